"""Manifolds: series solve the map's rule, images stay on the manifold, tangencies agree with published ones."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Rational

from symbolic import tables
from verification.arithmetic.balls import FLOAT64
from verification.cycles.cascade import cascade
from verification.cycles.recurrence import Closure
from verification.proofs.manifolds.grow import branch, far
from verification.proofs.manifolds.known import (
    CONTACTS,
    SHAPE,
    TRIANGLE,
    contact,
    crisis,
    homoclinic_exponent,
    shadow,
    table,
)
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.saddle import SaddleCycle, local, saddle
from verification.proofs.manifolds.tangency import Contact, Gap, tangency

INNER, OUTER = SaddleCycle("inner fixed point", (0.63,)), SaddleCycle("outer fixed point", (-1.13,))
EGG, MIRRORED = table(SHAPE), CONTACTS["merging"].unstable
CASES = [
    (Henon(Rational(3, 10)), INNER, 1.4),
    (Henon(Rational(3, 10)), OUTER, 1.4),
    (EGG, TRIANGLE, 0.66),
    (EGG, MIRRORED, 0.4434),
    (EGG, SaddleCycle("diameter", (0.0, 3.1416)), 0.5),
    (EGG, SaddleCycle("parallel tangents", (0.3326,), Closure(-1, (2, 3))), 0.4434),
]


@pytest.mark.parametrize("unstable", [True, False])
@pytest.mark.parametrize(("map", "orbit", "parameter"), CASES, ids=lambda case: getattr(case, "name", None))
def test_a_series_leaves_a_residual_of_rounding_size(map, orbit, parameter, unstable):
    made = local(saddle(orbit, map.over(FLOAT64), parameter), unstable)

    assert made.residual < 2e-14


@pytest.mark.parametrize(("map", "orbit", "parameter"), CASES, ids=lambda case: getattr(case, "name", None))
def test_multipliers_are_those_of_the_derivative_matrix(map, orbit, parameter):
    """Egg: `PinballMap.derivative` along the cycle; Henon map: the matrix by hand."""
    found = saddle(orbit, map.over(FLOAT64), parameter)
    if isinstance(map, Pinball):
        from numeric import PinballMap

        bounces = PinballMap("egg", lam=parameter, alpha=SHAPE)
        product = np.eye(2)
        ring = found.around()
        for here, following in pairwise(ring[1:]):
            phi = found.map.angle(here, following)[0]
            product = bounces.derivative(math.remainder(here, 2 * math.pi), phi) @ product
        product *= orbit.closure.turn
    else:
        product = np.array([[-2 * parameter * found.points[0], 1], [0.3, 0]])
    expected = sorted(np.linalg.eigvals(product).real, key=abs)

    assert found.stable == pytest.approx(expected[0], rel=1e-8, abs=1e-12)
    assert found.unstable == pytest.approx(expected[1], rel=1e-10)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.9, 0.9), st.sampled_from(CASES), st.booleans())
def test_the_map_acts_on_the_parameter_as_multiplication(z, case, unstable):
    map, orbit, parameter = case
    made = local(saddle(orbit, map.over(FLOAT64), parameter), unstable)
    there = np.array([z])  # within the disc where the series holds, as is the point one round nearer to the saddle

    near, image = far(made, there, 1), made.points(there)

    assert np.allclose(np.cos(near), np.cos(image), atol=3e-12)
    assert np.allclose(np.sin(near), np.sin(image), atol=3e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "digits"), [("merging", 11), ("boundary", 15), ("symmetry-restoring", 9)])
def test_two_methods_and_more_digits_agree_on_a_crisis(kind, digits):
    few, many = crisis(kind, SHAPE, 6), crisis(kind, SHAPE, digits)

    assert few.agrees
    assert many.agrees
    assert abs(few.parameter - many.parameter) <= few.error
    assert many.error < few.error / 100


def test_folds_of_shadowing_cycles_approach_a_tangency():
    """Three more rounds of the triangle bring the fold nearer by the cube of its unstable multiplier."""
    from verification.cycles.newton import floats

    where = contact("boundary", SHAPE)
    at = tangency(where, EGG, 8)
    gaps = []
    for rounds in (6, 8, 10):
        cycle = shadow(where, EGG, float(at.parameter), rounds)
        gaps.append(float(floats(cycle.problem, cycle.start)[-1] - at.parameter))

    assert gaps[0] / gaps[1] == pytest.approx(at.multipliers[1] ** 3, rel=0.05)
    assert gaps[1] / gaps[2] == pytest.approx(at.multipliers[1] ** 3, rel=0.01)


def test_bands_merge_by_feigenbaums_ratio():
    """The limit is from the certified doublings, whose only common ground with contacts is the chord."""
    members = cascade(SHAPE)
    values = [next(members).lam for _ in range(8)]
    end = values[-1] + (values[-1] - values[-2]) / (4.669201609 - 1)
    joined = [CONTACTS[f"band-merging-{period}"].parameter - end for period in (4, 8, 16)]
    ratios = [far / near for far, near in pairwise(joined)]

    assert ratios == pytest.approx([4.669201609] * 2, rel=3e-3)
    assert abs(ratios[1] / 4.669201609 - 1) < abs(ratios[0] / 4.669201609 - 1)


def test_manifolds_cross_beyond_the_boundary_crisis():
    where = contact("boundary", SHAPE)
    below, above = (
        Gap(where, EGG.over(FLOAT64), where.parameter + step, 24, 1e-16).extremum()[1].c for step in (-1e-5, 1e-5)
    )

    assert below[0] > 0 > above[0]
    assert below[2] > 0


def test_the_exponent_is_that_of_grebogi_ott_and_yorke():
    assert homoclinic_exponent(0.01, 3) == pytest.approx(math.log(0.01) / math.log((0.01 * 3) ** 2))


def test_bad_requests_are_one_sentence():
    with pytest.raises(ValueError, match="accepted: merging, boundary"):
        contact("other", SHAPE)
    with pytest.raises(ValueError, match="accepted: up to 500"):
        crisis("merging", SHAPE, 501)
    with pytest.raises(ValueError, match="side 1 or -1"):
        branch(local(saddle(TRIANGLE, EGG.over(FLOAT64), 0.66), True), 2, 1.0)
    with pytest.raises(ValueError, match="heteroclinic"):
        shadow(Contact(INNER, OUTER, 1, 1, -0.627005, 2.211054, 1.4269), Pinball(tables.circle), 1.4, 4)
    with pytest.raises(ValueError, match="no saddle"):
        saddle(SaddleCycle("triangle of the flat points", (-0.905,), Closure(1, (1, 3))), EGG.over(FLOAT64), 0.66)
