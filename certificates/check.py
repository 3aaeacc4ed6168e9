"""A second reader of certificates: `python check.py FILE...`, with nothing but Python's standard library.

It shares no line with the package that writes certificates. Numbers are intervals with integers over a power of two for
ends; tables are formulas; the map is a flight along a straight line and the law `phi = -lam*eta`, in jets (Taylor
polynomials). Sought is a zero of three equations in a bounce, the angle at which it is left, and a letter.
By the interval Newton theorem, where N = m - F'(X)^-1 F(m) is inside the box X with middle m, F has exactly one zero in
X, which is in N, and F' is regular there. What a file means: docs/certificate_format.md. Exit status 0: all are proved.
"""

import ast
import json
import re
import sys
from fractions import Fraction
from functools import cache
from itertools import product
from math import atan, factorial, isqrt
from pathlib import Path


class Unproved(Exception):
    """An item of the checklist that is not proved."""


class Wrong(Exception):
    """A file that is no certificate, in one sentence."""


def need(holds, why, error=Wrong):
    if not holds:
        raise error(why)


class Number:  # what follows from a sum, a product and a sign
    __radd__ = lambda self, o: self + o
    __rmul__ = lambda self, o: self * o
    __sub__ = lambda self, o: self + (-o)
    __rsub__ = lambda self, o: -self + o


