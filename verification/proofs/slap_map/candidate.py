"""A function near the invariant density of the cardioid's slap map: polynomials between the images of `pi/4`.

The second branch of the transfer operator ends at `pi/4`, with a density that vanishes quadratically there; so the
density bends at `pi/4` and, ever more weakly, at its images. Between them it is analytic. Collocation at
Chebyshev's points is solved in floats and refined in balls whose radii are dropped: nothing here is proved, and
nothing needs to be, for `certificates.slap_residual` judges the result as it is.
"""

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from flint import arb, arb_poly
from scipy.linalg import lu_factor, lu_solve

from verification.arithmetic.words import bits_of, working
from verification.proofs.slap_map.transfer import Branches

WIDTH = 0.12  # of the widest piece
SPARE = 2  # digits that are asked for beyond those of the residual


@dataclass(frozen=True)
class Pieces:
    """A function on `[0, pi/2]`: polynomials in `(y - middle)/half` between exact ends, the last end above `pi/2`."""

    ends: list[arb]
    polynomials: list[list[arb]]

    def local(self, piece: int, y: Any) -> Any:
        """The variable of a piece, from -1 to 1 on it."""
        low, high = self.ends[piece], self.ends[piece + 1]
        return (y - (low + high) / 2) * (2 / (high - low))

    def value(self, piece: int, y: Any) -> Any:
        """The polynomial of a piece at a ball or a series."""
        z = self.local(piece, y)
        total = z * 0
        for coefficient in reversed(self.polynomials[piece]):
            total = total * z + coefficient
        return total

    def met(self, low: arb, high: arb) -> range:
        """The pieces whose closed ranges a stretch meets, given balls of its ends."""
        last = len(self.polynomials)
        first = next((k for k in range(last) if not self.ends[k + 1] < low), last - 1)
        beyond = next((k for k in range(first, last) if self.ends[k] > high), last)
        return range(first, max(beyond, first + 1))

    def jumps(self) -> arb:
        """The sum of what the function jumps by at the ends between pieces."""
        inner = list(enumerate(self.ends))[1:-1]
        return sum((abs(self.value(k, end) - self.value(k - 1, end)) for k, end in inner), arb(0))

    def integral(self) -> arb:
        """From 0 to `pi/2`."""
        total = arb(0)
        for k, coefficients in enumerate(self.polynomials):
            anti = arb_poly(coefficients).integral()
            high = arb(1) if k + 1 < len(self.polynomials) else self.local(k, arb.pi() / 2)
            total += (anti(high) - anti(arb(-1))) * (self.ends[k + 1] - self.ends[k]) / 2
        return total

    def grounded(self) -> "Pieces":
        """The same with a constant added to the last piece, so that it is 0 at `pi/2`."""
        last = list(self.polynomials[-1])
        last[0] -= self.value(len(self.polynomials) - 1, arb.pi() / 2)
        return Pieces(self.ends, [*self.polynomials[:-1], last])


def breaks(digits: int, bits: int) -> list[arb]:
    """The ends of pieces: `pi/4` and its images for as long as the bend matters, and some between."""
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


def candidate(digits: int) -> Pieces:
    """The approximate density, to about `digits` digits; its integral is near 1, and it is 0 at `pi/2`.

    >>> with working(128):
    ...     near = candidate(4)
    ...     print(abs(near.integral() - 1) < 1e-3, near.value(0, arb(0)).mid().str(2, radius=False))
    True 1.1
    """
    degree, bits = digits + SPARE, bits_of(digits, 64) + 2 * digits
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
        return Pieces(ends, pieces).grounded()


def _carried(ends: list[arb], points: list[arb], size: int, bits: int) -> list[list[tuple[int, list[arb]]]]:
    """For each point of collocation the parts of `L`: where the coefficients start, and what they are multiplied by."""
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
    """`T_0(x)`, `T_1(x)`, ... by their recursion.

    >>> [int(t.unique_fmpz()) for t in chebyshev(arb(2), 4)]
    [1, 2, 7, 26]
    """
    made = [arb(1), x]
    while len(made) < count:
        made.append((2 * x * made[-1] - made[-2]).mid())
    return made[:count]


def powers(coefficients: list[arb]) -> list[arb]:
    """A sum of Chebyshev's polynomials in powers, exactly as far as the ambient precision goes.

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
