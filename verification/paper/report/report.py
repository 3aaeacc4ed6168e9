"""The judging of a paper's claims, the results as JSON, and digests of the code that a claim depends on.

`catalogue()` lists the claims and `verify()` judges them. The printed text is in the paper's folder, the true
statements are derived in `symbolic`, and only judges use both, so that a misprint cannot affect the mathematics. The
digest of a claim covers every module that its judge can load, according to the imports in the source text. This set of
modules is never too small, but may be larger than the claim needs.
"""

import platform
import re
import time
from collections import Counter, deque
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from difflib import get_close_matches
from fnmatch import fnmatchcase
from functools import cache, partial
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from importlib.resources.abc import Traversable
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from numeric.sweeps import workers
from numeric.sweeps.workers import Lost, cores, in_processes
from symbolic.expressions.signs import Outcome, SignFinding
from verification.arithmetic.balls import decimal, real_ball
from verification.paper.claims.claim import Claim, Judgement, Verdict, seconds
from verification.paper.claims.folder import OWN, Paper, home, judge_of, module, paper
from verification.paper.claims.sharing import shared_out
from verification.paper.figures.catalogue import FigureSource, PaperFigure

SMALL = 4.0  # below so many seconds of work other processes are not used
STOREYS = ("symbolic", "numeric", "verification")
OURS = rf"(?:{'|'.join(STOREYS)})"
FROM = re.compile(r"^[ \t]*from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|[^\n(]*)", re.MULTILINE)
IMPORT = re.compile(rf"^[ \t]*import[ \t]+({OURS}[\w.]*)", re.MULTILINE)
LEFT_OUT = re.compile(
    r'"""[\s\S]*?"""|^if TYPE_CHECKING:\n(?:[ \t].*\n|\n)*', re.MULTILINE
)  # docstrings, and imports for types only
QUOTED = re.compile(rf"[\"']({OURS}(?:\.\w+)+)[\"'.]")  # a module or package named in a string


@dataclass(frozen=True)
class Result:
    """A judged claim, in the form that all versions of the report use."""

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
    unsettled: str = ""

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Result":
        """The result that was written by `to_dict`."""
        return cls(**{**data, "verdict": Verdict(data["verdict"])})

    def to_dict(self) -> dict[str, object]:
        """The result as an object of the JSON schema."""
        rounded = {"verdict": self.verdict.value, "seconds": round(self.seconds, 4), "witness": dict(self.witness)}
        return {**self.__dict__, **rounded}


def catalogue(claims: str | Path = OWN) -> list[Claim]:
    """The claims of the paper in a folder, or of a paper of the package by its name, in the given order."""
    return list(paper(claims).claims)


def pictures(found: Paper) -> list[PaperFigure]:
    """The figures of a paper; empty for most papers."""
    return list(module(home(Path(found.figures))).pictures().values()) if found.figures else []


def verify(only: str = "*", digits: int = 15, jobs: int = 1, claims: str | Path = OWN) -> Iterator[Result]:
    """Judges the claims whose id matches the glob `only`, in the catalogue's order; only their judges are imported.

    `ValueError` at the call if there is no such claim or folder.

    With more than one job the claims are judged in that many processes. `claims` is the folder of another paper, or the
    name of a paper of the package; the judges in a folder are executed.
    """
    known = {claim.id: claim for claim in catalogue(claims)}
    return _in_order([known[name] for name in matching(only, [*known])], digits, jobs)


def _in_order(asked: Sequence[Claim], digits: int, jobs: int) -> Iterator[Result]:
    """Yields the result of each claim, in the order of the claims."""
    found: dict[str, Result] = {}
    order = deque(claim.id for claim in asked)
    with closing(judged(asked, digits, jobs)) as results:
        for result in results:
            found[result.id] = result
            while order and order[0] in found:
                yield found[order.popleft()]


