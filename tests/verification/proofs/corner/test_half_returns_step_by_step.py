"""Half the return near its corner orbit, step by step: the boxes that are followed, hulls of slopes, steps of `e`."""

import math
import random
from types import SimpleNamespace

import pytest
from flint import arb

from verification.arithmetic.balls import cuts, working
from verification.proofs.corner import evidence, half_return
from verification.proofs.corner.border_collision import Expansion, Kind, Piece, exactly_convex
from verification.proofs.corner.corner import ARC, WALL, Quantity
from verification.proofs.corner.half_return import LONGEST_E, LONGEST_U, LONGEST_V, TINY

REGION = [(-0.5, -1.75), (1.0, -1.0), (2.0, 1.5), (0.25, 2.0)]


@pytest.mark.parametrize("component", [ARC, WALL])
@pytest.mark.parametrize("at", [(0.0, 2.0**-12), (2.0**-9, 2.0**-9 + 2.0**-12), (2.0**-9, 2.0**-9)])
def test_boxes_hold_all_multiples_of_one_side_of_a_region_and_are_no_longer_than_is_asked(component, at):
    """Also from a region that lies on that side alone, and of one that is a point of the border."""
    e, chance = arb((at[0] + at[1]) / 2, (at[1] - at[0]) / 2), random.Random(1)
    side = -1 if component == ARC else 1
    with working(64):
        for region in (REGION, [(0.25, 0.0)], [(20.0, 0.0), (21.0, 0.0), (20.0, side * 1.0)]):
            boxes = half_return._boxes(region, component, e)
            for _ in range(60):
                shares = [chance.random() for _ in region]
                u, v = (sum(s * p[k] for s, p in zip(shares, region, strict=True)) / sum(shares) for k in (0, 1))
                if v * side < 0:
                    continue
                f = chance.choice([*at, chance.uniform(*at)])
                point = arb(u) * f, arb(v) * f, arb(f)
                assert any(all(b.contains(x.mid()) for b, x in zip(box, point, strict=True)) for box in boxes)
            heights = [side * v for _, v in region]
            for u, v, time in boxes:
                assert time is e
                high = (side * v / e).mid() if at[0] else None
                assert high is None or -1e-6 < high < max(*heights, 0) + 1e-6
                assert v.rad() < LONGEST_V / 2 + max(map(abs, heights)) * e.rad() + 1e-9
                assert u.rad() < LONGEST_U / 2 + max(abs(u) for u, _ in region) * e.rad() + 1e-9
    assert len(half_return._boxes([(0.25, 0.0)], component, arb(0))) == 1


def image(*rows):
    """An image whose slopes by `(u, v, e)` are given, of both of its numbers."""
    return tuple(Quantity(arb(0), tuple(x if isinstance(x, arb) else arb(x) for x in row), arb(0)) for row in rows)


def test_the_family_has_the_hull_of_all_slopes_on_either_side_and_one_shift(monkeypatch):
    asked = []

    def boxes(region, component, e):
        asked.append((region, component, e))
        return [("box", component, e), ("other", component, e)]

    def followed(component, name, same, e):
        assert same == component
        more = (1 if name == "other" else 0) + (8 if component == WALL else 0)
        return [image((1 + more, 2 + more, 9), (3 + more, 4 + more, 9)), image((1.5, 2.5, 9), (3.5, 4.5, 9))]

    shifts = []
    monkeypatch.setattr(half_return, "_boxes", boxes)
    monkeypatch.setattr(half_return, "followed", followed)
    monkeypatch.setattr(half_return, "_shift", lambda *given: shifts.append(given) or (arb(5), arb(6)))
    region, e = [(-1.0, -1.0), (1.0, -1.0), (3.0, 1.0), (1.0, 1.0)], (2.5 * LONGEST_E, 4.5 * LONGEST_E)
    found = half_return.pieces(region, e)
    ((base, times),) = shifts

    assert set(found) == {ARC, WALL}
    assert base == 1.0  # the border is met from 0 to 2
    for component, high in ((ARC, 1), (WALL, 9)):
        piece = found[component]
        assert (piece.shift, piece.base) == ((arb(5), arb(6)), (arb(1), arb(0)))
        for n, entry in enumerate((*piece.rows[0], *piece.rows[1]), 1):
            low = n if component == ARC else n + 0.5
            assert (entry.contains(arb(low)), entry.contains(arb(n + high))) == (True, True)
            assert entry.rad() < (n + high - low) / 2 + 1e-6
    for component in (ARC, WALL):
        (_, first), *_, (_, last) = [(r, t) for r, c, t in asked if c == component and r is region]
        assert first.contains(arb(e[0]))
        assert last.contains(arb(e[1]))
        assert first.lower() > e[0] * 0.999
    assert [float(t.mid()) for t in times] == pytest.approx([float(t.mid()) for t in cuts(0.0, e[1], LONGEST_E)])
    assert times[0].contains(0)
    assert times[-1].contains(arb(e[1]))


