"""The tongue explained in one picture: the curves of the cascade over a sample of where attractors are chaotic."""

from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from numeric import PinballMap
from verification.all_cycles.newton import Array
from verification.continuation.branch import What
from verification.continuation.tongue import Accumulation, Rung, accumulation, cascade, fold, largest_shape

if TYPE_CHECKING:
    from matplotlib.figure import Figure

POSITIVE = 0.02  # an exponent per bounce above this counts as chaotic
POINTS = 10_000  # parts that a convex table's range of shapes is cut into, to name a shape exactly


class Sample(NamedTuple):
    """The share of starts with a positive exponent, rows for shapes and columns for contractions."""

    alpha: Array
    lam: Array
    share: Array


def sampled(K: int, side: int = 40, starts: int = 24, bounces: int = 2000, seed: int = 1) -> Sample:
    """Exponents of random starts on a grid of shapes and contractions, after as many bounces that do not count.

    >>> found = sampled(3, 3, 4, 200)
    >>> found.share.shape, float(found.share[0].max())
    ((3, 3), 0.0)
    """
    rng = np.random.default_rng(seed)
    top, lams = Fraction(1, 1 + K * K), np.linspace(0.02, 0.98, side)
    alphas = [top * Fraction(round(POINTS * x), POINTS) for x in np.linspace(0.3, 1.0, side)]
    shares = []
    for alpha in alphas:
        theta = rng.uniform(-np.pi, np.pi, (side, starts))
        phi = np.arcsin(rng.uniform(-0.99, 0.99, (side, starts)))
        map = PinballMap("egg", lam=np.repeat(lams[:, None], starts, 1), K=K, alpha=alpha)
        found = map.exponents(theta, phi, bounces, transient=bounces)
        shares.append((found.nu_plus > POSITIVE).mean(axis=1))
    return Sample(np.array([float(a) for a in alphas]), lams, np.array(shares))


def tongue_plotted(K: int = 3, sample: Sample | None = None, highest: int = 64) -> "Figure":
    """Doublings, symmetry breaking, accumulation and the fold of the polygons that take over, in (lam, alpha)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    top = largest_shape(K)
    if sample is not None:
        axes.pcolormesh(sample.lam, sample.alpha, sample.share, cmap="Reds", vmin=0, vmax=1.6, shading="nearest")
    if K % 2:
        rungs = list(cascade(K, highest))
        for rung in rungs:
            _line(axes, rung)
        _limit(axes, accumulation(rungs, np.linspace(0.6 * top, top, 41)))
    for (p, q), dashes in zip(turns(K), ("-.", "--", ":", "-.", "--"), strict=False):
        plane = fold(K, p, q).curve.plane
        axes.plot(plane[:, 1], plane[:, 0], color="tab:blue", ls=dashes, lw=1.2, label=f"fold of the polygon {p}/{q}")
    axes.set_xlim(0, 1)
    axes.set_ylim(0.3 * top, top)
    axes.set_xlabel(r"$\lambda$")
    axes.set_ylabel(r"$\alpha$")
    axes.set_title(f"egg with K = {K}" + ("; red: share of starts that end in chaos" if sample is not None else ""))
    axes.legend(fontsize=8, frameon=True, loc="lower left")
    return figure


def turns(K: int) -> list[tuple[int, int]]:
    """The rotation numbers `p/K` below 1/2 whose polygons fold.

    >>> turns(5)
    [(1, 5), (2, 5)]
    """
    return [(p, K) for p in range(1, (K + 1) // 2) if np.gcd(p, K) == 1]


def _line(axes: object, rung: Rung) -> None:
    plane = rung.curve.plane
    breaking = rung.what is What.PITCHFORK
    label = rung.name if rung.period <= 4 else "doublings of 8, 16, ..." if rung.period == 8 else None
    colour = "tab:purple" if breaking else "black" if rung.period == 2 else "tab:green"
    axes.plot(plane[:, 1], plane[:, 0], color=colour, lw=1.6 if rung.period == 2 else 1.0, label=label)  # type: ignore[attr-defined]


def _limit(axes: object, end: Accumulation) -> None:
    axes.plot(end.lam, end.alpha, color="tab:red", lw=1.6, label="accumulation")  # type: ignore[attr-defined]
