"""Lowering: turns an exact table into its table IR (intermediate representation), the plain data that kernels need.

It is the only module of `numeric` that imports SymPy. It is used when a table IR is not on disk, never while a map
runs.
"""

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, reduce
from operator import mul
from typing import Any

from sympy import Abs, Add, Dummy, Expr, Float, I, Mul, Pow, S, Symbol, cos, expand, pi, sin, sqrt, tan
from sympy import sympify as exact

from numeric.lowering.program import Builder, ComponentProgram, LawIR, Named, Node, Program, ShapeRange, TableIR
from symbolic import tables
from symbolic.expressions.signs import Box, vanishes
from symbolic.expressions.text import FUNCTIONS
from symbolic.motion import flight
from symbolic.tables.curves import LONG, highest, size, varies, waves
from symbolic.tables.formula import levels
from symbolic.tables.geometry import group, velocity
from symbolic.tables.joins import bends, contacts, following
from symbolic.tables.law import Law, lengths
from symbolic.tables.polynomial import cubic
from symbolic.tables.scene import Scene
from symbolic.tables.table import Component, Table, eta, lam, s, theta
from symbolic.tables.validity import parameter_box, prove_table, radius_over, root, validated

DEEP = 12  # nested operations, beyond which derivatives are not written out
LARGEST = 4000  # numbers and operations of a coordinate, which is written out three times
DEGREE = 16  # the highest harmonic of a chord polynomial: its text grows with the third power

# Functions of one value that keep their names; the square root is a power.
WORDS: tuple[type[Expr], ...] = tuple(
    function for function in FUNCTIONS if isinstance(function, type) and function not in (sin, cos)
)
ROOT = 12  # the highest root


@lru_cache(maxsize=64)
def lower(table: Table) -> TableIR:
    """The table IR of a table; shape parameters without a value are inputs of its programs.

    First it is proved, unless this was done before, that the boundary bounds a table. `ValueError` if it does not, or
    if a formula has more than `LARGEST` numbers and operations.
    """
    for component in table.components:
        if (count := max(map(size, component.point))) > LARGEST:
            words = f"{count} numbers and operations; at most {LARGEST} are accepted"
            raise ValueError(f"{table.name}: a coordinate of {component.name} has {words}")
    table = validated(table)
    symbols = [shape.symbol for shape in table.shapes]
    parts = tuple(_part(component, symbols, parameter_box(table)) for component in table.components)
    same = _same_as(table)
    own = {} if same else _conic(table, symbols) or _fourier(table, symbols) or _pieces(table, symbols)
    programs = {} if same else own | _radius(table, symbols)
    index, start = table.origin
    return TableIR(
        table.name,
        same,
        tuple(ShapeRange(p.symbol.name, _bound(p.range.start), _bound(p.range.end), p.otherwise) for p in table.shapes),
        parts,
        tuple(programs.items()),
        (index, _program(symbols, lambda nodes: [nodes(start)])),
        tuple(
            (after, contact.name, bend)
            for after, contact, bend in zip(following(table), contacts(table), bends(table), strict=True)
        ),
    )


def lower_law(law: Law, table: Callable[[], Table]) -> LawIR:
    """The programs of a law without free parameters; `table` is called only for a law that depends on arc length."""
    if law.parameters:
        raise ValueError(f"law = {law}: the parameter {law.parameters[0]} needs a value")
    places = (theta, s) if law.measured else (theta,)

    def program(*values: Expr) -> Program:
        builder = Builder("eta", "lam", *map(str, places))
        nodes = dict(zip((eta, lam, *places), builder.nodes, strict=True))
        return builder.program(*(converted(builder, value, nodes) for value in values))

    def line(length: Expr) -> Program:
        return _program([], lambda nodes: [nodes(length.diff(theta)), nodes(length.subs(theta, 0))])

    known = (lengths(table()) if law.measured else None) or ()
    parts = () if any(length.has(sin, cos) for length in known) else tuple(map(line, known))
    return LawIR(
        str(law), program(law.phi), program(law.slope, *map(law.phi.diff, places)), law.placed, law.measured, parts
    )


def exact_table(table: Table | Scene | Named | str, K: int, shape: dict[str, Any]) -> Table:
    """The exact table of a map, with the numbers of its shape."""
    if isinstance(table, Scene | Named):
        return table.table if isinstance(table, Scene) else tables.of_gallery(table.name, dict(table.lengths))
    given = tables.named(table, K) if isinstance(table, str) else table
    return given.at(**{name: exact(value) for name, value in shape.items()}) if shape else given


