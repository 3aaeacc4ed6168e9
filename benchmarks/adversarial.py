"""A million points for each labelled case: did the kernel take the right zero, and how exact was it?

The two columns `/condition` divide by one plus the row sums of the derivative matrix, the condition numbers; `beyond`
and `from` say how many points go beyond 4 (position) or 8 (direction), and the smallest condition number among them.
The reference is the same step on 80-bit floats, with elementary functions and zeros to their own last bits
(`verification/measure/extremes/kernels.py`); that the step itself is right is what
tests/numeric/flights/test_accuracy.py shows,
with 50 digits. `judge` is how far the reference moves when the state is rounded once more in 80 bits: what it can
tell. A point is beyond only where that does not explain it.

    python benchmarks/adversarial.py [POINTS [WORD]]        only the cases whose label has the word
"""

import sys

import numpy as np

from verification.measure.extremes.kernels import Wide, made_unit
from verification.measure.extremes.orbits import RADII, bounced, cases, conditions, own_cases

EPS = 2.0**-52


def say(text):
    """A line on standard output, at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main(count, word):
    say(f"{count} points a case; errors in units of 2**-52")
    say(
        f"{'case':<40}{'stopped':>9}{'wrong':>7}{'position':>10}{'direction':>11}{'/condition':>18}"
        f"{'judge':>9}{'beyond':>8}{'from':>9}"
    )
    for case in cases(count):
        if word in case.label:
            line(case)
    for name in RADII:
        if name in word or not word:
            for case in own_cases(name, count):
                line(case)


def line(case):
    """What is said of a case."""
    own, found, going = bounced(case)
    truth, *others = references(case.map, own)
    place, turned = (size[going] for size in apart(case.map, truth, found))
    doubts = [apart(case.map, truth, other) for other in others]
    doubt = [np.max([one[i] for one in doubts], axis=0)[going] for i in (0, 1)]
    wrong = int(np.sum(~(place < 1e-3)))
    condition = [each[going] for each in conditions(case)]
    worst = [np.max(e, initial=0) / EPS for e in (place, turned)]
    worst += [np.max(e / c, initial=0) / EPS for e, c in zip((place, turned), condition, strict=True)]
    judge = max(np.max(d, initial=0) for d in doubt) / EPS
    beyond = [e - d > bound * EPS for e, d, bound in zip((place, turned), doubt, (4, 8), strict=True)]
    least = min(np.min(c[far], initial=np.inf) for far, c in zip(beyond, condition, strict=True))
    say(
        f"{case.label:<40}{np.sum(~going):>9}{wrong:>7}{worst[0]:>10.3g}{worst[1]:>11.3g}{worst[2]:>10.2g}"
        f" {worst[3]:>7.2g}{judge:>9.2g}{np.sum(beyond[0] | beyond[1]):>8} {least:>8.2g}"
    )


def references(map, own):
    """The landings in 80 bits: of the state as it is, and with the last bit of some numbers moved."""
    lam = np.full(own[0].size, np.longdouble(float(map.lam)))
    shape = [np.longdouble(x.numerator) / np.longdouble(x.denominator) for x in map.exact_shape]
    with np.errstate(all="ignore"):
        state = made_unit(map.family, [row.astype(np.longdouble) for row in own])
        half = len(map.family.position)
        for some in ((), range(half), (half - 1, half)):  # never all alike: angles must move against each other
            moved = [
                np.where(np.isin(row, (0, 1)), row, np.nextafter(row, np.longdouble(np.inf))) if i in some else row
                for i, row in enumerate(state)
            ]
            yield map.family.bounce(Wide(), map.law, shape, lam, moved)[0]


def apart(map, one, other):
    """The distance of two landings, in position and in direction."""
    gaps = [np.abs(np.asarray(a - b, dtype=float)) for a, b in zip(one, other, strict=True)]
    if map.family.position == ("theta",):
        gaps[0] = np.minimum(gaps[0], 2 * np.pi - gaps[0])
    half = len(map.family.position)
    return np.max(gaps[:half], axis=0), np.max([*gaps[half:], 0 * gaps[0]], axis=0)


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000, sys.argv[2] if len(sys.argv) > 2 else "")
