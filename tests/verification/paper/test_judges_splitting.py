"""Laws of the judges of dominated splitting, with the cones in numbers, and the judges driven to other verdicts."""

from types import SimpleNamespace

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
UNPROVED, PROVED = Finding(Outcome.UNKNOWN, "not proved"), Finding(Outcome.PROVED, "proved")


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


def test_averages_errors_and_correlations_are_those_of_the_orbits_that_are_given(monkeypatch):
    """Of 7 made-up orbits of 60 bounces in blocks of 20, by loops; the start is no bounce of theirs."""
    chance, orbits, bounces, block, lag = np.random.default_rng(4), 7, 60, 20, 3
    theta, phi = chance.uniform(0, 1, (bounces + 1, orbits)), chance.uniform(-1.5, 1.5, (bounces + 1, orbits))
    length = SimpleNamespace(s=lambda theta, component: theta * 4, perimeter=5.0)
    orbit = SimpleNamespace(theta=theta, phi=phi, component=0 * theta)
    map = SimpleNamespace(orbit=lambda *_: orbit, arclength=length)
    for name, value in (("BALLS", orbits), ("BOUNCES", bounces), ("BLOCK", block), ("LAG", lag)):
        monkeypatch.setattr(on_splitting, name, value)
    monkeypatch.setattr(on_splitting, "PinballMap", lambda table, lam: map)
    start = SimpleNamespace(theta=theta[0], phi=phi[0], component=0)
    monkeypatch.setattr(on_splitting, "phase_starts", lambda *_: start)
    means, errors, later = on_splitting.averages("made up")

    turn = 2 * np.pi * theta[1:] * 4 / 5
    values = [np.sin(phi[1:]) ** 2 - 1 / 3, np.cos(turn), np.sin(phi[1:]) * np.sin(turn)]
    for k, each in enumerate(values):
        for j in range(orbits):
            own = each[:, j]
            blocks = [np.mean(own[i : i + block]) for i in range(0, bounces, block)]
            assert means[k, j] == pytest.approx(np.mean(own))
            assert errors[k, j] == pytest.approx(np.std(blocks, ddof=1) / np.sqrt(3))
        pairs = [each[i + lag, j] * each[i, j] for i in range(bounces - lag) for j in range(orbits)]
        assert later[k] == pytest.approx(np.mean(pairs) / np.mean(each**2))


@pytest.mark.parametrize(
    ("spread", "later", "supported"), [(1, 0.01, True), (1, -0.03, False), (1, 0.03, False), (2, 0.01, False)]
)
def test_ergodicity_is_supported_by_averages_within_their_errors_and_by_correlations_that_fade(
    monkeypatch, spread, later, supported
):
    """Off the mean of the space by one error each, or by two, which is too much."""
    means = np.array([[spread, -spread]] * 2 + [[1.0, -1.0]])
    found = means, np.ones((3, 2)), np.array([0.0, later, 0.0])
    monkeypatch.setattr(on_splitting, "averages", lambda *_: found)

    wanted = Verdict.SUPPORTED if supported else Verdict.OPEN
    assert verdict(on_splitting.ergodic, "cardioid.elastic_ergodic") is wanted


@pytest.mark.parametrize(("found", "answer"), [(True, Verdict.CORRECTED), (None, Verdict.REFUTED)])
def test_the_fourth_collision_lies_beyond_again_at_the_contraction_that_is_told(monkeypatch, found, answer):
    """Where its boxes are proved, and it is told at that contraction; what is right takes the kink that falls."""
    asked = []
    proved, open_ = SimpleNamespace(on_wall=True, boxes=1), SimpleNamespace(on_wall=None, boxes=1)
    monkeypatch.setattr(on_splitting, "fourth_on_wall", lambda _, *lams, or_lower: asked.append(lams) or proved)
    monkeypatch.setattr(on_splitting, "kink_falls", lambda *_: found)
    monkeypatch.setattr(on_splitting, "corner", lambda *_: PROVED)
    claim = CLAIMS["cuspless.fourth_collision_above"]
    judgement = on_splitting.fourth_collision_above(claim)

    assert judgement.verdict is answer
    assert [float(at) for _, at in judgement.printed.at] == [asked[0][0]] == [asked[0][1]]
    monkeypatch.setattr(on_splitting, "fourth_on_wall", lambda *_, or_lower: open_)
    assert on_splitting.fourth_collision_above(claim).verdict is Verdict.OPEN


@pytest.mark.parametrize("wrong", ["far", "near", "falls", "corner", ""])
def test_the_fourth_collision_stays_beyond_below_lambda_star_by_each_of_its_proofs(monkeypatch, wrong):
    far = SimpleNamespace(on_wall=wrong != "far" or None, boxes=1)
    monkeypatch.setattr(on_splitting, "fourth_on_wall", lambda *_, **__: far)
    monkeypatch.setattr(on_splitting, "minimum_at_kink", lambda *_, **__: wrong != "near" or None)
    monkeypatch.setattr(on_splitting, "kink_falls", lambda *_: wrong != "falls" or None)
    monkeypatch.setattr(on_splitting, "corner", lambda *_: UNPROVED if wrong == "corner" else PROVED)

    wanted = Verdict.OPEN if wrong else Verdict.CONFIRMED
    assert verdict(on_splitting.fourth_collision_below, "cuspless.fourth_collision_below") is wanted


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
