"""A scene: a table, its shape, a reflection law and a contraction; exact, and one line of text.

A scene is written down once and everything takes it. It holds text and fractions only, so that one of the
paper's tables is read, compared, hashed and sent to another machine without SymPy; `table` builds the exact
table when somebody asks for it. Paper: section 2.
"""

import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from symbolic.table import Table

PAPER = {"circle": (), "ellipse": ("a",), "cardioid": (), "cuspless": (), "egg": ("alpha",)}
POINTS = 3  # of the paper's egg
UNIFORM = "-lam*eta"  # the paper's law
PIECE = ("name", "x", "y", "from", "to")
KINDS = ("table", "polar", "parametric", "component")
BOUNDARY = ("name", *KINDS, "K", "undefined", "origin")
KEYS = (*BOUNDARY, "shape", "law", "lam")
PLAIN = re.compile(r"[+-]?(\d{1,99}/[1-9]\d{0,98}|(\d{1,99}\.?\d{0,99}|\.\d{1,99})([eE][+-]?\d{1,2})?)", re.ASCII)
WORD = re.compile(r"[A-Za-z][A-Za-z0-9_ -]{0,59}", re.ASCII)
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def exact(label: str, given: Any) -> "Fraction | Expr":
    """The exact real number that text, an integer, a fraction or an expression says; a plain one without SymPy.

    A decimal means the decimal it shows. A float is refused, because it is not the number it shows.

    >>> exact("alpha", "0.08"), exact("a", "sqrt(2)")
    (Fraction(2, 25), sqrt(2))
    """
    if isinstance(given, int | Fraction) and not isinstance(given, bool):
        return Fraction(given)
    if isinstance(given, str) and PLAIN.fullmatch(given):
        return Fraction(given)
    if isinstance(given, str):
        from symbolic.formula import number

        return number(given, label)
    from symbolic.table import exact_number

    value = exact_number(label, given)
    if not value.is_real:
        raise ValueError(f"{label} = {given} is no real number")
    return value


def exact_text(label: str, given: Any) -> str:
    """The same number as text, the same for every way to write it: `0.08` and `2/25` are `2/25`."""
    return str(exact(label, given))


@dataclass(frozen=True)
class Law:
    """A reflection law: the exit angle `phi` as a formula in the angle of incidence `eta` and `lam`.

    >>> Law().phi
    -eta*lam
    """

    formula: str = UNIFORM

    def __post_init__(self) -> None:
        if self.formula != UNIFORM:
            raise ValueError(
                f"law = {self.formula!r}; so far only the paper's uniform contraction, {UNIFORM}, is known"
            )

    @property
    def phi(self) -> "Expr":
        """The exit angle, exactly. Paper: section 2, `phi = -lambda*eta`."""
        from symbolic.formula import parse
        from symbolic.symbols import eta, lam

        return parse(self.formula, {"eta": eta, "lam": lam})

    def __str__(self) -> str:
        return self.formula


