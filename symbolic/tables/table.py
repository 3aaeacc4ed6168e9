"""Tables and their parts: smooth components in a closed, simple, counterclockwise chain.

A table is written down once, as exact expressions in the boundary parameter `theta`; everything else in the package is
derived from it. Paper: section 2, the definition of `Gamma`.

The symbols are the paper's letters, each with the assumptions that the paper makes. For SymPy two symbols of the same
name and different assumptions are different, so everything in the package takes its symbols from here.
"""

from dataclasses import dataclass, replace

from sympy import Expr, Float, Interval, Rational, S, Symbol, cos, pi, sin
from sympy import sympify as exact  # converts Python numbers; never called on text

from symbolic.expressions.signs import interval_text
from symbolic.tables.definition import no_parameter


class Letter(Symbol):  # type: ignore[misc]  # SymPy has no types
    """A symbol whose LaTeX is the paper's letter."""

    def _latex(self, printer: object) -> str:
        return SHOWN[self.name]


Letter.__name__ = "Symbol"  # SymPy sorts by the name of the class: so letters are sorted among other symbols

SHOWN: dict[str, str] = {
    "lam": r"\lambda",
    "phi": r"\varphi",
    "cos_phi0": r"\cos \varphi_{0}",
    "cos_eta1": r"\cos \eta_{1}",
}

SHOWN_UP_TO = 90  # characters of the formulas in the representation of a table

theta = Symbol("theta", real=True)  # boundary parameter; the polar angle for polar tables
s = Symbol("s", real=True)  # arc length, counterclockwise
phi = Letter("phi", real=True)  # exit angle from the inward normal, positive towards the tangent
eta = Symbol("eta", real=True)  # incidence angle; the elastic law is phi = -eta
lam = Letter("lam", nonnegative=True)  # contraction of the angle, lambda in the paper
t = Symbol("t", positive=True)  # length of a flight

a = Symbol("a", positive=True)  # half the major axis of the ellipse
alpha = Symbol("alpha", nonnegative=True)  # shape of the egg

K0 = Symbol("K0", real=True)  # curvature where a flight leaves, negative when focusing
K1 = Symbol("K1", real=True)  # curvature where it lands
cos_phi0 = Letter("cos_phi0", positive=True)  # cosine of the exit angle where a flight leaves
cos_eta1 = Letter("cos_eta1", positive=True)  # cosine of the incidence angle where it lands


Pair = tuple[Expr, Expr]


@dataclass(frozen=True)
class Component:
    """A smooth part of the boundary: the points `(x, y)` for `start <= theta <= end`.

    The interior lies to the left as `theta` grows, so the inward normal is the tangent turned by
    a quarter turn counterclockwise.
    """

    name: str
    point: Pair
    start: Expr
    end: Expr

    def at(self, value: Expr) -> Pair:
        """The point at parameter `value`, exactly."""
        x, y = self.point
        return x.subs(theta, value), y.subs(theta, value)

    @property
    def radius(self) -> Expr | None:
        """`rho` of a component that is written as `rho*(cos(theta), sin(theta))`; None for any other component.

        >>> from symbolic.tables import cardioid, cuspless
        >>> cardioid.components[0].radius, cuspless.component("wall").radius
        (cos(theta) + 1, None)
        """
        x, y = self.point
        rho = x / cos(theta)
        return rho if rho * sin(theta) == y else None


@dataclass(frozen=True)
class Shape:
    """A shape parameter, the closed range in which the boundary bounds a table, and the message for other values."""

    symbol: Symbol
    range: Interval
    otherwise: str


@dataclass(frozen=True)
class Mark:
    """A boundary point where the map is undefined, with the name of the outcome of a flight to it (`cusp`)."""

    name: str
    component: int
    theta: Expr


@dataclass(frozen=True)
class Fit:
    """The points that a boundary was fitted to, the method, and estimates of its distance from the measured body.

    The boundary itself is exact. `residual` is the largest distance of a given point from the boundary's point at the
    same parameter, rounded up. `between` is the largest distance of the remaining points from a fit to every second
    one, an estimate of the error between points (None if there are too few); `uncertainty` is the given error of the
    points themselves.
    """

    points: tuple[Pair, ...]
    smoothness: int | None
    degree: int | None
    by: str
    uncertainty: Expr
    residual: Expr
    between: Expr | None

    @property
    def error(self) -> Expr:
        """The error bar, a length: `uncertainty` plus the larger of `residual` and `between`."""
        return self.uncertainty + max(self.residual, self.between or S.Zero)


