"""Functions that derive a result from a table: curvature, lengths, derivative, double normals, thresholds, code.

A table argument is one of `symbolic.tables`, a scene, or the name of one of the paper's tables. Results are exact, in
the symbolic parameters of the table, and `lam` for the contraction.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from inspect import Parameter, Signature
from itertools import pairwise
from typing import Any, TypeAlias

from sympy import (
    Abs,
    And,
    Basic,
    CRootOf,
    Expr,
    Integral,
    Interval,
    Matrix,
    N,
    Piecewise,
    Poly,
    Rational,
    Rel,
    S,
    Symbol,
    cos,
    elliptic_e,
    fraction,
    pi,
    roots,
    simplify,
    sin,
    sqrt,
    together,
)
from sympy.solvers.inequalities import solve_rational_inequalities

from symbolic.cycles import cycle as cycles
from symbolic.cycles.cycle import Cycle, given_cycle, shortened, trace_and_determinant
from symbolic.cycles.thresholds import flip_contraction, focus_contraction, stability_number
from symbolic.expressions.signs import nonnegative, positive, vanishes
from symbolic.expressions.text import Kernel, checked, constant, kernel, load
from symbolic.motion import collision
from symbolic.tables import geometry, named
from symbolic.tables.curves import LONG, curves, is_periodic, size
from symbolic.tables.definition import POINTS, exact
from symbolic.tables.scene import Scene, given_table
from symbolic.tables.table import Component, Table, exact_number, theta
from symbolic.tables.validity import enclosed_area, parameter_box, root

Bounce: TypeAlias = tuple[int, Expr]  # a component's index and a parameter
Tabled: TypeAlias = Table | Scene | str  # or a map of `numeric`, which has a scene
theta0, theta1 = Symbol("theta0", real=True), Symbol("theta1", real=True)  # boundary parameters of a flight's ends
SMALL = 80  # largest size, in operations, names and numbers, of an expression that is simplified
ARITHMETICS = {  # module and function of each number system, imported at its first use
    "numpy": ("numeric.backends.scalars", "array_arithmetic"),
    "mpmath": ("verification.arithmetic.balls", "mpmath_arithmetic"),
    "arb": ("verification.arithmetic.balls", "ball_arithmetic"),
}


def table_of(given: Tabled) -> Table:
    """The exact table of a scene with its numbers, a map, or a name of the paper; a table is returned unchanged."""
    held = given if isinstance(given, str) else getattr(given, "table", given)  # a scene and a map have a table
    table, _ = given_table(held, POINTS, {})
    return named(table) if isinstance(table, str) else table


def _each(given: Tabled | Component, derive: Callable[[Component], Expr]) -> Any:
    """The result of `derive` for a component, or for the only one of a table; for several a dict of results by name."""
    if isinstance(given, Component):
        return derive(given)
    parts = table_of(given).components
    return derive(parts[0]) if len(parts) == 1 else {part.name: derive(part) for part in parts}


def curvature(table: Tabled | Component) -> Any:
    """The signed curvature, in 1/length, negative where the boundary focuses; a dict by name for several components.

    Paper: section 2 (sign convention) and eq. (curvature-polar). Textbooks use the opposite sign.

    >>> from symbolic import curvature
    >>> from symbolic.tables.table import theta
    >>> curvature("cardioid").subs(theta, 0), curvature("cuspless")["wall"]
    (-3/4, 0)
    >>> curvature("cardioid")
    -3*sqrt(2)/(4*sqrt(cos(theta) + 1))
    """

    def derived(component: Component) -> Expr:
        found = geometry.curvature(component)
        return found if size(found) > LONG else min(found, found.factor(deep=True), key=lambda form: len(str(form)))

    return _each(table, derived)


def arc_length(table: Tabled | Component) -> Any:
    """Arc length from the start of the component to `theta`, in units of length; a dict by name for several components.

    It has a closed form, elementary or elliptic, where the squared speed is `p + q*cos(n*theta)`, and is an unevaluated
    integral elsewhere. SymPy integrates that with `.subs(theta, 1).evalf(30)`; in float64,
    `numeric.PinballMap(table, ...).arclength` has `s(theta)`, from the paper's origin, and `perimeter`.

    >>> arc_length("circle")
    theta + pi
    >>> from symbolic import alpha
    >>> arc_length("egg").subs({theta: 0, alpha: "1/10"}).evalf(20)
    3.2112946665255501811
    """

    def derive(part: Component) -> Expr:
        length = geometry.arc_length(part)
        if isinstance(length, Integral):  # nothing to simplify, and SymPy would try for minutes
            return Integral(length.function, (length.variables[0], part.start, theta))
        return simplify(length - length.subs(theta, part.start))

    return _each(table, derive)


def perimeter(table: Tabled) -> Expr:
    """The length of the whole boundary; see `arc_length` for numbers if it is an unevaluated integral.

    >>> perimeter("cardioid"), perimeter(named("egg").at(alpha="1/10")).evalf(20)
    (8, 6.4225893330511003622)
    """
    return geometry.perimeter(table_of(table))


def area(table: Tabled) -> Expr:
    """The enclosed area, by Green's formula; `ValueError` where no closed form is found.

    >>> area("cardioid")
    3*pi/2
    """
    found = enclosed_area(table_of(table))
    if found is None:
        raise ValueError(f"{table_of(table).name}: no closed form of the area is found")
    return found


def derivative_matrix(table: Tabled | None = None, *components: int, **values: Expr | int | str) -> Matrix:
    """`d(s1, phi1)/d(s0, phi0)` of one flight and one reflection. Paper: eq. (derivative_of_map).

    Without a table: in the paper's letters `K0, K1, t, cos_phi0, cos_eta1, lam`, each of which may be given a value.
    With a table: along the chord from `theta0` to `theta1`; `components` are the indices of the components on which
    these lie, by default 0 for both. `lam` stands for the slope of the reflection law at the landing, with the opposite
    sign. Values are exact numbers, such as `lam="1/2"`, or expressions; a float is refused.

    >>> derivative_matrix().det().simplify()
    cos_phi0*lam/cos_eta1
    >>> derivative_matrix("circle").subs({theta0: 0, theta1: pi})
    Matrix([
    [1,  -2],
    [0, lam]])
    """
    values = {name: exact_number(name, value) for name, value in values.items()}
    if table is None:
        return collision.derivative_matrix(**values)
    parts = table_of(table).components
    if len(components) not in (0, 2) or any(index not in range(len(parts)) for index in components):
        last = len(parts) - 1
        raise ValueError(f"derivative_matrix: components {components}; accepted: two indices from 0 to {last}, or none")
    here, there = components or (0, 0)
    ends = [(parts[index], parameter) for index, parameter in ((here, theta0), (there, theta1))]
    points, tangents = (
        [
            Matrix([x.subs(theta, at) for x in (part.point if not order else geometry.velocity(part))])
            for part, at in ends
        ]
        for order in (0, 1)
    )
    chord = points[1] - points[0]
    t = sqrt(_short(chord.dot(chord)))
    across = [tangent[0] * chord[1] - tangent[1] * chord[0] for tangent in tangents]  # chord times inward normal
    speeds = [geometry.speed(part).subs(theta, at) for part, at in ends]
    given = {
        "K0": geometry.curvature(ends[0][0]).subs(theta, theta0),
        "K1": geometry.curvature(ends[1][0]).subs(theta, theta1),
        "t": t,
        "cos_phi0": _short(across[0]) / (speeds[0] * t),
        "cos_eta1": -_short(across[1]) / (speeds[1] * t),
    }
    return collision.derivative_matrix(**{**given, **values})


def _short(expression: Expr) -> Expr:
    """The expression, simplified if it is short enough for that to be fast."""
    return simplify(expression) if size(expression) <= SMALL else expression


@dataclass(frozen=True, repr=False)
class SlapMap:
    """The map at `lam = 0`, where each flight leaves along the normal: `residual = 0` says where it lands.

    `residual` is a length times a speed, in `theta0` and `theta1`; it vanishes for `theta1 = theta0` too. `derivative`
    is `ds1/ds0` along the flight. Paper: section 2.2.
    """

    table: Table
    residual: Expr
    derivative: Expr

    def __repr__(self) -> str:
        letters = sorted(map(str, self.residual.free_symbols | self.derivative.free_symbols))
        return f"SlapMap({self.table.name}: residual and derivative in {', '.join(letters)})"

    def _repr_latex_(self) -> str:
        from symbolic.tables.formula import latex

        return rf"$\displaystyle {latex(self.residual)} = 0, \quad \frac{{ds_1}}{{ds_0}} = {latex(self.derivative)}$"


def slap_map(table: Tabled, *components: int) -> SlapMap:
    """The slap map, the one-dimensional map that remains at `lam = 0`, from one component to another.

    >>> slap = slap_map("circle")
    >>> slap.residual.subs(theta1, theta0 + pi), slap.derivative.subs(theta1, theta0 + pi).simplify()
    (0, 1)
    """
    parts, (here, there) = table_of(table).components, components or (0, 0)
    start, tangent = parts[here].point, geometry.velocity(parts[here])
    chord = [y.subs(theta, theta1) - x.subs(theta, theta0) for x, y in zip(start, parts[there].point, strict=True)]
    residual = sum((v.subs(theta, theta0) * d for v, d in zip(tangent, chord, strict=True)), S.Zero)
    matrix = derivative_matrix(table, here, there, lam=S.Zero, cos_phi0=S.One)
    return SlapMap(table_of(table), _short(residual), _short(matrix[0, 0]))


def double_normals(table: Tabled) -> tuple[Cycle, ...]:
    """The cycles of period 2 along the axes of symmetry, one of each kind, the longest chord first.

    Such a chord is normal to the boundary at both ends, so it is a cycle for every contraction. Axes that a symmetry
    of the table takes into one another are one kind. `ValueError` where the table has no proved axis.

    >>> [cycle.name for cycle in double_normals("ellipse")]
    ['axis at 0', 'axis at pi/2']
    """
    whole = table_of(table)
    found: list[Cycle] = []
    for symmetry in geometry.group(whole):
        if symmetry.sign > 0:
            continue
        for bounces in _chords(whole, symmetry):
            cycle = Cycle(f"axis at {symmetry.angle / 2}", whole, bounces)
            if cycles.is_double_normal(cycle) and not any(_alike(cycle, other) for other in found):
                found.append(cycle)
    if not found:
        raise ValueError(
            f"{whole.name}: no axis of symmetry is proved to have a chord along it; accepted: tables with such an axis"
        )
    middle = _middle(whole)
    return tuple(sorted(found, key=lambda cycle: -cycle.length(0).subs(middle).evalf()))


def _middle(table: Table) -> dict[Symbol, Expr]:
    """A value inside the range of each free parameter."""
    ranges = {p.symbol: (p.range.start, p.range.end) for p in table.shapes}
    return {x: (low + (high if high.is_finite else low + 2)) / 2 for x, (low, high) in ranges.items()}


def _chords(table: Table, symmetry: geometry.Symmetry) -> Iterator[tuple[Bounce, ...]]:
    """The chords along the axis of a reflection whose two ends are neither cusps nor corners.

    A closed curve that is its own mirror image meets the axis in two points, and other curves do not meet it. So the
    parts of the axis between these points lie in the table, in a hole, in the table, and so on.
    """
    smooth = _on_axis(table, symmetry)
    if len(curves(table)) == 1:
        yield from [tuple(smooth)] if len(smooth) == 2 else []
        return
    c, s, middle = cos(symmetry.angle / 2), sin(symmetry.angle / 2), _middle(table)
    starts = [(index, part.start, part.at(part.start)) for index, part in enumerate(table.components)]
    corners = [(index, at) for index, at, (x, y) in starts if vanishes(x * s - y * c) and (index, at) not in smooth]

    def along(bounce: Bounce) -> Expr:
        x, y = table.components[bounce[0]].at(bounce[1])
        return (x * c + y * s).subs(middle).evalf()

    ends = sorted({along(bounce): bounce for bounce in (*corners, *smooth)}.items())
    for (_, one), (_, other) in zip(ends[::2], ends[1::2], strict=False):
        if one in smooth and other in smooth:
            yield one, other


def _on_axis(table: Table, symmetry: geometry.Symmetry) -> list[Bounce]:
    """The boundary points on the axis of a reflection, as (component, parameter), without cusps and corners."""
    marked = {(mark.component, mark.theta) for mark in table.undefined}
    found = []
    alone = [ring[0] for ring in curves(table) if len(ring) == 1 and all(map(is_periodic, ring[0].point))]
    for index, (part, onto, shift) in enumerate(zip(table.components, symmetry.onto, symmetry.shift, strict=True)):
        whole = part.end - part.start == 2 * pi and part in alone
        for at in (shift / 2, shift / 2 + pi) if whole else (shift / 2,):
            at = at - 2 * pi if whole and at > pi else at
            inside = whole or (positive(at - part.start, {}) and positive(part.end - at, {}))
            bent = any(vanishes(x.args[0].subs(theta, at)) for x in Matrix(part.point).atoms(Abs))
            if onto == index and inside and not bent and not {(index, at), (index, at - 2 * pi)} & marked:
                found.append((index, at))
    return found


def _alike(one: Cycle, other: Cycle) -> bool:
    """Have two chords the same length and the same curvatures at their ends?"""
    ends = [sorted((frame.curvature for frame in cycle.frames), key=str) for cycle in (one, other)]
    return vanishes(one.length(0) - other.length(0)) and all(vanishes(p - q) for p, q in zip(*ends, strict=True))


def multipliers(cycle: Cycle) -> tuple[Expr, Expr]:
    """`(mu_plus, mu_minus)`, the eigenvalues of the monodromy matrix, in `lam` and the parameters of the table.

    >>> from symbolic.cycles.cycle import minor_axis
    >>> from symbolic.tables.table import a, lam
    >>> [mu.subs({a: 2, lam: 0}).simplify() for mu in multipliers(minor_axis())]
    [1/4, 0]
    """
    return cycles.multipliers(*trace_and_determinant(given_cycle("multipliers", cycle)))


def thresholds(cycle: Cycle) -> dict[str, Expr | None]:
    """The contractions at which a cycle of period 2 along a double normal doubles its period and becomes a focus.

    At `flip` a multiplier is -1; the cycle is stable below. Above `focus` the multipliers are complex. A value is None
    if no such contraction exists in [0, 1] for any shape in the range; if it exists for some shapes only, it is a
    formula with its condition, a SymPy `Piecewise`, whose value is `nan` for the other shapes. The condition bounds the
    parameter if there is one, and else the stability number `P`. `ValueError` for other cycles.

    >>> thresholds(double_normals("cuspless")[0])
    {'flip': (1 - sqrt(11)/4)/(sqrt(11)/4 + 1), 'focus': None}
    >>> thresholds(double_normals("egg")[0])["focus"]
    Piecewise(((alpha**2 + 18*alpha - 1)/(alpha**2 - 18*alpha - 1), alpha <= -9 + sqrt(82)))
    """
    if len(given_cycle("thresholds", cycle).bounces) != 2 or not cycles.is_double_normal(cycle):
        raise ValueError(f"{cycle.name}: thresholds are known of cycles of period 2 that are normal at both ends")
    P = stability_number(cycle)
    box = {letter: range for letter, range in parameter_box(cycle.table).items() if letter in P.free_symbols}
    if P.is_number:
        return {"flip": flip_contraction(P), "focus": focus_contraction(P)}
    return {"flip": _threshold(-P, -P, P + 1, box, ">"), "focus": _threshold(1 - P, P, 1 - P, box, ">=")}


def _threshold(square: Expr, one: Expr, other: Expr, box: dict[Symbol, Interval], sign: str) -> Expr | None:
    """`(1 - r)/(1 + r)`, `r = sqrt(square)`, if `one` has the `sign` to 0 and `other >= 0`; None if it never holds."""
    inside = {letter: Interval.open(range.start, range.end) for letter, range in box.items()}
    if any(nonnegative(-gap, inside) for gap in (one, other)):
        return None
    above, below = root(square, box).as_numer_denom()
    value = plain = (below - above) / (below + above)
    if (shorter := shortened(plain)) != plain:
        divisor = shorter.as_numer_denom()[1]  # where it vanishes, the shorter form may be 0/0
        value = shorter if divisor.is_number or positive(divisor, box) or positive(-divisor, box) else plain
    held = all(nonnegative(gap, inside) for gap in (one, other))
    return value if held else Piecewise((value, _condition({one: sign, other: ">="}, box)))


def _condition(gaps: dict[Expr, str], box: dict[Symbol, Interval]) -> Basic:
    """The condition that each gap has its sign to 0: as bounds of the letter, if they are rational functions of one."""
    if len(box) != 1 or not all(gap.free_symbols <= set(box) and gap.is_rational_function() for gap in gaps):
        return And(*(Rel(gap, 0, sign) for gap, sign in gaps.items()))
    ((letter, range),) = box.items()
    parts = [(tuple(Poly(part, letter) for part in fraction(together(gap))), sign) for gap, sign in gaps.items()]
    where = solve_rational_inequalities([parts]).intersect(range).as_relational(letter)
    return where.replace(CRootOf, lambda *root: _in_square_roots(CRootOf(*root)))


def _in_square_roots(root: Expr) -> Expr:
    """A root of a polynomial `a*x**4 + b*x**2 + c` with square roots; others as they are."""
    coefficients = root.poly.all_coeffs()
    if len(coefficients) != 5 or coefficients[1] or coefficients[3]:
        return root
    return next(x for x in roots(root.poly) if abs(N(x - root, 30)) < Rational(1, 10**20))


@lru_cache(maxsize=64)
def _kernel(letters: tuple[Symbol, ...], names: tuple[str, ...], entries: tuple[Expr, ...]) -> Kernel:
    """The generated function that returns `entries`, the same for every arithmetic and every number of digits."""
    for entry in entries:
        if entry.has(Integral, elliptic_e):
            raise ValueError(
                "generate: an expression with an integral or an elliptic function has no code; for its value use "
                "expression.subs(letter, number).evalf(digits), or numeric.PinballMap(table, ...).arclength in float64"
            )
        checked("generate", entry, set(letters))
    return kernel("value", letters, dict(zip(names, entries, strict=True)))


def generate(expression: Expr | Matrix, arithmetic: str = "numpy", digits: int = 50) -> Any:
    """The code of an expression or a matrix, for arrays, for mpmath numbers, for balls, or as text.

    The function takes the free symbols, by position or by name: `theta`, `theta0`, `theta1` come first, then the others
    in alphabetical order. `arithmetic` is `"numpy"`, `"mpmath"` or `"arb"` (with `digits`), or `"text"`, which returns
    the source in the closed vocabulary of `symbolic.expressions.text`; a rational is written `q(1, 3)` there and never
    rounded.

    An argument is text such as `"0.1"`, an integer, a fraction, or an exact number of SymPy. A float stands for the
    double that it is, which is not the decimal that it shows: 30 digits of `f(0.1)` are not those of `f("0.1")`.

    >>> from sympy import cos
    >>> from symbolic.tables.table import alpha
    >>> print(generate(alpha * cos(theta) / 3, "text"))
    def value(theta, alpha):
        value = q(1, 3)*alpha*cos(theta)
        return (value,)
    <BLANKLINE>
    >>> f = generate(cos(theta) / 3, "arb", digits=20)
    >>> print(f(0).str(20))
    [0.33333333333333333333 +/- 3.34e-21]
    >>> f = generate(alpha, "arb", digits=20)
    >>> f("0.1").str(20, radius=False), f(0.1).str(20, radius=False)
    ('0.10000000000000000000', '0.10000000000000000555')
    """
    entries = list(expression) if isinstance(expression, Matrix) else [S(expression)]
    letters = sorted(
        {x for entry in entries for x in entry.free_symbols}, key=lambda x: (x not in (theta, theta0, theta1), str(x))
    )
    names = ["value"] if len(entries) == 1 else [f"value{i}" for i in range(len(entries))]
    for one, other in pairwise(letters):
        if str(one) == str(other):
            raise ValueError(
                f"generate: two different symbols are called {one}; use one throughout, such as symbolic.{one}"
            )
    called = Signature([Parameter(str(letter), Parameter.POSITIONAL_OR_KEYWORD) for letter in letters])
    made = _kernel(tuple(letters), tuple(names), tuple(entries))
    if arithmetic == "text":
        return made.text
    if arithmetic not in ARITHMETICS:
        raise ValueError(f"generate: {arithmetic!r} is no arithmetic; accepted: text, {', '.join(ARITHMETICS)}")
    module, name = ARITHMETICS[arithmetic]
    system, run = getattr(import_module(module), name)(digits)
    function = load(made, system)

    def number(letter: str, given: Any) -> Any:
        """Text and numbers of SymPy in this arithmetic; other arguments as they are."""
        if not isinstance(given, str | Basic):
            return given
        return run(load(constant(S(exact(letter, given))), system), [], None)

    def value(*arguments: Any, **named_arguments: Any) -> Any:
        try:
            given = called.bind(*arguments, **named_arguments).arguments
        except TypeError as why:
            accepted = ", ".join(called.parameters) or "none"
            raise TypeError(f"generated function: {why}; its arguments are: {accepted}") from None
        return run(function, [number(*each) for each in given.items()], getattr(expression, "shape", None))

    value.__dict__["__signature__"] = called
    value.__doc__ = f"Arguments: {', '.join(map(str, letters))}.\n\n{made.text}"
    return value