class I(Number):
    """An interval [lo, hi] * 2**-p, with integers lo <= hi; every operation encloses all values of the real one."""

    def __init__(self, lo, hi, p):
        self.lo, self.hi, self.p = lo, hi, p

    @staticmethod
    def of(x, p):
        if isinstance(x, I):
            k = p - x.p
            return I(x.lo << k, x.hi << k, p) if k >= 0 else I(x.lo >> -k, -(-x.hi >> -k), p)
        x = Fraction(x)
        return I((x.numerator << p) // x.denominator, -((-x.numerator << p) // x.denominator), p)

    def __add__(self, o):
        if isinstance(o, Jet):
            return NotImplemented
        o = o if isinstance(o, I) else I.of(o, self.p)
        return I(self.lo + o.lo, self.hi + o.hi, self.p)

    def __mul__(self, o):
        if isinstance(o, Jet):
            return NotImplemented
        if isinstance(o, int):
            return I(*sorted((self.lo * o, self.hi * o)), self.p)
        o = o if isinstance(o, I) else I.of(o, self.p)
        ends = self.lo * o.lo, self.lo * o.hi, self.hi * o.lo, self.hi * o.hi
        return I(min(ends) >> self.p, -(-max(ends) >> self.p), self.p)

    def __truediv__(self, o):
        o, one = I.of(o, self.p), 1 << 2 * self.p
        need(not o.lo <= 0 <= o.hi, "a divisor may be 0", Unproved)
        return self * I(one // o.hi, -(-one // o.lo), self.p)

    __neg__ = lambda self: I(-self.hi, -self.lo, self.p)
    __gt__ = lambda self, x: self.lo > x << self.p
    __lt__ = lambda self, x: self.hi < x << self.p
    __contains__ = lambda self, x: self.lo <= x << self.p <= self.hi
    mid = lambda self: I((self.lo + self.hi) >> 1, (self.lo + self.hi) >> 1, self.p)
    real = lambda self: (self.lo + self.hi) / (2 << self.p)  # a double near the middle
    meet = lambda self, o: I(max(self.lo, o.lo), min(self.hi, o.hi), self.p)
    hull = lambda self, o: I(min(self.lo, o.lo), max(self.hi, o.hi), self.p)
    inside = lambda self, o: o.lo < self.lo and self.hi < o.hi  # in the interior
    wide = lambda self, o: I(self.lo - max(-o.lo, o.hi), self.hi + max(-o.lo, o.hi), self.p)  # by the largest of |o|

    def sin_cos(self):
        """Those of the middle, by Taylor's series, give or take the radius, since no slope is above 1."""
        m, p, one = self.mid().lo, self.p, 1 << self.p
        r, w = self.hi - m, p + 32 + max(0, m.bit_length() - p)  # a huge argument takes as many more bits of pi
        k = ((m << (w - p)) * 2 + pi(w).lo // 2) // pi(w).lo
        x = I(m << (w - p), m << (w - p), w) - I(pi(w).lo >> 1, (pi(w).hi >> 1) + 1, w) * k
        y, sums, slack = x.mid().lo, [], x.hi - x.mid().lo + 16
        for n in (1, 0):
            total, term = 0, y if n else 1 << w
            while abs(term) > 1:  # each term is at most 4 units off, and what follows the last one at most 16
                total, slack, n = total + term, slack + 4, n + 2
                term = -((term * y >> w) * y >> w) // (n * (n - 1))
            sums.append(total)
        s, c = (I.of(I(v - slack, v + slack, w), p) for v in sums)
        turned = ((s, c), (c, -s), (-s, -c), (-c, s))[k % 4]
        return [I(max(f.lo - r, -one), min(f.hi + r, one), p) for f in turned]

    def atan(self):
        """At both ends: Newton's method to y, then d = y - atan(x) has sin(d)*sqrt(1+x^2) = sin(y) - x*cos(y)."""
        ends = []
        for end in (self.lo, self.hi):
            x = I(end, end, self.p)
            y = I.of(Fraction(atan(x.real())), x.p)
            for _ in range(x.p.bit_length()):
                s, c = y.mid().sin_cos()
                y = y.mid() + (x * c - s) / (c + x * s)
            y, (s, c) = y.mid(), y.mid().sin_cos()
            need(c > 0 and c + x * s > 0 and y > -2 and y < 2, "an angle too near pi/2", Unproved)  # so cos(d) > 0
            ends.append(y.wide((s - x * c) * 2))  # |d| <= (pi/2)*|sin(d)|
        return ends[0].hull(ends[1])


@cache
def pi(p):
    """Machin: pi = 16*atan(1/5) - 4*atan(1/239). Each term is at most 2 units off, what follows the last at most 1."""
    w, total, slack = p + 24, 0, 40
    for factor, x in ((16, 5), (-4, 239)):
        term, n = (1 << w) // x, 1
        while term:
            total, slack = total + (factor if n % 4 == 1 else -factor) * (term // n), slack + 32
            term, n = term // (x * x), n + 2
    return I.of(I(total - slack, total + slack, w), p)


@cache
def algebra(degree):
    """The exponents in order, where each stands, and which pairs multiply to which."""
    powers = [e for d in range(degree + 1) for e in product(range(d + 1), repeat=3) if sum(e) == d]
    at = {e: i for i, e in enumerate(powers)}
    sums = ((i, j, tuple(map(sum, zip(d, e)))) for i, d in enumerate(powers) for j, e in enumerate(powers))
    return powers, at, [(i, j, at[e]) for i, j, e in sums if e in at]


class Jet(Number):
    """A polynomial in three letters up to a degree; over a box it encloses the Taylor coefficients at every point."""

    def __init__(self, c, degree):
        self.c, self.degree = c, degree

    @staticmethod
    def of(x, degree, letter=None):
        c = [x] + [0] * (len(algebra(degree)[0]) - 1)
        if letter is not None and degree:
            c[3 - letter] = 1
        return Jet(c, degree)

    def __add__(self, o):
        if isinstance(o, Jet):
            return Jet([a + b for a, b in zip(self.c, o.c)], self.degree)
        return Jet([self.c[0] + o, *self.c[1:]], self.degree)

    def __mul__(self, o):
        if not isinstance(o, Jet):
            return Jet([a * o if a != 0 else 0 for a in self.c], self.degree)
        c = [0] * len(self.c)
        for i, j, k in algebra(self.degree)[2]:
            if self.c[i] != 0 and o.c[j] != 0:  # an interval never equals a number
                c[k] = c[k] + self.c[i] * o.c[j]
        return Jet(c, self.degree)

    __neg__ = lambda self: Jet([-a for a in self.c], self.degree)
    gradient = lambda self, p: [I.of(a, p) for a in self.c[3:0:-1]]

    def diff(self, letter):
        """The derivative by a letter, of one degree less."""
        raised = (tuple(n + (k == letter) for k, n in enumerate(e)) for e in algebra(self.degree - 1)[0])
        return Jet([self.c[algebra(self.degree)[1][e]] * e[letter] for e in raised], self.degree - 1)


value = lambda x: x.c[0] if isinstance(x, Jet) else x


def function(name, x, p):
    """`sin`, `cos`, `atan` or `1/x` of a number or a jet of degree at most 3."""
    d, at, one = (x.degree if isinstance(x, Jet) else 0), I.of(value(x), p), I.of(1, p)
    if name in ("sin", "cos"):
        s, c = at.sin_cos()
        cycle = (s, c, -s, -c) if name == "sin" else (c, -s, -c, s)
        terms = [cycle[k] / factorial(k) for k in range(d + 1)]
    else:
        r = one / (at * at + 1 if name == "atan" else at)
        tangent = [at.atan(), r, -at * r * r, (at * at * 3 - 1) * r * r * r / 3] if name == "atan" else []
        terms = (tangent or [r, -r * r, r * r * r, -r * r * r * r])[: d + 1]
    if not isinstance(x, Jet):
        return terms[0]
    small, found = Jet([0, *x.c[1:]], d), Jet.of(terms[-1], d)
    for term in reversed(terms[:-1]):
        found = found * small + term
    return found


def parse(text):
    """The tree of a formula, by Python's own grammar; nothing is executed. A decimal is the one shown."""
    need(re.fullmatch(r"[\w+\-*/^(). ]{1,1000}", text, re.ASCII), "a formula has characters that mean nothing")
    said = text.strip().replace("^", "**")
    try:
        tree = ast.parse(said, mode="eval").body
        for node in (node for node in ast.walk(tree) if isinstance(node, ast.Constant)):
            shown = ast.get_source_segment(said, node)
            node.value = Fraction(shown if re.fullmatch(r"[\d.]+([eE][-+]?\d{1,3})?", shown) else "")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise Wrong(f"the formula {text[:60]} is not understood") from None
    return tree


def evaluate(node, names, p):
    """A formula and its derivative by theta: numbers, letters, pi, + - * / ** ( ), sin, cos, and roots of numbers."""
    kind = type(node).__name__
    if kind == "Constant":
        return node.value, 0
    if kind == "Name" and (node.id in names or node.id == "pi"):
        return names.get(node.id) or pi(p), int(node.id == "theta")
    if kind == "UnaryOp" and isinstance(node.op, ast.USub):
        return tuple(-x for x in evaluate(node.operand, names, p))
    if kind == "BinOp":
        mark, (x, dx), (y, dy) = type(node.op).__name__, *(evaluate(part, names, p) for part in (node.left, node.right))
        if mark == "Pow" and isinstance(y, Fraction) and y in range(1, 33):
            (z, dz), x = (1, 0), x if isinstance(x, Jet) else I.of(x, p)
            for _ in range(int(y)):
                z, dz = z * x, dz * x + z * dx
            return z, dz
        if mark in ("Add", "Sub"):
            return (x + y, dx + dy) if mark == "Add" else (x - y, dx - dy)
        if mark == "Div":
            mark, y = "Mult", 1 / y if isinstance(y, Fraction) and y else function("inverse", y, p)
            dy = dy and -dy * y * y
        if mark == "Mult":
            return x * y, (dx and dx * y) + (dy and x * dy)
    if kind == "Call" and len(node.args) == 1 and getattr(node.func, "id", "") in ("sin", "cos", "sqrt"):
        (x, dx), name = evaluate(node.args[0], names, p), node.func.id
        if name != "sqrt":
            s, c = function("sin", x, p), function("cos", x, p)
            return (s, dx and c * dx) if name == "sin" else (c, dx and -s * dx)
        if not isinstance(x, Jet) and not dx and I.of(x, p).lo >= 0:
            return I(isqrt(I.of(x, p).lo << p), isqrt(I.of(x, p).hi << p) + 1, p), 0
    raise Wrong(f"the formula has {ascii(ast.unparse(node))[:60]}, which is not understood or has no value")


PAPER = {  # the shape's letter, and the components: x and y, or one formula for the radius, and the ends of theta
    "circle": ("", [("1", "-pi", "pi")]),
    "ellipse": ("a", [("a*cos(theta)", "sin(theta)", "-pi", "pi")]),
    "cardioid": ("", [("1+cos(theta)", "-pi", "pi")]),
    "cuspless": ("", [("1+cos(theta)", "-2*pi/3", "2*pi/3"), ("-1/4", "-theta", "-sqrt(3)/4", "sqrt(3)/4")]),
    "egg": ("alpha", [("1+alpha*cos(K*theta)", "-pi", "pi")]),
}


class Table:
    """Components, counterclockwise, and the shape's letters; a letter that is free is added by those who ask."""

    def __init__(self, parts, letters):
        self.parts, self.letters = [[parse(text) for text in part] for part in parts], letters
        self.closed = len(parts) == 1

    def at(self, part, theta, names, p):
        """Point and velocity at a parameter."""
        found = [evaluate(node, names | {"theta": theta}, p) for node in self.parts[part][:-2]]
        if len(found) == 1:
            (r, dr), s, c = found[0], function("sin", theta, p), function("cos", theta, p)
            return r * c, r * s, dr * c - r * s, dr * s + r * c
        return found[0][0], found[1][0], found[0][1], found[1][1]

    def ends(self, part, p):
        return [I.of(evaluate(node, {}, p)[0], p) for node in self.parts[part][-2:]]

    def angle(self, here, there, names, p):
        """The angle at which a chord leaves: from the inward normal, positive along the tangent, counterclockwise."""
        (x, y, tx, ty), (u, v, _, _) = (self.at(*place, names, p) for place in (here, there))
        across = (v - y) * tx - (u - x) * ty
        need(across > 0, "admissible: a chord may not leave inwards", Unproved)
        return I.of(((u - x) * tx + (v - y) * ty) / across, p).atan()

    def flight(self, part, there, state, near, names, lam, p):
        """The state (parameter, angle) at the one zero of `direction x (q - start)` about `near`, by interval Newton.

        Its jet is found degree by degree. What the chord meets on its way is examined in `free`."""
        theta, psi = state
        x, y, tx, ty = self.at(part, theta, names, p)
        s, c = function("sin", psi, p), function("cos", psi, p)
        ux, uy, flat = tx * s - ty * c, ty * s + tx * c, {name: value(x) for name, x in names.items()}

        def off(t, names, flat=lambda x: x):
            a, b, da, db = self.at(there, t, names, p)
            return flat(ux) * (b - flat(y)) - flat(uy) * (a - flat(x)), flat(ux) * db - flat(uy) * da

        for _ in range(30):
            found = near.mid() - off(near.mid(), flat, value)[0] / off(near, flat, value)[1]
            if found.inside(near):
                break
            near = near.hull(found).wide((found - found.mid()) * 2)
        need(found.inside(near), "exists: a landing is not enclosed", Unproved)
        t = Jet.of(found, theta.degree)
        for k in range(1, t.degree + 1):
            h, dh = off(t, names)
            terms, factor = zip(algebra(t.degree)[0], t.c, h.c), I.of(-1, p) / value(dh)
            t = Jet([a + b * factor if sum(e) == k else a for e, a, b in terms], t.degree)
        a, b, da, db = self.at(there, t, names, p)
        vx, vy = a - x, b - y
        across, fair = vx * db - vy * da, value(c) > 0 and value(vx * ux + vy * uy) > 0
        need(fair and value(across) > 0, "admissible: a chord may not arrive from inside", Unproved)
        return t, function("atan", (vx * da + vy * db) * function("inverse", across, p), p) * lam

    def fly(self, state, way, names, lam, p, middle=None, off=()):
        """The states along a way of components and where to land, within the mean value form about a middle orbit."""
        states = [state]
        for k, (there, near) in enumerate(way[1:], 1):
            found = self.flight(way[k - 1][0], there, states[-1], near, names, lam, p)
            for x, m in zip(found, middle[k] if middle else ()):
                need(x.c[0].lo <= m.c[0].lo and m.c[0].hi <= x.c[0].hi, "exists: no middle orbit", Unproved)
                x.c[0] = x.c[0].meet(sum((a * b for a, b in zip(x.gradient(p), off)), m.c[0]))
            states.append(found)
        return states

    def free(self, start, end, names, p=64):
        """Proves that the chord of two bounces (lists of component and parameter) meets the boundary only there.

        A piece of the boundary is off the chord's line, or not between its ends, or so near to a bounce that the line
        is crossed once on the way from there; or it is halved. A closed curve has the period 2*pi."""
        names = {name: I.of(x, p) for name, x in names.items()}
        start, end = ([(part, I.of(at, p)) for part, at in bounce] for bounce in (start, end))
        (x, y, *_), (u, v, *_) = (self.at(*bounce[0], names, p) for bounce in (start, end))
        dx, dy, spent = u - x, v - y, 0

        def crossing(part, theta):
            qx, qy, tx, ty = self.at(part, theta, names, p)
            return dx * (qy - y) - dy * (qx - x), dx * ty - dy * tx, dx * (qx - x) + dy * (qy - y)

        for part in range(len(self.parts)):
            (low, high), queue = self.ends(part, p), [(Fraction(0), Fraction(1))]
            while queue:
                (a, b), spent = queue.pop(), spent + 1
                need(spent <= 4000, "admissible: a chord may meet the boundary on its way", Unproved)
                piece = low + (high - low) * I.of(a, p).hull(I.of(b, p))
                line, speed, along = crossing(part, piece)
                if 0 not in line or along < 0 or along - (dx * dx + dy * dy) > 0:
                    continue
                if 0 not in crossing(part, piece.mid())[0] + speed * (piece - piece.mid()):
                    continue
                for at in (at for other, at in start + end if other == part):
                    at = at + pi(p) * (2 * round((piece - at).real() / 6.283185307179586) if self.closed else 0)
                    speed = crossing(part, piece.hull(at))[1]
                    if speed > 0 or speed < 0:
                        break
                else:
                    queue += [(a, (a + b) / 2), ((a + b) / 2, b)]


def newton(equations, box, p):
    """N, proved to lie in the interior of the box: `equations` takes intervals to values and rows of derivatives."""
    middle, (a, b, c), cross = [x.mid() for x in box], equations(box)[1], []
    for v, w in ((b, c), (c, a), (a, b)):
        cross.append([v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]])
    values, one = equations(middle)[0], I.of(1, p) / sum(x * y for x, y in zip(a, cross[0]))  # Cramer's rule
    image = [m - sum(row[i] * x for row, x in zip(cross, values)) * one for i, m in enumerate(middle)]
    need(all(map(I.inside, image, box)), "exists, unique: interval Newton does not map the box into itself", Unproved)
    return image


class Cycle:
    """Bounces in `boxes` on `parts`, closed by theta -> sign*theta; in `box` a letter, `free`, or `lam` as it is."""

    def __init__(self, table, kind, parts, boxes, sign, free, box, lam, p):
        self.table, self.kind, self.parts, self.boxes, self.sign, self.p = table, kind, parts, boxes, sign, p
        self.fixed = free not in ("", "lam")  # then the letter is one of the table's
        self.free, self.box, self.lam = free, box or lam.wide(I.of(Fraction(1, 2**40), p)), lam
        self.names = lambda letter: table.letters | ({free: letter} if self.fixed else {})
        self.way = [*zip(parts, boxes), (parts[0], boxes[0] * sign)]

    def round(self, unknowns, degree):
        """All states from the start to a round later."""
        middle, off, found = [x.mid() for x in unknowns], [x - x.mid() for x in unknowns], None
        for start, d in ((middle, 0), (unknowns, degree)):
            theta, psi, letter = (Jet.of(x, d, k) for k, x in enumerate(start))
            lam = self.lam if self.fixed else letter
            found = self.table.fly((theta, psi), self.way, self.names(letter), lam, self.p, found, off)
        return found

    def equations(self, unknowns):
        """A round later minus now, and what the kind says of the multipliers of a round, or of the start."""
        states = self.round(unknowns, 2)
        theta, psi = (x * self.sign for x in states[-1])
        (a, b), (c, d) = ([x.diff(k) for k in (0, 1)] for x in (theta, psi))
        trace, det = a + d, a * d - b * c
        last = {
            "cycle": Jet.of(unknowns[2], 1, 2) - (self.lam or 0),
            "corner": Jet.of(unknowns[0], 1, 0) - self.table.ends(0, self.p)[1],
            "fold": 1 - trace + det,
            "flip": 1 + trace + det,
            "focus": trace * trace - det * 4,
        }
        left = [theta - states[0][0], psi - states[0][1], last[self.kind]]
        return [value(x) for x in left], [x.gradient(self.p) for x in left]

    def solved(self):
        """Exactly one solution in the boxes: enclosures of the three unknowns and of the bounces."""
        psi = self.table.angle(
            *zip(self.parts[:2], self.boxes), self.names(self.box), self.p
        )  # of all chains in the boxes
        image = newton(self.equations, [self.boxes[0], psi.wide(psi - psi.mid()), self.box], self.p)
        bounces = [value(theta) for theta, _ in self.round(image, 1)[: len(self.parts)]]
        need(all(map(I.inside, bounces, self.boxes)), "exists: the solution may lie outside the box", Unproved)
        return image, bounces

    def admissible(self, bounces, letter):
        """Bounces on their components, free chords, and no shorter cycle."""
        table, whole, placed = self.table, bounces + ([-x for x in bounces] if self.sign < 0 else []), []
        for part, x in zip(self.parts * 2, whole):
            low, high = table.ends(part, self.p)
            if table.closed:
                x = x - (high - low) * round(((x * 2 - low - high) / (high - low)).real() / 2)
            need(
                table.closed or x.inside(I(low.hi, high.lo, self.p)),
                "admissible: a bounce may be off its component",
                Unproved,
            )
            placed.append((part, x))
        for here, there in zip(placed, placed[1:] + placed[:1]):
            table.free([here], [there], self.names(letter))
        apart = lambda x, y: 0 not in (function("sin", (x - y) / 2, self.p) if table.closed else x - y)
        for m in (m for m in range(1, len(placed)) if len(placed) % m == 0):
            other = any(c != d or apart(x, y) for (c, x), (d, y) in zip(placed, placed[m:] + placed[:m]))
            need(other, "minimal_period: the cycle may be a shorter one, run through several times", Unproved)

    def generic(self, image):
        """The other multiplier, and the cubic coefficient of a doubling (Kuznetsov, Applied bifurcation theory, 5.4).

        Where the other multiplier is inside the unit circle, a zero at which F' is regular is a fold that is quadratic
        and transversal, and a doubling that is transversal: so no more of the normal form is needed."""
        states = self.round(image, 1)
        (a, b, _), (c, d, _) = ((x * self.sign).gradient(self.p) for x in states[-1])
        det, one = a * d - b * c, (a - 1) * (d - 1) - b * c
        need(det < 1 and det > -1, "simple_multiplier, other_multiplier_stable: the other may be too large", Unproved)
        if self.kind == "flip":
            v = next((v for v in ((b, -a - 1), (d + 1, -c)) if 0 not in v[0] or 0 not in v[1]), None)
            w = next((w for w in ((c, -a - 1), (d + 1, -b)) if 0 not in w[0] or 0 not in w[1]), None)
            need(v and w, "nondegenerate: no eigenvector is enclosed", Unproved)
            (e, f), _ = self.along(image, states, v, (0, 0))
            bend = (b * f - (d - 1) * e) / one, (c * e - (a - 1) * f) / one  # then a round leaves the square as it is
            cubic = sum(x * y for x, y in zip(w, self.along(image, states, v, bend)[1]))
            need(0 not in cubic, "nondegenerate: the cubic coefficient of the normal form may be 0", Unproved)

    def along(self, image, states, v, bend):
        """A round later on the curve `start + v*e + bend*e**2`: the coefficients of `e**2` and `e**3`."""
        e, names = Jet.of(0, 3, 0), self.names(image[2])
        start, lam = [x + e * y + e * e * z for x, y, z in zip(image, v, bend)], self.lam if self.fixed else image[2]
        last = self.table.fly(start, self.way, names, lam, self.p, states)[-1]
        return [[x.c[algebra(3)[1][k, 0, 0]] * self.sign for x in last] for k in (2, 3)]

    def cornered(self, image, theta1):
        """What the corner orbit says more; the cuspless table's lower corner is its wall's end and its arc's start."""
        table, p, slopes, unstable = self.table, self.p, [], False
        edge, wall = table.ends(0, p)[1], table.ends(1, p)[1]
        need(theta1 > 0 and theta1 < 2, "minimal_period: a bounce may be at a corner or on the axis", Unproved)
        table.free([(0, edge), (1, -wall)], [(0, theta1)], {})  # the mirror does the other two
        table.free([(0, theta1)], [(0, -edge), (1, wall)], {})
        for side, at in ((0, -edge), (1, wall)):
            way = [(0, edge), (0, theta1), (side, at), (0, -theta1), (0, edge)]
            _, psi, lam = (Jet.of(x, 1, k) for k, x in enumerate(image))
            states = table.fly((Jet.of(edge, 1), psi), way, {}, lam, p)
            (_, motion, shift), (_, rise, growth) = (states[k][0].gradient(p) for k in (2, 4))
            slopes.append((motion, rise, growth - rise * shift / motion))
            start = tuple(Jet.of(value(x), 1, k) for k, x in enumerate(states[1]))
            _, (theta, _), last = table.fly(start, way[1:4], {}, image[2], p)
            (a, b, _), (c, d, _) = ((-x).gradient(p) for x in last)
            (e, f, _), trace, det = theta.gradient(p), a + d, a * d - b * c
            off = 0 not in e * (e * b + f * d) - f * (e * a + f * c)  # no eigenvector runs along the corner's preimage
            unstable = unstable or (det > 0 and trace - det > 1 and off)
        (motion, arc, _), (_, straight, fall) = slopes
        kink = (motion > 0 and straight < 0 and arc > 0) or (motion < 0 and arc < 0 and straight > 0)
        for item, holds in (("s4_minimum_at_a_kink", kink), ("s4_dips_below", fall < 0), ("unstable", unstable)):
            need(holds, f"{item}: this sign is not proved", Unproved)


ITEMS = ["exists", "unique", "precise", "admissible", "minimal_period"]
NORMAL = ["simple_multiplier", "transversal", "nondegenerate", "other_multiplier_stable"]
KINDS = {"cycle": ITEMS, "fold": ITEMS + NORMAL, "flip": ITEMS + NORMAL, "focus": ITEMS}
KINDS["corner"] = [*ITEMS, "s4_minimum_at_a_kink", "s4_dips_below", "unstable"]
SAYS = dict.fromkeys(KINDS, "{scene}: exactly one cycle with {n} and {free} in the box has {what}.")
SAYS |= {
    "cycle": "{scene}: exactly one cycle has {n} in the box.",
    "corner": "{scene}: exactly one orbit with theta and lam in the box runs from the upper corner to theta, the lower "
    "corner, -theta and back; it is unstable; as a function of the exit angle s_4 has a minimum at a kink there, which "
    "falls as lam grows; the value is {free}.",
}
WHAT = {"fold": "the multiplier 1: a fold", "flip": "the multiplier -1: a flip", "focus": "two equal multipliers"}


def exact(pair):
    mantissa, exponent = (int(text) for text in pair if isinstance(text, str))
    need(abs(exponent) <= 40_000, "an exponent is out of range")
    return Fraction(mantissa) * Fraction(2) ** exponent


def within(name, x):
    low, high = {"a": (1, 1000), "alpha": (0, Fraction(1, 2))}.get(name, (0, 1))
    need(x.lo >= I.of(low, x.p).hi and x.hi <= I.of(high, x.p).lo, f"{name} is out of range")
    return x


def read_scene(scene, free, p):
    """The table and the contraction that a scene says, and how it is called in words."""
    known = isinstance(scene, dict) and set(scene) <= {"table", "polar", "K", "shape", "lam"}
    need(known and ("table" in scene) != ("polar" in scene), "scene: the entries are table or polar, K, shape, lam")
    shape, lam, K, title = scene.get("shape", {}), scene.get("lam"), scene.get("K", 3), scene.get("table")
    need(type(K) is int and 2 <= K <= 50 and ("K" not in scene or title == "egg"), "scene: K is out of range")
    need(isinstance(shape, dict) and title in (None, *PAPER), "scene: there is no such table")
    letter, parts = PAPER.get(title) or ("", [(scene["polar"], "-pi", "pi")])
    need([*shape, *({free} - {"", "lam"})] == [letter][: len(letter)], "scene: the table has other letters")
    number = lambda name, text: within(name, I.of(evaluate(parse(text), {}, p)[0], p))
    table = Table(parts, {"K": I.of(K, p)} | {name: number(name, text) for name, text in shape.items()})
    if title is None:  # a closed curve that goes once round, counterclockwise
        title = "polar " + scene["polar"]
        rest = re.sub(r"\b(sin|cos)\((\d+\*)?theta\)", "", scene["polar"].replace(" ", ""))
        need("theta" not in rest, "scene: theta may stand only in sin(n*theta) and cos(n*theta)")
        for piece in (pi(64) * I(k << 56, (k + 1) << 56, 64) for k in range(-256, 256)):
            need(evaluate(table.parts[0][0], {"theta": piece}, 64)[0] > 0, "scene: the radius may not be positive")
    need((free == "lam") == (lam is None), "scene: lam has a value where it is not the free letter, and only there")
    title += f" of {K} points" * (K != 3) + "".join(f", {k} = {v}" for k, v in [*shape.items(), ("lam", lam)] if v)
    return table, lam and number("lam", lam), title


def named(kind, sign, parts, bounces, boxes, scene, free, title, p):
    """The name of a value, from the equations alone: one that symmetry or its place tells, or what is stated of it."""
    same = lambda x, box: (x - pi(p) * 2 * round((x - box).real() / 6.283185307179586)).inside(box)
    mirrored = sign > 0 and all(map(same, [-x for x in bounces], boxes))  # so it is its own image: there is no other
    turned = sign > 0 and all(map(same, [x + pi(p) * Fraction(2, 3) for x in bounces], boxes[1:] + boxes[:1]))
    what = scene.get("table") if scene.get("K", 3) == 3 else None, kind, free, len(parts)
    if kind == "corner":
        near = abs(bounces[1].real() - 0.2545) < 0.001
        return {"lam": "lambda-star", "phi": "phi-star"}[free] if near else "an orbit through both corners"
    special = {("cuspless", "flip", "lam", 2): "lambda-c", ("egg", "fold", "lam", 3): "saddle-node"}
    special |= {("egg", "flip", "alpha", 2): "alpha-tilde", ("egg", "focus", "alpha", 2): "alpha-hat"}
    if what in special and (turned if what[-1] == 3 else mirrored):
        return special[what]
    half = "half of a symmetric cycle," if sign < 0 else "a cycle"
    return f"{kind + ' of ' if free else ''}{half} of period {len(parts)}{' in ' + free if free else ''}: {title}"


def checked(given):
    """The line that says what is proved of a document; `Wrong` or `Unproved` say why not."""
    keys = "schema name statement kind scene free components mirror bits digits centre radius checks".split()
    need(isinstance(given, dict) and set(given) == set(keys), f"the entries must be {', '.join(keys)}")
    schema, name, words, kind, scene, free, parts, mirror, bits, digits, centre, radius, items = map(given.get, keys)
    need(schema == 2 and kind in KINDS, f"this checker reads schema 2, and of its kinds {', '.join(KINDS)}")
    fit = type(bits) is type(digits) is int and 16 <= bits <= 12_000 and 1 <= digits <= 3_000 and type(mirror) is bool
    need(items == dict.fromkeys(KINDS[kind], True), f"checks must list these as true: {', '.join(KINDS[kind])}")
    centre, radius = [exact(pair) for pair in centre], exact(radius)
    letters = {"cycle": [""], "corner": ["lam", "phi"], "focus": ["alpha"]}.get(kind, ["lam", "alpha", "a"])
    fit = fit and free in letters and radius > 0 and isinstance(parts, list) and 2 <= len(parts) <= 1024
    need(fit, "bits, digits, mirror, free, radius or components is out of range")
    p = 16 * len(parts) + max(bits + 96, *(x.denominator.bit_length() for x in [*centre, radius]))
    table, lam, title = read_scene(scene, "lam" if kind == "corner" else free, p)
    fit = all(type(k) is int and 0 <= k < len(table.parts) for k in parts) and (not mirror or "table" in scene)
    fit = fit and (kind != "corner" or (scene == {"table": "cuspless"} and parts == [0, 0] and mirror))
    need(
        fit and len(centre) == len(parts) + (free != "" and kind != "corner"), "components, centre or mirror do not fit"
    )
    n = f"its {len(parts)} bounces" if not mirror else f"{len(parts)} bounces, and then their mirror images,"
    said = SAYS[kind].format(scene=title, n=n, free=free, what=WHAT.get(kind))
    need(words == said, f"the statement must be: {said!a}")
    boxes = [I.of(x - radius, p).hull(I.of(x + radius, p)) for x in centre]
    box = boxes.pop() if free else None
    if kind == "corner":  # where the first bounce is
        boxes.insert(0, table.ends(0, p)[1].wide(I.of(radius, p)))
    cycle = Cycle(table, kind, parts, boxes, -1 if mirror else 1, "lam" if kind == "corner" else free, box, lam, p)
    image, bounces = cycle.solved()
    within(free, image[2]) if free else None
    found = image[2] if free in ("lam", "alpha", "a") else image[1] if free == "phi" else bounces[-1]
    need((found.hi - found.lo) * 10**digits <= 1 << p, "precise: the enclosure is wider than the digits say", Unproved)
    cycle.cornered(image, bounces[1]) if kind == "corner" else cycle.admissible(bounces, image[2])
    cycle.generic(image) if kind in ("fold", "flip") else None
    true = named(kind, cycle.sign, parts, bounces, boxes, scene, free, title, p)
    need(name == true, f"the name must be {true!a}")
    scaled = round(Fraction(found.lo + found.hi, 2 << p) * 10**digits)
    decimal = f"{'-' if scaled < 0 else ''}{abs(scaled) // 10**digits}.{abs(scaled) % 10**digits:0{digits}d}"
    return f"proved: {true}{' = ' if free else ', last bounce at '}{decimal}, within 1e-{digits}\n  {said}"


def main(paths):
    """Prints a verdict for each file; 0 when all are proved."""
    done = bool(paths)
    for path in paths:
        try:
            said = checked(json.loads(Path(path).read_text(encoding="utf-8")))
        except (Unproved, Wrong) as why:
            said, done = f"{'not proved' if isinstance(why, Unproved) else 'refused'}: {why}", False
        except Exception as why:  # a file that cannot be read, or entries of the wrong kind
            said, done = f"refused: this is no certificate ({type(why).__name__})", False
        print(f"{ascii(path)[1:-1]}: {said}")
    return 0 if done else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
