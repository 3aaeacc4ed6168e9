"""A scene as the options of a command line, and what the commands that sweep over scenes have in common.

Table, shape and contraction are exact all the way: a decimal is the decimal it shows. None of the paper's tables
imports SymPy. From the options come the scene, a starting point as exact numbers, and the axes of a sweep.
"""

import json
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from symbolic import tables
from symbolic.tables.definition import GALLERY, PAPER, POINTS, UNIFORM, exact, parameter_text, range_ends, range_text
from symbolic.tables.law import Law, parameters_of_law
from symbolic.tables.scene import Scene

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from symbolic.tables.table import Table


def scene(
    table: str | None,
    polar: str | None,
    parametric: tuple[str, str] | None,
    K: int | None,
    lam: str | None,
    file: str | None = None,
    given: tuple[str, ...] = (),
    drawn: "Table | None" = None,
    formula: str | None = None,
    /,
    **shape: str | None,
) -> Scene:
    """The scene that the options describe; `ValueError` when they contradict each other.

    >>> scene("ellipse", None, None, None, "0.5", a="sqrt(2)")
    Scene('ellipse', a='sqrt(2)', lam='1/2')
    >>> scene("circle", None, None, None, "0.5", None, ("b=0.1",), None, "-lam*eta - b*sin(2*eta)")
    Scene('circle', b='1/10', law='-b*sin(2*eta) - eta*lam', lam='1/2')
    """
    options = ("polar", polar), ("parametric", parametric), (table, table), ("scene", file), ("data", drawn)
    named = [name for name, said in options if said]
    if len(named) != 1 or named[0] is None:
        many = " and ".join(str(name) for name in named) or "none"
        raise ValueError(
            f"one table is needed, {many} given; accepted: {', '.join(PAPER)}, --polar or --parametric, "
            f"{', '.join(GALLERY)}, --scene, --data"
        )
    name = named[0]
    values = dict(map(_shape_value, given))
    if file is not None:
        return _from_file(file, lam, values, K, shape, formula)
    law = UNIFORM if formula is None else _law(formula).formula
    own: dict[str, Any] = {n: values[n] for n in parameters_of_law(law) if n in values and name in BUILT}
    values = {n: text for n, text in values.items() if n not in own or n in _lengths(name)}  # one number for both
    if drawn is not None:
        for key in values:
            raise ValueError(f"--shape {key}: a table from a file of data has no shape parameter; leave it out")
        _fitting(drawn.name, (), shape)
        return Scene(drawn, lam=_contraction(lam), law=law, **own)
    if name in PAPER:
        if twice := [key for key in values if shape.get(key) is not None]:
            raise ValueError(f"--shape {twice[0]} is given, and --{twice[0]} {shape[twice[0]]} too; leave one out")
        shape = {**shape, **values}
    if K is not None and name != "egg":
        raise ValueError(f"{name}: --K = {K} is only for the egg; leave it out")
    numbers: dict[str, Any] = {
        key: parameter_text(f"--{key}", text) for key, text in _fitting(name, PAPER.get(name, ()), shape).items()
    }
    value = _contraction(lam)
    numbers |= {parameter: parameter_text(f"--shape {parameter}", text) for parameter, text in own.items()}
    if table in GALLERY:
        made, ranged = _of_gallery(table, values)
        return Scene(made, lam=value, law=law, **(numbers | ranged))
    if table:
        return Scene(table, lam=value, law=law, K=POINTS if K is None else K, **numbers)
    try:
        return Scene.of({name: polar or list(parametric or ()), "shape": values, "law": law, "lam": str(value)})
    except ValueError as error:
        raise ValueError(f"--{error}") from None


