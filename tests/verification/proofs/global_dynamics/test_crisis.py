"""A crisis between two contractions: orbits stay below it and leave above it; false statements are refused."""

import json
from dataclasses import replace
from fractions import Fraction

import pytest

from symbolic.tables.scene import Scene
from verification.app import cli
from verification.cycles.recurrence import Closure
from verification.proofs.global_dynamics.crisis import BoundaryCrisis, bracket
from verification.proofs.manifolds.known import CONTACTS, SHAPE, boundary

BELOW, ABOVE = Fraction(3, 5), Fraction(663, 1000)
GRID = (1024, 512, 1)
EGG, TRIANGLE = Scene("egg", alpha="0.08"), CONTACTS["boundary"].unstable


@pytest.fixture(scope="module")
def found():
    return bracket(EGG, TRIANGLE, 1, (BELOW, ABOVE), GRID)


@pytest.mark.slow
def test_the_boundary_crisis_of_the_egg_lies_between_two_contractions(found, tmp_path, capsys):
    """Between them lies the tangency, 0.66214, located and proved by other methods."""
    file = tmp_path / "crisis.json"
    file.write_text(json.dumps(found.to_dict()))

    assert cli.main(["check", str(file)]) == 0
    assert "lam between 3/5 and 663/1000  (certified" in capsys.readouterr().out
    assert BoundaryCrisis.from_dict(json.loads(file.read_text())) == found
    assert BELOW < Fraction(boundary(SHAPE).near) < ABOVE


def test_another_saddle_than_the_one_that_is_named_is_refused(found):
    elsewhere = replace(found.saddle, start=(found.saddle.start[0] + 2e-5,))
    assert replace(found, saddle=elsewhere).checks["saddle"] is None


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ("-lam*eta + cos(3*theta)/20", "depends on the place"),
        ("-lam*eta + s/50", "on the place"),
        ("-eta", "by a margin"),
    ],
)
def test_a_law_without_the_crisis_hypotheses_is_refused(found, law, said):
    with pytest.raises(ValueError, match=said):
        replace(found, scene=Scene("egg", alpha="0.08", lam="1/2", law=law))


@pytest.mark.slow
def test_nothing_leaves_below_the_crisis(found):
    """The proof tells both sides apart: at 0.65 the orbit that leaves at 0.663 stays."""
    assert replace(found, lam=(BELOW, Fraction(13, 20))).checks["leaves"] is None
    with pytest.raises(ValueError, match="none of 20000 orbits along the branch leaves"):
        bracket(EGG, TRIANGLE, 1, (BELOW, Fraction(13, 20)), GRID)


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "trapping region"}, {"side": 2}, {"lam": ["0.7", "0.6"]}, {"lam": ["1/0", "1/2"]}, {"lam": ["1/2"]},
        {"start": 1.5}, {"columns": 0}, {"sink": [1.0]},
    ],
    ids=lambda change: next(iter(change)),
)  # fmt: skip
def test_a_damaged_document_is_refused(found, change):
    with pytest.raises(ValueError, match=r"^(certificate|crisis): "):
        BoundaryCrisis.from_dict(found.to_dict() | change)


@pytest.mark.parametrize(
    "changed",
    [
        {"side": 0}, {"start": 1.5}, {"sink": (float("nan"), 0.0)}, {"sink": (10.0, 0.0)},
        *({"lam": ends} for ends in ((Fraction(0), ABOVE), (ABOVE, BELOW), (BELOW, BELOW), (BELOW, Fraction(1)))),
        *({"saddle": replace(TRIANGLE, start=start)} for start in (TRIANGLE.start * 2, (-10.0,))),
        {"saddle": replace(TRIANGLE, closure=Closure(-1, TRIANGLE.closure.shift))},
        {"saddle": replace(TRIANGLE, closure=Closure(1, (1, 5)))},
    ],
)  # fmt: skip
def test_each_hypothesis_of_the_statement_is_asked_when_it_is_made(changed):
    stated = BoundaryCrisis(EGG, TRIANGLE, 1, (BELOW, ABOVE), *GRID, 0.5, (0.0, 0.0))
    with pytest.raises(ValueError, match="crisis: "):
        replace(stated, **changed)
    assert {replace(stated, side=side, start=end).start for side, end in ((1, 0.0), (-1, 1.0))} == {0.0, 1.0}
    for shift in ((4, 3), (-1, 3), (0, 1)):  # up to whole turns
        assert replace(stated, saddle=replace(TRIANGLE, closure=Closure(1, shift))).side == 1
