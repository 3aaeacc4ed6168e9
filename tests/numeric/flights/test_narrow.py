"""First hits on boundaries with features narrower than a grid of thousands of points resolves, by a second search.

The second search knows where the features are: it brackets every zero of `v x (z(theta) - z0)` between points that are
spread evenly and clustered at the features, and bisects in mpmath.
"""

import mpmath
import numpy as np
import pytest
from sympy import Rational, cos, exp, pi, sin, tanh

from numeric import PinballMap
from numeric.flights.family import Boundary
from numeric.flights.general import cells
from symbolic import tables
from symbolic.tables.table import theta

MP = mpmath.MPContext()
MP.dps = 30
CROWD = np.concatenate([[0], np.geomspace(1e-9, 0.05, 300)])


def dent(m, at):
    r = 1 - 1 / (4 * (1 + 2 * 10**10 * m.sin((at - 1) / 2) ** 2))
    return r * m.cos(at), r * m.sin(at)


def step(m, at):
    return 2 * m.cos(at), m.sin(at) + m.tanh(100000 * m.cos(at)) / 3


def spike(m, at):
    r = 1 + m.exp(-2 * 10**6 * m.sin(at / 2) ** 2) / 4
    return r * m.cos(at), r * m.sin(at)


NARROW = {  # the last number: as far as the rounding of the table's own formula moves a point
    "dent": (tables.polar(1 - 1 / (4 * (1 + 10**10 * (1 - cos(theta - 1)))), name="dent"), dent, [1], 1e-6),
    "step": (
        tables.parametric(2 * cos(theta), sin(theta) + tanh(100000 * cos(theta)) / 3, name="step"),
        step,
        [np.pi / 2, -np.pi / 2],
        1e-9,
    ),
    "spike": (tables.polar(1 + exp(-(10**6) * (1 - cos(theta))) / 4, name="spike"), spike, [0], 1e-9),
}


def first_hit(curve, features, at, phi):
    """The parameter of the first hit, and the cosine of its angle of incidence."""
    z0, v = ray(curve, at, phi)
    grid = np.concatenate([np.linspace(-np.pi, np.pi, 4001), *(f + s * CROWD for f in features for s in (1, -1))])
    grid = np.unique(np.append(grid[np.abs(grid - at) > 1e-6], [at - 1e-6, at + 1e-6]))
    x, y = curve(np, grid)
    side = v[0] * (y - z0[1]) - v[1] * (x - z0[0])
    found = []
    exact0, vx, vy = curve(MP, MP.mpf(at)), MP.mpf(v[0]), MP.mpf(v[1])

    def height(where):
        px, py = curve(MP, where)
        return vx * (py - exact0[1]) - vy * (px - exact0[0])

    for i in np.flatnonzero(side[:-1] * side[1:] < 0):
        low, high = grid[i : i + 2]
        if not low < at < high:
            where = MP.findroot(height, (MP.mpf(low), MP.mpf(high)), solver="illinois", tol=1e-40, maxsteps=200)
            px, py = curve(MP, where)
            t = vx * (px - exact0[0]) + vy * (py - exact0[1])
            if t > 0:
                found.append((t, float(where), [float(px), float(py)]))
    return min(found)


def ray(curve, at, phi):
    """The starting point, and the direction at an angle from the inward normal."""
    dx, dy = np.array(derivative(curve, at)) / np.hypot(*derivative(curve, at))
    return curve(np, at), [np.sin(phi) * dx - np.cos(phi) * dy, np.sin(phi) * dy + np.cos(phi) * dx]


def derivative(curve, at):
    x, y = (MP.diff(lambda where, i=i: curve(MP, where)[i], MP.mpf(at)) for i in (0, 1))
    return float(x), float(y)


@pytest.mark.slow
@pytest.mark.parametrize("name", NARROW)
def test_a_narrow_feature_is_hit(name):
    table, curve, features, rounding = NARROW[name]
    map = PinballMap(table, lam=1)
    rng = np.random.default_rng(8)
    start = np.array([at for at in rng.uniform(-3, 3, 40) if min(abs(at - f) for f in features) > 0.1])[:20]
    aim = np.array(features)[rng.integers(0, len(features), start.size)] + rng.choice([-1, 1], start.size) * (
        10 ** rng.uniform(-7, -4, start.size)
    )
    place = np.zeros(start.size, dtype=int)
    frame = map.states.frame(place, start)
    x, y = curve(np, aim)
    phi = frame.angle(map.states.ops, *(d / np.hypot(x - frame.x, y - frame.y) for d in (x - frame.x, y - frame.y)))
    into = np.abs(phi) < 1.5
    landed = map.step(start[into], phi[into])
    for i, (at, angle) in enumerate(zip(start[into], phi[into], strict=True)):
        _, where, point = first_hit(curve, features, at, angle)
        if landed.code[i] == 0:
            x, y = curve(np, landed.theta[i])
            assert np.hypot(x - point[0], y - point[1]) * np.cos(landed.eta[i]) < rounding, (
                at,
                angle,
                where,
                landed.theta[i],
            )
    assert np.count_nonzero(landed.code == 0) > 10


def ripple(m, at):
    r = 1 + m.cos(4096 * at) / 10**5
    return r * m.cos(at), r * m.sin(at)


