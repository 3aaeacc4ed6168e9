"""The baselines of the benchmark folder: naive NumPy + lambdify, scalar numba, and the paper's own ways.

They are written as one would write them first and are no part of the installed package; without
the folder, or without numba, the benchmark goes on with its own rows only.
"""

import importlib.util
from collections.abc import Iterable
from decimal import Decimal
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from numeric import PinballMap
from verification.bench import LAWS, Row, best
from verification.exact_map import ExactMap
from verification.labelled import DIGITS, SCENES

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
BALLS = 24  # whose errors are measured
LAM = 0.95


def module(name: str) -> ModuleType | None:
    """A module of the benchmark folder, or None when it cannot be had."""
    path = FOLDER / f"{name}.py"
    if not path.exists():
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
