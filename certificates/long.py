"""Cycles of many bounces, for `check.py`, which follows short cycles as orbits and loses digits with each bounce.

The unknowns are all bounces and the free parameter. At each bounce the law gives an equation R = 0 in its parameter and
those of both neighbours. A multiplier 1 or -1 means a null vector of the linearised equations that a round maps to
itself or its negative. Bordered by a row and a column with one entry each, the linear system is regular, and with the
right-hand side (0, ..., 0, 1) its last unknown, g, is 0 if and only if there is such a vector. Linear systems have an
approximate inverse C, in doubles. Where all row sums of abs(1 - C*A) are below 1 for every A in a box of matrices,
these are regular, and A*x = b has abs(x - y) <= max(abs(C*(b - A*y)))/(1 - the largest sum).
"""

from fractions import Fraction

from check import Cycle, I, Jet, Wrong, algebra, function, need, value
from tangency import composed

SHIFT, OFF = 64, Fraction(1, 2**40)  # bits of the approximate inverse; shift of a singular matrix
ROUNDS, GAIN = 2, 24  # of improvement; bits that one gains, and more


class Linear:
    """A square system of intervals, each row a dictionary from columns; refused where it may be singular."""

    def __init__(self, rows, p):
        self.rows, self.p = rows, p
        self.inverse = [[round(x * 2**SHIFT) for x in row] for row in inverse(rows)]
        halves = [[(j, x.lo + x.hi, x.hi - x.lo) for j, x in row.items()] for row in rows]  # twice middle and radius
        self.sums = []
        for i, row in enumerate(self.inverse):
            middles = [-(2 << (p + SHIFT)) * (i == j) for j in range(len(rows))]
            for c, entries in zip(row, halves):
                for j, m, _ in entries:
                    middles[j] += c * m
            off = sum(abs(c) * r for c, entries in zip(row, halves) for *_, r in entries)
            self.sums.append((sum(map(abs, middles)) + off >> SHIFT + 1) + 1)
        self.norm = I(max(self.sums), max(self.sums), p)
        need(self.norm < 1, "exists, unique: a linear system may be singular")

    def times(self, vector):
        """The product of the approximate inverse and a vector of intervals."""
        middles, widths = [x.lo + x.hi for x in vector], [x.hi - x.lo for x in vector]
        found = []
        for row in self.inverse:
            m, r = sum(map(int.__mul__, row, middles)), sum(map(int.__mul__, map(abs, row), widths))
            found.append(I((m - r) >> SHIFT + 1, -(-(m + r) >> SHIFT + 1), self.p))
        return found

    def residual(self, right, x):
        return [b - sum(a * x[j] for j, a in row.items()) for row, b in zip(self.rows, right)]

    def solve(self, right, rounds):
        """Enclosures of the unknowns for every matrix and every right-hand side in the intervals."""
        x = [I.of(0, self.p)] * len(right)
        for _ in range(rounds):
            x = [(a + b).mid() for a, b in zip(x, self.times(self.residual(right, x)))]
        off = max((y.size() for y in self.times(self.residual(right, x))), key=lambda y: y.lo) / (1 - self.norm)
        return [y.wide(I(off.hi, off.hi, self.p)) for y in x]


def inverse(rows):
    """An approximate inverse of the midpoint matrix, in doubles, by elimination of sparse rows."""
    n = len(rows)
    left = [{j: x.real() for j, x in row.items()} for row in rows]
    right = [[float(i == j) for j in range(n)] for i in range(n)]
    order, free = [], set(range(n))
    for k in range(n):
        having = [i for i in free if left[i].get(k)]
        need(having, "exists, unique: a linear system may be singular")
        top = max(having, key=lambda i: abs(left[i][k]))
        free.remove(top)
        order.append(top)
        for i in having:
            if i != top:
                by = left[i].pop(k) / left[top][k]
                for j, x in left[top].items():
                    if j != k:
                        left[i][j] = left[i].get(j, 0.0) - by * x
                right[i] = [a - by * b for a, b in zip(right[i], right[top])]
    found = [None] * n
    for k in reversed(range(n)):
        row, total = left[order[k]], right[order[k]]
        for j, x in row.items():
            if j > k:
                total = [a - x * b for a, b in zip(total, found[j])]
        found[k] = [a / row[k] for a in total]
    return found


