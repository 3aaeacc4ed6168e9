"""The attractor born at `lambda-star`: theorems for the piecewise linear limit, and float64 orbits of the map itself.

The half return leaves a corner, meets the arc, lands near the other corner, and is followed by the mirror reflection.
It is continuous and piecewise smooth, since the curvature of the boundary jumps at the corners. Its enclosed linear
parts at `lambda-star` make a piecewise linear map, the normal form of a border collision. For this map the kind of the
border collision, bounds of the attractor in units of `lam - lambda-star`, and bounds of the exponent are proved. Paper:
section 5.2.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from verification.arithmetic.balls import working
from verification.proofs.corner.border_collision import (
    AttractorBounds,
    FixedPointChange,
    Pieces,
    Polygon,
    Row,
    exponents,
    extent,
    fixed_point,
    grown,
    holds,
    hull,
    inward,
    kind,
    part,
    robust,
    strips,
    trapped,
)
from verification.proofs.corner.corner import (
    ARC,
    BITS,
    WALL,
    BoundaryPoint,
    angle,
    constant,
    corner_parameters,
    enclosed,
)
from verification.proofs.corner.half_return import START, limit, pieces

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Border:
    """Theorems on the piecewise linear map; lengths and angles are in units of `lam - lambda-star`.

    `angles` bounds the exit angle at the corner minus `phi-star`; `exponent` bounds the largest exponent per bounce of
    every orbit; a few exceptional orbits attain these bounds.
    """

    pieces: Pieces
    kind: FixedPointChange
    robust: bool | None
    extent: AttractorBounds
    angles: tuple[float, float]
    exponent: tuple[float, float]


@cache
def border() -> Border:
    """The theorems on the border collision of the corner orbit.

    >>> found = border()
    >>> found.kind.name, found.robust, [round(v, 3) for v in found.exponent]
    ('FOLD', True, [0.18, 0.383])
    """
    with working(BITS):
        linear = limit()
        bounds = extent(linear)
        if bounds is None:
            raise ArithmeticError("the attractor of the piecewise linear map is not enclosed")
        rates = exponents(linear, bounds.outer, length=9)
        if rates is None:
            raise ArithmeticError("the piecewise linear map is not proved to expand a cone")
        return Border(linear, kind(linear), robust(linear), bounds, _angles(bounds.outer), rates)


def _angles(region: Polygon) -> tuple[float, float]:
    """The range of `phi = -lam*eta`, to first order, over both sides of a region, rounded outwards."""
    theta1, star = enclosed()
    found = []
    for component in (ARC, WALL):
        here = BoundaryPoint(component, constant(corner_parameters()[component], ()))
        eta, by_v, by_u = angle(here, BoundaryPoint(ARC, constant(-theta1, ())))
        found += [-eta - star * (by_v * v + by_u * u) for u, v in part(region, component)]
    return min(float(x.lower()) for x in found), max(float(x.upper()) for x in found)


def strips_of_the_map(last: float = 1e-6) -> tuple[tuple[float, float], ...] | None:
    """Length and width of two convex sets whose union is proved to hold the attractor of the map itself; None if not
    proved.

    Both are in units of `lam - lambda-star` and hold for all `lam` up to `lambda-star + last`. The first set holds the
    images of the bounces on the arc.

    >>> [width < 1e-3 for _, width in strips_of_the_map()]
    [True, True]
    """
    with working(BITS):
        region = grown(limit(), START, 5e-4)
        if region is None:
            return None
        family = pieces(region, (0.0, last))
        return strips(family, region) if trapped(family, region) else None


REGION: Polygon = [(-1.0, -1.0), (1.0, -1.0), (7.0, 12.0), (4.0, 12.0)]  # around both orbits of period 4


def saddles(last: float = 3e-6) -> dict[int, Row] | None:
    """The two orbits of period 4 born at `lambda-star`, proved for all `lam` up to `lambda-star + last`.

    They are returned as fixed points `(u, v)` of the half return, one on the arc and one on the wall, in units of `lam
    - lambda-star`. With `e = lam - lambda-star` let `H` be the half return before the division by `e`, and `base`
    a point of `v = 0`. For every matrix `A` in the enclosure of the derivative of `H` on the region, `base + (1 - A)^-1
    (H(e*base)/e - base)` lies in a ball inside the region; so there is exactly one fixed point. From `lam = 0.07122` on
    both orbits are followed by `proofs.periodic.over_interval`.

    >>> {component: v.str(3, radius=False) for component, (_, v) in saddles().items()}
    {0: '-0.532', 1: '10.1'}
    """
    with working(BITS):
        family = pieces(REGION, (0.0, last))
        found = {component: fixed_point(piece) for component, piece in family.items()}
        for component, point in found.items():
            trace, determinant = family[component].trace, family[component].determinant
            unstable = abs(trace) > abs(1 + determinant)
            if not (holds(REGION, point) and inward(point[1], component) > 0 and unstable):
                return None
        return found


@dataclass(frozen=True)
class ScaledAttractor:
    """An attractor in units of `lam - lambda-star`: ranges of arc length beyond the corner, and of `phi - phi-star`.

    `widths` are the widths of the two strips of bounces that come from the arc and from the wall; `exponent` is the
    largest exponent per bounce.
    """

    lam: float
    lengths: tuple[float, float]
    angles: tuple[float, float]
    widths: tuple[float, float]
    exponent: float


def measured(distances: Sequence[float], bounces: int = 40_000) -> list[ScaledAttractor]:
    """The attractor of the map itself at `lambda-star + e` for each distance `e`, in float64.

    >>> (found,) = measured([1e-4], 20_000)
    >>> [round(v, 2) for v in found.lengths]
    [-1.69, 1.96]
    """
    theta1, star = (float(x.mid()) for x in enclosed())
    lams = [star + e for e in distances]
    map = PinballMap("cuspless", lam=lams)
    start = np.full(len(lams), 2 * math.pi / 3)
    phi = np.full(len(lams), _exit_angle(theta1))
    orbit = map.orbit(start, phi, bounces)
    rates = map.exponents(start, phi, bounces, bounces // 10).nu_plus
    half = map.arclength.perimeter / 2
    from_middle = np.abs(np.remainder(map.arclength.s(orbit.theta, orbit.component) + half, 2 * half) - half)
    fields = orbit.component, orbit.theta, orbit.phi, from_middle
    found = []
    for i, e in enumerate(distances):
        near = [np.asarray(x[bounces // 4 :, i], float) for x in fields]
        if np.any(orbit.code[:, i]):
            raise ValueError(f"border: the orbit at lambda-star + {e} reaches a point where the map is undefined")
        found.append(_attractor(lams[i], e, near, (theta1, _exit_angle(theta1)), float(rates[i])))
    return found


def _exit_angle(theta1: float) -> float:
    here = BoundaryPoint(ARC, constant(corner_parameters()[ARC], ()))
    return float(angle(here, BoundaryPoint(ARC, constant(enclosed()[0], ())))[0].mid())


def _attractor(lam: float, e: float, near: list[Array], orbit: tuple[float, float], rate: float) -> ScaledAttractor:
    """The attractor from an orbit's bounces near the corners, mirrored to the upper corner.

    `near` has components, `theta`, `phi` and the distances along the boundary from the middle of the wall; `orbit` is
    `theta1` and `phi-star`. The coordinate `u` of a bounce comes from the bounce before it.
    """
    component, theta, phi, from_middle = near
    on_wall = component == WALL
    at = np.where(on_wall, np.abs(theta) > 0.2, np.abs(theta) > 1.2)
    upper = np.where(on_wall, -np.sign(theta), np.sign(theta))
    v = (math.sqrt(3) / 4 - from_middle) / e
    chosen = np.flatnonzero(at[2:]) + 2
    u = (theta[chosen - 1] * upper[chosen] + orbit[0]) / e
    angles = (phi[chosen] * upper[chosen] - orbit[1]) / e
    v, came_from_wall = v[chosen], on_wall[chosen - 2]
    widths = [_width(np.column_stack([u, v])[came_from_wall == side]) for side in (False, True)]
    return ScaledAttractor(
        lam,
        (float(v.min()), float(v.max())),
        (float(angles.min()), float(angles.max())),
        (widths[0], widths[1]),
        rate,
    )


def _width(points: Array) -> float:
    """The width of a set of points across its longest diagonal."""
    corners = np.array(hull([(float(u), float(v)) for u, v in points]))
    gaps = corners[:, None] - corners[None]
    i, j = np.unravel_index(np.argmax(np.hypot(gaps[..., 0], gaps[..., 1])), gaps.shape[:2])
    along = corners[j] - corners[i]
    across = along[0] * (corners - corners[i])[:, 1] - along[1] * (corners - corners[i])[:, 0]
    return float(np.ptp(across) / np.hypot(*along))
