"""Derivatives once round the pieces of a part: cones and norms by the ends of their bounds, hulls of several parts."""

import numpy as np
import pytest

from verification.proofs.periodic import returning
from verification.proofs.periodic.returning import Image, Piece, _hull, _judged, _once_round


def largest(span):
    return max(map(abs, span))


def least(span):
    return 0.0 if span[0] <= 0 <= span[1] else min(map(abs, span))


def by_hand(p, q, r, s):
    """Of one matrix in bounds, the least stretch in the cone of width `2*abs(r)`, 0 where it is not kept, and the norm.

    Each entry is that of its bounds which is worst, by itself.
    """
    wide = 2 * largest(r) + 2.0**-20
    stretch = least(p) - largest(q) * wide
    kept = largest(r) + largest(s) * wide <= wide * stretch
    return stretch if kept else 0.0, max(largest(p) + largest(q) * wide, largest(r) / wide + largest(s))


def test_bounds_of_a_matrix_count_with_the_end_that_is_worst():
    chance, kept = np.random.default_rng(4), 0
    for _ in range(400):
        middle = chance.uniform(-1, 1, 4) * (2.5, 0.5, 0.5, 1)
        half = chance.uniform(0, 0.5, 4) * (1, 0.5, 0.5, 1)
        spans = tuple(zip((middle - half).tolist(), (middle + half).tolist(), strict=True))
        found, known = _once_round([Image((), (0.0, 0.0), spans)]), by_hand(*spans)
        assert found == pytest.approx(known, rel=1e-6, abs=1e-9)
        assert found[0] <= known[0] * (1 + 1e-15)
        assert found[1] >= known[1] * (1 - 1e-15)
        kept += known[0] > 0
    assert 40 < kept < 360


def test_the_bounds_of_several_pieces_hold_for_every_product_of_their_matrices():
    chance = np.random.default_rng(5)
    for _ in range(60):
        images, products = [], [np.eye(2)] * 20
        for _ in range(3):
            middle, half = chance.uniform(-1, 1, 4) * (2, 0.5, 0.1, 0.1), chance.uniform(0, 0.1, 4)
            images.append(Image((), (0.0, 0.0), tuple(zip(middle - half, middle + half, strict=True))))
            products = [(middle + half * chance.choice([-1, 1], 4)).reshape(2, 2) @ old for old in products]
        slowest, fastest = _once_round(images)
        for product in products:
            assert max(abs(np.linalg.eigvals(product))) <= fastest * (1 + 1e-12)
            assert slowest <= abs(product[0, 0]) * (1 + 1e-12)  # the direction (1, 0) is in the cone


PART = {k: Image((), (0.0, 0.0), ((1.5, 2.0), (3.0, 4.0), (5.0, 6.0), (7.0, 8.0))) for k in (2, 3, 6)}
LEADS = {2: {6: (0.0, 0.0)}, 3: {6: (0.0, 0.0)}, 6: {2: (0.0, 0.0), 3: (0.0, 0.0)}}


@pytest.mark.parametrize(
    ("once", "repels"),
    [((1.0, 1.0), None), ((1.0, 9.0), None), ((1.0 + 2.0**-50, 9.0), True), ((0.0, 1.0), None),
     ((0.0, 1.0 - 2.0**-50), False)],
)  # fmt: skip
def test_a_part_whose_derivative_once_round_may_be_1_is_not_judged(monkeypatch, once, repels):
    monkeypatch.setattr(returning, "_once_round", lambda _: once)
    found = _judged([2, 3, 6], LEADS, PART, 0.1)
    assert (found and found[1]) is repels
    if found:  # the bounds of a piece are those of its own parameter
        assert [(round(p.low, 6), round(p.high, 6), p.least, p.most) for p in found[0]] == [
            (0.2, 0.4, 1.5, 2.0),
            (0.6, 0.7, 1.5, 2.0),
        ]


def hulls(monkeypatch, places, once=(0.0, 0.5)):
    shrinks = Image(((0.0, 0.1, 1),), (0.0, 0.0), ((0.5, 0.75), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)))
    asked = []
    monkeypatch.setattr(returning, "image", lambda table, cell, phi, lams: asked.append(cell) or shrinks)
    monkeypatch.setattr(returning, "_once_round", lambda _: once)
    return _hull([[Piece(a, b, 0, 0) for a, b in places]], None, 0.0625, {0: (-0.1, 0.1)}, (0.0, 0.1)), asked


def test_hulls_must_all_be_apart_and_their_norm_below_1(monkeypatch):
    apart = [(0.125, 0.25), (0.5, 0.625), (0.875, 1.0)]  # up to near a flat point
    found, asked = hulls(monkeypatch, apart)
    assert found == tuple(Piece(a, b, 0.5, 0.75) for a, b in apart)
    assert [cell[0] for cell in asked] == [0.125, 0.1875, 0.25, 0.5, 0.5625, 0.625, 0.875, 0.9375, 1.0]
    assert hulls(monkeypatch, apart[::-1])[0] is not None  # in any order
    assert hulls(monkeypatch, apart, (0.0, 1.0))[0] is None
    assert hulls(monkeypatch, [(0.125, 0.25), (0.25, 0.375), (0.875, 1.0)])[0] is None
    assert hulls(monkeypatch, [(0.125, 0.25), (0.5, 0.625), (0.5625, 1.0)])[0] is None
    assert hulls(monkeypatch, [(0.125, 0.25), (0.75, 1.0625)])[0] is None  # beyond the flat point
