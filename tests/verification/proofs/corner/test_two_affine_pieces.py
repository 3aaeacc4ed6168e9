"""Maps of two affine pieces: the extent of an attractor, the stretch of cones, and the sides of fixed points."""

import pytest
from affine_pieces import affine
from flint import arb

from verification.proofs.corner import border_collision as border
from verification.proofs.corner.border_collision import AffinePiece, extent, trapped
from verification.proofs.corner.corner import ARC, WALL

TENT = {ARC: affine(0.25, 0.125, 0, 1.5, 0, 1), WALL: affine(0.25, 0, 0, -1.5, 0, 1)}  # v -> 1 - 1.5*abs(v)
TURNED = {ARC: affine(0.25, 0, 0, -1.5, 0, -1), WALL: affine(0.25, 0.125, 0, 1.5, 0, -1)}


@pytest.mark.parametrize(
    ("images", "low", "high"), [(0, 0.4, 0.4), (1, 0.4, 1.0), (2, -0.5, 1.0), (3, -0.5, 1.0), (8, -0.5, 1.0)]
)
def test_an_attractor_reaches_as_far_as_images_of_a_segment(images, low, high):
    """The fixed point is at 2/5; the segment from it to 0 grows to 1, its image to -1/2, where it is folded."""
    for pieces, folding, sign in ((TENT, WALL, 1), (TURNED, ARC, -1)):
        found = extent(pieces, folding, images=images)
        ends = sorted(sign * float(x.mid()) for x in found.inner)
        assert ends == pytest.approx([low, high], abs=1e-12)
        assert images == 0 or found.inner[0] < found.inner[1]
        assert trapped(pieces, found.outer)
        reached = sorted(sign * v for _, v in found.outer)
        assert -0.501 < reached[0] < -0.5 < 1 < reached[-1] < 1.001
        assert found.strips == border.strips(pieces, found.outer)


def test_no_attractor_without_a_folding_piece():
    assert extent(TENT, ARC) is None  # a positive multiplier
    assert extent({**TENT, WALL: affine(0.25, 0, 0, -0.75, 0, 1)}, WALL) is None  # it attracts
    off = {**TENT, WALL: affine(0.25, 0, 0, -1.5, 0, -1)}  # the fixed point is on the other side, at -2/5
    assert extent(off, WALL) is None
    on = {**TENT, WALL: affine(0.25, 0, 0, -1.5)}  # and on the border
    assert extent(on, WALL) is None


@pytest.mark.parametrize(("height", "answer"), [(0.125, True), (-0.125, False), (0.0, False), (arb(0, 1), None)])
def test_a_left_fixed_point_is_on_its_side_however_near_to_the_border(height, answer):
    """`v -> 2*v + q` has the fixed point `-q`; the left piece, with the larger trace, may be on either side."""
    for left, right, sign in ((WALL, ARC, 1), (ARC, WALL, -1)):
        above = AffinePiece(((arb(0.25), arb(0)), (arb(0), arb(2))), (arb(0), -sign * arb(height)))
        made = border.hypotheses({left: above, right: affine(0.25, 0, 0, -3)})
        assert made["fixed_points_on_their_sides"] is answer
