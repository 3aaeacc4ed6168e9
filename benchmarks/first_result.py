"""Wall time of a whole process that computes one short orbit: warm, and with the kernel still to be compiled.

python benchmarks/first_result.py [RUNS]
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ORBITS = {
    "circle": 'PinballMap("circle", lam=0.95)',
    "ellipse": 'PinballMap("ellipse", lam=0.95, a="3/2")',
    "cardioid": 'PinballMap("cardioid", lam=0.95)',
    "cuspless": 'PinballMap("cuspless", lam=0.95)',
    "egg": 'PinballMap("egg", lam=0.95, alpha=0.08)',
}


def milliseconds(program, runs, folder, before=lambda: None):
    """The median over some runs."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PINBALL_CACHE"] = folder
    times = []
    for _ in range(runs + 1):
        before()
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", program], env=environment, check=True)
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times[1:])


def main(runs):
    with tempfile.TemporaryDirectory() as folder:

        def forget():
            for path in Path(folder).glob("kernel-*"):
                path.unlink()

        for name, program in (("interpreter", ""), ("import numpy", "import numpy")):
            sys.stdout.write(f"{name:<14}{milliseconds(program, runs, folder):6.0f} ms\n")
        for name, map in ORBITS.items():
            program = f"from numeric import PinballMap; {map}.orbit(0.3, 0.2, 10)"
            warm, cold = milliseconds(program, runs, folder), milliseconds(program, max(runs // 3, 3), folder, forget)
            sys.stdout.write(f"{name:<14}{warm:6.0f} ms warm {cold:6.0f} ms cold, kernel compiled, without SymPy\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 25)
