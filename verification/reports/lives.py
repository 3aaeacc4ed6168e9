"""Every cycle that a search finds, followed from birth to death: its events, certified, and the doublings beyond."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from sympy import S

from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import decimal
from verification.cycles.arc import End, LostError, Steps
from verification.cycles.branch import Branch, Event, spectrum_of
from verification.cycles.cascade import FEIGENBAUM
from verification.cycles.recurrence import BifurcationKind
from verification.cycles.switching import switched
from verification.named.events import EventCurve, Plane, curves_along, proof_of
from verification.named.files import document
from verification.named.questions import PeriodicOrbit, Tick, find_cycles, follow
from verification.plots.dynamics import plotted
from verification.plots.sheet import styled
from verification.proofs.periodic.bifurcation import Proof
from verification.reports.asked import DRAWN, Asked, Parts
from verification.reports.blocks import Block, Cell, Certificate, Effort, Known, Listing, Number, Picture, Words, solved
from verification.reports.pictures import saved

Document = dict[str, Any]
Made = tuple[list[Block], list[Effort], Document]
MOST = 250  # points of a branch, each way
DOUBLED = 60  # of the branch of a doubled cycle
STEPS = Steps(largest=0.2, most=150)  # of a curve
LOCATED, PLACED = 9, 6  # digits of an event, and of a point on a curve
CERTAIN = {BifurcationKind.BRANCH_POINT: 7}  # where branches cross the equations are singular
MARK = 5  # decimals of trace and determinant by which cycles are told apart
LAWS = {True: "vanish", False: "do not vanish", None: "no such law here"}


def search(asked: Asked, text: str, heard: Tick = lambda said: None) -> Made:
    """The cycles up to the asked period at one contraction, as far as a search finds them; `heard` after each round."""
    found = find_cycles(asked.scene.at(lam=text), up_to=asked.period, seed=asked.seed, tick=heard)
    searched = found.searched
    assert searched is not None
    data = {
        "at": text,
        "rows": [
            [n, len(found.of(n)), len(found.of(n).stable), LAWS[searched.balanced[n]]]
            for n in range(2, asked.period + 1)
        ],
        "degenerate": searched.catalogue.degenerate,
        "resolution": searched.catalogue.resolution(asked.period),
        "cycles": [said_of(orbit) for orbit in found],
    }
    return [], [Effort(f"search at lambda = {text}", f"{searched.rounds} rounds", 0.0)], data


def searched_blocks(asked: Asked, searches: Sequence[Document]) -> list[Block]:
    """What all searches found, in one table, and what they cannot tell."""
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (said["at"], str(n), str(count), str(stable), sums)
        for said in searches
        for n, count, stable, sums in said["rows"]
    )
    last = searches[-1]
    caption = (
        "Cycles found at each contraction by a search in float64, images under the symmetries counted apart. A search "
        "proves no completeness; where the index sums vanish no single cycle is missed, but a pair may be: "
        f"{last['resolution']}."
    )
    degenerate = sum(said["degenerate"] for said in searches)
    if degenerate:
        caption += f" {degenerate} times a cycle with the multiplier 1 was met, of a family or at a bifurcation."
    command = asked.command("cycles", f"--period {asked.period} --seed {asked.seed}", lam=last["at"])
    return [Listing(caption, ("lam", "period", "cycles", "stable", "index sums"), rows, command)]


def said_of(orbit: PeriodicOrbit) -> Document:
    """A cycle as plain data."""
    one, two = orbit.multipliers
    return {
        "components": list(orbit.components),
        "theta": list(orbit.theta),
        "phi": list(orbit.phi),
        "multipliers": [[one.real, one.imag], [two.real, two.imag]],
        "mark": mark(orbit.period, (one + two).real, (one * two).real),
    }


def mark(period: int, trace: float, determinant: float) -> list[float]:
    """What cycles have in common that a symmetry exchanges."""
    return [period, round(trace, MARK) + 0.0, round(determinant, MARK) + 0.0]


def orbit_of(scene: Scene, said: Document) -> PeriodicOrbit:
    """The cycle that was written down."""
    one, two = (complex(*pair) for pair in said["multipliers"])
    return PeriodicOrbit(scene, tuple(said["components"]), tuple(said["theta"]), tuple(said["phi"]), (one, two))


def known(said: Document, text: str, lives: list[Document]) -> bool:
    """Does one of the branches that were followed pass through this cycle, or an image of it, at a contraction?"""
    return any(_near(said["mark"], each) for life in lives for each in life["passes"].get(text, []))


def _near(one: list[float], two: list[float]) -> bool:
    return one[0] == two[0] and all(abs(a - b) <= 3 * 10**-MARK * (1 + abs(a)) for a, b in zip(one, two, strict=True))


def life(asked: Asked, parts: Parts, text: str, said: Document, number: int) -> Made:
    """A cycle followed both ways to the ends of its branch, with what happens on the way."""
    orbit = orbit_of(asked.scene.at(lam=text), said)
    name = f"life-{number}"
    try:
        branch = followed(asked, orbit)
    except (ValueError, LostError, ZeroDivisionError) as why:
        words = Words(f"A cycle of period {orbit.period} at lambda = {text} could not be followed: {why}.")
        return [words], [], {"passes": {text: [said["mark"]]}, "events": []}
    events = [located(asked, event, orbit.period, f"{name}-{i}", branch) for i, event in enumerate(branch.events)]
    blocks: list[Block] = [_listing(asked, branch, orbit, events, text)]
    with styled():
        drawn = plotted([branch])
        drawn.set_size_inches(6.0, 3.2)
        saved(parts, name, drawn)
    caption = (
        f"The cycle of period {orbit.period} through theta = {orbit.theta[0]:.6f} at lambda = {text}: its bounces "
        "along the branch, solid where it attracts and dashed where not, with its events. In float64."
    )
    alt = f"Bounces of a cycle of period {orbit.period} against {asked.parameter}"
    blocks.append(Picture(name, caption, alt, f"{command(asked, orbit, text)} {DRAWN}"))
    blocks += [event.certificate for event in events if event.certificate]
    certified = sum(event.certificate is not None for event in events)
    size = f"{len(branch.points)} points, {certified} certificates"
    data = {
        "passes": _passing(asked, branch, text, said["mark"]),
        "events": [[event.value, event.label] for event in events],
        "located": [event.document(asked.parameter, orbit.period) for event in events],
        "flips": [i for i, event in enumerate(branch.events) if event.kind is BifurcationKind.FLIP],
        "cycle": said,
        "at": text,
    }
    return blocks, [Effort(f"cycle {number} of period {orbit.period} followed", size, 0.0)], data


def followed(asked: Asked, orbit: PeriodicOrbit) -> Branch:
    """The branch of a cycle over the interval that was asked for."""
    interval: dict[str, Any] = {asked.parameter: (asked.low, asked.high)}
    return follow(orbit, points=MOST, **interval).branch


def _passing(asked: Asked, branch: Branch, text: str, own: list[float]) -> dict[str, list[list[float]]]:
    """The marks of the cycles where a branch passes the contractions that are looked at, its `own` among them."""
    system, found = branch.system, {text: [own]}
    for other in asked.at if asked.parameter == "lam" else ():
        value = float(exact("--at", other))
        try:
            tests = [system.tests(z) for z in branch.at(value)]
        except LostError:  # between two points where the branch turns
            continue
        found.setdefault(other, []).extend(
            mark(system.recurrence.period, (t["minus_one"] - t["one"]) / 2, t["volume"] + 1) for t in tests
        )
    return found


@dataclass(frozen=True)
class Located:
    """An event of a branch with the words of its label, its number, and its certificate if it has one."""

    event: Event
    label: str
    number: Number
    checks: str = "no certificate for this kind"
    certificate: Certificate | None = None

    @property
    def value(self) -> float:
        """The parameter."""
        return self.event.value

    @property
    def row(self) -> tuple[Cell, ...]:
        """What a table says of it."""
        form = self.event.form
        side = {True: "supercritical", False: "subcritical", None: ""}[form.supercritical if form else None]
        return self.event.kind.value, self.number, side, self.checks

    def document(self, parameter: str, period: int) -> Document:
        """The event for JSON; its value and radius are decimals as text."""
        return {
            "kind": self.event.kind.name.lower(),
            "period": period,
            "parameter": parameter,
            "value": self.number.value,
            "radius": self.number.error or None,
            "certified": self.certificate is not None,
        }


def located(asked: Asked, event: Event, period: int, name: str, branch: Branch) -> Located:
    """An event of a branch, certified to the asked digits where its kind has certificates."""
    between = float(np.max(np.abs(np.diff(branch.values)), initial=0.0))  # two points, one of them on either side
    digits, step = CERTAIN.get(event.kind, LOCATED), 0.0 if event.located else between
    plain = Located(event, f"{event.kind.value} {period}", solved(event.value, digits, step))
    try:
        proof = proof_of(event, asked.digits, asked.parameter, None if asked.parameter == "lam" else S(asked.scene.lam))
    except (ValueError, ZeroDivisionError) as why:
        return Located(event, plain.label, plain.number, f"no proof: {why}")
    return plain if proof is None else _proved(asked, plain, proof, name)


def _proved(asked: Asked, plain: Located, proof: Proof, name: str) -> Located:
    value, radius = decimal(proof.value, asked.digits + 1)
    open_ = [item for item, holds in proof.checks.items() if holds is not True]
    checks = f"open: {', '.join(open_)}" if open_ else f"all {len(proof.checks)} items hold"
    number = Number(value, radius, Known.FLOAT if open_ else Known.PROVED)
    try:
        certificate = None if open_ else Certificate(name, document(proof))
    except ValueError as why:  # what the format does not hold
        return Located(plain.event, plain.label, number, f"{checks}; no file: {why}", None)
    return Located(plain.event, plain.label, number, checks, certificate)


def plane_of(asked: Asked) -> Plane:
    """The plane of a report in two parameters."""
    assert asked.second is not None
    name, low, high = asked.second
    return Plane.of(asked.scene, name, (low, high), (asked.low, asked.high))


def curves(
    asked: Asked, said: Document, number: int, known: Sequence[Document], heard: Tick = lambda said: None
) -> Made:
    """The events of a life as curves in both parameters, and those that the cycle meets along the other parameter.

    Left out are those that lie on a curve that is `known`.
    """
    plane, found = plane_of(asked), list[Document]()
    for branch, other, options in _lines(asked, said):
        heard(options)
        seen = [EventCurve(**each) for each in (*known, *found)]
        for curve in curves_along(branch, plane, other, seen, STEPS, lambda point: heard("curve")):
            deeper = f" --switch {curve.depth}" if curve.depth else ""
            found.append(curve.document() | {"command": asked.command("follow", f"{options}{deeper}")})
    return [], [Effort(f"curves of cycle {number}", f"{len(found)} curves", 0.0)], {"curves": found}


def _lines(asked: Asked, said: Document) -> Iterator[tuple[Branch, float, str]]:
    """The life in the contraction, and at each contraction that is looked at the same cycle in the other parameter.

    With each comes the number of the parameter that is fixed, and the options that follow it again.
    """
    assert asked.second is not None
    letter, low, high = asked.second
    here = orbit_of(asked.scene.at(lam=said["at"]), said["cycle"])
    branch = followed(asked, here)
    over = f"--lam {asked.low}:{asked.high} --at {said['at']} --curves {letter}={low}:{high}"
    yield branch, asked.own, f"{over} {start_of(asked, here)}"
    for text in asked.at:
        lam = float(exact("--at", text))
        try:
            places = branch.at(lam)
        except LostError:
            continue
        for z in places:
            orbit = replace(here, scene=asked.scene.at(lam=text), theta=tuple(z[:-1].tolist()))
            over = f"--lam {text} --shape {letter}={low}:{high} --curves lam={asked.low}:{asked.high}"
            interval: dict[str, Any] = {letter: (low, high)}
            try:
                other = follow(orbit, points=MOST, **interval).branch
            except ValueError:  # a cycle of a family, or at a bifurcation
                continue
            yield other, lam, f"{over} {start_of(asked, orbit)}"


def curve_blocks(asked: Asked, found: Sequence[Document]) -> list[Block]:
    """What each curve is, where it runs, and the command that follows it."""
    assert asked.second is not None
    letter = asked.second[0]
    blocks: list[Block] = []
    for number, curve in enumerate(found, 1):
        place, ends = "({:.6g}, {:.6g})", (curve["points"][0], curve["points"][-1])
        rows: list[tuple[Cell, ...]] = [
            (
                f"end: {why.removesuffix(' was reached')}",
                *(solved(x, PLACED) for x in np.round(point[:2], 9) + 0.0),
            )
            for why, point in zip(curve["ends"], ends, strict=True)
        ]
        rows += [(what, *(solved(x, PLACED) for x in np.round(point, 9) + 0.0)) for what, *point in curve["special"]]
        caption = (
            f"Curve {number}: {curve['kind']} of period {curve['period']}, through ({letter}, lambda) = "
            f"{place.format(*curve['near'])}; {len(curve['points'])} points, each solved for in float64."
        )
        blocks.append(Listing(caption, ("what", letter, "lambda"), tuple(rows), curve["command"]))
    if not found:
        blocks.append(Words("No curve: the cycles that were followed met no fold, doubling or pitchfork on their way."))
    return blocks


COLUMNS = "what happens", "at", "branch that is born", "checklist"


def _listing(asked: Asked, branch: Branch, orbit: PeriodicOrbit, events: list[Located], text: str) -> Listing:
    """Birth, death and what happens between."""
    rows: list[tuple[Cell, ...]] = []
    for points, (end, why) in zip((branch.points[:2], branch.points[:-3:-1]), branch.ends, strict=True):
        values = [float(point.z[-1]) for point in points]
        exact = Number(f"{values[0]:.9g}") if end is End.INTERVAL else None
        where = exact or solved(values[0], LOCATED, abs(values[-1] - values[0]))
        rows.append((f"branch ends: {why.removesuffix(' was reached')}", where, "", "-"))
    rows[1:1] = [event.row for event in events]
    stable = np.array([spectrum_of(point).stable for point in branch.points])
    share = f"attracts at {stable.mean():.0%} of the points of its branch" if stable.any() else "attracts nowhere"
    caption = (
        f"Cycle of period {orbit.period}, found at lambda = {text}: {share}. Events are located in float64 and then "
        "proved in balls, where their kind has a certificate."
    )
    return Listing(caption, COLUMNS, tuple(rows), command(asked, orbit, text))


def command(asked: Asked, orbit: PeriodicOrbit, text: str) -> str:
    """The command that follows a cycle."""
    over = [asked.varied, f"--at {text}"] if asked.parameter == "lam" else [asked.varied]
    return asked.command("follow", *over, start_of(asked, orbit), f"--digits {asked.digits}")


def start_of(asked: Asked, orbit: PeriodicOrbit) -> str:
    """The options that name the bounces of a cycle."""
    names = [part.name for part in asked.scene.table.components]
    start = f"--start={','.join(f'{x:.9f}' for x in orbit.theta)}"
    if len(names) == 1:
        return start
    return f"{start} --components {','.join(names[i] for i in orbit.components)}"


def cascade(asked: Asked, said: Document, number: int, longest: int) -> Made:
    """What follows the first supercritical doubling of a life: each doubled branch with its events, certified."""
    orbit = orbit_of(asked.scene.at(lam=said["at"]), said["cycle"])
    branch, period = followed(asked, orbit), orbit.period
    event = next((e for e in branch.events if e.kind is BifurcationKind.FLIP and e.form and e.form.supercritical), None)
    flips = [] if event is None else [event.value]
    found: list[tuple[int, Located]] = []
    while event is not None and 2 * period <= longest:
        period *= 2
        try:
            (branch,) = switched(branch, event, asked.ends, Steps(most=DOUBLED))
        except (LostError, ValueError):
            break
        found += [
            (period, located(asked, e, period, f"cascade-{number}-{period}-{i}", branch))
            for i, e in enumerate(branch.events)
        ]
        event = next((e for e in branch.events if e.kind is BifurcationKind.FLIP), None)
        flips += [] if event is None else [event.value]
    if not flips:
        return [], [], {"events": []}
    rows: tuple[tuple[Cell, ...], ...] = tuple((str(n), *each.row) for n, each in found)
    words = command(asked, orbit, said["at"])
    caption = _doublings(orbit, period, flips)
    listing = Listing(caption, ("period", *COLUMNS), rows, f"{words} --switch 1") if rows else Words(caption)
    blocks: list[Block] = [listing, *(each.certificate for _, each in found if each.certificate)]
    data = {
        "events": [[each.value, each.label] for _, each in found],
        "located": [each.document(asked.parameter, n) for n, each in found],
        "doublings": flips,
    }
    return blocks, [Effort(f"cascade of cycle {number}", f"up to period {period}", 0.0)], data


def _doublings(orbit: PeriodicOrbit, longest: int, flips: list[float]) -> str:
    """The caption of a cascade, with the ratios of its distances and where it would accumulate."""
    said = f"Beyond the doubling of the cycle of period {orbit.period}: what happens up to period {longest}."
    gaps = np.diff(flips)
    if len(gaps) < 2:
        return f"{said} No cascade was seen: {len(flips)} successive doubling{'s' if len(flips) > 1 else ''}."
    ratios = ", ".join(f"{a / b:.4f}" for a, b in pairwise(gaps))
    limits = [b + (b - a) / (FEIGENBAUM - 1) for a, b in pairwise(flips)]
    return (
        f"{said} Successive distances of doublings have the ratios {ratios}; Feigenbaum's is 4.6692. If further ones "
        f"shrink by that number the cascade accumulates at {limits[-1]:.8g} ± {abs(limits[-1] - limits[-2]):.1g}: an "
        "estimate from the last two distances, not proved."
    )
