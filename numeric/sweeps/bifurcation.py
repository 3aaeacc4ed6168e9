"""Bifurcation diagrams: where random balls are after a long time, against the contraction. Paper: section 6.6."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from numeric.sweeps.scenes import BLOCKS, map_of, measured, spread
from numeric.sweeps.sweep import Array, Axis, Field, Part, Sweep

BALLS = 2000  # of a task, about; a fraction of a second for some thousand bounces
POINT, ORBIT = ("lam", "orbit", "bounce"), ("lam", "orbit")
FIELDS = (
    Field("s", POINT, "float64", "length", "arc length of each bounce, as in the paper"),
    Field("phi", POINT, "float64", "rad", "exit angle of each bounce"),
    Field("theta", POINT, "float64", "rad", "boundary parameter of each bounce"),
    Field("component", POINT, "int8", "1", "component of the boundary"),
    Field("nu_plus", ORBIT, "float64", "1/bounce", "largest exponent of the orbit"),
    Field("nu_plus_error", ORBIT, "float64", "1/bounce", "its standard error, over blocks of the orbit"),
    Field("chaotic", ORBIT, "int8", "1", "1 where the exponent is positive beyond its error, else 0"),
)


@dataclass(frozen=True)
class Diagram:
    """The task: the orbits of a few contractions, on their attractors."""

    scene: str
    orbits: int
    points: int
    bounces: int
    transient: int

    def __call__(self, part: Part) -> dict[str, Array]:
        lams = part.values["lam"]
        map, starts = spread(self.scene, lams, self.orbits, part.seed)
        found = measured(map, starts, self.bounces, self.transient, threads=1)
        orbit = map.orbit(found.end.theta, found.end.phi, self.points, found.end.component, threads=1)
        s = map.arclength.s(orbit.theta, orbit.component)
        s = np.where(orbit.code == 0, s, np.nan)
        each = lams.size, self.orbits
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
) -> Sweep:
    """The sweep over `lams`: for each the last `points` bounces of `orbits` random balls. `s` is nan where one stopped.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.scenes import text_of
    >>> sweep = bifurcation(text_of(Scene("ellipse", a=2)), np.array([0.5]), orbits=3, points=4)
    >>> found = sweep.task(sweep.part((0, 0, 0)))
    >>> np.unique(found["theta"].round(6)).tolist()  # every ball ends on the minor axis
    [-1.570796, 1.570796]
    """
    diagram = Diagram(scene, orbits, points, bounces // BLOCKS * BLOCKS, transient)
    return Sweep(
        name="bifurcation",
        about=f"Attractors against the contraction, from {orbits} random balls each",
        axes=(
            Axis("lam", np.asarray(lams, dtype=np.float64), "1", "contraction", max(1, BALLS // orbits)),
            Axis("orbit", np.arange(orbits), "1", "number of the ball"),
            Axis("bounce", np.arange(points), "1", "number of the bounce, after the transient"),
        ),
        fields=FIELDS,
        task=diagram,
        seed=seed,
        scene=scene,
        settings={"bounces": diagram.bounces, "transient": transient, "blocks": BLOCKS},
        collisions=len(lams) * orbits * (diagram.bounces + transient + points),
        map=partial(map_of, scene, 0.5),
    )
