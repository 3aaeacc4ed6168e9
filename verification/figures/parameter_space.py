"""The figure of the egg's parameter space: chaos or none. Paper: section 6.5."""

from typing import TYPE_CHECKING

import numpy as np

from symbolic.symbols import lam as lam_letter
from symbolic.thresholds import alpha_tilde
from verification.figures.panel import Curve, Fact, Panel, Panels, Raster, scaled
from verification.figures.phase import SEED
from verification.figures.sheet import BLACK, sheet
from verification.figures.swept import swept

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = ("no chaos found", "chaos", "undecided")


def parameter_space(fine: float = 1.0) -> Panels:
    """Which pairs `(alpha, lam)` have a chaotic orbit among 100 random starts, and `alpha_tilde(lam)`.

    Each sign counts beyond twice its error (`verification.sweeps.signs`); a pair with no chaotic orbit and one whose
    sign its error leaves open is undecided.
    """
    from symbolic.codegen import kernel, load
    from verification.arithmetic import ARRAYS
    from verification.sweeps.parameter_space import parameter_space as sweep

    side, starts = scaled(40, fine**0.5, 3), scaled(100, min(fine, 1.0), 4)
    bounces = scaled(1000, min(fine, 2.0), 40)
    alphas, lams = np.round(np.linspace(0, 0.1, side + 1), 12), np.round(np.linspace(0, 1, side + 1), 12)
    found = swept(sweep(alphas, lams, starts, bounces, bounces, seed=SEED))
    chaotic = found["chaotic"] > 0
    undecided = ~chaotic & (found["regular"] < starts)
    raster = Raster(lams, alphas, np.where(chaotic, 1, np.where(undecided, 2, 0)), NAMES)
    lam = np.linspace(0, 1, 201)
    tilde = load(kernel("alpha_tilde", [lam_letter], {"alpha": alpha_tilde()}), ARRAYS)(lam)[0]
    known: dict[str, Fact] = {"table": "egg", "seed": SEED, "starts": starts, "bounces": bounces, "transient": bounces}
    return (Panel("", "lam", "alpha", {"alpha_tilde": Curve(lam, tilde)}, raster, known),)


def draw_parameter_space(panels: Panels) -> "Figure":
    """Crosses and small plus signs, as in the paper; the doubling of period 2 as a black curve."""
    figure, (ax,) = sheet(panels, columns=1, height=3.6)
    (panel,) = panels
    assert panel.raster is not None
    lams, alphas, labels, names = panel.raster
    x, y = np.meshgrid(lams, alphas)
    looks = (("+", "0.72", 2.5, 0.4), ("x", "#a01010", 3.5, 0.8), ("$\\circ$", "0.3", 3.5, 0.2))
    for value, (marker, color, size, width) in enumerate(looks):
        here = labels == value
        if np.any(here):
            ax.plot(x[here], y[here], ls="", marker=marker, color=color, ms=size, mew=width, label=names[value])
    ax.plot(*panel.curves["alpha_tilde"], color=BLACK, lw=1.8, label=r"$\tilde\alpha(\lambda)$")
    ax.set_xlim(-0.015, 1.015)
    ax.set_ylim(-0.0015, 0.1015)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4, handletextpad=0.4)
    return figure
