"""One-step expansion in the cardioid: short curves grow in one bounce although the cusp cuts them. Paper: section 4.1.

S is the set of phase points whose flights land at the cusp; `C`, `x`, `c0` and `c1` are coordinates near it, defined in
`symbolic.cycles.cusp`. Let a curve with tangents in the cone lie in the strip `abs(phi) <= lam*pi/2` and have at most
the length `share*(1 - lam)**3`. Away from S a bounce stretches the curve by `expansion` at least. The curve crosses S
at most once, and then:

- *the piece that passes the cusp* begins with `C = 0`, and `C**3 <= 3*(1 + lam)*u` after a length `u`. So `C <= turn`
  on all of it, and there `least() >= passing`;
- *the piece that lands at it* has `c1**3 <= 3*(1 + lam)*u`, and `c0 >= 1 - lam - u/3`, since S has `c0 >= 1 - lam` and
  `da = du/3`. So `x >= near` on all of it, and there `least() >= landing`.

Then `1/passing + 1/landing < 1/expansion` at every contraction.
"""

from dataclasses import dataclass

from sympy import Expr, Interval, Rational, oo

from symbolic.cycles.cusp import expansion, least, leaves_the_cusp
from symbolic.cycles.defocusing import C, x
from symbolic.expressions.signs import nonnegative, positive
from symbolic.tables.table import lam
from verification.rigorous.theorem import Theorem, hypothesis

EVERY = {lam: Interval(0, 1)}  # all contractions


@dataclass(frozen=True)
class OneStepExpansion(Theorem):
    """A short curve is cut by the cusp in at most two pieces, and `1/passing + 1/landing` is below `1/expansion`.

    The statement holds for each `0 <= lam < 1` and each curve in the strip `abs(phi) <= lam*pi/2` of the cardioid with
    tangents in the cone and a length of at most `share*(1 - lam)**3` in `|K|*ds`, with the curvature `K`. `passing` and
    `landing` are the least stretches of the piece that passes the cusp, where `C <= turn`, and of the piece that lands
    at it, where `x >= near`; a flight from `theta0` to `theta1` has `C = cos((theta1 - theta0)/2)` and `x =
    cos(theta0/2)/cos(theta1/2)`.

    >>> OneStepExpansion(Rational(1, 48000), Rational(7, 5), 5, Rational(1, 5), 19).proved
    True
    """

    share: Expr
    passing: Expr
    landing: Expr
    turn: Expr
    near: Expr

    @property
    def length(self) -> Expr:
        """The largest length of the curves, as a formula in `lam`."""
        return self.share * (1 - lam) ** 3

    @hypothesis
    def leaves(self) -> bool:
        """A curve meets S at most once; stretches, and the speed at which pieces leave S, are bounded."""
        return bool(leaves_the_cusp())

    @hypothesis
    def passes(self) -> bool:
        """Where `0 <= C <= turn`, a bounce stretches by `passing` at least."""
        return bool(nonnegative(least() - self.passing, {x: Interval(0, oo), C: Interval(0, self.turn)}))

    @hypothesis
    def turns(self) -> bool:
        """A piece that passes the cusp is too short for `C` to reach `turn`."""
        return bool(positive(self.turn**3 - 3 * (1 + lam) * self.length, EVERY))

    @hypothesis
    def lands(self) -> bool:
        """Where `x >= near`, a bounce stretches by `landing` at least."""
        return bool(nonnegative(least() - self.landing, {x: Interval(self.near, oo), C: Interval(0, 1)}))

    @hypothesis
    def nears(self) -> bool:
        """A piece that lands at the cusp is too short for `x` to fall to `near`."""
        from_cusp = (1 - self.share * (1 - lam) ** 2 / 3) ** 3
        return bool(positive(from_cusp - 3 * (1 + lam) * self.share * self.near**3, EVERY))

    @hypothesis
    def sums(self) -> bool:
        """`1/passing + 1/landing`, both terms positive, is below the least value of `1/expansion`, at `lam = 0`."""
        room = 1 / expansion().subs(lam, 0) - 1 / self.passing - 1 / self.landing
        return all(positive(each, {}) for each in (self.passing, self.landing, room))


ONE_STEP = OneStepExpansion(Rational(1, 48000), Rational(7, 5), Rational(5), Rational(1, 5), Rational(19))
