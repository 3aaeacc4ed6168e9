"""What continuation costs: `python benchmarks/continuation.py [--full]`, from the repository's root.

First the triangles of the egg, alpha = 0.08, on 50 contractions from 1 down to 0.37: they end at the fold, 0.378...,
and the branch comes back on the vertex triangles. Beside it a naive walk in the parameter: Newton's method from
one contraction to the next, with the derivative by differences of the iterated map; what it cannot do is pass the
fold. Errors are against cycles solved to 30 digits and certified, at each point.

Then the doublings of periods 4 to 64 on 50 shapes, as curves in (alpha, lam); beside them the naive way of finding
each doubling afresh, by walking each cycle in `lam` until its multiplier is -1. Errors are against certified values,
on every tenth shape, or with `--full` on each of the 50, some minutes.
"""

import sys
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table as Shown
from sympy import Rational

from numeric import PinballMap
from symbolic.tables import egg
from verification.cycles.arc import Steps
from verification.cycles.branch import branch
from verification.cycles.cascade import next_critical
from verification.cycles.chords import Chords
from verification.cycles.problem import Problem
from verification.cycles.recurrence import Array, BifurcationKind
from verification.named.curves import BifurcationCurve, cascade
from verification.named.locate import certify

ALPHA = Rational(2, 25)
POINTS = 50
SHAPES = [Rational(73, 1000) + Rational(26 * k, 1000 * (POINTS - 1)) for k in range(POINTS)]
TRIANGLE = np.pi / 3 * np.array([1.0, 3.0, 5.0])


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """The least seconds of three runs, and the result."""
    best = np.inf
    for _ in range(3):
        start = time.perf_counter()
        result = work()
        best = min(best, time.perf_counter() - start)
    return float(best), result


def followed() -> list[tuple[float, Array]]:
    """The triangles by continuation: the cycles at 50 contractions on either side of the fold."""
    ring = Chords(egg(3).at(alpha=ALPHA), (0, 0, 0))
    one = branch(ring, TRIANGLE, "lam", 1.0, (0.37, 1.0), steps=Steps(largest=0.3))
    found = []
    for lam in np.linspace(0.37, 1.0, POINTS):
        found += [(float(lam), z[:3]) for z in one.at(float(lam))]
    return found


def naive() -> tuple[list[tuple[float, Array]], int]:
    """The same by walking in `lam` from 1 down, with single shooting and differences; and where it is lost."""
    map = PinballMap("egg", lam=1, alpha=ALPHA)
    x, found, steps = np.array([np.pi / 3, np.pi / 6]), [], 0
    for lam in np.linspace(0.37, 1.0, POINTS)[::-1]:
        here = map.at(float(lam))

        def gap(at: Array, here: PinballMap = here) -> Array:
            theta, phi = at
            for _ in range(3):
                step = here.step(float(theta), float(phi))
                theta, phi = float(step.theta), float(step.phi)
            return np.array([np.remainder(theta - at[0] + np.pi, 2 * np.pi) - np.pi, phi - at[1]])

        for _ in range(30):
            steps += 1
            value = gap(x)
            slope = np.stack([(gap(x + h) - value) / 1e-7 for h in 1e-7 * np.eye(2)], -1)
            move = np.linalg.solve(slope, value)
            x = x - np.clip(move, -0.1, 0.1)
            if np.max(np.abs(move)) < 1e-11:
                break
        else:
            return found, steps
        found.append((float(lam), x.copy()))
    return found, steps


def errors(found: list[tuple[float, Array]]) -> Array:
    """Of the first bounce, against the certified cycle at the very same contraction."""
    table, made = egg(3).at(alpha=ALPHA), []
    for lam, x in found:
        problem = Problem(table, (0, 0, 0), lam=Rational(lam))
        start = x if len(x) == 3 else x[0] + 2 * np.pi / 3 * np.arange(3)
        proof = certify(problem, [float(v) for v in start], 30)
        assert proof.certified
        made.append(abs(float(proof.enclosure.zero[0].mid() - x[0])))
    return np.array(made)


def triangles(console: Console) -> None:
    """The first table."""
    followed()
    quick, curve = timed(followed)
    slow, (walked, _) = timed(naive)
    shown = Shown("way", "points", "seconds", "ratio", "largest error", "median error", title="triangles, alpha = 0.08")
    for name, seconds, points in (("continuation", quick, curve), ("naive walk", slow, walked)):
        wrong = errors(points)
        shown.add_row(
            name,
            str(len(points)),
            f"{seconds:.4f}",
            f"{slow / seconds:.2f}",
            f"{wrong.max():.1e}",
            f"{np.median(wrong):.1e}",
        )
    console.print(shown)
    console.print(f"the naive walk is lost below lam = {walked[-1][0]:.4f}; continuation turns at the fold")


def doublings() -> tuple[list[BifurcationCurve], Array]:
    """The curves, and for each doubling of period 4 to 64 its contractions on 50 shapes."""
    curves = [each for each in cascade(3, 64) if each.kind is BifurcationKind.FLIP and each.period >= 4]
    return curves, np.array([[each.lam(float(alpha)) for alpha in SHAPES] for each in curves])


def afresh(alpha: Rational, cycles: list[Array]) -> list[float]:
    """Each doubling found by a walk in `lam`, from a start a little below it."""
    table = egg(3).at(alpha=alpha)
    lams = [float(z[-1]) for z in cycles]
    gaps = [lams[0] / 4, *(b - a for a, b in pairwise(lams))]
    return [
        next_critical(table, [float(x) for x in z[:-2]], lam - 0.4 * gap, 0.1 * gap, BifurcationKind.FLIP)[-1]
        for z, lam, gap in zip(cycles, lams, gaps, strict=True)
    ]


def cascades(console: Console, every: int) -> None:
    """The second table."""
    seconds, (curves, table) = timed(doublings)
    wrong: dict[str, list[list[float]]] = {"curve": [[] for _ in curves], "walk": [[] for _ in curves]}
    walking = []
    for alpha in SHAPES[::every]:
        at = [each.curve.crossing(float(alpha))[0] for each in curves]
        start = time.perf_counter()
        walked = afresh(alpha, at)
        walking.append(time.perf_counter() - start)
        for i, (each, z, other) in enumerate(zip(curves, at, walked, strict=True)):
            problem = Problem(egg(3).at(alpha=alpha), (0,) * each.period, BifurcationKind.FLIP, "lam")
            proof = certify(problem, [*(float(x) for x in z[:-2]), float(z[-1])], 25)
            assert proof.certified
            wrong["curve"][i].append(abs(float(proof.value.mid() - z[-1])))
            wrong["walk"][i].append(abs(float(proof.value.mid() - other)))
    shown = Shown("period", "curve", "naive walk", title=f"doublings, largest error on {len(walking)} shapes")
    for i, each in enumerate(curves):
        shown.add_row(str(each.period), f"{max(wrong['curve'][i]):.1e}", f"{max(wrong['walk'][i]):.1e}")
    console.print(shown)
    one = float(np.median(walking))
    console.print(
        f"{table.size} values on {POINTS} shapes: {seconds:.2f} s by curves; one shape by walks {one:.2f} s, "
        f"so {one * POINTS / seconds:.1f} times as long for as many"
    )


def main() -> None:
    """Prints both tables."""
    console = Console()
    triangles(console)
    cascades(console, 1 if "--full" in sys.argv[1:] else 10)


if __name__ == "__main__":
    main()
