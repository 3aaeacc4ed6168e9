"""Straight-line programs: the form in which formulas pass from `symbolic` to `numeric`.

A program is a list of lines in a closed vocabulary, without names, branches or floats. Any backend (LLVM lanes, NumPy
arrays, multiprecision numbers) runs it, and it is plain data: it can be hashed, and written to a file from which it is
read back without importing SymPy.

A table IR (intermediate representation) is the plain data that kernels need of a table. It is made once from the exact
table, by `numeric.lowering.lower`, the only module that imports SymPy. The IRs of tables with a name are kept on disk,
so that later runs do not import SymPy.
"""

import functools
import json
import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from numeric.backends.functions import Series
from numeric.lowering import cache
from symbolic.expressions.numbers import NumberSystem, R
from symbolic.tables.scene import GALLERY, Scene, exact_text

if TYPE_CHECKING:
    from symbolic.tables.table import Table

ROOTS = {f"root{n}": n for n in range(3, 13)}
UNARY = {"neg", "sqrt", "sin", "cos", "exp", "log", "atan", "sinh", "cosh", "tanh", *ROOTS}
BINARY = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
VOCABULARY = {"q", "pi"} | UNARY | set(BINARY)
Line = tuple[str, *tuple[int, ...]]  # a word of the vocabulary and the numbers of its operands


class Program(NamedTuple):
    """`outputs` computed from `inputs` by `lines`; values are numbered, inputs first."""

    inputs: tuple[str, ...]
    lines: tuple[Line, ...]
    outputs: tuple[int, ...]

    def __call__(self, ops: NumberSystem[R], *values: R) -> list[R]:
        """The outputs, computed in the arithmetic of `ops`, in which every rational is `ops.q(p, n)`."""
        known = list(values)
        turned: dict[int, tuple[R, R]] = {}
        both = getattr(ops, "turned", None)  # number systems may have cosine and sine at the cost of one
        for word, *operands in self.lines:
            if word in BINARY:
                i, j = operands
                known.append(BINARY[word](known[i], known[j]))
            elif word == "q":
                known.append(ops.q(*operands))
            elif word == "pi":
                known.append(ops.pi)
            elif word in ROOTS:
                known.append(getattr(ops, "root")(known[operands[0]], ROOTS[word]))  # noqa: B009  (few number systems have it)
            elif both and word in ("cos", "sin"):
                i = operands[0]
                turned[i] = turned.get(i) or both(known[i])
                known.append(turned[i][word == "sin"])
            else:
                x = known[operands[0]]
                known.append(-x if word == "neg" else getattr(ops, word)(x))
        return [known[i] for i in self.outputs]

    def only(self, *outputs: int) -> "Program":
        """The program of some of the outputs, without the lines that they do not need.

        >>> Program(("x",), (("neg", 0), ("*", 0, 0)), (1, 2)).only(1)
        Program(inputs=('x',), lines=(('*', 0, 0),), outputs=(1,))
        """
        builder = Builder(*self.inputs)
        numbers = list(range(len(self.inputs)))
        for word, *operands in self.lines:
            numbers.append(builder.number((word, *(operands if word == "q" else (numbers[i] for i in operands)))))
        return builder.program(*(Node(builder, None, numbers[self.outputs[i]]) for i in outputs))

    def constant(self, output: int) -> Fraction | None:
        """The rational number that an output always is; None if it is not written as a constant."""
        at = self.outputs[output] - len(self.inputs)
        word, *numbers = self.lines[at] if at >= 0 else ("",)
        return Fraction(*numbers) if word == "q" else None

    def as_data(self) -> list[list[object]]:
        """Nested lists for JSON."""
        return [list(self.inputs), [list(line) for line in self.lines], list(self.outputs)]

    @staticmethod
    def from_data(data: list[Any]) -> "Program":
        """The program of nested lists, as `as_data` gives them; `ValueError` for a word outside the vocabulary."""
        inputs, lines, outputs = data
        for line in lines:
            if line[0] not in VOCABULARY:
                raise ValueError(f"program: {line[0]!r} is no word of the vocabulary")
        return Program(tuple(inputs), tuple(tuple(line) for line in lines), tuple(outputs))


