"""What certified digits cost: `python benchmarks/certificates.py [--full]`, from the repository's root.

Three columns for each value: Newton's method in mpmath, the same in balls, and the certificate that
the first of them leads to. Whole searches beside what was asked of them, and beside the check of the
certificate alone. Proofs over sets. Then the cascade at 50 digits, whose cost must grow like the
period, and its end. `--full` goes to 10,000 digits, to period 2**15 and to `lam = 0.14`, a few minutes.
"""

import sys
import time
from collections.abc import Callable
from itertools import islice
from typing import Any

import mpmath
from flint import arb
from rich.console import Console
from rich.table import Table as Shown
from sympy import Expr, Integer, N, Rational, acos, pi

from symbolic import tables
from symbolic.cycles.polygons import saddle_node
from symbolic.tables.table import alpha as letter
from verification.arithmetic.balls import balls, bits_of, exact_balls, working
from verification.cycles.cascade import cascade
from verification.cycles.critical import corner
from verification.cycles.newton import GUARD, System, floats, levels, refined
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.named.curves import limit, ratio
from verification.named.files import checked, document
from verification.named.locate import GMPY2, locate
from verification.proofs.corner.corner_orbit import CornerClaim, corner_proved
from verification.proofs.corner.half_return import trapping_region
from verification.proofs.corner.return_map import kink_falls, minimum_at_kink
from verification.proofs.periodic.bifurcation import Claim, proved
from verification.proofs.periodic.triangles import no_triangles

ALPHA: Expr = Rational(2, 25)
DIGITS = (16, 50, 100, 300, 1000, 3000, 10_000)


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds, and the result; the least of three for what takes less than a second."""
    start = time.perf_counter()
    result = work()
    least = time.perf_counter() - start
    for _ in range(2 if least < 1 else 0):
        start = time.perf_counter()
        work()
        least = min(least, time.perf_counter() - start)
    return least, result


def in_balls(system: System, start: list[float], digits: int) -> list[arb]:
    """Newton's method on the midpoints of balls, with doubling precision: fast, and no proof."""
    z = [arb(x) for x in floats(system, start)]
    for level in levels(digits + GUARD):
        with working(bits_of(level)):
            for _ in range(2 if level < 20 else 1):
                z = [(x - d).mid() for x, d in zip(z, system.newton(balls(bits_of(level)), z), strict=True)]
    return z


def certificate(system: System, z: list[Any], digits: int) -> None:
    """The proof around an approximation: the whole checklist where there is one."""
    bits = bits_of(digits, 100)
    with working(bits):
        radius = (arb(10) ** -(digits + 2)).mid()
    if isinstance(system, Problem):
        assert proved(Claim(system, tuple(exact_balls(z)), radius, bits, digits)).certified
    else:
        assert corner_proved(CornerClaim("lam", tuple(exact_balls(z)), radius, bits, digits)).certified


def systems() -> dict[str, tuple[System, list[float]]]:
    """The three values of the table, each with a start."""
    egg = tables.egg(3).at(alpha=ALPHA)
    turn = -float(N(acos(-ALPHA))) / 3
    triangle = [turn + 2 * float(N(pi)) * k / 3 for k in range(3)]
    first = next(cascade(ALPHA))
    return {
        "lambda-star": (corner(), [0.2545, 0.0712]),
        "saddle-node": (
            Problem(egg, (0, 0, 0), BifurcationKind.FOLD, "lam"),
            [*triangle, float(N(saddle_node().subs(letter, ALPHA)))],
        ),
        "doubling 3": (first.problem, first.start),
    }


def digits_table(console: Console, most: int) -> None:
    """Digits against seconds."""
    shown = Shown("value", "digits", "mpmath", "balls", "certificate", title="seconds")
    for name, (system, start) in systems().items():
        certificate(system, refined(system, start, 16).z, 16)  # generates and loads the kernels
        for digits in (d for d in DIGITS if d <= most):
            shooting, solution = timed(lambda s=system, x=start, d=digits: refined(s, x, d))
            in_arb, _ = timed(lambda s=system, x=start, d=digits: in_balls(s, x, d))
            proof, _ = timed(lambda s=system, z=solution.z, d=digits: certificate(s, z, d))
            shown.add_row(name, str(digits), f"{shooting:.4f}", f"{in_arb:.4f}", f"{proof:.4f}")
    console.print(shown)


