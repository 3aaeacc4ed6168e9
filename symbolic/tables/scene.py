"""A scene: a table, its shape, a reflection law and a contraction; exact, and one line of text.

Every part of the package takes a scene. It holds text and fractions only, so that a scene with one of the paper's
tables is read, compared, hashed and sent to another machine without SymPy; `table` builds the exact table at its
first use. Paper: section 2.
"""

import re
from collections.abc import Callable, Mapping
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
    like,
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
from symbolic.tables.definition import no_parameter as no_parameter
from symbolic.tables.law import Law as Law
from symbolic.tables.law import parameters_of_law

if TYPE_CHECKING:
    from pathlib import Path

    from sympy import Expr

    from symbolic.tables.table import Table

LONGEST = 1 << 22  # characters of a scene file
QUOTED = re.compile(r'"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'')
DOTTED = re.compile(r"(?<![\w-])[\w-]+(?:[ \t]*\.[ \t]*[\w-]+){16}")


@dataclass(frozen=True, repr=False)
class Scene:
    """A table with numbers for its shape, a law and a contraction.

    `table` is an exact table, the name of one of the paper's or of `tables.GALLERY`, or a function that makes one, such
    as `tables.egg`; shape parameters are keywords. Numbers are exact, or text, where a decimal means the decimal it
    shows; a float is refused. A parameter may have a range, `b="0.1:0..1/4"`. Then it is proved, for all values in the
    range, that the boundary bounds a table (see `over`) and that the law points into the table.

    >>> egg = Scene("egg", alpha="0.08", lam="1/2")
    >>> egg
    Scene('egg', alpha='2/25', lam='1/2')
    >>> egg.text
    'scene = { table = "egg", shape = { alpha = "2/25" }, lam = "1/2" }'
    >>> Scene.parse(egg.text) == egg
    True
    >>> from symbolic import tables
    >>> Scene(tables.egg(3), alpha="2/25", lam="1/2") == Scene(tables.egg, alpha="2/25", lam="1/2") == egg
    True
    """

    text: str

    def __init__(
        self,
        table: "Table | Callable[..., Table] | str",
        *,
        lam: Any = 1,
        law: Law | str = UNIFORM,
        K: int = POINTS,
        **shape: Any,
    ) -> None:
        found, shape = given_table(table, K, shape)
        boundary, fixed = named_boundary(found, K) if isinstance(found, str) else table_boundary(found)
        ranges = _own_ranges(found) if not isinstance(found, str) and "table" not in boundary else {}
        self._hold(boundary, {**fixed, **_with_ranges(shape, ranges)}, lam, law)

    def _hold(self, boundary: dict[str, Any], shape: Mapping[str, Any], lam: Any, law: Law | str) -> None:
        """Sets `text` after all checks; equal scenes get the same text, however their numbers were written."""
        name, law = name_of(boundary), law if isinstance(law, Law) else Law(law)
        parameters = tuple(dict.fromkeys((*parameters_of(boundary), *parameters_of_law(law.formula))))
        _one_number(name, law, parameters_of(boundary), shape)
        shape = {**dict(law.numbers), **shape}
        for parameter in shape:
            if parameter not in parameters:
                raise no_parameter(name, parameter, parameters)
        for parameter in parameters:
            if parameter not in shape:
                raise ValueError(
                    f"{name}: the shape parameter {parameter} needs a value, as in Scene(..., {parameter}=...) "
                    f"or --shape {parameter}=NUMBER"
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

    # ---- its parts

    @cached_property
    def document(self) -> dict[str, Any]:
        """The scene as plain data, for JSON and for a scene file."""
        import tomllib

        said: dict[str, Any] = tomllib.loads(self.text)["scene"]
        return said

    @property
    def name(self) -> str:
        """The table's name: one of the paper's, the user's own, or `polar`, `parametric`, `piecewise`, `measured`."""
        return name_of(self.document)

    @property
    def K(self) -> int:
        """The number of points of the egg; 3 for every other table, where it means nothing."""
        return int(self.document.get("K", POINTS))

    @property
    def lam(self) -> "Fraction | Expr":
        """The contraction `lam`, exactly."""
        return exact("lam", self.document["lam"])

    @property
    def shape(self) -> "dict[str, Fraction | Expr]":
        """The values of the table's shape parameters, by name, exactly."""
        return {name: exact(name, value_text(self.document["shape"][name])) for name in parameters_of(self.document)}

    @property
    def ranges(self) -> "dict[str, tuple[Fraction | Expr, Fraction | Expr]]":
        """The ends of the range of each parameter of the table or the law that has a range.

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
        """The exact table with the values of its shape; `ValueError` if the boundary does not bound a table."""
        return built(self.document)

    @cached_property
    def family_text(self) -> str:
        """The boundary's text with ranges in place of its parameters' values; empty if no parameter has a range."""
        shape = {parameter: self.document["shape"][parameter] for parameter in parameters_of(self.document)}
        if not any(map(range_text, shape.values())):
            return ""
        return self._with({parameter: range_text(text) or text for parameter, text in shape.items()})

    def _with(self, shape: Mapping[str, str]) -> str:
        boundary = {key: value for key, value in self.document.items() if key in BOUNDARY}
        return f"scene = {toml({**boundary, 'shape': shape})}"

    @property
    def family(self) -> "Table":
        """The table, free in each shape parameter that has a range; `table` itself if none has one."""
        return _family(self.family_text) if self.family_text else self.table

    def over(self, parameter: str, low: Any, high: Any) -> "Table":
        """The table with one of its shape parameters left free, with the range from `low` to `high`.

        Raises `ValueError`, which names a value, if it is not a table for all values. For a table of the user's own
        this is proved for the whole interval; the paper's tables are checked at both ends.

        >>> flower = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}})
        >>> flower.over("b", 0, "1/30").shapes[0].range
        Interval(0, 1/30)
        """
        if parameter not in self.shape:
            raise no_parameter(self.name, parameter, self.shape)
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

    def spanning(self, parameter: str, low: Any, high: Any) -> "Scene":
        """The same scene, with the range from `low` to `high` for a parameter of its table or law.

        The parameter keeps its value if it is inside, otherwise it gets the middle. Maps at all its values then share
        their kernels. A parameter of a table of the paper has a range of its own, and gets a value only.

        >>> Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}}).spanning("b", 0, "1/30").ranges
        {'b': (Fraction(0, 1), Fraction(1, 30))}
        """
        first, last = (exact(parameter, end) for end in (low, high))
        known = {**self.shape, **{name: exact(name, text) for name, text in self.law.numbers}}
        if parameter not in known:
            accepted = f"{', '.join(['lam', *known])}{like(parameter, ['lam', *known])}"
            raise ValueError(f"{parameter} is no parameter that varies in {self}; accepted: {accepted}")
        if not first < last:
            raise ValueError(f"{parameter} from {low} to {high} is no interval; the first must be the smaller")
        value = known[parameter] if first < known[parameter] < last else (first + last) / 2
        ranged = "table" not in self.document or parameter not in self.shape
        number: dict[str, Any] = {parameter: f"{value}:{first}..{last}" if ranged else value}
        return self.at(**number)

    # ---- text and back

    @classmethod
    def parse(cls, text: str) -> "Scene":
        """The scene of a line of text, or of the text of a scene file; `ValueError` names the entry that is wrong.

        >>> Scene.parse('table = "ellipse"\\nlam = "0.9"\\n[shape]\\na = "sqrt(2)"')
        Scene('ellipse', a='sqrt(2)', lam='9/10')
        """
        import tomllib

        if len(text) > LONGEST or DOTTED.search(QUOTED.sub("q", text)):
            if len(text) > LONGEST:
                raise ValueError(f"scene: the text is too long; accepted: at most {LONGEST} characters")
            raise ValueError("scene: the text has a key of more than 16 parts; accepted: keys such as shape.a")
        try:
            said = tomllib.loads(text)
        except RecursionError:
            raise ValueError("scene: lists or tables are nested too deeply; accepted: a few levels") from None
        except tomllib.TOMLDecodeError as error:
            raise ValueError(f"scene: {error}") from None
        return cls.of(said["scene"] if set(said) == {"scene"} and isinstance(said["scene"], dict) else said)

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> "Scene":
        """The scene of a document: plain data with the entries of a scene file.

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
        """The scene of a text that is the `text` of a scene made before: its proofs are not repeated."""
        other = object.__new__(cls)
        object.__setattr__(other, "text", text)
        return other

    @classmethod
    def load(cls, path: "str | Path") -> "Scene":
        """The scene that the file at `path` holds; `ValueError` where that file cannot be read."""
        from pathlib import Path  # imported here, since most starts read no scene file

        try:
            with Path(path).open(encoding="utf-8") as file:
                text = file.read(LONGEST + 1)  # bounded: a device such as /dev/zero never ends
        except (OSError, UnicodeDecodeError) as why:
            said = getattr(why, "strerror", None) or why
            raise ValueError(f"scene: {path} cannot be read ({said}); give a file that Scene.save writes") from None
        return cls.parse(text)

    def save(self, path: "str | Path") -> None:
        """Writes the scene as a file that `load` reads; `ValueError` where that file cannot be written."""
        from importlib import import_module

        try:  # `numeric` has the function that writes a file whole or not at all
            import_module("numeric.lowering.files").write_whole(path, f"{self.text}\n")
        except OSError as why:
            raise ValueError(f"scene: {path} cannot be written ({why.strerror}); give a file in a folder") from None

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


