"""Kernels as machine code: specified, compiled, kept on disk, and called without the GIL.

llvmlite compiles the text, and ctypes calls the code. On disk is a flat image: the sections of the object file laid out
and linked once. A later process maps it into memory and calls it without importing LLVM, which halves the time until a
first orbit. Only an object file in the ELF format of x86-64 becomes an image; any other, or one with inconsistent
fields, is kept unchanged and loaded by LLVM. Files are not trusted: every offset, size, index and alignment is checked
before it is used.
"""

import ctypes
import struct
import warnings
from collections.abc import Callable, Sequence
from functools import cache as memoised
from typing import Any, NamedTuple

from numeric.backends.functions import CLOSED, Series
from numeric.backends.protocol import Backend, M, N, modulus
from numeric.flights.family import Array, Family
from numeric.lowering import cache

TANGENT = ("shift", "omega", "growth", "up", "down", "volume", "n0")
TOLD = ("component", "theta", "phi", "eta", "x", "y")
MATRIX = ("ds1/ds0", "ds1/dphi0", "dphi1/ds0", "dphi1/dphi0")
START = ("first component", "first theta", "first phi")  # the last rows of a kernel that starts by them
FAR = 2.0**100  # a double holds 2**1000
LINE = 64  # bytes that go to memory together


class KernelSpec(NamedTuple):
    """Specifies what a kernel computes, and what it records besides the last state."""

    law: str
    record: bool = False
    exponents: bool = False
    told: tuple[str, ...] = ()  # recorded in place of the state: fields of `TOLD`, `s`, `MATRIX`
    starts: bool = False  # from component, parameter and exit angle, in place of a state
    once: bool = False  # one bounce of particles in the caller's arrays, with no state afterwards
    length: Series = CLOSED  # the series of the arc length
    streams: bool = False  # records bypass the caches; they lie at multiples of `LINE` bytes

    @property
    def text(self) -> str:
        """The specification as a text, which is part of a kernel's key."""
        words = [word for word in ("record", "exponents", "starts", "once", "streams") if getattr(self, word)]
        how = ["-".join(map(str, self.length))] if "s" in self.told and self.length.terms else []
        return "-".join([self.law, *words, *self.told, *how])


def fields(family: Family, spec: KernelSpec) -> tuple[str, ...]:
    """The names of the rows of `state`, in order."""
    extra = (TANGENT if spec.exponents else ()) + (START if spec.starts else ())
    return (*family.fields(spec.law), *(("code", "lost") if family.stops else ()), *extra)


def starting(q: Array, omega: Array, n0: Array) -> list[Array]:
    """The rows `TANGENT` of a tangent vector at the start.

    `q` is the shift across the first flight, `omega` the change of its direction, and `n0` is `speed*cos(phi0)`.
    """
    nought = 0.0 * q
    return [q, omega, nought, nought + 1.0, nought + 1.0, nought, n0]


def rescaled(ops: Backend[N, M], rows: list[N]) -> list[N]:
    """The rows `TANGENT` of a tangent vector, with sizes far from 1 rescaled; called every `renormalise_every` bounces.

    With the rows called `q, omega, growth, up, down, volume, n0`, the vector is `(q, omega)*2**growth/down`, and the
    product of the bounces' `N0/N1` (`numeric.flights.family`), times their slopes if the law is no uniform contraction,
    is `2**volume*up/down`. So no bounce needs a logarithm or a division.
    """
    q, omega, growth, up, down, volume, n0 = rows
    size, one, nought = ops.maximum(modulus(q), modulus(omega)), ops.number(1.0), ops.number(0.0)
    away = (size < ops.number(1 / FAR)) | (ops.number(FAR) < size)
    for product in (up, down):
        away = away | (product < ops.number(1 / FAR)) | (ops.number(FAR) < product)

    def nearer() -> list[N]:
        (small, gained), (smaller, rise), (smallest, fall) = (
            [ops.select(away, x, otherwise) for x, otherwise in zip(ops.power_of_two(y), (one, nought), strict=True)]
            for y in (size, up, down)
        )
        scaled = [q * small, omega * small, growth + gained - fall]
        return [*scaled, up * smaller, down * smallest, volume + rise - fall, n0]

    return list(ops.when(away, rows, nearer))