@pytest.mark.parametrize(("e", "told"), [((0.0, 0.0), True), ((1e-3, 1e-3), True), ((0.0, 1e-3), True),
                                         ((-1e-9, 0.0), False), ((2e-3, 1e-3), False)])  # fmt: skip
def test_a_stretch_of_distances_is_one_from_0_on(monkeypatch, e, told):
    monkeypatch.setattr(half_return, "followed", lambda *_: [image((1, 2, 3), (4, 5, 6))])
    if told:
        assert half_return.pieces([(0.0, 0.0)], e)[ARC].trace.contains(6)
    else:
        with pytest.raises(ValueError, match="no stretch of distances above lambda-star"):
            half_return.pieces([(0.0, 0.0)], e)


def test_the_shift_is_the_mean_of_what_moves_along_the_border(monkeypatch):
    """`base*dH/dU + dH/de` over all times: with the slopes 2 and 3 (then 4 and 5), and 7 and 11."""
    asked = []

    def followed(component, u, v, e):
        asked.append((component, u, v, e))
        return [image((2 if len(asked) == 1 else 4, 99, 3 if len(asked) == 1 else 5), (7, 99, 11))]

    monkeypatch.setattr(half_return, "followed", followed)
    times = [arb(0.25, 0.25), arb(0.75, 0.25)]
    first, second = half_return._shift(0.5, times)

    assert [component for component, *_ in asked] == [ARC, ARC]
    assert all((u - 0.5 * t).contains(0) and v == 0 and e is t for (_, u, v, e), t in zip(asked, times, strict=True))
    assert all(abs(u.rad() - 0.125) < 1e-6 for _, u, *_ in asked)
    assert (first.contains(4), first.contains(7)) == (True, True)  # 0.5*2 + 3 and 0.5*4 + 5
    assert first.rad() < 1.5 + 1e-6
    assert abs(second - 14.5) < 1e-6


def test_a_mirrored_place_is_told_from_the_place_of_the_corner_orbit():
    at = Quantity(arb(0.5), (arb(2), arb(-3)), arb(0.5, 0.25))
    found = half_return._mirrored(at, arb(0.75))
    assert found.centre == 0.25
    assert found.slopes == (arb(-2), arb(3))
    assert (found.whole.contains(0), found.whole.contains(0.5), found.whole.rad() < 0.2501) == (True, True, True)


def regions(monkeypatch, fails, last, budget=200):
    """The stretches that are asked for when those of these numbers are not proved, and the answer."""
    asked, nears = [], []

    def step(near, e):
        asked.append(e)
        nears.append(near)
        return None if len(asked) - 1 in fails else (len(asked), half_return.Step(e, [], None, None))

    monkeypatch.setattr(half_return, "step", step)
    monkeypatch.setattr(half_return, "limit", lambda: 0)
    monkeypatch.setattr(half_return, "enclosed", lambda: (arb(0.25), arb(0.0625)))
    return half_return.trapping_region(last, budget), asked, nears


