"""Kernels that are loaded without LLVM are the kernels that LLVM loads."""

import ctypes
import struct
import sys

import numpy as np
import pytest
from attacks.machine_code import images

from numeric import PinballMap
from numeric.kernels import machine
from numeric.kernels.machine import MAGIC, KernelSpec, entered, image
from numeric.kernels.text import kernel_text


def bounced(address, rows, lam, bounces):
    """The rows after some bounces, called as the engine calls a kernel."""
    state, nothing = np.array(rows), np.zeros(1)
    pointer, number = ctypes.c_void_p, ctypes.c_int64
    run = ctypes.CFUNCTYPE(None, *[pointer] * 4, *[number] * 4)(address)
    width = state.shape[1]
    run(state.ctypes.data, lam.ctypes.data, nothing.ctypes.data, None, width, 0, width, bounces)
    return state


def test_an_image_runs_as_the_object_file_it_was_made_of():
    map = PinballMap("cardioid", lam=0.9)
    code = machine.object_code(kernel_text(map.family, map.engine.names, KernelSpec(map.law)))
    theta = np.linspace(-3, 3, map.family.width)
    rows = [np.cos(theta / 2), np.sin(theta / 2), np.cos(theta / 3), np.sin(theta / 3), 0 * theta, 0 * theta]
    (address, _owner), lam = machine._entered(code), np.full(theta.size, 0.9)
    expected = bounced(address, rows, lam, 50)
    flat = image(code)

    if flat is None:  # another machine: LLVM loads the file, as it just did
        assert code[:4] != b"\x7fELF" or code[18:20] != b"\x3e\x00"
    else:
        address, _memory = entered(flat)
        assert np.array_equal(bounced(address, rows, lam, 50), expected)


@pytest.mark.parametrize(
    "code", [b"", b"MZ" + bytes(200), b"\x7fELF\x02\x01" + bytes(200)], ids=["none", "coff", "empty"]
)
def test_what_is_no_object_file_of_this_kind_is_no_image(code):
    assert image(code) is None


def test_an_image_that_cannot_be_mapped_is_left_to_the_compiler():
    assert entered(MAGIC + bytes(12)) is None


def elf(relocations, symbols, text=bytes(range(32)), data=b"datadata", machine_code=62):
    """An object file with a text of 32 bytes, eight bytes of data aligned to 16, and the tables given.

    A relocation is (place in the text, kind, index of a symbol, addend), a symbol (name, section, value); section 1 is
    the text, 2 the data, 3 and beyond are not laid out.
    """
    names = b"\0" + b"".join(name + b"\0" for name, _, _ in symbols)
    at = [names.index(b"\0" + name + b"\0") + 1 for name, _, _ in symbols]
    table = b"".join(
        struct.pack("<IBBHQQ", place, 0, 0, section, value, 0)
        for place, (_, section, value) in zip(at, symbols, strict=True)
    )
    moves = b"".join(struct.pack("<QQq", here, index << 32 | kind, add) for here, kind, index, add in relocations)
    blobs = [b"", text, data, moves, table, names, b"notes"]
    heads = [
        (0, 0, 0, 0, 1),
        (1, 6, 0, 0, 16),
        (1, 2, 0, 0, 16),
        (4, 0, 4, 1, 8),
        (2, 0, 5, 0, 8),
        (3, 0, 0, 0, 1),
        (1, 0, 0, 0, 1),
    ]
    body, sections = b"", b""
    for blob, (kind, flags, link, target, align) in zip(blobs, heads, strict=True):
        sections += struct.pack("<IIQQQQIIQQ", 0, kind, flags, 0, 64 + len(body), len(blob), link, target, align, 0)
        body += blob
    head = b"\x7fELF\x02\x01" + bytes(10) + struct.pack("<HH", 1, machine_code) + bytes(20)
    head += struct.pack("<Q", 64 + len(body)) + bytes(10) + struct.pack("<HHH", 64, len(blobs), 5)
    return head[:64] + body + sections


RUN, DATA = (b"run", 1, 4), (b"numbers", 2, 2)


def parts(flat):
    """Entry, places to move and code of an image."""
    magic, count, entry = struct.unpack_from("<4sIQ", flat)
    assert magic == MAGIC
    return entry, struct.unpack_from(f"<{count}Q", flat, 16), flat[16 + 8 * count :]


def test_sections_are_laid_out_aligned_and_the_entry_is_found():
    text = bytes(range(1, 29))  # 28 bytes, so that the data begin at 32
    entry, moved, code = parts(image(elf([], [DATA, RUN], text)))

    assert (entry, moved) == (4, ())
    assert code == text + bytes(4) + b"datadata"


def test_places_are_joined_by_address_or_by_distance():
    relocations = [(0, 1, 1, 3), (8, 2, 1, -4), (16, 4, 0, 1), (24, 1, 0, 0)]
    entry, moved, code = parts(image(elf(relocations, [RUN, DATA])))
    goal = 32 + 2  # the data, and the symbol within them

    assert (entry, moved) == (4, (0, 24))
    assert struct.unpack_from("<q", code, 0) == (goal + 3,)
    assert struct.unpack_from("<i", code, 8) == (goal - 4 - 8,)
    assert struct.unpack_from("<i", code, 16) == (4 + 1 - 16,)
    assert struct.unpack_from("<q", code, 24) == (4,)
    assert code[12:16] == bytes(range(12, 16))


