"""Formulas: a parser of typed text that can only build exact expressions, and their LaTeX.

    sum     = product { ("+" | "-") product }
    product = signed { ("*" | "/") signed }
    signed  = ("+" | "-") signed | power
    power   = atom [ ("**" | "^") signed ]
    atom    = number | name | function "(" sum ")" | "(" sum ")"

Nothing typed is ever executed, and a decimal is the decimal it shows: `0.08` is 2/25. The size of a formula is bounded
(`flaw`), since otherwise a short formula could take a day: SymPy's numerical tests take twice as long for each level of
an irrational constant, and its roots factor the number under the root.
"""

import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import islice
from types import MappingProxyType
from typing import NamedTuple

from sympy import (
    Abs,
    Add,
    Basic,
    E,
    Expr,
    Matrix,
    Mul,
    Pow,
    Rational,
    S,
    Symbol,
    cos,
    cosh,
    exp,
    pi,
    sin,
    sinh,
    tan,
)
from sympy import latex as sympy_latex
from sympy.core.traversal import preorder_traversal

from symbolic.expressions import text as vocabulary
from symbolic.tables.table import K0, K1, Component, Table, cos_eta1, cos_phi0, eta, lam, phi, theta

LENGTH, DIGITS = 2000, 400
TOKEN = re.compile(
    r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<mark>\*\*|[-+*/^()])|\s+", re.ASCII
)
CONSTANTS: Mapping[str, Expr] = {"pi": pi, "E": E}
NAMES: Mapping[str, Symbol] = MappingProxyType({theta.name: theta})


def _tan(x: Expr) -> Expr:
    """`tan(x)` in the vocabulary; SymPy's own `tan` would turn `tan(x + pi/2)` into a cotangent."""
    value = tan(x)
    return value if value.func is tan or value.is_number else sin(x) / cos(x)


STEEP = ("sin", "cos", "tan", "exp", "sinh", "cosh", "tanh")  # costly to evaluate far from 0
FUNCTIONS: Mapping[str, Callable[[Expr], Expr]] = {
    **{name: function for function, name in vocabulary.FUNCTIONS.items()},
    "Abs": Abs,
    "abs": Abs,
    "tan": _tan,
}


GREEK = {"\u03b8": "theta", "\u03bb": "lam", "\u03c0": "pi", "\u03b7": "eta", "\u03c6": "phi", "\u03b1": "alpha"}


def parse(text: str, names: Mapping[str, Symbol] = NAMES) -> Expr:
    """The exact expression of `text`; `names` maps the allowed letters to symbols. `ValueError` for any other text.

    >>> parse("1 + cos(5*theta)/40")
    cos(5*theta)/40 + 1
    >>> parse("0.08^2 - 1e-3")
    27/5000
    >>> parse("theta.real")
    Traceback (most recent call last):
    ...
    ValueError: '.' at column 6 is no part of a formula; accepted: numbers, + - * / ** ( ), theta, pi, E, \
sqrt, sin, cos, exp, log, atan, sinh, cosh, tanh, abs, tan
    """
    if len(text) > LENGTH:
        raise ValueError(f"the formula has {len(text)} characters; at most {LENGTH} are accepted")
    return _Reader(text, names).whole()


def number(text: str, label: str) -> Expr:
    """The exact real number that `text` denotes; an error begins with `label`.

    >>> number("2/25", "alpha"), number("sqrt(2)", "a")
    (2/25, sqrt(2))
    """
    try:
        value = parse(text, {})
    except ValueError as error:
        raise ValueError(f"{label} = {_shown(text)}: {error}") from None
    if not value.is_real:
        raise ValueError(f"{label} = {_shown(text)} is not a real number")
    return value


class _Token(NamedTuple):
    kind: str
    text: str
    place: int


