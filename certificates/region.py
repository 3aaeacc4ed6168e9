"""Trapping regions, for `check.py`: cells of phase space that the map takes into their interior, image by image.

The proof is explained in docs/certificate_format.md.
"""

from bisect import bisect
from fractions import Fraction
from math import cos, sin

from check import I, Jet, Unproved, Wrong, need, pi, read_scene, value
from curves import covered, piece_of

BITS, HALVINGS, POINTS = 64, 4, 512  # of numbers; of a cell; of the boundary, at which guesses begin
CELLS = 60_000  # of a region
TURN = 6.283185307179586  # of guesses alone


def trapping(given):
    """Proves for each lam of a range that the map takes a document's cells into their interior; returns the line.

    After quick tests, each cell is halved in both directions where its image is not proved to lie inside.
    """
    cells, count = blocks(given)
    table, words, low, high = placed(given)
    true = f"trapping region of {words}: {count} box{'es'[: 2 * (count > 1)]} on a grid of "
    true += f"{given['columns']} by {given['rows']}"
    need(given["name"] == true, f"the name must be: {true!a}", Wrong)
    convex(table)
    inside = Inside(table, low.hull(high), high, (given["columns"], given["rows"]), cells)
    for column, row in sorted(cells):
        inside.cell(Fraction(column), Fraction(row), Fraction(1), HALVINGS)
    return f"proved: {true}\n  For every such lam the image of each of its points lies in its interior."


def blocks(given):
    """The cells of a document, column by row, and the number of its blocks; no cell twice or beyond the grid."""
    columns, rows, found, count = given["columns"], given["rows"], set(), 0
    need(all(2 <= n <= 8192 for n in (columns, rows)), "a count is out of range", Wrong)
    for chart, size, column, row, high in given["runs"]:
        within = size > 0 and high > 0 and column <= columns - size and row <= rows - size * high
        need(chart == 0 and within, "a run is beyond the grid", Wrong)
        need(len(found) + size * size * high <= CELLS, f"this reader takes up to {CELLS} cells", Wrong)
        block = {(column + i, row + j) for i in range(size) for j in range(size * high)}
        need(not block & found, "a cell stands twice in runs", Wrong)
        found, count = found | block, count + high
    need(found, "runs has no cell", Wrong)
    return found, count


def placed(given):
    """The table, one closed curve under the paper's law; its title in words; and the ends of lam."""
    scene, ends = given["scene"], given["lam"]
    need("law" not in scene, "scene: of laws this reader knows -lam*eta alone", Wrong)
    need(all(str(Fraction(x)) == x for x in ends), "lam: an end is no fraction in lowest terms", Wrong)
    need(0 <= Fraction(ends[0]) <= Fraction(ends[1]) < 1 and ends[1] != "0", "lam is out of range", Wrong)
    low, high = (I.of(Fraction(x), BITS) for x in ends)
    table, _, words = read_scene({key: x for key, x in scene.items() if key != "lam"}, "lam", BITS)
    need("table" in scene or "polar" in scene, "scene: this reader knows the paper's tables and radii alone", Wrong)
    need(table.closed == [True] and not table.marks, "convex_table: not one smooth closed curve", Unproved)
    return table, f"{words}, lam = {ends[0]}" + ("" if ends[0] == ends[1] else f" to {ends[1]}"), low, high


def convex(table):
    """Proves that a curve which runs once around a point, at growing polar angles, turns to one side everywhere.

    So a line that leaves inwards meets it at exactly one other point, and is inside on the way there.
    """

    def settled(a, b):
        turn = bend(table, piece_of((-pi(table.p), pi(table.p)), a, b, table.p))
        need(turn.hi > 0, "convex_table: the boundary bends outwards", Wrong)
        return turn > 0

    covered(settled, 2000, "convex_table: the boundary may bend outwards")


def bend(table, theta):
    """The rate at which the tangent turns, by the parameter."""
    p = table.p
    tx, ty = table.at(0, Jet.of(theta, 1, 0), table.letters, p)[2:]
    (x, y), (fast_x, *_), (fast_y, *_) = (I.of(value(t), p) for t in (tx, ty)), tx.gradient(p), ty.gradient(p)
    return (x * fast_y - y * fast_x) / (x * x + y * y)


