"""A scene: a table, its shape, a reflection law and a contraction; exact, and one line of text.

A scene is written down once and everything takes it. It holds text and fractions only, so that one of the
paper's tables is read, compared, hashed and sent to another machine without SymPy; `table` builds the exact
table when somebody asks for it. Paper: section 2.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from symbolic.tables.definition import (
    BOUNDARY,
    KEYS,
    KINDS,
    POINTS,
    UNIFORM,
    boundary_of,
    built,
    contraction_text,
    exact,
    exact_text,
    known_entries,
    letters_of,
    name_of,
    named_boundary,
    number_entry,
    table_boundary,
    text_entry,
    toml,
    word_entry,
)
from symbolic.tables.law import Law as Law
from symbolic.tables.law import letters_of_law

if TYPE_CHECKING:
    from pathlib import Path

    from sympy import Expr

    from symbolic.tables.table import Table


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
        boundary, fixed = named_boundary(table, K) if isinstance(table, str) else table_boundary(table)
        self._hold(boundary, {**fixed, **shape}, lam, law)

    def _hold(self, boundary: dict[str, Any], shape: Mapping[str, Any], lam: Any, law: Law | str) -> None:
        """Keeps the one line that says all of it; the same line for every way to write it."""
        name, law = name_of(boundary), law if isinstance(law, Law) else Law(law)
        letters = tuple(dict.fromkeys((*letters_of(boundary), *letters_of_law(law.formula))))
        shape = {**dict(law.numbers), **shape}
        for letter in shape:
            if letter not in letters:
                raise ValueError(f"{name}: no shape parameter {letter}; it has: {', '.join(letters) or 'none'}")
        for letter in letters:
            if letter not in shape:
                raise ValueError(f"{name}: the shape parameter {letter} needs a value, as in Scene(..., {letter}=...)")
        document = dict(boundary)
        if letters:
            document["shape"] = {letter: exact_text(f"{name}: {letter}", shape[letter]) for letter in letters}
        if not law.uniform:
            document["law"] = law.formula
        document["lam"] = contraction_text(lam)
        object.__setattr__(self, "text", f"scene = {toml(document)}")
        if not law.uniform:
            law = self.law
            law.check((self.lam, self.lam), law.places(self.table) if law.placed else None)

    # ---- what it says

    @cached_property
    def document(self) -> dict[str, Any]:
        """The scene as plain data, for JSON and for a scene file."""
        import tomllib

        said: dict[str, Any] = tomllib.loads(self.text)["scene"]
        return said

    @property
    def name(self) -> str:
        """The table's name: one of the paper's, the user's own, or `polar`, `parametric`, `piecewise`."""
        return name_of(self.document)

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
        """The numbers of the table's shape parameters, exactly."""
        return {name: exact(name, self.document["shape"][name]) for name in letters_of(self.document)}

    @property
    def law(self) -> Law:
        """The reflection law, with the numbers of its own parameters."""
        formula = self.document.get("law", UNIFORM)
        return Law(formula).at(**{name: self.document["shape"][name] for name in letters_of_law(formula)})

    @property
    def boundary(self) -> str:
        """The table with the numbers of its shape, as one line of text: the same for every law and contraction."""
        said = {key: value for key, value in self.document.items() if key in BOUNDARY}
        return toml(said | {"shape": {name: self.document["shape"][name] for name in letters_of(self.document)}})

    @cached_property
    def table(self) -> "Table":
        """The exact table with its shape; `ValueError` when there is none."""
        return built(self.document)

    def over(self, parameter: str, low: Any, high: Any) -> "Table":
        """The table with one of its shape parameters left free, looked at from `low` to `high`.

        `ValueError` with a value at which it is no table. A table given by its radius is proved for every value of the
        interval; any other one is proved at its ends and at seven values between.

        >>> flower = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}})
        >>> flower.over("b", 0, "1/30").shapes[0].range
        Interval(0, 1/30)
        """
        from sympy import Interval, Symbol

        from symbolic.tables.table import Shape
        from symbolic.tables.validity import radius_over

        if parameter not in self.shape:
            accepted = ", ".join(self.shape) or "none"
            raise ValueError(f"{self.name}: no shape parameter {parameter}; it has: {accepted}")
        ends = [exact(parameter, end) for end in (low, high)]
        free = Shape(Symbol(parameter, real=True), Interval(*ends), "is outside of what was looked at")
        table = built(self.document, (free,))
        proved = "table" in self.document or ("polar" in self.document and radius_over(table))
        for share in (0, 8) if proved else range(9):
            value = ends[0] + (ends[1] - ends[0]) * share / 8
            there: dict[str, Any] = {parameter: value}
            try:
                built(self.at(**there).document)
            except ValueError as why:  # the paper's tables name the value themselves
                raise ValueError(str(why) if "table" in self.document else f"{parameter} = {value}: {why}") from None
        return table

    def at(self, *, lam: Any = None, law: Law | str | None = None, **shape: Any) -> "Scene":
        """The same scene with another contraction or law, or other numbers for its shape.

        >>> Scene("egg", alpha="0.08").at(lam="0.4", alpha="1/20")
        Scene('egg', alpha='1/20', lam='2/5')
        """
        other = object.__new__(Scene)
        boundary = {key: value for key, value in self.document.items() if key in BOUNDARY}
        law, own = (Law(self.law.formula), self.law.numbers) if law is None else (law, ())
        numbers = {**self.shape, **dict(own), **shape}
        other._hold(boundary, numbers, self.document["lam"] if lam is None else lam, law)
        return other

    # ---- text and back

    @classmethod
    def parse(cls, text: str) -> "Scene":
        """The scene that a line, or a scene file, says; `ValueError` names the entry that is wrong.

        >>> Scene.parse('table = "ellipse"\\nlam = "0.9"\\n[shape]\\na = "sqrt(2)"')
        Scene('ellipse', a='sqrt(2)', lam='9/10')
        """
        import tomllib

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
        known_entries("scene", document, KEYS)
        kinds = [key for key in KINDS if key in document]
        if len(kinds) != 1:
            raise ValueError(
                f"scene: one table is needed, {' and '.join(kinds) or 'none'} given; accepted: {', '.join(KINDS)}"
            )
        shape = document.get("shape", {})
        if not isinstance(shape, Mapping):
            raise ValueError(f"scene: shape = {shape!r} is no table of numbers such as a = '3/2'")
        numbers = {
            word_entry("shape", letter): number_entry(f"shape.{letter}", value) for letter, value in shape.items()
        }
        other = object.__new__(cls)
        boundary = boundary_of({key: document[key] for key in BOUNDARY if key in document}, tuple(numbers))
        law = text_entry("law", document.get("law", UNIFORM))
        other._hold(boundary, numbers, number_entry("lam", document.get("lam", "1")), law)
        return other

    @classmethod
    def proved(cls, text: str) -> "Scene":
        """The scene whose own `text` this is; what was proved when it was made is not proved again."""
        other = object.__new__(cls)
        object.__setattr__(other, "text", text)
        return other

    @classmethod
    def load(cls, path: "str | Path") -> "Scene":
        """The scene of a file."""
        from pathlib import Path  # with tomllib a tenth of a warm start, which needs neither

        return cls.parse(Path(path).read_text(encoding="utf-8"))

    def __repr__(self) -> str:
        said = self.document
        first = [repr(said["table"])] if "table" in said else []
        first += [f"{key}={said[key]!r}" for key in ("name", "polar", "parametric", "K") if key in said]
        first += [f"{len(said['component'])} components"] if "component" in said else []
        first += [f"{len(said['points'])} points"] if "points" in said else []
        first += [f"{name}={text!r}" for name, text in said.get("shape", {}).items()]
        return f"Scene({', '.join([*first, *(f'{key}={said[key]!r}' for key in ('law', 'lam') if key in said)])})"

    def _repr_latex_(self) -> str:
        from symbolic.tables.table import latex

        return rf"$\displaystyle {latex(self.table)}, \quad \varphi = {latex(self.law.phi)}$"
