"""Tangencies as chains of bounces, made by the package and proved by the independent checker, to a few digits."""

import json
import re
from fractions import Fraction

import pytest
from committed import document

from symbolic.tables import egg
from verification.arithmetic.balls import FLOAT64
from verification.proofs.manifolds.certificate import Tangency
from verification.proofs.manifolds.known import CONTACTS, SHAPE, table

VALUE = "0.662144273358224419482534547746"  # by a cycle that shadows the tangency: docs/crises.md
DIGITS = 8


@pytest.fixture(scope="module")
def chain() -> dict:
    proved = Tangency(CONTACTS["boundary"], egg(3).at(alpha=SHAPE), VALUE, DIGITS).evidence
    return json.loads(json.dumps({name: entry for name, entry in proved.items() if name != "checks"}))


def number(pair) -> float:
    return float(Fraction(int(pair[0])) * Fraction(2) ** int(pair[1]))


@pytest.mark.slow
def test_what_is_told_of_a_tangency_is_proved_by_the_second_reader(check, chain):
    given = document("boundary-crisis") | chain
    line = check.checked(given).splitlines()[0]

    assert line.startswith("proved: tangency of two manifolds: egg, alpha = 2/25 = 0.66214427, within 1e-8")


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
    """The verdict on a document whose statement and name are those that its other entries require."""
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


@pytest.mark.slow
@pytest.mark.parametrize("scene", [FLOWER, CURVE], ids=["radius", "curve"])
def test_a_tangency_of_the_flower_is_proved_by_its_radius_and_as_a_curve(check, scene):
    """The value is that of `flower.json`, enclosed by series."""
    given = document("flower-tangency-2")

    assert re.fullmatch(r"proved: .* = 0\.99848542091065429028\d*, within 1e-24", read(check, given | {"scene": scene}))


@pytest.mark.slow
def test_a_tangency_under_another_law_is_proved_however_the_law_is_written(check):
    """The value is from folds of a shadowing cycle, in tests/verification/proofs/test_manifolds_proof.py."""
    given = document("tangency-under-a-law")
    scene = given["scene"] | {"law": "-lam*eta*(1 - eta**2/40)"}

    assert re.fullmatch(r"proved: .* = 0\.664811968482\d*, within 1e-24", read(check, given | {"scene": scene}))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "answer"),
    [
        ({"polar": "cos(5*theta)/41 + 1"}, "Unproved: "),
        ({"polar": "cos(5*theta)/40 - 1"}, "Wrong: scene: the radius may not be positive"),
        ({"polar": "1 + cos(theta/2)/40"}, "Wrong: scene: a tangency is one of a single closed curve"),
        (FLOWER | {"undefined": [MARK]}, "Wrong: scene: a tangency is one of a single closed curve"),
        (FLOWER | {"law": "-lam*eta*(1 - eta**2/40)"}, "Unproved: "),
        (FLOWER | {"law": "-lam*eta*(1 + theta/9)"}, "Unproved: law: it may lead out of the table"),
        ({"table": "cuspless"}, "Wrong: scene: a tangency is one of a single closed curve"),
    ],
)
def test_a_tangency_of_the_flower_is_none_of_another_table_or_law(check, scene, answer):
    given = document("flower-tangency-2")

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
    """`eta - eta**3/2` has a maximum, beyond which it has no inverse."""
    oval = check.read_scene({"table": "egg", "shape": {"alpha": "2/25"}, "law": "eta - eta**3/2"}, "lam", 99)[0]
    back, arrived = check.beside("tangency").Back(oval), check.Jet.of(check.I.of(Fraction(-7, 10), 99), 0)

    with pytest.raises(check.Unproved, match=r"a divisor may be 0|not enclosed"):
        back.leaves(arrived, {"lam": check.I.of(1, 99), "theta": check.I.of(0, 99)})