@dataclass(frozen=True, repr=False)
class Scene:
    """A table with numbers for its shape, a law and a contraction.

    `table` is an exact table, or the name of one of the paper's; shape parameters are keywords. Numbers are exact,
    or text, where a decimal means the decimal it shows.

    >>> egg = Scene("egg", alpha="0.08", lam="1/2")
    >>> egg
    Scene('egg', alpha='2/25', lam='1/2')
    >>> egg.text
    'scene = { table = "egg", shape = { alpha = "2/25" }, lam = "1/2" }'
    >>> Scene.parse(egg.text) == egg
    True
    >>> from symbolic import tables
    >>> Scene(tables.egg(3), alpha="2/25", lam="1/2") == egg
    True
    """

    text: str

    def __init__(
        self, table: "Table | str", *, lam: Any = 1, law: Law | str = UNIFORM, K: int = POINTS, **shape: Any
    ) -> None:
        boundary, fixed = _named(table, K) if isinstance(table, str) else _of_table(table)
        self._hold(boundary, {**fixed, **shape}, lam, law)

    def _hold(self, boundary: dict[str, Any], shape: Mapping[str, Any], lam: Any, law: Law | str) -> None:
        """Keeps the one line that says all of it; the same line for every way to write it."""
        name, letters = _name(boundary), _letters(boundary)
        for letter in shape:
            if letter not in letters:
                raise ValueError(f"{name}: no shape parameter {letter}; it has: {', '.join(letters) or 'none'}")
        for letter in letters:
            if letter not in shape:
                raise ValueError(f"{name}: the shape parameter {letter} needs a value, as in Scene(..., {letter}=...)")
        document = dict(boundary)
        if letters:
            document["shape"] = {letter: exact_text(f"{name}: {letter}", shape[letter]) for letter in letters}
        formula = (law if isinstance(law, Law) else Law(law)).formula
        if formula != UNIFORM:
            document["law"] = formula
        document["lam"] = _contraction(lam)
        object.__setattr__(self, "text", f"scene = {_toml(document)}")

    # ---- what it says

    @cached_property
    def document(self) -> dict[str, Any]:
        """The scene as plain data, for JSON and for a scene file."""
        said: dict[str, Any] = tomllib.loads(self.text)["scene"]
        return said

    @property
    def name(self) -> str:
        """The table's name: one of the paper's, the user's own, or `polar`, `parametric`, `piecewise`."""
        return _name(self.document)

    @property
    def K(self) -> int:
        """Points of the egg; 3 for every other table, where it means nothing."""
        return int(self.document.get("K", POINTS))

    @property
    def lam(self) -> "Fraction | Expr":
        """The contraction, exactly."""
        return exact("lam", self.document["lam"])

    @property
    def shape(self) -> "dict[str, Fraction | Expr]":
        """The numbers of the shape parameters, exactly."""
        return {name: exact(name, text) for name, text in self.document.get("shape", {}).items()}

    @property
    def law(self) -> Law:
        """The reflection law."""
        return Law(self.document.get("law", UNIFORM))

    @cached_property
    def table(self) -> "Table":
        """The exact table with its shape; `ValueError` when there is none."""
        return _built(self.document)

    def at(self, *, lam: Any = None, **shape: Any) -> "Scene":
        """The same scene with another contraction, or other numbers for its shape.

        >>> Scene("egg", alpha="0.08").at(lam="0.4", alpha="1/20")
        Scene('egg', alpha='1/20', lam='2/5')
        """
        other = object.__new__(Scene)
        boundary = {key: value for key, value in self.document.items() if key in BOUNDARY}
        numbers = {**self.document.get("shape", {}), **shape}
        other._hold(boundary, numbers, self.document["lam"] if lam is None else lam, self.law)
        return other

    # ---- text and back

    @classmethod
    def parse(cls, text: str) -> "Scene":
        """The scene that a line, or a scene file, says; `ValueError` names the entry that is wrong.

        >>> Scene.parse('table = "ellipse"\\nlam = "0.9"\\n[shape]\\na = "sqrt(2)"')
        Scene('ellipse', a='sqrt(2)', lam='9/10')
        """
        try:
            said = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise ValueError(f"scene: {error}") from None
        return cls.of(said["scene"] if set(said) == {"scene"} and isinstance(said["scene"], dict) else said)

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> "Scene":
        """The scene of a `document`.

        >>> Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}, "lam": "0.5"})
        Scene(polar='b*cos(5*theta) + 1', b='1/40', lam='1/2')
        """
        _known("scene", document, KEYS)
        kinds = [key for key in KINDS if key in document]
        if len(kinds) != 1:
            raise ValueError(
                f"scene: one table is needed, {' and '.join(kinds) or 'none'} given; accepted: {', '.join(KINDS)}"
            )
        shape = document.get("shape", {})
        if not isinstance(shape, Mapping):
            raise ValueError(f"scene: shape = {shape!r} is no table of numbers such as a = '3/2'")
        numbers = {_word("shape", letter): _number(f"shape.{letter}", value) for letter, value in shape.items()}
        other = object.__new__(cls)
        boundary = _read({key: document[key] for key in BOUNDARY if key in document}, tuple(numbers))
        law = _text("law", document.get("law", UNIFORM))
        other._hold(boundary, numbers, _number("lam", document.get("lam", "1")), law)
        return other

    @classmethod
    def load(cls, path: str | Path) -> "Scene":
        """The scene of a file."""
        return cls.parse(Path(path).read_text(encoding="utf-8"))

    def __repr__(self) -> str:
        said = self.document
        first = [repr(said["table"])] if "table" in said else []
        first += [f"{key}={said[key]!r}" for key in ("name", "polar", "parametric", "K") if key in said]
        first += [f"{len(said['component'])} components"] if "component" in said else []
        first += [f"{name}={text!r}" for name, text in said.get("shape", {}).items()]
        return f"Scene({', '.join([*first, *(f'{key}={said[key]!r}' for key in ('law', 'lam') if key in said)])})"

    def _repr_latex_(self) -> str:
        from symbolic.notation import latex

        return rf"$\displaystyle {latex(self.table)}, \quad \varphi = {latex(self.law.phi)}$"


# ---- the boundary, from a name, a table or a document


