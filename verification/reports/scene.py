"""The first sections of a report: the table, what is proved about it, and the thresholds of its double normals."""

from collections.abc import Iterator

from sympy import Expr, Integral, Symbol, simplify

from numeric import PinballMap
from symbolic.cycles.cycle import Cycle
from symbolic.cycles.derivations import double_normals
from symbolic.cycles.thresholds import flip_contraction, focus_contraction, stability_number
from symbolic.expressions.signs import Outcome
from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import convexity
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.curves import LONG, size
from symbolic.tables.formula import latex
from symbolic.tables.geometry import arc_length, curvature, group, perimeter, turning
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table, eta, theta
from symbolic.tables.validity import all_angles, enclosed_area, radius_sign, simple
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
    at_least = ShownNumber(f"D{mirrors}" if mirrors else f"C{len(symmetries)}", known=Known.PROVED)
    rows.append(("symmetries about the origin, at least", at_least))
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
    if rho is not None and all_angles(table.components[0], rho) and radius_sign(rho) is Outcome.PROVED:
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
    try:
        cycles = double_normals(asked.scene.table)
    except ValueError:  # no such axis
        said = "No axis of symmetry meets the table in two smooth points: no cycle of period 2 has a closed form here."
        return [*blocks, Paragraph(said)]
    return [*blocks, *(block for cycle in cycles for block in thresholds(cycle))]


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
        said = "P = 1: a multiplier is 1 for every contraction, as for parallel chords and a circle's diameters."
        blocks.append(Paragraph(said))
    else:
        exact = simplify(focus_contraction(number))
        blocks.append(Formula(f"{cycle.name}: complex multipliers", rf"\lambda > {approximated(exact)}"))
        blocks.append(Paragraph(f"{decimals}: stable for every lam < 1, a focus above this contraction."))
    return blocks


def approximated(exact: Expr) -> str:
    """An exact number and its decimal approximation, in LaTeX."""
    return rf"{latex(exact)} \approx {exact.evalf(DIGITS)}"
