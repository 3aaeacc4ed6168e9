"""Scenes from the options of a command line, and the options that commands share.

Table, shape and contraction are exact: a decimal stands for the number it shows. SymPy is not imported for the paper's
own tables. The options also give a starting point as exact numbers, and the axes of a sweep.
"""

import json
import re
import sys
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
from verification.app.cli import Whole, columns
from verification.app.lines import on_terminal

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
    corners: str | None = None,
    /,
    **shape: str | None,
) -> Scene:
    """The scene that the options describe; `ValueError` if they contradict each other.

    >>> scene("ellipse", None, None, None, "0.5", a="sqrt(2)")
    Scene('ellipse', a='sqrt(2)', lam='1/2')
    >>> scene("circle", None, None, None, "0.5", None, ("b=0.1",), None, "-lam*eta - b*sin(2*eta)")
    Scene('circle', b='1/10', law='-b*sin(2*eta) - eta*lam', lam='1/2')
    """
    options = (
        ("polar", polar),
        ("parametric", parametric),
        (table, table),
        ("scene", file),
        ("data", drawn),
        ("polygon", corners),
    )
    named = [name for name, said in options if said]
    if len(named) != 1 or named[0] is None:
        many = " and ".join(str(name) for name in named) or "none"
        raise ValueError(
            f"one table is needed, {many} given; accepted: {', '.join(PAPER)}, --polar or --parametric, "
            f"{', '.join(GALLERY)}, --scene, --data, --polygon"
        )
    name = named[0]
    values = dict(map(_shape_value, given))
    if file is not None:
        return _from_file(file, lam, values, K, shape, formula)
    law = UNIFORM if formula is None else _law(formula).formula
    if corners is not None:
        from verification.app.points import polygon_of

        name, drawn = "data", polygon_of(corners)
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
    """The scene of the options; a scene that needs SymPy is kept on disk, and later runs read it without SymPy."""
    *said, file, given, data, formula, corners = others
    if data is None and corners is None and table in PAPER and formula is None:
        return scene(table, *others, **shape)
    content = None
    if source := file if file is not None else data and data.path:
        with suppress(OSError):
            content = Path(source).read_bytes().hex() if Path(source).is_file() else None
    from numeric.lowering import cache

    key = (
        json.dumps([table, *said, file, content, given, formula, shape, data, corners]),
        cache.sources("symbolic", "verification/app"),
    )
    kept = cache.read("scene", *key)
    if kept is not None:
        text, *notes = kept.decode().split("\n")
        found = Scene.proved(text)
    else:
        outline, notes = None, []
        if data is not None:
            from verification.app.outline import read

            outline, notes = read(data)
        arguments = table, *said, file, given, outline, formula, corners
        found = scene(*arguments, **shape)
        cache.write("scene", *key, "\n".join([found.text, *notes]).encode())
    for note in notes:
        click.echo(on_terminal(f"{Path(data.path).name}: {note}", sys.stderr, columns()), err=True)
    return found


def _law(formula: str) -> Law:
    try:
        return Law(formula)
    except ValueError as error:
        raise ValueError(f"--{error}") from None


def _shape_value(text: str) -> tuple[str, str]:
    """Name and value of the text `NAME=VALUE`, or `NAME=VALUE:LOW..HIGH` with a range."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip().isidentifier():
        raise ValueError(f"--shape {text!r} sets nothing; give NAME=VALUE such as b=1/10")
    if ".." in value and ":" not in value:
        ranges = "NAME=VALUE:LOW..HIGH, and NAME=LOW:HIGH or NAME=LOW:HIGH:N where a parameter varies"
        raise ValueError(f"--shape {text} is no value; accepted: NAME=VALUE, {ranges}")
    return name.strip(), value.strip()


def parted(given: tuple[str, ...]) -> tuple[tuple[str, ...], str | None]:
    """The texts of --shape that set a parameter, and the text that varies one: `LOW:HIGH`, or `LOW:HIGH:N` in a sweep.

    >>> parted(("b=0.1:0..1/4", "c=0:1/8"))
    (('b=0.1:0..1/4',), 'c=0:1/8')
    """
    varied = [text for text in given if ":" in text and ".." not in text]
    if len(varied) > 1:
        raise ValueError(f"--shape {' and '.join(varied)}: two parameters vary; accepted: one, and a number for others")
    return tuple(text for text in given if text not in varied), next(iter(varied), None)


def _starting(given: tuple[str, ...], axis: str, known: set[str], by_name: bool) -> tuple[str, ...]:
    """The texts of --shape; the parameter that `axis` varies gets the lower end of its interval, if it has no number.

    With `by_name`, the parameter is a length of a table of the gallery; it also gets the interval as its range.

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
    """The scene in a file; a law, contraction or shape parameter on the command line replaces the file's."""
    for key, text in {"K": K, **shape}.items():
        if text is not None:
            raise ValueError(f"--{key} = {text} is already in the file of --scene; leave it out, or use --shape")
    found = Scene.load(file)
    numbers = {name: parameter_text(f"--shape {name}", text) for name, text in values.items()}
    law = None if formula is None else _law(formula)
    return found.at(lam=None if lam is None else _contraction(lam), law=law, **numbers)