@lru_cache(maxsize=64)
def proved_throughout(table: Table) -> bool:
    """Is it proved that the boundary bounds a table for all values of its free parameters?"""
    try:
        if not radius_over(table):
            prove_table(table)
    except ValueError:  # some values give no table; others may
        return False
    return True


def in_unit(table: Table, length: Fraction, x: Fraction, y: Fraction) -> Table:
    """The same table with its origin at `(x, y)`, measured in units of `length`."""
    scale, move = exact(length), (exact(x), exact(y))

    def component(old: Component) -> Component:
        rho = old.radius if x == y == 0 else None
        if rho is not None:
            rho = rho / scale
            return replace(old, point=(rho * cos(theta), rho * sin(theta)))
        u, v = ((place - away) / scale for place, away in zip(old.point, move, strict=True))
        return replace(old, point=(u, v))

    return replace(table, components=tuple(map(component, table.components)))


def symmetry_text(table: Table) -> str:
    """A JSON text of the symmetries that are proved for a table, the identity first, with floats for exact numbers."""
    return json.dumps([[g.sign, float(g.angle), g.onto, [float(x) for x in g.shift]] for g in group(table)])


def converted(builder: Builder, expression: Expr, nodes: dict[Symbol, Node]) -> Node:
    """The node of a SymPy expression in the program's vocabulary; `ValueError`, never a rounding, for anything else."""
    if expression.has(Float):
        raise ValueError(f"{expression} contains a rounded float; write its numbers exactly, as Rational(2, 25)")
    if expression in nodes:
        return nodes[expression]
    if expression.is_Rational:
        return builder.exact(0) + builder.exact(exact(expression).p) / builder.exact(exact(expression).q)
    if expression is pi:
        return builder.node("pi")
    values = [converted(builder, x, nodes) for x in expression.args] if expression.is_Add or expression.is_Mul else []
    if expression.is_Add:
        return sum(values[1:], start=values[0])
    if expression.is_Mul:
        return reduce(mul, values)
    if isinstance(expression, Pow) and expression.exp.is_Rational and expression.exp.q <= ROOT:
        return _power(builder, converted(builder, expression.base, nodes), expression.exp)
    if isinstance(expression, cos | sin):
        return _circular(builder, expression, nodes)
    if isinstance(expression, tan):
        return _circular(builder, sin(*expression.args), nodes) / _circular(builder, cos(*expression.args), nodes)
    if expression is S.Exp1:
        return builder.node("exp", builder.exact(1).number())
    if isinstance(expression, WORDS):
        return builder.node(expression.func.__name__, converted(builder, expression.args[0], nodes).number())
    raise ValueError(
        f"{expression} has no code in kernels; accepted: + - * /, powers by rationals, pi, rationals, sin, cos, tan, "
        f"{', '.join(function.__name__ for function in WORDS)}"
    )


def _power(builder: Builder, base: Node, power: Expr) -> Node:
    whole, part = divmod(abs(power), 1)
    result = _whole_power(builder, base, int(whole))
    if part:
        root = builder.node("sqrt" if part.q == 2 else f"root{part.q}", base.number())
        result = result * _whole_power(builder, root, int(part.p))
    return builder.exact(1) / result if power < 0 else result


def _whole_power(builder: Builder, base: Node, n: int) -> Node:
    return builder.exact(flight.power((base, 0), n)[0])


def _circular(builder: Builder, expression: Expr, nodes: dict[Symbol, Node]) -> Node:
    """The node of a cosine or sine.

    For whole multiples of `theta` it is formed from products, so that one cosine and one sine serve all multiples.
    """
    (argument,) = expression.args
    multiple = argument / theta
    index = 0 if isinstance(expression, cos) else 1
    if multiple.is_Integer and multiple != 0:
        at = nodes[theta].number()
        u = builder.node("cos", at), builder.node("sin", at)
        value = builder.exact(flight.power(u, abs(int(multiple)))[index])
        return -value if index and multiple < 0 else value
    return builder.node("sin" if index else "cos", converted(builder, argument, nodes).number())


