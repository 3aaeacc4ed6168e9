"""Families of cycles from birth to death: their table, their events with proofs, and pictures of large families.

`level` counts the refinements, from 0. `heard` is called with a text about each step, and may raise `TimeoutError`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from sympy import S

from numeric import PinballMap
from numeric.dynamics.attractors import find
from numeric.dynamics.phase_points import PhasePoints
from numeric.dynamics.recognition import Kind, wilson
from numeric.dynamics.symmetries import moved, symmetries_of
from numeric.sweeps.endings import CHAOTIC, NEUTRAL, STOPPED
from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import decimal
from verification.arithmetic.iteration import silent
from verification.cycles.branch import Branch, Event
from verification.cycles.cascade import FEIGENBAUM
from verification.cycles.chords import Chords
from verification.cycles.recurrence import BifurcationKind
from verification.named.attractors import joined
from verification.named.events import digits_to_follow, proof_of
from verification.named.families import SETS, SURE, Continuation, FamilyEvent
from verification.named.questions import PeriodicOrbit, Tick, follow
from verification.plots.dynamics import plotted
from verification.plots.sheet import styled
from verification.reports.asked import DRAWN, Asked, Parts
from verification.reports.blocks import (
    Block,
    Cell,
    Certificate,
    Effort,
    Known,
    Listing,
    Paragraph,
    Picture,
    ShownNumber,
    sampled,
    solved,
)
from verification.reports.dynamics import counted, wrapped
from verification.reports.pictures import saved

Document = dict[str, Any]
Made = tuple[list[Block], list[Effort], Document]
FEWER = 40  # starts at a value where the flight is slow
MOST = 250  # points of a branch, each way
LOCATED = 9  # digits of an event
CERTAIN = {BifurcationKind.BRANCH_POINT: 7}  # where branches cross the equations are singular
VALUES, SHAPES = (50, 200, 400, 800), (10, 40, 80, 160)  # of the contraction, or of another letter, at each level
DRAWN_ALONE = 6  # families that have a picture of their own
OTHER = ("chaotic", "neutral", "stopped", "other")  # of the shares, after those of the families


def continuation(asked: Asked, parts: Parts, level: int, heard: Tick) -> Continuation:
    """Continues to follow the families known so far, and returns them; raises `TimeoutError` if `heard` does."""
    found: Continuation = parts.memory.get("families") or Continuation(
        asked.scene, asked.parameter, (asked.low, asked.high), seed=asked.seed
    )
    if not found.seen and found.map_at(asked.own_value).family.slow:
        found.starts = FEWER
    parts.memory["families"], found.tick = found, heard
    found.run((VALUES if asked.parameter == "lam" else SHAPES)[level])
    return found


def families(asked: Asked, parts: Parts, level: int, heard: Tick) -> Made:
    """The section on families that attract random starts, with fractions of starts and a check at unused values."""
    try:
        found, late = continuation(asked, parts, level, heard), False
    except TimeoutError:
        found, late = parts.memory["families"], True
        if not found.seen:
            raise
    found.tick = silent  # the check is not ended
    numbers = _shares(found)
    parts.keep(f"families-{level}", numbers | lines(asked, found))
    checked = found.check()
    data = {
        "level": level,
        "late": late,
        "families": [family_said(found, i, numbers) for i in range(len(found.families))],
        "events": [event_said(found, event) for event in found.events],
        "ranges": found.document_of_ranges(),
        "amid_chaos": found.amid_chaos(),
        "unfollowed": [[one.value, one.period, one.share, one.why] for one in found.unfollowed],
        "values": len(found.seen),
        "starts": found.starts,
        "small": int(numbers["counts"][:, -1].sum()),
        "total": int(numbers["counts"].sum()),
        "check": checked.document() | {"words": checked.words},
        "command": asked.command("follow", asked.varied, f"--all --digits {asked.digits}"),
    }
    size = f"{len(found.seen)} values of {asked.parameter}, {data['total']} starts, {len(found.families)} families"
    return [], [Effort("families of cycles", size, 0.0)], data


def _shares(found: Continuation) -> dict[str, Any]:
    """The number of starts that end on each family, or are chaotic, neutral, stopped or other, at each value."""
    n = len(found.families)
    counts = np.zeros((len(found.seen), n + len(OTHER)), dtype=np.int32)
    for row, seen, label in zip(counts, found.seen, found.labels, strict=True):
        row[:n] = np.bincount(label[label >= 0], minlength=n)[:n]
        row[n:-1] = [np.sum(seen.kind == kind) for kind in (CHAOTIC, NEUTRAL, STOPPED)]
        row[-1] = seen.starts - row[:-1].sum()
    return {"shares_at": np.array([seen.value for seen in found.seen]), "counts": counts}


def lines(asked: Asked, found: Continuation) -> dict[str, Any]:
    """Curves for the diagram, with nan between: family, parameter, arc length of the bounces and symmetric images."""
    map = found.map_at(asked.own_value)
    half, group = map.arclength.perimeter / 2, symmetries_of(map)
    rows = list[Any]()
    for number, family in enumerate(found.families):
        ring = family.branch.system.recurrence
        assert isinstance(ring, Chords)
        placed = [ring.placed(point.z[:-1]) for point in family.branch.points]
        part = np.array([at.components for at, _ in placed])
        theta = np.array([x for _, x in placed])
        values = np.where(family.stable, family.branch.values, np.nan)
        for symmetry in group:
            image = moved(symmetry, PhasePoints(part.ravel(), theta.ravel(), np.zeros(theta.size)))
            s = wrapped(map.arclength.s(image.theta, image.component), half).reshape(theta.shape)
            s[1:][np.abs(np.diff(s, axis=0)) > half] = np.nan  # over the end of the circle
            for column in s.T:
                rows.append((np.full(len(values) + 1, number), np.append(values, np.nan), np.append(column, np.nan)))
    columns = [np.concatenate(each) for each in zip(*rows, strict=True)] if rows else [np.empty(0)] * 3
    return {**dict(zip(("family", "at", "s"), columns, strict=True)), "half": np.array(half)}


def family_said(found: Continuation, number: int, numbers: Mapping[str, Any]) -> Document:
    """A family as plain data: its JSON, its parent, its largest fraction of the starts, and one of its cycles."""
    family = found.families[number]
    best = int(np.argmax(numbers["counts"][:, number] / numbers["counts"].sum(axis=1)))
    parent = family.parent if family.birth else next((e.family for e in found.events if e.born == number), None)
    return {
        **found.branch_document(family),
        "parent": None if parent == number else parent,
        "largest": [float(numbers["shares_at"][best]), int(numbers["counts"][best, number]), found.seen[best].starts],
        "cycle": said_of(found.cycle(family)),
        "at": repr(float(family.start[-1])),
        "ends": [why.removesuffix(" was reached") for _, why in family.branch.ends],
    }


def event_said(found: Continuation, event: FamilyEvent) -> Document:
    """An event as plain data, without its proof."""
    form = event.event.form
    plain = found.event_document(event, None, LOCATED)
    return {**plain, "supercritical": form.supercritical if form else None, "key": key_of(plain)}


def key_of(event: Mapping[str, Any]) -> str:
    """A name of the event that is the same at every level of refinement."""
    return f"{event['kind']} {event['period']} {float(event['value']):.8f}"


def proofs(asked: Asked, parts: Parts, level: int, heard: Tick) -> Made:
    """Proves events as far as there is time, those of the families that most starts reach first."""
    before = parts.read(f"proofs-{level - 1}")
    data: Document = {"proofs": dict(before["data"]["proofs"]) if before else {}, "late": False}
    blocks: list[Block] = []
    try:
        found = parts.memory.get("families") or continuation(asked, parts, level, heard)
        said = parts.read(f"families-{level}")
        shares = [one["largest"][1] for one in said["data"]["families"]] if said else []
        for event in sorted(found.events, key=lambda one: -shares[one.family] if one.family < len(shares) else 0):
            key = key_of(found.event_document(event, None, LOCATED))
            if key in data["proofs"]:
                continue
            heard(key)
            name = f"event-{len(data['proofs'])}"
            number, checks, certificate = located(asked, event.event, name, found.families[event.family].branch)
            data["proofs"][key] = {
                "value": number.value,
                "error": number.error,
                "checks": checks,
                "proved": number.known is Known.PROVED,
                "file": name if certificate else None,
            }
            blocks += [certificate] if certificate else []
    except TimeoutError:
        data["late"] = True
    blocks = ([Certificate(**b) for b in _certificates(before)] if before else []) + blocks
    return blocks, [Effort("events proved", f"{len(data['proofs'])} events", 0.0)], data


def _certificates(found: Mapping[str, Any]) -> Iterator[Document]:
    """The certificates among the blocks of a step."""
    for block in found["blocks"]:
        if block["kind"] == "certificate":
            yield {key: value for key, value in block.items() if key != "kind"}


def life(asked: Asked, parts: Parts, said: Document, number: int) -> Made:
    """A section with the picture of one family: its bounces along the branch, and its events."""
    found = parts.memory.get("families")
    orbit = orbit_of(asked.scene.at(**{asked.parameter: said["at"]}), said["cycle"])
    branch = found.families[number].branch if found else followed(asked, orbit)
    with styled():
        drawn = plotted([branch])
        drawn.set_size_inches(6.4, 3.2)
        saved(parts, f"life-{number}", drawn)
    caption = (
        f"Family {number}, period {said['period']}, through theta = {orbit.theta[0]:.6f} at {asked.parameter} = "
        f"{float(said['at']):.6g}: its bounces along the branch, solid where it attracts and dashed where not, with "
        "its events. In float64."
    )
    alt = f"Bounces of a cycle of period {orbit.period} against {asked.parameter}"
    picture = Picture(f"life-{number}", caption, alt, f"{command(asked, orbit, said['at'])} {DRAWN}")
    return (
        [picture],
        [Effort(f"picture of family {number}", f"{len(branch.points)} points", 0.0)],
        {"mark": said["low"]},
    )


def chaos(asked: Asked, said: Document) -> Made:
    """A table of the chaotic attractors that coexist at some values; symmetric images are counted as copies."""
    rows: list[tuple[Cell, ...]] = []
    for value in said["amid_chaos"]:
        map = PinballMap(asked.scene.at(**{asked.parameter: repr(value)}))
        row = joined(find(map, SETS, asked.seed, images=True), SETS, value)
        for one in row.members:
            if one.kind is Kind.CHAOTIC:
                nu = sampled(one.nu_plus, one.first.errors[0], 5e-5)
                group = f"{one.symmetry}, {one.copies}"
                doubt = one.first.doubt or "-"
                rows.append((f"{value:.6g}", group, counted(one.share.count, SETS), nu, str(row.attractors), doubt))
    caption = (
        f"Chaotic attractors that coexist, at some values of {asked.parameter}: told apart by the cells that {SETS} "
        "random starts meet, with their images under the symmetries. Sampled."
    )
    columns = asked.parameter, "symmetry, copies", "share of the starts", "nu_plus", "attractors in all", "doubt"
    blocks: list[Block] = [Listing(caption, columns, tuple(rows), said["command"])] if rows else []
    size = f"{len(said['amid_chaos'])} values, {SETS} starts"
    return blocks, [Effort("chaotic attractors told apart", size, 0.0)] if rows else [], {}


def drawn_alone(said: Sequence[Document]) -> list[int]:
    """The indices of the `DRAWN_ALONE` families that the most starts reach."""
    order = sorted(range(len(said)), key=lambda i: -said[i]["largest"][1] / said[i]["largest"][2])
    return sorted(order[:DRAWN_ALONE])


def said_of(orbit: PeriodicOrbit) -> Document:
    """A cycle as plain data for JSON."""
    one, two = orbit.multipliers
    return {
        "components": list(orbit.components),
        "theta": list(orbit.theta),
        "phi": list(orbit.phi),
        "multipliers": [[one.real, one.imag], [two.real, two.imag]],
    }


def orbit_of(scene: Scene, said: Document) -> PeriodicOrbit:
    """The cycle from the plain data of `said_of`."""
    one, two = (complex(*pair) for pair in said["multipliers"])
    return PeriodicOrbit(scene, tuple(said["components"]), tuple(said["theta"]), tuple(said["phi"]), (one, two))


def followed(asked: Asked, orbit: PeriodicOrbit) -> Branch:
    """The branch of a cycle over the interval of the report."""
    interval: dict[str, Any] = {asked.parameter: (asked.low, asked.high)}
    return follow(orbit, points=MOST, **interval).branch


def events_of(said: Document, proved: Mapping[str, Document]) -> list[Document]:
    """The events as JSON, with the digits of those that are proved."""
    found = []
    for event in said["events"]:
        proof = proved.get(event["key"])
        digits = {"value": proof["value"], "radius": proof["error"] or None} if proof else {"radius": None}
        plain = {key: event[key] for key in ("kind", "period", "parameter", "value", "branch", "born")}
        found.append({**plain, **digits, "certified": bool(proof and proof["file"])})
    return found


def event_blocks(said: Document, proved: Mapping[str, Document], more: Sequence[Block]) -> list[Block]:
    """The table of events, and estimates of the limits of period-doubling cascades."""
    rows: list[tuple[Cell, ...]] = []
    for event in said["events"]:
        proof = proved.get(event["key"])
        known = Known.PROVED if proof and proof["proved"] else Known.FLOAT
        where = ShownNumber(proof["value"], proof["error"], known) if proof else solved(float(event["value"]), LOCATED)
        side = {True: "supercritical", False: "subcritical", None: ""}[event["supercritical"]]
        born = "-" if event["born"] is None else f"family {event['born']}"
        words = kind_of(event)
        checks = proof["checks"] if proof else "left for more time"
        rows.append((where, words, side, str(event["period"]), f"family {event['branch']}", born, checks))
    caption = (
        "Every event next to which a family attracts, in order of the parameter; located in float64 and then proved in "
        "balls where its kind has a certificate."
    )
    columns = "at", "what happens", "criticality", "period", "on", "born there", "checklist"
    first: Block = (
        Listing(caption, columns, tuple(rows), said["command"]) if rows else Paragraph("No family has an event.")
    )
    return [first, *_cascades(said), *more]


def kind_of(event: Document) -> str:
    """The kind of an event in words, such as "period doubling"."""
    return BifurcationKind[event["kind"].upper()].value


def named_certificates(said: Document, proved: Mapping[str, Document], blocks: Sequence[Block]) -> list[Block]:
    """The blocks, the events' certificates first: in the order of their table, titled by kind, period and value."""
    words: dict[str, str] = {}
    for event in said["events"]:
        file = proved.get(event["key"], {}).get("file")
        if file:
            at = f"{event['parameter']} = {float(event['value']):#.6g}"
            words[file] = f"{kind_of(event)} of period {event['period']} at {at}"
    known = {block.name: block for block in blocks if isinstance(block, Certificate) and block.name in words}
    first = [replace(known[name], words=text) for name, text in words.items() if name in known]
    return [*first, *(block for block in blocks if block not in known.values())]