class Builder:
    """Writes a program: evaluate a formula on `nodes`, then call `program` with the outputs.

    >>> builder = Builder("x", "y")
    >>> x, y = builder.nodes
    >>> builder.program(x * y + 0 * x, x * y * 2).lines
    (('*', 0, 1), ('q', 2, 1), ('*', 2, 3))
    """

    def __init__(self, *inputs: str) -> None:
        self.inputs = inputs
        self.lines: list[Line] = []
        self.numbers: dict[Line, int] = {}
        self.nodes = [Node(self, None, i) for i in range(len(inputs))]

    def number(self, line: Line) -> int:
        """The number of the value that `line` computes; a line equal to an earlier one is not written again."""
        if line not in self.numbers:
            self.numbers[line] = len(self.inputs) + len(self.lines)
            self.lines.append(line)
        return self.numbers[line]

    def node(self, word: str, *operands: int) -> "Node":
        """The value of a line whose operands are given by number."""
        return Node(self, None, self.number((word, *operands)))

    def exact(self, value: "Exact") -> "Node":
        """A rational constant."""
        return value if isinstance(value, Node) else Node(self, Fraction(value), None)

    def program(self, *outputs: "Exact") -> Program:
        """The program of all lines so far that the outputs need."""
        wanted = [self.exact(output).number() for output in outputs]
        first, used = len(self.inputs), set(wanted)
        for i in range(len(self.lines) - 1, -1, -1):
            if first + i in used and self.lines[i][0] != "q":
                used.update(self.lines[i][1:])
        renumbered = {i: i for i in range(first)}
        lines: list[Line] = []
        for i, (word, *operands) in enumerate(self.lines):
            if first + i in used:
                renumbered[first + i] = first + len(lines)
                lines.append((word, *(operands if word == "q" else (renumbered[j] for j in operands))))
        return Program(tuple(self.inputs), tuple(lines), tuple(renumbered[i] for i in wanted))


class Node:
    """A value in a program under construction; operations with 0 and 1 are simplified exactly."""

    def __init__(self, builder: Builder, value: Fraction | None, number: int | None) -> None:
        self.builder, self.value, self._number = builder, value, number

    def number(self) -> int:
        """The node's number; a constant gets its line only when something needs it."""
        if self._number is None:
            assert self.value is not None
            self._number = self.builder.number(("q", self.value.numerator, self.value.denominator))
        return self._number

    def _with(self, word: str, other: "Exact", swapped: bool = False) -> "Node":
        node = self.builder.exact(other)
        x, y = (node, self) if swapped else (self, node)
        if x.value is not None and y.value is not None:
            return Node(self.builder, Fraction(BINARY[word](x.value, y.value)), None)
        if word == "*" and 0 in (x.value, y.value):
            return self.builder.exact(0)
        if (word in "*/" and y.value == 1) or (word in "+-" and y.value == 0):
            return x
        if (word == "*" and x.value == 1) or (word == "+" and x.value == 0):
            return y
        if (word == "*" and y.value == -1) or (word == "/" and y.value == -1):
            return -x
        if (word == "*" and x.value == -1) or (word == "-" and x.value == 0):
            return -y
        if word in "+*" and x.number() > y.number():
            x, y = y, x
        return self.builder.node(word, x.number(), y.number())

    def __add__(self, other: "Exact") -> "Node":
        return self._with("+", other)

    def __radd__(self, other: "Exact") -> "Node":
        return self._with("+", other, swapped=True)

    def __sub__(self, other: "Exact") -> "Node":
        return self._with("-", other)

    def __rsub__(self, other: "Exact") -> "Node":
        return self._with("-", other, swapped=True)

    def __mul__(self, other: "Exact") -> "Node":
        return self._with("*", other)

    def __rmul__(self, other: "Exact") -> "Node":
        return self._with("*", other, swapped=True)

    def __truediv__(self, other: "Exact") -> "Node":
        return self._with("/", other)

    def __rtruediv__(self, other: "Exact") -> "Node":
        return self._with("/", other, swapped=True)

    def __neg__(self) -> "Node":
        return (
            Node(self.builder, -self.value, None) if self.value is not None else self.builder.node("neg", self.number())
        )


Exact = Node | Fraction | int  # what a formula may be made of
Kept = TypeVar("Kept")
PAPER = ("circle", "ellipse", "cardioid", "cuspless", "egg")
SOURCES = (
    "symbolic/expressions",
    "symbolic/motion",
    "symbolic/tables",
    "numeric/backends",
    "numeric/lowering",
)  # what a table IR depends on


