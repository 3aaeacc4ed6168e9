"""Functions in pieces under the transfer operator: each stretch by itself, against the formulas in float64."""

from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb, arb_series
from scipy.integrate import quad

from symbolic.cycles.cardioid_slap import branch
from symbolic.expressions.text import load
from verification.arithmetic.balls import ARRAYS, working
from verification.arithmetic.series import expanded, taylor
from verification.proofs.slap_map import candidate
from verification.proofs.slap_map.candidate import ABOVE, BELOW, OWN, Judge, Pieces, _parted
from verification.proofs.slap_map.transfer import Branches, Variation

HALF, BITS, DIGITS = np.pi / 2, 96, 2
ENDS = [0.0, 0.25, 0.625, 1.0, 1.375, 1.5708740234375]  # the last one is beyond pi/2
NUMBERS = [[1.0, 0.25, -0.125], [1.25, -0.5, 0.0625, 0.03125], [0.75, 0.125], [0.5, -0.25, 0.125], [0.25, -0.25]]


def pieces():
    return Pieces([arb(end) for end in ENDS], [[arb(c) for c in row] for row in NUMBERS])


@cache
def judge():
    with working(BITS):
        return Judge(pieces().grounded(), DIGITS, BITS)


@cache
def kernels():
    return tuple(load(branch(form), ARRAYS) for form in (False, True))


def polynomial(k, y, shift=0.0):
    low, high = ENDS[k], ENDS[k + 1]
    return np.polynomial.polynomial.polyval((2 * y - low - high) / (high - low), NUMBERS[k]) - shift


LAST = polynomial(4, HALF)


def density(y):
    """The grounded function in floats."""
    k = min(max(int(np.searchsorted(ENDS, y, side="right")) - 1, 0), 4)
    return polynomial(k, y, LAST if k == 4 else 0.0)


def launched(landing):
    return (float(x) for x in kernels()[int(landing >= -0.1)](np.float64(landing)))


def summands(x):
    """Those of the operator at `x`: rate, and launching point, of each that is there."""
    return [tuple(launched(b)) for b in ((-x, x) if x < HALF / 2 else (-x,))]


def residual(x):
    return sum(rate * density(y) for y, rate in summands(x)) - density(x)


def logarithmic(x):
    return sum(-rate * np.log(rate) * density(y) for y, rate in summands(x))


def test_pieces_are_polynomials_of_their_own_variable():
    with working(BITS):
        made = pieces()
        for k in range(5):
            middle = (ENDS[k] + ENDS[k + 1]) / 2
            for y in (ENDS[k], middle, ENDS[k + 1], ENDS[k] + 0.0625):
                z = (y - middle) / ((ENDS[k + 1] - ENDS[k]) / 2)
                assert abs(made.local(k, arb(y)) - z) < 1e-14
                assert abs(made.value(k, arb(y)) - polynomial(k, y)) < 1e-14
        jumps = sum(abs(polynomial(k, ENDS[k]) - polynomial(k - 1, ENDS[k])) for k in range(1, 5))
        assert abs(made.jumps() - jumps) < 1e-13
        whole = sum(quad(lambda y, k=k: polynomial(k, y), ENDS[k], min(ENDS[k + 1], HALF))[0] for k in range(5))
        assert abs(made.integral() - whole) < 1e-12
        level = made.grounded()
        assert level.value(4, arb.pi() / 2).contains(0)
        assert level.polynomials[:4] == made.polynomials[:4]
        assert level.polynomials[4][1:] == made.polynomials[4][1:]
        assert level.ends is made.ends
        assert made.polynomials[4][0] == 0.25  # as it was


@pytest.mark.parametrize(
    ("low", "high", "met"),
    [
        (0.0, 0.0, [0]), (0.25, 0.25, [0, 1]), (0.125, 0.5, [0, 1]), (0.125, 0.625, [0, 1, 2]),
        (0.375, 1.25, [1, 2, 3]), (1.25, 1.5, [3, 4]), (-1.0, -0.5, [0]), (2.0, 3.0, [4]),
        (0.0, 1.5, [0, 1, 2, 3, 4]), (1.0, 1.0, [2, 3]),
        (arb(0.5, 0.25), 0.75, [0, 1, 2]), (0.75, arb(0.875, 0.25), [2, 3]), (arb(1, 0.5), arb(1, 0.5), [1, 2, 3, 4]),
    ],
)  # fmt: skip
def test_a_stretch_meets_the_pieces_whose_closed_ranges_it_may_touch(low, high, met):
    ends = [x if isinstance(x, arb) else arb(x) for x in (low, high)]
    assert list(pieces().met(*ends)) == met


