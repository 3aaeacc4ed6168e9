"""The doubling of the horizontal orbit, blown up: what is divided by `e`, over balls of `e` and at points of them."""

import pytest
from flint import arb, arb_mat
from sympy import Rational

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables import egg
from verification.arithmetic.balls import real_ball, working
from verification.cycles.chain import trace_and_determinant
from verification.proofs.corner import corner_orbit
from verification.proofs.corner.corner_orbit import BITS, MOST, RADII, divided, half, linearised, slope_at_zero, step
from verification.proofs.periodic.interval_newton import Enclosure, Status

WIDE = arb(MOST / 2, MOST / 2 * (1 + 2.0**-40))
POINTS = ("0.0005", "0.01", "0.025", "0.04")


def near():
    return slope_at_zero(), real_ball(lambda_c(), 30).mid()


def test_what_is_divided_by_a_ball_around_0_holds_what_is_divided_by_its_numbers():
    with working(BITS):
        m, lam = near()
        for dm, dlam in ((0, 0), (arb(0.05), arb(0.01)), (arb(-0.03), arb(0.005))):
            over = divided(WIDE, m + dm, lam + dlam)
            for e in map(arb, POINTS):
                at = divided(e, m + dm, lam + dlam)
                rule = linearised(e, e * (m + dm), lam + dlam).value
                assert all(abs(x * e - y) < 1e-25 for x, y in zip(at, rule, strict=True))
                assert all(x.contains(y) for x, y in zip(over, at, strict=True))
            assert all(x.rad() < 0.02 for x in over)


def test_the_second_derivative_over_e_holds_the_differences_of_the_divided_rules():
    """`H_e/e` at `e` by differences, for numbers `e` of the ball; and it is not much wider than these are apart."""
    with working(BITS):
        (m, lam), h = near(), arb(10) ** -9
        m, lam = m + arb("0.01"), lam + arb("0.003")
        over = corner_orbit.third_order(WIDE, m, lam)
        told = [[], []]
        for e in map(arb, POINTS[1:]):
            low, high = divided(e - h, m, lam), divided(e + h, m, lam)
            for known, a, b, ball in zip(told, low, high, over, strict=True):
                known.append(((b - a) / (2 * h) / e).mid())
                assert (ball + arb(0, 1e-6)).contains(known[-1])
        assert all(abs(ball.mid() - known[0]) < 0.2 * abs(known[0]) for ball, known in zip(over, told, strict=True))


def test_a_hull_reaches_from_0_to_the_ball_and_to_its_multiples():
    w, v = corner_orbit.hull_from_zero(arb(0.75, 0.25), arb(-2))
    assert (w.contains(0), w.contains(1), w.rad() < 0.501) == (True, True, True)
    assert (v.contains(0), v.contains(-2), v.rad() < 1.001) == (True, True, True)


def linear(monkeypatch, spread=0.0):
    """`H = A*(x - x0)` with `x0 = (0.5, -0.25)` and derivatives in balls about `A`."""
    rows = [[2.0, 1.0], [-1.0, 3.0]]

    def divided(e, m, lam):
        return [a * (m - 0.5) + b * (lam + 0.25) for a, b in rows]

    monkeypatch.setattr(corner_orbit, "divided", divided)
    monkeypatch.setattr(
        corner_orbit, "derivatives", lambda e, m, lam: arb_mat([[arb(a, spread), arb(b, spread)] for a, b in rows])
    )


def test_a_step_of_krawczyk_holds_the_zero_and_is_as_wide_as_its_derivatives_are_unsure(monkeypatch):
    linear(monkeypatch)
    middle, box = [arb(0.51), arb(-0.26)], [arb(0.51, 0.125), arb(-0.26, 0.0625)]
    with working(64):
        (m, lam), slope = step(arb(1), middle, box)
        assert abs(m - 0.5) < 1e-15
        assert abs(lam + 0.25) < 1e-15
        assert [[float(x) for x in row] for row in slope.tolist()] == [[2, 1], [-1, 3]]
        linear(monkeypatch, 2.0**-5)
        (m, lam), _ = step(arb(1), middle, box)
        wide = 2.0**-5 * (0.125 + 0.0625)
        assert float(m.rad()) == pytest.approx(wide * 4 / 7, rel=1e-3)
        assert float(lam.rad()) == pytest.approx(wide * 3 / 7, rel=1e-3)


@pytest.mark.parametrize("middle", [(0.7, -0.25), (0.5, -0.4), (2.0, 2.0)])
def test_a_step_that_leaves_its_box_proves_nothing(monkeypatch, middle):
    linear(monkeypatch)
    box = [arb(x, r) for x, r in zip(middle, (0.125, 0.0625), strict=True)]
    assert step(arb(1), [arb(x) for x in middle], box) is None


def test_a_step_with_derivatives_that_may_be_singular_proves_nothing(monkeypatch):
    linear(monkeypatch)
    monkeypatch.setattr(corner_orbit, "derivatives", lambda *_: arb_mat([[1, 1], [1, 1]]))
    assert step(arb(1), [arb(0.5), arb(-0.25)], [arb(0.5, 0.125), arb(-0.25, 0.0625)]) is None


