"""Every return to the arc of the cuspless cardioid stretches: the steps, broken, and the float64 map beside them."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.cycles import returns
from symbolic.cycles.returns import B, margins
from symbolic.cycles.thresholds import lambda_c
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import lam
from verification.proofs.global_dynamics import returns as boxes
from verification.proofs.global_dynamics.returns import every_return, positive_margins

SIDE = 120


def test_the_steps_are_proved_and_the_margins_positive():
    assert every_return().outcome is Outcome.PROVED


@pytest.mark.parametrize("step", ["return_defects", "end_defects", "share_defects"])
def test_a_step_that_is_no_identity_proves_nothing(monkeypatch, step):
    monkeypatch.setattr(returns, step, lambda: [lam])
    returns.returns.cache_clear()
    outcome = returns.returns().outcome
    returns.returns.cache_clear()

    assert outcome is Outcome.UNKNOWN


def test_a_form_that_would_shrink_is_not_proved_to_grow(monkeypatch):
    first, second = margins()
    monkeypatch.setattr(boxes, "margins", lambda: (first, second - returns.A / 50))  # the smaller one is 0.0107 or so

    assert positive_margins(Fraction(1, 10), Fraction(3, 20)).positive is None


def test_nothing_is_proved_where_the_orbit_of_period_2_attracts():
    assert Fraction(93, 1000) < lambda_c().n()
    assert positive_margins(Fraction(93, 1000), Fraction(93, 1000)).positive is None


def grown(contraction):
    """The form after a return to the arc over what it was, at both ends of the cone, by the float64 map."""
    map = PinballMap("cuspless", lam=contraction)
    places, angles = (
        np.linspace(-1, 1, SIDE + 2)[1:-1] * end for end in (2 * np.pi / 3, float(contraction) * np.pi / 2)
    )
    theta, phi = (x.ravel() for x in np.meshgrid(places, angles))
    arc = np.zeros(theta.size, dtype=int)
    matrix, landed = map.derivative(theta, phi, arc), map.step(theta, phi, arc)
    later = map.step(landed.theta, landed.phi, landed.component)
    wall = landed.component != 0
    twice = map.derivative(landed.theta, landed.phi, landed.component) @ matrix
    whole, end = np.where(wall[:, None, None], twice, matrix), np.where(wall, later.theta, landed.theta)
    bend = [3 / (4 * np.cos(x / 2)) for x in (theta, end)]
    for y in (1.0, 1 + float(contraction)):
        vector = np.stack([1 / bend[0], np.full(theta.size, 1 - y)], axis=1)
        out = np.einsum("pij,pj->pi", whole, vector)
        yield np.abs((1 - float(B)) * bend[1] * out[:, 0] - out[:, 1]) / (y - float(B))


@pytest.mark.parametrize("contraction", ["0.1", "0.2", "0.35", "0.6"])
def test_every_return_multiplies_the_form_by_more_than_one(contraction):
    assert min(float(np.min(factor)) for factor in grown(contraction)) > 1.01


def test_below_the_loss_of_stability_some_return_shrinks_it():
    assert min(float(np.min(factor)) for factor in grown("0.09")) < 1


def run_of(monkeypatch, least, first=(2, 2, 4)):
    """Margins in the place of the formulas: `least` of half the place, exit and contraction, on few boxes at first."""
    monkeypatch.setattr(boxes, "FIRST", first)
    monkeypatch.setattr(boxes, "margins", lambda: ())
    monkeypatch.setattr(
        boxes, "program", lambda: lambda ops, *balls: [SimpleNamespace(lower=lambda x=x: x) for x in least(*balls)]
    )


def test_every_way_lies_in_a_box_whose_margins_are_both_large_enough(monkeypatch):
    """Boxes prove something once they are small, on one side of the way smaller than on the other."""
    held, low, high = [], Fraction(1, 5), Fraction(3, 5)

    def least(half, exit, contraction):
        ends = np.transpose([end for x in (half, exit, contraction) for end in (x.lower(), x.upper())])
        good = [contraction.r < 0.02 + 0.03 * (exit.m > 0), exit.r < 0.15 + 0.2 * (half.m > 0.2)]
        held.extend(ends[good[0] & good[1]])
        return [np.where(some, boxes.LEAST, boxes.LEAST * 0.999) for some in good]

    run_of(monkeypatch, least)
    found = positive_margins(low, high)
    assert found.positive is True
    assert found.boxes == 16 + 8 * (found.boxes - len(held))  # each box that is left is cut into eight
    ends, random = np.array(held), np.random.default_rng(7)
    for u, v, share in [*random.uniform(0, 1, (300, 3)), *np.ndindex(2, 2, 2)]:
        contraction = float(low) + share * float(high - low)
        exit = (2 * u - 1) * contraction * np.pi / 2
        point = np.array([v * (exit + np.pi / 2) / 3, exit, contraction])
        assert np.any(np.all((ends[:, ::2] - 1e-12 <= point) & (point <= ends[:, 1::2] + 1e-12), axis=1))
    whole = [ends[:, ::2].min(0), ends[:, 1::2].max(0)]
    wide = float(high) * np.pi / 2
    assert np.allclose(whole[1], [(wide + np.pi / 2) / 3, wide, float(high)], atol=0.5)
    assert whole[0][2] == pytest.approx(float(low), abs=1e-12)
    assert whole[1][2] == pytest.approx(float(high), abs=1e-12)


def test_boxes_that_are_never_small_enough_are_cut_so_often_and_so_many_and_prove_nothing(monkeypatch):
    asked = []

    def least(half, exit, contraction):
        asked.append(np.broadcast(half.m, exit.m, contraction.m).size)
        return [np.where(np.arange(asked[-1]) < 2, 0.0, 1.0), np.full(asked[-1], 1.0)]

    run_of(monkeypatch, least)
    monkeypatch.setattr(boxes, "DEPTH", 3)
    for most, rounds in ((1 << 19, 3), (16, 3), (15, 1)):
        asked.clear()
        monkeypatch.setattr(boxes, "MOST", most)
        found = positive_margins()
        assert (found.positive, found.boxes, len(asked)) == (None, 16 * rounds, rounds)


@pytest.mark.parametrize(("first", "second"), [(Outcome.PROVED, True), (Outcome.UNKNOWN, True), (Outcome.PROVED, None)])
def test_every_return_stretches_where_identities_and_margins_are_both_proved(monkeypatch, first, second):
    monkeypatch.setattr(boxes, "positive_margins", lambda: boxes.Margins(second, 5))
    monkeypatch.setattr(boxes, "returns", lambda: Finding(first, "identities"))
    held = first is Outcome.PROVED and second is True
    assert (every_return.__wrapped__().outcome is Outcome.PROVED) is held