SOURCES = ("numeric/backends", "numeric/flights", "numeric/kernels", "numeric/lowering")  # what a kernel depends on
Untyped = Any  # of llvmlite, ctypes and mmap
MAGIC = b"flat"
LAID_OUT, SYMBOLS, RELOCATIONS = 1, 2, 4  # kinds of sections: SHT_PROGBITS, SHT_SYMTAB, SHT_RELA
ALLOCATED, EXECUTABLE = 2, 4
ADDRESS, RELATIVE = 1, (2, 4)  # R_X86_64_64; R_X86_64_PC32 and PLT32
PAGE = 4096  # memory is mapped at multiples of it; a section cannot ask for more
LONGEST = 6 << 20  # characters of a kernel that is compiled; forty harmonics have half of it
LARGEST = 1 << 24  # bytes of an image; kernels have 10 to 100 thousand
NEAR = 64  # an address relative to the next instruction lies this much before what it means, at most


class ObjectSection(NamedTuple):
    """One line of the section table; all bytes of the section lie in the file."""

    kind: int
    flags: int
    begin: int
    size: int
    link: int
    target: int
    align: int


def image(code: bytes, entry: bytes = b"run") -> bytes | None:
    """The image of an object file; None if the file is of another format.

    It consists of a magic number, the count of addresses to relocate, the entry, these addresses' offsets, and the
    code.
    """
    sections = _sections(code)
    if sections is None:
        return None
    laid, at = bytearray(), dict[int, int]()
    for i, section in enumerate(sections):
        if section.kind == LAID_OUT and section.flags & ALLOCATED:
            laid += bytes(-len(laid) % max(section.align, 1))
            at[i] = len(laid)
            laid += code[section.begin : section.begin + section.size]
            if len(laid) > LARGEST:
                return None
    moved: list[int] = []
    for section in sections:
        if section.kind == RELOCATIONS and section.target in at:
            places = _joined(code, sections, section, at, laid)
            if places is None:
                return None
            moved += places
    found = _entry(code, sections, entry, at)
    if found is None:
        return None
    head = struct.pack(f"<4sIQ{len(moved)}Q", MAGIC, len(moved), found, *moved)
    return head + bytes(laid)


def _sections(code: bytes) -> list[ObjectSection] | None:
    """The section table of a relocatable x86-64 file; None when a field points outside the file or has no meaning."""
    if len(code) < 64 or code[:6] != b"\x7fELF\x02\x01" or struct.unpack_from("<HH", code, 16) != (1, 62):
        return None
    (start,), (size, count) = struct.unpack_from("<Q", code, 40), struct.unpack_from("<HH", code, 58)
    if size != 64 or start + 64 * count > len(code):
        return None
    found = []
    for i in range(count):
        _, kind, flags, _, begin, size, link, target, align, _ = struct.unpack_from("<IIQQQQIIQQ", code, start + 64 * i)
        if kind in (LAID_OUT, SYMBOLS, RELOCATIONS, 3):  # others are not read; 3 holds names
            whole = {SYMBOLS: 24, RELOCATIONS: 24}.get(kind, 1)
            if begin + size > len(code) or size % whole or align > PAGE or align & (align - 1):
                return None
            if kind in (SYMBOLS, RELOCATIONS) and link >= count:
                return None
        found.append(ObjectSection(kind, flags, begin, size, link, target, align))
    return found


def _joined(
    code: bytes, sections: list[ObjectSection], table: ObjectSection, at: dict[int, int], laid: bytearray
) -> list[int] | None:
    """Applies a table of relocations to `laid`, and returns the offsets of addresses in it; None for a bad table."""
    symbols, moved = sections[table.link], []
    if symbols.kind != SYMBOLS:
        return None
    for here, info, addend in struct.iter_unpack("<QQq", code[table.begin : table.begin + table.size]):
        index, kind = info >> 32, info & 0xFFFFFFFF
        if 24 * index >= symbols.size or kind not in (ADDRESS, *RELATIVE):
            return None
        _, _, _, section, value, _ = struct.unpack_from("<IBBHQQ", code, symbols.begin + 24 * index)
        width = 8 if kind == ADDRESS else 4
        if section not in at or value > sections[section].size or here + width > sections[table.target].size:
            return None
        place, goal = at[table.target] + here, at[section] + value + addend
        if not -NEAR <= goal <= len(laid):
            return None
        if kind == ADDRESS:
            moved.append(place)
            struct.pack_into("<q", laid, place, goal)
        else:
            struct.pack_into("<i", laid, place, goal - place)
    return moved


