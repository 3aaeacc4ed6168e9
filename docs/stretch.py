"""Draws docs/figures/stretch.svg: what is proved of stretching on the two cardioids, beside what is measured.

`python docs/stretch.py`. On the left are the exponents of the cardioid with the bounds that hold for almost every
start. On the right is what a return to the arc of the cuspless table multiplies a vector of the cone by, at least:
over a grid of flights, and over both ends of the cone.
"""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.dynamics.exponents import surveyed
from numeric.pinball.sampling import interior_starts
from symbolic.cycles.defocusing import least_exponent
from symbolic.cycles.returns import HIGHEST, LOWEST, B
from symbolic.expressions.text import kernel, load
from symbolic.tables.table import lam as contraction
from verification.arithmetic.balls import ARRAYS
from verification.plots.sheet import AXES, DARK, FAINT, MIDDLE, figure, styled

Array = NDArray[np.float64]
PICTURE = Path(__file__).with_name("figures") / "stretch.svg"
ORBITS, BOUNCES, TRANSIENT, SEED = 24, 1000, 200, 1
SIDE = 401  # of the grid of flights: places on the arc, and exit angles
EDGE = 2 * np.pi / 3  # of the arc
WIDE = 16 / 27  # from here on widths grow, by lam + 11/27 at least


def exponents(lams: Array) -> tuple[Array, Array]:
    """Both exponents of the cardioid and their standard errors: a row for each, a column for each contraction."""
    found = []
    for lam in lams:
        map = PinballMap("cardioid", lam=float(lam))
        survey = surveyed(map, interior_starts(map, ORBITS, SEED), BOUNCES, TRANSIENT)
        one = max((group for group in survey.groups), key=lambda group: group.members.size).measured
        found.append([[one.upper.mean, one.lower.mean], [one.upper.error, one.lower.error]])
    values, errors = np.moveaxis(np.array(found), 0, -1)
    return values, errors


def returns(lam: float) -> tuple[float, float]:
    """The least factor of the form `L` over returns along the arc, and over those by way of the wall."""
    b, A = float(B), 1 + lam - float(B)
    theta, phi = np.meshgrid(np.linspace(-EDGE, EDGE, SIDE + 2)[1:-1], lam * np.pi / 2 * np.linspace(-1, 1, SIDE))
    map = PinballMap("cuspless", lam=lam)
    orbit = map.orbit(theta.ravel(), phi.ravel(), 2, 0)
    t, t1 = np.hypot(np.diff(orbit.x, axis=0), np.diff(orbit.y, axis=0))
    cos_phi, cos_eta, bend = np.cos(orbit.phi), np.cos(orbit.eta), 3 / (4 * np.cos(orbit.theta / 2))
    D, r = cos_phi[0] / bend[0], cos_phi[1] / cos_eta[1]
    ends = []
    for y in (1.0, 1 + lam):
        along = (A * (t * y - D) * bend[1] / cos_eta[1] - lam * y) / (y - b)
        wall = (A * (r * (t * y - D) + lam * y * t1) * bend[2] / cos_eta[2] - lam**2 * y) / (y - b)
        ends.append((along, wall))
    going = orbit.code[1:] == 0
    on_arc, on_wall = going[0] & (orbit.component[1] == 0), going.all(0) & (orbit.component[1] == 1)
    return tuple(float(min(np.min(end[k][on]) for end in ends)) for k, on in enumerate((on_arc, on_wall)))


def drawn() -> Figure:
    """Both panels."""
    lams = np.linspace(0.02, 0.98, 17)
    values, errors = exponents(lams)
    fine = np.linspace(0.005, 0.999, 400)
    rate = load(kernel("rate", [contraction], {"rate": least_exponent()}), ARRAYS)(fine)[0]
    made = figure(7.0, 3.9)
    left, right = made.subplots(1, 2)
    left.axhline(0, **FAINT)
    shade: dict[str, Any] = {"lw": 0, "alpha": 0.22}
    left.fill_between(fine, rate, np.log(2), color=MIDDLE, label=r"proved for $\nu_+$", **shade)
    left.fill_between(fine, np.log(fine / 2), np.log(fine), color=DARK, label=r"proved for $\nu_-$", **shade)
    for colour, name, value, error in zip((MIDDLE, DARK), "+-", values, errors, strict=True):
        look: dict[str, Any] = {"fmt": "o", "ms": 3, "mew": 0, "elinewidth": 0.7, "color": colour}
        left.errorbar(lams, value, 2 * error, label=rf"$\nu_{name}$, measured", **look)
    left.set_ylim(-4, 1)
    left.set_ylabel("exponents, per bounce")
    left.set_title("cardioid", loc="left")
    lams = np.linspace(0.01, 0.99, 99)
    along, wall = np.array([returns(float(lam)) for lam in lams]).T
    right.axhline(1, **FAINT)
    right.axvspan(float(LOWEST), float(HIGHEST), color="0.9", lw=0, label="proved: both above 1")
    right.plot(lams, along, color=DARK, label="along the arc")
    right.plot(lams, wall, color=MIDDLE, label="by way of the wall")
    wide = np.linspace(WIDE, 1, 50)
    right.plot(wide, wide + 11 / 27, color="black", ls="--", label="widths by the wall, proved")
    right.set_ylim(0.7, 2.0)
    right.set_ylabel("growth in a return, at least")
    right.set_title("cuspless cardioid", loc="left")
    for axes in (left, right):
        axes.set_xlim(0, 1)
        axes.set_xlabel(AXES["lam"])
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
    return made


if __name__ == "__main__":
    with styled():
        drawn().savefig(PICTURE, transparent=True, metadata={"Date": None})
