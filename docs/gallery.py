"""Draws the tables of docs/tables.md, each with an orbit and with its phase space: `python docs/gallery.py`.

The lines are grey and blue on no background, so that the picture does in light and in dark.
"""

from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("svg")
matplotlib.rcParams |= {"svg.hashsalt": "tables", "svg.fonttype": "none"}  # the same bytes each time; text as text
from matplotlib import pyplot as plt  # noqa: E402  (after the backend)

from numeric import PinballMap  # noqa: E402
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


if __name__ == "__main__":
    drawn()
