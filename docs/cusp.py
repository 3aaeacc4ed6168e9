"""Draws docs/figures/cusp.svg: a short curve across the exits at the cusp, its flights, and by what it is stretched.

`python docs/cusp.py`. The curve is horizontal, and longer than those of the theorem, so that it can be seen.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from sympy import Rational

from numeric import PinballMap
from symbolic.cycles.cusp import expansion
from symbolic.tables.table import lam
from verification.plots.sheet import DARK, FAINT, MIDDLE, figure, styled

PICTURE = Path(__file__).with_name("figures") / "cusp.svg"
PLACE, LENGTH, POINTS = -0.9, 0.4, 4001  # theta in the middle, and how long the curve is in theta


def drawn() -> Figure:
    """The three panels."""
    half = Rational(1, 2)
    map = PinballMap("cardioid", lam=str(half))
    theta = PLACE + LENGTH * np.linspace(-0.5, 0.5, POINTS + 1)  # none at the cusp's own exit
    orbit = map.orbit(theta, np.full(theta.size, PLACE / 2 + 1e-6), 1)
    landing = orbit.theta[1]
    passes = landing > 0
    made = figure(7.5, 2.9)
    left, middle, right = made.subplots(1, 3)
    wide = np.linspace(-np.pi / 2, np.pi / 2, 3)
    left.plot(wide, wide / 2, label="S", **(FAINT | {"color": "black"}))
    for on, colour, name in ((passes, DARK, "passes the cusp"), (~passes, MIDDLE, "lands at it")):
        left.plot(theta[on], orbit.phi[0][on], color=colour, lw=2)
        left.plot(landing[on], orbit.phi[1][on], color=colour, lw=1, label=name)
        for k in np.flatnonzero(on)[:: max(1, int(np.sum(on)) // 5)]:
            middle.plot(orbit.x[:, k], orbit.y[:, k], color=colour, lw=0.6)
        stretch = np.diff(landing[on]) / np.diff(theta[on])
        right.plot(theta[on][1:], stretch, color=colour, lw=1.2)
    edge = np.linspace(-np.pi, np.pi, 400)
    middle.plot((1 + np.cos(edge)) * np.cos(edge), (1 + np.cos(edge)) * np.sin(edge), color="black", lw=0.8)
    middle.set_aspect("equal")
    middle.axis("off")
    left.set_xlim(-np.pi, np.pi)
    left.set_xlabel(r"$\theta$")
    left.set_ylabel(r"$\varphi$")
    left.legend(loc="upper left")
    right.axhline(float(expansion().subs(lam, half)), label="g", **FAINT)
    right.set_ylim(0, 12)
    right.set_xlabel(r"$\theta$")
    right.set_ylabel("stretching")
    return made


if __name__ == "__main__":
    with styled():
        drawn().savefig(PICTURE, transparent=True, metadata={"Date": None})
