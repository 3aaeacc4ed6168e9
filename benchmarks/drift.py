"""Drift of the conserved product of angular momenta in the elastic ellipse: `python benchmarks/drift.py [COLLISIONS]`.

Over `n` collisions of many particles the mean change of `L1*L2` over `n` is the drift; a random walk shows in its
standard error. The product is formed in 80 bits from the kernel's state, so that only the map rounds.
"""

import sys

import numpy as np

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec

PARTICLES = 2048


def say(text):
    """Prints a line on standard output at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def product(map, rows):
    """The product `L1*L2` about the foci, of the exact particle whose rounded state is in the rows."""
    ux, uy, vx, vy = (row.astype(np.longdouble) for row in rows)
    size = np.hypot(ux, uy)
    ux, uy = ux / size, uy / size
    size = np.hypot(vx, vy)
    vx, vy = vx / size, vy / size
    a = np.longdouble(map.shape[0])
    x, y, c2 = a * ux, uy, a * a - 1
    L = x * vy - y * vx
    return L * L - c2 * vy * vy


def main(collisions):
    for a in ("3/2", "11/10", "3"):
        map = PinballMap("ellipse", lam=1, a=a)
        rng = np.random.default_rng(5)
        theta, phi = rng.uniform(-np.pi, np.pi, PARTICLES), np.arcsin(rng.uniform(-1, 1, PARTICLES) * 0.999)
        rows = map.states.enter(np.zeros(PARTICLES, dtype=int), theta, phi, map.law)
        lam = np.ones(PARTICLES)
        start = product(map, rows)
        result = map.engine.run(KernelSpec(map.law), rows, lam, map.shape, collisions)
        change = np.asarray(product(map, [result.rows[f] for f in map.family.fields(map.law)]) - start, dtype=float)
        mean, error = change.mean() / collisions, change.std(ddof=1) / np.sqrt(PARTICLES) / collisions
        walk = change.std() / np.sqrt(collisions)
        say(f"a = {a:<6} drift {mean:+.2e} +- {error:.1e} a collision; spread {walk:.2e} * sqrt(n)")


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000)
