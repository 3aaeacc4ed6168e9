"""Machine code as a flat image: laid out and joined once, so that a later process maps and calls it without LLVM.

An object file in the ELF format of x86-64 becomes its sections in one piece, with the places that need
the address where the piece will lie. Anything else is no image, and LLVM loads the object file itself.

From a kernel's text to machine code: compiled by llvmlite, kept on disk, called through ctypes without the GIL.
"""

import ctypes
import struct
import warnings
from collections.abc import Callable, Sequence
from functools import cache as memoised
from typing import Any

from numeric.flights.family import Family
from numeric.kernels.spec import KernelSpec
from numeric.lowering import cache

MAGIC = b"flat"
ALLOCATED, RELOCATIONS, SYMBOLS = 2, 4, 2
ADDRESS, RELATIVE = 1, (2, 4)  # R_X86_64_64; R_X86_64_PC32 and PLT32


def image(code: bytes, entry: bytes = b"run") -> bytes | None:
    """The image of an object file: magic, size of what precedes the code, entry, places to move, code."""
    if code[:6] != b"\x7fELF\x02\x01" or struct.unpack_from("<HH", code, 16) != (1, 62):
        return None
    (start,), (count,) = struct.unpack_from("<Q", code, 40), struct.unpack_from("<H", code, 60)
    sections = [struct.unpack_from("<IIQQQQIIQQ", code, start + 64 * i) for i in range(count)]
    laid, at = bytearray(), {}
    for i, (_, kind, flags, _, offset, size, _, _, align, _) in enumerate(sections):
        if kind == 1 and flags & ALLOCATED:
            laid += bytes(-len(laid) % max(align, 1))
            at[i] = len(laid)
            laid += code[offset : offset + size]
    moved = []
    for _, kind, _, _, offset, size, link, target, _, _ in sections:
        if kind != RELOCATIONS or target not in at:
            continue
        for here, info, addend in struct.iter_unpack("<QQq", code[offset : offset + size]):
            _, _, _, section, value, _ = struct.unpack_from("<IBBHQQ", code, sections[link][4] + 24 * (info >> 32))
            place, kind = at[target] + here, info & 0xFFFFFFFF
            if section not in at or kind not in (ADDRESS, *RELATIVE):
                return None
            goal = at[section] + value + addend
            if kind == ADDRESS:
                moved.append(place)
                struct.pack_into("<q", laid, place, goal)
            else:
                struct.pack_into("<i", laid, place, goal - place)
    found = _entry(code, sections, entry, at)
    if found is None:
        return None
    head = struct.pack(f"<4sIQ{len(moved)}Q", MAGIC, len(moved), found, *moved)
    return head + bytes(laid)


def _entry(code: bytes, sections: list[Any], entry: bytes, at: dict[int, int]) -> int | None:
    """Where the function of this name begins."""
    for _, kind, _, _, offset, size, link, _, _, _ in sections:
        if kind == SYMBOLS:
            for name, _, _, section, value, _ in struct.iter_unpack("<IBBHQQ", code[offset : offset + size]):
                text = sections[link][4] + name
                if section in at and code[text : code.index(b"\0", text)] == entry:
                    return int(at[section] + value)
    return None


def entered(image: bytes) -> tuple[int, Any] | None:
    """The address of the function in memory of its own, executable and no longer writable, and that memory's owner."""
    import ctypes
    import mmap

    count, entry = struct.unpack_from("<IQ", image, 4)
    begin = 16 + 8 * count
    code = bytearray(image[begin:])
    try:
        memory = mmap.mmap(-1, len(code))
        base = ctypes.addressof(ctypes.c_char.from_buffer(memory))
        for place in struct.unpack_from(f"<{count}Q", image, 16):
            (goal,) = struct.unpack_from("<q", code, place)
            struct.pack_into("<q", code, place, goal + base)
        memory[:] = bytes(code)
        protect = ctypes.CDLL(None).mprotect
        protect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
        refused = protect(base, len(code), 1 | 4)  # read and execute
    except (OSError, AttributeError, ValueError, TypeError):
        return None
    return None if refused else (base + entry, memory)


Run = Callable[..., None]
_loaded: dict[tuple[str, ...], Any] = {}
_kept: list[Any] = []  # engines own the code that ctypes calls; they must outlive it


@memoised
def _llvm() -> Any:
    """The library, or None when it is missing or cannot serve this machine."""
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
    """What tells this processor from others: Linux says it at once, elsewhere LLVM is asked."""
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


def _target() -> Any:
    llvm = _llvm()
    name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    return llvm.Target.from_default_triple().create_target_machine(cpu=name, features=features, opt=3)


def available() -> bool:
    """Can kernels be compiled here?"""
    return _llvm() is not None


def compiled(family: Family, identity: str, shape: Sequence[str], question: KernelSpec, width: int) -> Run | None:
    """The kernel as a function, from memory, from disk, or newly made; None when only NumPy is left.

    `identity` names the blueprint: everything the family's steps depend on besides this package's text.
    """
    key = (identity, family.name, question.text, str(width), ",".join(shape))
    if key not in _loaded:
        version, processor = _version(), _processor()
        if version is None or processor is None:
            return None
        stamp = (*key, cache.sources("numeric"), version, *processor)
        code = cache.read("kernel", *stamp)
        found = _entered(code) if code is not None else None
        if found is None:
            if _llvm() is None:
                return None
            from numeric.kernels.text import kernel_text

            made = object_code(kernel_text(family, shape, question, width))
            code = image(made) or made
            found = _entered(code)
            if found is None:  # a system that lets nobody but LLVM make memory executable
                code, found = made, _entered(made)
            cache.write("kernel", *stamp, code)
        assert found is not None
        address, owner = found
        pointer, number = ctypes.c_void_p, ctypes.c_int64
        prototype = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, pointer, number, number, number, number)
        _kept.append(owner)
        _loaded[key] = prototype(address)
    return _loaded[key]  # type: ignore[no-any-return]


def _entered(code: bytes) -> tuple[int, Any] | None:
    """The address of the kernel in memory and what owns it: an image needs no LLVM, an object file does."""
    if code[: len(MAGIC)] == MAGIC:
        return entered(code)
    llvm = _llvm()
    if llvm is None:
        return None
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target())
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine.get_function_address("run"), engine


def optimised(text: str) -> Any:
    """The module after LLVM's passes."""
    llvm = _llvm()
    module = llvm.parse_assembly(text)
    module.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_unrolling = False
    passes = llvm.create_pass_builder(_target(), options).getModulePassManager()
    passes.run(module, llvm.create_pass_builder(_target(), options))
    return module


def object_code(text: str) -> bytes:
    """The object file for this machine."""
    return bytes(_target().emit_object(optimised(text)))


def assembly(text: str) -> str:
    """What the processor will run, for reading."""
    return str(_target().emit_assembly(optimised(text)))


def _version() -> str | None:
    """The version of the compiler that writes the code; None, and a warning, where there is none."""
    try:
        import llvmlite
    except ImportError:
        return None if _llvm() is None else ""
    return str(llvmlite.__version__)
