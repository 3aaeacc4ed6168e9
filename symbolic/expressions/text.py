"""Code of expressions in a closed vocabulary, so that floats, mpmath numbers and balls run the same formula.

Everything outside the vocabulary is refused. The vocabulary: `+ - * /`, integers, `q(p, n)` for every other rational,
`pi`, and the functions of `VOCABULARY`. A rational is never written `1/3`: Python would divide it in double
precision, and a ball computed from it would not contain the true value. Integer powers become products.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import CodeType
from typing import Any

from sympy import (
    Add,
    Expr,
    Float,
    Integer,
    Mul,
    Pow,
    Rational,
    S,
    Symbol,
    atan,
    cos,
    cosh,
    cse,
    exp,
    log,
    numbered_symbols,
    pi,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)
from sympy.core.function import AppliedUndef

from symbolic.expressions.numbers import NumberSystem, T

# The functions of the vocabulary, and the names by which every number system defines them.
FUNCTIONS: dict[Any, str] = {
    function: function.__name__ for function in (sqrt, sin, cos, exp, log, atan, sinh, cosh, tanh)
}
ROOT = "root"  # root(x, n) is the positive n-th root of a positive x


def checked(label: str, expression: Expr, known: set[Symbol]) -> None:
    """`ValueError` when `expression` holds a float, an unknown parameter, or a word outside the vocabulary.

    >>> checked("x", S(2) / 5, set())
    >>> checked("x", Float("0.4"), set())
    Traceback (most recent call last):
    ...
    ValueError: x: 0.400000000000000 is a rounded float; write it exactly, as Rational(2, 5)
    """
    for part in expression.atoms(Float):
        near = Rational(str(part)).limit_denominator(1000)
        raise ValueError(f"{label}: {part} is a rounded float; write it exactly, as Rational({near.p}, {near.q})")
    for symbol in sorted(expression.free_symbols - known, key=str):
        raise ValueError(f"{label}: {symbol} is neither an argument nor defined; known are {_listed(known)}")
    for node in _nodes(expression):
        if not _in_vocabulary(node):
            kind = node.func.__name__ if not isinstance(node, AppliedUndef) else str(node.func)
            if kind == "Piecewise":
                raise ValueError(f"{label}: a Piecewise has no code; take one of its formulas, such as .args[0][0]")
            raise ValueError(
                f"{label}: {kind} in {node} is outside the vocabulary; it has + - * /, rationals, pi, "
                f"powers by rationals, tan, {', '.join(sorted(FUNCTIONS.values()))}"
            )


def _nodes(e: Expr) -> list[Expr]:
    found, queue = [], [e]
    while queue:
        node = queue.pop()
        found.append(node)
        queue.extend(node.args)
    return found


def _in_vocabulary(e: Expr) -> bool:
    if isinstance(e, Rational) or e in (pi, S.Exp1) or isinstance(e, Symbol | Add | Mul | tan):
        return True
    if isinstance(e, Pow):
        return isinstance(e.exp, Rational)
    return e.func in FUNCTIONS


def _listed(symbols: set[Symbol]) -> str:
    return ", ".join(sorted(str(s) for s in symbols)) or "none"


class WordPrinter:
    """A printer of expressions that remembers the temporary names it gave and the words of the vocabulary it used."""

    def __init__(self, taken: set[str]) -> None:
        self.taken = taken
        self.names: dict[Symbol, str] = {}
        self.used: set[str] = set()
        self.before: list[tuple[str, str]] = []
        self.kept: dict[str, str] = {}
        self.count = 0

    def rename(self, symbol: Symbol) -> str:
        """Gives `symbol` the next free temporary name, and returns the name."""
        self.names[symbol] = self._fresh()
        return self.names[symbol]

    def assignment(self, e: Expr) -> tuple[list[tuple[str, str]], list[str]]:
        """The assignments that must come first, as pairs of name and text; and the terms of `e`, each with its sign."""
        self.before = []
        terms = [self._term(term, i > 0) for i, term in enumerate(_terms(e))]
        return self.before, terms

    def _fresh(self) -> str:
        name = f"c{self.count}"
        self.count += 1
        return self._fresh() if name in self.taken else name

    def _term(self, e: Expr, inner: bool) -> str:
        text, _ = self._print(e)
        if not inner:
            return text
        return f"- {text[1:]}" if text.startswith("-") else f"+ {text}"

    def _print(self, e: Expr) -> tuple[str, bool]:
        """The text of `e`; and whether it needs parentheses as a factor, because it is a sum or begins with a sign."""
        if isinstance(e, Symbol):
            return self.names.get(e, e.name), False
        if isinstance(e, Integer):
            return str(e), e < 0
        if isinstance(e, Rational):
            self.used.add("q")
            return f"q({e.p}, {e.q})" if e > 0 else f"-q({-e.p}, {e.q})", e < 0
        if e == pi:
            self.used.add("pi")
            return "pi", False
        if isinstance(e, Add):
            return " ".join(self._term(term, i > 0) for i, term in enumerate(_terms(e))), True
        if isinstance(e, Mul):
            return self._product(e)
        if isinstance(e, Pow) and e.exp.is_negative:
            return self._product(e)
        if isinstance(e, Pow):
            return self._power(e.base, e.exp), False
        return self._call(e), False

    def _call(self, e: Expr) -> str:
        if e == S.Exp1:
            self.used.add("exp")
            return "exp(1)"
        (argument,) = e.args
        if isinstance(e, tan):
            return self._product(sin(argument) / cos(argument))[0]
        word = FUNCTIONS[e.func]
        self.used.add(word)
        return f"{word}({self._print(argument)[0]})"

    def _product(self, e: Expr) -> tuple[str, bool]:
        coefficient, rest = e.as_coeff_Mul()
        sign, coefficient = ("-", -coefficient) if coefficient.is_negative else ("", coefficient)
        above, below = [], []
        for factor in rest.as_ordered_factors():
            if isinstance(factor, Pow) and factor.exp.is_negative:
                below.append(Pow(factor.base, -factor.exp))
            else:
                above.append(factor)
        if coefficient != 1 or not above:
            above.insert(0, coefficient)
        alone = len(above) == 1 and not below
        text = sign + "*".join(self._factor(factor, alone) for factor in above)
        if below:
            product = "*".join(self._factor(factor, False) for factor in below)
            text += "/" + (product if _closed(product) else f"({product})")
        return text, bool(sign)

    def _factor(self, e: Expr, alone: bool) -> str:
        text, enclosed = self._print(e)
        return f"({text})" if enclosed or ("/" in text and not alone) else text

    def _power(self, base: Expr, power: Rational) -> str:
        whole, part = divmod(power, 1)
        parts = [self._whole_power(self._named(base), int(whole))] if whole else []
        if part:
            inner = self._named(base) if whole else self._print(base)[0]
            root = f"sqrt({inner})" if part.q == 2 else f"{ROOT}({inner}, {part.q})"
            self.used.add("sqrt" if part.q == 2 else ROOT)
            parts.append(root if part.p == 1 else self._whole_power(self._kept(root), int(part.p)))
        return "*".join(parts)

    def _named(self, base: Expr) -> str:
        text = self._print(base)[0]
        return text if isinstance(base, Symbol) or base == pi else self._kept(text)

    def _whole_power(self, name: str, n: int) -> str:
        if n <= 3:
            return "*".join([name] * n)
        half = self._kept(self._whole_power(name, n // 2))
        return "*".join([half, half] + [name] * (n % 2))

    def _kept(self, text: str) -> str:
        """The name of the temporary that holds the value of `text`; its assignment is written once."""
        if text not in self.kept:
            self.kept[text] = self._fresh()
            self.before.append((self.kept[text], text))
        return self.kept[text]


def _closed(text: str) -> bool:
    """True for a name, a number, or one call or one pair of parentheses around everything."""
    depth = 0
    for character in text:
        depth += (character == "(") - (character == ")")
        if depth == 0 and character in "*/+- ":
            return False
    return True


def _terms(e: Expr) -> list[Expr]:
    """The terms of a sum in SymPy's printing order, but a positive term comes first if there is one."""
    if not isinstance(e, Add):
        return [e]
    terms = list(e.as_ordered_terms())
    first = next((t for t in terms if not t.could_extract_minus_sign()), terms[0])
    return [first, *(t for t in terms if t is not first)]


