"""Long attacks on what reads, keeps and proves, hours at full scale: `torture.py [PART ...] [--scale SHARE]`.

    images      object files and images of machine code with fields written over, read in children that may die
    restarts    sweeps that are killed, refused and damaged again and again, until they are done
    disks       sweeps onto disks of memory that are full at each of their writes
    visitors    sessions of the live table that are opened and left
    fields      certificate files with any of their entries altered: refused in a sentence, or true
    falsehoods  certificates of true statements made slightly false: none may be certified
    intervals   how often 95 per cent intervals of an exponent hold the value that balls enclose
    shares      how often those of a basin's share hold one half, where a mirror maps one basin to another
    dimensions  how often those of a boundary's dimension hold that of random fractal graphs
    known       how often intervals hold exponents that follow from the table
    joins       on which side of a join flights of the cuspless table land that pass it within rounding

Each part prints one line: what was tried, how often, and how much of it failed. The exit status is 1 when anything
failed. The same functions with smaller counts are tests of the suite.
"""

import argparse
import errno
import json
import os
import random
import socket
import struct
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

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


class Gone(BaseException):
    """The process ends here: nothing of what would tidy up behind it is done."""


def interrupted(work: Callable[[], object], where: str, moment: int) -> bool:
    """Does `work` and lets its write number `moment` fail; was it reached?

    `before`: the disk is full when the file is written. `between`: the process ends after the write and before the
    rename, so that the temporary file stays.
    """
    count, fsync, replace, unlink = [0], os.fsync, Path.replace, Path.unlink

    def written(handle: int) -> None:
        count[0] += 1
        if where == "before" and count[0] > moment:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(handle)

    def renamed(self: Path, target: Path) -> Path:
        if where == "between" and count[0] > moment and self.name.endswith(".partial"):
            raise Gone
        return replace(self, target)

    def kept(self: Path, missing_ok: bool = False) -> None:
        if not (where == "between" and count[0] > moment):
            unlink(self, missing_ok)

    os.fsync, Path.replace, Path.unlink = written, renamed, kept  # type: ignore[method-assign, assignment]
    try:
        work()
    except (Gone, OSError):
        return True
    except Exception as stop:
        if type(stop).__name__ in ("UnfinishedError", "ValueError"):  # one sentence, as a user sees it
            return True
        raise
    finally:
        os.fsync, Path.replace, Path.unlink = fsync, replace, unlink  # type: ignore[method-assign]
    return False


def _files(store: Path) -> dict[str, bytes]:
    return {str(file.relative_to(store)): file.read_bytes() for file in store.rglob("*") if file.is_file()}


def squares(size: int, cut: int, number: int, done: list[tuple[int, ...]]) -> Any:
    """A sweep over a grid of numbers, with random ones beside them; the parts that are computed are added to `done`."""
    import numpy as np

    from numeric.sweeps.sweep import Axis, Field, Sweep

    def task(part: Any) -> dict[str, Any]:
        done.append(part.at)
        x = part.values["x"]
        return {"square": x**2, "noise": np.random.default_rng(part.seed).random(x.size)}

    axes = (Axis("x", np.arange(float(size)), "1", "a number", cut),)
    made = tuple(Field(name, ("x",), "float64", "1", name) for name in ("square", "noise"))
    return Sweep("squares", "Squares", axes, made, task, number, "none", {}, size, lambda: None)


