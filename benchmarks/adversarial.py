"""Errors of the kernels on a million points of each labelled hard case: is the zero the right one, and how exact?

    python benchmarks/adversarial.py [POINTS [WORD]]            all cases, or those whose label has the word
    python benchmarks/adversarial.py pieces [POINTS [WORD]]     tables of sides and arcs: the table of docs/tables.md
    python benchmarks/adversarial.py inside [POINTS]            tables given by a radius: flights stay inside
    python benchmarks/adversarial.py splines [POINTS [WORD]]    splines: every zero of every cubic is a candidate

The reference is the same step on 80-bit floats (`verification/measure/extremes/kernels.py`); that this step is right is
tested with 50 digits in tests/numeric/flights/test_accuracy.py. Columns `/condition` are divided by the condition
number, one plus the row sums of the derivative matrix; `beyond` counts points with errors above 4 (position) or 8
(direction), `from` is the smallest condition number among them, and `judge` is how far the reference moves when the
state is rounded once more in 80 bits. Tables of sides and arcs are compared with every piece tried in 80 bits
(`by_hand.py` there), splines with every zero; where rounding decides, with the exact map in 50 digits.
"""

import sys

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.backends.scalars import ArrayBackend
from symbolic import tables
from verification.maps.exact import ExactMap, errors
from verification.measure.extremes.by_hand import WIDE, comet, cubic_hits, discs, hard, judged, spikes
from verification.measure.extremes.kernels import Wide, bounced, made_unit
from verification.measure.extremes.orbits import (
    DIGITS,
    LAM,
    LONG_RADII,
    cases,
    conditions,
    own_cases,
    spline_cases,
)

EPS = 2.0**-52


def say(text):
    """Prints a line on standard output at once."""
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
    for name in LONG_RADII:
        if word in name:
            for case in own_cases(name, count):
                line(case)


def line(case):
    """The line of the output for one case."""
    own, found, code = bounced(case.map, case[2:])
    going = code == 0
    order = np.argsort(steps(case.map, own), kind="stable")
    sizes = np.empty((4, order.size))
    for i in range(0, order.size, FEW):
        some = order[i : i + FEW]
        sizes[:, some] = judged_by_80_bits(case.map, [row[some] for row in own], [row[some] for row in found])
    place, turned, *doubt = sizes[:, going]
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


class Counted(ArrayBackend):
    """A float64 backend that counts the steps of each point's marches."""

    def __init__(self, count):
        self.steps = np.zeros(count)

    def repeat(self, condition, body, state, limit, steady=False):
        """As `ArrayBackend.repeat`, with counts."""

        def counted(state):
            active = condition(state)
            self.steps += active
            return active

        return super().repeat(counted, body, state, limit, steady)


def steps(map, own):
    """The number of steps of each point's marches; points of similar counts are computed together."""
    ops = Counted(own[0].size)
    with np.errstate(all="ignore"):
        map.family.bounce(ops, map.law, map.shape, np.full(own[0].size, float(map.lam)), own)
    return ops.steps


def judged_by_80_bits(map, own, found):
    """Errors in position and direction, and the uncertainty of the reference for all large ones and 1 of 16 others."""
    (truth,) = references(map, own, MOVED[:1])
    errors = apart(map, truth, found)
    asked = ~(errors[0] <= 4 * EPS) | ~(errors[1] <= 8 * EPS)
    asked[::16] = True
    others = references(map, [row[asked] for row in own], MOVED[1:])
    truth = [row[asked] for row in truth]
    doubts = np.zeros((2, asked.size))
    doubts[:, asked] = np.max([apart(map, truth, other) for other in others], axis=0)
    return [*errors, *doubts]


MOVED = "none", "first", "middle"  # never all alike: angles must move against each other


def references(map, own, moves):
    """The landings in 80 bits, with the last bit of some numbers changed."""
    lam = np.full(own[0].size, np.longdouble(float(map.lam)))
    shape = [np.longdouble(x.numerator) / np.longdouble(x.denominator) for x in map.exact_shape]
    with np.errstate(all="ignore"):
        state = made_unit(map.family, [row.astype(np.longdouble) for row in own])
        half = len(map.family.position)
        for move in moves:
            some = {"none": (), "first": range(half), "middle": (half - 1, half)}[move]
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


