"""A bound for the share of random starts that are not proved to converge to a cycle, and a bound for all exponents.

A random start is a chord that meets the boundary at `theta`, with incidence angle `eta`. For uniform points and
directions in a table of area `A`, chords of length `l` have the density `l*cos(eta)/(2*pi*A)` in `ds*deta` (Santalo's
formula), at most `D/(2*pi*A)` times `cos(eta)`, with the diameter `D`. Elastic bounces preserve `cos(eta)*ds*deta`, so
the bound holds at the second landing too, when the first bounce is elastic (the paper's appendix). It also holds for
starts uniform in `s` and `sin(eta)`, of density `1/(2*L)` with the perimeter `L`: on a convex table `L <= pi*D` and
`4*pi*A <= L*L`, so `pi*A <= D*L`. So one number bounds the share of undecided starts for all three distributions: their
measure in `cos(eta)*ds*deta`, times `D/(2*pi*A)`.

The plane of `theta` and `eta` is cut into strips between two lines in the direction of stable curves, so that images of
strips stay thin. A strip is decided when all parallelograms that hold its images reach the cycle's tube or an entry
tube; undecided strips are cut in two. The table is symmetric in the axis through the cycle, so `eta >= 0` suffices.

For every orbit `nu_plus` (as an upper limit) is at most half the logarithm of the largest norm of the derivative of two
bounces. Starts whose orbits meet a join have measure 0, since the map's determinant is not 0 for `lam > 0`. The bounds
hold for every contraction of a range. Paper: section 5.3 and the appendix.
"""

from math import exp
from typing import NamedTuple

import numpy as np

from numeric import PinballMap
from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, hull, turned
from verification.proofs.global_dynamics.flights import Matrix, matrix, norm
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.chords import ChordFlights
from verification.proofs.starts.core import AbsorbingTube
from verification.proofs.starts.parallelograms import Parallelograms, push_forward
from verification.rigorous.boxes import Boxes
from verification.rigorous.norms import times

SLACK = 1 + 2.0**-40  # above 1 by more than the rounding of a sum
MIDDLE = 1e-14  # above the rounding of a midpoint
WIDE = 0.05  # the largest distance between corner orbits
WIDEST = 0.3  # the widest parallelogram that is followed
LOOK, BLOCK = 1 << 12, 1 << 15  # strips in one call: in float64, and in balls
FEW = 0.08  # when only this share of strips is undecided, they are cut and no longer followed
LEAN = 5  # bounces after which strips in the chosen direction are thinnest
STEEPEST = 0.3  # the largest slope d theta/d eta of lines
MORE = 2.0  # strips of this multiple of the needed measure are examined in balls, as some fail
CORNERS = (-1, -1, 1, 1), (-1, 1, -1, 1)  # across and along a strip: starts of float64 orbits
BENT = 1.0  # the largest ratio of rest to first side before a strip is cut across
EARLY = 1  # the bounce after which that ratio is tested
BOUNCES = 20
FIRST = 128, 4  # the first parts of a component over which the norm is bounded
QUARTER = 1.5707963267948968  # above pi/2


