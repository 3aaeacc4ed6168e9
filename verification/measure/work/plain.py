"""The time of commands and scripts, each in a new process as users type them, against the shortest plain script.

A script answers the same question to the same digits. If an answer needs a search or a proof that only this package
has, the time of importing SymPy, NumPy and SciPy takes the script's place.
"""

import json
import os
import subprocess
import time
from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import mpmath

from numeric import PinballMap
from numeric.sweeps.workers import own_command

if TYPE_CHECKING:
    from verification.measure.work.calls import Call


def egg_orbit(start: Sequence[Any], bounces: int, digits: int, alpha: str, lam: str) -> list[tuple[Any, Any]]:
    """Parameters and exit angles of an orbit in the egg `r = 1 + alpha*cos(3*theta)`; the start comes first.

    The float64 kernel computes the landing, Newton steps refine it to full precision, and the exit angle is minus `lam`
    times the incidence angle.

    >>> mpmath.nstr(egg_orbit(("0.3", "0.2"), 1, 30, "0.08", "0.5")[1][0], 15)
    '-2.88977808883885'
    """
    map, own = egg(alpha, lam), mpmath.MPContext()
    own.dps = digits + 30
    a, contraction, theta, phi = (own.mpf(x) for x in (alpha, lam, *start))

    def curve(at: Any) -> tuple[Any, Any, Any, Any]:
        c, s = own.cos_sin(at)
        c3, s3 = own.cos_sin(3 * at)
        r, dr = 1 + a * c3, -3 * a * s3
        return r * c, r * s, dr * c - r * s, r * c + dr * s

    orbit = [(theta, phi)]
    for _ in range(bounces):
        x0, y0, dx, dy = curve(theta)
        c, s = own.cos_sin(phi)
        vx, vy = s * dx - c * dy, s * dy + c * dx
        theta = own.mpf(float(map.step(float(theta), float(phi)).theta))
        for _ in range((own.dps // 15).bit_length()):  # each step doubles the digits
            x, y, dx, dy = curve(theta)
            theta -= (vx * (y - y0) - vy * (x - x0)) / (vx * dy - vy * dx)
        x, y, dx, dy = curve(theta)
        phi = contraction * own.atan2(vx * dx + vy * dy, vx * dy - vy * dx)
        orbit.append((theta, phi))
    return orbit


@cache
def egg(alpha: str, lam: str) -> PinballMap:
    """The egg's map, cached; its kernel computes the landings of `egg_orbit`."""
    return PinballMap("egg", alpha=alpha, lam=lam)


def landing(bounces: int, digits: int) -> str:
    """The last landing of a benchmark particle in the egg, as text; a bounce loses less than 1/5 of a digit."""
    last, _ = egg_orbit(("0.3", "0.2"), bounces, digits + bounces // 5, "0.08", "0.5")[-1]
    own = last.context
    return str(own.nstr((last + own.pi) % (2 * own.pi) - own.pi, digits))


def flower_length() -> str:
    """The length of the curve `r = 1 + cos(5*theta)/40` by the trapezoidal rule, which converges geometrically."""
    imports()
    at = [2 * mpmath.pi * k / 200 for k in range(200)]
    speeds = (mpmath.hypot(1 + mpmath.cos(5 * t) / 40, mpmath.sin(5 * t) / 8) for t in at)
    return str(mpmath.nstr(mpmath.fsum(speeds) * mpmath.pi / 100, 15))


def imports() -> str:
    """Imports NumPy, SciPy and SymPy, as most scripts do at first; returns their versions."""
    import numpy
    import scipy
    import sympy

    return " ".join(package.__version__ for package in (numpy, scipy, sympy))


def last_theta(said: str) -> str:
    """The parameter of the last bounce in the JSON document of `pinball orbit`."""
    return str(json.loads(said)["bounces"][-1]["theta"])


class Asked(NamedTuple):
    """A command or Python code, and the plain script with which it is compared.

    `bar` is the largest accepted ratio of times; `read` takes a number from the output, which must agree to `digits`.
    """

    typed: str
    script: str
    bar: float
    digits: int = 0
    read: Callable[[str], str] = str


EGG = "egg --alpha 0.08 --lam 0.5"
ORBIT = f"pinball orbit {EGG} --start 0.3,0.2 --fields theta --json -"
FOLD = """from symbolic import Scene, tables
from verification import certify, find_cycles, follow
egg = Scene(tables.egg(3), alpha="2/25", lam="1/2")
print(certify(follow(find_cycles(egg, period=3).stable[0], lam=("0.3", "1")).folds[0], digits=20))"""
CYCLES = "from verification import find_cycles; print(find_cycles('egg', alpha='0.08', lam='0.5', period={}))"
LENGTH = "from symbolic import perimeter, tables; print(perimeter(tables.polar('1 + cos(5*theta)/40')).evalf(15))"
STEP = (
    "from numeric import PinballMap; print(PinballMap('egg', alpha='0.08', lam='0.95').orbit(0.3, 0.2, 10).theta[-1])"
)
QUESTIONS = (
    Asked(STEP, "import numpy", 1.6),
    Asked(f"{ORBIT} --bounces 1000 --arithmetic mpmath --digits 30", "landing(1000, 30)", 1.7, 30, last_theta),
    Asked(f"{ORBIT} --bounces 1000 --arithmetic arb --digits 30", "landing(1000, 30)", 1.0, 30, last_theta),
    Asked(f"{ORBIT} --bounces 1000 --arithmetic mpmath --digits 120", "landing(1000, 120)", 2.0, 120, last_theta),
    Asked(LENGTH, "flower_length()", 1.21, 15),
    Asked(CYCLES.format(3), "imports()", 1.36),
    Asked(CYCLES.format(6), "imports()", 1.71),
    Asked(FOLD, "imports()", 1.64),
    Asked(f"pinball cycles {EGG} --period 8 --count 4 --prove 3", "imports()", 4.3),
    Asked("pinball sweep parameter-space --alphas 0:0.1:21 --lams 0:1:41 --dry-run", "imports()", 0.57),
    Asked("pinball basins cuspless --lam 0.09 --columns 400 --rows 400", "imports()", 1.43),
    Asked("pinball locate saddle-node --alpha 0.08 --digits 50", "imports()", 0.71),
    Asked("pinball follow egg --alpha 0.08 --cycle triangle --lam 0.37:1 --digits 20", "imports()", 1.07),
    Asked(f"pinball morse {EGG} --columns 512 --rows 256", "imports()", 1.07),
)


def waited(text: str) -> tuple[float, str]:
    """Processor seconds of a command, or of Python code in this module, in a new process; and its output."""
    command, environment = own_command("verification", *text.split()[1:])
    if not text.startswith("pinball "):
        command[2:] = ["-c", text]
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # else its modules are compiled anew each time
    before, start = os.times(), time.perf_counter()
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    after = os.times()
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    if done.returncode != 0 and not done.stdout:
        raise ValueError(f"{text}: {(done.stderr.strip().splitlines() or ['it ended'])[-1]}")
    return spent or time.perf_counter() - start, done.stdout.strip()  # the clock's where a system does not say


def agree(one: str, other: str, digits: int) -> bool:
    """True if two decimals agree to so many digits, up to one unit in the last of them.

    >>> agree("1.2346", "1.23456", 5), agree("1.2346", "1.2344", 5)
    (True, False)
    """
    first, second = Decimal(one), Decimal(other)
    return abs(first - second) <= Decimal(1).scaleb(max(first.adjusted(), second.adjusted()) + 1 - digits)


def asked_rows(runs: int, questions: Iterable[Asked] = QUESTIONS) -> "Iterable[Call]":
    """Times each command against its script: the shortest of alternating runs. `ValueError` if their digits differ."""
    from verification.measure.work.calls import Call

    for one in questions:
        script = one.script
        if "(" in script:
            script = f"from verification.measure.work import plain; print(plain.{script})"
        pairs = [(waited(one.typed), waited(script)) for _ in range(runs)]
        (_, said), (_, known) = pairs[0]
        if one.digits and not agree(found := one.read(said), known, one.digits):
            raise ValueError(f"{one.typed}: {found}, and the plain script says {known}")
        spent, reference = (min(pair[i][0] for pair in pairs) for i in (0, 1))
        yield Call("", one.typed, spent, one.script, reference, one.bar)
