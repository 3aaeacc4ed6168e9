"""Compiles functions of arrays, written in NumPy, to one loop of machine code with the same bits.

A function that consists of sums, products, quotients, roots, comparisons and selections of NumPy is called with `Lanes`
in place of arrays. Each operation writes the LLVM instruction that IEEE 754 rounds in the same way, and no two are
fused. So results have the bits that NumPy gives, without temporary arrays. Where there is no compiler, or where the
function makes an array by `np.asarray` or `np.broadcast_arrays`, as an exponential by powers of two does, the function
itself is called. Any other operation is refused: the bits of NumPy's sine, for example, differ between machines.
"""

import ctypes
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from numeric.kernels import machine

Array = NDArray[np.float64]
WIDTH = 8
VECTOR, MASK = f"<{WIDTH} x double>", f"<{WIDTH} x i1>"
HEAD = (
    "define void @run(ptr noalias %in, ptr noalias %out, ptr %unused, ptr %none, "
    "i64 %width, i64 %first, i64 %last, i64 %times) #0 {\n"
    "entry:\n  br label %head\n"
    "head:\n  %at = phi i64 [%first, %entry], [%next, %body]\n"
    "  %busy = icmp slt i64 %at, %last\n  br i1 %busy, label %body, label %exit\nbody:"
)
END = f"  %next = add i64 %at, {WIDTH}\n  br label %head\nexit:\n  ret void\n}}"
TAIL = 'attributes #0 = { nounwind "prefer-vector-width"="512" "min-legal-vector-width"="512" }'
ARITHMETIC = {np.add: "fadd", np.subtract: "fsub", np.multiply: "fmul", np.true_divide: "fdiv"}
COMPARISONS = {
    np.less: "olt",
    np.less_equal: "ole",
    np.greater: "ogt",
    np.greater_equal: "oge",
    np.equal: "oeq",
    np.not_equal: "une",
}
LOGIC = {np.bitwise_and: "and", np.bitwise_or: "or", np.logical_and: "and", np.logical_or: "or"}
CALLS = {np.absolute: "fabs", np.sqrt: "sqrt", np.rint: "rint", np.floor: "floor", np.copysign: "copysign"}


class NoInstructionError(TypeError):
    """A NumPy operation for which no instruction with the same bits is known."""


class Lanes(NDArrayOperatorsMixin):
    """A stand-in for an array of doubles, or of truth values, while a function is traced."""

    def __init__(self, trace: "Trace", text: str, mask: bool = False) -> None:
        self.trace, self.text, self.mask = trace, text, mask

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> "Lanes":
        """Traces one operation. Its result is a new value, even where NumPy would overwrite an operand."""
        return self.trace.applied(ufunc, inputs) if method == "__call__" else NotImplemented

    def __array_function__(self, function: Any, types: Any, args: Any, options: Any) -> "Lanes":
        """Traces `np.where`, and no other function."""
        return self.trace.chosen(*args) if function is np.where else NotImplemented