def restarts(sweeps: int, seed: int = 1) -> Outcome:
    """Sweeps of random grids, each interrupted at random writes and damaged between its runs, until it is done.

    At the end every byte is that of a sweep that nothing disturbed, and no part that was whole was computed again.
    """
    from numeric.sweeps.run import run

    chance, failed, runs = random.Random(seed), 0, 0
    for number in range(sweeps):
        done: list[tuple[int, ...]] = []
        sweep = squares(chance.randint(3, 12), chance.randint(1, 4), number, done)
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of damaged files
            run(sweep, Path(folder) / "whole", workers=1)
            store, damaged = Path(folder) / "store", 0
            done.clear()
            while True:
                runs += 1
                where, moment = chance.choice(("before", "between")), chance.randint(6, 20)
                before = set(_chunks(store))
                done.clear()
                if not interrupted(lambda: run(sweep, store, workers=1), where, moment):  # noqa: B023
                    break
                failed += bool(before & {f"c/{at[0]}" for at in done})
                if chance.random() < 0.3 and (chunks := sorted(store.rglob("c/*"))):
                    victim, damaged = chance.choice(chunks), damaged + 1
                    whole = victim.read_bytes()
                    victim.write_bytes(whole[: chance.randrange(len(whole))])
            failed += _files(store) != _files(Path(folder) / "whole")
    return Outcome(sweeps, failed, f"{runs} starts")


def disks(pages: int, seed: int = 1) -> Outcome:
    """A sweep onto a disk of memory of one page, of two, ...: it stops with a sentence, and goes on with room.

    At the end every byte is that of a sweep that nothing disturbed. Only root may mount such a disk.
    """
    from numeric.sweeps.run import UnfinishedError, run

    if os.geteuid() != 0:
        return Outcome(0, 0, "only root may mount a disk of memory")
    failed = full = 0
    with tempfile.TemporaryDirectory() as folder:
        run(squares(8, 2, seed, []), Path(folder) / "whole", workers=1)
        whole, disk = _files(Path(folder) / "whole"), Path(folder) / "disk"
        disk.mkdir()
        for page in range(1, pages + 1):
            mount = ["mount", "-t", "tmpfs", "-o", f"size={page * os.sysconf('SC_PAGE_SIZE')}", "tmpfs", str(disk)]
            if subprocess.run(mount, check=False, capture_output=True).returncode:
                return Outcome(0, 0, "no disk of memory may be mounted here")
            try:
                try:
                    run(squares(8, 2, seed, []), disk / "store", workers=1)
                except (UnfinishedError, ValueError) as stop:  # one sentence, as a user sees it
                    full += 1
                    failed += "\n" in str(stop)
                subprocess.run(["mount", "-o", "remount,size=4m", str(disk)], check=True)
                run(squares(8, 2, seed, []), disk / "store", workers=1)
                failed += _files(disk / "store") != whole
            finally:
                subprocess.run(["umount", str(disk)], check=True)
    return Outcome(pages, failed, f"{full} of the disks were full")


LIVE = """
import sys, threading, time
from verification.app import live
live.FORGOTTEN = 1000
from bokeh.server.server import Server
from bokeh.server.session import ServerSession
known, made = [], []
begin, start = ServerSession.__init__, Server.start
def begun(self, *arguments, **named):
    made.append(1)
    begin(self, *arguments, **named)
ServerSession.__init__ = begun
def started(self):
    known.append(self)
    return start(self)
Server.start = started
def tell():
    while True:
        time.sleep(0.2)
        print(len(made), len(known[0].get_sessions()) if known else -1, flush=True)
threading.Thread(target=tell, daemon=True).start()
live.serve(int(sys.argv[1]), False)
"""


