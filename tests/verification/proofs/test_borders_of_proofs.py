"""What only touches is not proved: each inequality of a proof at its border, exactly, and on either side of it.

Where a proof cuts a set into boxes, a solution at a corner of a box is in it.
"""

import math
from fractions import Fraction
from itertools import accumulate, product
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from numeric import PinballMap
from symbolic.tables import egg, square
from symbolic.tables.law import PAPERS_LAW, Law
from verification.arithmetic.balls import between, halves, working
from verification.arithmetic.series import Expansion, Jet
from verification.cycles.problem import Problem
from verification.maps import first_hit
from verification.maps.enclosed import EnclosedMap
from verification.maps.first_hit import Boundary, inside
from verification.proofs.periodic import interval_newton as newton
from verification.proofs.periodic import triangles
from verification.proofs.periodic.bifurcation import Stability, Twist, stability
from verification.proofs.periodic.interval_newton import Cover, Enclosure, Status, parted, reflection
from verification.proofs.slap_map import exponent
from verification.proofs.slap_map.transfer import GRAIN, inverted, largest, spread, ulam

NEAR = 2.0**-40


@pytest.mark.parametrize(
    ("at", "answer"), [(0, None), (1, None), (NEAR, True), (1 - NEAR, True), (-NEAR, False), (1 + NEAR, False)]
)
def test_a_bounce_at_an_end_of_a_side_is_neither_inside_nor_off_it(at, answer):
    assert inside(square(), (0, 1), [arb(at), arb("0.5")]) is answer
    assert inside(square(), (2, 0), [arb("0.5"), arb(at)]) is answer


@pytest.mark.parametrize("x", [0, 1])
def test_a_wall_through_an_end_of_a_chord_is_not_beside_it(x):
    """The chord runs from (0, 0) to (1, 0), and the wall across it."""
    for off, passes in ((0, False), (NEAR * (2 * x - 1), True), (-NEAR * (2 * x - 1), False)):
        wall = lambda t, x=x + off: (arb(x), t, arb(0), arb(1))  # noqa: E731
        assert first_hit._passes(wall, arb(0, 0.5), [], (arb(0), arb(0)), (arb(1), arb(0))) is passes


def test_a_piece_that_ends_on_the_line_of_a_chord_does_not_pass_it():
    """Up to the line and not beyond: the ball of places on it has the line at its end."""
    for low, passes in ((0, False), (2.0**-10, True), (-(2.0**-10), False)):
        for sign in (1, -1):
            rising = lambda t, sign=sign: (arb("0.5"), sign * t, arb(0), arb(sign))  # noqa: E731
            assert first_hit._passes(rising, arb(low + 0.5, 0.5), [], (arb(0), arb(0)), (arb(1), arb(0))) is passes


def test_next_to_a_bounce_a_piece_passes_only_where_the_boundary_keeps_turning_away():
    """The slope of the boundary against the chord may not be 0 anywhere between the bounce and the piece."""
    for slope, passes in ((1, True), (-1, True), (0, False)):
        frame = lambda t, slope=slope: (t, arb(0, 1), arb(1), arb(slope) + arb(0, abs(slope)))  # noqa: E731
        sharp = lambda t, slope=slope: (t, arb(0, 1), arb(1), arb(slope))  # noqa: E731
        ends, piece = ((arb(0), arb(0)), (arb(1), arb(0))), arb("0.5", "0.25")
        assert first_hit._passes(sharp, piece, [[piece]], *ends) is passes
        assert first_hit._passes(frame, piece, [[piece]], *ends) is False  # from 0 to twice the slope
        assert first_hit._passes(sharp, piece, [[]], *ends) is True  # nothing lies between


def test_a_chord_to_a_wall_that_it_runs_along_is_not_free():
    """Two walls that meet the chord from (0, 0) to (1, 0) at its ends, upright or leaning along it."""
    for first, last, free in (((0, -1), (0, 1), True), ((1, 0), (0, 1), False), ((0, -1), (1, 0), False)):
        places = [
            lambda t, v=first: (t * v[0], t * v[1], arb(v[0]), arb(v[1])),
            lambda t, v=last: (1 + t * v[0], t * v[1], arb(v[0]), arb(v[1])),
        ]
        boundary = Boundary(places, [(arb(-1), arb(1))] * 2)
        assert first_hit.free(boundary, (0, arb(0)), (1, arb(0))) is free


