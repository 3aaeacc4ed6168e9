"""Where in its parameter space the egg is chaotic. Paper: section 6.5, figure of parameter space.

From each pair `(alpha, lam)` random balls are started as in the paper's appendix, and those are counted whose exponent
is positive beyond its error (`numeric.sweeps.scenes`). The curve on top of the figure is the doubling of period 2.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np

from numeric.sweeps.scenes import BLOCKS, map_of, measured, spread, text_of
from numeric.sweeps.sweep import Array, Axis, Field, Part, Sweep
from symbolic.tables.scene import Scene

BALLS = 20_000  # of a task, at most; what a core does in a second or less

FIELDS = (
    Field("chaotic", ("alpha", "lam"), "int32", "orbits", "orbits whose largest exponent is positive beyond its error"),
    Field(
        "regular",
        ("alpha", "lam"),
        "int32",
        "orbits",
        "orbits whose largest exponent is not positive; the rest is undecided or stopped",
    ),
    Field("nu_max", ("alpha", "lam"), "float64", "1/bounce", "largest nu_plus of all orbits"),
    Field("nu_max_error", ("alpha", "lam"), "float64", "1/bounce", "its standard error, over blocks of the orbit"),
    Field("nu_min", ("alpha", "lam"), "float64", "1/bounce", "smallest nu_plus of all orbits"),
)


@dataclass(frozen=True)
class Pairs:
    """The task: all orbits of a range of `lam` at a few `alpha`."""

    K: int
    starts: int
    bounces: int
    transient: int

    def __call__(self, part: Part) -> dict[str, Array]:
        rng = np.random.default_rng(part.seed)
        seeds = rng.integers(0, 2**63, part.values["alpha"].size)
        rows = [
            self.row(float(a), part.values["lam"], int(s)) for a, s in zip(part.values["alpha"], seeds, strict=True)
        ]
        return {field.name: np.array([row[field.name] for row in rows]) for field in FIELDS}

    def row(self, alpha: float, lams: Array, seed: int) -> dict[str, Array]:
        """The fields for one shape."""
        map, starts = spread(egg(self.K, alpha), lams, self.starts, seed)
        found = measured(map, starts, self.bounces, self.transient, threads=1)
        nu, error, chaotic, regular = (
            x.reshape(lams.size, self.starts)
            for x in (found.nu_plus, found.nu_plus_error, found.chaotic, found.regular)
        )
        best = np.argmax(nu, axis=1)[:, None]
        return {
            "chaotic": chaotic.sum(axis=1),
            "regular": regular.sum(axis=1),
            "nu_max": np.take_along_axis(nu, best, 1)[:, 0],
            "nu_max_error": np.take_along_axis(error, best, 1)[:, 0],
            "nu_min": nu.min(axis=1),
        }


def egg(K: int, alpha: float) -> str:
    """The scene of one shape, the decimal that `alpha` shows."""
    return text_of(Scene("egg", alpha=Fraction(repr(float(alpha))), K=K))


def parameter_space(
    alphas: Array, lams: Array, starts: int = 100, bounces: int = 2000, transient: int = 2000, K: int = 3, seed: int = 1
) -> Sweep:
    """The sweep over all pairs.

    >>> sweep = parameter_space(np.array([0.02, 0.09]), np.array([0.1, 0.3]), starts=3)
    >>> sweep.task(sweep.part((1, 0)))["chaotic"].tolist()
    [[0, 3]]
    """
    pairs = Pairs(K, starts, bounces // BLOCKS * BLOCKS, transient)
    return Sweep(
        name="parameter-space",
        about=f"Chaos or none in the {K}-pointed egg, from {starts} random orbits for each pair",
        axes=(
            Axis("alpha", np.asarray(alphas, dtype=np.float64), "1", "shape of the egg", 1),
            Axis("lam", np.asarray(lams, dtype=np.float64), "1", "contraction", max(1, BALLS // starts)),
        ),
        fields=FIELDS,
        task=pairs,
        seed=seed,
        scene=f"egg, K = {K}",
        settings={"starts": starts, "bounces": pairs.bounces, "transient": transient, "blocks": BLOCKS},
        collisions=len(alphas) * len(lams) * starts * (pairs.bounces + transient),
        map=partial(map_of, egg(K, 0.08 * 10 / (1 + K * K)), 0.5),
    )