class _Reader:
    """A recursive-descent parser of one formula; `level` is the depth of the recursion."""

    def __init__(self, text: str, names: Mapping[str, Symbol]) -> None:
        self.named: Mapping[str, Expr] = {**names, **CONSTANTS}
        self.tokens = self._split(text)
        self.level = 0

    def whole(self) -> Expr:
        value = self._sum()
        self._expect("", "an operator or the end")
        return value

    def _split(self, text: str) -> list[_Token]:
        """The tokens in reverse order, so that the next one is popped off the end."""
        found, place = [], 0
        while place < len(text):
            match = TOKEN.match(text, place)
            if match is None:
                word = GREEK.get(text[place])
                why = f"is no part of a formula; write {word}" if word else "is no part of a formula"
                raise _error(text[place], place, why, self._accepted())
            if match.lastgroup:
                found.append(_Token(match.lastgroup, match.group(), place))
            place = match.end()
        return [_Token("end", "", len(text)), *reversed(found)]

    @property
    def _next(self) -> _Token:
        return self.tokens[-1]

    def _take(self, *marks: str) -> str | None:
        return self.tokens.pop().text if self._next.kind == "mark" and self._next.text in marks else None

    def _expect(self, mark: str, accepted: str) -> None:
        token = self._next
        if token.text != mark:
            raise _error(token.text, token.place, "is unexpected", accepted)
        if mark:
            self.tokens.pop()

    def _sum(self) -> Expr:
        place, terms = self._next.place, [self._product()]
        while sign := self._take("+", "-"):
            terms.append(self._product() if sign == "+" else -self._product())
        return _checked(Add(*terms), place) if len(terms) > 1 else terms[0]

    def _product(self) -> Expr:
        place, factors = self._next.place, [self._signed()]
        while mark := self._take("*", "/"):
            where, factor = self._next.place, self._signed()
            if mark == "/" and (factor.is_zero or (factor.is_number and factor.is_zero is None)):
                raise _error(str(factor), where, "may not be divided by", "a divisor other than 0")
            factors.append(factor if mark == "*" else _checked(1 / factor, where))
        return _checked(Mul(*factors), place) if len(factors) > 1 else factors[0]

    def _signed(self) -> Expr:
        self.level += 1
        if self.level > LEVELS:
            raise _error(self._next.text, self._next.place, "is nested too deeply", f"at most {LEVELS} levels")
        sign = self._take("+", "-")
        value = self._signed() if sign else self._power()
        self.level -= 1
        return -value if sign == "-" else value

    def _power(self) -> Expr:
        place, base = self._next.place, self._atom()
        if not self._take("**", "^"):
            return base
        where, exponent = self._next.place, self._signed()
        if not is_exponent(exponent):
            raise _error(str(exponent), where, "is no accepted exponent", EXPONENTS)
        if base.is_zero and exponent.is_negative:
            raise _error(str(base), place, "may not be divided by", "a divisor other than 0")
        if isinstance(base, Rational) and not modest(base, abs(exponent)):
            raise _error(f"{base}**{exponent}", place, "is too large", "a smaller power")
        return _checked(Pow(base, exponent), place)

    def _atom(self) -> Expr:
        kind, text, place = self._next
        if self._take("("):
            return self._inside()
        if kind not in ("name", "number") or (kind == "name" and text not in {**FUNCTIONS, **self.named}):
            own = (
                f", or a letter of your own: {text}='LOW:HIGH' in Python, --shape {text}=NUMBER at the prompt"
                if kind == "name" and "theta" in self.named
                else ""
            )
            wrong = "is unknown" if kind == "name" else "is unexpected"
            raise _error(text, place, wrong, self._accepted() + own)
        self.tokens.pop()
        if kind == "number":
            return _numeral(text, place)
        return self._call(text, place) if text in FUNCTIONS else self.named[text]

    def _call(self, name: str, place: int) -> Expr:
        self._expect("(", f"{name}(...)")
        argument = self._inside()
        if name in STEEP and is_huge(argument):
            raise _error(name, place, "has too large an argument", ARGUMENTS)
        return _checked(FUNCTIONS[name](argument), place)

    def _inside(self) -> Expr:
        value = self._sum()
        self._expect(")", "an operator or )")
        return value

    def _accepted(self) -> str:
        functions = [name for name in FUNCTIONS if name != "Abs"]
        return ", ".join(["numbers", "+ - * / ** ( )", *self.named, *functions])