def _lengths(name: str) -> tuple[str, ...]:
    """The names of a table's shape parameters; those of tables in the gallery are lengths."""
    return tuple(signature(tables.GALLERY[name]).parameters) if name in GALLERY else PAPER.get(name, ())


def _of_gallery(name: str, values: dict[str, str]) -> "tuple[Table, dict[str, str]]":
    """The gallery's table with the given lengths, and the texts of the lengths that have a range and stay free."""
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
    """The shape parameters that were given; `ValueError` unless they are those of the table."""
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
    if lam is None:
        raise ValueError("--lam is missing; accepted: numbers in [0, 1], as in --lam 1/2")
    value = exact("--lam", lam)
    if not 0 <= value <= 1:
        raise ValueError(f"--lam = {value} is no contraction; accepted: numbers in [0, 1]")
    return value


NAMED = (*PAPER, *GALLERY)
BUILT = (*NAMED, "data")  # whose --shape gives lengths; a formula's own parameters stand in its scene
Command = Callable[..., Any]
TABLE = (
    click.argument("table", required=False, type=click.Choice(NAMED)),
    click.option("--a", metavar="NUMBER", help="Half the major axis of the ellipse, at least 1."),
    click.option("--alpha", metavar="NUMBER", help="Shape of the egg, from 0 to 1/(1 + K^2)."),
    click.option("--K", "K", type=Whole(2), metavar="INTEGER", help="Points of the egg; the paper's has 3."),
    click.option("--polar", metavar="FORMULA", help="Your own table: the radius, a formula in theta."),
    click.option("--parametric", nargs=2, metavar="X Y", help="Your own table: a closed curve in theta on [-pi, pi)."),
    click.option("--scene", "file", metavar="FILE", help="A scene file: any table, its shape, law and contraction."),
    click.option("--polygon", metavar="X,Y ...", help="Your own table: the corners of a polygon, exact numbers."),
    click.option("--data", metavar="FILE", help="A table from points (CSV), GeoJSON, WKT, or a drawing (SVG, DXF)."),
    click.option(
        "--units", metavar="UNIT", help="Of lengths from a drawing: mm, cm, m, in, ... [default: the file's]."
    ),
    click.option("--layer", multiple=True, metavar="NAME", help="Read this layer of a drawing only."),
    click.option("--curve", multiple=True, type=Whole(1), metavar="N", help="Read this curve of a drawing only."),
    click.option("--smoothness", type=Whole(0, 2), help="Of the spline through the points of --data; or 2."),
    click.option("--degree", type=Whole(1, 64), help="Of a Fourier sum near the points of --data, instead."),
    click.option("--law", metavar="FORMULA", help="The exit angle: a formula in eta, lam, theta, s; or else -lam*eta."),
)
TOLERANCE = click.option(
    "--tolerance", metavar="T", help="In --data: gaps that are closed, joins made smooth [default: 1e-9 of it]."
)
SHAPE = click.option(
    "--shape",
    "given",
    multiple=True,
    metavar="NAME=VALUE",
    help="A parameter of your own table or law, NAME=VALUE or NAME=VALUE:LOW..HIGH with its range; or a length.",
)
CONTRACTION = click.option("--lam", metavar="NUMBER", help="Contraction of the angle, from 0 to 1.")


