"""`pinball morse`: which attractors and repellers are proved, and in what order do orbits pass through them?

`pinball sweep morse-graphs` answers this for each box of a parameter grid, and finds the graphs that continue.
"""

import json
import time
from fractions import Fraction
from math import ceil, floor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from numeric.lowering.files import write_whole
from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, Whole, json_option, plot_option
from verification.app.commands.sweep import How, carried_out, lams_option, sweep_options
from verification.app.scene import along, table_options, varied_options
from verification.app.scene import span as numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr
    from rich.console import Console

    from numeric.sweeps.store import Memory, Stored
    from verification.arithmetic.arrays import Mask
    from verification.proofs.global_dynamics.database import Numbers
    from verification.proofs.global_dynamics.images import PinballImages
    from verification.proofs.global_dynamics.regions import Region
    from verification.rigorous.graph import MorseGraph

WINDOW = 12  # columns beside a join in which the density at a cut is measured
SHOWN = 24  # Morse sets in the table for people
WIDTH = 100  # letters of the picture of a database


@click.command(epilog="Example: pinball morse egg --alpha 0.08 --lam 0.5 --columns 512 --rows 256 --plot morse.png")
@table_options
@click.option("--lam", "lams", metavar="LOW:HIGH", required=True, help="Contractions, all at once, or one; below 1.")
@click.option("--columns", type=Whole(8, 1 << 13), default=512, show_default=True, help="Cells along theta.")
@click.option("--rows", type=Whole(8, 1 << 13), default=256, show_default=True, help="Cells along phi.")
@click.option("--coarsest", type=Whole(1, 64), default=4, show_default=True, help="Cells a box begins with.")
@click.option("--parts", type=Whole(1, 16), default=1, show_default=True, help="Cuts of a box for its image.")
@click.option("--exponents", type=Whole(1, 16), metavar="PARTS", help="Bound nu_plus; cuts of a box for it.")
@click.option(
    "--almost-every",
    type=Whole(64, 1 << 15),
    metavar="N",
    help="nu_plus of almost every orbit there; N columns.",
)
@click.option("--certificates", metavar="DIR", help="Write each trapping region, for `pinball check`.")
@plot_option("graphs.morse_sets", "the Morse sets over phase space")
@json_option
def command(
    scene: Scene,
    lams: str,
    columns: int,
    rows: int,
    coarsest: int,
    parts: int,
    exponents: int | None,
    almost_every: int | None,
    certificates: str | None,
    output: Output,
) -> int:
    """Which attractors are proved, and in what order? Exit status 1 when no trapping region but the whole strip is
    found.

    The strip |phi| <= lam*pi/2, where every particle is after one bounce, is covered by boxes. From some bounce on,
    every orbit that never lands on a join is proved to be in one of the Morse sets listed; it goes from one to another
    only in the order given; and each trapping region keeps what enters it. A set may hold several attractors, or none.
    """
    from verification.proofs.global_dynamics.images import PinballImages
    from verification.proofs.global_dynamics.regions import region, sampled_share, shares
    from verification.rigorous.graph import Grid, morse_graph, refined

    if certificates is not None and not Path(certificates).is_dir():
        raise ValueError(f"--certificates {certificates!r} is no directory; create it first")
    started = time.perf_counter()
    low, high = span(lams)
    map = PinballImages(scene.at(lam=low), (low, high))
    grid = Grid(map.charts, columns, rows)
    with output.progress("Covering phase space", 1) as step:
        graph = morse_graph(refined(map, grid, coarsest, parts))
        step("ordered")
    leaves = int(graph.transitions.leaf.sum())
    regions = [region(map, graph, index, parts) for index in graph.attracting]
    typical = dict.fromkeys(graph.attracting) if almost_every is None else almost(map, graph, almost_every)
    nu = dict.fromkeys(graph.attracting) if exponents is None else growths(map, graph, exponents)
    document: dict[str, Any] = {
        "scene": map.scene.document,
        "lam": [str(low), str(high)],
        "boxes": leaves,
        "edges": int(graph.transitions.edges.nnz),
        "sets": [entry(graph, index) for index in range(len(graph.sets))],
        "regions": [
            {"set": index, "name": found.name, "boxes": int(found.cells.chart.size), "basin": shares(graph, index)}
            | {"basin_sampled": sampled_share(map, graph, index), "nu_plus": nu[index]}
            | {"almost_every": typical[index]}
            for index, found in zip(graph.attracting, regions, strict=True)
            if found is not None
        ],
        "seconds": time.perf_counter() - started,
    }
    output.write(document, graph, map.label)
    show(output.console, map.label, document)
    if certificates is not None:
        for number, found in enumerate(found for found in regions if found is not None):
            written(found, Path(certificates) / f"region{number}.json", output.console)
    return DONE if any(0 < found["boxes"] < leaves for found in document["regions"]) else FAILED


