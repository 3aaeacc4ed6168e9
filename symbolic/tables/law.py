"""Reflection laws: the exit angle as a formula in the angle of incidence, proved to point into the table.

The paper allows `phi = -eta + f(eta)` with any `f` in C^2, and studies `phi = -lam*eta`. Here a law is any formula in
`eta`, `lam`, the boundary parameter `theta` or the arc length `s` of the point of reflection, and parameters of the
user's own. It must map the open half circle into itself, `|phi| < pi/2` for `|eta| < pi/2`. This is proved in integer
arithmetic over all angles and over the ranges of all other variables; near an end where `|phi|` tends to `pi/2`, by the
first derivative that does not vanish at this end.

Arc length is the paper's, counted from the table's origin. Where it is a closed formula in `theta` on every component,
`Law.on` substitutes it; on a closed curve without such a formula `s` stays, and is integrated where a number is needed.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from symbolic.tables.definition import LAW_NAMES, UNIFORM, exact, exact_text, words_of

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from symbolic.expressions.signs import SignFinding
    from symbolic.tables.table import Table

Range = tuple[Any, Any]  # two exact numbers, in order
Ranges = tuple[tuple[Any, Any, Any], ...]  # of symbol, lower end and upper end
Case = tuple[Any, Any, dict[Any, Any], dict[Any, Any]]  # what `_cases` yields
ORDER = 4  # of the highest derivative that is tried where |phi| tends to pi/2
STRIPS = (2, 4, 6, 8)  # n of the strips next to such an end, of width 2**-n quarter turns
BOUND = 1 << 20  # of |phi| and of its first two derivatives


@dataclass(frozen=True)
class Law:
    """A reflection law: the exit angle `phi` as a formula in `eta`, `lam`, `theta`, `s`, and parameters of its own.

    `numbers` holds the values of its own parameters, as exact text; `at` sets those that have none yet.

    >>> Law().phi, Law("-lam*eta") == Law("-eta*lam")
    (-eta*lam, True)
    >>> bent = Law("-lam*eta - b*sin(2*eta)")
    >>> bent.parameters, bent.at(b="0.1").phi
    (('b',), -eta*lam - sin(2*eta)/10)
    >>> bent.slope
    2*b*cos(2*eta) + lam
    """

    formula: str = UNIFORM
    numbers: tuple[tuple[str, str], ...] = ()
    along: "Expr | None" = None  # `s` as a formula in `theta` on one component, where the table has several

    def __post_init__(self) -> None:
        if self.formula != UNIFORM:
            object.__setattr__(self, "formula", _canonical(self.formula))

    @property
    def uniform(self) -> bool:
        """Is the law the paper's uniform contraction, `phi = -lam*eta`?"""
        return self.formula == UNIFORM

    @property
    def parameters(self) -> tuple[str, ...]:
        """Parameters of the law that have no value yet, in order."""
        names = [name for name in parameters_of_law(self.formula) if name not in dict(self.numbers)]
        lengths = {symbol.name for symbol in self.along.free_symbols} - set(LAW_NAMES) if self.along else set()
        return tuple(sorted({*names, *lengths}))

    def at(self, **numbers: Any) -> "Law":
        """The same law with exact numbers for parameters of its own."""
        for name in numbers:
            if name not in self.parameters:
                known = ", ".join(self.parameters) or "none"
                raise ValueError(f"law = {self.formula}: no parameter {name}; it has: {known}")
        texts = {name: exact_text(f"law: {name}", value) for name, value in numbers.items()}
        return replace(self, numbers=tuple(sorted({**dict(self.numbers), **texts}.items())))

    @property
    def symbols(self) -> "tuple[Symbol, ...]":
        """The symbols of its own parameters that have no value yet."""
        from sympy import Symbol

        return tuple(Symbol(name, real=True) for name in self.parameters)

    @property
    def phi(self) -> "Expr":
        """The exit angle as an exact expression, rewritten so that `tan(eta)` has no pole at `pi/2`. Paper: section 2.

        >>> from sympy import pi
        >>> from symbolic.tables.table import eta
        >>> Law("-atan(lam*tan(eta))").phi.subs(eta, pi / 2)  # the limit
        -pi/2
        """
        return _without_pole(self._as_written)

    @property
    def _as_written(self) -> "Expr":
        return _exit_angle(self.formula, self.numbers, self.along)

    @property
    def slope(self) -> "Expr":
        """`-d phi/d eta`, the factor of small differences of angle in a reflection; it is `lam` for the paper's law."""
        from symbolic.tables.table import eta

        return -self.phi.diff(eta)

    @property
    def placed(self) -> bool:
        """Does the exit angle depend on the place, that is on the landing's `theta` or `s`?"""
        from symbolic.tables.table import s, theta

        return not self.uniform and self.phi.has(theta, s)

    @property
    def measured(self) -> bool:
        """Does the exit angle depend on the arc length `s` of the landing?"""
        from symbolic.tables.table import s

        return not self.uniform and self.phi.has(s)

    def elastic(self, lam: Any) -> bool:
        """Is the law elastic, `phi = -eta`, at this exact contraction? The map then preserves area.

        >>> Law().elastic(1), Law().elastic(0)
        (True, False)
        """
        from sympy import S

        from symbolic.expressions.signs import vanishes
        from symbolic.tables.table import eta
        from symbolic.tables.table import lam as contraction

        if self.uniform:
            return bool(S(lam) == 1)
        return bool(vanishes(self.phi.subs(contraction, S(lam)) + eta))

    def on(self, table: "Table", component: int = 0) -> "Law":
        """The law on one component: `s` is replaced by its formula in `theta`, but kept on a closed curve without one.

        >>> from symbolic import tables
        >>> Law("-lam*eta + sin(s)/9").on(tables.square(), 2).phi
        -eta*lam + sin(theta + 2)/9
        """
        return _on(self, table, component) if self.measured else self

    @property
    def odd(self) -> bool:
        """Is `phi` proved to be odd in `eta` and the same at all points? Then mirror images of orbits are orbits."""
        from symbolic.expressions.signs import vanishes
        from symbolic.tables.table import eta

        return self.uniform or (not self.placed and vanishes(self.phi + self.phi.subs(eta, -eta)))

    def proof(
        self, lam: Range = (0, 1), theta: Range | None = None, s: Range | None = None, **own: Range
    ) -> "SignFinding":
        """Does the law map the open half circle into itself for all `lam`, `theta`, `s` and parameters in these ranges?

        `theta` runs by default from -pi to pi, over a closed curve; a law in `s` needs its range, as `places` gives it.

        >>> Law("-lam*eta").proof().outcome.name, Law("-lam*eta - eta**3/5").proof().outcome.name
        ('PROVED', 'REFUTED')
        """
        if self.measured and s is None:
            raise ValueError(
                f"law = {self}: the range of the arc length s is not given; accepted: s=(LOW, HIGH) on a table"
            )
        return _proof(self._as_written, self._ranges(lam, theta, s, own))

    def _ranges(self, lam: Range, theta: Range | None, s: Range | None, own: Mapping[str, Range]) -> Ranges:
        """Symbol, lower and upper end, for each symbol but `eta` that the exit angle may contain."""
        from sympy import S, pi

        from symbolic.tables.table import lam as contraction
        from symbolic.tables.table import s as length
        from symbolic.tables.table import theta as place

        ranges = {contraction: lam, place: theta or (-pi, pi)} | ({length: s} if s else {})
        ranges |= {symbol: own[symbol.name] for symbol in self.symbols}
        return tuple((symbol, S(low), S(high)) for symbol, (low, high) in ranges.items())

    def places(self, table: "Table") -> tuple[Range | None, Range | None]:
        """The ranges of `theta` and `s` over all components of a table; None for a variable that is not in the law."""
        if not self.placed:
            return None, None
        from sympy import Max, Min

        parts = table.components
        found = Min(*(part.start for part in parts)), Max(*(part.end for part in parts))
        return found, _reach(self, table) if self.measured else None

    def contracting(self, lam: Range = (0, 1), **own: Range) -> "SignFinding":
        """Is `|phi| < |eta|` for every `eta` but 0? Then `J` of `symbolic.motion.collision` grows on an ellipse.

        >>> Law("-lam*sin(eta)").contracting().outcome.name, Law("-eta").contracting().outcome.name
        ('PROVED', 'REFUTED')
        """
        from sympy import pi

        from symbolic.expressions.signs import Outcome, SignFinding, conjunction

        if self.placed:
            return SignFinding(Outcome.UNKNOWN, "the exit angle depends on the place")
        found = []
        for x, exit, others, _ in _cases(self._as_written, self._ranges(lam, None, None, own)):
            for side in (exit, exit.subs(x, -x)):
                found += [_positive(x * pi / 2 - sign * side, x, others, begin=0) for sign in (1, -1)]
        return conjunction(*found)

    def check(self, lam: Range = (0, 1), theta: Range | None = None, s: Range | None = None, **own: Range) -> None:
        """Raises `ValueError` if `proof` finds an angle at which the law leads out of the table, or finds no proof."""
        if self.uniform:
            return
        finding = self.proof(lam, theta, s, **own)
        if not finding:
            raise ValueError(f"law = {self}: {finding.reason}")

    def __str__(self) -> str:
        return ", ".join([self.formula, *(f"{name} = {text}" for name, text in self.numbers)])


