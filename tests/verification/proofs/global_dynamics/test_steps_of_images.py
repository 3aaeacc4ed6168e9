"""Steps of outer images: rows clipped to the strip, laws over pieces, and what is asked of table and law."""

from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import ArrayOps, BallArray
from verification.proofs.global_dynamics import images
from verification.proofs.global_dynamics.flights import Piece
from verification.proofs.global_dynamics.images import PinballImages, invertible

NAN, INF = float("nan"), float("inf")
SHARES = np.linspace(-1, 1, 7)


def bare(**known):
    """A map of which only so much is known."""
    made = object.__new__(PinballImages)
    made.__dict__ |= {"ops": ArrayOps(), "law": None, "placed": False, "lam": BallArray(0.5)} | known
    return made


def about(low, high):
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    return BallArray((low + high) / 2, (high - low) / 2)


ROWS = [  # ends of the arc, and incidences; the rectangle of a whole arc, and that of a part
    ((0, 1), (0.2, 0.4), (0, 1, -0.2, -0.1)),
    ((1, 2), (0.8, 1.4), (1, 2, -0.5, -0.4)),
    ((2, 3), (-1.4, -0.8), (2, 3, 0.4, 0.5)),
    ((3, 4), (1.2, 1.4), None),
    ((4, 5), (-1.4, -1.2), None),
    ((5, 6), (-INF, INF), (5, 6, -0.5, 0.5)),
    ((NAN, 6), (0.2, 0.4), (NAN, NAN, -0.2, -0.1)),
    ((6, NAN), (0.2, 0.4), (NAN, NAN, -0.2, -0.1)),
]


@pytest.mark.parametrize("smooth", [True, False])
def test_a_rectangle_is_clipped_to_the_strip_and_left_out_where_a_part_of_an_arc_has_no_angle_in_it(smooth):
    """Of a whole arc nothing is then known but the strip: rounding alone may put it outside."""
    (low, high), (least, most) = (np.array([row[k] for row in ROWS], dtype=float).T for k in (0, 1))
    with np.errstate(invalid="ignore"):
        eta = BallArray(np.nan_to_num((least + most) / 2), np.minimum((most - least) / 2, 1e9))
    on = np.arange(len(ROWS)) + 10
    piece = Piece(on, on + 5, low, high, smooth)
    theta = about(np.nan_to_num(low, nan=9), np.nan_to_num(high, nan=9))
    with np.errstate(invalid="ignore"):
        found = np.transpose(bare(top=0.5).row(piece, theta, eta, None))
    wanted = [
        (k, k + 5, *(rectangle or (*ends, -0.5, 0.5)))
        for k, (ends, _, rectangle) in zip(on, ROWS, strict=True)
        if rectangle or smooth
    ]
    assert np.allclose(found, wanted, atol=1e-14, equal_nan=True)


def test_of_two_enclosures_of_an_exit_the_common_part_is_taken():
    eta, theta = about([0.2, 0.2], [0.4, 0.4]), about([0.0, 0.0], [1.0, 1.0])
    piece = Piece(np.arange(2), np.zeros(2, dtype=int), np.zeros(2), np.ones(2), True)
    row = bare(top=0.5).row(piece, theta, eta, about([-0.15, -0.3], [0.0, -0.18]))
    assert np.allclose(row[4:], [[-0.15, -0.2], [-0.1, -0.18]], atol=1e-14)


def test_a_landing_whose_only_angle_is_that_of_the_strips_edge_is_kept():
    map, eta = bare(top=0.5), BallArray(np.array([1.25]), np.array([0.125]))
    map.top = -float(map.exit(eta, None).upper()[0])
    piece = Piece(np.arange(1), np.zeros(1, dtype=int), np.zeros(1), np.ones(1), False)
    on, *_, low, high = map.row(piece, about([0], [1]), eta, None)
    assert (on.tolist(), low.tolist(), high.tolist()) == ([0], [-map.top], [-map.top])


@pytest.mark.parametrize("placed", [True, False])
def test_all_angles_of_incidence_are_asked_for_at_all_places_where_a_law_tells_them_apart(placed):
    ends = [(BallArray(0.0, 0.25), BallArray(1.0, 0.125)), (BallArray(5.0), BallArray(7.0))]
    pieces = [*bare(ends=ends, placed=placed).incidences()]
    assert len(pieces) == (2 * images.PLACES if placed else 1)
    for eta, _ in pieces:
        low, high = eta.lower(), eta.upper()
        assert np.all(low[1:] <= high[:-1])
        assert low[0] <= -np.pi / 2 < np.pi / 2 <= high[-1] < np.pi / 2 + 1e-9
        assert low.size == images.STEPS
    along = [(float(theta.lower()), float(theta.upper())) for _, theta in pieces]
    for k, (low, high) in enumerate([(-0.25, 1.125), (5.0, 7.0)] if placed else [(-0.25, 1.125)]):
        some = along[k * images.PLACES : (k + 1) * images.PLACES]
        assert [some[0][0], some[-1][1]] == pytest.approx([low, high], abs=1e-9)
        assert some[0][0] <= low
        assert high <= some[-1][1]
        assert all(a[1] >= b[0] for a, b in pairwise(some))


