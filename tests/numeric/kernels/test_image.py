"""Damaged kernels on disk are refused, and never bring the process down."""

import struct

import pytest
from attacks.machine_code import images

from numeric.kernels.machine import MAGIC, entered, image


def elf(relocations, symbols, text=bytes(range(32)), data=b"datadata", machine_code=62):
    """An object file with 32 bytes of text, 8 bytes of data aligned to 16, and the given tables.

    A relocation is (place in the text, kind, index of a symbol, addend), and a symbol is (name, section, value).
    Section 1 is the text and section 2 the data; higher sections are not laid out.
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


WHOLE = elf([(0, 1, 1, 3), (8, 2, 1, -4), (24, 1, 0, 0)], [RUN, DATA])
TABLE = struct.unpack_from("<Q", WHOLE, 40)[0]  # where the seven lines of 64 bytes of the section table begin
HUGE = (1 << 63, (1 << 64) - 1, 1 << 32, len(WHOLE))


def altered(at, form, value):
    """The file with one field overwritten."""
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
