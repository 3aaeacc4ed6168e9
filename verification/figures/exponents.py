"""Lyapunov exponents against the contraction, as the paper plots them. Paper: sections 4.1 and 5.3, appendix."""

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from verification.figures.panel import Array, Curve, Panel
from verification.figures.phase import SEED, TRANSIENT, facts
from verification.sweeps.signs import floor_of

ORBITS = 100  # the paper's number for each contraction


def averaged(table: str, lams: Array, bounces: int, orbits: int = ORBITS) -> Panel:
    """The means of both exponents over all orbits, and of `nu_plus` over those that converge to a cycle and the others.

    The standard errors over the orbits come with the means; a mean over no orbit is a gap.
    """
    map = PinballMap(table, lam=np.repeat(lams, orbits))
    starts = interior_starts(map.at(1), orbits, SEED)
    theta, phi, component = (np.tile(field, lams.size) for field in (starts.theta, starts.phi, starts.component))
    found = map.exponents(theta, phi, bounces, TRANSIENT, component)
    stopped = found.code != 0
    plus, minus = (
        np.where(stopped, np.nan, values).reshape(lams.size, orbits) for values in (found.nu_plus, found.nu_minus)
    )
    chaotic = plus > floor_of(bounces)
    curves = {
        "nu_plus": Curve(lams, np.nanmean(plus, axis=1)),
        "nu_minus": Curve(lams, np.nanmean(minus, axis=1)),
        "sum": Curve(lams, np.nanmean(plus + minus, axis=1)),
        "nu_plus_stderr": Curve(lams, np.nanstd(plus, axis=1, ddof=1) / np.sqrt(orbits)),
        "nu_minus_stderr": Curve(lams, np.nanstd(minus, axis=1, ddof=1) / np.sqrt(orbits)),
        "nu_plus_chaotic": Curve(lams, _mean(plus, chaotic)),
        "nu_plus_periodic": Curve(lams, _mean(plus, plus <= floor_of(bounces))),
        "chaotic_share": Curve(lams, chaotic.mean(axis=1)),
    }
    known = facts(map, seed=SEED, orbits=orbits, bounces=bounces, transient=TRANSIENT)
    return Panel(table, "lam", "nu", curves, facts=known)


def _mean(values: Array, chosen: NDArray[np.bool_]) -> Array:
    """The mean of the chosen ones in each row; nan where there is none."""
    count = chosen.sum(axis=1)
    total = np.where(chosen, values, 0.0).sum(axis=1)
    return np.asarray(np.divide(total, count, out=np.full(count.shape, np.nan), where=count > 0))
