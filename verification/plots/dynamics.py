"""Figures of branches of cycles, of the egg's parameter plane and of its crises.

For a branch, `theta` of each bounce is drawn against the parameter, solid where the cycle is stable, with bifurcations
marked. For the plane of `lam` and `alpha`, the curves of the cascade over the fraction of chaotic starts. For a crisis
(paper: section 6.7), the attractor and the invariant manifolds, whole and enlarged where they touch.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from sympy import Expr

from numeric import PinballMap
from numeric.backends import elementary
from symbolic.tables import egg
from symbolic.tables.law import PAPERS_LAW, Law
from verification.arithmetic.balls import ARRAYS, FLOAT64
from verification.cycles.arc import Steps
from verification.cycles.branch import Branch, spectrum_of, through
from verification.cycles.chords import Chords
from verification.cycles.recurrence import Array, BifurcationKind, Closure
from verification.cycles.systems import Cycles
from verification.named.curves import AccumulationCurve as Accumulation
from verification.named.curves import BifurcationCurve, accumulation_curve, cascade, fold, largest_shape
from verification.plots.results import MARK, closed, position
from verification.plots.results import table as table_alone
from verification.plots.sheet import AXES, figure, figure_of
from verification.proofs.corner.corner_orbit import CornerOrbit
from verification.proofs.manifolds.grow import branch
from verification.proofs.manifolds.known import CONTACTS, contact, table
from verification.proofs.manifolds.saddle import local, saddle
from verification.proofs.manifolds.tangency import Gap
from verification.proofs.periodic.cycle_in_box import SolutionInBox, UniqueCycle

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from verification.named.locate import Located


MARKS = {
    BifurcationKind.FOLD: ("s", "tab:blue"),
    BifurcationKind.PITCHFORK: ("D", "tab:purple"),
    BifurcationKind.BRANCH_POINT: ("D", "tab:brown"),
    BifurcationKind.FLIP: ("o", "tab:red"),
    BifurcationKind.TORUS: ("*", "tab:green"),
    BifurcationKind.NEUTRAL_SADDLE: ("x", "tab:gray"),
    BifurcationKind.BORDER_COLLISION: ("v", "tab:orange"),
}


def plotted(branches: Sequence[Branch], bounces: Sequence[int] | None = None, axes: "Axes | None" = None) -> "Figure":
    """Figure of `theta` against the parameter along branches, for the given bounces (None: all); new or on `axes`."""
    if axes is not None:
        along(axes, branches, bounces)
        return figure_of(axes)
    made = figure(7, 4.4)
    axes = made.add_subplot()
    along(axes, branches, bounces)
    axes.set_title(", ".join(dict.fromkeys(b.system.label for b in branches)) + "  (dashed: unstable)", fontsize=10)
    return made


def along(axes: "Axes", branches: Sequence[Branch], bounces: Sequence[int] | None = None) -> None:
    """Draws `theta` of the given bounces (None: all) along each branch, and marks the bifurcations."""
    seen: set[BifurcationKind] = set()
    for number, followed in enumerate(branches):
        shown = range(followed.system.recurrence.period) if bounces is None else bounces
        colour = f"C{number}" if len(branches) > 1 else "black"
        for bounce in shown:
            for values, angles, stable in (run for piece in followed.each for run in runs(piece, bounce)):
                axes.plot(values, angles, color=colour, lw=1.4 if stable else 0.9, ls="-" if stable else "--")
            for event in followed.events:
                marker, paint = MARKS[event.kind]
                label = None if event.kind in seen else event.kind.value
                seen.add(event.kind)
                axes.plot(
                    event.value, _wrapped(event.point.z[bounce]), marker, color=paint, ms=5, label=label, zorder=3
                )
    axes.set_xlabel(
        {"lam": r"$\lambda$", "alpha": r"$\alpha$"}.get(branches[0].system.parameter, branches[0].system.parameter)
    )
    axes.set_ylabel(r"$\theta$ of the bounces" if isinstance(branches[0].system.recurrence, Chords) else "$x$")
    if seen:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))


NEAR = 0.12  # share of the parameter's range that is shown on either side of a located value
MOST = 64  # at most so many images of a part of a cycle under its symmetry
NUMBERED = {"band-merging": "4", "interior-crisis": "1"}  # the crisis that is drawn when no number is given


def situated(found: "Sequence[Located]", number: str | None = None) -> "Figure":
    """Figure of the first located value: its cycle in the table, and the branch with the value marked.

    A crisis is drawn with its manifolds; `number` selects one of several with the same name. For the orbit through the
    corners, the landing of the fourth bounce is drawn, as in section 5.2.
    """
    one = found[0]
    proof: Any = one.proof
    if proof is None:
        raise ValueError(f"--plot: nothing was proved of {one.name} here, so there is no cycle to draw")
    kind = one.name.removesuffix("-crisis")
    if isinstance(proof, CornerOrbit):
        return _through_corners(float(proof.centre[1].mid()))
    if not isinstance(proof, SolutionInBox):
        kind = kind if kind in CONTACTS else f"{one.name}-{number or NUMBERED.get(one.name)}"
        return portrait(kind, dict(proof.table.fixed)["alpha"], law=proof.law)
    z = np.array([float(x.mid()) for x in proof.centre])
    problem = proof.problem if isinstance(proof, UniqueCycle) else None
    ring, free, lam = _diameter(), "alpha", getattr(proof, "lam", None)
    if problem:
        ring, free, lam = problem.ring, problem.free, problem.lam
    low, high = next(((float(p.range.start), float(p.range.end)) for p in ring.table.shapes), (-1.0, 1.0))
    low, high = (0.0, 1.0) if lam is None else (low, high)
    interval = max(low, z[-1] - NEAR * (high - low)), min(high, z[-1] + NEAR * (high - low))
    generic = np.append(np.cos(np.arange(len(z) - 1.0)), 1.0)  # at a fold the tangent has no part along the parameter
    system = Cycles(ring, free, {} if lam is None else {"lam": float(lam)})
    followed = through(system, z, generic, interval, Steps(largest=0.004, most=200))
    law = ring.law.at(**{free: Fraction(z[-1])}) if ring.law.parameters else ring.law
    shape = {free: z[-1]} if ring.table.shapes else {}
    map = PinballMap(ring.table, lam=z[-1] if lam is None else float(lam), law=law, **shape)
    whole = _whole(ring.closure, z[:-1])
    made = figure(7.0, 3.2)
    left, right = made.subplots(1, 2, width_ratios=(1, 1.5))
    table_alone(left, map)
    closed(left, map, ring.components * (len(whole) // len(ring.components)), whole, color="black", lw=0.9)
    if problem:
        along(right, [followed])
    else:  # the diameter does not move with the parameter; its multipliers meet
        right.plot(
            followed.values, [[abs(mu) for mu in each.multipliers] for each in followed.spectra()], color="black"
        )
        right.set_xlabel(AXES["alpha"])
        right.set_ylabel(AXES["modulus"])
    right.axvline(z[-1], color=MARK, lw=0.7)
    right.set_title(f"{one.title} = {one.value[:14]}  (dashed: unstable)", loc="left")
    return made


def _diameter() -> Chords:
    """The egg's diameter, as chord rules with `alpha` free, for the figure of alpha-hat (complex multipliers)."""
    return Chords(egg(3), (0, 0))


