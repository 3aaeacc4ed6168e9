"""The report of a scene, made in steps: a useful page first, then refinements as long as there is time.

Each step writes one file to the folder of intermediate results, and the page is written again after it. So a stopped
run leaves a report, and the next run resumes from its files.
"""

import json
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from numeric import PinballMap
from numeric.lowering.files import write_whole
from numeric.sweeps.run import connected
from symbolic.tables.law import Law
from symbolic.tables.scene import as_scene
from verification.reports import crises as tangencies
from verification.reports import lives, planes
from verification.reports import scene as exactly
from verification.reports.asked import DRAWN, Asked, Parts
from verification.reports.blocks import Block, Effort, Paragraph, Picture, Section, costs

Clock = Callable[[], float]
Tick = Callable[[str], None]
Made = tuple[list[Block], list[Effort], dict[str, Any]]
TITLES = {
    "diagram": "Families of attractors",
    "events": "Events",
    "families": "Families, one by one",
    "census": "Attractors and their basins",
    "missing": "What was not found",
    "plane": "Parameter space and curves of events",
    "scene": "The scene",
    "derivation": "Derivative and closed thresholds",
    "slap": "The slap map",
    "portrait": "Phase portraits",
    "cost": "Error against run time",
}
FIRST = {  # expected seconds of steps that have not run yet
    "plane": 5.0,
    "census": 3.0,
    "derivation": 3.0,
    "life": 1.5,
    "curves": 5.0,
    "crises": 10.0,
    "tangency": 6.0,
    "work": 3.0,
    "chaos": 10.0,
}
GROWTH = 3.5  # factor on the seconds of a question from one level to the next
LEVELS = 4
LEVELLED = "portrait", "diagram", "families", "proofs", "plane", "regions", "census"  # asked again, more finely
SHARE = 0.5  # of the time that is left, for a step that could take all of it
SCHEMA = 1  # of the JSON
UNANSWERED: dict[str, Any] = {"unanswered": True}  # data of a step that ended in an error, which its section tells


@dataclass(frozen=True)
class Step:
    """A piece of work: the file that it writes, its section, and the seconds that it is expected to take."""

    name: str
    section: str
    expected: float
    work: Callable[[], Made] = field(repr=False)


@dataclass(frozen=True, repr=False)
class Report:
    """The sections of a report, its main numbers, and the steps for which there was no time.

    `pending` are the titles of sections about which nothing is known yet. A report is `unfinished` while it is being
    made; if the run is killed, the page says so.
    """

    asked: Asked
    sections: tuple[Section, ...]
    versions: dict[str, str]
    seconds: float
    left: tuple[str, ...]
    events: tuple[dict[str, Any], ...] = ()
    branches: tuple[dict[str, Any], ...] = ()
    attractors: tuple[dict[str, Any], ...] = ()
    exponents: tuple[dict[str, Any], ...] = ()
    accounted: dict[str, Any] | None = None
    pending: tuple[str, ...] = ()
    unfinished: bool = False

    def __repr__(self) -> str:
        found = f"{len(self.branches)} families, {len(self.events)} events, {len(self.attractors)} attractors"
        return f"Report({self.asked.title}: {found}, {self.seconds:.0f} s)"

    def document(self) -> dict[str, Any]:
        """The report as JSON: all that the page shows, except its pictures."""
        asked = self.asked
        return {
            "schema": SCHEMA,
            "scene": asked.scene.document,
            "asked": {
                "vary": asked.parameter,
                "from": asked.low,
                "to": asked.high,
                "at": list(asked.at),
                "period": asked.period,
                "digits": asked.digits,
                "seed": asked.seed,
                "second": None
                if asked.second is None
                else dict(zip(("vary", "from", "to"), asked.second, strict=True)),
            },
            "digest": asked.digest,
            "versions": self.versions,
            "seconds": round(self.seconds, 2),
            "left_for_more_time": list(self.left),
            "events": list(self.events),
            "branches": list(self.branches),
            "accounted": self.accounted,
            "attractors": list(self.attractors),
            "exponents": list(self.exponents),
            "sections": [section.document() for section in self.sections],
        }