def parameters_of_law(formula: str) -> tuple[str, ...]:
    """The names in a law's formula that are parameters of its own."""
    return tuple(sorted(words_of([formula]) - set(LAW_NAMES))) if formula != UNIFORM else ()


def _symbols(formula: str) -> "dict[str, Symbol]":
    from sympy import Symbol

    from symbolic.tables.table import eta, lam, s, theta

    known = {"eta": eta, "lam": lam, "theta": theta, "s": s}
    return known | {name: Symbol(name, real=True) for name in parameters_of_law(formula)}


@cache
def _canonical(formula: str) -> str:
    """The formula as SymPy writes it, so that equal laws are the same text."""
    from symbolic.expressions.text import checked
    from symbolic.tables.formula import parse
    from symbolic.tables.table import eta, lam

    try:
        symbols = _symbols(formula)
        phi = parse(formula, symbols)
        checked("the exit angle", phi, set(symbols.values()))
    except ValueError as error:
        raise ValueError(f"law: {error}") from None
    return UNIFORM if phi == -lam * eta else str(phi)


@cache
def _exit_angle(formula: str, numbers: tuple[tuple[str, str], ...], along: "Expr | None") -> "Expr":
    from sympy import S

    from symbolic.tables.formula import parse

    symbols = _symbols(formula)
    phi = parse(formula, symbols).subs({symbols[name]: S(exact(name, text)) for name, text in numbers})
    return phi if along is None else phi.subs(symbols["s"], along)


