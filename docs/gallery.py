"""Makes the pictures of docs/gallery.md from the code that stands below each: `python docs/gallery.py [NAME ...]`.

Without names it makes those that are missing, as `make docs` does. A picture is made as large as its command says and
cut down for the page; it has no background, and the page turns its inks round in the dark.

`python docs/gallery.py tables` draws the tables of docs/tables.md, each with an orbit and with its phase space, grey
and blue on no background; `python docs/gallery.py times` prints what a bounce costs on each of them.
"""

import io
import re
import runpy
import shlex
import sys
import tempfile
import time
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

matplotlib.use("svg")
from matplotlib import pyplot as plt

from numeric import PinballMap, phase_starts
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from verification.app.cli import main
from verification.measure.extremes.by_hand import discs, outline
from verification.measure.extremes.orbits import RADII
from verification.plots.sheet import STYLE

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
    (tables.GALLERY["elliptical_stadium"](), "0.95"),
    (tables.reuleaux(), "0.9"),
    (tables.lemon(), "0.9"),
    (tables.regular(100), "0.9"),
    (discs(6), "0.95"),
    *((tables.polar(rho, name), "0.9") for name, rho in RADII.items() if name != "waves"),
    (tables.from_points(PEBBLE, "pebble"), "0.9"),
    (outline(30, 0.2, "dented"), "0.9"),
]


FORMS = ((1200, 80), (1200, 60), (1200, 40), (900, 50), (900, 30), (600, 40))  # width and quality, the best first
PAGE = Path(__file__).parent / "gallery.md"
BYTES = 72_000  # of a picture on the page, at most


def entries() -> dict[str, tuple[str, str]]:
    """For each picture of the page, `sh` or `python` and the code below it."""
    found = re.findall(r"!\[[^\]]*\]\(gallery/([\w-]+)\.webp\)\s+```(sh|python)\n(.*?)```", PAGE.read_text(), re.DOTALL)
    return {name: (language, code) for name, language, code in found}


def made(name: str, folder: Path) -> Path:
    """Runs the code of one picture, and gives the small form of what it drew."""
    language, code = entries()[name]
    with tempfile.TemporaryDirectory() as place:
        large = Path(place) / f"{name}.webp"
        code = code.replace(large.name, str(large))
        with matplotlib.rc_context():
            STYLE["savefig.transparent"] = True
            if language == "sh":
                program, *words = shlex.split(code.replace("\\\n", " "))
                status = main(words)
            else:
                program, status = "pinball", 0
                (Path(place) / "code.py").write_text(code)
                runpy.run_path(str(Path(place) / "code.py"))
            STYLE.pop("savefig.transparent")
        if program != "pinball" or status not in (0, 1) or not large.exists():
            raise ValueError(f"{PAGE.name}: the code of {name} draws no {name}.webp")
        (folder / f"{name}.webp").write_bytes(small(large))
    return folder / f"{name}.webp"


def small(path: Path) -> bytes:
    """A picture for a page: not too wide, and as good as its bytes allow."""
    with Image.open(path) as large:
        for wide, quality in FORMS:
            fitted = large.convert("RGBA")
            fitted.thumbnail((wide, 10 * wide), Image.Resampling.LANCZOS)
            buffer = io.BytesIO()
            fitted.save(buffer, "webp", quality=quality, alpha_quality=quality, method=6)
            if buffer.tell() <= BYTES:
                break
    return buffer.getvalue()


def make(names: list[str]) -> None:
    """Makes the pictures of these names; without names, those that are not there."""
    folder = PAGE.with_suffix("")
    folder.mkdir(exist_ok=True)
    for name in names or [name for name in entries() if not (folder / f"{name}.webp").exists()]:
        began = time.perf_counter()
        path = made(name, folder)
        sys.stdout.write(f"{path}: {path.stat().st_size} bytes, {time.perf_counter() - began:.1f} s\n")


def drawn() -> None:
    """Writes the picture."""
    rows = len(SCENES) // 3
    figure, axes = plt.subplots(2 * rows, 3, figsize=(9, 4.3 * rows), height_ratios=[2, 1] * rows)
    for k, (table, lam) in enumerate(SCENES):
        place, phase = axes[2 * (k // 3), k % 3], axes[2 * (k // 3) + 1, k % 3]
        map = PinballMap(table, lam=lam)
        for index, (low, high) in enumerate(map.states.ends):
            theta = np.linspace(low, high, 160 if len(map.states.ends) == 1 else 40 if len(map.states.ends) < 9 else 12)
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
    with matplotlib.rc_context({"svg.hashsalt": "tables", "svg.fonttype": "none"}):  # the same bytes; text as text
        figure.savefig(PICTURE, transparent=True, metadata={"Date": None})
    plt.close(figure)


def timed(runs: int = 30) -> None:
    """Nanoseconds a bounce, without exponents: the best of many runs, by turns in one process on one core."""
    egg = PinballMap("egg", alpha="2/25", lam="0.95")
    maps = {"egg": egg} | {table.name: PinballMap(table, lam="0.95") for table, _ in SCENES}
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
    sys.stdout.write(f"100 sides against 4: {best['regular100'] / best['square']:.2f}\n")


if __name__ == "__main__":
    {"times": timed, "tables": drawn}.get(" ".join(sys.argv[1:]), lambda: make(sys.argv[1:]))()