def _known(table: str | None, *others: Any, **shape: str | None) -> Scene:
    """The scene of the options. What needs SymPy to be read and proved is kept between runs, and read without it."""
    *said, file, given, drawn, formula = others
    if drawn is not None or (table in PAPER and formula is None):
        return scene(table, *others, **shape)
    content = None
    if file is not None:
        with suppress(OSError, UnicodeDecodeError):
            content = Path(file).read_text(encoding="utf-8")
    from numeric.lowering import cache

    key = (
        json.dumps([table, *said, file, content, given, formula, shape]),
        cache.sources("symbolic", "verification/app"),
    )
    kept = cache.read("scene", *key)
    if kept is not None:
        return Scene.proved(kept.decode())
    found = scene(table, *others, **shape)
    cache.write("scene", *key, found.text.encode())
    return found


def _law(formula: str) -> Law:
    try:
        return Law(formula)
    except ValueError as error:
        raise ValueError(f"--{error}") from None


def _shape_value(text: str) -> tuple[str, str]:
    """`NAME=VALUE`, or `NAME=VALUE:LOW..HIGH` with its range, as a pair."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip().isidentifier():
        raise ValueError(f"--shape {text!r} sets nothing; give NAME=VALUE such as b=1/10")
    return name.strip(), value.strip()


def parted(given: tuple[str, ...]) -> tuple[tuple[str, ...], str | None]:
    """What --shape sets, and what it varies: `[NAME=]LOW:HIGH` for a branch, `NAME=LOW:HIGH:N` for a sweep.

    >>> parted(("b=0.1:0..1/4", "c=0:1/8"))
    (('b=0.1:0..1/4',), 'c=0:1/8')
    """
    varied = [text for text in given if ":" in text and ".." not in text]
    if len(varied) > 1:
        raise ValueError(f"--shape {' and '.join(varied)}: two parameters vary; accepted: one, and a number for others")
    return tuple(text for text in given if text not in varied), next(iter(varied), None)


def _starting(given: tuple[str, ...], axis: str, known: set[str], by_name: bool) -> tuple[str, ...]:
    """What --shape sets, with the lower end for the parameter that varies where nothing else gives it a number.

    A length of a table `by_name` is a parameter because it varies: it is given the ends for its range.

    >>> _starting(("straight=2",), "straight=1:3:9", set(), True)
    ('straight=2:1..3',)
    """
    name, equals, ends = (part.strip() for part in axis.partition("="))
    if not equals:
        return given
    low, high = (*ends.split(":"), "")[:2]
    said = {text.partition("=")[0].strip(): text for text in given}
    if by_name and high not in ("", low) and ":" not in said.get(name, ""):
        said[name] = f"{said.get(name, f'{name}={low}')}:{low}..{high}"
    elif name not in known:
        said.setdefault(name, f"{name}={low}")
    return tuple(said.values())


def _from_file(
    file: str, lam: str | None, values: dict[str, str], K: int | None, shape: dict[str, Any], formula: str | None
) -> Scene:
    """The scene of a file; a law, a contraction and shape parameters on the command line come before its own."""
    for key, text in {"K": K, **shape}.items():
        if text is not None:
            raise ValueError(f"--{key} = {text} says what the file of --scene says; leave it out, or use --shape")
    try:
        found = Scene.load(file)
    except (OSError, UnicodeDecodeError) as reason:
        raise ValueError(f"--scene {file!r} cannot be read: {reason}") from None
    numbers = {name: parameter_text(f"--shape {name}", text) for name, text in values.items()}
    law = None if formula is None else _law(formula)
    return found.at(lam=None if lam is None else _contraction(lam), law=law, **numbers)


def _lengths(name: str) -> tuple[str, ...]:
    """The names of a built table's numbers, which for those of the gallery are lengths."""
    return tuple(signature(tables.GALLERY[name]).parameters) if name in GALLERY else PAPER.get(name, ())


