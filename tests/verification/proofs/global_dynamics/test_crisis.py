"""A crisis between two contractions: what keeps below, what leaves above, and what must not be proved."""

import json
from dataclasses import dataclass, replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.app import cli
from verification.arithmetic.balls import FLOAT64
from verification.cycles.recurrence import Closure
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.proofs.global_dynamics import crisis
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.global_dynamics.crisis import (
    CHECKS,
    BoundaryCrisis,
    bracket,
    enters,
)
from verification.proofs.global_dynamics.graph import Grid
from verification.proofs.manifolds.enclosed import TooWideError
from verification.proofs.manifolds.known import BOUNDARY, CONTACTS, SHAPE
from verification.proofs.manifolds.saddle import saddle

BELOW, ABOVE = Fraction(3, 5), Fraction(663, 1000)
GRID = (1024, 512, 1)
EGG, TRIANGLE = Scene("egg", alpha="0.08"), CONTACTS["boundary"].unstable


@pytest.fixture(scope="module")
def found():
    return bracket(EGG, TRIANGLE, 1, (BELOW, ABOVE), GRID)


def test_the_boundary_crisis_of_the_egg_lies_between_two_contractions(found, tmp_path, capsys):
    """The tangency at 0.66214, located and proved by other means, lies between them too."""
    file = tmp_path / "crisis.json"
    file.write_text(json.dumps(found.to_dict()))

    assert cli.main(["check", str(file)]) == 0
    assert "lam between 3/5 and 663/1000  (certified" in capsys.readouterr().out
    assert BoundaryCrisis.from_dict(json.loads(file.read_text())) == found
    assert BELOW < Fraction(BOUNDARY[SHAPE][1]) < ABOVE


def test_every_turned_copy_of_a_piece_of_the_branch_is_kept(found):
    """Orbits that begin nearer to the saddle pass another copy: of them one copy alone says nothing."""
    branch = found._branch(found._continued()[0], found.lam[0], 160)
    piece = found._launched(branch, np.array([0.0]), np.array([1.0]))
    copies = [float(theta.mid()) for theta, _ in found._turned(piece)]

    assert np.allclose(np.diff(copies), 2 * np.pi / 3)
    assert len(copies) == 3


def test_another_saddle_than_the_one_that_is_named_is_refused(found):
    elsewhere = replace(found.saddle, start=(found.saddle.start[0] + 2e-5,))
    assert replace(found, saddle=elsewhere).checks["saddle"] is None


def test_a_table_of_several_components_is_refused(found):
    with pytest.raises(ValueError, match="several components"):
        replace(found, scene=Scene("cuspless"))


BENT = Scene("egg", alpha="0.08", law="-lam*eta*(1 - eta**2/40)")


def test_the_branch_of_a_crisis_under_another_law_is_one_of_its_map(found):
    """A point and its image a round later, turned, by the map of the kernels."""
    bent = replace(
        found, scene=BENT, saddle=replace(found.saddle, start=(-0.19822,)), lam=(Fraction(31, 50), Fraction(17, 25))
    )
    plane = bent.map.over(FLOAT64)
    bent = replace(bent, saddle=replace(bent.saddle, start=tuple(saddle(bent.saddle, plane, 0.62).points)))
    branch = bent._branch(bent._continued()[0], bent.lam[0], 160)
    ((theta, phi), (theta1, phi1)) = bent._launched(branch, np.array([-1.0, 0.0]), np.array([-1.0, 0.0]))
    step = PinballMap(BENT, lam=0.62, kernels=False).step(float(theta.mid()), float(phi.mid()))

    assert abs(np.sin((step.theta - float(theta1.mid()) - 2 * np.pi / 3) / 2)) < 1e-13
    assert abs(step.phi - float(phi1.mid())) < 1e-13
    assert "phi = -eta*lam*(1 - eta**2/40)" in bent.name
    assert BoundaryCrisis.from_dict(bent.to_dict()) == bent


@pytest.mark.parametrize(
    ("law", "said"),
    [("-lam*eta + cos(3*theta)/20", "a round turns the table"), ("-lam*eta + s/50", "turns"), ("-eta", "by a margin")],
)
def test_a_law_without_the_crisis_hypotheses_is_refused(found, law, said):
    with pytest.raises(ValueError, match=said):
        replace(found, scene=Scene("egg", alpha="0.08", lam="1/2", law=law))


def test_nothing_leaves_below_the_crisis(found):
    """Above and below are told apart: at 0.65 the orbit that leaves at 0.663 is kept."""
    assert replace(found, lam=(BELOW, Fraction(13, 20))).checks["leaves"] is None
    with pytest.raises(ValueError, match="none of 20000 orbits along the branch leaves"):
        bracket(EGG, TRIANGLE, 1, (BELOW, Fraction(13, 20)), GRID)