@cache
def _without_pole(phi: "Expr") -> "Expr":
    """Rewrites `atan(u*tan(eta))`, if `u >= 0`, in a form that has no pole at a right angle.

    The form is `eta - atan((1 - u)*sin(eta)*cos(eta)/(cos(eta)**2 + u*sin(eta)**2))`. Both are equal for
    `|eta| < pi/2`, and the new form is smooth at `pi/2`.
    """
    from sympy import Wild, atan, cos, sin, tan

    from symbolic.tables.table import eta

    u = Wild("u", exclude=[eta])

    def rewritten(whole: "Expr") -> "Expr":
        found = whole.args[0].match(u * tan(eta))
        if found is None or not found[u].is_nonnegative:
            return whole
        factor = found[u]
        return eta - atan((1 - factor) * sin(eta) * cos(eta) / (cos(eta) ** 2 + factor * sin(eta) ** 2))

    return phi.replace(lambda part: isinstance(part, atan) and part.has(tan(eta)), rewritten)


@cache
def lengths(table: "Table") -> "tuple[Expr, ...] | None":
    """Arc length from the table's origin on each component, a formula in `theta`; None if one has no elementary form.

    >>> from symbolic import tables
    >>> lengths(tables.cardioid), lengths(tables.egg(3))
    ((4*sin(theta/2),), None)
    """
    from sympy import Integral, elliptic_e

    from symbolic.tables.geometry import arc_length, positions

    if any(arc_length(component).has(Integral, elliptic_e) for component in table.components):
        return None
    return positions(table)