BARS = (
    ("lambda-star", 1000, {}, 1),
    ("lambda-star", 10_000, {}, 60),
    ("saddle-node", 1000, {"alpha": ALPHA}, 5),
    ("doubling", 50, {"alpha": ALPHA, "n": Integer(10)}, 30),
)


def bars_table(console: Console, most: int) -> None:
    """Seconds of a whole search, after start-up, beside the seconds it may take and those of the check alone."""
    shown = Shown("value", "digits", "search and proof", "may take", "check alone", "share", title="seconds")
    for name, digits, shape, bar in BARS:
        if digits > most:
            continue
        locate(name, 16, **shape)
        whole, found = timed(lambda n=name, d=digits, s=shape: locate(n, d, **s))
        made = document(name, found.proof)
        alone, again = timed(lambda m=made: checked(m))
        assert found.certified
        assert again.certified
        shown.add_row(name, str(digits), f"{whole:.3f}", str(bar), f"{alone:.3f}", f"{alone / whole:.0%}")
    console.print(shown)


def sets_table(console: Console, full: bool) -> None:
    """Proofs over sets: what they took."""
    shown = Shown("proof", "pieces", "seconds", title="proofs over sets")
    last = 0.14 if full else 0.1
    proofs: dict[str, Callable[[], tuple[bool | None, int]]] = {
        "no period 3 for lam <= 0.378": lambda: (
            (found := no_triangles(ALPHA, Rational(378, 1000))).excluded,
            found.boxes,
        ),
        "s_4 has its minimum at a kink, 0.071 <= lam <= 0.0713": lambda: (minimum_at_kink(0.04, 0.071, 0.0713), 0),
        "and that falls": lambda: (kink_falls(0.071, 0.0713), 0),
        f"a chaotic attractor for lambda-star < lam <= {last}": lambda: (
            (found := trapping_region(last)).proved,
            len(found.steps),
        ),
    }
    for name, proof in proofs.items():
        seconds, (holds, pieces) = timed(proof)
        assert holds
        shown.add_row(name, str(pieces or ""), f"{seconds:.2f}")
    console.print(shown)


def cascade_table(console: Console, highest: int) -> None:
    """Period against seconds at 50 digits, and where the cascade ends."""
    shown = Shown("n", "period", "start in float64", "mpmath", "certificate", "lambda_n", title="seconds at 50 digits")
    values = []
    members = islice(cascade(ALPHA), highest - 2)
    while True:
        seconds, each = timed(lambda: next(members, None))
        if each is None:
            break
        shooting, solution = timed(lambda r=each: refined(r.problem, r.start, 50))
        proof, _ = timed(lambda r=each, s=solution: certificate(r.problem, s.z, 50))
        values.append(mpmath.nstr(solution.z[-1], 55))
        row = [str(each.n), str(each.problem.period), *(f"{t:.2f}" for t in (seconds, shooting, proof))]
        shown.add_row(*row, values[-1][:24])
    console.print(shown)
    for name, found in (("lambda_infinity", limit(values)), ("delta", ratio(values))):
        shown_value, error = mpmath.nstr(found.value, 26), mpmath.nstr(found.error, 2)
        console.print(f"{name} = {shown_value} +- {error}, estimated by two schemes, not certified", soft_wrap=True)


def main() -> None:
    """Prints both tables."""
    console = Console()
    full = "--full" in sys.argv[1:]
    console.print(f"gmpy2 under mpmath: {'yes' if GMPY2 else 'no'}")
    digits_table(console, 10_000 if full else 1000)
    bars_table(console, 10_000 if full else 1000)
    sets_table(console, full)
    cascade_table(console, 15 if full else 10)


if __name__ == "__main__":
    main()
