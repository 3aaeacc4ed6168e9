"""What particles do: the slap map, phase portraits, the bifurcation diagram with exponents, and the attractors."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter
from sympy import S

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind, find
from numeric.dynamics.recognition import wilson
from numeric.sweeps.fields import basins, bifurcation
from numeric.sweeps.run import run
from numeric.sweeps.space import parameter_space
from numeric.sweeps.sweep import text_of
from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import decimal, working
from verification.named.attractors import Member, certificate, exponents, joined
from verification.named.questions import PeriodicOrbit
from verification.reports import pictures
from verification.reports.asked import DRAWN, Asked, Parts
from verification.reports.blocks import Block, Effort, Known, Listing, Number, Picture, Words, solved
from verification.reports.lives import said_of

Found = tuple[list[Block], list[Effort], dict[str, Any]]
POINTS = 1200  # of the graph of the slap map
COLUMNS, ROWS = 240, 160  # cells of a phase portrait
SHAPES = 40  # values of another parameter than the contraction: each is a table of its own
CELLS = 240  # of arc length in a bifurcation diagram
FEW = 0.02  # of them
LONGEST = 12  # period of an attracting cycle that is followed, whatever was asked for
ROUNDED = 5e-6  # of an exponent that is shown with five decimals
EXPONENT, SHOWN, BITS = 5, 8, 128  # digits of a cycle's exponents, in float64 and in balls, and the bits of these
LISTED = 11  # contractions of a diagram whose exponents are listed


def slap(asked: Asked, parts: Parts) -> Found:
    """The map at contraction 0: where a particle lands that leaves along the normal."""
    if not asked.scene.law.uniform:
        return [Words("The slap map is the limit of the law phi = -lam*eta; this scene has another law.")], [], {}
    map = PinballMap(asked.scene, lam=0)
    ends = np.array(map.states.ends)
    each = POINTS // len(ends)
    component = np.repeat(np.arange(len(ends)), each)
    share = (np.tile(np.arange(each), len(ends)) + 0.5) / each
    theta = ends[component, 0] + (ends[component, 1] - ends[component, 0]) * share
    found = map.slap(theta, 1, component)
    half = map.arclength.perimeter / 2
    s, image = (
        wrapped(map.arclength.s(at, on), half) for at, on in ((theta, component), (found.theta[1], found.component[1]))
    )
    order = np.argsort(s)
    good = found.code[1] == 0
    slope = np.where(good, found.slope, np.nan)
    pictures.slap(parts, "slap", s[order], np.where(good, image, np.nan)[order], slope[order], half)
    steep = float(np.mean(np.abs(slope[good]) > 1)) if np.any(good) else float("nan")
    caption = (
        "The slap map, the limit of contraction 0, and its derivative, both over arc length. In the grey band the map "
        f"contracts; it expands at {steep:.0%} of {good.sum()} points of an even grid in the parameter."
    )
    alt = "Graphs of the slap map and of its derivative"
    return [Picture("slap", caption, alt, asked.command("slap", DRAWN))], [], {}


def wrapped(s: Any, half: float) -> Any:
    """Arc length modulo the perimeter, from `-half` to `half`."""
    return np.remainder(np.asarray(s) + half, 2 * half) - half


def portrait(asked: Asked, parts: Parts, level: int) -> Found:
    """Where random particles are after a transient, as a density over arc length and the sine of the exit angle."""
    from numeric.pinball.sampling import interior_starts

    orbits, bounces = 100 << level, 400 << level
    clouds, half = [], 1.0
    for text in asked.at:
        map = PinballMap(asked.scene.at(lam=text))
        half = map.arclength.perimeter / 2
        starts = interior_starts(map, orbits, asked.seed)
        end = map.exponents(starts.theta, starts.phi, 1, 1000, starts.component)
        alive = end.code == 0
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
    alt = "Densities of bounces in phase space at " + ", ".join(f"lambda = {text}" for text in asked.at)
    command = asked.command("attractor", f"--orbits {orbits} --seed {asked.seed}", DRAWN, lam=asked.at[0])
    effort = Effort("phase portraits", f"{orbits} particles, {bounces} bounces", 0.0)
    return [Picture(f"portrait-{level}", caption, alt, command)], [effort], {}


def diagram(asked: Asked, parts: Parts, level: int) -> Found:
    """The attractors against the contraction, and the exponents of the same orbits; kept as arrays to be drawn."""
    low, high = asked.ends
    columns, orbits, points = (150 if asked.parameter == "lam" else SHAPES) * 2**level, 12 + 6 * level, 120
    values = np.linspace(low, high, columns)
    transient, bounces = 1000 * 2**level, 512 * 2**level
    text, lam = text_of(asked.scene), float(asked.scene.lam)
    sweep = bifurcation(text, values, orbits, points, bounces, transient, asked.seed, asked.parameter, lam)
    found = run(sweep, scheduler=parts.scheduler)
    half = PinballMap(asked.scene).arclength.perimeter / 2
    counts = density(found.s.values, half)
    nu, error = found.nu_plus.values, found.nu_plus_error.values
    best = np.nanargmax(np.where(np.isfinite(nu), nu, -np.inf), axis=1)
    rows = np.arange(columns)
    arrays = {
        "values": values,
        "half": np.array(half),
        "counts": counts,
        "largest": nu[rows, best],
        "error": np.nan_to_num(error[rows, best]),
        "least": np.nanmin(np.where(np.isfinite(nu), nu, np.inf), axis=1),
        "chaotic": found.chaotic.values.mean(axis=1),
    }
    parts.keep(f"diagram-{level}", arrays)
    options = f"--orbits {orbits} --points {points} --transient {transient} --bounces {bounces} --seed {asked.seed}"
    over = f"--lams {asked.low}:{asked.high}:{columns}"
    if asked.parameter != "lam":
        over = f"--lams {asked.at[0]} --shape {asked.parameter}={asked.low}:{asked.high}:{columns}"
    command = asked.command("bifurcation", over, options)
    size = f"{columns} values of {asked.parameter}, {orbits} particles, {bounces} bounces"
    effort = Effort("bifurcation diagram", size, 0.0, f"{float(np.nanmedian(arrays['error'])):.1g} (median of nu_plus)")
    rows_of = exponent_rows(arrays)
    said: dict[str, Any] = {"level": level, "command": command, "size": size, "orbits": orbits, "rows": rows_of}
    keys = asked.parameter, "chaotic_share", "nu_plus", "nu_plus_stderr"
    said["exponents"] = [dict(zip(keys, row, strict=True)) for row in rows_of]
    return [], [effort], said


def density(s: NDArray[Any], half: float) -> NDArray[np.int32]:
    """How often each cell of arc length is met, in a column for each value of the parameter."""
    rows = wrapped(s, half).reshape(len(s), -1)
    return np.stack([np.histogram(row[np.isfinite(row)], CELLS, (-half, half))[0] for row in rows], 1).astype(np.int32)


def plane(asked: Asked, parts: Parts, level: int) -> Found:
    """The largest exponent of random particles at pairs of the second parameter and the contraction; kept as arrays."""
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


def plane_blocks(asked: Asked, parts: Parts, said: dict[str, Any], curves: Sequence[dict[str, Any]]) -> list[Block]:
    """The plane with the curves known so far over it, drawn unless it is there."""
    assert asked.second is not None
    letter = asked.second[0]
    name = f"plane-{said['level']}-{len(curves)}"
    if not parts.picture(name).exists():
        pictures.plane(parts, name, parts.arrays(f"plane-{said['level']}"), letter, curves, asked.own)
    caption = (
        f"Parameter space: {said['size']} after a transient as long. The largest exponent per bounce, red where it is "
        f"positive; at {said['chaotic']:.0%} of the pairs some particle's is positive beyond its error. Sampled. The "
        f"lines are curves of events, numbered as below, in float64; the grey line is the {letter} of other sections."
    )
    alt = f"Largest exponent over {letter} and lambda, with curves of events"
    drawn = [{key: curve[key] for key in ("kind", "period", "points")} for curve in curves]
    return [Picture(name, caption, alt, said["command"], {"curves": drawn})]


def exponent_rows(arrays: dict[str, NDArray[Any]]) -> list[list[Any]]:
    """A few contractions: the share of chaotic orbits, and the largest exponent with its error."""
    at = np.linspace(0, len(arrays["values"]) - 1, LISTED).round().astype(int)
    return [[float(arrays[name][i]) for name in ("values", "chaotic", "largest", "error")] for i in at]


def diagram_blocks(asked: Asked, parts: Parts, said: dict[str, Any], events: list[tuple[float, str]]) -> list[Block]:
    """The diagram with the events known so far, drawn unless it is there, and the exponents along it."""
    name = f"diagram-{said['level']}-{len(events)}"
    if not parts.picture(name).exists():
        pictures.diagram(parts, name, parts.arrays(f"diagram-{said['level']}"), asked.parameter, events)
    caption = (
        f"Bifurcation diagram: {said['size']} after a transient. Above, arc length of the bounces, the darker the more "
        "often a cell is met (logarithm of the count), and the located events as lines; below, the largest exponent "
        "per bounce over the orbits, with its standard error, and the smallest. Sampled: an attractor that no start "
        "reached is not drawn."
    )
    picture = Picture(name, caption, "Bifurcation diagram as a density, above exponents", f"{said['command']} {DRAWN}")
    rows = tuple(
        (
            f"{value:.6g}",
            _share(share, said["orbits"]),
            Number(f"{nu:.5f}", f"{error:.1g}", Known.SAMPLED),
        )
        for value, share, nu, error in said["rows"]
    )
    caption = "Along the diagram: the share of orbits with an exponent positive beyond its error, and the largest one."
    columns = asked.parameter, "chaotic orbits", "largest nu_plus"
    return [picture, Listing(caption, columns, rows, f"{said['command']} --json FILE.json")]


def _share(share: float, of: int) -> Number:
    """A share of particles with half its 95 % interval."""
    interval = wilson(round(share * of), of)
    return Number(f"{share:.0%}", f"{max(share - interval.low, interval.high - share):.0%}", Known.SAMPLED)


def census(asked: Asked, parts: Parts, which: int, level: int) -> Found:
    """The attractors that random starts reach at one contraction, and which start reaches which."""
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
    blocks: list[Block] = [Listing(caption, columns, rows, command)]
    attracting = [a for a in found if a.kind in (Kind.CYCLE, Kind.CHAOTIC)]
    if len(attracting) > 1:
        blocks.append(_basins(asked, parts, text, attracting, f"basins-{which}-{level}", level))
    wide = max((m.share.high - m.share.low for m in row.members), default=0.0) / 2
    effort = Effort(f"census at lambda = {text}", f"{starts} starts", 0.0, f"{wide:.2g} (half the widest interval)")
    cycles = [_cycle(scene, m.first) for m in row.members if m.kind is Kind.CYCLE and m.period <= LONGEST]
    told = [_attractor(text, *pair) for pair in zip(row.members, known, strict=True)]
    return blocks, [effort], {"cycles": cycles, "attractors": told}


Three = tuple[str | Number, str | Number, Number]


def _attractor(text: str, member: Member, known: Three) -> dict[str, Any]:
    """An attractor for JSON: what it is, how many images it has, and the share of starts with a 95 % interval."""
    share, numbers = member.share, dict(zip(("nu_plus", "nu_minus"), known[:2], strict=True))
    errors = {f"{name}_error": nu.error if isinstance(nu, Number) else None for name, nu in numbers.items()}
    return {
        "lam": text,
        "kind": member.kind.name.lower(),
        "period": member.period if member.kind is Kind.CYCLE else None,
        "symmetry": member.symmetry,
        "copies": member.copies,
        "share": [share.low, share.high],
        **{name: nu.value if isinstance(nu, Number) else None for name, nu in numbers.items()},
        **errors,
    }


def _cycle(scene: Scene, attractor: Attractor) -> dict[str, Any]:
    """An attracting cycle as plain data, for whoever follows it."""
    points, multipliers = attractor.points, attractor.multipliers or (0j, 0j)
    component, theta, phi = (tuple(row.tolist()) for row in points)
    return said_of(PeriodicOrbit(scene, component, theta, phi, multipliers))


def _member(member: Member, known: Three) -> tuple[str | Number, ...]:
    share = member.share
    name = {Kind.CYCLE: f"cycle of period {member.period}", Kind.CHAOTIC: "chaotic", Kind.NEUTRAL: "neutral"}
    half = (share.high - share.low) / 2
    return (
        name.get(member.kind, f"stopped: {member.first.status.name.lower()}"),
        member.symmetry,
        str(member.copies),
        Number(f"{(share.low + share.high) / 2:.3f}", f"{half:.3f}", Known.SAMPLED),
        *known,
    )


def _known(scene: Scene, member: Member) -> Three:
    """Both exponents and the existence of an attractor: of a cycle what balls prove, of anything else what was seen."""
    first = member.first
    if member.kind is not Kind.CYCLE:
        errors = zip((first.nu_plus, first.nu_minus), first.errors, strict=True)
        sampled = [Number(f"{nu:.5f}", f"{max(error, ROUNDED):.0e}", Known.SAMPLED) for nu, error in errors]
        plus, minus = (number if np.isfinite(float(number.value)) else "-" for number in sampled)
        return plus, minus, Number("seen", known=Known.SAMPLED)
    plus, minus = (solved(nu, EXPONENT) if np.isfinite(nu) else "-" for nu in (first.nu_plus, first.nu_minus))
    try:
        proof = certificate(scene.table, S(scene.lam), first.points, law=scene.law)
    except (ValueError, ZeroDivisionError):
        return plus, minus, Number("in float64", known=Known.FLOAT)
    open_ = [name for name, value in proof.checks.items() if value is not True]
    if open_:
        return plus, minus, Number(f"open: {', '.join(open_)}", known=Known.FLOAT)
    with working(BITS):
        balls = exponents(proof.trace, proof.determinant, len(proof.theta))
    plus, minus = (Number(*decimal(nu, SHOWN), Known.PROVED) if nu.is_finite() else "-" for nu in balls)
    return plus, minus, Number("exists and attracts", known=Known.PROVED)


def _basins(asked: Asked, parts: Parts, text: str, attractors: list[Attractor], name: str, level: int) -> Picture:
    columns, rows = 120 * 2**level, 60 * 2**level
    scene = asked.scene.at(lam=text)
    sweep = basins(text_of(scene), float(scene.lam), columns, rows, None, 0, 500, asked.seed, True, tuple(attractors))
    label = run(sweep, scheduler=parts.scheduler).label.values
    half = PinballMap(scene).arclength.perimeter / 2
    order = sorted(range(len(attractors)), key=lambda i: (attractors[i].family, i))
    colours = [order.index(i) for i in range(len(attractors))]
    pictures.basins(parts, name, label, colours, half, rf"$\lambda = {text}$")
    shares = ", ".join(f"{np.mean(label == i):.0%}" for i in order[:8])
    caption = (
        f"Basins at lambda = {text}: the attractor that each of {columns} x {rows} starts reaches, a colour for "
        f"each of {len(attractors)}; shares of the cells {shares}. Sampled at the centres of the cells."
    )
    command = asked.command("basins", f"--columns {columns} --rows {rows} --seed {asked.seed}", DRAWN, lam=text)
    return Picture(name, caption, f"Basins of attraction at lambda = {text}", command)
