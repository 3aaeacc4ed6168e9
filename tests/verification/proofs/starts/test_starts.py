"""Shares of starts: the core of an attracting cycle, strips that come to it, and what is refused."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from sympy import Rational, S

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from symbolic import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts import mean
from verification.proofs.starts.core import Core, attracts
from verification.proofs.starts.mean import CORE, HIGH, LOW, average, diameter, stable
from verification.proofs.starts.strips import Left, Strips, bounded, settled, strips, unsettled

SHORT = replace(CORE, gates=((0.36, 0.03),))


@pytest.fixture(scope="module")
def map() -> PinballImages:
    """The cuspless table next to `lambda*`."""
    return PinballImages(Scene("cuspless", lam="0.0713"), (LOW, HIGH))


@pytest.mark.parametrize(
    ("core", "item"),
    [
        (replace(SHORT, cubic=0.2), "orbits come to the middle"),  # no curve along which orbits approach
        (replace(SHORT, outer=0.4335), "orbits come to the middle"),  # beyond the join
        (replace(SHORT, inner=0.3), "they converge there"),  # its entries, as the kernels find them, grow by 1.03
        (replace(SHORT, cells=20), "orbits come to the middle"),
        (replace(SHORT, gates=((0.41, 0.05),)), "gates lead in"),
    ],
)
def test_a_core_that_is_none_is_refused(map: PinballImages, core: Core, item: str) -> None:
    """Each step of the proof fails alone."""
    assert all(attracts(map, SHORT).values())
    assert not attracts(map, core)[item]


@pytest.mark.parametrize("wrong", [{"cells": 0}, {"inner": -0.05}, {"width": 0.0}, {"gates": ((0.4, -0.003),)}])
def test_a_core_without_a_cell_or_a_size_is_none(wrong) -> None:
    """Of no cell everything is true: that all of a set up to the joins converges would be proved of it."""
    with pytest.raises(ValueError, match="at least one cell, and bounds above 0"):
        replace(CORE, outer=0.86, **wrong)


def test_a_repelling_cycle_has_no_core() -> None:
    """Beyond lambda_c = 0.0934 the orbit of period 2 attracts nothing."""
    assert not any(attracts(PinballImages(Scene("cuspless", lam="1/10")), replace(SHORT, gates=SHORT.gates)).values())


def test_half_of_a_core_is_no_proof_where_the_table_is_not_its_own_mirror_image(
    map: PinballImages, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Images of `theta >= 0` say nothing of the others there; and the norm is asked of `phi < 0` too."""
    monkeypatch.setitem(map.__dict__, "mirrored", False)
    assert not any(attracts(map, SHORT).values())
    asked: list[float] = []

    def noted(map: PinballImages, boxes: Boxes, bounces: int, weight: float) -> np.ndarray:
        asked.append(float(np.min(boxes.y[0])))
        return np.zeros(boxes.chart.size)

    monkeypatch.setattr("verification.proofs.starts.strips.steepest", noted)
    assert bounded(map, 0.54, 2, 0.05)
    assert asked == [-map.top] * 2


def test_half_of_a_core_is_no_proof_where_the_law_is_not_its_own_mirror_image() -> None:
    """With this one the half of `theta >= 0` goes to the middle, and of the other half some leave the core."""
    law = "-lam*eta + eta**2/300"
    bent = PinballImages(Scene("cuspless", lam=str(float(HIGH)), law=law), (LOW, HIGH))
    core = replace(CORE, gates=())
    theta = -np.linspace(0.001, 0.4099, 400)
    start = theta, (core.slope + core.cubic * theta**2) * theta - 0.99 * core.width, 2, np.full(theta.size, core.chart)
    orbit = bent.map.orbit(*start, fields=("theta", "phi"))
    theta, phi = orbit["theta"][-1], orbit["phi"][-1]
    assert np.any(np.abs(phi - (core.slope + core.cubic * theta**2) * theta) > core.width)
    assert not any(attracts(bent, core).values())
    with pytest.raises(ValueError, match="under -lam"):
        strips(bent, (64, 12), 12)