def test_the_direction_of_the_doubling_has_the_multiplier_minus_1():
    """Both rules hold for `(1, m)` at `lambda_c`, and the trace of half an orbit there is that of -1 and the rest."""
    with working(BITS):
        m, lam = near()
        a = corner_orbit.dense(linearised(arb(0), arb(0), real_ball(lambda_c(), 30)).plain)
        assert all(abs(a[i, 0] + a[i, 1] * m) < 1e-25 for i in range(2))
        trace, determinant = half(arb(0), m, lam)
        assert abs(1 - trace + determinant) < 1e-25  # of half an orbit and the mirror: the multiplier 1


def test_the_branch_is_asked_over_all_e_first_and_then_at_its_end(monkeypatch):
    real, asked = corner_orbit.step, []
    monkeypatch.setattr(corner_orbit, "step", lambda *given: asked.append(given) or real(*given))
    found = corner_orbit.doubled_branch()
    (first, middle, box), *ends = asked

    assert first.contains(0)
    assert first.contains(arb(MOST))
    assert first.upper() < MOST * 1.0001
    assert [float(x.rad()) for x in box] == pytest.approx(RADII)
    assert abs(middle[1] - real_ball(lambda_c(), 30)) < 1e-15
    assert len(ends) == 3
    assert all(e == arb(MOST) for e, *_ in ends)
    for (_, centre, last), (_, _, before) in zip(ends[1:], ends[:-1], strict=True):
        assert all(x.rad() < y.rad() for x, y in zip(last, before, strict=True))
        assert all(x.contains(c) and c.is_exact() for x, c in zip(last, centre, strict=True))
    with working(BITS):
        assert found.end.rad() < 1e-8
        assert all(abs(x) < 1e-7 for x in divided(arb(MOST), ends[-1][1][0], ends[-1][1][1]))
        assert found.m.contains(ends[-1][1][0])
        assert found.lam.contains(found.end)


@pytest.mark.parametrize(
    ("trace", "everywhere", "unstable"),
    [
        (arb(2), arb(0.5), True), (arb(1.25), arb(0.25), None), (arb(2), arb(0, 1.5), None), (arb(2), arb(-0.5), True),
        (arb(2), arb(1), None), (arb(1), arb(0.5), None),
    ],
)  # fmt: skip
def test_the_multipliers_at_the_end_and_the_determinant_over_all_e_say_that_a_branch_is_unstable(
    monkeypatch, trace, everywhere, unstable
):
    """At the end `1 - trace + det < 0`, where the determinant is 1/4; over all `e` it is between -1 and 1."""
    monkeypatch.setattr(
        corner_orbit, "half", lambda e, m, lam: (trace, arb(0.25)) if e.is_exact() else (arb(9), everywhere)
    )
    assert corner_orbit.doubled_branch().unstable is unstable


def test_derivatives_by_the_contraction_are_those_of_the_rules_at_every_point_of_the_branch():
    """By differences in `lam`, off the direction `m` of the doubling, to far more digits than a ball is wide."""
    with working(BITS):
        (m, lam), h = near(), arb(10) ** -8
        for e, off in ((arb("0.04"), arb("0.5")), (arb("0.02"), arb("-0.25"))):
            over = corner_orbit.derivatives(e, m + off, lam)
            low, high = (divided(e, m + off, lam + s * h) for s in (-1, 1))
            for i in range(2):
                quotient = (high[i] - low[i]) / (2 * h)
                assert (over[i, 1] + arb(0, 1e-9)).contains(quotient.mid())
                assert over[i, 1].rad() < 0.01


@pytest.mark.parametrize(("apart", "held"), [(0, None), (1, True), (2, None)])
def test_bounces_are_apart_by_no_whole_turns(monkeypatch, apart, held):
    """By 0, by 2*pi*1/3 and by 2*pi: a third of a turn is one, and a whole turn is none."""
    asked = []
    gap = (arb(0), 2 * arb.pi() / 3, 2 * arb.pi())[apart]
    zero = [arb(1) + gap, arb(1), arb(0.05, 1e-12)]
    monkeypatch.setattr(corner_orbit, "interval_newton", lambda *_: Enclosure(Status.UNIQUE, zero))
    monkeypatch.setattr(corner_orbit, "convex", lambda *given: asked.append(given) or True)
    monkeypatch.setattr(corner_orbit.CornerClaim, "system", None)
    claim = corner_orbit.CornerClaim("alpha", (arb(0),) * 3, arb(0.01), 64, 10, Rational(1, 3))
    found = corner_orbit.corner_proved(claim)
    assert found.checks["minimal_period"] is held
    assert found.checks["admissible"] is held
    assert asked == ([(egg(3), (zero[-1],))] if held else [])


def test_all_bounces_of_the_branch_are_asked_to_be_inside(monkeypatch):
    asked = []
    monkeypatch.setattr(corner_orbit, "inside", lambda *given: asked.append(given) or True)
    found = corner_orbit.doubled_branch()
    ((_, parts, (w, v)),) = asked
    assert parts == (1, 0)
    for e in (arb(0), arb(MOST)):
        assert w.contains(e)
        assert v.contains((e * found.m).mid())
    assert v.rad() < 1.1 * MOST * abs(found.m).upper()


def test_half_an_orbit_has_its_bounce_on_the_wall_at_e_and_that_on_the_arc_at_m_times_e():
    with working(BITS):
        e, m, lam = arb("0.0625"), arb("-0.5"), arb("0.25")
        chain = linearised(e, arb("-0.03125"), lam).plain
        for found, wanted in zip(half(e, m, lam), trace_and_determinant(chain.rows, chain.sign), strict=True):
            assert found.overlaps(wanted)
            assert found.rad() < 1e-12
