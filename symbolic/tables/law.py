"""Reflection laws: the exit angle as a formula in the angle of incidence, proved to point into the table.

The paper allows `phi = -eta + f(eta)` with any `f` in C^2, and studies `phi = -lam*eta`. Here a law is any formula in
`eta`, `lam`, the landing's boundary parameter `theta` or arc length `s`, and parameters of the user's own. It is one
only where it maps the open half circle into itself, `|phi| < pi/2` for `|eta| < pi/2`, and that is proved in integers
over all angles and over the ranges of whatever else is in the formula: towards an end where `|phi|` tends to `pi/2`
itself, by the first derivative that does not vanish there.

Arc length is that of the paper, counted from the table's origin. Where it is a closed formula in `theta` on every
component, `Law.on` writes it in; on a closed curve without one it is what is integrated wherever a number is needed.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from symbolic.tables.definition import LAW_NAMES, UNIFORM, exact, exact_text, words_of

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from symbolic.expressions.signs import Finding
    from symbolic.tables.table import Table

Range = tuple[Any, Any]  # two exact numbers, in order
Ranges = tuple[tuple[Any, Any, Any], ...]  # symbols, each with both ends
Case = tuple[Any, Any, dict[Any, Any], dict[Any, Any]]
ORDER = 4  # of the derivatives that are looked at where |phi| tends to pi/2
STRIPS = (2, 4, 6, 8)  # widths 2**-n of such a neighbourhood, in quarter turns
BOUND = 1 << 20  # of the law and its two first derivatives


@dataclass(frozen=True)
class Law:
    """A reflection law: the exit angle `phi` as a formula in `eta`, `lam`, `theta`, `s`, and parameters of its own.

    `numbers` are those of its own parameters that have a value, as exact text; `at` gives one to the others.

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
    along: "Expr | None" = None  # what `s` is in `theta`, on a component of a table that has several

    def __post_init__(self) -> None:
        if self.formula != UNIFORM:
            object.__setattr__(self, "formula", _canonical(self.formula))

    @property
    def uniform(self) -> bool:
        """Is it the paper's uniform contraction, `phi = -lam*eta`?"""
        return self.formula == UNIFORM

    @property
    def parameters(self) -> tuple[str, ...]:
        """Its own parameters that have no value yet, in order."""
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
        """The exit angle, exactly. Paper: section 2."""
        return _exit_angle(self.formula, self.numbers, self.along)

    @property
    def slope(self) -> "Expr":
        """`-d phi/d eta`, what a reflection multiplies small differences of angles by: `lam` for the paper's law."""
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

    def on(self, table: "Table", component: int = 0) -> "Law":
        """The same law on one component, `s` written as a formula in `theta`; on a closed curve without one `s` stays.

        >>> from symbolic import tables
        >>> Law("-lam*eta + sin(s)/9").on(tables.square(), 2).phi
        -eta*lam + sin(theta + 2)/9
        """
        return _on(self, table, component) if self.measured else self

    @property
    def odd(self) -> bool:
        """Is `phi` proved to be odd in `eta`, the same everywhere? Then mirror images of orbits are orbits."""
        from symbolic.expressions.signs import vanishes
        from symbolic.tables.table import eta

        return self.uniform or (not self.placed and vanishes(self.phi + self.phi.subs(eta, -eta)))

    def proof(self, lam: Range = (0, 1), theta: Range | None = None, s: Range | None = None, **own: Range) -> "Finding":
        """Does it map the open half circle into itself, for all `lam`, `theta`, `s` and own parameters in these ranges?

        `theta` is by default that of a closed curve, from -pi to pi; arc length has a range on a table only.

        >>> Law("-lam*eta").proof().outcome.name, Law("-lam*eta - eta**3/5").proof().outcome.name
        ('PROVED', 'REFUTED')
        """
        if self.measured and s is None:
            raise ValueError(f"law = {self}: s is arc length, which has a range on a table only")
        return _proof(self.phi, self._ranges(lam, theta, s, own))

    def _ranges(self, lam: Range, theta: Range | None, s: Range | None, own: Mapping[str, Range]) -> Ranges:
        """The range of each symbol but `eta` that the exit angle may depend on."""
        from sympy import S, pi

        from symbolic.tables.table import lam as contraction
        from symbolic.tables.table import s as length
        from symbolic.tables.table import theta as place

        ranges = {contraction: lam, place: theta or (-pi, pi)} | ({length: s} if s else {})
        ranges |= {symbol: own[symbol.name] for symbol in self.symbols}
        return tuple((symbol, S(low), S(high)) for symbol, (low, high) in ranges.items())

    def places(self, table: "Table") -> tuple[Range | None, Range | None]:
        """The ranges of `theta` and of `s` over all components of a table, each when the law depends on it."""
        if not self.placed:
            return None, None
        from sympy import Max, Min

        parts = table.components
        found = Min(*(part.start for part in parts)), Max(*(part.end for part in parts))
        return found, _reach(self, table) if self.measured else None

    def contracting(self, lam: Range = (0, 1), **own: Range) -> "Finding":
        """Is `|phi| < |eta|` for every `eta` but 0? It makes `J` of an ellipse grow (`symbolic.motion.collision`).

        >>> Law("-lam*sin(eta)").contracting().outcome.name, Law("-eta").contracting().outcome.name
        ('PROVED', 'REFUTED')
        """
        from sympy import pi

        from symbolic.expressions.signs import Finding, Outcome, conjunction

        if self.placed:
            return Finding(Outcome.UNKNOWN, "the exit angle depends on the place")
        found = []
        for x, exit, others, _ in _cases(self.phi, self._ranges(lam, None, None, own)):
            for side in (exit, exit.subs(x, -x)):
                found += [_positive(x * pi / 2 - sign * side, x, others, begin=0) for sign in (1, -1)]
        return conjunction(*found)

    def check(self, lam: Range = (0, 1), theta: Range | None = None, s: Range | None = None, **own: Range) -> None:
        """`ValueError` with the angle at which it leads out of the table, or when no proof was found."""
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
def lengths(table: "Table") -> "tuple[Expr, ...] | None":
    """Arc length on every component, from the table's origin, in the words of a law; None where one has no such form.

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
    """The range of arc length: exact in closed form, else bounds of it on a closed curve."""
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
        raise ValueError(f"law = {law}: the arc length s of {table.name} is not bounded: {error}") from None


def _cases(phi: "Expr", ranges: Ranges) -> Iterator[Case]:
    """`x` with `eta = x*pi/2`, the exit angle in it, the ranges that are left, and what the other symbols are.

    Where the exit angle is affine in a symbol, the ends of its range decide; else it runs with a variable from 0 to 1.
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
            u = Dummy("u")
            moving[symbol], left[u] = low + (high - low) * u, (S.Zero, S.One)
    for corner in corners:
        known = {**corner, **moving}
        yield x, phi.subs({eta: x * pi / 2, **known}, simultaneous=True), left, known


