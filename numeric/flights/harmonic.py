"""Tables whose boundary is a finite Fourier sum: the ellipse in closed form, any convex curve by its chord polynomial.

State: the unit numbers `u = exp(i*theta)` and `v`, the particle's direction. The programs that a flight needs come from
`symbolic.motion.flight` through the table IR.
"""

from collections.abc import Sequence
from typing import ClassVar

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair
from numeric.flights.family import SLAP, Boundary, Family, Frame, Landing, Status, grazing, reflected

FAR = 2.0**30  # tan(delta) of any chord lies within
MOST_KNOWN = 256  # tables of which it is remembered whether they are convex


class Harmonic(Family):
    """The base of the families with the module's state: their reflection, tangent map and arc length."""

    position = ("ux", "uy")
    direction = ("vx", "vy")
    pairs = 0, 2
    can_record = True
    order = "generic"

    def point(self, ops: Backend[N, M], *values: N) -> list[N]:
        """The boundary point at `cos(theta)`, `sin(theta)` and the shape."""
        return self.boundary.ir.program("point")(ops, *values)

    def velocity(self, ops: Backend[N, M], *values: N) -> list[N]:
        """Derivative of the boundary point by `theta`."""
        return self.boundary.ir.program("velocity")(ops, *values)

    def acceleration(self, ops: Backend[N, M], *values: N) -> list[N]:
        """Second derivative of the boundary point by `theta`."""
        return self.boundary.ir.program("acceleration")(ops, *values)

    def enter(self, ops: Backend[N, M], component: N, theta: N) -> list[N]:
        return [ops.cos(theta), ops.sin(theta)]

    def place(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        return ops.number(0.0), self.ranged(ops, ops.atan2(position[1], position[0]))

    def framed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Frame[N]:
        d = self.velocity(ops, *position, *shape)
        x, y = self.point(ops, *position, *shape)
        return Frame(x, y, *plane.normalised(ops, (d[0], d[1])))

    def curving(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> Pair[N]:
        d, a = self.velocity(ops, *position, *shape), self.acceleration(ops, *position, *shape)
        square = plane.dot((d[0], d[1]), (d[0], d[1]))
        rate = ops.sqrt(square)
        return rate, plane.cross((a[0], a[1]), (d[0], d[1])) / (square * rate)

    def unit_of_theta(self, ops: Backend[N, M], position: Fields[N]) -> Pair[N]:
        """`exp(i*theta)` at a position in the family's fields."""
        return position[0], position[1]

    def along(self, ops: Backend[N, M], position: Fields[N], theta: N, how: plane.Series, numbers: Fields[N]) -> N:
        """`offset + mean*theta + sum_k a_k*sin(k*theta) + b_k*(1 - cos(k*theta))`, by Horner's or Clenshaw's rule."""
        u = c, s = self.unit_of_theta(ops, position)
        for bit in f"{how.step:b}"[1:]:
            c, s = plane.squared((c, s))
            c, s = plane.times((c, s), u) if bit == "1" else (c, s)
        sines, rises = numbers[2 : 2 + how.terms], numbers[2 + how.terms :]

        def backwards(coefficients: Sequence[N]) -> Pair[N]:
            one, two = coefficients[-1], ops.number(0.0)
            for a in coefficients[-2::-1]:
                one, two = (c + c) * one + (a - two), one
            return one, two

        if how.powers:
            value = sines[-1]
            for a in sines[-2::-1]:
                value = value * c + a
            return numbers[1] * theta + (s * value + numbers[0])
        wave = s * backwards(sines)[0]
        if rises:
            one, two = backwards(rises)
            wave = wave + ((sum(rises[1:], start=rises[0]) + two) - c * one)
        return numbers[1] * theta + wave + numbers[0]

    def landed(
        self, ops: Backend[N, M], shape: Fields[N], law: str, u: Pair[N], v: Pair[N], d: Pair[N] | None = None
    ) -> Landing[N]:
        """The landing at `u` of a particle that flies along `v`; `d` is the tangent there, if known to more digits."""
        dx, dy = d or self.velocity(ops, *u, *shape)
        across = plane.exact_dot(ops, (dx, dy), v)
        along = -plane.exact_cross(ops, (dx, dy), v)
        code = None  # a convex table has no tangent normals
        if law != SLAP:
            code = ops.select(grazing(ops, across, along), ops.number(float(Status.GRAZING.code)), ops.number(0.0))
        return Landing(list(u), across, along, code, {"v": v, "d": (dx, dy)})

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        return reflected(self, ops, law, lam, landing)

    def normal_exit_of_unit_length(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        dx, dy = self.velocity(ops, *position, *shape)
        return list(plane.normalised(ops, (-dy, dx)))

    normal_exit = normal_exit_of_unit_length

    def exit_normal_speed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        dx, dy = self.velocity(ops, *position, *shape)
        return plane.cross((dx, dy), (exit[0], exit[1]))

    def kept(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        return self.point(ops, *position, *shape)

    def leaving_rate(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N], leaving: Fields[N]) -> N:
        d = landing.vectors["d"]
        if not leaving:
            return ops.sqrt(plane.dot(d, d))
        return plane.cross(d, (leaving[0], leaving[1]))

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        d = landing.vectors["d"]
        ax, ay = self.acceleration(ops, *landing.position, *shape)
        return plane.cross((ax, ay), d), plane.dot(d, d)


class Ellipse(Harmonic):
    """The ellipse, with one harmonic: for the mean `m` of a chord's parameters `exp(i*m)` lies along `support`."""

    name, path = "ellipse", "closed form in unit numbers"
    narrow = 32  # few values are alive at a time

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        self.support = boundary.ir.program("support")

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        return boundary.ir.has("support") and not boundary.ir.has("focus")

    def elliptic(self) -> float | None:
        ops, shape = self.boundary.ops, self.boundary.shape
        (right, up), (left, down) = (self.velocity(ops, *u, *shape) for u in ((1.0, 0.0), (0.0, 1.0)))
        if (right, up, down) != (0.0, 1.0, 0.0):
            return None
        return float((1 + left) * (1 - left))  # the axis is -left: the velocity at the top

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        v = exit[0], exit[1]
        M = self.support(ops, v[1], -v[0], *shape)
        inverse = ops.number(1.0) / plane.dot((M[0], M[1]), (M[0], M[1]))
        x, y = plane.times(plane.squared((M[0], M[1])), (position[0], -position[1]))
        landing = self.landed(ops, shape, law, plane.unit(ops, (x * inverse, y * inverse)), v)
        landing.numbers["inverse"] = inverse
        return landing

    def kept(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        return []

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return ops.number(-2.0) * self.turning(ops, shape) * (n0 * landing.numbers["inverse"])

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        d = landing.vectors["d"]
        return self.turning(ops, shape), plane.dot(d, d)

    def turning(self, ops: Backend[N, M], shape: Fields[N]) -> N:
        """Acceleration cross velocity: minus the determinant of the affine map from the circle, a constant."""
        start = ops.number(1.0), ops.number(0.0)
        ax, ay = self.acceleration(ops, *start, *shape)
        dx, dy = self.velocity(ops, *start, *shape)
        return plane.cross((ax, ay), (dx, dy))

    def normal_exit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        dx, dy = self.velocity(ops, *position, *shape)
        return [-dy, dx]


class Fourier(Harmonic):
    """Any convex Fourier sum: the only real zero of the chord polynomial is found from the circle's chord."""

    steps = 1, 1

    name, path = "fourier", "chord polynomial, one real zero"

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        self.chord = boundary.ir.program("chord")

    known: ClassVar[dict[tuple[str | float, ...], bool]] = {}  # which tables were found convex: it takes a millisecond

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        if not boundary.ir.has("chord"):
            return False
        table: tuple[str | float, ...] = (boundary.ir.as_text(), *boundary.shape)
        if table not in cls.known:
            if len(cls.known) >= MOST_KNOWN:
                cls.known.clear()
            cls.known[table] = boundary.convex
        return cls.known[table]

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        v = exit[0], exit[1]
        E = v[1], -v[0]
        # the rounding of B moves the zero most where the boundary is flat, and is its own to the last bit here
        u = position[0], position[1]
        B = plane.unit(ops, (plane.exact_dot(ops, E, u), plane.exact_cross(ops, u, E)))
        p = self.chord(ops, *E, *B, *shape)
        one, two = ops.number(1.0), ops.number(2.0)
        start = -(p[0] * p[1]) / (p[1] * p[1] - p[0] * p[2])  # Halley's step from T = 0
        T = ops.polynomial_zero(p, start, ops.number(-FAR), ops.number(FAR), one, self.steps)
        s = two * T / (T * T + one)
        c = one - T * s
        u = plane.unit(ops, plane.times(plane.times(B, E), (c, s)))
        return self.landed(ops, shape, law, u, v)