def _cascades(said: Document) -> list[Block]:
    """A sentence for each chain of period doublings: the ratios of their distances, and an estimate of the limit."""
    flips = [event for event in said["events"] if event["kind"] == "flip"]
    after = [_next_doubling(flip, flips) for flip in flips]
    blocks: list[Block] = []
    for start in sorted(set(range(len(flips))) - set(after), key=lambda i: flips[i]["branch"]):
        values: list[float] = []
        at: int | None = start
        while at is not None:
            values.append(float(flips[at]["value"]))
            at = after[at]
        gaps = np.diff(values)
        if len(gaps) < 2 or not (np.all(gaps > 0) or np.all(gaps < 0)):
            continue
        ratios = ", ".join(f"{a / b:.4f}" for a, b in pairwise(gaps))
        limits = [b + (b - a) / (FEIGENBAUM - 1) for a, b in pairwise(values)]
        blocks.append(
            Paragraph(
                f"Cascade from family {flips[start]['branch']} of period {flips[start]['period']}: "
                f"{len(values)} doublings in a row; successive distances have the ratios {ratios}; Feigenbaum's is "
                f"4.6692. If further ones shrink by that number the cascade accumulates at {limits[-1]:.8g} ± "
                f"{abs(limits[-1] - limits[-2]):.1g}: an estimate from the last two distances, not proved."
            )
        )
    return blocks


