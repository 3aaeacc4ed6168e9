"""A million points for each labelled case: did the kernel take the right zero, and how exact was it?

The two columns `/condition` divide by one plus the row sums of the derivative matrix, the condition numbers; the
last two say how many points go beyond 4 (position) or 8 (direction), and the smallest condition number among them.
The reference is the same step on 80-bit floats (NumPy's longdouble, 11 bits more than a double);
that the step itself is right is what tests/numeric/test_accuracy.py shows at 50 digits.

    python benchmarks/adversarial.py [POINTS [WORD]]        only the cases whose label has the word
"""

import sys

import numpy as np

from verification.extremes.kernels import Wide
from verification.labelled import bounced, cases, conditions

EPS = 2.0**-52


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


def main(count, word):
    say(f"{count} points a case; errors in units of 2**-52")
    say(
        f"{'case':<40}{'stopped':>9}{'wrong':>7}{'position':>10}{'direction':>11}{'/condition':>18}{'beyond':>8}{'from':>9}"
    )
    for case in cases(count):
        if word not in case.label:
            continue
        label, map = case.label, case.map
        own, found, going = bounced(case)
        lam = np.full(case.theta.size, np.longdouble(float(map.lam)))
        with np.errstate(all="ignore"):
            state = exactly(map.family.name, own)
            shape = [np.longdouble(x.numerator) / np.longdouble(x.denominator) for x in map.exact_shape]
            truth, _ = map.family.bounce(Wide(), map.law, shape, lam, state)
        gaps = [np.abs(np.asarray(a - b, dtype=float)) for a, b in zip(truth, found, strict=True)]
        if map.family.name == "circle":
            gaps[0] = np.minimum(gaps[0], 2 * np.pi - gaps[0])
        half = len(map.family.position)
        place = np.max(gaps[:half], axis=0)[going]
        turned = np.max([*gaps[half:], 0 * gaps[0]], axis=0)[going]
        wrong = int(np.sum(~(place < 1e-3)))
        condition = [each[going] for each in conditions(case)]
        worst = [np.max(e, initial=0) / EPS for e in (place, turned)]
        worst += [np.max(e / c, initial=0) / EPS for e, c in zip((place, turned), condition, strict=True)]
        beyond = [e > bound * EPS for e, bound in ((place, 4), (turned, 8))]
        least = min(np.min(c[far], initial=np.inf) for far, c in zip(beyond, condition, strict=True))
        say(
            f"{label:<40}{np.sum(~going):>9}{wrong:>7}{worst[0]:>10.3g}{worst[1]:>11.3g}{worst[2]:>10.2g}"
            f" {worst[3]:>7.2g}{np.sum(beyond[0] | beyond[1]):>8} {least:>8.2g}"
        )


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000, sys.argv[2] if len(sys.argv) > 2 else "")
