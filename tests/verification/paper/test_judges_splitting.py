"""Laws of the judges of dominated splitting, with the cones in numbers, and the judges driven to other verdicts."""

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.cycles.splitting import least_rate
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import lam
from verification.paper.claims.claim import Verdict
from verification.paper.judges import cuspless_chaos as on_chaos
from verification.paper.judges import hyperbolicity as on_splitting
from verification.paper.report.report import catalogue

CLAIMS = {claim.id: claim for claim in catalogue()}
UNPROVED = Finding(Outcome.UNKNOWN, "not proved")


def verdict(judge, name):
    return judge(CLAIMS[name]).verdict


def returns(contraction, balls=200, bounces=60):
    """Back on the arc after one or two bounces: `y` of both edges of the cone, and the growth of widths over `D`."""
    map = PinballMap("cuspless", lam=contraction)
    rng = np.random.default_rng(3)
    orbit = map.orbit(rng.uniform(-2, 2, balls), rng.uniform(-0.3, 0.3, balls), bounces)
    edges, growth = [], []
    for i in range(5, bounces - 2):
        here = orbit.component[i] == 0
        c = np.cos(orbit.theta[i] / 2)
        for y in (1.0, 1.0 + contraction):
            vector = np.stack([np.ones(balls), (1 - y) * 3 / (4 * c)], axis=-1)
            wide, at = 3 / (4 * c), np.array(here)
            for k in range(i, i + 2):
                matrix = map.derivative(orbit.theta[k], orbit.phi[k], orbit.component[k])
                vector = np.einsum("nij,nj->ni", matrix, vector)
                landed = at & (orbit.component[k + 1] == 0)
                bend = 3 / (4 * np.cos(orbit.theta[k + 1] / 2))
                edges += list((1 - vector[:, 1] / (vector[:, 0] * bend))[landed])
                growth += list(np.abs(vector[:, 0] * bend / wide)[landed])
                at &= ~landed
    return np.array(edges), np.array(growth)


@pytest.mark.parametrize("contraction", [0.05, 0.3, 0.6, 0.9])
def test_every_return_to_the_arc_maps_the_cone_strictly_into_itself(contraction):
    edges, _ = returns(contraction)

    assert edges.size > 10_000
    assert np.min(edges) > 1
    assert np.max(edges) < 1 + contraction


@pytest.mark.parametrize("contraction", [0.6, 0.75, 0.9])
def test_above_16_27_every_return_widens_the_beams_by_what_is_proved(contraction):
    _, growth = returns(contraction)

    assert np.min(growth) >= float(np.exp(2 * float(least_rate().subs(lam, contraction))))


def test_below_5_27_a_return_may_narrow_them():
    assert np.min(returns(0.15)[1]) < 1


@pytest.mark.parametrize(
    ("judge", "name", "proved", "unproved"),
    [
        (on_splitting.dominated, "cuspless.dominated_splitting", Verdict.CONFIRMED, Verdict.OPEN),
        (on_splitting.dominated, "cardioid.dominated_splitting", Verdict.CONFIRMED, Verdict.OPEN),
        (on_splitting.by_exponents, "cuspless.splitting_by_exponents", Verdict.CORRECTED, Verdict.OPEN),
        (on_splitting.unfolded, "cuspless.unfolded_defocusing", Verdict.CONFIRMED, Verdict.OPEN),
        (on_splitting.hyperbolic, "cuspless.elastic_hyperbolic", Verdict.CONFIRMED, Verdict.OPEN),
    ],
)
def test_cones_that_are_not_proved_settle_nothing(monkeypatch, judge, name, proved, unproved):
    assert verdict(judge, name) is proved

    monkeypatch.setattr(on_splitting, "splits", lambda: UNPROVED)
    assert verdict(judge, name) is unproved


def test_the_cardioid_s_hyperbolicity_hangs_on_its_cone(monkeypatch):
    assert verdict(on_splitting.hyperbolic, "cardioid.elastic_hyperbolic") is Verdict.CONFIRMED

    monkeypatch.setattr(on_splitting, "expands", lambda: UNPROVED)
    assert verdict(on_splitting.hyperbolic, "cardioid.elastic_hyperbolic") is Verdict.OPEN


def test_time_averages_of_a_dissipative_table_are_not_those_of_the_elastic_measure(monkeypatch):
    assert verdict(on_splitting.ergodic, "cuspless.elastic_ergodic") is Verdict.SUPPORTED

    dissipative = on_splitting.averages("cuspless", "0.9")
    monkeypatch.setattr(on_splitting, "averages", lambda table: dissipative)
    assert verdict(on_splitting.ergodic, "cuspless.elastic_ergodic") is Verdict.OPEN


@pytest.mark.parametrize("ground", ["every_return", "splits"])
@pytest.mark.parametrize(
    ("judge", "name", "settled"),
    [
        (on_chaos.global_near_one, "cuspless.global_near_one", Verdict.SUPPORTED),  # one attractor is sampled
        (on_chaos.above_tenth, "cuspless.chaotic_above_tenth", Verdict.SUPPORTED),
        (on_chaos.accumulates, "cuspless.accumulates_on_joins", Verdict.CONFIRMED),
    ],
)
def test_chaos_of_the_cuspless_table_rests_on_every_return(monkeypatch, judge, name, settled, ground):
    assert verdict(judge, name) is settled

    monkeypatch.setattr(on_chaos, ground, lambda: UNPROVED)
    assert verdict(judge, name) is Verdict.OPEN