class Strips(NamedTuple):
    """Sets `left + left_lean*u <= theta <= right + right_lean*u` for `eta = middle + u`, `|u| <= half`."""

    chart: Indices
    left: Array
    right: Array
    left_lean: Array
    right_lean: Array
    middle: Array
    half: Array

    def some(self, chosen: Mask | Indices | slice) -> "Strips":
        """Some of the strips."""
        chart, *fields = self
        return Strips(chart[chosen], *(field[chosen] for field in fields))

    def cut(self, across: Mask) -> "Strips":
        """Each strip cut in two: along its length, or at its middle `eta` where `across` is True."""
        down, flat = self.some(~across), self.some(across)
        line, lean = (down.left + down.right) / 2, (down.left_lean + down.right_lean) / 2
        parts = [down._replace(right=line, right_lean=lean), down._replace(left=line, left_lean=lean)]
        for sign in (-0.5, 0.5):
            step = sign * flat.half
            left, right = flat.left + step * flat.left_lean, flat.right + step * flat.right_lean
            parts.append(flat._replace(left=left, right=right, middle=flat.middle + step, half=flat.half / 2))
        return joined(parts)

    def started(self, map: PinballImages) -> Parallelograms:
        """Parallelograms that hold the phase points after the first bounce of the starts, with `phi = -lam*eta`."""
        lean, lam = (self.left_lean + self.right_lean) / 2, map.lam
        middle, exit = (self.left + self.right) / 2, -(lam * BallArray(self.middle))
        wide, tall = (self.right - self.left) / 2 * (1 + 1e-12), self.half * (1 + 1e-12)
        sides, rest = np.zeros((2, 2, middle.size)), np.zeros((2, middle.size))
        sides[0, 0], sides[0, 1], sides[1, 1] = wide, lean * tall, -float(lam.m) * tall
        rest[0] = np.abs(self.right_lean - self.left_lean) / 2 * tall * SLACK + MIDDLE
        rest[1] = exit.r + (float(lam.r) + 1e-16) * tall * SLACK + 1e-15
        return Parallelograms(self.chart, np.stack([middle, exit.m]), sides, rest)

    def measures(self, map: PinballImages) -> Array:
        """Upper bounds for the integrals of `cos(eta)*ds*deta` over the strips."""
        sway = [np.abs(lean) * self.half for lean in (self.left_lean, self.right_lean)]
        whole = hull(self.left - sway[0], self.right + sway[1])  # the lines do not cross
        speed = speeds(map, self.chart, whole).upper()
        low = np.maximum(np.abs(self.middle) - self.half, 0.0)
        cosine = turned(BallArray(low))[0].upper()
        wide = self.right - self.left
        wide = np.where(np.abs(self.right_lean - self.left_lean) * self.half < wide, wide, np.inf)
        return np.asarray(wide * 2 * self.half * speed * cosine * SLACK)


def joined(parts: list[Strips]) -> Strips:
    """The strips of all arrays in a list, as one array."""
    chart, *fields = (np.concatenate(field) for field in zip(*parts, strict=True))
    return Strips(chart, *fields)


