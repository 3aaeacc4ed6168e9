"""What an expression read from a formula may be, so that everything done with it stays cheap.

SymPy's numerical tests take twice as long for each level of an irrational constant, and its
roots factor the number under them; a short formula can otherwise ask for a day of work.
"""

from functools import lru_cache
from itertools import islice

from sympy import Abs, Add, E, Expr, Mul, Pow, Rational, S, Symbol, atan, cos, exp, log, pi, sin, tan
from sympy.core.traversal import preorder_traversal

EXPONENT = 64  # largest modulus of an exponent
NODES = 1500  # largest number of operations, names and numbers
LEVELS = 60  # deepest nesting of operations
CONSTANT_LEVELS = 10  # the same inside an irrational constant
BITS = 1400  # largest numerator or denominator; 400 decimal digits fit
ARGUMENT = 10**6  # largest modulus of a constant inside a function
VOCABULARY = (Add, Mul, Pow, Rational, Symbol, type(pi), type(E), Abs, atan, cos, exp, log, sin, tan)


def flaw(value: Expr) -> tuple[str, str] | None:
    """What is wrong with `value`, and what would be accepted; None when it may stay.

    >>> from symbolic.tables.symbols import theta
    >>> flaw(theta**65)
    ('the exponent 65 is not accepted', 'an integer or half-integer between -64 and 64')
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


def _flaw_at(node: Expr) -> tuple[str, str] | None:
    if node.is_finite is False:
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
    if node.func is exp and is_huge(node.args[0]):
        return "the argument of exp is too large", ARGUMENTS
    return None


EXPONENTS = f"an integer or half-integer between -{EXPONENT} and {EXPONENT}"
ARGUMENTS = f"a modulus of at most {ARGUMENT}"


def is_exponent(value: Expr) -> bool:
    """Whether `value` may be an exponent.

    >>> is_exponent(Rational(3, 2)), is_exponent(Rational(1, 3))
    (True, False)
    """
    return isinstance(value, Rational) and value.q <= 2 and abs(value) <= EXPONENT


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
    """How deeply operations are nested in `value`.

    >>> levels(1 + 2 * pi)
    2
    """
    return 1 + max(levels(part) for part in value.args) if value.args else 0