def _named(name: str, K: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """One of the paper's tables by its name."""
    if name not in PAPER:
        raise ValueError(f"no table is called {name!r}; the paper's are {', '.join(PAPER)}")
    if isinstance(K, bool) or not isinstance(K, int) or K < 2:
        raise ValueError(f"{name}: K = {K!r} is no number of points; K must be an integer of at least 2")
    if K != POINTS and name != "egg":
        raise ValueError(f"{name}: K = {K} is only for the egg; leave it out")
    return {"table": name} | ({"K": K} if K != POINTS else {}), {}


def _of_table(table: "Table") -> tuple[dict[str, Any], dict[str, Any]]:
    """What an exact table says; the paper's own are recognised, with the numbers that they hold already."""
    from sympy import cos, pi, sin

    from symbolic import tables
    from symbolic.symbols import theta

    held = dict(table.fixed)
    K = _points(table) if table.name == "egg" else POINTS
    if table.name in PAPER and tables.named(table.name, K).at(**held) == table:
        return _named(table.name, K)[0], held
    said: dict[str, Any] = {"name": table.name} if table.name not in ("polar", "parametric", "piecewise") else {}
    first = table.components[0]
    x, y = first.point
    if len(table.components) == 1 and (first.start, first.end) == (-pi, pi):
        rho = x / cos(theta)
        same = rho * sin(theta) == y
        said |= {"polar": str(rho)} if same else {"parametric": [str(x), str(y)]}
    else:
        values = [(p.name, *p.point, p.start, p.end) for p in table.components]
        said["component"] = [dict(zip(PIECE, map(str, row), strict=True)) for row in values]
    if table.undefined:
        said["undefined"] = [{"name": m.name, "component": m.component, "theta": str(m.theta)} for m in table.undefined]
    if table.origin != (0, 0):
        said["origin"] = {"component": table.origin[0], "theta": str(table.origin[1])}
    return said, {}


def _points(table: "Table") -> int:
    """`K` of an egg: the highest frequency of its boundary is `K + 1`."""
    from symbolic.fourier import boundary_coefficients

    waves = boundary_coefficients(table.components[0])
    return max(2, max(waves) - 1) if waves else POINTS


def _read(said: Mapping[str, Any], letters: tuple[str, ...]) -> dict[str, Any]:
    """A boundary as a document says it, each formula read and written again, so that equal ones are the same text."""
    if "table" in said:
        _known("scene with a named table", said, ("table", "K"))
        return _named(_text("table", said["table"]), said.get("K", POINTS))[0]
    found: dict[str, Any] = {"name": _word("name", said["name"])} if "name" in said else {}
    if "polar" in said:
        found["polar"] = _formula("polar", said["polar"], letters)
    elif "parametric" in said:
        if not isinstance(said["parametric"], list) or len(said["parametric"]) != 2:
            raise ValueError("scene: parametric needs two formulas, as in parametric = ['3*cos(theta)', 'sin(theta)']")
        found["parametric"] = [_formula("parametric", text, letters) for text in said["parametric"]]
    else:
        found["component"] = [_component(n, entry, letters) for n, entry in enumerate(_list("component", said), 1)]
    if "undefined" in said:
        found["undefined"] = [_mark(entry) for entry in _list("undefined", said)]
    if "origin" in said:
        _known("scene: origin", said["origin"], ("component", "theta"))
        found["origin"] = _place("origin", said["origin"])
    return found


def _component(n: int, entry: Any, letters: tuple[str, ...]) -> dict[str, str]:
    """One component: a name, two formulas in `theta`, and where `theta` begins and ends."""
    label = f"component {n}"
    _known(f"scene: {label}", entry, PIECE)
    for key in PIECE[1:]:
        if key not in entry:
            raise ValueError(f"scene: {label} has no {key}; it needs {', '.join(PIECE[1:])}")
    return {"name": _word(f"{label}: name", entry.get("name", f"component{n}"))} | {
        key: _formula(f"{label}: {key}", entry[key], letters) for key in PIECE[1:]
    }


def _mark(entry: Any) -> dict[str, Any]:
    """A boundary point where the map is undefined."""
    _known("scene: undefined", entry, ("name", "component", "theta"))
    return {"name": _word("undefined: name", entry.get("name"))} | _place("undefined", entry)


def _place(label: str, entry: Mapping[str, Any]) -> dict[str, Any]:
    """A component's index and a parameter there."""
    index = entry.get("component", 0)
    if isinstance(index, bool) or not isinstance(index, int) or index < 0:
        raise ValueError(f"scene: {label}: component = {index!r} is no index, counted from 0")
    return {"component": index, "theta": _formula(f"{label}: theta", entry.get("theta", "0"), ())}


def _formula(label: str, given: Any, letters: tuple[str, ...]) -> str:
    """A formula in `theta` and the shape's letters, as SymPy writes it."""
    text = str(given) if isinstance(given, int) and not isinstance(given, bool) else _text(label, given)
    return str(_parsed(label, text, letters))


def _parsed(label: str, text: str, letters: Iterable[str]) -> "Expr":
    from symbolic.formula import parse

    try:
        return parse(text, _symbols(letters))
    except ValueError as error:
        raise ValueError(f"{label}: {error}") from None


def _symbols(letters: Iterable[str]) -> "dict[str, Symbol]":
    """`theta`, and the shape's letters as real symbols."""
    from sympy import Symbol

    from symbolic.symbols import theta

    return {letter: Symbol(letter, real=True) for letter in letters} | {theta.name: theta}


def _built(document: Mapping[str, Any]) -> "Table":
    """The exact table that a document says, with its numbers."""
    from symbolic import tables
    from symbolic.table import Mark

    texts = document.get("shape", {})
    numbers = {letter: _expression(letter, text) for letter, text in texts.items()}
    if "table" in document:
        return tables.named(document["table"], document.get("K", POINTS)).at(**numbers)
    symbols = _symbols(texts)

    def formula(text: str) -> "Expr":
        return _parsed("scene", text, texts).subs({symbols[letter]: value for letter, value in numbers.items()})

    marks = [Mark(m["name"], m["component"], formula(m["theta"])) for m in document.get("undefined", ())]
    name = _name(document)
    if "polar" in document:
        return tables.polar(formula(document["polar"]), name, undefined=marks)
    if "parametric" in document:
        x, y = document["parametric"]
        return tables.parametric(formula(x), formula(y), name, undefined=marks)
    arcs = [tables.arc(p["name"], *(formula(p[key]) for key in PIECE[1:])) for p in document["component"]]
    start = document.get("origin", {"component": 0, "theta": "0"})
    origin = start["component"], formula(start["theta"])
    return tables.piecewise(*arcs, name=name, undefined=marks, origin=origin)


def _name(boundary: Mapping[str, Any]) -> str:
    kind = next((key for key in ("polar", "parametric") if key in boundary), "piecewise")
    return str(boundary.get("table") or boundary.get("name") or kind)


def _letters(boundary: Mapping[str, Any]) -> tuple[str, ...]:
    """The shape parameters of a boundary: the paper's, or the letters of the formulas other than `theta`."""
    if "table" in boundary:
        return PAPER[boundary["table"]]
    formulas = [boundary.get("polar", ""), *boundary.get("parametric", ())]
    formulas += [part[key] for part in boundary.get("component", ()) for key in PIECE[1:]]
    return tuple(sorted({name for text in formulas for name in NAME.findall(text)} - _vocabulary()))


def _vocabulary() -> set[str]:
    from symbolic.formula import CONSTANTS, FUNCTIONS

    return {*FUNCTIONS, *CONSTANTS, "theta"}


# ---- one entry at a time


def _contraction(given: Any) -> str:
    value = exact("lam", given)
    if not 0 <= value <= 1:
        raise ValueError(f"lam = {given} is no contraction; accepted: numbers in [0, 1]")
    return str(value)


def _expression(label: str, text: str) -> "Expr":
    from symbolic.formula import number

    return number(text, label)


def _known(label: str, entry: Any, keys: tuple[str, ...]) -> None:
    if not isinstance(entry, Mapping):
        raise ValueError(f"{label} is {entry!r}; it must be a table with the entries {', '.join(keys)}")
    for key in entry:
        if key not in keys:
            raise ValueError(f"{label}: the entry {key!r} is unknown; accepted: {', '.join(keys)}")


def _list(key: str, said: Mapping[str, Any]) -> list[Any]:
    if not isinstance(said[key], list) or not said[key]:
        raise ValueError(f"scene: {key} = {said[key]!r} is no list of tables; write [[{key}]] before each")
    return list(said[key])


def _text(label: str, given: Any) -> str:
    if not isinstance(given, str):
        raise ValueError(f"scene: {label} = {given!r} is no text; put it in quotation marks")
    return given


def _word(label: str, given: Any) -> str:
    if not isinstance(given, str) or not WORD.fullmatch(given):
        raise ValueError(f"scene: {label} = {given!r} is no name; accepted: letters, digits, '_', '-' and blanks")
    return given


def _number(label: str, given: Any) -> Any:
    """A number as text or as an integer; a TOML float is refused, because it is not the decimal that it shows."""
    if isinstance(given, float):
        raise ValueError(f"scene: {label} = {given} is a rounded float; put the decimal in quotation marks")
    if isinstance(given, bool) or not isinstance(given, int | str):
        raise ValueError(f"scene: {label} = {given!r} is no number; write it as text, such as '2/25' or '0.08'")
    return given


def _toml(value: Any) -> str:
    """Plain data on one line of TOML; its strings are JSON's, which TOML reads too."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value)
