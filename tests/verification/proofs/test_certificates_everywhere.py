"""Cycles for every contraction of an interval: the paper's attracting and unstable ones."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st
from sympy import Rational

from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables import cuspless, egg, ellipse, sinai
from symbolic.tables.law import Law
from symbolic.tables.table import lam as contraction
from verification.arithmetic.balls import real_ball, working
from verification.cycles.cascade import attractor, cycle_at, doubled
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.cycles.search import Catalogue
from verification.maps import first_hit
from verification.named.locate import certify
from verification.proofs.corner import return_map
from verification.proofs.periodic import bifurcation, interval_newton, triangles
from verification.proofs.periodic.bifurcation import Stability, over_interval, stability
from verification.proofs.periodic.interval_newton import Cover, Status, krawczyk, no_others, steepest

EGG = egg(3).at(alpha=Rational(2, 25))
FLAT = [math.pi / 3, math.pi, 5 * math.pi / 3]
FLAT_TERMS = SimpleNamespace(terms=SimpleNamespace(rows=None))
VERTEX = [0.0, 2 * math.pi / 3, 4 * math.pi / 3]


@pytest.mark.parametrize(("start", "wanted"), [(FLAT, Stability.ATTRACTING), (VERTEX, Stability.SADDLE)])
def test_the_two_triangles_exist_from_the_elastic_end_to_the_fold(start, wanted):
    assert over_interval(EGG, (0, 0, 0), start, (0.999, 0.379), wanted).proved


def test_the_triangles_meet_at_the_fold():
    lam, third = Rational(3781213, 10**7), 2 * math.pi / 3
    starts = ([x + k * third for k in range(3)] for x in (1.54, 1.55))
    near = [floats(Problem(EGG, (0, 0, 0), lam=lam), start) for start in starts]
    gaps = [abs(a - b) for a, b in zip(*near, strict=True)]

    assert 0 < max(gaps) < 2e-3  # like the root of lam - lambda_c = 5e-8


def test_an_attracting_cycle_of_period_4_exists_for_every_small_contraction():
    start = attractor(EGG, 0.2, (0.05, 3.1))

    assert over_interval(EGG, (0,) * 4, start, (0.2, 0.0), Stability.ATTRACTING).proved
    assert over_interval(EGG, (0,) * 4, start, (0.2, 0.28), Stability.ATTRACTING).proved


def test_the_unstable_cycle_born_at_lambda_c_lives_down_to_the_corners():
    flip = Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam")
    start, lam = doubled(flip, floats(flip, [0.0, 0.0, 0.0934]), 0.002)

    assert lam < 0.0934  # subcritical: on the side where the period-2 orbit is stable
    assert over_interval(cuspless, (1, 0, 1, 0), start, (lam, 0.0933), Stability.SADDLE).proved
    assert over_interval(cuspless, (1, 0, 1, 0), start, (lam, 0.07122), Stability.SADDLE).proved


def test_its_partner_on_the_arc_is_a_saddle_from_the_corners_on():
    corner = [2.0943943, 0.2545256, -2.0943943, -0.2545256]  # lam = 0.07122, from `border.saddles`
    problem = Problem(cuspless, (0,) * 4, lam=Rational(7122, 10**5))
    start = floats(problem, corner)

    assert over_interval(cuspless, (0,) * 4, start, (0.07122, 0.1), Stability.SADDLE).proved


def test_what_is_not_so_is_not_proved():
    start = attractor(EGG, 0.36, (0.05, 3.1))
    found = over_interval(EGG, (0,) * 4, start, (0.36, 0.38), Stability.ATTRACTING, budget=300)

    assert not found.proved
    assert 0.371 < found.reached < 0.3712356  # lambda_3


@given(st.floats(-3, 3), st.floats(0, 1.5))
def test_stability_agrees_with_the_multipliers(trace, determinant):
    with working(64):
        found = stability(arb(trace), arb(determinant))
    root = complex(trace * trace - 4 * determinant) ** 0.5
    sizes = sorted(abs((trace + s * root) / 2) for s in (1, -1))
    if found is Stability.ATTRACTING:
        assert sizes[1] < 1 + 1e-7
    if found is Stability.SADDLE:
        assert sizes[0] < 1 + 1e-7
        assert sizes[1] > 1 - 1e-7


def test_krawczyk_has_three_answers_too():
    problem = Problem(EGG, (0, 0), lam=Rational(1, 2))
    answers = [
        krawczyk(problem, [arb(0), arb(x)], [r, r], 80).status for x, r in ((3.1415, 0.001), (3.1, 0.001), (3.1, 3))
    ]

    assert answers == [Status.UNIQUE, Status.EMPTY, Status.UNKNOWN]


def test_at_039_the_attractor_has_period_16_and_not_8_as_the_papers_figure_says():
    sixteen = attractor(EGG, 0.39, (0.05, 3.1))
    eight = attractor(EGG, 0.38, (0.05, 3.1))
    for lam in (0.382, 0.384, 0.386, 0.388, 0.389, 0.39):
        eight = cycle_at(EGG, eight, lam)

    assert len(sixteen) == 16
    assert over_interval(EGG, (0,) * 16, sixteen, (0.39, 0.39001), Stability.ATTRACTING).proved
    assert over_interval(EGG, (0,) * 8, eight, (0.39, 0.39001), Stability.SADDLE).proved


class Asked:
    """Boxes that a proof was asked about; those are settled that are small, and smaller about one place."""

    def __init__(self, size, *fine):
        self.size, self.fine, self.boxes = size, fine, []

    def settles(self, *box):
        near = all(abs(m - x) <= r for (m, r), x in zip(box, self.fine, strict=False))
        good = max(r for _, r in box) <= self.size / (8 if near and self.fine else 1)
        self.boxes += [box] if good else []
        return good

    def covers(self, *ranges, points=400):
        random = np.random.default_rng(1)
        places = random.uniform([low for low, _ in ranges], [high for _, high in ranges], (points, len(ranges)))
        ends = np.array(np.meshgrid(*ranges)).reshape(len(ranges), -1).T
        held = np.array(self.boxes)
        return all(np.any(np.all(np.abs(held[:, :, 0] - x) <= held[:, :, 1] + 1e-12, axis=1)) for x in (*places, *ends))


def of(ball):
    return float(ball.mid()), float(ball.rad())


def test_the_angles_and_contractions_asked_about_the_fourth_collision_are_all_of_them(monkeypatch):
    for low, high, angle in ((0.0, 0.3, 0.5), (0.1, 0.6, 0.05), (0.2, 0.2, 0.4)):
        asked = Asked(0.05, 0.2, 0.25)
        monkeypatch.setattr(
            return_map, "_lands_inside", lambda phi, lam, _, asked=asked: asked.settles(of(phi), of(lam))
        )
        shares = []
        found = return_map.fourth_on_wall(angle, low, high, tick=shares.append)

        assert found.on_wall is True
        assert asked.covers((-angle, angle), (low, high))
        assert sum(shares) == pytest.approx(1 if high > low else 0)


def test_the_triangles_asked_are_all_that_a_box_holds():
    start = ((1.0, 1.0), (2.0, 0.75), (3.0, 0.5))
    asked = Asked(0.25, 0.3, 1.6, 3.1)
    found = triangles._subdivided(lambda box: asked.settles(*box), start, 10**5, lambda share: None)

    assert found.excluded is True
    assert asked.covers(*((m - r, m + r) for m, r in start))
    assert found.share == pytest.approx(1)
    assert 0.01 < found.smallest < 0.25


def test_the_tilts_asked_along_the_branch_of_triangles_are_all_of_them(monkeypatch):
    asked = Asked(0.1, 0.77)
    made = [lambda at: (arb(1 if asked.settles(of(at)) else -1),), lambda: (arb(1),)]
    monkeypatch.setattr(triangles, "load", lambda *_: made.pop(0))

    assert triangles.flips_nowhere(Rational(2, 25)) is True
    assert asked.covers((0.0, 1.0))


def test_the_places_where_a_curve_is_asked_to_bend_inwards_are_all_of_them(monkeypatch):
    asked = Asked(0.2, 1.0)
    monkeypatch.setattr(first_hit, "_exactly_nonnegative", lambda *_: False)
    monkeypatch.setattr(
        first_hit,
        "load",
        lambda made, words, load=first_hit.load: (
            load(made, words) if made.results != ("bend",) else lambda at: (arb(1 if asked.settles(of(at)) else -1),)
        ),
    )
    monkeypatch.setattr(first_hit, "turning", lambda component: Rational(2) + component.point[0])

    assert first_hit._bends_inwards(EGG, 0, ())
    assert asked.covers((-math.pi, math.pi))


def test_the_pieces_asked_along_a_chord_are_all_of_every_component(monkeypatch):
    table = sinai()
    asked = [Asked(0.4, 0.3) for _ in range(5)]
    boundary = first_hit._boundary(table, ())
    places = list(boundary.places)
    monkeypatch.setattr(first_hit, "_passes", lambda place, piece, *_: asked[places.index(place)].settles(of(piece)))
    with working(96):
        assert first_hit.free(boundary, (3, arb("0.5")), (4, arb.pi()))
        ends = [tuple(float(end) for end in pair) for pair in boundary.ends]
    for each, pair in zip(asked, ends, strict=True):
        assert each.covers(pair)


@pytest.mark.parametrize("n", [2, 3])
def test_the_chains_asked_are_all_that_a_period_may_have(monkeypatch, n):
    """From the least to the largest gap, up to a half turn of the ellipse, for every number of turns."""
    asked = {turns: Asked(0.5, 1.0, 2.0) for turns in range(1, n)}
    monkeypatch.setattr(Cover, "settled", lambda self, box, turns: asked[turns].settles(*box))
    found = no_others(Catalogue(ellipse.at(a="3/2"), 0.5), Rational(1, 2), n)
    gap = interval_newton.start(2, n, 0.0)[1]

    assert found.complete is True
    for each in asked.values():
        assert each.covers((-math.pi / 2, math.pi / 2), *[(1.0, 2 * math.pi - 1.0)] * (n - 1))
    assert gap[0] + gap[1] >= 2 * math.pi
    assert gap[0] - gap[1] <= 0


@pytest.mark.parametrize("law", [Law("-lam*eta"), Law("-lam*eta + cos(theta)/20")], ids=str)
def test_the_exit_angles_asked_for_their_largest_are_those_at_every_incidence_and_place(law):
    asked = []

    def reflected(eta, theta):
        asked.append((of(eta), of(theta)))
        return [(abs(eta) + (theta.cos() if law.placed else 0), arb(1), arb(0))]

    bound = steepest(law, reflected)
    held = np.array(asked)
    places = np.linspace(-math.pi, math.pi, 130) if law.placed else [0.0]
    for eta in np.linspace(-math.pi / 2, math.pi / 2, 40):
        near = held[np.abs(held[:, 0, 0] - eta) <= held[:, 0, 1] + 1e-12]
        for theta in places:
            turned = np.remainder(near[:, 1, 0] - theta + math.pi, 2 * math.pi) - math.pi
            assert np.any(np.abs(turned) <= near[:, 1, 1] + 1e-12)
    largest = math.pi / 2 + (1 if law.placed else 0)
    assert largest <= bound < largest + 0.02


def test_the_largest_tilt_is_an_arc_cosine():
    for x in (Rational(0), Rational(2, 25), Rational(1, 2), Rational(-9, 10)):
        assert float(triangles.acos_of(x)) == pytest.approx(math.acos(x))


@pytest.mark.parametrize("ends", [(0.25, 0.75), (0.75, 0.25)])
def test_the_contractions_that_are_asked_cover_the_stretch_between_the_ends(monkeypatch, ends):
    """Whatever the lengths of the steps are: some are refused until they are short."""
    asked = []

    def short(table, components, theta, middle, half, radii):
        asked.extend([(middle, half)] * (half < 0.011))
        return Stability.ATTRACTING if half < 0.011 else Stability.UNKNOWN

    monkeypatch.setattr(bifurcation, "floats", lambda problem, start: [float(problem.lam)] * 2)
    monkeypatch.setattr(bifurcation, "_proved", short)
    found = over_interval(egg(3).at(alpha=Rational(2, 25)), (0, 0), [0.0, 3.0], ends, Stability.ATTRACTING)

    assert found.proved
    for lam in np.linspace(0.25, 0.75, 401):
        assert any(abs(lam - middle) <= half + 1e-12 for middle, half in asked)
    assert all(middle - half >= 0.25 - 1e-12 and middle + half <= 0.75 + 1e-12 for middle, half in asked)


def test_a_doubling_is_supercritical_by_the_sign_that_its_certificate_has():
    """At one contraction, by the formula for all of them; with the bend turned round it is not."""
    for K, lam in ((3, "1/2"), (3, "1/5"), (5, "1/2")):
        with working(bifurcation.BITS):
            exact = real_ball(alpha_tilde(K).subs(contraction, Rational(lam)))
        near = [0.0, math.pi, float(exact)]
        proof = certify(Problem(egg(K), (0, 0), BifurcationKind.FLIP, "alpha", Rational(lam)), near, 15)
        assert bifurcation._supercritical(K, real_ball(Rational(lam)), exact) is proof.supercritical


@pytest.mark.parametrize("wrong", ["wide", "thin", "convex", "inside", "minimal", "slopes", ""])
def test_a_cycle_over_an_interval_is_proved_by_all_of_its_steps(monkeypatch, wrong):
    """Existence over the ball and at its middle, a convex table, bounces on their parts, the period, the slopes."""

    def exists(problem, centre, radii, bits):
        kind = "thin" if problem.lam.is_exact() else "wide"
        return interval_newton.Enclosure(Status.UNKNOWN if wrong == kind else Status.UNIQUE, centre)

    steps = {"convex": lambda *_: wrong != "convex" or None, "inside": lambda *_: wrong != "inside" or None}
    steps |= {"minimal": lambda *_: wrong != "minimal" or None, "krawczyk": exists, "Linearised": lambda *_: FLAT_TERMS}
    steps |= {"_slopes": lambda *_: None if wrong == "slopes" else (arb(0), arb(0))}
    steps |= {"trace_and_determinant": lambda rows: (arb(0), arb(0))}
    for name, step in steps.items():
        monkeypatch.setattr(bifurcation, name, step)
    found = bifurcation._proved(EGG, (0, 0), [0.0, 3.0], 0.5, 0.125, [0.1, 0.1])

    assert found is (Stability.UNKNOWN if wrong else Stability.ATTRACTING)