@pytest.mark.parametrize(
    ("trace", "determinant", "answer"),
    [
        ("0", "1/2", Stability.ATTRACTING),
        ("0", "1", Stability.UNKNOWN),
        ("3/2", "1/2", Stability.UNKNOWN),
        ("-3/2", "1/2", Stability.UNKNOWN),
        ("7/4", "1/2", Stability.SADDLE),
        ("-7/4", "1/2", Stability.SADDLE),
        ("0", "-1", Stability.UNKNOWN),
        ("1/2", "-1", Stability.SADDLE),
        ("0", "3/2", Stability.UNKNOWN),
    ],
)
def test_a_cycle_attracts_only_where_both_multipliers_are_inside_the_circle_and_not_on_it(trace, determinant, answer):
    """Of a saddle one multiplier is in (-1, 1) and the other beyond."""
    balls = [arb(x.numerator) / x.denominator for x in (Fraction(trace), Fraction(determinant))]

    assert stability(*balls) is answer


def test_islands_need_a_trace_inside_the_circle_and_a_twist_that_is_not_0():
    held = lambda trace, twist: Twist(arb(trace), arb(twist), arb(0)).islands  # noqa: E731

    assert [held(trace, 1) for trace in (-2, -1, 0, 2)] == [None] * 4
    assert [held(trace, twist) for trace in (-1.5, -0.5, 1, 1.5) for twist in (1, -1)] == [True] * 8
    assert held(1, 0) is None


def test_the_periods_are_told_until_one_stays_open(monkeypatch):
    open_at = 4
    monkeypatch.setattr(
        newton, "no_others", lambda catalogue, lam, n, *_: SimpleNamespace(complete=n < open_at or None)
    )

    assert [found.complete for found in newton.proofs(None, Rational(1, 2), 6, 10)] == [True, True, None]
    open_at = 9
    assert len(list(newton.proofs(None, Rational(1, 2), 6, 10))) == 5


ALPHA = Rational(2, 25)
MEASURED = Law("-lam*eta + sin(s)/100")


def test_krawczyk_is_asked_of_small_boxes_on_one_side_of_where_a_law_jumps(monkeypatch):
    """Nothing else excludes these: all angles may be 0. A law of arc length jumps at pi."""
    monkeypatch.setattr(newton, "krawczyk", lambda *_: Enclosure(Status.EMPTY, []))
    any_angle = lambda *_: [arb(0, 1)] * 3  # noqa: E731
    for law, middle, half, answer in (
        (PAPERS_LAW, 0.0, 0.125, True),
        (PAPERS_LAW, 3.125, 0.125, True),
        (PAPERS_LAW, 0.0, 0.25, False),
        (MEASURED, 0.0, 0.125, True),
        (MEASURED, 3.125, 0.125, False),
    ):
        sides = lambda eta, theta: [(arb(0, 1),) * 3]  # noqa: E731
        problem = Problem(egg(3).at(alpha=ALPHA), (0, 0), lam=arb("0.5"), law=law)
        cover = Cover(problem, any_angle, sides, 0.5, [])
        box = ((middle, half), (0.125, half))
        at = [list(accumulate(x)) for x in ([arb(m) for m, _ in box], [arb(m, r) for m, r in box])]
        assert cover._impossible(box, *at) is answer


def test_a_ball_of_places_is_on_one_side_of_where_its_law_jumps_unless_it_reaches_over():
    for law, answers in ((PAPERS_LAW, [True, True]), (MEASURED, [True, False])):
        assert [newton.on_one_side(law, [arb(1), arb(middle, 0.1)]) for middle in (3.0, 3.1)] == answers


@pytest.mark.parametrize("one_side", [True, False])
@pytest.mark.parametrize("status", Status)
def test_a_neighbourhood_of_a_known_cycle_needs_both_a_proof_and_one_side_of_the_jump(monkeypatch, one_side, status):
    """Around each bounce of the cycle, and repeated where the period is a multiple of its own."""
    monkeypatch.setattr(newton, "on_one_side", lambda *_: one_side)
    monkeypatch.setattr(newton, "krawczyk", lambda *_: Enclosure(status, []))
    cycle = SimpleNamespace(theta=[0.5, 3.0], period=2)
    catalogue = SimpleNamespace(of=lambda n: [cycle])
    held = newton.neighbourhoods(catalogue, Problem(egg(3).at(alpha=ALPHA), (0,) * 4, lam=arb("0.5")))

    assert len(held) == (2 if one_side and status is Status.UNIQUE else 0)
    for centre, radius in held:
        assert radius == 0.2
        turned = {tuple(np.round(np.remainder(np.subtract(centre, start), 2 * math.pi), 9)) for start in (0.5, 3.0)}
        assert any(abs(x) < 1e-6 for places in turned for x in places)