class ShapeRange(NamedTuple):
    """A shape parameter, its closed range (None for no bound), and the message for a value outside it."""

    name: str
    low: str | None
    high: str | None
    otherwise: str

    def check(self, table: str, value: Fraction) -> None:
        """Raises `ValueError` for a value outside the range."""
        below = self.low is not None and value < Fraction(self.low)
        above = self.high is not None and value > Fraction(self.high)
        if below or above:
            high = "oo)" if self.high is None else f"{self.high}]"
            low = "(-oo" if self.low is None else f"[{self.low}"
            shown = value if value.denominator < 10**6 else float(value)
            raise ValueError(f"{table}: {self.name} = {shown} {self.otherwise}; {self.name} must lie in {low}, {high}")


class ComponentProgram(NamedTuple):
    """A component: its parameter's ends and its curve, as programs in `theta` and the shape.

    `curve` has the six outputs `x, y` and their first and second derivatives.
    """

    name: str
    ends: Program
    curve: Program

    def first(self, count: int) -> Program:
        """The program of the first outputs of the curve."""
        return _first(self.curve, count)


@functools.cache
def _first(program: Program, count: int) -> Program:
    return program.only(*range(count)) if count < len(program.outputs) else program


class LawIR(NamedTuple):
    """A reflection law for kernels: programs in `eta`, `lam` and the position, with numbers for the law's own
    parameters.

    The position is `theta`, followed by the arc length `s` if the law is `measured`. `exit` gives the exit angle, and
    `slopes` gives minus its derivative with respect to `eta`, then those with respect to the position.
    """

    text: str
    exit: Program
    slopes: Program
    placed: bool  # does the exit angle depend on the place?
    measured: bool = False  # on its arc length?
    lengths: tuple[Program, ...] = ()  # on each component its slope by `theta` and its value at 0, where that is all
    series: tuple[Series, tuple[float, ...]] | None = None  # as a sum of waves, on other closed curves

    def length(self, ops: NumberSystem[R], component: int, theta: R) -> R:
        """Arc length from the table's origin, on a table of straight sides and circular arcs."""
        slope, begin = self.lengths[component](ops)
        return slope * theta + begin


class TableIR(NamedTuple):
    """A table as the kernels see it.

    `same_as` names the paper's table with the same boundary, if that table has a flight method of its own; `programs`
    has the programs for other flight methods, by name. For the end of every component, `joins` has the component that
    begins there, the name of the `symbolic.tables.joins.JoinKind`, and the side to which a corner turns (1 left, -1
    right).
    """

    table: str
    same_as: str
    shape: tuple[ShapeRange, ...]
    parts: tuple[ComponentProgram, ...]
    programs: tuple[tuple[str, Program], ...]
    origin: tuple[int, Program]
    joins: tuple[tuple[int, str, int], ...]

    def program(self, name: str) -> Program:
        """The straight-line program of this name."""
        return dict(self.programs)[name]

    def has(self, name: str) -> bool:
        """Is there a program of this name?"""
        return any(name == known for known, _ in self.programs)

    def as_text(self) -> str:
        """The table IR as JSON; equal table IRs have equal text."""
        data = {
            "table": self.table,
            "same_as": self.same_as,
            "shape": [[s.name, s.low, s.high, s.otherwise] for s in self.shape],
            "parts": [[p.name, p.ends.as_data(), p.curve.as_data()] for p in self.parts],
            "programs": [[name, program.as_data()] for name, program in self.programs],
            "origin": [self.origin[0], self.origin[1].as_data()],
            "joins": self.joins,
        }
        return json.dumps(data, separators=(",", ":"))

    @staticmethod
    def from_text(text: str) -> "TableIR":
        """The table IR of a text that `as_text` has written."""
        data = json.loads(text)
        read = Program.from_data
        return TableIR(
            data["table"],
            data["same_as"],
            tuple(ShapeRange(*entry) for entry in data["shape"]),
            tuple(ComponentProgram(name, read(ends), read(curve)) for name, ends, curve in data["parts"]),
            tuple((name, read(program)) for name, program in data["programs"]),
            (data["origin"][0], read(data["origin"][1])),
            tuple((after, contact, bend) for after, contact, bend in data["joins"]),
        )


class Named(NamedTuple):
    """A table of `symbolic.tables.gallery`, given by its name and the values of its lengths, as exact text."""

    name: str
    lengths: tuple[tuple[str, str], ...] = ()


