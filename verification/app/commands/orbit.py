"""Where does this particle go?

`pinball orbit` follows it, `pinball slap` does so at contraction 0, and `pinball cycles` lists the orbits that
return.
"""

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import UNIFORM
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, json_option, plot_option
from verification.app.lines import of_bounces
from verification.app.scene import scene_options, start_of, table_options

if TYPE_CHECKING:
    from rich.console import Console

    from verification.cycles.newton import Solution
    from verification.cycles.search import Catalogue, Found


MOST = 40  # bounces shown to people
WAYS = ("float64", "mpmath", "arb", "auto")
FEW, MANY = 12, 50  # digits, where nothing is said: for auto, and for mpmath and arb
PROVED = "arb, each landing proved to be the first hit"
KEYS = ("component", "theta", "s", "x", "y", "eta", "phi", "status")


@click.command(epilog="Example: pinball orbit ellipse --a 1.5 --lam 0.9 --start 0.5,-0.2 --bounces 10")
@scene_options
@click.option("--start", required=True, metavar="THETA,PHI", help="Boundary parameter and exit angle, in radians.")
@click.option("--component", metavar="NAME", help="The component of the start; the first one if left out.")
@click.option("--bounces", type=click.IntRange(1, 10_000_000), default=20, show_default=True, help="How many.")
@click.option("--arithmetic", type=click.Choice(WAYS), default="float64", show_default=True)
@click.option("--digits", type=click.IntRange(1, 10_000), help="For mpmath and arb [default: 50], and auto [12].")
@click.option("--tolerance", metavar="T", help="In place of --digits: so many that the error is below it.")
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE", help="A table in .npz, .parquet or .zarr.")
@plot_option("results.orbit", "the flights, and the bounces in phase space")
@json_option
def command(
    scene: Scene,
    start: str,
    component: str | None,
    bounces: int,
    arithmetic: str,
    digits: int | None,
    tolerance: str | None,
    out: Path | None,
    output: Output,
) -> int:
    """Where does this particle go? Exit status 1 when it stops at a join, a cusp or a tangency.

    In arb the last digit shown is off by one at most, and every landing is proved to be the first hit; an orbit
    that goes on where that cannot be proved ends as `unproved`. The other outcomes are found, and not proved.
    `auto` takes what is cheapest for the digits asked of the last bounce, and says why: float64 as long as the orbit
    leaves it enough of its own, then arb.
    With --out every bounce is a row of a table of float64 columns, and `component` and `code` are whole numbers; then
    --json has the first bounces only. A .zarr store is written in pieces, and the same command resumes it.
    """
    from numeric import PinballMap

    map = PinballMap(scene)
    names = [part.name for part in map.ir.parts]
    if component is not None and component not in names:
        raise ValueError(f"--component = {component} is not on this table; accepted: {', '.join(names)}")
    index = names.index(component) if component else 0
    theta, phi = start_of(start)
    digits = wanted(digits, tolerance)
    picked: dict[str, str] = {}
    if arithmetic != "float64":
        map.orbit(float(theta), float(phi), 1, index)  # refuses a bad start in one sentence
    if arithmetic == "auto":
        from verification.measure.work.choice import for_orbit

        choice = for_orbit(map, (float(theta), float(phi), index), bounces, digits := digits or FEW)
        arithmetic = choice.arithmetic
        picked = {"arithmetic": arithmetic, "why": choice.why}
    digits = digits or MANY
    if out is not None:
        if arithmetic != "float64":
            raise ValueError(f"--out {out} holds float64 columns; accepted: --arithmetic float64, or --json FILE")
        from numeric.sweeps.orbits import written

        picked |= {"out": str(out), "last": written(map, (float(theta), float(phi), index), bounces, out)}
        output.console.print(f"{bounces + 1} rows are in {out}; the first:")
        bounces = min(bounces, MOST - 1)
    if arithmetic == "float64":
        entries = in_float64(map, float(theta), float(phi), bounces, index)
    else:
        from verification.maps.enclosed import in_balls, in_multiprecision

        follow = in_multiprecision if arithmetic == "mpmath" else in_balls
        with output.progress("Bouncing", bounces) as step:
            entries = follow(map, scene.lam, (theta, phi, index), bounces, digits, step)
    output.write({"bounces": entries} | picked, map, entries)
    show(output.console, entries, {"float64": map.path, "mpmath": f"mpmath, {digits} digits"}.get(arithmetic, PROVED))
    if "why" in picked:
        output.console.print(f"{arithmetic}: {picked['why']}")
    if entries[-1]["status"] == "unproved":
        output.console.print("no proof that the next flight meets nothing before it lands; it is not given")
    statuses = [*(entry["status"] for entry in entries), picked.get("last", "regular")]
    return DONE if all(status == "regular" for status in statuses) else FAILED


def wanted(digits: int | None, tolerance: str | None) -> int | None:
    """The digits asked for, in either way; None where nothing was said."""
    if tolerance is None:
        return digits
    if digits is not None:
        raise ValueError(f"--tolerance = {tolerance} and --digits = {digits} ask for the same thing; give one of them")
    from verification.measure.work.choice import digits_for

    return digits_for(tolerance)


