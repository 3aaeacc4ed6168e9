"""A tangency told bounce by bounce, made by the package and read by the second reader, to a few digits."""

import json
import re
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest

from symbolic.tables import egg
from verification.arithmetic.balls import FLOAT64, multiprecision
from verification.proofs.manifolds.claim import TangencyClaim
from verification.proofs.manifolds.known import CONTACTS, SHAPE, table
from verification.proofs.manifolds.saddle import saddle

VALUE = "0.662144273358224419482534547746"  # by a cycle that shadows the tangency: docs/crises.md
FOLDER = Path(__file__).parents[2] / "certificates"
DIGITS = 8


@pytest.fixture(scope="module")
def chain() -> dict:
    return json.loads(json.dumps(TangencyClaim(CONTACTS["boundary"], egg(3).at(alpha=SHAPE), VALUE, DIGITS).chain()))


@pytest.fixture(scope="module")
def sides(check, chain):
    """Both manifolds as the second reader proves them, over the box of contractions; and the bits."""
    p = 16 * 2 + chain["bits"] + 96
    centre, radius = check.exact(chain["centre"][2]), check.exact(chain["radius"])
    oval = check.read_scene({"table": "egg", "shape": {"alpha": "2/25"}}, "lam", p)[0]
    lam = check.I.of(centre - radius, p).hull(check.I.of(centre + radius, p))
    read = check.beside("tangency").Manifold
    return {name: read(oval, chain[name], lam, name == "stable") for name in ("unstable", "stable")}, lam, p


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
    map, lam, h = table(SHAPE).over(multiprecision(context)), context.mpf(VALUE), context.mpf(10) ** -8
    at, before, after = (saddle(CONTACTS["boundary"].unstable, map, lam + move) for move in (0, -h, h))
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
    map, orbit = table(SHAPE).over(FLOAT64), [number(pair) for pair in chain["orbit"]]
    lam = number(chain["centre"][2])
    rules = [abs(map.rule(orbit[k : k + 3], lam)) for k in range(len(orbit) - 2)]

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


def read(check, given: dict) -> str:
    """The verdict on a document whose statement and name are made those that its other entries ask for."""
    for _ in range(3):
        try:
            return check.checked(given).splitlines()[0]
        except (check.Wrong, check.Unproved) as why:
            asked = re.fullmatch(r"the (statement|name) must be:? '(.*)'", str(why))
            if asked is None:
                return f"{type(why).__name__}: {why}"
            given = given | {asked[1]: asked[2]}
    raise AssertionError(given["name"])


FLOWER = {"polar": "cos(5*theta)/40 + 1"}


CURVE = {"parametric": ["(1 + cos(5*theta)/40)*cos(theta)", "(1 + cos(5*theta)/40)*sin(theta)"]}
MARK = {"name": "m", "component": 0, "theta": "1/2"}


@pytest.mark.parametrize("scene", [FLOWER, CURVE], ids=["radius", "curve"])
def test_a_tangency_of_the_flower_is_proved_by_its_radius_and_as_a_curve(check, scene):
    """The value is that of `flower.json`, which the report enclosed by series."""
    given = json.loads((FOLDER / "flower-tangency-2.json").read_text())

    assert re.fullmatch(r"proved: .* = 0\.99848542091065429028\d*, within 1e-24", read(check, given | {"scene": scene}))


def test_a_tangency_under_another_law_is_proved_however_the_law_is_written(check):
    """The value is a fold's of a cycle that shadows it, in tests/verification/proofs/test_manifolds_proof.py."""
    given = json.loads((FOLDER / "tangency-under-a-law.json").read_text())
    scene = given["scene"] | {"law": "-lam*eta*(1 - eta**2/40)"}

    assert re.fullmatch(r"proved: .* = 0\.664811968482\d*, within 1e-24", read(check, given | {"scene": scene}))


@pytest.mark.parametrize(
    ("scene", "answer"),
    [
        ({"polar": "cos(5*theta)/41 + 1"}, "Unproved: "),
        ({"polar": "cos(5*theta)/40 - 1"}, "Wrong: scene: the radius may not be positive"),
        ({"polar": "1 + cos(theta/2)/40"}, "Wrong: scene: a tangency is one of a single closed curve"),
        (FLOWER | {"undefined": [MARK]}, "Wrong: scene: a tangency is one of a single closed curve"),
        (FLOWER | {"law": "-lam*eta*(1 - eta**2/40)"}, "Unproved: "),
        (FLOWER | {"law": "-lam*eta*(1 + theta/9)"}, "Wrong: scene: a tangency is one of a single closed curve"),
        ({"table": "cuspless"}, "Wrong: scene: a tangency is one of a single closed curve"),
    ],
)
def test_a_tangency_of_the_flower_is_none_of_another_table_or_law(check, scene, answer):
    given = json.loads((FOLDER / "flower-tangency-2.json").read_text())

    assert read(check, given | {"scene": scene}).startswith(answer)


def test_backwards_a_particle_leaves_at_the_angle_from_which_the_law_makes_the_one_it_left_at(check):
    """Forwards `phi = L(eta)` at a place; backwards `-phi` arrives and `eta` leaves: up to the third derivative."""
    p, formula = 200, "-lam*eta*(1 - eta**2/40 + cos(theta)/99)"
    oval = check.read_scene({"table": "egg", "shape": {"alpha": "2/25"}, "law": formula}, "lam", p)[0]
    back = check.beside("tangency").Back(oval)
    arrived, theta, lam = (check.Jet.of(check.I.of(Fraction(x), p), 3, k) for k, x in enumerate(("0.4", "1.1", "0.7")))
    eta = back.leaves(arrived, {"lam": lam, "theta": theta})
    again = oval.leaves(-eta, {"lam": lam, "theta": theta, "eta": eta}) + arrived

    assert all(0 in check.I.of(c, p) and check.I.of(c, p).width() < 2**20 for c in again.c)
    assert float(check.value(eta).real()) == pytest.approx(0.4 / 0.7, rel=0.02)


def test_backwards_no_angle_is_told_where_the_law_takes_two_to_one(check):
    """`eta - eta**3/2` has a largest value, beyond which it has no inverse."""
    oval = check.read_scene({"table": "egg", "shape": {"alpha": "2/25"}, "law": "eta - eta**3/2"}, "lam", 99)[0]
    back, arrived = check.beside("tangency").Back(oval), check.Jet.of(check.I.of(Fraction(-7, 10), 99), 0)

    with pytest.raises(check.Unproved, match=r"a divisor may be 0|not enclosed"):
        back.leaves(arrived, {"lam": check.I.of(1, 99), "theta": check.I.of(0, 99)})
