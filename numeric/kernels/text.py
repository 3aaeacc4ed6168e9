"""The LLVM text of a kernel: blocks of lanes, each bounced many times, for one family, one law and one `KernelSpec`.

    void run(double state[], const double lam[], const double shape[], double record[],
             int64 width, int64 first, int64 last, int64 bounces)

`state` holds one row of `width` doubles for each field. First come the fields of the particle's own state, then `code`
and `lost` if the family has outcomes; then those of the tangent vector for exponents, or the component, parameter and
exit angle from which a particle starts. The kernel works on columns `first` to `last`. To record states, `record`
receives the particle's own rows after every bounce. To record other fields (parameter, angles, point, arc length),
`record` is a table: an address for each field, then the number of doubles between two bounces, so that a kernel writes
where its caller wants the data. In a kernel of one bounce (`once`) `state` is a table too: the addresses of the
particles' component, parameter and exit angle, and of their outcomes; no state is kept. In `shape` the numbers of the
arc length follow those of the shape.

Inside, the processor flushes numbers below 2**-1022 to zero: a particle at rest on a cycle reaches them, and on many
processors such an operation takes sixty times as long. The caller's mode is restored on return.
"""

import platform
import re
from collections.abc import Sequence
from typing import NamedTuple

from numeric.backends.llvm import LLVMBackend, LLVMVector
from numeric.flights.family import ELASTIC, SLAP, Family, Landing
from numeric.kernels.machine import LINE, MATRIX, START, TANGENT, KernelSpec, fields, rescaled, wide

NAME = re.compile(r"%[A-Za-z0-9_]+")
HEAD = (
    "define void @run(ptr noalias %state, ptr noalias %lam, ptr noalias %shape, ptr noalias %record, "
    "i64 %width, i64 %first, i64 %last, i64 %bounces) #0 {"
)
TAIL = (
    'attributes #0 = { nounwind alignstack=64 "prefer-vector-width"="512" "min-legal-vector-width"="512" '
    '"denormal-fp-math"="preserve-sign,preserve-sign" }'
)


class Mode(NamedTuple):
    """The code that makes a processor flush subnormal numbers to zero: on entry, on exit, and its declarations."""

    entry: tuple[str, ...] = ()
    exit: tuple[str, ...] = ()
    declared: tuple[str, ...] = ()


X86 = Mode(  # the bits "flush to zero", of results, and "denormals are zeros", of operands, of the register MXCSR
    (
        "%mode = alloca i32, align 4",
        "%flushed = alloca i32, align 4",
        "call void @llvm.x86.sse.stmxcsr(ptr %mode)",
        "%found = load i32, ptr %mode, align 4",
        f"%flushing = or i32 %found, {0x8040}",
        "store i32 %flushing, ptr %flushed, align 4",
        "call void @llvm.x86.sse.ldmxcsr(ptr %flushed)",
    ),
    ("call void @llvm.x86.sse.ldmxcsr(ptr %mode)",),
    ("declare void @llvm.x86.sse.ldmxcsr(ptr)", "declare void @llvm.x86.sse.stmxcsr(ptr)"),
)
ARM = Mode(  # the bit FZ, of both, of the register FPCR
    (
        "%mode = call i64 @llvm.aarch64.get.fpcr()",
        f"%flushing = or i64 %mode, {1 << 24}",
        "call void @llvm.aarch64.set.fpcr(i64 %flushing)",
    ),
    ("call void @llvm.aarch64.set.fpcr(i64 %mode)",),
    ("declare i64 @llvm.aarch64.get.fpcr()", "declare void @llvm.aarch64.set.fpcr(i64)"),
)
MODES = {"x86_64": X86, "amd64": X86, "aarch64": ARM, "arm64": ARM}  # elsewhere subnormal numbers stay what they are