def in_float64(map: Any, theta: float, phi: float, bounces: int, index: int = 0) -> list[dict[str, Any]]:
    """The orbit from the kernels, as far as it goes."""
    orbit = map.orbit(theta, phi, bounces, index)
    names = [part.name for part in map.ir.parts]
    s = map.arclength.s(orbit.theta, orbit.component)
    statuses = [status.name.lower() for status in orbit.status]
    end = next((i for i, status in enumerate(statuses) if status != "regular"), len(statuses) - 1)
    entries = []
    for i in range(end + 1):
        eta = float(orbit.eta[i])
        values = (names[orbit.component[i]], *(float(row[i]) for row in (orbit.theta, s, orbit.x, orbit.y)))
        entries.append(
            dict(zip(KEYS, (*values, None if eta != eta else eta, float(orbit.phi[i]), statuses[i]), strict=True))
        )
    return entries


def show(console: "Console", entries: list[dict[str, Any]], how: str) -> None:
    """The first bounces, as many columns wide as the terminal."""
    for line in of_bounces(entries[:MOST], KEYS, console.width):
        console.print(line)
    if len(entries) > MOST:
        console.print(f"... and {len(entries) - MOST} more; --json FILE has them all")
    console.print(f"{len(entries) - 1} bounces ({how})")


ROWS = 33  # points shown to people


