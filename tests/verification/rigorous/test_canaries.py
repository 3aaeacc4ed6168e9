"""Canaries: for each hypothesis of a theorem, data that violate this hypothesis and no other."""

import json
import pkgutil
from dataclasses import fields, replace
from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest
from committed import document

import verification.proofs
from symbolic.tables.scene import Scene
from verification.named.theorems import THEOREMS, theorem, theorem_class
from verification.paper.egg.nearly_round import edge
from verification.paper.judges.cuspless_chaos import almost_every
from verification.proofs.global_dynamics.barrier import BarrierBreaks
from verification.proofs.global_dynamics.fates import AlmostEveryOrbit, FewAttractingCycles
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.unstable_curves.certificate import AtMostOneAttractor
from verification.rigorous.theorem import Theorem

SADDLE = 0, 2.0382687, -0.0454335
SCENE, RANGE = Scene("cuspless"), (Fraction(0), Fraction(1, 100))
FILES = {"cycle": "cardioid", "fold": "saddle-node", "flip": "lambda-c", "corner": "lambda-star", "focus": "alpha-hat"}
DOCUMENTS = {kind: document(name) for kind, name in (FILES | {"tangency": "boundary-crisis"}).items()} | {
    "trapping region": document("triangle-region"),
    "boundary crisis": document("crisis-between"),
    "no two attractors": AtMostOneAttractor(
        SCENE, (Fraction(13, 100),) * 2, 64, 64, (SADDLE,), SADDLE, 4, 0.003
    ).to_dict(),
}
REGION = theorem(DOCUMENTS["trapping region"])
HORIZONTAL, VERTICAL = ((0, 0.0, 0.0), (1, 0.0, 0.0)), ((0, np.pi / 3, 0.0), (0, -np.pi / 3, 0.0))
ORBITS = AlmostEveryOrbit(SCENE, RANGE, (1024, 16), 4, (HORIZONTAL,))
MINOR = ((0, np.pi / 2, 0.0), (0, -np.pi / 2, 0.0))
ELLIPSE = AlmostEveryOrbit(Scene("ellipse", a="3/2"), (Fraction(1, 10),) * 2, (512, 64), 4, (MINOR,))
BELOW = almost_every()
FIRST, MIDDLE, LAST = BELOW.ranges
PLAIN = AlmostEveryOrbit(*(getattr(LAST, each.name) for each in fields(LAST)))
ONE_LESS = type(REGION.cells)(*(column[1:] for column in REGION.cells))
FEW = FewAttractingCycles(SCENE, RANGE, (1024, 16), 4, 1)
DIAMETERS = FewAttractingCycles(Scene("egg", alpha="2/25"), (Fraction(0), Fraction(1, 128)), (12288, 256), 32, 3)
EDGE = edge()
COARSE = replace(EDGE.barrier, columns=256)  # no staircase of so few steps is taken below itself
BREAKS = BarrierBreaks(replace(EDGE.barrier, columns=4096), Fraction(6623, 10000), (-3.0003, 0.4175), 0.7251)
CANARIES = [
    (ORBITS, {"cycles": ()}, {"sinks"}),  # an attracting cycle is not named
    (ORBITS, {"cycles": (HORIZONTAL, HORIZONTAL)}, {"sinks"}),
    (ORBITS, {"cycles": (VERTICAL,)}, {"cycles", "sinks"}),  # it is a saddle, which no boxes are taken into
    (ELLIPSE, {"grid": (64, 16)}, {"saddles"}),  # boxes about the major axis are too wide for cones
    (ORBITS, {"lam": (Fraction(7, 100), Fraction(71, 1000))}, {"returning", "sinks", "saddles"}),  # they meet a join
    (BELOW, {"ranges": (FIRST, LAST)}, {"joined"}),
    (BELOW, {"ranges": (FIRST, MIDDLE)}, {"joined"}),  # it ends below lambda*
    (BELOW, {"ranges": (FIRST, replace(MIDDLE, near=3), LAST)}, {"each"}),
    (BELOW, {"ranges": (FIRST, MIDDLE, PLAIN)}, {"each"}),  # boxes beside the corner orbit are no saddles
    (LAST, {"lam": (Fraction(65, 1000), LAST.lam[1])}, {"leaving"}),  # lambda* is so far that V may lie beyond FAR
    (FEW, {"lam": (Fraction(7, 100), Fraction(71, 1000))}, {"returning", "sinks", "repelling"}),
    (DIAMETERS, {"count": 2}, {"sinks"}),
    (DIAMETERS, {"grid": (6144, 128), "coarsest": 16}, {"repelling"}),
    (EDGE, {"radius": 0.03}, {"disc"}),  # the derivative is no contraction over so wide a disc
    (EDGE, {"sink": (-0.9, 0.4)}, {"disc", "alone"}),  # the triangle lies beside it
    (EDGE, {"saddle": replace(TRIANGLE, start=(1.19,))}, {"saddle", "hyperbolic", "alone"}),  # that one attracts
    (EDGE, {"barrier": COARSE}, {"barrier", "disc", "alone"}),
    (BREAKS, {"sink": (-3.0003, -0.4175)}, {"apart", "crossed"}),  # the cycle lies below the barrier
    (BREAKS, {"barrier": COARSE}, {"barrier", "apart"}),
    (REGION, {"lam": (Fraction(2, 5), Fraction(1, 2))}, {"images_inside"}),
    (REGION, {"cells": ONE_LESS}, {"images_inside"}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("proved", "changes", "failing"), CANARIES)
def test_a_change_of_the_data_makes_its_hypotheses_fail_and_no_other(proved, changes, failing):
    assert proved.proved
    assert {*replace(proved, **changes).open} == failing


def test_each_hypothesis_has_a_canary():
    """Except those that the map itself guarantees: convex tables, enclosed images, bounded boxes."""
    kinds = {type(proved) for proved, *_ in CANARIES} - {type(REGION), BarrierBreaks}
    failing = set().union(*(items for proved, _, items in CANARIES if type(proved) in kinds))
    assert failing == {name for kind in kinds for name in kind.hypotheses()}


@pytest.mark.parametrize("kind", FILES)
def test_a_box_beside_the_solution_holds_none_and_one_too_wide_is_not_precise(kind):
    stated = theorem(DOCUMENTS[kind])
    aside = replace(stated, centre=tuple(x + 1000 * stated.radius for x in stated.centre))
    assert stated.proved
    assert {"exists", "unique", "admissible", "minimal_period"} <= {*aside.open}
    assert {*replace(stated, digits=stated.digits + 100).open} == {"precise"}


@pytest.mark.parametrize("kind", THEOREMS)
def test_a_document_is_read_and_written_entry_by_entry(kind):
    """Its entries are the theorem's fields; if one is missing, the document is refused by that entry's name."""
    document = DOCUMENTS[kind]
    entries = [key for key in document if key not in theorem_class(kind).beside]
    assert [*json.loads(json.dumps(theorem(document).to_dict()))] == entries
    for missing in {*entries} - {"name", "statement"}:
        with pytest.raises(ValueError, match=rf"the entry '{missing}' is missing|^certificate: {missing} = "):
            theorem({name: value for name, value in document.items() if name != missing})
    with pytest.raises(ValueError, match="is not what it states"):
        theorem(document | {"name": "another"})


def declared(kind=Theorem):
    """All theorems derived from one class, in all modules."""
    for module in pkgutil.walk_packages(verification.proofs.__path__, "verification.proofs."):
        import_module(module.name)
    return {found for each in kind.__subclasses__() for found in (each, *declared(each))}


def test_each_theorem_and_each_hypothesis_is_said_in_words():
    for kind in declared():
        words = [each.words for each in kind.hypotheses().values()]
        assert kind.statement()
        assert all(line[0].isupper() or line[0] == "`" for line in words), kind
        assert all(line.endswith(".") for line in words), kind