class Nodes:
    """Converts expressions into nodes of one program; `inputs` are the nodes of the program's first inputs."""

    def __init__(self, builder: Builder, inputs: list[Node], known: dict[Symbol, Node]) -> None:
        self.builder, self.inputs, self.known = builder, inputs, known

    @property
    def unit(self) -> tuple[Node, Node]:
        """The first two inputs: cosine and sine of an angle."""
        return self.inputs[0], self.inputs[1]

    def harmonics(self, h: flight.Harmonics) -> flight.Harmonics:
        """The vectors of a Fourier sum in nodes."""
        return {k: tuple((self(x), self(y)) for x, y in vectors) for k, vectors in h.items()}  # type: ignore[misc]

    def __call__(self, expression: Expr | int, more: dict[Symbol, Node] | None = None) -> Node:
        return converted(self.builder, exact(expression), {**self.known, **more} if more else self.known)


def _program(symbols: list[Symbol], formula: Callable[[Nodes], list[Node]], *first: str) -> Program:
    """The program with inputs `first`, `symbols` and outputs `formula(nodes)`, where `nodes` converts expressions."""
    builder = Builder(*first, *(symbol.name for symbol in symbols))
    nodes = dict(zip([theta] if first == ("theta",) else [], builder.nodes, strict=False))
    nodes |= dict(zip(symbols, builder.nodes[len(first) :], strict=True))
    return builder.program(*formula(Nodes(builder, builder.nodes[: len(first)], nodes)))


def _part(component: Component, symbols: list[Symbol], ranges: Box) -> ComponentProgram:
    ends = _program(symbols, lambda nodes: [nodes(component.start), nodes(component.end)])
    known = cubic(component)
    if known is not None and any(row[3] for row in known):
        return ComponentProgram(
            component.name, ends, _program(symbols, lambda nodes: _polynomial_curve(nodes, known), "theta")
        )
    if sum(map(size, component.point)) > LONG or max(map(levels, component.point)) > DEEP:
        return ComponentProgram(component.name, ends, _long_curve(component, symbols))
    component = flight.about_far_focus(component, ranges)
    first = velocity(component)
    curve = [*component.point, *first, *first.diff(theta)]
    return ComponentProgram(
        component.name, ends, _program(symbols, lambda nodes: [nodes(expr) for expr in curve], "theta")
    )


def _long_curve(component: Component, symbols: list[Symbol]) -> Program:
    """Point, velocity and acceleration of a long formula: harmonic by harmonic, or one operation after the other.

    Derivatives are not written out, as those of a product of thirty factors have some thousand factors.
    """
    x, y = component.point
    found = waves(x + I * y)
    c = flight.harmonics(component) if found is not None and highest(found) <= LONG else None
    if c is not None:
        once = flight.differentiated(c)
        sums = c, once, flight.differentiated(once)

        def waved(nodes: Nodes) -> list[Node]:
            u = nodes(cos(theta)), nodes(sin(theta))
            return [x for h in sums for x in flight.point_at(nodes.harmonics(h), u)]

        return _program(symbols, waved, "theta")

    def jets(nodes: Nodes) -> list[Node]:
        known: dict[Expr, Jet] = {}
        x, y = (_jet(expression, nodes, known) for expression in component.point)
        return [value for pair in zip(x, y, strict=True) for value in pair]

    return _program(symbols, jets, "theta")


Jet = tuple[Node, Node, Node]  # a value and its first two derivatives by theta


def _jet(expression: Expr, nodes: Nodes, known: dict[Expr, Jet]) -> Jet:
    """The nodes of an expression and its derivatives by `theta`, by the chain rule on each operation."""
    if expression in known:
        return known[expression]
    if not expression.args or _is_wave(expression) or not expression.has(theta):
        first = expression.diff(theta)
        found = nodes(expression), nodes(first), nodes(first.diff(theta))
    elif isinstance(expression, Add | Mul) and len(expression.args) > 2:
        half = len(expression.args) // 2
        parts = (expression.func(*some) for some in (expression.args[:half], expression.args[half:]))
        found = _chained(expression.func, [_jet(part, nodes, known) for part in parts], nodes)
    else:
        inner = [part for part in expression.args if part.has(theta)]

        def outer(*given: Expr) -> Expr:
            by_part = dict(zip(inner, given, strict=True))
            return expression.func(*(by_part.get(part, part) for part in expression.args))

        found = _chained(outer, [_jet(part, nodes, known) for part in inner], nodes)
    known[expression] = found
    return found