def kernel_text(family: Family, shape: Sequence[str], spec: KernelSpec, width: int = 0, processor: str = "") -> str:
    """The kernel as LLVM text, for a kind of processor (as `platform.machine` names it), by default this machine's."""
    mode = MODES.get((processor or platform.machine()).lower(), Mode())
    ops = LLVMBackend(width or family.width)
    names = fields(family, spec)
    own = len(family.fields(spec.law))
    ops.label("entry")
    ops.lines += [f"  {line}" for line in mode.entry]
    parameters = [_broadcast(ops, i, name) for i, name in enumerate(shape)]
    series = [_broadcast(ops, len(shape) + i, f"of length {i}") for i in range(spec.length.size)]
    goals = [_entry(ops, "record", "ptr", i) for i in range(len(spec.told))]
    far_apart = _entry(ops, "record", "i64", len(goals)) if goals else ""
    given = [_entry(ops, "state", "ptr", i) for i in range(len(START) + family.stops)] if spec.once else []
    ops.lines += ["  br label %column", "column:", "  %at = phi i64 [%first, %entry], [%next, %stored]"]
    ops.lines += ["  %busy = icmp slt i64 %at, %last", "  br i1 %busy, label %start, label %exit"]
    ops.label("start")
    ops.open()
    if spec.once:
        addresses = [ops.emit(f"getelementptr double, ptr {goal}, i64 %at") for goal in given]
    else:
        addresses = [_address(ops, "state", ops.emit(f"mul i64 %width, {i}")) for i in range(len(names))]
    loaded = [ops.emit(f"load {ops.type}, ptr {address}, align 8") for address in addresses]
    if spec.starts:
        loaded = _started(ops, family, spec.law, parameters, loaded[-len(START) :]) + loaded[own : -len(START)]
        names, addresses = names[: -len(START)], addresses[: -len(START)]
    if spec.once:
        nothing = [ops.literal(0.0)] * (2 * family.stops)  # code and lost
        loaded = _started(ops, family, spec.law, parameters, loaded[: len(START)]) + nothing
    if spec.starts and not spec.told:
        return _module(ops, family, spec, _stored(ops, loaded, addresses), mode)
    lam = _contraction(ops, spec.law)
    particle = [LLVMVector(ops, name) for name in loaded[:own]]
    place = particle[: len(family.position)]
    carried = [x.text for x in family.kept(ops, parameters, place)] if spec.exponents else []
    before = ops.block
    outer = [ops.fresh() for _ in [*names, *carried]]
    ops.lines += ["  %some = icmp sgt i64 %bounces, 0", "  br i1 %some, label %stretch, label %done"]
    ops.label("stretch")
    far = len(ops.lines)
    ops.open()
    stretch = f"add i64 %begun, {family.renormalise_every}" if spec.exponents else "add i64 %bounces, 0"
    ops.lines += [f"  %full = {stretch}", "  %short = icmp slt i64 %full, %bounces"]
    ops.lines += ["  %until = select i1 %short, i64 %full, i64 %bounces", "  br label %bounce"]
    ops.label("bounce")
    slot = len(ops.lines)
    ops.open()
    state = [ops.fresh() for _ in [*names, *carried]]
    new, landed = _bounced(ops, family, spec, parameters, lam, [LLVMVector(ops, name) for name in state])
    texts = [x.text for x in new]
    if spec.told:
        particle = [LLVMVector(ops, name) for name in state[:own]]
        told = _told(ops, family, spec, parameters, series, lam, particle, landed)
        _tell(ops, [x.text for x in told], goals, far_apart, spec.streams)
    elif spec.record:
        _record(ops, texts[:own])
    ops.lines += ["  %following = add i64 %i, 1", "  %more = icmp slt i64 %following, %until"]
    ops.lines.append("  br i1 %more, label %bounce, label %measured")
    ops.lines[slot:slot] = _joined(ops, "i", state, ("stretch", "%begun", outer), (ops.block, "%following", texts))
    ops.close()
    ops.label("measured")
    if spec.exponents:
        at = own + (2 if family.stops else 0)
        rows = [LLVMVector(ops, name) for name in texts[at : at + len(TANGENT)]]
        texts[at : at + len(TANGENT)] = [x.text for x in rescaled(ops, rows)]
    ops.lines += ["  %again = icmp slt i64 %following, %bounces", "  br i1 %again, label %stretch, label %done"]
    last = ops.block
    origin = loaded + carried
    ops.lines[far:far] = _joined(ops, "begun", outer, (before, "0", origin), (last, "%following", texts))
    ops.close()
    ops.label("done")
    finals = [ops.fresh() for _ in names]
    for name, begin, end in zip(finals, loaded, texts[: len(names)], strict=True):
        ops.lines.append(f"  {name} = phi {ops.type} [{begin}, %{before}], [{end}, %{last}]")
    if spec.once:
        finals, addresses = finals[own : own + family.stops], addresses[len(START) :]
    return _module(ops, family, spec, _stored(ops, finals, addresses), mode)


