"""A smooth join is no corner: cutting a curve into pieces changes no flight, wherever it starts or ends."""

import numpy as np
import pytest
from sympy import Rational, S, cos, pi, sin

from numeric import PinballMap, phase_starts
from numeric.pinball.coordinates import located
from symbolic import tables
from symbolic.tables.table import Component, Table, theta
from verification.app.cli import main

X, Y = cos(theta), sin(theta)
EGG = tables.egg(3).at(alpha="0.08").components[0].point


def arcs(x, y, low, high, count):
    cuts = [low + (high - low) * Rational(k, count) for k in range(count + 1)]
    return [Component(f"{x} {k}", (S(x), S(y)), cuts[k], cuts[k + 1]) for k in range(count)]


def stadium(count):
    """The stadium with its half circles cut into pieces."""
    side = [Component(f"side {y}", (-y * theta, S(y)), S(-1), S(1)) for y in (1, -1)]
    right, left = (arcs(X + z, Y, -z * pi / 2, (2 - z) * pi / 2, count) for z in (1, -1))
    return Table("stadium", (*right, side[0], *left, side[1]))


def disc(low, high, count):
    """The square with a disc, cut into pieces."""
    return Table("disc", (*tables.square(4).components, *arcs(2 + X, 2 - Y, low, high, count)))


def egg(count, hole):
    """The egg with a disc, each cut into so many pieces."""
    return Table("egg", (*arcs(*EGG, -pi, pi, count), *arcs(X / 4, -Y / 4, -pi, pi, hole)))


def outline(depth):
    """A spline through 24 points of an ellipse with three dents."""
    angle = 2 * np.pi * np.arange(24) / 24
    r = 1 + depth * np.cos(3 * angle)
    return tables.from_points(
        [(f"{x:.6f}", f"{y:.6f}") for x, y in zip(1.5 * r * np.cos(angle), r * np.sin(angle), strict=True)]
    )


CUT = {
    "circle": (Table("circle", tuple(arcs(X, Y, S(0), 2 * pi, 12))), tables.circle),
    "ellipse": (Table("ellipse", tuple(arcs(3 * X / 2, Y, S(0), 2 * pi, 5))), tables.ellipse.at(a="3/2")),
    "ellipse in many": (Table("ellipse", tuple(arcs(3 * X / 2, Y, S(0), 2 * pi, 40))), tables.ellipse.at(a="3/2")),
    "stadium": (stadium(3), stadium(1)),
    "stadium in many": (stadium(20), stadium(1)),
    "disc": (disc(S(0), 2 * pi, 4), disc(-pi, pi, 1)),
    "disc in many": (disc(S(0), 2 * pi, 40), disc(-pi, pi, 1)),
    "egg": (egg(3, 2), egg(1, 1)),
}
WHOLE = {
    "egg and disc": egg(1, 1),
    "spline": outline(0.0),
    "dented spline": outline(0.3),
}


def landed(map, where, at, phi):
    step = map.step(at, phi, where)
    return step, np.cos(step.eta)


@pytest.mark.slow
@pytest.mark.parametrize("name", CUT)
def test_how_a_curve_is_cut_changes_no_flight(name):
    """From the same points, every fourth at a join, both forms of the curve have the same landings and angles."""
    cut, whole = (PinballMap(table, lam=0.5, kernels=False) for table in CUT[name])
    starts = phase_starts(cut, 2000, seed=1)
    where, smooth = starts.component, np.array([not last for _, last in cut.states.boundary.corners])
    in_join = (np.arange(2000) % 4 == 0) & smooth[where]
    at = np.where(in_join, np.array(cut.states.ends)[where, 1], starts.theta)
    x, y = cut.states.point(where, at)
    one, straight = landed(cut, where, at, starts.phi)
    other, _ = landed(whole, *(located(whole.states, x, y)[i] for i in (0, 1)), starts.phi)

    assert np.sum(in_join) > 10
    assert not np.any(one.code)
    assert not np.any(other.code)
    assert np.max(np.hypot(one.x - other.x, one.y - other.y) * straight) < 1e-12
    assert np.max(np.abs(one.eta - other.eta) * straight) < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CUT, *WHOLE])
@pytest.mark.parametrize("kernels", [False, True])
def test_no_flight_passes_through_a_join_at_which_it_is_aimed(name, kernels):
    """At a join the two pieces round one point differently, and no flight may slip between the two roundings."""
    map = PinballMap(CUT[name][0] if name in CUT else WHOLE[name], lam=0.5, kernels=kernels)
    starts = phase_starts(map, 4000, seed=2)
    joins = np.flatnonzero([not last for _, last in map.states.boundary.corners])
    aim = np.random.default_rng(3).choice(joins, starts.theta.size)
    x, y = map.states.point(aim, np.array(map.states.ends)[aim, 1])
    frame = map.states.frame(starts.component, starts.theta)
    far = np.hypot(x - frame.x, y - frame.y)
    phi = frame.angle(map.states.ops, (x - frame.x) / far, (y - frame.y) / far)
    seen = (far > 1e-3) & (np.abs(phi) < 1.5)
    step = map.step(starts.theta[seen], phi[seen], starts.component[seen])
    flown = np.hypot(step.x - frame.x[seen], step.y - frame.y[seen])

    assert np.sum(seen) > 1000
    assert not np.any(step.code)
    assert np.max(flown - far[seen]) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", WHOLE)
@pytest.mark.parametrize("kernels", [False, True])
def test_flights_from_a_join_are_those_from_beside_it(name, kernels):
    map, rng = PinballMap(WHOLE[name], lam=0.5, kernels=kernels), np.random.default_rng(2)
    ends = np.array(map.states.ends)
    where, side, count = rng.integers(0, len(ends), 4000), rng.integers(0, 2, 4000), 4000
    at, inwards = ends[where, side], np.where(side == 0, 1, -1)
    phi = np.arcsin(rng.uniform(-0.99, 0.99, count))
    off = np.where(np.arange(count) % 2 == 0, 0, 10 ** rng.uniform(-17, -9, count))
    one, straight = landed(map, where, at + inwards * off, phi)
    other, also = landed(map, where, at + inwards * 1e-7, phi)

    assert not np.any(one.code[other.code == 0])
    assert np.quantile(np.hypot(one.x - other.x, one.y - other.y) * np.minimum(straight, also), 0.99) < 1e-5
    start = map.states.point(where, at)
    assert np.min(np.hypot(one.x - start[0], one.y - start[1])) > 1e-3


POINTS = "\n".join(f"{1.5 * np.cos(t):.18e},{np.sin(t):.18e}" for t in 2 * np.pi * np.arange(24) / 24)


@pytest.mark.slow
def test_the_short_axis_of_an_ellipse_through_points_attracts(tmp_path, capsys):
    """Both its ends are joins of the spline; both exponents are near `log(1/2)/2 = -0.34657`, as in the ellipse."""
    path = tmp_path / "points.csv"
    path.write_text(POINTS)
    assert main(["attractor", "--data", str(path), "--lam", "0.5", "--orbits", "40"]) == 0
    said = capsys.readouterr().out
    assert "period 2" in said
    assert said.count("-0.346") == 2
    assert "stopped" not in said