def test_steps_join_from_lambda_star_to_the_end_each_from_the_family_of_the_one_before(monkeypatch):
    found, asked, nears = regions(monkeypatch, (), 0.0625 + 5e-3)

    assert found.proved is True
    assert [step.e for step in found.steps] == asked
    assert [e[0] for e in asked] == [0.0, *(e[1] for e in asked[:-1])]
    lengths = [b - a for a, b in asked]
    assert lengths[:3] == pytest.approx([1e-3, 1.3e-3, 1.69e-3])  # longer by three tenths, up to 2e-3
    assert max(lengths) <= 2e-3 + 1e-12
    assert found.reached == asked[-1][1] > 5e-3
    assert found.reached < 5e-3 * (1 + 2.0**-39)
    assert nears == list(range(len(asked)))
    long = regions(monkeypatch, (), 0.0625 + 9e-3)[1]
    assert long[3][1] - long[3][0] == pytest.approx(2e-3)


def test_a_step_that_is_not_proved_is_halved_until_it_is_too_short(monkeypatch):
    found, asked, nears = regions(monkeypatch, (1, 2), 0.0625 + 2e-3)
    assert found.proved is True
    assert asked[:5] == [
        pytest.approx(e) for e in ((0, 1e-3), (1e-3, 2e-3), (1e-3, 1.65e-3), (1e-3, 1.325e-3), (1.325e-3, 1.7475e-3))
    ]
    assert nears[:5] == [0, 1, 1, 1, 4]
    never, asked, _ = regions(monkeypatch, range(1, 99), 0.0625 + 2e-3)
    assert (never.proved, never.reached, len(never.steps)) == (None, asked[0][1], 1)
    assert asked[-1][1] - asked[-1][0] == pytest.approx(1.3e-3 / 2**7)  # 1.3e-3/2**8 is below 1e-5
    few, asked, _ = regions(monkeypatch, (), 0.0625 + 5e-3, 2)
    assert (few.proved, len(few.steps), len(asked)) == (None, 2, 2)
    assert few.reached == asked[-1][1]


FAMILY = {part: Piece(((arb(0.5), arb(0)), (arb(0), arb(x))), (arb(0), arb(1))) for part, x in ((ARC, -3), (WALL, 2))}


@pytest.mark.parametrize("missing", [None, "extent", "exponents"])
def test_the_border_collision_is_told_where_its_attractor_and_its_exponents_are_enclosed(monkeypatch, missing):
    asked, region = [], [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)]
    bounds = SimpleNamespace(outer=region)
    monkeypatch.setattr(evidence, "limit", lambda: FAMILY)
    monkeypatch.setattr(evidence, "extent", lambda linear: None if missing == "extent" else bounds)
    monkeypatch.setattr(evidence, "exponents", lambda *given, **more: asked.append((given, more)) or (
        None if missing == "exponents" else (0.25, 0.5)))  # fmt: skip
    if missing:
        with pytest.raises(ArithmeticError, match=r"is not enclosed|is not proved to expand"):
            evidence.border.__wrapped__()
        return
    found = evidence.border.__wrapped__()
    assert (found.pieces, found.extent, found.exponent) == (FAMILY, bounds, (0.25, 0.5))
    assert (found.kind, found.robust) == (Kind.FOLD, evidence.robust(FAMILY))
    assert found.angles == pytest.approx(evidence._angles(region))
    assert asked == [((FAMILY, region), {"length": 9})]