def test_stretches_follow_each_other_from_0_to_the_last_end_and_are_cut_at_ends_and_about_their_images():
    with working(BITS):
        found, margin = judge().stretches, arb(2) ** (24 - BITS)
        cuts = [low for low, _ in found] + [found[-1][1]]
        assert all(high == low for (_, high), (low, _) in pairwise(found))
        assert cuts[0] == 0
        assert cuts[-1] == ENDS[-1]
        assert abs(cuts[-2] - (arb.pi() / 2 - arb(2) ** -(DIGITS + 4))) < 1e-20
        assert all(low < high for low, high in found)
        assert all(end in cuts for end in map(arb, ENDS[:-1]))
        images = [abs(Branches(BITS).landing(arb(end), BITS)) for end in ENDS[1:-1]] + [arb.pi() / 4]
        for image in images:
            low, high = max(c for c in cuts if c < image), min(c for c in cuts if c > image)
            assert low < image < high
            assert abs(high - low - 2 * margin) < margin * 1e-6
        for low, high in found[:-1]:
            assert high - low <= judge()._longest(low) * 1.0001


def test_parts_of_a_stretch_are_as_long_as_is_said_of_their_lower_ends_and_the_last_one_what_is_left():
    found = [(float(a), float(b)) for a, b in _parted(arb(1), arb(4), lambda low: float(low) / 2)]
    assert found == [(1, 1.5), (1.5, 2.25), (2.25, 3.375), (3.375, 4)]
    assert list(_parted(arb(1), arb(1), lambda low: 1.0)) == []
    assert [(float(a), float(b)) for a, b in _parted(arb(0), arb(1), lambda low: 1.0)] == [(0, 1)]
    ((_, end),) = _parted(arb(0), arb(1, 0.25), lambda low: 1.0)  # a step within the end leaves none out
    assert end.contains(arb(1, 0.25))


def test_on_each_stretch_the_residual_and_its_slope_and_the_logarithm_are_within_their_bounds():
    """Sampled in float64; where each launching point lies in one piece the bounds are not three times too large."""
    own = judge()
    singles, close = 0, 0
    with working(BITS):
        for low, high in own.stretches[:-1:3]:
            size, slope = own._bounds(low, high)
            integral = own._integral(low, high)
            a, b = float(low), float(high)
            at = np.linspace(a, b, 7)[1:-1]
            values = [residual(x) for x in at]
            assert max(map(abs, values)) <= size + 1e-12
            length = high - low
            inner = (b - a) / 6 * (sum(map(logarithmic, at)) + (logarithmic(at[0]) + logarithmic(at[-1])) / 2)
            met, single = own._sides(low, high)
            assert set(met) == ({BELOW} if a >= HALF / 2 else {BELOW, ABOVE})
            if single and length > 1e-9:
                singles += 1
                steps = np.diff(values) / np.diff(at)
                assert max(map(abs, steps)) <= slope + 1e-6
                close += bool(size < 3 * max(map(abs, values)) + 1e-3) and bool(slope < 3 * max(map(abs, steps)) + 0.05)
                assert abs(integral - inner) < 2e-3 * length
                assert integral.rad() < 1e-6 * length
            elif not single:
                most = [
                    expanded(own._logarithmic(s, k), low, high, 2).size() for s, parts in met.items() for k in parts
                ]
                assert float(integral.rad()) == pytest.approx(float(sum(most) * length), rel=1e-6)
                assert abs(integral.mid()) < 1e-6 * length
    assert singles > 20
    assert close > 0.9 * singles


def test_where_pieces_change_the_parts_of_all_that_are_met_are_bounded_one_by_one():
    """Such stretches are so short that bounds are values at a point: of the function, and of each summand."""
    own, seen = judge(), 0
    with working(BITS), taylor(2):
        for low, high in own.stretches[:-1]:
            met, single = own._sides(low, high)
            if single:
                continue
            seen += 1
            at = arb_series([(low + high) / 2, 1])
            parts = [own._part(OWN, own._own(low, high))(at)]
            parts += [own._part(side, k)(at) for side, held in met.items() for k in held]
            for bound, k in zip(own._bounds(low, high), (0, 1), strict=True):
                assert float(bound) == pytest.approx(float(sum(abs(part[k]) for part in parts)), rel=1e-9)
            logs = [own._logarithmic(side, k)(at)[0] for side, held in met.items() for k in held]
            integral = own._integral(low, high)
            assert integral.contains(0)
            assert float(integral.rad() / (high - low)) == pytest.approx(float(sum(map(abs, logs))), rel=1e-6)
    assert seen > 4


@pytest.mark.parametrize(("rate", "told"), [(0.25, True), (0.3, True), (0.34, False), (0.5, False), (0.9, False)])
def test_the_tail_of_a_mean_is_bounded_where_the_rate_is_below_one_third(rate, told):
    """By hand: the largest `-rate*log(rate)` times what two pieces may be between both launching points."""
    launched = {-2.0: (arb(0.125), arb(rate)), -3.0: (arb(0.75), arb(0.0625))}
    own = SimpleNamespace(
        stretches=[(arb(0), arb(1)), (arb(1), arb(2)), (arb(2), arb(3))],
        branches=lambda landing: launched[float(landing)],
        pieces=SimpleNamespace(value=lambda k, launch: [launch, 2 * launch - 2][k]),
        _met=lambda side, low, high: range(2) if (side, low, high) == (BELOW, 2, 3) else None,
        _integral=lambda low, high: high + 4,
    )
    if not told:
        with pytest.raises(ArithmeticError, match="too wide to be bounded"):
            Judge.mean(own)
        return
    found = Judge.mean(own)
    assert found.contains(11)
    assert float(found.rad()) == pytest.approx(-rate * np.log(rate) * (0.75 + 1.75), rel=1e-6)