def _of_gallery(name: str, values: dict[str, str]) -> "tuple[Table, dict[str, str]]":
    """One of the gallery's tables, with the lengths that were given; those with a range stay free, and have text."""
    from sympy import Interval, Symbol

    from symbolic.tables.table import Shape

    make, known = tables.GALLERY[name], _lengths(name)
    lengths: dict[str, Any] = {}
    ranged = {key: parameter_text(f"--shape {key}", text) for key, text in values.items() if ":" in text}
    for key, text in values.items():
        if key not in known:
            raise ValueError(f"{name}: --shape {key} is none of its lengths; accepted: {', '.join(known) or 'none'}")
        if key in ranged:
            ends = Interval(*range_ends(key, range_text(ranged[key])))
            lengths[key] = Shape(Symbol(key, real=True), ends, "is outside of the range that was given")
        else:
            lengths[key] = exact(f"--shape {key}", text)
    return make(**lengths), ranged


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


NAMED = (*PAPER, *GALLERY)
BUILT = (*NAMED, "data")  # whose --shape gives lengths; a formula's own parameters stand in its scene
Command = Callable[..., Any]
TABLE = (
    click.argument("table", required=False, type=click.Choice(NAMED)),
    click.option("--a", metavar="NUMBER", help="Half the major axis of the ellipse, at least 1."),
    click.option("--alpha", metavar="NUMBER", help="Shape of the egg, from 0 to 1/(1 + K^2)."),
    click.option("--K", "K", type=click.IntRange(2), metavar="INTEGER", help="Points of the egg; the paper's has 3."),
    click.option("--polar", metavar="FORMULA", help="Your own table: the radius, a formula in theta."),
    click.option("--parametric", nargs=2, metavar="X Y", help="Your own table: a closed curve in theta on [-pi, pi)."),
    click.option("--scene", "file", metavar="FILE", help="A scene file: any table, its shape, law and contraction."),
    click.option("--data", metavar="FILE", help="A measured table: points in CSV; or a drawn one: SVG or DXF."),
    click.option("--smoothness", type=click.IntRange(0, 2), help="Of the spline through the points of --data; or 2."),
    click.option("--degree", type=click.IntRange(1, 64), help="Of a Fourier sum near the points of --data, instead."),
    click.option("--law", metavar="FORMULA", help="The exit angle: a formula in eta, lam, theta, s; or else -lam*eta."),
)
SHAPE = click.option(
    "--shape",
    "given",
    multiple=True,
    metavar="NAME=VALUE",
    help="A parameter of your own table or law, NAME=VALUE or NAME=VALUE:LOW..HIGH with its range; or a length.",
)
CONTRACTION = click.option("--lam", metavar="NUMBER", help="Contraction of the angle, from 0 to 1.")


def table_options(command: Command, varies: bool = False, optional: bool = False) -> Command:
    """Gives `command` the arguments of a table, as a keyword `scene` whose `lam` is 0.

    Where a parameter `varies`, what --shape says of it is a keyword `axis`, None where lambda varies. Where a table is
    `optional`, the scene is None without one, and a keyword `bare` has --K, --alpha, --lam, --law.
    """

    @wraps(command)
    def called(
        table: str | None,
        polar: str | None,
        parametric: tuple[str, str] | None,
        K: int | None,
        a: str | None,
        alpha: str | None,
        file: str | None,
        data: str | None,
        smoothness: int | None,
        degree: int | None,
        lam: str | None = "0",
        given: tuple[str, ...] = (),
        law: str | None = None,
        **others: Any,
    ) -> Any:
        given, axis = parted(given)
        if varies:
            others["axis"] = axis
            if axis is not None and file is None:
                known = {key for key, text in (("a", a), ("alpha", alpha)) if text is not None}
                given = _starting(given, axis, known, table in GALLERY)
        elif axis is not None:
            raise ValueError(f"--shape {axis} varies a parameter; this command takes one number, as in b=1/10")
        if optional:
            others["bare"], lam = {"K": K, "alpha": alpha, "lam": lam, "law": law}, "0"
            if not (table or polar or parametric or file or data):
                for option, said in (("a", a), ("shape", axis or next(iter(given), None))):
                    if said is not None:
                        raise ValueError(f"--{option} {said} says something of a table, and none is given")
                return command(scene=None, **others)
        measured = None
        if data is not None or smoothness is not None or degree is not None:
            from verification.app.outline import drawn

            measured = drawn(data, smoothness, degree)
        options = table, polar, parametric, K, lam, file, given, measured, law
        return command(scene=_known(*options, a=a, alpha=alpha), **others)

    for option in reversed((*TABLE, SHAPE)):
        called = option(called)
    return called


