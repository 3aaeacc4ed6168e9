"""Theorems on the egg's cycles of period 3: contractions where they attract, and where none exist. Paper: section 6.4.

The triangles at the flat points attract for every contraction between the fold and 1. On the branch
(`symbolic.cycles.polygons`) the determinant of one bounce is `f(gamma - delta)/f(gamma + delta)` with `f(x) =
x*cos(x)`, which is below 1 while `f` grows; `1 - trace + det` has the sign of `-(cos(3*theta) + alpha)` and is positive
up to the fold. The remaining condition, `1 + trace + det > 0`, is proved in balls on a cover of the closed branch.

The paper argues against period 3 at small contractions. Its argument takes three bounces from every position with *any*
initial angle, and says that up to `lambda_c` the orbit never returns to that position after three bounces. A
counterexample refutes it: an orbit that obeys the collision rules at the second and third bounce and returns to the
given first position. A second counterexample has an initial angle of at most `lam*pi/2`, which a collision can produce
(in a convex table every such angle is produced).

The theorem that a range of contractions has no cycle of period 3 is proved by excluding every triangle. For a period-3
cycle of a convex table the collision rule `phi_i = -lam*eta_i` and the interior angles `phi_i - eta_i`, which add up to
`pi`, give (counterclockwise, the mirror image being the same)

    0 <= phi_i,    sum phi_i = lam*pi/(1 + lam),    phi_i*eta_j = phi_j*eta_i.

So `phi_i <= lam*pi/(1 + lam)`. Since `phi` falls as the landing point moves on, this gives a least gap between bounces.
Triangles with at least these gaps are covered by boxes. A box is excluded when one of the equations is proved false in
it, by enclosure or by the mean value theorem, and halved otherwise. The angles are enclosed from the gaps and the polar
equation of the egg: the width of a box comes mostly from rotations of the whole triangle, which change the angles
little.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

from flint import arb
from sympy import Expr, Integer, Rational, atan, pi, sqrt, tan

from symbolic.cycles.polygons import characteristic_on_branch, half_turn, largest_tilt
from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import chord_kernel, polar_polygon_kernel, polygon_kernel
from symbolic.tables import egg
from symbolic.tables.table import alpha as letter
from symbolic.tables.table import theta
from verification.arithmetic.balls import Arithmetic, Box, balls, bits_of, exact_balls, working
from verification.arithmetic.iteration import Tick, Vector, silent
from verification.cycles.critical import Small
from verification.cycles.newton import refined
from verification.maps.first_hit import convex
from verification.proofs.periodic.interval_newton import ZeroStatus, interval_newton
from verification.rigorous.exclusion import Search, bisect

BITS = 80
SMALLEST = 2.0**-36  # above it ends of boxes are exact in floats


def flips_nowhere(alpha: Expr, budget: int = 2000) -> bool | None:
    """True if `1 + trace + det > 0` is proved on the whole branch, ends included; None if the budget ends before.

    >>> from sympy import Rational
    >>> flips_nowhere(Rational(2, 25))
    True
    """
    value = characteristic_on_branch(theta, Integer(-1)).subs(letter, alpha)
    with working(BITS):
        at = load(kernel("characteristic", [theta], {"value": value}), balls(BITS))
        end = load(kernel("fold", [], {"fold": acos_of(alpha)}), balls(BITS))()[0]
        return bisect(((0.5, 0.5),), lambda box: bool(at(end * arb(*box[0]))[0] > 0), budget, SMALLEST).proved


def acos_of(alpha: Expr) -> Expr:
    """The formula `acos(alpha)` in functions that the generated kernels have."""
    return pi / 2 - atan(alpha / sqrt(1 - alpha**2))


def contracts(alpha: Expr) -> bool:
    """True if `x*cos(x)` is proved to grow up to the branch's largest incidence angle; then `det < 1` for `lam < 1`.

    >>> from sympy import Rational
    >>> contracts(Rational(2, 25))
    True
    """
    largest = half_turn() + atan(largest_tilt().subs(letter, alpha))
    with working(BITS):
        (slope,) = load(kernel("slope", [], {"slope": 1 - largest * tan(largest)}), balls(BITS))()
        return bool(slope > 0)


DIGITS = 20
SLAP = Rational(1, 5), (0.2838, 3.7697)  # at alpha = 2/25, lam = 0: first bounce, and the next two
PRODUCED = Rational(2, 5), (4.8086, 8.9349)  # at alpha = 2/25, lam = 3/10


@dataclass(frozen=True)
class Witness:
    """An orbit of the egg that starts at `theta0` with exit angle `angle` and returns to `theta0` after three flights.

    `exists` is True if the orbit is proved; `produced` is True if a collision can produce the angle: `|angle| <=
    lam*pi/2`.
    """

    exists: bool | None
    produced: bool | None
    angle: arb


def returning(alpha: Expr, lam: Expr, theta0: Rational) -> Small:
    """The equations for the second and third bounce of an orbit of the egg that returns to `theta0`."""
    table = egg(3).at(alpha=alpha)

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        angle = load(chord_kernel(table, 0, 0, 0), arithmetic)
        given = load(kernel("given", [], {"start": theta0, "lam": lam}), arithmetic)()
        start, contraction = given
        one, two = z
        return [
            angle(one, two)[0] + contraction * angle(one, start)[0],
            angle(two, start)[0] + contraction * angle(two, one)[0],
        ]

    return Small(f"egg, a return to theta0 = {theta0} after three bounces", equations)


def witness(alpha: Expr, lam: Expr, theta0: Rational, near: tuple[float, float]) -> Witness:
    """The proved orbit that returns to `theta0` with second and third bounce near `near`.

    Such orbits are proved at `lam = 0`, and at `lam = 3/10` with an angle that a collision can produce.

    >>> one = witness(Rational(2, 25), Rational(0), *SLAP)
    >>> one.exists, one.produced
    (True, False)
    >>> other = witness(Rational(2, 25), Rational(3, 10), *PRODUCED)
    >>> other.exists, other.produced
    (True, True)
    """
    system = returning(alpha, lam, theta0)
    solution = refined(system, near, DIGITS)
    bits = bits_of(DIGITS, 64)
    with working(bits):
        radius = (arb(10) ** -(DIGITS + 2)).mid()
        found = interval_newton(system, exact_balls(solution.z), radius, bits)
        table = egg(3).at(alpha=alpha)
        angle = load(chord_kernel(table, 0, 0, 0), balls(bits))
        start, contracted = load(kernel("given", [], {"start": theta0, "lam": lam}), balls(bits))()
        phi = angle(start + arb(0), found.zero[0])[0]
        spare = contracted * arb.pi() / 2 - abs(phi)
        exists = True if found.status is ZeroStatus.UNIQUE else None
        return Witness(exists, True if spare > 0 else False if spare < 0 else None, phi)


BITS_OF_COVER = 64


def no_triangles(alpha: Expr, most: Expr, K: int = 3, budget: int = 10**6, tick: Tick = silent) -> Search:
    """The proof that the egg with `K` vertices has no cycle of period 3 for any `0 <= lam <= most`.

    >>> from sympy import Rational
    >>> no_triangles(Rational(2, 25), Rational(1, 4)).proved
    True
    """
    table = egg(K).at(alpha=alpha)
    if convex(table) is not True:
        return Search(None, 0)
    with working(BITS_OF_COVER):
        arithmetic = balls(BITS_OF_COVER)
        angle = load(chord_kernel(table, 0, 0, 0), arithmetic)
        angles, slopes = (load(polygon_kernel(table, 3, order), arithmetic) for order in (0, 1))
        ratio = load(kernel("most", [], {"most": most}), arithmetic)()[0] + arb(0)
        largest = ratio * arb.pi() / (1 + ratio)
        gap = _gap(angle, largest)
        turn = math.ceil(201.07 / K) / 64  # just above pi/K, and exact in binary
        reach = 201.25 / 64 - gap
        start: Box = ((turn, turn), (gap + reach, reach), (gap + reach, reach))
        closer = load(polar_polygon_kernel(table, 3), arithmetic)
        excluded = partial(_impossible, angles, slopes, closer, largest, ratio, gap)
        return bisect(start, excluded, budget, SMALLEST, tick)


def _gap(angle: Any, largest: arb) -> float:
    """A gap of parameters up to which every chord's angle at its start exceeds `largest`; 0 if none is found."""
    gap, pieces = 1.5, 400
    while gap > 0:
        step = 2 * arb.pi() / pieces
        starts = [arb(2 * k + 1, 1) * step / 2 for k in range(pieces)]
        if all(angle(x, x + arb(gap))[0] > largest for x in starts):
            return gap
        gap -= 1 / 16
    return 0.0


