"""A scene as the options of a command line: the table, its shape and a contraction.

Numbers are exact all the way, and a decimal is the decimal it shows; none of the paper's tables imports SymPy.

A scene as a map in float64, and a starting point as exact numbers.
"""

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import PAPER, POINTS, exact
from symbolic.tables.scene import Scene

if TYPE_CHECKING:
    pass


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
    Scene('ellipse', a='sqrt(2)', lam='1/2')
    """
    named = [name for name, given in (("polar", polar), ("parametric", parametric), (table, table)) if given]
    if len(named) != 1 or named[0] is None:
        given = " and ".join(str(name) for name in named) or "none"
        raise ValueError(f"one table is needed, {given} given; accepted: {', '.join(PAPER)}, --polar or --parametric")
    name = named[0]
    if K is not None and name != "egg":
        raise ValueError(f"{name}: --K = {K} is only for the egg; leave it out")
    numbers: dict[str, Any] = {
        key: exact(f"--{key}", text) for key, text in _fitting(name, PAPER.get(name, ()), shape).items()
    }
    value = _contraction(lam)
    if table:
        return Scene(table, lam=value, K=POINTS if K is None else K, **numbers)
    try:
        return Scene.of({name: polar or list(parametric or ()), "lam": str(value)})
    except ValueError as error:
        raise ValueError(f"--{error}") from None


def _fitting(name: str, known: tuple[str, ...], shape: dict[str, str | None]) -> dict[str, str]:
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


def _contraction(lam: str | None) -> Any:
    value = "missing" if lam is None else exact("--lam", lam)
    if isinstance(value, str) or not 0 <= value <= 1:
        raise ValueError(f"--lam = {value} is no contraction; accepted: numbers in [0, 1]")
    return value


Command = Callable[..., Any]
TABLE = (
    click.argument("table", required=False, type=click.Choice(list(PAPER))),
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


def start_of(text: str) -> tuple[Any, Any]:
    """`THETA,PHI` as two exact numbers.

    >>> start_of("1/3,0.25")
    (Fraction(1, 3), Fraction(1, 4))
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise ValueError(f"--start {text!r} is no pair; give THETA,PHI such as 0.5,-pi/6")
    theta, phi = (exact("--start", part.strip()) for part in parts)
    return theta, phi
