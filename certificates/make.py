"""Writes the certificates of this folder: `python certificates/make.py [--into DIR] [NAME...]`, from the root.

The values behind the report's headline numbers, and a few cycles so that every kind is there. The same versions of the
package and its libraries write the same bytes, whatever the machine: a test makes some of them again and compares.
"""

import argparse
import json
from collections.abc import Callable, Mapping
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sympy import Expr, Integer, Rational

from symbolic import tables
from symbolic.tables.table import Table
from verification.cycles.problem import Problem
from verification.named.files import document
from verification.named.locate import certify, locate

Proof = Callable[[], Any]
HERE = Path(__file__).parent
DIGITS = 20
LONG = {6: 60}  # the second reader follows a cycle all round, and needs two digits for each bounce of a long one
EGG, THIRD, HALF = Rational(2, 25), Rational(1, 3), Rational(1, 2)


def value(name: str, digits: int = DIGITS, **shape: Expr) -> Proof:
    """What `pinball locate` proves of a named value."""
    return lambda: locate(name, digits, **shape).proof


def cycle(table: Table, start: list[float], lam: Expr) -> Proof:
    """A cycle by itself, of a table of one component."""
    return lambda: certify(Problem(table, (0,) * len(start), lam=lam), start, DIGITS)


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
    }
)


def text(name: str) -> str:
    """A certificate as it stands in its file."""
    proof = CERTIFICATES[name]()
    if proof is None or not proof.certified:
        raise ArithmeticError(f"{name}: not proved")
    return json.dumps(document(proof), indent=1) + "\n"


def main() -> None:
    """Writes the files that are asked for, or all."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(CERTIFICATES)}")
    asked.add_argument("--into", type=Path, default=HERE, help="the folder for the files")
    given = asked.parse_args()
    for name in given.names or CERTIFICATES:
        (given.into / f"{name}.json").write_text(text(name), encoding="utf-8")


if __name__ == "__main__":
    main()
