"""The report of a scene, made in steps: a useful page first, refined as long as there is time, kept on the way.

Each step leaves one file among the parts. The page is written anew after each, so that a report that is stopped is a
report, and one that is asked again goes on.
"""

import json
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from numeric.sweeps.run import connected
from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.reports import crises as tangencies
from verification.reports import lives
from verification.reports import scene as exactly
from verification.reports.asked import DRAWN, Asked, Parts
from verification.reports.blocks import Block, Effort, Picture, Section, costs

Clock = Callable[[], float]
Tick = Callable[[str], None]
Made = tuple[list[Block], list[Effort], dict[str, Any]]
TITLES = {
    "scene": "The scene",
    "derivation": "Derivative and closed thresholds",
    "slap": "The slap map",
    "portrait": "Phase portraits",
    "diagram": "Bifurcation diagram and exponents",
    "plane": "Parameter space and curves of events",
    "census": "Attractors and their basins",
    "cycles": "Cycles from birth to death",
    "cost": "Error against run time",
}
FIRST = {  # seconds, not measured yet
    "plane": 5.0,
    "census": 3.0,
    "derivation": 3.0,
    "search": 4.0,
    "life": 1.5,
    "curves": 5.0,
    "cascade": 4.0,
    "crises": 10.0,
    "tangency": 6.0,
}
GROWTH = 3.5  # of the seconds of a question from one level to the next
LEVELS = 4
LEVELLED = "portrait", "diagram", "plane", "census", "cascade"  # questions that are asked again, more finely
SCHEMA = 1  # of the JSON
DEEPEST = 2  # further doublings of a cascade at each level


@dataclass(frozen=True)
class Step:
    """A piece of work: the file that it leaves, its section, and the seconds that it is expected to take."""

    name: str
    section: str
    expected: float
    work: Callable[[], Made] = field(repr=False)


@dataclass(frozen=True)
class Report:
    """The sections of a report, its findings in a few numbers each, and what more time would do.

    `pending` are the titles of sections of which nothing is known yet. A report is `unfinished` while it is worked on:
    that is what a page says which was left behind by a run that was killed.
    """

    asked: Asked
    sections: tuple[Section, ...]
    versions: dict[str, str]
    seconds: float
    left: tuple[str, ...]
    events: tuple[dict[str, Any], ...] = ()
    attractors: tuple[dict[str, Any], ...] = ()
    exponents: tuple[dict[str, Any], ...] = ()
    pending: tuple[str, ...] = ()
    unfinished: bool = False

    def document(self) -> dict[str, Any]:
        """The report as JSON has it: what the page shows, without its pictures."""
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
            "attractors": list(self.attractors),
            "exponents": list(self.exponents),
            "sections": [section.document() for section in self.sections],
        }


