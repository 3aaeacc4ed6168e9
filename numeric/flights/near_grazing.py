"""Flights along the wall of the cuspless table, from next to one join to the wall or past the other.

A rounding of the direction moves such a landing by the inverse of the angle, or of its square. So the angle is
formed from the state with twice the digits, and distances from the wall from exact squares: the arc lies
`(2*p**2 - 1/2)**2` from it, at the height `4*p**3*q`, where `p, q` is `sigma`, whose length is one up to rounding only.
"""

from typing import Any

from numeric.backends import plane
from numeric.backends.plane import Pair


def sharp_back(ops: Any, sigma: Pair, exit: Pair) -> Any:
    """The real part of `sigma**3*conj(exit)` to the last bits however small it is."""
    (p, q), (c, s) = sigma, exit
    a, a_rest = plane.cross_and_rest(ops, sigma, (q, p))
    pq, pq_rest = plane.product_and_rest(ops, p, q)
    b, b_rest = pq + pq, pq_rest + pq_rest
    w, w_rest = plane.cross_and_rest(ops, (p, -q), (s, c))
    k, k_rest = plane.cross_and_rest(ops, (q, p), (s, c))
    real, rest = plane.cross_and_rest(ops, (a, b), (k, w))
    return real + (rest + (a * w_rest + w * a_rest) - (b * k_rest + k * b_rest))


def above_the_wall(ops: Any, sigma: Pair) -> Pair:
    """The root of an arc point's distance from the wall, and its height, of `sigma` made a unit number."""
    p, q = sigma
    (pp, low), (qq, lower) = plane.product_and_rest(ops, p, p), plane.product_and_rest(ops, q, q)
    steep, one, two = pp < qq, ops.number(1.0), ops.number(2.0)
    most, least = ops.select(steep, qq, pp), ops.select(steep, pp, qq)
    excess = (least - (one - most)) + (low + lower)  # of p*p + q*q over one: both differences are exact
    gap = ops.fma(p + p, p, ops.number(-0.5)) - two * pp * excess
    height = two * pp * (two * p * q)
    return gap, height - two * excess * height


def sharpened(ops: Any, sigma: Pair, exit: Pair, by: Any, landing: Pair, along: Any) -> tuple[Any, Any, Pair]:
    """Back's real part, the height on the wall, and the landing on the arc after one step of Newton's method.

    `by` is the other part of back; `along` the cosine of the incidence on the arc.
    """
    bx = sharp_back(ops, sigma, exit)
    gap, height = above_the_wall(ops, sigma)
    there, top = above_the_wall(ops, landing)
    off = (top - height) * bx - (there - gap) * (there + gap) * by
    step = off / (ops.number(4.0) * landing[0] * along)
    moved = landing[0] - step * landing[1], landing[1] + step * landing[0]
    return bx, height - gap * gap * (by / bx), moved