def strips(map: PinballImages, columns: tuple[int, ...], rows: int) -> Strips:
    """Strips that cover all `theta` and `0 <= eta <= pi/2`, in the direction of stable curves, estimated from float64
    orbits.

    `columns` must have one number for each component of the table; else `ValueError`.
    """
    if len(columns) != len(map.charts) or min(rows, *columns) < 1:
        raise ValueError(f"strips: columns = {columns}, rows = {rows}; accepted: 1 or more, for each component")
    if map.law is not None or not map.mirrored:
        wanted = "tables that are their own mirror images, under -lam*eta"
        raise ValueError(f"strips: {map.label} does not fit; accepted: {wanted}")
    pieces: list[Strips] = []
    edges = np.linspace(0.0, QUARTER, rows + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2 * (1 + 1e-9)
    for chart, count in enumerate(columns):
        low, high = map.charts[chart].x
        line = np.linspace(low, high, count + 1)
        for eta, tall, lean in zip(middle, half, _leaning(map.map, chart, line, middle), strict=True):
            lean[0] = lean[-1] = 0.0
            most = np.diff(line) / tall * 0.9
            for _ in range(2):  # lines do not cross
                for i in range(1, lean.size):
                    lean[i] = np.clip(lean[i], lean[i - 1] - most[i - 1], lean[i - 1] + most[i - 1])
                lean, most = lean[::-1], most[::-1]
                lean[0] = 0.0
            fields = line[:-1], line[1:], lean[:-1], lean[1:]
            pieces.append(Strips(np.full(count, chart), *fields, *(np.full(count, x) for x in (eta, tall))))
    return joined(pieces)


def _leaning(map: PinballMap, chart: int, theta: Array, eta: Array) -> Array:
    """The slopes `d theta/d eta` of curves that a few bounces contract, with rows for `eta` and columns for `theta`."""
    lam = float(np.max(map.lam))
    inside, on = np.clip(theta, theta[0] + 1e-6, theta[-1] - 1e-6), np.full(theta.size * eta.size, chart)
    at, phi = np.tile(inside, eta.size), -lam * np.repeat(eta, theta.size)
    dx, dy = (np.gradient(z, inside) for z in map.states.point(on[: theta.size], inside))
    product = np.tile(np.eye(2), (on.size, 1, 1))
    for _ in range(LEAN):
        product = map.derivative(at, phi, on) @ product
        step = map.step(at, phi, on)
        at, phi, on = step.theta, step.phi, step.component
    lean = (lam * product[:, 0, 1] / product[:, 0, 0]).reshape(eta.size, theta.size) / np.sqrt(dx * dx + dy * dy)
    return np.asarray(np.clip(np.nan_to_num(lean), -STEEPEST, STEEPEST))


def seems_to_enter_tube(map: PinballMap, core: AbsorbingTube, given: Strips) -> tuple[Mask, Mask]:
    """Masks of strips that seem to enter the tube, and of those to cut across, from float64 orbits of their corners."""
    lam, count, corners = float(np.max(map.lam)), given.left.size, len(CORNERS[0])
    across, along = (np.array(side)[:, None] for side in CORNERS)
    u = along * given.half
    left, right = given.left + given.left_lean * u, given.right + given.right_lean * u
    theta, phi = (left + right + across * (right - left)) / 2, -lam * (given.middle + u)
    low, high = (np.array([end[k] for end in map.states.ends])[given.chart] for k in (0, 1))
    start = np.clip(theta, low, high).ravel(), phi.ravel(), BOUNCES, np.tile(given.chart, corners)
    orbit = map.orbit(*start, fields=("component", "theta", "phi"))
    chart, at, exit = (orbit[name].reshape(BOUNCES + 1, corners, count) for name in ("component", "theta", "phi"))
    low, high = at.min(axis=1), at.max(axis=1)
    spread, far = high - low, np.maximum(high, -low)
    aside = np.abs(exit - (core.slope + core.cubic * at**2) * at)
    most = 2 * aside.max(axis=1) - aside.min(axis=1)
    fine = np.logical_and.accumulate((chart == chart[:, :1]).all(axis=1) & (spread < WIDE), axis=0)
    inside = np.zeros((BOUNCES + 1, count), dtype=bool)
    for outer, width in ((core.outer, core.width), *core.entry_tubes):
        inside |= (far + spread < outer) & (most < width)
    good = np.any(inside & fine & (chart[:, 0] == core.chart), axis=0)
    last = np.clip(np.sum(fine, axis=0), 1, BOUNCES), np.arange(count)
    a, b, c, d = (at[last[0], k, last[1]] for k in range(4))
    return good, np.asarray(np.maximum(np.abs(a - b), np.abs(c - d)) > np.maximum(np.abs(a - c), np.abs(b - d)))


def enter_tube(map: PinballImages, core: AbsorbingTube, given: Strips) -> tuple[Mask, Mask]:
    """Masks of the strips that are proved to reach the core, and of the undecided strips to cut across."""
    sets, owner = given.started(map), np.arange(given.left.size)
    failed, flat, entered = (np.zeros(owner.size, dtype=bool) for _ in range(3))
    for bounce in range(BOUNCES):
        home = core.enters(sets)
        entered[owner[home]] = True
        open_ = ~home & ~failed[owner]
        sets, owner = sets[open_], owner[open_]
        if owner.size <= FEW * entered.size:
            break
        source, images = push_forward(map, sets)
        with np.errstate(invalid="ignore"):
            lost = ~images.known | ~(images.reach() < WIDEST)
        sets, owner = images, owner[source]
        failed[owner[lost]] = True
        if bounce == EARLY:
            flat[owner] = np.abs(sets.sides[0, 1]) + sets.rest[0] > BENT * np.abs(sets.sides[0, 0])
    failed[owner] = True
    return entered & ~failed, flat


class Remainder(NamedTuple):
    """Undecided starts: a bound for their measure in `cos(eta)*ds*deta`; and the number of strips examined in balls."""

    measure: float
    strips: int


def remainder(map: PinballImages, core: AbsorbingTube, first: Strips, enough: float, rounds: int = 24) -> Remainder:
    """Cuts strips until the undecided starts, `eta < 0` included, measure at most `enough`, or `rounds` times.

    A strip that is undecided, or not yet examined after the last round, counts with its whole measure.
    """
    cells, asked, left = first, 0, np.inf
    for _ in range(rounds):
        sizes, open_ = 2 * SLACK * cells.measures(map), np.ones(cells.left.size, dtype=bool)
        looks = [seems_to_enter_tube(map.map, core, cells.some(slice(k, k + LOOK))) for k in range(0, sizes.size, LOOK)]
        good, across = (np.concatenate(answers) for answers in zip(*looks, strict=True))
        hopes = np.flatnonzero(good)
        hopes = hopes[np.argsort(-sizes[hopes], kind="stable")]
        hopes = hopes[np.cumsum(sizes[hopes]) - sizes[hopes] <= MORE * (np.sum(sizes) - enough)]
        for k in range(0, hopes.size, BLOCK):
            chosen = hopes[k : k + BLOCK]
            done, across[chosen] = enter_tube(map, core, cells.some(chosen))
            open_[chosen[done]] = False
            asked += chosen.size
            left = float(np.sum(sizes[open_])) * SLACK
            if left <= enough:
                return Remainder(left, asked)
        cells = cells.some(open_).cut(across[open_])
    return Remainder(left, asked)


def steepest(map: PinballImages, boxes: Boxes, bounces: int, weight: float) -> Array:
    """For each box a bound of the norm of the derivative of `bounces` bounces, in `max(abs(ds), abs(dphi)/weight)`.

    The bound is infinite if it is not proved; where landings lie on both sides of a join, it holds for both
    derivatives.
    """
    found = np.zeros(boxes.chart.size)
    one, nought = BallArray(np.ones(found.size)), BallArray(np.zeros(found.size))
    first = np.asarray(speeds(map, boxes.chart, hull(*boxes.x)).lower())
    _steepest(map, boxes, np.arange(found.size), [[one, nought], [nought, one]], bounces, found, (first, weight))
    return found


def speeds(map: PinballImages, chart: Indices, theta: BallArray) -> BallArray:
    """The speed of the boundary parameter: the derivative of arc length with respect to it."""
    return norm(map.ops, map.place(chart, theta)[2:4])


def _steepest(
    map: PinballImages,
    boxes: Boxes,
    owner: Indices,
    product: Matrix,
    bounces: int,
    found: Array,
    norm: tuple[Array, float],
) -> None:
    """Adds to `found` the bounds for orbits that have reached `boxes`; `product` is the derivative up to there."""
    if not owner.size:
        return
    with np.errstate(all="ignore"):
        if not bounces:
            last, (first, weight) = np.asarray(speeds(map, boxes.chart, hull(*boxes.x)).upper()), norm
            size = [[entry.magnitude() for entry in row] for row in product]
            along = last * (size[0][0] / first[owner] + weight * size[0][1])
            turn = size[1][0] / first[owner] / weight + size[1][1]
            most = np.maximum(along, turn) * SLACK
            np.maximum.at(found, owner, np.where(np.isfinite(most), most, np.inf))
            return
        seen = np.zeros(owner.size, dtype=bool)
        whole = ChordFlights(map, boxes)
        for piece in whole.split(*whole.arcs()):
            on = piece.on
            seen[on] = True
            arc = hull(piece.low, piece.high)
            known, low, high = whole.exits(on, piece.chart, arc)
            known &= np.isfinite(arc.r)
            found[owner[on[~known]]] = np.inf
            go = np.flatnonzero(known & (low <= high))
            image = Boxes(piece.chart[go], (arc.lower()[go], arc.upper()[go]), (low[go], high[go]))
            before = [[entry[on] for entry in row] for row in product]
            after = times(matrix(whole.slopes(on, piece.chart, arc)), before)
            _steepest(map, image, owner[on[go]], [[x[go] for x in row] for row in after], bounces - 1, found, norm)
        found[owner[~seen]] = np.inf


def bounded(map: PinballImages, rate: float, bounces: int, weight: float, halvings: int = 8) -> bool:
    """True if `nu_plus <= rate` is proved for every orbit, by the norm of the derivative of `bounces` bounces.

    Boxes are halved up to `halvings` times; if table and law are symmetric, only boxes with `phi >= 0` are examined.
    """
    goal, half = exp(rate * bounces) / SLACK, map.mirrored
    for chart, ends in enumerate(map.charts):
        boxes = Boxes.one(ends.x, (0.0, map.top) if half else ends.y, chart=chart).parts(*FIRST)[0]
        for _ in range(halvings):
            open_ = ~(steepest(map, boxes, bounces, weight) <= goal)
            if not np.any(open_):
                break
            (left, right), (below, above) = boxes.x, boxes.y
            kept = (left[open_], right[open_]), (below[open_], above[open_])
            boxes = Boxes(boxes.chart[open_], *kept).parts(2, 2)[0]
        else:
            return False
    return True