@pytest.mark.parametrize(
    ("phi", "eta", "excluded"),
    [
        (0.1, -0.5, False),
        (0.1, 0.5, True),  # an exit angle of the sign of the incidence angle
        (-0.1, 0.5, True),  # an exit angle to the other side
        (0.1, -0.19, True),  # more than the largest contraction leaves
        (0.1, -0.21, False),
        (0.4, -0.9, True),  # larger than any exit angle, and in the sum as well
        (0.34, -0.9, True),  # in the sum alone
    ],
)
def test_each_rule_alone_excludes_a_triangle_whose_angles_are_all_alike(phi, eta, excluded):
    """With the ratio 1/2 the three exit angles are at most 1 together, in a box where the first gap is the largest."""
    box = ((0.0, NEAR), (2.5, NEAR), (2.0, NEAR))
    values = lambda *_: [arb(phi)] * 3 + [arb(eta)] * 3  # noqa: E731
    slopes = lambda *_: [arb(x) for size in (phi, eta) for x in (size, 0, 0) * 3]  # noqa: E731
    with working(64):
        assert triangles._impossible(values, slopes, arb(1), arb("0.5"), 0.25, box) is excluded


def test_an_angle_comes_from_the_gaps_only_where_that_holds():
    """From the parameters where a corner may be seen backwards, if only just, or where it is infinite."""
    inf, ahead = arb(0, "inf"), [arb(1), arb(0), arb(-1), arb(0, 1), arb(1), arb(1)]
    near = [arb(10 + i) for i in range(5)] + [inf]
    closer, angles = lambda *_: [*near, *ahead], lambda *_: [arb(i) for i in range(6)]

    assert [float(x) for x in triangles._from_gaps(angles, closer, [], [])] == [10, 1, 2, 3, 14, 5]


def test_each_gap_is_that_from_its_corner_to_the_next():
    given = []
    closer = lambda *z: given.append(z) or [arb(-1)] * 6 + [arb(1)] * 6  # noqa: E731

    assert triangles._impossible(None, None, arb(1), arb("0.5"), 0.25, ((0.5, NEAR), (2.5, NEAR), (2.0, NEAR)), closer)
    ((a, b, c, *gaps),) = given
    assert all(gap.overlaps(d) for gap, d in zip(gaps, (b - a, c - b, a + 2 * arb.pi() - c), strict=True))
    assert all(gap.rad() < 3 * NEAR for gap in gaps)


@pytest.mark.parametrize("middle", [-3.1, -1.0, 0.0, 3.0, 3.2, 9.4, -9.5])
def test_a_ball_of_parameters_is_told_from_each_side_of_where_a_law_jumps(middle):
    """Each parameter of the ball is in one of the parts, up to whole turns, and within the ends there."""
    for half in (0.05, 0.3):
        parts = parted(arb(middle, half))
        for x in np.linspace(middle - half, middle + half, 31):
            turn = x - 2 * math.pi * round(x / (2 * math.pi))
            assert any(part.overlaps(arb(turn)) for part in parts)
        reaches = abs(abs(middle - 2 * math.pi * round(middle / (2 * math.pi))) - math.pi) < half
        assert len(parts) == (2 if reaches else 1)


def corners(n):
    return product((-0.999, 0.999), repeat=n)


def planar(values, slopes):
    """A chord angle linear in both ends, with a value and slopes of its own for each pair of ends."""

    def angle(here, there):
        keys = min(values, key=lambda pair: abs(float(here.mid()) - pair[0]) + abs(float(there.mid()) - pair[1]))
        by_here, by_there = slopes[keys]
        return [
            values[keys] + by_here * (here - keys[0]) + by_there * (there - keys[1]), arb(by_here), arb(by_there)
        ]  # fmt: skip

    return angle


