"""Lyapunov exponents against the contraction, by attractor. Paper: sections 4.1 and 5.3, figures of exponents.

Orbits that share an attractor make a group, and groups are never averaged together. The groups of one `lam` are
numbered from the one with the most orbits on; the same number at two contractions need not be the same branch.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from numeric.dynamics.exponents import Group, surveyed
from numeric.dynamics.kinds import Kind
from numeric.dynamics.statistics import Estimate
from numeric.sweeps.scenes import map_of, spread
from numeric.sweeps.sweep import Array, Axis, Field, Part, Sweep

KINDS = (*Kind, None)  # the number of each kind in the results; None for balls that settle on no attractor
ON = ("lam", "group")
MEANINGS = ", ".join(f"{i} {kind.name.lower() if kind else 'unsettled'}" for i, kind in enumerate(KINDS))
FIELDS = (
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
    """The task: the groups of one contraction."""

    scene: str
    orbits: int
    groups: int
    bounces: int
    transient: int

    def __call__(self, part: Part) -> dict[str, Array]:
        lam = float(part.values["lam"][0])
        _, starts = spread(self.scene, np.array([lam]), self.orbits, part.seed)
        survey = surveyed(map_of(self.scene, lam), starts, self.bounces, self.transient)
        rows = [numbers(group) for group in survey.groups[: self.groups]]
        none: dict[str, float] = {field.name: -1 if field.dtype.startswith("int") else np.nan for field in FIELDS}
        rows += [none] * (self.groups - len(rows))
        return {field.name: np.array([[row[field.name] for row in rows]], field.dtype) for field in FIELDS}


def numbers(group: Group) -> dict[str, float]:
    """The fields of one group."""
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
) -> Sweep:
    """The sweep over `lams`, with as many `groups` as are kept for each.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.scenes import text_of
    >>> sweep = exponents(text_of(Scene("ellipse", a=2)), np.array([0.5]), orbits=8, groups=2, bounces=512)
    >>> found = sweep.task(sweep.part((0, 0)))
    >>> found["period"].tolist(), found["total"].round(12).tolist()  # period 2 and log(1/2)
    ([[2, -1]], [[-0.69314718056, nan]])
    """
    return Sweep(
        name="exponents",
        about=f"Lyapunov exponents against the contraction, from {orbits} random orbits each, by attractor",
        axes=(
            Axis("lam", np.asarray(lams, dtype=np.float64), "1", "contraction", 1),
            Axis("group", np.arange(groups), "1", "attractors, from the one that most orbits reach on"),
        ),
        fields=FIELDS,
        task=Surveys(scene, orbits, groups, bounces, transient),
        seed=seed,
        scene=scene,
        settings={"orbits": orbits, "bounces": bounces, "transient": transient},
        collisions=len(lams) * orbits * (bounces + transient),
        map=partial(map_of, scene, 0.5),
    )