def _numeral(text: str, place: int) -> Expr:
    mantissa, _, power = text.lower().partition("e")
    if len(mantissa) > DIGITS or len(power) > DIGITS or abs(int(power or 0)) > DIGITS:
        raise _error(text, place, "is too long a number", f"at most {DIGITS} digits, and e-{DIGITS} to e+{DIGITS}")
    return Rational(text)


def _checked(value: Expr, place: int) -> Expr:
    found = flaw(value)
    if found:
        raise _error("the formula", place, f"cannot be used: {found[0]}", found[1], quoted=False)
    return value


def _error(subject: str, place: int, complaint: str, accepted: str, quoted: bool = True) -> ValueError:
    subject = (_shown(subject) if subject else "the end") if quoted else subject
    return ValueError(f"{subject} at column {place + 1} {complaint}; accepted: {accepted}")


def _shown(text: str) -> str:
    """`text` quoted on one line and cut to a readable length."""
    return ascii(text if len(text) <= 40 else f"{text[:37]}...")


EXPONENT = 64  # largest modulus of an exponent
DENOMINATOR = 12  # and its largest denominator
NODES = 1500  # largest number of operations, names and numbers
LEVELS = 60  # deepest nesting of operations
CONSTANT_LEVELS = 10  # the same inside an irrational constant
BITS = 1400  # largest numerator or denominator; 400 decimal digits fit
ARGUMENT = 10**6  # largest modulus of a constant inside a function
VOCABULARY = (
    *(Add, Mul, Pow, Rational, Symbol, type(pi), type(E), Abs, tan),
    *(function for function in vocabulary.FUNCTIONS if isinstance(function, type)),  # without the square root: a power
)


def flaw(value: Expr) -> tuple[str, str] | None:
    """The fault of `value` and what would be accepted, as two texts; None if there is no fault.

    >>> from symbolic.tables.table import theta
    >>> flaw(theta**65)
    ('the exponent 65 is not accepted', 'a number between -64 and 64 with a denominator of at most 12')
    >>> flaw(theta**64) is None
    True
    """
    nodes = list(islice(preorder_traversal(value), NODES + 1))
    if len(nodes) > NODES:
        return "the formula is too long", f"at most {NODES} operations, names and numbers"
    if levels(value) > LEVELS:
        return "the formula is nested too deeply", f"at most {LEVELS} levels"
    for node in nodes:
        found = _flaw_at(node)
        if found:
            return found
    return None


@lru_cache(maxsize=4096)  # the parser tests all parts of a formula again after each operation
def _flaw_at(node: Expr) -> tuple[str, str] | None:
    if node.is_number and node.is_finite is False:  # letters are finite, so that only a constant can be infinite
        return "the value is not finite", "a formula without a pole"
    if node is S.ImaginaryUnit:
        return "the value is not real", "a formula with real values"
    if not isinstance(node, VOCABULARY):
        return f"{node.func.__name__} is beyond the vocabulary", "sums, products, powers and the named functions"
    if isinstance(node, Rational):
        return None if modest(node) else ("the number is too large", f"numbers of at most {BITS} bits")
    if node.is_number and levels(node) > CONSTANT_LEVELS:
        return "a constant is nested too deeply", f"at most {CONSTANT_LEVELS} levels inside a constant"
    if node.is_number and node.is_real is False:
        return "the value is not real", "a formula with real values"
    if node.func is Pow and not is_exponent(node.exp):
        return f"the exponent {node.exp} is not accepted", EXPONENTS
    if node.func in (exp, sinh, cosh) and is_huge(node.args[0]):
        return f"the argument of {node.func.__name__} is too large", ARGUMENTS
    return None