class Inside:
    """Images of rectangles of a grid, and a test whether the cells cover them, borders included.

    Column `i` is `-pi + 2*pi*[i, i + 1]/columns`; rows divide the strip that holds all particles in the same way.
    """

    def __init__(self, table, lam, high, grid, cells):
        self.table, self.lam, self.cells, self.p = table, lam, cells, table.p
        self.columns, self.rows = grid
        self.top = pi(self.p) / 2 * high  # above the angle at which any particle leaves
        at = (table.at(0, I.of(Fraction(TURN * k / POINTS), self.p), table.letters, self.p)[:2] for k in range(POINTS))
        self.points = [(x.real(), y.real()) for x, y in at]

    def cell(self, column, row, size, more):
        """Proves that the image of a square of cells, or of a part of one, lies in the interior of all cells."""
        try:
            if self.covered(*self.image(column, row, size)):
                return
        except Unproved as why:  # as far as this square goes
            need(more, why)
        need(more, f"images_inside: that of column {int(column)}, row {int(row)} may not lie in the interior")
        for x in (column, column + size / 2):
            for y in (row, row + size / 2):
                self.cell(x, y, size / 2, more - 1)

    def image(self, column, row, size):
        """The landings of a square, and the exit angles there, for every lam."""
        landing, psi = self.landing(column, row, size)
        return landing, psi * self.lam

    def landing(self, column, row, size):
        """The landings of a square, and minus the angles of arrival, by the mean-value theorem.

        The angle of arrival is `-(phi + tau(landing) - tau(theta) - pi)`, where the tangent has the angle `tau`.
        """
        part = lambda k, n: I.of(k / n * 2 - 1, self.p).hull(I.of((k + size) / n * 2 - 1, self.p))  # noqa: E731
        theta, phi = pi(self.p) * part(column, self.columns), self.top * part(row, self.rows)
        there = I.of(Fraction(self.guess(theta.real(), phi.real())), self.p)
        near, names = there.wide(I.of(Fraction(TURN / POINTS), self.p)), self.table.letters | {"lam": I.of(1, self.p)}
        middle, ends = (
            self.table.flight(0, (0, near), [Jet.of(x, d, k) for k, x in enumerate(at)], names)
            for d, at in enumerate([(theta.mid(), phi.mid()), (theta, phi)])
        )
        (x, psi), (a, b, _), (u, v) = (
            map(value, middle),
            ends[0].gradient(self.p),
            (theta - theta.mid(), phi - phi.mid()),
        )
        landing = value(ends[0]).meet(x.wide(a * u).wide(b * v))
        need(landing.lo <= landing.hi, "images_enclosed: the middle does not land where the square does")
        turn = bend(self.table, landing)
        return landing, psi.wide((turn * a - bend(self.table, theta)) * u).wide((turn * b + 1) * v)

    def covered(self, theta, phi):
        """True if the cells contain a rectangle and all cells next to it."""
        return all(cell in self.cells for cell in self.met(theta, phi))

    def met(self, theta, phi):
        """The cells that a rectangle meets or is next to; no particle leaves the strip."""
        u = (theta / pi(self.p) + 1) * self.columns / 2
        v = (phi / self.top + 1) * self.rows / 2
        (a, b), (c, d) = (((x.lo - 1) >> x.p, (x.hi + 1) >> x.p) for x in (u, v))
        c, d = max(c, 0), min(d, self.rows - 1)
        need(c <= d, "images_enclosed: an image lies outside the strip")
        across = range(a, min(b, a + self.columns - 1) + 1)
        return [(i % self.columns, j) for i in across for j in range(c, d + 1)]

    def guess(self, theta, psi):
        """A landing in floats: counterclockwise from the start, points before it are right of the line."""
        x, y, tx, ty = (z.real() for z in self.table.at(0, I.of(Fraction(theta), self.p), self.table.letters, self.p))
        ux, uy, first = tx * sin(psi) - ty * cos(psi), ty * sin(psi) + tx * cos(psi), int(theta % TURN * POINTS / TURN)
        ahead = [self.points[(first + k) % POINTS] for k in range(1, POINTS)]
        k = bisect(ahead, False, key=lambda z: ux * (z[1] - y) > uy * (z[0] - x))
        return (first + k + 0.5) * TURN / POINTS
