"""`pinball follow`: what becomes of this cycle as lambda, or the table's shape, changes?"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, Whole, json_option, plot_option
from verification.app.scene import varied_options

if TYPE_CHECKING:
    from fractions import Fraction

    from rich.console import Console
    from sympy import Expr

    from symbolic.tables.table import Table
    from verification.cycles.branch import Branch
    from verification.named.events import Plane

ALONE = "alone"  # the value of --curves without a parameter
ROWS = 12  # points of a branch shown to people, and all its events


@click.command(epilog="Example: pinball follow egg --alpha 0.08 --cycle triangle --lam 0.37:1 --digits 20")
@varied_options
@click.option("--lam", "interval", required=True, metavar="LOW:HIGH", help="The contractions, between 0 and 1.")
@click.option("--cycle", metavar="NAME", help="A cycle of the paper: diameter, triangle, horizontal, ...")
@click.option("--start", metavar="THETA,...", help="Or the bounces of one, roughly.")
@click.option("--components", metavar="NAME,...", help="Where the bounces of --start lie, on a table of several parts.")
@click.option("--at", metavar="NUMBER", help="The contraction of the start; LOW, or the named cycle's own.")
@click.option("--points", type=Whole(2, 100_000), default=400, show_default=True, help="At most, each way.")
@click.option("--switch", type=Whole(0, 12), default=0, show_default=True, help="Crossroads to turn off at.")
@click.option(
    "--curves",
    is_flag=False,
    flag_value=ALONE,
    metavar="[NAME=LOW:HIGH]",
    help="Follow the events on in a second parameter, with lam or the shape; the egg's is alpha if none is named.",
)
@click.option("--all", "whole", is_flag=True, help="Follow every cycle that random starts end on at some value.")
@click.option("--digits", type=Whole(1, 1000), help="Certify the events to so many digits.")
@plot_option("dynamics.plotted", "the branches")
@json_option
def command(
    scene: Scene,
    axis: str | None,
    interval: str,
    cycle: str | None,
    start: str | None,
    components: str | None,
    at: str | None,
    points: int,
    switch: int,
    curves: str | None,
    whole: bool,
    digits: int | None,
    output: Output,
) -> int:
    """What becomes of this cycle as lambda changes? Followed through folds, with every event on the way.

    With --shape [NAME=]LOW:HIGH, or NAME=VALUE:LOW..HIGH, and one number for --lam, a parameter of the table or of the
    law varies; the start is then a cycle at the scene's own value of it. Exit status 1 when a branch stops inside the
    interval; what was found is kept. With --all no start is given: all families of cycles that attract random starts at
    some values are followed. Random starts at other values then show whether an attractor was missed, with exit status
    1 if so.
    """
    from verification.cycles.arc import Steps
    from verification.cycles.branch import at_contraction, branch, named, record, typed
    from verification.cycles.crossing import continued
    from verification.named.questions import law_over

    shape = axis or (ranged(scene) if ":" not in interval else None)
    if whole:
        return all_families(scene, shape, interval, digits or 20, output)
    if (cycle is None) == (start is None):
        raise ValueError("one start is needed; accepted: --cycle NAME, or --start THETA,... with two bounces or more")
    parameter, ends = varied(scene, shape) if shape else ("lam", interval)
    low, high = interval_of(f"--{'shape' if shape else 'lam'}", ends)
    lam = contraction(interval) if shape else None
    if lam is not None and not scene.law.uniform:
        scene = scene.at(lam=lam)
    plane = plane_of(scene, curves, parameter, ends) if curves else None
    law = law_over(scene, parameter, ends.split(":"))
    table = scene.table
    if cycle is not None:
        ring, x, own = named(cycle, table)
    else:
        names = components.split(",") if components else None
        (ring, x), own = typed(table, [float(exact("--start", t)) for t in str(start).split(",")], names), None
    ring = replace(ring, law=scene.law)
    first = low if lam is None else float(lam)
    value, fixed = float(exact("--at", at)) if at is not None else first if own is None else own, {}
    if lam is not None:
        x, fixed = at_contraction(ring, x, value, float(lam)), {"lam": float(lam)}
        if parameter in scene.shape:
            ring = replace(ring, table=over(scene, parameter, ends))
        value = float({**scene.shape, **own_numbers(scene)}[parameter])
    ring = replace(ring, law=law)
    steps = Steps(most=points)
    with output.progress("Following", points) as tick:
        found = [
            branch(ring, x, parameter, value, (low, high), fixed, steps, lambda p: tick(f"{parameter} = {p.z[-1]:.4f}"))
        ]
        found[0] = continued(found[0], (low, high), steps, lambda p: tick(f"{parameter} = {p.z[-1]:.4f}"))
        found += turned_off(found[0], (low, high), steps, switch)
    certificates = {}
    if digits:
        events = [event for one in found for event in one.along]
        with output.progress("Certifying", len(events)) as tick:
            for event in events:
                certificates[id(event)] = certificate(event, digits, parameter, lam)
                tick(event.kind.value)
    documents = []
    for one in found:
        document = record(one)
        document["events"] = [noted(event, parameter, certificates.get(id(event))) for event in one.along]
        documents.append(document)
    drawn_on = curves_of(found, plane, scene, lam, output) if plane else []
    output.write({"table": scene.name, "branches": documents, "curves": drawn_on}, found)
    for document in documents:
        show(output.console, document)
    for row in drawn_on:
        show_curve(output.console, row)
    return told(output.console, found)


def all_families(scene: Scene, shape: str | None, interval: str, digits: int, output: Output) -> int:
    """Follows and prints every family that attracts random starts, with events and a check; returns the exit status."""
    from verification.named.bifurcations import bifurcations

    parameter, ends = varied(scene, shape) if shape else ("lam", interval)
    interval_of(f"--{'shape' if shape else 'lam'}", ends)
    here = scene.at(lam=contraction(interval)) if shape else scene
    with output.progress("Following", 100) as tick:
        given: dict[str, Any] = {parameter: tuple(ends.split(":"))}
        found = bifurcations(here, tick=tick, **given)
    checked = found.check()
    document = {"table": scene.name, **found.document(digits), "check": checked.document()}
    output.write(document, [family.branch for family in found.families])
    for number, one in enumerate(document["branches"]):
        ranges = ", ".join(f"{low:.9g} to {high:.9g}" for low, high in one["attracts"]) or "nowhere"
        said = f"branch {number}, period {one['period']}, {one['symmetry']}: {one['low']:.9g} to {one['high']:.9g}"
        output.console.print(f"{said}; attracts {ranges}")
    for one in document["events"]:
        value = f"{one['value']} +- {one['radius']}" if one["radius"] else one["value"]
        born = "" if one["born"] is None else f"; branch {one['born']} is born"
        output.console.print(f"{one['kind']} of period {one['period']} at {parameter} = {value}{born}")
    for one in document["ranges"]:
        (a, b), (c, d) = one["low"], one["high"]
        output.console.print(f"{one['kind']} from between {a:.6g} and {b:.6g} to between {c:.6g} and {d:.6g}")
    output.console.print(checked.words)
    return DONE if not checked.missing else FAILED


def interval_of(option: str, text: str) -> tuple[float, float]:
    """The two numbers of the text `LOW:HIGH`.

    >>> interval_of("--lam", "0.25:1/2")
    (0.25, 0.5)
    """
    parts = text.split(":")
    if len(parts) != 2:
        raise ValueError(f"{option} {text!r} is no interval; accepted: LOW:HIGH such as 0.37:1")
    low, high = (float(exact(option, part)) for part in parts)
    if option == "--lam" and not 0 <= low < high <= 1:
        raise ValueError(f"--lam {text} is no interval of contractions; accepted: LOW:HIGH with 0 <= LOW < HIGH <= 1")
    if not low < high:
        raise ValueError(f"{option} {text} is no interval; accepted: LOW:HIGH with LOW < HIGH")
    return low, high


def own_numbers(scene: Scene) -> dict[str, Any]:
    """The exact values of the law's own parameters, by name."""
    return {name: exact(name, text) for name, text in scene.law.numbers}


