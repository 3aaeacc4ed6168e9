"""Judges on parameter space and elastic collisions: the facts behind their verdicts, and the twist by two methods."""

import numpy as np
import pytest
from flint import arb
from sympy import Interval, Rational

from numeric import PinballMap
from numeric.dynamics.phase_points import phase_points
from numeric.dynamics.recognition import polished
from symbolic.cycles.normal_forms import egg_diameter
from symbolic.tables import egg, ellipse
from symbolic.tables.table import alpha
from verification.named.cascades import cascade
from verification.paper.claims.claim import Verdict
from verification.paper.egg.elastic import elastic_mixed, isosceles
from verification.paper.egg.stability import CASCADES, periods_at
from verification.paper.report.report import catalogue
from verification.proofs.periodic.bifurcation import Twist, twist

CLAIMS = {claim.id: claim for claim in catalogue()}


@pytest.mark.parametrize("shape", [Rational(1, 50), Rational(1, 20)])
def test_the_twist_of_the_diameter_is_the_same_by_averaging_and_by_the_normal_form(shape):
    _, trace, mean = (e.subs(alpha, shape) for e in egg_diameter())
    found = twist(egg(3).at(alpha=shape), (0, 0), [arb(0), arb.pi()], 100)

    exact = mean / (2 * (1 - trace**2 / 4))  # the mean of S is 8*sin^2 of the twist's angle, of which it makes 4
    assert found.twist.overlaps(arb(int(exact.p)) / int(exact.q))
    assert found.trace.overlaps(arb(int(trace.p)) / int(trace.q))
    assert found.drift.contains(0)
    assert found.islands


def test_the_twist_is_how_the_rotation_changes_with_the_distance():
    # second method: orbits at two distances from the isosceles triangle, and the mean angle that they turn
    _, turn = isosceles()
    map = PinballMap("egg", lam=1, alpha="0.1")
    cycle = polished(map, phase_points([3.141, -1.4413, 1.4413], [0.7498, 0.4104, 0.4104]))
    theta, phi = cycle.points.theta[0], cycle.points.phi[0]

    def momentum(at, angle):
        return np.sin(angle) * map.states.speed(np.zeros(at.shape, dtype=np.int64), at)

    start = theta + np.array([0.0, 1e-5, 1e-4, 3e-4])
    one = momentum(start[:1], phi)
    angle = np.arcsin(one / momentum(start, np.pi / 2))  # the same momentum at each start
    orbit = map.orbit(start, angle, 3 * 4000)
    x = np.remainder(orbit.theta[::3] - theta + np.pi, 2 * np.pi) - np.pi
    p = momentum(orbit.theta[::3], orbit.phi[::3]) - one
    M = np.linalg.lstsq(np.stack([x[:-1, 1], p[:-1, 1]], 1), np.stack([x[1:, 1], p[1:, 1]], 1), rcond=None)[0].T
    sine = np.sign(M[0, 1]) * np.sqrt(1 - np.trace(M) ** 2 / 4)
    a, b = (M[0, 0] - M[1, 1]) / (2 * sine), M[0, 1] / sine
    z = (x[:, 2:] - 1j * (b * p + a * x)[:, 2:]) / np.sqrt(b)  # turns by an angle that only depends on its size
    turned = np.mod(np.angle(z[1:] / z[:-1]), 2 * np.pi)
    part = (np.arange(len(turned)) + 0.5) / len(turned)
    weight = np.exp(-1 / (part * (1 - part)))  # a smooth window: the mean converges faster than any power
    near, far = weight @ turned / weight.sum()
    sizes = weight @ np.abs(z[:-1]) ** 2 / weight.sum()

    assert (far - near) / (sizes[1] - sizes[0]) == pytest.approx(float(turn.twist), rel=0.02)


def test_a_multiplier_that_is_a_root_of_unity_proves_no_island():
    third = twist(ellipse.at(a=2), (0, 0), [-arb.pi() / 2, arb.pi() / 2], 100)  # trace -1

    assert third.trace.contains(-1)
    assert third.islands is None
    assert Twist(arb(0), arb(1), arb(0)).islands is None
    assert Twist(arb(1), arb(0, 1), arb(0)).islands is None
    assert Twist(arb(3), arb(1), arb(0)).islands is None


def test_the_circle_at_the_end_of_the_printed_range_does_not_refute_mixed_phase_spaces():
    found = elastic_mixed(CLAIMS["egg.elastic_mixed"])

    assert CLAIMS["egg.elastic_mixed"].box[alpha] == Interval(0, Rational(1, 10))
    assert found.verdict is Verdict.SUPPORTED
    assert "(0, 1/10]" in found.derived


def test_periods_are_those_of_the_paper_s_cascade():
    # section 6.6: period 4 before lambda_3 = 0.372 and period 8 after it; period 3 from 0.39 on, as printed
    assert set(periods_at("0.08", "0.3", 20)) == {4}
    assert set(periods_at("0.08", "0.377", 20)) == {8}
    assert set(periods_at("0.08", "0.7", 20)) == {3}
    assert 0 in periods_at("0.08", "0.5", 20)


def test_a_cascade_needs_a_cycle_to_start_from():
    said = "none of 400 particles at alpha = 2/25, lam = 3/10 ends on a cycle of period 7"
    with pytest.raises(ValueError, match=said):
        cascade(Rational(2, 25), Rational(3, 10), 7, 1e-3)


def test_the_ratios_of_a_cascade_are_near_feigenbaum_s():
    # 4.6692: a second method, since nothing in the climb knows it but the first guess of the next rung
    for shape, start, period, step, _ in CASCADES:
        assert cascade(Rational(shape), Rational(start), period, step).ratios == pytest.approx([4.6692], rel=0.03)
