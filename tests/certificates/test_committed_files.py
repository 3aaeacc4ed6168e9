"""The committed certificates that take a moment: proved as they are, and not with a displaced box."""

from fractions import Fraction
from itertools import product

import pytest
from committed import document, moved

SHORT = (
    "alpha-hat", "alpha-tilde", "cardioid", "egg-period-3", "egg-triangle", "five-waves", "free-parameter", "lambda-c",
    "lambda-star", "law-in-all-words", "law-parameter", "marked-point", "minor-axis", "moved-waves", "own-mirror",
    "phi-star", "radius-in-words", "saddle-node", "scatterer", "spline", "symmetry-breaking",
)  # fmt: skip
LONG = "cardioid-period-9", "doubling-3"  # by the equations for long cycles


@pytest.mark.slow
@pytest.mark.parametrize("name", [*SHORT, *LONG])
def test_what_a_committed_certificate_states_is_proved_and_told_with_its_digits(check, name):
    given = document(name)
    first, statement, *_ = check.checked(given).split("\n")
    what, value = first.removeprefix("proved: ").split(", within 1e-")[0].rsplit(" = " if given["free"] else " at ", 1)
    place = 0 if given["free"] == "phi" else -1

    assert what.removesuffix(", last bounce") == given["name"]
    assert statement.strip() == given["statement"]
    assert given["free"] == "phi" or abs(Fraction(value) - check.exact(given["centre"][place])) < 2 * Fraction(
        1, 10 ** given["digits"]
    ) + check.exact(given["radius"])


@pytest.mark.slow
@pytest.mark.parametrize("name", SHORT)
def test_a_box_beside_the_solution_is_not_proved(check, name):
    """The box is moved by four of its radii, in each coordinate in turn, both ways."""
    given = document(name)
    for place, way in product(range(len(given["centre"])), (4, -4)):
        with pytest.raises((check.Unproved, check.Wrong)):
            check.checked(moved(given, place, way))
