"""Functions that no table of the paper needs, for `check.py`; the headline results rest on that file alone.

They are `exp`, `log`, `tan`, `atan`, `sinh`, `cosh`, `tanh`, `abs`, the number `E`, and powers with fractional
exponents, on intervals with integer ends and on jets.
"""

from fractions import Fraction
from functools import cache
from math import prod

from check import I, Jet, function, need, pi, taylor, value

HALF, LARGEST = Fraction(1, 2), 708  # an exponent of e: what is larger has a power above 2**1020


def point(end, p):
    return I(end, end, p)


def hull(each, x):
    """An increasing function over an interval, from its enclosures at both ends."""
    return each(point(x.lo, x.p)).hull(each(point(x.hi, x.p)))


@cache
def log2(p):
    """The number log 2 = 2*artanh(1/3)."""
    return I.of(artanh(I.of(Fraction(1, 3), p + 32)) * 2, p)


def artanh(x):
    """The series x + x**3/3 + x**5/5 + ... for `abs(x) <= 1/3`: the rest after a term is less than its power of x."""
    total, high, n = x, x, 1
    while high.size().lo > 1:
        n += 2
        high = high * x * x
        total = total + high * Fraction(1, n)
    return total.wide(high)


def twos(x):
    """About how often log 2 is contained in a number: any whole number is correct."""
    return int(x.real() / 0.6931471805599453)


def exp_at(x):
    """The exponential at a point: 2**k times the exponential of the rest, at most about log 2, by Taylor's series."""
    need(x.lo < LARGEST << x.p, "an exponential is too large")
    if x.lo < -x.p << x.p:
        return I(0, 1, x.p)
    k = twos(x)
    w = x.p + 64 + abs(k)
    r = I.of(x, w) - log2(w) * k
    total, term, n = I.of(1, w), I.of(1, w), 0
    while term.size().lo > 1:  # what follows a term is less than that term
        n += 1
        term = term * r * Fraction(1, n)
        total = total + term
    total = total.wide(term)
    return I.of(I(total.lo, total.hi, w - k), x.p)


def log_at(x):
    """The logarithm at a point above 0: k*log 2 plus that of m in [1/2, 1], which is 2*artanh((m - 1)/(m + 1))."""
    need(x.lo > 0, "a logarithm of what may not be positive")
    bits, w = x.lo.bit_length(), x.p + 64
    m = I.of(point(x.lo, bits), w)
    return I.of(artanh((m - 1) / (m + 1)) * 2 + log2(w) * (bits - x.p), x.p)


def tanh_at(x):
    """The hyperbolic tangent (1 - u)/(1 + u) with u = exp(-2*x)."""
    if x.lo < 0:
        return -tanh_at(-x)
    u = exp_at(point(-2 * x.lo, x.p))
    return (1 - u) / (u + 1)


def atan_at(x):
    """The arctangent at a point, from that of 1/x where x is large."""
    if x.lo < 0:
        return -atan_at(-x)
    return x.atan() if x.lo <= 2 << x.p else pi(x.p) / 2 - (1 / x).atan()


def at_number(name, at, exponent):
    """A function at an interval: all are increasing except a power, which is reduced to one of them."""
    if name == "power":
        need(at > 0, "a root of what may not be positive")
        return hull(exp_at, hull(log_at, at) * exponent)
    return hull({"exp": exp_at, "log": log_at, "tanh": tanh_at, "atan": atan_at}[name], at)


def series(name, x, p, exponent=None):
    """A function of a number or, by Taylor's series to third order, of a jet."""
    at = I.of(value(x), p)
    y = at_number(name, at, exponent)
    if not isinstance(x, Jet):
        return y
    if name == "exp":
        return taylor(x, [y, y, y / 2, y / 6])
    if name == "tanh":
        slope = 1 - y * y
        return taylor(x, [y, slope, -y * slope, slope * (y * y * 3 - 1) / 3])
    if name == "atan":
        r = 1 / (at * at + 1)
        return taylor(x, [y, r, -at * r * r, (at * at * 3 - 1) * r * r * r / 3])
    r, terms = 1 / at, [y]
    if name == "log":
        return taylor(x, [y, r, -r * r / 2, r * r * r / 3])
    for k in range(3):
        terms.append(terms[-1] * r * (exponent - k) / (k + 1))
    return taylor(x, terms)


def power(x, dx, exponent, p):
    """A power and its derivative; where the base may be 0, only a root, without derivative."""
    if exponent.denominator == 1:
        low = prod([x] * (abs(int(exponent)) - 1), start=I.of(1, p))
        if exponent < 0:
            low = function("inverse", low * x * x, p)
        return low * x, dx and low * dx * exponent
    at = I.of(value(x), p)
    if at.lo == 0 < exponent and not isinstance(x, Jet) and not dx:
        top = series("power", point(at.hi, p), p, exponent) if at.hi else at
        return I(0, top.hi, p), 0
    return series("power", x, p, exponent), dx and series("power", x, p, exponent - 1) * dx * exponent


def square(x):
    """The square of an interval, which is not below 0."""
    y = x * x
    return I(max(0, y.lo), y.hi, y.p) if isinstance(y, I) else y


def called(name, x, dx, p):
    """A function of this vocabulary and its derivative; None for another function."""
    if name in ("exp", "tanh", "log", "atan"):
        y = series(name, x, p)
        slopes = {"exp": lambda: y, "tanh": lambda: 1 - y * y, "log": lambda: function("inverse", x, p)}
        slopes["atan"] = lambda: function("inverse", square(x) + 1, p)
        return y, dx and slopes[name]() * dx
    if name == "sqrt":
        return power(x, dx, HALF, p)
    if name == "tan":
        y = function("sin", x, p) * function("inverse", function("cos", x, p), p)
        return y, dx and (y * y + 1) * dx
    if name in ("sinh", "cosh"):
        e, f = series("exp", x, p) * HALF, series("exp", -x, p) * HALF
        return (e - f, dx and (e + f) * dx) if name == "sinh" else (e + f, dx and (e - f) * dx)
    if name in ("abs", "Abs"):
        at = I.of(value(x), p)
        if at > 0 or at < 0:
            return (x, dx) if at > 0 else (-x, -dx)
        need(not isinstance(x, Jet) and not dx, "a modulus has no slope where it may be 0")
        return I(0, at.size().hi, p), 0
    return None


def meaning(kind, mark, parts, p):
    """The value of a formula's node (a name, an operation, a call) from those of its parts; None if it is unknown.

    A part is a value and its derivative by theta.
    """
    if kind == "Name" and mark == "E":
        return series("exp", 1, p), 0
    if kind == "UnaryOp" and mark == "UAdd":
        return parts[0]
    if kind == "BinOp" and mark == "Pow" and isinstance(parts[1][0], Fraction):
        exponent = parts[1][0]
        fit = abs(exponent) <= 64 and exponent.denominator <= 12 and exponent
        return power(*parts[0], exponent, p) if fit else None
    return called(mark, *parts[0], p) if len(parts) == 1 else None  # of what has one part only calls have a known name
