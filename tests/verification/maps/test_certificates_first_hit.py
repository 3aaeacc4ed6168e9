"""Chords that meet nothing on their way, in tables that are not convex."""

import math
import random

import numpy as np
import pytest
from flint import arb
from sympy import Rational, cos, sin, sqrt

from symbolic.tables import cardioid, cuspless, egg, polar, sinai
from symbolic.tables.law import Law
from symbolic.tables.table import theta
from verification.arithmetic.balls import exact_balls, working
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.maps import first_hit
from verification.maps.first_hit import convex, first_hits, inside, minimal
from verification.proofs.periodic.bifurcation import Claim, proved

WAISTED = polar(1 + cos(2 * theta) / 2)  # the waist at theta = +-pi/2 has radius 1/2


def bounces(*values: float) -> list[arb]:
    return [arb(x) for x in values]


def test_a_convex_table_agrees_with_its_convexity():
    assert first_hits(egg(3).at(alpha=Rational(2, 25)), (0, 0), bounces(0.1, 3.0)) is True
    assert first_hits(cuspless, (1, 0, 0), bounces(0.1, 0.3, 1.5)) is True


def test_a_chord_through_a_waist_is_free_and_one_around_it_is_not():
    assert first_hits(WAISTED, (0, 0), bounces(0, math.pi)) is True
    assert first_hits(WAISTED, (0, 0), bounces(0.7, math.pi - 0.7)) is None  # it leaves the table in between


def test_a_chord_that_leaves_outwards_is_refused():
    assert first_hits(WAISTED, (0, 0), bounces(math.pi / 2 - 0.2, math.pi / 2 + 0.2)) is None


@pytest.mark.parametrize("lam", [Rational(1, 3), Rational(9, 10)])
def test_the_cardioids_vertical_orbit_is_certified_though_the_table_is_not_convex(lam):
    problem = Problem(cardioid, (0, 0), lam=lam)
    solution = refined(problem, [1.0, -1.0], 20)
    with working(150):
        claim = Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20)

    assert proved(claim).certified


def test_a_bounce_at_the_seam_of_a_round_hole_is_one_like_any_other():
    """Between the left side of Sinai's cell and the disc, whose parameter begins and ends where it is met."""
    table = sinai()
    with working(96):
        seam, other = arb.pi(), -arb.pi()
        side = 3
        middle = arb("0.5")

        for there in (seam, other, seam + arb("0.001")):
            assert inside(table, (side, 4), [middle, there]) is True
        assert first_hits(table, (side, 4), [middle, seam]) is True
        assert first_hits(table, (side, 4), [middle, other]) is True
        assert first_hits(table, (side, 1), [middle, middle]) is None  # the disc is between
        assert minimal(table, (side, 4, side, 4), [middle, seam, middle, other]) is None  # the same point twice


def test_a_curve_of_one_formula_that_dents_where_it_closes_is_not_convex():
    """Both bend inwards everywhere else; at theta = pi the radius is least in the one and largest in the other."""
    assert convex(polar(1 + cos(theta / 2) / 4)) is None
    assert convex(polar(1 - cos(theta / 2) / 4)) is True


def test_what_a_formula_draws_beyond_the_ends_of_its_parameter_is_no_boundary():
    """A chord system has a zero there, on the curve that the formula goes on to draw; a turn less is elsewhere."""
    table = polar(1 + cos(theta / 2) / 4 + sin(theta) / 8)
    problem = Problem(table, (0, 0), lam=Rational(1, 2))
    solution = refined(problem, [4.85837, 8.15732], 20)
    with working(150):
        proof = proved(Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20))

    assert proof.checks["exists"] is True
    assert proof.checks["admissible"] is None
    assert "bounce 0 left" in problem.ring.obstacle(np.array([4.85837, 8.15732]), {"lam": 0.5})


@pytest.mark.parametrize(
    ("law", "admissible"), [("-lam*eta*(1 + cos(theta)/9)", True), ("-lam*eta*(1 + theta/99)", None)]
)
def test_a_law_that_a_whole_turn_changes_is_asked_between_the_ends_alone(law, admissible):
    problem = Problem(egg(3).at(alpha=Rational(2, 25)), (0, 0), lam=Rational(1, 2), law=Law(law))
    solution = refined(problem, [math.pi, 2 * math.pi], 20)
    with working(150):
        proof = proved(Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20))

    assert proof.checks["exists"] is True
    assert proof.checks["admissible"] is admissible


def test_a_law_of_arc_length_on_a_disc_among_sides_is_asked_between_the_ends_alone():
    """A turn less on the disc the same point has another length, and a zero of the chord system is no cycle."""
    problem = Problem(sinai(), (0, 4), lam=Rational(1, 2), law=Law("-lam*eta + sin(s)/9"))
    for start, admissible in (([0.467, 1.669], True), ([0.4745, -4.644], False)):
        solution = refined(problem, start, 20)
        with working(150):
            proof = proved(Claim(problem, tuple(exact_balls(solution.z)), arb("1e-22").mid(), 150, 20))

        assert proof.checks["exists"] is True
        assert proof.checks["admissible"] is admissible


def test_a_piece_that_crosses_a_chord_never_passes_and_a_small_one_beside_it_does():
    """Straight pieces in all directions through points of the chord from (0, 0) to (2, 1), and beside it."""
    chance = random.Random(1)
    p, d = (arb(0), arb(0)), (arb(2), arb(1))
    for _ in range(100):
        share, angle, half = chance.uniform(0.1, 0.9), chance.uniform(-3, 3), 2.0 ** chance.uniform(-20, -1)
        vx, vy = arb(math.cos(angle)), arb(math.sin(angle))
        seen = abs(2 * math.sin(angle) - math.cos(angle)) > 0.1  # else it runs along the chord
        crossing = lambda t, share=share, vx=vx, vy=vy: (2 * share + vx * t, share + vy * t, vx, vy)  # noqa: E731
        beside = lambda t, share=share, vx=vx, vy=vy: (2 * share - 0.2 + vx * t, share + 0.4 + vy * t, vx, vy)  # noqa: E731

        piece = arb(half * chance.uniform(-0.9, 0.9), half)
        assert not first_hit._passes(crossing, piece, [], p, d)
        assert first_hit._passes(beside, piece, [], p, d) or half > 0.1
        assert first_hit._passes(crossing, arb(0, half), [[arb(0, half)]], p, d) or not seen  # next to a bounce


def test_only_a_component_that_ends_where_it_begins_is_closed():
    """The wall of the cuspless table ends above its beginning; the disc of Sinai's cell is a circle."""
    assert first_hit._boundary(cuspless, ()).closed == (False, False)
    assert first_hit._boundary(sinai(), ()).closed == (False, False, False, False, True)


def test_convexity_is_proved_piece_by_piece_where_no_formula_decides_it():
    assert convex(polar(1 + cos(theta) / 3 + sqrt(2) * cos(2 * theta) / 40)) is True
    assert convex(polar(1 + cos(theta) / 3 + sqrt(2) * cos(2 * theta) / 4)) is None
    assert convex(egg(3), (arb("0.099"),)) is True
    assert convex(egg(3), (arb("0.101"),)) is None
    assert convex(sinai()) is None  # the disc bends outwards by a constant