def _stored(ops: LLVMBackend, rows: Sequence[str], addresses: Sequence[str]) -> list[str]:
    """Lines that end a block of lanes: they store its rows, and go on to the next block."""
    stores = [f"  store {ops.type} {row}, ptr {address}, align 8" for row, address in zip(rows, addresses, strict=True)]
    return [*stores, "  br label %stored", "stored:", f"  %next = add i64 %at, {ops.width}", "  br label %column"]


def _module(ops: LLVMBackend, family: Family, spec: KernelSpec, end: list[str], mode: Mode) -> str:
    """The text of the whole LLVM module: the lines written so far, followed by the lines `end`."""
    lines = [*ops.lines, *end, "exit:", *(f"  {line}" for line in mode.exit)]
    title = f"; {family.name}, {spec.text}: written by numeric.kernels.text from numeric.flights"
    arrays = [f"{name} = private unnamed_addr constant {array}, align 64" for array, name in ops.constants.items()]
    declared = [*sorted(ops.called), *mode.declared]
    order = f' "tune-cpu"="{family.order}"' if family.order and mode is X86 and not wide() else ""
    tail = TAIL.replace(" }", f"{order} }}")
    seen, marks = (["  fence seq_cst"], ["!0 = !{i32 1}"]) if spec.streams else ([], [])  # stores are visible on return
    return "\n".join([title, *arrays, HEAD, *alive(lines), *seen, "  ret void", "}", *declared, tail, *marks, ""])


def _joined(
    ops: LLVMBackend, index: str, names: list[str], first: tuple[str, str, list[str]], again: tuple[str, str, list[str]]
) -> list[str]:
    """The phi instructions of a loop's head: index and rows come from the block before it, or from its last block."""
    (before, zero, begins), (last, following, ends) = first, again
    phis = [f"  %{index} = phi i64 [{zero}, %{before}], [{following}, %{last}]"]
    for name, begin, end in zip(names, begins, ends, strict=True):
        phis.append(f"  {name} = phi {ops.type} [{begin}, %{before}], [{end}, %{last}]")
    return phis


def _broadcast(ops: LLVMBackend, i: int, name: str) -> LLVMVector:
    """The number `i` of the shape, in every lane."""
    address = ops.emit(f"getelementptr double, ptr %shape, i64 {i}")
    scalar = ops.emit(f"load double, ptr {address}, align 8", key=f"shape {name}")
    one = ops.emit(f"insertelement {ops.type} poison, double {scalar}, i64 0")
    everywhere = f"<{ops.width} x i32> zeroinitializer"
    return LLVMVector(ops, ops.emit(f"shufflevector {ops.type} {one}, {ops.type} poison, {everywhere}"))


def _address(ops: LLVMBackend, base: str, row: str) -> str:
    """Writes the address of the current block in a row that begins `row` doubles after `base`."""
    return ops.emit(f"getelementptr double, ptr %{base}, i64 {ops.emit(f'add i64 {row}, %at')}")


