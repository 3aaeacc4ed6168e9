"""A new way to fly is one class and one line of the registry: nothing else has to hear of it."""

import sys
from types import ModuleType

import numpy as np
import pytest
from sympy import cos, sin

from numeric import PinballMap
from numeric.backends import functions as plane
from numeric.flights import registry
from numeric.flights.family import Family, Landing, Status, grazing, reflected
from symbolic import tables
from symbolic.tables.table import theta
from verification.maps.exact import ExactMap

DISC = tables.parametric(3 * cos(theta), 3 * sin(theta), "disc")
THETA, PHI = np.array([0.3, -2.0, 3.1, 0.0]), np.array([0.4, -1.2, 0.0, 1.5])


class Disc(Family):
    """A circle of any radius, its centre at the origin: the chord turns by `pi - 2*phi`, in unit numbers."""

    name, path = "disc", "the chord of a circle, in unit numbers"
    pairs = 0, 2
    position, direction = ("ux", "uy"), ("vx", "vy")

    @classmethod
    def matches(cls, boundary):
        return boundary.ir.table == "disc"

    def enter(self, ops, component, theta):
        return [ops.cos(theta), ops.sin(theta)]

    def place(self, ops, position):
        return ops.number(0.0), ops.atan2(position[1], position[0])

    def radius(self, ops, shape):
        x, y, *_ = self.boundary.ir.parts[0].curve(ops, ops.number(0.0), *shape)
        return ops.sqrt(x * x + y * y)

    def fly(self, ops, shape, law, position, exit):
        v = exit[0], exit[1]
        half = plane.exact_dot(ops, tuple(position), v)  # minus half the chord, in radii
        u = plane.unit(ops, (position[0] - (half + half) * v[0], position[1] - (half + half) * v[1]))
        R = self.radius(ops, shape)
        across, along = R * plane.exact_cross(ops, u, v), R * plane.exact_dot(ops, u, v)
        code = ops.select(grazing(ops, across, along), ops.number(float(Status.GRAZING.code)), ops.number(0.0))
        d = -R * u[1], R * u[0]
        return Landing(list(u), across, along, code, {"v": v, "d": d}, {"t": -(half + half) * R})

    def leave(self, ops, shape, law, lam, landing):
        return reflected(self, ops, law, lam, landing)

    def slapped(self, ops, shape, position):
        return [-position[0], -position[1]]

    def departure(self, ops, shape, position, exit):
        return -plane.dot(tuple(position), tuple(exit)) * self.radius(ops, shape)

    def length(self, ops, shape, n0, start, end, landing):
        return landing.numbers["t"]

    def bend(self, ops, shape, landing):
        return ops.number(-1.0), ops.number(1.0)


@pytest.fixture
def registered(monkeypatch):
    module = ModuleType("numeric.flights.disc")
    module.Disc = Disc
    monkeypatch.setitem(sys.modules, "numeric.flights.disc", module)
    monkeypatch.setattr(registry, "FAMILIES", (("disc", "Disc", ""), *registry.FAMILIES))


@pytest.mark.parametrize("kernels", [True, False], ids=["LLVM", "NumPy"])
@pytest.mark.parametrize("lam", ["0", "0.7", "1"])
def test_a_family_of_one_class_and_one_line_answers_every_question(registered, monkeypatch, lam, kernels):
    """Steps, orbits, derivatives, exponents, slap maps and arc lengths, as the families that were there answer them."""
    new = PinballMap(DISC, lam=lam, kernels=kernels)
    monkeypatch.setattr(registry, "FAMILIES", registry.FAMILIES[1:])
    old = PinballMap(DISC, lam=lam, kernels=kernels)
    one, other = (map.orbit(THETA, PHI, 5) for map in (new, old))

    assert (new.path, old.path) == (Disc.path, "closed form in unit numbers")
    assert np.max(np.abs(np.exp(1j * one.theta) - np.exp(1j * other.theta))) < 1e-13
    assert np.nanmax(np.abs(one.phi - other.phi)) < 1e-13
    assert np.allclose(new.derivative(THETA, PHI), old.derivative(THETA, PHI), rtol=1e-12, atol=1e-12)
    assert np.allclose(new.exponents(THETA, PHI, 40).nu_plus, old.exponents(THETA, PHI, 40).nu_plus, rtol=0, atol=1e-12)
    assert np.allclose(new.slap(THETA).slope, old.slap(THETA).slope, rtol=0, atol=1e-12)
    assert np.allclose(new.arclength.s(THETA), 3 * THETA, rtol=0, atol=1e-14)


def test_the_text_of_a_new_family_runs_on_fifty_digits_and_is_the_definition(registered):
    map = PinballMap(DISC, lam="0.7")
    exact = ExactMap(map, 50)
    mp, ops = exact.context, exact.ops
    start = exact.start(THETA[0], PHI[0])
    state = [*map.family.enter(ops, mp.mpf(0), start.theta), *start.v]
    fields, code = map.family.bounce(ops, map.law, exact.shape, exact.lam, state)
    truth = exact.bounce(start)

    assert not code
    assert abs(map.family.place(ops, fields[:2])[1] - truth.theta) < mp.mpf(10) ** -45
    assert (
        max(abs(a - b) for a, b in zip(fields[2:], truth.v, strict=True)) < mp.mpf(10) ** -16
    )  # lam is a double there
