"""Each committed certificate that takes a moment: proved as it stands, and not with a box beside its solution."""

import json
from fractions import Fraction
from itertools import product
from pathlib import Path
from types import SimpleNamespace

import pytest

FOLDER = Path(__file__).parents[2] / "certificates"
SHORT = (
    "alpha-hat", "alpha-tilde", "cardioid", "egg-period-3", "egg-triangle", "five-waves", "free-parameter", "lambda-c",
    "lambda-star", "law-in-all-words", "law-parameter", "marked-point", "minor-axis", "moved-waves", "own-mirror",
    "phi-star", "radius-in-words", "saddle-node", "scatterer", "spline", "symmetry-breaking",
)  # fmt: skip
LONG = "cardioid-period-9", "doubling-3"  # by the equations for long cycles


def document(name):
    return json.loads((FOLDER / f"{name}.json").read_text())


@pytest.mark.parametrize("name", [*SHORT, *LONG])
def test_what_a_committed_certificate_states_is_proved_and_told_with_its_digits(check, name):
    given = document(name)
    first, statement = check.checked(given).split("\n")
    what, value = first.removeprefix("proved: ").split(", within 1e-")[0].rsplit(" = " if given["free"] else " at ", 1)
    place = 0 if given["free"] == "phi" else -1

    assert what.removesuffix(", last bounce") == given["name"]
    assert statement.strip() == given["statement"]
    assert given["free"] == "phi" or abs(Fraction(value) - check.exact(given["centre"][place])) < 2 * Fraction(
        1, 10 ** given["digits"]
    ) + check.exact(given["radius"])


@pytest.mark.parametrize("name", SHORT)
def test_a_box_beside_the_solution_is_not_proved(check, name):
    """Moved by four of its radii, in each coordinate in turn, either way."""
    given = document(name)
    for place, way in product(range(len(given["centre"])), (4, -4)):
        exponent = given["radius"][1]
        moved = check.exact(given["centre"][place]) + way * check.exact(given["radius"])
        beside = [*given["centre"]]
        beside[place] = [str(int(moved * 2 ** (4 - int(exponent)))), str(int(exponent) - 4)]
        with pytest.raises((check.Unproved, check.Wrong)):
            check.checked(given | {"centre": beside})


@pytest.mark.parametrize("k", range(8))
@pytest.mark.parametrize("name", ["minor-axis", "lambda-c", "alpha-tilde", "lambda-star", "spline"])
def test_a_certificate_in_which_something_is_changed_is_refused_or_true(check, mutants, name, k):
    original = document(name)
    assert mutants.judged(name, k, original, check.checked(original).splitlines()[0]) != "FALSE"


ROUND = (3, 1), (0, Fraction(1, 2)), (1, 1)  # the derivative of a round, and the slopes by both of where its corner is


def cornered(check, motion=2, arc=3, straight=-1, fall=-5, shift=4, round=ROUND, theta1="1/4"):
    """The checks of a corner orbit whose slopes by the exit angle and by lam are these; the chords that were free."""
    p, sides, asked = 60, [], []
    number = lambda x: check.I.of(Fraction(x), p)  # noqa: E731
    jet = lambda *slopes: check.Jet([number(0), *map(number, slopes[::-1])], 1)  # noqa: E731  # by start, angle and lam

    def orbit(launch, at, way, order):
        here = launch(*(check.Jet.of(x, order, k) for k, x in enumerate(at)))
        assert check.value(here[2]["lam"]).real() == pytest.approx(1 / 9)
        if len(way) == 5:
            assert check.value(here[0]).real() == 2  # from the upper corner, on the arc
            sides.append(way[2][0])
            second = jet(0, motion if way[2][0] == 0 else 7, shift)
            last = jet(0, arc, 100) if way[2][0] == 0 else jet(0, straight, fall + Fraction(straight * shift, 7))
            return [(jet(0, 0, 0),) * 2] * 2 + [(second,), (jet(0, 0, 0),), (last,)]
        assert [x.real() for _, x in way[::2]] == [
            pytest.approx(check.I.of(Fraction(theta1), p).real() * s) for s in (1, -1)
        ]
        (a, b), (c, d), (e, f) = round
        return [None, (jet(e, f, 0), None), (jet(-a, -b, 0), jet(-c, -d, 0))]

    table = SimpleNamespace(p=p, orbit=orbit)
    table.ends = lambda component, p: (number(-2 - component), number(2 + component))
    table.free = lambda here, there, names: asked.extend(
        tuple((part, float(x.real())) for part, x in chord) for chord in product(here, there)
    )
    check.beside("corner").cornered(
        SimpleNamespace(table=table, p=p), [number(0), number(0), number("1/9")], number(theta1)
    )
    return sides, asked


