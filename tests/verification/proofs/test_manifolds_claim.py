"""Certificates of tangencies: a file proves itself again, a changed one does not, bad ones give one sentence."""

import json
from dataclasses import replace

import pytest
from flint import arb

from symbolic.tables import egg
from verification.app.cli import main
from verification.arithmetic.balls import working
from verification.named.theorems import checked, theorem
from verification.proofs.manifolds import proof
from verification.proofs.manifolds.certificate import Tangency
from verification.proofs.manifolds.known import CONTACTS, SHAPE

VALUE = "0.662144273358224419482534547746"  # by a cycle that shadows the tangency: docs/crises.md
CLAIM = Tangency(CONTACTS["boundary"], egg(3).at(alpha=SHAPE), VALUE, 20)


FIRST = CLAIM.to_dict()
CONTACT = FIRST["contact"]


@pytest.mark.slow
def test_a_certificate_of_a_tangency_is_checked_without_the_search(tmp_path, capsys):
    path = tmp_path / "touch.json"
    path.write_text(json.dumps(CLAIM.document()))

    assert main(["check", str(path), "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["certified"] is True
    assert found["name"] == "tangency of two manifolds: egg, alpha = 2/25"
    assert found["value"].startswith("0.66214427335822441948")
    assert set(found["checks"].values()) == set(found["strange_attractors"].values()) == {True}


@pytest.mark.slow
def test_what_a_file_says_of_itself_is_not_believed():
    given = CLAIM.document()
    given["contact"]["value"] = "0.66214427335822441952"
    found = checked(json.loads(json.dumps(given)))

    assert set(given["checks"].values()) == {True}
    assert found.checks["exists"] is False
    assert not found.proved


def test_a_claim_survives_the_way_through_a_file():
    for contact in CONTACTS.values():
        claim = replace(CLAIM, contact=contact)

        assert theorem(json.loads(json.dumps(claim.to_dict()))) == claim


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"scene": {"table": "cuspless"}}, "cuspless is not of the accepted kind: one smooth curve"),
        ({"scene": {"table": "ellipse", "shape": {"a": "2"}}}, "a turn or a mirror that the table does not have"),
        ({"scene": {"table": "square"}}, "no table is called square"),
        ({"digits": 10**6}, "digits = 1000000"),
        ({"contact": CONTACT | {"value": "__import__('os')"}}, "value = __import__"),
        ({"contact": CONTACT | {"value": "1.5"}}, r"value = 1\.5"),
        ({"scene": {"table": "egg"}}, "egg is not of the accepted kind: one smooth curve, a number for each"),
        ({"scene": {"table": "egg", "shape": {"alpha": "0.2"}}}, r"alpha"),
        ({"contact": {"value": VALUE}}, "entry 'unstable' is missing"),
        ({"contact": CONTACT | {"bounces": 10**9}}, "bounces = 1000000000"),
        ({"contact": CONTACT | {"z": float("nan")}}, "z = nan"),
        (
            {"contact": CONTACT | {"stable": {"name": "", "start": [], "sign": 1, "shift": [1, 3]}}},
            "saddle: 0 bounces",
        ),
    ],
)
def test_senseless_entries_are_one_sentence(changed, why):
    with pytest.raises(ValueError, match=why):
        checked(FIRST | changed)


@pytest.mark.parametrize("order", [1, 2, 7, 99, 100, 101])
def test_multipliers_are_not_resonant_up_to_an_order(order):
    """`abs(stable)**i*abs(unstable)**j` is 1 for `i = order`, `j = order + 1`, and for no smaller exponents."""
    with working(200):
        unstable = arb(2)
        stable = (-arb(2).log() * (order + 1) / order).exp()
        assert proof.nonresonant(stable, unstable) is (True if order > proof.RESONANCES else None)
        assert proof.nonresonant(arb(0.5, 0.5), unstable) is None
