"""The images of unstable curves: their stretching, slope, second derivative and density.

A curve is a graph `phi = g(theta)` on one component, with slope `m = g'`, bend `w = g''` and a density `rho` by `theta`
with `d = (log rho)'`. On the boundary `speed` is the length of the velocity, and `bend0` and `bend1` the rates at which
the tangent turns at start and landing; `l` is the length of the flight. With `p = bend0 - m` and `N = l*p -
cos(phi0)*speed0` the stretching (the landing's derivative along the curve) is `r = N/(speed1*cos(eta1))`. The length of
the flight has the derivative `l' = -sin(eta1)*speed1*r - sin(phi0)*speed0`. If `bend0` and `bend1` do not depend on the
boundary point, which is needed throughout this module (`ValueError` for other tables), `log r` has the derivative ::

    k = (l'*p - l*w + sin(phi0)*m*speed0 - cos(phi0)*speed0')/N - r*speed1'/speed1 + tan(eta1)*(bend1*r - p)

The image has the slope `-lam*(bend1 - p/r)`, the bend `-lam*p*k0/r^2 + lam*cos(phi0)*speed0*w/(r^2*N)`, where
`k = k0 + k1*w`, and `d` becomes `(d - k)/r`.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from verification.arithmetic.arrays import BallArray, Indices, Mask, common_part, hull, paired, spread, turned, unpaired
from verification.proofs.global_dynamics.flights import OPS, constant_bends, norm
from verification.proofs.global_dynamics.images import PinballImages
from verification.rigorous.boxes import Boxes, Chart


class Landed(NamedTuple):
    """Images of curves in boxes, one row for each box and each component on which it may land.

    `smooth` is True if the whole box lands there. `theta` and `phi` enclose landing and exit angle, `stretch` the
    stretching and `slope` the slopes of the images; `k0` and `k1` are the coefficients of `k`, and the image's bend is
    `bend + by_bend*w`.
    """

    source: Indices
    chart: Indices
    smooth: Mask
    theta: BallArray
    phi: BallArray
    stretch: BallArray
    slope: BallArray
    k0: BallArray
    k1: BallArray
    bend: BallArray
    by_bend: BallArray


class CurveMap(Protocol):
    """A map of adjacent charts, which breaks curves where they land on the ends of charts, the joins."""

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts."""

    @property
    def closed(self) -> bool:
        """True if there is one chart, which closes without a join."""

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        """The images of curves in boxes, for given ranges of slopes; radii are infinite where nothing is proved."""


@dataclass(frozen=True)
class PinballCurves:
    """Unstable curves of a scene with the paper's law, on components whose tangents turn at a constant rate."""

    map: PinballImages

    def __post_init__(self) -> None:
        if self.map.law is not None:
            raise ValueError(f"law = {self.map.scene.law}: unstable curves are followed under the law -lam*eta alone")
        if self.map.range[0] <= 0:
            raise ValueError("lam = 0: the map takes phase space to a curve, of area 0; accepted: 0 < lam")
        if None in constant_bends(self.map.map.table):
            raise ValueError(
                f"{self.map.scene.name}: a tangent turns at no constant rate; accepted: cardioids, the circle"
            )

    @property
    def closed(self) -> bool:
        return self.map.closed

    @property
    def charts(self) -> tuple[Chart, ...]:
        return self.map.charts

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        with np.errstate(all="ignore"):
            flights = self.map.flights(boxes)
            rows = []
            for piece in flights.pieces(*flights.arcs()):
                if not piece.on.size:
                    continue
                on, chart, low, high, smooth = piece
                arc = hull(low, high)
                _, theta, eta, phi = flights.landing(piece)
                phi = self.map.exit(eta, theta) if phi is None else common_part(phi, self.map.exit(eta, theta))
                found = flights.slopes(on, chart, arc)
                there, here = flights.over(on, chart, arc)[0], {name: x[on] for name, x in flights.whole.items()}
                (cos, sin), (cos0, sin0) = turned(eta), turned(flights.phis[on])
                cos = BallArray(cos.m, np.where(cos.positive(), cos.r, np.inf))
                fast, fast0, m = norm(OPS, there[2:4]), flights.speed[on], slopes[on]
                faster = (there[2] * there[4] + there[3] * there[5]) / (there[2] * there[2] + there[3] * there[3])
                faster0 = (here["dx"] * here["ddx"] + here["dy"] * here["ddy"]) / fast0
                p, length = found.bend_here - m, -(found.by_phi * (fast * cos))
                width, r = length * p - cos0 * fast0, found.by_theta + found.by_phi * m
                longer = -(sin * fast * r) - sin0 * fast0
                k0 = (longer * p + sin0 * m * fast0 - cos0 * faster0) / width - faster * r
                k0 = k0 + sin / cos * (found.bend_there * r - p)
                slope = -(found.law * (found.bend_there - p / r))
                bent = -(found.law * (p * k0 / (r * r))), found.law * (cos0 * fast0 / (r * r * width))
                values = theta, phi, r, slope, k0, -(length / width), *bent
                rows.append((on, chart, np.full(on.size, smooth), *unpaired(spread(x, low) for x in values)))
        source, charts, whole, *told = (np.concatenate(column) for column in zip(*rows, strict=True))
        return Landed(source, charts, whole, *paired(told))