def test_a_core_and_its_gates_are_their_own_mirror_images_and_the_kernel_takes_them_in(map: PinballImages) -> None:
    """Random points of both halves, `theta` of either sign: after two bounces they are in the core."""
    rng = np.random.default_rng(8)
    for lam in (LOW, HIGH):
        pinball = PinballMap("cuspless", lam=str(float(lam)))
        for outer, width in (CORE.bounds, *CORE.gates):
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
    """Strips about points."""
    flat = np.zeros(theta.size)
    return Strips(np.full(theta.size, chart), theta - wide, theta + wide, flat, flat, eta, flat + tall)


def test_settled_strips_end_on_period_2_and_chaotic_ones_are_never_settled(map: PinballImages) -> None:
    """Random starts at both ends of the range; those near a chaotic one are drawn as thin as rounding lets."""
    for lam in (LOW, HIGH):
        pinball = PinballMap("cuspless", lam=str(float(lam)))
        start = interior_starts(pinball, 4000, 5)
        theta, eta = start.theta, start.phi
        nu = pinball.exponents(theta, -float(lam) * eta, 400, 3000, start.component).nu_plus
        for wide in (1e-3, 1e-9):
            for chart in (0, 1):
                on = (start.component == chart) & (np.abs(theta) < map.charts[chart].x[1] - 2 * wide)
                done, _ = settled(map, CORE, thin(chart, theta[on], eta[on], wide, wide))
                assert np.all(nu[on][done] < 0)
                assert np.mean(done) > 0.5
    assert np.sum(nu > 0.1) > 0  # at 0.0713, of 4000 starts
    beyond, _ = settled(map, CORE, thin(0, np.zeros(3), np.array([2.0, 5.0, 20.0]), 1e-3, 1e-3))
    assert not np.any(beyond)  # no incidence is above a quarter turn


def test_every_start_is_in_a_strip_and_half_of_the_measure_is_the_perimeter(map: PinballImages) -> None:
    """Strips of all `theta` and `0 <= eta <= pi/2`, also after cuts; together a little more than `L`."""
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


def test_a_strip_is_in_the_parallelogram_after_its_bounce_and_hardly_smaller(map: PinballImages) -> None:
    """Random points of strips that lean: `phi = -lam*eta`, and what the sides leave of them is within the rest."""
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
    """The area between them would be counted with a sign."""
    one = np.ones(1)
    crossing = Strips(np.zeros(1, dtype=np.int64), 0 * one, 0.01 * one, one, -one, 0.5 * one, 0.1 * one)
    assert crossing.measures(map)[0] == np.inf


def test_no_orbit_grows_faster_than_the_largest_norm(map: PinballImages) -> None:
    """The kernels find a norm of exp(2*0.514) over two bounces: 0.5 is refused, 0.54 proved."""
    assert bounded(map, 0.54, 2, 0.05)
    assert not bounded(map, 0.5, 2, 0.05, 4)


def test_what_is_left_is_counted_whole(map: PinballImages) -> None:
    """In no round nothing is settled, and less is left with each."""
    first = strips(map, (64, 12), 12)
    whole = 2 * np.sum(first.measures(map))
    left = unsettled(map, SHORT, first, 0.0, rounds=2)
    assert 0.3 * whole < left.measure < 0.9 * whole
    assert unsettled(map, replace(SHORT, outer=1e-9, gates=()), first, 0.0, rounds=1).measure >= whole


def test_jury() -> None:
    """Multipliers -0.92 and 0: a bound of 0.928 holds; of modulus 0.93, also complex, it does not."""
    assert stable(Rational(-92, 100), S.Zero, LOW, HIGH)
    assert not stable(Rational(-93, 100), S.Zero, LOW, HIGH)
    assert not stable(S.Zero, Rational(93, 100) ** 2, LOW, HIGH)