def test_exit_angles_of_a_region_are_those_of_the_chord_at_its_corners_on_either_side(monkeypatch):
    """`-eta - star*(by_v*v + by_u*u)`, with slopes of its own on the arc and on the wall."""
    slopes = {ARC: (0.25, 2.0, -3.0), WALL: (0.125, -1.0, 0.5)}
    monkeypatch.setattr(evidence, "enclosed", lambda: (arb(0.5), arb(0.25)))

    def angle(here, there):
        assert there.component == ARC
        assert there.at.centre == -0.5
        return tuple(map(arb, slopes[here.component]))

    monkeypatch.setattr(evidence, "angle", angle)
    region = [(1.0, -2.0), (2.0, 1.0), (0.0, 3.0)]
    values = []
    for component, places in ((ARC, [(1, -2), (5 / 3, 0), (0.6, 0)]), (WALL, [(2, 1), (0, 3), (5 / 3, 0), (0.6, 0)])):
        eta, by_v, by_u = slopes[component]
        values += [-eta - 0.25 * (by_v * v + by_u * u) for u, v in places]
    low, high = evidence._angles(region)
    assert (low, high) == pytest.approx((min(values), max(values)), abs=1e-8)
    assert low <= min(values) < max(values) <= high


@pytest.mark.parametrize("missing", [None, "grown", "trapped"])
def test_strips_of_the_map_are_told_where_a_region_is_trapped_by_all_of_its_family(monkeypatch, missing):
    asked = []
    monkeypatch.setattr(evidence, "limit", lambda: "limit")
    monkeypatch.setattr(evidence, "grown", lambda *g: asked.append(g) or (None if missing == "grown" else "region"))
    monkeypatch.setattr(evidence, "pieces", lambda *g: asked.append(g) or "family")
    monkeypatch.setattr(evidence, "trapped", lambda *g: asked.append(g) or (None if missing == "trapped" else True))
    monkeypatch.setattr(evidence, "strips", lambda *g: asked.append(g) or "strips")
    assert evidence.strips_of_the_map(0.5) == (None if missing else "strips")
    assert asked[0][0] == "limit"
    if missing != "grown":
        assert asked[1:3] == [("region", (0.0, 0.5)), ("family", "region")]


@pytest.mark.parametrize(("least", "told"), [(1.0, False), (1.0 + 2.0**-20, True)])
def test_a_cone_whose_vectors_may_keep_their_length_proves_nothing(monkeypatch, least, told):
    monkeypatch.setattr(half_return, "grown", lambda *_: [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0)])
    monkeypatch.setattr(half_return, "pieces", lambda *_: FAMILY)
    monkeypatch.setattr(half_return, "trapped", lambda *_: True)
    monkeypatch.setattr(half_return, "expansion", lambda _: Expansion(arb(0), arb(least), arb(2)))
    found = half_return.step(FAMILY, (0.0, 1e-3))
    assert (found is not None) is told
    if told:  # the fixed point of the arc's piece: v = -3*v + 1
        assert found[0] is FAMILY
        assert found[1].cycle[1].contains(arb(0.25))
        assert TINY < 1e-6


def test_exponents_are_bounded_with_the_outer_ends_of_what_stretches_are_enclosed_by():
    steps = (half_return.Step((0.0, 1.0), [], Expansion(arb(0), arb(1.5, 0.25), arb(2, 0.5)), None),)
    least, most = half_return.TrappingRegion(True, 1.0, steps).exponent
    assert (least, most) == pytest.approx((math.log(1.25) / 2, math.log(2.5) / 2))


def test_exit_angles_count_with_the_outer_ends_of_their_balls(monkeypatch):
    monkeypatch.setattr(evidence, "enclosed", lambda: (arb(0.5), arb(0.25)))
    monkeypatch.setattr(evidence, "angle", lambda here, there: (arb(1, 0.5), arb(0), arb(1)))
    low, high = evidence._angles([(0.0, -1.0), (0.0, 1.0), (-2.0, 0.0)])
    assert (low, high) == pytest.approx((-1.5, 0.0), abs=1e-7)  # the second is -1/2 + 2/4


def test_saddles_are_sought_in_a_convex_polygon_across_the_border():
    """Brouwer's theorem wants a convex one, counterclockwise, and the mean value theorem starts on `v = 0`."""
    region = evidence.REGION
    k = region.index(min(region))
    assert exactly_convex(region) == region[k:] + region[:k]
    assert min(v for _, v in region) < 0 < max(v for _, v in region)