def ranged(scene: Scene) -> str | None:
    """The parameter with a range, as `NAME=LOW:HIGH`; None if there is none, `ValueError` if there are several."""
    found = [f"{name}={low}:{high}" for name, (low, high) in scene.ranges.items()]
    if len(found) > 1:
        raise ValueError(f"--lam is one number, {', '.join(scene.ranges)} have ranges; pick one: --shape {found[0]}")
    return next(iter(found), None)


def varied(scene: Scene, shape: str) -> tuple[str, str]:
    """The name of the parameter of the table or the law that --shape varies, and its interval as text."""
    name, given, ends = shape.rpartition("=")
    known = [*scene.shape, *dict(scene.law.numbers)]
    if not known:
        raise ValueError(
            f"--shape: {scene.name} has no shape parameter; accepted: the ellipse, the egg, and tables with parameters "
            "of their own or with named lengths, as in straight=1:3"
        )
    if given and name not in known:
        raise ValueError(f"--shape {shape}: {name} is no parameter that varies here; accepted: {', '.join(known)}")
    if not given and len(scene.shape or known) > 1:
        raise ValueError(f"--shape {shape}: say which of {', '.join(known)} varies, as in {known[0]}={ends}")
    return name or known[0], ends


def over(scene: Scene, parameter: str, ends: str) -> "Table":
    """The table with `parameter` free over the interval `ends`; the error names a value at which no table exists."""
    try:
        return scene.over(parameter, *ends.split(":"))
    except ValueError as why:
        raise ValueError(f"--shape: {why}") from None


