"""A million points for each labelled case: did the kernel take the right zero, and how exact was it?

The two columns `/condition` divide by one plus the row sums of the derivative matrix, the condition numbers; the
last two say how many points go beyond 4 (position) or 8 (direction), and the smallest condition number among them.
The reference is the same step on 80-bit floats (NumPy's longdouble, 11 bits more than a double);
that the step itself is right is what tests/numeric/test_accuracy.py shows at 50 digits.

    python benchmarks/adversarial.py [POINTS [WORD]]        only the cases whose label has the word
"""

import sys

import numpy as np

from numeric import PinballMap
from numeric.question import Question
from numeric.readers.arrays import Arrays

EPS = 2.0**-52


class Wide(Arrays):
    """80-bit arrays: 64 bits of mantissa."""

    splitter = np.longdouble(2.0**32 + 1)

    def constant(self, p, q=1):
        return np.longdouble(p) / np.longdouble(q)

    def number(self, x):
        return np.longdouble(x)


def say(text):
    """A line on standard output, at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def unit(x, y):
    size = np.hypot(x, y)
    return x / size, y / size


def exactly(name, own):
    """The rounded state in 80 bits, its pairs made unit vectors again."""
    wide = [row.astype(np.longdouble) for row in own]
    if name == "circle":
        return wide
    first = 1 if name == "cuspless" else 0
    pairs = [unit(*wide[i : i + 2]) for i in range(first, len(wide), 2)]
    if name == "cuspless":
        wall = wide[0] > 0.5
        pairs[0] = np.where(wall, wide[1], pairs[0][0]), np.where(wall, wide[2], pairs[0][1])
    return wide[:first] + [row for pair in pairs for row in pair]


def cases(count, rng):
    """Name, map, component, theta, phi."""
    side = np.where(rng.integers(0, 2, count) == 0, 1, -1)
    tiny = 10.0 ** rng.uniform(-12, -1, count)
    zero = np.zeros(count, dtype=int)
    angle = np.arcsin(rng.uniform(-1, 1, count) * (1 - 1e-12))
    scenes = {
        "circle": {},
        "ellipse": {"a": "3/2"},
        "cardioid": {},
        "egg": {"alpha": "0.08"},
        "cuspless": {},
    }
    for name, shape in scenes.items():
        map = PinballMap(name, lam=0.95, **shape)
        low, high = map.states.ends[0]
        theta = low + (high - low) * rng.uniform(1e-9, 1 - 1e-9, count)
        yield f"{name}, random", map, zero, theta, angle
        yield f"{name}, grazing to 1e-12", map, zero, theta, side * (np.pi / 2 - tiny)
        for lam in (0.0, 1e-300, 1.0):
            yield f"{name}, lam = {lam:g}", PinballMap(name, lam=lam, **shape), zero, theta, angle
    cardioid = PinballMap("cardioid", lam=0.95)
    yield "cardioid, start near the cusp", cardioid, zero, side * (np.pi - tiny), angle
    theta = rng.uniform(-2.9, 2.9, count)
    yield "cardioid, aimed at the cusp", cardioid, zero, theta, theta / 2 + side * tiny
    cuspless = PinballMap("cuspless", lam=0.95)
    join = 2 * np.pi / 3
    yield "cuspless, start near a join", cuspless, zero, side * (join - tiny), angle
    wall = rng.uniform(-0.4329, 0.4329, count)
    yield "cuspless, from the wall", cuspless, zero + 1, wall, angle
    yield "cuspless, from the wall near a join", cuspless, zero + 1, side * (np.sqrt(3) / 4 - tiny), angle
    theta = rng.uniform(-2, 2, count)
    x, y = cuspless.states.point(zero, theta)
    tx, ty = cuspless.states.tangent(zero, theta)
    vx, vy = -0.25 - x, side * np.sqrt(3) / 4 - y
    aim = np.arctan2(vx * tx + vy * ty, vy * tx - vx * ty) + np.where(rng.integers(0, 2, count) == 0, 1, -1) * tiny
    good = np.abs(aim) < 1.57
    yield "cuspless, aimed at a join", cuspless, zero[good], theta[good], aim[good]
    flat = PinballMap("egg", lam=0.95, alpha="0.1")
    theta = rng.integers(-1, 2, count) * 2 * np.pi / 3 + np.pi / 3 + side * tiny
    yield "egg, alpha = 0.1, from flat points", flat, zero, np.remainder(theta + np.pi, 2 * np.pi) - np.pi, angle
    long = PinballMap("ellipse", lam=0.95, a=10000)
    yield "ellipse, a = 1e4", long, zero, rng.uniform(-np.pi, np.pi, count), angle
    yield "ellipse, a = 1e4, near the tip", long, zero, side * tiny, angle


def main(count, word):
    rng = np.random.default_rng(11)
    say(f"{count} points a case; errors in units of 2**-52")
    say(
        f"{'case':<40}{'stopped':>9}{'wrong':>7}{'position':>10}{'direction':>11}{'/condition':>18}{'beyond':>8}{'from':>9}"
    )
    for label, map, component, theta, phi in cases(count, rng):
        if word not in label:
            continue
        own = map.states.enter(component, theta, phi, "pinball")
        lam = np.full(theta.size, float(map.lam))
        result = map.engine.run(Question("pinball", record=True), own, lam, map.shape, 1)
        with np.errstate(all="ignore"):
            state = exactly(map.family.name, own)
            shape = [np.longdouble(x.numerator) / np.longdouble(x.denominator) for x in map.exact_shape]
            truth, _ = map.family.bounce(Wide(), "pinball", shape, lam.astype(np.longdouble), state)
        found = result.record[0]
        going = result.rows["code"] == 0 if "code" in result.rows else np.ones(theta.size, dtype=bool)
        gaps = [np.abs(np.asarray(a - b, dtype=float)) for a, b in zip(truth, found, strict=True)]
        if map.family.name == "circle":
            gaps[0] = np.minimum(gaps[0], 2 * np.pi - gaps[0])
        half = len(map.family.position)
        place = np.max(gaps[:half], axis=0)[going]
        turned = np.max(gaps[half:], axis=0)[going]
        wrong = int(np.sum(~(place < 1e-3)))
        matrix = np.abs(map.derivative(theta, phi, component))[going]
        conditions = 1 + matrix[:, 0].sum(axis=-1), 1 + matrix[:, 1].sum(axis=-1)
        worst = [np.max(e, initial=0) / EPS for e in (place, turned)]
        worst += [np.max(e / c, initial=0) / EPS for e, c in zip((place, turned), conditions, strict=True)]
        beyond = [e > bound * EPS for e, bound in ((place, 4), (turned, 8))]
        least = min(np.min(c[far], initial=np.inf) for far, c in zip(beyond, conditions, strict=True))
        say(
            f"{label:<40}{np.sum(~going):>9}{wrong:>7}{worst[0]:>10.3g}{worst[1]:>11.3g}{worst[2]:>10.2g}"
            f" {worst[3]:>7.2g}{np.sum(beyond[0] | beyond[1]):>8} {least:>8.2g}"
        )


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000, sys.argv[2] if len(sys.argv) > 2 else "")
