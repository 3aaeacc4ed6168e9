"""Parallelograms contain the images of all their points, with derivatives; the kernels are the second method."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from numeric import PinballMap
from symbolic import Scene
from verification.arithmetic.arrays import hull
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.chords import ChordFlights
from verification.proofs.starts.parallelograms import Parallelograms, push_forward
from verification.rigorous.boxes import Boxes

LOW, HIGH = Fraction("0.0712"), Fraction("0.0713")
Array = NDArray[np.float64]


def drawn(map: PinballImages, seed: int, count: int, size: float) -> Boxes:
    """Random boxes on all components, a tenth of them at an end of one."""
    rng = np.random.default_rng(seed)
    chart = rng.integers(0, len(map.charts), count)
    low, high = np.array([c.x for c in map.charts])[chart].T
    left = low + (high - low - size) * rng.random(count)
    left = np.where(rng.random(count) < 0.1, np.where(rng.random(count) < 0.5, low, high - size), left)
    bottom = -map.top + (2 * map.top - size / 3) * rng.random(count)
    return Boxes(chart, (left, left + size * rng.random(count)), (bottom, bottom + size / 3 * rng.random(count)))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "size"), [("cuspless", 0.02), ("cuspless", 0.001), ("egg", 0.02)])
def test_orbits_stay_in_the_images(name: str, size: float) -> None:
    """For each set the orbit of a random point lies in one of the images, bounce by bounce."""
    scene = Scene("egg", alpha="0.08", lam="0.0713") if name == "egg" else Scene("cuspless", lam="0.0713")
    images, map = PinballImages(scene, (LOW, HIGH)), PinballMap(scene, lam="0.07126")
    boxes, rng = drawn(images, 1, 800, size), np.random.default_rng(2)
    share = rng.random((2, 800))
    theta, phi = (a + (b - a) * u for (a, b), u in zip((boxes.x, boxes.y), share, strict=True))
    chart, owner, sets = boxes.chart, np.arange(800), Parallelograms.about(boxes)
    followed = 0
    for _ in range(9):
        source, sets = push_forward(images, sets)
        owner = owner[source]
        step = map.step(theta, phi, chart)
        theta, phi, chart = step.theta, step.phi, step.component
        lost = np.unique(owner[~sets.known])
        held = sets.boxes()
        near = (theta[owner] - held.x[0]) % (2 * np.pi) if images.closed else theta[owner] - held.x[0]
        inside = (held.chart == chart[owner]) & (near >= 0) & (near <= held.x[1] - held.x[0])
        inside &= (held.y[0] <= phi[owner]) & (phi[owner] <= held.y[1])
        known = np.setdiff1d(owner, lost)
        found = np.bincount(owner, inside, minlength=800)[known]
        assert np.all(found[step.code[known] == 0] >= 1)
        followed += int(known.size)
        keep = ~np.isin(owner, lost)
        sets, owner = sets[keep], owner[keep]
    assert followed > 1500


def test_derivatives_hold_those_of_the_kernels() -> None:
    """Also for flights from the arc to the wall or back."""
    images, map = PinballImages(Scene("cuspless", lam="0.0713"), (LOW, HIGH)), PinballMap("cuspless", lam="0.07126")
    boxes, rng = drawn(images, 3, 2000, 0.004), np.random.default_rng(4)
    theta, phi = (a + (b - a) * rng.random(boxes.chart.size) for a, b in (boxes.x, boxes.y))
    step, told = map.step(theta, phi, boxes.chart), map.derivative(theta, phi, boxes.chart)
    speed = [
        np.where(chart == 0, 2 * np.cos(at / 2), 1.0)
        for chart, at in ((boxes.chart, theta), (step.component, step.theta))
    ]
    factors = np.array([[speed[0] / speed[1], 1 / speed[1]], [speed[0], np.ones_like(theta)]])
    told = told * factors.transpose(2, 0, 1)
    flights, asked = ChordFlights(images, boxes), 0
    for on, chart, low, high, _ in flights.pieces(*flights.arcs()):
        arc = hull(low, high)
        entries = matrix(flights.slopes(on, chart, arc))
        here = (step.component[on] == chart) & (low <= step.theta[on]) & (step.theta[on] <= high)
        for i in (0, 1):
            for j in (0, 1):
                gap = np.abs(told[on, i, j] - entries[i][j].m)
                assert np.all(~here | (gap <= entries[i][j].r + 1e-12))
        if np.any(here):
            assert np.median(entries[0][0].r[here]) < 0.1  # of a box of 0.004: slopes vary by some hundredths there
        asked += int(np.sum(here))
    assert asked == np.sum(step.code == 0)


def test_beyond_a_join_every_flight_crosses_the_longer_component() -> None:
    """The crossing with the cardioid's formula, by Newton's method, lies in the returned arc, also past its end."""
    images = PinballImages(Scene("cuspless", lam="0.0713"), (LOW, HIGH))
    boxes, rng = drawn(images, 5, 6000, 0.03), np.random.default_rng(6)
    theta, phi = (a + (b - a) * rng.random(6000) for a, b in (boxes.x, boxes.y))
    flights, beyond = ChordFlights(images, boxes), 0
    for on, chart, low, high, smooth in flights.pieces(*flights.arcs()):
        if smooth or not on.size:
            continue
        arc, told = flights.beyond(on, chart, low, high)
        use = told & (chart == 0)
        x0, y0, v, w = leaving(boxes.chart[on], theta[on], phi[on])
        for k in np.flatnonzero(use):
            t = float(arc.m[k])
            for _ in range(30):
                r, slope = 1 + np.cos(t), -np.sin(t)
                gap = v[k] * (r * np.sin(t) - y0[k]) - w[k] * (r * np.cos(t) - x0[k])
                t -= gap / (v[k] * (slope * np.sin(t) + r * np.cos(t)) - w[k] * (slope * np.cos(t) - r * np.sin(t)))
            assert abs(t - arc.m[k]) <= arc.r[k] + 1e-12
            beyond += abs(t) > 2 * np.pi / 3
    assert beyond > 15


def leaving(chart: Array, theta: Array, phi: Array) -> tuple[Array, ...]:
    """Start `(x, y)` and unit direction of flights on the cuspless table, from its formulas."""
    c, s = np.cos(theta), np.sin(theta)
    dx, dy = np.where(chart == 0, -s - np.sin(2 * theta), 0.0), np.where(chart == 0, c + np.cos(2 * theta), -1.0)
    x, y = np.where(chart == 0, (1 + c) * c, -0.25), np.where(chart == 0, (1 + c) * s, -theta)
    tangent = np.arctan2(dy, dx)
    return x, y, np.cos(tangent + np.pi / 2 - phi), np.sin(tangent + np.pi / 2 - phi)
