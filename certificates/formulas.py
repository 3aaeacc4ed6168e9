"""Words of formulas that no table of the paper needs, for `check.py`; the headline results rest on that file alone.

`exp`, `log`, `tan`, `atan`, `sinh`, `cosh`, `tanh`, `abs`, `E`, and powers with fractions for exponents, as intervals
with integer ends and as jets.
"""

from fractions import Fraction
from functools import cache
from math import prod

from check import I, Jet, function, need, pi, taylor, value

HALF, LARGEST = Fraction(1, 2), 2**16  # of an exponent of e


def hull(each, x):
    """A growing function over an interval, from what encloses it at both ends."""
    return each(I(x.lo, x.lo, x.p)).hull(each(I(x.hi, x.hi, x.p)))


@cache
def log2(p):
    """log 2 = 2*(1/3 + (1/3)**3/3 + (1/3)**5/5 + ...)."""
    w = p + 32
    terms = [(2 << w) // (n * 3**n) for n in range(1, w, 2)]  # each at most one unit too small; 9**(w/2) > 2**w
    return I.of(I(sum(terms), sum(terms) + len(terms) + 2, w), p)


def exp_at(x):
    """At a point, 2**k times the exponential of what is left: at most log 2, by Taylor's series."""
    need(x.lo < LARGEST << x.p, "an exponential is too large")
    if x.lo < -(x.p + 1) << x.p:
        return I(0, 1, x.p)
    k = int(x.real() / 0.6931471805599453)
    w = x.p + 64 + max(0, k)
    r = I.of(x, w) - log2(w) * k
    y, total, term, n = r.mid().lo, 0, 1 << w, 0
    slack = (r.hi - r.mid().lo) * 4 + 32  # no slope is above 4
    while abs(term) > 1:  # each term is at most 4 units off, and what follows the last one at most 16
        total, slack, n = total + term, slack + 4, n + 1
        term = (term * y >> w) // n
    return I.of(I(max(0, total - slack), total + slack, w - k), x.p)


def log_at(x):
    """At a point above 0, k*log 2 more than that of m in [1/2, 1], which is 2*artanh((m - 1)/(m + 1))."""
    need(x.lo > 0, "a logarithm of what may not be positive")
    bits, w = x.lo.bit_length(), x.p + 64
    m = I.of(I(x.lo, x.lo, bits), w)
    z = (m - 1) / (m + 1)
    y, total, n = z.mid().lo, 0, 1
    square, term, slack = y * y >> w, y, (z.hi - y) * 2 + 16  # no slope is above 9/8
    while abs(term) > 1:  # each term is at most 3 units off, and what follows the last one at most 16
        total, slack, n = total + term // n, slack + 4, n + 2
        term = term * square >> w
    return I.of(I(total - slack, total + slack, w) * 2 + log2(w) * (bits - x.p), x.p)


def tanh_at(x):
    """(1 - u)/(1 + u) with u = exp(-2*abs(x))."""
    u = exp_at(I(-2 * abs(x.lo), -2 * abs(x.lo), x.p))
    return (1 - u) / (u + 1) * (1 if x.lo > 0 else -1)


def atan_at(x):
    """By the angle of 1/x where x is large."""
    if abs(x.lo) <= 2 << x.p:
        return x.atan()
    return (pi(x.p) if x.lo > 0 else -pi(x.p)) / 2 - (1 / x).atan()


def at_number(name, at, exponent):
    """The function at an interval: all of these grow, but for a power, which is one of them of another."""
    if name == "power":
        need(at > 0, "a root of what may not be positive")
        return hull(exp_at, hull(log_at, at) * exponent)
    return hull({"exp": exp_at, "log": log_at, "tanh": tanh_at, "atan": atan_at}[name], at)


def series(name, x, p, exponent=None):
    """A function of a number or, by Taylor's series up to the third term, of a jet."""
    at = I.of(value(x), p)
    y = at_number(name, at, exponent)
    if not isinstance(x, Jet):
        return y
    if name == "exp":
        terms = [y, y, y / 2, y / 6]
    elif name == "tanh":
        slope = 1 - y * y
        terms = [y, slope, -y * slope, slope * (y * y * 3 - 1) / 3]
    elif name == "atan":
        r = 1 / (at * at + 1)
        terms = [y, r, -at * r * r, (at * at * 3 - 1) * r * r * r / 3]
    else:
        r = 1 / at
        terms = [y, r, -r * r / 2, r * r * r / 3] if name == "log" else [y]
        for k in range(3 if name == "power" else 0):
            terms.append(terms[-1] * r * (exponent - k) / (k + 1))
    return taylor(x, terms[: x.degree + 1])


def power(x, dx, exponent, p):
    """A power and its derivative; of what may be 0 only a root, and not its slope."""
    if exponent.denominator == 1 and exponent:
        low = prod([x] * (abs(int(exponent)) - 1), start=I.of(1, p))
        if exponent < 0:
            low = function("inverse", low * x * x, p)
        return low * x, dx and low * dx * exponent
    at = I.of(value(x), p)
    if at.lo == 0 < exponent and not isinstance(x, Jet) and not dx:
        top = power(I(at.hi, at.hi, p), 0, exponent, p)[0] if at.hi else at
        return I(0, top.hi, p), 0
    return series("power", x, p, exponent), dx and series("power", x, p, exponent - 1) * dx * exponent


def square(x):
    """Not below 0, also over an interval around 0."""
    y = x * x
    return I(max(0, y.lo), y.hi, y.p) if isinstance(y, I) else y


def called(name, x, dx, p):
    """A function of this vocabulary and its derivative; None for another."""
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
    """A formula from what it is (a name, an operation, a call of one argument) and its parts; None if it says nothing.

    A part is a value and its derivative by theta."""
    if kind == "Name" and mark == "E":
        return series("exp", 1, p), 0
    if kind == "UnaryOp" and mark == "UAdd":
        return parts[0]
    if kind == "BinOp" and mark == "Pow" and isinstance(parts[1][0], Fraction):
        exponent = parts[1][0]
        fit = abs(exponent) <= 64 and exponent.denominator <= 12 and exponent
        return power(*parts[0], exponent, p) if fit else None
    return called(mark, *parts[0], p) if kind == "Call" and len(parts) == 1 else None