def _started(ops: LLVMBackend, family: Family, law: str, shape: list[LLVMVector], rows: list[str]) -> list[str]:
    """The fields of the state of particles that leave from `rows`: component, parameter and exit angle."""
    component, theta, phi = (LLVMVector(ops, row) for row in rows)
    position = family.enter(ops, component, theta)
    if law == SLAP:
        return [x.text for x in position]
    frame = family.framed(ops, shape, position)
    assert frame is not None, family.name
    return [x.text for x in (*position, *family.exit_fields(ops, frame, phi))]


def _told(
    ops: LLVMBackend,
    family: Family,
    spec: KernelSpec,
    shape: list[LLVMVector],
    series: list[LLVMVector],
    lam: LLVMVector,
    before: list[LLVMVector],
    landing: Landing[LLVMVector] | None,
) -> list[LLVMVector]:
    """The recorded fields of a landing, with the angles of its reflection; meaningless for a particle that stops.

    Fields that are not recorded cost nothing: nothing depends on them, so their lines are removed from the text.
    """
    assert landing is not None
    component, theta = family.place(ops, landing.position)
    frame = family.framed(ops, shape, landing.position)
    assert frame is not None, family.name
    incidence = family.incidence(ops, landing)
    phi = ops.number(0.0) if spec.law == SLAP else family.exit_angle(ops, spec.law, lam, landing)
    known = {"component": component, "theta": theta, "phi": phi, "eta": -incidence, "x": frame.x, "y": frame.y}
    if "s" in spec.told:
        known["s"] = family.along(ops, landing.position, theta, spec.length, series)
    if MATRIX[0] in spec.told:
        known |= zip(MATRIX, _matrix(ops, family, spec.law, shape, lam, before, landing), strict=True)
    return [known[name] for name in spec.told]


def _matrix(
    ops: LLVMBackend,
    family: Family,
    law: str,
    shape: list[LLVMVector],
    lam: LLVMVector,
    before: list[LLVMVector],
    landing: Landing[LLVMVector],
) -> list[LLVMVector]:
    """The entries `machine.MATRIX` of the derivative of a bounce, by the tangent map of `numeric.flights.family`."""
    position, exit = before[: len(family.position)], before[len(family.position) :]
    n0, (rate, curvature) = family.exit_normal_speed(ops, shape, position, exit), family.curving(ops, shape, position)
    ends = family.kept(ops, shape, position), family.kept(ops, shape, landing.position)
    t = family.length(ops, shape, n0, *ends, landing)
    rate1, curvature1 = family.curving(ops, shape, landing.position)
    turned, scale = (curvature, ops.number(1.0)), -rate1 / landing.along
    moved = [(t * curvature + n0 / rate) * scale, t * scale]
    return [*moved, *(lam * (curvature1 * x - y) for x, y in zip(moved, turned, strict=True))]


def _entry(ops: LLVMBackend, table: str, kind: str, i: int) -> str:
    """Writes the load of entry `i` of a table of addresses; returns the value, of the LLVM type `kind`."""
    return ops.emit(f"load {kind}, ptr {ops.emit(f'getelementptr i64, ptr %{table}, i64 {i}')}, align 8")


def _tell(ops: LLVMBackend, texts: list[str], goals: Sequence[str], apart: str, streams: bool) -> None:
    """Writes instructions that store the recorded fields of bounce `%i` at the addresses `goals`."""
    place = ops.emit(f"add i64 {ops.emit(f'mul i64 %i, {apart}')}, %at")
    for text, goal in zip(texts, goals, strict=True):
        address = ops.emit(f"getelementptr double, ptr {goal}, i64 {place}")
        how = f"{LINE}, !nontemporal !0" if streams else "8"
        ops.lines.append(f"  store {ops.type} {text}, ptr {address}, align {how}")