def test_a_triangle_at_a_corner_of_a_box_is_in_it(monkeypatch):
    """Its angles obey all rules there and are linear beside it, so that the bounds of the mean value just hold."""
    monkeypatch.setattr(newton, "krawczyk", lambda *_: Enclosure(Status.UNKNOWN, []))
    chance, contraction, half = np.random.default_rng(3), 0.4, 2.0**-9
    total = math.pi * contraction / (1 + contraction)
    for signs in corners(3):
        box = tuple((round(x * 64) / 64, half) for x in (chance.uniform(-1, 1), 2.4, 2.1))
        held = [m + s * half for (m, _), s in zip(box, signs, strict=True)]
        at, phi = list(accumulate(held)), [0.2 * total, 0.3 * total, 0.5 * total]
        rules = ((i, (i + step) % 3) for step in (1, -1) for i in range(3))
        rules = list(rules)
        sizes = [*phi, *(-p / contraction for p in phi)]
        values = {(at[i], at[j]): size for (i, j), size in zip(rules, sizes, strict=True)}
        slopes = {pair: (float(chance.uniform(-1, 1)), float(chance.uniform(-1, 1))) for pair in values}
        angle = planar(values, slopes)
        with working(64):
            largest, ratio = arb(total) * (1 + 2.0**-30), arb(contraction)
            sides = [lambda *z, n=n: [x for i, j in rules for x in angle(z[i], z[j])[:n]] for n in (1, 3)]  # noqa: B023
            assert not triangles._impossible(*sides, largest, ratio, 0.5, box)
            cover = Cover(
                Problem(egg(3).at(alpha=ALPHA), (0,) * 3, lam=ratio),
                angle,
                reflection(PAPERS_LAW, ratio, egg(3)),
                0.5,
                [],
            )
            exact, wide = accumulate(arb(m) for m, _ in box), accumulate(arb(m, r) for m, r in box)
            assert not cover._impossible(box, list(exact), list(wide))


@pytest.mark.parametrize(
    ("far", "k", "slope", "settled"),
    [
        (0, (0, 0), 0, False), (1, (0, 0), 0, True), (-1, (1, 0), 0, True), (-1, (-1, 0), 0, True),
        (-1, (0, 1), -1, True), (-1, (0, 1), 1, False), (0, (1, 1), (0, 1), False), (0, (-1, 1), (0, 1), False),
        ((1, 1), (0, 1), (-1, 1), False), ("nan", "nan", "nan", False),
    ],
)  # fmt: skip
def test_a_box_holds_one_critical_point_at_most_where_a_bound_is_off_0_and_not_at_it(
    monkeypatch, far, k, slope, settled
):
    """`(1, 1)` is the ball from 0 to 2."""
    balls = [arb(*x) if isinstance(x, tuple) else arb(x) for x in (far, k, slope)]
    monkeypatch.setattr(exponent, "load", lambda *_: lambda c, shape: balls)

    assert exponent.one_zero(budget=40).proved is (True if settled else None)


def test_every_shape_up_to_a_tenth_and_every_cosine_is_asked_for_its_critical_points(monkeypatch):
    asked = []

    def at(c, shape):
        small = bool(c.rad() < 0.2) and bool(shape.rad() < 0.01)
        asked.extend([(c, shape)] * small)
        return arb(0), arb(int(small)), arb(0)

    monkeypatch.setattr(exponent, "load", lambda *_: at)
    assert exponent.one_zero(budget=2000).proved is True
    for c, shape in product(np.linspace(-1, 1, 41), np.linspace(0, 0.1, 41)):
        assert any(one.overlaps(arb(c)) and other.overlaps(arb(shape)) for one, other in asked)


@pytest.mark.parametrize("sign", [1, -1])
def test_what_rounding_and_displaced_points_do_is_in_the_defect_of_an_inverse(sign):
    """Launching points are off by one grain at most, which moves twice as much mass in each of a column's entries."""
    cells = 64
    found, matrix = inverted(cells, sign=sign), ulam(cells, sign)
    identity = np.eye(cells)
    inverse = np.linalg.inv(identity - matrix.toarray() + (1 / cells if sign == 1 else 0))
    size = (spread if sign == 1 else largest)(inverse)
    own = inverted(cells, inverse, sign)

    assert own.defect > 2 * 1.5 * cells / GRAIN * size * 0.99
    assert own.defect > (spread if sign == 1 else largest)(identity - inverse @ (identity - matrix.toarray()))
    assert own.bound >= size / (1 - own.defect)
    assert found.bound == pytest.approx(own.bound, rel=1e-3)