class Long(Cycle):
    """A cycle like `check.Cycle`, proved by the equations in the docstring of this file."""

    def chords(self, bounces, letter, degree):
        """For each chord, and for the first one of the next round, its angle and the one that the law requires next."""
        p, n, found = self.p, len(self.parts), []
        ends = self.round(bounces, 1)
        for k in range(n + 1):
            here, there = (Jet.of(x, degree, place) for place, x in enumerate(ends[k : k + 2]))
            names = self.names(Jet.of(letter, degree, 2) if self.free else letter)
            x, y, tx, ty = self.table.at(self.parts[k % n], here, names, p)
            u, v, a, b = self.table.at(self.parts[(k + 1) % n], there, names, p)
            dx, dy = u - x, v - y
            leaves, lands = dy * tx - dx * ty, dx * b - dy * a
            need(value(leaves) > 0 and value(lands) > 0, "admissible: a chord may not leave or arrive inwards")
            psi, arrived = (
                function("atan", along * function("inverse", across, p), p)
                for along, across in ((dx * tx + dy * ty, leaves), (dx * a + dy * b, lands))
            )
            found.append((psi, self.table.leaves(arrived, names | {"eta": -arrived, "theta": there})))
        return found

    def turned(self, k, twist):
        """The column of bounce k, and its sign: after a round comes the mirror image, times the multiplier's sign."""
        n = len(self.parts)
        return k % n, (self.sign * twist) ** (k // n)

    def matrix(self, chords, twist, free):
        """The matrix of the linearised equations: rows for the bounces from the second to the next round's first."""
        rows = []
        for k in range(1, len(self.parts) + 1):
            row = {}
            for jet, first in ((chords[k][0], k), (-chords[k - 1][1], k - 1)):
                slopes = jet.gradient(self.p)
                for place in (0, 1):
                    column, by = self.turned(first + place, twist)
                    row[column] = row.get(column, 0) + slopes[place] * by
                if free:
                    row[len(self.parts)] = row.get(len(self.parts), 0) + slopes[2]
            rows.append(row)
        return rows

    def bordered(self, rows, edge):
        """The matrix bordered by a row and a column, each with one entry, and its transpose."""
        n, (i, j) = len(rows), edge
        one = I.of(1, self.p)
        more = [row | ({n: one} if k == i else {}) for k, row in enumerate(rows)] + [{j: one}]
        over = [{} for _ in more]
        for k, row in enumerate(more):
            for column, x in row.items():
                over[column][k] = x
        return Linear(more, self.p), over

    def edge(self, rows):
        """The indices at which approximate left and right null vectors are largest."""
        whole = inverse([row | {k: row[k] + OFF} for k, row in enumerate(rows)])
        right = max(range(len(rows)), key=lambda k: sum(map(abs, whole[k])))
        left = max(range(len(rows)), key=lambda k: sum(abs(row[k]) for row in whole))
        return left, right

    def vectors(self, chords):
        """The right and the left null vectors of the linearised equations, up to g; one entry of each is 1."""
        system, over = self.bordered(self.matrix(chords, self.twist, False), self.border)
        return [x.solve(self.end, ROUNDS)[:-1] for x in (system, Linear(over, self.p))]

    def solved(self):
        """Enclosures of the one solution in the boxes, in the order of `Cycle`, and of all bounces."""
        p, n, self.free = self.p, len(self.parts), self.kind != "cycle"
        need(self.kind in ("cycle", "fold", "flip"), "kind: that of a long cycle is another", Wrong)
        self.twist, self.end = -1 if self.kind == "flip" else 1, [I.of(0, p)] * n + [I.of(1, p)]
        unknowns = [*self.boxes, self.box][: n + self.free]
        middle = [x.mid() for x in unknowns]
        letters = (middle[-1], self.box) if self.free else (self.lam, self.lam)
        point, over = self.chords(middle[:n], letters[0], 1), self.chords(self.boxes, letters[1], 1 + self.free)
        values = [I.of(value(point[k][0]) - value(point[k - 1][1]), p) for k in range(1, n + 1)]
        rows = self.matrix(over, 1, self.free)
        if self.free:
            near = self.matrix(point, self.twist, False)
            self.border = self.edge(near)
            values.append(self.bordered(near, self.border)[0].solve(self.end, p // GAIN)[n])
            rows.append(self.moving(over, *self.vectors(over)))
        system, image = Linear(rows, p), []
        radius = max((x - x.mid()).size().lo for x in unknowns)
        for m, step, total, box in zip(middle, system.times(values), system.sums, unknowns):
            image.append((m - step).wide(I(total, total, p) * I(radius, radius, p)))
            need(image[-1].inside(box), "exists, unique: interval Newton does not map the box into itself")
        self.bounces = image[:n]
        return [image[0], None, image[-1] if self.free else self.box], self.bounces

    def round(self, vector, twist):
        """A vector over the bounces, extended by its first two entries as they are a round later."""
        return vector + [x * (self.sign * twist) for x in vector[:2]]

    def moving(self, chords, w, u):
        """The derivatives of g by the bounces and the free parameter, from those of the matrix between both vectors."""
        row, w = {}, self.round(w, self.twist)
        slopes = [[jet.diff(0) * w[k] + jet.diff(1) * w[k + 1] for jet in pair] for k, pair in enumerate(chords)]
        for of_one, y in zip(self.matrix(slopes, 1, True), u):
            for column, x in of_one.items():
                row[column] = row.get(column, 0) - x * y
        return row

    def generic(self, image):
        """Proves the genericity conditions: the other multiplier, and the branching of cycles of twice the length.

        Along w*e + h*e**2, with the h of this cycle's own closure for which the equations have no e**2, they have e**3
        times a vector. Its product with u is not 0: the reduced equation of the longer cycles is a*e + b*e**3 with b
        not 0.
        """
        n, p, chords = len(self.parts), self.p, self.chords(self.bounces, image[2], 3)
        det = I.of(1, p)
        for k in range(n):
            det = det * chords[k][1].gradient(p)[0] / chords[k + 1][0].gradient(p)[1]  # up to its sign
        need(det < 1 and det > -1, "simple_multiplier, other_multiplier_stable: the other may be too large")
        if self.kind == "flip":
            w, u = self.vectors(chords)
            zero = [I.of(0, p)] * n
            second = [-x for x, _ in self.along(chords, w, zero)]
            h = Linear(self.matrix(chords, 1, False), p).solve(second, ROUNDS)
            cubic = sum(x * y for x, (_, y) in zip(u, self.along(chords, w, h)))
            need(0 not in cubic, "nondegenerate: the cubic coefficient of the normal form may be 0")

    def along(self, chords, w, h):
        """The coefficients of e**2 and e**3 in each equation, along w*e + h*e**2."""
        found, w, h = [], self.round(w, self.twist), self.round(h, 1)
        e = Jet.of(0, 3, 0)
        ways = [e * a + e * e * b for a, b in zip(w, h)]
        for k in range(1, len(self.parts) + 1):
            gap = composed(chords[k][0], [*ways[k : k + 2], e * 0]) - composed(
                chords[k - 1][1], [*ways[k - 1 : k + 1], e * 0]
            )
            found.append([gap.c[algebra(gap.degree)[1][n, 0, 0]] for n in (2, 3)])
        return found
