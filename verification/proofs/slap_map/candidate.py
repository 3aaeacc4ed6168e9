"""An approximate invariant density of the cardioid's slap map, piecewise polynomial, and rigorous bounds for its error.

`L`, `F`, `g` and launching points are defined in `transfer`. The second summand of the transfer operator `L` ends at
`pi/4`, where it vanishes quadratically; so a derivative of the density jumps at `pi/4` and, ever more weakly, at its
images. Between them the density is analytic. The approximation is found, without proof, by collocation at Chebyshev
points, in floats refined in multiprecision. The residual `L f - f` and the mean of `log F'` are then bounded in balls,
with proof.

For this the half table is cut into *stretches* at the ends of pieces, at their images and at `pi/4`, each image
enclosed between two exact points `2*margin` apart. If balls prove that the launching points of a stretch lie within one
piece, the residual `r = L f - f` is analytic on it, and `r` and `r'` are bounded by Taylor series at the middle, with
the last coefficient enclosed over the whole stretch. On the other stretches, which are tiny, the contributions of all
pieces that they meet are bounded separately. A jump of `f` contributes itself and its image under `L` to the variation
of `r`; at `pi/4` there is no jump, since `f(pi/2) = 0`.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from flint import arb, arb_poly, arb_series
from scipy.linalg import lu_factor, lu_solve

from verification.arithmetic.balls import bits_of, working
from verification.arithmetic.series import Function, expanded
from verification.proofs.slap_map.transfer import Branches, variation

WIDTH = 0.12  # the largest width of a piece
SPARE = 2  # extra digits of the approximation


@dataclass(frozen=True)
class PiecewisePolynomial:
    """A function on `[0, pi/2]`, on each piece a polynomial in `(y - middle)/half`; the last end is above `pi/2`."""

    ends: list[arb]
    polynomials: list[list[arb]]

    def local(self, piece: int, y: Any) -> Any:
        """The local variable of a piece, from -1 to 1."""
        low, high = self.ends[piece], self.ends[piece + 1]
        return (y - (low + high) / 2) * (2 / (high - low))

    def value(self, piece: int, y: Any) -> Any:
        """The value of the polynomial of a piece at a ball or a series."""
        z = self.local(piece, y)
        total = z * 0
        for coefficient in reversed(self.polynomials[piece]):
            total = total * z + coefficient
        return total

    def met(self, low: arb, high: arb) -> range:
        """The indices of the pieces whose closed intervals may meet the interval from `low` to `high`."""
        last = len(self.polynomials)
        first = next((k for k in range(last) if not self.ends[k + 1] < low), last - 1)
        beyond = next((k for k in range(first, last) if self.ends[k] > high), last)
        return range(first, max(beyond, first + 1))

    def jumps(self) -> arb:
        """The sum of the absolute jumps at the ends between pieces."""
        inner = list(enumerate(self.ends))[1:-1]
        return sum((abs(self.value(k, end) - self.value(k - 1, end)) for k, end in inner), arb(0))

    def integral(self) -> arb:
        """The integral of the function from 0 to `pi/2`."""
        total = arb(0)
        for k, coefficients in enumerate(self.polynomials):
            anti = arb_poly(coefficients).integral()
            high = arb(1) if k + 1 < len(self.polynomials) else self.local(k, arb.pi() / 2)
            total += (anti(high) - anti(arb(-1))) * (self.ends[k + 1] - self.ends[k]) / 2
        return total

    def grounded(self) -> "PiecewisePolynomial":
        """The function with a constant added on the last piece, such that the value at `pi/2` is 0."""
        last = list(self.polynomials[-1])
        last[0] -= self.value(len(self.polynomials) - 1, arb.pi() / 2)
        return PiecewisePolynomial(self.ends, [*self.polynomials[:-1], last])


def breaks(digits: int, bits: int) -> list[arb]:
    """The ends of pieces: `pi/4`, those of its images where the density is not smooth enough, and points in between."""
    at = Branches(bits)
    point, weight = (arb.pi() / 4).mid(), 1.0
    found = [point]
    while weight > 10.0**-digits:
        landing = at.landing(point, bits)
        weight *= float(at(landing)[1]) ** 3
        point = abs(landing)
        found.append(point)
    inner = sorted(found, key=float)
    outer = [arb(0), *inner, (arb.pi() / 2).mid() + arb(2) ** (8 - bits)]
    made = [arb(0)]
    for low, high in pairwise(outer):
        parts = ceil(float(high - low) / WIDTH)
        made += [(low + (high - low) * k / parts).mid() for k in range(1, parts)] + [high.mid()]
    return made


def precision(digits: int) -> int:
    """The number of bits used for a density of so many digits."""
    return bits_of(digits, 64) + 2 * digits


def candidate(digits: int) -> PiecewisePolynomial:
    """The approximate density, to about `digits` digits; its integral is near 1, and its value at `pi/2` is 0.

    >>> with working(128):
    ...     near = candidate(4)
    ...     print(abs(near.integral() - 1) < 1e-3, near.value(0, arb(0)).mid().str(2, radius=False))
    True 1.1
    """
    degree, bits = digits + SPARE, precision(digits)
    with working(bits):
        ends = breaks(digits, bits)
        size, panels = degree + 1, len(ends) - 1
        points = [arb(float(x)) for x in np.cos(np.pi * (np.arange(size) + 0.5) / size)]
        basis = [chebyshev(x, size) for x in points]
        rows = _carried(ends, points, size, bits)
        whole = [arb(0 if k % 2 else 1) * 2 / (1 - k * k) if k % 2 == 0 else arb(0) for k in range(size)]
        weights = [(high - low) / 2 * w for low, high in pairwise(ends) for w in whole]
        count = size * panels
        dense = np.zeros((count + 1, count + 1))
        for i, terms in enumerate(rows):
            for start, values in terms:
                dense[i, start : start + size] += [float(v) for v in values]
            start = i // size * size
            dense[i, start : start + size] -= [float(v) for v in basis[i % size]]
        dense[:count, count] = 1
        dense[count, :count] = [float(w) for w in weights]
        factors = lu_factor(dense)
        unknown = [arb(0)] * (count + 1)
        for _ in range(digits // 9 + 2):
            gaps = [-unknown[count]] * count + [1 - _dot(weights, unknown)]
            for i, terms in enumerate(rows):
                own = i // size * size
                gaps[i] += _dot(basis[i % size], unknown[own : own + size])
                gaps[i] -= sum((_dot(values, unknown[start : start + size]) for start, values in terms), arb(0))
            most = max(abs(float(gap)) for gap in gaps)
            if most == 0:
                break
            step = lu_solve(factors, np.array([float(gap / most) for gap in gaps]))
            unknown = [(old + arb(float(new)) * most).mid() for old, new in zip(unknown, step, strict=True)]
        pieces = [powers(unknown[k * size : (k + 1) * size]) for k in range(panels)]
        return PiecewisePolynomial(ends, pieces).grounded()


def _carried(ends: list[arb], points: list[arb], size: int, bits: int) -> list[list[tuple[int, list[arb]]]]:
    """For each collocation point the terms of `L f`: a piece's first index, and the factors of its coefficients."""
    at, quarter = Branches(bits), arb.pi() / 4
    floats = [float(end) for end in ends]
    rows = []
    for low, high in pairwise(ends):
        for z in points:
            x = ((low + high) / 2 + (high - low) / 2 * z).mid()
            terms = []
            for landing in (-x, x) if x < quarter else (-x,):
                launch, rate = (value.mid() for value in at(landing))
                panel = min(max(bisect_right(floats, float(launch)) - 1, 0), len(ends) - 2)
                local = (2 * launch - ends[panel] - ends[panel + 1]) / (ends[panel + 1] - ends[panel])
                terms.append((panel * size, [(rate * t).mid() for t in chebyshev(local.mid(), size)]))
            rows.append(terms)
    return rows


