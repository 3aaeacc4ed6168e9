"""Parameter space: chaos and periods over pairs of a shape and a contraction. Paper: section 6.5.

At each pair random particles are started as in the paper's appendix, and those whose exponent is positive beyond its
error (`numeric.sweeps.sweep`) are counted. For the particle with the smallest exponent up to `LONGEST` more bounces are
computed, to find the period after which it returns.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.dynamics.phase_points import PhasePoints
from numeric.dynamics.recognition import determinants
from numeric.pinball.sampling import Growth, Starts
from numeric.sweeps.sweep import (
    BLOCKS,
    Array,
    Axis,
    Field,
    Sweep,
    SweepPart,
    against,
    at_value,
    map_of,
    measured,
    spread,
    text_of,
)
from symbolic.tables.scene import Scene

LONGEST = 24  # period
BACK = 1e-6  # of the perimeter, and of a radian
PAIR_PARTICLES = 20_000  # of a task, at most; what a core does in a second or less

SPACE_FIELDS = (
    Field("chaotic", ("lam",), "int32", "orbits", "orbits whose largest exponent is positive beyond its error"),
    Field("regular", ("lam",), "int32", "orbits", "orbits with no positive exponent; the rest is undecided or stopped"),
    Field("nu_max", ("lam",), "float64", "1/bounce", "largest nu_plus of all orbits"),
    Field("nu_max_error", ("lam",), "float64", "1/bounce", "its standard error, over blocks of the orbit"),
    Field("nu_min", ("lam",), "float64", "1/bounce", "smallest nu_plus of all orbits"),
    Field("period", ("lam",), "int16", "bounces", "period of the orbit with that one; 0 where it did not come back"),
)


@dataclass(frozen=True)
class ShapeTask:
    """The task of a sweep over parameter space: all orbits of a range of `lam` at a few shapes."""

    scene: str
    parameter: str
    starts: int
    bounces: int
    transient: int

    def __call__(self, part: SweepPart) -> dict[str, Array]:
        rng = np.random.default_rng(part.seed)
        values = part.values[self.parameter]
        seeds = rng.integers(0, 2**63, values.size)
        rows = [self.row(float(a), part.values["lam"], int(s)) for a, s in zip(values, seeds, strict=True)]
        return {field.name: np.array([row[field.name] for row in rows]) for field in SPACE_FIELDS}

    def row(self, value: float, lams: Array, seed: int) -> dict[str, Array]:
        """The fields for one shape."""
        here = at_value(self.scene, self.parameter, value)
        map, starts = spread(here, lams, self.starts, seed)
        found = measured(map, starts, self.bounces, self.transient, threads=1)
        kept = found.nu_plus, found.nu_plus_error, found.chaotic, found.regular
        nu, error, chaotic, regular = (x.reshape(lams.size, self.starts) for x in kept)
        best = np.argmax(nu, axis=1)[:, None]
        quiet = np.arange(lams.size) * self.starts + np.argmin(np.where(np.isfinite(nu), nu, np.inf), axis=1)
        going = found.code[quiet] == 0
        return {
            "chaotic": chaotic.sum(axis=1),
            "regular": regular.sum(axis=1),
            "nu_max": np.take_along_axis(nu, best, 1)[:, 0],
            "nu_max_error": np.take_along_axis(error, best, 1)[:, 0],
            "nu_min": nu.min(axis=1),
            "period": np.where(going, periods(map_of(here, lams), found.ended(quiet)), 0),
        }


def periods(map: PinballMap, starts: Starts) -> NDArray[np.int64]:
    """The number of bounces, up to `LONGEST`, after which each particle first returns; 0 if it does not.

    >>> diameters = Starts(*(np.array(x) for x in ([0, 0], [0.5, 0.5], [0.0, 0.2], [0.0, 0.0], [0.0, 0.0])))
    >>> periods(PinballMap("circle", lam=1), diameters).tolist()
    [2, 0]
    """
    fields = ("x", "y", "phi", "code")
    told = map.orbit(starts.theta, starts.phi, LONGEST, starts.component, threads=1, fields=fields)
    x, y, phi = (told[name][1:] - told[name][0] for name in fields[:3])
    back = (told["code"][1:] == 0) & (np.hypot(x, y) < BACK * map.arclength.perimeter) & (np.abs(phi) < BACK)
    return np.where(back.any(axis=0), np.argmax(back, axis=0) + 1, 0)


def attracting(map: PinballMap, starts: Starts, period: NDArray[np.int64]) -> NDArray[np.bool_]:
    """For each particle: are both multipliers of the cycle through it, of this period, below 1? False for period 0.

    Paper: section 2.1; this holds if `|trace| < 1 + det` and `|det| < 1`.

    >>> ends = Starts(*(np.array(x) for x in ([0, 0], [np.pi / 2, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0])))
    >>> attracting(PinballMap("ellipse", a=2, lam="0.5"), ends, np.array([2, 2])).tolist()  # the short axis, the long
    [True, False]
    """
    trace, determinant = returns(map, starts, period)
    with np.errstate(invalid="ignore"):
        return np.asarray((np.abs(trace) < 1 + determinant) & (np.abs(determinant) < 1))


def returns(map: PinballMap, starts: Starts | PhasePoints, period: NDArray[np.int64]) -> tuple[Array, Array]:
    """Trace and determinant of the derivative of `T**period` at each particle; nan for period 0."""
    trace, determinant = np.full((2, period.size), np.nan)
    fields = "component", "theta", "phi"
    for n in np.unique(period[period > 0]):
        on = np.flatnonzero(period == n)
        lam = np.broadcast_to(map.lam, period.shape)[on]
        component, theta, phi = (getattr(starts, name)[on] for name in fields)
        told = map.at(lam).orbit(theta, phi, int(n), component, threads=1, fields=fields)
        component, theta, phi = (told[name][:-1] for name in fields)
        slopes = map.at(np.broadcast_to(lam, theta.shape)).derivative(theta, phi, component)
        product = slopes[0]
        for slope in slopes[1:]:
            product = np.sum(slope[:, :, :, None] * product[:, None, :, :], axis=2)
        trace[on] = product[:, 0, 0] + product[:, 1, 1]
        determinant[on] = np.prod(determinants(slopes), axis=0)
    return trace, determinant


class Followed(NamedTuple):
    """The period of each particle, 0 if it is on no cycle; and those still `going`: their indices and their `Growth`.

    `starts` has the last phase points of all particles.
    """

    period: NDArray[np.int64]
    starts: Starts
    going: NDArray[np.int64]
    growth: Growth


def followed(map: PinballMap, starts: Starts, marks: Sequence[int], threads: int | None = None) -> Followed:
    """Follows particles over `marks[-1]` bounces; those on an attracting cycle after an earlier mark stop there.

    A particle is on an attracting cycle if it returns after up to `LONGEST` bounces whose derivative has both
    multipliers below 1. The second condition excludes particles that return near a saddle.

    >>> ellipse = PinballMap("ellipse", a=2, lam="0.5")
    >>> starts = Starts(*(np.array(x) for x in ([0, 0], [1.5, 0.2], [0.0, 0.1], [0.0, 0.0], [0.0, 0.0])))
    >>> followed(ellipse, starts, (1, 100)).period.tolist(), followed(ellipse, starts, (1,)).going.tolist()
    ([2, 2], [0, 1])
    """
    growth, done = Growth(map, starts.theta, starts.phi, starts.component), 0
    period, going = np.zeros(starts.theta.size, dtype=np.int64), np.arange(starts.theta.size)
    component, theta, phi = growth.component.copy(), growth.theta.copy(), growth.phi.copy()
    for mark in marks:
        if not going.size:
            break
        growth.skip(mark - done, threads)
        component[going], theta[going], phi[going] = growth.component, growth.theta, growth.phi
        here = Starts(growth.component, growth.theta, growth.phi, starts.x[going], starts.y[going])
        there = map.at(growth.lam)
        back = np.where((growth.code == 0) & (growth.lam < 1), periods(there, here), 0)
        period[going] = np.where(attracting(there, here, back), back, 0)
        left = np.flatnonzero((period[going] == 0) & (growth.code == 0))
        going, growth, done = going[left], growth.only(left), mark
    return Followed(period, Starts(component, theta, phi, starts.x, starts.y), going, growth)


def egg(K: int, alpha: float) -> str:
    """The scene's text for the egg at one shape, the decimal that `alpha` shows."""
    return text_of(Scene("egg", alpha=Fraction(repr(float(alpha))), K=K))


