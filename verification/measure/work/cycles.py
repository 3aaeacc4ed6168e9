"""Benchmarks on cycles of period 2, 3 and 64, a fold, and doublings; chord equations against shooting and iteration."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from decimal import Decimal
from functools import cache, partial
from itertools import islice
from typing import Any

import numpy as np
from flint import arb
from sympy import N, Rational, acos

from numeric import PinballMap
from symbolic import tables
from symbolic.cycles import polygons
from symbolic.tables.table import Table, lam
from symbolic.tables.table import alpha as alpha_symbol
from verification.cycles.cascade import Doubling, cascade, cycle_at, doubled
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.measure.work.bench import module
from verification.measure.work.question import Method, Question, textbook
from verification.measure.work.sought import DIGITS, Sought, last, to_digits
from verification.named.locate import proof_near
from verification.proofs.periodic.cycle_in_box import UniqueCycle, closed_form

ALPHA = Rational(2, 25)
HALF = Rational(1, 2)
EGG = tables.egg(3).at(alpha=ALPHA)
TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
FIRST, HIGHEST = 3, 6  # n of the doublings `lambda_n`, as in section 6.6
FAR = Rational(41, 100)  # a contraction at which the cycle of period 64 has multipliers of some 10**5
STRIDE = 0.2  # step, over the distance in the contraction from its birth


def cycle(
    name: str, title: str, table: Table, at: Rational, start: tuple[float, ...], own: PinballMap, settles: bool
) -> Question:
    """Benchmark on the bounces of a cycle at `lam = at`, for the map `own`; `settles` says if particles reach it."""
    problem = Problem(table, (0,) * len(start), lam=at)
    usual = textbook_cycle(own, (start[0], first_exit(problem, start)), len(start), settles)
    what = f"a cycle of period {len(start)} of the {table.name}, lam = {at}"
    return cycle_question(name, title, what, problem, start, usual)


def cycle_question(
    name: str,
    title: str,
    what: str,
    problem: Problem,
    start: tuple[float, ...],
    usual: Sequence[Method],
) -> Question:
    """Benchmark on a cycle's bounces, in every arithmetic, against `usual` methods."""

    def certified(digits: int) -> list[arb]:
        return list(whole(proof_near(problem, list(start), digits)).enclosure.zero)

    methods = (*Sought(problem, start).methods(certified), *usual)
    return Question(name, title, f"the boundary parameters of {what}", "radians", certified, methods)


def whole(proof: UniqueCycle) -> UniqueCycle:
    """The proof itself; `ValueError` if an item of its checklist is open."""
    if not proof.proved:
        raise ValueError(f"{proof.label}: not proved: {', '.join(proof.open)}")
    return proof


def first_exit(problem: Problem, start: tuple[float, ...]) -> float:
    """The exit angle at the first bounce of a cycle, to three decimals, or to nine for long cycles."""
    out, _ = problem.ring.angles(np.array(floats(problem, start)), {"lam": float(problem.lam)})
    return round(float(out[0]), 3 if problem.period < 10 else 9)


def textbook_cycle(map: PinballMap, particle: tuple[float, float], period: int, settles: bool) -> list[Method]:
    """Textbook methods for a cycle: single shooting on the compiled step, and iteration if the cycle attracts."""
    book = module("textbook")
    if book is None:
        return []

    def bounces(start: tuple[float, float]) -> list[float]:
        return [float(x) for x in map.orbit(*start, period - 1).theta]

    shooting = textbook(
        "single shooting", lambda x: bounces(book.shooting(map, particle, period, x)), "xtol", TOLERANCES
    )
    waiting = textbook(
        "waiting for it", lambda n: bounces(book.iterated(map, *particle, period * n)), "turns", (10, 30, 100, 300)
    )
    return [shooting, waiting] if settles else [shooting]


def period_2() -> Question:
    """Benchmark: the vertical cycle of the cardioid between `pi/3` and `-pi/3`, which is unstable."""
    own = PinballMap("cardioid", lam="1/2")
    return cycle("cycle-2", "A cycle of period 2, cardioid", tables.cardioid, HALF, (1.05, -1.05), own, False)


def period_3() -> Question:
    """Benchmark: the attracting triangle of the egg at `lam = 1/2`."""
    own = PinballMap("egg", lam="1/2", alpha="2/25")
    return cycle("cycle-3", "A cycle of period 3, egg", EGG, HALF, triangle_start(), own, True)


def triangle_start() -> tuple[float, ...]:
    """The bounces of the egg's triangle at `lam = 1/2`, to three decimals."""
    first = float(N(polygons.near_flat().subs({lam: HALF, alpha_symbol: ALPHA})))
    return tuple(round(math.remainder(first + k * math.tau / 3, math.tau), 3) for k in range(3))


def period_64() -> Question:
    """Benchmark: a strongly unstable cycle of period 64 of the cascade, far from where it is born."""
    own = PinballMap("egg", lam=str(FAR), alpha="2/25")
    return cycle("cycle-64", "A cycle of period 64, egg", EGG, FAR, far_cycle(), own, False)


@cache
def members() -> tuple[Doubling, ...]:
    """The period doublings `lambda_3` to `lambda_6` of the egg's cascade, in float64."""
    return tuple(islice(cascade(ALPHA), HIGHEST - FIRST + 1))


