"""Lower and upper bounds of `nu_plus` for almost every orbit of a trapping region, by standard pairs and potentials.

The lemma and its proof are in docs/global.md. A family of pieces of unstable curves is described by four numbers for
each label `i`: the mass `r[i]` of pieces that cross their whole column, the mass `e[i]` of the other pieces, the sum
`E[i]` of densities at ends of curves, and the sum `C[i]` of densities at those ends that lie on a join, where a column
ends. After one bounce

- the mass `r[i]` of an unbroken label is distributed in known shares over the columns that its image meets, other mass
  moves along edges;
- ends move along edges, and their density is divided by the stretching; `e[i] <= length*E[i]/(1 - D)`;
- a curve cut by a join has two more ends, of type `C`. Its density at the cut is at most that of half the mass in a
  window of `window` columns on each side, or of an end there, if the curve ends before.

Numbers `y`, `w`, `v` for each label with

    E:  w >= length*s/(1 - D) + tiny + (max w over edges)/least + cuts,   s >= greatest + max y over edges - y - high
    C:  v >= tiny + (max w over edges)/least + cuts
    r:  mean + (shares of max y over rows) + cuts <= y + high

make `sum(y*(r + e) + w*E + v*C)` a potential: the mean of the logarithm of the stretching over any family is at most
`high`, up to a bounded sum. Any numbers with `w > 0` and `v > 0` that satisfy the inequalities prove the bound:
`potential` finds such numbers and `holds` checks them. The same inequalities with minus the logarithm give the lower
bound.
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor

import numpy as np

from numeric.backends import elementary
from verification.arithmetic.arrays import Array, Indices
from verification.proofs.starts.curves import CurveMap
from verification.proofs.starts.standard_pairs import Pairs, pairs
from verification.rigorous.graph import Cells, Grid
from verification.rigorous.theorem import Theorem, hypothesis

UP, DOWN = 1 + 1e-12, 1 - 1e-12
SLACK = 1e-9  # for rounding errors, which `holds` proves to be smaller
LARGEST = 1e4
TINY = 1e-9
STEPS, PRECISE = 3000, 1e-5
WEIGHTS = 4000  # the most iterations for the numbers of the ends


class Cut:
    """The curves that one join cuts: the broken labels, the windows beside them, and the labels of the new ends."""

    def __init__(self, found: Pairs, broken: Indices, window: int) -> None:
        labels, count = found.labels, found.labels.count
        hulls, ends = labels.hulls(), np.zeros(count, dtype=bool)
        ends[broken] = True
        self.window = np.zeros(count, dtype=bool)
        for side in (-1, 1):
            near = broken
            for _ in range(window):
                chart, column = labels.chart[near], labels.column[near] + side
                if np.any((column < 0) | (column >= labels.columns[chart])):
                    raise ValueError(
                        "a window beside a join reaches the next join; give a smaller window or more columns"
                    )
                foot, way = labels.bottom[chart] + labels.row[near] * labels.high[chart], side * labels.wide[chart]
                phi, slopes = (foot, foot + labels.high[chart]), (labels.low[near], labels.top[near])
                met = labels.named(labels.crossed(near, chart, column, phi, (way, way), slopes, hulls))[1]
                near = np.unique(met[met >= 0])
                self.window[near] = True
        self.near = self.window | ends
        whole = (labels.columns * labels.wide).min()  # between two cuts by the same join a curve crosses a component
        if (2 * window + 3) * labels.wide.max() * found.cast.most[self.near].max() > whole:
            raise ValueError("a curve may meet a join twice within a window; give a smaller window or more columns")
        least = float(found.cast.least[broken].min())
        growth = (window + 1) * float((found.density * labels.wide[labels.chart])[self.near].max())
        if growth > 0.5:
            raise ValueError("densities vary too much next to a join; give finer columns")
        self.size = UP / (least * (1 - growth))
        self.mass = self.size / (window * labels.wide[labels.chart])
        corner = (labels.column == 0) | (labels.column == labels.columns[labels.chart] - 1)
        to = np.unique(found.edges[1][np.isin(found.edges[0], broken)])
        self.new = to[corner[to]]
        if not self.new.size:
            raise ValueError("no label holds the ends of curves that a join cuts")


class Balance:
    """The coefficients of the inequalities for masses and ends, computed from standard pairs.

    In its methods the index `gain` is 0 for the logarithm of the stretching, and 1 for minus the logarithm.
    """

    def __init__(self, found: Pairs, window: int) -> None:
        labels, cast, spread = found.labels, found.cast, found.spread
        self.found, self.count = found, labels.count
        self.edges = found.edges
        self.starts = np.searchsorted(self.edges[0], np.arange(self.count))
        if np.any(np.bincount(self.edges[0], minlength=self.count) == 0):
            raise ValueError("a label has no image")
        width = labels.wide[labels.chart]
        turn = found.density * width  # a bound of the variation of log-densities over a column
        if turn.max() > 0.5:
            raise ValueError("densities vary too much within a column; give finer columns")
        self.length, self.least = width / (1 - turn) * UP, cast.least * DOWN
        if len(labels.map.charts) > 1 and window < 1:
            raise ValueError(f"window = {window}; accepted: at least one column")
        self.cuts = self._cuts(window)
        low, high = spread.leaves
        source = spread.targets.source
        self.first = np.clip(low - turn[source] / 4, 0, 1), np.clip(high + turn[source] / 4, 0, 1)
        self.entry, self.to = labels.named(spread.targets)
        self.rows = np.searchsorted(self.entry, np.arange(source.size))
        with np.errstate(divide="ignore"):
            size, part = np.abs(cast.landed.stretch.m), (cast.label, cast.part)
            ends = []
            for how, value in ((np.maximum, size + cast.landed.stretch.r), (np.minimum, size - cast.landed.stretch.r)):
                whole = np.full((self.count, labels.parts), np.inf if how is np.minimum else -np.inf)
                how.at(whole, part, elementary.log(value))
                ends.append(whole)
        most, least = ends[0] + SLACK / 10, SLACK / 10 - ends[1]
        self.gains = tuple((self._mean(x, turn), x.max(1)) for x in (most, least))

    def _cuts(self, window: int) -> list[Cut]:
        labels, cast = self.found.labels, self.found.cast
        count, landed = len(labels.map.charts), cast.landed
        broken = np.flatnonzero(cast.broken)
        if not broken.size:
            return []
        made, seen = [], np.zeros(labels.count, dtype=bool)
        ends = labels.left, labels.left + labels.columns * labels.wide
        for join in range(count):  # between this chart and the next
            after = (join + 1) % count
            at = (landed.chart == join) & (landed.theta.upper() >= ends[1][join] - 1e-6 * labels.wide[join])
            at |= (landed.chart == after) & (landed.theta.lower() <= ends[0][after] + 1e-6 * labels.wide[after])
            at = at & cast.broken[cast.label]
            if (which := np.unique(cast.label[at])).size:
                seen[which] = True
                made.append(Cut(self.found, which, window))
        if not np.all(seen[broken]):
            raise ValueError("a curve is broken at a point that is no join")
        return made

    @staticmethod
    def _mean(values: Array, turn: Array) -> Array:
        """The largest mean over a column of a function with bounds `values` on its parts; densities vary by `turn`."""
        steps, total = values[:, :-1] - values[:, 1:], values[:, -1].copy()
        for k in range(steps.shape[1]):
            share = (k + 1) / values.shape[1]
            step = steps[:, k]
            total += step * np.where(step > 0, np.minimum(share + turn / 4, 1), np.maximum(share - turn / 4, 0))
        return total

    def best(self, values: Array) -> Array:
        """For each label the largest of the `values` at the labels to which its edges lead."""
        found: Array = np.maximum.reduceat(values[self.edges[1]], self.starts)
        return found

    def shared(self, y: Array) -> Array:
        """For each label the largest mean of `y` over the images of the pieces that cross their whole column."""
        found = self.best(y)
        spread = self.found.spread
        if spread.last.size:
            there = np.maximum.reduceat(y[self.to], self.rows)
            step = np.append(there[:-1] - there[1:], 0.0)
            value = np.where(spread.last, there, step * np.where(step > 0, self.first[1], self.first[0]))
            total = np.bincount(spread.targets.source, value, minlength=self.count)
            found = np.where(self.found.cast.broken, found, total)
        return found

    def charged(self, v: Array) -> tuple[Array, Array]:
        """The terms `cuts` of the inequalities, per unit of mass and per end, from potentials `v` of ends on joins."""
        mass, end = np.zeros(self.count), np.zeros(self.count)
        for cut in self.cuts:
            top = float(v[cut.new].max())
            mass += cut.window * cut.mass * top
            end += cut.near * cut.size * top
        return mass, end

    def excess(self, gain: int, y: Array, high: float) -> Array:
        """For each label, how far the gain of pieces that do not cross their column exceeds `y + high`; at least 0."""
        found: Array = np.maximum(self.gains[gain][1] + self.best(y) - y - high, 0.0)
        return found

    def ends(self, s: Array, w: Array, v: Array) -> tuple[Array, Array]:
        """One iteration of the inequalities for `w` and `v`, given `s`."""
        on, (_, cut) = self.best(w) / self.least + TINY, self.charged(v)
        return (self.length * s + on + cut) * UP, (on + cut) * UP

    def step(self, gain: int, y: Array, v: Array) -> Array:
        """Left side of the inequality for masses at each label, for the potentials `y` of masses and `v` of ends."""
        return self.gains[gain][0] + self.shared(y) + self.charged(v)[0]

    def potential(self, gain: int) -> tuple[Array, float]:
        """Numbers `y` of a potential, and the approximate bound that the potential gives, by iteration in float64."""
        y, w, v, high = np.zeros(self.count), np.zeros(self.count), np.zeros(self.count), 0.0
        best = np.inf, y
        for _ in range(STEPS):
            s = self.excess(gain, y, high)
            for _ in range(2):
                w, v = self.ends(s, w, v)
            change = self.step(gain, y, v) - y
            most, least = float(change.max()), float(change.min())
            if not most < LARGEST:
                break
            high = (most + least) / 2
            best = min(best, (most, y), key=lambda pair: pair[0])
            if most - least < PRECISE:
                break
            y = y + 0.7 * (change - high)
        return best[1], best[0]

    def weights(self, gain: int, y: Array, high: float) -> tuple[Array, Array]:
        """The numbers `w` and `v` for a potential `y` of the masses; `holds` still has to check them."""
        s, w, v = self.excess(gain, y, high) + SLACK, np.zeros(self.count), np.zeros(self.count)
        for _ in range(WEIGHTS):
            more = self.ends(s, w, v)
            if (np.all(more[0] <= w) and np.all(more[1] <= v)) or not w.max() < LARGEST:
                break
            w, v = (np.maximum(old, new * (1 + 1e-7)) for old, new in zip((w, v), more, strict=True))
        return w, v

    def roundings(self, gain: int, y: Array, left: Array, high: float) -> float:
        """A bound for the rounding errors in the inequality of the masses, and in `excess`.

        A sum of `n` terms, each rounded a few times, errs by at most `(n + 8)*2^-53` times the sum of their moduli.
        Terms are differences of entries of `y` or of gains; costs of cuts are positive, so `left` bounds their sum with
        the other terms. The numbers `w` and `v` of the ends are sums of positive terms, for which the factor `UP`
        suffices.
        """
        spread, gains = self.found.spread, self.gains[gain]
        terms = int(np.bincount(spread.targets.source, minlength=1).max()) + self.found.labels.parts + len(self.cuts)
        size = sum(float(np.abs(x).max()) for x in (y, left, *gains)) + abs(high)
        return (terms + 8.0) ** 2 * size * 2.0**-50

    def holds(self, gain: int, y: Array, w: Array, v: Array, high: float) -> bool:
        """True if the numbers satisfy all inequalities with a margin for rounding, so that `high` is a proved bound."""
        least = self.ends(self.excess(gain, y, high) + SLACK, w, v)
        left = self.step(gain, y, v)
        sizes = [float(np.abs(x).max()) for x in (y, w, v, left)]
        bounded = bool(np.all(w > 0) and np.all(v > 0))  # the potential is bounded below, as `y` is
        small = bounded and all(size < LARGEST for size in sizes) and self.roundings(gain, y, left, high) < SLACK / 2
        masses = bool(np.all(left + SLACK <= y + high))
        return small and masses and bool(np.all(least[0] <= w)) and bool(np.all(least[1] <= v))

    def proved(self, gain: int) -> float | None:
        """A proved upper bound of the exponent (`gain` 0) or of its negative (`gain` 1); None if none is proved."""
        y, high = self.potential(gain)
        for _ in range(6):
            if not high < LARGEST:
                return None
            w, v = self.weights(gain, y, high)
            if self.holds(gain, y, w, v, high):
                return high
            high = max(high, float((self.step(gain, y, v) - y).max())) + 4 * SLACK
        return None


@dataclass(frozen=True)
class TypicalExponent(Theorem):
    """Bounds `low <= nu_plus <= high` for almost every orbit that enters a trapping region given by boxes."""

    map: CurveMap
    grid: Grid
    cells: Cells
    columns: int
    rows: int
    window: int = 8

    @cached_property
    def balance(self) -> Balance | str:
        """The coefficients of the inequalities; or the reason, in words, why the standard pairs are not proved."""
        try:
            return Balance(pairs(self.map, self.grid, self.cells, self.columns, self.rows), self.window)
        except ValueError as error:
            return str(error)

    @cached_property
    def ends(self) -> tuple[float | None, float | None]:
        """Upper bounds of the exponent and of its negative; None for a bound that is not proved."""
        return (None, None) if isinstance(self.balance, str) else (self.balance.proved(0), self.balance.proved(1))

    @hypothesis
    def standard_pairs(self) -> bool:
        """Images of pieces of curves are enclosed, and their densities vary little."""
        return not isinstance(self.balance, str)

    @hypothesis
    def potentials(self) -> bool:
        """Potentials bound the mean logarithm of the stretching from both sides."""
        return None not in self.ends

    @property
    def low(self) -> float:
        """The lower bound of `nu_plus`; minus infinity if none is proved."""
        return -np.inf if self.ends[1] is None else floor(-self.ends[1] * 1e6) / 1e6

    @property
    def high(self) -> float:
        """The upper bound of `nu_plus`; infinity if none is proved."""
        return np.inf if self.ends[0] is None else ceil(self.ends[0] * 1e6) / 1e6

    @property
    def labels(self) -> int:
        """The number of labels of the standard pairs."""
        return 0 if isinstance(self.balance, str) else self.balance.count

    @property
    def why(self) -> str:
        """The reason why the bounds are not proved, and what to change; empty if they are proved."""
        open_ends = "" if self.potentials else "ends of curves gather at joins; give more columns or rows"
        return self.balance if isinstance(self.balance, str) else open_ends
