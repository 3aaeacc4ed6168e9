"""What a crisis costs: `python benchmarks/crises.py [--scaling]`, from the repository's root.

Each crisis by sampling, by its manifolds and by the cycles that shadow it: seconds, the error against the
value with 60 digits, and the time in units of the sampling's. `--scaling` adds the mean stay above the two
crises of the paper at many distances, with the fitted power, some minutes.
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
from rich.console import Console
from rich.table import Table as Shown

from verification.cycles.newton import refined
from verification.named import crises
from verification.proofs.manifolds import known as passages
from verification.proofs.manifolds.known import SHAPE, contact, crisis, shadow, table
from verification.proofs.manifolds.proof import sharpened, tangency_proved
from verification.proofs.manifolds.tangency import tangency

SHOWN = ("merging", "boundary", "band-merging", "symmetry-restoring", "window-end-15")
DISTANCES = {"merging": np.geomspace(3e-3, 3e-7, 61), "boundary": np.geomspace(4e-3, 9e-5, 40)}


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Processor seconds, and the result."""
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def by_cycle(kind: str, digits: int) -> Any:
    """The fold of a cycle long enough for `digits` digits."""
    where, map = contact(kind, SHAPE), table(SHAPE)
    unstable = abs(tangency(where, map, 8).multipliers[1])
    cycle = shadow(where, map, where.parameter, int((digits + 2) * np.log(10) / np.log(unstable)) + 1)
    return refined(cycle.problem, cycle.start, digits).z[-1]


def by_proof(kind: str, digits: int) -> Any:
    """The tangency proved in balls, from a start of eight digits."""
    where, map = contact(kind, SHAPE), table(SHAPE)
    found = tangency_proved(where, map, sharpened(where, map, str(where.parameter), digits), digits)
    assert found.holds
    return found.parameter.mid().str(2 * digits, radius=False)


def values() -> Shown:
    """The table of methods."""
    shown = Shown("crisis", "method", "seconds", "error", "of the sampling's time")
    for kind in SHOWN:
        true = crisis(kind, SHAPE, 60).parameter
        rows: list[tuple[str, float, Any]] = []
        if kind in crises.KINDS:
            rows.append(("sampling", *timed(lambda k=kind: crises.crisis(k, "0.08", 2e-6, 10**7).lam)))
        rows.append(
            ("manifolds, float64", *timed(lambda k=kind: tangency(contact(k, SHAPE), table(SHAPE), 10).parameter))
        )
        rows.append(
            ("manifolds, 20 digits", *timed(lambda k=kind: tangency(contact(k, SHAPE), table(SHAPE), 20).parameter))
        )
        rows.append(("tangency, 24 digits, proved", *timed(lambda k=kind: by_proof(k, 24))))
        for digits in (20, 50, 200):
            rows.append((f"cycle, {digits} digits", *timed(lambda k=kind, d=digits: by_cycle(k, d))))
        base = rows[0][1]
        for name, seconds, value in rows:
            error = mpmath.nstr(abs(mpmath.mpf(1) * (true.context.mpf(value) - true)), 2)
            shown.add_row(kind, name, f"{seconds:.2f}", error, f"{seconds / base:.2f}" if kind in crises.KINDS else "")
    return shown


def scalings() -> Shown:
    """The fitted powers beside those of the multipliers, at the same distances and in the limit."""
    shown = Shown(
        "crisis", "distances", "fitted exponent", "by passages of the saddle", "left of ln(stay)", "in the limit"
    )
    for kind, distances in DISTANCES.items():
        found = crises.scaling(kind, "0.08", contact(kind, SHAPE).parameter, distances, 2 * 10**9)
        at = crisis(kind, SHAPE, 8)
        stable, unstable = at.touch.multipliers[:2]
        one, left = passages.unit(found.points, stable, unstable)
        expected = passages.exponent(np.array([d for d, _ in found.points]), one, stable, unstable)
        x, y = np.log(np.array(found.points)).T
        straight = float(np.std(y - np.polyval(np.polyfit(x, y, 1), x)))
        fitted = f"{found.exponent:.2f} +- {found.error:.2f}"
        span = f"{distances[-1]:.0e} to {distances[0]:.0e}"
        about = f"{left:.2f}, of a power {straight:.2f}"
        shown.add_row(kind, span, fitted, f"{expected:.2f} (unit {one:.2g})", about, f"{at.exponent:.3f}")
    return shown


if __name__ == "__main__":
    console = Console()
    console.print(values())
    if "--scaling" in sys.argv:
        console.print(scalings())
