"""The first sections of a report: the table, what is proved about it, and the thresholds of its double normals."""

from collections.abc import Iterator

from sympy import Expr, Integral, Symbol, cos, pi, simplify, sqrt

from numeric import PinballMap
from symbolic.cycles.cycle import Cycle, is_double_normal
from symbolic.cycles.thresholds import flip_contraction, focus_contraction, stability_number
from symbolic.expressions.signs import Outcome
from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import convexity
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.curves import LONG, size
from symbolic.tables.formula import latex
from symbolic.tables.geometry import Symmetry, arc_length, curvature, group, perimeter, turning
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table, eta, theta
from symbolic.tables.validity import enclosed_area, radius_sign, simple
from verification.arithmetic.balls import ARRAYS, FLOAT64, decimal
from verification.arithmetic.iteration import bracketed
from verification.maps.enclosed import EnclosedMap
from verification.maps.enclosed import perimeter as enclosed_perimeter
from verification.maps.first_hit import convex, turns_once
from verification.reports.asked import Asked
from verification.reports.blocks import Block, Cell, Formula, Known, Listing, Paragraph, ShownNumber

SHOWN = 4  # components whose formulas are shown
DIGITS = 15
GRID = 2001  # parameters of a piece at which the sign of the curvature is looked at
WIDE = 400  # letters of a formula in LaTeX that is still shown


def definition(asked: Asked) -> list[Block]:
    """The formulas of the table, its law and its curvature, as blocks of the section."""
    table, law = asked.scene.table, asked.scene.law
    shown = [part for part in table.components[:SHOWN] if size(part.point[0]) + size(part.point[1]) <= LONG]
    blocks: list[Block] = []
    for number, part in enumerate(shown):
        name = "boundary" if len(table.components) == 1 else f"boundary, {part.name}"
        blocks.append(Formula(name, rf"\left(x,\, y\right) = {latex(part)}"))
        bent = latex(curvature(part))
        if len(bent) <= WIDE:
            blocks.append(Formula(name.replace("boundary", "curvature"), rf"\kappa\left(\theta\right) = {bent}"))
        if number + 1 == SHOWN < len(table.components):
            blocks.append(Paragraph(f"{len(table.components) - SHOWN} more pieces are in the scene's file."))
    if not shown:
        blocks.append(
            Paragraph(f"The boundary has {len(table.components)} pieces; their formulas are in the scene's file.")
        )
    blocks.append(Formula("reflection law", rf"\varphi = {latex(law.phi)}"))
    return blocks


def facts(asked: Asked) -> list[Block]:
    """A table of arc length, area and symmetry, and of the properties that are proved."""
    table = asked.scene.table
    rows: list[tuple[Cell, ...]] = [("perimeter", length(asked.scene))]
    area = enclosed_area(table)
    if area is not None and area.is_number:
        rows.append(("area", ShownNumber(str(area))))
    symmetries = group(table)
    mirrors = sum(symmetry.sign < 0 for symmetry in symmetries)  # a dihedral group has as many turns
    rows.append(("symmetries", ShownNumber(f"D{mirrors}" if mirrors else f"C{len(symmetries)}", known=Known.PROVED)))
    rows += [(what, ShownNumber(said, known=known)) for what, said, known in properties(table)]
    caption = "What is known of the table. A closed formula is exact; what is proved is proved for the exact boundary."
    return [Listing(caption, ("property", "value"), tuple(rows))]


def length(scene: Scene) -> ShownNumber:
    """The perimeter, in closed form if there is one, else enclosed by integration in balls."""
    table = scene.table
    if len(table.components) <= SHOWN + 1 and not any(arc_length(part).has(Integral) for part in table.components):
        return ShownNumber(str(perimeter(table)))
    value, radius = decimal(enclosed_perimeter(EnclosedMap(PinballMap(scene), scene.lam, 100), DIGITS), DIGITS)
    return ShownNumber(value, radius, Known.PROVED)


def properties(table: Table) -> Iterator[tuple[str, str, Known]]:
    """The properties closed, simple and convex: for each its name, the answer, and how it is known."""
    yield "closed", "yes", Known.PROVED
    rho = table.components[0].radius if len(table.components) == 1 else None
    if rho is not None and radius_sign(rho) is Outcome.PROVED:
        yield "simple", "yes: the radius is positive for every angle", Known.PROVED
    elif turns_once(table):
        yield "simple", "yes: it bends inwards everywhere, and its tangent turns once", Known.PROVED
    elif simple(table):
        yield "simple", "yes: no two parts of the boundary meet", Known.PROVED
    if convex(table) or turns_once(table):
        yield "convex", "yes", Known.PROVED
        return
    where = inflections(table)
    if where:
        yield "convex", f"no: the curvature changes sign at theta = {', '.join(where)}, each within 5e-7", Known.FLOAT
    elif convexity(table).outcome is Outcome.REFUTED:
        yield "convex", "no: a point with positive curvature is known", Known.PROVED
    else:
        yield "convex", "not decided", Known.FLOAT