def contraction(text: str) -> "Fraction | Expr":
    """The value of `--lam`, which must be one number when the shape varies."""
    lam = exact("--lam", text) if ":" not in text else -1
    if not 0 <= lam <= 1:
        raise ValueError(f"--lam {text} with --shape is no contraction; accepted: one number between 0 and 1")
    return lam


def turned_off(first: "Branch", interval: tuple[float, float], steps: Any, depth: int) -> list["Branch"]:
    """The branches born at events of `first`, those born at events of these, and so on, `depth` times."""
    from verification.cycles.arc import LostError
    from verification.cycles.switching import switched

    found, newest = [], [first]
    for _ in range(depth):
        following = []
        for whole, piece in ((branch, piece) for branch in newest for piece in branch.each):
            passed = {each.system.recurrence for each in whole.pieces}
            for event in piece.along:
                try:
                    others = switched(piece, event, interval, steps)
                except LostError:
                    continue
                following += [b for b in others if not (event.collision and b.system.recurrence in passed)]
        found += following
        newest = following
    return found


def certificate(event: Any, digits: int, parameter: str, lam: Any) -> dict[str, Any] | None:
    """Value, radius and checklist of an event's proof as JSON, or None where it has no certificate."""
    from verification.arithmetic.balls import decimal
    from verification.named.events import proof_of

    try:
        proof = proof_of(event, digits, parameter, lam)
    except ValueError:
        return None
    if proof is None:
        return None
    value, radius = decimal(proof.value, digits + 1)
    return {"value": value, "radius": radius, "certified": proof.proved, "checks": proof.checks}


def noted(event: Any, parameter: str, proof: dict[str, Any] | None) -> dict[str, Any]:
    """An event of a branch as JSON."""
    form = event.form
    return {
        "event": event.kind.value,
        parameter: event.value,
        "located": event.located,
        "birth": event.birth,
        "theta": [float(x) for x in event.point.z[:-1]],
        "branch_coefficient": form.branch if form else None,
        "supercritical": form.supercritical if form else None,
        "certificate": proof,
        **({"collision": event.collision.value} if event.collision else {}),
    }


def plane_of(scene: Scene, curves: str, parameter: str, ends: str) -> "Plane":
    """The plane of the parameter that the branch varies and the one that --curves names; one of the two is `lam`."""
    from verification.named.events import Plane

    known = [*scene.shape, *dict(scene.law.numbers)]
    name, equals, second = (part.strip() for part in curves.partition("="))
    if curves == ALONE:
        if parameter == "lam" and scene.name == "egg":
            return Plane.of_egg(scene.K)
        if parameter == "lam":
            one = f"{known[0]}=LOW:HIGH" if known else "a table with a shape"
            raise ValueError(f"--curves: a second parameter is needed with {scene.name}; accepted: {one}")
        name, equals, second = "lam", "=", "0:1"
    others = known if parameter == "lam" else ["lam"]
    if not equals or name not in others:
        accepted = f"NAME=LOW:HIGH with one of {', '.join(others)}" if others else "a table with a shape"
        raise ValueError(f"--curves {curves}: {name} is no second parameter here; accepted: {accepted}")
    interval_of("--lam" if name == "lam" else "--curves", second)
    shape, lams = (ends, second) if name == "lam" else (second, ends)
    low, high = shape.split(":")
    least, most = lams.split(":")
    return Plane.of(scene, parameter if name == "lam" else name, (low, high), (least, most))


