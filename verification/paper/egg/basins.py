"""Claims on basins of attraction, supported by sampling with its errors.

The basin of an attracting cycle is open, so no two such basins are intermingled at every point; what pictures
show is a fractal boundary, and its dimension is measured. Paper: sections 5.2, 6.7 and 7.
"""

from functools import cache

import numpy as np

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind
from numeric.dynamics.basins import Window, intermingling, labels, random_points, starts_at, whole
from numeric.dynamics.phase_points import Array
from numeric.dynamics.recognition import Labels
from numeric.dynamics.statistics import Uncertainty, uncertainty
from symbolic.cycles.cycle import egg_diameter, is_double_normal
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import judges
from verification.paper.shared.attractors import SHAPE, found, unsettled
from verification.paper.shared.samples import sampled

SEED = 1
PAIRS = 4000
MANY = 400
BEYOND = ("0.664", "0.67", "0.68", "0.69", "0.7")  # contractions above the crisis at 0.6621
EARLY = 400  # bounces before labels are read off


def scene(name: str, contraction: str) -> tuple[PinballMap, tuple[Attractor, ...]]:
    """The map and its attractors."""
    if name == "egg":
        return PinballMap("egg", lam=contraction, alpha=SHAPE), found("egg", contraction, alpha=SHAPE)
    return PinballMap(name, lam=contraction), found(name, contraction)


@cache
def boundary(name: str, contraction: str, distances: tuple[float, ...]) -> Uncertainty:
    """The uncertainty exponent over a range of distances."""
    map, attractors = scene(name, contraction)
    return uncertainty(map, attractors, PAIRS, SEED, distances=distances, transient=EARLY)


def told(law: Uncertainty) -> str:
    """The dimension with its error and the range it was fitted over."""
    return f"{law.dimension:.3f} +- {law.error:.3f} for eps from {law.largest:g} to {law.smallest:g}"


@cache
def fates(name: str, contraction: str, starts: int = 3000) -> tuple[Array, Labels]:
    """`sin(phi)` of random starts and the attractor each reaches."""
    map, attractors = scene(name, contraction)
    s, height = random_points(whole(map), starts, np.random.default_rng(SEED))
    return height, labels(map, starts_at(map, s, height), attractors, EARLY, sure=True)


@judges("map.smooth_basin_boundaries")
def smooth_boundaries(claim: Claim) -> Judgement:
    """Dimension 1 below the first loss of symmetry; above 1 at other contractions."""
    smooth, rough = (
        boundary("egg", "0.2", (0.02, 0.01, 0.005, 0.002)),
        boundary("cuspless", "0.09", (0.01, 0.003, 1e-3, 3e-4)),
    )
    said = (
        f"the boundaries between the three basins of the egg at alpha = {SHAPE}, lam = 0.2 have the dimension "
        f"{told(smooth)}, as smooth curves have; those of the cuspless cardioid at 0.09, {told(rough)}"
    )
    good = abs(smooth.dimension - 1) < 3 * smooth.error < 0.4
    return sampled("smooth curves in some cases, of dimension above 1 in others", said, good)


@judges("cuspless.basins_intermingled")
def cuspless_intermingled(claim: Claim) -> Judgement:
    """A boundary of dimension above 1: strips of both basins at every scale that was looked at."""
    law = boundary("cuspless", "0.09", (0.01, 0.003, 1e-3, 3e-4))
    said = (
        f"the boundary has the dimension {told(law)}: strips of both basins at every scale sampled. It has no area: "
        f"the share of pairs of starts with different fates falls like eps^{law.exponent:.2f}, and the basin of the "
        "period-2 orbit is open"
    )
    return sampled(
        "a fractal boundary, dimension about 1.24", said, 1 < law.dimension - 3 * law.error < law.dimension < 2
    )


@judges("cuspless.two_basins")
def two_basins(claim: Claim) -> Judgement:
    """No random start reaches anything else."""
    map, attractors = scene("cuspless", "0.09")
    _, label = fates("cuspless", "0.09")
    kinds = sorted((a.kind.name, a.period) for a in attractors)
    other = int(np.sum(label < 0)) + unsettled(attractors)
    share = np.mean(np.isin(label, [i for i, a in enumerate(attractors) if a.kind is Kind.CHAOTIC]))
    said = (
        f"{label.size} random starts: {share:.1%} reach the chaotic attractor, all others the period-2 orbit; a share "
        f"below {3 / label.size:.1%} of others is not excluded"
    )
    return sampled(
        "two attractors", said, other == 0 and kinds == [("CHAOTIC", 0), ("CYCLE", 2)] and map.law == "pinball"
    )


@judges("egg.after_crisis")
def after_crisis(claim: Claim) -> Judgement:
    """Random starts, from just above the crisis to the contraction of the paper's figure.

    "All" is meant of almost all: a ball on a diameter stays there, and the authors name these orbits themselves.
    """
    each = {x: found("egg", x, MANY, alpha=SHAPE) for x in BEYOND}
    threes = all(unsettled(some, MANY) == 0 and all(a.period == 3 for a in some) for some in each.values())
    stays = is_double_normal(egg_diameter())
    said = (
        f"at lam = {', '.join(BEYOND)} each of {MANY} random starts reaches one of the two period-3 orbits (a share "
        f"below {3 / MANY:.1%} of others is not excluded)"
    )
    return sampled(
        "almost all initial conditions, from the crisis to lam = 0.7 at least; not all, as the diameters are orbits of "
        "period 2 for every lam; further up there are other attractors: two of period 12 from 0.8162 to 0.8714, six "
        "more of period 3 from 0.9141 on",
        said,
        threes and stays,
    )


@judges("egg.basins_separate")
def separate(claim: Claim) -> Judgement:
    """One basin lies at positive angles, the other at negative ones, with a gap that the chaotic basin fills."""
    _, attractors = scene("egg", "0.66")
    height, label = fates("egg", "0.66")
    ways = {np.sign(a.points.phi[0]): i for i, a in enumerate(attractors) if a.kind is Kind.CYCLE}
    low, high = float(np.min(height[label == ways[1.0]])), float(np.max(height[label == ways[-1.0]]))
    law = boundary("egg", "0.66", (0.01, 0.005, 0.002, 1e-3))
    said = (
        f"of {label.size} random starts those that reach the orbit with phi > 0 have sin(phi) >= {low:.3f}, those that "
        f"reach the other sin(phi) <= {high:.3f}; the boundaries with the chaotic basin have the dimension {told(law)}"
    )
    return sampled(
        "one basin above, one below, the chaotic one between them", said, high < 0 < low and not np.any(label < 0)
    )


@judges("egg.basins_intermingled")
def egg_intermingled(claim: Claim) -> Judgement:
    """The uncertainty exponent over five decades, and small squares in the middle of the region."""
    law = boundary("egg", "0.7", (1e-3, 1e-5, 1e-7))
    map, attractors = scene("egg", "0.7")
    middle = Window((-0.3, 0.3), (-0.1, 0.1))
    wide, fine = intermingling(map, attractors, [1e-2, 1e-4], 100, SEED, middle, EARLY)
    said = (
        f"the boundary has the dimension {told(law)}, next to 2; around s = 0, phi = 0 {wide.mixed.count} of 100 "
        f"squares of side 0.01 and {fine.mixed.count} of side 0.0001 hold starts of both basins among 25. In the end "
        f"the share must vanish, since the basins are open: it falls like eps^{law.exponent:.3f}"
    )
    return sampled(
        "a fractal boundary of dimension about 1.968, not yet all of the region",
        said,
        law.dimension - 3 * law.error > 1.9 and wide.mixed.low > 0.8,
    )