@cache
def _on(law: Law, table: "Table", component: int) -> Law:
    from symbolic.tables.table import s

    known = lengths(table)
    if known is None:
        if len(table.components) > 1 or table.shapes:
            raise _unknown(law, table)
        return law
    if len(table.components) == 1:
        return Law(str(law.phi.subs(s, known[component])))
    return replace(law, along=known[component])


def _unknown(law: Law, table: "Table") -> ValueError:
    where = "on several pieces" if len(table.components) > 1 else "over a range of shapes"
    why = f"the arc length s of {table.name} is no closed formula, as it has to be {where}; write the law in theta"
    return ValueError(f"law = {law}: {why}")


@cache
def _reach(law: Law, table: "Table") -> Range:
    """The least and the greatest arc length on a table: exact where `lengths` has formulas, else bounds."""
    from symbolic.expressions.enclosures import UnboundedError, root_integral
    from symbolic.tables.geometry import speed
    from symbolic.tables.table import theta

    known = lengths(table)
    if known is not None:
        ends = [
            length.subs(theta, end)
            for length, part in zip(known, table.components, strict=True)
            for end in (part.start, part.end)
        ]
        return min(ends, key=lambda end: end.evalf()), max(ends, key=lambda end: end.evalf())
    if len(table.components) > 1:
        raise _unknown(law, table)
    whole, (_, origin) = table.components[0], table.origin
    square = speed(whole) ** 2
    try:
        return -root_integral(square, theta, whole.start, origin), root_integral(square, theta, origin, whole.end)
    except UnboundedError as error:
        raise ValueError(f"law = {law}: no bounds of the arc length s of {table.name} were found: {error}") from None


def _cases(phi: "Expr", ranges: Ranges) -> Iterator[Case]:
    """Cases that cover the ranges: `x`, with `eta = x*pi/2`; the exit angle; the ranges of variables; fixed values.

    A symbol in which the exit angle is affine is set to the ends of its range; any other becomes a variable on [0, 1].
    """
    from sympy import Dummy, S, pi

    from symbolic.tables.table import eta

    x = Dummy("x")
    corners: list[dict[Symbol, Expr]] = [{}]
    moving: dict[Symbol, Expr] = {}
    left: dict[Symbol, Range] = {}
    for symbol, low, high in ranges:
        if not phi.has(symbol):
            continue
        if low == high or phi.diff(symbol, 2) == 0:
            corners = [{**corner, symbol: end} for corner in corners for end in dict.fromkeys((low, high))]
        else:
            u = Dummy("u", nonnegative=True)
            moving[symbol], left[u] = low + (high - low) * u, (S.Zero, S.One)
    for corner in corners:
        known = {**corner, **moving}
        yield x, _without_pole(phi.subs(known, simultaneous=True)).subs(eta, x * pi / 2), left, known


@cache
def _proof(phi: "Expr", ranges: Ranges) -> "SignFinding":
    from sympy import S, pi

    from symbolic.expressions.signs import Outcome, SignFinding, conjunction

    found = []
    for x, exit, others, known in _cases(phi, ranges):
        own: list[SignFinding] = []
        for sign in (1, -1):
            finding = _positive(pi / 2 - sign * exit, x, others)
            if finding.outcome is Outcome.REFUTED:
                return _witnessed(finding, x, exit, known)
            own.append(finding)
        slope = _derivative(exit, x)
        own += [_bounded(value, {x: (-S.One, S.One), **others}) for value in (exit, slope, slope.diff(x))]
        found += [_located(one, x, known) if one.outcome is Outcome.REFUTED else one for one in own]
    whole = conjunction(*found)
    if whole:
        return SignFinding(Outcome.PROVED, "enclosures: |phi| < pi/2 for |eta| < pi/2, with two bounded derivatives")
    return SignFinding(Outcome.UNKNOWN, f"no proof that |phi| < pi/2 for |eta| < pi/2, smoothly: {whole.reason}")