class Trace:
    """The instructions of one function, each written once."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.known: dict[str, str] = {}
        self.declared: set[str] = set()

    def emit(self, text: str) -> str:
        """Writes an instruction, or finds an equal one written before; returns the name of its result."""
        if text not in self.known:
            self.known[text] = f"%v{len(self.known)}"
            self.lines.append(f"  {self.known[text]} = {text}")
        return self.known[text]

    def number(self, x: Any) -> str:
        """The text of an operand: of lanes, or of a double that is the same in all lanes."""
        if isinstance(x, Lanes):
            return x.text
        return f"splat (double 0x{struct.unpack('<Q', struct.pack('<d', float(x)))[0]:016X})"

    def applied(self, ufunc: np.ufunc, inputs: Sequence[Any]) -> Lanes:
        """The result of an elementwise function of NumPy; `NoInstructionError` if it has no instruction."""
        one, *rest = (self.number(x) for x in inputs)
        if ufunc in LOGIC:
            return Lanes(self, self.emit(f"{LOGIC[ufunc]} {MASK} {one}, {rest[0]}"), True)
        if ufunc in (np.invert, np.logical_not):
            return Lanes(self, self.emit(f"xor {MASK} {one}, splat (i1 true)"), True)
        if ufunc in COMPARISONS:
            return self.compared(COMPARISONS[ufunc], one, rest[0])
        if ufunc is np.isnan:
            return self.compared("uno", one, one)
        if ufunc is np.isfinite:
            return self.compared("olt", self.called("fabs", one).text, self.number(np.inf))
        if ufunc in ARITHMETIC:
            return Lanes(self, self.emit(f"{ARITHMETIC[ufunc]} {VECTOR} {one}, {rest[0]}"))
        if ufunc is np.negative:
            return Lanes(self, self.emit(f"fneg {VECTOR} {one}"))
        if ufunc in CALLS:
            return self.called(CALLS[ufunc], one, *rest)
        if ufunc in (np.maximum, np.minimum, np.fmax, np.fmin):
            larger = self.compared("oge" if ufunc in (np.maximum, np.fmax) else "ole", one, rest[0])
            unknown = one if ufunc in (np.maximum, np.minimum) else rest[0]
            return self.chosen(larger | self.compared("uno", unknown, unknown), *inputs)
        raise NoInstructionError(f"{ufunc.__name__} is no operation of a traced function")

    def compared(self, word: str, one: str, other: str) -> Lanes:
        """A comparison, as truth values."""
        return Lanes(self, self.emit(f"fcmp {word} {VECTOR} {one}, {other}"), True)

    def called(self, name: str, *operands: str) -> Lanes:
        """The result of the LLVM intrinsic of this name."""
        self.declared.add(f"declare {VECTOR} @llvm.{name}.v{WIDTH}f64({', '.join([VECTOR] * len(operands))})")
        inside = ", ".join(f"{VECTOR} {x}" for x in operands)
        return Lanes(self, self.emit(f"call {VECTOR} @llvm.{name}.v{WIDTH}f64({inside})"))

    def chosen(self, mask: Lanes, one: Any, other: Any) -> Lanes:
        """The result of `np.where(mask, one, other)`."""
        return Lanes(
            self,
            self.emit(f"select {MASK} {mask.text}, {VECTOR} {self.number(one)}, {VECTOR} {self.number(other)}"),
        )

    def row(self, base: str, index: int) -> str:
        """The address of the current block of row `index` of an array."""
        start = self.emit(f"mul i64 %width, {index}")
        return self.emit(f"getelementptr double, ptr {base}, i64 {self.emit(f'add i64 {start}, %at')}")


def text(function: Callable[..., Sequence[Any]], count: int) -> tuple[str, int]:
    """The LLVM text of a function of `count` arrays, and the number of its results."""
    trace = Trace()
    rows = [Lanes(trace, trace.emit(f"load {VECTOR}, ptr {trace.row('%in', i)}, align 8")) for i in range(count)]
    found = function(*rows)
    for i, value in enumerate(found):
        address = trace.row("%out", i)
        trace.lines.append(f"  store {VECTOR} {trace.number(value)}, ptr {address}, align 8")
    return "\n".join([HEAD, *trace.lines, END, *sorted(trace.declared), TAIL, ""]), len(found)


def compiled(function: Callable[..., Sequence[Any]], count: int) -> tuple[machine.Run | None, int]:
    """The machine code of a function of `count` arrays, and the number of its results; None if it cannot be traced."""
    try:
        written, outputs = text(function, count)
    except NoInstructionError:
        raise
    except TypeError:  # NumPy's, of lanes in the place of an array
        return None, 0
    return machine.from_text(written), outputs


class Traced:
    """A compiled function of arrays of one length, and of numbers; it returns arrays of that length.

    >>> mean = Traced(lambda x, y: [(x + y) / 2, np.where(x < y, x, y)])
    >>> [each.tolist() for each in mean(np.array([1.0, 2.0]), 1.0)]
    [[1.0, 1.5], [1.0, 1.0]]
    """

    def __init__(self, function: Callable[..., Sequence[Any]]) -> None:
        self.function = function
        self.run: machine.Run | None = None
        self.outputs, self.written = 0, False

    def __call__(self, *values: Any) -> list[Array]:
        shape = np.broadcast_shapes(*map(np.shape, values))
        if len(shape) != 1:
            return list(self.function(*values))
        (size,) = shape
        if not self.written:
            self.run, self.outputs = compiled(self.function, len(values))
            self.written = True
        if self.run is None:
            return [np.broadcast_to(np.asarray(x, dtype=float), shape) for x in self.function(*values)]
        width = -(-size // WIDTH) * WIDTH
        given, found = np.empty((len(values), width)), np.empty((self.outputs, width))
        for row, value in zip(given, values, strict=True):
            row[:size] = value
        given[:, size:] = 1.0
        self.run(_address(given), _address(found), None, None, width, 0, width, 0)
        return list(found[:, :size])


def _address(array: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