def by_name(name: str, lengths: Mapping[str, Any]) -> Named:
    """A table of the gallery by its name, with lengths; an unknown length is refused when the table is made.

    >>> by_name("stadium", {"straight": "0.50"})
    Named(name='stadium', lengths=(('straight', '1/2'),))
    """
    decimals = {key: str(value) if isinstance(value, float) else value for key, value in sorted(lengths.items())}
    return Named(name, tuple((key, exact_text(f"{name}: {key}", value)) for key, value in decimals.items()))


def table_ir(table: "Table | Scene | Named | str", K: int = 3) -> TableIR:
    """The table IR of an exact table, of a table of the paper or the gallery by name, or of a scene with its numbers.

    A shape parameter that has a range stays open. IRs of names and scenes are kept between runs, and need SymPy only
    once.

    >>> table_ir("circle").same_as
    'circle'
    """
    if not isinstance(table, str | Scene | Named):
        from numeric.lowering.lower import lower

        return lower(table)

    def made() -> str:
        from numeric.lowering.lower import exact_table, lower

        return lower(table.family if isinstance(table, Scene) else exact_table(table, K, {})).as_text()

    return kept(ir_name(table, K), made, TableIR.from_text)


def table_ir_in_unit(
    table: "Table | Scene | Named | str", K: int, shape: dict[str, Any], unit: tuple[Fraction, Fraction, Fraction]
) -> TableIR:
    """The table IR of a table with numbers for its shape, measured in a unit of length and about a point."""

    def lowered() -> TableIR:
        from numeric.lowering.lower import exact_table, in_unit, lower

        return lower(in_unit(exact_table(table, K, shape), *unit))

    if not isinstance(table, str | Scene | Named):
        return lowered()
    name = repr((ir_name(table, K), sorted(shape.items()), unit))
    return kept(name, lambda: lowered().as_text(), TableIR.from_text)


class TableSymmetry(NamedTuple):
    """A symmetry of a table, as `symbolic.tables.geometry.Symmetry`, but with floats and without a name."""

    sign: int
    angle: float
    onto: tuple[int, ...]
    shift: tuple[float, ...]


def symmetries(table: "Table | Scene | Named | str", K: int, shape: dict[str, Any]) -> tuple[TableSymmetry, ...]:
    """The proved symmetries of a table with numbers for its shape, the identity first.

    >>> [symmetry.sign for symmetry in symmetries("cuspless", 3, {})]
    [1, -1]
    """

    def made() -> str:
        from numeric.lowering.lower import exact_table, symmetry_text

        return symmetry_text(exact_table(table, K, shape))

    def read(text: str) -> tuple[TableSymmetry, ...]:
        return tuple(TableSymmetry(sign, angle, tuple(onto), tuple(by)) for sign, angle, onto, by in json.loads(text))

    if not isinstance(table, str | Scene | Named):
        return read(made())
    return kept(symmetry_name(table, K, shape), made, read)


def symmetry_name(table: "Scene | Named | str", K: int, shape: dict[str, Any]) -> str:
    """The key under which the proved symmetries of a table are kept."""
    return f"symmetries of {ir_name(table, K)}, {sorted(shape.items())}"


def kept(name: str, made: Callable[[], str], read: Callable[[str], Kept]) -> Kept:
    """The result of `read` on the text of this name, found on disk or in the package, or else made by `made` and kept.

    The name determines the text, together with this project's own sources.
    """
    sources = cache.sources(*SOURCES)
    found = cache.read("table_ir", name, sources)
    if found is not None:
        try:
            return read(found.decode())
        except (ValueError, KeyError, TypeError, IndexError):
            pass  # a damaged file is as good as none: it is written again
    from numeric.lowering.shipped import shipped

    text = shipped(name, sources)
    text = made() if text is None else text
    cache.write("table_ir", name, sources, text.encode())
    return read(text)


def ir_name(table: "Scene | Named | str", K: int) -> str:
    """The name under which a table IR is kept on disk; `ValueError` for an unknown table."""
    if isinstance(table, Scene):
        return table.family_text or table.boundary
    if isinstance(table, Named):
        return repr(table)
    if table in PAPER:
        return f"{table}{K}" if table == "egg" else table
    raise ValueError(f"no table is called {table!r}; accepted: {', '.join((*PAPER, *GALLERY))}")
