"""LLVM vectors as a number system: running a step of the map on its values writes the instructions of a kernel.

A product that is only added to something becomes a fused multiply-add. This file decides so, never the compiler: no
fast-math flag is set. So the bits of a result depend neither on the number of lanes, nor on the other instructions of
the kernel, nor on the version of LLVM.
"""

import math
import struct
from collections.abc import Callable, Sequence
from typing import Any

from numeric.backends import functions, memory
from numeric.backends.doubles import DoubleBackend

Fold = float | None


class LLVMMask:
    """A vector of truth values."""

    def __init__(self, trace: "LLVMBackend", text: str) -> None:
        self.trace, self.text = trace, text

    def __and__(self, other: "LLVMMask") -> "LLVMMask":
        return self.trace.mask("and", self.text, other.text)

    def __or__(self, other: "LLVMMask") -> "LLVMMask":
        return self.trace.mask("or", self.text, other.text)


class LLVMVector:
    """A vector of doubles: a known constant, a value already written, or a product that is not written yet."""

    def __init__(
        self,
        trace: "LLVMBackend",
        text: str = "",
        value: Fold = None,
        factors: tuple["LLVMVector", "LLVMVector"] | None = None,
    ):
        self.trace, self._text, self.value, self.factors = trace, text, value, factors
        self._scope = trace.scope

    @property
    def text(self) -> str:
        """The operand's name in LLVM; first writes the instruction of a pending product."""
        if self.value is not None:
            return self.trace.literal(self.value)
        if self.factors is not None and (not self._text or self._scope not in self.trace.scopes):
            x, y = self.factors
            self._text, self._scope = self.trace.line("fmul", x, y)._text, self.trace.scope
        return self._text

    def __add__(self, other: "LLVMVector") -> "LLVMVector":
        if self.value is not None and other.value is not None:
            return self.trace.number(self.value + other.value)
        if self.value == 0.0:
            return other
        if other.value == 0.0:
            return self
        if self.factors is not None:
            return self.trace.fma(*self.factors, other)
        if other.factors is not None:
            return self.trace.fma(*other.factors, self)
        return self.trace.line("fadd", self, other)

    def __sub__(self, other: "LLVMVector") -> "LLVMVector":
        if self.value == 0.0:
            return -other
        if other.value is not None or self.factors is not None:
            return self + -other
        if other.factors is not None:
            return self.trace.fma(-other.factors[0], other.factors[1], self)
        return self.trace.line("fsub", self, other)

    def __mul__(self, other: "LLVMVector") -> "LLVMVector":
        x, y = (other, self) if other.value is not None else (self, other)
        if x.value is None:
            return LLVMVector(self.trace, factors=(x, y))
        if y.value is not None:
            return self.trace.number(x.value * y.value)
        if x.value in (0.0, 1.0, -1.0):
            return {0.0: x, 1.0: y}.get(x.value) or -y
        return LLVMVector(self.trace, factors=(x, y))

    def __truediv__(self, other: "LLVMVector") -> "LLVMVector":
        if self.value is not None and other.value is not None:
            return self.trace.number(self.value / other.value)
        return self if other.value == 1.0 else self.trace.line("fdiv", self, other)

    def __neg__(self) -> "LLVMVector":
        if self.value is not None:
            return self.trace.number(-self.value)
        if self.factors is not None:
            return LLVMVector(self.trace, factors=(-self.factors[0], self.factors[1]))
        return self.trace.line("fneg", self)

    def __abs__(self) -> "LLVMVector":
        if self.value is not None:
            return self.trace.number(abs(self.value))
        return self.trace.call("fabs", self)

    def __lt__(self, other: "LLVMVector") -> LLVMMask:
        return self.trace.compare("olt", self, other)

    def __le__(self, other: "LLVMVector") -> LLVMMask:
        return self.trace.compare("ole", self, other)

    def __eq__(self, other: object) -> Any:
        assert isinstance(other, LLVMVector)
        return self.trace.compare("oeq", self, other)

    __hash__ = None  # type: ignore[assignment]