def as_scene(given: Any, *, lam: Any = None, law: Law | str | None = None, **shape: Any) -> Scene:
    """The scene of a table, a map, a scene or a name, with these values in place of its own.

    >>> as_scene("ellipse", a="3/2", lam="1/2")
    Scene('ellipse', a='3/2', lam='1/2')
    >>> as_scene(Scene("cardioid", lam="1/2"), lam="1/4")
    Scene('cardioid', lam='1/4')
    """
    own = given if isinstance(given, Scene | str) else getattr(given, "scene", given)  # of a map, or of a cycle
    if isinstance(own, Scene):
        changed = lam is not None or law is not None or shape
        return own.at(lam=lam, law=law, **shape) if changed else own
    return Scene(own, lam=1 if lam is None else lam, law=UNIFORM if law is None else law, **shape)


def given_table(table: Any, K: int, shape: Mapping[str, Any]) -> "tuple[Any, dict[str, Any]]":
    """The table that is given, named, or made by a given function; and the shape values not used to make it."""
    numbers = dict(shape)
    if isinstance(table, str) and table in GALLERY:
        from symbolic.tables import gallery

        table = gallery.GALLERY[table]
    if callable(table):
        from inspect import signature

        name, known = getattr(table, "__name__", "table"), signature(table).parameters
        own = {key: numbers.pop(key) for key in known if key in numbers} | ({"K": K} if "K" in known else {})
        try:
            table = table(**own)
        except TypeError as why:
            raise ValueError(f"{name}: a call of it makes no table ({why}); give the table itself") from None
    if not isinstance(table, str) and not hasattr(table, "components"):
        raise ValueError(f"{table!r} is no table; accepted: a table, a scene, a map, or the name of a table")
    return table, numbers


