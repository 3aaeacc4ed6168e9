"""Where particles end: the attractors, and their exponents with error bars.

`pinball attractor` finds and describes them; `pinball lyapunov` measures two exponents for each.
"""

from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, INTERRUPTED, Output, Whole, json_option, plot_option
from verification.app.lines import FAR, table, widest
from verification.app.scene import scene_options

if TYPE_CHECKING:
    from rich.console import Console

    from numeric import PinballMap
    from numeric.dynamics.attractors import Attractor
    from numeric.dynamics.exponents import Survey


@click.command(epilog="Example: pinball attractor egg --alpha 0.08 --lam 0.43 --orbits 2000 --seed 1")
@scene_options
@click.option("--orbits", type=Whole(1, 10_000_000), default=100, show_default=True, help="How many random starts.")
@click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of the random starts.")
@click.option("--transient", type=Whole(10, 10**8), default=1000, show_default=True, help="Bounces first.")
@click.option("--bounces", type=Whole(100, 10**8), default=4000, show_default=True, help="For exponents.")
@click.option("--points", type=Whole(0, 8192), default=256, show_default=True, help="Listed of each, in JSON.")
@click.option("--certify", is_flag=True, help="Prove that each cycle exists and attracts.")
@plot_option("results.attractors", "the attractors in the table and in phase space")
@json_option
def attractor_command(
    scene: Scene, orbits: int, seed: int, transient: int, bounces: int, points: int, certify: bool, output: Output
) -> int:
    """The attractors that random starts reach, with period, symmetry, exponents and the fraction of starts.

    Starts are uniform inside the table with uniform directions; the first collision is elastic.
    """
    from numeric import PinballMap
    from numeric.dynamics.attractors import Kind, find

    map = PinballMap(scene)
    found = find(map, orbits, seed, transient, bounces, images=True)
    doubts = [a.doubt for a in found if a.doubt]
    document: dict[str, Any] = {
        "count": None if doubts else sum(a.kind is not Kind.STOPPED for a in found),
        "undecided": "; ".join(dict.fromkeys(doubts)) or None,
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
    """An attractor as JSON, with up to `points` of its points."""
    import numpy as np

    from numeric.dynamics.recognition import Kind

    spread = attractor.kind is Kind.CHAOTIC
    x, y = map.states.point(attractor.points.component, attractor.points.theta)
    names = [part.name for part in map.ir.parts]
    rows = list(zip(*attractor.points, x, y, strict=True))
    share = attractor.share
    assert share is not None
    numbers = {
        "nu_plus": attractor.nu_plus,
        "nu_minus": attractor.nu_minus,
        "nu_plus_stderr": attractor.errors[0],
        "nu_minus_stderr": attractor.errors[1],
        "stay_at_least": attractor.stay if spread else None,
    }
    entries = [
        {"component": names[i], "theta": float(a), "phi": float(b), "x": float(p), "y": float(q)}
        for i, a, b, p, q in rows[: max(points, 1)]
    ]
    return {
        "kind": attractor.kind.name.lower(),
        "undecided": attractor.doubt or None,
        "at": entries[0],
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
        "points": entries[:points],
    }


def checked(scene: Scene, attractor: "Attractor") -> dict[str, bool | None]:
    """The checklist of a cycle's proof; empty for other attractors."""
    from numeric.dynamics.recognition import Kind
    from verification.named.attractors import certificate

    if attractor.kind is not Kind.CYCLE:
        return {}
    from sympy import S

    return dict(certificate(scene.table, S(scene.lam), attractor.points, law=scene.law).checks)


def show_attractor(console: "Console", document: dict[str, Any]) -> None:
    """Prints a line for each attractor; a narrow terminal gets fewer digits, and the proofs below the table."""
    names = "row", "symmetry", "attractor", "at x, y, phi", "starts", "share (95%)", "nu_plus", "nu_minus"
    found = document["attractors"]
    proofs = [said(a.get("checks")) for a in found]
    rows = [_row(a, number, found, 5) for number, a in enumerate(found, 1)]
    lines = table((*names, ""), [(*row, word) for row, word in zip(rows, proofs, strict=True)])
    if widest(lines) > console.width:
        lines = table(names, [_row(a, number, found, 4) for number, a in enumerate(found, 1)])
        for word in dict.fromkeys(filter(None, proofs)):
            numbers = (str(number) for number, proof in enumerate(proofs, 1) if proof == word)
            lines.append(f"{word}: row {', '.join(numbers)}")
    for line in lines:
        console.print(line)
    if document["count"] is not None and document["count"] > 1:
        console.print(f"{document['count']} attractors")
    show_doubts(console, [(number, a["undecided"]) for number, a in enumerate(found, 1) if a["undecided"]])
    console.print(f"{document['orbits']} starts, seed {document['seed']}; {document['unsettled']} did not settle")


def show_doubts(console: "Console", doubts: list[tuple[int, str]]) -> None:
    """Prints, for each reason, the rows for which it is undecided whether they are one attractor or several."""
    for reason in dict.fromkeys(reason for _, reason in doubts):
        rows = [str(row) for row, word in doubts if word == reason]
        many = f"row {rows[0]} is" if len(rows) == 1 else f"rows {', '.join(rows)} are"
        console.print(f"undecided whether {many} one attractor or several: {reason}")


def _row(a: dict[str, Any], number: int, found: list[dict[str, Any]], digits: int) -> tuple[str, ...]:
    """The cells of a row of the table, for one attractor; exponents have `digits` decimals."""
    kind = {"cycle": f"period {a['period']}", "chaotic": "chaotic", "stopped": f"stopped: {a['status']}"}
    name = kind.get(a["kind"], f"neutral, period {a['period']}" if a["period"] else "neutral")
    first = next(k for k, other in enumerate(found, 1) if other["family"] == a["family"])
    name += ", undecided" if a["undecided"] else "" if first == number else f", image of {first}"
    of = round(a["starts"] / a["share"]) if a["share"] else 0
    starts = f"{a['starts']} of {of}" if of else "0"
    exponents = (_number(a[nu], a[f"{nu}_stderr"], digits) for nu in ("nu_plus", "nu_minus"))
    return str(number), str(a["symmetry"]), name, place(a), starts, share_in_words(a), *exponents


def share_in_words(a: dict[str, Any]) -> str:
    """The 95 % interval of a probability estimated from counts, in words; a one-sided bound at 0 or 1.

    >>> share_in_words({"share": 1.0, "share_low": 0.98116, "share_high": 1.0})
    'at least 98.1 %'
    >>> share_in_words({"share": 0.5, "share_low": 0.43137, "share_high": 0.56863})
    '43.1 to 56.9 %'
    """
    low, high = floor(1000 * a["share_low"]) / 10, ceil(1000 * a["share_high"]) / 10
    if a["share"] == 1:
        return f"at least {low} %"
    return f"{low} to {high} %" if a["share"] else f"at most {high} %"


def said(checks: dict[str, bool | None] | None) -> str:
    """`proved`, or the names of the checks that are not proved; empty if there are no checks."""
    if not checks:
        return ""
    missing = [name for name, value in checks.items() if value is not True]
    return "proved" if not missing else f"not proved: {', '.join(missing)}"


def _number(value: float | None, error: float | None, digits: int) -> str:
    if value is None:
        return "-"
    places = max(digits, min(ceil(-log10(error)), PLACES)) if error else digits
    return f"{value:.{places}f}" + (f"({error:.0e})" if error else "")


PLACES = 10  # decimals of an exponent, at most
LAWS = {
    "interior": "points uniform in the table, directions uniform, first collision elastic",
    "phase": "uniform in arc length and in sin(phi)",
}
SIZE = 1_000_000_000
LONG = 10_000  # bounces of a transient, at most, unless --transient is given


@click.command(epilog="Example: pinball lyapunov cuspless --lam 0.8 --bounces 10000 --orbits 100 --seed 1")
@scene_options
@click.option("--bounces", type=Whole(10, SIZE), default=10_000, show_default=True, help="Bounces that count, each.")
@click.option("--orbits", type=Whole(2, 10_000_000), default=100, show_default=True, help="How many random starts.")
@click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of the random starts.")
@click.option("--transient", type=Whole(0, SIZE), help="Bounces before; if left out --bounces, at most 10000.")
@click.option(
    "--start-law", type=click.Choice(list(LAWS)), default="interior", show_default=True, help="Of the starts."
)
@click.option("--until-error", type=float, help="Go on, twice as long each time, until every error is at most this.")
@click.option("--budget", type=Whole(1), default=SIZE, show_default=True, help="Bounces of all particles, then.")
@click.option("--per-time", is_flag=True, help="Also the mean flight, and exponents per unit of time at speed 1.")
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
    per_time: bool,
    certified: bool,
    output: Output,
) -> int:
    """The two exponents per bounce, in the coordinates (s, phi), with standard errors, for each attractor.

    Starts are those of the paper's appendix (points uniform in the table, directions uniform, the first collision
    elastic), or uniform in arc length and sin(phi). Nothing is averaged across attractors. Ctrl-C ends a long run; the
    bounces so far are reported.
    """
    if until_error is not None and not until_error > 0:
        raise ValueError(f"--until-error = {until_error} is no error; give a positive number such as 1e-4")
    from numeric import PinballMap
    from numeric.dynamics.account import account
    from numeric.dynamics.exponents import surveyed, with_families
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
    document = {**account(map, survey, per_time), "bounces": bounces, "seed": seed, "start_law": start_law}
    if until_error is not None:
        document |= {"until_error": until_error, "reached": survey.ended == "error"}
    if certified:
        with output.progress("Proving", 1) as step:
            add_proofs(scene, survey, document)
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


