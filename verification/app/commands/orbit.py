"""`pinball orbit` follows a particle, `pinball slap` does so at contraction 0, `pinball cycles` lists cycles."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import UNIFORM, exact
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, Whole, json_option, plot_option
from verification.app.lines import of_bounces, short, table
from verification.app.scene import scene_options, table_options

if TYPE_CHECKING:
    from rich.console import Console

    from verification.app.commands.starts import Start
    from verification.cycles.newton import Solution
    from verification.cycles.search import Catalogue, Found


MOST = 40  # bounces shown to people
WAYS = ("float64", "mpmath", "arb", "auto")
FEW, MANY = 12, 50  # digits without --digits: for auto, and for mpmath and arb
PROVED = "arb, each landing proved to be the first hit"
CUT = 60  # particles shown to people


@click.command(epilog="Example: pinball orbit ellipse --a 1.5 --lam 0.9 --start 0.5,-0.2 --bounces 10")
@scene_options
@click.option("--start", metavar="THETA,PHI", help="Boundary parameter, or s=ARC LENGTH, and exit angle in radians.")
@click.option("--from", "point", metavar="X,Y", help="Start at an interior point; the first wall is the first bounce.")
@click.option("--towards", metavar="DX,DY", help="The direction of --from; or one angle from the x axis, in radians.")
@click.option("--starts", type=click.Path(path_type=Path), metavar="FILE", help="Many starts: a CSV file, see below.")
@click.option("--component", metavar="NAME", help="The component of the start; the first one if left out.")
@click.option("--bounces", type=Whole(1, 10_000_000), default=20, show_default=True, help="How many.")
@click.option("--door", metavar="LOW:HIGH", help="An opening, by arc length: what lands in it has escaped.")
@click.option("--fields", metavar="NAME,...", help="What each bounce is asked for, such as x,y,flight,time.")
@click.option("--arithmetic", type=click.Choice(WAYS), default="float64", show_default=True)
@click.option("--digits", type=Whole(1, 10_000), help="For mpmath and arb [default: 50], and auto [12].")
@click.option("--tolerance", metavar="T", help="In place of --digits: the error; with --data: gaps closed.")
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE", help="A table: .csv, .npz, .parquet or .zarr.")
@plot_option("results.orbit", "the flights, and the bounces in phase space")
@json_option
def command(
    scene: Scene,
    start: str | None,
    point: str | None,
    towards: str | None,
    starts: Path | None,
    component: str | None,
    bounces: int,
    door: str | None,
    fields: str | None,
    arithmetic: str,
    digits: int | None,
    tolerance: str | None,
    out: Path | None,
    output: Output,
) -> int:
    """Where does this particle go? Exit status 1 when it stops at a join, a cusp or a tangency.

    In arb the last digit shown is off by one at most, and every landing is proved to be the first hit; an orbit ends as
    `unproved` where this cannot be proved. The other outcomes are computed, but not proved. `auto` takes the cheapest
    arithmetic that has the wanted digits at the last bounce, and says why: float64 as long as the orbit leaves it
    enough correct digits, else arb.

    The first line of a --starts file names its columns (theta,phi or theta,phi,component or s,phi or x,y,dx,dy or
    x,y,angle). Of --fields, `flight` is the length of the flight before a bounce and `time` the length of all flights
    so far. Only the fields asked for are computed; mpmath and arb compute arc lengths only for --json or --fields. With
    a --door, a particle that lands between two arc lengths ends as `escaped`, and its number of bounces is printed.
    With --out every bounce is a row of a table of float64 columns, and `component` and `code` are whole numbers; then
    --json has the first bounces only. A .zarr store is written in pieces, and the same command resumes it.
    """
    from numeric import PinballMap
    from numeric.pinball.states import KEYS
    from verification.app.commands.starts import chosen, fields_of

    map, named = PinballMap(scene), fields_of(fields)
    particles = chosen(map, start, point, towards, component, starts)
    first = particles[0]
    digits = wanted(digits, tolerance)
    picked: dict[str, Any] = {}
    if door is not None and (arithmetic != "float64" or out is not None):
        raise ValueError(f"--door {door} is for float64 orbits shown on screen; leave out --arithmetic and --out")
    opening = opened(map, door) if door is not None else None
    if arithmetic != "float64":
        if len(particles) > 1 or first.given is None:
            raise ValueError(
                f"--arithmetic {arithmetic} takes one exact start on the wall; accepted: --start THETA,PHI, or float64"
            )
        map.orbit(first.theta, first.phi, 1, first.component)  # refuses a bad start in one sentence
    if arithmetic == "auto":
        from verification.measure.work.choice import for_orbit

        choice = for_orbit(map, (first.theta, first.phi, first.component), bounces, digits := digits or FEW)
        arithmetic = choice.arithmetic
        picked = {"arithmetic": arithmetic, "why": choice.why}
    digits = digits or MANY
    if output.plot is not None and len(particles) > 1:
        raise ValueError(f"--plot {output.plot} draws one particle, and --starts {starts} has {len(particles)}")
    if out is not None:
        if arithmetic != "float64":
            raise ValueError(f"--out {out} holds float64 columns; accepted: --arithmetic float64, or --json FILE")
        from verification.app.commands.starts import written

        picked |= {"out": str(out), "last": written(map, particles, bounces, out, named)}
        rows = (bounces + 1) * len(particles)
        output.console.print(f"{rows} rows are in {out}; the first:")
        bounces = min(bounces, MOST - 1)
    shown = named or KEYS
    if arithmetic != "float64" and named is None and output.path is None and output.plot is None:
        shown = tuple(name for name in KEYS if name != "s")
    extra = (*(("s",) if opening else ()), *(("x", "y", "s", "phi") if output.plot is not None else ()))
    asked = tuple(dict.fromkeys((*shown, *extra)))
    if arithmetic == "float64":
        told = in_float64(map, particles, bounces, asked)
        times = [escape(entries, opening) for entries in told] if opening else []
    else:
        from verification.maps.orbits import in_balls, in_multiprecision

        follow = in_multiprecision if arithmetic == "mpmath" else in_balls
        assert first.given is not None
        with output.progress("Bouncing", bounces) as step:
            told = [follow(map, scene.lam, (*first.given, first.component), bounces, digits, step, asked)]
    if opening:
        picked["escape_times"] = times
    lists = [[{name: entry[name] for name in shown} for entry in entries] for entries in told]
    body: dict[str, Any] = {"bounces": lists[0]} if starts is None else {"particles": [{"bounces": x} for x in lists]}
    output.write(body | picked, map, told[0])
    if starts is None:
        how = {"float64": map.path, "mpmath": f"mpmath, {digits} digits"}.get(arithmetic, PROVED)
        show(output.console, lists[0], shown, how)
    else:
        show_ends(output.console, told, shown)
    if opening:
        output.console.print(escapes(times, bounces))
    if "why" in picked:
        output.console.print(f"{arithmetic}: {picked['why']}")
    if told[0][-1]["status"] == "unproved":
        output.console.print("the next bounce is not given: no proof that its flight meets nothing before it lands")
    statuses = [*(entries[-1]["status"] for entries in told), picked.get("last", "regular")]
    return DONE if all(status in ("regular", "escaped") for status in statuses) else FAILED


def opened(map: Any, text: str) -> tuple[float, float]:
    """The two ends of a door as arc lengths, counterclockwise; the point where arc length jumps may lie inside."""
    half, parts = map.arclength.perimeter / 2, text.split(":")
    try:
        low, high = (float(exact("--door", part)) for part in parts)
    except ValueError:
        raise ValueError(f"--door {text} is no opening; accepted: LOW:HIGH, two arc lengths such as 0.1:1/4") from None
    if low == high or not (-half <= low <= half and -half <= high <= half):
        raise ValueError(f"--door {text} is out of range; accepted: two arc lengths from {-half:.6g} to {half:.6g}")
    return low, high


def escape(entries: list[dict[str, Any]], door: tuple[float, float]) -> int | None:
    """The number of bounces until a particle lands in a door, or None; `entries` is cut off after this bounce."""
    low, high = door
    for bounce, entry in enumerate(entries[1:], 1):
        s = entry["s"] if entry["status"] == "regular" else None
        if s is not None and (low <= s <= high if low < high else s >= low or s <= high):
            entry["status"] = "escaped"
            del entries[bounce + 1 :]
            return bounce
    return None


def escapes(times: Sequence[int | None], bounces: int) -> str:
    """A sentence on how many particles escaped, and after how many bounces.

    >>> escapes([3, None, 5], 100)
    '2 of 3 particles escaped within 100 bounces, after 4 on average, the last after 5'
    """
    found = [time for time in times if time is not None]
    said = f"{len(found)} of {len(times)} particles escaped within {bounces} bounces"
    return f"{said}, after {sum(found) / len(found):g} on average, the last after {max(found)}" if found else said


def wanted(digits: int | None, tolerance: str | None) -> int | None:
    """The number of digits that --digits or --tolerance asks for; None if neither is given."""
    if tolerance is None:
        return digits
    if digits is not None:
        raise ValueError(f"--tolerance = {tolerance} and --digits = {digits} ask for the same thing; give one of them")
    from verification.measure.work.choice import digits_for

    return digits_for(tolerance)


def in_float64(map: Any, particles: "list[Start]", bounces: int, fields: Sequence[str]) -> list[list[dict[str, Any]]]:
    """The bounces of each particle until it stops, computed by the float64 kernels."""
    from verification.app.commands.starts import columns, entries_of

    found = columns(map, particles, bounces, fields)
    return [entries_of(map, found, i) for i in range(len(particles))]


def show(console: "Console", entries: list[dict[str, Any]], keys: Sequence[str], how: str) -> None:
    """Prints the first bounces, with as many columns as fit the terminal."""
    for line in of_bounces(entries[:MOST], keys, console.width):
        console.print(line)
    if len(entries) > MOST:
        console.print(f"... and {len(entries) - MOST} more; --json FILE has them all")
    console.print(f"{len(entries) - 1} bounces ({how})")


def show_ends(console: "Console", told: list[list[dict[str, Any]]], keys: Sequence[str]) -> None:
    """Prints the last bounce of each particle."""
    ends = [{"particle": str(i), "bounces": str(len(each) - 1), **each[-1]} for i, each in enumerate(told)]
    names = ["particle", "bounces", *keys, *(() if "status" in keys else ("status",))]
    rows = [[short(end[name]) for name in names] for end in ends[:CUT]]
    for line in table(names, rows):
        console.print(line)
    if len(ends) > CUT:
        console.print(f"... and {len(ends) - CUT} more; --json FILE has them all")


ROWS = 33  # points shown to people


def _only_zero(context: click.Context, option: click.Parameter, value: str | None) -> None:
    """Refuses a contraction other than 0."""
    if value is not None and exact("--lam", value) != 0:
        raise ValueError(f"--lam {value}: the slap map is the limit at lam = 0; leave --lam out")


@click.command(epilog="Example: pinball slap egg --alpha 0.08 --iterates 4 --points 1000 --json slap.json")
@table_options
@click.option("--lam", hidden=True, expose_value=False, callback=_only_zero)
@click.option("--iterates", type=Whole(1, 1000), default=1, show_default=True, help="Up to which power.")
@click.option("--points", type=Whole(2, 1_000_000), default=200, show_default=True, help="On each component.")
@plot_option("results.slap", "the graphs of the iterates, and the slope")
@json_option
def slap_command(scene: Scene, iterates: int, points: int, output: Output) -> int:
    """The slap map: the limit at lambda = 0, where every particle leaves along the normal."""
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
    """The scene with the paper's law; its slap map is that of every law which exits along the normal at `lam = 0`."""
    if scene.law.uniform:
        return scene
    from symbolic.expressions.signs import vanishes
    from symbolic.tables.table import lam

    if not vanishes(scene.law.phi.subs(lam, 0)):
        said = "does not exit along the normal at lam = 0, so it has no slap map"
        raise ValueError(f"--law: {scene.law} {said}; accepted: laws that are 0 at lam = 0")
    return scene.at(law=UNIFORM)