def report(
    table: Any,
    out: str | Path = "report.html",
    *,
    minutes: float = 2.0,
    lam: tuple[Any, Any] | Any = ("0", "1"),
    vary: tuple[str, Any, Any] | None = None,
    at: tuple[str, ...] = ("1/10", "1/2", "9/10"),
    period: int = 3,
    digits: int = 20,
    seed: int = 1,
    latex: str | Path | None = None,
    scheduler: str | None = None,
    clock: Clock = time.monotonic,
    tick: Tick = lambda said: None,
    law: Law | str | None = None,
    **shape: Any,
) -> Report:
    """Makes a report on a scene as the contraction varies, as one page of HTML; its files are kept in `out` + `.parts`.

    `table` is a scene, a table, a map or the name of a table; `law` and the exact numbers of its shape are keywords.

    With `vary=("b", low, high)`, a parameter of the table or of the law varies too, and the page has the plane of both
    with the curves of events in it. Its other sections are at the scene's own `b`, or in the middle of the interval if
    that lies at an end. If `lam` is one contraction, only `b` varies.

    The page is useful after its first steps and refined until the `minutes` are over; another call resumes it.
    Diagrams, planes and basins are grids: the workers of the Dask cluster at `scheduler` compute them, or all cores.
    """
    second = None if vary is None else (vary[0], str(vary[1]), str(vary[2]))
    scene = as_scene(table, lam=at[len(at) // 2] if isinstance(lam, tuple) else None, law=law, **shape)
    if vary is not None:
        scene = scene.spanning(*vary)
    if isinstance(lam, tuple):
        parameter, low, high = "lam", *lam
    elif vary is None:
        raise ValueError(f"report: lam = {lam} is no interval; give two contractions, as in lam=(0, 1)")
    else:
        (parameter, low, high), second, at = vary, None, (str(lam),)
    here = scene.at(lam=at[len(at) // 2])
    PinballMap(here)  # which refuses what is not proved to be a table
    asked = Asked(here, parameter, str(low), str(high), tuple(at), period, digits, seed, second)
    if asked.second:
        planes.plane_of(asked)  # a law that is none somewhere in the plane is refused before any work
    if scheduler is not None:
        connected(scheduler).close()
    if not minutes > 0:
        raise ValueError(f"report: minutes = {minutes} is no time; give a positive number such as 2")
    page = Path(out)
    parts = Parts(page.with_suffix(".parts"), asked.digest, scheduler)
    parts.made(asked)
    return worked(asked, parts, page, clock() + 60 * minutes, clock, tick, latex)


def worked(
    asked: Asked,
    parts: Parts,
    page: Path,
    until: float,
    clock: Clock,
    tick: Tick,
    latex: str | Path | None = None,
) -> Report:
    """Runs each step that fits in the time, once; writes the report after each, and returns the last report."""
    left: list[str] = []

    def within(share: float) -> Tick:
        """A function that raises `TimeoutError` when this fraction of the remaining time is over."""
        end = until - (1 - share) * max(0.0, until - clock())

        def heard(_: str) -> None:
            if clock() > end:
                raise TimeoutError

        return heard

    for step in plan(asked, parts, within):
        if parts.read(step.name) is not None:
            continue
        begun = clock()
        if begun + step.expected > until:
            left.append(step.name)
            continue
        tick(step.name)
        parts.files.clear()
        try:
            blocks, efforts, data = step.work()
        except TimeoutError:  # it will have to begin again
            left.append(step.name)
            continue
        except (ValueError, ArithmeticError) as why:  # the page says so, and has the rest
            blocks, efforts, data = [Paragraph(f"No answer to this question: {why}.")], [], UNANSWERED
        spent = clock() - begun
        efforts = [replace(effort, seconds=round(spent / len(efforts), 2)) for effort in efforts]
        section = Section(step.section, TITLES[step.section], tuple(blocks), tuple(efforts))
        parts.write(step.name, {"seconds": round(spent, 3), "data": data, **section.document()})
        written(replace(composed(asked, parts, tuple(left)), unfinished=True), parts, page)
    done = composed(asked, parts, tuple(dict.fromkeys(left)))
    written(done, parts, page, latex)
    return done


def written(done: Report, parts: Parts, page: Path, latex: str | Path | None = None) -> None:
    """Writes the page, and the LaTeX article if `latex` is a path."""
    from verification.reports.page import latex as article
    from verification.reports.page import page as html

    write_whole(page, html(done, parts))
    if latex is not None:
        write_whole(latex, article(done, parts))


def plan(
    asked: Asked, parts: Parts, within: Callable[[float], Tick] = lambda share: lambda said: None
) -> Iterator[Step]:
    """The steps, the most useful first; later steps are planned from the results of earlier ones.

    `within(share)` gives a function that raises `TimeoutError` once this fraction of the remaining time is over. Long
    searches call that function from time to time.
    """
    from verification.reports import dynamics

    heard = within(1.0)

    yield Step("scene", "scene", 0.0, partial(_scene, asked, parts))
    yield Step("slap", "slap", 0.0, partial(dynamics.slap, asked, parts))
    yield Step("portrait-0", "portrait", 0.0, partial(dynamics.portrait, asked, parts, 0))
    yield Step("diagram-0", "diagram", 0.0, partial(dynamics.diagram, asked, parts, 0))
    yield from _families(asked, parts, 0, within)
    if asked.second:
        yield Step("plane-0", "plane", FIRST["plane"], partial(dynamics.plane, asked, parts, 0))
        yield Step("regions-0", "plane", FIRST["plane"], partial(dynamics.regions, asked, parts, 0))
    for i in range(len(asked.at)):
        yield Step(f"census-{i}-0", "census", FIRST["census"], partial(dynamics.census, asked, parts, i, 0))
    yield Step("derivation", "derivation", FIRST["derivation"], lambda: (exactly.derivation(asked), [], {}))
    yield from _families(asked, parts, 1, within)
    yield from _lives(asked, parts)
    if (seen := _best(parts, "families")).get("amid_chaos"):
        yield Step("chaos", "families", FIRST["chaos"], partial(lives.chaos, asked, seen))
    yield Step("work", "cost", FIRST["work"], partial(_work, asked, parts))
    if asked.second:
        yield from _curves(asked, parts, heard)
    if asked.parameter == "lam" and _answered(parts, "diagram-0"):
        yield Step("crises", "events", FIRST["crises"], partial(tangencies.crises, asked, parts, heard))
        yield from _tangencies(asked, parts)
    for level in range(1, LEVELS):
        finer: list[tuple[str, Callable[..., Made], tuple[int, ...]]] = [("diagram", dynamics.diagram, ())]
        finer += [("plane", dynamics.plane, ()), ("regions", dynamics.regions, ())] if asked.second else []
        finer += [("census", dynamics.census, (i,)) for i in range(len(asked.at))]
        finer += [("portrait", dynamics.portrait, ())] if level == 1 else []
        for kind, work, which in finer:
            name = "-".join([kind, *map(str, which)])
            expected = _expected(parts, name, level, GROWTH, FIRST.get(kind, 1.0))
            section = "plane" if kind == "regions" else kind
            yield Step(f"{name}-{level}", section, expected, partial(work, asked, parts, *which, level))
        if level > 1:
            yield from _families(asked, parts, level, within)


def _expected(parts: Parts, name: str, level: int, growth: float, first: float) -> float:
    """The expected seconds of a level, from those of the last level that was made; `first` if there is none."""
    before = ((level - i, parts.read(f"{name}-{i}")) for i in reversed(range(level)))
    return next((float(found["seconds"]) * growth**steps for steps, found in before if found), first)


def _answered(parts: Parts, name: str) -> bool:
    """True if the step of this name has been done without an error."""
    found = parts.read(name)
    return found is not None and found["data"] != UNANSWERED


def _scene(asked: Asked, parts: Parts) -> Made:
    """The section on the table: its picture, its formulas, and what is proved."""
    from verification.reports import pictures

    start = 0.3
    pictures.table(parts, "table", PinballMap(asked.scene), start)
    command = asked.command("orbit", f"--start {start},{start} --bounces 14 {DRAWN}", lam=str(asked.scene.lam))
    caption = "The table, and fourteen flights of one particle at the contraction of the scene."
    shown = Picture("table", caption, "The boundary of the table with an orbit in it", command)
    return [shown, *exactly.definition(asked), *exactly.facts(asked)], [], {}


def _work(asked: Asked, parts: Parts) -> Made:
    """The section on work-precision: error against run time for orbits of this scene, in every arithmetic."""
    from verification.measure.work.scenes import work_precision
    from verification.plots.sheet import styled
    from verification.reports import pictures

    found = work_precision(asked.scene, "orbit", seed=asked.seed)
    with styled():
        pictures.saved(parts, "work", found.plot())
    caption = (
        f"{found.question.title} in this scene, at lambda = {asked.scene.lam}: the error against the seconds of "
        "one core, in float64, in mpmath and in balls to 16, 30 and 100 digits. Errors are distances from "
        "a ball that is proved; full marks are best: nothing else is both quicker and more exact."
    )
    command = asked.command("work orbit", f"--seed {asked.seed}", DRAWN, lam=str(asked.scene.lam))
    return [Picture("work", caption, "Error against run time, a line for each arithmetic", command)], [], {}


def _families(asked: Asked, parts: Parts, level: int, within: Callable[[float], Tick]) -> Iterator[Step]:
    """The steps that find the families and prove their events; each level samples more parameter values."""

    def work(name: str, section: str, made: Callable[..., Made]) -> Step:
        expected = _expected(parts, name, level, 1.0, 0.0)  # at least: it goes on from the level before
        return Step(f"{name}-{level}", section, expected, lambda: made(asked, parts, level, within(SHARE)))

    yield work("families", "families", lives.families)
    if _answered(parts, f"families-{level}"):
        yield work("proofs", "events", lives.proofs)


def _best(parts: Parts, name: str) -> dict[str, Any]:
    """The answer to a question from the highest level computed so far; empty if there is none."""
    found = [parts.read(f"{name}-{level}") for level in range(LEVELS)]
    return next((one["data"] for one in reversed(found) if one and one["data"] != UNANSWERED), {})


def _lives(asked: Asked, parts: Parts) -> Iterator[Step]:
    """The steps that draw, one by one, the families that most starts reach."""
    said = _best(parts, "families").get("families", [])
    for i in lives.drawn_alone(said):
        yield Step(f"life-{i}", "families", FIRST["life"], partial(lives.life, asked, parts, said[i], i))


def _curves(asked: Asked, parts: Parts, heard: Tick) -> Iterator[Step]:
    """The steps that follow events of the largest families as curves in two parameters, without repetition."""
    said, known = _best(parts, "families").get("families", []), list[dict[str, Any]]()
    for i in lives.drawn_alone(said):
        name = f"curves-{i}"
        yield Step(name, "plane", FIRST["curves"], partial(planes.curves, asked, said[i], i, tuple(known), heard))
        made = parts.read(name)
        known += made["data"].get("curves", []) if made else []


def _tangencies(asked: Asked, parts: Parts) -> Iterator[Step]:
    """The steps that prove, one by one, the tangencies that were found."""
    found = parts.read("crises")
    for i, said in enumerate(found["data"].get("touches", []) if found else []):
        yield Step(f"tangency-{i}", "events", FIRST["tangency"], partial(tangencies.proved, asked, said, i))


def composed(asked: Asked, parts: Parts, left: tuple[str, ...]) -> Report:
    """The report from the results that exist, with the finest answer to each question."""
    from numeric.sweeps.sweep import versions
    from verification.reports import dynamics

    made = {name: found for name in _names(parts) if (found := parts.read(name)) is not None}
    best = _finest(made)
    touching = tangencies.told(asked, best) if "crises" in best else tangencies.NOTHING
    seen, proved = _best(parts, "families"), _best(parts, "proofs").get("proofs", {})
    blocks: dict[str, list[Block]] = {name: [] for name in TITLES}
    located, attractors, exponents = (
        _once([row for found in best.values() for row in found["data"].get(name, [])] + more)
        for name, more in (
            ("located", [*(lives.events_of(seen, proved) if seen else []), *touching.events]),
            ("attractors", []),
            ("exponents", []),
        )
    )
    curves = [curve for found in best.values() for curve in found["data"].get("curves", [])]
    marks = [(float(value), words, 1.0) for value, words in touching.lines]
    for event in seen.get("events", []):
        share = seen["families"][event["branch"]]["largest"]
        marks.append((float(event["value"]), f"{lives.kind_of(event)} {event['period']}", share[1] / share[2]))
    if seen:
        blocks["events"] += lives.event_blocks(seen, proved, touching.blocks)
        blocks["families"] += lives.family_blocks(asked, seen)
        blocks["missing"] += lives.missing_blocks(asked, seen, attractors)
    for name, found in best.items():
        if found["data"] == UNANSWERED:
            blocks[found["name"]] += Section.read(found).blocks
        elif found["name"] == "diagram":
            blocks["diagram"] += dynamics.diagram_blocks(asked, parts, found["data"], marks, seen or None)
        elif name == "plane":
            blocks["plane"] += dynamics.plane_blocks(asked, parts, found["data"], curves, _best(parts, "regions"))
        elif found["name"] == "events" and seen:
            blocks["events"] += lives.named_certificates(seen, proved, Section.read(found).blocks)
        elif not name.startswith("life") or _still(found, name, seen):
            blocks[found["name"]] += Section.read(found).blocks
    if not seen:
        blocks["events"] += touching.blocks
    if asked.second and any(name.startswith("curves") for name in best):
        blocks["plane"] += planes.curve_blocks(asked, curves)
    efforts = tuple(effort for found in made.values() for effort in Section.read(found).efforts)
    sections = [Section(name, TITLES[name], tuple(blocks[name])) for name in TITLES if blocks[name]]
    if efforts:
        sections = [each for each in sections if each.name != "cost"]
        sections.append(Section("cost", TITLES["cost"], (*blocks["cost"], costs(efforts)), efforts))
    seconds = sum(float(found["seconds"]) for found in made.values())
    told = {name for name in TITLES if blocks[name]} | {"cost", *(() if asked.second else ("plane",))}
    keys = "period", "symmetry", "copies", "low", "high", "attracts"
    branches = tuple({key: one[key] for key in keys} for one in seen.get("families", []))
    pending = tuple(title for name, title in TITLES.items() if name not in told)
    return Report(
        asked,
        tuple(sections),
        versions(),
        seconds,
        left,
        located,
        branches,
        attractors,
        exponents,
        seen.get("check"),
        pending,
    )


def _still(found: dict[str, Any], name: str, seen: dict[str, Any]) -> bool:
    """True if the family of a picture is still in the table, with the same first value of the parameter."""
    number = int(name.split("-")[1])
    families = seen.get("families", [])
    return number < len(families) and families[number]["low"] == found["data"].get("mark")


def _once(rows: Iterable[dict[str, Any]]) -> tuple[dict[str, Any], ...]:
    """The rows in order, without repetition: events on symmetric images of a cycle are listed once."""
    return tuple({json.dumps(row): row for row in rows}.values())


def _names(parts: Parts) -> list[str]:
    """The names of the steps whose files exist, in the order of the page."""
    order = ["diagram", "families", "proofs", "chaos", "life", "census", "plane", "scene", "derivation", "slap"]
    order += ["portrait", "crises", "tangency", "curves", "work"]
    found = [path.stem for path in parts.folder.glob("*.json")]

    def place(name: str) -> tuple[int, list[int]]:
        kind, *rest = name.split("-")
        return order.index(kind), [int(word) for word in rest if word.isdigit()]

    return sorted((name for name in found if name.split("-")[0] in order), key=place)


def _finest(made: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """For each question that was answered at several levels, the answer at the highest level."""
    best: dict[str, dict[str, Any]] = {}
    for name, found in made.items():
        kind = name.split("-")[0]
        question = name.rpartition("-")[0] if kind in LEVELLED else name
        if question not in best or found["data"] != UNANSWERED:
            best[question] = found
    return best
