"""Attack: object files and images of machine code with overwritten fields give an image or none, but never a crash."""

import random
import struct

from attacks.outcome import Outcome, in_children

INTERESTING = (0, 1, 2, 7, 8, 23, 24, 63, 64, 4095, 4096, 1 << 16, (1 << 31) - 1, 1 << 31, (1 << 32) - 1, 1 << 63)


def altered(whole: bytes, chance: random.Random) -> bytes:
    """The bytes with one to six fields of one to eight bytes overwritten, and sometimes truncated."""
    code = bytearray(whole)
    for _ in range(chance.randint(1, 6)):
        size = chance.choice((1, 2, 4, 8))
        place = chance.randrange(len(code) - size)
        place -= place % size if chance.random() < 0.8 else 0
        old = int.from_bytes(code[place : place + size], "little")
        near = old + chance.choice((-1, 1, 8, -8, 24, 64, len(code)))
        value = chance.choice((chance.getrandbits(64), near, chance.choice(INTERESTING)))
        code[place : place + size] = (value % (1 << 8 * size)).to_bytes(size, "little")
    if chance.random() < 0.1:
        del code[chance.randrange(len(code)) :]
    return bytes(code)


def images(executions: int, seed: int = 1, batch: int = 20_000) -> Outcome:
    """Object files of a kernel, and images made of them, with overwritten fields: an image or none, never a crash.

    Half of the object files keep their header and section table and are hit in the tables. An image is mapped but never
    called: bytes of the code itself cannot be checked.
    """
    from numeric import PinballMap
    from numeric.kernels import machine
    from numeric.kernels.machine import KernelSpec
    from numeric.kernels.text import kernel_text

    map = PinballMap("cuspless", lam=0.5)
    whole = machine.object_code(kernel_text(map.family, map.engine.names, KernelSpec(map.law)))
    flat = machine.image(whole)
    if flat is None:
        return Outcome(0, 0, "object files are no images on this machine")
    (table,) = struct.unpack_from("<Q", whole, 40)
    (count,) = struct.unpack_from("<I", flat, 4)
    text = machine._sections(whole)
    assert text is not None
    large = max(range(len(text)), key=lambda i: text[i].size)
    begin, end = text[large].begin, text[large].begin + text[large].size
    outside = whole[:begin], whole[begin:end], whole[end:]

    def attack(chance: random.Random) -> None:
        if chance.random() < 0.5:
            which = chance.choice((0, 2, 2))
            parts = list(outside)
            parts[which] = altered(parts[which], chance)
            made = machine.image(b"".join(parts))
            if made is not None:
                machine.entered(made)
        else:
            head = 16 + 8 * count
            machine.entered(altered(flat[: head + 64], chance) + flat[head + 64 :])

    failed = in_children(attack, executions, seed, batch)
    return Outcome(executions, failed, f"an object file of {len(whole)} bytes, its section table at {table}")