VOCABULARY = ("q", "pi", *sorted([*FUNCTIONS.values(), ROOT]))
WIDTH = 99


@dataclass(frozen=True)
class Kernel:
    """A generated function: its name, arguments, results, the words of the vocabulary that it uses, and its text."""

    name: str
    arguments: tuple[str, ...]
    results: tuple[str, ...]
    words: tuple[str, ...]
    text: str


def kernel(
    name: str,
    arguments: Sequence[Symbol],
    values: Mapping[str, Expr],
    definitions: Mapping[Symbol, Expr] | None = None,
    about: str = "",
) -> Kernel:
    """The function `name(*arguments)` that returns the tuple of `values`.

    `definitions` are named intermediate values; they may use one another, and keep their names.

    >>> from sympy import Rational, symbols
    >>> x = Symbol("x")
    >>> print(kernel("third", [x], {"third": x**2 / 3}).text)
    def third(x):
        third = q(1, 3)*x*x
        return (third,)
    <BLANKLINE>
    """
    steps = {symbol: S(e) for symbol, e in (definitions or {}).items()}
    results = {Symbol(result): S(e) for result, e in values.items()}
    known = {*arguments, *steps}
    for symbol, e in (*steps.items(), *results.items()):
        checked(f"{name}: {symbol}", e, known)
    names = {str(symbol) for symbol in known} | set(values)
    if reserved := names & set(VOCABULARY):
        raise ValueError(f"{name}: {min(reserved)} is a word of the vocabulary and cannot name a value")
    lines, words = _lines(_shared({**steps, **results}, names), list(results), names)
    body = "\n".join(f"    {line}" for line in lines)
    listed = ", ".join(values) + ("," if len(values) == 1 else "")
    docstring = f'    """{about}"""\n' if about else ""
    signature = f"def {name}({', '.join(str(a) for a in arguments)}):"
    answer = f"    return ({listed})" if len(values) == 1 else _wrapped("return ", list(values))
    text = f"{signature}\n{docstring}{body}\n{answer}\n"
    return Kernel(name, tuple(str(a) for a in arguments), tuple(values), tuple(sorted(words)), text)