def report(
    scene: Scene,
    out: str | Path,
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
) -> Report:
    """What becomes of a scene as the contraction varies, as one page of HTML; parts are kept in `out` with `.parts`.

    With `vary=("b", low, high)` a parameter of the table or of the law varies too, and the page has the plane of both
    with the curves of events in it; its other sections are at the scene's own `b`, or in the middle where that lies at
    an end. With one contraction for `lam` it is that parameter alone which varies.

    The page is useful after its first steps and refined until the `minutes` are over. Asked again, it goes on.
    Diagrams, planes and basins are grids: the workers of the Dask cluster at `scheduler` do them, or else all cores.
    """
    second = None if vary is None else (vary[0], str(vary[1]), str(vary[2]))
    if vary is not None:
        scene = _placed(scene, *vary)
    if isinstance(lam, tuple):
        parameter, low, high = "lam", *lam
    elif vary is None:
        raise ValueError(f"report: lam = {lam} is no interval; give two contractions, as in lam=(0, 1)")
    else:
        (parameter, low, high), second, at = vary, None, (str(lam),)
    here = scene.at(lam=at[len(at) // 2])
    asked = Asked(here, parameter, str(low), str(high), tuple(at), period, digits, seed, second)
    if asked.second:
        lives.plane_of(asked)  # a law that is none somewhere in the plane is refused before any work
    if scheduler is not None:
        connected(scheduler).close()
    if not minutes > 0:
        raise ValueError(f"report: minutes = {minutes} is no time; give a positive number such as 2")
    page = Path(out)
    parts = Parts(page.with_suffix(".parts"), asked.digest, scheduler)
    parts.made(asked)
    return worked(asked, parts, page, clock() + 60 * minutes, clock, tick, latex)


def _placed(scene: Scene, parameter: str, low: Any, high: Any) -> Scene:
    """The scene with an interval for one of its parameters, over which it is proved to be a table.

    Its own number for the parameter is kept inside of the interval; at an end, or beyond, the middle takes its place.
    """
    ends = [exact(parameter, end) for end in (low, high)]
    if parameter not in (*scene.shape, *dict(scene.law.numbers)):
        accepted = ", ".join(["lam", *scene.shape, *dict(scene.law.numbers)])
        raise ValueError(f"report: {parameter} is no parameter that varies in {scene}; accepted: {accepted}")
    if not ends[0] < ends[1]:
        raise ValueError(f"report: {parameter} from {low} to {high} is no interval; the first must be the smaller")
    own = {**scene.shape, **{name: exact(name, text) for name, text in scene.law.numbers}}[parameter]
    value = own if ends[0] < own < ends[1] else (ends[0] + ends[1]) / 2
    ranged = "table" not in scene.document or parameter not in scene.shape  # a table of the paper has its own
    number: dict[str, Any] = {parameter: f"{value}:{ends[0]}..{ends[1]}" if ranged else value}
    return scene.at(**number)


def worked(
    asked: Asked,
    parts: Parts,
    page: Path,
    until: float,
    clock: Clock,
    tick: Tick,
    latex: str | Path | None = None,
) -> Report:
    """Does the steps that fit until a time, each of them once, and writes the report after each."""
    left: list[str] = []

    def heard(_: str) -> None:
        if clock() > until:
            raise TimeoutError

    for step in plan(asked, parts, heard):
        if parts.read(step.name) is not None:
            continue
        begun = clock()
        if begun + step.expected > until:
            left.append(step.name)
            continue
        tick(step.name)
        try:
            blocks, efforts, data = step.work()
        except TimeoutError:  # it will have to begin again
            left.append(step.name)
            continue
        spent = clock() - begun
        efforts = [replace(effort, seconds=round(spent / len(efforts), 2)) for effort in efforts]
        section = Section(step.section, TITLES[step.section], tuple(blocks), tuple(efforts))
        parts.write(step.name, {"seconds": round(spent, 3), "data": data, **section.document()})
        written(replace(composed(asked, parts, tuple(left)), unfinished=True), parts, page)
    done = composed(asked, parts, tuple(dict.fromkeys(left)))
    written(done, parts, page, latex)
    return done


def written(done: Report, parts: Parts, page: Path, latex: str | Path | None = None) -> None:
    """Writes the page, and the article where it is asked for."""
    from verification.reports.page import latex as article
    from verification.reports.page import page as html

    temporary = page.with_name(f".{page.name}")
    temporary.write_text(html(done, parts), encoding="utf-8")
    temporary.replace(page)
    if latex is not None:
        Path(latex).write_text(article(done, parts), encoding="utf-8")


def plan(asked: Asked, parts: Parts, heard: Tick = lambda said: None) -> Iterator[Step]:
    """The steps in the order of their use; later ones are planned from what earlier ones found.

    `heard` is called from within a long search, and may end it with a `TimeoutError`.
    """
    from verification.reports import dynamics

    def seconds(name: str, kind: str) -> float:
        """What a step of this kind is expected to take, from the one of the level before."""
        found = parts.read(name)
        return FIRST.get(kind, 1.0) if found is None else GROWTH * float(found["seconds"])

    yield Step("scene", "scene", 0.0, partial(_scene, asked, parts))
    yield Step("slap", "slap", 0.0, partial(dynamics.slap, asked, parts))
    yield Step("portrait-0", "portrait", 0.0, partial(dynamics.portrait, asked, parts, 0))
    yield Step("diagram-0", "diagram", 0.0, partial(dynamics.diagram, asked, parts, 0))
    if asked.second:
        yield Step("plane-0", "plane", FIRST["plane"], partial(dynamics.plane, asked, parts, 0))
    for i in range(len(asked.at)):
        yield Step(f"census-{i}-0", "census", FIRST["census"], partial(dynamics.census, asked, parts, i, 0))
    yield Step("derivation", "derivation", FIRST["derivation"], lambda: (exactly.derivation(asked), [], {}))
    for i, text in enumerate(asked.at):
        yield Step(f"search-{i}", "cycles", FIRST["search"], partial(lives.search, asked, text, heard))
    yield from _lives(asked, parts)
    if asked.second:
        yield from _curves(asked, parts, heard)
    if asked.parameter == "lam":
        yield Step("crises", "cycles", FIRST["crises"], partial(tangencies.crises, asked, parts, heard))
        yield from _tangencies(asked, parts)
    yield from _cascades(asked, parts, 0)
    for level in range(1, LEVELS):
        finer: list[tuple[str, Callable[..., Made], tuple[int, ...]]] = [("diagram", dynamics.diagram, ())]
        finer += [("plane", dynamics.plane, ())] if asked.second else []
        finer += [("census", dynamics.census, (i,)) for i in range(len(asked.at))]
        finer += [("portrait", dynamics.portrait, ())] if level == 1 else []
        for kind, work, which in finer:
            name = "-".join([kind, *map(str, which)])
            expected = seconds(f"{name}-{level - 1}", kind)
            yield Step(f"{name}-{level}", kind, expected, partial(work, asked, parts, *which, level))
        yield from _cascades(asked, parts, level)


def _scene(asked: Asked, parts: Parts) -> Made:
    """The first section."""
    from numeric import PinballMap
    from verification.reports import pictures

    start = 0.3
    pictures.table(parts, "table", PinballMap(asked.scene), start)
    command = asked.command("orbit", f"--start {start},{start} --bounces 14 {DRAWN}", lam=str(asked.scene.lam))
    caption = "The table, and fourteen flights of one particle at the contraction of the scene."
    shown = Picture("table", caption, "The boundary of the table with an orbit in it", command)
    return [shown, *exactly.definition(asked), *exactly.facts(asked)], [], {}


def _lives(asked: Asked, parts: Parts) -> Iterator[Step]:
    """A step for each cycle that was found and lies on no branch known by then; those that attract come first."""
    number, known = 0, list[dict[str, Any]]()
    for i, text in enumerate(asked.at):
        kept = [parts.read(f"search-{i}"), parts.read(f"census-{i}-0")]
        for said in [cycle for found in kept if found for cycle in found["data"]["cycles"]]:
            if lives.known(said, text, known):
                continue
            name = f"life-{number}"
            yield Step(name, "cycles", FIRST["life"], partial(lives.life, asked, parts, text, said, number))
            made = parts.read(name)
            known.append(made["data"] if made else {"passes": {text: [said["mark"]]}})
            number += 1


def _curves(asked: Asked, parts: Parts, heard: Tick) -> Iterator[Step]:
    """A step for each life that was followed: its events, as curves in both parameters that are not there yet."""
    number, known = 0, list[dict[str, Any]]()
    while (found := parts.read(f"life-{number}")) is not None:
        name = f"curves-{number}"
        if "cycle" in found["data"]:
            work = partial(lives.curves, asked, found["data"], number, tuple(known), heard)
            yield Step(name, "plane", FIRST["curves"], work)
        made = parts.read(name)
        known += made["data"]["curves"] if made else []
        number += 1


def _tangencies(asked: Asked, parts: Parts) -> Iterator[Step]:
    """A step for each tangency that was found: its proof."""
    found = parts.read("crises")
    for i, said in enumerate(found["data"].get("touches", []) if found else []):
        yield Step(f"tangency-{i}", "cycles", FIRST["tangency"], partial(tangencies.proved, asked, said, i))


def _cascades(asked: Asked, parts: Parts, level: int) -> Iterator[Step]:
    """A step for each life with a flip: its doublings, two more at each level."""
    number = 0
    while (found := parts.read(f"life-{number}")) is not None:
        said = found["data"]
        if said.get("flips"):
            longest = len(said["cycle"]["theta"]) * 2 ** (DEEPEST * (level + 1))
            name = f"cascade-{number}-{level}"
            before = parts.read(f"cascade-{number}-{level - 1}")
            expected = GROWTH * float(before["seconds"]) if before else FIRST["cascade"]
            if level == 0 or (before and before["data"]["events"]):
                yield Step(name, "cycles", expected, partial(lives.cascade, asked, said, number, longest))
        number += 1


def composed(asked: Asked, parts: Parts, left: tuple[str, ...]) -> Report:
    """The report from the parts that are there, the finest of each question."""
    from numeric.sweeps.sweep import versions
    from verification.reports import dynamics

    made = {name: found for name in _names(parts) if (found := parts.read(name)) is not None}
    best = _finest(made)
    touching = tangencies.told(asked, best) if "crises" in best else tangencies.NOTHING
    pairs = [pair for found in best.values() for pair in found["data"].get("events", [])] + touching.lines
    events = sorted({(round(value, 9), label) for value, label in pairs})
    searches = [found["data"] for name, found in best.items() if name.startswith("search")]
    blocks: dict[str, list[Block]] = {name: [] for name in TITLES}
    blocks["cycles"] += lives.searched_blocks(asked, searches) if searches else []
    curves = [curve for found in best.values() for curve in found["data"].get("curves", [])]
    for found in best.values():
        if found["name"] == "diagram":
            blocks["diagram"] += dynamics.diagram_blocks(asked, parts, found["data"], events)
        elif found["name"] == "plane" and "level" in found["data"]:
            blocks["plane"] += dynamics.plane_blocks(asked, parts, found["data"], curves)
        else:
            blocks[found["name"]] += Section.read(found).blocks
    blocks["cycles"] += touching.blocks
    if asked.second and any(name.startswith("curves") for name in best):
        blocks["plane"] += lives.curve_blocks(asked, curves)
    efforts = tuple(effort for found in made.values() for effort in Section.read(found).efforts)
    sections = [Section(name, TITLES[name], tuple(blocks[name])) for name in TITLES if blocks[name]]
    if efforts:
        sections.append(Section("cost", TITLES["cost"], (costs(efforts),), efforts))
    seconds = sum(float(found["seconds"]) for found in made.values())
    located, attractors, exponents = (
        _once([row for found in best.values() for row in found["data"].get(name, [])] + more)
        for name, more in (("located", touching.events), ("attractors", []), ("exponents", []))
    )
    told = {found["name"] for found in best.values()} | {"cost", *(() if asked.second else ("plane",))}
    pending = tuple(title for name, title in TITLES.items() if name not in told)
    return Report(asked, tuple(sections), versions(), seconds, left, located, attractors, exponents, pending)


def _once(rows: Iterable[dict[str, Any]]) -> tuple[dict[str, Any], ...]:
    """Each row once, in order: what images of one cycle do under the symmetries is one event."""
    return tuple({json.dumps(row): row for row in rows}.values())


def _names(parts: Parts) -> list[str]:
    """The steps whose files are there, in the order in which they are told."""
    order = ["scene", "derivation", "slap", "portrait", "diagram", "plane", "census", "search", "life", "cascade"]
    order += ["crises", "tangency", "curves"]
    found = [path.stem for path in parts.folder.glob("*.json")]

    def place(name: str) -> tuple[int, list[int]]:
        kind, *rest = name.split("-")
        return order.index(kind), [int(word) for word in rest if word.isdigit()]

    return sorted((name for name in found if name.split("-")[0] in order), key=place)


def _finest(made: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Of each question that was answered at several levels, the last answer."""
    best: dict[str, dict[str, Any]] = {}
    for name, found in made.items():
        kind = name.split("-")[0]
        question = name.rpartition("-")[0] if kind in LEVELLED else name
        best[question] = found
    return best
