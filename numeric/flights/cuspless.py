"""The cardioid cut off by the wall `x = -1/4`. A flight solves a cubic from arc to arc and a quartic from the wall.

The table is convex, so a line leaves it at one further point; the sides on which the line passes the two joins show
whether this point is on the arc or on the wall. State: the component (0 arc, 1 wall), `sigma = exp(i*theta/2)` on the
arc or `(y, .)` on the wall, and `exp(i*phi)`. Paper: section 5 and the appendix, where the wall is called the cut-off.

Flights along the wall, from near one join to the wall or past the other join, need more digits: a rounding of the
direction moves their landing by the inverse of their angle with the wall, or of its square. So this angle is formed
from the state with twice the digits, and distances from the wall are formed from exact squares. With `p, q` for
`sigma`, whose length is one up to rounding only, a point of the arc has the distance `(2*p**2 - 1/2)**2` from the wall,
and the height `4*p**3*q`.
"""

import numpy as np
from numpy.typing import NDArray

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.cardioid import Cardioid
from numeric.flights.family import NEAR, SLAP, Array, Boundary, Frame, Landing, Status, grazing

QUARTER = 0.25
FLAT_WALL = 0.125  # cosines of the incidence below which a flight is sharpened: on the wall,
FLAT_ARC = 0.875  # and on the arc past the other join, there with cos(theta/2) added, which is 1/2 at the join
TINY = 2.0**-30  # landings from the wall are found relatively, down to this distance from a join


