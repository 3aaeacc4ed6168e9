"""Many collisions on every table, none outside and none lost: `python benchmarks/soak.py [COLLISIONS]`."""

import sys
import time

import numpy as np

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec
from numeric.pinball.sampling import phase_starts
from verification.measure.work.bench import SCENES

PARTICLES, PART = 8192, 2000


def say(text):
    """Prints a line on standard output at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main(collisions, only):
    for name, shape in SCENES.items():
        if only not in ("", name):
            continue
        for lam in (0.95, 1):
            map = PinballMap(name, lam=lam, **shape)
            component, theta, phi = phase_starts(map, PARTICLES, seed=3)[:3]
            fields = map.family.fields(map.law)
            rows = map.states.enter(component, theta, phi, map.law)
            began, lost, off = time.perf_counter(), {}, 0.0
            for _ in range(max(1, round(collisions / PARTICLES / PART))):
                result = map.engine.run(KernelSpec(map.law), rows, np.full(PARTICLES, float(lam)), map.shape, PART)
                rows = [np.ascontiguousarray(result.rows[field]) for field in fields]
                for row in rows:
                    off = max(off, float(np.max(np.abs(row))) if np.all(np.isfinite(row)) else np.inf)
                if "code" in result.rows:
                    codes = result.rows["code"].astype(int)
                    for code in set(codes[codes > 0].tolist()):
                        lost[code] = lost.get(code, 0) + int(np.sum(codes == code))
                    again = codes > 0  # a particle that stopped starts anew
                    fresh = map.states.enter(*phase_starts(map, PARTICLES, seed=len(lost))[:3], map.law)
                    rows = [np.where(again, new, old) for new, old in zip(fresh, rows, strict=True)]
            component, theta = map.states.place(rows)
            x, y = map.states.point(component, theta)
            inside = bool(np.all(np.isfinite(x) & np.isfinite(y)))
            seconds = time.perf_counter() - began
            say(f"{name:<9} lam = {lam:<5} finite {inside}, largest {off:.17g}, stopped {lost}, {seconds:.0f} s")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 1e9, sys.argv[2] if len(sys.argv) > 2 else "")