def _positive(g: "Expr", x: "Symbol", others: Mapping["Symbol", Range], begin: int = -1) -> "SignFinding":
    """Is `g > 0` for `begin < x < 1`? If `g` vanishes at an end, the sign of a derivative decides near it."""
    from sympy import Rational, S

    from symbolic.expressions.enclosures import sign_in
    from symbolic.expressions.signs import Outcome

    ends = {begin: S(begin), 1: S.One}
    for end, way in ((begin, 1), (1, -1)):
        inward, order = g, 0
        while order < ORDER and _is_zero(inward.subs(x, end)):
            inward, order = way * _derivative(inward, x), order + 1
        if order:
            for n in STRIPS:
                ends[end] = end + way * Rational(1, 2**n)
                strip = tuple(sorted((ends[end], S(end))))
                if sign_in(inward, {x: strip, **others}):
                    break
            else:
                middle = sign_in(g, {x: (ends[begin], ends[1]), **others})
                return middle if middle.outcome is Outcome.REFUTED else replace(middle, outcome=Outcome.UNKNOWN)
    return sign_in(g, {x: (ends[begin], ends[1]), **others})


def _derivative(value: "Expr", x: "Symbol") -> "Expr":
    """`d value/dx`, as one reduced fraction if it contains no arc tangent: terms that cancel would have wide bounds."""
    from sympy import Function, atan, cancel, cos, sin

    found = value.diff(x)
    angles = all(isinstance(part, atan | sin | cos) for part in value.atoms(Function))
    return cancel(found) if angles and value.has(atan) and not found.has(atan) else found


def _is_zero(value: "Expr") -> bool:
    """Does `value` vanish identically in its symbols? A numerical value that is not 0 decides at once."""
    from sympy import Rational, simplify

    here = value.subs({symbol: Rational(1, 3) for symbol in value.free_symbols}).n(30)
    if not here.is_comparable:  # at a pole
        return False
    return not abs(here) > Rational(1, 10**20) and bool(simplify(value) == 0)


def _bounded(value: "Expr", box: Mapping["Symbol", Range]) -> "SignFinding":
    """Is the modulus of `value` below `BOUND` on the whole box?"""
    from symbolic.expressions.enclosures import sign_in

    return sign_in(BOUND**2 - value**2, box)


def _located(finding: "SignFinding", x: "Symbol", others: Mapping["Symbol", "Expr"]) -> "SignFinding":
    """The finding with another reason: it names `eta` and other values near which `BOUND` may be exceeded."""
    from sympy import pi

    at = dict(finding.at)
    places = {"eta": x * pi / 2, **{str(symbol): value for symbol, value in others.items()}}
    where = ", ".join(f"{name} = {place.subs(at).n(6)}" for name, place in places.items())
    return replace(finding, reason=f"phi, or one of its derivatives, may be larger than {BOUND} near {where}")


def _witnessed(finding: "SignFinding", x: "Symbol", exit: "Expr", others: Mapping["Symbol", "Expr"]) -> "SignFinding":
    """The refutation with another reason: it names an angle, found by bisection, at which the law fails."""
    from sympy import Rational, S, pi

    at = dict(finding.at)
    elsewhere = "".join(f", {symbol} = {value.subs(at).n(6)}" for symbol, value in others.items())

    def fails(place: "Expr") -> bool:
        return not abs(exit.subs({**at, x: place}).n(30)) < (pi / 2).n(30)

    inside, outside = S.Zero, S.Zero if fails(S.Zero) else at[x]
    while abs(outside - inside) > Rational(1, 2**20):
        middle = (inside + outside) / 2
        inside, outside = (inside, middle) if fails(middle) else (middle, outside)
    angle, value = (outside * pi / 2).n(6), exit.subs({**at, x: outside}).n(6)
    where = f"at eta = {angle}{elsewhere} the exit angle is {value if value.is_finite else 'not finite'}"
    return replace(finding, reason=f"{where}, which does not lie between -pi/2 and pi/2")


PAPERS_LAW = Law()  # phi = -lam*eta
