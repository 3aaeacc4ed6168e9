"""The claims of the paper, each with a judge: `catalogue()` lists them, `verify()` judges them.

What is printed lies in `printed/*.toml`, what is true is derived in `symbolic`, and the judges
stand between the two; so a misprint cannot leak into the mathematics.
"""

import re
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache
from importlib import import_module
from importlib.resources import files

from symbolic.expressions.signs import Finding, Outcome
from verification.arithmetic.balls import decimal, real_ball
from verification.paper.claims.claim import Claim, Judgement, Verdict, load
from verification.paper.claims.judges import JUDGES

TABLES = ("map", "circle", "ellipse", "cardioid", "cuspless", "egg", "appendix")
ROOMS = ("ellipse", "cardioid", "egg", "shared")  # of judges
JUDGED, QUOTED = re.compile(r"@judges\(([^)]*)\)"), re.compile(r'"([^"]+)"')


@dataclass(frozen=True)
class Result:
    """A judged claim, as the report shows it."""

    id: str
    section: str
    quote: str
    printed: str
    derived: str
    verdict: Verdict
    value: str | None
    radius: str | None
    method: str
    seconds: float
    erratum: str = ""
    witness: Mapping[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, object]:
        """The keys of the JSON schema, in order."""
        rounded = {"verdict": self.verdict.value, "seconds": round(self.seconds, 4), "witness": dict(self.witness)}
        return {**self.__dict__, **rounded}


def catalogue() -> list[Claim]:
    """Every claim, table by table, in the order of the paper."""
    return [claim for table in TABLES for claim in load(table)]


def verify(only: str = "*", digits: int = 15) -> Iterator[Result]:
    """Judges the claims whose id matches the glob `only`, one at a time; only their judges are imported."""
    for claim in catalogue():
        if fnmatchcase(claim.id, only):
            yield judge(claim, digits)


@cache
def homes() -> dict[str, str]:
    """The module that judges each claim, read off the decorators without importing a judge.

    >>> homes()["egg.monodromy"]
    'verification.paper.egg.period2'
    """
    found: dict[str, str] = {}
    for room in ROOMS:
        for path in (files("verification.paper") / room).iterdir():
            if path.name.endswith(".py"):
                text = path.read_text(encoding="utf-8")
                named = [name for ids in JUDGED.findall(text) for name in QUOTED.findall(ids)]
                found |= dict.fromkeys(named, f"verification.paper.{room}.{path.name[:-3]}")
    return found


def judge(claim: Claim, digits: int = 15) -> Result:
    """The result of one claim; `open` when nothing judges it yet."""
    start = time.perf_counter()
    if claim.id in homes():
        import_module(homes()[claim.id])
    if claim.id in JUDGES:
        judgement = _judged(claim)
    else:
        judgement = Judgement(Finding(Outcome.UNKNOWN, "stated from numerics; nothing settles it here yet"), "")
    value, radius = None, None
    if judgement.value is not None:
        value, radius = decimal(real_ball(judgement.value, digits + 5), digits)
    return Result(
        claim.id,
        claim.section,
        claim.quote,
        claim.text,
        judgement.derived,
        judgement.verdict,
        value,
        radius,
        method(judgement),
        time.perf_counter() - start,
        judgement.erratum if judgement.verdict in (Verdict.CORRECTED, Verdict.REFUTED) else "",
        {str(letter): str(value) for letter, value in judgement.witness(claim).items()},
    )


def _judged(claim: Claim) -> Judgement:
    """A judge that fails leaves its claim open, and says so; the others go on."""
    try:
        return JUDGES[claim.id](claim)
    except Exception as error:
        return Judgement(Finding(Outcome.UNKNOWN, f"the judge failed: {type(error).__name__}: {error}"), "")


def method(judgement: Judgement) -> str:
    """How the verdict was reached, in a sentence or two."""
    if judgement.verdict is Verdict.SUPPORTED:
        return judgement.evidence
    if judgement.verdict is Verdict.CORRECTED and judgement.mended is not None:
        return f"As printed: {judgement.printed.reason}. Corrected: {judgement.mended.reason}."
    return judgement.printed.reason
