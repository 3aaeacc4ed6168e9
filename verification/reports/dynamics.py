"""Sections on sampled orbits: slap map, phase portraits, bifurcation diagram with exponents, attractors.

`level` counts the refinements of a section, from 0.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter
from sympy import S

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind, find
from numeric.dynamics.recognition import wilson
from numeric.sweeps.endings import CHAOTIC, CYCLE, NEUTRAL, Endings, endings
from numeric.sweeps.fields import basins, bifurcation
from numeric.sweeps.run import run
from numeric.sweeps.space import parameter_space
from numeric.sweeps.sweep import at_value, map_of, text_of
from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import decimal, working
from verification.named.attractors import Member, certificate, exponents, joined
from verification.plots import grids, results
from verification.plots.sheet import styled
from verification.reports import pictures
from verification.reports.asked import DRAWN, Asked, Parts
from verification.reports.blocks import Block, Effort, Known, Listing, Paragraph, Picture, ShownNumber, sampled, solved

Found = tuple[list[Block], list[Effort], dict[str, Any]]
POINTS = 1200  # on the graph of the slap map
COLUMNS, ROWS = 240, 160  # cells of a phase portrait
SHAPES = 40  # values of another parameter than the contraction: each is a table of its own
CELLS = 240  # of arc length in a bifurcation diagram
FEW = 0.02  # share of cells met below which a portrait is drawn with larger points
CLOSE = 3, 0.35  # so many events in such a part of the interval get a picture of their own
APART = 3e-3  # in parts of the table's size: marks of different cycles differ by more
FLAT = 1e-4  # an exponent this near 0 may be 0
EXPONENT, SHOWN, BITS = 5, 8, 128  # digits of a cycle's exponents, in float64 and in balls, and the bits of these
LISTED = 11  # contractions of a diagram whose exponents are listed


def slap(asked: Asked, parts: Parts) -> Found:
    """The content of the section on the slap map: its graph, the limit in which particles leave along the normal."""
    if not asked.scene.law.uniform:
        return [Paragraph("The slap map is the limit of the law phi = -lam*eta; this scene has another law.")], [], {}
    map = PinballMap(asked.scene, lam=0)
    ends = np.array(map.states.ends)
    each = POINTS // len(ends)
    component = np.repeat(np.arange(len(ends)), each)
    share = (np.tile(np.arange(each), len(ends)) + 0.5) / each
    theta = ends[component, 0] + (ends[component, 1] - ends[component, 0]) * share
    found = map.slap(theta, 1, component)
    with styled():
        pictures.saved(parts, "slap", results.slap(map, component, theta, found))
    slope = found.slope[found.code[1] == 0]
    steep = float(np.mean(np.abs(slope) > 1)) if slope.size else float("nan")
    caption = (
        "The slap map, the limit of contraction 0, and its derivative, both over arc length. In the grey band the map "
        f"contracts; it expands at {steep:.0%} of {slope.size} points of an even grid in the parameter."
    )
    alt = "Graphs of the slap map and of its derivative"
    return [Picture("slap", caption, alt, asked.command("slap", DRAWN))], [], {}


def wrapped(s: Any, half: float) -> Any:
    """Arc length modulo the perimeter, from `-half` to `half`."""
    return np.remainder(np.asarray(s) + half, 2 * half) - half


def portrait(asked: Asked, parts: Parts, level: int) -> Found:
    """The content of the section on phase portraits: the density of random particles after a transient."""
    from numeric.pinball.sampling import interior_starts

    orbits, bounces = 100 << level, 400 << level
    clouds, half = [], 1.0
    for text in asked.at:
        map = PinballMap(asked.scene.at(lam=text))
        half = map.arclength.perimeter / 2
        starts = interior_starts(map, orbits, asked.seed)
        end = map.exponents(starts.theta, starts.phi, 1, 1000, starts.component)
        alive = end.code == 0
        counts = np.zeros((ROWS, COLUMNS))
        if not np.any(alive):
            clouds.append((text, counts))
            continue
        orbit = map.orbit(end.theta[alive], end.phi[alive], bounces, end.component[alive])
        s = wrapped(map.arclength.s(orbit.theta, orbit.component), half)
        good = orbit.code == 0
        counts, _, _ = np.histogram2d(np.sin(orbit.phi[good]), s[good], (ROWS, COLUMNS), ((-1, 1), (-half, half)))
        few = np.count_nonzero(counts) < FEW * counts.size  # cycles, whose points would be too small to be seen
        clouds.append((text, maximum_filter(counts, 3) if few else counts))
    pictures.portraits(parts, f"portrait-{level}", clouds, half)
    caption = (
        f"Phase portraits: {bounces} bounces of each of {orbits} random particles after 1000 that are not drawn, the "
        f"darker the more often a cell is met (logarithm of the count). Sampled, seed {asked.seed}."
    )
    if empty := [text for text, counts in clouds if not np.any(counts)]:
        caption += f" At lambda = {', '.join(empty)} every particle stops before: at a corner, a join or a cusp."
    alt = "Densities of bounces in phase space at " + ", ".join(f"lambda = {text}" for text in asked.at)
    command = asked.command("attractor", f"--orbits {orbits} --seed {asked.seed}", DRAWN, lam=asked.at[0])
    effort = Effort("phase portraits", f"{orbits} particles, {bounces} bounces", 0.0)
    return [Picture(f"portrait-{level}", caption, alt, command)], [effort], {}


def diagram(asked: Asked, parts: Parts, level: int) -> Found:
    """Computes the arrays for the bifurcation diagram: attractors by parameter, and exponents of the same orbits."""
    low, high = asked.ends
    columns, orbits, points = (150 if asked.parameter == "lam" else SHAPES) * 2**level, 12 + 6 * level, 120
    values = np.linspace(low, high, columns)
    transient, bounces = 1000 * 2**level, 512 * 2**level
    text, lam = text_of(asked.scene), float(asked.scene.lam)
    sweep = bifurcation(text, values, orbits, points, bounces, transient, asked.seed, asked.parameter, lam)
    found = run(sweep, scheduler=parts.scheduler)
    half = PinballMap(asked.scene).arclength.perimeter / 2
    counts = density(found.s.values, half)
    apart = found.nu_plus.values < -2 * found.nu_plus_error.values - FLAT  # on cycles, which are drawn as families
    nu, error = found.nu_plus.values, found.nu_plus_error.values
    finite = np.isfinite(nu)
    best = np.argmax(np.where(finite, nu, -np.inf), axis=1)  # meaningless where no particle goes on
    rows = np.arange(columns)
    arrays = {
        "values": values,
        "half": np.array(half),
        "counts": counts,
        "spread": density(np.where(apart[:, :, None], np.nan, found.s.values), half),
        "largest": nu[rows, best],
        "error": np.nan_to_num(error[rows, best]),
        "least": np.where(finite.any(axis=1), np.where(finite, nu, np.inf).min(axis=1), np.nan),
        "chaotic": found.chaotic.values.mean(axis=1),
    }
    parts.keep(f"diagram-{level}", arrays)
    options = f"--orbits {orbits} --points {points} --transient {transient} --bounces {bounces} --seed {asked.seed}"
    over = f"--lams {asked.low}:{asked.high}:{columns}"
    if asked.parameter != "lam":
        over = f"--lams {asked.at[0]} --shape {asked.parameter}={asked.low}:{asked.high}:{columns}"
    command = asked.command("bifurcation", over, options)
    size = f"{columns} values of {asked.parameter}, {orbits} particles, {bounces} bounces"
    effort = Effort("bifurcation diagram", size, 0.0, f"{float(np.median(arrays['error'])):.1g} (median of nu_plus)")
    rows_of = exponent_rows(arrays)
    said: dict[str, Any] = {"level": level, "command": command, "size": size, "orbits": orbits, "rows": rows_of}
    keys = asked.parameter, "chaotic_share", "nu_plus", "nu_plus_stderr"
    said["exponents"] = [dict(zip(keys, row, strict=True)) for row in rows_of]
    return [], [effort], said


def density(s: NDArray[Any], half: float) -> NDArray[np.int32]:
    """Counts of bounces, with a row for each cell of arc length and a column for each value of the parameter."""
    rows = wrapped(s, half).reshape(len(s), -1)
    return np.stack([np.histogram(row[np.isfinite(row)], CELLS, (-half, half))[0] for row in rows], 1).astype(np.int32)


def plane(asked: Asked, parts: Parts, level: int) -> Found:
    """Computes the arrays for the parameter plane: the largest exponent by second parameter and contraction."""
    assert asked.second is not None
    name, low, high = asked.second
    rows, columns, starts = 16 << level, 32 << level, 6 + 2 * level
    bounces = transient = 512 << level
    first, last = (float(exact(name, end)) for end in (low, high))
    values, lams = np.linspace(first, last, rows), np.linspace(*asked.ends, columns)
    sweep = parameter_space(
        values, lams, starts, bounces, transient, seed=asked.seed, scene=text_of(asked.scene), parameter=name
    )
    found = run(sweep, scheduler=parts.scheduler)
    arrays = {"values": values, "lams": lams, "nu": found.nu_max.values, "chaotic": found.chaotic.values}
    parts.keep(f"plane-{level}", arrays)
    over = f"--shape {name}={low}:{high}:{rows} --lams {asked.low}:{asked.high}:{columns}"
    options = f"--starts {starts} --transient {transient} --bounces {bounces} --seed {asked.seed}"
    command = asked.command("sweep parameter-space", over, options, DRAWN)
    error = float(np.nanmedian(found.nu_max_error.values))
    size = f"{rows} values of {name} by {columns} contractions, {starts} particles, {bounces} bounces"
    said = {"level": level, "command": command, "size": size, "chaotic": float(np.mean(found.chaotic.values > 0))}
    return [], [Effort("parameter space", size, 0.0, f"{error:.1g} (median of nu_plus)")], said


def regions(asked: Asked, parts: Parts, level: int) -> Found:
    """Computes on which attractors random starts end, by second parameter and contraction."""
    assert asked.second is not None
    name, low, high = asked.second
    first, last = (float(exact(name, end)) for end in (low, high))
    rows, columns, starts = 16 << level, 32 << level, 24
    of, at = (a + (np.arange(n) + 0.5) / n * (b - a) for n, a, b in ((rows, first, last), (columns, *asked.ends)))
    text, names = text_of(asked.scene), list[str]()
    for value in of:
        here = at_value(text, name, float(value))
        size = float(map_of(here, 0.5).states.size)
        names += [_set_of(seen, size) for seen in endings(here, "lam", at, 1.0, starts, asked.seed)]
    sets, label = np.unique(names, return_inverse=True)
    parts.keep(f"regions-{level}", {"of": of, "at": at, "sets": sets, "label": label.reshape(rows, columns)})
    size_of = f"{rows} values of {name} by {columns} contractions, {starts} starts at each"
    return [], [Effort("regions of coexistence", size_of, 0.0)], {"level": level, "size": size_of, "sets": len(sets)}


def _set_of(seen: Endings, size: float) -> str:
    """The attractors that some starts reach, as text: the periods of different cycles (up to symmetry), and chaos."""
    found = list[str]()
    for n in np.unique(seen.period[seen.kind == CYCLE]):
        left = seen.marks[(seen.kind == CYCLE) & (seen.period == n)]
        while left.size:
            left = left[np.max(np.abs(left - left[0]), axis=1) > APART * size]
            found.append(str(n))
    found += [words for kind, words in ((CHAOTIC, "chaos"), (NEUTRAL, "neutral")) if np.any(seen.kind == kind)]
    return " + ".join(found) or "undecided"


def plane_blocks(
    asked: Asked,
    parts: Parts,
    said: dict[str, Any],
    curves: Sequence[dict[str, Any]],
    sets: dict[str, Any] | None,
) -> list[Block]:
    """The blocks for the parameter plane: regions of coexistence, and the plane with all curves known so far."""
    assert asked.second is not None
    letter, blocks = asked.second[0], list[Block]()
    lines = (
        "The lines are curves of events, numbered as below, in float64; at each dot the event is proved. The grey "
        f"line is the {letter} of other sections."
    )
    drawn = [{key: curve[key] for key in ("kind", "period", "points", "proved")} for curve in curves]
    if sets:
        name = f"regions-{sets['level']}-{len(curves)}"
        if name not in parts.drawn:
            pictures.regions(parts, name, parts.arrays(f"regions-{sets['level']}"), letter, curves, asked.own)
        caption = (
            "Regions of coexistence: the periods of the cycles that random starts end on, each as often as cycles "
            f"differ by more than a symmetry, and chaos; {sets['size']}. Sampled. {lines}"
        )
        blocks.append(Picture(name, caption, f"Attractors that coexist over {letter} and lambda", said["command"]))
    name = f"plane-{said['level']}-{len(curves)}"
    if name not in parts.drawn:
        pictures.plane(parts, name, parts.arrays(f"plane-{said['level']}"), letter, curves, asked.own)
    caption = (
        f"Parameter space: {said['size']} after a transient as long. The largest exponent per bounce, red where it "
        f"is positive; at {said['chaotic']:.0%} of the pairs some particle's is positive beyond its error. Sampled. "
        f"{lines}"
    )
    alt = f"Largest exponent over {letter} and lambda, with curves of events"
    return [*blocks, Picture(name, caption, alt, said["command"], {"curves": drawn})]


def exponent_rows(arrays: dict[str, NDArray[Any]]) -> list[list[Any]]:
    """Rows for a few parameter values: value, fraction of chaotic orbits, largest exponent and its error."""
    at = np.linspace(0, len(arrays["values"]) - 1, LISTED).round().astype(int)
    rows = [[float(arrays[name][i]) for name in ("values", "chaotic", "largest", "error")] for i in at]
    return [[value if np.isfinite(value) else None for value in row] for row in rows]


def diagram_blocks(
    asked: Asked,
    parts: Parts,
    said: dict[str, Any],
    events: list[tuple[float, str, float]],
    seen: dict[str, Any] | None,
) -> list[Block]:
    """The blocks for the diagram with all families and events known so far, and for the exponents along it."""
    level = -1 if seen is None else seen["level"]
    name = f"diagram-{said['level']}-{level}-{len(events)}"
    families = None if seen is None else parts.arrays(f"families-{level}")
    periods = [] if seen is None else [one["period"] for one in seen["families"]]
    window = close(asked, [value for value, _, _ in events]) if families is not None else None
    for each, part in ((name, None), (f"{name}-close", window)):
        if each not in parts.drawn and (part or each == name):
            arrays = parts.arrays(f"diagram-{said['level']}")
            pictures.diagram(parts, each, arrays, asked.parameter, events, families, periods, part)
    caption = (
        "Families of attractors along the parameter. Above, arc length of the bounces: each family of cycles has a "
        "colour and is drawn where it attracts, its images under the symmetries too, and the density is of particles "
        "that end on no cycle, the darker the more often a cell is met. Red lines are events. In the middle, the share "
        "of random starts that end on each family, in the same colours. Below, the largest exponent per bounce over "
        f"the orbits of the density, with its error, and the smallest. The density: {said['size']}. Sampled."
    )
    command = f"{said['command']} {DRAWN}"
    blocks: list[Block] = [Picture(name, caption, "Families of attractors, shares and exponents", command)]
    if window:
        caption = f"The same from {window[0]:.4g} to {window[1]:.4g}, where the events are."
        blocks.append(Picture(f"{name}-close", caption, "Part of the picture before", command))
    rows = tuple(
        (
            f"{value:.6g}",
            counted(round(share * said["orbits"]), said["orbits"]),
            "every particle stops" if nu is None else sampled(nu, error),
        )
        for value, share, nu, error in said["rows"]
    )
    caption = "Along the diagram: the orbits with an exponent positive beyond its error, and the largest one."
    columns = asked.parameter, "chaotic orbits", "largest nu_plus"
    return [*blocks, Listing(caption, columns, rows, f"{said['command']} --json FILE.json")]


def close(asked: Asked, values: Sequence[float]) -> tuple[float, float] | None:
    """The part of the interval that contains all events, if it is small; else None."""
    (low, high), span = asked.ends, max(values, default=0.0) - min(values, default=0.0)
    if len(values) < CLOSE[0] or span > CLOSE[1] * (high - low):
        return None
    return max(low, min(values) - 0.1 * span), min(high, max(values) + 0.1 * span)


def counted(count: int, of: int) -> str:
    """A count of starts as text, with a 95 % bound or interval for the probability.

    >>> counted(200, 200)
    '200 of 200, at least 98.1%'
    """
    share = wilson(count, of)
    if count in (0, of):
        return f"{count} of {of}, " + (f"at least {share.low:.1%}" if count else f"at most {share.high:.1%}")
    return f"{count} of {of}, {share.low:.1%} to {share.high:.1%}"


def census(asked: Asked, parts: Parts, which: int, level: int) -> Found:
    """The content of the section on attractors at one contraction: those that random starts reach, and the basins."""
    text = asked.at[which]
    starts = 200 * 4**level
    scene = asked.scene.at(lam=text)
    map = PinballMap(scene)
    found = find(map, starts, asked.seed, images=True)
    row = joined(found, starts, float(exact("--at", text)))
    known = [_known(scene, member) for member in row.members]
    rows = tuple(_member(*pair) for pair in zip(row.members, known, strict=True))
    missed = 3 / starts
    command = asked.command("attractor", f"--orbits {starts} --seed {asked.seed} --certify", lam=text)
    caption = (
        f"lambda = {text}: attractors that {starts} random starts reach, images under the symmetries together; shares "
        f"with 95 % intervals (Wilson). {row.unsettled} starts did not settle. An attractor whose basin is smaller "
        f"than about {missed:.2g} of the starts is likely to be missed."
    )
    columns = ("attractor", "symmetry", "copies", "share of the starts", "nu_plus", "nu_minus", "existence")
    nothing = f"lambda = {text}: none of {starts} random starts settled, so no attractor is known here."
    blocks: list[Block] = [Listing(caption, columns, rows, command) if rows else Paragraph(nothing)]
    attracting = [a for a in found if a.kind in (Kind.CYCLE, Kind.CHAOTIC)]
    if len(attracting) > 1:
        blocks.append(_basins(asked, parts, text, attracting, f"basins-{which}-{level}", level))
    wide = max((m.share.high - m.share.low for m in row.members), default=0.0) / 2
    effort = Effort(f"census at lambda = {text}", f"{starts} starts", 0.0, f"{wide:.2g} (half the widest interval)")
    told = [_attractor(text, *pair) for pair in zip(row.members, known, strict=True)]
    return blocks, [effort], {"attractors": told}


Three = tuple[str | ShownNumber, str | ShownNumber, ShownNumber]


def _attractor(text: str, member: Member, known: Three) -> dict[str, Any]:
    """An attractor as JSON: its kind, the number of its images, and the fraction of starts with a 95 % interval."""
    share, numbers = member.share, dict(zip(("nu_plus", "nu_minus"), known[:2], strict=True))
    errors = {f"{name}_error": nu.error if isinstance(nu, ShownNumber) else None for name, nu in numbers.items()}
    return {
        "lam": text,
        "kind": member.kind.name.lower(),
        "period": member.period if member.kind is Kind.CYCLE else None,
        "symmetry": member.symmetry,
        "copies": member.copies,
        "share": [share.low, share.high],
        **{name: nu.value if isinstance(nu, ShownNumber) else None for name, nu in numbers.items()},
        **errors,
    }


def _member(member: Member, known: Three) -> tuple[str | ShownNumber, ...]:
    share = member.share
    name = {Kind.CYCLE: f"cycle of period {member.period}", Kind.CHAOTIC: "chaotic", Kind.NEUTRAL: "neutral"}
    return (
        name.get(member.kind, f"stopped: {member.first.status.name.lower()}"),
        member.symmetry,
        str(member.copies),
        counted(share.count, share.of),
        *known,
    )


def _known(scene: Scene, member: Member) -> Three:
    """Both exponents of an attractor and its existence, each with how it is known: proved for a cycle, else sampled."""
    first = member.first
    if member.kind is not Kind.CYCLE:
        errors = zip((first.nu_plus, first.nu_minus), first.errors, strict=True)
        plus, minus = (sampled(nu, error) if np.isfinite(nu) else "-" for nu, error in errors)
        return plus, minus, ShownNumber("seen", known=Known.SAMPLED)
    plus, minus = (solved(nu, EXPONENT) if np.isfinite(nu) else "-" for nu in (first.nu_plus, first.nu_minus))
    try:
        proof = certificate(scene.table, S(scene.lam), first.points, law=scene.law)
    except (ValueError, ZeroDivisionError):
        return plus, minus, ShownNumber("in float64", known=Known.FLOAT)
    open_ = [name for name, value in proof.checks.items() if value is not True]
    if open_:
        return plus, minus, ShownNumber(f"open: {', '.join(open_)}", known=Known.FLOAT)
    with working(BITS):
        balls = exponents(proof.trace, proof.determinant, len(proof.theta))
    plus, minus = (ShownNumber(*decimal(nu, SHOWN), Known.PROVED) if nu.is_finite() else "-" for nu in balls)
    return plus, minus, ShownNumber("exists and attracts", known=Known.PROVED)


def _basins(asked: Asked, parts: Parts, text: str, attractors: list[Attractor], name: str, level: int) -> Picture:
    columns, rows = 120 * 2**level, 60 * 2**level
    scene = asked.scene.at(lam=text)
    sweep = basins(text_of(scene), float(scene.lam), columns, rows, None, 0, 500, asked.seed, True, tuple(attractors))
    with styled():
        pictures.saved(parts, name, grids.basins(run(sweep, scheduler=parts.scheduler)))
    caption = (
        f"Basins at lambda = {text}: the attractor that each of {columns} x {rows} starts reaches, a colour for "
        f"each of {len(attractors)}, with shares of the cells. Sampled at the centres of the cells."
    )
    command = asked.command("basins", f"--columns {columns} --rows {rows} --seed {asked.seed}", DRAWN, lam=text)
    return Picture(name, caption, f"Basins of attraction at lambda = {text}", command)