@click.command(epilog="Example: pinball slap egg --alpha 0.08 --iterates 4 --points 1000 --json slap.json")
@table_options
@click.option("--iterates", type=click.IntRange(1, 1000), default=1, show_default=True, help="Up to which power.")
@click.option("--points", type=click.IntRange(2, 1_000_000), default=200, show_default=True, help="On each component.")
@plot_option("results.slap", "the graphs of the iterates, and the slope")
@json_option
def slap_command(scene: Scene, iterates: int, points: int, output: Output) -> int:
    """The slap map: what remains at lambda = 0, where every exit is along the normal."""
    import numpy as np

    from numeric import PinballMap

    map = PinballMap(normal_exits(scene), lam=0)
    names = [part.name for part in map.ir.parts]
    component = np.repeat(np.arange(len(names)), points)
    ends = np.array(map.states.ends)
    share = (np.tile(np.arange(points), len(names)) + 0.5) / points
    theta = ends[component, 0] + (ends[component, 1] - ends[component, 0]) * share
    values = map.slap(theta, iterates, component)
    document = {
        "iterates": iterates,
        "points": [
            {
                "component": names[component[i]],
                "theta": float(theta[i]),
                "images": [
                    {"component": names[values.component[k, i]], "theta": float(values.theta[k, i])}
                    if values.code[k, i] == 0
                    else None
                    for k in range(1, iterates + 1)
                ],
                "slope": float(values.slope[i]),
            }
            for i in range(theta.size)
        ],
    }
    output.write(document, map, component, theta, values)
    rows = range(0, theta.size, max(1, theta.size // ROWS))
    show_slap(
        output.console,
        [(float(theta[i]), [float(x) for x in values.theta[1:, i]], float(values.slope[i])) for i in rows],
    )
    return DONE


def normal_exits(scene: Scene) -> Scene:
    """The scene with the paper's law, whose slap map is that of every law with `phi = 0` at `lam = 0`."""
    if scene.law.uniform:
        return scene
    from symbolic.expressions.signs import vanishes
    from symbolic.tables.table import lam

    if not vanishes(scene.law.phi.subs(lam, 0)):
        said = "does not exit along the normal at lam = 0, as every law does that has a slap map"
        raise ValueError(f"--law: {scene.law} {said}; accepted: laws that vanish there")
    return scene.at(law=UNIFORM)


def show_slap(console: "Console", rows: list[tuple[float, list[float], float]]) -> None:
    """Some points, their images and the slope `T0'(s)`."""
    console.print("theta        slope        images")
    for theta, images, slope in rows:
        console.print(f"{theta:<13.6f}{slope:<13.6f}" + "  ".join(f"{image:.6f}" for image in images[:8]))


CYCLES_MOST = 60  # cycles shown to people


@click.command(epilog="Example: pinball cycles egg --alpha 0.08 --lam 0.5 --period 8 --count 4 --prove 3")
@scene_options
@click.option("--period", type=click.IntRange(2, 24), required=True, help="The longest.")
@click.option("--count", type=click.IntRange(2, 12), help="Count up to this period a second way, on cells.")
@click.option("--prove", type=click.IntRange(2, 6), help="Prove completeness up to this period, in balls.")
@click.option("--budget", type=click.IntRange(1), default=100_000, show_default=True, help="Boxes of a proof.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the starts of the search.")
@plot_option("results.cycles", "the first cycles in the table")
@json_option
def cycles_command(
    scene: Scene, period: int, count: int | None, prove: int | None, budget: int, seed: int, output: Output
) -> int:
    """Which cycles are there, up to a period? Found by search, and completeness shown as far as it can be.

    Exit status 1 when a count does not come out even or a proof stays open; the cycles found are kept.
    """
    from sympy import S

    from verification.cycles.newton import given
    from verification.cycles.problem import Problem
    from verification.cycles.search import ROUNDS, all_cycles

    if prove:
        provable(scene)
    table, lam = scene.table, S(scene.lam)
    with output.progress("Searching", ROUNDS) as tick:
        found = all_cycles(table, lam, period, seed, tick, scene.law)
    catalogue = found.catalogue
    solutions = [
        given(Problem(table, cycle.components, lam=lam, law=scene.law), cycle.theta) for cycle in catalogue.cycles
    ]
    counts = counted(catalogue, count, output) if count else []
    completed = completeness(catalogue, lam, prove, budget, output) if prove else []
    document = {
        "table": scene.name,
        "lam": str(lam),
        **({} if scene.law.uniform else {"law": str(scene.law)}),
        "rounds": found.rounds,
        "degenerate": catalogue.degenerate,
        "periods": [
            {
                "period": n,
                "cycles": catalogue.count(n),
                "index_sums_vanish": found.balanced[n],
                "resolution": catalogue.resolution(n),
            }
            for n in range(2, period + 1)
        ],
        "cycles": [entry(cycle) | worth(solution) for cycle, solution in zip(catalogue.cycles, solutions, strict=True)],
        "second_count": counts,
        "completeness": completed,
    }
    output.write(document, scene, catalogue)
    show_cycles(output.console, catalogue, document)
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
    from verification.cycles.cells import fixed_points
    from verification.maps.first_hit import closes_smoothly, convex

    if not closes_smoothly(catalogue.table) or convex(catalogue.table) is not True:
        raise ValueError(
            f"--count needs a map that is continuous, and {catalogue.table.name} is not proved to be one smooth convex "
            "curve; leave --count out"
        )
    map = PinballMap(catalogue.table, lam=catalogue.lam, law=catalogue.law)
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


def provable(scene: Scene) -> None:
    """Refuses --prove, in a sentence that says why, where its theorem asks for more than the scene has."""
    from symbolic.tables.curves import is_periodic
    from verification.maps.first_hit import closes_smoothly, convex
    from verification.proofs.periodic.interval_newton import stays_below

    if not closes_smoothly(scene.table) or convex(scene.table) is not True:
        raise ValueError(
            f"--prove covers all closed chains of chords of one smooth convex curve, and {scene.name} is not proved to "
            "be one: chains that a wall cuts could not be told from cycles; leave --prove out"
        )
    if not scene.law.uniform:
        stated = scene.law.on(scene.table)
        if stated.placed and not (stated.measured or is_periodic(stated.phi)):
            raise ValueError(
                f"--prove: a whole turn of theta is not seen to leave {stated} the same; leave --prove out"
            )
        if not stays_below(stated, scene.lam, scene.table):
            raise ValueError(f"--prove: |phi| = |{stated}| is not proved to stay below pi/2 by a margin; leave it out")


def completeness(catalogue: "Catalogue", lam: Any, highest: int, budget: int, output: Output) -> list[dict[str, Any]]:
    """What balls prove, period by period."""
    from verification.proofs.periodic.interval_newton import proofs

    with output.progress("Proving", highest - 1) as tick:
        return [
            {"period": found.period, "complete": found.complete, "boxes": found.boxes, "cycles": found.known}
            for found in proofs(catalogue, lam, highest, budget, tick)
        ]


def show_cycles(console: "Console", catalogue: "Catalogue", document: dict[str, Any]) -> None:
    """The cycles, a line each, then what is known about completeness."""
    console.print("period  winding  multipliers                              stable  first bounce")
    for cycle in catalogue.cycles[:CYCLES_MOST]:
        pair = "  ".join(f"{m.real:+.5g}{m.imag:+.4g}i" for m in cycle.spectrum.multipliers)
        stable = "yes" if cycle.spectrum.stable else "no"
        console.print(f"{cycle.period:<8}{cycle.winding:<9}{pair:<41}{stable:<8}{cycle.theta[0]:.9f}")
    if len(catalogue.cycles) > CYCLES_MOST:
        console.print(f"... and {len(catalogue.cycles) - CYCLES_MOST} more; --json FILE has them all")
    if catalogue.degenerate:
        console.print(
            f"{catalogue.degenerate} times a cycle with the multiplier 1 was met, of a family or at a bifurcation; "
            "such are not listed, and the index law does not count them"
        )
    for row in document["periods"]:
        laws = {True: "index sums vanish", False: "index sums do NOT vanish", None: "no index law here"}
        console.print(f"period {row['period']:<3} {row['cycles']:>5} cycles, {laws[row['index_sums_vanish']]}")
    if document["periods"]:
        console.print(document["periods"][-1]["resolution"])
    for row in document["second_count"]:
        said = {True: "agrees with the search", False: "DISAGREES with the search", None: "cells left open"}
        console.print(
            f"cells: T^{row['period']} has {row['positive']} + {row['negative']} fixed points, {said[row['agrees']]}"
        )
    for row in document["completeness"]:
        end = "proved to be all" if row["complete"] else "open, the budget of boxes ended"
        console.print(f"proof: the {row['cycles']} cycles of period {row['period']} are {end} ({row['boxes']} boxes)")