def test_the_chords_of_a_corner_orbit_are_free_on_either_side_of_both_corners(check):
    """From the upper corner to the bounce between, and on to the lower one; the mirror does the way back."""
    sides, asked = cornered(check)

    assert sides == [0, 1]
    upper, lower, between = [(0, 2.0), (1, -3.0)], [(0, -2.0), (1, 3.0)], (0, 0.25)
    assert sorted(asked) == sorted([*((x, between) for x in upper), *((between, x) for x in lower)])


@pytest.mark.parametrize(
    ("changed", "item"),
    [
        ({}, None),
        ({"motion": -2, "arc": -3, "straight": 1}, None),  # the other way round
        ({"arc": -3}, "s4_minimum_at_a_kink"),
        ({"straight": 1}, "s4_minimum_at_a_kink"),
        ({"motion": -2}, "s4_minimum_at_a_kink"),
        ({"motion": -2, "arc": -3}, "s4_minimum_at_a_kink"),
        ({"motion": -2, "straight": 1}, "s4_minimum_at_a_kink"),
        ({"arc": 0}, "s4_minimum_at_a_kink"),
        ({"straight": 0}, "s4_minimum_at_a_kink"),
        ({"fall": 5}, "s4_dips_below"),
        ({"fall": 0}, "s4_dips_below"),
        ({"round": ((1, 0), (0, 1), (1, 1))}, "unstable"),  # trace - determinant is 1
        ({"round": ((-2, 0), (0, -3), (1, 1))}, "unstable"),  # trace below 0
        ({"round": ((-3, 1), (0, 1), (1, 1))}, "unstable"),  # determinant below 0
        ({"round": ((3, 1), (0, 2), (1, 1))}, "unstable"),  # trace - determinant is -1
        ({"round": ((3, 1), (0, "1/2"), (1, 1))}, None),  # 7/2 - 3/2 = 2
        ({"round": ((3, 0), (0, "1/2"), (1, 0))}, "unstable"),  # the first eigenvector runs along the preimage
        ({"round": ((3, 0), (0, "1/2"), (0, 1))}, "unstable"),
        ({"round": ((3, 1), (0, "1/2"), (5, -2))}, None),
        ({"theta1": "-1/4"}, "minimal_period"),
        ({"theta1": "0"}, "minimal_period"),
        ({"theta1": "2"}, "minimal_period"),
    ],
)
def test_each_item_of_a_corner_orbit_is_a_sign_of_its_own(check, changed, item):
    """Multipliers outside the unit circle on one side: determinant above 0, and trace above 1 + determinant."""
    if "round" in changed:
        changed = {"round": tuple(tuple(map(Fraction, row)) for row in changed["round"])}
    if item is None:
        cornered(check, **changed)
    else:
        with pytest.raises(check.Unproved, match=item):
            cornered(check, **changed)


def test_an_orbit_through_both_corners_is_called_by_the_place_of_its_bounce(check):
    at = lambda x: check.I.of(Fraction(x), 60)  # noqa: E731
    called = check.beside("corner").called
    assert [called(free, at("0.2545")) for free in ("lam", "phi")] == ["lambda-star", "phi-star"]
    assert {called("lam", at(x)) for x in ("0.2525", "0.2565", "0.9")} == {"an orbit through both corners"}
