"""Writes the certificates of this folder: `python certificates/make.py [--into DIR] [NAME...]`, from the root.

They belong to the report's headline numbers, with a few cycles so that every kind occurs. The same versions of the
package and its libraries write the same bytes on every machine: a test makes some of them again and compares.
"""

import argparse
import json
from collections.abc import Callable, Mapping
from fractions import Fraction
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from sympy import Expr, Integer, Rational

from symbolic import Law, Scene, tables
from symbolic.tables.table import Mark, Table
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind, Closure
from verification.named.locate import locate, proof_near
from verification.named.theorems import checked
from verification.proofs.global_dynamics.crisis import bracket
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.global_dynamics.regions import Region
from verification.proofs.manifolds.known import CONTACTS
from verification.rigorous.absorbing import grown
from verification.rigorous.boxes import Boxes

Proof = Callable[[], Any]
HERE = Path(__file__).parent
REPORTS = HERE.parent / "docs" / "reports"
NINE = (-2.2794, 0.0999, 2.9941, 2.5028, 1.9891, 1.3928, 0.7008, -0.1020, -1.0494)  # near a cycle at lam = 9/10
DIGITS = 20
LONGER = 32  # from so many bounces the checker uses equations that lose no digits
LONG = {6: 60}  # the checker follows a cycle as an orbit, and needs two digits for each bounce
LAW = (
    "-lam*tanh(eta) + exp(eta)/90 + log(eta**2 + 1)/20 - tan(eta/2)/9 - atan(eta)/9 + sinh(eta)*cosh(eta)/99"
    " + sqrt(eta + 2)/90 - (eta + 2)**(1/3)/80 + (eta + 3)**(-2)/9"
)
PEBBLE = (
    "1.5 0",
    "1.2 0.61",
    "0.31 0.98",
    "-0.73 0.87",
    "-1.4 0.33",
    "-1.41 -0.3",
    "-0.7 -0.9",
    "0.3 -1",
    "1.23 -0.58",
)
CUBIC = "-lam*eta*(1 - eta**2/40)"
BENT = "-b*eta - eta**3/50"
RADIUS = "1 + exp(cos(2*theta))/40 + tanh(cos(2*theta))/50 + (2 + cos(2*theta))**(2/3)/60 + E/99"
EGG, THIRD, HALF = Rational(2, 25), Rational(1, 3), Rational(1, 2)


def value(name: str, digits: int = DIGITS, **shape: Expr) -> Proof:
    """The certificate of a value that `pinball locate` proves."""
    return lambda: locate(name, digits, **shape).proof


def cycle(table: Table, start: list[float], lam: Expr, law: str = "-lam*eta", parts: tuple[int, ...] = ()) -> Proof:
    """The certificate of a cycle of a table of one component, or on the given components."""
    return lambda: proof_near(Problem(table, parts or (0,) * len(start), lam=lam, law=Law(law)), start, DIGITS)


def flip(
    table: Table, start: list[float], free: str, lam: Expr | None = None, mirror: bool = False, law: str = "-lam*eta"
) -> Proof:
    """The certificate of a period doubling under a user's table or law; the last start is for the free parameter."""
    closure = Closure(-1 if mirror else 1)
    problem = Problem(table, (0,) * (len(start) - 1), BifurcationKind.FLIP, free, lam, closure, Law(law))
    return lambda: proof_near(problem, start, DIGITS)


def doubling_beside(period: int, member: int) -> Proof:
    """The certificate of a doubling in another cascade than the paper's."""

    def proof() -> Any:
        from verification.paper.egg.egg import side_cascade

        found = side_cascade(period)[member]
        start = [float(x.mid()) for x in found.centre]
        return proof_near(found.problem, start, int(2.5 * len(start)))

    return proof


def inside(report: str, name: str) -> Mapping[str, Any]:
    """A certificate from inside a report of docs/reports."""
    blocks = (block for part in json.loads((REPORTS / report).read_text())["sections"] for block in part["blocks"])
    return next(block["document"] for block in blocks if block["kind"] == "certificate" and block["name"] == name)


def kept(report: str, name: str) -> Proof:
    """A certificate of a report of docs/reports, with as many digits as the independent checker needs."""

    def proof() -> Any:
        given = inside(report, name)
        start = [int(m) * 2.0 ** int(e) for m, e in given["centre"]]
        period = len(given["components"])
        table = tables.polar(given["scene"]["polar"])
        problem = Problem(table, (0,) * period, BifurcationKind.FLIP, "lam", None, Closure(1))
        return proof_near(problem, start, DIGITS if period > LONGER else int(2.5 * period))

    return proof


def touching(report: str, name: str) -> Proof:
    """The tangency of a report of docs/reports, proved again."""
    return lambda: checked(inside(report, name))


def family(radius: str, parameter: str, span: str) -> Table:
    """A table with a free parameter, over its range."""
    return Scene.of({"polar": radius, "shape": {parameter: span}}).family