class LLVMBackend(DoubleBackend[LLVMVector, LLVMMask]):
    """Writes LLVM instructions on vectors of `width` doubles."""

    def __init__(self, width: int = 32) -> None:
        self.width, self.type = width, f"<{width} x double>"
        self.masks, self.integers = f"<{width} x i1>", f"<{width} x i64>"
        self.lines: list[str] = []
        self.known: list[dict[str, str]] = [{}]
        self.scopes, self.scope, self.opened, self.block, self.count = [0], 0, 0, "entry", 0
        self.called: set[str] = set()
        self.constants: dict[str, str] = {}  # names of arrays in memory

    # ---- writing

    def fresh(self, stem: str = "v") -> str:
        """A name that no value or label of the kernel has yet."""
        self.count += 1
        return f"%{stem}{self.count}"

    def emit(self, text: str, key: str | None = None) -> str:
        """Writes `name = text`, unless an open scope has a value with this key, by default `text`; returns its name."""
        key = key if key is not None else text
        for known in reversed(self.known):
            if key in known:
                return known[key]
        name = self.fresh()
        self.lines.append(f"  {name} = {text}")
        self.known[-1][key] = name
        return name

    def line(self, word: str, *operands: LLVMVector) -> LLVMVector:
        """Writes an arithmetic instruction and returns its result."""
        return LLVMVector(self, self.emit(f"{word} {self.type} " + ", ".join(x.text for x in operands)))

    def call(self, name: str, *operands: LLVMVector) -> LLVMVector:
        """Writes a call of an intrinsic function of vectors and returns its result."""
        self.called.add(f"declare {self.type} @llvm.{name}.v{self.width}f64({', '.join([self.type] * len(operands))})")
        inside = ", ".join(f"{self.type} {x.text}" for x in operands)
        return LLVMVector(self, self.emit(f"call {self.type} @llvm.{name}.v{self.width}f64({inside})"))

    def compare(self, word: str, x: LLVMVector, y: LLVMVector) -> LLVMMask:
        """Writes a comparison and returns its result, which is false where an operand is nan."""
        return LLVMMask(self, self.emit(f"fcmp {word} {self.type} {x.text}, {y.text}"))

    def mask(self, word: str, x: str, y: str) -> LLVMMask:
        """Writes a logical instruction and returns its result."""
        return LLVMMask(self, self.emit(f"{word} {self.masks} {x}, {y}"))

    def literal(self, x: float) -> str:
        """A constant in every lane, exactly."""
        return f"splat (double 0x{struct.unpack('<Q', struct.pack('<d', x))[0]:016X})"

    def label(self, name: str) -> None:
        """Starts a basic block with this name."""
        self.lines.append(f"{name}:")
        self.block = name

    def open(self) -> None:
        """Opens a scope, inside which `emit` may use the values of all scopes around it."""
        self.opened += 1
        self.scope = self.opened
        self.scopes.append(self.scope)
        self.known.append({})

    def close(self) -> None:
        """Closes the scope opened last; what was emitted in it is not used again."""
        self.scopes.pop()
        self.known.pop()
        self.scope = self.scopes[-1]

    # ---- arithmetic

    def q(self, p: int, n: int) -> LLVMVector:
        """The double nearest to `p/n`."""
        return self.number(p / n)

    def number(self, x: float) -> LLVMVector:
        """The double `x`, as a known constant."""
        return LLVMVector(self, value=float(x))

    def constant(self, x: LLVMVector) -> bool:
        """Is this number known while the kernel is written?"""
        return x.value is not None

    def same(self, x: LLVMVector, y: LLVMVector) -> bool:
        """Are two values known to be equal while the kernel is written?"""
        return x is y or (x.value == y.value if x.value is not None or y.value is not None else x.text == y.text)

    @property
    def pi(self) -> LLVMVector:
        """The double nearest to pi."""
        return self.number(2 * functions.HALF_PI)

    @property
    def pi_low(self) -> LLVMVector:
        """Pi minus the double nearest to it."""
        return self.number(2 * functions.HALF_PI_LOW)

    def sqrt(self, x: LLVMVector) -> LLVMVector:
        """The square root."""
        return self.number(math.sqrt(x.value)) if x.value is not None else self.call("sqrt", x)

    def fma(self, x: LLVMVector, y: LLVMVector, z: LLVMVector) -> LLVMVector:
        """`x*y + z`, rounded once."""
        if z.value == 0.0 or 0.0 in (x.value, y.value) or {x.value, y.value} & {1.0, -1.0}:
            product = x * y
            return product + z if product.factors is None else product
        return self.call("fma", x, y, z)

    def product(self, x: LLVMVector, y: LLVMVector) -> LLVMVector:
        """`x*y`, rounded by itself: it is never joined with a sum to one instruction."""
        return self.line("fmul", x, y)

    def maximum(self, x: LLVMVector, y: LLVMVector) -> LLVMVector:
        """The larger of two numbers; `y` where `x` is nan."""
        return self.select(y < x, x, y)

    def select(self, mask: LLVMMask, x: LLVMVector, y: LLVMVector) -> LLVMVector:
        """`x` where the mask holds, else `y`."""
        if x is y:
            return x
        text = f"select {self.masks} {mask.text}, {self.type} {x.text}, {self.type} {y.text}"
        return LLVMVector(self, self.emit(text))

    def look_up(self, values: Sequence[LLVMVector], index: LLVMVector) -> LLVMVector:
        """The constant at an index, gathered from memory; the first constant where the index is out of range."""
        return LLVMVector(self, memory.gathered(self, [x.value for x in values], index))  # type: ignore[misc]

    def look_up_row(self, rows: Sequence[Sequence[float]], index: LLVMVector) -> list[LLVMVector]:
        """The entries of the row at an index in a table of constants; the first row where the index is out of range."""
        return [LLVMVector(self, column) for column in memory.columns(self, rows, index)]

    def negated(self, mask: LLVMMask) -> LLVMMask:
        """The opposite of a mask."""
        return self.mask("xor", mask.text, "splat (i1 true)")

    def rounded(self, x: LLVMVector) -> LLVMVector:
        """The nearest integer, for `|x| < 2**51`."""
        return (x + (magic := self.number(1.5 * 2.0**52))) - magic

    def with_sign(self, x: LLVMVector, y: LLVMVector) -> LLVMVector:
        """`|x|` with the sign of `y`."""
        return self.call("copysign", x, y)

    def times_sign(self, x: LLVMVector, y: LLVMVector) -> LLVMVector:
        """`x` with its sign flipped where `y` is negative."""
        sign = self._bits("and", self._integer(y), f"splat (i64 {-(2**63)})")
        return self._double(self._bits("xor", self._integer(x), sign))

    def power_of_two(self, x: LLVMVector) -> tuple[LLVMVector, LLVMVector]:
        """`(2**-e, e)` with `2**e <= x < 2**(e + 1)`, for positive normal `x`."""
        field = self._bits("and", self._integer(x), f"splat (i64 {0x7FF << 52})")
        inverse = self._double(self._bits("sub", f"splat (i64 {0x7FE << 52})", field))
        magic = self._bits("or", self._bits("lshr", field, "splat (i64 52)"), f"splat (i64 {0x433 << 52})")
        return inverse, self._double(magic) - self.number(2.0**52 + 1023)

    def sin(self, x: LLVMVector) -> LLVMVector:
        """The sine, of angles up to 2**30."""
        return self.turn(self._within_a_turn(x))[1]

    def cos(self, x: LLVMVector) -> LLVMVector:
        """The cosine, of angles up to 2**30."""
        return self.turn(self._within_a_turn(x))[0]

    def two_to(self, k: LLVMVector) -> LLVMVector:
        """`2**k` for whole `k` from -1022 to 1023."""
        shifted = self._integer(k + self.number(1.5 * 2.0**52 + 1023))
        return self._double(self._bits("shl", shifted, "splat (i64 52)"))

    def _within_a_turn(self, x: LLVMVector) -> LLVMVector:
        """`x` minus whole turns. A turn is given to 107 bits, and each subtraction is rounded once."""
        turns = self.rounded(x * self.number(0.25 / functions.HALF_PI))
        for part in (functions.HALF_PI, functions.HALF_PI_LOW):
            x = self.fma(-turns, self.number(4 * part), x)
        return x

    def settle(self, *values: LLVMVector) -> None:
        """Writes the instructions of these values now, before a branch that may use them."""
        for x in values:
            assert x.text

    def _integer(self, x: LLVMVector) -> str:
        return self.emit(f"bitcast {self.type} {x.text} to {self.integers}")

    def _double(self, x: str) -> LLVMVector:
        return LLVMVector(self, self.emit(f"bitcast {self.integers} {x} to {self.type}"))

    def _bits(self, word: str, x: str, y: str) -> str:
        return self.emit(f"{word} {self.integers} {x}, {y}")

    # ---- control flow

    def anywhere(self, mask: LLVMMask) -> str:
        """A single bit: does the mask hold in any lane?"""
        packed = self.emit(f"bitcast {self.masks} {mask.text} to i{self.width}")
        return self.emit(f"icmp ne i{self.width} {packed}, 0")

    def repeat(
        self,
        condition: Callable[[list[LLVMVector]], LLVMMask],
        body: Callable[[list[LLVMVector]], list[LLVMVector]],
        state: list[LLVMVector],
        limit: int,
        steady: bool = False,
    ) -> list[LLVMVector]:
        """Applies `body` to the lanes in which `condition` holds, until it holds in none, or `limit` times.

        A `steady` body does not change the lanes in which `condition` fails, so that they need no selection.
        """
        head, inside, after = (self.fresh(stem)[1:] for stem in ("head", "inside", "after"))
        starts, before, names = [x.text for x in state], self.block, [self.fresh() for _ in state]
        index, following = self.fresh("pass"), self.fresh("pass")
        self.lines.append(f"  br label %{head}")
        self.label(head)
        slot = len(self.lines)
        self.open()
        now = [LLVMVector(self, name) for name in names]
        active = condition(now)
        more = self.emit(f"and i1 {self.anywhere(active)}, {self.emit(f'icmp ult i32 {index}, {limit}')}")
        self.lines.append(f"  br i1 {more}, label %{inside}, label %{after}")
        self.label(inside)
        new = [x.text if steady else self.select(active, x, y).text for x, y in zip(body(now), now, strict=True)]
        self.lines += [f"  {following} = add i32 {index}, 1", f"  br label %{head}"]
        phis = [
            f"  {name} = phi {self.type} [{start}, %{before}], [{end}, %{self.block}]"
            for name, start, end in zip(names, starts, new, strict=True)
        ]
        self.lines[slot:slot] = [*phis, f"  {index} = phi i32 [0, %{before}], [{following}, %{self.block}]"]
        self.close()
        self.label(after)
        return [LLVMVector(self, name) for name in names]

    def when(
        self, mask: LLVMMask, values: list[LLVMVector], changed: Callable[[], list[LLVMVector]]
    ) -> list[LLVMVector]:
        """`changed()` in all lanes if the mask holds in any, else `values`; the caller selects by lane."""
        return self.branch(self.anywhere(mask), values, changed)

    def branch(self, bit: str, values: list[LLVMVector], changed: Callable[[], list[LLVMVector]]) -> list[LLVMVector]:
        """`changed()` where the single bit is set, else `values`."""
        inside, after = self.fresh("inside")[1:], self.fresh("after")[1:]
        otherwise, before = [x.text for x in values], self.block
        self.lines.append(f"  br i1 {bit}, label %{inside}, label %{after}")
        self.label(inside)
        self.open()
        then = [x.text for x in changed()]
        self.lines.append(f"  br label %{after}")
        last = self.block
        self.close()
        self.label(after)
        names = [y if x == y else self.fresh() for x, y in zip(then, otherwise, strict=True)]
        for name, x, y in zip(names, then, otherwise, strict=True):
            if x != y:
                self.lines.append(f"  {name} = phi {self.type} [{x}, %{last}], [{y}, %{before}]")
        return [LLVMVector(self, name) for name in names]
