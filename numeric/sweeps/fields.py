"""The sweeps and their fields: basins of attraction, bifurcation diagrams, exponents by attractor.

Basins (paper: appendix): the attractors are found once, from random starts; then a particle starts at each cell's
centre, and the cell's label is the number of the attractor that the particle reaches. Bifurcation diagrams (section
6.6) show the phase points of random particles after a long time, against the contraction or another parameter.
Exponents (sections 4.1 and 5.3): orbits that share an attractor form a group, and no average is taken over several
groups. At each value groups are numbered by size, the largest first; groups of the same number at two values need not
belong to the same branch.
"""

import json
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from numeric import PinballMap
from numeric.dynamics.attractors import find
from numeric.dynamics.basins import Window, labels, starts_at, whole
from numeric.dynamics.exponents import Group, surveyed
from numeric.dynamics.recognition import Attractor, Kind
from numeric.dynamics.statistics import Estimate
from numeric.pinball.sampling import Starts
from numeric.sweeps.sweep import (
    BLOCKS,
    Array,
    Axis,
    Field,
    Sweep,
    SweepPart,
    against,
    fixed,
    map_of,
    measured,
    missing_value,
    parameter_axis,
    said,
    spread_over,
)

PARTICLES = 1 << 15  # of a task, about; a fraction of a second for a thousand bounces
FIELDS = (Field("label", ("sin_phi", "s"), "int16", "1", "number of the attractor, -1 for none of those found"),)


@dataclass(frozen=True, eq=False)
class LabelTask:
    """The task of a sweep over basins: the labels of some rows of cells."""

    scene: str
    lam: float
    attractors: tuple[Attractor, ...]
    transient: int

    def __call__(self, part: SweepPart) -> dict[str, Array]:
        columns, rows = part.values["s"], part.values["sin_phi"]
        map = map_of(self.scene, self.lam)
        particles = starts_at(map, np.tile(columns, rows.size), np.repeat(rows, columns.size))
        return {"label": labels(map, particles, self.attractors, self.transient).reshape(rows.size, columns.size)}


