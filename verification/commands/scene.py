"""A scene: a table, its shape and a contraction, as the command line gives them.

Numbers stay text until a table is built, so a command that only reads its arguments does not
import SymPy; they are exact all the way, and a decimal is the decimal it shows.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from sympy import Expr

    from symbolic.table import Table

SHAPES: Mapping[str, tuple[str, ...]] = {
    "circle": (),
    "ellipse": ("a",),
    "cardioid": (),
    "cuspless": (),
    "egg": ("alpha",),
}
POINTS = 3  # of the paper's egg
PLAIN = re.compile(r"[+-]?(\d{1,99}/[1-9]\d{0,98}|(\d{1,99}\.?\d{0,99}|\.\d{1,99})([eE][+-]?\d{1,2})?)", re.ASCII)


@dataclass(frozen=True)
class Scene:
    """Where a ball moves. `formula` has one part for a polar table, two for a parametric, else none.

    >>> Scene("egg", {"alpha": "0.08"}, lam="1/2").table().fixed
    (('alpha', 2/25),)
    """

    table_name: str
    shape: Mapping[str, str] = field(default_factory=dict)
    formula: tuple[str, ...] = ()
    lam: str = "0"
    K: int = POINTS

    def table(self) -> "Table":
        """The symbolic table; `ValueError` when there is none for this shape or formula."""
        from symbolic import tables
        from symbolic.formula import parse

        if not self.formula:
            return tables.named(self.table_name, self.K).at(**self.values())
        parts = []
        for text in self.formula:
            try:
                parts.append(parse(text))
            except ValueError as error:
                raise ValueError(f"--{self.table_name}: {error}") from None
        return tables.polar(*parts) if self.table_name == "polar" else tables.parametric(*parts)

    def values(self) -> dict[str, "Expr"]:
        """The shape parameters as exact numbers."""
        from symbolic.formula import number

        return {name: number(text, f"--{name}") for name, text in self.shape.items()}

    def contraction(self) -> "Expr":
        """`lam` as an exact number."""
        from symbolic.formula import number

        return number(self.lam, "--lam")


def scene(
    table: str | None,
    polar: str | None,
    parametric: tuple[str, str] | None,
    K: int | None,
    lam: str | None,
    **shape: str | None,
) -> Scene:
    """The scene that the options describe; `ValueError` when they contradict each other.

    >>> scene("ellipse", None, None, None, "0.5", a="sqrt(2)")
    Scene(table_name='ellipse', shape={'a': 'sqrt(2)'}, formula=(), lam='1/2', K=3)
    """
    named = [name for name, given in (("polar", polar), ("parametric", parametric), (table, table)) if given]
    if len(named) != 1 or named[0] is None:
        given = " and ".join(str(name) for name in named) or "none"
        raise ValueError(f"one table is needed, {given} given; accepted: {', '.join(SHAPES)}, --polar or --parametric")
    name, known = named[0], SHAPES.get(named[0], ())
    if K is not None and name != "egg":
        raise ValueError(f"{name}: --K = {K} is only for the egg; leave it out")
    return Scene(
        name,
        {key: str(exact(f"--{key}", text)) for key, text in _fitting(name, known, shape).items()},
        (polar,) if polar else tuple(parametric or ()),
        _contraction(lam),
        POINTS if K is None else K,
    )


def exact(label: str, text: str) -> "Fraction | Expr":
    """The exact number that `text` says; a plain one is read without SymPy.

    >>> str(exact("--alpha", "0.08")), str(exact("--a", "sqrt(2)"))
    ('2/25', 'sqrt(2)')
    """
    if PLAIN.fullmatch(text):
        return Fraction(text)
    from symbolic.formula import number

    return number(text, label)


def _fitting(name: str, known: tuple[str, ...], shape: Mapping[str, str | None]) -> dict[str, str]:
    """The shape parameters that were given, when they are the ones the table has."""
    given = {key: text for key, text in shape.items() if text is not None}
    for key in known:
        if key not in given:
            raise ValueError(f"{name}: --{key} is missing; give it a number such as --{key} 2/25")
    for key, text in given.items():
        if key not in known:
            accepted = ", ".join(f"--{k}" for k in known) or "none"
            raise ValueError(f"{name}: --{key} = {text} is no shape parameter of this table; accepted: {accepted}")
    return given


def _contraction(lam: str | None) -> str:
    value = "missing" if lam is None else exact("--lam", lam)
    if isinstance(value, str) or not 0 <= value <= 1:
        raise ValueError(f"--lam = {value} is no contraction; accepted: numbers in [0, 1]")
    return str(value)


Command = Callable[..., Any]
TABLE = (
    click.argument("table", required=False, type=click.Choice(list(SHAPES))),
    click.option("--a", metavar="NUMBER", help="Half the major axis of the ellipse, at least 1."),
    click.option("--alpha", metavar="NUMBER", help="Shape of the egg, from 0 to 1/(1 + K^2)."),
    click.option("--K", "K", type=click.IntRange(2), metavar="INTEGER", help="Points of the egg; the paper's has 3."),
    click.option("--polar", metavar="FORMULA", help="Your own table: the radius, a formula in theta."),
    click.option("--parametric", nargs=2, metavar="X Y", help="Your own table: a closed curve in theta on [-pi, pi)."),
)
CONTRACTION = click.option("--lam", metavar="NUMBER", help="Contraction of the angle, from 0 to 1.")


def table_options(command: Command) -> Command:
    """Gives `command` the arguments of a table, as a keyword `scene` whose `lam` is 0."""

    @wraps(command)
    def called(
        table: str | None,
        polar: str | None,
        parametric: tuple[str, str] | None,
        K: int | None,
        a: str | None,
        alpha: str | None,
        lam: str | None = "0",
        **others: Any,
    ) -> Any:
        return command(scene=scene(table, polar, parametric, K, lam, a=a, alpha=alpha), **others)

    for option in reversed(TABLE):
        called = option(called)
    return called


def scene_options(command: Command) -> Command:
    """Gives `command` the arguments of a scene, as a keyword `scene`."""
    return CONTRACTION(table_options(command))