def test_exit_angles_are_asked_to_stay_below_a_quarter_turn_over_all_pieces(monkeypatch):
    law = SimpleNamespace(check=lambda *_: None, places=lambda _: ())
    pieces = [(BallArray(np.array([0.25, -0.75])),), (BallArray(np.array([0.5])),)]
    map = bare(
        scene=SimpleNamespace(law=law), map=SimpleNamespace(table=None), range=(0, 1), incidences=lambda: pieces,
        exit=lambda ball: ball,
    )  # fmt: skip
    size = float(pieces[0][0].magnitude().max())
    monkeypatch.setattr(images, "QUARTER", size)
    with pytest.raises(ValueError, match="by a margin"):
        map._steepest()
    monkeypatch.setattr(images, "QUARTER", float(np.nextafter(size, 1)))
    assert map._steepest() == size


@pytest.mark.parametrize(("measured", "along"), [(True, None), (False, 1), (True, 1)])
def test_a_law_along_the_boundary_that_is_no_formula_of_its_parameter_is_refused(monkeypatch, measured, along):
    scene = Scene("circle", lam="1/2")
    monkeypatch.setattr(type(scene.law), "on", lambda *_: SimpleNamespace(measured=measured, along=along))
    with pytest.raises(ValueError, match="boxes know theta"):
        PinballImages(scene)


LAWS = {"-lam*sin(eta) - atan(eta)/4": False, "-lam*eta*(1 + cos(3*theta)/4) + sin(theta)/8": True}


@pytest.fixture(params=LAWS, scope="module")
def other(request):
    return PinballImages(Scene("egg", alpha="0.08", lam="1/2", law=request.param)), LAWS[request.param]


def test_exits_and_slopes_of_a_law_over_pieces_are_enclosed_and_hardly_more(other):
    map, placed = other
    eta, theta, h = np.array([-1.2, -0.3, 0.5, 1.1]), np.array([0.4, -2.0, 2.5, 1.0]), 1e-4
    ball = [BallArray(x, np.full(4, h)) for x in (eta, theta)]
    i, j = (x[:, :, None] * h for x in np.meshgrid(SHARES, SHARES))
    eta, theta = eta + i, theta + j

    def law(eta, theta):
        return (
            -eta / 2 * (1 + np.cos(3 * theta) / 4) + np.sin(theta) / 8
            if placed
            else -np.sin(eta) / 2 - np.arctan(eta) / 4
        )

    slopes = (
        (law(eta - 1e-6, theta) - law(eta + 1e-6, theta)) / 2e-6,
        (law(eta, theta + 1e-6) - law(eta, theta - 1e-6)) / 2e-6,
    )
    assert map.placed is placed
    for found, some, spare in zip(
        (map.exit(*ball), *map.slopes(*ball)), (law(eta, theta), *slopes), (1.05, 15, 15), strict=True
    ):
        low, high = some.min((0, 1)), some.max((0, 1))
        assert np.all((found.lower() <= low + 1e-9) & (high - 1e-9 <= found.upper()))
        assert np.all(2 * found.r <= spare * (high - low) + 1e-8)
    plain = bare()
    assert plain.slopes(*ball)[0] is plain.lam
    assert np.all(plain.slopes(*ball)[1].magnitude() == 0)
    assert np.array_equal(plain.exit(*ball).m, -ball[0].m / 2)


@pytest.mark.parametrize(
    ("low", "high", "held"),
    [
        ([0.1, 0.2], [0.3, 0.4], True), ([-0.3, -0.4], [-0.1, -0.2], True), ([-0.3, 0.2], [-0.1, 0.4], False),
        ([0.0, 0.2], [0.3, 0.4], False), ([0.1, -0.2], [0.3, 0.4], False), ([-0.3, -0.4], [0.0, -0.2], False),
    ],
)  # fmt: skip
def test_a_law_is_invertible_where_its_slope_keeps_one_sign_on_all_pieces(low, high, held):
    """Over two pieces; also of those where only one end is not away from 0."""
    pieces = [(about([a], [b]), None) for a, b in zip(low, high, strict=True)]
    for some in (pieces, pieces[::-1], [(about(low, high), None)], [(about(low[::-1], high[::-1]), None)]):
        every = lambda some=some: iter([(k,) for k in some])  # noqa: E731
        assert invertible(SimpleNamespace(law=1, incidences=every, slopes=lambda one: one)) is held
    assert invertible(SimpleNamespace(law=None))