def _next_doubling(flip: Document, flips: Sequence[Document]) -> int | None:
    """The index of the first doubling of the family that is born at `flip`; the family may double again elsewhere."""
    there = [i for i, e in enumerate(flips) if e["branch"] == flip["born"] and e["period"] == 2 * flip["period"]]
    return min(there, key=lambda i: abs(float(flips[i]["value"]) - float(flip["value"])), default=None)


def family_blocks(asked: Asked, said: Document) -> list[Block]:
    """The table of the families, and the ranges without cycles."""
    rows: list[tuple[Cell, ...]] = []
    for number, one in enumerate(said["families"]):
        where = "; ".join(f"{low:.6g} to {high:.6g}" for low, high in one["attracts"]) or "nowhere"
        value, count, of = one["largest"]
        share = f"{count} of {of} at {value:.4g}, at least {wilson(count, of).low:.1%}" if count else "-"
        origin = "-" if one["parent"] is None else f"family {one['parent']}"
        exists = f"{one['low']:.6g} to {one['high']:.6g}"
        group = f"{one['symmetry']}, {one['copies']}"
        rows.append((str(number), str(one["period"]), group, exists, where, origin, share))
    caption = (
        f"Families of cycles, each once, its images under the symmetries counted as copies. {said['total']} random "
        f"starts at {said['values']} values of {asked.parameter} found them, {said['starts']} at each and fewer at the "
        "closer values within chaos; each was followed from birth to "
        "death, and a long one only while it attracts and for a while beyond."
    )
    columns = "family", "period", "symmetry, copies", "exists", "attracts", "born on", "largest share of the starts"
    blocks: list[Block] = []
    if rows:
        blocks.append(Listing(caption, columns, tuple(rows), said["command"]))
    if said["ranges"]:
        ranges = tuple((one["kind"], *(_between(one[end]) for end in ("low", "high"))) for one in said["ranges"])
        words = (
            "Where random starts end on no cycle; each end was bisected between two values, and windows divide ranges. "
            "Chaos counts that lasts while areas shrink by exp(100), and for some thousand bounces at least: beyond a "
            "crisis it may last so long and still end."
        )
        blocks.append(Listing(words, ("what", "from", "to"), ranges, said["command"]))
    return blocks


