"""Error bars of Lyapunov exponents, tested: how often 95 per cent intervals hold the truth, and against the usual way.

python benchmarks/error_bars.py [REPEATS]

Each scene is run many times with a few orbits; the truth is one long run. The usual way takes the standard deviation of
the growth of single bounces over the square root of their number, as if they were independent.
"""

import sys

import numpy as np

from numeric import PinballMap
from numeric.dynamics.exponents import Count
from numeric.dynamics.statistics import estimate
from numeric.pinball.sampling import Growth, interior_starts

SCENES = (
    ("cardioid", {}, "0"),
    ("cardioid", {}, "0.5"),
    ("cardioid", {}, "1"),
    ("cuspless", {}, "0.1"),
    ("cuspless", {}, "0.5"),
    ("cuspless", {}, "1"),
    ("egg", {"alpha": "0.08"}, "0.6"),
)
ORBITS, EARLY = 4, 1000
LENGTHS = (256, 1024, 4096)
CATCHES = 0.0  # an orbit with nu_plus below this is on a cycle, and not on the chaotic attractor


def say(text):
    """A line on standard output, at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def chaotic(map, count):
    """Particles on the chaotic attractor, their vectors aligned."""
    start = interior_starts(map, 2 * count, seed=5)
    phi = start.phi if map.law != "slap" else 0 * start.phi
    end = map.exponents(start.theta, phi, EARLY, EARLY, start.component)
    stay = np.nonzero((end.nu_plus > CATCHES) & (end.code == 0))[0][:count]
    growth = Growth(map, end.theta[stay], end.phi[stay], end.component[stay])
    growth.advance(100)
    return growth


def truth(map):
    """The exponent from 4000 particles of 16000 bounces, and its error."""
    growth = chaotic(map, 4000)
    count = Count(growth, most=64)
    for _ in count.until(16_000):
        pass
    found = estimate(count.up)
    return found.mean, found.error


def usual(growth, bounces=200):
    """The standard deviation of the growth of single bounces."""
    track = [growth.stretch]
    for _ in range(bounces):
        growth.advance(1)
        track.append(growth.stretch)
    return float(np.std(np.diff(track, axis=0)))


def main(repeats):
    say(f"{repeats} repeats of {ORBITS} orbits; coverage of 95% intervals")
    say("scene              bounces   scatter  our error  coverage   usual error  coverage  usual/true")
    for name, shape, lam in SCENES:
        map = PinballMap(name, lam=lam, **shape)
        value, error = truth(map)
        single = usual(chaotic(map, 400))
        growth = chaotic(map, repeats * ORBITS)
        for bounces in LENGTHS:
            count = Count(growth)
            for _ in count.until(bounces):
                pass
            found = [estimate(part) for part in np.split(count.up, repeats, axis=1)]
            off = np.array([x.mean for x in found]) - value
            ours, halves = np.array([x.error for x in found]), np.array([x.interval for x in found])
            naive = single / np.sqrt(bounces * ORBITS)
            say(
                f"{name:<9} at {lam:<5}{bounces:>9}{np.std(off):>10.1e}{np.mean(ours):>11.1e}"
                f"{np.mean(np.abs(off) < np.hypot(halves, error)):>10.1%}{naive:>14.1e}"
                f"{np.mean(np.abs(off) < 1.96 * naive):>10.1%}{naive / np.std(off):>12.2f}"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 400)
