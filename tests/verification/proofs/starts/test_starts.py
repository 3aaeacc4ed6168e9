"""Shares of starts: the core of an attracting cycle, strips that converge to it, and refused statements."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from sympy import Rational, S

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from symbolic import Scene
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.core import AbsorbingTube, attracts
from verification.proofs.starts.mean import CORE, HIGH, LOW, average, diameter, stable
from verification.proofs.starts.strips import Strips, bounded, enter_tube, remainder, strips

SHORT = replace(CORE, entry_tubes=((0.36, 0.03),))


@pytest.fixture(scope="module")
def map() -> PinballImages:
    """The cuspless table at a contraction next to `lambda*`."""
    return PinballImages(Scene("cuspless", lam="0.0713"), (LOW, HIGH))


@pytest.mark.parametrize(
    ("core", "item"),
    [
        (replace(SHORT, cubic=0.2), "orbits come to the middle"),  # no curve along which orbits approach
        (replace(SHORT, outer=0.4335), "orbits come to the middle"),  # beyond the join
        (replace(SHORT, inner=0.3), "they converge there"),  # its entries, as the kernels find them, grow by 1.03
        (replace(SHORT, cells=20), "orbits come to the middle"),
        (replace(SHORT, entry_tubes=((0.41, 0.05),)), "gates lead in"),
    ],
)
def test_a_core_that_is_none_is_refused(map: PinballImages, core: AbsorbingTube, item: str) -> None:
    """Each step of the proof fails alone."""
    assert all(attracts(map, SHORT).values())
    assert not attracts(map, core)[item]


@pytest.mark.parametrize("wrong", [{"cells": 0}, {"inner": -0.05}, {"width": 0.0}, {"entry_tubes": ((0.4, -0.003),)}])
def test_a_core_without_a_cell_or_a_size_is_none(wrong) -> None:
    """With no cell every statement is vacuous: the whole set up to the joins would be proved to converge."""
    with pytest.raises(ValueError, match="at least one cell, and bounds above 0"):
        replace(CORE, outer=0.86, **wrong)


def test_a_repelling_cycle_has_no_core() -> None:
    """Beyond lambda_c = 0.0934 the orbit of period 2 attracts no other."""
    assert not any(attracts(PinballImages(Scene("cuspless", lam="1/10")), SHORT).values())


def test_half_of_a_core_is_no_proof_under_an_uneven_law() -> None:
    """Under this law orbits with `theta >= 0` converge, and some from the other half leave the core."""
    law = "-lam*eta + eta**2/300"
    bent = PinballImages(Scene("cuspless", lam=str(float(HIGH)), law=law), (LOW, HIGH))
    core = replace(CORE, entry_tubes=())
    theta = -np.linspace(0.001, 0.4099, 400)
    start = theta, (core.slope + core.cubic * theta**2) * theta - 0.99 * core.width, 2, np.full(theta.size, core.chart)
    orbit = bent.map.orbit(*start, fields=("theta", "phi"))
    theta, phi = orbit["theta"][-1], orbit["phi"][-1]
    assert np.any(np.abs(phi - (core.slope + core.cubic * theta**2) * theta) > core.width)
    assert not any(attracts(bent, core).values())
    with pytest.raises(ValueError, match="under -lam"):
        strips(bent, (64, 12), 12)


def test_the_kernel_takes_a_core_and_its_gates_in(map: PinballImages) -> None:
    """Random points with `theta` of both signs are in the core after two bounces."""
    rng = np.random.default_rng(8)
    for lam in (LOW, HIGH):
        pinball = PinballMap("cuspless", lam=str(float(lam)))
        for outer, width in (CORE.bounds, *CORE.entry_tubes):
            theta = outer * (2 * rng.random(4000) - 1)
            phi = (CORE.slope + CORE.cubic * theta**2) * theta + width * (2 * rng.random(4000) - 1)
            theta, phi = (x[np.abs(phi) < map.top] for x in (theta, phi))
            for sign in (1, -1):
                step = pinball.step(sign * theta, sign * phi, CORE.chart)
                step = pinball.step(step.theta, step.phi, step.component)
                aside = np.abs(step.phi - (CORE.slope + CORE.cubic * step.theta**2) * step.theta)
                assert np.all(step.component == CORE.chart)
                assert np.all((np.abs(step.theta) <= CORE.outer) & (aside <= CORE.width))


def thin(chart: int, theta: np.ndarray, eta: np.ndarray, wide: float, tall: float) -> Strips:
    """Strips about points, of half width `wide` and half height `tall`."""
    flat = np.zeros(theta.size)
    return Strips(np.full(theta.size, chart), theta - wide, theta + wide, flat, flat, eta, flat + tall)


def test_settled_strips_end_on_period_2(map: PinballImages) -> None:
    """Random starts at both ends of the range; strips near a chaotic start are as thin as rounding allows."""
    for lam in (LOW, HIGH):
        pinball = PinballMap("cuspless", lam=str(float(lam)))
        start = interior_starts(pinball, 4000, 5)
        theta, eta = start.theta, start.phi
        nu = pinball.exponents(theta, -float(lam) * eta, 400, 3000, start.component).nu_plus
        for wide in (1e-3, 1e-9):
            for chart in (0, 1):
                on = (start.component == chart) & (np.abs(theta) < map.charts[chart].x[1] - 2 * wide)
                done, _ = enter_tube(map, CORE, thin(chart, theta[on], eta[on], wide, wide))
                assert np.all(nu[on][done] < 0)
                assert np.mean(done) > 0.5
    assert np.sum(nu > 0.1) > 0  # at 0.0713, of 4000 starts
    beyond, _ = enter_tube(map, CORE, thin(0, np.zeros(3), np.array([2.0, 5.0, 20.0]), 1e-3, 1e-3))
    assert not np.any(beyond)  # no incidence is above a quarter turn


def test_every_start_is_in_a_strip(map: PinballImages) -> None:
    """Strips of all `theta` and `0 <= eta <= pi/2`, also after cuts; the sum of their measures is just above `L`."""
    made, rng = strips(map, (96, 16), 24), np.random.default_rng(6)
    middle, which = np.unique(made.middle, return_index=True)
    half = made.half[which]
    assert np.all((middle + half)[:-1] >= (middle - half)[1:])  # rows overlap by more than a rounding
    assert middle[0] - half[0] <= 0
    assert middle[-1] + half[-1] >= np.pi / 2
    perimeter = 9 * 3**0.5 / 2
    for across in (False, True, False):
        assert perimeter < np.sum(made.measures(map)) < 1.25 * perimeter
        for chart, ends in enumerate(map.charts):
            theta, eta = ends.x[0] + (ends.x[1] - ends.x[0]) * rng.random(300), np.pi / 2 * rng.random(300)
            u = eta[:, None] - made.middle
            held = (made.chart == chart) & (np.abs(u) <= made.half)
            held &= made.left + made.left_lean * u <= theta[:, None]
            held &= theta[:, None] <= made.right + made.right_lean * u
            assert np.all(held.any(axis=1))
        made = made.cut(np.full(made.left.size, across))


@pytest.mark.parametrize(("columns", "rows"), [((96,), 24), ((96, 0), 24), ((96, 16), 0)])
def test_strips_that_leave_out_a_component_or_all_angles_are_refused(map: PinballImages, columns, rows) -> None:
    with pytest.raises(ValueError, match="for each component"):
        strips(map, columns, rows)


def test_a_strip_is_in_its_parallelogram(map: PinballImages) -> None:
    """Random points of leaning strips, with `phi = -lam*eta`: their distance from the sides is within the rest."""
    rng, count = np.random.default_rng(9), 200
    left, middle = rng.uniform(-1, 1, count), rng.uniform(0, 1.5, count)
    right, half = left + rng.uniform(0.01, 0.1, count), rng.uniform(0.005, 0.05, count)
    leans = rng.uniform(-0.3, 0.3, (2, count))
    sets = Strips(np.zeros(count, dtype=np.int64), left, right, *leans, middle, half).started(map)
    (wide, along), (none, down) = sets.sides
    assert np.all(none == 0)
    for lam in (float(LOW), float(HIGH)):
        for _ in range(20):
            u, share = half * rng.choice([-1, 1, rng.uniform(-1, 1)], count), rng.choice([0, 1, rng.random()], count)
            first, last = left + leans[0] * u, right + leans[1] * u
            off = np.array([first + share * (last - first), -lam * (middle + u)]) - sets.middle
            v = u / half
            assert np.all(np.abs(off[1] - v * down) <= sets.rest[1] + 1e-13)
            over = np.abs(off[0] - v * along) - np.abs(wide)
            assert np.all(over <= sets.rest[0] + 1e-13)
    assert np.all(sets.rest[0] < np.abs(leans[1] - leans[0]) / 2 * half * 1.001 + 1e-13)
    assert np.all(np.abs(wide) < (right - left) / 2 * 1.001)
    assert np.all(np.abs(down) < 0.0714 * half)


def test_lines_that_cross_have_no_measure(map: PinballImages) -> None:
    """The area between crossing lines would be counted with a sign."""
    one = np.ones(1)
    crossing = Strips(np.zeros(1, dtype=np.int64), 0 * one, 0.01 * one, one, -one, 0.5 * one, 0.1 * one)
    assert crossing.measures(map)[0] == np.inf


def test_no_orbit_grows_faster_than_the_largest_norm(map: PinballImages) -> None:
    """The kernels find a norm of exp(2*0.514) over two bounces; the bound 0.5 is refused, and 0.54 proved."""
    assert bounded(map, 0.54, 2, 0.05)
    assert not bounded(map, 0.5, 2, 0.05, 4)


def test_what_is_left_is_counted_whole(map: PinballImages) -> None:
    """Without a round everything is left, and each round leaves less."""
    first = strips(map, (64, 12), 12)
    whole = 2 * np.sum(first.measures(map))
    left = remainder(map, SHORT, first, 0.0, rounds=2)
    assert 0.3 * whole < left.measure < 0.9 * whole
    assert remainder(map, replace(SHORT, outer=1e-9, entry_tubes=()), first, 0.0, rounds=1).measure >= whole


def test_jury() -> None:
    """For multipliers -0.92 and 0 the bound 0.928 holds; for real or complex ones of modulus 0.93 it does not."""
    assert stable(Rational(-92, 100), S.Zero, LOW, HIGH)
    assert not stable(Rational(-93, 100), S.Zero, LOW, HIGH)
    assert not stable(S.Zero, Rational(93, 100) ** 2, LOW, HIGH)


def test_the_diameter_is_that_of_the_cardioid(map: PinballImages) -> None:
    """The largest distance in the cardioid, `3*sqrt(3)/2`, is between two points that the cut keeps."""
    assert 0 < diameter(map) - 1.5 * 3**0.5 < 0.01


@pytest.mark.slow
def test_the_average_is_negative_where_the_attractor_is_born() -> None:
    """Proved next to lambda*, above sampled values; at 0.09, where most starts are chaotic, no bound is proved."""
    found = average()
    assert all(found.checks.values())
    assert found.mean < 0 < found.share < 0.07
    start = interior_starts(PinballMap("cuspless", lam="0.0713"), 500, 7)
    sampled = PinballMap("cuspless", lam="0.0713").exponents(start.theta, start.phi, 300, 2000, start.component)
    assert np.mean(sampled.nu_plus) < found.mean
    assert not all(attracts(PinballImages(Scene("cuspless", lam=str(Fraction(9, 100)))), CORE).values())
