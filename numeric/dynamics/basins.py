"""Basins of attraction: the label of every start, from a grid or at chosen points of phase space. Paper: appendix.

`labels` is a plain function on arrays, and the label of a start does not depend on the other starts. So a picture of
any resolution can be computed in pieces and in any order. All coordinates are the paper's, `s` and `sin(phi)`.

How closely basins are mixed is measured in small squares of phase space, from the fates (attractors reached) of a few
starts in each. There are three numbers at each size `eps`: the share of squares with more than one fate; the basin
entropy, the mean over all squares of `-sum p log p` over the fates; and the boundary basin entropy, the mean over
squares with more than one fate (Daza and others 2016). For a smooth boundary the last number stays constant, and the
first falls like `eps`; for basins that are intermingled at every point all three would stay constant as `eps` goes to
0. The basin of an attracting cycle is open, so for cycles the first number tends to 0: the measurement shows how fast.

The dimension of a basin boundary is measured by the uncertainty exponent. Two starts at a distance `eps` have different
fates with probability `f(eps) ~ eps**a`, and the boundary has dimension `2 - a` [McDonaldGrebogiOttYorke1985]. The same
starts are used at all distances, so their counts are not independent, and the error comes from resampling the starts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.attractors import Classified, classify, image_of, wilson
from numeric.dynamics.phase_points import Array, Labels, PhasePoints, advanced, phase_points
from numeric.dynamics.recognition import UNSETTLED, Attractor, Kind, Share, at_clouds, at_cycles
from numeric.dynamics.symmetries import moved, symmetries_of
from numeric.pinball.sampling import PhaseGrid, boundary

if TYPE_CHECKING:
    from numeric.lowering.program import TableSymmetry

TRANSIENT = 1000
EARLY = 64  # bounces after which particles near a cycle are looked for first
APART = 1e-6  # of a cell: largest distance of a cell's image from a cell
PIECE = 1 << 16  # particles at a time


class Window(NamedTuple):
    """A rectangle of phase space; its range of `s` may extend beyond one turn of the boundary."""

    s: tuple[float, float]
    sin_phi: tuple[float, float]


def whole(map: PinballMap) -> Window:
    """All of phase space.

    >>> whole(PinballMap("cardioid"))
    Window(s=(-4.0, 4.0), sin_phi=(-1.0, 1.0))
    """
    half = map.arclength.perimeter / 2
    return Window((-half, half), (-1.0, 1.0))


def starts_at(map: PinballMap, s: ArrayLike, sin_phi: ArrayLike) -> PhasePoints:
    """The particles at these coordinates; for `|sin(phi)| > 1`, which is beyond grazing, the angle is reflected back.

    >>> particle = starts_at(PinballMap("cardioid"), [2.0], [0.5])
    >>> [round(float(x[0]), 6) for x in (particle.theta, particle.phi)]
    [1.047198, 0.523599]
    """
    along, height = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(sin_phi, dtype=float))
    height = np.where(np.abs(height) > 1, np.sign(height) * 2 - height, height) * (1 - 1e-12)
    component, theta = boundary(map, along.ravel())
    return phase_points(theta, elementary.arcsin(height.ravel()), component)


def labels(
    map: PinballMap,
    particles: PhasePoints,
    attractors: Sequence[Attractor],
    transient: int = TRANSIENT,
    sure: bool = False,
) -> Labels:
    """The index of the attractor that each particle reaches, of those known; -1 where it reaches none of them.

    A particle gets the label of a cycle as soon as it is within the cycle's `reach`. A particle that is near the points
    of a chaotic attractor after `transient` bounces gets that label. With `sure`, such particles are advanced further
    as long as any of them still goes to a cycle.

    >>> from numeric.dynamics.attractors import find
    >>> map = PinballMap("cuspless", lam="0.09")
    >>> found = find(map, 100, seed=1)
    >>> label = labels(map, phase_points([0.0, 0.2], [0.0, -0.03], [1, 0]), found)
    >>> [found[i].kind.name for i in label]
    ['CYCLE', 'CHAOTIC']
    """
    found = np.full(particles.size, UNSETTLED)
    for first in range(0, particles.size, PIECE):
        part = particles.only(slice(first, first + PIECE))
        label = found[first : first + PIECE]
        if transient > EARLY and all(a.kind is not Kind.NEUTRAL for a in attractors):
            there, code = advanced(map, part, EARLY)
            label[code == 0] = at_cycles(map, there.only(code == 0), attractors)
        if (going := np.nonzero(label == UNSETTLED)[0]).size:
            label[going] = _settled(map, part.only(going), attractors, transient, sure)
    return found


def _settled(
    map: PinballMap, particles: PhasePoints, attractors: Sequence[Attractor], transient: int, sure: bool
) -> Labels:
    end = map.exponents(particles.theta, particles.phi, transient, 0, particles.component)
    there = PhasePoints(end.component, end.theta, end.phi)
    found = at_cycles(map, there, attractors)
    going = np.nonzero((found == UNSETTLED) & (end.code == 0))[0]
    if not sure:
        spread = going[end.nu_plus[going] > 0]
        found[spread] = at_clouds(map, there.only(spread), attractors)
        going = np.nonzero((found == UNSETTLED) & (end.code == 0))[0]
    if going.size:
        here = there.only(going)
        late = classify(map, here.theta, here.phi, here.component, transient=transient, known=attractors).label
        found[going] = np.where(late < len(attractors), late, UNSETTLED)
    return found


def classify_cells(map: PinballMap, grid: PhaseGrid, transient: int = TRANSIENT) -> Classified:
    """The attractor that the particle in each cell of a `phase_grid` reaches, and the attractors.

    Of cells that are images of each other under the table's symmetries only one is followed; the others get the images
    of its attractor.

    >>> from numeric.pinball.sampling import phase_grid
    >>> map = PinballMap("egg", alpha="0.08", lam="0.7")
    >>> label, attractors = classify_cells(map, phase_grid(map, 6, 4), 2000)
    >>> [a.period for a in attractors], label[:6].tolist()
    ([3, 3], [1, 1, 1, 1, 1, 1])
    """
    images = [(g, cells) for g in symmetries_of(map) if (cells := image_cells(map, grid, g)) is not None]
    first = np.unique(np.max([cells for _, cells in images], axis=0))
    theta, phi, component = grid.starts.theta[first], grid.starts.phi[first], grid.starts.component[first]
    followed, attractors = classify(map, theta, phi, component, transient)
    found = list(attractors)
    onto = np.array([[image_of(map, found, attractor, g) for attractor in attractors] for g, _ in images], dtype=int)
    order = list(dict.fromkeys(int(i) for i in onto.T.ravel()))  # an attractor, then its images, then the next
    place = np.append(np.argsort(order), UNSETTLED)
    label = np.full(grid.starts.theta.size, UNSETTLED)
    for row, (_, cells) in zip(reversed(onto), reversed(images), strict=True):  # the identity last
        label[cells[first]] = place[np.append(row, UNSETTLED)[followed]]
    return Classified(label, tuple(found[i] for i in order))


def image_cells(map: PinballMap, grid: PhaseGrid, symmetry: "TableSymmetry") -> Labels | None:
    """The index of the cell to which a symmetry takes each cell; None if it does not map centres of cells to centres.

    >>> from numeric.pinball.sampling import phase_grid
    >>> map = PinballMap("cuspless")
    >>> [image_cells(map, phase_grid(map, 2, 2), g).tolist() for g in symmetries_of(map)]
    [[0, 1, 2, 3], [3, 2, 1, 0]]
    """
    columns, rows = grid.s.size, grid.sin_phi.size
    middles = phase_points(grid.starts.theta[:columns], 0.0, grid.starts.component[:columns])
    image = moved(symmetry, middles)
    place = map.arclength.s(image.theta, image.component) / (map.arclength.perimeter / columns) + (columns - 1) / 2
    column = np.rint(place).astype(np.int64)
    if np.max(np.abs(place - column)) > APART:
        return None
    row = np.arange(rows)[:: symmetry.sign]
    return np.asarray((row[:, None] * columns + column % columns).ravel(), dtype=np.int64)


def random_points(window: Window, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Points of a window, uniform in `s` and `sin(phi)`."""
    return rng.uniform(*window.s, count), rng.uniform(*window.sin_phi, count)


