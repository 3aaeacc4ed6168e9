"""Certificates of tangencies: a file proves itself again, a changed one does not, a senseless one is one sentence."""

import json
from dataclasses import replace

import pytest

from verification.app.cli import main
from verification.named.files import checked, document
from verification.proofs.manifolds.known import CONTACTS, SHAPE
from verification.proofs.manifolds.proof import TangencyClaim, claim_of, worked_through

VALUE = "0.662144273358224419482534547746"  # by a cycle that shadows the tangency: docs/crises.md
CLAIM = TangencyClaim(CONTACTS["boundary"], SHAPE, VALUE, 20)


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

        assert claim_of(json.loads(json.dumps(claim.to_dict()))) == claim


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"table": "circle"}, "table = 'circle' is out of range"),
        ({"digits": 10**6}, "digits = 1000000"),
        ({"value": "__import__('os')"}, "value = __import__"),
        ({"value": "1.5"}, r"value = 1\.5"),
        ({"shape": {}}, "entry 'alpha' is missing"),
        ({"shape": {"alpha": "0.2"}}, r"alpha"),
        ({"contact": {}}, "entry 'unstable' is missing"),
        ({"contact": CLAIM.to_dict()["contact"] | {"bounces": 10**9}}, "bounces = 1000000000"),
        ({"contact": CLAIM.to_dict()["contact"] | {"z": float("nan")}}, "z = nan"),
        (
            {"contact": CLAIM.to_dict()["contact"] | {"stable": {"name": "", "start": [], "sign": 1, "shift": [1, 3]}}},
            "saddle of 0 bounces",
        ),
    ],
)
def test_senseless_entries_are_one_sentence(changed, why):
    with pytest.raises(ValueError, match=why):
        checked({"schema": 1} | CLAIM.to_dict() | changed)
