"""Where particles end: the attractors, and their exponents with error bars.

`pinball attractor` finds them and says what each is like; `pinball lyapunov` measures two exponents for each.
"""

from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, INTERRUPTED, Output, json_option, plot_option
from verification.app.lines import table, widest
from verification.app.scene import scene_options

if TYPE_CHECKING:
    from rich.console import Console

    from numeric import PinballMap
    from numeric.dynamics.attractors import Attractor
    from numeric.dynamics.exponents import Survey


@click.command(epilog="Example: pinball attractor egg --alpha 0.08 --lam 0.43 --orbits 2000 --seed 1")
@scene_options
@click.option(
    "--orbits", type=click.IntRange(1, 10_000_000), default=100, show_default=True, help="How many random starts."
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the random starts.")
@click.option("--transient", type=click.IntRange(10, 10**8), default=1000, show_default=True, help="Bounces first.")
@click.option("--bounces", type=click.IntRange(100, 10**8), default=4000, show_default=True, help="For exponents.")
@click.option("--points", type=click.IntRange(0, 8192), default=256, show_default=True, help="Listed of each, in JSON.")
@click.option("--certify", is_flag=True, help="Prove that each cycle exists and attracts.")
@plot_option("results.attractors", "the attractors in the table and in phase space")
@json_option
def attractor_command(
    scene: Scene, orbits: int, seed: int, transient: int, bounces: int, points: int, certify: bool, output: Output
) -> int:
    """The attractors that random starts reach, with period, symmetry, exponents and share of the starts.

    Starts are uniform inside the table with uniform directions; the first collision is elastic.
    """
    from numeric import PinballMap
    from numeric.dynamics.attractors import find

    map = PinballMap(scene)
    found = find(map, orbits, seed, transient, bounces, images=True)
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
    output.write(document, map, found)
    show_attractor(output.console, document)
    return DONE if proved and document["unsettled"] == 0 else FAILED


def listed(map: "PinballMap", attractor: "Attractor", points: int) -> dict[str, Any]:
    """An attractor as JSON has it."""
    import numpy as np

    from numeric.dynamics.recognition import Kind

    spread = attractor.kind is Kind.CHAOTIC
    x, y = map.states.point(attractor.points.component, attractor.points.theta)
    names = [part.name for part in map.ir.parts]
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
    from numeric.dynamics.recognition import Kind
    from verification.named.attractors import certificate

    if attractor.kind is not Kind.CYCLE:
        return {}
    from sympy import S

    return dict(certificate(scene.table, S(scene.lam), attractor.points, law=scene.law).checks)


def show_attractor(console: "Console", document: dict[str, Any]) -> None:
    """A line for each attractor; where that is too wide, with fewer digits, and what is proved below."""
    names = "family", "symmetry", "attractor", "share (95%)", "nu_plus", "nu_minus"
    found = document["attractors"]
    proofs = [said(a.get("checks")) for a in found]
    lines = table((*names, ""), [(*_row(a, 4, 5), word) for a, word in zip(found, proofs, strict=True)])
    if widest(lines) > console.width:
        lines = table(names, [_row(a, 3, 4) for a in found])
        for word in dict.fromkeys(filter(None, proofs)):
            families = dict.fromkeys(str(a["family"]) for a, proof in zip(found, proofs, strict=True) if proof == word)
            lines.append(f"{word}: family {', '.join(families)}")
    for line in lines:
        console.print(line)
    console.print(f"{document['orbits']} starts, seed {document['seed']}; {document['unsettled']} did not settle")


def _row(a: dict[str, Any], places: int, digits: int) -> tuple[str, ...]:
    """An attractor in words: its share to so many places, its exponents to so many digits after the point."""
    kind = {"cycle": f"period {a['period']}", "chaotic": "chaotic", "stopped": f"stopped: {a['status']}"}
    name = kind.get(a["kind"], f"neutral, period {a['period']}" if a["period"] else "neutral")
    share = f"{a['share']:.{places}f} ({a['share_low']:.{places}f}, {a['share_high']:.{places}f})"
    exponents = (_number(a[nu], a[f"{nu}_stderr"], digits) for nu in ("nu_plus", "nu_minus"))
    return str(a["family"]), str(a["symmetry"]), name, share, *exponents


def said(checks: dict[str, bool | None] | None) -> str:
    """`proved`, or what is not; nothing where no proof was asked for."""
    if not checks:
        return ""
    missing = [name for name, value in checks.items() if value is not True]
    return "proved" if not missing else f"not proved: {', '.join(missing)}"


def _number(value: float | None, error: float | None, digits: int) -> str:
    if value is None:
        return "-"
    return f"{value:.{digits}f}" + (f"({error:.0e})" if error else "")


LAWS = {
    "interior": "points uniform in the table, directions uniform, first collision elastic",
    "phase": "uniform in arc length and in sin(phi)",
}
SIZE = 1_000_000_000
LONG = 10_000  # bounces of a transient, unless it is given


@click.command(epilog="Example: pinball lyapunov cuspless --lam 0.8 --bounces 10000 --orbits 100 --seed 1")
@scene_options
@click.option(
    "--bounces", type=click.IntRange(10, SIZE), default=10_000, show_default=True, help="Bounces that count, each."
)
@click.option(
    "--orbits", type=click.IntRange(2, 10_000_000), default=100, show_default=True, help="How many random starts."
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the random starts.")
@click.option("--transient", type=click.IntRange(0, SIZE), help="Bounces before; if left out --bounces, at most 10000.")
@click.option(
    "--start-law", type=click.Choice(list(LAWS)), default="interior", show_default=True, help="Of the starts."
)
@click.option("--until-error", type=float, help="Go on, twice as long each time, until every error is at most this.")
@click.option(
    "--budget", type=click.IntRange(1), default=SIZE, show_default=True, help="Bounces of all particles, then."
)
@click.option("--certified", is_flag=True, help="Also the proved ones: of cycles; of the cardioid's chaos at --lam 0.")
@plot_option("results.exponents", "the exponents with their errors")
@json_option
def command(
    scene: Scene,
    bounces: int,
    orbits: int,
    seed: int,
    transient: int | None,
    start_law: str,
    until_error: float | None,
    budget: int,
    certified: bool,
    output: Output,
) -> int:
    """The two exponents per bounce, in the coordinates (s, phi), with standard errors, for each attractor.

    Starts are those of the paper's appendix: points uniform in the table, directions uniform, the first collision
    elastic; or uniform in arc length and sin(phi). Nothing is averaged across attractors. Ctrl-C ends a long count,
    and what was counted is reported.
    """
    if until_error is not None and not until_error > 0:
        raise ValueError(f"--until-error = {until_error} is no error; give a positive number such as 1e-4")
    from numeric import PinballMap
    from numeric.dynamics.account import account
    from numeric.dynamics.exponents import surveyed
    from numeric.pinball import sampling

    map = PinballMap(scene)
    starts = {"interior": sampling.interior_starts, "phase": sampling.phase_starts}[start_law](map, orbits, seed)
    with output.progress("Counting", 1000) as step:
        heard = 0

        def say(part: float) -> None:
            nonlocal heard
            while heard < min(part, 1.0) * 1000:
                heard += 1
                step("")

        transient = min(bounces, LONG) if transient is None else transient
        survey = surveyed(map, starts, bounces, transient, until_error, budget, say)
    survey = with_families(map, survey)
    document = {**account(map, survey), "bounces": bounces, "seed": seed, "start_law": start_law}
    if until_error is not None:
        document |= {"until_error": until_error, "reached": survey.ended == "error"}
    if certified:
        with output.progress("Proving", 1) as step:
            certify(scene, survey, document)
            step("")
    output.write(document, document)
    show(output.console, document)
    if survey.ended == "interrupted":
        return INTERRUPTED
    return (
        FAILED
        if survey.ended == "budget" or any(g.get("certified", True) is None for g in document["groups"])
        else DONE
    )


def with_families(map: "PinballMap", survey: "Survey") -> "Survey":
    """The survey with attractors that are symmetry images of each other numbered alike."""
    from dataclasses import replace

    found = [group.attractor for group in survey.groups if group.attractor is not None]
    if len(found) < 2:
        return survey
    from numeric.dynamics.attractors import with_images

    joined = iter(with_images(map, found))
    groups = [one if one.attractor is None else one._replace(attractor=next(joined)) for one in survey.groups]
    return replace(survey, groups=tuple(groups))


def certify(scene: Scene, survey: "Survey", document: dict[str, Any]) -> None:
    """Adds the proved exponents of each cycle to its group, null where the proof failed; and those of chaos."""
    from sympy import S

    from verification.named.attractors import certified_exponents, chaotic_exponents

    for one, described in zip(survey.groups, document["groups"], strict=True):
        if described.get("period") and one.attractor is not None:
            described["certified"] = certified_exponents(scene.table, S(scene.lam), one.attractor.points, law=scene.law)
        elif (
            described["kind"] == "chaotic"
            and scene.law.uniform
            and (found := chaotic_exponents(scene.table, S(scene.lam)))
        ):
            described["certified"] = found


def show(console: "Console", document: dict[str, Any]) -> None:
    """The result of the one attractor, or of each, and where the error bars come from."""
    if document["nu_plus"] is None:
        console.print(f"{document['attractors']} attractors: nothing is averaged across them")
    else:
        console.print(f"nu_plus  = {_measured(document, 'nu_plus')}")
        console.print(f"nu_minus = {_measured(document, 'nu_minus')}")
        console.print(f"sum      = {_measured(document, 'sum')}")
    law = LAWS[document["start_law"]]
    console.print(f"over {document['orbits']} orbits of {document['counted']} bounces, per bounce; starts: {law}")
    for group in document["groups"]:
        console.print(f"{group['orbits']:>8} orbits: {group['kind']}")
        if group["nu_plus"] is not None:
            both = (f"{name} = {_measured(group, name)}" for name in ("nu_plus", "nu_minus"))
            console.print(f"{'':>17} {', '.join(both)}")
        if group.get("naive_stderr"):
            ratio = group["nu_plus_stderr"] / group["naive_stderr"]
            console.print(
                f"{'':>17} memory {group['autocorrelation_time']:.3g} bounces; the error is {ratio:.3g} times that of "
                "independent bounces"
            )
        if group.get("trusted") is False:
            console.print(f"{'':>17} too short for its memory: the error bar is rough")
        if group.get("along_orbits"):
            console.print(
                f"{'':>17} from its multipliers; along the orbits nu_plus = {group['along_orbits']['nu_plus']:.6g}"
            )
        if group.get("certified"):
            lower = group["certified"]["nu_minus"]
            console.print(f"{'':>17} proved: {group['certified']['nu_plus']}, {'-oo' if lower is None else lower}")
    rule = document["sum_rule"]
    if rule["difference"] is not None:
        console.print(
            f"log|det| by kernel and from angles differ by {rule['difference']:.1g} after {rule['bounces']} bounces"
        )
    if document["ended"] == "interrupted":
        console.print("interrupted: this is what was counted so far")
    if document.get("reached") is False and document["ended"] == "budget":
        console.print(
            f"the error {document['until_error']:g} was not reached within the budget; give a larger --budget"
        )


def _measured(document: dict[str, Any], name: str) -> str:
    value, error = document[name], document[f"{name}_stderr"]
    if value is None:
        return "-oo"
    return f"{value:.12g}" if error == 0 else f"{value:.6g}" + ("" if error is None else f" +- {error:.1g}")