def chebyshev(x: arb, count: int) -> list[arb]:
    """The values `T_0(x)`, `T_1(x)`, ... of the Chebyshev polynomials, by recursion.

    >>> [int(t.unique_fmpz()) for t in chebyshev(arb(2), 4)]
    [1, 2, 7, 26]
    """
    made = [arb(1), x]
    while len(made) < count:
        made.append((2 * x * made[-1] - made[-2]).mid())
    return made[:count]


def powers(coefficients: list[arb]) -> list[arb]:
    """The coefficients in powers of `x` of a sum of Chebyshev polynomials, rounded to the ambient precision.

    >>> [int(c.unique_fmpz()) for c in powers([arb(1), arb(0), arb(3)])]
    [-2, 0, 6]
    """
    before, current = arb_poly([1]), arb_poly([0, 1])
    total = arb_poly([coefficients[0]])
    for coefficient in coefficients[1:]:
        total += coefficient * current
        before, current = current, arb_poly([0, 2]) * current - before
    return [c.mid() for c in total.coeffs()]


def _dot(one: list[arb], other: list[arb]) -> arb:
    return sum((a * b for a, b in zip(one, other, strict=False)), arb(0)).mid()


LONGEST = 0.03  # the longest stretch with a Taylor series
NEARNESS = 0.1  # the largest ratio of a stretch to its distance from the cusp, where the rate is 0
SHARE = 0.35  # the largest part of a piece that a stretch or its launching points may cover
OWN, BELOW, ABOVE = 0, -1, 1  # the function itself; the summands of L with landings -x and x


