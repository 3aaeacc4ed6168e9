"""What a proof is given holds what it is said to be about: no end, no place and no value is left out."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from symbolic.tables import circle, egg
from symbolic.tables.law import PAPERS_LAW
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.arithmetic.balls import exact_balls, working
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.proofs.global_dynamics.flights import Slopes, matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.periodic import bifurcation, returning, triangles
from verification.proofs.periodic.interval_newton import Cover, Enclosure, Status, stays_below


@pytest.mark.parametrize("half", [2.0**-10, 1 / 300, 2.0**-20])
def test_a_step_along_a_parameter_is_proved_up_to_its_ends_and_a_little_beyond(monkeypatch, half):
    """Steps end at rounded numbers: two that only touched would leave a gap of a rounding between them."""
    given, table = [], egg(3).at(alpha=Fraction(2, 25))

    def problem(*parts, lam):
        given.append(lam)
        return Problem(*parts, lam=lam)

    monkeypatch.setattr(bifurcation, "Problem", problem)
    bifurcation._proved(table, (0, 0, 0), [1.05, 3.14, 5.24], 0.97, half, [1e-3] * 3)
    wide, thin = given

    assert wide.contains_interior(arb(0.97) - arb(half))
    assert wide.contains_interior(arb(0.97) + arb(half))
    assert thin == arb(0.97)


def test_the_papers_law_contracts_by_lam_wherever_a_particle_lands():
    """`phi = -lam*eta`: minus its slope in `eta` is `lam`, and in the place it has none."""
    map = PinballImages(Scene("egg", alpha="0.08", lam="1/2"))
    eta, theta = (BallArray(np.array(middle), np.array(radius)) for middle, radius in (([0.3], [0.1]), ([2.0], [0.5])))
    slope, drift = map.slopes(eta, theta)

    assert (float(slope.m), float(drift.m), float(np.max(drift.r))) == (0.5, 0.0, 0.0)


@pytest.mark.parametrize(("lam", "answer"), [("0", True), ("1/2", True), ("99/100", True), ("1", False)])
def test_exit_angles_stay_below_a_right_angle_exactly_where_the_law_contracts(lam, answer):
    assert stays_below(PAPERS_LAW, lam, circle) is answer


def test_boxes_whose_gaps_no_cycle_has_are_settled_without_another_look():
    """A last gap below the least, one that is longer than the first, and what may be a cycle."""

    def unasked(*_):
        raise AssertionError

    cover = Cover(Problem(circle, (0, 0, 0), lam=arb(1) / 2), unasked, unasked, 0.5, [])
    turn = 2 * float(arb.pi())

    assert cover.settled([(0.0, 1.0), (turn / 2, 0.01), (turn / 2 - 0.3, 0.01)], 1)  # 0.3 is left
    assert cover.settled([(0.0, 1.0), (1.0, 0.01), (2.0, 0.01)], 1)  # both others are longer
    with pytest.raises(AssertionError):
        cover.settled([(0.0, 1.0), (turn / 3, 0.25), (turn / 3, 0.25)], 1)


@pytest.mark.parametrize(("last", "answer"), [(2.0, True), (2.0 + 2.0**-51, False)])
def test_a_box_whose_centre_was_rounded_is_no_box_about_a_known_cycle(last, answer):
    """The angles are sums of gaps: 1, 3.25, and 5.25 or a little more, which takes a bit more than a float has."""
    known = [([1.0, 3.25, 5.25], 1.0)]
    cover = Cover(Problem(circle, (0, 0, 0), lam=arb(1) / 2), None, None, 0.5, known)

    assert cover.settled([(1.0, 0.01), (2.25, 0.01), (last, 0.01)], 1) is answer


@pytest.mark.parametrize("wide", range(4))
def test_a_value_is_precise_where_it_is_known_and_not_where_a_bounce_is(monkeypatch, wide):
    """Of the four unknowns the last one is the value; the others may be known less well."""
    problem = Problem(egg(3).at(alpha=Fraction(2, 25)), (0, 0, 0), BifurcationKind.FOLD, "lam")
    centre = exact_balls(refined(problem, [-0.55, 1.54, 3.63, 0.378], 40).z)
    zero = [arb(x, 1e-9 if k == wide else 1e-20) for k, x in enumerate(centre)]
    monkeypatch.setattr(bifurcation, "interval_newton", lambda *_: Enclosure(Status.UNIQUE, zero))
    with working(100):
        checks = bifurcation.proved(bifurcation.Claim(problem, tuple(centre), arb(2) ** -40, 100, 12)).checks
    assert checks["precise"] is (wide != 3)


@pytest.mark.parametrize(("slope", "share", "excluded"), [(0, 0.4, True), (0, 0.3, False), (40, 0.4, False)])
def test_triangles_are_excluded_by_the_sum_of_their_exit_angles_at_the_middle_and_its_slopes(slope, share, excluded):
    """Three equal angles of 0.4 of the largest are too much; where their sum varies by as much they may not be."""
    box = ((0.5, 2.0**-10), (2.25, 2.0**-10), (2.0, 2.0**-10))

    def angles(*theta):
        phi = arb(share) if theta[0].is_exact() else arb(share, 0.15)
        return [phi] * 3 + [-2 * phi] * 3

    def slopes(*theta):
        row = [arb(0), arb(slope), arb(slope)]
        return row * 3 + [arb(0)] * 9

    with working(64):
        assert triangles._impossible(angles, slopes, arb(1), arb(1), 0.25, box) is excluded


def test_a_scalar_product_is_the_sum_of_three_products_and_a_volume_that_of_three_widths():
    numbers = lambda *xs: [arb(x) for x in xs]  # noqa: E731
    assert triangles._dot(numbers(1, 10, 100), numbers(2, 3, 5)) == 532
    assert triangles._by_gaps(numbers(1, 10, 100)) == numbers(111, 110, 100)  # all move with the first, two with a gap
    assert triangles._volume(((9.0, 2.0), (9.0, 3.0), (9.0, 5.0))) == 30
    assert [triangles._slope(numbers(7, 8, 9), *ends) for ends in ((0, 1), (1, 2), (2, 0))] == [
        [8, 9, 0], [0, 8, 9], [9, 0, 8]
    ]  # fmt: skip


def test_a_stretch_is_folded_into_the_sixth_of_the_turn_with_its_ends_and_signs():
    """By the symmetries of the egg: turns by a third, and the reflection, which changes the sign of exit angles."""
    rng = np.random.default_rng(3)
    for end, reach in zip(rng.uniform(-7, 7, 300), rng.choice([0.0, 1e-3, 0.2, 0.5], 300), strict=True):
        found = returning._folded(end, reach)
        for x in end + reach * np.array([-1, 1, *rng.uniform(-1, 1, 5)]):
            rest = np.remainder(x, 2 * np.pi / 3)
            at, sign = (rest, 1) if rest <= np.pi / 3 else (2 * np.pi / 3 - rest, -1)
            near = [(low, high) for low, high, told in found if told == sign]
            assert any(low <= at <= high for low, high in near) or min(at, np.pi / 3 - at) < 1e-12
        for low, high, _ in found:
            assert 0 <= low <= high <= np.pi / 3 + 2e-9
            assert high - low <= 2 * reach + 4e-9


def test_the_largest_gap_of_a_triangle_is_its_first_and_none_is_below_the_least():
    """Whatever its angles are: nothing is asked of boxes in which that is not so."""
    for gaps, asked in (((2.5, 2.0), True), ((2.0, 2.5), False), ((2.0, 1.5), False), ((5.0, 1.2), False)):
        box = ((0.5, 2.0**-20), *((gap, 2.0**-20) for gap in gaps))
        angles = lambda *_: [arb("nan")] * 6  # noqa: E731
        assert triangles._impossible(angles, None, arb(1), arb(1), 0.25, box) is not asked


def test_a_derivative_under_a_law_of_the_place_adds_its_drift_at_the_landing():
    """`d phi1 = drift*d theta1 - law*(bend_there*d theta1 - bend_here*d theta0 + d phi0)`, in numbers."""
    one = lambda x: BallArray(np.array([float(x)]))  # noqa: E731
    by_theta, by_phi, here, there, law, drift = 2, 3, 5, 7, 11, 13
    found = matrix(Slopes(*map(one, (by_theta, by_phi, here, there, law, drift))))
    wanted = [[2, 3], [drift * 2 - law * (there * 2 - here), drift * 3 - law * (there * 3 + 1)]]
    assert [[float(x.m[0]) for x in row] for row in found] == wanted