@cache
def _proof(phi: "Expr", ranges: Ranges) -> "Finding":
    from sympy import S, pi

    from symbolic.expressions.signs import Finding, Outcome, conjunction

    found = []
    for x, exit, others, known in _cases(phi, ranges):
        for sign in (1, -1):
            finding = _positive(pi / 2 - sign * exit, x, others)
            if finding.outcome is Outcome.REFUTED:
                return _witnessed(finding, x, exit, known)
            found.append(finding)
        found += [_bounded(exit.diff(x, n), {x: (-S.One, S.One), **others}) for n in (0, 1, 2)]
    whole = conjunction(*found)
    if whole:
        return Finding(Outcome.PROVED, "enclosures: |phi| < pi/2 for |eta| < pi/2, with two bounded derivatives")
    return Finding(Outcome.UNKNOWN, f"no proof that |phi| < pi/2 for |eta| < pi/2, smoothly: {whole.reason}")


def _positive(g: "Expr", x: "Symbol", others: Mapping["Symbol", Range], begin: int = -1) -> "Finding":
    """Is `g > 0` for `begin < x < 1`? Where it vanishes at an end, a derivative of one sign decides next to it."""
    from sympy import Rational, S

    from symbolic.expressions.enclosures import sign_in
    from symbolic.expressions.signs import Outcome

    ends = {begin: S(begin), 1: S.One}
    for end, way in ((begin, 1), (1, -1)):
        inward, order = g, 0
        while order < ORDER and _is_zero(inward.subs(x, end)):
            inward, order = way * inward.diff(x), order + 1
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


def _is_zero(value: "Expr") -> bool:
    """Is `value` 0 whatever is still open in it? A number at one place says no at once."""
    from sympy import Rational, simplify

    here = value.subs({symbol: Rational(1, 3) for symbol in value.free_symbols}).n(30)
    return not abs(here) > Rational(1, 10**20) and bool(simplify(value) == 0)


def _bounded(value: "Expr", box: Mapping["Symbol", Range]) -> "Finding":
    """Is the modulus of `value` below `BOUND` on the whole box?"""
    from symbolic.expressions.enclosures import sign_in

    return sign_in(BOUND**2 - value**2, box)


def _witnessed(finding: "Finding", x: "Symbol", exit: "Expr", others: Mapping["Symbol", "Expr"]) -> "Finding":
    """The refutation, with the angle nearest to the normal at which the law was seen to fail, on this side of it."""
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