@pytest.mark.parametrize("shift", [(1, 5), (1, 2)])
def test_a_turn_that_is_no_symmetry_of_the_table_is_refused(found, shift):
    """By the rule alone the points of such a round would be no orbit."""
    orbit = replace(TRIANGLE, closure=Closure(1, shift))
    with pytest.raises(ValueError, match="a turn of the table"):
        replace(found, saddle=orbit)


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "trapping region"},
        {"side": 2},
        {"lam": ["0.7", "0.6"]},
        {"lam": ["1/0", "1/2"]},
        {"lam": ["1/2"]},
        {"start": 1.5},
        {"columns": 0},
        {"sink": [1.0]},
    ],
    ids=lambda change: next(iter(change)),
)
def test_a_damaged_document_is_refused(found, change):
    with pytest.raises(ValueError, match=r"^(certificate|crisis): "):
        BoundaryCrisis.from_dict(found.to_dict() | change)


@pytest.mark.parametrize(
    "changed",
    [
        {"side": 0},
        {"lam": (Fraction(0), ABOVE)},
        {"lam": (ABOVE, BELOW)},
        {"lam": (BELOW, BELOW)},
        {"lam": (BELOW, Fraction(1))},
        {"start": 1.5},
        {"saddle": replace(TRIANGLE, start=TRIANGLE.start * 2)},
        {"saddle": replace(TRIANGLE, closure=Closure(-1, TRIANGLE.closure.shift))},
        {"saddle": replace(TRIANGLE, closure=Closure(1, (1, 5)))},
        {"sink": (float("nan"), 0.0)},
        {"sink": (10.0, 0.0)},
        {"saddle": replace(TRIANGLE, start=(-10.0,))},
    ],
)
def test_each_hypothesis_of_the_statement_is_asked_when_it_is_made(changed):
    stated = BoundaryCrisis(EGG, TRIANGLE, 1, (BELOW, ABOVE), *GRID, 0.5, (0.0, 0.0))
    with pytest.raises(ValueError, match="crisis: "):
        replace(stated, **changed)
    assert {replace(stated, side=side, start=end).start for side, end in ((1, 0.0), (-1, 1.0))} == {0.0, 1.0}
    for shift in ((4, 3), (-1, 3), (0, 1)):  # up to whole turns
        assert replace(stated, saddle=replace(TRIANGLE, closure=Closure(1, shift))).side == 1


@dataclass(frozen=True)
class Cycle:
    """In the place of an enclosed saddle."""

    orbit: object
    points: tuple[acb, ...]
    lam: arb


@pytest.mark.parametrize("wrong", [None, *range(6)])
def test_a_saddle_is_continued_only_while_every_two_that_overlap_are_proved_to_be_one_cycle(monkeypatch, wrong):
    """Of three parts of the range each is compared with the saddle at its lower and at its upper end."""
    asked, lams = [], []

    def enclosed(orbit, map, lam):
        lams.append(lam.real)
        return Cycle(orbit, (acb(orbit.start[0]),), lam.real)

    monkeypatch.setattr(crisis, "CUTS", 3)
    monkeypatch.setattr(crisis, "complex_balls", lambda _: None)
    monkeypatch.setattr(crisis, "enclosed_saddle", enclosed)
    monkeypatch.setattr(crisis, "one_cycle", lambda *pair: asked.append(pair) or len(asked) - 1 != wrong)
    monkeypatch.setattr(BoundaryCrisis, "map", type("", (), {"over": lambda *_: None})())
    stated = BoundaryCrisis(EGG, TRIANGLE, 1, (BELOW, ABOVE), *GRID, 0.5, (0.0, 0.0))

    if wrong is None:
        first, last = stated._continued()
        assert first.points[0].real.contains(arb(TRIANGLE.start[0]))
        assert len(asked) == 6
        assert [first.lam.contains(lams[0]), last.lam.contains(lams[-1])] == [True, True]
        ends = [BELOW + (ABOVE - BELOW) * Fraction(k, 3) for k in range(4)]
        for k, at in enumerate(ends):
            assert abs(lams[2 * k] - arb(at.numerator) / at.denominator) < 1e-15
        for around, low, high in zip(lams[1::2], lams[::2], lams[2::2], strict=False):
            assert around.contains(low)
            assert around.contains(high)
            assert float(around.rad()) * 2 < float(high - low) * 1.001
    else:
        with pytest.raises(TooWideError, match="the cycle at an end may be another"):
            stated._continued()