def test_launching_points_meet_the_pieces_that_they_lie_in():
    own = judge()
    with working(BITS):
        for low, high in own.stretches[:-1:4]:
            for side in (BELOW, ABOVE) if low * 4 < arb.pi() else (BELOW,):
                for x in (float(low), float(low + high) / 2, float(high)):
                    if side * x < HALF / 2:
                        y, _ = launched(side * x)
                        held = [k for k in range(5) if ENDS[k] - 1e-12 <= y <= ENDS[k + 1] + 1e-12]
                        assert set(held) & set(own._met(side, low, high))
        (around,) = [ends for ends in own.stretches if ends[0] * 4 < arb.pi() < ends[1] * 4]
        met, single = own._sides(*around)  # the second summand ends within
        assert (set(met), single) == ({BELOW, ABOVE}, False)
        assert own._own(arb(0.25), arb(0.5)) == 1
        assert own._own(arb(0.5), arb(0.625)) == 1
        with pytest.raises(ValueError, match="unpack"):
            own._own(arb(0.5), arb(0.75))  # in two pieces


def test_parts_of_the_operator_are_the_rate_times_the_value_where_a_particle_left():
    own = judge()
    with working(BITS), taylor(4):
        for x, sides in ((0.5, (BELOW, ABOVE)), (1.0, (BELOW,))):
            assert abs(own._part(OWN, 2)(arb_series([arb(x), 1]))[0] - polynomial(2, x)) < 1e-14
            for side in sides:
                launch, rate = launched(side * x)
                found = own._part(side, 3)(arb_series([arb(x), 1]))
                logs = own._logarithmic(side, 3)(arb_series([arb(x), 1]))
                assert abs(found[0] - rate * polynomial(3, launch)) < 1e-12
                assert abs(logs[0] + np.log(rate) * rate * polynomial(3, launch)) < 1e-12


def test_the_residual_is_the_sum_over_all_stretches_and_the_jumps(monkeypatch):
    """With bounds up to 2.25 and 3.5 on each stretch: as many times the whole length, and the jumps in the second."""
    monkeypatch.setattr(Judge, "_bounds", lambda self, low, high: (arb(2, 0.25), arb(3, 0.5)))
    monkeypatch.setattr(candidate, "variation", lambda: Variation(arb(0.75), arb(2), True))
    with working(BITS):
        own = Judge(pieces().grounded(), DIGITS, BITS)
        found = own.residual()
        jumps = own.pieces.jumps() * 1.75
        assert abs(found.norm - 2.25 * ENDS[-1]) < 1e-6
        assert abs(found.variation - 3.5 * ENDS[-1] - jumps) < 1e-6
        assert found.norm.is_exact()
        assert found.variation.is_exact()


def test_a_mean_is_the_sum_over_all_stretches_and_what_the_tail_may_add(monkeypatch):
    monkeypatch.setattr(Judge, "_integral", lambda self, low, high: high - low)
    with working(BITS):
        own = judge()
        low, high = own.stretches[-1]
        rest = own.mean() - low
        rate = own.branches(-low)[1]
        launches = [own.branches(-x)[0] for x in (low, high)]
        values = abs(own.pieces.value(0, launches[0].union(launches[1]))).upper()  # particles leave near 0
        bound = float((-rate * rate.log() * values * (high - low)).upper())
        assert rest.contains(0)
        assert float(rest.rad()) == pytest.approx(bound, rel=1e-3)
        assert abs(rest.mid()) < 1e-6 * bound
        with pytest.raises(ArithmeticError, match="the tail from"):
            Judge(pieces().grounded(), -4, BITS).mean()


def test_pieces_reach_from_0_to_beyond_the_cusp_with_their_last_one():
    for ends in ([0.125, *ENDS[1:]], ENDS[:-1], [*ENDS, 1.75]):
        rows = [[arb(1)]] * (len(ends) - 1)
        with working(BITS), pytest.raises(ValueError, match="they must reach from 0 to beyond pi/2"):
            _ = Judge(Pieces([arb(end) for end in ends], rows), DIGITS, BITS).stretches


def test_series_have_a_good_part_of_two_terms_for_each_digit_and_eight_at_least():
    assert [Judge(pieces(), digits, BITS).order for digits in (1, 4, 5, 10, 20)] == [8, 8, 8, 17, 34]
