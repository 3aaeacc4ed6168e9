"""A search excludes no point that its region contains, whatever the digits of its boxes."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verification.rigorous.exclusion import Cuboids, exclude


def line(middle, half):
    """An interval as a region of one dimension."""
    return Cuboids(np.array([[middle]]), np.array([[half]]))


def without(point):
    """Which boxes do not contain a point, in exact numbers."""
    return lambda boxes: np.array(
        [abs(Fraction(m) - point) > Fraction(h) for m, h in zip(boxes.middle[:, 0], boxes.half[:, 0], strict=True)]
    )


@given(st.floats(-1, 1), st.floats(1e-3, 1), st.fractions(-1, 1))
def test_a_point_of_the_region_is_in_a_box(middle, half, share):
    for point in (Fraction(middle), Fraction(middle) + share * Fraction(half)):
        assert exclude(line(middle, half), without(point), 200, 1e-6).proved is None


@pytest.mark.parametrize("box", [(0.0, -1.0), (0.0, np.nan), (np.inf, 1.0), (0.0, np.inf)])
def test_a_box_without_both_ends_is_refused(box):
    with pytest.raises(ValueError, match="finite"):
        exclude(line(*box), lambda boxes: np.ones(boxes.size, dtype=bool), 10, 1e-3)
