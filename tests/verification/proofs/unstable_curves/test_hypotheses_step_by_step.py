"""Hypotheses of the lemma on attractors: each fails alone, and curves are followed until all have crossed."""

from types import SimpleNamespace

import numpy as np
import pytest

from verification.proofs.global_dynamics.boxes import Boxes, Chart
from verification.proofs.unstable_curves import no_two_attractors as room
from verification.proofs.unstable_curves.anchor import Anchor
from verification.proofs.unstable_curves.growth import Growth
from verification.proofs.unstable_curves.no_two_attractors import REFUSED, NoTwoAttractors, continuous, crossing
from verification.proofs.unstable_curves.spans import Spans

CHARTS = tuple(Chart(name, ends, (-1.0, 1.0)) for name, ends in (("a", (-1.0, 0.0)), ("b", (3.0, 5.0)), ("c", (0, 1))))
START = Boxes(np.zeros(1, int), (np.zeros(1),) * 2, (np.zeros(1),) * 2)
AT = Anchor(0, -0.75, -0.5, -1.0, 1.0)
HELD = {
    "region": SimpleNamespace(),
    "wide": SimpleNamespace(),
    "growth": Growth((2.0, 0.5), 1),
    "anchor": AT,
    "astray": 0,
}


def table(joins=((0, 1), (1, 2)), charts=CHARTS, one_to_one=True):
    """A map of which only its charts are known."""
    return SimpleNamespace(charts=charts, joins=joins, homeomorphism=one_to_one, label="a map")


def stated(map=None, **known):
    """What is to be proved, with what is known of it."""
    found = NoTwoAttractors(map or table(), 8, 8, START, (0, -0.6, 0.0), 1, 0.1)
    found.__dict__.update(HELD | known)
    return found


@pytest.mark.parametrize(
    ("missing", "known"),
    [
        (None, {}),
        ("continuous", {"map": table(one_to_one=False)}),
        ("cones", {"region": "no cones: they grow without end"}),
        ("growth", {"growth": None}),
        ("growth", {"growth": Growth((2.0, 1.0), 1)}),
        ("saddle", {"anchor": None}),
        ("crossing", {"astray": None}),
        ("crossing", {"astray": 1}),
    ],
)
@pytest.mark.parametrize("visited", [True, False])
def test_each_hypothesis_fails_alone_and_the_last_is_not_needed(monkeypatch, missing, known, visited):
    asked = []
    chances = SimpleNamespace(proved=visited)
    monkeypatch.setattr(room, "attraction", lambda *given: asked.append(given) or chances)
    found = stated(**known)
    assert list(found.needed) == ["continuous", "cones", "growth", "saddle", "crossing"]
    assert found.needed == {item: None if item == missing else True for item in found.needed}
    assert found.proved is (missing is None)
    known_enough = missing in (None, "continuous", "growth")
    assert found.checks == found.needed | {"visits": True if visited and known_enough else None}
    assert asked == ([(HELD["region"], HELD["wide"], AT)] if known_enough else [])
    if missing is None:
        assert "at most one attractor" in found.reason
    else:
        assert found.reason == f"a map: {known['region'] if missing == 'cones' else REFUSED[missing]}"


def test_nothing_is_asked_of_a_region_that_is_not_known(monkeypatch):
    for name in ("growth", "anchor", "crossing", "attraction"):
        monkeypatch.setattr(room, name, None)
    found = stated(region="no trapping region")
    for name in ("growth", "anchor", "astray"):
        del found.__dict__[name]
    assert (found.growth, found.anchor, found.astray) == (None, None, None)
    assert found.checks["visits"] is None
    assert found.reason == "a map: no trapping region"
    assert stated(table(one_to_one=False), region="no cones").reason == f"a map: {REFUSED['continuous']}"
    for name, value in (("wide", "no cones"), ("region", "no cones"), ("anchor", None)):
        assert stated(**{name: value}).checks["visits"] is None
    without = stated(anchor=None)
    del without.__dict__["astray"]
    assert without.astray is None


