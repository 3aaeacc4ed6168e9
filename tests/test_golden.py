"""The package's present results, one line per value, so that each changed result is a changed line.

`make golden` writes the files of `tests/golden`, and these tests compare. A changed line is explained in the changelog.
The bits of the kernels are in `tests/numeric/golden_bits.json`.
"""

import hashlib
import json
import math
import os
import shlex
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest

from symbolic.tables.definition import GALLERY
from verification.app.cli import main
from verification.paper.report.report import catalogue, judge

ROOT = Path(__file__).parent.parent
KEPT = ROOT / "tests" / "golden"
FLOATS = 1e-9  # relative: libraries differ in the last digits
EGG = "--alpha 0.08"
CLAIM = ("verdict", "value", "radius", "derived", "erratum")
CLOCK = (  # the machine, words
    "seconds", "newton", "gmpy2", "title", "resolution", "machine", "made_with", "versions", "degenerate",
)  # fmt: skip
# of these values follow others
LONG = ("points", "fields", "trace", "components", "coords", "conditioning", "determinant")
COMMANDS = {
    "locate": [
        "lambda-star --digits 60",
        "phi-star --digits 60",
        "lambda-c --digits 40",
        "alpha-tilde --lam 1/3 --digits 40",
        "alpha-hat --lam 1/3 --digits 40",
        f"saddle-node {EGG} --digits 40",
        f"symmetry-breaking {EGG} --digits 40",
        *(f"doubling {EGG} --n {n} --digits 30" for n in range(3, 9)),
        *(f"{name} {EGG} --digits 20" for name in ("merging-crisis", "boundary-crisis", "symmetry-restoring")),
        *(
            f"{name} {EGG} --period {n} --digits 16"
            for name, n in [("band-merging", 4), ("window-end", 15), ("family-end", 8)]
        ),
    ],
    "follow": [
        f"egg {EGG} --cycle triangle --lam 0.37:1 --digits 20",
        "egg --alpha 0.08 --lam 0.5 --cycle diameter --shape 0.01:0.1",
        "cuspless --cycle horizontal --lam 0:1",
        "ellipse --a 1.5 --cycle minor-axis --lam 0:1",
        "--polar '1 + cos(2*theta)/10' --lam 0.1:1 --start 0,pi",
    ],
    "cycles": [
        f"egg {EGG} --lam 0.5 --period 8 --count 4 --prove 3",
        f"egg {EGG} --lam 0.2 --period 6 --count 3 --prove 2",
        "cuspless --lam 0.09 --period 6",
        "ellipse --a 1.5 --lam 0.9 --period 4",
        *(f"{name} --lam 1/2 --period 3" for name in ("circle", "cardioid", *GALLERY)),
    ],
    "orbit": [
        f"egg {EGG} --lam 0.5 --start 0.3,0.2 --bounces 5 --arithmetic {way}" for way in ("float64", "mpmath", "arb")
    ],
    "lyapunov": ["cuspless --lam 0.8 --bounces 1000 --orbits 20 --seed 1"],
    "attractor": [f"egg {EGG} --lam 0.43 --orbits 100 --seed 1"],
    "basins": ["cuspless --lam 0.09 --columns 8 --rows 6"],
    "bifurcation": [f"egg {EGG} --lams 0.35:0.45:3 --orbits 4"],
    "slap": [f"egg {EGG} --iterates 2 --points 5"],
    "morse": [f"egg {EGG} --lam 0.5 --columns 128 --rows 64"],
    "verify": ["--only ellipse.P1"],
}
WHOLE = [f"{command} {text}" for command, texts in COMMANDS.items() for text in texts]
DEAR = ("crisis", "restoring", "merging", "-end", "--n 8", "cycles stadium", "cycles elliptical")  # some words of each
QUICK = 0.02  # seconds of judging a claim
PARTS = (("egg",), ("cuspless",), ("map", "cardioid", "ellipse", "circle", "appendix"))  # of what shares little


def leaves(said: object, path: str = "") -> Iterator[tuple[str, object]]:
    """Each value of a JSON document with its path, without times and long lists."""
    if isinstance(said, dict | list):
        for key, value in sorted(said.items()) if isinstance(said, dict) else enumerate(said):
            if key not in CLOCK + LONG:
                yield from leaves(value, f"{path}.{key}")
    else:
        yield path, said