def _entry(code: bytes, sections: list[ObjectSection], entry: bytes, at: dict[int, int]) -> int | None:
    """The offset of the function named `entry` within the image; None if there is no such function."""
    for table in sections:
        if table.kind != SYMBOLS or sections[table.link].kind != 3:
            continue
        names = sections[table.link]
        text = code[names.begin : names.begin + names.size]
        for name, _, _, index, value, _ in struct.iter_unpack("<IBBHQQ", code[table.begin : table.begin + table.size]):
            if text[name : name + len(entry) + 1] != entry + b"\0" or index not in at:
                continue
            if sections[index].flags & EXECUTABLE and value < sections[index].size:
                return at[index] + int(value)
    return None


def entered(image: bytes) -> tuple[int, Untyped] | None:
    """The address of an image's function, in memory that is executable and no longer writable, and that memory's owner.

    None if the system refuses such memory, or if the bytes are no valid image (every offset must lie within the code).
    """
    import mmap

    if len(image) < 16 or image[:4] != MAGIC:
        return None
    count, entry = struct.unpack_from("<IQ", image, 4)
    begin = 16 + 8 * count
    if begin > len(image) or len(image) - begin > LARGEST:
        return None
    code = bytearray(image[begin:])
    places = struct.unpack_from(f"<{count}Q", image, 16)
    if entry >= len(code) or any(place + 8 > len(code) for place in places) or len(set(places)) < count:
        return None
    goals = [struct.unpack_from("<q", code, place)[0] for place in places]
    if not all(-NEAR <= goal <= len(code) for goal in goals):
        return None
    try:
        memory = mmap.mmap(-1, len(code))
        base = ctypes.addressof(ctypes.c_char.from_buffer(memory))
        for place, goal in zip(places, goals, strict=True):
            struct.pack_into("<q", code, place, goal + base)
        memory[:] = bytes(code)
        protect = ctypes.CDLL(None).mprotect
        protect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
        refused = protect(base, len(code), 1 | 4)  # read and execute
    except (OSError, AttributeError, ValueError, TypeError):
        return None
    return None if refused else (base + entry, memory)


Run = Callable[..., None]
_loaded: dict[tuple[str, ...], Untyped] = {}
_kept: list[Untyped] = []  # engines own the code that ctypes calls; they must outlive it


@memoised
def _llvm() -> Untyped:
    """The library llvmlite, or None when it is missing or cannot serve this machine."""
    try:
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    except Exception as reason:  # any failure here means one thing: use NumPy
        warnings.warn(
            f"llvmlite cannot be used ({reason}); maps run on NumPy arrays, about 20 times slower", stacklevel=2
        )
        return None
    return llvm


@memoised
def _processor() -> tuple[str, ...] | None:
    """Texts that identify the processor, from Linux or from LLVM; None if neither gives them."""
    try:
        with open("/proc/cpuinfo", "rb", buffering=0) as file:  # noqa: PTH123  (pathlib takes 3 ms to import)
            first = file.read(4096).partition(b"\n\n")[0].decode()
    except OSError:
        first = ""
    facts = [line for line in first.splitlines() if line.startswith(("vendor_id", "cpu family", "model", "flags"))]
    if len(facts) == 5 and len(first) < 4096:  # vendor_id, cpu family, model, model name, flags
        return tuple(facts)
    llvm = _llvm()
    return None if llvm is None else (llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten())


@memoised
def wide() -> bool:
    """Has the processor the 32 registers of AVX-512?"""
    words = " ".join(_processor() or ()).replace(",", " ").split()
    return "avx512f" in words or "+avx512f" in words