@contextmanager
def live_server() -> Iterator[tuple[int, "subprocess.Popen[str]"]]:
    """The live table in a process that tells how many sessions there were and are; its environment would open it."""
    root = Path(__file__).resolve().parent.parent
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {**os.environ, "PYTHONPATH": str(root), "BOKEH_ALLOW_WS_ORIGIN": "*", "BOKEH_ADDRESS": "0.0.0.0"}
    process = subprocess.Popen(
        [sys.executable, "-c", LIVE, str(port)], env=environment, cwd=root, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    try:
        for _ in range(600):
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                time.sleep(0.2)
        yield port, process
    finally:
        process.kill()
        process.communicate()


def answer(port: int, request: str, seconds: float = 600) -> str:
    """The first line that the server answers to a request."""
    with socket.create_connection(("127.0.0.1", port), timeout=seconds) as link:
        link.sendall(request.replace("\n", "\r\n").encode())
        return link.recv(4096).decode(errors="replace").partition("\r\n")[0]


def left(served: "tuple[int, subprocess.Popen[str]]", count: int, seconds: float = 1200) -> tuple[int, int, int]:
    """How many of `count` visitors were answered, and how many sessions there were and are when all have left."""
    port, process = served
    answered = sum(" 200 " in answer(port, f"GET / HTTP/1.1\nHost: 127.0.0.1:{port}\n\n") for _ in range(count))
    assert process.stdout is not None
    made, here, ended = 0, -1, time.monotonic() + seconds
    while (made < count or here) and time.monotonic() < ended:
        made, here = map(int, process.stdout.readline().split())
    return answered, made, here


def visitors(count: int) -> Outcome:
    """Pages of the live table that are opened and left: each is answered, and none is remembered."""
    with live_server() as served:
        answered, made, here = left(served, count)
    return Outcome(count, count - answered + abs(made - count) + here, f"{made} sessions, {here} are left")


def _chunks(store: Path) -> list[str]:
    """The parts of which both fields are whole files; a damaged one is shorter."""
    sizes: dict[str, list[int]] = {}
    for file in store.rglob("c/*"):
        sizes.setdefault(f"c/{file.name}", []).append(file.stat().st_size)
    return [name for name, found in sizes.items() if len(found) == 2 and min(found) > 20]


KINDS = ("fold", "flip")
STATEMENTS = 40  # that are true, at shapes and contractions drawn at random


def true_statements(count: int, chance: random.Random) -> list[dict[str, Any]]:
    """Certificates of the cuspless table's flip and of the egg's folds, flips and triangles.

    A cycle along a double normal would be one at any contraction: none is among them.
    """
    from sympy import Rational

    from symbolic import tables
    from verification.cycles.newton import floats
    from verification.cycles.problem import Problem
    from verification.named import files
    from verification.named.locate import certify, locate

    found: list[dict[str, Any]] = [files.document(locate("lambda-c", 20).proof)]  # type: ignore[arg-type]
    while len(found) < count:
        kind, lam = chance.randrange(3), Rational(chance.randint(5, 95), 100)
        if kind == 0:
            proof: Any = locate("saddle-node", 20, alpha=Rational(chance.randint(20, 98), 1000)).proof
        elif kind == 1:
            proof = locate("alpha-tilde", 20, lam=lam).proof
        else:
            lam = Rational(chance.randint(60, 95), 100)
            egg = tables.egg(3).at(alpha=Rational(chance.randint(50, 90), 1000))
            problem = Problem(egg, (0, 0, 0), lam=lam)
            proof = certify(problem, floats(problem, [0.96, 3.05, 5.15]), 20)
        if proof.certified:
            found.append(json.loads(json.dumps(files.document(proof))))
    return found


def falsehoods(count: int, seed: int = 1) -> Outcome:
    """True statements with a box that no longer holds the solution, at another shape, contraction or kind of event.

    A digit of the centre moves by 10 to 10**12 radii, the shape by 10**-6 to 10**-14 of itself: so little that
    nothing but the proof can see it, and too much for the solution to stay in the box. Name and words are those of the
    altered statement, so that it is the proof that has to refuse.
    """
    from verification.named import files

    chance, failed, refused = random.Random(seed), 0, 0
    true = true_statements(max(4, min(STATEMENTS, count // 20)), chance)
    for number in range(count):
        given = json.loads(json.dumps(chance.choice(true)))
        radius = Fraction(int(given["radius"][0])) * Fraction(2) ** int(given["radius"][1])
        scene = given["scene"]
        ways = ["digit", "radius"] + ["shape"] * bool(scene.get("shape")) + ["lam"] * bool(scene.get("lam"))
        way = chance.choice([*ways, *(["kind"] if given["kind"] in KINDS else [])])
        sign = chance.choice((-1, 1))
        if way in ("digit", "radius"):
            index = chance.randrange(len(given["centre"]))
            mantissa, exponent = (int(text) for text in given["centre"][index])
            move = radius * 10 ** chance.randint(1, 12) * chance.randint(1, 9)
            unit = Fraction(2) ** exponent
            given["centre"][index][0] = str(mantissa + sign * max(1, int(move / unit)))
        elif way == "shape":
            letter = chance.choice(sorted(scene["shape"]))
            part = Fraction(sign * chance.randint(1, 9), 10 ** chance.randint(6, 14))
            scene["shape"][letter] = str(Fraction(scene["shape"][letter]) * (1 + part))
        elif way == "lam":
            part = Fraction(sign * chance.randint(1, 9), 10 ** chance.randint(6, 14))
            scene["lam"] = str(Fraction(scene["lam"]) * (1 + part))
        else:
            given["kind"] = KINDS[1 - KINDS.index(given["kind"])]
        try:
            given["name"], given["statement"] = files.name_of(files.claim_of(given)), files._words(given, files.SCHEMA)
            certified = files.checked(given).certified
        except ValueError:
            certified, refused = False, refused + 1
        if certified:
            failed += 1
            sys.stderr.write(f"number {number}: certified after a change of {way}: {json.dumps(given)[:2000]}\n")
    return Outcome(count, failed, f"{refused} of them were refused before the proof began")


SECOND = Path(__file__).resolve().parent.parent / "certificates"


def fields(each: int) -> Outcome:
    """The damage of certificates/mutants.py, so many mutants of each of its samples, read by the package.

    Each is refused in one sentence, not proved, or true by what is known of the undamaged file.
    """
    sys.path.insert(0, str(SECOND))
    import mutants

    from verification.named import files

    tried, failed, said = 0, 0, {"refused": 0, "not proved": 0, "true": 0}
    for name in mutants.SAMPLES:
        original = json.loads((SECOND / f"{name}.json").read_text(encoding="utf-8"))
        first = mutants.undamaged(name)
        for k in range(each):
            given, tried = mutants.mutant(name, original, k), tried + 1
            try:
                proof = files.checked(given)
                if not proof.certified:
                    said["not proved"] += 1
                    continue
                middle = proof.value.mid().str(given["digits"] + 5, radius=False)
                value, digits = float(Fraction(middle)), min(given["digits"], 14)
                line = f"proved: {given['name']} = {value:.17f}, within 1e-{digits}"
                held = given == original or mutants.is_true(given, line, original, first)
            except ValueError as error:
                said["refused"] += 1
                held = "\n" not in str(error)
            else:
                said["true"] += held
            if not held:
                failed += 1
                sys.stderr.write(f"{name}, mutant {k}: {json.dumps(given)[:2000]}\n")
    return Outcome(tried, failed, ", ".join(f"{count} {word}" for word, count in said.items()))


class Passed(NamedTuple):
    """What became of flights that pass a join closely: arrays, and the distances in units of 2**-52."""

    miss: Any
    stopped: Any
    regular: Any
    wrong: Any


def past_joins(count: int, units: float, near: bool, kernels: bool, seed: int) -> Passed:
    """Flights of the cuspless table, arc to join, that miss it by up to so many units of 2**-52; sides in 80 bits.

    They leave from anywhere on the arc, or from `near` the join. The particle is what the doubles say: which side it
    passes is told from the rounded state and not from where it was aimed.
    """
    import numpy as np

    from numeric import PinballMap, Status
    from numeric.kernels.machine import KernelSpec

    rng, wide, join = np.random.default_rng(seed), np.longdouble, 2 * np.pi / 3
    beside = np.where(np.arange(count) % 2, 1, -1) * (join - 10 ** rng.uniform(-9, -1, count))
    theta = beside if near else rng.uniform(-join, join, count)
    map = PinballMap("cuspless", lam=0.9, kernels=kernels)
    own = [np.asarray(row) for row in map.states.enter(np.zeros(count, dtype=int), theta, 0 * theta, map.law)]
    p, q = (row.astype(wide) for row in own[1:3])
    p, q = p / np.hypot(p, q), q / np.hypot(p, q)
    height, wall, top = (
        4 * p**3 * q,
        -((2 * p * p - wide(0.5)) ** 2),
        np.sqrt(wide(3)) / 4,
    )  # from the start to the wall
    tangent = q * (q * q - 3 * p * p), p * (p * p - 3 * q * q)

    x, y = wall, rng.choice([-1, 1], count) * top - height
    turn = rng.uniform(-units, units, count) * wide(2.0**-52) / (x * x + y * y)
    x, y = x - turn * y, y + turn * x
    cosine, sine = (
        part / np.hypot(x, y) for part in (y * tangent[0] - x * tangent[1], x * tangent[0] + y * tangent[1])
    )
    leaves = cosine > 1e-12
    own = [row[leaves] for row in (*own[:3], cosine.astype(float), sine.astype(float))]
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(len(own[0]), 0.9), map.shape, 1)

    c, s = (row.astype(wide) for row in own[3:])
    (tx, ty), wall, height = (row[leaves] for row in tangent), wall[leaves], height[leaves]
    vx, vy = (tx * s - ty * c) / np.hypot(c, s), (ty * s + tx * c) / np.hypot(c, s)
    above, below = (vx * (side * top - height) - vy * wall for side in (1, -1))
    onto_wall, miss = (above * below < 0) & (vx < 0), np.minimum(np.abs(above), np.abs(below)) * 2.0**52
    stopped, regular = (result.rows["code"] == status.code for status in (Status.JOIN, Status.REGULAR))
    return Passed(miss, stopped, regular, regular & ((result.record[0][0] == 1) != onto_wall))


def joins(flights: int, seed: int = 1, batch: int = 100_000) -> Outcome:
    """Flights past a join by up to eight units, half from anywhere and half from beside it: none on the wrong side.

    Failed are also those that are stopped although they pass it by ten units.
    """
    import numpy as np

    count, failed, on, stopped, farthest = 0, 0, 0, 0, 0.0
    for k in range(0, flights, batch):
        found = past_joins(batch, 8, bool(k // batch % 2), True, seed + k)
        count, on, stopped = count + found.miss.size, on + int(found.regular.sum()), stopped + int(found.stopped.sum())
        farthest = max(farthest, float(np.max(found.miss[found.stopped], initial=0)))
        failed += int(found.wrong.sum() + np.sum(found.stopped & (found.miss >= 10)))
    return Outcome(count, failed, f"{stopped:,} stop, the last {farthest:.1f} units off, and {on:,} go on")


def calibrated(part: str, share: float) -> Outcome:
    """A part of benchmarks/calibration.py, with 500 seeds at full scale."""
    import calibration

    outcome: Outcome = getattr(calibration, part)(max(100, int(500 * share)))
    return outcome


PARTS: dict[str, Callable[[float], Outcome]] = {
    "images": lambda share: images(int(1_000_000 * share)),
    "restarts": lambda share: restarts(int(400 * share)),
    "disks": lambda share: disks(max(3, int(40 * share))),
    "visitors": lambda share: visitors(max(8, int(100 * share))),
    "fields": lambda share: fields(max(1, int(40 * share))),
    "falsehoods": lambda share: falsehoods(int(1000 * share)),
    "intervals": lambda share: calibrated("intervals", share),
    "shares": lambda share: calibrated("shares", share),
    "dimensions": lambda share: calibrated("dimensions", share),
    "known": lambda share: calibrated("known", share),
    "joins": lambda share: joins(int(10_800_000 * share)),
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
