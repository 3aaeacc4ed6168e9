"""An independent checker of certificates: `python check.py FILE...`, with Python's standard library only.

It shares no code with the package that writes them. Numbers are intervals whose ends are integers over a power of two;
the map is given by formulas in jets (Taylor polynomials). Interval Newton theorem: if N = m - F'(X)^-1 F(m) lies inside
the box X with middle m, then F has one zero in X, it is in N, and F' is regular there. See docs/certificate_format.md.
"""

import ast
import re
import sys
from decimal import Decimal
from fractions import Fraction
from functools import cache, lru_cache
from importlib import import_module
from math import atan, isqrt, prod
from pathlib import Path

Wrong, Unproved = (type(name, (Exception,), {}) for name in ("Wrong", "Unproved"))  # no certificate; not proved
value = lambda x: x.c[0] if isinstance(x, Jet) else x
left = [10**9]  # the remaining steps of formulas for a file
parse = lambda text: beside("entries").parse(text)  # the tree of a formula
pi = cache(lambda p: I.of(I.of(1, p + 8).atan() * 4, p))
PAPER = {  # the shape's letter, and the components: x and y, or one formula for the radius, and the ends of theta
    "circle": ("", [("1", "-pi", "pi")]),
    "ellipse": ("a", [("a*cos(theta)", "sin(theta)", "-pi", "pi")]),
    "cardioid": ("", [("1+cos(theta)", "-pi", "pi")]),
    "cuspless": ("", [("1+cos(theta)", "-2*pi/3", "2*pi/3"), ("-1/4", "-theta", "-sqrt(3)/4", "sqrt(3)/4")]),
    "egg": ("alpha", [("1+alpha*cos(K*theta)", "-pi", "pi")]),
}
ITEMS = ["exists", "unique", "precise", "admissible", "minimal_period"]
NORMAL = ["simple_multiplier", "transversal", "nondegenerate", "other_multiplier_stable"]
KINDS = {"cycle": ITEMS, "fold": ITEMS + NORMAL, "flip": ITEMS + NORMAL, "focus": ITEMS}
KINDS["corner"] = [*ITEMS, "s4_minimum_at_a_kink", "s4_dips_below", "unstable"]
KINDS["tangency"] = ["saddle", "remainder", "exists", "unique", "admissible", "quadratic", "transversal"]
SAYS = dict.fromkeys(KINDS, "{scene}: exactly one cycle with {n} and {free} in the box has {what}.")
SAYS |= {
    "cycle": "{scene}: exactly one cycle has {n} in the box.",
    "corner": "{scene}: exactly one orbit with theta and lam in the box runs from the upper corner to theta, the lower "
    "corner, -theta and back; it is unstable; as a function of the exit angle s_4 has a minimum at a kink there, which "
    "falls as lam grows; the value is {free}.",
    "tangency": "{scene}: manifolds of the two saddles touch at exactly one lam in the box, quadratically, and pass "
    "through each other as lam varies.",
}
WHAT = {"fold": "the multiplier 1: a fold", "flip": "the multiplier -1: a flip", "focus": "two equal multipliers"}
length = lambda degree: (degree + 1) * (degree + 2) * (degree + 3) // 6  # the number of coefficients in three letters
FACTORS = Fraction(1), Fraction(1), Fraction(1, 2), Fraction(1, 6)  # of Taylor's series
WAYS, SHORT = ("table", "polar", "parametric", "component"), 32  # forms of a boundary; bounces of a short cycle
BITS, VALUES = 16_384, 1020  # bits of numbers after and before the point


def need(holds, why, error=Unproved):
    if not holds:
        raise error(why)


def beside(name):
    """The module in a file of this folder, loaded when a document needs it."""
    sys.modules.setdefault("check", sys.modules[__name__])
    sys.path += {str(Path(__file__).parent)} - {*sys.path}
    return import_module(name)


class Number:  # operations that follow from sum, product and sign
    __radd__ = lambda self, o: self + o
    __rmul__ = lambda self, o: self * o
    __sub__ = lambda self, o: self + (-o)
    __rsub__ = lambda self, o: -self + o