def _target() -> Untyped:
    llvm = _llvm()
    name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    return llvm.Target.from_default_triple().create_target_machine(cpu=name, features=features, opt=3)


def available() -> bool:
    """Can kernels be compiled here?"""
    return _llvm() is not None


def compiled(family: Family, identity: str, shape: Sequence[str], spec: KernelSpec, width: int) -> Run | None:
    """The kernel as a function, from memory, from disk, or newly compiled; None if only NumPy can be used.

    `identity` is a text that determines the family's steps, together with this package's sources.
    """
    key = (identity, family.name, spec.text, str(width), ",".join(shape))
    if key not in _loaded:
        version, processor = _version(), _processor()
        if version is None or processor is None:
            return None

        def written() -> str | None:
            from numeric.kernels.text import kernel_text

            text = kernel_text(family, shape, spec, width)
            if len(text) <= LONGEST:
                return text
            warnings.warn(
                f"the kernel of this table has {len(text) >> 20} MB of text, more than {LONGEST >> 20} that are "
                "compiled in some twenty seconds; it runs on NumPy arrays",
                stacklevel=4,
            )
            _loaded[key] = None
            return None

        _load(key, "kernel", (*key, cache.sources(*SOURCES), version, *processor), written)
    return _loaded.get(key)


def from_text(text: str) -> Run | None:
    """The function `run` in a module of LLVM text, with the arguments of a kernel; None when there is no compiler."""
    version, processor = _version(), _processor()
    if version is None or processor is None:
        return None
    stamp = cache.key_of(text), version, *processor
    if stamp not in _loaded:
        _load(stamp, "text", stamp, lambda: text)
    return _loaded.get(stamp)


def _load(key: tuple[str, ...], kind: str, stamp: tuple[str, ...], written: Callable[[], str | None]) -> None:
    """Sets `_loaded[key]` to a function from disk or compiled from `written()`; does nothing without a compiler."""
    code = cache.read(kind, *stamp)
    found = _entered(code) if code is not None else None
    if found is None:
        text = written() if _llvm() is not None else None
        if text is None:
            return
        code, found = _made(text)
        cache.write(kind, *stamp, code)
    assert found is not None
    _loaded[key] = _function(*found)


def _made(text: str) -> tuple[bytes, tuple[int, Untyped] | None]:
    """The code compiled from a text, as it is kept on disk, and its address in memory with that memory's owner."""
    made = object_code(text)
    code = image(made) or made
    found = _entered(code)
    return (code, found) if found is not None else (made, _entered(made))  # where only LLVM may make memory executable


def _function(address: int, owner: Untyped) -> Run:
    """The function at an address; it keeps the owner of its memory alive."""
    pointer, number = ctypes.c_void_p, ctypes.c_int64
    prototype = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, pointer, number, number, number, number)
    _kept.append(owner)
    return prototype(address)


def _entered(code: bytes) -> tuple[int, Untyped] | None:
    """The address of a kernel's code in memory, and the memory's owner. LLVM is needed only for an object file."""
    if code[: len(MAGIC)] == MAGIC:
        return entered(code)
    llvm = _llvm()
    if llvm is None:
        return None
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target())
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine.get_function_address("run"), engine


def optimised(text: str, target: Untyped = None) -> Untyped:
    """The LLVM module of a text after optimisation, for this machine or for a given target."""
    llvm = _llvm()
    target = target or _target()
    module = llvm.parse_assembly(text)
    module.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_unrolling = False
    passes = llvm.create_pass_builder(target, options).getModulePassManager()
    passes.run(module, llvm.create_pass_builder(target, options))
    return module


def object_code(text: str, target: Untyped = None) -> bytes:
    """The object file of a text, for this machine or for a given target of LLVM's."""
    target = target or _target()
    return bytes(target.emit_object(optimised(text, target)))


def _version() -> str | None:
    """The version of llvmlite, which is part of a kernel's key; None, and a warning, if llvmlite cannot be used."""
    try:
        import llvmlite
    except ImportError:
        return None if _llvm() is None else ""
    return str(llvmlite.__version__)