SIZES = {"": Rational(1), "1e-6 of ": Rational(1, 10**6), "1e6 of ": Rational(10**6)}
UNEQUAL = [(0, 0), (SIZES["1e-6 of "], 0), (10**6, SIZES["1e-6 of "]), (10**6, 1), (0, 1)]
NOTCHED = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
NAMED = ("square", "stadium", "reuleaux", "lemon", "semi_ellipse", "mushroom", "sinai", "diamond")
OWN = {name: getattr(tables, name) for name in NAMED} | {
    "comet": comet,
    "notched": lambda: tables.polygon(*NOTCHED, name="notched"),
    "100 spikes": lambda: spikes(100),
    "36 discs": lambda: discs(6),
    "sides of 1e-6 and 1e6": lambda: tables.polygon(*UNEQUAL, name="unequal"),
}
BLOCK = 50_000
FEW = 2_000  # points of which an 80-bit array stays in the cache


def by_hand(count, word):
    """Measures the tables of sides and arcs."""
    say(f"{count} points a case; errors sideways in units of 2**-52 of the numbers added up")
    say("| table | flights | points | stopped | wrong | largest error | farthest reason to stop |")
    say("|---|---|---|---|---|---|---|")
    for name, made in OWN.items():
        for size, factor in SIZES.items():
            if (word and word not in name) or (size and "1e" in name):
                continue
            parts = [
                tables.arc(part.name, *(factor * x for x in part.point), part.start, part.end)
                for part in made().components
            ]
            many = len(parts) > 32  # of which nothing is proved again
            table = tables.Table(name, tuple(parts)) if many else tables.piecewise(*parts, name=name)
            map = PinballMap(table, lam=LAM)
            for label, (counts, (error, reason)) in totals(of_pieces(map, count)).items():
                say(f"| {size}{name} | {label} | {' | '.join(f'{x}' for x in counts)} | {error:.2g} | {reason:.3g} |")


