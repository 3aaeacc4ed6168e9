"""A proof that two formulas are equal for every value of their letters, for `check.py`. No number is rounded.

A formula becomes a sum of fractions times products of powers of *atoms*: letters, `pi`, `E`, prime numbers (for their
roots), and functions of such sums. Two formulas are equal if their difference is the empty sum; otherwise nothing is
decided. The rules are those of fractions, `x**a * x**b = x**(a + b)`, values of sines and cosines at multiples of
`pi/6` and `pi/4`, their parity and shifts by `pi/2`, and values of functions at 0.
"""

import ast
from fractions import Fraction
from math import isqrt

from check import need

TERMS, BITS, PRIMES = 200, 20_000, (2, 3, 5, 7, 11, 13)  # the largest sum; bits of a fraction; whose roots are known
ONE, HALF = frozenset(), Fraction(1, 2)
AT_0 = {"exp": 1, "cosh": 1, "atan": 0, "sinh": 0, "tanh": 0, "abs": 0, "Abs": 0}
ODD, EVEN = ("sin", "atan", "sinh", "tanh"), ("cos", "cosh", "abs", "Abs")


def number(x):
    return {ONE: Fraction(x)} if x else {}


def atom(key, exponent=1):
    return {frozenset([(key, Fraction(exponent))]): Fraction(1)}


def plus(x, y, sign=1):
    return added([*x.items(), *((of, sign * c) for of, c in y.items())])


def added(terms):
    found = {}
    for of, c in terms:
        found[of] = found.get(of, 0) + c
    found = {of: c for of, c in found.items() if c}
    large = max((max(c.numerator.bit_length(), c.denominator.bit_length()) for c in found.values()), default=0)
    need(len(found) <= TERMS and large <= BITS, "a formula is too long to be multiplied out")
    return found


def times(x, y):
    need(len(x) * len(y) <= TERMS * 8, "a formula is too long to be multiplied out")
    return added(term for a, c in x.items() for b, d in y.items() for term in product(dict(a), b, c * d).items())


def product(powers, other, c):
    """The product of two monomials: whole powers of primes become fractions, and powers of sums are expanded."""
    for key, exponent in other:
        powers[key] = powers.get(key, Fraction(0)) + exponent
    again = []
    for key, exponent in [*powers.items()]:
        if isinstance(key, int) and exponent.denominator == 1:
            c *= Fraction(key) ** int(exponent)
        elif isinstance(key, frozenset) and exponent.denominator == 1 and exponent > 0:
            again += [dict(key)] * int(exponent)
        elif exponent:
            continue
        del powers[key]
    found = {frozenset(powers.items()): c}
    for sum_of in again:
        found = times(found, sum_of)
    return found


def power(x, exponent):
    """A power of a sum: a whole power is expanded; a root of other than a fraction times positive atoms is an atom."""
    need(abs(exponent) <= 64, "a power has an exponent out of range")
    if exponent.denominator == 1 and exponent >= 0:
        found = number(1)
        for _ in range(int(exponent)):
            found = times(found, x)
        return found
    need(x, "a power of 0 may have no value")
    if len(x) > 1:
        lead = max(x, key=order)
        if exponent.denominator > 1 or x[lead] == 1:
            return atom(frozenset(x.items()), exponent)
        return times(number(x[lead] ** int(exponent)), power(times(x, number(1 / x[lead])), exponent))
    ((of, c),) = x.items()
    if exponent.denominator == 1:
        return product({}, [(key, e * exponent) for key, e in of], c ** int(exponent))
    if c < 0 or any(not (isinstance(key, int) or key in ("pi", "E")) for key, _ in of):
        return atom(frozenset(x.items()), exponent)
    roots = product({}, [(key, e * exponent) for key, e in of], Fraction(1))
    return times(times(roots, root(c.numerator, exponent)), root(c.denominator, -exponent))


def quotient(x, y, inverse):
    """The number by which one sum is a multiple of the other."""
    ratios = {x[of] / c for of, c in y.items()} if {*x} == {*y} else ()
    return number(*ratios) if len(ratios) == 1 else times(x, inverse)


def root(n, exponent):
    found = number(1)
    for prime in PRIMES:
        while n % prime == 0:
            n, found = n // prime, times(found, atom(prime, exponent))
    whole = isqrt(n)
    n, exponent = (whole, 2 * exponent) if whole * whole == n else (n, exponent)
    return found if n == 1 else times(found, product({}, [(n, exponent)], Fraction(1)))


