"""Scenes as plain data: the boundary by a name, by formulas or by points, and every number exact.

Formulas and numbers are text here; `symbolic.tables.formula` parses them and executes nothing. A scene that has one of
the paper's tables and plain numbers is read without SymPy.
"""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from symbolic.tables.families import NAMES

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from symbolic.tables.table import Shape, Table

PAPER = {"circle": (), "ellipse": ("a",), "cardioid": (), "cuspless": (), "egg": ("alpha",)}
GALLERY = (  # tables of symbolic.tables.gallery and of families; each of their lengths has a default value
    "square", "triangle", "stadium", "reuleaux", "lemon", "semi_ellipse", "mushroom", "sinai", "diamond", *NAMES,
)  # fmt: skip
POINTS = 3  # default of K, the number of points of the egg
MOST = 4000  # largest number of components
UNIFORM = "-lam*eta"  # the paper's law
LAW_NAMES = ("eta", "lam", "theta", "s")  # the letters that every law may contain
RESERVED = frozenset({  # names in a formula that are functions or constants; all others are parameters
    "Abs", "E", "abs", "atan", "cos", "cosh", "exp", "log", "pi", "sin", "sinh", "sqrt", "tan", "tanh"
})  # fmt: skip
PIECE = ("name", "x", "y", "from", "to")
KINDS = ("table", "polar", "parametric", "support", "component", "points")
FIT = {
    "smoothness": 2,
    "degree": None,
    "by": "chord",
    "uncertainty": "0",
}  # default options of the fit, for a boundary that is given by points
BOUNDARY = ("name", *KINDS, *FIT, "K", "undefined", "origin")
KEYS = (*BOUNDARY, "shape", "law", "lam")
PLAIN = re.compile(r"[+-]?(\d{1,99}/[1-9]\d{0,98}|(\d{1,99}\.?\d{0,99}|\.\d{1,99})([eE][+-]?\d{1,2})?)", re.ASCII)
WORD = re.compile(r"[A-Za-z][A-Za-z0-9_ -]{0,59}", re.ASCII)
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


KEYWORDS = (  # of functions that take the numbers of a shape as further keywords
    "orbits", "bounces", "transient", "columns", "rows", "points", "values", "starts", "period", "up_to", "digits",
    "searches", "seed", "lam", "law",
)  # fmt: skip


def like(name: str, known: Iterable[str]) -> str:
    """Text such as `; did you mean stadium?` for the most similar known name; empty where none is similar.

    >>> like("stadum", GALLERY)
    '; did you mean stadium?'
    """
    from difflib import get_close_matches  # 1 ms, for a mistake only

    return "".join(f"; did you mean {each}?" for each in get_close_matches(name, list(known), 1))


def no_parameter(table: str, name: str, known: Iterable[str]) -> ValueError:
    """The error for a keyword that is no shape parameter of a table; it suggests a similar keyword of the package."""
    accepted = ", ".join(known) or "none"
    return ValueError(f"{table}: no shape parameter {name}; it has: {accepted}{like(name, KEYWORDS)}")


def exact(label: str, given: Any) -> "Fraction | Expr":
    """An exact real number from text, an integer, a fraction or an expression; a `Fraction` where SymPy is not needed.

    A decimal means the decimal it shows. A float is refused, since it is not exactly the decimal that it shows. Errors
    begin with `label`.

    >>> exact("alpha", "0.08"), exact("a", "sqrt(2)")
    (Fraction(2, 25), sqrt(2))
    """
    if isinstance(given, int | Fraction) and not isinstance(given, bool):
        return Fraction(given)
    if isinstance(given, str) and PLAIN.fullmatch(given):
        return Fraction(given)
    if isinstance(given, str):
        from symbolic.tables.formula import number

        return number(given, label)
    from symbolic.tables.table import exact_number

    value = exact_number(label, given)
    if not value.is_real:
        raise ValueError(f"{label} = {given} is no real number")
    return value