def span(text: str) -> tuple[Fraction, Fraction]:
    """The two ends of `LOW:HIGH`, or one number twice, as exact contractions.

    >>> span("0.5"), span("1/4:1/2")
    ((Fraction(1, 2), Fraction(1, 2)), (Fraction(1, 4), Fraction(1, 2)))
    """
    ends = [exact("--lam", part) for part in text.split(":")]
    low, high = ends[0], ends[-1]
    if len(ends) > 2 or not (isinstance(low, Fraction) and isinstance(high, Fraction)) or not 0 <= low <= high < 1:
        raise ValueError(f"--lam {text!r} is no range of contractions; accepted: rationals LOW:HIGH in [0, 1), or one")
    return low, high


def entry(graph: "MorseGraph", index: int) -> dict[str, Any]:
    """A Morse set as JSON: its number of boxes, their range, and the Morse sets below it in the order."""
    from verification.rigorous.graph import Cells

    members = graph.sets[index]
    inner = members[members < graph.transitions.count]
    boxes = graph.transitions.grid.boxes(Cells(*(field[inner] for field in graph.transitions.cells)))
    names = [chart.name for chart in graph.transitions.grid.charts]
    ends = {name: [float(low.min()), float(high.max())] for name, (low, high) in (("theta", boxes.x), ("phi", boxes.y))}
    below = [other for other in range(len(graph.sets)) if other != index and graph.below[index, other]]
    found = {"boxes": int(members.size), "components": sorted({names[i] for i in boxes.chart.tolist()}), **ends}
    return found | {"attracting": index in graph.attracting, "leads_to": below}


def blocks(graph: "MorseGraph") -> "Iterator[tuple[int, Mask]]":
    """The index and the trapping region (a mask of boxes) of each attracting set that has such a region."""
    for index in graph.attracting:
        block = graph.trapping(index)
        if not block[-1]:
            yield index, block


def growths(map: "PinballImages", graph: "MorseGraph", parts: int) -> dict[int, list[float] | None]:
    """Bounds for `nu_plus` in each trapping region, rounded outwards; None where no invariant cones were found."""
    from math import ceil, floor, isfinite

    from verification.proofs.global_dynamics.regions import expansion

    found: dict[int, list[float] | None] = dict.fromkeys(graph.attracting)
    for index, block in blocks(graph):
        bounds = expansion(map, graph.transitions, block, parts=parts)
        if isfinite(bounds.low) and isfinite(bounds.high):
            found[index] = [floor(bounds.low * 1e6) / 1e6, ceil(bounds.high * 1e6) / 1e6]
    return found


def almost(map: "PinballImages", graph: "MorseGraph", columns: int) -> "dict[int, dict[str, Any] | None]":
    """Bounds for `nu_plus` of almost every orbit in each trapping region, or the reason why there are none."""
    from verification.proofs.starts.curves import PinballCurves
    from verification.proofs.starts.typical import TypicalExponent

    found: dict[int, dict[str, Any] | None] = dict.fromkeys(graph.attracting)
    curves = PinballCurves(map)
    for index, block in blocks(graph):
        cells = graph.transitions.chosen(block)
        bounds = TypicalExponent(curves, graph.transitions.grid, cells, columns, 2 * columns, WINDOW)
        ends = [bounds.low, bounds.high] if bounds.proved else None
        found[index] = {"nu_plus": ends, "labels": bounds.labels, "why": bounds.why}
    return found


