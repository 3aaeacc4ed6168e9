"""Basins of attraction: the label of every start, and starts where one wants them in phase space. Paper: appendix.

A plain function on arrays, so that a picture of any resolution is made piece by piece and in any order: the
label of a start does not depend on the others. All coordinates are the paper's, `s` and `sin(phi)`.

How closely basins are mixed: small squares of phase space, and the fates of a few starts in each.

Three numbers at each size `eps`: the share of squares with more than one fate; the basin entropy, the mean over
all squares of `-sum p log p` over the fates; and the boundary basin entropy, the mean over squares with more
than one fate (Daza and others 2016). A smooth boundary keeps the last one and lets the first fall like
`eps`; basins that are intermingled at every point would keep all three as `eps` goes to 0. The basin of an
attracting cycle is open, so for cycles the first one must vanish in the end: what can be measured is how fast.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.attractors import Classified, classify, image_of, moved, symmetries_of, wilson
from numeric.dynamics.phase_points import Array, PhasePoints, phase_points
from numeric.dynamics.recognition import UNSETTLED, Attractor, Labels, Share, at_clouds, at_cycles
from numeric.pinball.sampling import Grid, boundary

if TYPE_CHECKING:
    from symbolic.tables.geometry import Symmetry

TRANSIENT = 1000
APART = 1e-6  # of a cell, between the middle of one and the image of that of another
PIECE = 1 << 16  # particles at a time


class Window(NamedTuple):
    """A rectangle of phase space; the ends of `s` may lie beyond a turn of the boundary."""

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
    """The particles at these coordinates; beyond grazing, `|sin(phi)| > 1`, the angle is mirrored back.

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

    Quick: after `transient` bounces a particle within reach of a cycle is settled, and one on the cloud of a chaotic
    attractor too. With `sure`, as long as any particle is still leaving the cloud for a cycle, all go on.

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
        found[first : first + PIECE] = _settled(map, part, attractors, transient, sure)
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


def classify_cells(map: PinballMap, grid: Grid, transient: int = TRANSIENT) -> Classified:
    """The attractor that the particle in each cell of a `phase_grid` reaches, and the attractors.

    Of cells that are images of each other under the table's symmetries one is followed: at the image of a start is
    the image of its orbit, which ends on the image of its attractor.

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


def image_cells(map: PinballMap, grid: Grid, symmetry: "Symmetry") -> Labels | None:
    """The cell onto which a symmetry takes each; None where it takes the middles of cells elsewhere.

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
    """What squares of size `eps` hold; entropies in nats with standard errors, nan where no square is mixed."""

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
    """The mixing at each size, in squares placed at random.

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
