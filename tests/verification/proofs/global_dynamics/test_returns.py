"""Every return to the arc of the cuspless cardioid stretches: each proof step can fail, and float64 agrees."""

from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.cycles.returns import B
from symbolic.cycles.thresholds import lambda_c
from symbolic.expressions.signs import Outcome
from verification.proofs.global_dynamics.returns import every_return, positive_margins

SIDE = 120


def test_the_steps_are_proved_and_the_margins_positive():
    assert every_return().outcome is Outcome.PROVED


def test_nothing_is_proved_where_the_orbit_of_period_2_attracts():
    assert Fraction(93, 1000) < lambda_c().n()
    assert positive_margins(Fraction(93, 1000), Fraction(93, 1000)).proved is None


def grown(contraction):
    """The ratio of the form after and before a return to the arc, at both edges of the cone, in float64."""
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