class I(Number):
    """The interval [lo, hi] * 2**-p, with integers lo <= hi; every operation encloses all values of the real one."""

    def __init__(self, lo, hi, p):
        self.lo, self.hi, self.p = lo, hi, p

    @staticmethod
    def of(x, p):
        if isinstance(x, I):
            k = p - x.p
            return I(x.lo << k, x.hi << k, p) if k > 0 else I(x.lo >> -k, -(-x.hi >> -k), p) if k < 0 else x
        return I((x.numerator << p) // x.denominator, -((-x.numerator << p) // x.denominator), p)

    def __add__(self, o):
        if isinstance(o, Jet):
            return NotImplemented
        o = o if isinstance(o, I) else I.of(o, self.p)
        return I(self.lo + o.lo, self.hi + o.hi, self.p)

    def __mul__(self, o):
        if isinstance(o, Jet):
            return NotImplemented
        if not isinstance(o, I):  # an exact number, which may be smaller than the last place
            low, high = sorted((self.lo * o.numerator, self.hi * o.numerator))
            return I(low // o.denominator, -(-high // o.denominator), self.p)
        ends = self.lo * o.lo, self.lo * o.hi, self.hi * o.lo, self.hi * o.hi
        return I(min(ends) >> self.p, -(-max(ends) >> self.p), self.p)

    def __truediv__(self, o):
        o, one = I.of(o, self.p), 1 << 2 * self.p
        need(not o.lo <= 0 <= o.hi, "a divisor may be 0")
        return self * I(one // o.hi, -(-one // o.lo), self.p)

    __rtruediv__ = lambda self, o: I.of(o, self.p) / self
    __neg__ = lambda self: I(-self.hi, -self.lo, self.p)
    __gt__ = lambda self, x: self.lo > x << self.p
    __lt__ = lambda self, x: self.hi < x << self.p
    __contains__ = lambda self, x: self.lo <= x << self.p <= self.hi
    mid = lambda self: I((self.lo + self.hi) >> 1, (self.lo + self.hi) >> 1, self.p)
    size = lambda self: I(max(-self.lo, self.hi), max(-self.lo, self.hi), self.p)  # the largest |x|
    width = lambda self: self.hi - self.lo
    real = lambda self: (self.lo + self.hi) / (2 << self.p)  # a double near the middle
    meet = lambda self, o: I(max(self.lo, o.lo), min(self.hi, o.hi), self.p)
    hull = lambda self, o: I(min(self.lo, o.lo), max(self.hi, o.hi), self.p)
    inside = lambda self, o: o.lo < self.lo and self.hi < o.hi  # in the interior
    wide = lambda self, o: I(self.lo - o.size().lo, self.hi + o.size().lo, self.p)

    @lru_cache(maxsize=99)  # one interval is asked for both, and more than once
    def sin_cos(self):
        """The sine and the cosine: those of the middle, by Taylor's series, plus or minus the radius."""
        m, p, one = self.mid(), self.p, 1 << self.p
        r, w = self.hi - m.lo, 32 + max(p, m.lo.bit_length())  # a huge argument takes as many more bits of pi
        k = round(Fraction(2 * m.lo << w - p, pi(w).lo)) if abs(m.lo) > one else 0
        x = I.of(m, w) - (pi(w) * Fraction(k, 2) if k else 0)
        y, total, slack, n = x.mid().lo, 0, x.hi - x.mid().lo + 16, 1
        term, square = y, y * y >> w
        while abs(term) > 1:  # each term is at most 4 units off, and what follows the last one at most 16
            total, slack, n = total + term, slack + 4, n + 2
            term = -(term * square >> w) // (n * (n - 1))
        other = isqrt((1 << 2 * w) - total * total)  # the cosine: of angles up to 1 with a slope of at most 2
        s, c = (I.of(I(v - off, v + off, w), p) for v, off in ((total, slack), (other, 2 * slack + 2)))
        turned = ((s, c), (c, -s), (-s, -c), (-c, s))[k % 4]
        return [I(max(f.lo - r, -one), min(f.hi + r, one), p) for f in turned]

    def atan(self):
        """The arctangent at both ends, by Newton's method: d = y - atan(x), sin(d)*sqrt(1+x^2) = sin(y) - x*cos(y)."""
        ends = []
        for x in (I(self.lo, self.lo, self.p), I(self.hi, self.hi, self.p)):
            y = I.of(Fraction(atan(x.real())), x.p).mid()
            for _ in range((x.p // 50).bit_length() + 1):  # from 50 bits twice as many each time
                s, c = y.sin_cos()
                y = (y + (x * c - s) / (c + x * s)).mid()
            s, c = y.sin_cos()
            need(c + x * s > 0 and y.size() < 2, "an angle too near pi/2")  # so cos(d) > 0, and abs(d) < 4
            ends.append(y.wide((s - x * c) * 2))  # |d| <= (pi/2)*|sin(d)|
        return ends[0].hull(ends[1])


@cache
def algebra(degree):
    """The exponents of the coefficients in order, the index of each, and for each the pairs whose product it is."""
    powers = [(a, b, d - a - b) for d in range(degree + 1) for a in range(d + 1) for b in range(d - a + 1)]
    at = {e: i for i, e in enumerate(powers)}
    rest = lambda e, d: at.get(tuple(a - b for a, b in zip(e, d)))
    return powers, at, [[(i, rest(e, d)) for i, d in enumerate(powers) if rest(e, d) is not None] for e in powers]


class Jet(Number):
    """A polynomial in three letters up to a degree; over a box it encloses the Taylor coefficients at every point."""

    def __init__(self, c, degree):
        self.c, self.degree = c, degree

    @staticmethod
    def of(x, degree, *letter):  # none: a number
        return Jet([x, *(int(3 - k in letter) for k in range(1, length(degree)))], degree)

    def __add__(self, o):
        if isinstance(o, Jet):
            return Jet([a + b for a, b in zip(self.c, o.c)], self.degree)
        return Jet([self.c[0] + o, *self.c[1:]], self.degree)

    def __mul__(self, o):
        if not isinstance(o, Jet):
            return Jet([a * o if a != 0 else 0 for a in self.c], self.degree)
        c = []
        for pairs in algebra(self.degree)[2]:
            low = high = total = p = 0
            for x, y in [(self.c[i], o.c[j]) for i, j in pairs]:
                if type(x) is type(y) is I:  # the sum of such products is rounded once
                    ends, p = (x.lo * y.lo, x.lo * y.hi, x.hi * y.lo, x.hi * y.hi), x.p
                    low, high = low + min(ends), high + max(ends)
                elif x != 0 and y != 0:  # an interval never equals a number
                    total = x * y + total
            c.append(total + I(low >> p, -(-high >> p), p) if p else total)
        return Jet(c, self.degree)

    __neg__ = lambda self: Jet([-a for a in self.c], self.degree)
    gradient = lambda self, p: [I.of(a, p) for a in self.c[3:0:-1]]

    def diff(self, letter):
        """The derivative by a letter, of one degree less."""
        at = algebra(self.degree)[1]
        return Jet([self.c[i] * e[letter] for e, i in at.items() if e[letter]], self.degree - 1)

    def tighten(self, m, off, p):
        """The coefficients over boxes from those at the middle, m, and the next; or the value from another jet's."""
        for d in reversed(range(m.degree + 1 if off else 1)):  # the higher ones first, on which the lower ones rest
            slopes = [self.diff(k).c for k in range(3)] if off else []
            for i in range(length(d - 1), length(d)):
                self.c[i] = I.of(self.c[i], p).meet(sum((s[i] * o for s, o in zip(slopes, off or ())), I.of(m.c[i], p)))


def function(name, x, p):
    """`sin`, `cos`, `atan` or `1/x` of a number or a jet of degree at most 3."""
    d, at, one = (x.degree if isinstance(x, Jet) else 0), I.of(value(x), p), I.of(1, p)
    if name in ("sin", "cos"):
        s, c = at.sin_cos()
        terms = [f * by for f, by in zip((s, c, -s, -c) if name == "sin" else (c, -s, -c, s), FACTORS[: d + 1])]
    else:
        r = one / (at * at + 1 if name == "atan" else at)
        tangent = [at.atan(), r, -at * r * r, (at * at * 3 - 1) * r * r * r / 3] if name == "atan" else []
        terms = (tangent or [r, -r * r, r * r * r, -r * r * r * r])[: d + 1]
    return taylor(x, terms)


def taylor(x, terms):
    """A function of a number or a jet, from its Taylor coefficients at the value."""
    if not isinstance(x, Jet):
        return terms[0]
    small, found = Jet([0, *x.c[1:]], x.degree), Jet.of(terms[-1], x.degree)
    for term in reversed(terms[:-1]):
        found = found * small + term
    return found


def implicit(off, near, degree):
    """The jet of the one zero near an interval, by interval Newton; `off` gives value and slope of truncated jets."""
    sure = False
    for _ in range(60):
        last, found = near, near.mid() - off(near.mid(), value)[0] / off(near, value)[1]
        sure = sure or found.inside(near)
        near = found.meet(near) if sure else near.hull(found).wide((found - found.mid()) * 2)
        if sure and near.width() * 2 >= last.width():
            break
    need(sure, "exists: a landing is not enclosed")
    t = Jet.of(near, 0)
    for k, n in [(k, length(k)) for k in range(1, degree + 1)]:  # coefficients of degree k, from those below
        h, dh = off(Jet((t.c + [0] * n)[:n], k), lambda x, n=n, k=k: Jet(x.c[:n], k) if isinstance(x, Jet) else x)
        t = Jet(t.c + [-b / value(dh) for b in h.c[len(t.c) :]], k)
    return t


def evaluate(node, names, p):
    """A formula and its derivative by theta; `Unproved` where a value, or the number of steps, is too large."""
    left[0] -= 1 + (p >> 9) ** 2
    need(left[0] > 0, "the file takes more steps than this reader allows")
    found = meaning(node, names, p)
    need(not isinstance(x := value(found[0]), I) or max(-x.lo, x.hi) >> p + VALUES == 0, "a value is too large")
    return found


def meaning(node, names, p):
    """The value of a letter, pi, + - * / **, sin, cos, or a root of a number; other functions are in formulas.py."""
    kind = type(node).__name__
    if kind == "Constant":
        return node.value, 0
    if kind == "Name" and (node.id in names or node.id == "pi"):
        x = names.get(node.id) or pi(p)
        return x if isinstance(x, Jet) else I.of(x, p), int(node.id == "theta")
    below = {"UnaryOp": ["operand"], "BinOp": ["left", "right"]}.get(kind, [])
    parts = [evaluate(part, names, p) for part in [getattr(node, key) for key in below] or getattr(node, "args", [])]
    mark = getattr(getattr(node, "func", node), "id", "") or type(getattr(node, "op", None)).__name__
    if mark == "USub":
        return tuple(-x for x in parts[0])
    if kind == "BinOp":
        (x, dx), (y, dy) = parts
        if mark == "Pow" and y in range(1, 33):  # an interval or a jet is in none
            low = prod([x] * (int(y) - 1), start=I.of(1, p))
            return low * x, dx and low * dx * y
        if mark in ("Add", "Sub"):
            return (x + y, dx + dy) if mark == "Add" else (x - y, dx - dy)
        if mark == "Div":
            mark, y = "Mult", 1 / y if isinstance(y, Fraction) and y else function("inverse", y, p)
            dy = dy and -dy * y * y
        if mark == "Mult":
            return x * y, (dx and dx * y) + (dy and x * dy)
    if len(parts) == 1 and mark in ("sin", "cos", "sqrt"):
        x, dx = parts[0]
        if mark != "sqrt":
            s, c = function("sin", x, p), function("cos", x, p)
            return (s, dx and c * dx) if mark == "sin" else (c, dx and -s * dx)
        if not isinstance(x, Jet) and not dx and I.of(x, p).lo >= 0:
            return I(*(isqrt(end << p) + k for k, end in enumerate((I.of(x, p).lo, I.of(x, p).hi))), p), 0
    found = beside("formulas").meaning(kind, mark, parts, p)
    need(found, f"the formula has {ascii(ast.unparse(node))[:60]}, which is not understood or has no value", Wrong)
    return found


class Table:
    """A table: components, counterclockwise; numbers for letters; a law, or None for `lam` times the arrival angle."""

    def __init__(self, parts, letters, law, p):
        self.parts, self.letters, self.p = [[parse(text) for text in part] for part in parts], letters, p
        self.law, self.marks = law and parse(law), []  # where the map is undefined
        self.closed = [len(parts) == 1] * len(parts)  # is it a curve with the period 2*pi? Of the paper's tables

    def at(self, part, theta, names, p):
        """Point and velocity at a parameter."""
        found = [evaluate(node, names | {"theta": theta}, p) for node in self.parts[part][:-2]]
        if len(found) == 1:
            (r, dr), s, c = found[0], function("sin", theta, p), function("cos", theta, p)
            return r * c, r * s, dr * c - r * s, dr * s + r * c
        return found[0][0], found[1][0], found[0][1], found[1][1]

    ends = lambda self, part, p: [I.of(evaluate(node, self.letters, p)[0], p) for node in self.parts[part][-2:]]

    def angle(self, here, there, names):
        """The exit angle of a chord, from the inward normal, positive along the (counterclockwise) tangent."""
        (x, y, tx, ty), (u, v, _, _) = (self.at(*place, names, self.p) for place in (here, there))
        across = (v - y) * tx - (u - x) * ty
        need(across > 0, "admissible: a chord may not leave inwards")
        return I.of(((u - x) * tx + (v - y) * ty) / across, self.p).atan()

    def flight(self, part, place, state, names):
        """The next state: the one zero of `direction x (q - start)` near a place, if `free` proves the chord."""
        (there, near), (theta, psi), p = place, state, self.p
        x, y, tx, ty = self.at(part, theta, names, p)
        s, c = function("sin", psi, p), function("cos", psi, p)
        ux, uy = tx * s - ty * c, ty * s + tx * c

        def off(t, cut):
            a, b, da, db = self.at(there, t, {name: cut(x) for name, x in names.items()}, p)
            return cut(ux) * (b - cut(y)) - cut(uy) * (a - cut(x)), cut(ux) * db - cut(uy) * da

        t = implicit(off, near, theta.degree)
        a, b, da, db = self.at(there, t, names, p)
        vx, vy = a - x, b - y
        across, psi = vx * db - vy * da, I.of(value(psi), p)
        fair = psi.size() < 2 and value(c) > 0 and value(vx * ux + vy * uy) > 0
        need(fair and value(across) > 0, "admissible: a chord may not arrive from inside")
        psi = function("atan", (vx * da + vy * db) * function("inverse", across, p), p)
        return t, self.leaves(psi, names | {"eta": -psi, "theta": t})

    own_law = lambda self, psi, names: Jet.of(0, psi.degree) + evaluate(self.law, names, self.p)[0]
    leaves = lambda self, psi, names: self.own_law(psi, names) if self.law else psi * names["lam"]  # of who arrives

    def orbit(self, launch, boxes, way, degree, middle=None, view=None):
        """The states along places, from the start that `launch` makes of three letters in boxes, passed to `view` last.

        Coefficients are tightened by those at the middle of the boxes, or values by those of a given `middle`.
        """
        p, off = self.p, None if middle else [x - x.mid() for x in boxes]
        for at, d in [([x.mid() for x in boxes], degree - 1)] * (middle is None) + [(boxes, degree)]:
            letters = [Jet.of(x, d, k) for k, x in enumerate(at)]
            *state, names = launch(*letters)
            states = [state]
            for k in range(1, len(way) + (view is not None)):
                state = self.flight(way[k - 1][0], way[k], state, names) if k < len(way) else view(*state, letters[2])
                states.append(state)
                for x, m in zip(state, middle[k] if middle else ()):
                    need(x.c[0].lo <= m.c[0].lo and m.c[0].hi <= x.c[0].hi, "exists: the middle orbit is not inside")
                    x.tighten(m, off, p)
            middle = states
        return states

    def free(self, start, end, names, p=64):
        """Proves that the chord of two bounces (lists of component and parameter) meets the boundary only there.

        Each piece of the boundary lies off the chord's line, or not between its ends, or so near to a bounce that it
        crosses the line once; otherwise it is halved. A closed curve has the period 2*pi.
        """
        start, end = ([(part, I.of(at, p)) for part, at in bounce] for bounce in (start, end))
        (x, y, *_), (u, v, *_) = (self.at(*bounce[0], names, p) for bounce in (start, end))
        dx, dy, looks = u - x, v - y, iter(range(4000))

        def crossing(part, theta):
            qx, qy, tx, ty = self.at(part, theta, names, p)
            return dx * (qy - y) - dy * (qx - x), dx * ty - dy * tx, dx * (qx - x) + dy * (qy - y)

        def settled(part, piece):
            line, speed, along = crossing(part, piece)
            off = 0 not in line or along < 0 or along - (dx * dx + dy * dy) > 0
            if off or 0 not in crossing(part, piece.mid())[0].wide(speed * (piece - piece.mid())):
                return True
            turns = lambda at: pi(p) * 2 * (self.closed[part] and round((piece - at).real() / 6.283185307179586))
            speeds = (crossing(part, piece.hull(at + turns(at)))[1] for other, at in start + end if other == part)
            return any(speed > 0 or speed < 0 for speed in speeds)

        for part in range(len(self.parts)):
            (low, high), queue = self.ends(part, p), [(Fraction(0), Fraction(1))]
            while queue:
                a, b = queue.pop()
                need(next(looks, None) is not None, "admissible: a chord may meet the boundary on its way")
                try:
                    done = settled(part, low + (high - low) * I.of(a, p).hull(I.of(b, p)))
                except Unproved:  # a formula may have no value on a wide piece
                    done = False
                queue += [] if done else [(a, (a + b) / 2), ((a + b) / 2, b)]


def newton(equations, box, p):
    """The interval Newton image N, proved to lie inside the box; `equations` gives jets (degree 0 at the middle)."""
    middle, (a, b, c) = [x.mid() for x in box], (x.gradient(p) for x in equations(box, 1))
    cross = [[v[k - 2] * w[k - 1] - v[k - 1] * w[k - 2] for k, _ in enumerate(v)] for v, w in ((b, c), (c, a), (a, b))]
    values, one = [value(x) for x in equations(middle, 0)], 1 / sum(x * y for x, y in zip(a, cross[0]))  # Cramer's rule
    image = [m - sum(row[i] * x for row, x in zip(cross, values)) * one for i, m in enumerate(middle)]
    need(all(map(I.inside, image, box)), "exists, unique: interval Newton does not map the box into itself")
    return image


class Cycle:
    """A cycle: bounces in `boxes` on `parts`, closed by theta -> sign*theta; `box` encloses `free`, or `lam`."""

    def __init__(self, table, kind, parts, boxes, sign, free, box, lam):
        self.table, self.kind, self.parts, self.boxes, self.sign, self.p = table, kind, parts, boxes, sign, table.p
        self.lam, self.box = lam, box or lam.wide(I.of(Fraction(1, 2**40), self.p))
        self.names = lambda letter: table.letters | {"lam": lam, free or "lam": letter}
        launch = lambda theta, psi, letter: (theta, psi, self.names(letter))
        self.run = lambda unknowns, d: table.orbit(launch, unknowns, self.way, d)
        self.way = [*zip(parts, boxes), (parts[0], boxes[0] * sign)]

    def equations(self, unknowns, d):
        """The state after a round minus that before, and the condition on multipliers, or on the start."""
        states = self.run(unknowns, d + 1)
        theta, psi = (x * self.sign for x in states[-1])
        (a, b), (c, e) = ([x.diff(k) for k in (0, 1)] for x in (theta, psi))
        trace, det = a + e, a * e - b * c
        last = {
            "cycle": Jet.of(unknowns[2], d, 2) - (self.lam or self.box),
            "corner": Jet.of(unknowns[0], d, 0) - self.table.ends(0, self.p)[1],
            "fold": 1 - trace + det,
            "flip": 1 + trace + det,
            "focus": trace * trace - det * 4,
        }
        return theta - states[0][0], psi - states[0][1], last[self.kind]

    def solved(self):
        """Enclosures of the three unknowns and of the bounces, of the exactly one solution in the boxes."""
        psi = self.table.angle(*zip(self.parts[:2], self.boxes), self.names(self.box))  # of all chains in the boxes
        image = newton(self.equations, [self.boxes[0], psi.wide(psi - psi.mid()), self.box], self.p)
        bounces = [value(theta) for theta, _ in self.run(image, 1)[: len(self.parts)]]
        need(all(map(I.inside, bounces, self.boxes)), "exists: the solution may lie outside the box")
        return image, bounces

    def admissible(self, bounces, letter):
        """Proves that bounces lie on their components, chords are free, and the period is minimal."""
        table, p, placed = self.table, self.p, []
        apart = lambda part, x, y: 0 not in (((x - y) / 2).sin_cos()[0] if table.closed[part] else x - y)
        for part, x in zip(self.parts + self.parts, bounces + [-x for x in bounces] * (self.sign == -1)):
            low, high = table.ends(part, p)
            if table.closed[part]:
                x = x - (high - low) * round(((x * 2 - low - high) / (high - low)).real() / 2)
            need(table.closed[part] or x.inside(I(low.hi, high.lo, p)), "admissible: a bounce may be off its component")
            placed.append((part, x))
        for here, there in zip(placed, [*placed[1:], placed[0]]):
            table.free([here], [there], self.names(letter))
        fit = all(part != other or apart(part, x, at) for part, x in placed for other, at in table.marks)
        need(fit, "admissible: the map may be undefined at a bounce")
        for m in (m for m in range(1, len(placed)) if len(placed) % m == 0):
            other = any(c != d or apart(c, x, y) for (c, x), (d, y) in zip(placed, placed[m:] + placed[:m]))
            need(other, "minimal_period: the cycle may be a shorter one, run through several times")

    def generic(self, image):
        """Proves genericity: the other multiplier's condition, and the cubic coefficient of a doubling (Kuznetsov)."""
        states = self.run(image, 1)
        (a, b, _), (c, d, _) = ((x * self.sign).gradient(self.p) for x in states[-1])
        det, one = a * d - b * c, (a - 1) * (d - 1) - b * c
        need(det < 1 and det > -1, "simple_multiplier, other_multiplier_stable: the other may be too large")
        if self.kind == "flip":  # of two vectors one at least is not 0, or the determinant might be 1
            v = next(v for v in ((b, -a - 1), (d + 1, -c)) if 0 not in v[0] or 0 not in v[1])
            w = next(w for w in ((c, -a - 1), (d + 1, -b)) if 0 not in w[0] or 0 not in w[1])
            (e, f), _ = self.along(image, states, v, (0, 0))
            bend = (b * f - (d - 1) * e) / one, (c * e - (a - 1) * f) / one  # then a round leaves the square as it is
            cubic = sum(x * y for x, y in zip(w, self.along(image, states, v, bend)[1]))
            need(0 not in cubic, "nondegenerate: the cubic coefficient of the normal form may be 0")

    def along(self, image, states, v, bend):
        """The state after a round on the curve `start + v*e + bend*e**2`: the coefficients of `e**2` and `e**3`."""
        launch = lambda e, *_: (*(e * y + e * e * z + x for x, y, z in zip(image, v, bend)), self.names(image[2]))
        last = self.table.orbit(launch, [I.of(0, self.p)] * 2 + [image[2]], self.way, 3, states)[-1]
        return [[x.c[algebra(x.degree)[1][k, 0, 0]] * self.sign for x in last] for k in (2, 3)]


def exact(pair):
    mantissa, exponent = pair
    need(len(mantissa) <= BITS // 3 and abs(int(exponent)) <= BITS, "a number has too many digits", Wrong)
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def within(name, x, table=None):
    spans = {("ellipse", "a"): (1, 10**6), ("egg", "alpha"): (0, Fraction(1, 2)), (table, "lam"): (0, 1)}
    low, high = spans.get((table, name), (-(10**6), 10**6))
    need(x.lo >= I.of(low, x.p).hi and x.hi <= I.of(high, x.p).lo, f"{name} is out of range {low} to {high}", Wrong)
    return x


def read_scene(scene, free, p):
    """The table and the contraction of a scene, and its title in words."""
    more = {"K"} if "table" in scene else {"undefined", "origin"}  # marks are of tables of one's own
    way = [key for key in WAYS if not {*scene} - {key, *more, "shape", "law", "lam"}]  # all, of none
    need(len(way) == 1, f"scene: the entries are one of {', '.join(WAYS)}, and K, shape, law, lam, ...", Wrong)
    shape, lam, K, title = scene.get("shape", {}), scene.get("lam"), scene.get("K", 3), scene.get("table")
    fit = "K" not in scene or title == "egg"
    letter, parts = PAPER.get(title) or ("", beside("boundaries").pieces(way[0], scene[way[0]]))
    ends = {name: text.partition("..") for name, text in shape.items()}
    spans = [name for name, at in ends.items() if at[1]]
    given, own = {*shape, free} - {"", "lam"}, {*re.findall(r"\w+", scene.get("law", ""))} - {"theta", "eta", "pi", "E"}
    fit = fit and letter in ("", *given) and (title is None or not given - {letter} - own)
    fit = fit and free in ("", "lam", letter, *spans, *own) and {*spans} == {free} & {*shape} and not (title and spans)
    need(fit, "scene: the table has other letters, or a range of one that is not free, or no such name", Wrong)
    number = lambda name, text: within(name, I.of(evaluate(parse(text), {}, p)[0], p), title)
    letters = {name: number(name, at[0]).hull(number(name, at[2] or at[0])) for name, at in ends.items()}
    forward = all((number(name, ends[name][2]) - number(name, ends[name][0])).lo > 0 for name in spans)
    need(forward, "scene: a letter's range must run from the smaller end to the larger", Wrong)
    parts = [[text.replace("K", str(K)) for text in part] for part in parts] if title else parts
    table = Table(parts, letters, scene.get("law"), p)
    if title is None or table.law:
        beside("boundaries").own(table, way[0], scene, free if spans else None)
    need((free == "lam") == (lam is None), "scene: lam must have a number unless it is the free letter", Wrong)
    said = [("phi", scene.get("law")), *shape.items(), ("lam", lam)]
    title = (title or beside("boundaries").called_by(way[0], scene[way[0]])) + f" of {K} points" * (K != 3)
    return table, lam and number("lam", lam), title + "".join(f", {k} = {v}" for k, v in said if v and k not in spans)


def named(kind, sign, parts, bounces, boxes, scene, free, title, p):
    """The name of a value: one that follows from the symmetry or the position of the cycle, or the stated one."""
    same = lambda x, box: (x - pi(p) * 2 * round((x - box).real() / 6.283185307179586)).inside(box)
    mirrored = sign == 1 and all(map(same, [-x for x in bounces], boxes))  # so it is its own image: there is no other
    turned = sign == 1 and all(map(same, [x + pi(p) * Fraction(2, 3) for x in bounces], [*boxes[1:], boxes[0]]))
    what = scene.get("table") if scene.get("K", 3) == 3 and "law" not in scene else None, kind, free, len(parts)
    if kind == "corner":
        return beside("corner").called(free, bounces[1])
    special = {("cuspless", "flip", "lam", 2): "lambda-c", ("egg", "fold", "lam", 3): "saddle-node"}
    special |= {("egg", "flip", "alpha", 2): "alpha-tilde", ("egg", "focus", "alpha", 2): "alpha-hat"}
    if what in special and (turned if what[-1] == 3 else mirrored):
        return special[what]
    half = "half of a symmetric cycle," if sign == -1 else "a cycle"
    return f"{kind + ' of ' if free else ''}{half} of period {len(parts)}{' in ' + free if free else ''}: {title}"


def checked(given):
    """The line that says what is proved of a document; raises `Wrong` or `Unproved` with the reason."""
    beside("entries").fits(given)
    left[0] = beside("entries").budget(given)
    if given["kind"] in ("trapping region", "boundary crisis"):
        return beside("region").trapping(given) if "runs" in given else beside("crisis").crisis(given)
    keys = "name statement kind scene free bits digits centre radius checks".split()
    name, words, kind, scene, free, bits, digits, centre, radius, items = map(given.get, keys)
    need({*items} == {*KINDS[kind]}, f"checks must list as true: {', '.join(KINDS[kind])}", Wrong)
    centre, radius, parts = [exact(pair) for pair in centre], exact(radius), given.get("components", [0, 0])
    letters = {"cycle": [""], "corner": ["lam", "phi"], "focus": ["alpha"], "tangency": ["lam"]}.get(kind)
    fit = 0 < radius <= 1 and (free in letters if letters else free != "") and max(map(abs, centre)) < 10**6
    need(fit, "free, radius or centre is out of range", Wrong)
    p = 16 * min(len(parts), SHORT) + max(bits + 96, *(x.denominator.bit_length() for x in [*centre, radius]))
    need(p <= BITS, f"bits, centre or radius: this reader takes up to {BITS} bits, and some of them for itself", Wrong)
    table, lam, title = read_scene(scene, "lam" if kind == "corner" else free, p)
    sign, wanted = -1 if given.get("mirror") else 1, {"corner": 2, "tangency": 3}.get(kind, len(parts) + (free != ""))
    fit = all(k < len(table.parts) for k in parts)
    fit = fit and (sign == 1 or ("table" in scene and not table.law) or beside("boundaries").symmetric(table, parts))
    fit = fit and (kind != "corner" or (scene == {"table": "cuspless"} and parts == [0, 0] and sign == -1))
    need(fit and len(centre) == wanted, "scene, components, centre or mirror do not fit together", Wrong)
    n = f"its {len(parts)} bounces" if sign == 1 else f"{len(parts)} bounces, and then their mirror images,"
    said = SAYS[kind].format(scene=title, n=n, free=free, what=WHAT.get(kind))
    need(words == said, f"the statement must be: {said!a}", Wrong)
    boxes = [I.of(x - radius, p).hull(I.of(x + radius, p)) for x in centre]
    if table.law:
        letter = {free or "lam": boxes[-1] if free else lam}
        beside("laws").lawful(table, {"lam": lam} | table.letters | letter)
    if kind == "tangency":
        image, true = beside("tangency").touching(given, table, boxes[2], title)
    else:
        box, reach = boxes.pop() if free else None, table.letters.get(free)
        table.letters |= {free: box} if reach else {}
        boxes = [table.ends(0, p)[1].wide(I.of(radius, p)), *boxes] if kind == "corner" else boxes  # the first bounce
        known, letter = beside("long").Long if len(parts) > SHORT else Cycle, "lam" if kind == "corner" else free
        image, bounces = (cycle := known(table, kind, parts, boxes, sign, letter, box, lam)).solved()
        need(not reach or image[2].inside(reach), f"{free} is not in its range", Wrong)
        beside("corner").cornered(cycle, image, bounces[1]) if kind == "corner" else cycle.admissible(bounces, image[2])
        cycle.generic(image) if kind in ("fold", "flip") else None
        true = named(kind, sign, parts, bounces, boxes, scene, free, title, p)
    found = image[1] if (kind, free) == ("corner", "phi") else image[2] if free else bounces[-1]
    within(free, image[2], scene.get("table")) if free else None
    need(found.width() <= (1 << p) // 10**digits, "precise: the enclosure is wider than the digits say")
    need(name == true, f"the name must be {true!a}", Wrong)
    decimal = Decimal(f"{round(Fraction(found.lo + found.hi, 2 << p) * 10**digits)}e-{digits}")
    if lam and table.law and "lam" not in beside("boundaries").words([table.law]):
        said += "\n  The law does not have the contraction that is told."
    return f"proved: {true}{' = ' if free else ', last bounce at '}{decimal:f}, within 1e-{digits}\n  {said}"


def main(paths):
    """Prints a verdict for each file, and returns 0 if all are proved."""
    limit = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)  # `exact` refuses text that is too long
    done = bool(paths)
    for path in paths:
        try:
            said = checked(beside("entries").read(path))
        except Exception as why:  # also a file that cannot be read, or numbers that no step foresees
            told, done = isinstance(why, (Unproved, Wrong)), False
            said = "not proved: " if isinstance(why, Unproved) else "refused: "
            said += str(why) if told else f"this is no certificate ({type(why).__name__})"
        print(f"{ascii(path)[1:-1]}: {said}")
    sys.set_int_max_str_digits(limit)
    return 0 if done else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