def grid(window: Window, columns: int, rows: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The centres of the cells of a window, row after row.

    >>> [x.tolist() for x in grid(Window((0.0, 1.0), (0.0, 1.0)), 2, 1)]
    [[0.25, 0.75], [0.5, 0.5]]
    """
    s = window.s[0] + (np.arange(columns) + 0.5) * (window.s[1] - window.s[0]) / columns
    height = window.sin_phi[0] + (np.arange(rows) + 0.5) * (window.sin_phi[1] - window.sin_phi[0]) / rows
    return np.tile(s, rows), np.repeat(height, columns)


EACH = 25  # starts in a square


class Mixing(NamedTuple):
    """How basins mix in squares of size `eps`: entropies in nats with standard errors; nan where no square is mixed."""

    eps: float
    mixed: Share
    entropy: float
    entropy_error: float
    boundary_entropy: float
    boundary_entropy_error: float


def intermingling(
    map: PinballMap,
    attractors: Sequence[Attractor],
    sizes: Sequence[float],
    squares: int,
    seed: int,
    window: Window | None = None,
    transient: int = TRANSIENT,
) -> list[Mixing]:
    """How the basins mix at each size of squares: a `Mixing` for each, from squares placed at random.

    >>> from numeric.dynamics.attractors import find
    >>> map = PinballMap("ellipse", a=2, lam="0.5")  # one attractor only
    >>> intermingling(map, find(map, 50, 1), [0.1], 50, 1)[0].mixed.count
    0
    """
    rng = np.random.default_rng(seed)
    where = whole(map) if window is None else window
    s, height = (x[:, None] for x in random_points(where, squares, rng))
    found = []
    for eps in sizes:
        aside, above = rng.uniform(-eps / 2, eps / 2, (2, squares, EACH))
        label = labels(map, starts_at(map, s + aside, height + above), attractors, transient, sure=True)
        found.append(_of(eps, entropies(label.reshape(squares, EACH), len(attractors))))
    return found


def entropies(label: Labels, count: int) -> Array:
    """The entropy of the labels in each row, in nats.

    >>> entropies(np.array([[0, 0, 1, 1], [0, 0, 0, 0]]), 2).round(6).tolist()
    [0.693147, 0.0]
    """
    shares = np.stack([np.mean(label == i, axis=1) for i in range(-1, count)])
    return np.asarray(np.sum(-shares * elementary.log(np.where(shares > 0, shares, 1)), axis=0)) + 0.0


def _of(eps: float, entropy: Array) -> Mixing:
    mixed = entropy[entropy > 0]
    error = float(np.std(entropy) / np.sqrt(entropy.size))
    if mixed.size == 0:
        return Mixing(eps, wilson(0, entropy.size), 0.0, error, float("nan"), float("nan"))
    inner = float(np.std(mixed) / np.sqrt(mixed.size))
    return Mixing(eps, wilson(mixed.size, entropy.size), float(np.mean(entropy)), error, float(np.mean(mixed)), inner)


DISTANCES = tuple(10.0 ** (-k / 2) for k in range(4, 17))  # 1e-2 to 1e-8 in s and sin(phi)
FEWEST_STARTS = 10  # differing pairs at each of two distances, without which there is no fit
RESAMPLED = 400
NEWTON = 12  # steps, which double the digits


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """The numbers of pairs with different fates at each distance, and the power law fitted from `smallest` to
    `largest`.

    `curvature` is the change of the local exponent per decade, with its error; for a power law it is 0.
    """

    distances: Array
    different: NDArray[np.int64]
    pairs: int
    exponent: float
    error: float
    curvature: tuple[float, float]
    largest: float
    smallest: float

    @property
    def dimension(self) -> float:
        """Dimension of the boundary between basins."""
        return 2 - self.exponent


def uncertainty(
    map: PinballMap,
    attractors: Sequence[Attractor],
    count: int,
    seed: int,
    window: Window | None = None,
    distances: Sequence[float] = DISTANCES,
    transient: int = TRANSIENT,
    sure: bool = True,
) -> Uncertainty:
    """The uncertainty exponent of the boundary between all basins in a window.

    A smooth boundary has the exponent 1:

    >>> from numeric.dynamics.attractors import find
    >>> map = PinballMap("egg", alpha="0.08", lam="0.2")
    >>> found = uncertainty(map, find(map, 100, 1), 4000, 1, distances=(0.03, 0.01, 0.003))
    >>> abs(found.exponent - 1) < 3 * found.error < 0.4
    True
    """
    rng = np.random.default_rng(seed)
    where = whole(map) if window is None else window
    s, height = random_points(where, count, rng)
    turn = rng.uniform(0, 2 * np.pi, count)
    centre = labels(map, starts_at(map, s, height), attractors, transient, sure)
    rows = []
    for eps in distances:
        near = starts_at(map, s + eps * np.cos(turn), height + eps * np.sin(turn))
        label = labels(map, near, attractors, transient, sure)
        rows.append((label != centre) & (label != UNSETTLED) & (centre != UNSETTLED))
    return fitted(np.array(distances), np.array(rows), rng)


def fitted(distances: Array, different: NDArray[np.bool_], rng: np.random.Generator) -> Uncertainty:
    """The power law fitted to the shares of pairs with different fates; rows of `different` are distances, columns
    starts.

    >>> rng = np.random.default_rng(0)
    >>> eps = np.array([0.1, 0.01, 0.001])
    >>> found = fitted(eps, rng.uniform(size=20_000) < eps[:, None] ** 0.5, rng)
    >>> abs(found.exponent - 0.5) < 3 * found.error < 0.1
    True
    """
    counts, size = different.sum(axis=1), different.shape[1]
    used = counts >= FEWEST_STARTS
    if np.sum(used) < 2:
        nothing = float("nan")
        return Uncertainty(distances, counts, size, nothing, nothing, (nothing, nothing), nothing, nothing)
    draws = np.array([different[:, rng.integers(0, size, size)].sum(axis=1) for _ in range(RESAMPLED)])
    (slope, bend), *drawn = power_laws(elementary.log(distances), np.vstack([counts, draws]), size)
    errors, ends = np.nanstd(np.array(drawn), axis=0), distances[used]
    return Uncertainty(
        distances, counts, size, slope, float(errors[0]), (bend, float(errors[1])), float(max(ends)), float(min(ends))
    )


def power_laws(x: Array, counts: NDArray[np.int64], of: int) -> list[tuple[float, float]]:
    """For each row of counts, the slope of `log f` against `x = log eps` with `f = counts/of`, and its change per
    decade.

    The fit is the most likely power law for binomial counts, by Newton's method, which gives small counts their proper
    weight. A fit of logarithms that omits small counts makes the slope too small by a third of its error.
    """
    slopes = _most_likely(x, counts, of, 1)[:, 0]
    decade, curved = 2 * elementary.log(10), x.size > 2
    bends = decade * _most_likely(x, counts, of, 2)[:, 0] if curved else np.full(len(counts), np.nan)
    return [(float(slope), float(bend)) for slope, bend in zip(slopes, bends, strict=True)]


def _most_likely(x: Array, counts: NDArray[np.int64], of: int, degree: int) -> Array:
    """Coefficients, highest first, of the polynomial `log(counts/of)` in `x`, by reweighted least squares."""
    powers = np.vander(x - np.mean(x), degree + 1)  # the highest coefficient is the same about any point
    share = np.maximum(counts, 0.5) / of
    for _ in range(NEWTON):
        weight = of * share / (1 - share)
        wanted = weight * (elementary.log(share) + (counts / of - share) / share)
        normal = np.einsum("ri,ij,ik->rjk", weight, powers, powers)
        right = np.einsum("ri,ij->rj", wanted, powers)
        found: Array = np.einsum("rjk,rk->rj", np.linalg.pinv(normal, hermitian=True), right)
        share = np.clip(elementary.exp(found @ powers.T), 1e-300, 1 - 1 / (2 * of))
    return found