def show_slap(console: "Console", rows: list[tuple[float, list[float], float]]) -> None:
    """Prints some points, their images and the slope `T0'(s)`."""
    console.print("theta        slope        images")
    for theta, images, slope in rows:
        console.print(f"{short(theta):<13}{short(slope):<13}" + "  ".join(map(short, images[:8])))


CYCLES_MOST = 60  # cycles shown to people


@click.command(epilog="Example: pinball cycles egg --alpha 0.08 --lam 0.5 --period 8 --count 4 --prove 3")
@scene_options
@click.option("--period", type=Whole(2, 24), required=True, help="The longest.")
@click.option("--count", type=Whole(2, 12), help="Count up to this period a second way, on cells.")
@click.option("--prove", type=Whole(2, 6), help="Prove completeness up to this period, in balls.")
@click.option("--budget", type=Whole(1), default=100_000, show_default=True, help="Boxes of a proof.")
@click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of the starts of the search.")
@plot_option("results.cycles", "the first cycles in the table")
@json_option
def cycles_command(
    scene: Scene, period: int, count: int | None, prove: int | None, budget: int, seed: int, output: Output
) -> int:
    """Lists the cycles up to a period, found by a search, and shows as far as possible whether the list is complete.

    Exit status 1 when the cycles found do not account for a count, or a proof stays open; the cycles are kept.
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
    """A cycle as JSON."""
    spectrum = cycle.spectrum
    return {
        "period": cycle.period,
        "winding": cycle.winding,
        "components": list(cycle.components),
        "theta": list(cycle.theta),
        "phi": list(cycle.phi),
        "multipliers": [{"real": m.real, "imaginary": m.imag} for m in spectrum.multipliers],
        "determinant": spectrum.determinant,
        "stable": spectrum.stable if cycle.one_sided is None else cycle.stability.value == "stable",
        "stability": cycle.stability.value,
        "index": cycle.index(cycle.period),
        "one_sided": bool(cycle.one_sided),
        **({"sides": cycle.one_sided.value} if cycle.one_sided else {}),
        "length": cycle.length,
    }


def worth(solution: "Solution") -> dict[str, Any]:
    """Condition number and reliable digits of a computed cycle, as JSON."""
    condition = solution.condition if isfinite(solution.condition) else None
    return {"condition": condition, "digits_sure": solution.digits_sure, "conditioning": solution.conditioning.name}


def counted(catalogue: "Catalogue", highest: int, output: Output) -> list[dict[str, Any]]:
    """For each period n, as JSON: the number of fixed points of `T**n`, as counted on cells and as in the catalogue."""
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
    """Raises `ValueError`, with the reason, if the theorem behind --prove does not apply to the scene."""
    from symbolic.tables.curves import is_periodic
    from verification.maps.first_hit import convex
    from verification.proofs.periodic.completeness import one_smooth_curve, stays_below

    if not one_smooth_curve(scene.table, scene.law) or convex(scene.table) is not True:
        raise ValueError(
            f"--prove: {scene.name} is not proved to be one smooth strictly convex curve, so that a closed chain "
            "of chords may cross its wall and is then no cycle; leave --prove out"
        )
    if not scene.law.uniform:
        stated = scene.law.on(scene.table)
        if stated.placed and not (stated.measured or is_periodic(stated.phi)):
            raise ValueError(f"--prove: {stated} is not proved to have period 2*pi in theta; leave --prove out")
        if not stays_below(stated, scene.lam, scene.table):
            unproved = f"|phi| = |{stated}| is not proved to stay below pi/2 by a margin"
            raise ValueError(f"--prove: {unproved}; leave --prove out")


def completeness(catalogue: "Catalogue", lam: Any, highest: int, budget: int, output: Output) -> list[dict[str, Any]]:
    """For each period, as JSON: whether the cycles found are proved to be all."""
    from verification.proofs.periodic.completeness import proofs

    with output.progress("Proving", highest - 1) as tick:
        return [
            {"period": found.period, "complete": found.complete, "boxes": found.boxes, "cycles": found.known}
            for found in proofs(catalogue, lam, highest, budget, tick)
        ]


def show_cycles(console: "Console", catalogue: "Catalogue", document: dict[str, Any]) -> None:
    """Prints the cycles, a line each, then what is known about completeness."""
    console.print("period winding multipliers            stability length      first bounce")
    for cycle in catalogue.cycles[:CYCLES_MOST]:
        one, other = cycle.spectrum.multipliers
        pair = f"{one.real:+.5g} +- {abs(one.imag):.5g}i" if one.imag else f"{one.real:+.5g}  {other.real:+.5g}"
        stability, parts = cycle.stability.value, catalogue.table.components
        first = f"{cycle.theta[0]:.9f}" + (f" on {parts[cycle.components[0]].name}" if len(parts) > 1 else "")
        console.print(f"{cycle.period:<7}{cycle.winding:<8}{pair:<23}{stability:<10}{cycle.length:<12.9g}{first}")
    if len(catalogue.cycles) > CYCLES_MOST:
        console.print(f"... and {len(catalogue.cycles) - CYCLES_MOST} more; --json FILE has them all")
    if catalogue.degenerate:
        console.print(
            f"{catalogue.degenerate} times a cycle with the multiplier 1 was met, of a family or at a bifurcation; "
            "such are not listed, and the index law does not count them"
        )
    if on_joins := [cycle for cycle in catalogue.cycles if cycle.one_sided]:
        why = "a bounce lies on a join where the curvature jumps: multipliers are those of the component behind it"
        console.print(f"some multipliers are one-sided; {why}")
        for cycle in on_joins[:CYCLES_MOST]:
            where, sides = catalogue.table.components[cycle.components[0]].name, cycle.one_sided
            place = f"period {cycle.period}, {cycle.theta[0]:.9f} on {where}"
            console.print(f"{place}: {sides.value if sides else ''}")
    for row in document["periods"]:
        laws = {True: "index sums vanish", False: "index sums do NOT vanish", None: "no index law here"}
        if row["index_sums_vanish"] is False and not row["cycles"]:
            laws[False] = "but a smooth convex curve has two double normals: some were missed"
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