def test_cells_that_are_not_seen_to_come_to_the_rectangle_are_counted(monkeypatch):
    monkeypatch.setattr(room, "crossing", lambda region, at: np.array([True, False, True, False, False]))
    found = stated()
    del found.__dict__["astray"]
    assert found.astray == 3


def test_both_regions_grow_from_the_same_start_and_the_wide_one_reaches_further(monkeypatch):
    asked = []
    monkeypatch.setattr(room, "cover", lambda *given, **more: asked.append((given, more)) or "none")
    map = table()
    found = NoTwoAttractors(map, 8, 16, START, (0, -0.6, 0.0), 2, 0.1, 5)
    assert (found.region, found.wide) == ("none", "none")
    assert asked == [((map, 8, 16, START), {}), ((map, 8, 16, START), {"around": 5})]


@pytest.mark.parametrize(
    ("map", "held"),
    [
        (table(), True),
        (table(((0, 1), (1, 2), (2, 0))), True),
        (table(one_to_one=False), False),
        (table(((0, 1),)), False),
        (table(((0, 1), (2, 0))), False),
        (table(((0, 1), (1, 2), (2, 1))), False),
        (table(((0, 1), (1, 2), (0, 2))), False),
        (table(charts=(*CHARTS[:2], CHARTS[2]._replace(y=(-1.0, 2.0)))), False),
        (table((), CHARTS[:1]), True),
        (table(((0, 0),), CHARTS[:1]), True),
    ],
)
def test_charts_are_joined_each_to_the_next_at_the_same_heights(map, held):
    assert continuous(map) is held


def over(origins, low, high, chart=0):
    """Spans over one interval."""
    full = lambda x: np.full(len(origins), x)  # noqa: E731
    return Spans(np.array(origins, int), full(chart), full(low), full(high), (full(0.0),) * 2, (full(0.0),) * 2)


def joined(*some):
    """All of several sets of spans."""
    fields = [np.concatenate(column) for column in zip(*(each[:4] for each in some), strict=True)]
    ends = (np.zeros(fields[0].size),) * 2
    return Spans(*fields, ends, ends)


def test_curves_are_followed_until_each_has_a_part_across_the_rectangle(monkeypatch):
    """Of five cells one crosses at once, two after a bounce, one over another chart alone, one dies out."""
    steps = iter([
        joined(over([1, 2], -1.0, -0.5), over([3], -0.75, -0.5, chart=1), over([3], -0.75, -0.5625)),
        joined(over([3], -1.0, 0.0, chart=2)),
    ])  # fmt: skip
    asked, none = [], over([], 0.0, 0.0)

    class Walk:
        def columns(self):
            return joined(over([0], -0.75, -0.5), over([1, 2, 3, 4], -1.0, -0.75))

        def step(self, spans):
            asked.append(sorted(set(spans.origin.tolist())))
            return next(steps, none)

    monkeypatch.setattr(room, "Course", lambda region: Walk())
    region = SimpleNamespace(cells=SimpleNamespace(chart=np.zeros(5)))
    assert crossing(region, AT).tolist() == [True, True, True, False, False]
    assert asked == [[1, 2, 3, 4], [3], [3]]


def test_curves_are_not_followed_for_ever_nor_are_all_their_parts(monkeypatch):
    sizes = []

    class Walk:
        def columns(self):
            return over([0], -1.0, -0.9)

        def step(self, spans):
            sizes.append(spans.chart.size)
            return over([0] * 20, -1.0, -0.9)

    monkeypatch.setattr(room, "Course", lambda region: Walk())
    assert crossing(SimpleNamespace(cells=SimpleNamespace(chart=np.zeros(1))), AT).tolist() == [False]
    assert sizes == [1] + [room.BRANCHES] * (room.LONGEST - 1)