def exact_text(label: str, given: Any) -> str:
    """The number of `exact` as text, in one form for every way to write it: `0.08` and `2/25` both give `2/25`."""
    return str(exact(label, given))


def parameter_text(label: str, given: Any) -> str:
    """A parameter as exact text: its value, or `VALUE:LOW..HIGH`, the value and the range of the parameter.

    >>> parameter_text("b", "0.1"), parameter_text("b", "0.1:0..0.25")
    ('1/10', '1/10:0..1/4')
    """
    if not isinstance(given, str) or ":" not in given:
        return exact_text(label, given)
    value, _, ends = given.partition(":")
    low, dots, high = (part.strip() for part in ends.partition(".."))
    if not (value.strip() and low and dots and high):
        raise ValueError(f"{label} = {given} is no value with its range; accepted: VALUE:LOW..HIGH such as 0.1:0..1/4")
    middle, first, last = (exact(label, part) for part in (value.strip(), low, high))
    if not first < last:
        raise ValueError(f"{label} = {given}: {low}..{high} is no range; accepted: LOW..HIGH with LOW < HIGH")
    if not first <= middle <= last:
        raise ValueError(f"{label} = {middle} lies outside of its range {first}..{last}")
    return f"{middle}:{first}..{last}"


def value_text(text: str) -> str:
    """The value of a parameter, from `parameter_text`."""
    return text.partition(":")[0]


def range_text(text: str) -> str:
    """The range of a parameter as `LOW..HIGH`; empty where it has none."""
    return text.partition(":")[2]


def range_ends(label: str, text: str) -> "tuple[Fraction | Expr, Fraction | Expr]":
    """The two ends of a range written as `LOW..HIGH`, as exact numbers."""
    low, _, high = text.partition("..")
    return exact(label, low), exact(label, high)


# ---- the boundary, from a name, a table or a document


