"""A survey of exponents as plain data: one entry for each attractor, with error bars and a check by the determinant.

The sum `nu_plus + nu_minus` along an orbit follows from its angles alone, which checks the tangent kernels. In
`(s, phi)` the determinant is `det DT = lam*cos(phi0)/cos(eta1)`, and along an orbit cosines of successive bounces pair
up:

    log|det D(T^n)| = n*log(lam) + sum of log(cos(lam*eta_k)/cos(eta_k)) + log(cos(phi_0)/cos(phi_n)).

See `symbolic.motion.collision` for the derivation and for what follows from it.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.estimator import ExponentEstimates, mean_flight, measured_on, per_time
from numeric.dynamics.exponents import CHANGED, Group, Survey
from numeric.dynamics.phase_points import PhasePoints
from numeric.dynamics.recognition import Attractor, Kind
from numeric.dynamics.statistics import Estimate
from numeric.flights.family import FORMULA
from numeric.pinball.sampling import Growth

Document = dict[str, Any]  # of JSON
METHOD = (
    "batch means over orbits and blocks, batches merged until their ends matter little and put right with the "
    "integrated autocorrelation time; the last level is one batch for each independent orbit"
)
EXPONENTS = "nu_plus", "nu_minus"
CHECKED_PARTICLES, CHECKED_BOUNCES = 32, 500


def account(map: PinballMap, survey: Survey, timed: bool = False) -> Document:
    """The document of `pinball lyapunov`: results by group, and at the top those of the attractor if there is only one.

    With `timed`, it has the mean flights and the exponents per unit of time as well.

    >>> from numeric.pinball.sampling import phase_starts
    >>> from numeric.dynamics.exponents import surveyed
    >>> circle = PinballMap("circle", lam="0.25")
    >>> document = account(circle, surveyed(circle, phase_starts(circle, 10, seed=1), 200, 100))
    >>> round(document["sum"], 12), document["groups"][0]["kind"]  # log(1/4)
    (-1.38629436112, 'neutral')
    """
    groups = [described(group, survey) | (per_unit_of_time(group, survey) if timed else {}) for group in survey.groups]
    doubts = dict.fromkeys(group.attractor.doubt for group in survey.groups if group.attractor)
    undecided = "; ".join(filter(None, doubts)) or None
    settled = [group for group in survey.groups if group.attractor and group.attractor.kind is not Kind.STOPPED]
    families = {group.attractor.family if group.attractor else -1 for group in settled}
    one = len(settled) == 1 or (len(families) == 1 and -1 not in families)
    together = np.concatenate([group.members for group in settled]) if one else None
    whole = None if together is None else measured_on(survey.count, together, settled[0].attractor)
    return {
        **(of_cycle(settled[0].attractor) if one and is_cycle(settled[0]) else numbers(whole)),
        "orbits": int(survey.count.growth.theta.size),
        "counted": survey.count.bounces,
        "transient": survey.transient,
        "ended": survey.ended,
        "method": METHOD,
        "attractors": None if undecided else len(settled),
        "undecided": undecided,
        "sum_rule": sum_rule(map, survey),
        "groups": groups,
    }


def numbers(measured: ExponentEstimates | None) -> Document:
    """The exponents and their sum with standard errors, as a document; null where there is no finite number."""
    whole = measured or ExponentEstimates(None, None, None)
    found: Document = {}
    for name, value in (("nu_plus", whole.upper), ("nu_minus", whole.lower), ("sum", whole.total)):
        found[name] = None if value is None else value.mean
        found[f"{name}_stderr"] = None if value is None or np.isnan(value.error) else value.error
    return found


def is_cycle(group: Group) -> bool:
    """Does the group end on a cycle, whose multipliers give its exponents without a statistical error?"""
    return group.attractor is not None and group.attractor.kind is Kind.CYCLE


def of_cycle(cycle: Attractor | None) -> Document:
    """The entries for the exponents of a cycle, from its multipliers.

    Growth along orbits would converge more slowly: the turning of the vector leaves an error of order `1/n`.
    """
    assert cycle is not None
    finite = bool(np.isfinite(cycle.nu_minus))
    return {
        "nu_plus": cycle.nu_plus,
        "nu_plus_stderr": 0.0,
        "nu_minus": cycle.nu_minus if finite else None,
        "nu_minus_stderr": 0.0 if finite else None,
        "sum": cycle.nu_plus + cycle.nu_minus if finite else None,
        "sum_stderr": 0.0 if finite else None,
    }


def described(group: Group, survey: Survey) -> Document:
    """A document of one group: its kind and size, its exponents, and how far their error bars can be trusted."""
    attractor, measured, map = group.attractor, group.measured, survey.count.growth.map
    lost = group.kind.startswith("stopped") or group.kind == CHANGED
    found: Document = {
        "kind": group.kind,
        "orbits": int(group.members.size),
        **numbers(None if lost else measured),
    }
    if attractor is not None:
        component, theta, phi = (row[0] for row in attractor.points)
        x, y = map.states.point(np.array([component]), np.array([theta]))
        found["at"] = {"theta": float(theta), "phi": float(phi), "x": float(x[0]), "y": float(y[0])}
        found["at"]["component"] = map.ir.parts[component].name
        found["undecided"] = attractor.doubt or None
    if attractor is not None and attractor.family >= 0:
        found["family"] = attractor.family
    if attractor is not None and attractor.kind is Kind.CYCLE:
        found |= {"period": attractor.period, **of_cycle(attractor), "along_orbits": numbers(measured)}
    if lost or measured.upper is None:
        return found
    upper, length = measured.upper, survey.count.length
    return {
        **found,
        "batch_bounces": upper.level.batch * length,
        "batches": upper.level.count,
        "trusted": bool(trusted(measured)),
        "skewness": upper.level.skewness,
        "skewed": upper.skewed,
        "interval_95": list(upper.interval) if np.isfinite(upper.error) else None,
        "autocorrelation_time": measured.tau,
        "naive_stderr": measured.naive,
        "trace": trace(group, survey),
    }


def per_unit_of_time(group: Group, survey: Survey) -> Document:
    """The mean flight of a group with its standard error, and both exponents per unit of time at speed 1."""
    end, attractor = survey.count.growth, group.attractor
    if is_cycle(group) and attractor is not None:
        x, y = end.map.states.point(attractor.points.component, attractor.points.theta)
        length = float(np.mean(np.hypot(x - np.roll(x, 1), y - np.roll(y, 1))))
        numbers = of_cycle(attractor)
        rates = {f"{name}_per_time": None if (nu := numbers[name]) is None else nu / length for name in EXPONENTS}
        errors = {f"{name}_per_time_stderr": numbers[f"{name}_stderr"] for name in EXPONENTS}
        return {"mean_flight": length, "mean_flight_stderr": 0.0, **rates, **errors}
    going = group.members[end.code[group.members] == 0]
    if attractor is None or not going.size:
        return {}
    particles = PhasePoints(end.component[going], end.theta[going], end.phi[going])
    flight = mean_flight(end.map.at(end.lam[going]), particles, max(survey.count.bounces, 1))
    found: Document = {"mean_flight": flight.mean, "mean_flight_stderr": flight.error}
    for name, value in zip(EXPONENTS, group.measured[:2], strict=True):
        rate, error = (None, None) if value is None else per_time(value, flight)
        found |= {f"{name}_per_time": rate, f"{name}_per_time_stderr": error}
    return found


def trusted(measured: ExponentEstimates) -> bool:
    """Does every error bar rest on enough batches, each longer than the autocorrelation time?"""
    return all(x.trusted for x in measured[:3] if isinstance(x, Estimate))


def trace(group: Group, survey: Survey) -> list[Document]:
    """How the estimates converge: exponents and errors from the first 1, 2, 4, ... blocks, and last from all."""
    blocks, count = 1, survey.count
    found = []
    while blocks < 2 * len(count.up):
        used = min(blocks, len(count.up))
        bounces = used * count.length
        each = measured_on(count, group.members, group.attractor, used)
        found.append({"collisions": bounces * int(group.members.size), **numbers(each)})
        blocks *= 2
    return found


def sum_rule(map: PinballMap, survey: Survey) -> Document:
    """Entries that compare `log|det D(T^n)|` by the tangent kernel with its value by the angles, on the same orbits."""
    end = survey.count.growth
    few = np.nonzero(end.code == 0)[0][:CHECKED_PARTICLES]
    if few.size == 0:
        return {"difference": None, "bounces": 0, "particles": 0}
    lam = end.lam[few]
    particles = PhasePoints(end.component[few], end.theta[few], end.phi[few])
    return checked(map.at(lam), particles, CHECKED_BOUNCES)._asdict()


Array = NDArray[np.float64]


class DeterminantCheck(NamedTuple):
    """The largest difference of `log|det D(T^n)|` between kernel and angles, over `particles` orbits."""

    difference: float
    bounces: int
    particles: int


def volume(map: PinballMap, particles: PhasePoints, bounces: int) -> Array:
    """`log|det D(T^n)|` of each orbit from its angles, by the formula of this module; nan for a particle that stops.

    The term `n*log(lam)` of the paper's law is left out; for any other law the logarithms of its slopes are included.

    >>> circle = PinballMap("circle", lam="0.5")
    >>> particles = PhasePoints(np.array([0]), np.array([0.3]), np.array([0.4]))
    >>> bool(abs(volume(circle, particles, 5)[0]) < 1e-15)  # eta_{k+1} = -phi_k, so the sum telescopes to 0
    True
    """
    orbit = map.orbit(particles.theta, particles.phi, bounces, particles.component)
    exit, lam = orbit.phi[1:], np.broadcast_to(map.lam, particles.theta.shape)
    if map.law == FORMULA:
        slope, _ = map.slopes(orbit.eta[1:], orbit.theta[1:], orbit.component[1:])
        inner = np.sum(elementary.log(np.abs(slope)), axis=0)
    else:
        inner, exit = np.zeros(lam.shape), lam * orbit.eta[1:]
    inner = inner + np.sum(elementary.log(np.cos(exit) / np.cos(orbit.eta[1:])), axis=0)
    return np.asarray(inner + elementary.log(np.cos(orbit.phi[0]) / np.cos(orbit.phi[-1])))


def checked(map: PinballMap, particles: PhasePoints, bounces: int) -> DeterminantCheck:
    """Compares `volume` with the tangent kernel, along orbits whose bounces are equal bit for bit.

    >>> from numeric.pinball.sampling import phase_starts
    >>> table = PinballMap("cuspless", lam="0.5")
    >>> bool(checked(table, PhasePoints(*phase_starts(table, 8, seed=1)[:3]), 200).difference < 1e-11)
    True
    """
    growth = Growth(map, particles.theta, particles.phi, particles.component)
    growth.advance(bounces)
    difference = np.abs(volume(map, particles, bounces) - growth.volume)[growth.code == 0]
    return DeterminantCheck(float(np.max(difference, initial=0.0)), bounces, int(difference.size))