@pytest.mark.parametrize(
    ("relocations", "symbols", "code"),
    [
        ([(0, 9, 0, 0)], [RUN], 62),  # a kind that is not known
        ([(0, 1, 1, 0)], [RUN, (b"sin", 0, 0)], 62),  # a function from elsewhere
        ([], [(b"go", 1, 4)], 62),  # no entry
        ([], [(b"run", 6, 0)], 62),  # an entry that is not laid out
        ([], [RUN], 183),  # another processor
    ],
)
def test_what_cannot_be_laid_out_is_left_to_llvm(relocations, symbols, code):
    assert image(elf(relocations, symbols, machine_code=code)) is None
    assert image(elf([], [RUN])) is not None


def test_places_that_need_the_address_get_it_in_memory():
    flat = image(elf([(0, 1, 1, 3), (24, 1, 0, 0)], [RUN, DATA]))
    found = entered(flat)
    assert found is not None or sys.platform != "linux"  # elsewhere memory may not become executable
    address, memory = found or (4, struct.pack("<q", 37) + bytes(16) + struct.pack("<q", 4) + b"datadata")
    base = address - 4

    assert struct.unpack_from("<q", memory, 0) == (base + 37,)
    assert struct.unpack_from("<q", memory, 24) == (base + 4,)
    assert memory[32:40] == b"datadata"


def test_the_memory_of_an_image_is_not_writable_and_a_refusal_is_none(monkeypatch):
    flat, asked = image(elf([], [RUN])), []

    class Library:
        def __init__(self, name):
            self.mprotect = lambda base, size, rights: asked.append((size, rights)) or 1
            self.mprotect = type("F", (), {"__call__": staticmethod(self.mprotect)})()

    monkeypatch.setattr(ctypes, "CDLL", Library)
    assert entered(flat) is None
    assert asked == [(40, 5)]  # read and execute


WHOLE = elf([(0, 1, 1, 3), (8, 2, 1, -4), (24, 1, 0, 0)], [RUN, DATA])
TABLE = struct.unpack_from("<Q", WHOLE, 40)[0]  # where the seven lines of 64 bytes of the section table begin
HUGE = (1 << 63, (1 << 64) - 1, 1 << 32, len(WHOLE))


def altered(at, form, value):
    """The file with one field written over."""
    code = bytearray(WHOLE)
    struct.pack_into(form, code, at, value)
    return bytes(code)


@pytest.mark.parametrize("value", HUGE)
@pytest.mark.parametrize("section", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("field", [24, 32, 48], ids=["offset", "size", "alignment"])
def test_a_section_that_leaves_the_file_is_no_section(section, field, value):
    if field == 48 and value == len(WHOLE) and not value & (value - 1):
        value += 1
    assert image(altered(TABLE + 64 * section + field, "<Q", value)) is None


@pytest.mark.parametrize(
    ("at", "form", "value"),
    [
        (40, "<Q", 1 << 63),  # the section table beyond the file
        (58, "<H", 63),  # lines of another length
        (60, "<H", 65535),  # more sections than there are bytes
        (TABLE + 64 * 3 + 40, "<I", 99),  # symbols in a section that is not there
        (TABLE + 64 * 3 + 40, "<I", 1),  # symbols in the text
        (TABLE + 64 * 4 + 40, "<I", 1 << 31),  # names in a section that is not there
        (TABLE + 64 * 3 + 32, "<Q", 25),  # a relocation and a byte
    ],
)
def test_tables_that_do_not_fit_together_are_refused(at, form, value):
    assert image(WHOLE) is not None
    assert image(altered(at, form, value)) is None


@pytest.mark.parametrize(
    ("relocations", "symbols"),
    [
        ([(25, 1, 1, 0)], [RUN, DATA]),  # the last of eight bytes is not the text's
        ([(29, 2, 1, 0)], [RUN, DATA]),
        ([(1 << 63, 1, 1, 0)], [RUN, DATA]),
        ([(0, 1, 2, 0)], [RUN, DATA]),  # a symbol that is not there
        ([(0, 1, 1, 1 << 40)], [RUN, DATA]),  # beyond the image
        ([(0, 1, 1, -(1 << 40))], [RUN, DATA]),
        ([(8, 2, 1, 1 << 33)], [RUN, DATA]),  # a distance of more than 32 bits
        ([(0, 1, 1, 0)], [RUN, (b"numbers", 2, 9)]),  # a symbol behind its section
        ([], [(b"run", 1, 32)]),  # an entry behind the text
        ([], [(b"run", 2, 0)]),  # an entry among the data
    ],
)
def test_what_points_outside_is_refused(relocations, symbols):
    assert image(elf(relocations, symbols)) is None


@pytest.mark.parametrize(
    "flat",
    [
        b"",
        MAGIC,
        b"flit" + struct.pack("<IQ", 0, 0) + bytes(8),
        MAGIC + struct.pack("<IQ", 1 << 31, 0) + bytes(64),  # more places than bytes
        MAGIC + struct.pack("<IQ", 0, 8) + bytes(8),  # an entry behind the code
        MAGIC + struct.pack("<IQQ", 1, 0, 1) + bytes(8),  # a place of which the last byte is outside
        MAGIC + struct.pack("<IQQ", 1, 0, (1 << 64) - 4) + bytes(8),
        MAGIC + struct.pack("<IQQq", 1, 0, 0, 1 << 62),  # an address far outside
    ],
)
def test_bytes_that_are_no_image_are_not_entered(flat):
    assert entered(flat) is None


def test_altered_files_never_bring_the_process_down():
    """`benchmarks/torture.py images` does the same a million times."""
    assert images(4000, seed=1, batch=2000).failed == 0