def inflections(table: Table) -> list[str]:
    """Parameters where the curvature of the first pieces changes sign, to six digits; a grid may miss a close pair.

    >>> from symbolic.tables import cuspless
    >>> inflections(cuspless)
    []
    """
    import numpy as np

    found = []
    for part in table.components[:SHOWN]:
        bend = turning(part)
        if bend.is_number or bend.free_symbols - {theta} or size(bend) > LONG:
            continue
        text = kernel("turning", [theta], {"bend": bend})
        one, many = load(text, FLOAT64), load(text, ARRAYS)
        at = np.linspace(float(part.start), float(part.end), GRID)
        values = np.broadcast_to(many(at)[0], at.shape)
        for i in np.flatnonzero(values[:-1] * values[1:] < 0):
            zero = bracketed(lambda x, f=one: f(x)[0], float(at[i]), float(at[i + 1]), 1e-12, 1e-15)  # type: ignore[misc]
            found.append(f"{zero:.6f}")
    return found


def derivation(asked: Asked) -> list[Block]:
    """The section on the derivative of the map, and on double normals along symmetry axes with their thresholds."""
    law = asked.scene.law
    matrix = derivative_matrix() if law.uniform else derivative_matrix(lam=Symbol("f'", real=True))
    name = "derivative in (s, phi), one flight and one reflection"
    blocks: list[Block] = [Formula(name, rf"\mathrm{{D}}T = {latex(matrix)}")]
    if not law.uniform:
        blocks.append(Formula("slope of the law", rf"f'\left(\eta\right) = {latex(law.phi.diff(eta) * -1)}"))
        blocks.append(
            Paragraph("Closed thresholds of period 2 are known for the law phi = -lam*eta; this scene has another.")
        )
        return blocks
    cycles = list(double_normals(asked.scene.table))
    if not cycles:
        blocks.append(
            Paragraph(
                "No axis of symmetry meets the table in two smooth points: no cycle of period 2 has a closed form here."
            )
        )
    for cycle in cycles:
        blocks += thresholds(cycle)
    return blocks


def double_normals(table: Table) -> Iterator[Cycle]:
    """The chords along symmetry axes with smooth end points; they are cycles of period 2 for every contraction.

    Chords that a symmetry exchanges are listed once.

    >>> from symbolic.tables import ellipse
    >>> [cycle.bounces for cycle in double_normals(ellipse.at(a=2))]
    [((0, 0), (0, pi)), ((0, pi/2), (0, 3*pi/2))]
    """
    seen: set[tuple[float, ...]] = set()
    for symmetry in group(table):
        ends = [] if symmetry.sign > 0 else _on_axis(table, symmetry)
        if len(ends) != 2 or any(_marked(table, *end) for end in ends):
            continue
        look = _look(table, ends)
        if look not in seen:
            seen.add(look)
            cycle = Cycle(f"axis at {symmetry.angle / 2}", table, tuple(ends))
            if is_double_normal(cycle):
                yield cycle


def _on_axis(table: Table, mirror: Symmetry) -> list[tuple[int, Expr]]:
    """The boundary points that a reflection fixes, except end points of pieces."""
    fixed = [(i, mirror.shift[i] / 2) for i, onto in enumerate(mirror.onto) if onto == i]
    if len(table.components) == 1:
        return [*fixed, *((i, at + pi) for i, at in fixed)]
    return [(i, at) for i, at in fixed if table.components[i].start < at < table.components[i].end]


def _look(table: Table, ends: list[tuple[int, Expr]]) -> tuple[float, ...]:
    """The rounded length of a chord and curvatures at its ends, equal for chords that a symmetry exchanges."""
    (x0, y0), (x1, y1) = (table.components[i].at(at) for i, at in ends)
    length = float(sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2))
    bent = sorted(float(curvature(table.components[i]).subs(theta, at)) for i, at in ends)
    return tuple(round(value, 9) for value in (length, *bent))


def _marked(table: Table, index: int, at: Expr) -> bool:
    """True if the map is undefined at this boundary point."""
    return any(mark.component == index and cos(mark.theta - at) == 1 for mark in table.undefined)


def thresholds(cycle: Cycle) -> list[Block]:
    """Formulas for a double normal: its stability number, and where it doubles its period or becomes a focus."""
    number = stability_number(cycle)
    value = number.evalf(20)
    blocks: list[Block] = [Formula(f"{cycle.name}: stability number P = (1 + t*K0)*(1 + t*K1)", f"P = {latex(number)}")]
    decimals = f"P = {number if number.is_Integer else value.evalf(12)}"
    if number < -1 or number > 1:
        blocks.append(Paragraph(f"{decimals}: unstable for every contraction."))
    elif number < 0:
        exact = simplify(flip_contraction(number))
        blocks.append(Formula(f"{cycle.name}: period doubling", rf"\lambda = {approximated(exact)}"))
        blocks.append(Paragraph(f"{decimals}: stable below this contraction, unstable above it."))
    elif number == 1:
        blocks.append(
            Paragraph("P = 1: one of a family of parallel chords, with a multiplier 1 for every contraction.")
        )
    else:
        exact = simplify(focus_contraction(number))
        blocks.append(Formula(f"{cycle.name}: complex multipliers", rf"\lambda > {approximated(exact)}"))
        blocks.append(Paragraph(f"{decimals}: stable for every lam < 1, a focus above this contraction."))
    return blocks


def approximated(exact: Expr) -> str:
    """An exact number and its decimal approximation, in LaTeX."""
    return rf"{latex(exact)} \approx {exact.evalf(DIGITS)}"
