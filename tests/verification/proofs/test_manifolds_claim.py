"""Certificates of tangencies: a file proves itself again, a changed one does not, a senseless one is one sentence."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from flint import arb
from sympy import Rational

from symbolic.tables import egg
from verification.app.cli import main
from verification.arithmetic.balls import working
from verification.named import tangency_entries
from verification.named.files import checked, document
from verification.proofs.manifolds import enclosed, proof, tangency
from verification.proofs.manifolds.claim import TangencyClaim, worked_through
from verification.proofs.manifolds.enclosed import TooWideError
from verification.proofs.manifolds.known import CONTACTS, SHAPE
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.proof import ITEMS, Proof, tangency_proved
from verification.proofs.periodic.interval_newton import Enclosure, Status

VALUE = "0.662144273358224419482534547746"  # by a cycle that shadows the tangency: docs/crises.md
CLAIM = TangencyClaim(CONTACTS["boundary"], egg(3).at(alpha=SHAPE), VALUE, 20)


def first(claim):
    """The entries of a document of the first version."""
    said = tangency_entries.entries(claim)
    contact = {key: x for key, x in said["contact"].items() if key != "value"}
    table = {"table": "egg", "points": 3, "shape": said["scene"]["shape"]}
    return {"schema": 1, "kind": "tangency", "digits": claim.digits, "value": claim.value, "contact": contact} | table


def test_a_certificate_of_a_tangency_is_checked_without_the_search(tmp_path, capsys):
    path = tmp_path / "touch.json"
    path.write_text(json.dumps(document(worked_through(CLAIM))))

    assert main(["check", str(path), "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["certified"] is True
    assert found["name"] == "tangency of two manifolds: egg, alpha = 2/25"
    assert found["value"].startswith("0.66214427335822441948")
    assert set(found["checks"].values()) == set(found["strange_attractors"].values()) == {True}


def test_what_a_file_says_of_itself_is_not_believed():
    given = document(worked_through(CLAIM))
    given["contact"]["value"] = "0.66214427335822441952"
    found = checked(json.loads(json.dumps(given)))

    assert set(given["checks"].values()) == {True}
    assert found.checks["exists"] is False
    assert not found.certified


def test_a_claim_survives_the_way_through_a_file():
    for contact in CONTACTS.values():
        claim = replace(CLAIM, contact=contact)

        for given in (first(claim), {"schema": 4} | tangency_entries.entries(claim)):
            assert tangency_entries.claim_of(json.loads(json.dumps(given))) == claim


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"table": "cuspless", "shape": {}}, "cuspless is out of range; accepted: one smooth curve"),
        ({"table": "ellipse", "shape": {"a": "2"}}, "a turn or a mirror that the table does not have"),
        ({"table": "square"}, "no table is called square"),
        ({"digits": 10**6}, "digits = 1000000"),
        ({"value": "__import__('os')"}, "value = __import__"),
        ({"value": "1.5"}, r"value = 1\.5"),
        ({"shape": {}}, "egg is out of range; accepted: one smooth curve, a number for each"),
        ({"shape": {"alpha": "0.2"}}, r"alpha"),
        ({"contact": {}}, "entry 'unstable' is missing"),
        ({"contact": first(CLAIM)["contact"] | {"bounces": 10**9}}, "bounces = 1000000000"),
        ({"contact": first(CLAIM)["contact"] | {"z": float("nan")}}, "z = nan"),
        (
            {"contact": first(CLAIM)["contact"] | {"stable": {"name": "", "start": [], "sign": 1, "shift": [1, 3]}}},
            "saddle of 0 bounces",
        ),
    ],
)
def test_senseless_entries_are_one_sentence(changed, why):
    with pytest.raises(ValueError, match=why):
        checked(first(CLAIM) | changed)


def entry(name, value):
    """The document with one entry of the claim, of its contact or of a saddle of it changed."""
    given = json.loads(json.dumps(first(CLAIM)))
    *places, last = name.split(".")
    at = given
    for place in places:
        at = at[place]
    at[last] = value
    return given


@pytest.mark.parametrize(
    ("name", "accepted", "refused"),
    [
        ("digits", [10, 600], [9, 601]),
        ("value", ["0.5", "0." + "1" * 1000], ["0.", ".5", "-0.5", "0." + "1" * 1001, "0.5\n"]),
        ("contact.bounces", [0, 1000], [-1, 1001]),
        ("contact.sign", [1, -1], [0, 2]),
        ("contact.z", [1e-9, -999.0], [0.0, 1000.0, -1000.0]),
        ("contact.end", [1e-9, -999.0], [0.0, 1000.0, -1000.0]),
        ("contact.letter", [1e-9, 0.999], [0.0, 1.0, -0.5]),
        ("contact.unstable.start", [[0.5], [0.5] * 64], [[], [0.5] * 65]),
        ("contact.stable.sign", [1, -1], [0, 3]),
        ("contact.stable.shift", [[1, 1], [-2, 3], [1000, 1000]], [[1, 1001], [1, 0]]),
    ],
)
def test_an_entry_is_accepted_up_to_the_end_of_its_range_and_refused_beyond(name, accepted, refused):
    for value in accepted:
        claim = tangency_entries.claim_of(entry(name, value))
        assert tangency_entries.claim_of(json.loads(json.dumps(first(claim)))) == claim
    for value in refused:
        with pytest.raises(ValueError, match="certificate: "):
            tangency_entries.claim_of(entry(name, value))


@pytest.mark.parametrize("open_", [None, *ITEMS])
def test_a_tangency_is_one_by_five_items_and_holds_by_all(open_):
    for answer in (None, False):
        found = Proof(arb(0), {item: answer if item == open_ else True for item in ITEMS})

        assert found.holds is (open_ is None)
        assert found.touches is (open_ not in ("saddle", "remainder", "exists", "unique", "admissible"))


@pytest.mark.parametrize("why", [*(TooWideError(item, "") for item in ITEMS), ValueError(), ArithmeticError()],
                         ids=lambda why: getattr(why, "item", type(why).__name__))  # fmt: skip
def test_a_proof_that_stops_says_which_items_came_before(monkeypatch, why):
    def stops(*_):
        raise why

    monkeypatch.setattr(proof, "Touching", stops)
    found = tangency_proved(CLAIM.contact, CLAIM.map, VALUE, 20)
    known = ITEMS[: ITEMS.index(getattr(why, "item", "saddle"))]

    assert {item for item, value in found.checks.items() if value is True} == set(known)
    assert {item for item, value in found.checks.items() if value is None} == set(ITEMS) - set(known)


@pytest.mark.parametrize(
    ("bounces", "answers", "halves", "held"),
    [
        (proof.LONG, [True], [False], True),
        (proof.LONG + 1, [True], [True], True),
        (proof.LONG + 1, [None, True], [True, False], True),
        (proof.LONG + 1, [None, None], [True, False], False),
        (proof.LONG + 1, [ValueError(), True], [True, False], True),
        (proof.LONG + 1, [ZeroDivisionError(), None], [True, False], False),
    ],
)
def test_long_systems_are_solved_in_halves_first_and_whole_where_that_proves_nothing(
    monkeypatch, bounces, answers, halves, held
):
    system, asked, given = SimpleNamespace(bounces=bounces, halves=False), [], iter(answers)

    def proved(*_):
        asked.append(system.halves)
        answer = next(given)
        if isinstance(answer, Exception):
            raise answer
        return Proof(arb(0), dict.fromkeys(ITEMS, True) | {"quadratic": answer})

    monkeypatch.setattr(proof, "Touching", lambda *_: system)
    monkeypatch.setattr(proof, "_proved", proved)
    assert tangency_proved(CLAIM.contact, CLAIM.map, VALUE, 20).holds is held
    assert asked == halves


@pytest.mark.parametrize("components", [1, 2, 3])
@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("convex", [True, None])
def test_chords_are_free_in_a_convex_table_whose_curve_closes_or_that_has_several(
    monkeypatch, components, closed, convex
):
    monkeypatch.setattr(proof, "convex", lambda _: convex)
    monkeypatch.setattr(proof, "closes_smoothly", lambda _: closed)
    map = Pinball(SimpleNamespace(components=[None] * components))
    assert proof.admissible(map) is (convex if closed or components > 1 else None)
    for falls in (True, False):
        monkeypatch.setattr(proof, "falling", lambda *_, falls=falls: falls)
        for law in (SimpleNamespace(uniform=True), SimpleNamespace(uniform=False)):
            smooth = convex and closed and (law.uniform or falls)
            assert proof.smooth(replace(map, law=law), arb(0.5)) is (True if smooth else None)


@pytest.mark.parametrize(
    ("stable", "unstable", "dissipative"),
    [
        (arb("0.3"), arb(2), True),
        (-arb("0.3"), arb(2), True),
        (arb("0.3"), -arb(2), True),
        (arb("0.6"), arb("2.5"), False),
        (arb("0.6"), -arb("2.5"), False),
        (arb("0.5"), arb(2), None),
        (arb("0.5", "0.1"), arb(2), None),
        (arb("0.7"), arb("2.8"), False),
    ],
)
@pytest.mark.parametrize(("holds", "contact"), [(True, CONTACTS["boundary"]), (None, CONTACTS["merging"])])
def test_an_orbit_shrinks_areas_where_the_product_of_its_multipliers_is_below_one(
    monkeypatch, stable, unstable, dissipative, holds, contact
):
    monkeypatch.setattr(proof, "nonresonant", lambda *given: [float(x) for x in given])
    monkeypatch.setattr(proof, "smooth", lambda map, parameter: (map, float(parameter)))
    found = Proof(arb(0.5), dict.fromkeys(ITEMS, True) | {"quadratic": holds}, multipliers=(stable, unstable))
    said = proof.strange_attractors(contact, "a map", found)
    assert list(said) == list(proof.STRANGE)
    assert said["dissipative"] is dissipative
    assert said["tangency"] is holds
    assert said["homoclinic"] is (contact.unstable == contact.stable)
    assert said["analytic"] == ("a map", 0.5)
    assert said["nonresonant"] == [abs(float(stable)), abs(float(unstable))]
    none = proof.strange_attractors(contact, "a map", replace(found, multipliers=()))
    assert (none["dissipative"], none["nonresonant"]) == (None, None)


@pytest.mark.parametrize("order", [1, 2, 7, 99, 100, 101])
def test_multipliers_are_not_resonant_up_to_an_order(order):
    """`abs(stable)**i*abs(unstable)**j` is 1 for `i = order`, `j = order + 1`, and no smaller ones."""
    with working(200):
        unstable = arb(2)
        stable = (-arb(2).log() * (order + 1) / order).exp()
        assert proof.nonresonant(stable, unstable) is (True if order > proof.RESONANCES else None)
        assert proof.nonresonant(arb(0.5, 0.5), unstable) is None


def test_any_flight_is_free_where_a_map_is_no_billiard():
    map = Henon(Rational(3, 10))
    assert proof.admissible(map) is True
    assert proof.smooth(map) is True


BALL, OPEN = arb(1, 0.1), arb(0, 1)


@pytest.mark.parametrize(
    ("status", "convex", "clear", "objects", "bend", "speed", "missing"),
    [
        (Status.UNIQUE, True, False, "", BALL, -BALL, {}),
        (Status.UNKNOWN, True, False, "", BALL, BALL, dict.fromkeys(("exists", "unique", "quadratic", "transversal"))),
        (Status.EMPTY, True, False, "", BALL, BALL, dict.fromkeys(("exists", "unique"), False)
         | dict.fromkeys(("quadratic", "transversal"))),
        (Status.UNIQUE, None, False, "", BALL, BALL, {"admissible": None}),
        (Status.UNIQUE, None, True, "", BALL, BALL, {}),  # each flight is free, though the table is not convex
        (Status.UNKNOWN, None, True, "", BALL, BALL,
         dict.fromkeys(("exists", "unique", "admissible", "quadratic", "transversal"))),
        (Status.UNIQUE, True, True, "no law", BALL, BALL, {"admissible": None}),
        (Status.UNIQUE, True, False, "", OPEN, BALL, {"quadratic": None}),
        (Status.UNIQUE, True, False, "", BALL, OPEN, {"transversal": None}),
        (Status.UNIQUE, True, False, "", arb(0), -BALL, {"quadratic": None}),
    ],
)  # fmt: skip
def test_each_item_of_a_tangency_is_what_its_own_step_proves(
    monkeypatch, status, convex, clear, objects, bend, speed, missing
):
    linear = SimpleNamespace(values=[arb(0)] * 3, along=[arb(0)] * 2, step=lambda values, how: [arb(0)] * len(values))
    real = [SimpleNamespace(real=arb(k)) for k in range(7, 11)]  # complex balls have a real part
    pairs = [SimpleNamespace(saddle=SimpleNamespace(stable=real[k], unstable=real[k + 1])) for k in (0, 2)]
    system = SimpleNamespace(linear=lambda at: linear, parameter=arb("0.6"), contact=CLAIM.contact, pairs=pairs)
    system.clear = lambda at: clear
    zero = [arb(0.1), arb(0.2), arb(0.3), arb(0.4), arb(0.6)]
    monkeypatch.setattr(proof, "settled", lambda *_: SimpleNamespace(unknowns=zero))
    monkeypatch.setattr(proof, "stepped", lambda *_: Enclosure(status, zero))
    monkeypatch.setattr(proof, "admissible", lambda _: convex)
    monkeypatch.setattr(proof, "objection", lambda *_: objects)
    monkeypatch.setattr(proof, "generic", lambda *_: (bend, speed))
    monkeypatch.setattr(proof, "multipliers_at", lambda _, saddle, *rest: (saddle.stable.real, saddle.unstable.real))
    found = proof._proved(system, CLAIM.map, tangency.Precision(20))

    assert found.checks == dict.fromkeys(ITEMS, True) | missing
    if status is Status.UNIQUE:
        assert found.parameter is zero[-1]
        assert [float(x) for x in found.multipliers] == [7, 8]  # of the saddle that the orbit leaves
    else:
        assert found.parameter.overlaps(arb("0.6"))
        assert 0 < found.parameter.rad() < 1e-15
        assert not found.multipliers


@pytest.mark.parametrize(
    ("least", "found", "bound"),
    [
        (["1e-9", "3e-9"], ["1.9e-9", "5.9e-9"], "6e-9"),
        (["3e-9", "1e-9"], ["1e-9", "1e-9"], "6e-9"),
        (["1e-9", "3e-9"], ["2.1e-9", "1e-9"], None),  # one round takes the first to more than it may be
        (["1e-9", "3e-9"], ["1e-9", "7e-9"], None),
        (["6e-7", "1e-9"], ["1e-7", "1e-9"], None),  # beyond the tube on which slopes are bounded
        (["1e-9", "5.1e-7"], ["1e-9", "1e-9"], None),
    ],
)
def test_a_remainder_is_bounded_where_a_round_takes_its_bounds_into_themselves_within_the_tube(
    monkeypatch, least, found, bound
):
    asked = []

    def bounds(made, slopes, errors):
        asked.append(errors)
        return [arb(x) for x in (found if len(asked) > 1 else least)]

    monkeypatch.setattr(enclosed, "vanishing", lambda _: True)
    monkeypatch.setattr(enclosed, "round_outwards", lambda *_: [None, None])
    monkeypatch.setattr(enclosed, "bounds", bounds)
    if bound is None:
        with pytest.raises(TooWideError, match="not bounded"):
            enclosed.remainder(None, 1000)
    else:
        assert enclosed.remainder(None, 1000).overlaps(arb(bound))
    assert [float(x) for x in asked[0]] == [0, 0]
    assert [float(x) for x in asked[1]] == pytest.approx([2 * float(x) for x in least])


@pytest.mark.parametrize(
    ("item", "fails", "count"),
    [("remainder", 0, 1), ("remainder", 2, 3), ("remainder", 3, 4), ("remainder", 4, None), ("saddle", 1, None)],
)
def test_smaller_units_are_tried_where_a_remainder_is_not_bounded_and_for_no_other_reason(
    monkeypatch, item, fails, count
):
    tried = []

    def pair(orbit, map, parameter, scale, precision):
        tried.append((scale.unit, scale.more))
        if len(tried) <= fails:
            raise TooWideError(item, "")
        return scale

    monkeypatch.setattr(tangency, "pair", pair)
    start = tangency.Scale(True, 1.0, 0, None)
    if count is None:
        with pytest.raises(TooWideError):
            tangency.smaller(None, None, None, start, None)
        assert len(tried) == (4 if item == "remainder" else 1)
    else:
        assert tangency.smaller(None, None, None, start, None).unit == 10.0 ** -(count - 1)
        assert tried == [(pytest.approx(10.0**-k), 10 * k) for k in range(count)]


def test_a_bounce_of_a_pair_has_the_derivatives_of_its_polynomials_and_cauchys_bounds_of_what_they_leave_out():
    """`1 + 2*z + 3*z**2 + 5*z**3`, and by the parameter `7 + z - z**2`: by hand at z = 1/4, a step of 1/8 away."""
    balls = lambda *c: [arb(x) for x in c]  # noqa: E731
    made = tangency.Pair(None, None, [[], balls(1, 2, 3, 5)], [[], balls(7, 1, -1, 0)], arb("1e-9"), arb(0.5), ())
    found = made.at(1, arb(0.25), arb(0.125))
    place, first, second = 1 + 0.5 + 3 / 16 + 5 / 64, 2 + 1.5 + 15 / 16, 6 + 30 / 4
    wanted = {
        "place": (place + (7 + 0.25 - 1 / 16) / 8, 1e-9), "first": (first + (1 - 0.5) / 8, 2e-9),
        "second": (second - 2 / 8, 8e-9), "by_parameter": (7 + 0.25 - 1 / 16, 2e-9), "mixed": (1 - 0.5, 4e-9),
    }  # fmt: skip
    for name, (true, error) in wanted.items():
        ball = getattr(found, name)
        assert ball.contains(true)
        assert abs(float(ball.rad()) - error) < 1e-3 * error
    for z in (arb(0.5), arb(-0.5), arb(0.4, 0.2)):
        with pytest.raises(TooWideError, match="radius 1/2"):
            made.at(1, z, arb(0))


def test_the_cycle_at_one_parameter_is_the_one_around_it_only_where_each_of_its_balls_lies_in_that():
    wide = SimpleNamespace(points=(arb(1, 0.5), arb(2, 0.5)))
    for places, one in (((1.25, 1.75), True), ((1.25, 2.75), False), ((0.25, 2), False)):
        assert tangency.one_cycle(wide, SimpleNamespace(points=[arb(x, 0.125) for x in places])) is one
    jutting = SimpleNamespace(points=(arb(1.375, 0.25), arb(2)))  # it overlaps, and has points outside
    assert not tangency.one_cycle(wide, jutting)


def test_what_is_left_out_is_bounded_by_the_larger_end_of_a_ball():
    """A remainder known as a ball is at most its upper end, whichever sign it has."""
    for bound in (arb("1e-9", "5e-10"), -arb("1e-9", "5e-10"), arb(0, "1.5e-9")):
        around = tangency._within(arb(0), bound)
        assert all(around.contains(arb("1.499e-9") * sign) for sign in (1, -1))
        assert around.rad() < 1.6e-9
