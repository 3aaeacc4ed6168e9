"""A scene: a table, its shape, a reflection law and a contraction; exact, and one line of text.

A scene is written down once and everything takes it. It holds text and fractions only, so that one of the
paper's tables is read, compared, hashed and sent to another machine without SymPy; `table` builds the exact
table when somebody asks for it. Paper: section 2.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import product
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
    known_entries,
    name_of,
    named_boundary,
    number_entry,
    parameter_text,
    parameters_of,
    range_ends,
    range_text,
    table_boundary,
    text_entry,
    toml,
    value_text,
    word_entry,
)
from symbolic.tables.definition import GALLERY as GALLERY
from symbolic.tables.definition import exact_text as exact_text
from symbolic.tables.law import Law as Law
from symbolic.tables.law import parameters_of_law

if TYPE_CHECKING:
    from pathlib import Path

    from sympy import Expr

    from symbolic.tables.table import Table


@dataclass(frozen=True, repr=False)
class Scene:
    """A table with numbers for its shape, a law and a contraction.

    `table` is an exact table, or the name of one of the paper's; shape parameters are keywords. Numbers are exact,
    or text, where a decimal means the decimal it shows. A parameter may have a range, `b="0.1:0..1/4"`, over which the
    boundary is proved to be a table (as far as `over` says), and a law to be one.

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
        ranges = _own_ranges(table) if not isinstance(table, str) and "table" not in boundary else {}
        self._hold(boundary, {**fixed, **_with_ranges(shape, ranges)}, lam, law)

    def _hold(self, boundary: dict[str, Any], shape: Mapping[str, Any], lam: Any, law: Law | str) -> None:
        """Keeps the one line that says all of it; the same line for every way to write it."""
        name, law = name_of(boundary), law if isinstance(law, Law) else Law(law)
        parameters = tuple(dict.fromkeys((*parameters_of(boundary), *parameters_of_law(law.formula))))
        _one_number(name, law, parameters_of(boundary), shape)
        shape = {**dict(law.numbers), **shape}
        for parameter in shape:
            if parameter not in parameters:
                raise ValueError(f"{name}: no shape parameter {parameter}; it has: {', '.join(parameters) or 'none'}")
        for parameter in parameters:
            if parameter not in shape:
                raise ValueError(
                    f"{name}: the shape parameter {parameter} needs a value, as in Scene(..., {parameter}=...)"
                )
        document = dict(boundary)
        if parameters:
            document["shape"] = {
                parameter: parameter_text(f"{name}: {parameter}", shape[parameter]) for parameter in parameters
            }
        if not law.uniform:
            document["law"] = law.formula
        document["lam"] = contraction_text(lam)
        object.__setattr__(self, "text", f"scene = {toml(document)}")
        if self.family_text:
            _family(self.family_text)
        if not law.uniform:
            own, law = parameters_of_law(law.formula), self.law
            ranges = {parameter: ends for parameter, ends in self.ranges.items() if parameter in own}
            free = Law(law.formula, tuple(pair for pair in law.numbers if pair[0] not in ranges))
            free.check((self.lam, self.lam), *(free.places(self.table) if free.placed else ()), **ranges)

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
        return {name: exact(name, value_text(self.document["shape"][name])) for name in parameters_of(self.document)}

    @property
    def ranges(self) -> "dict[str, tuple[Fraction | Expr, Fraction | Expr]]":
        """The ends of the range of each parameter that has one, the table's and the law's own.

        >>> Scene.of({"polar": "1 + b*cos(theta)", "shape": {"b": "0.1:0..1/4"}}).ranges
        {'b': (Fraction(0, 1), Fraction(1, 4))}
        """
        given = {name: range_text(text) for name, text in self.document.get("shape", {}).items()}
        return {name: range_ends(name, ends) for name, ends in given.items() if ends}

    @property
    def law(self) -> Law:
        """The reflection law, with the numbers of its own parameters."""
        formula = self.document.get("law", UNIFORM)
        return Law(formula).at(
            **{name: value_text(self.document["shape"][name]) for name in parameters_of_law(formula)}
        )

    @property
    def boundary(self) -> str:
        """The table with the numbers of its shape, as one line of text: the same for every law and contraction."""
        said = {key: value for key, value in self.document.items() if key in BOUNDARY}
        shape = {name: value_text(self.document["shape"][name]) for name in parameters_of(self.document)}
        return toml(said | {"shape": shape})

    @cached_property
    def table(self) -> "Table":
        """The exact table with its shape; `ValueError` when there is none."""
        return built(self.document)

    @cached_property
    def family_text(self) -> str:
        """The boundary with the ranges of its parameters in the place of their values; nothing where none has one."""
        shape = {parameter: self.document["shape"][parameter] for parameter in parameters_of(self.document)}
        if not any(map(range_text, shape.values())):
            return ""
        return self._with({parameter: range_text(text) or text for parameter, text in shape.items()})

    def _with(self, shape: Mapping[str, str]) -> str:
        boundary = {key: value for key, value in self.document.items() if key in BOUNDARY}
        return f"scene = {toml({**boundary, 'shape': shape})}"

    @property
    def family(self) -> "Table":
        """The table with every shape parameter left free that has a range; the table itself where none has one."""
        return _family(self.family_text) if self.family_text else self.table

    def over(self, parameter: str, low: Any, high: Any) -> "Table":
        """The table with one of its shape parameters left free, looked at from `low` to `high`.

        `ValueError` with a value at which it is no table. A table given by its radius is proved for every value of the
        interval; any other one is proved at its ends and at seven values between.

        >>> flower = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}})
        >>> flower.over("b", 0, "1/30").shapes[0].range
        Interval(0, 1/30)
        """
        if parameter not in self.shape:
            accepted = ", ".join(self.shape) or "none"
            raise ValueError(f"{self.name}: no shape parameter {parameter}; it has: {accepted}")
        ends = [exact(parameter, end) for end in (low, high)]
        values = {parameter: value_text(text) for parameter, text in self.document["shape"].items()}
        return _family(self._with({name: values[name] for name in self.shape} | {parameter: "{}..{}".format(*ends)}))

    def at(self, *, lam: Any = None, law: Law | str | None = None, **shape: Any) -> "Scene":
        """The same scene with another contraction or law, or other numbers for its shape.

        >>> Scene("egg", alpha="0.08").at(lam="0.4", alpha="1/20")
        Scene('egg', alpha='1/20', lam='2/5')
        """
        other = object.__new__(Scene)
        boundary = {key: value for key, value in self.document.items() if key in BOUNDARY}
        kept = self.shape if law is not None else self.document.get("shape", {})
        texts = {name: self.document["shape"][name] for name in kept}
        law = Law(self.law.formula) if law is None else law
        ranges = {name: range_text(text) for name, text in texts.items() if range_text(text)}
        other._hold(
            boundary, {**texts, **_with_ranges(shape, ranges)}, self.document["lam"] if lam is None else lam, law
        )
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
            word_entry("shape", parameter): number_entry(f"shape.{parameter}", value)
            for parameter, value in shape.items()
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
        from symbolic.tables.formula import latex

        return rf"$\displaystyle {latex(self.table)}, \quad \varphi = {latex(self.law.phi)}$"


