"""Fixtures: scenes that tests share, and a cache folder apart from the user's, which all processes and runs share."""

import os
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

os.environ["PINBALL_CACHE"] = str(Path(__file__).parents[2] / ".pytest_cache" / "pinball")  # its keys hold the sources

from numeric import PinballMap
from numeric.backends.scalars import ScalarBackend
from numeric.kernels.machine import KernelSpec

SHAPES = {"circle": {}, "ellipse": {"a": "3/2"}, "cardioid": {}, "cuspless": {}, "egg": {"alpha": "0.08"}}


def starts(map, count, seed, steepest=1.0):
    """Random particles: component, theta and phi; `sin(phi)` is uniform below the sine of the steepest angle."""
    rng = np.random.default_rng(seed)
    component = rng.integers(0, len(map.states.ends), count)
    ends = np.array(map.states.ends)[component]
    theta = ends[:, 0] + (ends[:, 1] - ends[:, 0]) * rng.uniform(0.001, 0.999, count)
    return component, theta, np.arcsin(rng.uniform(-steepest, steepest, count) * 0.9999)


def boundary(name, where, theta, shape):
    """Point, unit tangent, curvature with the paper's sign, and speed, from the polar form of each table."""
    zero = 0 * theta
    if name == "ellipse":
        (a,) = shape
        first, second = (-a * np.sin(theta), np.cos(theta)), (-a * np.cos(theta), -np.sin(theta))
        z = a * np.cos(theta), np.sin(theta)
    else:
        share, k = {"circle": (0, 1), "egg": (*shape, 3)}.get(name, (1, 1))
        rho, slope, bend = (
            1 + share * np.cos(k * theta),
            -share * k * np.sin(k * theta),
            -share * k * k * np.cos(k * theta),
        )
        u = np.cos(theta), np.sin(theta)
        z = rho * u[0], rho * u[1]
        first = slope * u[0] - rho * u[1], slope * u[1] + rho * u[0]
        second = (bend - rho) * u[0] - 2 * slope * u[1], (bend - rho) * u[1] + 2 * slope * u[0]
    if name == "cuspless":
        wall = where == 1
        z = np.where(wall, -0.25, z[0]), np.where(wall, -theta, z[1])
        first = np.where(wall, zero, first[0]), np.where(wall, -1.0, first[1])
        second = np.where(wall, zero, second[0]), np.where(wall, zero, second[1])
    speed = np.hypot(*first)
    return z, (first[0] / speed, first[1] / speed), -(first[0] * second[1] - first[1] * second[0]) / speed**3, speed


def inside(name, x, y, shape):
    """A measure of how far a point lies within the table, without unit; negative outside."""
    if name == "ellipse":
        return 1 - (x / shape[0]) ** 2 - y**2
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    share, k = {"circle": (0, 1), "egg": (*shape, 3)}.get(name, (1, 1))
    within = 1 + share * np.cos(k * angle) - radius
    if name == "cuspless":  # between the wall and the tips of the arc there is no arc
        within = np.minimum(np.where(abs(angle) < 2 * np.pi / 3, within, np.inf), x + 0.25)
    return within


class Bounced:
    """One bounce of many particles, with the values that the definition of the map gives for each table."""

    def __init__(self, map, where, theta, phi):
        name, law = map.ir.table, map.law
        here = boundary(name, where, theta, map.shape)
        lams = np.full(theta.size, float(map.lam))
        own = map.states.enter(where, theta, phi, law)
        with np.errstate(all="ignore"):
            fields = list(map.engine.run(KernelSpec(law, record=True), own, lams, map.shape, 1).record[0])
        self.fields, self.own = fields, own
        self.where, self.theta = map.states.place(fields)
        self.phi = map.states.exit(self.where, self.theta, fields, law)
        there = boundary(name, self.where, self.theta, map.shape)
        (x, y), (tx, ty), *_ = here
        v = np.sin(phi) * tx - np.cos(phi) * ty, np.sin(phi) * ty + np.cos(phi) * tx
        (x1, y1), (tx, ty), *_ = there
        self.off_the_line = abs((x1 - x) * v[1] - (y1 - y) * v[0])
        self.length = (x1 - x) * v[0] + (y1 - y) * v[1]
        self.eta = -np.arctan2(v[0] * tx + v[1] * ty, v[0] * ty - v[1] * tx)
        self.turned = abs(self.phi + map.lam * self.eta)
        share = np.linspace(0.02, 0.98, 25)[:, None]
        self.depth = np.min(inside(name, x + share * (x1 - x), y + share * (y1 - y), map.shape), axis=0)


def rounding(map, where, theta, phi):
    """Rounding errors of the fields of a landing, in eps: the step on arrays against the step with 40 digits."""
    context = mpmath.MPContext()
    context.dps = 40
    own = map.states.enter(where, theta, phi, map.law)
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(theta.size, float(map.lam)), map.shape, 1)
    found, shape, lam = result.record[0], [context.mpf(x) for x in map.shape], context.mpf(float(map.lam))
    errors = []
    for i in range(theta.size):
        state = [context.mpf(float(field[i])) for field in own]
        exact, code = map.family.bounce(ScalarBackend(context), map.law, shape, lam, state)
        assert (code or 0) == (result.rows["code"][i] if "code" in result.rows else 0)
        errors.append([float(abs(a - b) / 2.0**-52) for a, b in zip(found[:, i].tolist(), exact, strict=True)])
    at = len(map.family.position)
    return np.max(np.array(errors)[:, :at]), np.max(np.array(errors)[:, at:], initial=0.0)


@pytest.fixture(name="rounding")
def rounding_():
    """The largest errors of position and of direction."""
    return rounding


@pytest.fixture
def bounced():
    """Bounces with the values that the definition gives."""
    return Bounced


@pytest.fixture(params=list(SHAPES))
def table(request):
    """Each table of the paper: its name, its shape, a map at some `lam`, and random particles."""
    name, shape = request.param, SHAPES[request.param]
    return SimpleNamespace(
        name=name,
        shape=shape,
        map=lambda lam, **more: PinballMap(name, lam=lam, **shape, **more),
        starts=starts,
        boundary=lambda where, theta, shape: boundary(name, where, theta, shape),
    )
