"""Boundary crises between two contractions, for `check.py`: a saddle, a branch of its manifold, and two sets of cells.

The statement and its proof are in docs/certificate_format.md. Everything is taken modulo the rotations of the table.
"""

from fractions import Fraction
from math import ceil, isqrt, log, log2

from check import I, Jet, Unproved, Wrong, function, need, pi, read_scene, value
from region import BITS, HALVINGS, Inside, bend, convex

GRID, MOST = (342, 512), 60_000  # columns for a part of the table that turns onto the next, and rows; cells of a set
CUTS, PIECES = 16, 96  # of lam; of the branch
AWAY, SAMPLES, LONG, STEP = 0.1, 400, 60, 0.381966  # how far from the saddle the pieces are; orbits that are tried
SMALL, TINY, MORE = 24, 240, 1200  # bits by which the local branch is small; more of them for one orbit along it
WHERE, NEAR, LANDING, TRIED = (Fraction(1, n) for n in (10**5, 2**36, 2**12, 80))  # about a saddle, about landings


def crisis(given):
    """The line that says what is proved of a document."""
    scene, (turns, q), low, high = said(given)
    table, _, words = read_scene(scene, "lam", BITS)
    finer, finest = (read_scene(scene, "lam", bits)[0] for bits in (4 * BITS, MORE))
    at, side = given["saddle"]["start"][0], given["side"]
    true = f"boundary crisis of {words}, saddle at theta = {at:.5f}, {turns}/{q} of a turn a bounce, side {side:+d}"
    true += f": lam between {low} and {high}"
    need(given["name"] == true, f"the name must be: {true!a}", Wrong)
    convex(table)
    saddle = continued(table, Fraction(turns, q), low, high, at)
    strip = I.of(high, BITS)
    both, below = (Grown(table, lam, strip, q) for lam in (I.of(low, BITS).hull(strip), I.of(low, BITS)))
    taken = both.grow(both.met(*(I.of(Fraction(x), BITS) for x in given["sink"])))
    first = Branch(finer, Fraction(turns, q), low, saddle[0], SMALL)
    kept = below.grow(cell for box in first.pieces(side, below) for cell in below.met(*box))
    touched = {(i % GRID[0], j) for i, row in kept for i in range(i - 1, i + 2) for j in range(row - 1, row + 2)}
    need(not touched & taken, "apart: the two sets may have a common point")
    rough, last = (Branch(t, Fraction(turns, q), high, saddle[1], k) for t, k in ((table, SMALL), (finest, TINY)))
    need(last.leaves(side, both, taken, rough), "leaves: no orbit along the branch is seen to enter the other set")
    return f"proved: {true}\n  {len(kept)} cells are kept at {low}, {len(taken)} are trapping up to {high}."


def said(given):
    """The scene, the rotation that makes a bounce a round, and the ends of lam."""
    scene, saddle, ends, numbers = given["scene"], given["saddle"], given["lam"], [given["start"], *given["sink"]]
    known = scene.get("table") == "egg" and "law" not in scene
    need(known, "scene: of crises this reader knows those of the paper's egg under its law alone", Wrong)
    (turns, q), numbers = saddle["shift"], [*numbers, *saddle["start"]]
    fit = 0 < turns < q and scene.get("K", 3) % q == 0
    need(fit, "saddle: a round is not one bounce and a turn of the table", Wrong)
    fit = all(type(x) is float and abs(x) < 10 for x in numbers) and all(str(Fraction(x)) == x for x in ends)
    low, high = map(Fraction, ends)
    need(fit and 0 < low < high < 1, "lam, start or sink is out of range", Wrong)
    read_scene(scene, "", BITS)  # its own lam says nothing here, and must be one
    return {key: x for key, x in scene.items() if key != "lam"}, (turns, q), low, high


def law(table, turn, theta, lam):
    """The exit angle of the chord from a place to the next minus the one by the law; and this exit angle."""
    p = table.p
    (x, y, tx, ty), (u, v, sx, sy) = (table.at(0, z, table.letters, p) for z in (theta, theta + pi(p) * (turn * 2)))
    dx, dy = u - x, v - y
    ahead, behind = dy * tx - dx * ty, dx * sy - dy * sx
    need(value(ahead) > 0 and value(behind) > 0, "saddle: a chord may not run inside", Unproved)
    out = function("atan", (dx * tx + dy * ty) * function("inverse", ahead, p), p)
    return out - function("atan", (dx * sx + dy * sy) * function("inverse", behind, p), p) * lam, out


def found(table, turn, lam, start):
    """The place near a start where the law holds, by the secant method in floats."""
    p = table.p
    at, before = I.of(Fraction(start), p), I.of(Fraction(start) + Fraction(1, 2**20), p)
    old = value(law(table, turn, before, lam)[0]).mid()
    for _ in range(40):
        new = value(law(table, turn, at, lam)[0]).mid()
        if abs((new - old).lo) < 64 or abs((at - before).lo) < 64:
            break
        at, before, old = (at - new * ((at - before) / (new - old))).mid(), at, new
    return at


