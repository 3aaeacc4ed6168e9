"""Long attacks on what reads, keeps and proves: `torture.py [PART ...] [--scale SHARE]`; all parts take half an hour.

    images      object files and images of machine code with fields written over, read in children that may die

Each part prints one line: what was tried, how often, and how much of it failed. The exit status is 1 when anything
failed. The same functions with smaller counts are tests of the suite.
"""

import argparse
import os
import random
import struct
import sys
import time
from collections.abc import Callable
from typing import NamedTuple

Attack = Callable[[random.Random], None]


class Outcome(NamedTuple):
    """How many attempts there were, how many of them failed, and what was found along the way."""

    tried: int
    failed: int
    said: str = ""


def in_children(attack: Attack, executions: int, seed: int, batch: int) -> int:
    """Runs an attack so many times, a batch to each forked child; how many children died or raised.

    A child that is killed by a signal is a failure like one that raises: its seed is printed.
    """
    failed = 0
    for first in range(0, executions, batch):
        child = os.fork()
        if child == 0:
            status = 1
            try:
                chance = random.Random(seed * 1_000_003 + first)
                for _ in range(min(batch, executions - first)):
                    attack(chance)
                status = 0
            except BaseException as error:  # whatever it is, the parent counts it
                sys.stderr.write(f"{type(error).__name__}: {error}\n")
            finally:
                os._exit(status)
        _, status = os.waitpid(child, 0)
        if status:
            failed += 1
            sys.stderr.write(f"the child with seed {seed * 1_000_003 + first} ended with {status}\n")
    return failed


INTERESTING = (0, 1, 2, 7, 8, 23, 24, 63, 64, 4095, 4096, 1 << 16, (1 << 31) - 1, 1 << 31, (1 << 32) - 1, 1 << 63)


def altered(whole: bytes, chance: random.Random) -> bytes:
    """The bytes with one to six fields, of one to eight bytes each, written over, and sometimes cut off."""
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
    """Object files of a kernel, and images made of them, with fields written over: an image or none, never a crash.

    Half of the object files keep their head and section table and are hit in the tables, where most fields are. What
    is laid out is mapped but never called: a byte of the code itself is nobody's to check.
    """
    from numeric import PinballMap
    from numeric.kernels import machine
    from numeric.kernels.spec import KernelSpec
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
            code = b"".join(parts)
            if which == 0 and len(parts[0]) < begin:
                code = code[: len(code)]
            made = machine.image(code)
            if made is not None:
                machine.entered(made)
        else:
            head = 16 + 8 * count
            machine.entered(altered(flat[: head + 64], chance) + flat[head + 64 :])

    failed = in_children(attack, executions, seed, batch)
    return Outcome(executions, failed, f"an object file of {len(whole)} bytes, its section table at {table}")


PARTS: dict[str, Callable[[float], Outcome]] = {
    "images": lambda share: images(int(1_000_000 * share)),
}


def main() -> int:
    """Runs the parts that were named, or all of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--scale", type=float, default=1.0, help="a share of the full counts")
    given = parser.parse_args()
    unknown = set(given.parts) - set(PARTS)
    if unknown:
        parser.error(f"no part is called {', '.join(unknown)}; accepted: {', '.join(PARTS)}")
    failed = 0
    for name in given.parts or PARTS:
        began = time.perf_counter()
        outcome = PARTS[name](given.scale)
        failed += outcome.failed
        spent = time.perf_counter() - began
        sys.stdout.write(f"{name}: {outcome.tried:,} tried, {outcome.failed} failed, {spent:.0f} s; {outcome.said}\n")
        sys.stdout.flush()
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
