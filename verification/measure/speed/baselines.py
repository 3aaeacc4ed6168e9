"""The baselines of the benchmark folder: naive NumPy + lambdify, scalar numba, and the paper's own ways.

They are written as one would write them first and are no part of the installed package: they need a checkout, or the
source distribution. Elsewhere, or without numba, the benchmark goes on with its own rows only, and says so.

A diagram of errors against times, in text: from float64 to a thousand digits on one page.
"""

import importlib.util
from collections.abc import Collection, Iterable, Sequence
from decimal import Decimal
from math import log10
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from numeric import PinballMap
from verification.maps.exact import ExactMap
from verification.measure.speed.bench import LAWS, Row, best
from verification.measure.speed.labelled import DIGITS, SCENES

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "benchmarks"
MISSING = "The baselines need a checkout, or the source distribution: benchmarks/ is no part of the installed package."
BALLS = 24  # whose errors are measured
LAM = 0.95


def is_checkout() -> bool:
    """Whether the package runs from its source tree: what lies beside an installed one is somebody else's."""
    return (ROOT / "pyproject.toml").is_file() and FOLDER.is_dir()


def module(name: str) -> ModuleType | None:
    """A module of the benchmark folder, or None when it cannot be had."""
    path = FOLDER / f"{name}.py"
    if not is_checkout() or not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(found)
    except ImportError:
        return None
    return found


def baseline_rows(name: str, runs: int) -> Iterable[Row]:
    """The three baselines on a scene."""
    rng = np.random.default_rng(2)
    shape: dict[str, Any] = dict(SCENES[name])
    map = PinballMap(name, lam=LAWS["pinball"], **shape)
    low, high = map.states.ends[0]
    theta, phi = rng.uniform(low * 0.99, high * 0.99, 2048), rng.uniform(-1.4, 1.4, 2048)
    value = map.shape[0] if map.shape else 0.0
    scalar = module("scalar_numba")
    if scalar is not None:
        step = getattr(scalar, name)

        def compiled(bounces: int, count: int = 512) -> Any:
            at, out = theta[:count].copy(), phi[:count].copy()
            scalar.every(step, at, out, LAM, bounces, value)
            return at, out

        error = _error(map, theta, phi, *compiled(1, BALLS))
        yield Row(
            name, "float64", "numba, one ball at a time", error, best(lambda: compiled(300), runs) / 512 / 300, runs
        )
    arrays = module("arrays_lambdify")
    naive = arrays.baseline(name, shape) if arrays is not None else None
    if naive is not None:
        with np.errstate(all="ignore"):
            error = _error(map, theta, phi, *naive.bounce(theta[:BALLS], phi[:BALLS], LAM))

            def lambdified() -> None:
                at, out = theta, phi
                for _ in range(10):
                    at, out = naive.bounce(at, out, LAM)

            yield Row(name, "float64", "numpy + lambdify", error, best(lambdified, runs) / theta.size / 10, runs)
    ways = module("paper_ways")
    if ways is not None:
        way = getattr(ways, name)

        def papers() -> Any:
            return [
                way(0, a, b, LAM, *map.shape) for a, b in zip(theta[:BALLS].tolist(), phi[:BALLS].tolist(), strict=True)
            ]

        _, at, out = (np.array(column, dtype=float) for column in zip(*papers(), strict=True))
        error = _error(map, theta, phi, at, out)
        yield Row(name, "float64", "the paper's way, in Python", error, best(papers, runs) / BALLS, runs)


def _error(map: PinballMap, theta: Any, phi: Any, at: Any, out: Any) -> Decimal:
    """The largest error of parameter or angle over the first balls, in units of 2**-52."""
    exact = ExactMap(map, DIGITS)
    mp, worst = exact.context, 0.0
    for i in range(BALLS):
        truth = exact.bounce(exact.ball(0, theta[i], phi[i]))
        gap = mp.mpf(float(at[i])) - truth.theta
        if truth.component == 0:
            gap -= 2 * mp.pi * mp.nint(gap / (2 * mp.pi))
        worst = max(worst, float(abs(gap)), float(abs(mp.mpf(float(out[i])) - truth.phi)))
    return Decimal(f"{worst * 2.0**52:.3g}")


WIDTH, HEIGHT = 72, 14  # characters
UNIT = -52 * log10(2)  # decimal logarithm of the unit of errors
Point = tuple[float, Decimal | None]  # seconds, and an error in units of 2**-52


def duration(seconds: float) -> str:
    """A time in the unit that suits it.

    >>> duration(7.5e-9), duration(2e-3)
    ('7.5 ns', '2 ms')
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.2g} ns"


def magnitude(error: Decimal) -> float:
    """The decimal logarithm of an error given in units of 2**-52, which may lie below every float.

    >>> round(magnitude(Decimal("4.5036e-984")), 3)
    -999.0
    """
    return float(error.log10()) + UNIT if error else -float("inf")


def diagram(points: Sequence[Point], front: Collection[int] = ()) -> str:
    """A letter at each time (to the right) and error (upwards), both logarithmic; capitals are on the front.

    Where errors span hundreds of decades the upward scale is the logarithm of the number of digits that are right.

    >>> print(diagram([(1e-9, Decimal(1)), (1e-3, Decimal("1e-90"))], front={1}).splitlines()[0].strip())
    1e-16 |a
    """
    placed = {
        i: (log10(seconds), magnitude(error))
        for i, (seconds, error) in enumerate(points)
        if error is not None and error.is_finite() and error > 0
    }
    if not placed:
        return ""
    left, right = min(x for x, _ in placed.values()), max(x for x, _ in placed.values())
    top, bottom = max(y for _, y in placed.values()), min(y for _, y in placed.values())
    wide = bottom < 3 * top < 0

    def height(y: float) -> float:
        return -log10(-y) if wide else y

    span = max(height(top) - height(bottom), 1e-9)
    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    for i, (x, y) in placed.items():
        column = round((x - left) / max(right - left, 1e-9) * (WIDTH - 1))
        line = round((height(top) - height(y)) / span * (HEIGHT - 1))
        while canvas[line][column] != " " and column < WIDTH - 1:
            column += 1
        canvas[line][column] = chr(ord("A" if i in front else "a") + i)
    texts = []
    for line, letters in enumerate(canvas):
        at = height(top) - span * line / (HEIGHT - 1)
        label = (f"1e{-round(10**-at)}" if wide else _power(at)) if line % 4 == 0 or line == HEIGHT - 1 else ""
        texts.append(f"  {label:>8} |{''.join(letters).rstrip()}")
    first, last = duration(10**left), duration(10**right)
    return "\n".join([*texts, f"{'':>11}+{'-' * WIDTH}", f"{'':>12}{first}{last:>{WIDTH - len(first)}} a bounce"])


def _power(y: float) -> str:
    """`10**y` with one digit."""
    exponent = int(y // 1)
    lead = round(10 ** (y - exponent))
    return f"{1 if lead == 10 else lead}e{exponent + (lead == 10)}"