@pytest.mark.parametrize(
    ("bounces", "held"),
    [((0.5,), True), ((0.1, 0.1, 0.5), True), ((0.1,) * 400, False), ((Refusal.WIDE, 0.5), False), ((None, 0.5), False),
     ((0.1, Refusal.UNPROVED, 0.5), False), ((float("inf"), 0.5), True)],
)  # fmt: skip
def test_an_orbit_enters_cells_where_each_landing_on_its_way_is_proved(monkeypatch, bounces, held):
    """Cells about `theta = 1/2`; None lands on a join."""

    @dataclass
    class Landing:
        theta: arb
        phi: arb
        code: int = 0

    class Map:
        orbit = EnclosedMap.orbit

        def __init__(self, map, lam, bits):
            self.left = [x if isinstance(x, Refusal) else Landing(arb(x or 0), arb(0), int(x is None)) for x in bounces]

        def start(self, theta, phi):
            return Landing(theta, phi)

        def bounce(self, here):
            return self.left.pop(0)

    grid = Grid((Chart("turning", (-np.pi, np.pi), (-1.0, 1.0), True, True),), 64, 8)
    x = (np.arange(64) + 0.5) / 64 * 2 * np.pi - np.pi
    monkeypatch.setattr(crisis, "EnclosedMap", Map)
    monkeypatch.setattr(crisis, "PinballMap", lambda *_, **__: None)
    cells = grid, np.broadcast_to((np.abs(x - 0.5) < 0.25)[None, :, None], (1, 64, 8))

    assert enters(EGG, ABOVE, (arb(0), arb(0)), cells) is held


MISSING = {  # what goes wrong, and the items of the list that are open then
    "_continued": set(CHECKS),
    "_branch": set(CHECKS) - {"saddle"},
    "seed": {"taken", "apart", "leaves"},
    "taken": {"taken", "apart", "leaves"},
    "kept": {"kept", "apart", "leaves"},
    "_next": {"kept", "apart", "leaves"},
    "_meets": {"apart"},
    "_leaves": {"leaves"},
    "": set(),
}


@pytest.mark.parametrize("wrong", MISSING, ids=lambda wrong: wrong or "nothing")
def test_each_step_of_the_proof_that_fails_leaves_its_items_open(monkeypatch, wrong):
    def unless(name, value, other=None):
        def made(*_):
            if name == wrong and other is None:
                raise ArithmeticError
            return other if name == wrong else value

        return made

    where, asked, seeds = (arb(0), arb(0)), [], []
    stated = BoundaryCrisis(EGG, TRIANGLE, 1, (BELOW, ABOVE), *GRID, 0.5, (2.0 if wrong == "seed" else 0.0, 0.25))
    monkeypatch.setattr(crisis, "PinballImages", lambda scene, lam: lam)

    def boxed(points):
        seeds.append(points)
        return None if wrong == "seed" and points[0][0] > 1 else points

    monkeypatch.setattr(crisis, "boxed", boxed)
    monkeypatch.setattr(crisis, "_next", lambda *_: None if wrong == "_next" else where)
    monkeypatch.setattr(crisis, "_meets", lambda *_: wrong == "_meets")
    steps = {
        "_continued": unless("_continued", ("first", "last")),
        "_branch": unless("_branch", None) if wrong == "_branch" else lambda self, *given: given[:2],
        "_launched": lambda self, *given: asked.append(given) or [where],
        "_turned": lambda self, points: points,
        "_leaves": lambda self, *given: asked.append(given) or wrong != "_leaves",
        "_grown": lambda self, lam, start: None if wrong == ("kept" if lam == (BELOW, BELOW) else "taken") else lam,
    }
    for name, step in steps.items():
        monkeypatch.setattr(BoundaryCrisis, name, step)

    assert {item for item, value in stated.checks.items() if value is not True} == MISSING[wrong]
    assert set(stated.checks.values()) <= {True, None}
    assert stated.proved is (wrong == "")
    if wrong == "":  # all of a piece from a point to its image is followed
        (branch, low, high), last = asked
        assert (branch, low[0], high[-1]) == (("first", BELOW), 0, 1)
        assert last == (("last", ABOVE), (BELOW, ABOVE))
        assert [float(x) for x in seeds[0][0]] == [0.0, 0.25]
        assert np.array_equal(low[1:], high[:-1])
        assert np.all(low < high)


def test_an_orbit_along_the_branch_leaves_from_its_start_at_the_upper_contraction(monkeypatch):
    asked, stated = [], BoundaryCrisis(EGG, TRIANGLE, -1, (BELOW, ABOVE), *GRID, 0.25, (0.5, -0.25))
    branch = SimpleNamespace(points=lambda *given: asked.append(given) or [("theta", "phi")])
    for held in (True, False):
        monkeypatch.setattr(crisis, "enters", lambda *given, held=held: asked.append(given) or held)
        assert stated._leaves(branch, "taken") is held
    assert asked == [(-1, [0.25], [0.25]), (EGG, ABOVE, ("theta", "phi"), "taken")] * 2
    monkeypatch.setattr(crisis, "grown", lambda *given: given)
    assert stated._grown("map", "start") == ("map", GRID, "start")
    again = BoundaryCrisis.from_dict(json.loads(json.dumps(stated.to_dict())))
    assert again == stated
    ends = replace(stated, columns=crisis.GRID["columns"], rows=crisis.GRID["rows"], parts=16)
    assert BoundaryCrisis.from_dict(ends.to_dict()) == ends
    for name in ("columns", "rows", "parts"):
        with pytest.raises(ValueError, match=f"{name} holds"):
            BoundaryCrisis.from_dict(ends.to_dict() | {name: getattr(ends, name) + 1})