def _between(ends: Sequence[float]) -> ShownNumber:
    return sampled(sum(ends) / 2, abs(ends[1] - ends[0]) / 2)


def on_no_family(asked: Asked, said: Document, attractors: Sequence[Document]) -> list[str]:
    """The attracting cycles in the section on basins that no family has, in words; few starts may reach them."""
    found = []
    for one in attractors if asked.parameter == "lam" else ():
        at = float(exact("lam", one["lam"]))
        ranges = [r for each in said["families"] if each["period"] == one["period"] for r in each["attracts"]]
        if one["kind"] == "cycle" and not any(low <= at <= high for low, high in ranges):
            found.append(f"period {one['period']} at lam = {one['lam']}")
    return found


def missing_blocks(asked: Asked, said: Document, attractors: Sequence[Document] = ()) -> list[Block]:
    """The blocks on what may be missing: the check, cycles that could not be followed, and too small basins."""
    check = said["check"]
    total = len(check["values"]) * check["starts"]
    blocks: list[Block] = []
    if check["missing"]:
        blocks.append(Paragraph(f"SHORTFALL. {check['words']}"))
    else:
        blocks.append(Paragraph(check["words"]))
    if apart := on_no_family(asked, said, attractors):
        words = f"SHORTFALL. Attractors in the section on basins that are on no family: {'; '.join(apart)}."
        blocks.append(Paragraph(words))
    blocks.append(
        Paragraph(
            f"The check used {total} starts, at the values {', '.join(f'{x:.4g}' for x in check['values'])} of "
            f"{asked.parameter}. "
            f"At one value {said['starts']} starts miss what attracts a share of {SURE / said['starts']:.2g} with a "
            f"chance of 5 %; at k values they miss a share of {SURE / said['starts']:.2g}/k. "
            f"{said['small']} of {said['total']} starts ended on anything else than a family, a "
            "range or a corner. A family that lives only between two values that were sampled is not seen."
        )
    )
    rows = tuple((f"{value:.6g}", str(n), f"{share:.1%}", why) for value, n, share, why in said["unfollowed"])
    if rows:
        blocks.append(Listing("Cycles that could not be followed.", ("at", "period", "share", "why"), rows))
    if said["late"]:
        blocks.append(Paragraph("The time ended before every cycle that was seen had been followed."))
    return blocks


