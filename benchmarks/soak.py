"""Many collisions on every table, none outside and none lost: `python benchmarks/soak.py [COLLISIONS [TABLE]]`."""

import sys
import time
from collections import Counter

import numpy as np

from numeric.kernels.machine import KernelSpec
from numeric.pinball.sampling import phase_starts
from verification.measure.extremes.orbits import SCENES, scene

PARTICLES, PART = 8192, 2000


def main(collisions, only):
    for name in (name for name in SCENES if only in ("", name)):
        for lam in (0.95, 1):
            map, began, lost, off = scene(name, lam), time.perf_counter(), Counter(), 0.0
            rows = map.states.enter(*phase_starts(map, PARTICLES, seed=3)[:3], map.law)
            for _ in range(max(1, round(collisions / PARTICLES / PART))):
                result = map.engine.run(KernelSpec(map.law), rows, np.full(PARTICLES, float(lam)), map.shape, PART)
                rows = [np.ascontiguousarray(result.rows[field]) for field in map.family.fields(map.law)]
                off = max(off, *(float(np.max(np.abs(row))) if np.all(np.isfinite(row)) else np.inf for row in rows))
                if "code" in result.rows:  # a particle that stopped starts anew
                    codes = result.rows["code"].astype(int)
                    lost.update(codes[codes > 0].tolist())
                    fresh = map.states.enter(*phase_starts(map, PARTICLES, seed=len(lost))[:3], map.law)
                    rows = [np.where(codes > 0, new, old) for new, old in zip(fresh, rows, strict=True)]
            inside = bool(np.all(np.isfinite(map.states.point(*map.states.place(rows)))))
            seconds = time.perf_counter() - began
            sys.stdout.write(
                f"{name:<9} lam = {lam:<5} finite {inside}, largest {off:.17g}, stopped {dict(lost)}, {seconds:.0f} s\n"
            )
            sys.stdout.flush()


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 1e9, sys.argv[2] if len(sys.argv) > 2 else "")
