"""Two affine pieces by hand: how far an attractor reaches, which segments have images, how much cones stretch."""

from dataclasses import replace

import pytest
from flint import arb

from verification.proofs.corner import border_collision as border
from verification.proofs.corner.border_collision import Piece, clipped, expansion, extent, trapped
from verification.proofs.corner.corner import ARC, WALL


def affine(a, b, c, d, p=0.0, q=0.0, at=(0.0, 0.0)):
    return Piece(((arb(a), arb(b)), (arb(c), arb(d))), (arb(p), arb(q)), (arb(at[0]), arb(at[1])))


TENT = {ARC: affine(0.25, 0.125, 0, 1.5, 0, 1), WALL: affine(0.25, 0, 0, -1.5, 0, 1)}  # v -> 1 - 1.5*abs(v)
TURNED = {ARC: affine(0.25, 0, 0, -1.5, 0, -1), WALL: affine(0.25, 0.125, 0, 1.5, 0, -1)}


@pytest.mark.parametrize(
    ("images", "low", "high"), [(0, 0.4, 0.4), (1, 0.4, 1.0), (2, -0.5, 1.0), (3, -0.5, 1.0), (8, -0.5, 1.0)]
)
def test_an_attractor_reaches_as_far_as_images_of_the_way_from_the_fixed_point_to_the_border(images, low, high):
    """The fixed point is at 2/5; the way to 0 goes to that up to 1, this to that down to -1/2, and this folds."""
    for pieces, folding, sign in ((TENT, WALL, 1), (TURNED, ARC, -1)):
        found = extent(pieces, folding, images=images)
        ends = sorted(sign * float(x.mid()) for x in found.inner)
        assert ends == pytest.approx([low, high], abs=1e-12)
        assert images == 0 or found.inner[0] < found.inner[1]
        assert trapped(pieces, found.outer)
        reached = sorted(sign * v for _, v in found.outer)
        assert -0.501 < reached[0] < -0.5 < 1 < reached[-1] < 1.001
        assert found.strips == border.strips(pieces, found.outer)


def test_no_attractor_is_told_without_a_folding_piece_or_a_region_that_is_trapped(monkeypatch):
    assert extent(TENT, ARC) is None  # a positive multiplier
    assert extent({**TENT, WALL: affine(0.25, 0, 0, -0.75, 0, 1)}, WALL) is None  # it attracts
    off = {**TENT, WALL: affine(0.25, 0, 0, -1.5, 0, -1)}  # the fixed point is on the other side, at -2/5
    assert extent(off, WALL) is None
    on = {**TENT, WALL: affine(0.25, 0, 0, -1.5)}  # and on the border
    assert extent(on, WALL) is None
    monkeypatch.setattr(border, "trapped", lambda *_: None)
    assert extent(TENT, WALL) is None
    monkeypatch.setattr(border, "trapped", lambda *_: True)
    assert extent(TENT, WALL) is not None
    monkeypatch.setattr(border, "grown", lambda *_: None)
    assert extent(TENT, WALL) is None


def segment(*ends):
    return tuple((arb(u), arb(v)) for u, v in ends)


def test_a_segment_across_the_border_has_the_images_of_its_two_parts():
    """From (0, -1) to (3, 2) it meets the border in (1, 0); the pieces double, or treble."""
    pieces = {ARC: affine(2, 0, 0, 2), WALL: affine(3, 0, 0, 3)}
    for ends in ([(0, -1), (3, 2)], [(3, 2), (0, -1)]):
        found = border._mapped(pieces, segment(*ends))
        told = [[(float(u), float(v)) for u, v in pair] for pair in found]
        wanted = [[(0, -2), (2, 0)], [(3, 0), (9, 6)]]
        assert told == (wanted if ends[0][1] < 0 else [wanted[1][::-1], wanted[0][::-1]])
    for ends, factor in (([(1, -1), (2, -3)], 2), ([(1, 1), (2, 3)], 3), ([(1, 0), (2, -1)], 2), ([(1, 2), (0, 0)], 3)):
        ((p, q),) = border._mapped(pieces, segment(*ends))
        assert [(float(u), float(v)) for u, v in (p, q)] == [(factor * u, factor * v) for u, v in ends]
    assert border._mapped(pieces, segment((0, 0), (1, 0))) == []  # along the border
    assert border._mapped(pieces, segment((0, arb(0, 1)), (1, 3))) == []  # what may cross it