def _one_number(name: str, law: Law, own: tuple[str, ...], shape: Mapping[str, Any]) -> None:
    """Refuses a law that holds one number under a name for which the table, or the scene, has another or none."""
    for parameter, held in law.numbers:
        given = value_text(parameter_text(f"{name}: {parameter}", shape[parameter])) if parameter in shape else None
        if given != held and (given is not None or parameter in own):
            raise ValueError(
                f"{name}: {parameter} is {held} in the law and has {given or 'no number'} in the "
                f"{'table' if parameter in own else 'scene'}; a name means one number, so rename one of the two"
            )


def _with_ranges(shape: Mapping[str, Any], ranges: Mapping[str, str]) -> dict[str, Any]:
    """Numbers, each with the range that is known for it where it says none of its own."""
    return {
        name: value
        if name not in ranges or (isinstance(value, str) and ":" in value)
        else f"{exact(name, value)}:{ranges[name]}"
        for name, value in shape.items()
    }


def _own_ranges(table: "Table") -> dict[str, str]:
    """The ranges that a table states for its own shape parameters, as far as their ends are numbers."""
    ends = {p.symbol.name: (p.range.start, p.range.end) for p in table.shapes}
    return {name: f"{low}..{high}" for name, (low, high) in ends.items() if low.is_finite and high.is_finite}


@lru_cache(maxsize=64)
def _family(line: str) -> "Table":
    """The table of a line in which some parameters have a range `LOW..HIGH` alone: these stay free.

    A radius is proved positive over all of the ranges; of any other table the corners of the ranges and, for each
    parameter, nine values of it are looked at, the others in the middle.
    """
    import tomllib

    from sympy import Interval, Symbol

    from symbolic.tables.table import Shape
    from symbolic.tables.validity import radius_over

    document: dict[str, Any] = tomllib.loads(line)["scene"]
    ranges = {name: range_ends(name, text) for name, text in document["shape"].items() if ".." in text}
    outside = "is outside of what was looked at"
    free = [Shape(Symbol(name, real=True), Interval(*ends), outside) for name, ends in ranges.items()]
    table = built(document, free)
    proved = "table" in document or ("polar" in document and radius_over(table))
    places = [dict(zip(ranges, corner, strict=True)) for corner in product(*ranges.values())]
    if not proved:
        middle = {name: (low + high) / 2 for name, (low, high) in ranges.items()}
        for name, (low, high) in ranges.items():
            places += [{**middle, name: low + (high - low) * share / 8} for share in range(9)]
    for place in {str(place): place for place in places}.values():
        try:
            built({**document, "shape": {**document["shape"], **{name: str(value) for name, value in place.items()}}})
        except ValueError as why:  # the paper's tables name the value themselves
            where = ", ".join(f"{name} = {value}" for name, value in place.items())
            raise ValueError(str(why) if "table" in document else f"{where}: {why}") from None
    return table