def curves_of(branches: list["Branch"], plane: "Plane", scene: Scene, lam: Any, output: Output) -> list[dict[str, Any]]:
    """The curves that events trace in a plane of two parameters, as JSON, each with its points of codimension two."""
    from verification.named.events import curve_of

    events = [(one.system.recurrence.period, event) for one in branches for event in one.events]
    name, rows = plane.two[0], []
    own = float({**scene.shape, **own_numbers(scene)}[name])
    with output.progress("Drawing", len(events)) as tick:
        for period, event in events:
            found = curve_of(event, plane, (own, event.value) if lam is None else (event.value, float(lam)))
            tick(event.kind.value)
            if found is not None:
                special = [
                    {"what": point.kind.value, name: point.parameters[0], "lam": point.parameters[1]}
                    for point in found.special
                ]
                points = [[float(x) for x in row] for row in found.plane]
                rows.append({"event": event.kind.value, "period": period, f"{name}_lam": points, "special": special})
    return rows


def show_curve(console: "Console", row: dict[str, Any]) -> None:
    """Prints where a curve starts and ends, and its special points."""
    key = next(key for key in row if key.endswith("_lam"))
    name, points = key.removesuffix("_lam"), row[key]
    first, last = points[0], points[-1]
    console.print(
        f"curve of the {row['event']} of period {row['period']}: ({name}, lam) from ({first[0]:.6f}, {first[1]:.6f}) "
        f"to ({last[0]:.6f}, {last[1]:.6f})"
    )
    for point in row["special"]:
        console.print(f"  {point['what']} at ({point[name]:.9f}, {point['lam']:.9f})")


def show(console: "Console", document: dict[str, Any]) -> None:
    """Prints the events of a branch, then some of its points."""
    points, parameter = document["points"], document["parameter"]
    stride = max(1, len(points) // ROWS)
    console.print(f"{document['cycle']}: {len(points)} points")
    for event in document["events"]:
        proof = event["certificate"]
        said = (
            f"{proof['value']} +- {proof['radius']} ({'' if proof['certified'] else 'not '}certified)"
            if proof
            else (f"{event[parameter]:.12g}")
        )
        side = {True: ", supercritical", False: ", subcritical", None: ""}[event["supercritical"]]
        turns = ": here the branch turns, born of a cycle that repeats itself" if event["birth"] else ""
        turns = f", {event['collision']}" if "collision" in event else turns
        console.print(f"  {event['event']} at {parameter} = {said}{side}{turns}")
    console.print(f"  {parameter:<14}  multipliers                            stability   event")
    for i, point in enumerate(points):
        if i % stride and not point["event"] and i != len(points) - 1:
            continue
        shown = "  ".join(f"{m['real']:+.6f}{m['imaginary']:+.6f}i" for m in point["multipliers"])
        console.print(f"  {point[parameter]:<14.9f}  {shown:<38} {said_stable(point):11} {point['event'] or ''}")


def said_stable(point: dict[str, Any]) -> str:
    """The stability of a point of a branch in words; `-` at an event, where it changes."""
    return "-" if point["event"] else str(point["stability"])


def told(console: "Console", branches: list["Branch"]) -> int:
    """Prints where and why branches stopped inside the interval, and returns the exit status."""
    from verification.cycles.arc import End

    status = DONE
    for one in branches:
        for point, (end, why) in zip((one.points[0], one.points[-1]), one.ends, strict=True):
            if end in (End.OBSTACLE, End.LOST, End.ENOUGH):
                console.print(
                    f"{one.system.label}: the branch stopped at {one.system.parameter} = {point.z[-1]:.9g}: {why}"
                )
                status = DONE if end is End.ENOUGH and status == DONE else FAILED
    return status
