"""What leaves the upper join below `lambda*`, step by step: which starts are followed, and what proves it."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats
from flint import arb

from numeric import PinballMap
from verification.arithmetic.balls import working
from verification.proofs.corner.corner import ARC, BITS, WALL, enclosed
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.graph import sparse
from verification.proofs.starts import below_star
from verification.proofs.starts.below_star import ANGLE, NEXT, TOP, BelowStar, unreturning
from verification.proofs.starts.parallelograms import Parallelograms

EDGE, MIDDLE = 2.0, below_star.MIDDLE
#         chart, from theta, to, from phi, to, a leaf, is it about a start
CELLS = ((ARC, 1.5, EDGE, -0.01, 0.01, True, True),
         (ARC, 1.5, EDGE - 1e-9, -0.01, 0.01, True, True),
         (ARC, 1.5, EDGE - 2e-9, -0.01, 0.01, True, False),
         (ARC, 1.5, EDGE, -0.1, -ANGLE, True, True),
         (ARC, 1.5, EDGE, -0.1, -ANGLE - 1e-9, True, False),
         (ARC, 1.5, EDGE, ANGLE, 0.1, True, True),
         (ARC, 1.5, EDGE, ANGLE + 1e-9, 0.1, True, False),
         (ARC, 1.5, EDGE, -0.1, 0.1, True, True),
         (ARC, 1.5, EDGE, -0.01, 0.01, False, False),
         (WALL, 1.5, EDGE, -0.01, 0.01, True, False))  # fmt: skip


def graph_of(cells, reached, recurrent, edges=(), asked=None):
    """A graph of boxes `(chart, from theta, to, from phi, to)`, of which walks come to some."""
    chart, left, right, low, high = (np.array(x) for x in zip(*(cell[:5] for cell in cells), strict=True))
    boxes, count = Boxes(chart, (left, right), (low, high)), len(cells)
    among = lambda some: np.isin(np.arange(count + 1), some)  # noqa: E731
    links = [np.array(side, dtype=np.int32) for side in zip(*edges, strict=True)] or [np.zeros(0, dtype=np.int32)] * 2
    return SimpleNamespace(
        cells=SimpleNamespace(chart=chart), grid=SimpleNamespace(boxes=lambda _: boxes),
        leaf=np.ones(count, dtype=bool),
        reached=lambda first: (asked.append(first) if asked is not None else None) or among(reached),
        recurrent=among(recurrent), edges=sparse(*links, count + 1),
    )  # fmt: skip


def fate_of(graph, parts=(), sinks=True) -> SimpleNamespace:
    charts = SimpleNamespace(x=(-EDGE, EDGE)), SimpleNamespace(x=(-1.0, 1.0))
    return SimpleNamespace(graph=graph, map=SimpleNamespace(charts=charts), parts=parts, checks={"sinks": sinks})


def test_walks_begin_in_all_leaves_about_the_join_at_small_angles():
    asked = []
    graph = graph_of(CELLS, (), (), asked=asked)
    graph.leaf = np.array([cell[5] for cell in CELLS])
    assert not unreturning(fate_of(graph), None)  # walks come nowhere: there is nothing about the orbit
    assert asked[0].tolist() == [cell[6] for cell in CELLS] + [False]


@pytest.mark.parametrize(("reached", "recurrent", "within", "held"), [
    ((0, 1), (0, 1), True, True), ((0, 1), (1,), True, True), ((0, 1), (0, 1), False, False), ((0,), (1,), True, False),
    ((0, 2), (0, 2), True, False), ((0, 2), (0,), True, True), ((), (), True, False),
])  # fmt: skip
def test_without_a_core_all_boxes_that_return_lie_in_sinks(monkeypatch, reached, recurrent, within, held):
    """Of two boxes; the vertex after them is what is outside of all."""
    asked = []
    monkeypatch.setattr(
        below_star, "_within", lambda boxes, parts: asked.append((boxes.x[0].tolist(), parts)) or within
    )
    graph = graph_of([(WALL, 0.0, 0.5, 0, 0.5), (WALL, 0.5, 1.0, 0, 0.5)], reached, recurrent)
    assert unreturning(fate_of(graph, parts="parts"), None) is held
    both = [x for k, x in ((0, 0.0), (1, 0.5)) if k in reached and k in recurrent]
    assert asked in ([(both, "parts")], [])
    assert asked or not held


ARCS = ((ARC, -0.5, 0.5, 0, 0.5), (ARC, 0.25, 0.75, 0, 0.5), (WALL, 0, 0.25, 0, 0.5), (WALL, 0.25, 0.5, 0, 0.5))


@pytest.mark.parametrize(("change", "held"), [
    ({}, True),
    ({"edges": [(0, 2), (2, 1), (1, 3), (3, 3)]}, True),
    ({"edges": [(0, 1)]}, False),  # from the arc to the arc
    ({"edges": [(0, 0)]}, False),
    ({"cells": ((ARC, -0.5, MIDDLE, 0, 0.5), *ARCS[1:])}, False),
    ({"cells": ((ARC, -MIDDLE, 0.5, 0, 0.5), *ARCS[1:])}, False),
    ({"cells": ((ARC, -0.5, 0.99 * MIDDLE, 0, 0.5), *ARCS[1:])}, True),
    ({"cells": (*ARCS[:3], (WALL, 5.0, 6.0, 0, 0.5))}, True),  # beyond the middle of the arc is asked of the arc alone
    ({"inside": (True, False)}, False),
    ({"attracts": {"one": True, "other": False}}, False),
    ({"parts": None}, False),
    ({"sinks": None}, True),
])  # fmt: skip
def test_with_a_core_all_boxes_of_the_wall_that_return_lie_in_it_and_none_stays_on_the_arc(monkeypatch, change, held):
    given = {"cells": ARCS, "edges": [], "inside": (True, True), "attracts": {"one": True, "other": True}, "parts": (),
             "sinks": True} | change  # fmt: skip
    monkeypatch.setattr(below_star, "attracts", lambda map, core: given["attracts"])
    asked = []
    core = SimpleNamespace(holds=lambda sets: asked.append(sets) or np.array(given["inside"]))
    graph = graph_of(given["cells"], range(4), range(4), given["edges"])
    assert unreturning(fate_of(graph, given["parts"], given["sinks"]), core) is held
    assert not asked or asked[0].chart.tolist() == [WALL, WALL]


def ranges(*ends):
    return tuple((SimpleNamespace(lam=tuple(map(Fraction, pair))), None) for pair in ends)


@pytest.mark.parametrize(("fates", "joins"), [
    (ranges((0, "0.03"), ("0.03", NEXT)), True), (ranges((0, NEXT)), True), ((), False),
    (ranges((0, "0.03"), ("0.031", NEXT)), False), (ranges((0, "0.03"), ("0.029", NEXT)), False),
    (ranges(("0.001", NEXT)), False), (ranges((0, "0.0687")), False), (ranges((0, "0.0689")), False),
])  # fmt: skip
def test_graphs_are_of_all_contractions_up_to_the_next_range(monkeypatch, fates, joins):
    monkeypatch.setattr(below_star, "unreturning", lambda fate, core: True)
    monkeypatch.setattr(below_star, "attracts", lambda *_: {"one": True})
    monkeypatch.setattr(below_star, "TOP", Fraction("0.07"))  # below lambda*: nothing else is asked
    found = BelowStar(fates, None)
    assert found.checks == {
        name: True if name == "core" or (name == "boxes" and joins) else None for name in found.checks
    }
    assert not found.proved


@pytest.mark.parametrize("held", [(True, True), (True, False), (False, True)])
def test_each_of_the_graphs_proves_its_range(monkeypatch, held):
    fates, answers = ranges((0, "0.03"), ("0.03", NEXT)), iter(held)
    monkeypatch.setattr(below_star, "unreturning", lambda fate, core: next(answers))
    monkeypatch.setattr(below_star, "attracts", lambda *_: {"one": True})
    monkeypatch.setattr(below_star, "TOP", Fraction("0.07"))
    assert BelowStar(fates, None).checks["boxes"] is (all(held) or None)


@pytest.mark.parametrize("failing", ["hulls", "first_hull", "_exits"])
def test_where_a_ball_is_too_wide_what_was_proved_before_stays(monkeypatch, failing):
    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(below_star, "attracts", lambda *_: {"one": True})
    for name in ("hulls", "first_hull"):
        monkeypatch.setattr(below_star, name, broken if name == failing else lambda *_: None)
    for name in ("inner", "begins"):
        monkeypatch.setattr(below_star, name, lambda *_: True)
    monkeypatch.setattr(BelowStar, "_exits", broken if failing == "_exits" else lambda _: True)
    found = {name for name, held in BelowStar((), None).checks.items() if held}
    assert found == {"hulls": {"core"}, "first_hull": {"core", "inner"}, "_exits": {"core", "inner", "starts"}}[failing]


def test_the_map_of_what_is_carried_is_that_of_the_contractions_up_to_above_lambda_star(monkeypatch):
    asked = []
    monkeypatch.setattr(below_star, "attracts", lambda images, core: asked.append(images) or {"one": False})
    monkeypatch.setattr(below_star, "hulls", lambda depth: asked.append(depth) or 1 / 0)
    assert BelowStar((), None).checks["core"] is None
    assert asked[0].range == (NEXT, TOP)
    assert float(asked[1].mid()) == pytest.approx(float(enclosed()[1].mid()) - float(NEXT), rel=1e-9)
    assert float(NEXT) < float(enclosed()[1].mid()) < float(TOP)


@pytest.mark.parametrize(("home", "lost", "carried"), [
    ({0: 1, 1: 3, 2: 2}, {}, True), ({0: 0, 1: 0, 2: 0}, {}, True), ({0: 1, 1: 3}, {}, False),
    ({0: 1, 1: 3, 2: 2}, {1: 2}, False), ({0: 1, 1: 2, 2: 2}, {1: 3}, True),
])  # fmt: skip
def test_what_leaves_the_join_is_carried_until_all_of_it_is_in_the_core(monkeypatch, home, lost, carried):
    """Three sets, by the bounce at which each is in the core, or is lost."""
    begun, bounce, names = [], [0], [floats(0, 1, 2)]

    def enters(sets):
        if not begun:
            begun.append(sets)
        inside = np.array([home.get(int(k), 99) <= bounce[0] for k in names[0]])
        names[0] = names[0][~inside]
        return inside

    def moved(map, sets):
        bounce[0] += 1
        rest = np.array([[np.inf if lost.get(int(k)) == bounce[0] else 0.0 for k in names[0]]] * 2)
        return np.arange(names[0].size), Parallelograms(sets.chart, sets.middle, sets.sides, rest)

    monkeypatch.setattr(below_star, "moved", moved)
    monkeypatch.setattr(below_star, "MOST_BOUNCES", 5)
    map = SimpleNamespace(charts=(SimpleNamespace(x=(-1.0, 2.0)), SimpleNamespace(x=(-9.0, 9.0))))
    made = BelowStar((), SimpleNamespace(enters=enters))
    low, high = floats(-0.25, 0.0, 0.25), floats(0.0, 0.25, 0.5)
    assert made._carried(map, low, high) is carried
    boxes = begun[0].boxes()
    assert boxes.chart.tolist() == [ARC] * 3
    assert np.all((boxes.x[0] < 2.0) & (boxes.x[0] > 2.0 - 1e-12))
    assert np.all((boxes.x[1] > 2.0) & (boxes.x[1] < 2.0 + 1e-12))
    assert np.all((boxes.y[0] <= low) & (boxes.y[0] > low - 1e-12))
    assert np.all((boxes.y[1] >= high) & (boxes.y[1] < high + 1e-12))


@pytest.mark.parametrize("last", [4, 5])
def test_sets_are_carried_as_often_as_is_said_and_no_more(monkeypatch, last):
    count = []
    monkeypatch.setattr(below_star, "moved", lambda map, sets: (count.append(0), sets))
    monkeypatch.setattr(below_star, "MOST_BOUNCES", 5)
    enters = lambda sets: np.full(sets.chart.size, len(count) >= last)  # noqa: E731
    map = SimpleNamespace(charts=(SimpleNamespace(x=(-1.0, 2.0)),))
    assert BelowStar((), SimpleNamespace(enters=enters))._carried(map, floats(0), floats(1)) is (last < 5)


def test_derivatives_of_inner_states_are_those_of_all_of_them(monkeypatch):
    """Of either side of the corner with its own boxes; what is found of each is joined entry by entry."""
    asked = {ARC: [], WALL: []}

    def followed(component, u, v, e):
        asked[component].append((u, v, e))
        number = len(asked[component])
        slope = lambda k: [arb(100 * k + 10 * i + number + 1000 * component) for i in range(3)]  # noqa: E731
        return [[SimpleNamespace(slopes=slope(0)), SimpleNamespace(slopes=slope(1))]]

    monkeypatch.setattr(below_star, "followed", followed)
    depth = arb("0.0024")
    found = below_star.hulls(depth)
    assert set(found) == {ARC, WALL}
    rng = np.random.default_rng(1)
    for component, low, high in ((ARC, below_star.V_LOW, 0.0), (WALL, 0.0, below_star.V_HIGH)):
        boxes = asked[component]
        for share in [(0, 0, 0), (1, 1, 1), *rng.random((20, 3))]:
            point = (2 * share[0] - 1) * below_star.U_END, low + share[1] * (high - low), -share[2] * 0.0024
            assert any(all(ball.contains(arb(x)) for ball, x in zip(box, point, strict=True)) for box in boxes)
        assert all(low - 1e-9 < box[1] and box[1] < high + 1e-9 for box in boxes)
        assert all(box[2] < 1e-9 and box[2] > -0.0025 for box in boxes)
        for k in (0, 1):
            for i in range(3):
                ends = [100 * k + 10 * i + n + 1000 * component for n in (1, len(boxes))]
                assert float(found[component][k][i].lower()) == pytest.approx(ends[0], abs=0.01)
                assert float(found[component][k][i].upper()) == pytest.approx(ends[1], abs=0.01)


def test_the_deepest_contraction_is_below_the_range():
    for depth in (arb("0.0024"), arb("0.0024", 1e-5)):
        end = below_star._end(depth)
        assert arb(end) > depth.upper()
        assert end < float(depth.upper()) * (1 + 1e-9)


def test_a_particle_that_leaves_the_join_at_the_angle_of_a_chord_lands_at_its_other_end():
    map = PinballMap("cuspless", lam="0.07")
    for at in (-1.5, -0.5, 0.5, 1.2):
        with working(BITS):
            phi = float(below_star._leaving(arb(at)).mid())
        step = map.step(np.array([2 * np.pi / 3]), np.array([phi]), np.array([ARC]))
        assert step.theta[0] == pytest.approx(at, abs=1e-6)


@pytest.mark.parametrize("e", [0.0, 0.001, 0.0023])
def test_derivatives_of_the_first_landing_hold_difference_quotients(e):
    """By `U` and the contraction, of where a particle of the join comes next to the lower corner, up to a sign."""
    with working(BITS):
        theta1, star = (float(x.mid()) for x in enclosed())
        depth = enclosed()[1] - arb(NEXT.numerator) / NEXT.denominator
        r, c = below_star.first_hull(depth)

    def beyond(u, lam):
        with working(BITS):
            phi = float(below_star._leaving(arb(theta1 - u)).mid())
        orbit = PinballMap("cuspless", lam=lam).orbit(np.array([2 * np.pi / 3]), np.array([phi]), 2, np.array([ARC]))
        end = -2 * np.pi / 3 if orbit.component[2, 0] == ARC else 3 * 3**0.5 / 4
        return float(orbit.theta[2, 0] - end), int(orbit.component[2, 0])

    step, seen = 1e-6, []
    for u in (-0.0159, -0.008, 0.004, 0.0158):
        (after, one), (before, two) = beyond(u + step, star - e), beyond(u - step, star - e)
        (later, three), (sooner, four) = beyond(u, star - e + step), beyond(u, star - e - step)
        assert one == two == three == four
        seen.append(((after - before) / (2 * step), (later - sooner) / (2 * step)))
    signs = {np.sign(x[0]) for x in seen}
    assert len(signs) == 1
    sign = signs.pop()
    for by_u, by_e in seen:
        assert float(r.lower()) - 1e-4 < sign * by_u < float(r.upper()) + 1e-4
        assert float(c.lower()) - 1e-4 < sign * by_e < float(c.upper()) + 1e-4
    assert float(r.rad()) < 0.2
    assert float(c.rad()) < 0.2


SIZES = {"K": 2.0, "U_END": 0.0625, "V_LOW": -0.03125, "V_HIGH": 0.03125, "LEAN": 0.75, "THICK": 0.0078125,
         "FAR": 0.125, "BESIDE": 0.015625}  # fmt: skip
INNER = {"a": 0.0625, "b": 0.5, "c": 0.5, "f": 0.125, "g": 1.5, "h": 2.0}
NUDGE = 2.0**-20


def sized(monkeypatch, numbers: dict) -> dict:
    """The sizes, of few bits, some of them changed; the other numbers are told."""
    for name, size in (SIZES | {name: x for name, x in numbers.items() if name in SIZES}).items():
        monkeypatch.setattr(below_star, name, size)
    return {name: arb(x) for name, x in numbers.items() if name not in SIZES}


@pytest.mark.parametrize(("numbers", "name", "way"), [
    ({"a": 0.25, "b": 0.5, "c": 0.75, "THICK": 0.03125}, "b", 1), ({"a": 0.25, "b": 0.75, "THICK": 0.03125}, "c", 1),
    ({"U_END": 0.015625, "b": 0.4375}, "b", -1), ({"FAR": 0.05859375}, "FAR", 1), ({"b": 0.9375}, "b", -1),
    ({"c": 1.3125}, "c", -1), ({"THICK": 0.00390625}, "THICK", 1), ({"wall": 1.0}, "wall", 1),
    ({"V_LOW": -0.115234375, "FAR": 1.0}, "V_LOW", 1), ({"V_HIGH": 0.115234375, "FAR": 1.0}, "V_HIGH", -1),
    ({"FAR": 0.181640625, "V_LOW": -0.11328125, "b": 0.125 + NUDGE}, "FAR", 1),
])  # fmt: skip
def test_inequalities_of_inner_states_are_strict(monkeypatch, numbers, name, way):
    """At the border nothing is proved, and next to it all is; growth on the wall is asked for itself."""
    for step, held in ((0.0, False), (way * NUDGE, True)):
        told = INNER | numbers
        given = sized(monkeypatch, told | {name: (SIZES | told)[name] + step})
        a, b, c, f, g, h = (given[x] for x in "abcfgh")
        sides = ((ARC, -1, g), (WALL, 1, given.get("wall", g)))
        whole = {side: [[a, sign * b, -c], [f, sign * grows, -h]] for side, sign, grows in sides}
        assert below_star.inner(whole, arb(1) / 512) is held


@pytest.mark.parametrize("name", ["a", "b", "c", "f", "g", "h"])
@pytest.mark.parametrize("side", [ARC, WALL])
def test_derivatives_of_inner_states_are_positive(monkeypatch, name, side):
    for value, held in ((INNER[name], True), (0.0, False), (-0.0625, False)):
        sized(monkeypatch, {})
        whole = {}
        for of, sign in ((ARC, -1), (WALL, 1)):
            a, b, c, f, g, h = (arb(x) for x in (INNER | ({name: value} if of == side else {})).values())
            whole[of] = [[a, sign * b, -c], [f, sign * g, -h]]
        assert below_star.inner(whole, arb(1) / 512) is held


@pytest.mark.parametrize(("numbers", "name", "way"), [
    ({"r": 2.0}, "r", -1), ({"U_END": 0.015625}, "U_END", 1), ({"FAR": 0.029296875}, "FAR", 1),
    ({"r": 2.0, "V_LOW": -0.0625, "LEAN": 0.5}, "LEAN", 1), ({"V_HIGH": 0.001953125}, "V_HIGH", 1),
    ({"c": 3.5}, "c", -1), ({"r": 2.0, "V_LOW": -0.0625, "K": 0.5, "c": 0.75}, "K", 1), ({"c": 0.0}, "c", 1),
    ({"V_LOW": -0.02734375}, "V_LOW", -1),
])  # fmt: skip
def test_inequalities_of_the_first_landing_are_strict(monkeypatch, numbers, name, way):
    for step, held in ((0.0, False), (way * NUDGE, True)):
        told = {"r": 1.75, "c": 1.0} | numbers
        given = sized(monkeypatch, told | {name: (SIZES | told)[name] + step})
        assert below_star.begins([given["r"], -given["c"]], arb(1) / 512) is held
