"""`pinball cycles`: which cycles are there, up to a period?"""

from math import isfinite
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.scene import Scene
from verification.app.shell.cli import DONE, FAILED
from verification.app.shell.output import Output, json_option
from verification.app.shell.scene import scene_options

if TYPE_CHECKING:
    from rich.console import Console

    from verification.cycles.search.catalogue import Catalogue, Found
    from verification.cycles.shooting.newton import Solution

MOST = 60  # cycles shown to people


@click.command(epilog="Example: pinball cycles egg --alpha 0.08 --lam 0.5 --period 8 --count 4 --prove 3")
@scene_options
@click.option("--period", type=click.IntRange(2, 24), required=True, help="The longest.")
@click.option("--count", type=click.IntRange(2, 12), help="Count up to this period a second way, on cells.")
@click.option("--prove", type=click.IntRange(2, 6), help="Prove completeness up to this period, in balls.")
@click.option("--budget", type=click.IntRange(1), default=100_000, show_default=True, help="Boxes of a proof.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the starts of the search.")
@json_option
def command(
    scene: Scene, period: int, count: int | None, prove: int | None, budget: int, seed: int, output: Output
) -> int:
    """Which cycles are there, up to a period? Found by search, and completeness shown as far as it can be.

    Exit status 1 when a count does not come out even or a proof stays open; the cycles found are kept.
    """
    from sympy import S

    from verification.cycles.search.search import ROUNDS, all_cycles
    from verification.cycles.shooting.newton import given
    from verification.cycles.shooting.problem import Problem

    table, lam = scene.table, S(scene.lam)
    with output.progress("Searching", ROUNDS) as tick:
        found = all_cycles(table, lam, period, seed, tick)
    catalogue = found.catalogue
    solutions = [given(Problem(table, cycle.components, lam=lam), cycle.theta) for cycle in catalogue.cycles]
    counts = counted(catalogue, count, output) if count else []
    completed = completeness(catalogue, lam, prove, budget, output) if prove else []
    document = {
        "table": scene.name,
        "lam": str(lam),
        "rounds": found.rounds,
        "degenerate": catalogue.degenerate,
        "periods": [
            {"period": n, "cycles": catalogue.count(n), "index_sums_vanish": found.balanced[n]}
            for n in range(2, period + 1)
        ],
        "cycles": [entry(cycle) | worth(solution) for cycle, solution in zip(catalogue.cycles, solutions, strict=True)],
        "second_count": counts,
        "completeness": completed,
    }
    output.write(document)
    show(output.console, catalogue, document)
    if solutions:
        worst = max(solutions, key=lambda solution: solution.condition)
        output.console.print(f"the worst conditioned cycle has period {len(worst.z)}: {worst.words}")
    even = all(value is not False for value in found.balanced.values()) and all(
        row["agrees"] is not False for row in counts
    )
    return DONE if even and all(row["complete"] for row in completed) else FAILED


def entry(cycle: "Found") -> dict[str, Any]:
    """A cycle for JSON."""
    spectrum = cycle.spectrum
    return {
        "period": cycle.period,
        "winding": cycle.winding,
        "components": list(cycle.components),
        "theta": list(cycle.theta),
        "phi": list(cycle.phi),
        "multipliers": [{"real": m.real, "imaginary": m.imag} for m in spectrum.multipliers],
        "determinant": spectrum.determinant,
        "stable": spectrum.stable,
        "index": cycle.index(cycle.period),
    }


def worth(solution: "Solution") -> dict[str, Any]:
    """What the digits of a cycle are worth, for JSON."""
    condition = solution.condition if isfinite(solution.condition) else None
    return {"condition": condition, "digits_sure": solution.digits_sure, "conditioning": solution.conditioning.name}


def counted(catalogue: "Catalogue", highest: int, output: Output) -> list[dict[str, Any]]:
    """Fixed points of `T**n` on cells against those of the catalogue."""
    from numeric import PinballMap
    from verification.cycles.search.cells import fixed_points
    from verification.maps.admissible import convex

    if len(catalogue.table.components) > 1 or convex(catalogue.table) is not True:
        raise ValueError(f"--count: {catalogue.table.name} is not convex and smooth; leave --count out")
    map = PinballMap(catalogue.table, lam=catalogue.lam)
    rows = []
    with output.progress("Counting", highest - 1) as tick:
        for n in range(2, highest + 1):
            zeros = fixed_points(map, n)
            own = [sum(c.period for c in catalogue.of(n) if c.index(n) == sign) for sign in (1, -1)]
            same = (zeros.positive, zeros.negative) == (own[0], own[1])
            rows.append(
                {
                    "period": n,
                    "positive": zeros.positive,
                    "negative": zeros.negative,
                    "open_cells": zeros.open,
                    "of_the_search": own,
                    "agrees": None if zeros.open else same,
                }
            )
            tick(f"period {n}")
    return rows


def completeness(catalogue: "Catalogue", lam: Any, highest: int, budget: int, output: Output) -> list[dict[str, Any]]:
    """What balls prove, period by period."""
    from verification.proofs.periodic.completeness import proofs

    with output.progress("Proving", highest - 1) as tick:
        return [
            {"period": found.period, "complete": found.complete, "boxes": found.boxes, "cycles": found.known}
            for found in proofs(catalogue, lam, highest, budget, tick)
        ]


def show(console: "Console", catalogue: "Catalogue", document: dict[str, Any]) -> None:
    """The cycles, a line each, then what is known about completeness."""
    console.print("period  winding  multipliers                              stable  first bounce")
    for cycle in catalogue.cycles[:MOST]:
        pair = "  ".join(f"{m.real:+.5g}{m.imag:+.4g}i" for m in cycle.spectrum.multipliers)
        stable = "yes" if cycle.spectrum.stable else "no"
        console.print(f"{cycle.period:<8}{cycle.winding:<9}{pair:<41}{stable:<8}{cycle.theta[0]:.9f}")
    if len(catalogue.cycles) > MOST:
        console.print(f"... and {len(catalogue.cycles) - MOST} more; --json FILE has them all")
    if catalogue.degenerate:
        console.print(
            f"{catalogue.degenerate} times a cycle with the multiplier 1 was met, of a family or at a bifurcation; "
            "such are not listed, and the index law does not count them"
        )
    for row in document["periods"]:
        laws = {True: "index sums vanish", False: "index sums do NOT vanish", None: "no index law here"}
        console.print(f"period {row['period']:<3} {row['cycles']:>5} cycles, {laws[row['index_sums_vanish']]}")
    for row in document["second_count"]:
        said = {True: "agrees with the search", False: "DISAGREES with the search", None: "cells left open"}
        console.print(
            f"cells: T^{row['period']} has {row['positive']} + {row['negative']} fixed points, {said[row['agrees']]}"
        )
    for row in document["completeness"]:
        end = "proved to be all" if row["complete"] else "open, the budget of boxes ended"
        console.print(f"proof: the {row['cycles']} cycles of period {row['period']} are {end} ({row['boxes']} boxes)")