def show(console: "Console", label: str, document: dict[str, Any]) -> None:
    """Prints the Morse graph."""
    console.print(f"{label}: {document['boxes']} boxes, {document['edges']} edges, {document['seconds']:.1f} s")
    console.print("proved: from some bounce on every orbit that never lands on a join is in one of these sets")
    console.print("  set    boxes  attracting  phi                   leads to")
    for index, found in enumerate(document["sets"][:SHOWN]):
        ends = f"{found['phi'][0]:.4f} to {found['phi'][1]:.4f}"
        leads = " ".join(map(str, found["leads_to"][:8])) or "-"
        console.print(
            f"  {index:3} {found['boxes']:8}  {'yes' if found['attracting'] else 'no':10}  {ends:20}  {leads}"
        )
    if len(document["sets"]) > SHOWN:
        console.print(f"  and {len(document['sets']) - SHOWN} more")
    for found in document["regions"]:
        low, high = found["basin"]
        console.print(f"proved: {found['name']}, about set {found['set']}")
        held = f"between {floor(low * 1e4) / 100:.2f}% and {ceil(high * 1e4) / 100:.2f}%" if low < 1 else "all"
        console.print(f"        its basin holds {held} of phase space, by area")
        if found["basin_sampled"] is not None:
            share, error = found["basin_sampled"]
            console.print(f"        sampled: {share:.2%} +- {error:.2%} of random starts are in it after 2000 bounces")
        if found["nu_plus"] is not None:
            low, high = found["nu_plus"]
            console.print(f"        {low:.6f} <= nu_plus <= {high:.6f} for every orbit there that lands on no join")
        if (some := found["almost_every"]) is not None and some["nu_plus"] is None:
            console.print(f"        nothing is proved of almost every orbit there: {some['why']}")
        elif some is not None:
            low, high = some["nu_plus"]
            console.print(
                f"        {low:.6f} <= nu_plus <= {high:.6f} for almost every orbit there: within {high - low:.3f}"
            )


def written(region: "Region", path: Path, console: "Console") -> None:
    """Writes a certificate of a trapping region, which `pinball check` proves anew."""
    write_whole(path, json.dumps(region.to_dict()) + "\n")
    console.print(f"{path}: {region.name}")


CLASSES = 12  # in the table for people


@click.command(
    "morse-graphs",
    epilog="Example: pinball sweep morse-graphs egg --shape alpha=0:1/10:65 --lams 0:0.98:65 --store graphs.zarr",
)
@varied_options
@lams_option
@click.option("--columns", type=Whole(8, 1 << 10), default=96, show_default=True, help="Cells along theta.")
@click.option("--rows", type=Whole(8, 1 << 10), default=128, show_default=True, help="Cells along phi.")
@click.option("--coarsest", type=Whole(1, 64), default=8, show_default=True, help="Cells a box begins with.")
@click.option("--page", metavar="FILE", help="Write a page that shows the graph of the box of parameters pointed at.")
@plot_option("graphs.database", "what continues over both parameters")
@sweep_options
def graphs_command(
    scene: Scene,
    axis: str | None,
    lams: str,
    columns: int,
    rows: int,
    coarsest: int,
    page: str | None,
    how: How,
) -> int:
    """The Morse graph of each box of parameters, and which of them continue from box to box.

    The N values of --lams and of --shape NAME=LOW:HIGH:N are the borders of the boxes; contractions are below 1. What
    is proved for a box holds for each of its parameters. Phase space is taken modulo rotations of the table.
    """
    from verification.proofs.global_dynamics.database import continued, database

    if axis is None:
        raise ValueError("--shape is missing; accepted: --shape NAME=LOW:HIGH:N, which varies besides lam")
    scene, parameter, values = along(scene, axis)
    sweep = database(scene, parameter, values.tolist(), numbers("--lams", lams), columns, rows, coarsest)

    def lines(results: "Memory | Stored") -> list[str]:
        found = results.dataset()
        label = continued(found)
        if page is not None:
            from verification.reports.explorer import explorer

            write_whole(Path(page), explorer(found, label))
        return graph_lines(found, label)

    return carried_out(sweep, how, lines)


def graph_lines(found: "xr.Dataset", label: "Numbers") -> list[str]:
    """Lines of text: the numbers of boxes of the largest classes, and a picture of the numbers of trapping regions."""
    import numpy as np

    sets, attracting = found.sets.values, found.attracting.values
    known = int((label >= 0).sum())
    shown = [
        f"{label.size} boxes of parameters, {known} with a Morse graph; {int(label.max()) + 1} classes",
        "  class   boxes  Morse sets  trapping regions",
    ]
    for index in range(min(CLASSES, int(label.max()) + 1)):
        on = label == index
        first = tuple(np.argwhere(on)[0])
        shown.append(f"  {index:5}  {int(on.sum()):6}  {int(sets[first]):10}  {int(attracting[first]):16}")
    parameter, ends = str(found.sets.dims[0]), (float(found.lam[0]), float(found.lam[-1]))
    shown.append(f"{parameter} down, lam from {ends[0]:.4g} to {ends[1]:.4g} across; trapping regions up to rotation")
    step = max(1, -(-found.lam.size // WIDTH))
    for value, row in zip(found[parameter].values, attracting[:, ::step], strict=True):
        shown.append(f"{value:<9.4g}" + "".join("." if count < 0 else str(min(count, 9)) for count in row.tolist()))
    return shown