@cache
def far_cycle() -> tuple[float, ...]:
    """The bounces of the cycle of period 64, to six decimals; it is followed in the contraction from its birth."""
    birth, below = members()[-1], members()[-2]
    here, lam = doubled(birth.problem, birth.start, 0.06 * (birth.lam - below.lam))
    before, last_step = here, 1.0
    while lam < float(FAR):
        step = min(STRIDE * (lam - birth.lam), float(FAR) - lam)  # the branch leaves its birth like a square root
        guess = [x + step / last_step * (x - y) for x, y in zip(here, before, strict=True)]
        before, here = here, cycle_at(EGG, guess, lam + step)
        lam, last_step = lam + step, step
    return tuple(round(math.remainder(x, math.tau), 6) for x in here)


def fold() -> Question:
    """Benchmark: the fold at which the egg's triangles are born. Paper: section 6.4."""
    exact = polygons.saddle_node().subs(alpha_symbol, ALPHA)
    turn = -float(N(acos(-ALPHA))) / 3
    start = (*(round(turn + math.tau / 3 * k, 3) for k in range(3)), round(float(N(exact)), 3))
    formula = Method(
        "closed form, arb", "arb", "digits", DIGITS, lambda d: [closed_form(exact, d)], to_digits, proved=True
    )
    asked = fold_question(
        "fold-3",
        "The fold of period 3, egg",
        f"the contraction at which cycles of period 3 are born, alpha = {ALPHA}",
        Problem(EGG, (0, 0, 0), BifurcationKind.FOLD, "lam"),
        start,
    )
    methods = (*asked.methods, formula, *textbook_fold())
    return replace(asked, reference=lambda digits: [closed_form(exact, digits)], methods=methods)


def fold_question(name: str, title: str, answers: str, problem: Problem, start: tuple[float, ...]) -> Question:
    """Benchmark on the parameter of a fold, in every arithmetic."""

    def certified(digits: int) -> list[arb]:
        return [whole(proof_near(problem, list(start), digits)).value]

    return Question(name, title, answers, "in lam", certified, Sought(problem, start, last).methods(certified))


def textbook_fold() -> list[Method]:
    """A textbook method for the fold: bisection on whether shooting still finds the cycle."""
    book = module("textbook")
    if book is None:
        return []
    map, triangle = PinballMap("egg", lam=1, alpha="2/25"), triangle_start()
    start = triangle[0], first_exit(Problem(EGG, (0, 0, 0), lam=HALF), triangle)
    seen = partial(book.fold_seen, map.at, start, 3, 0.3, 0.5)
    return [textbook("last seen, shooting", lambda xtol: [seen(xtol)], "xtol", TOLERANCES[:3])]


def doublings() -> Question:
    """Benchmark: the doublings `lambda_3` to `lambda_6` of the egg's cascade. Paper: section 6.6."""
    starts = [tuple(round(x, 5 if each.n < HIGHEST else 6) for x in each.start) for each in members()]

    def certified(problem: Problem, start: tuple[float, ...], digits: int) -> list[arb]:
        return [whole(proof_near(problem, list(start), digits)).value]

    singly = [
        Sought(each.problem, start, last).methods(partial(certified, each.problem, start))
        for each, start in zip(members(), starts, strict=True)
    ]
    together = tuple(_together(methods) for methods in zip(*singly, strict=True))
    return Question(
        "doubling",
        "The doubling cascade, egg",
        f"lambda_{FIRST} to lambda_{HIGHEST}, where periods 4 to 32 double, alpha = {ALPHA}",
        "in lam",
        lambda d: [whole(proof_near(r.problem, list(s), d)).value for r, s in zip(members(), starts, strict=True)],
        (*together, *textbook_doublings()),
    )


def _together(methods: tuple[Method, ...]) -> Method:
    """One method that answers several questions at once; it promises the largest of their errors."""

    def call(setting: Any) -> list[Any]:
        return [x for method in methods for x in method.call(setting)]

    def promise(setting: Any) -> Decimal | None:
        made = [method.promise(setting) for method in methods]
        return max((p for p in made if p is not None), default=None)

    return replace(methods[0], call=call, promise=promise)


def textbook_doublings() -> list[Method]:
    """Textbook methods: `brentq` on the multiplier of a cycle found by shooting, and periods after a transient."""
    book = module("textbook")
    if book is None:
        return []
    map, brackets = PinballMap("egg", lam=1, alpha="2/25"), []
    for each in members():
        period, gap = 2 ** (each.n - 1), 0.002 / 4.67 ** (each.n - FIRST)
        phi = first_exit(Problem(EGG, (0,) * period, lam=Rational(each.lam)), tuple(each.start[:-1]))
        brackets.append(((each.start[0], phi), period, each.lam - gap, each.lam + 0.7 * gap))

    def each_by(way: Callable[..., float]) -> Callable[[Any], list[float]]:
        return lambda setting: [way(map.at, *bracket, setting) for bracket in brackets]

    return [
        textbook("brentq, shooting", each_by(book.flip), "xtol", TOLERANCES),
        textbook("periods of settled particles", each_by(book.doubling_seen), "bounces", (300, 3_000, 30_000)),
    ]