def varied_options(command: Command) -> Command:
    """Gives `command` the arguments of a table with a parameter that varies, as keywords `scene` and `axis`."""
    return table_options(command, varies=True)


def optional_options(command: Command) -> Command:
    """The same where a table may be left out."""
    return table_options(command, varies=True, optional=True)


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


MOST = 1_000_000  # values of an axis


def span(label: str, text: str, low: Fraction | None = Fraction(0), high: Fraction | None = Fraction(1)) -> list[float]:
    """The numbers that `LOW:HIGH:N` says, equally spaced with both ends, or one number; each the nearest to the exact.

    >>> span("--lams", "0:0.3:4"), span("--lams", "1/2")
    ([0.0, 0.1, 0.2, 0.3], [0.5])
    """
    parts = text.split(":")
    if len(parts) == 1:
        parts = [text, text, "1"]
    if len(parts) != 3 or not (parts[2].isascii() and parts[2].isdigit() and 1 <= int(parts[2]) <= MOST):
        raise ValueError(f"{label} {text!r} is no range; accepted: LOW:HIGH:N such as 0:1:101, or one number")
    first, last = (Fraction(_rational(label, part)) for part in parts[:2])
    if first > last:
        raise ValueError(f"{label} {text!r} is no range; accepted: LOW:HIGH:N with LOW <= HIGH, or one number")
    if (low is not None and first < low) or (high is not None and last > high):
        raise ValueError(f"{label} {text!r} does not lie in order in [{low}, {high}]; accepted: numbers that do")
    steps = int(parts[2]) - 1
    return [float(first + (last - first) * Fraction(i, max(steps, 1))) for i in range(steps + 1)]


class Varied(NamedTuple):
    """What a sweep varies in a scene, as the sweep labels it: the parameter, its values, and the one contraction."""

    text: str
    parameter: str
    values: "NDArray[np.float64]"
    lam: float


def over(scene: Scene, lams: str, axis: str | None) -> Varied:
    """The contractions, or `NAME=LOW:HIGH:N` in their place; a bad shape is refused before anything runs."""
    import numpy as np

    from numeric.sweeps.sweep import map_of, text_of

    if axis is None:
        text, values = text_of(scene), np.array(span("--lams", lams))
        map_of(text, values)
        return Varied(text, "lam", values, float(values[0]))
    if ":" in lams:
        raise ValueError(f"--lams {lams} and --shape {axis} both vary; accepted: one number for --lams")
    lam = _contraction(lams)
    scene, parameter, values = along(scene.at(lam=lam), axis)
    text = text_of(scene)
    map_of(text, float(lam))
    return Varied(text, parameter, values, float(lam))


def along(scene: Scene, axis: str) -> "tuple[Scene, str, NDArray[np.float64]]":
    """The scene with the range that `NAME=LOW:HIGH:N` says, its parameter, and the values."""
    import numpy as np

    name, equals, ends = axis.partition("=")
    name, known = name.strip(), [*scene.shape, *dict(scene.law.numbers)]
    if not equals or name not in known:
        accepted = f"NAME=LOW:HIGH:N with one of {', '.join(known)}" if known else "--lams, as it has no parameter"
        raise ValueError(f"--shape {axis}: {name} is no parameter of {scene.name}; accepted: {accepted}")
    values = np.array(span(f"--shape {name}", ends, low=None, high=None))
    low, high = (str(_rational(f"--shape {name}", text)) for text in ends.split(":")[:2])
    try:
        return scene.at(**{name: f"{low}:{low}..{high}" if low != high else low}), name, values
    except ValueError as why:
        raise ValueError(f"--shape {axis}: {why}") from None


def _rational(label: str, text: str) -> Fraction:
    value = exact(label, text)
    return value if isinstance(value, Fraction) else Fraction(float(value))
