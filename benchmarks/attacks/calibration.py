"""How often error bars hold the truth, in cases where it is known: a subject of `benchmarks/torture.py`.

95 per cent intervals have to hold it in 93 to 97 of 100; those of a cycle or of a polygon, which are exact, always.
"""

import math
from typing import Any

from attacks.outcome import Outcome

SLAP_EXPONENT = 0.368340799475763256  # of the cardioid, proved in balls: docs/exponents.md


def intervals(seeds: int, seed: int = 1) -> Outcome:
    """95 per cent intervals of the cardioid's slap exponent, from 4 orbits each, against the value proved in balls.

    Failed are those beyond what 93 to 97 of 100 allow.
    """
    import numpy as np

    from numeric import PinballMap
    from numeric.dynamics.exponents import Count
    from numeric.dynamics.statistics import estimate
    from numeric.pinball.sampling import Growth, interior_starts

    truth, map = SLAP_EXPONENT, PinballMap("cardioid", lam=0)
    said, failed = [], 0
    for bounces in (256, 1024, 4096):
        starts = interior_starts(map, 4 * seeds, seed=seed + bounces)
        growth = Growth(map, starts.theta, 0 * starts.phi, starts.component)
        growth.skip(1000)
        count = Count(growth)
        for _ in count.until(bounces):
            pass
        found = [estimate(part) for part in np.split(count.up, seeds, axis=1)]
        held = sum(abs(each.mean - truth) <= each.interval for each in found)
        said.append(f"{100 * held / seeds:.1f} of 100 at {bounces} bounces")
        failed += allowed(held, seeds)
    return Outcome(3 * seeds, failed, f"{', '.join(said)}; the value is {truth:.8f}")


def allowed(held: int, seeds: int) -> int:
    """How many seeds are beyond what 93 to 97 of 100 allow."""
    return max(0, int(0.93 * seeds) - held, held - int(0.97 * seeds + 1))


def shares(seeds: int, starts: int = 400, seed: int = 1) -> Outcome:
    """Wilson's intervals for the basin of one of the egg's two triangles among those that end on either.

    The triangles are mirror images, and so are their basins: the share is one half.
    """
    import numpy as np

    from numeric import PinballMap
    from numeric.dynamics.attractors import find, wilson
    from numeric.dynamics.basins import labels, random_points, starts_at, whole

    map = PinballMap("egg", alpha="2/25", lam="1/2")
    attractors = find(map, 200, 1)
    pair = [i for i, each in enumerate(attractors) if each.period == 3]
    if len(pair) != 2:
        raise ValueError(f"{len(pair)} triangles attract, where two mirror images do")
    window, held = whole(map), 0
    for k in range(seeds):
        s, height = random_points(window, starts, np.random.default_rng([seed, k]))
        label = labels(map, starts_at(map, s, height), attractors)
        one, other = (int(np.sum(label == i)) for i in pair)
        found = wilson(one, one + other)
        held += found.low <= 0.5 <= found.high
    return Outcome(seeds, allowed(held, seeds), f"{100 * held / seeds:.1f} of 100 hold one half")


RATIO = 1.35  # of the frequencies of a graph; near 1 leaves a pure power law
FINEST = 1e-12


def fractal_fates(roughness: float, distances: Any, starts: int, seed: int) -> Any:
    """Which pairs of points lie on different sides of a graph of dimension `2 - roughness`; distances along the rows.

    The graph is Weierstrass's sum of sines of random phase, cut off below all distances.
    """
    import numpy as np

    rng = np.random.default_rng(seed)
    order = np.arange(int(np.log(1 / FINEST) / np.log(RATIO)))
    frequency, size, phase = RATIO**order, RATIO ** (-roughness * order), rng.uniform(0, 2 * np.pi, order.size)
    wide = np.sqrt(2 * np.sum(size**2))  # twice the standard deviation
    x, y, turn = (rng.uniform(low, high, starts) for low, high in ((0, 20 * np.pi), (-wide, wide), (0, 2 * np.pi)))

    def below(x: Any, y: Any) -> Any:
        return y < np.sin(x[:, None] * frequency + phase) @ size

    here = below(x, y)
    return np.array([below(x + eps * np.cos(turn), y + eps * np.sin(turn)) != here for eps in distances])


def dimensions(seeds: int, starts: int = 3000, seed: int = 1) -> Outcome:
    """The dimension of random graphs of dimension 1.75 and 1.5, from pairs of points at seven distances."""
    import numpy as np

    from numeric.dynamics.statistics import fitted

    distances, said, failed = 10.0 ** -np.arange(2, 5.5, 0.5), [], 0
    for roughness in (0.25, 0.5):
        held = 0
        for k in range(seeds):
            different = fractal_fates(roughness, distances, starts, seed + k)
            found = fitted(distances, different, np.random.default_rng([seed, k]))
            held += bool(abs(found.dimension - (2 - roughness)) <= 1.96 * found.error)
        said.append(f"{100 * held / seeds:.1f} of 100 at {2 - roughness}")
        failed += allowed(held, seeds)
    return Outcome(2 * seeds, failed, ", ".join(said))


def known(seeds: int, seed: int = 1, bounces: int = 256) -> Outcome:
    """Exponents that follow from the table: on the ellipse's minor axis, in the elastic circle, in polygons.

    On the axis `det DT**2 = lam**2` and the multipliers are complex or, here, equal in modulus; in a polygon `lam` is
    an eigenvalue of each bounce. Nothing is left to chance there, and all intervals hold; in the elastic circle vectors
    grow like the time, and what is left of 0 has to lie in the error.
    """
    from numeric import PinballMap
    from numeric.dynamics.account import account
    from numeric.dynamics.exponents import surveyed
    from numeric.pinball.sampling import interior_starts
    from symbolic import tables

    half = math.log(0.5)
    scenes: tuple[tuple[str, Any, dict[str, float]], ...] = (
        ("ellipse", PinballMap("ellipse", a="3/2", lam="1/2"), {"nu_plus": half / 2, "nu_minus": half / 2}),
        ("elastic circle", PinballMap("circle", lam=1), {"nu_plus": 0.0, "nu_minus": 0.0}),
        ("square", PinballMap(tables.square(), lam="1/2"), {"nu_minus": half}),
        ("triangle", PinballMap(tables.triangle(), lam="3/10"), {"nu_minus": math.log(0.3)}),
    )
    said, failed = [], 0
    for name, map, truth in scenes:
        held = 0
        for k in range(seeds):
            starts = interior_starts(map, 4, seed=seed + k)
            found = account(map, surveyed(map, starts, bounces, 1000))["groups"][0]
            near = [abs(found[word] - value) <= 1.96 * found[f"{word}_stderr"] + 1e-12 for word, value in truth.items()]
            held += all(near)
        said.append(f"{100 * held / seeds:.1f} of 100 in the {name}")
        failed += seeds - held
    return Outcome(len(scenes) * seeds, failed, ", ".join(said))
