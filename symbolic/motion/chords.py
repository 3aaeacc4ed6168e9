"""The collision rule as one equation per bounce, in boundary parameters alone.

With `q` a bounce, `V` the velocity of the boundary there and `N` that velocity turned left (inwards), the chord `d` to
another boundary point makes with the inward normal the angle

    A(q, d) = atan(d.V / d.N),    positive towards the tangent, as the paper's exit angle.

The chord to the next bounce gives the exit angle, `phi = A`, and the chord back to the previous one the incidence
angle, `eta = A`. The law `phi = -lam*eta` is `A(next) + lam*A(previous) = 0`: one equation in three neighbouring
parameters. A cycle of length `n` is a solution of `n` such equations, one for each bounce. For any other law the
equation is `A(next) - phi(A(previous)) = 0`, and its derivatives contain the law's slopes (`law_kernel`).

`A` is the direction of `N` minus the direction of `d`, so each derivative is a difference, `dA = bend(V) - bend(d)`,
where `bend(w) = (w x dw)/(w.w)` is the derivative of the direction of `w`.

Convexity is proved here too, for all shapes in a range. A closed simple boundary is convex where it never turns right.
On a trigonometric boundary the turning `x'y'' - y'x''` is a polynomial in `tan(x/2)`, with `x` the common multiple of
`theta` that it depends on, so its sign over all of the boundary and the whole shape range can be proved.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement

from sympy import Derivative, Expr, Function, Interval, Symbol, atan, cos, diff, oo, sin

from symbolic.expressions.signs import Box, Outcome, SignFinding, conjunction, nonnegative, positive
from symbolic.expressions.text import Kernel, kernel
from symbolic.tables.geometry import in_half_tangent, speed, turning
from symbolic.tables.law import Law
from symbolic.tables.table import Component, Table, eta, lam, s, theta
from symbolic.tables.validity import parameter_box

theta0 = Symbol("theta0", real=True)  # the bounce itself
theta1 = Symbol("theta1", real=True)  # the other end of a chord


@dataclass(frozen=True)
class Staged:
    """Expressions by name, in terms of intermediate values, each of which is defined by earlier ones."""

    arguments: tuple[Symbol, ...]
    definitions: dict[Symbol, Expr]
    values: dict[str, Expr]

    def whole(self, name: str) -> Expr:
        """The expression called `name`, with all intermediate values substituted.

        >>> from symbolic.tables import circle
        >>> chord_angle(circle, order=0).whole("angle").subs({theta0: 0, theta1: 3})
        atan(sin(3)/(1 - cos(3)))
        """
        return self.values[name].subs(list(reversed(self.definitions.items())))


def chord_angle(table: Table, here: int = 0, there: int = 0, order: int = 1) -> Staged:
    """`A`, the angle in radians from the inward normal at `here` to the chord to `there`.

    `here` and `there` are components; `theta0` is the parameter here, `theta1` there. The values are
    `angle` and its partial derivatives up to `order` (at most 2), `angle_0` by `theta0`, `angle_01`
    by `theta0` and `theta1`, `angle_1_alpha` by `theta1` and `alpha`. Shapes are differentiated from order 1 on.

    >>> from symbolic.tables import circle
    >>> list(chord_angle(circle, order=2).values)
    ['angle', 'angle_0', 'angle_1', 'angle_00', 'angle_01', 'angle_11']
    """
    shapes = tuple(p.symbol for p in table.shapes)
    ends = ((table.components[here].point, theta0), (table.components[there].point, theta1))
    placed = [e.subs(theta, by) for point, by in ends for e in point]
    x0, y0, x1, y1, dx, dy = _coordinates(shapes)
    meaning = {**dict(zip((x0, y0, x1, y1), placed, strict=True)), dx: x1 - x0, dy: y1 - y0}
    return _Stage(shapes, meaning).finished((theta0, theta1, *shapes), _derived(shapes, order))


@cache
def _coordinates(shapes: tuple[Symbol, ...]) -> tuple[Expr, ...]:
    """Coordinates of both ends of a chord, then of the chord, as unknown functions of `theta0`, `theta1`, shapes."""
    ends = [Function(axis + end, real=True)(by, *shapes) for end, by in (("0", theta0), ("1", theta1)) for axis in "xy"]
    return (*ends, *(Function("d" + axis, real=True)(theta0, theta1, *shapes) for axis in "xy"))


@cache
def _derived(shapes: tuple[Symbol, ...], order: int) -> dict[str, Expr]:
    """The values of `chord_angle` by name, for any two components, in symbols for the coordinates of their points."""
    x0, y0, _, _, dx, dy = _coordinates(shapes)
    vx, vy = diff(x0, theta0), diff(y0, theta0)
    turned = {p: _bend(vx, vy, p) - _bend(dx, dy, p) for p in (theta0, theta1, *shapes)}
    found: dict[str, Expr] = {}
    for name, by in partials(shapes, order).items():
        if by:
            found[name] = diff(turned[by[0]], *by[1:]) if by[1:] else turned[by[0]]
        else:
            found[name] = atan((dx * vx + dy * vy) / (dy * vx - dx * vy))
    return found


def partials(shapes: tuple[Symbol, ...], order: int) -> dict[str, tuple[Symbol, ...]]:
    """The names of the values of `chord_angle`, in order, each with the variables by which the angle is differentiated.

    >>> list(partials((Symbol("alpha"),), 1))
    ['angle', 'angle_0', 'angle_1', 'angle_alpha']
    """
    if order not in (0, 1, 2):
        raise ValueError(f"chord_angle: order = {order} is not available; it must be 0, 1 or 2")
    parameters = (theta0, theta1, *shapes)
    by = [(), *((p,) for p in parameters)][: None if order else 1]
    if order == 2:
        pairs = combinations_with_replacement(parameters, 2)
        by += [(p, q) for p, q in pairs if p == q or p not in shapes or q not in shapes]
    return {_named(*each): each for each in by}


@cache
def law_kernel(law: Law, order: int = 1, whole: Component | None = None) -> Kernel:
    """The exit angle as a generated function of `(eta, lam, theta, *own)`, with derivatives up to `order`.

    For a law that contains arc length, `whole` is the closed curve: the arguments are then
    `(eta, lam, theta, s, *own)`, and derivatives by `theta` are those along the curve, where `ds/dtheta` is the speed.

    The values are `phi`, then its first derivatives such as `phi_eta`, and for order 2 the second derivatives by `eta`
    or `theta` and any argument, such as `phi_eta_eta`.

    >>> law_kernel(Law("-lam*eta - b*sin(2*eta)")).results
    ('phi', 'phi_eta', 'phi_theta', 'phi_lam', 'phi_b')
    """
    letters, places = (eta, theta, lam, *law.symbols), (theta,) if whole is None else (theta, s)
    length = Function("length", real=True)(theta)
    phi = law.phi if whole is None else law.phi.subs(s, length)
    found = {"phi": phi}
    if order:
        found |= {f"phi_{p}": diff(phi, p) for p in letters}
    if order > 1:
        pairs = combinations_with_replacement(letters, 2)
        found |= {f"phi_{p}_{q}": diff(phi, p, q) for p, q in pairs if p in (eta, theta)}
    if whole is not None:
        rate = speed(whole)
        known = {length: s, diff(length, theta): rate, diff(length, theta, 2): diff(rate, theta)}
        found = {name: value.xreplace(known) for name, value in found.items()}
    return kernel(f"law_{order}", (eta, lam, *places, *law.symbols), found, about=f"The law phi = {law}.")


@cache
def ends_kernel(table: Table) -> Kernel:
    """Start and end of the parameter of every component, one after the other, as a generated function of `(*shape)`.

    >>> from symbolic.tables import cuspless
    >>> ends_kernel(cuspless).results
    ('start0', 'end0', 'start1', 'end1')
    """
    found: dict[str, Expr] = {}
    for index, component in enumerate(table.components):
        found |= {f"start{index}": component.start, f"end{index}": component.end}
    return kernel("ends", [p.symbol for p in table.shapes], found)


@cache
def chord_kernel(table: Table, here: int = 0, there: int = 0, order: int = 1) -> Kernel:
    """The values of `chord_angle` as a generated function of `(theta0, theta1, *shape)`."""
    staged = chord_angle(table, here, there, order)
    ends = f"{table.components[here].name} to {table.components[there].name}"
    about = f"Angle from the inward normal to the chord, {ends}, with derivatives to order {order}."
    name = f"chord_angle_{here}_{there}_{order}"
    return kernel(name, staged.arguments, staged.values, staged.definitions, about)


@cache
def polygon_kernel(table: Table, corners: int, order: int = 1) -> Kernel:
    """The values of `chord_angle` for all sides of a polygon, as a generated function of the parameters at its corners.

    The results are the values of `chord_angle` from all corners to the next one, then from all corners to the one
    before. A value that depends on one corner only is computed once. The table has one component and no free shape
    parameter.

    >>> from symbolic.tables import circle
    >>> polygon_kernel(circle, 3, 0).results
    ('angle_from0to1', 'angle_from1to2', 'angle_from2to0', 'angle_from0to2', 'angle_from1to0', 'angle_from2to1')
    """
    staged, at = chord_angle(table, order=order), [Symbol(f"theta{i}", real=True) for i in range(corners)]
    definitions: dict[Symbol, Expr] = {}
    values: dict[str, Expr] = {}
    for here, there in [(i, (i + step) % corners) for step in (1, -1) for i in range(corners)]:
        side, own = f"from{here}to{there}", {theta0: at[here], theta1: at[there]}
        for symbol in staged.definitions:
            axis, end, rest = symbol.name[0], symbol.name[1], symbol.name[2:]  # x0_t, or dx of the chord
            named = f"{axis}{(here, there)[int(end)]}{rest}" if end.isdigit() else f"{symbol.name}_{side}"
            own[symbol] = Symbol(named, real=True)
        definitions |= {own[symbol]: e.xreplace(own) for symbol, e in staged.definitions.items()}
        values |= {f"{name}_{side}": e.xreplace(own) for name, e in staged.values.items()}
    about = f"Angles from the inward normals to the sides at {corners} corners, with derivatives to order {order}."
    return kernel(f"polygon_{corners}_{order}", at, values, definitions, about)


@cache
def polar_polygon_kernel(table: Table, corners: int) -> Kernel:
    """The angles of `polygon_kernel`, no derivatives, on one polar curve; the gaps between corners are arguments too.

    The arguments are the parameters at the corners, then the gaps: how much they grow from each corner to the next one,
    and from the last to the first. Let `q` be the ratio of the radii at both ends of a chord. The chord makes the angle
    `atan(sin(gap)/(q - cos(gap)))` with the ray to the origin, and the normal makes the angle `atan(rho'/rho)`. As gaps
    are arguments of their own, their width in ball arithmetic does not grow with the uncertainty of both corners. The
    first results are the angles, which are valid where the last results, `q - cos(gap)`, are positive. `ValueError` for
    other tables.

    >>> from symbolic.tables import circle
    >>> polar_polygon_kernel(circle, 3).results[5:7]
    ('angle_from2to1', 'ahead_from0to1')
    """
    radius = table.components[0].radius
    if len(table.components) > 1 or radius is None:
        raise ValueError(f"polar_polygon_kernel: {table.name} is not a single polar curve; accepted: tables rho(theta)")
    at = [Symbol(f"theta{i}", real=True) for i in range(corners)]
    gaps = [Symbol(f"gap{i}", real=True) for i in range(corners)]
    rho, tilt = ([Symbol(f"{name}{i}", real=True) for i in range(corners)] for name in ("rho", "tilt"))
    definitions = {r: radius.subs(theta, place) for r, place in zip(rho, at, strict=True)}
    turned = atan(diff(radius, theta) / radius)
    definitions |= {r: turned.subs(theta, place) for r, place in zip(tilt, at, strict=True)}
    values, ahead = {}, {}
    for step in (1, -1):
        for here in range(corners):
            there = (here + step) % corners
            gap = gaps[here] if step == 1 else -gaps[there]
            side = ahead[f"ahead_from{here}to{there}"] = rho[here] / rho[there] - cos(gap)
            values[f"angle_from{here}to{there}"] = atan(sin(gap) / side) - tilt[here]
    about = f"Angles from the inward normals to the sides at {corners} corners, from the gaps between these."
    return kernel(f"polar_polygon_{corners}", [*at, *gaps], values | ahead, definitions, about)


class _Stage:
    """Formulas in undetermined coordinates of a chord, where named values replace the derivatives of coordinates."""

    def __init__(self, shapes: tuple[Symbol, ...], meaning: dict[Expr, Expr]) -> None:
        self.shapes, self.meaning = shapes, meaning
        self.known: dict[Expr, Expr] = {}  # the name or number that replaces a derivative or a coordinate

    def finished(self, arguments: tuple[Symbol, ...], found: dict[str, Expr]) -> Staged:
        """The values with derivatives of coordinates replaced by names, and definitions of those names."""
        definitions: dict[Symbol, Expr] = {}
        values = {name: self._named_parts(e, definitions) for name, e in found.items()}
        return Staged(arguments, definitions, values)

    def _named_parts(self, e: Expr, definitions: dict[Symbol, Expr]) -> Expr:
        derivatives = sorted(e.atoms(Derivative), key=lambda d: (-d.derivative_count, str(d)))
        e = e.xreplace({d: self._known(d, d.expr, d.variables, definitions) for d in derivatives})
        functions = sorted((f for f in self.meaning if e.has(f)), key=str)
        return e.xreplace({f: self._known(f, f, (), definitions) for f in functions})

    def _known(self, whole: Expr, f: Expr, variables: Sequence[Symbol], definitions: dict[Symbol, Expr]) -> Expr:
        if whole not in self.known:
            self.known[whole] = self._value(f, variables, definitions)
        return self.known[whole]

    def _value(self, f: Expr, variables: Sequence[Symbol], definitions: dict[Symbol, Expr]) -> Expr:
        expression = self.meaning[f].diff(*variables) if variables else self.meaning[f]
        expression = self._named_parts(expression, definitions)
        if expression.is_number or expression.is_Symbol:
            return expression
        turns = "t" * sum(v in (theta0, theta1) for v in variables)
        parts = [f.func.__name__, turns, *(v.name for v in variables if v in self.shapes)]
        symbol = Symbol("_".join(part for part in parts if part), real=True)
        if f.func.__name__.startswith("d"):
            if variables:
                return expression
            definitions[symbol] = expression
            return symbol
        definitions.setdefault(symbol, expression)
        return symbol


def _bend(x: Expr, y: Expr, p: Symbol) -> Expr:
    """The derivative by `p` of the direction of `(x, y)`."""
    return (x * diff(y, p) - y * diff(x, p)) / (x**2 + y**2)


def _named(*parameters: Symbol) -> str:
    tail = "".join({theta0: "0", theta1: "1"}.get(p, f"_{p}") for p in parameters)
    return f"angle_{tail.removeprefix('_')}" if parameters else "angle"


def convexity(table: Table, box: Box | None = None, strictly: bool = False) -> SignFinding:
    """Is the table convex for every shape in `box` (by default its own range, ends included)?

    `strictly` asks for negative curvature everywhere. For a piecewise table each component is examined on its whole
    period, which is sufficient but not necessary.

    >>> from symbolic.tables import egg
    >>> convexity(egg(3)).outcome.name, convexity(egg(3), strictly=True).outcome.name
    ('PROVED', 'REFUTED')
    """
    ranges = dict(box or parameter_box(table))
    return conjunction(*(_turns_left(turning(component), ranges, strictly) for component in table.components))


def _turns_left(expression: Expr, box: Box, strictly: bool) -> SignFinding:
    judge = positive if strictly else nonnegative
    if not expression.has(theta):
        return judge(expression, {x: r for x, r in box.items() if x in expression.free_symbols})
    half = in_half_tangent(expression)
    if half is None:
        return SignFinding(Outcome.UNKNOWN, f"{expression} is no trigonometric polynomial")
    polynomial, T, at_pi = half
    used = {x: r for x, r in box.items() if x in polynomial.free_symbols}
    far = judge(at_pi, {x: r for x, r in box.items() if x in at_pi.free_symbols})
    sides = [judge(polynomial.subs(T, sign * T), {**used, T: Interval(0, oo)}) for sign in (1, -1)]
    return conjunction(*sides, far)
