"""Long attacks on what reads, keeps and proves, hours at full scale: `torture.py [PART ...] [--scale SHARE]`.

    images      object files and images of machine code with fields written over, read in children that may die
    restarts    sweeps that are killed, refused and damaged again and again, until they are done
    falsehoods  certificates of true statements made slightly false: none may be certified
    intervals   how often 95 per cent intervals of an exponent hold the value that balls enclose
    shares      how often those of a basin's share hold one half, where a mirror maps one basin to another
    dimensions  how often those of a boundary's dimension hold that of random fractal graphs
    joins       on which side of a join flights of the cuspless table land that pass it within rounding

Each part prints one line: what was tried, how often, and how much of it failed. The exit status is 1 when anything
failed. The same functions with smaller counts are tests of the suite.
"""

import argparse
import errno
import json
import os
import random
import struct
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
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


def restarts(sweeps: int, seed: int = 1) -> Outcome:
    """Sweeps of random grids, each interrupted at random writes and damaged between its runs, until it is done.

    At the end every byte is that of a sweep that nothing disturbed, and no part that was whole was computed again.
    """
    import numpy as np

    from numeric.sweeps.run import run
    from numeric.sweeps.sweep import Axis, Field, Sweep

    chance, failed, runs = random.Random(seed), 0, 0
    for number in range(sweeps):
        size, cut = chance.randint(3, 12), chance.randint(1, 4)
        axes = (Axis("x", np.arange(float(size)), "1", "a number", cut),)
        fields = tuple(Field(name, ("x",), "float64", "1", name) for name in ("square", "noise"))
        done: list[tuple[int, ...]] = []

        def task(part: Any, done: list[tuple[int, ...]] = done) -> dict[str, Any]:
            done.append(part.at)
            x = part.values["x"]
            return {"square": x**2, "noise": np.random.default_rng(part.seed).random(x.size)}

        sweep = Sweep("squares", "Squares", axes, fields, task, number, "none", {}, size, lambda: None)
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


def _chunks(store: Path) -> list[str]:
    """The parts of which both fields are whole files; a damaged one is shorter."""
    sizes: dict[str, list[int]] = {}
    for file in store.rglob("c/*"):
        sizes.setdefault(f"c/{file.name}", []).append(file.stat().st_size)
    return [name for name, found in sizes.items() if len(found) == 2 and min(found) > 20]


KINDS = ("fold", "flip")
NAMED: tuple[tuple[str, dict[str, str]], ...] = (
    ("lambda-c", {}),
    ("saddle-node", {"alpha": "2/25"}),
    ("symmetry-breaking", {"alpha": "2/25"}),
    ("alpha-tilde", {"lam": "1/3"}),
)


def falsehoods(count: int, seed: int = 1) -> Outcome:
    """True statements with a box that no longer holds the solution, at another shape, contraction or kind of event.

    A digit of the centre moves by 10 to 10**12 radii, the shape by 10**-6 to 10**-14 of itself: so little that
    nothing but the proof can see it, and too much for the solution to stay in the box. The name is that of the altered
    statement, so that it is the proof that has to refuse.
    """
    from sympy import Rational

    from verification.named import files
    from verification.named.locate import locate

    chance, failed, refused = random.Random(seed), 0, 0
    true = []
    for name, shape in NAMED:
        found = locate(name, 20, **{letter: Rational(text) for letter, text in shape.items()})
        assert found.proof is not None
        if not found.proof.certified:
            return Outcome(0, 1, f"{name}: the true statement is not certified")
        true.append(files.document(found.proof))
    for number in range(count):
        given = json.loads(json.dumps(chance.choice(true)))
        radius = Fraction(int(given["radius"][0])) * Fraction(2) ** int(given["radius"][1])
        ways = ["digit", "radius"] + ["shape"] * bool(given.get("shape")) + ["lam"] * bool(given.get("lam"))
        way = chance.choice([*ways, *(["kind"] if given["kind"] in KINDS else [])])
        sign = chance.choice((-1, 1))
        if way in ("digit", "radius"):
            index = chance.randrange(len(given["centre"]))
            mantissa, exponent = (int(text) for text in given["centre"][index])
            move = radius * 10 ** chance.randint(1, 12) * chance.randint(1, 9)
            unit = Fraction(2) ** exponent
            given["centre"][index][0] = str(mantissa + sign * max(1, int(move / unit)))
        elif way == "shape":
            letter = chance.choice(sorted(given["shape"]))
            part = Fraction(sign * chance.randint(1, 9), 10 ** chance.randint(6, 14))
            given["shape"][letter] = str(Fraction(given["shape"][letter]) * (1 + part))
        elif way == "lam":
            part = Fraction(sign * chance.randint(1, 9), 10 ** chance.randint(6, 14))
            given["lam"] = str(Fraction(given["lam"]) * (1 + part))
        else:
            given["kind"] = KINDS[1 - KINDS.index(given["kind"])]
        try:
            given["name"] = files.name_of(files.claim_of(given))
            certified = files.checked(given).certified
        except ValueError:
            certified, refused = False, refused + 1
        if certified:
            failed += 1
            sys.stderr.write(f"number {number}: certified after a change of {way}: {json.dumps(given)[:2000]}\n")
    return Outcome(count, failed, f"{refused} of them were refused before the proof began")


