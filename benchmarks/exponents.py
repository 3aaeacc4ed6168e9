"""What both Lyapunov exponents add to the time of a bounce, on one core: medians of three, each the fastest of seven.

python benchmarks/exponents.py [SCENE ...]
"""

import sys

import numpy as np

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, starting
from verification.measure.work.bench import LAWS, PARTICLES, SCENES, attracted, best

BOUNCES = 1000


def main(names):
    for name in names:
        map = PinballMap(name, lam=LAWS["pinball"], **SCENES[name])
        own, lam, one = attracted(map, PARTICLES), np.full(PARTICLES, float(map.lam)), np.ones(PARTICLES)

        def nanoseconds(question, tangent=(), map=map, own=own, lam=lam):
            def once():
                return map.engine.run(question, own, lam, map.shape, BOUNCES, tangent, 1)

            once()
            return best(once, 7) / BOUNCES / PARTICLES * 1e9

        pairs = [
            (
                nanoseconds(KernelSpec(map.law)),
                nanoseconds(KernelSpec(map.law, exponents=True), starting(one, 0 * one, one)),
            )
            for _ in range(3)
        ]
        bare, whole = sorted(pairs, key=lambda pair: pair[1] / pair[0])[1]
        sys.stdout.write(f"{name:<10}{bare:7.3f} ns, with exponents {whole:7.3f} ns: {whole / bare - 1:+.0%}\n")


if __name__ == "__main__":
    main(sys.argv[1:] or SCENES)
