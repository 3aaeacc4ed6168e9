"""What the transfer operator changes in a piecewise polynomial, and its mean of `log F'`: both bounded in balls.

The half table is cut at the ends of pieces, at their images and at `pi/4`, each image between two exact points
`2*margin` apart. A stretch whose launching points lie within one piece (that is tested in balls, so that a misplaced
cut costs precision and no truth) has an analytic residual `r = L f - f`, bounded by Taylor's series at the middle
with the last coefficient enclosed over the whole stretch; the same for `r'`. On any other stretch, all of them
tiny, the parts of all pieces that it meets are bounded one by one. Where `f` jumps, `r` jumps by that, and by the
rate times that at the image; at `pi/4` nothing jumps, since `f(pi/2) = 0`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from flint import arb, arb_series

from verification.arithmetic.series import Function, expanded
from verification.proofs.slap_map.candidate import Pieces
from verification.proofs.slap_map.transfer import Branches, variation

LONGEST = 0.03  # of the stretches that get a series of their own
NEARNESS = 0.1  # their length over the distance from the cusp, at most, where the rate is 0 and its logarithm is not
SHARE = 0.35  # of a piece that a stretch or its launching points take up, at most
OWN, BELOW, ABOVE = 0, -1, 1  # the function itself, and the two summands of the operator: signs of the landing


@dataclass(frozen=True)
class Residual:
    """Upper bounds of the `L1` norm and of the variation of `L f - f`."""

    norm: arb
    variation: arb


@dataclass(frozen=True)
class Judge:
    """Bounds for a function in pieces that is 0 at `pi/2`, about `digits` sharp, at the ambient `bits`."""

    pieces: Pieces
    digits: int
    bits: int

    @property
    def order(self) -> int:
        """The terms of series."""
        return max(8, 17 * self.digits // 10)

    @cached_property
    def branches(self) -> Branches:
        """`g` and its derivative."""
        return Branches(self.bits)

    @cached_property
    def stretches(self) -> list[tuple[arb, arb]]:
        """Neighbouring exact points, from 0 to beyond `pi/2`, in order; the last stretch is the tail at the cusp."""
        ends, half_pi = self.pieces.ends, arb.pi() / 2
        if not ends[0] == 0 or not ends[-2] < half_pi < ends[-1]:
            raise ValueError(f"density: pieces from {ends[0]} to {ends[-1]}; they must reach from 0 to beyond pi/2")
        margin = arb(2) ** (24 - self.bits)
        images = [abs(self.branches.landing(end, self.bits)) for end in ends[1:-1]] + [half_pi / 2]
        tail = (half_pi - arb(2) ** -(self.digits + 4)).mid()
        cuts = {x.mid().fmpq() for image in images for x in (image - margin, image + margin)}
        cuts |= {x.fmpq() for x in (*ends[:-1], tail)}
        points = [arb(cut) for cut in sorted(cuts) if 0 <= cut <= tail.fmpq()]
        found = [cut for low, high in pairwise(points) for cut in _parted(low, high, self._longest)]
        return [*found, (tail, ends[-1])]

    def residual(self) -> Residual:
        """Bounds of `L f - f`."""
        norm, change = arb(0), (1 + variation().shrinks) * self.pieces.jumps()
        for low, high in self.stretches:
            size, slope = self._bounds(low, high)
            norm += size * (high - low)
            change += slope * (high - low)
        return Residual(arb(norm.abs_upper()), arb(change.abs_upper()))

    def mean(self) -> arb:
        """The integral of `log F'` times the function."""
        total = sum((self._integral(low, high) for low, high in self.stretches[:-1]), arb(0))
        low, high = self.stretches[-1]
        rate = self.branches(-low)[1]  # grows off the cusp, and so does -rate*log(rate) below 1/e
        if not rate * 3 < 1:
            raise ArithmeticError(f"density: the tail from {low} on is too wide to be bounded")
        launches = self.branches(-low)[0].union(self.branches(-high)[0])
        values = sum((abs(self.pieces.value(k, launches)) for k in self._met(BELOW, low, high)), arb(0))
        rest: arb = -rate * rate.log() * values * (high - low) * arb(0, 1)
        return total + rest

    def _longest(self, low: arb) -> float:
        """How long a stretch from `low` on should be, for its series to converge fast: a matter of precision only."""
        ends = self.pieces.ends
        limits = [LONGEST, NEARNESS * float(arb.pi() / 2 - low)]
        launched = [self.branches(low * side) for side in (BELOW, ABOVE) if side == BELOW or low * 4 < arb.pi()]
        for point, rate in ((low, arb(1)), *launched):
            piece = self.pieces.met(point, point)[-1]
            limits.append(SHARE * float((ends[piece + 1] - ends[piece]) / rate))
        return min(limits)

    def _met(self, side: int, low: arb, high: arb) -> range:
        """The pieces that the launching points of a stretch meet."""
        one, other = sorted((side * low, side * high), key=lambda end: end.fmpq())
        return self.pieces.met(self.branches(one)[0], self.branches(other)[0])

    def _own(self, low: arb, high: arb) -> int:
        (inside,) = (k for k, (start, end) in enumerate(pairwise(self.pieces.ends)) if start <= low and high <= end)
        return inside

    def _sides(self, low: arb, high: arb) -> tuple[dict[int, range], bool]:
        """The summands of the operator that are there, with the pieces that they meet; is it one piece for each?"""
        quarter = arb.pi() / 4
        sides = (BELOW,) if low > quarter else (BELOW, ABOVE)
        met = {side: self._met(side, low, high) for side in sides}
        single = all(len(pieces) == 1 for pieces in met.values())
        return met, single and bool(low > quarter or high < quarter)

    def _part(self, side: int, piece: int) -> Function:
        """A summand of the operator with the polynomial of a piece, or the polynomial itself."""

        def terms(x: arb_series) -> arb_series:
            launch, rate = (x, 1) if side == OWN else self.branches(side * x)
            made: arb_series = rate * self.pieces.value(piece, launch)
            return made

        return terms

    def _logarithmic(self, side: int, piece: int) -> Function:
        def terms(x: arb_series) -> arb_series:
            launch, rate = self.branches(side * x)
            made: arb_series = -rate.log() * rate * self.pieces.value(piece, launch)
            return made

        return terms

    def _bounds(self, low: arb, high: arb) -> tuple[arb, arb]:
        """Upper bounds of `abs(r)` and of `abs(r')` on a stretch."""
        met, single = self._sides(low, high)
        itself = self._part(OWN, self._own(low, high))
        if single:
            parts = [self._part(side, pieces[0]) for side, pieces in met.items()]
            whole = expanded(lambda x: sum((part(x) for part in parts), -itself(x)), low, high, self.order)
            return whole.size(), whole.slope()
        parts = [itself, *(self._part(side, k) for side, pieces in met.items() for k in pieces)]
        found = [expanded(part, low, high, 2) for part in parts]
        return sum((each.size() for each in found), arb(0)), sum((each.slope() for each in found), arb(0))

    def _integral(self, low: arb, high: arb) -> arb:
        """The integral of `log F'` times the function over the launches to a stretch, from either side."""
        met, single = self._sides(low, high)
        total = arb(0)
        for side, pieces in met.items():
            if single:
                total += expanded(self._logarithmic(side, pieces[0]), low, high, self.order).integral()
                continue
            sizes = (expanded(self._logarithmic(side, k), low, high, 2).size() for k in pieces)
            total += sum(sizes, arb(0)) * (high - low) * arb(0, 1)
        return total


def _parted(low: arb, high: arb, longest: Callable[[arb], float]) -> Iterator[tuple[arb, arb]]:
    """A stretch in parts no longer than is said of their lower ends."""
    while low < high:
        step = (low + longest(low)).mid()
        end = step if step < high else high
        yield low, end
        low = end