def test_jets_multiply_and_divide_as_polynomials_do():
    for order in range(1, 6):
        chance = np.random.default_rng(order)
        one, other = ([int(x) for x in chance.integers(-9, 9, order)] for _ in range(2))
        made = np.convolve(one, other)[:order]

        assert (Jet(*one) * Jet(*other)).c == tuple(made)
        assert (Jet(*one) - Jet(*other)).c == tuple(np.subtract(one, other))
        assert (3 - Jet(*one)).c == (3 - one[0], *(-x for x in one[1:]))
        assert (Jet(*one) - 3).c == (one[0] - 3, *one[1:])
        divisor = Jet(*map(Fraction, [2, *other[1:]]))
        assert (Jet(*map(Fraction, one)) / divisor * divisor).c == tuple(one)
        assert (3 / divisor * divisor).c == (3, *[0] * (order - 1))


def test_the_bounds_of_an_expansion_hold_where_the_last_coefficient_is_at_either_end():
    """`c0 + c1*t + r*t**2` with `r` in `[1, 3]`, on `[-1, 1/2]`: the integral and the bounds by hand."""
    made = Expansion(arb(-1), arb("0.5"), (arb(2), arb(4), arb(2, 1)))
    for r in (1, 2, 3):
        for t in (-1, -0.5, 0, 0.5):
            assert made.size() >= abs(2 + 4 * t + r * t * t)
            assert made.slope() >= abs(4 + 2 * r * t)
        assert made.integral().overlaps(arb(2 * 1.5 + 4 * (0.125 - 0.5) + r * (0.125 + 1) / 3))
    assert made.size() < 9.001
    assert made.slope() < 10.001


def test_an_exponent_of_a_density_without_mass_is_not_certified(monkeypatch):
    from verification.proofs.slap_map.candidate import Residual
    from verification.proofs.slap_map.transfer import Inverted, Variation

    judge = SimpleNamespace(residual=lambda: Residual(arb(0), arb(0)), mean=lambda: arb(0))
    monkeypatch.setattr(exponent, "Judge", lambda *_: judge)
    for mass in (arb(0), arb(1, 1)):
        near = SimpleNamespace(grounded=lambda mass=mass: SimpleNamespace(integral=lambda: mass))
        found = exponent.judged(near, 4, Inverted(1000, 9.0, 0.0, 1), Variation(arb("0.75"), arb(2), True))
        assert found.checks["mass"] is None
        assert not found.certified


STARTS = [(0.3, 0.2), (-1.1, -0.7), (2.0, 0.9)]


@pytest.mark.parametrize("name", ["circle", "ellipse", "cardioid", "cuspless", "egg"])
def test_a_bounce_in_balls_holds_that_of_mpmath_and_is_as_narrow_as_its_start(name):
    """Landing, exit angle, point and incidence angle, of a start that is exact and of a ball around it."""
    map = PinballMap(name, lam="2/5", **{"ellipse": {"a": "3/2"}, "egg": {"alpha": "0.08"}}.get(name, {}))
    enclosed = EnclosedMap(map, Rational(2, 5), bits=100)
    for theta, phi in STARTS:
        mp = enclosed.exact
        exact = mp.bounce(mp.start(mp.middle(arb(theta)), mp.middle(arb(phi))))
        for size in (0.0, 1e-12):
            found = enclosed.bounce(enclosed.start(arb(theta, size), arb(phi, size)))
            assert found.component == exact.component
            for value, truth in zip(
                (found.theta, found.phi, found.x, found.y, found.eta),
                (exact.theta, exact.phi, exact.x, exact.y, exact.eta),
                strict=True,
            ):
                assert abs(value - arb(str(truth))).lower() < 1e-24
                assert value.rad() < 1e-22 + 1e3 * size
            assert found.theta.rad() >= 0.1 * size


def test_balls_that_touch_leave_nothing_between_them():
    for low, high in ((0.1, 0.3), (-2.0, 5.0)):
        whole = between(low, high)
        parts = halves(whole)
        assert parts[0].overlaps(parts[1])
        for x in np.linspace(low, high, 41):
            assert whole.contains(arb(x))
            assert any(part.contains(arb(x)) for part in parts)
        assert all(part.rad() < 0.51 * whole.rad() for part in parts)