def located(asked: Asked, event: Event, name: str, branch: Branch) -> tuple[ShownNumber, str, Certificate | None]:
    """An event's value (to `digits` digits if it can be certified), its checklist in words, and its certificate."""
    between = float(np.max(np.abs(np.diff(branch.values)), initial=0.0))  # two points, one of them on either side
    digits, step = CERTAIN.get(event.kind, LOCATED), 0.0 if event.located else between
    plain = solved(event.value, digits, step)
    more = digits_to_follow(event.ring.period)
    lam = None if asked.parameter == "lam" else S(asked.scene.lam)
    try:
        proof = proof_of(event, asked.digits + more, asked.parameter, lam)
    except (ValueError, ZeroDivisionError) as why:
        return plain, f"no proof: {why}", None
    if proof is None:
        return plain, "no certificate for this kind", None
    value, radius = decimal(proof.value, asked.digits + 1)
    if proof.open:
        return plain, f"open: {', '.join(proof.open)}", None
    number, checks = ShownNumber(value, radius, Known.PROVED), f"all {len(proof.checks)} items hold"
    try:
        return number, checks, Certificate(name, proof.document())
    except ValueError as why:  # what the format does not hold
        return number, f"{checks}; no file: {why}", None


def command(asked: Asked, orbit: PeriodicOrbit, text: str) -> str:
    """The `pinball follow` command for a cycle."""
    over = [asked.varied, f"--at {text}"] if asked.parameter == "lam" else [asked.varied]
    return asked.command("follow", *over, start_of(asked, orbit), f"--digits {asked.digits}")


def start_of(asked: Asked, orbit: PeriodicOrbit) -> str:
    """The options for `pinball follow` that give the bounces of a cycle."""
    names = [part.name for part in asked.scene.table.components]
    start = f"--start={','.join(f'{x:.9f}' for x in orbit.theta)}"
    if len(names) == 1:
        return start
    return f"{start} --components {','.join(names[i] for i in orbit.components)}"