def _chained(outer: Callable[..., Expr], inner: list[Jet], nodes: Nodes) -> Jet:
    """The jet of a function of one or two expressions, from their jets."""
    whole = outer(*(letters := [Dummy(real=True) for _ in inner]))
    known = {letter: jet[0] for letter, jet in zip(letters, inner, strict=True)}
    value = nodes(whole, known)
    first, second = nodes(0), nodes(0)
    for letter, jet in zip(letters, inner, strict=True):
        slope = whole.diff(letter)
        first = first + nodes(slope, known) * jet[1]
        second = second + nodes(slope, known) * jet[2]
        for other, more in zip(letters, inner, strict=True):
            second = second + nodes(slope.diff(other), known) * jet[1] * more[1]
    return value, first, second


def _is_wave(expression: Expr) -> bool:
    return isinstance(expression, cos | sin) and bool((expression.args[0] / theta).is_Integer)


def _same_as(table: Table) -> str:
    """The name of the paper's table with the same boundary, if it has a flight method of its own; else empty."""
    if table.components == tables.cuspless.components:
        return "cuspless"
    if len(table.components) > 1:
        return ""
    (part,), (cardioid,), (circle,) = (one.components for one in (table, tables.cardioid, tables.circle))
    if part.point == cardioid.point and part.start == cardioid.start:  # its arc length has the cusp at the ends
        return "cardioid"
    return "circle" if part.point == circle.point else ""


def _fourier(table: Table, symbols: list[Symbol]) -> dict[str, Program]:
    """The programs of a closed curve that is a finite Fourier sum; empty for any other boundary."""
    whole = len(table.components) == 1 and table.components[0].end - table.components[0].start == 2 * pi
    x, y = table.components[0].point
    if not whole or any(flight.oscillates(z) or highest(waves(z) or {}) > DEGREE for z in (x, y)):
        return {}
    h = flight.harmonics(table.components[0])
    return {} if h is None or max(h) > DEGREE else _harmonic(h, symbols)


def _harmonic(h: flight.Harmonics, symbols: list[Symbol]) -> dict[str, Program]:
    """The programs of a finite Fourier sum."""
    degree = max(h)

    def at_point(harmonics: flight.Harmonics) -> Program:
        return _program(symbols, lambda nodes: list(flight.point_at(nodes.harmonics(harmonics), nodes.unit)), "c", "s")

    once = flight.differentiated(h)
    programs = {"point": at_point(h), "velocity": at_point(once), "acceleration": at_point(flight.differentiated(once))}
    if degree == 1:
        support = _program(symbols, lambda nodes: list(flight.support(nodes.harmonics(h), 1, nodes.unit)), "ex", "ey")
        return programs | {"support": support}

    def chord(nodes: Nodes) -> list[Node]:
        ex, ey, bx, by = nodes.inputs
        ahead = {k: flight.seen_ahead(k, *vectors, (ex, ey)) for k, vectors in nodes.harmonics(h).items() if k}
        return flight.chord_polynomial(ahead, flight.ONE, (bx, by))

    programs["chord"] = _program(symbols, chord, "ex", "ey", "bx", "by")
    return programs


def _conic(table: Table, symbols: list[Symbol]) -> dict[str, Program]:
    """The programs of an ellipse that is given by its radius about a focus; empty for any other table."""
    whole = table.components[0]
    rho = whole.radius if len(table.components) == 1 and whole.end - whole.start == 2 * pi else None
    known = None if rho is None or size(rho) > LONG or levels(rho) > DEEP else flight.about_focus(rho)
    if known is None:
        return {}
    focus = _program(symbols, lambda nodes: [nodes(x) for x in (*known.ahead, known.p, known.size, known.left)])
    return _harmonic(known.harmonics, symbols) | {"focus": focus}


def _radius(table: Table, symbols: list[Symbol]) -> dict[str, Program]:
    """The program of `r(theta)` and three derivatives in cosine and sine, for a boundary given by its radius.

    The result is empty for other boundaries, or if `theta` occurs outside sines and cosines of its whole multiples.
    """
    whole = table.components[0]
    x, rho, turn = whole.point[0], whole.radius, whole.end - whole.start
    if rho is None or table.components[1:] or turn != 2 * pi or size(x) > LONG or levels(x) > DEEP:
        return {}
    values = [rho.diff(theta, n) if n else rho for n in range(4)]
    known = {wave: Dummy(real=True) for value in values for wave in value.atoms(cos, sin) if _is_wave(wave)}
    if any(value.xreplace(known).has(theta) for value in values):
        return {}

    def radius(nodes: Nodes) -> list[Node]:
        waves = {}
        for wave in sorted(known, key=str):
            times = int(wave.args[0] / theta)
            value = flight.power(nodes.unit, abs(times))[isinstance(wave, sin)]
            waves[wave] = -value if isinstance(wave, sin) and times < 0 else value
        return [nodes(value, waves) for value in values]

    return {"radius": _program(symbols, radius, "c", "s")}