def basins(
    scene: str,
    lam: float,
    columns: int,
    rows: int,
    window: Window | None = None,
    starts: int = 1000,
    transient: int = 1000,
    seed: int = 1,
    images: bool = False,
    known: tuple[Attractor, ...] | None = None,
) -> Sweep:
    """The sweep over the cells of a window, or of all phase space; `images` adds images of attractors under symmetries.

    If the attractors are `known`, none are searched for.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.sweep import text_of
    >>> sweep = basins(text_of(Scene("cuspless")), 0.09, 4, 2, starts=100)
    >>> sorted(set(sweep.task(sweep.part((0, 0)))["label"].ravel().tolist()))  # a chaotic attractor and period 2
    [0, 1]
    """
    map = map_of(scene, lam)
    attractors = find(map, starts, seed, transient, images=images) if known is None else known
    where = window or whole(map)
    cells, share = LabelTask(scene, lam, attractors, transient), max(1, PARTICLES // columns)
    return Sweep(
        name="basins",
        about=f"Basins of attraction at lam = {lam:g}",
        axes=(
            Axis("sin_phi", _centres(where.sin_phi, rows), "1", "sine of the first exit angle", share),
            Axis("s", _centres(where.s, columns), "length", "arc length of the start, as in the paper"),
        ),
        fields=FIELDS,
        task=cells,
        seed=seed,
        scene=scene,
        settings={
            "lam": lam,
            "starts": starts,
            "transient": transient,
            "attractors": [described(attractor) for attractor in attractors],
        },
        collisions=columns * rows * transient,
        map=partial(map_of, scene, lam),
    )


def described(attractor: Attractor) -> dict[str, Any]:
    """An attractor in a few numbers: its kind, period, exponents, and one of its points."""
    first = {"theta": float(attractor.points.theta[0]), "phi": float(attractor.points.phi[0])}
    exponents = {"nu_plus": attractor.nu_plus, "nu_minus": attractor.nu_minus}
    finite = {name: value if np.isfinite(value) else None for name, value in exponents.items()}
    kind = {"kind": attractor.kind.name.lower(), "period": attractor.period, "family": attractor.family}
    return kind | finite | first | ({"undecided": attractor.doubt} if attractor.doubt else {})


def attractors_of(settings: str) -> list[dict[str, Any]]:
    """The attractors, as `described` returns them, read from the `settings` that are stored with a result."""
    found: list[dict[str, Any]] = json.loads(settings)["attractors"]
    return found


def _centres(ends: tuple[float, float], count: int) -> Array:
    return ends[0] + (np.arange(count) + 0.5) * ((ends[1] - ends[0]) / count)


DIAGRAM_PARTICLES = 2000  # of a task, about; a fraction of a second for some thousand bounces
POINT, ORBIT = ("orbit", "bounce"), ("orbit",)  # after the parameter that varies
DIAGRAM_FIELDS = (
    Field("s", POINT, "float64", "length", "arc length of each bounce, as in the paper"),
    Field("phi", POINT, "float64", "rad", "exit angle of each bounce"),
    Field("theta", POINT, "float64", "rad", "boundary parameter of each bounce"),
    Field("component", POINT, "int8", "1", "component of the boundary"),
    Field("nu_plus", ORBIT, "float64", "1/bounce", "largest exponent of the orbit"),
    Field("nu_plus_error", ORBIT, "float64", "1/bounce", "its standard error, over blocks of the orbit"),
    Field("chaotic", ORBIT, "int8", "1", "1 where the exponent is positive beyond its error, else 0"),
)


@dataclass(frozen=True)
class DiagramTask:
    """The task of a bifurcation diagram: orbits on their attractors, at a few contractions or at one shape."""

    scene: str
    orbits: int
    points: int
    bounces: int
    transient: int
    parameter: str = "lam"
    lam: float = 1.0

    def __call__(self, part: SweepPart) -> dict[str, Array]:
        values = part.values[self.parameter]
        runs = spread_over(self.scene, self.parameter, values, self.lam, self.orbits, part.seed)
        rows = [self.rows(map, starts) for _, map, starts in runs]
        return {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}

    def rows(self, map: PinballMap, starts: Starts) -> dict[str, Array]:
        """The fields of one map, a row for each of its contractions."""
        found = measured(map, starts, self.bounces, self.transient, threads=1)
        orbit = map.orbit(found.end.theta, found.end.phi, self.points, found.end.component, threads=1)
        s = map.arclength.s(orbit.theta, orbit.component)
        s = np.where(orbit.code == 0, s, np.nan)
        each = starts.theta.size // self.orbits, self.orbits
        shown = {"s": s, "phi": orbit.phi, "theta": orbit.theta, "component": orbit.component}
        along = {name: np.moveaxis(x[1:], 0, -1).reshape(*each, self.points) for name, x in shown.items()}
        ends = {"nu_plus": found.nu_plus, "nu_plus_error": found.nu_plus_error, "chaotic": found.chaotic}
        return along | {name: x.reshape(each) for name, x in ends.items()}


def bifurcation(
    scene: str,
    lams: Array,
    orbits: int = 20,
    points: int = 100,
    bounces: int = 2000,
    transient: int = 4000,
    seed: int = 1,
    parameter: str = "lam",
    lam: float = 1.0,
) -> Sweep:
    """The sweep over `lams`, with the last `points` bounces of `orbits` particles for each; `s` is nan after a stop.

    If `parameter` is another one, of the table or of the law, `lams` holds its values, and `lam` is fixed.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.sweep import text_of
    >>> sweep = bifurcation(text_of(Scene("ellipse", a=2)), np.array([0.5]), orbits=3, points=4)
    >>> found = sweep.task(sweep.part((0, 0, 0)))
    >>> np.unique(found["theta"].round(6)).tolist()  # every particle ends on the minor axis
    [-1.570796, 1.570796]
    """
    diagram = DiagramTask(scene, orbits, points, bounces // BLOCKS * BLOCKS, transient, parameter, lam)
    return Sweep(
        name="bifurcation",
        about=f"Attractors against {said(parameter)}, from {orbits} random particles each",
        axes=(
            parameter_axis(parameter, lams, max(1, DIAGRAM_PARTICLES // orbits)),
            Axis("orbit", np.arange(orbits), "1", "number of the particle"),
            Axis("bounce", np.arange(points), "1", "number of the bounce, after the transient"),
        ),
        fields=against(parameter, DIAGRAM_FIELDS),
        task=diagram,
        seed=seed,
        scene=scene,
        settings={"bounces": diagram.bounces, "transient": transient, "blocks": BLOCKS} | fixed(parameter, lam),
        collisions=len(lams) * orbits * (diagram.bounces + transient + points),
        map=partial(map_of, scene, 0.5),
    )


KINDS = (*Kind, None)  # the number of each kind in the results; None for particles that settle on no attractor
ON = ("group",)  # after the parameter that varies
MEANINGS = ", ".join(f"{i} {kind.name.lower() if kind else 'unsettled'}" for i, kind in enumerate(KINDS))
EXPONENT_FIELDS = (
    Field("orbits", ON, "int32", "orbits", "orbits of the group, -1 where there is no such group"),
    Field("kind", ON, "int8", "1", f"what the orbits end on: {MEANINGS}"),
    Field("period", ON, "int32", "bounces", "period of a cycle, else 0"),
    Field("nu_plus", ON, "float64", "1/bounce", "larger exponent"),
    Field("nu_plus_error", ON, "float64", "1/bounce", "its standard error"),
    Field("nu_minus", ON, "float64", "1/bounce", "smaller exponent; nan at lam = 0, where it is minus infinity"),
    Field("nu_minus_error", ON, "float64", "1/bounce", "its standard error"),
    Field("total", ON, "float64", "1/bounce", "sum of both, the mean of log |det DT|"),
    Field("total_error", ON, "float64", "1/bounce", "its standard error"),
)


@dataclass(frozen=True)
class Surveys:
    """The task of a sweep over exponents: groups of orbits and their exponents, at one contraction or one shape."""

    scene: str
    orbits: int
    groups: int
    bounces: int
    transient: int
    parameter: str = "lam"
    lam: float = 1.0

    def __call__(self, part: SweepPart) -> dict[str, Array]:
        values = part.values[self.parameter][:1]
        lam = float(values[0]) if self.parameter == "lam" else self.lam
        ((scene, _, starts),) = spread_over(self.scene, self.parameter, values, lam, self.orbits, part.seed)
        survey = surveyed(map_of(scene, lam), starts, self.bounces, self.transient)
        rows = [numbers(group) for group in survey.groups[: self.groups]]
        none = {field.name: missing_value(field.dtype) for field in EXPONENT_FIELDS}
        rows += [none] * (self.groups - len(rows))
        return {field.name: np.array([[row[field.name] for row in rows]], field.dtype) for field in EXPONENT_FIELDS}


def numbers(group: Group) -> dict[str, float]:
    """The values of `EXPONENT_FIELDS` for one group."""
    found: dict[str, float] = {
        "orbits": group.members.size,
        "kind": KINDS.index(group.attractor.kind if group.attractor else None),
        "period": group.attractor.period if group.attractor else 0,
    }
    measured = group.measured
    for name, value in (("nu_plus", measured.upper), ("nu_minus", measured.lower), ("total", measured.total)):
        found[name], found[f"{name}_error"] = _pair(value)
    return found


def _pair(value: Estimate | None) -> tuple[float, float]:
    return (np.nan, np.nan) if value is None else (value.mean, value.error)


def exponents(
    scene: str,
    lams: Array,
    orbits: int = 100,
    groups: int = 6,
    bounces: int = 4096,
    transient: int = 2000,
    seed: int = 1,
    parameter: str = "lam",
    lam: float = 1.0,
) -> Sweep:
    """The sweep over `lams`, or over another `parameter` at a fixed `lam`; it keeps `groups` groups for each value.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.sweep import text_of
    >>> sweep = exponents(text_of(Scene("ellipse", a=2)), np.array([0.5]), orbits=8, groups=2, bounces=512)
    >>> found = sweep.task(sweep.part((0, 0)))
    >>> found["period"].tolist(), found["total"].round(12).tolist()  # period 2 and log(1/2)
    ([[2, -1]], [[-0.69314718056, nan]])
    """
    return Sweep(
        name="exponents",
        about=f"Lyapunov exponents against {said(parameter)}, from {orbits} random orbits each, by attractor",
        axes=(
            parameter_axis(parameter, lams, 1),
            Axis("group", np.arange(groups), "1", "attractors, from the one that most orbits reach on"),
        ),
        fields=against(parameter, EXPONENT_FIELDS),
        task=Surveys(scene, orbits, groups, bounces, transient, parameter, lam),
        seed=seed,
        scene=scene,
        settings={"orbits": orbits, "bounces": bounces, "transient": transient} | fixed(parameter, lam),
        collisions=len(lams) * orbits * (bounces + transient),
        map=partial(map_of, scene, 0.5),
    )