def of_pieces(map, count):
    """Yields by kind: points, those that stopped, those that are wrong; the largest error, the weakest reason."""
    for seed in range(-(-count // BLOCK)):
        for label, starts in hard(map, min(count, BLOCK), seed).items():
            found = judged(map, starts)
            largest = float(np.max(np.where(found.wrong, 0, found.error))), float(np.max(found.reason))
            yield label, (starts[1].size, int(np.sum(found.stopped)), int(np.sum(found.wrong))), largest


def totals(found):
    """The sums of counts and the largest of numbers, by label."""
    rows = {}
    for label, counts, numbers in found:
        if label in rows:
            counts = [x + y for x, y in zip(rows[label][0], counts, strict=True)]
            numbers = [max(x, y) for x, y in zip(rows[label][1], numbers, strict=True)]
        rows[label] = counts, numbers
    return rows


PARTS = ((np.arange(64) + 0.5) / 64)[:, None]


def inside(count, word):
    """Measures flights on tables given by a radius: 64 points of each lie inside, to 64 units; doubts go to 80 bits."""
    say("| table | flights | points | stopped | outside |")
    say("|---|---|---|---|---|")
    for name in LONG_RADII:
        for case in own_cases(name, count) if not word or word in name else ():
            own, found, code = bounced(case.map, case[2:])
            going = code == 0
            out = 0
            for block in range(0, own[0].size, BLOCK):
                cut = slice(block, block + BLOCK)
                doubles = case.map.states.ops, [row[cut] for row in own], [row[cut] for row in found]
                doubtful = np.flatnonzero(~(farthest_outside(case.map, *doubles) <= 64 * EPS) & going[cut])
                wide = [made_unit(case.map.family, [x[doubtful].astype(WIDE) for x in rows]) for rows in doubles[1:]]
                out += int(np.sum(~(farthest_outside(case.map, Wide(), *wide) <= 64 * EPS)))
            label = case.label.partition(", ")[2]
            say(f"| {name} | {label} | {own[0].size} | {int(np.sum(~going))} | {out} |")


def ring(count, radius):
    """The spline through so many points around the origin, with six decimals."""
    angle = 2 * np.pi * np.arange(count) / count
    x, y = 1.5 * radius(angle) * np.cos(angle), radius(angle) * np.sin(angle)
    return tables.from_points([(f"{a:.6f}", f"{b:.6f}") for a, b in zip(x, y, strict=True)])


HOLED = [
    [[(0, 0), (4, 0)], [(4, 0), (5, 2), (4, 3), (3, 3)], [(3, 3), (1, 2), (0, 4)], [(0, 4), (-1, 1), (0, 0)]],
    [[(1, 1), (2, 1)], [(2, 1), (2, 2), (1, 1)]],
]
SPLINES = {
    "convex": lambda: ring(9, lambda angle: 1 + 0.02 * np.cos(3 * angle)),
    "dented": lambda: ring(30, lambda angle: 1 + 0.2 * np.cos(3 * angle)),
    "deeply dented": lambda: ring(30, lambda angle: 1 + 0.5 * np.cos(3 * angle)),
    "rough": lambda: ring(30, lambda angle: 1 + np.random.default_rng(1).uniform(-0.2, 0.2, angle.size)),
    "of 100 points": lambda: ring(100, lambda angle: 1 + 0.2 * np.cos(3 * angle)),
    "corners": lambda: tables.from_path(HOLED[:1]),
    "holed": lambda: tables.from_path(HOLED),
}
ASTRAY = 1e-6  # of the table: farther from the judge's landing is another one


def splines(count, word):
    """Measures splines: flights stopped, undecided, and landed elsewhere than the reference and the exact map say."""
    say(f"{count} points a case; errors sideways in units of 2**-52 of the table")
    say("| spline | flights | points | stopped | in doubt | wrong | largest error |")
    say("|---|---|---|---|---|---|---|")
    for name, made in SPLINES.items():
        if word not in name:
            continue
        map = PinballMap(made(), lam=LAM)
        cases = (
            case for seed in range(-(-count // BLOCK)) for case in spline_cases(name, map, min(count, BLOCK), seed)
        )
        for label, (counts, (error,)) in totals((case.label, *counted(case)) for case in cases).items():
            say(f"| {' | '.join([name, label.partition(', ')[2], *(f'{x}' for x in counts)])} | {error:.2g} |")


def counted(case):
    """Counts of points, stopped, undecided and wrong; and the largest sideways error of the right ones."""
    own, after, code = bounced(case.map, case[2:])
    going = code == 0
    truth = cubic_hits(case.map, own)
    x, y = case.map.states.point(after[0].astype(int), after[1])
    size = max(np.max(np.abs(x)), np.max(np.abs(y)))
    with np.errstate(invalid="ignore"):
        gap = np.hypot(x - truth.x, y - truth.y).astype(float) / size
    astray = going & ~(gap <= ASTRAY)
    wrong = int(np.sum(astray & truth.sure))
    exact = ExactMap(case.map, DIGITS)
    for i in np.flatnonzero(astray & ~truth.sure):
        place, _ = errors(case.map, exact, [row[i : i + 1] for row in own], [row[i : i + 1] for row in after])
        wrong += int(not place[0] * EPS < ASTRAY)
    right = going & ~astray & truth.sure
    error = np.max(gap[right] * truth.straight[right], initial=0) / EPS
    return (going.size, int(np.sum(~going)), int(np.sum(going & ~truth.sure)), wrong), (error,)


def farthest_outside(map, ops, own, found):
    """The largest distance of flights outside the wall, to first order, relative to one plus that from the origin."""
    shape = [ops.number(float(x)) for x in map.shape]
    (x0, y0), (x1, y1) = (map.family.point(ops, *rows[:2], *shape) for rows in (own, found))
    x, y = x0 + PARTS * (x1 - x0), y0 + PARTS * (y1 - y0)
    away = np.hypot(x, y)
    if map.ir.has("focus"):  # 1/r = p + Q.n, of which a radius in doubles would lose digits
        qx, qy, p, size, _ = map.ir.program("focus")(ops, *shape)
        beyond = p * away + size * (qx * x + qy * y) - 1
        steep = np.hypot(p * x / away + size * qx, p * y / away + size * qy)
        return np.max(beyond / steep / (1 + away), axis=0).astype(float)
    r, slope = map.ir.program("radius").only(0, 1)(ops, x / away, y / away, *shape)
    return np.max((away - r) / np.hypot(1, slope / r) / (1 + away), axis=0).astype(float)


if __name__ == "__main__":
    words = sys.argv[1:]
    ways = {"pieces": by_hand, "inside": inside, "splines": splines}
    way = ways[words.pop(0)] if words and words[0] in ways else main
    way(int(float(words[0])) if words else 1_000_000, words[1] if len(words) > 1 else "")
