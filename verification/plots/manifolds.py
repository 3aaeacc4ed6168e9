"""A crisis as a picture: attractor and manifolds, whole and close to where they touch. Paper: section 6.7."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Expr

from numeric import PinballMap
from verification.arithmetic.words import ARRAYS, FLOAT64
from verification.proofs.manifolds.grow import branch
from verification.proofs.manifolds.known import CONTACTS, contact, table
from verification.proofs.manifolds.saddle import saddle
from verification.proofs.manifolds.series import local
from verification.proofs.manifolds.tangency import Gap

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BALLS, BOUNCES, TRANSIENT, SEED = 300, 400, 2000, 1
LENGTHS = dict.fromkeys(CONTACTS, (16.0, 12.0)) | {"boundary": (26.0, 9.0)}  # of each unstable and each stable branch
ZOOM = dict.fromkeys(CONTACTS, (0.12, 0.009)) | {
    "boundary": (0.16, 0.09)
}  # half the width and height of the second panel
JOINED = 0.02
COLOURS = {"unstable": "#c1272d", "stable": "#1f4e99", "attractor": "0.55"}


def portrait(kind: str, alpha: Expr, below: float = 0.0, share: float = 1.0) -> "Figure":
    """A crisis of the egg, one of `CONTACTS`, modulo its rotations, in `theta` and `phi`.

    `below` moves the contraction below the tangency; `share` shortens the curves, for a quick look.
    """
    from matplotlib.figure import Figure

    where = contact(kind, alpha)
    map, lam = table(alpha).over(FLOAT64), where.letter - below
    figure = Figure(figsize=(12, 5.2), layout="constrained")
    whole, close = figure.subplots(1, 2)
    found, arrays = saddle(where.unstable, map, lam), map.over(ARRAYS)
    cloud = attractor(kind, alpha, lam)
    target = _touching_point(where, map)
    for axes, size in ((whole, 0.3), (close, 1.5)):
        axes.plot(*cloud, ",", color=COLOURS["attractor"], zorder=1)
        for unstable, word, length in zip((False, True), ("stable", "unstable"), LENGTHS[kind][::-1], strict=True):
            for side in (1, -1):
                grown = branch(local(found, unstable), side, share * length, spacing=0.01)
                here, following = grown.here, grown.following
                for _ in found.points:  # the curve through one bounce, and its images through the others
                    theta, phi = arrays.plane(here, following)
                    for sign in (1, -1):
                        _curve(axes, sign * theta, sign * phi, COLOURS[word], 0.5 + size / 3)
                    here, following = following, arrays.following(here, following, lam)
        ring = found.around()
        for sign in (1, -1):
            theta, phi = zip(*(map.plane(a, b) for a, b in pairwise(ring[1:])), strict=True)
            axes.plot(_modulo(sign * np.array(theta)), sign * np.array(phi), "o", ms=4, color="black", zorder=4)
        axes.set_xlabel(r"$\theta$ modulo $2\pi/3$")
        axes.set_ylabel(r"$\varphi$")
    whole.set_xlim(-np.pi / 3, np.pi / 3)
    whole.set_ylim(*((-0.75, 0.75) if kind == "boundary" else (-0.3, 0.3)))
    width, height = ZOOM[kind]
    close.set_xlim(target[0] - width, target[0] + width)
    close.set_ylim(target[1] - height, target[1] + height)
    close.plot(*target, "o", ms=9, mfc="none", mec="black", zorder=5)
    whole.set_title(rf"{kind} crisis, $\alpha = {float(alpha):g}$, $\lambda = {lam:.9f}$")
    close.set_title("where the manifolds touch")
    for word, colour in COLOURS.items():
        whole.plot([], [], color=colour, label=word if word == "attractor" else f"{word} manifold")
    whole.plot([], [], "o", ms=4, color="black", label=found.orbit.name)
    whole.legend(loc="upper left", fontsize=8, framealpha=0.9)
    return figure


def attractor(kind: str, alpha: Expr, lam: float) -> tuple[Any, Any]:
    """A cloud of points on the chaotic attractor, just below the crisis where it still attracts."""
    rng = np.random.default_rng(SEED)
    map = PinballMap("egg", lam=lam - (1e-4 if kind == "boundary" else 1e-6), alpha=alpha)
    theta, phi = rng.uniform(-0.05, 0.05, (2, BALLS))
    ball = map.exponents(theta, phi, 200, TRANSIENT)
    chaotic = ball.nu_plus > 0
    orbit = map.orbit(ball.theta[chaotic], ball.phi[chaotic], BOUNCES)
    return _modulo(orbit.theta.ravel()), orbit.phi.ravel()


def _touching_point(where: Any, map: Any) -> tuple[float, float]:
    """The bounce of the tangency orbit that is farthest from the saddle, in the cell of the first panel."""
    gap = Gap(where, map, where.letter, 28, 1e-16)
    flight = [jet.c[0] for jet in gap.orbit(gap.extremum()[0])]
    moves = [abs(jet.c[1]) for jet in gap.orbit(gap.start)[:-1]]
    bent = int(np.argmax(moves)) if len(where.unstable.start) != 2 else len(moves) - 1
    theta, phi = map.plane(flight[bent], flight[bent + 1])
    return float(_modulo(theta)), float(phi)


def _curve(axes: Any, x: Any, y: Any, colour: str, width: float) -> None:
    """A line that is broken where it leaves the cell, and where its points are too far apart to be joined."""
    cell = _modulo(x)
    broken = np.hypot(np.diff(cell), np.diff(y)) > JOINED
    at = np.nonzero(broken)[0] + 1
    axes.plot(np.insert(cell, at, np.nan), np.insert(y, at, np.nan), color=colour, lw=width, zorder=2)


def _modulo(theta: Any) -> Any:
    third = 2 * np.pi / 3
    return np.remainder(np.asarray(theta) + third / 2, third) - third / 2
