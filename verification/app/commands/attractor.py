"""`pinball attractor`: where balls end, how many attractors there are, and what each is like."""

from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.scene import Scene
from verification.app.shell.cli import DONE, FAILED
from verification.app.shell.output import Output, json_option
from verification.app.shell.scene import scene_options

if TYPE_CHECKING:
    from rich.console import Console

    from numeric import PinballMap
    from numeric.dynamics.attractors import Attractor


@click.command(epilog="Example: pinball attractor egg --alpha 0.08 --lam 0.43 --orbits 2000 --seed 1")
@scene_options
@click.option("--orbits", type=click.IntRange(1, 10_000_000), required=True, help="How many random starts.")
@click.option("--seed", type=click.IntRange(0), required=True, help="Of the random starts.")
@click.option("--transient", type=click.IntRange(10, 10**8), default=1000, show_default=True, help="Bounces first.")
@click.option("--bounces", type=click.IntRange(100, 10**8), default=4000, show_default=True, help="For exponents.")
@click.option("--points", type=click.IntRange(0, 8192), default=256, show_default=True, help="Listed of each, in JSON.")
@click.option("--certify", is_flag=True, help="Prove that each cycle exists and attracts.")
@json_option
def command(
    scene: Scene, orbits: int, seed: int, transient: int, bounces: int, points: int, certify: bool, output: Output
) -> int:
    """The attractors that random starts reach, with period, symmetry, exponents and share of the starts.

    Starts are uniform inside the table with uniform directions; the first collision is elastic.
    """
    from numeric import PinballMap
    from numeric.dynamics.attractors import find

    map, table = PinballMap(scene), scene.table
    found = find(map, orbits, seed, table, transient, bounces)
    document: dict[str, Any] = {
        "orbits": orbits,
        "seed": seed,
        "transient": transient,
        "bounces": bounces,
        "unsettled": orbits - sum(a.share.count for a in found if a.share),
        "attractors": [listed(map, attractor, points) for attractor in found],
    }
    proved = True
    if certify:
        with output.progress("proving", len(found)) as step:
            for attractor, entry in zip(found, document["attractors"], strict=True):
                entry["checks"] = checked(scene, attractor)
                proved = proved and all(value is True for value in entry["checks"].values())
                step(f"period {attractor.period}")
    output.write(document)
    show(output.console, document)
    return DONE if proved and document["unsettled"] == 0 else FAILED


def listed(map: "PinballMap", attractor: "Attractor", points: int) -> dict[str, Any]:
    """An attractor as JSON has it."""
    import numpy as np

    spread = attractor.kind.name == "CHAOTIC"
    x, y = map.states.point(attractor.points.component, attractor.points.theta)
    names = [part.name for part in map.blueprint.parts]
    rows = zip(*attractor.points, x, y, strict=True)
    share = attractor.share
    assert share is not None
    numbers = {
        "nu_plus": attractor.nu_plus,
        "nu_minus": attractor.nu_minus,
        "nu_plus_stderr": attractor.errors[0],
        "nu_minus_stderr": attractor.errors[1],
        "stay_at_least": attractor.stay if spread else None,
    }
    return {
        "kind": attractor.kind.name.lower(),
        "status": attractor.status.name.lower(),
        "period": attractor.period,
        "family": attractor.family,
        "symmetry": attractor.symmetry,
        "starts": share.count,
        "share": share.count / share.of,
        "share_low": share.low,
        "share_high": share.high,
        **{key: value if value is not None and np.isfinite(value) else None for key, value in numbers.items()},
        "multipliers": [{"re": mu.real, "im": mu.imag} for mu in attractor.multipliers or ()],
        "points": [
            {"component": names[i], "theta": float(a), "phi": float(b), "x": float(p), "y": float(q)}
            for (i, a, b, p, q), _ in zip(rows, range(points), strict=False)
        ],
    }


def checked(scene: Scene, attractor: "Attractor") -> dict[str, bool | None]:
    """The checklist of a cycle's proof; empty for what is no cycle."""
    from verification.named.attractors import certificate

    if attractor.kind.name != "CYCLE":
        return {}
    from sympy import S

    return dict(certificate(scene.table, S(scene.lam), attractor.points).checks)


def show(console: "Console", document: dict[str, Any]) -> None:
    """A line for each attractor."""
    console.print("family  symmetry  attractor          share of the starts (95%)    nu_plus        nu_minus")
    for a in document["attractors"]:
        kind = {"cycle": f"period {a['period']}", "chaotic": "chaotic", "stopped": f"stopped: {a['status']}"}
        name = kind.get(a["kind"], f"neutral, period {a['period']}" if a["period"] else "neutral")
        share = f"{a['share']:.4f} ({a['share_low']:.4f}, {a['share_high']:.4f})"
        proof = "  " + said(a["checks"]) if a.get("checks") else ""
        console.print(
            f"{a['family']:<8}{a['symmetry']:<10}{name:<19}{share:<29}"
            f"{_number(a['nu_plus'], a['nu_plus_stderr']):<15}{_number(a['nu_minus'], a['nu_minus_stderr'])}{proof}"
        )
    console.print(f"{document['orbits']} starts, seed {document['seed']}; {document['unsettled']} did not settle")


def said(checks: dict[str, bool | None]) -> str:
    """`proved`, or what is not."""
    missing = [name for name, value in checks.items() if value is not True]
    return "proved" if not missing else f"not proved: {', '.join(missing)}"


def _number(value: float | None, error: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.5f}" + (f"({error:.0e})" if error else "")