def _one_number(name: str, law: Law, own: tuple[str, ...], shape: Mapping[str, Any]) -> None:
    """Raises `ValueError` if a parameter has one value in the law and another value or none in the table or scene."""
    for parameter, held in law.numbers:
        given = value_text(parameter_text(f"{name}: {parameter}", shape[parameter])) if parameter in shape else None
        if given != held and (given is not None or parameter in own):
            raise ValueError(
                f"{name}: {parameter} is {held} in the law and has {given or 'no number'} in the "
                f"{'table' if parameter in own else 'scene'}; a name means one number, so rename one of the two"
            )


def _with_ranges(shape: Mapping[str, Any], ranges: Mapping[str, str]) -> dict[str, Any]:
    """Values of shape parameters, each with its range from `ranges` appended unless it has a range already."""
    return {
        name: value
        if name not in ranges or (isinstance(value, str) and ":" in value)
        else f"{exact(name, value)}:{ranges[name]}"
        for name, value in shape.items()
    }


def _own_ranges(table: "Table") -> dict[str, str]:
    """The finite ranges that a table has for its own shape parameters, as `LOW..HIGH` by name."""
    ends = {p.symbol.name: (p.range.start, p.range.end) for p in table.shapes}
    return {name: f"{low}..{high}" for name, (low, high) in ends.items() if low.is_finite and high.is_finite}


@lru_cache(maxsize=64)
def _family(line: str) -> "Table":
    """The table of a scene's line of text in which parameters given as a range `LOW..HIGH` stay free.

    A table of the user's own is proved to be a table over all of the ranges; the paper's tables are checked at their
    ends.
    """
    import tomllib

    from sympy import Interval, Symbol

    from symbolic.tables.table import Shape
    from symbolic.tables.validity import prove_table, radius_over

    document: dict[str, Any] = tomllib.loads(line)["scene"]
    ranges = {name: range_ends(name, text) for name, text in document["shape"].items() if ".." in text}
    outside = "is outside of the range that was given"
    free = [Shape(Symbol(name, real=True), Interval(*ends), outside) for name, ends in ranges.items()]
    table = built(document, free)
    proved = "table" in document or ("polar" in document and radius_over(table))
    places = [dict(zip(ranges, corner, strict=True)) for corner in product(*ranges.values())]
    for place in {str(place): place for place in places}.values():
        try:
            built({**document, "shape": {**document["shape"], **{name: str(value) for name, value in place.items()}}})
        except ValueError as why:  # the paper's tables name the value themselves
            where = ", ".join(f"{name} = {value}" for name, value in place.items())
            raise ValueError(str(why) if "table" in document else f"{where}: {why}") from None
    if not proved:
        prove_table(table)
    return table
