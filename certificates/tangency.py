"""Tangencies of two manifolds, for `check.py`, its only import; the proof is in docs/certificate_format.md."""

from fractions import Fraction

from check import I, Jet, Table, Wrong, algebra, evaluate, exact, function, implicit, need, newton, value


def composed(f, letters):
    """A polynomial of three letters with jets in place of the letters."""
    total = 0
    for e, at in algebra(f.degree)[1].items():
        term = f.c[at]
        for letter in (letter for letter, n in zip(letters, e) for _ in range(n)):
            term = letter * term
        total = total + term
    return total


class Back(Table):
    """A table with time reversed: particles arrive at the reversed exit angle and leave at the angle of incidence."""

    def __init__(self, table):
        self.__dict__ = table.__dict__

    def leaves(self, psi, names):
        """The angle of incidence, with the sign of a particle that leaves, which the law maps to `-psi`.

        It is unique among the angles between it and 0, so it is the same at every call.
        """
        if self.law is None:
            return psi * names["1/lam"]

        def off(eta, cut):
            known = {name: cut(x) for name, x in names.items()}
            at = {name: value(x) for name, x in names.items()} | {"eta": Jet.of(value(eta), 1, 0)}
            slope = self.own_law(at["eta"], at).gradient(self.p)[0]
            return evaluate(self.law, known | {"eta": eta}, self.p)[0] + cut(psi), slope

        return implicit(off, I.of(0, self.p), psi.degree)


class Manifold:
    """The unstable manifold of a saddle, for each lam of a box; or, with time reversed, the stable one.

    It is a graph y = w(x, lam), abs(x) <= reach, in the frame of a file, which moves with lam. The file has bounds of
    w, w_x, w_lam, w_xx/2 and w_x_lam. A round maps such graphs (0 is one) over abs(x) <= inner to such graphs, and
    contracts their distance. So one is mapped to itself, and a round expands along it: it is the manifold of a saddle
    on it.
    """

    def __init__(self, table, given, lam, back):
        p, self.lam, self.own, self.other = table.p, lam, int(back), int(not back)
        self.table = table = Back(table) if back else table
        point = lambda pair: I.of(exact(pair), p)
        names = ("bounces", "frame", "drift", "range", "bounds")
        saddle, (*self.zero, along, across), self.drift, (self.reach, inner), radii = (
            [point(x) for x in given[name]] for name in names
        )
        self.along, self.across, self.w = along, across, [I.of(0, p).wide(r) for r in radii]
        near = [(0, x.wide(I.of(Fraction(1, 1000), p))) for x in saddle]
        run = lambda x, d: table.orbit(self.launch, self.boxes(x, lam), near + near[:1], d, view=self.framed)
        *self.states, (x, y) = run(I.of(0, p).wide(inner), 2)
        (x1, y1), (x0, _) = map(self.on, (x, y)), run(I.of(0, p), 1)[-1]
        slope = y1.diff(self.own) * function("inverse", x1.diff(self.own), p)
        s, g, (*_, turn), shift = value(slope), x1.gradient(p)[self.own], slope.gradient(p), x1.gradient(p)[2]
        bend = slope.gradient(p)[self.own] / g
        new = [value(y1), s, y1.gradient(p)[2] - s * shift, bend / 2, turn - bend * shift]
        need(all(map(I.inside, new, self.w)), "remainder: the manifold is not enclosed")
        fy, gy = (f.gradient(p)[self.other].size() for f in (x, y))
        fits = (inner - self.reach).hi <= 0
        grows = fits and (value(x0).size() + self.reach) * (1 / g).size() - inner < 0 and (1 / g).size() < 1
        need(grows and gy + self.w[1].size() * fy < 1, "saddle: a round may not expand, or not bring graphs closer")

    boxes = lambda self, x, lam: [self.w[0], x, lam] if self.own else [x, self.w[0], lam]

    def launch(self, *letters):
        (x, y, lam), (theta, psi) = (letters[self.own], letters[self.other], letters[2]), self.centred(letters[2])
        names = {"lam": lam, "1/lam": function("inverse", lam, self.table.p)} if self.own else {"lam": lam}
        return y * self.across + x + theta, x * self.along + y + psi, self.table.letters | names

    def centred(self, lam):
        """The origin of the frame at `lam`: place and angle, which move linearly with `lam`."""
        return [(lam - self.lam.mid()) * move + zero for zero, move in zip(self.zero, self.drift)]

    def framed(self, theta, psi, lam):
        """The coordinates of a state in the frame."""
        (a, b), one = (x - zero for x, zero in zip((theta, psi), self.centred(lam))), 1 / (1 - self.along * self.across)
        return (a - b * self.across) * one, (b - a * self.along) * one

    def on(self, f):
        """A jet along the manifold, as one in x and lam, to second order."""
        (_, w_x, w_lam, bend, turn), letters = self.w, [Jet.of(0, 2, k) for k in (0, 1, 2)]
        x, lam = letters[self.own], letters[2]
        letters[self.other] = x * w_x + lam * w_lam + x * x * bend + x * lam * turn
        return composed(f, letters)


def touching(given, table, lam, title):
    """Proves exactly one contact of two manifolds with lam in a box and places near those of a file; returns its name.

    The arriving and the departing particle are at one place, at angles that obey the law, with parallel tangents. Where
    the derivative of these equations is regular, the contact is quadratic and passes with non-zero speed.
    """
    true = f"tangency of two manifolds: {title}"
    need(given["name"] == true, f"the name must be {true!a}", Wrong)
    whole = table.closed == [True] and not table.marks
    need(whole, "scene: a tangency is one of a single closed curve without marked points", Wrong)
    p, meets, places = table.p, given["meets"], map(exact, given["centre"][:2])
    box = [*(I.of(x, p).wide(I.of(x / 2**36, p)) for x in places), lam]
    sides = [Manifold(table, given[key], box[2], key == "stable") for key in ("unstable", "stable")]
    orbit = [(0, I.of(exact(pair), p).wide(I.of(Fraction(1, 10**5), p))) for pair in given["orbit"]]
    need(type(meets) is int and 0 < meets < len(orbit) - 1, "meets is out of range", Wrong)
    ways = orbit[: meets + 1], orbit[: meets - 1 : -1]
    need(all((x.size() - side.reach).hi <= 0 for side, x in zip(sides, box)), "exists: a start beyond the manifold")

    def runs(box, d):
        sought = zip(sides, box, ways)
        return [side.table.orbit(side.launch, side.boxes(x, box[2]), way, d) for side, x, way in sought]

    def equations(box, d):
        chains.append(runs(box, d + 2))
        (a, b), (u, v) = ([side.on(Jet(f.c[:10], 2)) for f in run[-1]] for side, run in zip(sides, chains[-1]))
        v = table.leaves(-v, table.letters | {"lam": Jet.of(box[2], 2, 2), "eta": v, "theta": u})
        return a - u, b - v, a.diff(0) * v.diff(1) - b.diff(0) * u.diff(1)

    chains = [[side.states for side in sides]]
    image = newton(equations, box, p)
    for chain in chains[0] + chains[1]:  # of the saddles, and of all starts in the box
        for here, there in zip(chain, chain[1:]):
            table.free([(0, value(here[0]))], [(0, value(there[0]))], table.letters)
    return image, true