def one(table, turn, box, lam):
    """Proves that for each lam of a range the law holds at exactly one place of a box."""
    p, (left, right) = table.p, (I(end, end, table.p) for end in (box.lo, box.hi))
    slope = law(table, turn, Jet.of(box, 1, 0), lam)[0].gradient(p)[0]
    a, b = (value(law(table, turn, end, lam)[0]) for end in (left, right))
    fit = (slope > 0 and a < 0 and b > 0) or (slope < 0 and a > 0 and b < 0)
    need(fit, "saddle: not seen to be one cycle")


def derivative(table, turn, state, lam):
    """The derivative of a bounce and a rotation back, over a box of states, and its determinant.

    With the angle `tau` of the tangent the law is `psi1 = -lam*(psi + tau1 - tau - pi)`.
    """
    p, (theta, _), names = table.p, state, table.letters | {"lam": lam}
    way = [(0, theta), (0, (theta + pi(p) * (turn * 2)).wide(I.of(LANDING, p)))]
    _, (there, _) = table.orbit(lambda x, y, _: (x, y, names), [*state, lam], way, 2)
    (a, b, _), here, then = there.gradient(p), bend(table, theta), bend(table, value(there))
    return (a, b), ((here - then * a) * lam, (then * b + 1) * -lam), (a + b * here) * -lam


def continued(table, turn, low, high, at):
    """Proves one curve of saddles from `low` to `high`, with a non-vertical unstable direction; returns its end."""
    p, places = table.p, []
    ends = [low + (high - low) * Fraction(k, CUTS) for k in range(CUTS + 1)]
    for lam in ends:
        places.append(found(table, turn, I.of(lam, p), places[-1].real() if places else at))
    near = [x.wide(I.of(NEAR, p)) for x in places]
    need(near[0].inside(I.of(Fraction(at), p).wide(I.of(WHERE, p))), "saddle: it is not where it is said")
    for k in range(CUTS):
        lam = I.of(ends[k], p).hull(I.of(ends[k + 1], p))
        box = near[k].hull(near[k + 1])
        box = box.wide(box - box.mid())
        one(table, turn, box, lam)
        for x, end in zip(near[k : k + 2], ends[k : k + 2], strict=True):  # the same cycle on both sides of a join
            one(table, turn, x, I.of(end, p))
            need(x.inside(box), "saddle: the cycle at an end may be another")
        slope = law(table, turn, Jet.of(box, 1, 0), lam)[1].gradient(p)[0]
        out = value(law(table, turn, box.mid(), lam)[1]).wide(slope * (box - box.mid()))
        (a, b), (_, d), det = derivative(table, turn, (box, out), lam)
        trace = a + d
        need(1 - trace + det < 0 and 1 + trace + det > 0 and 0 not in b, "saddle: its multipliers are not seen")
    return near[0], near[-1]