def answer(line: str) -> list[str]:
    """The lines of a command: its exit status, then each value that it writes with `--json`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answer.json"
        status = main([*shlex.split(line), "--json", str(path)])
        said = json.loads(path.read_text()) if path.is_file() else None
    return [f"{line} | exit = {status}", *(f"{line} | {path} = {json.dumps(value)}" for path, value in leaves(said))]


def claims(most: float = math.inf, parts: tuple[str, ...] = ("",)) -> list[str]:
    """Verdict, value and printed right form of each claim of these parts that takes at most `most` seconds alone."""
    known = [claim for claim in catalogue() if claim.id.startswith(parts)]
    spared = {name for claim in known for name, seconds in claim.spares if seconds > most}
    found = [judge(claim).to_dict() for claim in known if claim.seconds <= most and claim.id not in spared]
    return sorted(f"{each['id']} | {key} = {json.dumps(each[key])}" for each in found for key in CLAIM)


def certificates() -> list[str]:
    """A digest of each committed certificate."""
    files = sorted((ROOT / "certificates").glob("*.json"))
    return [f"{file.name} = {hashlib.sha256(file.read_bytes()).hexdigest()}" for file in files]


def same(kept: str, now: str) -> bool:
    """Whether two lines are equal, with floats compared up to their last digits."""
    if kept == now:
        return True
    (name, _, old), (other, _, new) = kept.partition(" = "), now.partition(" = ")
    try:
        return (
            name == other
            and isinstance(json.loads(old), float)
            and math.isclose(float(old), float(new), rel_tol=FLOATS, abs_tol=FLOATS)
        )
    except ValueError:
        return False


def differences(kept: list[str], now: list[str]) -> list[str]:
    """The lines that changed, old ones after `-` and new ones after `+`."""
    if len(kept) == len(now):
        pairs = [(old, new) for old, new in zip(kept, now, strict=True) if not same(old, new)]
        return [line for old, new in pairs for line in (f"- {old}", f"+ {new}")]
    old, new = set(kept), set(now)
    return [*(f"- {line}" for line in kept if line not in new), *(f"+ {line}" for line in now if line not in old)]


def read(kind: str) -> list[str]:
    return (KEPT / f"{kind}.txt").read_text().splitlines()


def slow_if(dear: bool) -> list[pytest.MarkDecorator]:
    return [pytest.mark.slow] if dear else []


@pytest.mark.parametrize("line", [pytest.param(x, marks=slow_if(any(word in x for word in DEAR))) for x in WHOLE])
def test_a_command_answers_as_before(line):
    kept = [each for each in read(line.split()[0]) if each.startswith(f"{line} | ")]

    assert kept
    assert differences(kept, answer(line)) == []


@pytest.mark.parametrize(
    ("most", "parts"), [(QUICK, ("",)), *(pytest.param(math.inf, each, marks=pytest.mark.slow) for each in PARTS)]
)
def test_each_claim_has_the_verdict_that_it_had(most, parts):
    now = claims(most, parts)
    names = {line.partition(" | ")[0] for line in now}

    assert len(names) > 50
    assert differences([line for line in read("claims") if line.partition(" | ")[0] in names], now) == []


def test_no_committed_certificate_changed():
    assert differences(read("certificates"), certificates()) == []


def test_a_digit_that_moves_is_a_line():
    assert differences(["x = 0.25"], ["x = 0.2500000000001"]) == []
    assert differences(['x = "0.5001"', "y = 1"], ['x = "0.5002"', "y = 1"]) == ['- x = "0.5001"', '+ x = "0.5002"']
    assert differences(["x = 1"], ["x = 1", "y = 2"]) == ["+ y = 2"]


if __name__ == "__main__":
    os.environ.setdefault("COLUMNS", "120")
    KEPT.mkdir(exist_ok=True)
    with ProcessPoolExecutor(2) as pool:  # balls hold ambient state, so each command has its process
        answers = dict(zip(WHOLE, pool.map(answer, WHOLE), strict=True))
    for command, texts in COMMANDS.items():
        lines = [line for text in texts for line in answers[f"{command} {text}"]]
        (KEPT / f"{command}.txt").write_text("\n".join(lines) + "\n")
    (KEPT / "claims.txt").write_text("\n".join(claims()) + "\n")
    (KEPT / "certificates.txt").write_text("\n".join(certificates()) + "\n")
    sys.stdout.write(f"written: {KEPT.relative_to(ROOT)}\n")
