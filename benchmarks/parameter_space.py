"""Chaos in the egg below alpha = 0.06, where the paper found none: a fine search, and long runs at what it finds.

python benchmarks/parameter_space.py [--quick]

The search takes random balls at closely spaced contractions, along the doubling of period 2 and beyond, also close to
lam = 1, where transients are long. What it finds is then followed for many bounces, and counts when every orbit that
was chaotic still is. A sample proves nothing; the error bars are those of the mean over orbits.
"""

import sys

import numpy as np

from numeric.sampling import interior_starts
from verification.sweeps.parameter_space import egg, parameter_space
from verification.sweeps.run import run
from verification.sweeps.scenes import map_of
from verification.sweeps.signs import measured

SHAPES = np.round(np.arange(0.030, 0.0600, 0.001), 6)
NEAR_ONE = np.array([0.0555, 0.056, 0.057, 0.058, 0.059])
BALLS, BOUNCES, SEED = 2000, 10**8, 3
TRANSIENT = 200_000


def search(shapes, lams, starts, bounces, transient):
    """The pairs at which some ball is chaotic: shape, contraction, how many of the balls."""
    found = run(parameter_space(shapes, lams, starts, bounces, transient, seed=SEED)).chaotic
    return [(float(shapes[i]), float(lams[j]), int(found.values[i, j])) for i, j in np.argwhere(found.values > 0)]


def follow(shape, lam):
    """The share of random balls that are chaotic, how many of those still are after a long run, and their exponent."""
    map = map_of(egg(3, shape), lam)
    first = measured(map, interior_starts(map, BALLS, SEED), 4000, TRANSIENT)
    on = np.nonzero(first.chaotic)[0]
    if on.size == 0:
        return None
    last = measured(map, first.ended(on), max(4000, BOUNCES // on.size), 0)
    nu = last.nu_plus[last.chaotic]
    error = np.std(nu) / np.sqrt(nu.size) if nu.size else np.nan
    return on.size / BALLS, int(np.sum(last.chaotic)), on.size, np.mean(nu) if nu.size else np.nan, error


def reported(pairs):
    """One line for each shape, at the contraction where most balls were chaotic."""
    for shape in sorted({pair[0] for pair in pairs}):
        here = [pair for pair in pairs if pair[0] == shape]
        lam = max(here, key=lambda pair: pair[2])[1]
        found = follow(shape, lam)
        lams = f"{here[0][1]:g} to {here[-1][1]:g}" if len(here) > 1 else f"{lam:g}"
        said = "all of it transient"
        if found is not None:
            share, still, of, nu, error = found
            said = f"{share:.2%} of {BALLS} balls, {still} of {of} still chaotic after {BOUNCES:.0e} bounces in all"
            said += f", nu_+ = {nu:.5f} +- {error:.0e}"
        sys.stdout.write(f"alpha = {shape:<7g} chaos at {len(here)} lam, {lams}; at {lam:g}: {said}\n")
        sys.stdout.flush()


def main(arguments):
    quick = "--quick" in arguments
    step = 0.005 if quick else 0.0005
    reported(search(SHAPES[::5] if quick else SHAPES, np.round(np.arange(0.3, 0.96, step), 6), 60, 1500, 4000))
    close = np.round(1 - np.geomspace(0.04, 1e-3, 10 if quick else 80), 6)
    sys.stdout.write("close to lam = 1:\n")
    reported(search(NEAR_ONE[:1] if quick else NEAR_ONE, close, 40, 4000, TRANSIENT))


if __name__ == "__main__":
    main(sys.argv[1:])