def _through_corners(lam: float) -> "Figure":
    """Figure of the cuspless orbit through both corners, and of `s` at the fourth bounce from the upper corner."""
    map, corner = PinballMap("cuspless", lam=lam), 2 * np.pi / 3
    made = figure(7.0, 3.2)
    left, right = made.subplots(1, 2, width_ratios=(1, 1.5))
    table_alone(left, map)
    phi = np.linspace(-lam, lam, 1601) * np.pi / 2
    orbit = map.orbit(np.full(phi.shape, corner), phi, 4, 0)
    s = position(map, map.arclength.s(orbit.theta[4], orbit.component[4]))[0]
    low = position(map, map.arclength.s(np.array([-corner, corner]), 0))[0]
    nearest = int(np.nanargmin(np.where(orbit.code[4] == 0, np.hypot(s - low[1], orbit.theta[2] + corner), np.nan)))
    left.plot(orbit.x[:, nearest], orbit.y[:, nearest], color="black", lw=0.9)
    right.plot(phi, np.where(np.abs(np.diff(s, append=s[-1])) > 1, np.nan, s), color="black")
    right.axvline(phi[nearest], color=MARK, lw=0.7)
    for join in low:
        right.axhline(join, color="0.6", lw=0.5, ls=":")
    right.set_xlabel(AXES["phi"])
    right.set_ylabel(AXES["s_4"])
    right.set_title(rf"$\lambda$ = {lam:.12f}", loc="left")
    return made


def _whole(closure: Closure, x: Array) -> list[float]:
    """All bounces of a cycle, from the bounces `x` of one part, which a symmetry maps to the next parts."""
    bounces, here = list(x), np.asarray(x)
    for _ in range(MOST):
        here = closure.turn * here + closure.radians
        if np.max(np.abs(np.sin((here - x) / 2))) < 1e-9:
            break
        bounces += list(here)
    return [float(bounce) for bounce in bounces]


