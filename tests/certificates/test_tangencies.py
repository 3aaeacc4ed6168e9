"""A tangency told bounce by bounce, made by the package and read by the second reader, to a few digits."""

import json
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest

from verification.arithmetic.balls import FLOAT64, multiprecision
from verification.proofs.manifolds.known import CONTACTS, SHAPE, table
from verification.proofs.manifolds.proof import TangencyClaim
from verification.proofs.manifolds.saddle import saddle

VALUE = "0.662144273358224419482534547746"  # by a cycle that shadows the tangency: docs/crises.md
FOLDER = Path(__file__).parents[2] / "certificates"
DIGITS = 8


@pytest.fixture(scope="module")
def chain() -> dict:
    return json.loads(json.dumps(TangencyClaim(CONTACTS["boundary"], SHAPE, VALUE, DIGITS).chain()))


@pytest.fixture(scope="module")
def sides(check, chain):
    """Both manifolds as the second reader proves them, over the box of contractions; and the bits."""
    p = 16 * 2 + chain["bits"] + 96
    centre, radius = check.exact(chain["centre"][2]), check.exact(chain["radius"])
    egg = check.read_scene({"table": "egg", "shape": {"alpha": "2/25"}}, "lam", p)[0]
    lam = check.I.of(centre - radius, p).hull(check.I.of(centre + radius, p))
    read = check.beside("tangency").Manifold
    return {name: read(egg, chain[name], lam, name == "stable") for name in ("unstable", "stable")}, lam, p


def number(pair) -> float:
    return float(Fraction(int(pair[0])) * Fraction(2) ** int(pair[1]))


def test_what_is_told_of_a_tangency_is_proved_by_the_second_reader(check, chain):
    given = json.loads((FOLDER / "boundary-crisis.json").read_text()) | chain
    line = check.checked(given).splitlines()[0]

    assert line.startswith("proved: tangency of two manifolds: egg, alpha = 2/25 = 0.66214427, within 1e-8")


def test_each_side_of_a_tangency_is_a_manifold_in_its_frame(check, sides):
    made, lam, p = sides
    for side in made.values():
        assert side.reach.lo > 0
        assert len(side.states) == 4  # a round of the triangle
        for k in range(3):  # w and its slopes are small beside what is allowed on the way
            assert side.w[k].width() < 2 ** (p - 12)
    assert lam.width() < 2 ** (p - 25)


def test_the_entries_of_a_side_are_those_of_its_saddle(chain):
    """Its multipliers and its motion with the contraction by another Newton's method, in float64 and in mpmath."""
    context = mpmath.MPContext()
    context.dps = 30
    egg, lam, h = table(SHAPE).over(multiprecision(context)), context.mpf(VALUE), context.mpf(10) ** -8
    at, before, after = (saddle(CONTACTS["boundary"].unstable, egg, lam + move) for move in (0, -h, h))
    for name, factor in (("unstable", at.unstable), ("stable", 1 / at.stable)):
        given = {key: [number(pair) for pair in chain[name][key]] for key in chain[name]}
        reach, inner = given["range"]
        *firsts, bend, turn = given["bounds"]

        assert given["drift"][0] == pytest.approx(float((after.points[0] - before.points[0]) / (2 * h)), rel=1e-6)
        assert (
            min(abs(float(at.points[0]) - x - k * 2 * mpmath.pi / 3) for x in given["bounces"] for k in range(-3, 4))
            < 1e-8
        )
        assert inner == pytest.approx(reach * 17 / 16 / abs(float(factor)) ** 3, rel=1e-6)
        assert firsts == pytest.approx([2 * bend * reach**2, 2 * bend * reach, turn * reach], rel=1e-6)
        assert given["frame"][0] == given["bounces"][0]
    starts = [abs(number(pair)) for pair in chain["centre"][:2]]
    assert starts == pytest.approx(
        [number(chain[name]["range"][0]) * 8 / 9 for name in ("unstable", "stable")], rel=1e-6
    )


def test_the_orbit_of_a_tangency_obeys_the_rule_from_one_saddle_to_the_other(chain):
    egg, orbit = table(SHAPE).over(FLOAT64), [number(pair) for pair in chain["orbit"]]
    lam = number(chain["centre"][2])
    rules = [abs(egg.rule(orbit[k : k + 3], lam)) for k in range(len(orbit) - 2)]

    assert max(rules) < 1e-6
    assert abs(lam - float(VALUE)) < 1e-12
    assert 0 < chain["meets"] < len(orbit) - 1
    for name, end in (("unstable", orbit[0]), ("stable", orbit[-1])):
        assert min(abs(end - number(pair)) for pair in chain[name]["bounces"]) < 1e-3
    far = [
        min(abs(orbit[chain["meets"]] - number(pair)) for pair in chain[name]["bounces"])
        for name in ("unstable", "stable")
    ]
    assert min(far) > 0.01