@dataclass(frozen=True)
class Residual:
    """Upper bounds of the `L1` norm and of the variation of `L f - f`, which is 0 for an invariant density `f`."""

    norm: arb
    variation: arb


@dataclass(frozen=True)
class Judge:
    """Rigorous bounds for a piecewise polynomial that is 0 at `pi/2`, in balls fit for about `digits` digits."""

    pieces: PiecewisePolynomial
    digits: int
    bits: int

    @property
    def order(self) -> int:
        """The order of the Taylor series."""
        return max(8, 17 * self.digits // 10)

    @cached_property
    def branches(self) -> Branches:
        """The launching point `g` and its derivative, as functions of the landing."""
        return Branches(self.bits)

    @cached_property
    def stretches(self) -> list[tuple[arb, arb]]:
        """Stretches, from 0 to beyond `pi/2`; their ends are exact, and the last stretch is the tail at the cusp."""
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
        """Bounds of `L f - f`, with `f` the piecewise polynomial and `L` the transfer operator."""
        norm, change = arb(0), (1 + variation().shrinks) * self.pieces.jumps()
        for low, high in self.stretches:
            size, slope = self._bounds(low, high)
            norm += size * (high - low)
            change += slope * (high - low)
        return Residual(arb(norm.abs_upper()), arb(change.abs_upper()))

    def mean(self) -> arb:
        """The integral of `log F'` times the piecewise polynomial, where `F` is the slap map in half angles."""
        *inner, (low, high) = self.stretches
        rate = self.branches(-low)[1]  # it grows away from the cusp, as does -rate*log(rate) below 1/e
        if not rate * 3 < 1:
            raise ArithmeticError(f"density: the tail from {low} on is too wide to be bounded")
        launches = self.branches(-low)[0].union(self.branches(-high)[0])
        values = sum((abs(self.pieces.value(k, launches)) for k in self._met(BELOW, low, high)), arb(0))
        rest = rate * rate.log() * values * (high - low) * arb(0, 1)
        return sum((self._integral(*ends) for ends in inner), rest)

    def _longest(self, low: arb) -> float:
        """A length up to which series on a stretch from `low` converge fast; it affects the precision only."""
        ends = self.pieces.ends
        limits = [LONGEST, NEARNESS * float(arb.pi() / 2 - low)]
        launched = [self.branches(low * side) for side in (BELOW, ABOVE) if side == BELOW or low * 4 < arb.pi()]
        for point, rate in ((low, arb(1)), *launched):
            piece = self.pieces.met(point, point)[-1]
            limits.append(SHARE * float((ends[piece + 1] - ends[piece]) / rate))
        return min(limits)

    def _met(self, side: int, low: arb, high: arb) -> range:
        """The indices of the pieces that the launching points of a stretch meet, for the summand `side` of `L`."""
        one, other = sorted((side * low, side * high), key=lambda end: end.fmpq())
        return self.pieces.met(self.branches(one)[0], self.branches(other)[0])

    def _own(self, low: arb, high: arb) -> int:
        (inside,) = (k for k, (start, end) in enumerate(pairwise(self.pieces.ends)) if start <= low and high <= end)
        return inside

    def _sides(self, low: arb, high: arb) -> tuple[dict[int, range], bool]:
        """The pieces met by each summand of `L` on a stretch; True if one each, and `pi/4` is not in the stretch."""
        quarter = arb.pi() / 4
        beyond = low > quarter
        met = {side: self._met(side, low, high) for side in ((BELOW,) if beyond else (BELOW, ABOVE))}
        single = all(len(pieces) == 1 for pieces in met.values())
        return met, single and bool(beyond or high < quarter)

    def _part(self, side: int, piece: int) -> Function:
        """Function that summand `side` of `L` makes of the polynomial of one piece; for `OWN` the polynomial itself."""

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
        """Upper bounds of the absolute values of the residual `r = L f - f` and of its derivative, on a stretch."""
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
        """Integral of `log F'` times the function over the launching points of a stretch, summed over both summands."""
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
    """A stretch cut into parts; a part from `start` on is at most `longest(start)` long."""
    while low < high:
        end = min(high, (low + longest(low)).mid())  # equals `high` unless the other is surely less
        yield low, end
        low = end