def order(of):
    """A sort key of monomials; any consistent order is correct."""
    return sorted((text(key), exponent) for key, exponent in of)


def text(key):
    if isinstance(key, tuple | frozenset):
        return repr(sorted(map(text, key)) if isinstance(key, frozenset) else [*map(text, key)])
    return str(key)


def function(name, x):
    """A function of a sum, simplified by the rules."""
    if name == "tan":
        return times(function("sin", x), power(function("cos", x), Fraction(-1)))
    if name == "sqrt":
        return power(x, HALF)
    if name in ("sin", "cos"):
        turn = x.get(frozenset([("pi", Fraction(1))]), Fraction(0))
        rest = {of: c for of, c in x.items() if of != frozenset([("pi", Fraction(1))])}
        return sine(turn + (HALF if name == "cos" else 0), rest)
    if not x and name in AT_0:
        return number(AT_0[name])
    if name == "log" and x == number(1):
        return {}
    if x and name in ODD + EVEN and x[max(x, key=order)] < 0:
        return plus({}, function(name, plus({}, x, -1)), -1 if name in ODD else 1)
    return atom((name, frozenset(x.items())))


def sine(turn, rest):
    """The sine of `turn*pi` plus a rest, reduced to the first quarter, with a positive first sign of the rest."""
    turn %= 2
    if rest and rest[max(rest, key=order)] < 0:  # sin(x) = sin(pi - x)
        return sine(1 - turn, plus({}, rest, -1))
    if turn >= 1:
        return plus({}, sine(turn - 1, rest), -1)
    if not rest and turn > HALF:
        return sine(1 - turn, rest)
    known = {Fraction(0): number(0), Fraction(1, 6): number(HALF), HALF: number(1)}
    known |= {Fraction(1, 4): power(number(HALF), HALF), Fraction(1, 3): power(number(Fraction(3, 4)), HALF)}
    if not rest and turn in known:
        return known[turn]
    return atom(("sin", turn, frozenset(rest.items())))


def slope(name, x):
    """The derivative of the function `name` at a sum `x`, again as a sum."""
    if name in ("exp", "sinh", "cosh"):
        return function({"exp": "exp", "sinh": "cosh", "cosh": "sinh"}[name], x)
    if name in ("sin", "cos"):
        return function("cos", x) if name == "sin" else plus({}, function("sin", x), -1)
    need(name in ("log", "atan", "tanh", "tan", "sqrt"), "a modulus has no slope in such a formula")
    if name == "sqrt":
        return times(number(HALF), power(x, -HALF))
    square = lambda y: times(y, y)  # noqa: E731
    if name in ("tanh", "tan"):
        return plus(number(1), square(function(name, x)), -1 if name == "tanh" else 1)
    return power(plus(number(1), square(x)) if name == "atan" else x, Fraction(-1))


def exact(node, names):
    """A formula and its derivative by theta as such sums; `names` has the sums of letters with a value."""
    if isinstance(node, ast.Constant):
        return number(node.value), {}
    if isinstance(node, ast.Name):
        return names.get(node.id) or (atom(node.id) if node.id not in names else {}), number(int(node.id == "theta"))
    if isinstance(node, ast.UnaryOp):
        x, dx = exact(node.operand, names)
        return (plus({}, x, -1), plus({}, dx, -1)) if isinstance(node.op, ast.USub) else (x, dx)
    if isinstance(node, ast.Call):
        x, dx = exact(node.args[0], names)
        return function(node.func.id, x), dx and times(slope(node.func.id, x), dx)
    (x, dx), (y, dy) = exact(node.left, names), exact(node.right, names)
    if isinstance(node.op, ast.Add | ast.Sub):
        sign = -1 if isinstance(node.op, ast.Sub) else 1
        return plus(x, y, sign), plus(dx, dy, sign)
    if isinstance(node.op, ast.Div):
        inverse = power(y, Fraction(-1))
        dy = dy and plus({}, times(times(inverse, inverse), dy), -1)
        return quotient(x, y, inverse), plus(times(dx, inverse), times(x, dy))
    if isinstance(node.op, ast.Mult):
        return times(x, y), plus(times(dx, y), times(x, dy))
    need(isinstance(node.op, ast.Pow) and {*y} <= {ONE} and not dy, "a power has an exponent that is no fraction")
    exponent = y.get(ONE, Fraction(0))
    return power(x, exponent), dx and times(times(number(exponent), power(x, exponent - 1)), dx)