def runs(branch: Branch, bounce: int) -> Iterator[tuple[list[float], list[float], bool]]:
    """Pieces `(parameters, angles, stable)` of a branch, cut where the stability changes or the angle jumps by 2*pi."""
    values: list[float] = []
    angles: list[float] = []
    attracts = [spectrum_of(point).stable for point in branch.points]
    for end, inner in ((0, 1), (-1, -2)):  # of areas that are preserved, as at lam = 1, the neighbour decides
        if len(attracts) > 1 and np.max(np.abs(spectrum_of(branch.points[end]).multipliers)) < 1 + NEUTRAL:
            attracts[end] = attracts[inner]
    for (a, b), (before, stable) in zip(pairwise(branch.points), pairwise(attracts), strict=True):
        ends = [(float(p.z[-1]), float(_wrapped(p.z[bounce]))) for p in (a, b)]
        if not values:
            values, angles = [ends[0][0]], [ends[0][1]]
        if abs(ends[1][1] - ends[0][1]) > np.pi:
            yield values, angles, before
            values, angles = [], []
            continue
        values.append(ends[1][0])
        angles.append(ends[1][1])
        if before != stable:
            yield values[:-1], angles[:-1], not stable
            values, angles = [ends[0][0], ends[1][0]], [ends[0][1], ends[1][1]]
    if values:
        yield values, angles, attracts[-1]


def _wrapped(theta: float) -> float:
    return float(np.mod(theta + np.pi, 2 * np.pi) - np.pi)


NEUTRAL = 1e-9  # by which rounding moves a multiplier off the unit circle
POSITIVE = 0.02  # an exponent per bounce above this counts as chaotic
POINTS = 10_000  # shapes are multiples of this part of their range, hence exact


class Sample(NamedTuple):
    """The fraction of starts whose exponent is positive, by shape `alpha` (rows) and contraction `lam` (columns)."""

    alpha: Array
    lam: Array
    share: Array


