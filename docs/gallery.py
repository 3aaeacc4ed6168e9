"""Draws the tables of docs/tables.md, each with an orbit and with its phase space: `python docs/gallery.py`.

`python docs/gallery.py times` prints what a bounce costs on each of them.

The lines are grey and blue on no background, so that the picture does in light and in dark.
"""

import sys
import time
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("svg")
matplotlib.rcParams |= {"svg.hashsalt": "tables", "svg.fonttype": "none"}  # the same bytes each time; text as text
from matplotlib import pyplot as plt  # noqa: E402  (after the backend)

from numeric import PinballMap, phase_starts  # noqa: E402
from numeric.kernels.machine import KernelSpec  # noqa: E402
from symbolic import tables  # noqa: E402

PICTURE = Path(__file__).parent / "figures" / "tables.svg"
GREY, BLUE = "#7d8590", "#2f81f7"
PEBBLE = [("1.5", "0"), ("1.2", "0.61"), ("0.31", "0.98"), ("-0.73", "0.87"), ("-1.4", "0.33"),
          ("-1.41", "-0.3"), ("-0.7", "-0.9"), ("0.3", "-1"), ("1.23", "-0.58")]  # fmt: skip
SCENES = [
    (tables.square(), "0.8"),
    (tables.triangle(), "0.3"),
    (tables.stadium(), "0.9"),
    (tables.mushroom(), "0.95"),
    (tables.sinai(), "0.9"),
    (tables.diamond(), "0.9"),
    (tables.semi_ellipse(), "0.8"),
    (tables.polar("1 + cos(5*theta)/4", "star"), "0.9"),
    (tables.from_points(PEBBLE, "pebble"), "0.9"),
]


def drawn() -> None:
    """Writes the picture."""
    figure, axes = plt.subplots(6, 3, figsize=(9, 13), height_ratios=[2, 1] * 3)
    for k, (table, lam) in enumerate(SCENES):
        place, phase = axes[2 * (k // 3), k % 3], axes[2 * (k // 3) + 1, k % 3]
        map = PinballMap(table, lam=lam)
        for index, (low, high) in enumerate(map.states.ends):
            theta = np.linspace(low, high, 40 if len(map.states.ends) > 1 else 160)
            x, y, *_ = map.states.boundary.curve(np.full(theta.shape, index), theta)
            place.plot(x, y, color=GREY, lw=1.4)
        low, high = map.states.ends[0]
        orbit = map.orbit(low + 0.37 * (high - low), 0.4, 160)
        going = orbit.code == 0
        place.plot(orbit.x[going][:40], orbit.y[going][:40], color=BLUE, lw=0.5)
        place.set_aspect("equal")
        place.axis("off")
        place.set_title(f"{table.name}, lam = {lam}", color=GREY, fontsize=10)
        s = map.arclength.s(orbit.theta[going], orbit.component[going])
        phase.plot(s[20:], orbit.phi[going][20:], ".", color=BLUE, ms=2)
        phase.set_xlabel("s", color=GREY, fontsize=8)
        phase.set_ylabel("phi", color=GREY, fontsize=8)
        phase.tick_params(colors=GREY, labelsize=7)
        for side in phase.spines.values():
            side.set_color(GREY)
    figure.tight_layout()
    figure.savefig(PICTURE, transparent=True, metadata={"Date": None})
    plt.close(figure)


def timed(runs: int = 30) -> None:
    """Nanoseconds a bounce, without exponents: the best of many runs, by turns in one process on one core."""
    egg = PinballMap("egg", alpha="2/25", lam="0.95")
    hundred = tables.regular(100)
    maps = {"egg": egg} | {table.name: PinballMap(table, lam="0.95") for table in [*(t for t, _ in SCENES), hundred]}
    bounces, best, own = 200, dict.fromkeys(maps, np.inf), {}
    for name, map in maps.items():
        starts = phase_starts(map, 2048, seed=1)
        own[name] = map.states.enter(starts.component, starts.theta, 0.9 * starts.phi, map.law)
    for _ in range(runs):
        for name, map in maps.items():
            lam = np.full(own[name][0].size, 0.95)
            began = time.process_time()
            map.engine.run(KernelSpec(map.law), own[name], lam, map.shape, bounces, threads=1)
            best[name] = min(best[name], (time.process_time() - began) / (lam.size * bounces) * 1e9)
    for name, spent in best.items():
        sys.stdout.write(f"{name:<28}{spent:7.1f} ns a bounce, {spent / best['egg']:5.2f} of the egg\n")
    sys.stdout.write(f"100 sides against 4: {best[hundred.name] / best['square']:.2f}\n")


if __name__ == "__main__":
    timed() if sys.argv[1:] == ["times"] else drawn()