def region(scene: Scene, start: tuple[float, float], lam: tuple[str, str], grid: tuple[int, int, int]) -> Proof:
    """The trapping region of cells to which a phase point leads, for a range of contractions."""

    def proof() -> Any:
        ends, (theta, phi) = (Fraction(lam[0]), Fraction(lam[1])), (np.array([x]) for x in start)
        found = grown(PinballImages(scene, ends), grid, Boxes(np.array([0]), (theta, theta), (phi, phi)))
        if found is None:
            return None
        return Region(scene, ends, *grid, found.cells)

    return proof


def crisis_between(low: str, high: str) -> Proof:
    """The boundary crisis of the egg between two contractions; the orbit that leaves is found in float64."""
    ends, triangle = (Fraction(low), Fraction(high)), CONTACTS["boundary"].unstable
    return lambda: bracket(Scene(tables.egg(3), alpha=EGG), triangle, 1, ends, (1024, 512, 1))


CERTIFICATES: Mapping[str, Proof] = MappingProxyType(
    {
        "lambda-star": value("lambda-star"),
        "phi-star": value("phi-star"),
        "lambda-c": value("lambda-c"),
        "alpha-tilde": value("alpha-tilde", lam=THIRD),
        "alpha-hat": value("alpha-hat", lam=THIRD),
        "saddle-node": value("saddle-node", alpha=EGG),
        "symmetry-breaking": value("symmetry-breaking", alpha=EGG),
        **{f"doubling-{n}": value("doubling", LONG.get(n, DIGITS), alpha=EGG, n=Integer(n)) for n in range(3, 7)},
        "merging-crisis": value("merging-crisis", alpha=EGG),
        "boundary-crisis": value("boundary-crisis", alpha=EGG),
        "minor-axis": cycle(tables.ellipse.at(a=2), [pi / 2, -pi / 2], THIRD),
        "cardioid": cycle(tables.cardioid, [pi / 3, -pi / 3], THIRD),
        "egg-triangle": cycle(tables.egg(3).at(alpha=EGG), [0.96, 3.05, 5.15], HALF),
        "five-waves": cycle(tables.polar("1 + cos(5*theta)/40"), [0.0, pi], THIRD),
        "cardioid-period-9": cycle(tables.cardioid, [*NINE], Rational(9, 10)),
        "egg-period-3": cycle(tables.egg(3).at(alpha=EGG), [0.96, 3.05, 5.15], Rational(3937, 10_000)),
        **{f"beside-{12 * 2**k}": doubling_beside(12, k) for k in range(2)},
        **{f"beside-{8 * 2**k}": doubling_beside(8, k) for k in range(2)},
        "limacon-12": kept("limacon.json", "cascade-3-12-0"),
        **{f"limacon-{3 * 2**k}": kept("limacon.json", f"cascade-3-{3 * 2**k}-0") for k in (3, 4)},
        **{f"flower-tangency-{k}": touching("flower.json", f"tangency-{k}") for k in range(4)},
        "tangency-under-a-law": lambda: locate("boundary-crisis", DIGITS, Law(CUBIC), alpha=EGG).proof,
        "marked-point": cycle(tables.polar("1 + cos(5*theta)/40", "polar", (), [Mark("m", 0, HALF)]), [0.0, pi], THIRD),
        "law-in-all-words": cycle(tables.egg(3).at(alpha=EGG), [0.96, 3.05, 5.15], HALF, LAW),
        "radius-in-words": cycle(tables.polar(RADIUS), [pi / 2, -pi / 2], THIRD),
        "free-parameter": flip(family("1 + b*cos(3*theta)", "b", "0:0..1/10"), [0.0, pi, 0.06], "b", THIRD),
        "spline": cycle(tables.from_points([p.split() for p in PEBBLE]), [0.0024, 0.5175], THIRD, parts=(0, 4)),
        "scatterer": cycle(tables.sinai(), [0.5, -pi], THIRD, parts=(3, 4)),
        "moved-waves": cycle(tables.polar("1 + cos(3*theta + 1/2)/20"), [-0.16667, 2.97493], THIRD),
        "law-parameter": flip(tables.egg(3).at(alpha="3/50"), [0.0, pi, 0.41], "b", THIRD, law=BENT),
        "own-mirror": flip(tables.polar("1 + 2*cos(3*theta)/25"), [0.0845, -2.7749, 0.2878], "lam", mirror=True),
        "triangle-region": region(
            Scene(tables.egg(3), alpha=EGG, lam=HALF), (2.88671, -0.34907), ("49/100", "1/2"), (512, 256, 1)
        ),
        "crisis-between": crisis_between("3/5", "663/1000"),
    }
)


def text(name: str) -> str:
    """A certificate as the text of its file."""
    proof = CERTIFICATES[name]()
    if proof is None or not proof.proved:
        raise ArithmeticError(f"{name}: not proved")
    return json.dumps(proof.document(), indent=1 if proof.evidence else None) + "\n"


def main() -> None:
    """Writes the named files, or all."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(CERTIFICATES)}")
    asked.add_argument("--into", type=Path, default=HERE, help="the folder for the files")
    given = asked.parse_args()
    for name in given.names or CERTIFICATES:
        (given.into / f"{name}.json").write_text(text(name), encoding="utf-8")


if __name__ == "__main__":
    main()