class Cuspless(Cardioid):
    """The flight on the cuspless cardioid. Paper: section 5."""

    name = "cuspless"
    path = "the cardioid's cubic, the wall, and a quartic from the wall"
    cusped = False
    pairs = 1, 3  # the first is a height on the wall
    position = ("wall", "p", "q")
    steps = 2, 1

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.same_as == "cuspless"

    def frame(self, component: NDArray[np.int64], theta: Array) -> Frame[Array]:
        wall, arc = component == 1, super().frame(component, theta)
        return Frame(arc.x, arc.y, np.where(wall, 0.0, arc.tx), np.where(wall, -1.0, arc.ty))

    def cartesian(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        wall, (x, y) = component == 1, super().cartesian(component, theta)
        return np.where(wall, -QUARTER, x), np.where(wall, -theta, y)

    def speed(self, component: NDArray[np.int64], theta: Array) -> Array:
        return np.where(component == 1, 1.0, super().speed(component, theta))

    def bending(self, component: NDArray[np.int64], theta: Array) -> tuple[Array, Array]:
        rate, curvature = super().bending(component, theta)
        return rate, np.where(component == 1, 0.0, curvature)

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        wall = ops.number(0.5) < component
        p, q = super().enter(ops, component, theta)
        return [component, ops.select(wall, -theta, p), ops.select(wall, ops.number(0.0), q)]

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        component, p, q = position
        _, theta = super().place(ops, [p, q])
        return component, ops.select(ops.number(0.5) < component, -p, theta)

    def framed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Frame[N]:
        wall, sigma = ops.number(0.5) < position[0], (position[1], position[2])
        tx, ty = plane.times(sigma, plane.squared(sigma))
        tangent = ops.select(wall, ops.number(0.0), -ty), ops.select(wall, ops.number(-1.0), tx)
        return Frame(*self.point(ops, position), *tangent)

    def curving(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        rate, curvature = super().curving(ops, shape, position[1:])
        return rate, ops.select(ops.number(0.5) < position[0], ops.number(0.0), curvature)

    def arclength(self, ops: Backend[N, M], component: int, theta: N) -> N:
        return theta if component == 1 else super().arclength(ops, component, theta)

    def along(self, ops: Backend[N, M], position: Fields[N], theta: N, how: plane.Series, numbers: Fields[N]) -> N:
        wall, (arc_offset, wall_offset) = ops.number(0.5) < position[0], numbers
        return ops.select(wall, wall_offset - position[1], ops.number(4.0) * position[2] + arc_offset)

    def parameter(self, component: int, s: Array) -> Array | None:
        return super().parameter(component, s) if component == 0 else None

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        nought, one, two = (ops.number(x) for x in (0.0, 1.0, 2.0))
        root3 = ops.sqrt(ops.number(3.0))  # tan(theta/2) at the join
        from_wall = ops.number(0.5) < position[0]
        (c, s), (p, q) = exit, position[1:]
        # from the arc: the cardioid's cubic, and on which side the line passes the joins
        cubic, Q, k, back = self.cubic(ops, (p, q), (c, s))
        reach = root3 * p
        reach2 = reach * reach
        even, odd = cubic[2] * reach2 + cubic[0], (cubic[3] * reach2 + cubic[1]) * reach
        ahead, behind = even - odd, even + odd
        onwards, across = ahead < nought, (behind < nought) & ops.negated(from_wall)
        to_wall = ops.negated(onwards | across | from_wall)
        # mirrored where it passes on the other side of the cusp, so that the zero lies above -reach on every way
        cubic[1], cubic[3] = (ops.select(across, -x, x) for x in (cubic[1], cubic[3]))
        # from the wall, at height y after a mirroring that lets it fly upwards: a quartic in -tan(theta1/2)
        y, up, four = -ops.times_sign(p, s), modulus(s), ops.number(4.0)
        L, below = ops.fma(c, y, ops.number(QUARTER) * up), ops.number(QUARTER) * root3 - y
        quartic = [two * up + L, four * c, two * (L - up), nought, L]
        poly = [ops.select(from_wall, a, b) for a, b in zip(quartic, [*cubic, nought], strict=True)]
        base = ops.select(from_wall, one, p)
        low = -root3 * base
        high = ops.select(from_wall, root3, ops.select(across, -Q, Q))
        # starts that are off by 0.15 at most, past a join by 0.2: two steps of Halley's method then do
        size, turn = modulus(k), ops.number(2.125)
        turn = ops.fma(ops.fma(ops.number(1.8125), size, ops.number(-3.0625)), size, turn)
        past = ops.number(1.5) - ops.number(3.25) * c - ops.number(4.375) * size
        guess = ops.number(1.3125) * c - ops.number(1.375) - ops.number(0.3125) * y
        start = ops.select(from_wall, guess, ops.select(across, past, Q - c * turn))
        near_grazing = from_wall & ((c < ops.number(0.015625)) | (c < ops.number(0.125)) & (below < ops.number(0.0625)))
        S = ops.polynomial_zero(poly, start, low, high, base, self.steps, ops.negated(to_wall | near_grazing))

        def from_the_join() -> list[N]:
            """Where a flight is near grazing, solves the quartic in `sqrt(3) - tan(theta1/2)`, in which nothing
            cancels.

            Such flights graze the wall, or the arc next to the join. For all others the landing is unchanged.
            """
            turned = [-ops.number(16.0) * c * below, -four * c * (four * root3 * y - one)]
            turned += [ops.number(3.0) * up + ops.number(20.0) * c * y, -four * root3 * L, L]
            tiny, far = ops.number(TINY), two * root3
            rest = ops.polynomial_zero(turned, nought, nought, far, tiny, self.steps, near_grazing)
            return [ops.select(near_grazing, rest - root3, S)]

        (S,) = ops.when(near_grazing, [S], from_the_join)
        tangent = ops.times_sign(ops.select(across, -S, S), ops.select(from_wall, s, k))
        back = ops.select(from_wall, -c, back[0]), ops.select(from_wall, s, back[1])
        landing = plane.normalised(ops, (base, tangent))
        # on the wall the angular momentum about the origin tells the height: no term is larger than the result needs
        height = -(two * p * p * k + ops.number(QUARTER) * back[1]) / back[0]
        w = plane.times(plane.times(landing, plane.squared(landing)), plane.conjugate(back))
        sine, cosine = ops.select(to_wall, back[1], w[1]), ops.select(to_wall, back[0], -w[0])
        small = ops.select(to_wall, ops.number(FLAT_WALL), ops.number(FLAT_ARC) - landing[0])
        flat = (to_wall | (q * landing[1] < nought)) & (cosine < small)
        rough = [back[0], height, *landing, sine, cosine]

        def sharp() -> list[N]:
            real, high, moved = sharpened(ops, (p, q), (c, s), back[1], landing, -w[0])
            turned = plane.times(plane.times(moved, plane.squared(moved)), (real, -back[1]))
            angle = ops.select(to_wall, back[1], turned[1]), ops.select(to_wall, real, -turned[0])
            return [ops.select(flat, a, b) for a, b in zip([real, high, *moved, *angle], rough, strict=True)]

        real, height, *found, sine, cosine = ops.when(flat, rough, sharp)
        back, landing = (real, back[1]), (found[0], found[1])
        join = ops.select(
            to_wall, modulus(modulus(height) - ops.number(QUARTER) * root3), modulus(modulus(tangent) - root3 * base)
        )

        def told() -> list[N]:
            """The code of `JOIN` where rounding hides on which side of a join the line passes; else 0.

            A line along the arc is in doubt only near the join, as elsewhere the arc bends away from it. A flight from
            the wall lands on the arc in any case.
            """
            way = modulus(root3 * p - ops.times_sign(q, ops.select(to_wall, height, tangent)))
            least = (
                ops.number(NEAR) * ops.select(from_wall, one, way) * ops.select(to_wall | from_wall, one, two * base)
            )
            rate = ops.select(from_wall, one, ops.select(to_wall, cosine, ops.maximum(cosine, join)))
            return [ops.select(least < join * rate, nought, ops.number(float(Status.JOIN.code)))]

        sure = ops.number(4 * NEAR) < join * cosine  # the way is at most 2, and base 1
        (code,) = ops.when(ops.negated(sure), [nought], told)
        if law != SLAP:
            code = ops.select(grazing(ops, sine, cosine), ops.number(float(Status.GRAZING.code)), code)
        wall = ops.select(to_wall, one, nought)
        landed = [wall, ops.select(to_wall, height, landing[0]), ops.select(to_wall, nought, landing[1])]
        return Landing(landed, sine, cosine, code, {"back": back})

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        wall = ops.number(0.5) < landing.position[0]
        return ops.select(wall, ops.number(0.0), ops.number(-0.75)), ops.select(
            wall, ops.number(1.0), landing.position[1]
        )

    def drifting(self, ops: Backend[N, M], landing: Landing[N], below: N, drift: N) -> N:
        wall = ops.number(0.5) < landing.position[0]
        return ops.select(wall, drift, drift * ops.number(0.5))

    def point(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        """The boundary point on the arc or on the wall."""
        wall = ops.number(0.5) < position[0]
        x, y = super().point(ops, position[1:])
        return ops.select(wall, ops.number(-QUARTER), x), ops.select(wall, position[1], y)


def sharp_back(ops: Backend[N, M], sigma: Pair[N], exit: Pair[N]) -> N:
    """The real part of `sigma**3*conj(exit)`, with all its digits however small it is."""
    (p, q), (c, s) = sigma, exit
    a, a_error = plane.cross_and_error(ops, sigma, (q, p))
    pq, pq_error = plane.product_and_error(ops, p, q)
    b, b_error = pq + pq, pq_error + pq_error
    w, w_error = plane.cross_and_error(ops, (p, -q), (s, c))
    k, k_error = plane.cross_and_error(ops, (q, p), (s, c))
    real, error = plane.cross_and_error(ops, (a, b), (k, w))
    return real + (error + (a * w_error + w * a_error) - (b * k_error + k * b_error))


def above_the_wall(ops: Backend[N, M], sigma: Pair[N]) -> Pair[N]:
    """The square root of the distance from the wall, and the height, of the point of the arc that `sigma` represents.

    Both are those of `sigma` normalised.
    """
    p, q = sigma
    (pp, low), (qq, lower) = plane.product_and_error(ops, p, p), plane.product_and_error(ops, q, q)
    steep, one, two = pp < qq, ops.number(1.0), ops.number(2.0)
    most, least = ops.select(steep, qq, pp), ops.select(steep, pp, qq)
    excess = (least - (one - most)) + (low + lower)  # of p*p + q*q over one: both differences are exact
    gap = ops.fma(p + p, p, ops.number(-0.5)) - two * pp * excess
    height = two * pp * (two * p * q)
    return gap, height - two * excess * height


def sharpened(
    ops: Backend[N, M], sigma: Pair[N], exit: Pair[N], by: N, landing: Pair[N], along: N
) -> tuple[N, N, Pair[N]]:
    """The real part of minus the direction, the height on the wall, and the landing after a step of Newton's method.

    `by` is the imaginary part of minus the direction; `along` is the cosine of the incidence angle on the arc.
    """
    bx = sharp_back(ops, sigma, exit)
    gap, height = above_the_wall(ops, sigma)
    there, top = above_the_wall(ops, landing)
    off = (top - height) * bx - (there - gap) * (there + gap) * by
    step = off / (ops.number(4.0) * landing[0] * along)
    moved = landing[0] - step * landing[1], landing[1] + step * landing[0]
    return bx, height - gap * gap * (by / bx), moved