def _record(ops: LLVMBackend, texts: list[str]) -> None:
    """Writes instructions that store the particle's own rows of bounce `%i`."""
    page = ops.emit(f"mul i64 %i, {len(texts)}")
    for i, text in enumerate(texts):
        row = ops.emit(f"mul i64 {ops.emit(f'add i64 {page}, {i}')}, %width")
        ops.lines.append(f"  store {ops.type} {text}, ptr {_address(ops, 'record', row)}, align 8")


def alive(lines: list[str]) -> list[str]:
    """The lines without those on which no store and no branch depends.

    >>> alive(["  %a = fadd double 1.0, 2.0", "  %b = fadd double 3.0, 4.0", "  store double %b, ptr %p"])
    ['  %b = fadd double 3.0, 4.0', '  store double %b, ptr %p']
    """
    uses = {}
    needed: list[str] = []
    for line in lines:
        name, found, text = line.strip().partition(" = ")
        if found and name.startswith("%"):
            uses[name] = NAME.findall(text)
        else:
            needed += NAME.findall(line)
    kept: set[str] = set()
    while needed:
        name = needed.pop()
        if name not in kept:
            kept.add(name)
            needed += uses.get(name, [])
    return [line for line in lines if (line.strip().partition(" = ")[0] in kept) or " = " not in line]


def operations(text: str) -> dict[str, int]:
    """The number of vector instructions of each kind in one bounce, not counting branches that are rarely taken."""
    counts = dict.fromkeys(("fma", "add", "mul", "div", "sqrt", "compare", "select"), 0)
    words = {"fadd": "add", "fsub": "add", "fmul": "mul", "fdiv": "div", "fcmp": "compare", "select": "select"}
    rare = True
    for line in text.splitlines():
        if line.endswith(":"):
            rare = line.startswith(("entry", "start", "stretch", "measured", "inside", "head"))
        elif not rare and " = " in line:
            word = line.partition(" = ")[2].split()[0]
            if word in words:
                counts[words[word]] += 1
            for name in ("fma", "sqrt"):
                counts[name] += f"@llvm.{name}." in line
    return counts


def _contraction(ops: LLVMBackend, law: str) -> LLVMVector:
    if law in (SLAP, ELASTIC):
        return ops.number(0.0 if law == SLAP else 1.0)
    address = ops.emit("getelementptr double, ptr %lam, i64 %at")
    return LLVMVector(ops, ops.emit(f"load {ops.type}, ptr {address}, align 8"))


def _bounced(
    ops: LLVMBackend,
    family: Family,
    spec: KernelSpec,
    shape: list[LLVMVector],
    lam: LLVMVector,
    state: list[LLVMVector],
) -> tuple[list[LLVMVector], Landing[LLVMVector] | None]:
    """All rows after one bounce, and the landing (None if there is a tangent vector).

    A lane whose bounce has an outcome keeps its rows, and counts the bounces that it misses.
    """
    count = len(family.fields(spec.law))
    own, rest = state[:count], state[count:]
    outcome, rest = (rest[:2], rest[2:]) if family.stops else ([], rest)
    if spec.exponents:
        vector, kept = rest[: len(TANGENT)], rest[len(TANGENT) :]
        particle, code, rows, kept = family.bounce_with_tangent(ops, spec.law, shape, lam, own, vector, kept)
        rest_new, landing = rows + kept, None
    else:
        landing, leaving = family.flown(ops, spec.law, shape, lam, own)
        particle, code, rest_new = landing.position + leaving, landing.code, []
    new = [*particle, *rest_new]
    if code is None or not family.stops:
        return [*particle, *outcome, *rest_new], landing
    stopped = ops.number(0.5) < code

    def frozen() -> list[LLVMVector]:
        kept = [ops.select(stopped, x, y) for x, y in zip([*own, *rest], new, strict=True)]
        first = ops.select(stopped, code, outcome[0])
        return [first, outcome[1] + ops.select(stopped, ops.number(1.0), ops.number(0.0)), *kept]

    code_row, lost_row, *new = ops.when(stopped, [*outcome, *new], frozen)
    return [*new[:count], code_row, lost_row, *new[count:]], landing