SLAP_EXPONENT = 0.368340799475763256  # of the cardioid, proved in balls: docs/exponents.md


def intervals(seeds: int, seed: int = 1) -> Outcome:
    """95 per cent intervals of the cardioid's slap exponent, from 4 orbits each, against the value proved in balls.

    Failed are those beyond what 93 to 97 of 100 allow.
    """
    import numpy as np

    from numeric import PinballMap
    from numeric.dynamics.exponents import Count
    from numeric.dynamics.statistics import estimate
    from numeric.pinball.sampling import Growth, interior_starts

    truth, map = SLAP_EXPONENT, PinballMap("cardioid", lam=0)
    said, failed = [], 0
    for bounces in (256, 1024, 4096):
        starts = interior_starts(map, 4 * seeds, seed=seed + bounces)
        growth = Growth(map, starts.theta, 0 * starts.phi, starts.component)
        growth.skip(1000)
        count = Count(growth)
        for _ in count.until(bounces):
            pass
        found = [estimate(part) for part in np.split(count.up, seeds, axis=1)]
        held = sum(abs(each.mean - truth) <= each.interval for each in found)
        said.append(f"{100 * held / seeds:.1f} of 100 at {bounces} bounces")
        failed += allowed(held, seeds)
    return Outcome(3 * seeds, failed, f"{', '.join(said)}; the value is {truth:.8f}")


def allowed(held: int, seeds: int) -> int:
    """How many seeds are beyond what 93 to 97 of 100 allow."""
    return max(0, int(0.93 * seeds) - held, held - int(0.97 * seeds + 1))


def shares(seeds: int, starts: int = 400, seed: int = 1) -> Outcome:
    """Wilson's intervals for the basin of one of the egg's two triangles among those that end on either.

    The triangles are mirror images, and so are their basins: the share is one half.
    """
    import numpy as np

    from numeric import PinballMap
    from numeric.dynamics.attractors import find, wilson
    from numeric.dynamics.basins import labels, random_points, starts_at, whole

    map = PinballMap("egg", alpha="2/25", lam="1/2")
    attractors = find(map, 200, 1)
    pair = [i for i, each in enumerate(attractors) if each.period == 3]
    if len(pair) != 2:
        raise ValueError(f"{len(pair)} triangles attract, where two mirror images do")
    window, held = whole(map), 0
    for k in range(seeds):
        s, height = random_points(window, starts, np.random.default_rng([seed, k]))
        label = labels(map, starts_at(map, s, height), attractors)
        one, other = (int(np.sum(label == i)) for i in pair)
        found = wilson(one, one + other)
        held += found.low <= 0.5 <= found.high
    return Outcome(seeds, allowed(held, seeds), f"{100 * held / seeds:.1f} of 100 hold one half")


RATIO = 1.35  # of the frequencies of a graph; near 1 leaves a pure power law
FINEST = 1e-12


def fractal_fates(roughness: float, distances: Any, starts: int, seed: int) -> Any:
    """Which pairs of points lie on different sides of a graph of dimension `2 - roughness`; distances along the rows.

    The graph is Weierstrass's sum of sines of random phase, cut off below all distances.
    """
    import numpy as np

    rng = np.random.default_rng(seed)
    order = np.arange(int(np.log(1 / FINEST) / np.log(RATIO)))
    frequency, size, phase = RATIO**order, RATIO ** (-roughness * order), rng.uniform(0, 2 * np.pi, order.size)
    wide = np.sqrt(2 * np.sum(size**2))  # twice the standard deviation
    x, y, turn = (rng.uniform(low, high, starts) for low, high in ((0, 20 * np.pi), (-wide, wide), (0, 2 * np.pi)))

    def below(x: Any, y: Any) -> Any:
        return y < np.sin(x[:, None] * frequency + phase) @ size

    here = below(x, y)
    return np.array([below(x + eps * np.cos(turn), y + eps * np.sin(turn)) != here for eps in distances])


def dimensions(seeds: int, starts: int = 3000, seed: int = 1) -> Outcome:
    """The dimension of random graphs of dimension 1.75 and 1.5, from pairs of points at seven distances."""
    import numpy as np

    from numeric.dynamics.statistics import fitted

    distances, said, failed = 10.0 ** -np.arange(2, 5.5, 0.5), [], 0
    for roughness in (0.25, 0.5):
        held = 0
        for k in range(seeds):
            different = fractal_fates(roughness, distances, starts, seed + k)
            found = fitted(distances, different, np.random.default_rng([seed, k]))
            held += bool(abs(found.dimension - (2 - roughness)) <= 1.96 * found.error)
        said.append(f"{100 * held / seeds:.1f} of 100 at {2 - roughness}")
        failed += allowed(held, seeds)
    return Outcome(2 * seeds, failed, ", ".join(said))


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


PARTS: dict[str, Callable[[float], Outcome]] = {
    "images": lambda share: images(int(1_000_000 * share)),
    "restarts": lambda share: restarts(int(400 * share)),
    "falsehoods": lambda share: falsehoods(int(1000 * share)),
    "intervals": lambda share: intervals(max(100, int(500 * share))),
    "shares": lambda share: shares(max(100, int(500 * share))),
    "dimensions": lambda share: dimensions(max(100, int(500 * share))),
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