@cache
def constant(value: Expr) -> Kernel:
    """A kernel without arguments that returns the exact number `value`; kernels are cached.

    >>> from fractions import Fraction
    >>> from sympy import Rational
    >>> from types import SimpleNamespace
    >>> load(constant(Rational(1, 3)), SimpleNamespace(q=Fraction))()
    (Fraction(1, 3),)
    """
    return kernel("constant", [], {"value": value})


def load(kernel: Kernel, arithmetic: NumberSystem[T]) -> Callable[..., Any]:
    """The kernel as a Python function over one number system, which defines the words of the vocabulary.

    Only here is generated text executed, and it can reach nothing but these words. `ValueError` if a word is missing.

    >>> from fractions import Fraction
    >>> from types import SimpleNamespace
    >>> made = kernel("third", [Symbol("x")], {"third": Symbol("x") / 3})
    >>> third = load(made, SimpleNamespace(q=Fraction))
    >>> third(Fraction(1, 2))
    (Fraction(1, 6),)
    """
    missing = [word for word in kernel.words if not hasattr(arithmetic, word)]
    if missing:
        known = [word for word in VOCABULARY if hasattr(arithmetic, word)]
        raise ValueError(f"{kernel.name}: this arithmetic has no {', '.join(missing)}; it has {', '.join(known)}")
    scope: dict[str, Any] = {"__builtins__": {}} | {word: getattr(arithmetic, word) for word in kernel.words}
    exec(compiled(kernel.text, kernel.name), scope)  # noqa: S102
    function: Callable[..., Any] = scope[kernel.name]
    return function