EXPONENTS = f"a number between -{EXPONENT} and {EXPONENT} with a denominator of at most {DENOMINATOR}"
ARGUMENTS = f"a modulus of at most {ARGUMENT}"


def is_exponent(value: Expr) -> bool:
    """Whether `value` may be an exponent.

    >>> is_exponent(Rational(3, 2)), is_exponent(Rational(1, 13))
    (True, False)
    """
    return isinstance(value, Rational) and value.q <= DENOMINATOR and abs(value) <= EXPONENT


def is_huge(argument: Expr) -> bool:
    """Whether a function of the constant `argument` is too costly to evaluate.

    >>> is_huge(S(10) ** 7), is_huge(pi)
    (True, False)
    """
    return bool(argument.is_number) and (Abs(argument) > ARGUMENT) == S.true


def modest(value: Rational, power: int = 1) -> bool:
    """Whether `value**power` has a numerator and a denominator of moderate size.

    >>> modest(S(10) ** 400), modest(S(10), 480)
    (True, False)
    """
    return bool((max(abs(value.p), value.q).bit_length() - 1) * power <= BITS)


@lru_cache(maxsize=4096)
def levels(value: Expr) -> int:
    """The depth to which operations are nested in `value`; 0 for a number or a name.

    >>> levels(1 + 2 * pi)
    2
    """
    return 1 + max(levels(part) for part in value.args) if value.args else 0


SPECIAL = {
    lam: r"\lambda",
    phi: r"\varphi",
    eta: r"\eta",
    K0: "K_{0}",
    K1: "K_{1}",
    cos_phi0: r"\cos \varphi_{0}",
    cos_eta1: r"\cos \eta_{1}",
}


def latex(expression: Expr | Matrix | Component | Table) -> str:
    """LaTeX of an expression, matrix, component or table, in the paper's letters; a component is its parametrisation.

    >>> from symbolic.tables.table import alpha
    >>> latex(lam * alpha)
    '\\\\alpha \\\\lambda'
    >>> from symbolic.tables import cuspless
    >>> latex(cuspless.component("wall").point[0])
    '- \\\\frac{1}{4}'
    """
    if isinstance(expression, Table):
        return r" \\ ".join(latex(component) for component in expression.components)
    if isinstance(expression, Component):
        x, y = (latex(coordinate) for coordinate in expression.point)
        return rf"\left({x}, {y}\right), \quad {latex(expression.start)} \leq \theta \leq {latex(expression.end)}"
    return str(sympy_latex(expression, symbol_names=_names(expression)))


def equation(left: str, right: Expr | Matrix) -> str:
    """A displayed equation for a notebook cell; `left` is LaTeX already.

    >>> equation(r"\\varphi", -lam * eta)
    '$\\\\displaystyle \\\\varphi = - \\\\eta \\\\lambda$'
    """
    return rf"$\displaystyle {left} = {latex(right)}$"


def letter(name: str) -> str:
    """LaTeX of a name in the code: the paper's letter, with digits and the part after `_` as a subscript.

    >>> letter("theta_next"), letter("lam"), letter("mu0")
    ('\\\\theta_{\\\\mathrm{next}}', '\\\\lambda', '\\\\mu_{0}')
    """
    stem, _, tail = name.partition("_")
    digits = stem[len(stem.rstrip("0123456789")) :]
    stem = stem[: len(stem) - len(digits)]
    base = {"lam": r"\lambda", "phi": r"\varphi"}.get(stem) or str(sympy_latex(Symbol(stem)))
    parts = [digits] if digits else []
    parts += [rf"\mathrm{{{tail}}}"] if tail else []
    return base + (f"_{{{','.join(parts)}}}" if parts else "")


def _names(expression: Expr | Matrix) -> dict[Basic, str]:
    symbols = sorted(expression.free_symbols, key=str)
    return {s: SPECIAL.get(s) or letter(s.name) for s in symbols}
