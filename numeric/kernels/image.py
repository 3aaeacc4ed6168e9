"""Machine code as a flat image: laid out and joined once, so that a later process maps and calls it without LLVM.

An object file in the ELF format of x86-64 becomes its sections in one piece, with the places that need
the address where the piece will lie. Anything else is no image, and LLVM loads the object file itself.
"""

import struct
from typing import Any

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