def matching(only: str, ids: Sequence[str], label: str = "only") -> list[str]:
    """The ids that match the glob `only`; `ValueError` with the most similar ids if none does, about `label`.

    >>> matching("egg.*", ["egg.mu", "ellipse.mu"])
    ['egg.mu']
    """
    found = [each for each in ids if fnmatchcase(each, only)]
    if not found:
        if "," in only:
            again = " ".join(f"{label} {each.strip()!r}" for each in only.split(",") if each.strip())
            raise ValueError(f"{label} {only!r} is no name of a claim; accepted: one name at a time, as in {again}")
        near = ", ".join(get_close_matches(only.strip("*"), ids, 3, 0))
        raise ValueError(f"{label} {only!r} matches no claim; the nearest are: {near}")
    return found


class DrawnPicture(NamedTuple):
    """The rendered image of a picture, as the bytes of a file, and the picture's name."""

    name: str
    image: bytes


def judged(claims: Sequence[Claim], digits: int, jobs: int | None) -> Generator[Result, None, None]:
    """Yields the result of each claim when it is finished; with several jobs, the most expensive claims start first.

    The results do not depend on `jobs`, except for their computing times. A claim whose process dies repeatedly is
    open.
    """
    for answer in answered(claims, (), digits, jobs):
        if isinstance(answer, Result):
            yield answer


def answered(
    claims: Sequence[Claim], drawings: Sequence[FigureSource], digits: int, jobs: int | None
) -> Generator[Result | DrawnPicture, None, None]:
    """Yields results of claims and images of pictures when they are finished, from one pool of processes.

    The most expensive ones start first. In contrast to `judged`, a picture whose process dies repeatedly raises an
    error.
    """
    for claim in claims:
        if claim.home.endswith(".py"):
            judge_of(claim)  # fails before any work if a module cannot be run
    if _few(claims, drawings, jobs):
        yield from (judge(claim, digits) for claim in claims)
        yield from (DrawnPicture(each.name, each.drawn()) for each in drawings)
        return
    tasks: list[list[Claim | FigureSource]] = [[*group] for group in shared_out(claims, jobs or cores())]
    tasks.extend([each] for each in drawings)
    tasks.sort(key=seconds, reverse=True)
    with closing(in_processes(partial(answer, digits=digits), tasks, jobs, _modules(claims, drawings))) as answers:
        for item, found in answers:
            if not isinstance(found, Lost):
                yield found
            elif isinstance(item, Claim):
                yield _result(item, _open(f"not judged: {found}"), digits, 0.0)
            else:
                raise RuntimeError(f"the picture {item.name} could not be drawn: {found}")


def begin(claims: Sequence[Claim], drawings: Sequence[FigureSource], jobs: int | None) -> None:
    """Starts to import the modules that `answered` needs in other processes, if it uses any."""
    if not _few(claims, drawings, jobs):
        workers.begin(_modules(claims, drawings))


def _few(claims: Sequence[Claim], drawings: Sequence[FigureSource], jobs: int | None) -> bool:
    return jobs == 1 or seconds([*claims, *drawings]) < SMALL


def _modules(claims: Sequence[Claim], drawings: Sequence[FigureSource]) -> list[str]:
    homes = {claim.home for claim in claims if not claim.home.endswith(".py")}
    return sorted(homes | {each.module for each in drawings})


def answer(item: Claim | FigureSource, digits: int) -> Result | DrawnPicture:
    """The result of a claim, or the image of a picture."""
    return judge(item, digits) if isinstance(item, Claim) else DrawnPicture(item.name, item.drawn())


def judge(claim: Claim, digits: int = 15) -> Result:
    """The result of one claim; the module of its judge is imported on first use."""
    start = time.perf_counter()
    try:
        found = judge_of(claim)
        start = time.perf_counter()  # the import is not counted
        judgement = found(claim)
        if not isinstance(judgement, Judgement):
            raise TypeError(f"it returns {judgement!r}, and a judge returns a Judgement")
    except Exception as error:  # a judge that fails leaves its claim open
        judgement = _open(f"the judge failed: {type(error).__name__}: {error}")
    return _result(claim, judgement, digits, time.perf_counter() - start)


