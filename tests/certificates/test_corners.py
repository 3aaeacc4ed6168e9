"""The hypotheses of a corner orbit beyond those of a cycle: one-sided slopes, multipliers, free chords."""

from fractions import Fraction
from functools import partial
from itertools import product
from random import Random
from types import SimpleNamespace

import by_hand
import pytest

P = 60


number = partial(by_hand.number, p=P)


ROUND = (3, 1), (0, Fraction(1, 2)), (1, 1)  # the derivative of a round, and the slopes by both of where its corner is


def cornered(check, motion=2, arc=3, straight=-1, fall=-5, shift=4, rounds=(ROUND, ROUND), theta1="1/4"):
    """The checks of a corner orbit with these slopes by the exit angle and by lam, and the chords that were tested.

    The two rounds are those of orbits that meet the lower corner on the arc and on the wall.
    """
    sides, asked, between = [], [], number(check, theta1)
    jet = lambda *slopes: check.Jet([number(check, x) for x in (0, *slopes[::-1])], 1)  # noqa: E731  # by start, angle and lam
    place = lambda part, x: (part, check.I.of(x, P).real())  # noqa: E731

    def orbit(launch, at, way, order):
        here = launch(*(check.Jet.of(x, order, k) for k, x in enumerate(at)))
        assert check.value(here[2]["lam"]).real() == pytest.approx(1 / 9)
        way, bounce = [place(*bounce) for bounce in way], between.real()
        side = next(k for k in (0, 1) if (k, 3 if k else -2) in way)
        through = [(0, bounce), (side, 3 if side else -2), (0, -bounce)]
        assert order == 1
        if len(way) == 5:
            assert way == [(0, 2), *through, (0, 2)]
            assert check.value(here[0]).real() == 2  # from the upper corner, on the arc
            assert [(x.lo, x.hi) for x in here[0].gradient(P)] == [(0, 0)] * 3  # wherever it is told to begin
            sides.append(side)
            second = jet(0, 7 if side else motion, shift)
            last = jet(0, straight, fall + Fraction(straight * shift, 7)) if side else jet(0, arc, 100)
            return [(jet(0, 0, 0),) * 2, (jet(1, 2, 3), jet(4, 5, 6)), (second,), (jet(0, 0, 0),), (last,)]
        assert way == through
        (a, b), (c, d), (e, f) = rounds[side]
        return [None, (jet(e, f, 0), None), (jet(-a, -b, 0), jet(-c, -d, 0))]

    table = SimpleNamespace(p=P, orbit=orbit)
    table.ends = lambda component, p: (number(check, -2 - component), number(check, 2 + component))
    table.free = lambda here, there, names: asked.extend(
        (place(*one), place(*other)) for one, other in product(here, there)
    )
    image = [number(check, 0), number(check, 0), number(check, "1/9")]
    check.beside("corner").cornered(SimpleNamespace(table=table, p=P), image, between)
    return sides, asked


def holds(check, item, **given) -> bool:
    """True if nothing is refused; or, given an item, if exactly this one is refused."""
    refused = ""
    try:
        cornered(check, **given)
    except check.Unproved as why:
        refused = str(why)
    assert not refused or refused.startswith(item)
    return not refused


def test_the_chords_of_a_corner_orbit_are_free_on_either_side_of_both_corners(check):
    """From the upper corner to the bounce between, and on to the lower one; the rest follows by the mirror symmetry."""
    sides, asked = cornered(check)

    assert sides == [0, 1]
    upper, lower, between = [(0, 2.0), (1, -3.0)], [(0, -2.0), (1, 3.0)], (0, 0.25)
    assert sorted(asked) == sorted([*((x, between) for x in upper), *((between, x) for x in lower)])


def test_a_kink_is_a_minimum_where_the_return_falls_up_to_it_and_rises_beyond(check):
    """If the bounce moves with the angle, the arc is met beyond the kink, otherwise before; 0 decides nothing."""
    ends = -2, Fraction(-1, 4), 0, Fraction(1, 4), 2
    for motion, arc, straight in product([x for x in ends if x], ends, ends):
        beyond, before = (arc, straight) if motion > 0 else (straight, arc)
        wanted = before < 0 < beyond
        assert holds(check, "s4_minimum", motion=motion, arc=arc, straight=straight) == wanted, (motion, arc, straight)


@pytest.mark.parametrize("shift", [4, 0, -3])
def test_the_return_dips_below_where_it_falls_with_lam_at_the_corner_itself(check, shift):
    """The angle is changed with lam so that the orbit stays in the corner."""
    for fall in (-5, Fraction(-1, 4), 0, Fraction(1, 4), 5):
        assert holds(check, "s4_dips", fall=fall, shift=shift) == (fall < 0)


@pytest.mark.parametrize("seed", range(4))
def test_a_corner_orbit_is_unstable_where_one_side_has_a_multiplier_above_1_and_one_below(check, seed):
    """By the signs of the characteristic polynomial at 0 and 1, and an eigenvector off the preimage of the corner."""
    dice, seen = Random(seed), set()
    good, bad = ROUND, ((1, 0), (0, 1), (1, 1))
    assert holds(check, "unstable", rounds=(good, bad)) and holds(check, "unstable", rounds=(bad, good))  # noqa: PT018
    for _ in range(150):
        (a, b), (c, d), (e, f) = made = [[Fraction(dice.randrange(-6, 9), 2) for _ in range(2)] for _ in range(3)]
        at_0, at_1 = a * d - b * c, (1 - a) * (1 - d) - b * c
        moved = a * f - b * e, c * f - d * e  # of (f, -e), along which the corner stays where it is
        wanted = at_1 < 0 < at_0 and moved[0] * e + moved[1] * f != 0
        seen.add(wanted)
        rounds = ((made, bad), (bad, made))[dice.randrange(2)]
        assert holds(check, "unstable", rounds=rounds) == wanted, made
    assert len(seen) == 2


@pytest.mark.parametrize("other", [(0, 1), (1, 2), (-1, 1)])
@pytest.mark.parametrize("values", [("3", "1/2"), ("1/4", "2")])
def test_a_corner_whose_preimage_runs_along_an_eigenvector_proves_no_instability(check, values, other):
    """Matrices with the eigenvectors `v` and `other`, of which one or none is `(f, -e)`."""
    for v in ((1, 0), (1, 1), (2, 1), (-1, 3)):
        (x, y), (u, w), (m, n) = v, other, map(Fraction, values)
        if x * w == y * u:
            continue
        entries = m * x * w - n * u * y, (n - m) * x * u, (m - n) * y * w, n * x * w - m * u * y
        a, b, c, d = (entry / (x * w - y * u) for entry in entries)
        for e, f, wanted in ((-y, x, False), (-w, u, False), (-y - w, x + u, True)):
            assert holds(check, "unstable", rounds=(((a, b), (c, d), (e, f)),) * 2) == wanted, (v, e, f)
