"""The egg's triangles at the flat points: attracting for every contraction between the fold and 1.

On the branch (`symbolic.cycles.polygons`) the determinant of one bounce is `f(gamma - delta)/f(gamma + delta)`
with `f(x) = x*cos(x)`, which is below 1 while `f` grows; `1 - trace + det` has the sign of
`-(cos(3*theta) + alpha)` and is positive up to the fold. What is left, `1 + trace + det > 0`, balls
decide on a cover of the closed branch. Paper: section 6.4.
"""

from flint import arb
from sympy import Expr, Integer, Symbol, atan, pi, sqrt, tan

from symbolic.cycles.polygons import characteristic_on_branch, half_turn, largest_tilt
from symbolic.generation.text import kernel, load
from symbolic.tables.symbols import alpha as letter
from verification.arithmetic.words import balls, working

BITS = 80


def flips_nowhere(alpha: Expr, budget: int = 2000) -> bool | None:
    """Is `1 + trace + det > 0` on the whole branch, ends included? None when the budget ends first.

    >>> from sympy import Rational
    >>> flips_nowhere(Rational(2, 25))
    True
    """
    x = Symbol("x", real=True)
    value = characteristic_on_branch(x, Integer(-1)).subs(letter, alpha)
    with working(BITS):
        at = load(kernel("characteristic", [x], {"value": value}), balls(BITS))
        end = load(kernel("fold", [], {"fold": acos_of(alpha)}), balls(BITS))()[0]
        queue, spent = [(0.5, 0.5)], 0
        while queue:
            middle, half = queue.pop()
            spent += 1
            if spent > budget:
                return None
            if not at(end * arb(middle, half))[0] > 0:
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True


def acos_of(alpha: Expr) -> Expr:
    """`acos(alpha)` in the vocabulary of the kernels."""
    return pi / 2 - atan(alpha / sqrt(1 - alpha**2))


def contracts(alpha: Expr) -> bool:
    """Does `x*cos(x)` grow up to the largest incidence angle of the branch? Then `det < 1` for `lam < 1`.

    >>> from sympy import Rational
    >>> contracts(Rational(2, 25))
    True
    """
    largest = half_turn() + atan(largest_tilt().subs(letter, alpha))
    with working(BITS):
        (slope,) = load(kernel("slope", [], {"slope": 1 - largest * tan(largest)}), balls(BITS))()
        return bool(slope > 0)