def named_boundary(name: str, K: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """The entries of a scene for a table of the paper; and an empty dict, for values of its shape parameters."""
    if name not in PAPER:
        known = (*PAPER, *GALLERY)
        raise ValueError(f"no table is called {name!r}; accepted: {', '.join(known)}{like(name, known)}")
    if isinstance(K, bool) or not isinstance(K, int) or K < 2:
        raise ValueError(f"{name}: K = {K!r} is no number of points; K must be an integer of at least 2")
    if K != POINTS and name != "egg":
        raise ValueError(f"{name}: K = {K} is only for the egg; leave it out")
    return {"table": name} | ({"K": K} if K != POINTS else {}), {}


def table_boundary(table: "Table") -> tuple[dict[str, Any], dict[str, Any]]:
    """The entries of a scene for an exact table, and the shape values that it holds (for the paper's tables only)."""
    from sympy import pi

    from symbolic import tables

    held = dict(table.fixed)
    K = _points(table) if table.name == "egg" else POINTS
    if table.name in PAPER and tables.named(table.name, K).at(**held) == table:
        return named_boundary(table.name, K)[0], held
    said: dict[str, Any] = {"name": table.name} if table.name not in ("polar", "parametric", "piecewise") else {}
    first = table.components[0]
    x, y = first.point
    if table.fit is not None:
        return _fit_entries(table), {}
    if len(table.components) == 1 and (first.start, first.end) == (-pi, pi):
        rho = first.radius
        said |= {"parametric": [str(x), str(y)]} if rho is None else {"polar": str(rho)}
    else:
        values = [(p.name, *p.point, p.start, p.end) for p in table.components]
        said["component"] = [dict(zip(PIECE, map(str, row), strict=True)) for row in values]
    if table.undefined:
        said["undefined"] = [{"name": m.name, "component": m.component, "theta": str(m.theta)} for m in table.undefined]
    if table.origin != (0, 0):
        said["origin"] = {"component": table.origin[0], "theta": str(table.origin[1])}
    return said, {}


def _fit_entries(table: "Table") -> dict[str, Any]:
    """The entries for a fitted table: its points, and the options of the fit that differ from the defaults in `FIT`."""
    fit = table.fit
    assert fit is not None
    said: dict[str, Any] = {"name": table.name} if table.name != "measured" else {}
    said["points"] = [[str(x), str(y)] for x, y in fit.points]
    given = {"smoothness": fit.smoothness, "degree": fit.degree, "by": fit.by, "uncertainty": str(fit.uncertainty)}
    return said | {key: value for key, value in given.items() if value not in (None, FIT[key])}


def _fitted(said: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a fitted table, as in `_fit_entries`, from a document that gives the boundary by points."""
    rows = said["points"]
    if not isinstance(rows, list) or not all(isinstance(row, list) and len(row) == 2 for row in rows):
        raise ValueError("scene: points must be a list of pairs of numbers, as in points = [['1', '0'], ['0', '0.5']]")
    found: dict[str, Any] = {"points": []}
    for i, row in enumerate(rows, 1):
        found["points"].append([exact_text(f"point {i}", number_entry(f"point {i}", value)) for value in row])
    given = {key: said[key] for key in FIT if key in said}
    if "uncertainty" in given:
        given["uncertainty"] = exact_text("uncertainty", number_entry("uncertainty", given["uncertainty"]))
    return found | {key: value for key, value in given.items() if value != FIT[key]}


def _points(table: "Table") -> int:
    """`K` of an egg: the highest frequency of its boundary is `K + 1`."""
    from symbolic.tables.geometry import boundary_coefficients

    waves = boundary_coefficients(table.components[0])
    return max(2, max(waves) - 1) if waves else POINTS


def boundary_of(said: Mapping[str, Any], parameters: tuple[str, ...]) -> dict[str, Any]:
    """The checked entries of a document's boundary; formulas are parsed and printed, so that equal ones look equal."""
    if "table" in said:
        known_entries("scene with a named table", said, ("table", "K"))
        return named_boundary(text_entry("table", said["table"]), said.get("K", POINTS))[0]
    found: dict[str, Any] = {"name": word_entry("name", said["name"])} if "name" in said else {}
    more = tuple(FIT) if "points" in said else ("undefined", "origin")
    known_entries("scene", {key: said[key] for key in BOUNDARY if key in said}, ("name", *KINDS, *more))
    if "polar" in said:
        found["polar"] = _formula("polar", said["polar"], parameters)
    elif "points" in said:
        found |= _fitted(said)
    elif "parametric" in said:
        if not isinstance(said["parametric"], list) or len(said["parametric"]) != 2:
            raise ValueError("scene: parametric needs two formulas, as in parametric = ['3*cos(theta)', 'sin(theta)']")
        found["parametric"] = [_formula("parametric", text, parameters) for text in said["parametric"]]
    elif "support" in said:
        from symbolic.tables.gallery import supported

        h = _parsed("support", text_entry("support", said["support"]), parameters)
        found["parametric"] = [str(coordinate) for coordinate in supported(h)]
    else:
        if len(_list("component", said)) > MOST:
            raise ValueError(f"scene: {len(said['component'])} components are given; accepted: up to {MOST}")
        found["component"] = [_component(n, entry, parameters) for n, entry in enumerate(_list("component", said), 1)]
    count = len(found["component"]) if "component" in found else 1
    if "undefined" in said:
        found["undefined"] = [_mark(entry, count) for entry in _list("undefined", said)]
    if "origin" in said:
        known_entries("scene: origin", said["origin"], ("component", "theta"))
        found["origin"] = _place("origin", said["origin"], count)
    return found


def _component(n: int, entry: Any, parameters: tuple[str, ...]) -> dict[str, Any]:
    """The checked entry of one component: name, formulas `x` and `y`, ends of `theta`, and `hole` if it bounds one."""
    label = f"component {n}"
    known_entries(f"scene: {label}", entry, (*PIECE, "hole"))
    if not isinstance(entry.get("hole", False), bool):
        raise ValueError(f"scene: {label}: hole = {entry['hole']!r}; accepted: true, false")
    for key in PIECE[1:]:
        if key not in entry:
            raise ValueError(f"scene: {label} has no {key}; it needs {', '.join(PIECE[1:])}")
    return (
        {"name": word_entry(f"{label}: name", entry.get("name", f"component{n}"))}
        | {key: _formula(f"{label}: {key}", entry[key], parameters) for key in PIECE[1:]}
        | ({"hole": True} if entry.get("hole") else {})
    )


def _mark(entry: Any, count: int) -> dict[str, Any]:
    """The checked entry of a boundary point where the map is undefined."""
    known_entries("scene: undefined", entry, ("name", "component", "theta"))
    return {"name": word_entry("undefined: name", entry.get("name"))} | _place("undefined", entry, count)


def _place(label: str, entry: Mapping[str, Any], count: int) -> dict[str, Any]:
    """The checked index of one of `count` components, and a parameter `theta` on it; errors begin with `label`."""
    index = entry.get("component", 0)
    if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < count:
        raise ValueError(f"scene: {label}: component = {index!r} is no index, counted from 0 to {count - 1}")
    return {"component": index, "theta": _formula(f"{label}: theta", entry.get("theta", "0"), ())}


def _formula(label: str, given: Any, parameters: tuple[str, ...]) -> str:
    """A formula in `theta` and the shape's parameters, as SymPy writes it."""
    text = str(given) if isinstance(given, int) and not isinstance(given, bool) else text_entry(label, given)
    return str(_parsed(label, text, parameters))


def _parsed(label: str, text: str, parameters: Iterable[str]) -> "Expr":
    from symbolic.tables.formula import parse

    try:
        return parse(text, _symbols(parameters))
    except ValueError as error:
        raise ValueError(f"{label}: {error}") from None


def _symbols(parameters: Iterable[str]) -> "dict[str, Symbol]":
    """`theta` and the shape's parameters as real symbols, by name."""
    from sympy import Symbol

    from symbolic.tables.table import theta

    return {parameter: Symbol(parameter, real=True) for parameter in parameters} | {theta.name: theta}


def built(document: Mapping[str, Any], free: "Sequence[Shape]" = ()) -> "Table":
    """The exact table of a document, with the numbers of its shape; the shape parameters in `free` stay symbols."""
    from symbolic import tables
    from symbolic.tables.curves import curves
    from symbolic.tables.table import Mark

    texts = {parameter: document["shape"][parameter] for parameter in parameters_of(document)}
    left = {each.symbol.name for each in free}
    numbers = {key: _expression(key, value_text(text)) for key, text in texts.items() if key not in left}
    if "table" in document:
        return tables.named(document["table"], document.get("K", POINTS)).at(**numbers)
    if "points" in document:
        given = {key: document[key] for key in FIT if key in document}
        return tables.from_points(document["points"], name_of(document), **given)
    symbols = _symbols(texts)

    def formula(text: str) -> "Expr":
        values = {symbols[parameter]: value for parameter, value in numbers.items()}
        return _parsed("scene", text, texts).subs(values | {symbols[each.symbol.name]: each.symbol for each in free})

    marks = [Mark(m["name"], m["component"], formula(m["theta"])) for m in document.get("undefined", ())]
    start = document.get("origin", {"component": 0, "theta": "0"})
    name, origin = name_of(document), (start["component"], formula(start["theta"]))
    if "polar" in document:
        return replace(tables.polar(formula(document["polar"]), name, free, marks), origin=origin)
    if "parametric" in document:
        x, y = map(formula, document["parametric"])
        return replace(tables.parametric(x, y, name, free, marks), origin=origin)
    arcs = [tables.arc(p["name"], *(formula(p[key]) for key in PIECE[1:])) for p in document["component"]]
    table = tables.piecewise(*arcs, name=name, shapes=free, undefined=marks, origin=origin)
    outer = curves(table)[0]
    for n, part in enumerate(document["component"][: len(outer)], 1):
        if part.get("hole"):
            raise ValueError(f"scene: component {n}: hole = true; the first closed curve is the outer one and no hole")
    return table


def name_of(boundary: Mapping[str, Any]) -> str:
    """The name of a boundary: the paper's, the user's own, or `polar`, `parametric`, `piecewise` or `measured`."""
    kind = next((key for key in ("polar", "parametric") if key in boundary), "piecewise")
    kind = "measured" if "points" in boundary else kind
    return str(boundary.get("table") or boundary.get("name") or kind)


def parameters_of(boundary: Mapping[str, Any]) -> tuple[str, ...]:
    """The shape parameters of a boundary: the paper's, or the names in the formulas other than `theta`."""
    if "table" in boundary:
        return PAPER[boundary["table"]]
    formulas = [boundary.get("polar", ""), *boundary.get("parametric", ())]
    formulas += [part[key] for part in boundary.get("component", ()) for key in PIECE[1:]]
    return tuple(sorted(words_of(formulas) - {"theta"}))


def words_of(formulas: Iterable[str]) -> set[str]:
    """The names in formulas that stand for neither a function nor a constant."""
    return {name for text in formulas for name in NAME.findall(text)} - RESERVED


# ---- one entry at a time


def contraction_text(given: Any) -> str:
    """A contraction as exact text; it must lie in [0, 1]."""
    value = exact("lam", given)
    if not 0 <= value <= 1:
        raise ValueError(f"lam = {given} is no contraction; accepted: numbers in [0, 1]")
    return str(value)


def _expression(label: str, text: str) -> "Expr":
    from symbolic.tables.formula import number

    return number(text, label)


def known_entries(label: str, entry: Any, keys: tuple[str, ...]) -> None:
    """Raises `ValueError` unless `entry` is a mapping with no other keys than `keys`; errors begin with `label`."""
    if not isinstance(entry, Mapping):
        raise ValueError(f"{label} is {entry!r}; it must be a table with the entries {', '.join(keys)}")
    for key in entry:
        if key not in keys:
            raise ValueError(f"{label}: the entry {key!r} is unknown; accepted: {', '.join(keys)}")


def _list(key: str, said: Mapping[str, Any]) -> list[Any]:
    if not isinstance(said[key], list) or not said[key]:
        raise ValueError(f"scene: {key} = {said[key]!r} is no list of tables; write [[{key}]] before each")
    return list(said[key])


def text_entry(label: str, given: Any) -> str:
    """`given`, which must be text; otherwise `ValueError`."""
    if not isinstance(given, str):
        raise ValueError(f"scene: {label} = {given!r} is no text; put it in quotation marks")
    return given


def word_entry(label: str, given: Any) -> str:
    """`given`, which must be a name (letters, digits, `_`, `-` and blanks); otherwise `ValueError`."""
    if not isinstance(given, str) or not WORD.fullmatch(given):
        raise ValueError(f"scene: {label} = {given!r} is no name; accepted: letters, digits, '_', '-' and blanks")
    return given


def number_entry(label: str, given: Any) -> Any:
    """`given`, if text or an integer, else `ValueError`: a TOML float is not the decimal that it shows."""
    if isinstance(given, float):
        raise ValueError(f"scene: {label} = {given} is a rounded float; put the decimal in quotation marks")
    if isinstance(given, bool) or not isinstance(given, int | str):
        raise ValueError(f"scene: {label} = {given!r} is no number; write it as text, such as '2/25' or '0.08'")
    return given


def toml(value: Any) -> str:
    """Plain data (mappings, lists, text, numbers) on one line of TOML; strings are written as in JSON."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value)
