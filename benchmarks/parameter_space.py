"""A search for chaos in the egg below alpha = 0.06, where the paper found none, with long runs where it finds any.

python benchmarks/parameter_space.py [--quick]

The search takes particles at closely spaced contractions, along the doubling of period 2 and beyond, ten times as
closely where the strips of chaos are narrow, and also close to lam = 1, where transients are long. What it finds is
then followed for many bounces, and counts when every orbit that was chaotic still is. A sample proves nothing; the
error bars are those of the mean over orbits.
"""

import sys

import numpy as np

from numeric.pinball.sampling import interior_starts
from numeric.sweeps.run import run
from numeric.sweeps.space import egg, parameter_space
from numeric.sweeps.sweep import map_of, measured

WIDE = np.round(np.arange(0.051, 0.0600, 0.001), 6), np.round(np.arange(0.3, 0.96, 5e-4), 6)
NARROW = np.round(np.arange(0.030, 0.0505, 0.001), 6), np.round(np.arange(0.8, 0.99, 5e-5), 6)
NEAR_ONE = np.array([0.0555, 0.056, 0.057, 0.058, 0.059])
PARTICLES, BOUNCES, SEED = 2000, 10**8, 3
TRANSIENT = 200_000


def search(shape, lams, starts, bounces, transient):
    """The contractions at which some particle is chaotic, and the number of such particles."""
    found = run(parameter_space(np.array([shape]), lams, starts, bounces, transient, seed=SEED)).chaotic.values[0]
    return {float(lams[j]): int(found[j]) for j in np.nonzero(found)[0]}


def follow(shape, lam, transient):
    """The share of chaotic particles, the share that stays chaotic in a long run, and their exponent."""
    map = map_of(egg(3, shape), lam)
    first = measured(map, interior_starts(map, PARTICLES, SEED), 4000, transient)
    on = np.nonzero(first.chaotic)[0]
    if on.size == 0:
        return "all of it transient"
    last = measured(map, first.ended(on), max(4000, BOUNCES // on.size), 0)
    nu = last.nu_plus[last.chaotic]
    said = f"{on.size / PARTICLES:.2%} of {PARTICLES}, {nu.size} of {on.size} still chaotic after {BOUNCES:.0e} bounces"
    return said + (f", nu_+ = {np.mean(nu):.5f} +- {np.std(nu) / np.sqrt(nu.size):.0e}" if nu.size else "")


def reported(shape, lams, starts, bounces, transient):
    """The line for a shape, at the contraction with the most chaotic particles."""
    found = search(shape, lams, starts, bounces, transient)
    said = "none"
    if found:
        lam = max(found, key=found.get)
        said = f"at {len(found)} of {lams.size} lam, {min(found):g} to {max(found):g}; at {lam:g} "
        said += follow(shape, lam, max(transient, 20_000))
    sys.stdout.write(f"alpha = {shape:<7g} chaos: {said}\n")
    sys.stdout.flush()


def main(arguments):
    quick = "--quick" in arguments
    for shapes, lams in [(WIDE[0][-2:-1], WIDE[1][800:840])] if quick else (WIDE, NARROW):
        for shape in shapes[::-1]:
            reported(float(shape), lams, 60, 1500, 4000)
    sys.stdout.write("close to lam = 1:\n")
    close = np.round(1 - np.geomspace(0.04, 1e-3, 8 if quick else 80), 6)
    for shape in NEAR_ONE[:1] if quick else NEAR_ONE:
        reported(float(shape), close, 40, 4000, TRANSIENT)


if __name__ == "__main__":
    main(sys.argv[1:])