def test_the_diameter_is_that_of_the_cardioid(map: PinballImages) -> None:
    """The largest distance of two points of the cardioid is `3*sqrt(3)/2`, between two that the cut leaves."""
    assert 0 < diameter(map) - 1.5 * 3**0.5 < 0.01


@pytest.mark.parametrize(("speeds", "gap"), [((1.0, 1.0), 0.25), ((1.0, 3.0), 0.75), ((2.0, 1.0), 0.5)])
def test_a_diameter_is_that_of_a_mesh_and_of_what_may_lie_between_its_points(monkeypatch, speeds, gap) -> None:
    """Of two sides of length 1 that are 2 apart, by five points of each; boundaries run at most at given speeds."""
    monkeypatch.setattr(mean, "MESH", 4)
    monkeypatch.setattr(mean, "speeds", lambda map, on, theta: BallArray(np.array(speeds)[on], 0.0 * theta.m))
    place = lambda on, theta: (theta, BallArray(2.0 * on, 0.0 * theta.m), None)  # noqa: E731
    sides = SimpleNamespace(charts=[SimpleNamespace(x=(0.0, 1.0))] * 2, place=place)
    exact = 5**0.5 + gap
    assert exact < diameter(sides) < exact * (1 + 1e-9)


def test_the_average_is_negative_where_the_attractor_is_born() -> None:
    """Proved next to lambda*; sampled, it is lower. At 0.09, where most starts are chaotic, nothing is proved."""
    found = average()
    assert all(found.checks.values())
    assert found.mean < 0 < found.share < 0.07
    start = interior_starts(PinballMap("cuspless", lam="0.0713"), 500, 7)
    sampled = PinballMap("cuspless", lam="0.0713").exponents(start.theta, start.phi, 300, 2000, start.component)
    assert np.mean(sampled.nu_plus) < found.mean
    assert not all(attracts(PinballImages(Scene("cuspless", lam=str(Fraction(9, 100)))), CORE).values())


@pytest.mark.parametrize("failing", [None, "core", "no orbit grows faster", "period 2 is as stable"])
@pytest.mark.parametrize("measure", [0.0, 0.5, 200.0])
def test_the_mean_is_that_of_what_is_settled_and_of_the_rest_at_its_worst(monkeypatch, failing, measure) -> None:
    """`(1 - s)*log(0.928)/2 + s*0.52` for a share `s` of `measure*2.6/(2*pi*A)`; the area is `15*sqrt(3)/16 + pi`."""
    asked = []

    def unsettled(map, core, first, enough):
        asked.append(enough)
        return Left(measure, 7)

    monkeypatch.setattr(mean, "unsettled", unsettled)
    monkeypatch.setattr(mean, "attracts", lambda *_: {"core": failing != "core"})
    monkeypatch.setattr(mean, "bounded", lambda *_: failing != "no orbit grows faster")
    monkeypatch.setattr(mean, "stable", lambda *_: failing != "period 2 is as stable")
    monkeypatch.setattr(mean, "strips", lambda *_: None)
    monkeypatch.setattr(mean, "diameter", lambda _: 2.6)
    found = mean.average.__wrapped__(LOW, HIGH)
    ratio = 2.6 / (2 * np.pi * (15 * 3**0.5 / 16 + np.pi))
    share, nu, rate = measure * ratio, np.log(0.928) / 2, 0.52
    assert found.share == pytest.approx(share, rel=1e-9)
    assert found.share >= share * (1 - 1e-14)
    assert {name for name, held in found.checks.items() if not held} == ({failing} if failing else set())
    proved = failing is None and share < 1
    assert found.mean == (pytest.approx((1 - share) * nu + share * rate, rel=1e-9) if proved else np.inf)
    assert found.mean >= (1 - share) * nu + share * rate
    assert asked == [pytest.approx(0.98 * -nu / (rate - nu) / ratio, rel=1e-9)]