@pytest.mark.parametrize("failing", ["", "placed", "low", "slope", "turn", "ahead"])
def test_a_map_is_a_homeomorphism_where_no_condition_on_table_law_and_range_fails(monkeypatch, failing):
    """At a join both tangents are parallel, and point the same way."""
    side = lambda zero, positive: (SimpleNamespace(is_zero=zero), SimpleNamespace(is_positive=positive))  # noqa: E731
    joins = [side(True, True), side(failing != "turn", failing != "ahead")]
    monkeypatch.setattr(images, "tangents", lambda _: joins)
    monkeypatch.setattr(images, "invertible", lambda _: failing != "slope")
    map = bare(map=SimpleNamespace(table=None), placed=failing == "placed", range=(Fraction(failing != "low"), 1))
    assert map.homeomorphism is (failing == "")


@pytest.mark.parametrize(("table", "law", "odd", "held"), [(True, None, None, True), (False, None, None, False),
                                                           (True, 1, True, True), (True, 1, False, False),
                                                           (False, 1, True, False)])  # fmt: skip
def test_a_map_has_a_mirror_image_where_table_and_law_have_one(monkeypatch, table, law, odd, held):
    monkeypatch.setattr(images, "reflected", lambda _: table)
    map = bare(map=SimpleNamespace(table=None), law=law, scene=SimpleNamespace(law=SimpleNamespace(odd=odd)))
    assert map.mirrored is held


def test_charts_go_from_end_to_end_and_joins_once_round():
    parts = [SimpleNamespace(name=name) for name in "abc"]
    ends = [tuple(BallArray(x, 2.0**-20) for x in pair) for pair in ((-1.0, 2.0), (0.5, 1.0), (3.0, 4.0))]
    map = bare(map=SimpleNamespace(ir=SimpleNamespace(parts=parts)), ends=ends, closed=False, top=0.5)
    far = 2.0**-20
    assert np.allclose(map.outer, [[-1 - far, 0.5 - far, 3 - far], [2 + far, 1 + far, 4 + far]], rtol=0, atol=1e-14)
    assert np.allclose(map.inner, [[-1 + far, 0.5 + far, 3 + far], [2 - far, 1 - far, 4 - far]], rtol=0, atol=1e-14)
    assert np.all(map.outer[0] <= [-1 - far, 0.5 - far, 3 - far])
    assert map.joins == ((0, 1), (1, 2), (2, 0))
    assert [chart[:3] for chart in map.charts] == [
        (name, (*map.outer[:, k],), (-0.5, 0.5)) for k, name in enumerate("abc")
    ]
    assert {chart[3:] for chart in map.charts} == {(False, True)}
    map.closed = True
    map.map.ir.parts = parts[:1]
    assert map.joins == ()
    assert map.charts == (("a", (-1.0, 2.0), (-0.5, 0.5), True, True),)


def test_boundary_points_are_those_of_each_places_own_component():
    curve = lambda k: lambda theta, shape: [theta + BallArray(10.0 * k + part) * shape for part in range(6)]  # noqa: E731
    map = bare(curves=[curve(0), curve(1), curve(2)], shape=[BallArray(2.0)], closed=False)
    chart, theta = np.array([2, 0, 1, 0]), np.array([0.5, 1.5, 2.5, 3.5])
    for radius in (0.25, np.array([0.25, 0.5, 0.0, 1.0])):
        for part, ball in enumerate(map.place(chart, BallArray(theta, radius))):
            assert np.allclose(ball.m, theta + 20 * chart + 2 * part)
            assert np.allclose(ball.r, np.broadcast_to(radius, 4), rtol=1e-9, atol=1e-13)
    map.closed = True
    assert np.allclose(map.place(chart, BallArray(theta, 0.25))[3].m, theta + 6)


@pytest.mark.parametrize(
    ("lam", "held"),
    [
        ((0, 0.5), True),
        ((0.5, 0.5), True),
        ((0, 0), False),
        ((0.5, 1), False),
        ((-0.5, 0.5), False),
        ((0.5, 0.25), False),
    ],
)
def test_a_range_of_contractions_begins_at_0_or_above_and_ends_below_1(lam, held):
    scene, ends = Scene("circle", lam="1/2"), tuple(Fraction(end) for end in lam)
    if not held:
        with pytest.raises(ValueError, match="accepted: 0 <= LOW"):
            PinballImages(scene, ends)
        return
    map = PinballImages(scene, ends)
    assert map.range == ends
    assert ends[1] * Fraction(np.pi) / 2 < Fraction(map.top) < ends[1] * Fraction(np.pi) / 2 + Fraction(1, 10**12)
    assert [Fraction(float(end)) for end in (map.lam.m - map.lam.r, map.lam.m + map.lam.r)] == pytest.approx(
        ends, abs=1e-15
    )
    assert map.label.startswith("circle, ")
    assert map.label.endswith(f"lam = {ends[0]} to {ends[1]}" if ends[0] != ends[1] else f"lam = {ends[0]}")