def _open(reason: str) -> Judgement:
    return Judgement(SignFinding(Outcome.UNKNOWN, reason), "")


def _result(claim: Claim, judgement: Judgement, digits: int, seconds: float) -> Result:
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
        seconds,
        judgement.erratum if judgement.verdict in (Verdict.CORRECTED, Verdict.REFUTED) else "",
        {str(letter): str(value) for letter, value in judgement.witness(claim).items()},
        claim.unsettled if judgement.verdict in (Verdict.SUPPORTED, Verdict.OPEN) else "",
    )


def method(judgement: Judgement) -> str:
    """The reason for the verdict, in a sentence or two."""
    if judgement.verdict is Verdict.SUPPORTED:
        return judgement.evidence
    if judgement.verdict is Verdict.CORRECTED and judgement.mended is not None:
        return f"As printed: {judgement.printed.reason}. Corrected: {judgement.mended.reason}."
    return judgement.printed.reason


VERDICTS = {
    "confirmed": "proved, and as printed",
    "corrected": "proved to differ from what is printed, and the right form is proved",
    "refuted": "proved false",
    "supported": "agrees within a stated error, not proved",
    "open": "not settled",
}


def document(results: Iterable["Result"], about: Mapping[str, object] | None = None) -> dict[str, Any]:
    """The results in the JSON schema of `pinball verify`, with `about` as its entry `paper`."""
    return {"schema": 1, **({"paper": about} if about else {}), "claims": [result.to_dict() for result in results]}


def counts(results: Iterable["Result"]) -> dict[str, int]:
    """The number of claims with each verdict, including verdicts without claims."""
    found = Counter(result.verdict.value for result in results)
    return {verdict: found[verdict] for verdict in VERDICTS}


def summary(results: Sequence["Result"]) -> str:
    """One line with the number of claims and the number with each verdict."""
    parts = ", ".join(f"{number} {verdict}" for verdict, number in counts(results).items())
    return f"{len(results)} claim{'s' if len(results) != 1 else ''}: {parts}."