def parameter_space(
    alphas: Array,
    lams: Array,
    starts: int = 100,
    bounces: int = 2000,
    transient: int = 2000,
    K: int = 3,
    seed: int = 1,
    scene: str | None = None,
    parameter: str = "alpha",
) -> Sweep:
    """The sweep over all pairs: shapes of the egg, or values of a `parameter` of another `scene`, by contractions.

    >>> sweep = parameter_space(np.array([0.02, 0.09]), np.array([0.1, 0.3]), starts=3)
    >>> sweep.task(sweep.part((1, 0)))["chaotic"].tolist()
    [[0, 3]]
    """
    whole = egg(K, 0.08 * 10 / (1 + K * K)) if scene is None else scene
    pairs = ShapeTask(whole, parameter, starts, bounces // BLOCKS * BLOCKS, transient)
    name, what = (f"the {K}-pointed egg", "shape of the egg") if scene is None else ("the scene", "shape of the table")
    return Sweep(
        name="parameter-space",
        about=f"Chaos or none in {name}, from {starts} random orbits for each pair",
        axes=(
            Axis(parameter, np.asarray(alphas, dtype=np.float64), "1", what, 1),
            Axis("lam", np.asarray(lams, dtype=np.float64), "1", "contraction", max(1, PAIR_PARTICLES // starts)),
        ),
        fields=against(parameter, SPACE_FIELDS),
        task=pairs,
        seed=seed,
        scene=f"egg, K = {K}" if scene is None else scene,
        settings={"starts": starts, "bounces": pairs.bounces, "transient": transient, "blocks": BLOCKS},
        collisions=len(alphas) * len(lams) * starts * (pairs.bounces + transient),
        map=partial(map_of, whole, 0.5),
    )