def test_the_way_to_the_border_is_told_of_every_multiplier_below_minus_1():
    """The direction of -5/4 is that of `(b, -5/4 - a)`; the fixed point is at `(b*v/(1 - a), v)`, `v = 4/9`."""
    found = border._to_border(affine(0.25, 0.5, 0, -1.25, 0, 1))
    v, lean = 4 / 9, 0.5 / (-1.25 - 0.25)
    assert float(found[0].mid()) == pytest.approx(0.5 * v / 0.75 - v * lean)
    assert found[1] == 0
    assert border._to_border(affine(0.25, 0.5, 0, -1, 0, 1)) is None


def test_corners_on_the_levels_are_kept_and_no_crossing_is_added_there():
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    assert clipped(square, 0, 1) == square
    assert clipped(square, 0, 0) == square[:2]
    assert clipped(square, 1, 3) == square[2:]
    hair = border.HAIR
    across = clipped([(0.0, -1.0), (2.0, 1.0), (-2.0, 1.0)], 0, 1)
    assert across == [(2.0, 1.0), (-2.0, 1.0), (1 - hair, 0), (1 + hair, 0), (-1 - hair, 0), (-1 + hair, 0)]


def test_a_cone_stretches_by_no_less_and_no_more_than_its_pieces_do():
    """Of triangular pieces the last entries are the factors; with `c = 1/8` and directions up to 1/4 an eighth more."""
    found = expansion({ARC: affine(0.25, 0, 0, 2), WALL: affine(0.25, 0, 0, -3)})
    assert (float(found.least), float(found.most)) == pytest.approx((2, 3))
    assert abs(found.ratio) < 0.01
    for swapped in (False, True):
        rows = affine(0.25, 0.5, 0.125, 2), affine(0.25, 0.25, 0.125, 4)
        found = expansion({ARC: rows[swapped], WALL: rows[not swapped]})
        low, high = float(found.ratio.lower()), float(found.ratio.upper())
        assert low < 0.07 < 0.25 < high < 0.4
        assert float(found.least) == pytest.approx(2 + low / 8, rel=1e-6)
        assert float(found.most) == pytest.approx(4 + high / 8, rel=1e-6)


def test_the_image_of_a_point_is_taken_about_the_base():
    piece = affine(2, 3, 5, 7, 11, 13, (0.5, 0.25))
    assert [float(x) for x in piece.of((arb(1), arb(2)))] == [2 * 0.5 + 3 * 1.75 + 11, 5 * 0.5 + 7 * 1.75 + 13]
    assert (float(piece.trace), float(piece.determinant)) == (9, -1)
    assert [float(border.inward(arb(3), part)) for part in (ARC, WALL)] == [-3, 3]


def test_a_flat_corner_in_floats_is_no_corner():
    """The middle corner is a little inside of the line of its neighbours, by less than floats can see."""
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    bent = [(0.0, 0.0), (0.5, 2.0**-1070), *square[1:]]
    assert border.exactly_convex(bent) == square
    assert border.exactly_convex(square[::-1]) == square
    assert border.holds(square, (arb(0.5), arb(0.5)))
    assert replace(affine(1, 0, 0, 1), shift=(arb(1), arb(1))).of((arb(0), arb(0))) == (1, 1)


def test_the_image_of_a_point_is_told_with_a_hair_on_every_side():
    hair = border.HAIR
    found = border._image(affine(1, 0, 0, 1), [(0.5, 0.25)])
    assert len(found) == 4
    for u in (0.5 - hair, 0.5 + hair):
        for v in (0.25 - hair, 0.25 + hair):
            assert any(abs(x - u) + abs(y - v) < hair / 100 for x, y in found)


@pytest.mark.parametrize(("height", "answer"), [(0.125, True), (-0.125, False), (0.0, False), (arb(0, 1), None)])
def test_a_left_fixed_point_is_on_its_side_however_near_to_the_border(height, answer):
    """`v -> 2*v + q` has it at `-q`; the left piece is that with the larger trace, on either side of the border."""
    for left, right, sign in ((WALL, ARC, 1), (ARC, WALL, -1)):
        above = Piece(((arb(0.25), arb(0)), (arb(0), arb(2))), (arb(0), -sign * arb(height)))
        made = border.hypotheses({left: above, right: affine(0.25, 0, 0, -3)})
        assert made["fixed_points_on_their_sides"] is answer
