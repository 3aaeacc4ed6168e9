"""That a solution of the chord system is a cycle of the billiard: it is admissible, of minimal period.

In a convex table the chord between two boundary points meets the boundary nowhere else, unless both
lie on the same straight part; so there it is enough that consecutive bounces are different points
and that a finite collision rule shows the chord is not tangent.
"""

from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import gcd

from flint import arb
from sympy import Expr, Interval, Matrix, S, Symbol, chebyshevt, simplify

from symbolic.generation.text import kernel, load
from symbolic.proofs.signs import nonnegative
from symbolic.tables.fourier import coefficients
from symbolic.tables.geometry import turning, velocity
from symbolic.tables.symbols import theta
from symbolic.tables.table import Component, Table
from verification.arithmetic.words import balls, working

BITS = 64
PIECES = 2**12  # boxes that a proof of convexity may use up


def convex(table: Table, shape: tuple[arb, ...] = ()) -> bool | None:
    """True when every part is proved to bend inwards, or to be straight, and the joins to bend in too.

    `shape` encloses the free shape parameters. None: nothing proved.

    >>> from symbolic.tables import cardioid, cuspless, egg
    >>> convex(cuspless), convex(egg(3).at(alpha="0.08")), convex(cardioid)
    (True, True, None)
    >>> convex(egg(3).at(alpha="0.1"))
    True
    """
    return _of_one_shape(table) if not shape else _convex(table, shape)


@cache
def _of_one_shape(table: Table) -> bool | None:
    return _convex(table, ())


def _convex(table: Table, shape: tuple[arb, ...]) -> bool | None:
    if table.undefined:
        return None
    parts = all(_bends_inwards(component, table, shape) for component in table.components)
    return True if parts and _joined(table) else None


def _bends_inwards(component: Component, table: Table, shape: tuple[arb, ...]) -> bool:
    bend = turning(component)
    if bend.is_nonnegative or _exactly_nonnegative(bend):
        return True
    function = load(kernel("turning", [theta, *(p.symbol for p in table.shapes)], {"bend": bend}), balls(BITS))
    with working(BITS):
        start, end = (_ball(x) for x in (component.start, component.end))
        queue, spent = [(Fraction(0), Fraction(1))], 0
        while queue:
            low, high = queue.pop()
            spent += 1
            middle = (low + high) / 2
            share = arb(_exact(middle), _exact((high - low) / 2))
            if not function(start + (end - start) * share, *shape)[0] > 0:
                if spent > PIECES:
                    return False
                queue += [(low, middle), (middle, high)]
    return True


def _exactly_nonnegative(bend: Expr) -> bool:
    """True when a sum of cosines of multiples of `theta` is proved nonnegative, as a polynomial in one of them."""
    waves = coefficients(bend)
    if waves is None or len(waves) < 2 or any(waves.get(-k) != c or not c.is_Rational for k, c in waves.items()):
        return False
    step = gcd(*waves)
    c = Symbol("c", real=True)
    polynomial = sum((w * (2 if k else 1) * chebyshevt(k // step, c) for k, w in waves.items() if k >= 0), S.Zero)
    return bool(nonnegative(polynomial, {c: Interval(-1, 1)}))


@cache
def _joined(table: Table) -> bool:
    ring = (*table.components, table.components[0])
    for before, after in pairwise(ring):
        p, q = velocity(before).subs(theta, before.end), velocity(after).subs(theta, after.start)
        if not simplify(Matrix([p.T, q.T]).det()).is_nonnegative or not simplify(p.dot(q)).is_positive:
            return len(table.components) == 1  # one closed part is smooth where it ends
    return True


def inside(table: Table, components: tuple[int, ...], zero: list[arb]) -> bool | None:
    """True when every bounce is proved to lie in the interior of its component, or on a closed one."""
    if len(table.components) == 1:
        return True
    for index, value in zip(components, zero, strict=False):
        part = table.components[index]
        if not (value > _ball(part.start) and value < _ball(part.end)):
            return False if value < _ball(part.start) or value > _ball(part.end) else None
    return True


def minimal(table: Table, components: tuple[int, ...], zero: list[arb]) -> bool | None:
    """True when no shorter cycle is run through several times: some bounce differs from its image."""
    n = len(components)
    for prime in (k for k in range(2, n + 1) if n % k == 0 and all(k % j for j in range(2, k))):
        shift = n // prime
        if not any(_apart(table, components, zero, i, (i + shift) % n) for i in range(n)):
            return None
    return True


def _apart(table: Table, components: tuple[int, ...], zero: list[arb], i: int, j: int) -> bool:
    if components[i] != components[j]:
        return True
    gap = zero[i] - zero[j]
    closed = len(table.components) == 1
    return not ((gap / 2).sin() if closed else gap).contains(0)


def _ball(x: Expr) -> arb:
    value: arb = load(kernel("end", [], {"end": x}), balls(BITS))()[0] + arb(0)
    return value


def _exact(x: Fraction) -> arb:
    return arb(x.numerator) / x.denominator
