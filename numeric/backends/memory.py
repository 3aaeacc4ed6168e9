"""Constants in memory, which each lane of an LLVM vector loads by its own index, number by number or in rows."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numeric.backends.llvm import LLVMBackend, LLVMVector

FOUR = "<4 x double>"


def gathered(ops: "LLVMBackend", values: Sequence[float], index: "LLVMVector") -> str:
    """The constant at the index of each lane; the first constant where the index is out of range."""
    name, whole, places = _array(ops, values), _whole(ops, len(values), index), f"<{ops.width} x i32>"
    pointers = ops.emit(f"getelementptr double, ptr {name}, {places} {whole}")
    gather, kind = f"{ops.type} @llvm.masked.gather.v{ops.width}f64.v{ops.width}p0", f"<{ops.width} x ptr>"
    ops.called.add(f"declare {gather}({kind}, i32, {ops.masks}, {ops.type})")
    given = f"{kind} {pointers}, i32 8, {ops.masks} splat (i1 true), {ops.type} poison"
    return ops.emit(f"call {gather}({given})")


def columns(ops: "LLVMBackend", rows: Sequence[Sequence[float]], index: "LLVMVector") -> list[str]:
    """The entries, column by column, of a table's row at the index of each lane; the first row if it is out of range.

    A lane loads four neighbouring entries at once, and eight shuffles turn the rows of four lanes into columns. This is
    less work than to gather the entries one by one.
    """
    count, places = len(rows[0]), f"<{ops.width} x i32>"
    name, whole = _array(ops, [x for row in rows for x in row]), _whole(ops, len(rows), index)
    begins = ops.emit(f"mul {places} {whole}, splat (i32 {count})")
    at = [ops.emit(f"extractelement {places} {begins}, i32 {lane}") for lane in range(ops.width)]
    pointers = [ops.emit(f"getelementptr double, ptr {name}, i32 {begin}") for begin in at]
    found: list[str] = []
    for first in range(0, count - count % 4, 4):
        where = [ops.emit(f"getelementptr double, ptr {pointer}, i32 {first}") for pointer in pointers]
        found += _turned(ops, [ops.emit(f"load {FOUR}, ptr {place}, align 8") for place in where])
    for i in range(len(found), count):
        column = "poison"
        for lane, pointer in enumerate(pointers):
            place = ops.emit(f"getelementptr double, ptr {pointer}, i32 {i}")
            number = ops.emit(f"load double, ptr {place}, align 8")
            column = ops.emit(f"insertelement {ops.type} {column}, double {number}, i32 {lane}")
        found.append(column)
    return found


def _array(ops: "LLVMBackend", values: Sequence[float]) -> str:
    """The name of a constant array in memory that has these values."""
    items = ", ".join(ops.literal(x)[len("splat (") : -1] for x in values)
    return ops.constants.setdefault(f"[{len(values)} x double] [{items}]", f"@array{len(ops.constants)}")


def _whole(ops: "LLVMBackend", count: int, index: "LLVMVector") -> str:
    """The index as an integer; 0 where it is `count` or more."""
    known = (ops.number(-0.5) < index) & (index < ops.number(count - 0.5))
    inside = ops.select(known, index, ops.number(0.0)).text
    return ops.emit(f"fptosi {ops.type} {inside} to <{ops.width} x i32>")


def _turned(ops: "LLVMBackend", loaded: list[str]) -> list[str]:
    """Transposes: from the four entries that each lane has loaded to four vectors over the lanes."""

    def mixed(x: str, y: str, size: int, places: Sequence[int]) -> str:
        kind, order = f"<{size} x double>", ", ".join(f"i32 {place}" for place in places)
        return ops.emit(f"shufflevector {kind} {x}, {kind} {y}, <{len(places)} x i32> <{order}>")

    blocks: list[list[str]] = []
    for lane in range(0, ops.width, 4):
        rows = (loaded[lane : lane + 4] * 4)[:4]
        pairs = [(mixed(x, y, 4, (0, 4, 2, 6)), mixed(x, y, 4, (1, 5, 3, 7))) for x, y in (rows[:2], rows[2:])]
        blocks.append([mixed(pairs[0][i], pairs[1][i], 4, (k, k + 1, k + 4, k + 5)) for k in (0, 2) for i in (0, 1)])
    size = 4
    while len(blocks) > 1:
        two = zip(blocks[::2], blocks[1::2], strict=True)
        blocks = [[mixed(x, y, size, range(2 * size)) for x, y in zip(*both, strict=True)] for both in two]
        size *= 2
    return blocks[0] if ops.width >= size else [mixed(x, x, size, range(ops.width)) for x in blocks[0]]