def _pieces(table: Table, symbols: list[Symbol]) -> dict[str, Program]:
    """One program for each component, if all are straight sides or arcs of ellipses, or if all are cubic; otherwise
    empty.

    For a cubic the outputs are the coefficients of `x` and `y`, for an arc about a focus those of `flight.focal_arc`.
    For the others they are: the coefficients of the point `O + p*A + q*B`, where `(p, q)` is the cosine and sine of the
    parameter on an arc, and the parameter and -1 on a side; the first corner; `A x B`; the radius; and numbers that
    mark the ends.
    """

    def program(numbers: list[Expr]) -> Program:
        return _program(symbols, lambda nodes: [nodes(x) for x in numbers])

    found: list[tuple[str, list[Expr]] | None] = []
    for component in table.components:
        found.append(_piece(component, parameter_box(table)))
        if found[-1] is None:  # then all are cubic, or none counts
            break
    if None in found:
        found = [("cubic", [*c[0], *c[1]]) if c is not None else None for c in map(cubic, table.components)]
    known = [piece for piece in found if piece is not None]
    if len(known) < len(found):
        return {}
    return {f"{kind} {index}": program(numbers) for index, (kind, numbers) in enumerate(known)}


def _polynomial_curve(nodes: Nodes, known: list[list[Expr]]) -> list[Node]:
    """Point, velocity and acceleration of polynomials, by Horner's rule."""
    found = []
    for _ in range(3):
        found += [reduce(lambda value, c: value * nodes(theta) + nodes(c), row[::-1], nodes(0)) for row in known]
        known = [[i * c for i, c in enumerate(row)][1:] for row in known]
    return found


def _piece(component: Component, ranges: Box) -> tuple[str, list[Expr]] | None:
    """A component's kind and its numbers, in the order in which the flight reads them; None for other kinds.

    A circle whose radius may have either sign, over the ranges of the parameters, counts as an ellipse.
    """
    x, y = component.point
    low, high = component.start, component.end
    if any(word.has(theta) for word in x.atoms(*WORDS) | y.atoms(*WORDS)):  # before numbers like exp(-10**6) are needed
        return None
    corner = component.at(low)
    slope = [coordinate.diff(theta) for coordinate in (x, y)]
    if any(d.has(theta) and d.is_polynomial(theta) for d in slope):
        return None
    if not any(d.has(theta) for d in slope):
        return "line", [*component.at(S.Zero), *slope, S.Zero, S.Zero, *corner, S.Zero, S.One, low, high, low, high]
    if sum(map(size, component.point)) > LONG:  # no arc of an ellipse is as long, and nothing longer is multiplied out
        return None
    centre = [c if varies(c) else expand(c) for c in (v + v.diff(theta, 2) for v in (x, y))]
    if any(c.has(theta) for c in centre):
        focal = flight.focal_arc(component, ranges) if max(map(levels, component.point)) <= DEEP else None
        return ("focal", focal) if focal else None
    A = [expand(start - c) for start, c in zip(component.at(S.Zero), centre, strict=True)]
    B = [d.subs(theta, 0) for d in slope]
    square, other = (expand(v[0] ** 2 + v[1] ** 2) for v in (A, B))
    circular = vanishes(square - other) and vanishes(A[0] * B[0] + A[1] * B[1])
    D = expand(A[0] * B[1] - A[1] * B[0])
    middle, half = (low + high) / 2, (high - low) / 2
    marks = [cos(middle), sin(middle), sin(half), cos(half)]
    radius = root(square, ranges) if square.free_symbols else sqrt(square)
    circular = circular and not radius.has(Abs)
    return "circle" if circular else "ellipse", [*centre, *A, *B, *corner, D, radius if circular else S.One, *marks]


def _bound(value: Expr) -> str | None:
    return str(value) if value.is_Rational else None
