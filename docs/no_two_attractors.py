"""Draws docs/figures/no_two_attractors.png: the trapping region of the cuspless table at 3/25, and an attractor in it.

`python docs/no_two_attractors.py`. Grey are the cells that the map takes into themselves, blue is a sampled orbit,
orange the rectangle about a saddle that images of every unstable curve come to cross, and black its cycle of period 4.
"""

from fractions import Fraction
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from numeric import PinballMap
from symbolic import Scene
from verification.plots.sheet import AXES, BLACK, DARK, MIDDLE, figure, styled
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors
from verification.rigorous.boxes import Boxes

PICTURE = Path(__file__).with_name("figures") / "no_two_attractors.png"
LAM, GRID, HALF = Fraction(3, 25), (1024, 8192), 0.006
SADDLE = 2.04718624, -0.0430328
ORBITS, BOUNCES, TRANSIENT = 40, 2500, 500


def proof() -> NoTwoAttractors:
    """What docs/global.md proves."""
    theta, phi = (np.array([x, -x]) for x in SADDLE)
    start = Boxes(np.array([0, 0]), (theta, theta), (phi, phi))
    return NoTwoAttractors(PinballImages(Scene("cuspless"), (LAM,) * 2), *GRID, start, (0, *SADDLE), 4, HALF)


def drawn() -> Figure:
    """The half of the region above the axis, and the rectangle from near."""
    found, map = proof(), PinballMap("cuspless", lam=float(LAM))
    region, at = found.region, found.anchor
    if isinstance(region, str) or at is None:
        raise SystemExit(f"nothing to draw: {found.reason}")
    boxes = region.grid.boxes(region.cells)
    theta = SADDLE[0] + np.linspace(-1, 1, ORBITS) * HALF / 2
    orbit = map.orbit(theta, np.full(ORBITS, SADDLE[1]), BOUNCES, 0)
    cycle = map.orbit(*SADDLE, 3, 0)
    made = figure(7.0, 5.2)
    panels = made.subplots(2, 2).flat

    def shown(axes: Axes, part: int, low: float, high: float, size: float) -> None:
        inside = (boxes.chart == part) & (boxes.x[1] >= low) & (boxes.x[0] <= high)
        for edge in np.unique(boxes.x[0][inside]):
            here = inside & (boxes.x[0] == edge)
            width, foot, head = boxes.x[1][here][0] - edge, boxes.y[0][here], boxes.y[1][here]
            gap = np.flatnonzero(foot[1:] > head[:-1] + 1e-12)
            starts, ends = foot[np.r_[0, gap + 1]], head[np.r_[gap, -1]]
            for a, b in zip(starts, ends, strict=True):
                axes.add_patch(Rectangle((edge, a), width, b - a, color="0.85", lw=0))
        o = orbit.component[TRANSIENT:] == part
        x, y = orbit.theta[TRANSIENT:][o], orbit.phi[TRANSIENT:][o]
        on = (x >= low) & (x <= high)
        axes.plot(x[on], y[on], ".", color=DARK, ms=size, mew=0)
        here = (cycle.component == part) & (cycle.theta >= low) & (cycle.theta <= high)
        axes.plot(cycle.theta[here], cycle.phi[here], "o", color=BLACK, ms=4)
        axes.set_xlabel(AXES["theta"])
        axes.set_ylabel(r"$\varphi$")
        axes.set_xlim(low, high)

    near = at.low - 2 * HALF, at.high + 2 * HALF
    views = (
        ("arc, next to its middle", 0, (0.15, 0.32), 0.8),
        ("arc, next to the join", 0, (1.99, 2 * np.pi / 3), 0.8),
        ("wall, next to the join", 1, (0.32, 0.44), 0.8),
        ("the rectangle, from near", 0, near, 2.0),
    )
    for axes, (words, part, ends, size) in zip(panels, views, strict=True):
        shown(axes, part, *ends, size)
        axes.set_title(words, loc="left")
        if part == 0 and ends[0] > 1:
            sides = at.high - at.low, at.top - at.bottom
            axes.add_patch(Rectangle((at.low, at.bottom), *sides, fill=False, edgecolor=MIDDLE, lw=1.4, zorder=3))
    return made


if __name__ == "__main__":
    with styled():
        drawn().savefig(PICTURE, dpi=144, transparent=False)
