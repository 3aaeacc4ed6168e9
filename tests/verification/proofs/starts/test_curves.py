"""Images of unstable curves: against difference quotients, boxes against their points, and refused data."""

from fractions import Fraction

import numpy as np
import pytest

from symbolic import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.curves import PinballCurves
from verification.rigorous.boxes import Boxes

STARTS = (1, 0.1, 0.05), (1, -0.4, -0.2), (0, 0.3, 0.05), (0, 1.3, -0.3), (0, -1.6, 0.4)  # component, theta, phi


@pytest.mark.parametrize(("chart", "start", "exit"), STARTS)
def test_density_along_curves_is_what_the_map_makes_of_it(chart, start, exit):
    """By difference quotients along a curve with a slope and a bend; the stretch may be negative."""
    map = PinballImages(Scene("cuspless", lam="0.12"))
    m, w, step = 0.15, 0.3, 1e-4
    theta = start + step * np.arange(-2, 3)
    phi = exit + m * (theta - start) + w * (theta - start) ** 2 / 2
    end = map.map.step(theta, phi, np.full(5, chart))
    rate = np.gradient(end.theta, step)[1:4]
    slopes = np.gradient(end.phi, step)[1:4] / rate
    point = Boxes(np.array([chart]), (np.array([start]),) * 2, (np.array([exit]),) * 2)
    found = PinballCurves(map).landed(point, BallArray(np.array([m]), np.array([0.0])))
    assert found.chart.tolist() == [end.component[2]]
    assert found.theta.m[0] == pytest.approx(end.theta[2], abs=1e-10)
    assert found.phi.m[0] == pytest.approx(end.phi[2], abs=1e-10)
    assert found.stretch.m[0] == pytest.approx(rate[1], rel=1e-6)
    assert found.slope.m[0] == pytest.approx(slopes[1], rel=1e-6, abs=1e-7)
    change = np.log(rate[2] / rate[0]) / (2 * step)
    assert found.k0.m[0] + found.k1.m[0] * w == pytest.approx(change, rel=1e-5, abs=1e-5)
    bend = (slopes[2] - slopes[0]) / (2 * step) / rate[1]
    assert found.bend.m[0] + found.by_bend.m[0] * w == pytest.approx(bend, rel=1e-5, abs=1e-5)


def test_curves_in_a_box_hold_those_at_its_points():
    """Also for all slopes of a range; and for boxes that land on one component, given as an argument."""
    curves, rng, size = PinballCurves(PinballImages(Scene("cuspless", lam="0.12"))), np.random.default_rng(4), 2e-3
    chart = np.repeat([0, 1], 150)
    x = np.where(chart == 0, rng.uniform(-2.0, 2.0, 300), rng.uniform(-1.2, 1.2, 300))
    y = rng.uniform(-0.15, 0.15, 300)
    slopes = BallArray(rng.uniform(-0.2, 0.2, 300), np.full(300, 0.01))
    boxes = Boxes(chart, (x, x + size), (y, y + size))
    whole = curves.landed(boxes, slopes)
    seen = 0
    for share in rng.random((6, 3, 300)):
        at = x + size * share[0], y + size * share[1]
        m = BallArray(slopes.m + (2 * share[2] - 1) * 0.01, np.zeros(300))
        points = curves.landed(Boxes(chart, (at[0], at[0]), (at[1], at[1])), m)
        one = (np.bincount(points.source, minlength=300) == 1)[points.source]
        place = np.full((300, 2), -1)
        place[points.source[one], points.chart[one]] = np.flatnonzero(one)
        told = place[whole.source, whole.chart]
        assert np.all(whole.smooth == (np.bincount(whole.source, minlength=300)[whole.source] == 1) & whole.smooth)
        for box, point in zip(whole[3:], points[3:], strict=True):
            known = (told >= 0) & np.isfinite(box.r)
            off = np.abs(box.m - point.m[told])
            assert np.all(~known | (off <= box.r + point.r[told] + 1e-12 * (1 + np.abs(box.m))))
            seen += int(np.sum(known))
    assert seen > 6 * 8 * 200


def test_tables_and_laws_whose_curves_are_not_known_are_refused():
    with pytest.raises(ValueError, match="at no constant rate"):
        PinballCurves(PinballImages(Scene("egg", alpha="0.08", lam="1/2")))
    with pytest.raises(ValueError, match="law"):
        PinballCurves(PinballImages(Scene("circle", lam="1/2", law="-lam*eta/2")))


def test_without_contraction_nothing_is_said_by_area():
    with pytest.raises(ValueError, match="0 < lam"):
        PinballCurves(PinballImages(Scene("cuspless"), (Fraction(0), Fraction("0.1"))))