def test_a_ripple_of_thousands_of_waves_is_met_where_a_scan_meets_it():
    """Rays across the table and along the wall; the scan has 64 points per wave, and more near the start."""
    map = PinballMap(tables.polar(1 + cos(4096 * theta) / 10**5, name="ripple"), lam=1)
    rng = np.random.default_rng(5)
    start, phi = rng.uniform(-3, 3, 30), (np.pi / 2 - 10 ** rng.uniform(-4, 0, 30)) * rng.choice([-1, 1], 30)
    landed = map.step(start, phi)
    far = np.union1d(np.geomspace(1e-8, 1e-3, 4000), np.linspace(1e-3, 2.1, 90_000))
    for i, (at, angle) in enumerate(zip(start, phi, strict=True)):
        (x0, y0), (vx, vy) = ray(ripple, at, angle)

        def inside(m, s, x0=x0, y0=y0, vx=vx, vy=vy):
            x, y = x0 + s * vx, y0 + s * vy
            return 1 + m.cos(4096 * (m.arctan2 if m is np else m.atan2)(y, x)) / 10**5 - m.sqrt(x * x + y * y)

        first = int(np.argmax(inside(np, far) < 0))
        t = MP.findroot(
            lambda s: inside(MP, s), [MP.mpf(s) for s in far[first - 1 : first + 1]], solver="illinois", tol=1e-24
        )
        miss = np.hypot(landed.x[i] - x0 - float(t) * vx, landed.y[i] - y0 - float(t) * vy)
        assert miss * np.cos(landed.eta[i]) < 1e-12, (at, angle)  # the wall turns 4096 times as fast as its angle
        assert landed.code[i] == 0


@pytest.mark.slow
@pytest.mark.parametrize("lam", [0, Rational(1, 2), 1])
def test_a_circle_whose_parameter_stands_still_at_a_point(lam):
    """The circle with angle `theta - sin(theta)`, whose speed is 0 at `theta = 0`; half of the flights start there."""
    angle = theta - sin(theta)
    halves = [tables.arc(f"slow {k}", cos(angle), sin(angle), (k - 1) * pi, k * pi) for k in (0, 1)]
    slow, circle = PinballMap(tables.piecewise(*halves), lam=lam), PinballMap("circle", lam=lam)
    rng = np.random.default_rng(1)
    start, phi = rng.uniform(-3.1, 3.1, 100), rng.uniform(-1.5, 1.5, 100)
    goal = 10 ** rng.uniform(-9, -1, 50) * rng.choice([-1, 1], 50)
    turn = goal - (start - np.sin(start))[:50]
    phi[:50] = (turn - np.pi * np.sign(turn)) / 2
    one, other = slow.step(start, phi, (start > 0).astype(int)), circle.step(start - np.sin(start), phi)

    assert not one.code.any()
    assert np.max(np.hypot(one.x - other.x, one.y - other.y)) < 1e-11
    assert np.max(np.abs(one.phi - other.phi)) < 1e-11
    with pytest.raises(ValueError, match="slow 1 moves by less than rounding; start elsewhere"):
        slow.step(0.0, 0.3, 1)


def test_a_parameter_that_stands_still_inside_of_a_component_is_refused():
    angle = theta - sin(theta)
    with pytest.raises(ValueError, match=r"size, stops, turns back or has no tangent near slow at theta = -?0"):
        tables.parametric(cos(angle), sin(angle), name="slow")


@pytest.mark.slow
@pytest.mark.parametrize(
    "radius",
    [1 + cos(1000 * theta) / 100, 1 + cos(10**6 * theta) / 10**13, 1 + sin(1000 * theta + sin(theta)) / 1000],
)
def test_what_is_not_proved_is_refused(radius):
    """Countless waves: bounding the turning of the boundary takes more intervals or pieces than are allowed."""
    with pytest.raises(ValueError, match=r"waves: .*; (accepted: a boundary with wider features|at most 128 times)"):
        PinballMap(tables.polar(radius, name="waves"))


@pytest.mark.parametrize("name", NARROW)
def test_cells_turn_as_they_are_said_to(name):
    """The bound for each cell's turning holds at points clustered at the features."""
    table, _, features, _ = NARROW[name]
    boundary = Boundary(PinballMap(table, kernels=False).ir, [])
    edges, ways = cells(boundary, 0)
    at = np.concatenate([f + s * np.geomspace(1e-8, 1, 50000) for f in features for s in (1, -1)])
    at = at[(edges[0] < at) & (at < edges[-1])]
    _, _, dx, dy, ax, ay = boundary.curve_on(0, at)
    way = ways[np.searchsorted(edges, at) - 1]
    turning, rounding = dx * ay - dy * ax, 2.0**-40 * (np.abs(dx * ay) + np.abs(dy * ax))

    assert np.all(np.diff(edges) > 0)
    assert np.all((turning * way > -rounding)[np.abs(way) == 1])


def test_pieces_that_begin_at_rest():
    """Two parabolas, also with `2*u**2 - 1` as their parameter: then the speed is 0 where each piece begins."""

    def lens(u, low, high, name):
        return tables.piecewise(
            tables.arc("lower", u, (u**2 - 1) / 2, low, high),
            tables.arc("upper", -u, (1 - u**2) / 2, low, high),
            name=name,
        )

    one = PinballMap(lens(theta, -1, 1, "even"), lam=Rational(1, 2), kernels=False)
    other = PinballMap(lens(2 * theta**2 - 1, 0, 1, "at rest"), lam=Rational(1, 2), kernels=False)
    rng = np.random.default_rng(5)
    where, u, phi = rng.integers(0, 2, 300), rng.uniform(0.02, 0.99, 300), rng.uniform(-1.4, 1.4, 300)
    a, b = one.step(2 * u**2 - 1, phi, where), other.step(u, phi, where)
    both = (a.code == 0) & (b.code == 0)

    assert np.count_nonzero(both) > 290
    assert np.array_equal(a.component[both], b.component[both])
    assert np.max(np.hypot(a.x - b.x, a.y - b.y)[both]) < 1e-12
    assert np.max(np.abs(a.phi - b.phi)[both]) < 1e-11
