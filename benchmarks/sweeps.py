"""Two sweeps against the kernel alone, for as many bounces with exponents: seconds of both on all cores, and the ratio.

    python benchmarks/sweeps.py [--quick]
    python benchmarks/sweeps.py --workers 4 8 16   # what it costs to keep so many busy

The sweeps are the paper's parameter space at 100 x 100 pairs with 100 starts of 2000 bounces, and a picture of
1000 x 1000 basins of the cuspless table at lam = 0.09. Sweep and kernel take turns, so that both meet the same machine.
With `--workers` tasks only wait, for a second each, so that more workers than cores are asked too.
"""

import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from numeric.dynamics.basins import starts_at
from numeric.kernels.machine import KernelSpec, starting
from numeric.sweeps.fields import basins
from numeric.sweeps.run import on_threads
from numeric.sweeps.space import egg, parameter_space
from numeric.sweeps.sweep import map_of, spread, text_of
from numeric.sweeps.workers import cores
from symbolic import Scene
from verification.measure.work.scaling import waiting_rows

TURNS = 10


def parameter_space_of(pairs, starts=100, bounces=2000):
    """The sweep, and what makes the particles of a part of it."""
    grid = np.linspace(0, 1, pairs)
    sweep = parameter_space(grid.round(9) / 10, grid, starts, bounces, transient=0)

    def particles(part):
        return spread(egg(3, part.values["alpha"][0]), part.values["lam"], starts, part.seed)

    return sweep, particles, bounces


def basins_of(cells, transient=1000):
    """The sweep, and what makes the particles of a part of it."""
    text = text_of(Scene("cuspless"))
    sweep = basins(text, 0.09, cells, cells, transient=transient)

    def particles(part):
        columns, rows = part.values["s"], part.values["sin_phi"]
        map = map_of(text, 0.09)
        return map, starts_at(map, np.tile(columns, rows.size), np.repeat(rows, columns.size))

    return sweep, particles, transient


def kernel(map, particles, bounces):
    """A call that runs the compiled loop on these particles, and does nothing else."""
    own = map.states.enter(particles.component, particles.theta, particles.phi, "pinball")
    one = np.ones(particles.theta.size)
    lam = np.broadcast_to(map.lam, one.shape).astype(float)
    question = KernelSpec("pinball", exponents=True)
    return lambda: map.engine.run(question, own, lam, map.shape, bounces, starting(one, 0 * one, one), 1)


def seconds(action):
    begun = time.perf_counter()
    action()
    return time.perf_counter() - begun


def ratio(name, sweep, particles, bounces):
    whole, bare, workers = 0.0, 0.0, cores()
    next(iter(on_threads(sweep, sweep.indices()[:1], 1)))  # compiles
    for turn in range(TURNS):
        indices = sweep.indices()[turn::TURNS]
        calls = [kernel(*particles(sweep.part(at)), bounces) for at in indices]
        whole += seconds(lambda indices=indices: list(on_threads(sweep, indices, workers)))
        with ThreadPoolExecutor(workers) as pool:
            bare += seconds(lambda pool=pool, calls=calls: list(pool.map(lambda call: call(), calls)))
    sys.stdout.write(
        f"{name:<16}{sweep.collisions:.2g} bounces on {workers} cores: {whole:6.2f} s, "
        f"the kernel alone {bare:6.2f} s, ratio {whole / bare:.2f}\n"
    )


def main(arguments):
    if "--workers" in arguments:
        for row in (row for workers in map(int, arguments[1:]) for row in waiting_rows(workers)):
            sys.stdout.write(f"{row.call:<56}{row.seconds:.3f} s, efficiency {100 / row.ratio:.1f} %\n")
        return
    quick = "--quick" in arguments
    ratio("parameter space", *parameter_space_of(20 if quick else 100))
    ratio("basins", *basins_of(400 if quick else 1000))


if __name__ == "__main__":
    main(sys.argv[1:])
