"""A bound for all that the truncated series of a local manifold leave out, for saddles of any number of bounces.

Let `P[i]`, `0 <= i < p`, be the polynomials of order `N`, continued to all `i` by
`P[i+p](z) = sign*P[i](mu*z) + shift`. Sought are functions `h[i]`, analytic on the unit disc, without terms up
to order `N` and continued likewise, such that `P + h` obeys the rule. Let `m` be the multiplier outwards: `mu` for
the unstable manifold, `1/mu` for the stable one. Going outwards, each rule is solved for its outermost point:

1. The rule along `P` is an analytic function without terms up to order `N`. So on the unit disc it is at
   most `R**-(N+1)` times its bound on the disc of radius `R` (Schwarz's lemma): one evaluation in balls.
2. One round nearer to the saddle the functions are `sign*h[i](z/m)`, at most `abs(m)**-(N+1)` times the bound of
   `h[i]` (Schwarz again). This makes the sought functions small on the right side, and no inverse is needed.
3. Where the two inner points of a rule are off by at most `e1` and `e2`, the outermost one is off by at most
   `(defect + slope1*e1 + slope2*e2)/slope0`. The slopes are bounded over a convex tube around `P`, and `slope0`
   is not 0 there, so such a point exists and is the only one in the tube (an interval Newton step).

So a round outwards takes bounds `e[0], ..., e[p-1]` to bounds `E(e)`, an affine and monotone map. It is checked
that `E(e) <= e < TUBE` for `e = 2*E(0)`. Then functions bounded by `e` are taken to functions bounded by `e`, and their
distances, in the norm weighted by `e`, at least halved. The one fixed point is `h`. It is analytic in the letter,
and real where the letter is, as all else is. Dividing `z` by `m` again and again leads along an orbit to the
saddle: this is the manifold.
"""

from flint import acb, arb

from verification.manifolds.enclosed import Enclosed, TooWideError, around_zero, size
from verification.shooting.jets import Jet

TUBE = "1e-6"  # what the remainder may not exceed, so that the slopes are bounded beforehand


def remainder(made: Enclosed, outer: int) -> arb:
    """What bounds the remainder of every bounce on the unit disc, by the rule on the disc of radius `outer`."""
    if not vanishing(made):
        raise TooWideError("remainder", "the rule has terms of low order; these are no coefficients of a manifold")
    slopes = round_outwards(made, outer)
    least = bounds(made, slopes, [arb(0)] * len(slopes))
    allowed = [2 * e for e in least]
    found = bounds(made, slopes, allowed)
    if not all(e <= a and a < arb(TUBE) for e, a in zip(found, allowed, strict=True)):
        raise TooWideError("remainder", "the remainder of the series is not bounded")
    return max(allowed, key=lambda e: e.mid())


def vanishing(made: Enclosed) -> bool:
    """Do the rules' coefficients up to the order of the series contain 0?"""
    map, ring = made.saddle.map.lifted, made.ring()
    triples = [ring[i : i + 3] for i in range(len(ring) - 2)]
    rules: list[Jet] = [map.rule(triple, made.saddle.letter) for triple in triples]
    return all(c.contains(0) for rule in rules for c in rule.c)


Outwards = list[tuple[int, arb, arb, arb]]  # for each bounce: defect, slope by the point inside it and the one before


def round_outwards(made: Enclosed, outer: int) -> Outwards:
    """One round from the saddle, each rule solved for its outermost point, with bounds in units of `slope0`."""
    map, letter, p = made.saddle.map, made.saddle.letter, len(made.coefficients)
    inside = -1 if made.unstable else 1
    found: Outwards = []
    for i in range(p) if made.unstable else reversed(range(p)):
        three = [i + inside + k for k in (-1, 0, 1)]
        defect = size(map.rule([made.over(j, arb(outer)) for j in three], letter))
        tube = [made.over(j, arb(1)) + around_zero(arb(TUBE)) for j in three]
        rows = map.slopes(tube, letter)
        far, here, outermost = rows if made.unstable else rows[::-1]
        least = arb(acb(outermost).abs_lower())
        if not least > 0:
            raise TooWideError("remainder", "a slope of the rule may be 0")
        found.append((i, defect / least * arb(outer) ** -(made.order + 1), size(here) / least, size(far) / least))
    return found


def bounds(made: Enclosed, slopes: Outwards, errors: list[arb]) -> list[arb]:
    """`E(e)` of the text above: bounds one round outwards from `errors`."""
    p, inside = len(errors), -1 if made.unstable else 1
    shrink = size(1 / made.factor if made.unstable else made.factor) ** (made.order + 1)
    known: dict[int, arb] = {}

    def bound(j: int) -> arb:
        return known[j] if j in known else errors[j % p] * shrink ** abs(j // p)

    for i, defect, here, far in slopes:
        known[i] = size(defect + here * bound(i + inside) + far * bound(i + 2 * inside))
    return [known[i] for i in range(p)]
