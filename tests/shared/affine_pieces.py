"""Helpers, imported as `affine_pieces`: pieces `x -> A*x + b` of maps of the plane, and a square to map."""

from flint import arb

from verification.proofs.corner.border_collision import AffinePiece

SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]


def affine(a, b, c, d, p=0.0, q=0.0) -> AffinePiece:
    """The piece `(u, v) -> (a*u + b*v + p, c*u + d*v + q)`, of numbers or balls."""
    return AffinePiece(((arb(a), arb(b)), (arb(c), arb(d))), (arb(p), arb(q)))