def add_proofs(scene: Scene, survey: "Survey", document: dict[str, Any]) -> None:
    """Adds certified exponents to each group of `document`: of a cycle (null if not proved) or of proved chaos."""
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
    """Prints the exponents, for each attractor if there are several, and how their error bars were obtained."""
    if document["nu_plus"] is None:
        many = "undecided how many" if document["undecided"] else document["attractors"]
        console.print(f"{many} attractors: nothing is averaged across them")
    else:
        console.print(f"nu_plus  = {_measured(document, 'nu_plus')}")
        console.print(f"nu_minus = {_measured(document, 'nu_minus')}")
        console.print(f"sum      = {_measured(document, 'sum')}")
    law = LAWS[document["start_law"]]
    console.print(f"over {document['orbits']} orbits of {document['counted']} bounces, per bounce; starts: {law}")
    for group in document["groups"]:
        alike = sum(other["kind"] == group["kind"] for other in document["groups"]) > 1
        console.print(f"{group['orbits']:>8} orbits: {group['kind']}{f', at {place(group)}' if alike else ''}")
        if group.get("undecided"):
            console.print(f"{'':>17} undecided whether it is one attractor or several: {group['undecided']}")
        if group["nu_plus"] is not None:
            both = (f"{name} = {_measured(group, name)}" for name in ("nu_plus", "nu_minus"))
            console.print(f"{'':>17} {', '.join(both)}")
        if group.get("mean_flight"):
            both = (f"{name} = {_measured(group, f'{name}_per_time')}" for name in ("nu_plus", "nu_minus"))
            console.print(f"{'':>17} mean flight {_measured(group, 'mean_flight')}; per unit of time {', '.join(both)}")
        if group.get("naive_stderr"):
            ratio = group["nu_plus_stderr"] / group["naive_stderr"]
            console.print(
                f"{'':>17} autocorrelation time {group['autocorrelation_time']:.3g} bounces; the error is {ratio:.3g} "
                "times that of independent bounces"
            )
        if group.get("trusted") is False:
            console.print(f"{'':>17} the run is short compared with this time: the error bar is rough")
        if group.get("skewed"):
            console.print(
                f"{'':>17} rare stretches make the error (skewness {group['skewness']:.2g}): 95 per cent interval of "
                f"nu_plus {group['interval_95'][0]:.6g} to {group['interval_95'][1]:.6g}"
            )
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


def place(described: dict[str, Any]) -> str:
    """A point of an attractor as text: its coordinates in the table and its exit angle.

    >>> place({"at": {"x": 0.0, "y": -2e-10, "phi": 0.25}})
    '0.000e+00, -2.000e-10, 0.250'
    """
    x, y, phi = (described["at"][key] for key in ("x", "y", "phi"))
    size = max(abs(x), abs(y))
    digits = ".3f" if size == 0 or 0.01 <= size < FAR else ".3e"
    at = (format(round(value, 3) + 0.0 if digits == ".3f" else value, digits) for value in (x, y))
    return f"{', '.join(at)}, {round(phi, 3) + 0.0:.3f}"


def _measured(document: dict[str, Any], name: str) -> str:
    value, error = document[name], document[f"{name}_stderr"]
    if value is None:
        return "-oo"
    return f"{value:.12g}" if error == 0 else f"{value:.6g}" + ("" if error is None else f" +- {error:.1g}")
