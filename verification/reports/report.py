"""The report of a scene, made in steps: a useful page first, refined as long as there is time, kept on the way.

Each step leaves one file among the parts. The page is written anew after each, so that a report that is stopped is a
report, and one that is asked again goes on.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.reports import scene as exactly
from verification.reports.asked import Asked, Parts
from verification.reports.blocks import Block, Effort, Known, Listing, Number, Picture, Section

Clock = Callable[[], float]
Tick = Callable[[str], None]
Made = tuple[list[Block], list[Effort], dict[str, Any]]
TITLES = {
    "scene": "The scene",
    "derivation": "Derivative and closed thresholds",
    "slap": "The slap map",
    "portrait": "Phase portraits",
    "diagram": "Bifurcation diagram and exponents",
    "census": "Attractors and their basins",
    "cycles": "Cycles from birth to death",
    "cost": "Error against run time",
}
FIRST = {"census": 3.0, "derivation": 3.0, "search": 4.0, "life": 1.5, "cascade": 4.0}  # seconds, not measured yet
GROWTH = 3.5  # of the seconds of a question from one level to the next
LEVELS = 4
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
    """The sections of a report, the files that were written, and what more time would do."""

    asked: Asked
    sections: tuple[Section, ...]
    versions: dict[str, str]
    seconds: float
    left: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """The report as JSON has it: what the page shows, without its pictures."""
        asked = self.asked
        return {
            "scene": asked.scene.document,
            "asked": {
                "vary": asked.parameter,
                "from": asked.low,
                "to": asked.high,
                "at": list(asked.at),
                "period": asked.period,
                "digits": asked.digits,
                "seed": asked.seed,
            },
            "digest": asked.digest,
            "versions": self.versions,
            "seconds": round(self.seconds, 2),
            "left_for_more_time": list(self.left),
            "sections": [section.document() for section in self.sections],
        }


def report(
    scene: Scene,
    out: str | Path,
    *,
    minutes: float = 2.0,
    lam: tuple[Any, Any] = ("0", "1"),
    vary: tuple[str, Any, Any] | None = None,
    at: tuple[str, ...] = ("1/10", "1/2", "9/10"),
    period: int = 3,
    digits: int = 20,
    seed: int = 1,
    latex: str | Path | None = None,
    clock: Clock = time.monotonic,
    tick: Tick = lambda said: None,
) -> Report:
    """What becomes of a scene as the contraction varies, as one page of HTML; parts are kept in `out` with `.parts`.

    With `vary=("b", low, high)` it is a parameter of the table or of the law that varies, at the one contraction in
    `at`; there cycles are searched for, at the middle of the interval.

    The page is useful after its first steps and refined until the `minutes` are over. Asked again, it goes on.
    """
    parameter, low, high = ("lam", *lam) if vary is None else vary
    if parameter != "lam":
        scene = _midway(scene, parameter, low, high)
    here = scene.at(lam=at[len(at) // 2])
    asked = Asked(here, parameter, str(low), str(high), tuple(at), period, digits, seed)
    if not minutes > 0:
        raise ValueError(f"report: minutes = {minutes} is no time; give a positive number such as 2")
    page = Path(out)
    parts = Parts(page.with_suffix(".parts"), asked.digest)
    parts.made(asked)
    return worked(asked, parts, page, clock() + 60 * minutes, clock, tick, latex)


def _midway(scene: Scene, parameter: str, low: Any, high: Any) -> Scene:
    """The scene at the middle of an interval of one of its parameters, proved to be a table over all of it."""
    ends = [exact(parameter, end) for end in (low, high)]
    if parameter not in (*scene.shape, *dict(scene.law.numbers)):
        accepted = ", ".join(["lam", *scene.shape, *dict(scene.law.numbers)])
        raise ValueError(f"report: {parameter} is no parameter that varies in {scene}; accepted: {accepted}")
    if not ends[0] < ends[1]:
        raise ValueError(f"report: {parameter} from {low} to {high} is no interval; the first must be the smaller")
    middle = (ends[0] + ends[1]) / 2
    ranged = "table" not in scene.document or parameter not in scene.shape  # a table of the paper has its own
    value: dict[str, Any] = {parameter: f"{middle}:{ends[0]}..{ends[1]}" if ranged else middle}
    return scene.at(**value)


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
    done = composed(asked, parts, ())

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
        done = composed(asked, parts, tuple(left))
        written(done, parts, page)
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
    from verification.reports import dynamics, lives

    def seconds(name: str, kind: str) -> float:
        """What a step of this kind is expected to take, from the one of the level before."""
        found = parts.read(name)
        return FIRST.get(kind, 1.0) if found is None else GROWTH * float(found["seconds"])

    yield Step("scene", "scene", 0.0, partial(_scene, asked, parts))
    yield Step("slap", "slap", 0.0, partial(dynamics.slap, asked, parts))
    yield Step("portrait-0", "portrait", 0.0, partial(dynamics.portrait, asked, parts, 0))
    yield Step("diagram-0", "diagram", 0.0, partial(dynamics.diagram, asked, parts, 0))
    for i in range(len(asked.at)):
        yield Step(f"census-{i}-0", "census", FIRST["census"], partial(dynamics.census, asked, parts, i, 0))
    yield Step("derivation", "derivation", FIRST["derivation"], lambda: (exactly.derivation(asked), [], {}))
    for i, text in enumerate(asked.at):
        yield Step(f"search-{i}", "cycles", FIRST["search"], partial(lives.search, asked, text, heard))
    yield from _lives(asked, parts)
    yield from _cascades(asked, parts, 0)
    for level in range(1, LEVELS):
        finer: list[tuple[str, Callable[..., Made], tuple[int, ...]]] = [("diagram", dynamics.diagram, ())]
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
    command = asked.command("orbit", f"--start {start},{start} --bounces 14", lam=str(asked.scene.lam))
    caption = "The table, and fourteen flights of one particle at the contraction of the scene."
    shown = Picture("table", caption, "The boundary of the table with an orbit in it", command)
    return [shown, *exactly.definition(asked), *exactly.facts(asked)], [], {}


def _lives(asked: Asked, parts: Parts) -> Iterator[Step]:
    """A step for each cycle that was found and lies on no branch known by then; those that attract come first."""
    from verification.reports import lives

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


def _cascades(asked: Asked, parts: Parts, level: int) -> Iterator[Step]:
    """A step for each life with a flip: its doublings, two more at each level."""
    from verification.reports import lives

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
    from verification.reports import dynamics, lives

    made = {name: found for name in _names(parts) if (found := parts.read(name)) is not None}
    best = _finest(made)
    pairs = [pair for found in best.values() for pair in found["data"].get("events", [])]
    events = sorted({(round(value, 9), label) for value, label in pairs})
    searches = [found["data"] for name, found in best.items() if name.startswith("search")]
    blocks: dict[str, list[Block]] = {name: [] for name in TITLES}
    blocks["cycles"] += lives.searched_blocks(asked, searches) if searches else []
    for found in best.values():
        if found["name"] == "diagram":
            blocks["diagram"] += dynamics.diagram_blocks(asked, parts, found["data"], events)
        else:
            blocks[found["name"]] += Section.read(found).blocks
    efforts = tuple(effort for found in made.values() for effort in Section.read(found).efforts)
    sections = [Section(name, TITLES[name], tuple(blocks[name])) for name in TITLES if blocks[name]]
    if efforts:
        sections.append(Section("cost", TITLES["cost"], (_costs(efforts),), efforts))
    seconds = sum(float(found["seconds"]) for found in made.values())
    return Report(asked, tuple(sections), versions(), seconds, left)


def _names(parts: Parts) -> list[str]:
    """The steps whose files are there, in the order in which they are told."""
    order = ["scene", "derivation", "slap", "portrait", "diagram", "census", "search", "life", "cascade"]
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
        question = name.rpartition("-")[0] if kind in ("portrait", "diagram", "census", "cascade") else name
        best[question] = found
    return best


def _costs(efforts: tuple[Effort, ...]) -> Block:
    rows = tuple(
        (effort.question, effort.size, Number(f"{effort.seconds:.2f}", known=Known.SAMPLED), effort.error or "-")
        for effort in efforts
    )
    caption = (
        "What each question cost on this machine, and the error that its answer is left with; later rows of a question "
        "are its refinements."
    )
    return Listing(caption, ("question", "size", "seconds", "error left"), rows)