def sampled(K: int, side: int = 40, starts: int = 24, bounces: int = 2000, seed: int = 1) -> Sample:
    """The fraction of chaotic starts on a `side` by `side` grid; exponents are over `bounces`, after a transient.

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
        phi = elementary.arcsin(rng.uniform(-0.99, 0.99, (side, starts)))
        map = PinballMap("egg", lam=np.repeat(lams[:, None], starts, 1), K=K, alpha=alpha)
        found = map.exponents(theta, phi, bounces, transient=bounces)
        shares.append((found.nu_plus > POSITIVE).mean(axis=1))
    return Sample(np.array([float(a) for a in alphas]), lams, np.array(shares))


def tongue_plotted(K: int = 3, sample: Sample | None = None, highest: int = 64) -> "Figure":
    """Figure of the plane of `lam` and `alpha`: doublings, symmetry breaking, accumulation, folds of polygons."""
    made = figure(7.5, 5.2)
    axes = made.add_subplot()
    top = largest_shape(K)
    if sample is not None:
        axes.pcolormesh(sample.lam, sample.alpha, sample.share, cmap="Reds", vmin=0, vmax=1.6, shading="nearest")
    if K % 2:
        curves = list(cascade(K, highest))
        for line in curves:
            _line(axes, line)
        _limit(axes, accumulation_curve(curves, np.linspace(0.6 * top, top, 41)))
    for (p, q), dashes in zip(turns(K), ("-.", "--", ":", "-.", "--"), strict=False):
        plane = fold(K, p, q).curve.plane
        axes.plot(plane[:, 1], plane[:, 0], color="tab:blue", ls=dashes, lw=1.2, label=f"fold of the polygon {p}/{q}")
    axes.set_xlim(0, 1)
    axes.set_ylim(0.3 * top, top)
    axes.set_xlabel(r"$\lambda$")
    axes.set_ylabel(r"$\alpha$")
    axes.set_title(f"egg with K = {K}" + ("; red: share of starts that end in chaos" if sample is not None else ""))
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return made


def turns(K: int) -> list[tuple[int, int]]:
    """The rotation numbers `p/K` below 1/2 in lowest terms, as pairs `(p, K)`, of the polygons that have folds.

    >>> turns(5)
    [(1, 5), (2, 5)]
    """
    return [(p, K) for p in range(1, (K + 1) // 2) if np.gcd(p, K) == 1]


def _line(axes: object, line: BifurcationCurve) -> None:
    plane = line.curve.plane
    breaking = line.kind is BifurcationKind.PITCHFORK
    label = line.name if line.period <= 4 else "doublings of 8, 16, ..." if line.period == 8 else None
    colour = "tab:purple" if breaking else "black" if line.period == 2 else "tab:green"
    axes.plot(plane[:, 1], plane[:, 0], color=colour, lw=1.6 if line.period == 2 else 1.0, label=label)  # type: ignore[attr-defined]


def _limit(axes: object, end: Accumulation) -> None:
    axes.plot(end.lam, end.alpha, color="tab:red", lw=1.6, label="accumulation")  # type: ignore[attr-defined]


PARTICLES, BOUNCES, TRANSIENT, SEED = 300, 400, 2000, 1
LENGTHS = dict.fromkeys(CONTACTS, (16.0, 12.0)) | {"boundary": (26.0, 9.0)}  # of an unstable and of a stable branch
ZOOM = dict.fromkeys(CONTACTS, (0.12, 0.009)) | {
    "boundary": (0.16, 0.09)
}  # half the width and height of the second panel
JOINED = 0.02
COLOURS = {"unstable": "#c1272d", "stable": "#1f4e99", "attractor": "0.55"}


def portrait(kind: str, alpha: Expr, below: float = 0.0, share: float = 1.0, law: Law = PAPERS_LAW) -> "Figure":
    """Figure of a crisis of the egg in `theta` modulo 2*pi/3 and `phi`; `kind` names the crisis.

    `below` is subtracted from the contraction of the tangency; `share` scales the lengths of the manifolds.
    """
    where = contact(kind, alpha, law)
    map, lam = table(alpha, law).over(FLOAT64), where.parameter - below
    made = figure(12, 5.2)
    whole, close = made.subplots(1, 2)
    found, arrays = saddle(where.unstable, map, lam), map.over(ARRAYS)
    cloud = attractor(kind, alpha, lam, law)
    mirrors = (1, -1) if law.odd else (1,)
    target = _touching_point(where, map)
    for axes, size in ((whole, 0.3), (close, 1.5)):
        axes.plot(*cloud, ",", color=COLOURS["attractor"], zorder=1)
        for unstable, word, length in zip((False, True), ("stable", "unstable"), LENGTHS[kind][::-1], strict=True):
            for side in (1, -1):
                grown = branch(local(found, unstable), side, share * length, spacing=0.01)
                here, following = grown.here, grown.following
                for _ in found.points:  # the curve through one bounce, and its images through the others
                    theta, phi = arrays.plane(here, following)
                    for sign in mirrors:
                        _curve(axes, sign * theta, sign * phi, COLOURS[word], 0.5 + size / 3)
                    here, following = following, arrays.following(here, following, lam)
        ring = found.around()
        for sign in mirrors:
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
    made.legend(loc="outside lower center", ncols=4, fontsize=8)
    return made


def attractor(kind: str, alpha: Expr, lam: float, law: Law = PAPERS_LAW) -> tuple[Any, Any]:
    """`theta` and `phi` of points on the chaotic attractor, at a contraction just below the crisis `lam`."""
    rng = np.random.default_rng(SEED)
    map = PinballMap("egg", lam=lam - (1e-4 if kind == "boundary" else 1e-6), alpha=alpha, law=law)
    theta, phi = rng.uniform(-0.05, 0.05, (2, PARTICLES))
    particle = map.exponents(theta, phi, 200, TRANSIENT)
    chaotic = particle.nu_plus > 0
    orbit = map.orbit(particle.theta[chaotic], particle.phi[chaotic], BOUNCES)
    return _modulo(orbit.theta.ravel()), orbit.phi.ravel()


def _touching_point(where: Any, map: Any) -> tuple[float, float]:
    """`theta` modulo 2*pi/3 and `phi` of the bounce at which a tangency is shown, the most sensitive or the last."""
    gap = Gap(where, map, where.parameter, 28, 1e-16)
    flight = [jet.c[0] for jet in gap.orbit(gap.extremum()[0])]
    moves = [abs(jet.c[1]) for jet in gap.orbit(gap.start)[:-1]]
    bent = int(np.argmax(moves)) if len(where.unstable.start) != 2 else len(moves) - 1
    theta, phi = map.plane(flight[bent], flight[bent + 1])
    return float(_modulo(theta)), float(phi)


def _curve(axes: Any, x: Any, y: Any, colour: str, width: float) -> None:
    """Draws a curve with `theta` modulo 2*pi/3, broken where neighbouring points are more than `JOINED` apart."""
    cell = _modulo(x)
    broken = np.hypot(np.diff(cell), np.diff(y)) > JOINED
    at = np.nonzero(broken)[0] + 1
    axes.plot(np.insert(cell, at, np.nan), np.insert(y, at, np.nan), color=colour, lw=width, zorder=2)


def _modulo(theta: Any) -> Any:
    third = 2 * np.pi / 3
    return np.remainder(np.asarray(theta) + third / 2, third) - third / 2