def table_options(command: Command, varies: bool = False, optional: bool = False, contracted: bool = False) -> Command:
    """Decorator that gives a command the arguments of a table as a keyword `scene`; its `lam` is 0 unless `contracted`.

    With `varies`, a keyword `axis` has the text of --shape for the parameter that varies, or None if lambda varies.
    With `optional`, the scene is None without a table, and a keyword `bare` has --K, --alpha, --lam, --law.
    """

    own = any(option.name == "tolerance" for option in getattr(command, "__click_params__", ()))

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
        polygon: str | None,
        units: str | None,
        layer: tuple[str, ...],
        curve: tuple[int, ...],
        tolerance: str | None = None,
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
            others["bare"] = {"K": K, "alpha": alpha, "lam": lam, "law": law}
            lam = lam if contracted else "0"
            if not (table or polar or parametric or file or data or polygon):
                for option, said in (("a", a), ("shape", axis or next(iter(given), None))):
                    if said is not None:
                        raise ValueError(f"--{option} {said} is for a table, and none is given")
                return command(scene=None, **others)
        reading = None
        if data is not None:
            from verification.app.outline import Data

            reading = Data(data, smoothness, degree, tolerance, units, layer, curve)
        for option, value in (("units", units), ("layer", "".join(layer[:1])), ("curve", "".join(map(str, curve[:1])))):
            if value and data is None:
                raise ValueError(
                    f"--{option} = {value} says how a drawing is read; give one with --data FILE.svg or .dxf"
                )
        for option, number in (("smoothness", smoothness), ("degree", degree)):
            if number is not None and data is None:
                said = "says how points are fitted; give a file of them with --data FILE.csv"
                raise ValueError(f"--{option} = {number} {said}")
        if tolerance is not None and data is None and not own:
            raise ValueError(
                f"--tolerance = {tolerance} is the largest gap that is closed in a file; give the file as --data FILE"
            )
        if own:
            others["tolerance"] = tolerance if data is None else None
        options = table, polar, parametric, K, lam, file, given, reading, law, polygon
        return command(scene=_known(*options, a=a, alpha=alpha), **others)

    for option in reversed((*TABLE, SHAPE) if own else (*TABLE, TOLERANCE, SHAPE)):
        called = option(called)
    return called


def varied_options(command: Command) -> Command:
    """Decorator that gives a command a table with a parameter that varies, as keywords `scene` and `axis`."""
    return table_options(command, varies=True)


def optional_options(command: Command) -> Command:
    """Decorator that gives a command a table with a parameter that varies; the table may be left out."""
    return table_options(command, varies=True, optional=True)


def optional_scene_options(command: Command) -> Command:
    """Decorator that gives a command the arguments of a scene, which may be left out."""
    return CONTRACTION(table_options(command, optional=True, contracted=True))


def scene_options(command: Command) -> Command:
    """Decorator that gives a command the arguments of a scene, as a keyword `scene`."""
    return CONTRACTION(table_options(command))


def start_of(text: str) -> tuple[Any, Any]:
    """The two exact numbers of the text `THETA,PHI`.

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
    """The numbers of `LOW:HIGH:N`, equally spaced with both ends, or one number; each is the double nearest to it.

    >>> span("--lams", "0:0.3:4"), span("--lams", "1/2")
    ([0.0, 0.1, 0.2, 0.3], [0.5])
    """
    parts = text.split(":")
    if len(parts) == 1:
        parts = [text, text, "1"]
    if len(parts) != 3 or not (re.fullmatch("[0-9]{1,9}", parts[2]) and 1 <= int(parts[2]) <= MOST):
        raise ValueError(f"{label} {text!r} is no range; accepted: LOW:HIGH:N such as 0:1:101, or one number")
    first, last = (Fraction(_rational(label, part)) for part in parts[:2])
    if first > last:
        raise ValueError(f"{label} {text!r} is no range; accepted: LOW:HIGH:N with LOW <= HIGH, or one number")
    if (low is not None and first < low) or (high is not None and last > high):
        raise ValueError(f"{label} {text!r} is not within [{low}, {high}]; accepted: numbers in this range")
    steps = int(parts[2]) - 1
    return [float(first + (last - first) * Fraction(i, max(steps, 1))) for i in range(steps + 1)]


class Varied(NamedTuple):
    """What a sweep varies: the scene as text, the parameter's name and values, and the contraction (if it is fixed)."""

    text: str
    parameter: str
    values: "NDArray[np.float64]"
    lam: float


def over(scene: Scene, lams: str, axis: str | None) -> Varied:
    """The parameter that a sweep varies, by --lams or `NAME=LOW:HIGH:N`; a bad shape is refused before any work."""
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
    """The scene with the range in `axis`, the text `NAME=LOW:HIGH:N`; the parameter's name; its N values."""
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