@cache
def compiled(text: str, name: str) -> CodeType:
    """The bytecode of a kernel's text, cached: compiling takes longer than most kernels run."""
    return compile(text, f"<kernel {name}>", "exec")


def module_text(kernels: Iterable[Kernel], source: str) -> str:
    """The text of a module of kernels, with a header that names the module they were generated from.

    >>> module_text([], "symbolic.motion.chords").splitlines()[0]
    '# Generated by symbolic.expressions.text from symbolic.motion.chords; edit that, not this.'
    """
    listed = list(kernels)
    words = sorted({word for k in listed for word in k.words})
    header = [
        f"# Generated by symbolic.expressions.text from {source}; edit that, not this.",
        f"# Words that the arithmetic must give a meaning to: {', '.join(words) or 'none'}.",
        *(["# ruff: noqa: F821"] if words else []),
    ]
    return "\n".join(header) + "\n\n\n" + "\n\n".join(k.text for k in listed)


def _shared(steps: dict[Symbol, Expr], taken: set[str]) -> dict[Symbol, Expr]:
    """`steps`, with common subexpressions as further steps under provisional names, which `_lines` will replace."""
    spare = (s for s in numbered_symbols("c") if s.name not in taken)
    found, reduced = cse(list(steps.values()), symbols=spare, order="canonical", list=True)
    meaning = dict(found)
    named: dict[Symbol, Symbol] = {}  # a temporary that is a named value under another name
    made: dict[Symbol, Expr] = {}
    for symbol, e in zip(steps, reduced, strict=True):
        if e in meaning and e not in named:
            named[e] = symbol
            e = meaning[e]
        made[symbol] = e
    made |= {symbol: e for symbol, e in found if symbol not in named}
    return {symbol: e.xreplace(named) for symbol, e in made.items()}


def _lines(steps: dict[Symbol, Expr], results: list[Symbol], names: set[str]) -> tuple[list[str], set[str]]:
    """The lines of assignments, in an order in which they can be executed; and the words of the vocabulary they use."""
    printer, lines = WordPrinter(names), list[str]()
    done: set[Symbol] = set()

    def write(symbol: Symbol) -> None:
        if symbol in done or symbol not in steps:
            return
        done.add(symbol)
        for needed in sorted(steps[symbol].free_symbols, key=_natural):
            write(needed)
        before, terms = printer.assignment(steps[symbol])
        for other, made in before:
            lines.extend(_folded(other, [made]))
        lines.extend(_folded(symbol.name if symbol.name in names else printer.rename(symbol), terms))

    for result in results:
        write(result)
    return lines, printer.used


def _natural(symbol: Symbol) -> tuple[str, int, str]:
    stem = symbol.name.rstrip("0123456789")
    return stem, int(symbol.name[len(stem) :] or 0), symbol.name  # the name tells `u` from `u0`


def _folded(name: str, terms: list[str]) -> list[str]:
    line = f"{name} = {' '.join(terms)}"
    if len(line) + 4 <= WIDTH or len(terms) == 1:
        return [line]
    return [f"{name} = (", *_filled(terms, " ", WIDTH - 8), ")"]


def _filled(parts: list[str], gap: str, width: int) -> list[str]:
    rows = [""]
    for part in parts:
        if rows[-1] and len(rows[-1]) + len(gap) + len(part) > width:
            rows.append("")
        rows[-1] += (gap if rows[-1] else "") + part
    return [f"    {row}" for row in rows]


def _wrapped(word: str, names: list[str]) -> str:
    line = f"    {word}{', '.join(names)}"
    if len(line) <= WIDTH:
        return line
    rows = _filled([f"{n}," for n in names], " ", WIDTH - 8)
    return "\n".join([f"    {word}(", *(f"    {row}" for row in rows), "    )"])