def _impossible(angles: Any, slopes: Any, closer: Any, largest: arb, ratio: arb, gap: float, box: Box) -> bool:
    """True if it is proved that no triangle in the box whose first gap is the largest obeys the equations.

    `angles` returns exit and incidence angles at three bounces; `slopes` returns their derivatives too, and takes twice
    the time. `closer` encloses the angles from the gaps (`polar_polygon_kernel`), which reduces the number of boxes to
    a twentieth.
    """
    (first, _), (one, _), (two, _) = box
    wide = [arb(m, r) for m, r in box]
    rest = 2 * arb.pi() - wide[1] - wide[2]
    if rest < gap or wide[1] < wide[2] or wide[1] < rest:  # the first gap may be assumed the largest
        return True
    theta = [wide[0], wide[0] + wide[1], wide[0] + wide[1] + wide[2]]
    ends = [(0, 1), (1, 2), (2, 0)]
    found = _from_gaps(angles, closer, theta, [wide[1], wide[2], rest])
    phi, eta = found[:3], found[3:]
    if any(p < 0 or p > largest for p in phi) or phi[0] + phi[1] + phi[2] > largest:
        return True
    if not all(x.is_finite() for x in found):
        return False
    if any(not (p + ratio * e * _UNIT).contains(0) for p, e in zip(phi, eta, strict=True)):
        return True
    sloped = slopes(*theta)
    dphi = [_slope(sloped[3 * i :], i, j) for i, j in ends]
    deta = [_slope(sloped[3 * i + 9 :], i, i - 1) for i in range(3)]
    middle = angles(arb(first), arb(first) + one, arb(first) + one + two)
    phi_m, eta_m = middle[:3], middle[3:]
    offset = [x - m for x, m in zip(wide, (arb(first), arb(one), arb(two)), strict=True)]
    total = [dphi[0][k] + dphi[1][k] + dphi[2][k] for k in range(3)]
    if phi_m[0] + phi_m[1] + phi_m[2] + _dot(_by_gaps(total), offset) > largest:
        return True
    for i, j in ends:
        value = phi_m[i] * eta_m[j] - phi_m[j] * eta_m[i]
        slope = [
            dphi[i][k] * eta[j] + phi[i] * deta[j][k] - dphi[j][k] * eta[i] - phi[j] * deta[i][k] for k in range(3)
        ]
        if not (value + _dot(_by_gaps(slope), offset)).contains(0):
            return True
    return False


def _from_gaps(angles: Any, closer: Any, theta: Vector, gaps: Vector) -> Vector:
    """The six angles of a triangle from its gaps; or from its parameters, if the gaps give no finite enclosure."""
    values = closer(*theta, *gaps)
    found, ahead = values[:6], values[6:]
    if all(a > 0 for a in ahead) and all(x.is_finite() for x in found):
        return list(found)
    other = angles(*theta)
    return [x if a > 0 and x.is_finite() else y for x, a, y in zip(found, ahead, other, strict=True)]


_UNIT = arb("0.5", "0.5")  # lam/most


def _slope(values: Any, here: int, there: int) -> Vector:
    found: Vector = [0, 0, 0]
    found[here], found[there] = values[1], values[2]
    return found


def _by_gaps(slope: Vector) -> Vector:
    """Derivatives by the first parameter and the two gaps, from derivatives by the three parameters."""
    return [slope[0] + slope[1] + slope[2], slope[1] + slope[2], slope[2]]


def _dot(x: Vector, y: Vector) -> arb:
    total: arb = x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
    return total