@dataclass(frozen=True, repr=False)
class Table:
    """A billiard table, exact: `shapes` are its free shape parameters, `fixed` the values of the others, by name.

    `origin` is the place from which the paper counts arc length: a component's index and a parameter on it;
    `s` grows counterclockwise, which is the direction of `theta`.

    >>> from symbolic.tables import polar, stadium
    >>> polar("1 + b*cos(2*theta)", b="0:1/5"), stadium()
    (polar('b*cos(2*theta) + 1', b='0:1/5'), Table('stadium', 4 components))
    """

    name: str
    components: tuple[Component, ...]
    shapes: tuple[Shape, ...] = ()
    undefined: tuple[Mark, ...] = ()
    origin: tuple[int, Expr] = (0, S.Zero)
    fixed: tuple[tuple[str, Expr], ...] = ()
    fit: Fit | None = None

    def at(self, **shape: Expr | int | str) -> "Table":
        """The same table with numbers (or symbols) for its shape parameters.

        >>> from symbolic.tables import ellipse
        >>> ellipse.at(a=2).components[0].point
        (2*cos(theta), sin(theta))
        """
        known = {parameter.symbol.name: parameter for parameter in self.shapes}
        values: dict[Symbol, Expr] = {}
        for name, given in shape.items():
            if name not in known:
                raise no_parameter(self.name, name, sorted(known))
            value = exact_number(f"{self.name}: {name}", given)
            if value.has(theta):
                raise ValueError(f"{self.name}: {name} = {value} depends on theta; a shape parameter is one number")
            if value.is_number and known[name].range.contains(value) == S.false:
                raise ValueError(
                    f"{self.name}: {name} = {value} {known[name].otherwise}; "
                    f"{name} must lie in {interval_text(known[name].range)}"
                )
            values[known[name].symbol] = value
        table = replace(
            self,
            components=tuple(_substituted(component, values) for component in self.components),
            shapes=tuple(p for p in self.shapes if p.symbol not in values),
            fixed=self.fixed + tuple((symbol.name, value) for symbol, value in values.items()),
        )
        if not table.shapes:
            from symbolic.tables.validity import simple  # imports this module

            simple(table)
        return table

    def component(self, name: str) -> Component:
        """The component called `name`."""
        for component in self.components:
            if component.name == name:
                return component
        names = ", ".join(component.name for component in self.components)
        raise ValueError(f"{self.name}: no component {name}; it has: {names}")

    def __repr__(self) -> str:
        """What was given, where it fits on a line; otherwise the name and what the boundary consists of."""
        first, count = self.components[0], len(self.components)
        rho = first.radius
        call, formulas = ("parametric", first.point) if rho is None else ("polar", (rho,))
        said = [repr(str(formula)) for formula in formulas] + [f"name={self.name!r}"] * (self.name != call)
        if self.fit is not None:
            call, said = "Table", [repr(self.name), f"{len(self.fit.points)} points"]
        elif count > 1 or self.undefined or (first.start, first.end) != (-pi, pi) or len("".join(said)) > SHOWN_UP_TO:
            call, said = "Table", [repr(self.name), f"{count} component{'s' * (count > 1)}"]
        said += [f"{each.symbol}='{each.range.start}:{each.range.end}'" for each in self.shapes]
        return f"{call}({', '.join(said)})"

    def _repr_latex_(self) -> str:
        from symbolic.tables.formula import latex  # imports this module

        return rf"$\displaystyle {latex(self)}$"


def exact_number(label: str, given: Expr | int | str) -> Expr:
    """`given` as an exact expression; a float is refused, since it is not exactly the decimal that it shows.

    >>> exact_number("a", "0.08")
    2/25
    """
    if isinstance(given, str):
        try:
            return Rational(given)
        except (TypeError, ValueError, ZeroDivisionError):
            raise ValueError(f"{label} = {given!r} is no exact number such as 2/25 or 0.08") from None
    value = exact(given)
    if not isinstance(value, Expr):
        raise ValueError(f"{label} = {given!r} is no exact number such as 2/25 or 0.08")
    if value.has(Float):
        raise ValueError(
            f"{label} = {given} is a rounded float; write it exactly, as the text '{given}' or such as '2/25'"
        )
    return value


def _substituted(component: Component, values: dict[Symbol, Expr]) -> Component:
    x, y = (coordinate.subs(values) for coordinate in component.point)
    return replace(component, point=(x, y), start=component.start.subs(values), end=component.end.subs(values))
