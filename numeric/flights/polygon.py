"""Tables whose sides are straight: every side in closed form, first hit.

A side is `A + theta*B` between its ends. The particle crosses the line of a side where the cross product of its
direction with `A + theta*B - z0` vanishes, and the side itself where that product changes sign between its ends; two
sides that share a corner compare the same number there. State: the side, the parameter `theta`, and the direction `v`.
"""

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import NEAR, Boundary, Family, Landing, Status, grazing, reflected

FAR = 2.0**100  # as far as nothing was met


class Polygon(Family):
    """Sides in order, counterclockwise; not necessarily convex."""

    name, path = "polygon", "closed form on every straight side, first hit"
    pairs = (2,)
    position = ("component", "theta")
    direction = ("vx", "vy")

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        """Straight is a side whose second derivative is the constant 0, as it was derived."""
        curves = [part.curve for part in boundary.ir.parts]
        return all(curve.constant(output) == 0 for curve in curves for output in (4, 5))

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        return [component, theta]

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        return position[0], position[1]

    def sides(self, ops: Backend[N, M], shape: Fields[N]) -> list[list[N]]:
        """`A`, `B` and both ends of every side, six numbers each."""
        parts = self.boundary.ir.parts
        return [[*part.curve(ops, ops.number(0.0), *shape)[:4], *part.ends(ops, *shape)] for part in parts]

    def side(self, ops: Backend[N, M], shape: Fields[N], component: N) -> list[N]:
        """The six numbers of one side, chosen lane by lane."""
        values, *others = self.sides(ops, shape)
        for index, other in enumerate(others, start=1):
            here = ops.number(index - 0.5) < component
            values = [ops.select(here, new, old) for new, old in zip(other, values, strict=True)]
        return values

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        component, theta = position
        v, nought = (exit[0], exit[1]), ops.number(0.0)
        ax, ay, bx, by, *_ = self.side(ops, shape, component)
        x0, y0 = theta * bx + ax, theta * by + ay
        t, where, at = ops.number(FAR), component, theta
        for index, (ax, ay, bx, by, low, high) in enumerate(self.sides(ops, shape)):
            ends = [plane.cross(v, (ax + end * bx - x0, ay + end * by - y0)) for end in (low, high)]
            across = plane.cross(v, (bx, by))
            line = plane.cross(v, (x0 - ax, y0 - ay)) / across
            reach = plane.cross((ax - x0, ay - y0), (bx, by)) / across
            meets = ops.number(0.25) < modulus(component - ops.number(float(index)))
            meets = meets & ops.negated(nought < ends[0] * ends[1]) & ops.negated(across == nought)
            nearer = meets & (nought < reach) & (reach < t)
            t, where = ops.select(nearer, reach, t), ops.select(nearer, ops.number(float(index)), where)
            at = ops.select(nearer, line, at)
        _, _, dx, dy, low, high = self.side(ops, shape, where)
        across, along = dx * v[0] + dy * v[1], dy * v[0] - dx * v[1]
        code = ops.select(grazing(ops, across, along), ops.number(float(Status.GRAZING.code)), nought)
        inside = -ops.maximum(low - at, at - high) * ops.sqrt(dx * dx + dy * dy)
        lands = (ops.number(NEAR) <= inside) & (t < ops.number(FAR))  # what passes between two sides is at a join
        code = ops.select(lands, code, ops.number(float(Status.JOIN.code)))
        return Landing([where, at], across, along, code, {"v": v, "d": (dx, dy)}, {"t": t})

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        return reflected(ops, law, lam, landing)

    def slapped(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        _, _, dx, dy, *_ = self.side(ops, shape, position[0])
        return list(plane.normalised(ops, (-dy, dx)))

    def departure(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        _, _, dx, dy, *_ = self.side(ops, shape, position[0])
        return plane.cross((dx, dy), (exit[0], exit[1]))

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return landing.numbers["t"]

    def bend(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        d = landing.vectors["d"]
        return ops.number(0.0), plane.dot(d, d)
