"""Flights from parallelograms: landings of midpoints, and landings on a component continued beyond its end.

The landing of the float64 kernel is the centre at which landing and derivative are enclosed.
"""

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, hull
from verification.proofs.global_dynamics.flights import End, Flights, LandingArcs, incidence, turn_between

NEARLY = 1 - 2.0**-40  # below 1 by more than the rounding of a comparison
DOUBLINGS = 4  # how often the continuation of an arc is doubled
REACH = 3.0  # the approximate length of a flight


class ChordFlights(Flights):
    """The flights from a block of boxes, with the landings of midpoints."""

    kept: tuple[BallArray, BallArray, list[BallArray]] | None = None  # an arc with its centre and the boundary there

    def split(self, low: End, high: End) -> list[LandingArcs]:
        """The arcs that lie on one component, followed by all parts of the other arcs; empty entries are omitted."""
        smooth, *parts = self.pieces(low, high)
        if parts:
            on, chart, first, last = (np.concatenate(column) for column in list(zip(*parts, strict=True))[:4])
            parts = [LandingArcs(on, chart, first, last, False)]
        return [piece for piece in (smooth, *parts) if piece.on.size]

    def near(self, on: Indices, chart: Indices, arc: BallArray) -> tuple[BallArray, list[BallArray]]:
        """For each arc, a double near the landing of the box's midpoint, as centre, and the boundary point there."""
        if self.kept is None or self.kept[0] is not arc:
            self.kept = arc, *self._near(on, chart, arc)
        return self.kept[1:]

    def _near(self, on: Indices, chart: Indices, arc: BallArray) -> tuple[BallArray, list[BallArray]]:
        m, r, (where, landed, place) = np.asarray(arc.m), arc.r * NEARLY, self.landed
        at = np.where(where[on] == chart, landed[on], np.nan)
        far = np.flatnonzero(~(np.abs(at - m) <= r))
        if not far.size:
            return BallArray(at), [value[on] for value in place]
        at[far] = self._polished(on[far], chart[far], m[far])
        at = np.where(np.abs(at - m) <= r, at, m)
        return BallArray(at), self.map.place(chart, BallArray(at))

    def _polished(self, on: Indices, chart: Indices, near: Array) -> Array:
        """The landings of the midpoints of boxes in float64, by Newton's method from the nearby parameters `near`."""
        at, (x0, y0, v, w) = near, (self.centre[name].m[on] for name in ("x", "y", "v", "w"))
        for _ in range(2):  # Newton steps
            x, y, dx, dy, *_ = (value.m for value in self.map.place(chart, BallArray(at)))
            at = at - (v * (y - y0) - w * (x - x0)) / (v * dy - w * dx)
        return np.asarray(at)

    def exits(self, on: Indices, chart: Indices, arc: BallArray) -> tuple[Mask, Array, Array]:
        """A mask of boxes whose exit angles are enclosed, and bounds of these, cut off at the border of the strip."""
        exit, top = self.map.exit(self.over(on, chart, arc)[1], arc), self.map.top
        return np.isfinite(exit.r), np.maximum(exit.lower(), -top), np.minimum(exit.upper(), top)

    def midpoints(self, on: Indices, chart: Indices, arc: BallArray, bend: BallArray) -> tuple[BallArray, BallArray]:
        """Landing and exit angle of the midpoints of boxes, by an interval Newton step within the arc.

        `bend` is the rate at which the tangent turns over the arc.
        """
        (at, place), (there, _) = self.near(on, chart, arc), self.over(on, chart, arc)
        x, y, v, w = (self.centre[name][on] for name in ("x", "y", "v", "w"))
        step = (w * (place[0] - x) - v * (place[1] - y)) / (v * there[3] - w * there[2])
        turn = turn_between(self.tangent(on, self.centre), place[2:4])
        eta, landing = incidence(self.phi[on] + turn + bend * step), at + step
        return landing, self.map.exit(eta, landing)

    def beyond(self, on: Indices, chart: Indices, low: Array, high: Array) -> tuple[BallArray, Mask]:
        """Arcs continued past the end of a component, by the same formulas; and a mask of those that are enclosed.

        The arcs are so long that every flight of the box crosses the continued component exactly once within its arc,
        since all flights cross the arc from the same side. If a landing lies on the component, it is this crossing,
        which is a smooth function on the whole box.
        """
        first, last = self.map.outer[:, chart]
        up, down = high >= last, low <= first
        step = (self.reach[0].r + REACH * self.reach[1].r)[on]
        found, known = [low.copy(), high.copy()], ~(up & down) & (low < high)
        for side, moving, sign in ((0, down, -1.0), (1, up, 1.0)):
            open_ = np.flatnonzero(moving & known)
            for attempt in range(DOUBLINGS):
                at = found[side][open_] + sign * step[open_] * 2.0**attempt
                value = self.sides((chart[open_], at), on[open_])
                good = value.positive() if sign > 0 else value.negative()
                found[side][open_[good]] = at[good]
                if not (open_ := open_[~good]).size:
                    break
            known[open_] = False
        return hull(*found), known