class Branch:
    """The unstable manifold near a saddle: a curve `y = w(x)`, `abs(w) <= slope*abs(x)`, for `abs(x) <= reach`.

    A state is the saddle plus `x` and `y` times directions whose first entry is 1. Where derivatives keep the cone
    `abs(dy) <= slope*abs(dx)` and stretch `dx`, a round maps such curves to such curves, and contracts their distance.
    """

    def __init__(self, table, turn, lam, near, small):
        p, self.table, self.turn, self.lam = table.p, table, turn, I.of(lam, table.p)
        at = found(table, turn, self.lam, near.real())
        self.theta = at.wide(I(1 << 24, 1 << 24, p))
        one(table, turn, self.theta, self.lam)
        need(self.theta.inside(I.of(near, p)), "manifold: the saddle may be another")
        self.psi = value(law(table, turn, self.theta, self.lam)[1])
        self.grows, self.along, self.across = self.frame()
        self.reach, self.slope = Fraction(1, 2**small), Fraction(256, 2**small)  # so `x` has the sign of theta
        self.most = self.proved()

    def frame(self):
        """Approximations of the unstable multiplier and of both directions."""
        p, state = self.table.p, (self.theta.mid(), self.psi.mid())
        (a, b), (_, d), det = derivative(self.table, self.turn, state, self.lam)
        a, b, trace, det = (x.mid() for x in (a, b, a + d, det))
        root = (trace * trace - det * 4).mid()
        root = I(isqrt(root.lo << p), isqrt(root.lo << p), p)
        grows, falls = (trace + root) / 2, (trace - root) / 2
        return grows.mid(), *(((half - a) / b).mid() for half in (grows, falls))

    state = lambda self, x, y: (x + y + self.theta, x * self.along + y * self.across + self.psi)  # noqa: E731

    def proved(self):
        """An upper bound of the factors of a round along the curve, when the manifold is proved."""
        p, s = self.table.p, self.slope
        x = I.of(0, p).wide(I.of(self.reach, p))
        (a, b), (c, d), _ = derivative(self.table, self.turn, self.state(x, x * s), self.lam)
        one, images = 1 / (self.across - self.along), [(a + b * k, c + d * k) for k in (self.along, self.across)]
        (e, g), (f, h) = (((u * self.across - v) * one, (v - u * self.along) * one) for u, v in images)
        f = f.size() * s
        need(e - f > 1 and (g.size() + h.size() * s - (e - f) * s).hi < 0, "manifold: the cone is not kept")
        need(h.size() + f < 1, "manifold: two curves may not come closer")
        return Fraction((e + f).hi, 1 << p)

    def sampled(self, x, rounds, map, until=lambda box: False):
        """An orbit along the curve in floats, bounce by bounce, until a condition holds; and its last state."""
        p, names, way = self.table.p, self.table.letters | {"lam": self.lam}, []
        here = [z.mid() for z in self.state(x.mid(), I.of(0, p))]
        while len(way) <= rounds:
            way.append((0, here[0].wide(I.of(Fraction(1, 2**9), p))))
            if until(here):
                break
            there = I.of(Fraction(map.guess(here[0].real(), here[1].real())), p).wide(I.of(TRIED, p))
            here = [value(z).mid() for z in self.table.flight(0, (0, there), [Jet.of(z, 0) for z in here], names)]
        return way, here

    def followed(self, x, way):
        """An enclosure of the last state of all orbits that start over an interval of the curve."""
        p, names = self.table.p, self.table.letters | {"lam": self.lam}
        need((x.size() - self.reach).hi <= 0, "manifold: a start beyond it")
        launch = lambda x, y, lam: (*self.state(x, y), names)  # noqa: E731
        states = self.table.orbit(launch, [x, I.of(0, p).wide(x * self.slope), self.lam], way, 1)
        return [value(z) for z in states[-1]]

    def pieces(self, side, map):
        """Boxes that hold a piece of the branch from a point to its image, some rounds away from the saddle."""
        rounds = 1 + ceil(log(AWAY / self.reach) / log(self.most))
        ends = [self.reach / Fraction(float(self.most) ** (k / PIECES)) for k in range(PIECES)]
        ends.append(self.reach / self.most)
        for a, b in zip(ends[1:], ends, strict=False):
            x = I.of(a, self.table.p).hull(I.of(b, self.table.p)) * side
            yield self.followed(x, self.sampled(x, rounds, map)[0])

    def leaves(self, side, map, cells, rough, samples=SAMPLES):
        """True if an orbit along the branch enters the cells: it is found in floats, then enclosed."""
        rounds = LONG + ceil(log(AWAY / rough.reach) / log(rough.most))
        down = ceil((TINY - SMALL) / log2(self.grows.real()))
        enters = lambda box: {*map.met(*(I.of(z, BITS) for z in box))} <= cells  # noqa: E731
        for k in range(samples):
            x = rough.reach / Fraction(float(rough.most) ** (k * STEP % 1))
            try:
                if enters(rough.sampled(I.of(x, BITS) * side, rounds, map, enters)[1]):
                    far = I.of(x, MORE) * side
                    for _ in range(down):
                        far = (far / self.grows).mid()
                    if enters(self.followed(far, self.sampled(far, rounds + down, map, enters)[0])):
                        return True
            except Unproved:  # of this orbit nothing is known
                continue
        return False


class Grown(Inside):
    """The cells, of one fundamental part of the table, that a set of cells and its later images meet."""

    def __init__(self, table, lam, high, parts):
        super().__init__(table, lam, high, (parts * GRID[0], GRID[1]), set())

    def met(self, theta, phi):
        """The cells of the fundamental part that a rectangle meets, borders included, after rotation into it."""
        return {(i % GRID[0], j) for i, j in super().met(theta, phi)}

    def grow(self, seeds):
        """The smallest set that holds these cells and all cells that images of its cells meet."""
        found = {*seeds}
        new = [*found]
        while new:
            column, row = new.pop()
            more = self.images(Fraction(column), Fraction(row), Fraction(1), HALVINGS) - found
            found |= more
            new += more
            need(len(found) <= MOST, "kept, taken: the cells have no end")
        return found

    def images(self, column, row, size, more):
        """The cells that the image of a square of cells meets; squares are halved where the image is not enclosed."""
        try:
            return self.met(*self.image(column, row, size))
        except Unproved as why:
            need(more, why)
        half = size / 2
        corners = [(x, y) for x in (column, column + half) for y in (row, row + half)]
        return set().union(*(self.images(*at, half, more - 1) for at in corners))