def made_with() -> dict[str, str]:
    """The versions of the packages on which results depend, the type of machine, and the seed."""
    found = {"python": platform.python_version()}
    for package in ("sympy", "mpmath", "gmpy2", "python-flint", "numpy"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found | {"machine": platform.machine() or "unknown", "seed": "1"}


def by_section(results: Iterable["Result"], sections: Iterable[str] = ()) -> list[tuple[str, list["Result"]]]:
    """The results by section: first the given `sections` in order, then other sections by number."""
    order = {name: (-1, n) for n, name in enumerate(sections)}
    ordered = sorted(results, key=lambda each: (order.get(each.section, section_order(each.section)), each.section))
    return [(name, list(claims)) for name, claims in groupby(ordered, key=lambda result: result.section)]


def errata(results: Iterable["Result"], sections: Iterable[str] = ()) -> list["Result"]:
    """The corrected and refuted results, in the order of the paper."""
    wrong = [result for result in results if result.verdict.value in ("corrected", "refuted")]
    return [result for _, claims in by_section(wrong, sections) for result in claims]


def place(result: "Result") -> str:
    """The claim's section, as text."""
    return f"Section {result.section}" if section_order(result.section) > (0,) else result.section


def section_order(section: str) -> tuple[int, ...]:
    """A sort key of sections: the abstract, the numbered sections, the appendix.

    >>> sorted(["A.1 Lyapunov", "10 End", "6.2 Slap", "6 Egg", "Abstract"], key=section_order)
    ['Abstract', '6 Egg', '6.2 Slap', '10 End', 'A.1 Lyapunov']
    """
    label = section.split(" ")[0].split(".")
    if label[0].isdigit():
        return (1, *(int(part) for part in label if part.isdigit()))
    return (2, *(int(part) for part in label[1:] if part.isdigit())) if len(label[0]) == 1 else (0,)


@cache
def sources() -> Mapping[str, str]:
    """The text of every module of the package by its dotted name, and of each package's stub by its name and `.pyi`."""
    found: dict[str, str] = {}
    for storey in STOREYS:
        _gather(files(storey), storey, found)
    return found


def _gather(folder: Traversable, name: str, found: dict[str, str]) -> None:
    for path in folder.iterdir():
        if path.is_dir() and (path / "__init__.py").is_file():
            _gather(path, f"{name}.{path.name}", found)
        elif path.name.endswith((".py", ".pyi")):
            stem, ending = path.name.split(".")
            dotted = name if stem == "__init__" else f"{name}.{stem}"
            found[f"{dotted}.pyi" if ending == "pyi" else dotted] = path.read_text(encoding="utf-8")


@cache
def exports(room: str) -> Mapping[str, str]:
    """For each name that a package exports, the module that defines it.

    >>> exports("verification")["verify"]
    'verification.paper.report.report'
    """
    pairs = FROM.findall(sources().get(f"{room}.pyi", ""))
    return {name: f"{room}{origin}".rstrip(".") for origin, names in pairs for name in _names(names)}


def _names(listed: str) -> list[str]:
    return [name.split(" as ")[0].strip() for name in listed.strip("()").split(",") if name.strip()]


@cache
def imports(module: str) -> frozenset[str]:
    """The modules of the package that the source text of a module names.

    >>> "symbolic.expressions.signs" in imports("verification.paper.claims.judges")
    True
    """
    found = named(LEFT_OUT.sub("", sources()[module]))
    # Packages run first.
    above = {each.rsplit(".", n)[0] for each in {*found, module} for n in range(1, each.count(".") + 1)}
    return frozenset((found | above) & sources().keys())


def named(text: str) -> set[str]:
    """The modules of the package that a text imports or quotes, and the names imported from them."""
    known, found = sources(), set(IMPORT.findall(text))
    for origin, names in FROM.findall(text):
        found.add(origin)
        if origin in known:
            for name in _names(names):
                found |= {f"{origin}.{name}", *([exports(origin)[name]] if name in exports(origin) else [])}
    for quoted in QUOTED.findall(text):
        found |= {quoted, *(each for each in known if each.rpartition(".")[0] == quoted)}
    return found


def closure(module: str) -> frozenset[str]:
    """The module and all modules of the package that it can load, directly or indirectly."""
    found, waiting = {module}, [module]
    while waiting:
        new = imports(waiting.pop()) - found
        found |= new
        waiting += new
    return frozenset(found)


@cache
def digest(module: str) -> str:
    """A digest of the source of a module, of all modules that it can load, and of the versions of packages."""
    whole = sha256(repr(sorted(made_with().items())).encode())
    for name in sorted(closure(module)):
        whole.update(f"\n{name}\n".encode() + sources()[name].encode())
    return whole.hexdigest()


def codes(claims: Iterable[Claim], digits: int, figures: Iterable[PaperFigure] = ()) -> dict[str, str]:
    """A digest for each claim, by its id, and for each figure of the claims' sections, by `figure NAME`.

    It changes with the claim's text, its judge, the modules that the judge can load, and the number of digits.
    """
    claims = list(claims)
    judged = {claim.id: _digest(claim.home, claim, digits) for claim in claims}
    sections = {claim.section for claim in claims}
    return judged | {f"figure {each.name}": _digest(each.module, each) for each in figures if each.section in sections}


def _digest(module: str, *words: object) -> str:
    code = outside(module) if module.endswith(".py") else digest(module)
    return sha256(repr((code, words)).encode()).hexdigest()


def outside(path: str) -> str:
    """A digest of a module outside the package, and of the modules of the package that it can load."""
    text = Path(path).read_text(encoding="utf-8")
    whole = sha256(text.encode())
    for name in sorted(named(text) & sources().keys()):
        whole.update(digest(name).encode())
    return whole.hexdigest()
