"""The hypotheses of a corner orbit beyond those of a cycle, for `check.py`: see docs/certificate_format.md."""

from check import need, value


def cornered(cycle, image, theta1):
    """Proves the further hypotheses of a corner orbit; the lower corner is the wall's end and the arc's start."""
    table, p, slopes, unstable = cycle.table, cycle.p, [], False
    edge, wall = table.ends(0, p)[1], table.ends(1, p)[1]
    need(theta1 > 0 and theta1 < 2, "minimal_period: a bounce may be at a corner or on the axis")
    table.free([(0, edge), (1, -wall)], [(0, theta1)], {})  # the mirror does the other two
    table.free([(0, theta1)], [(0, -edge), (1, wall)], {})
    for side, at in ((0, -edge), (1, wall)):
        way = [(0, edge), (0, theta1), (side, at), (0, -theta1), (0, edge)]
        states = table.orbit(lambda x, psi, lam: (x * 0 + edge, psi, {"lam": lam}), image, way, 1)
        (_, motion, shift), (_, rise, growth) = (states[k][0].gradient(p) for k in (2, 4))
        slopes.append((motion, rise, growth - rise * shift / motion))
        start = [*map(value, states[1]), image[2]]
        _, (theta, _), last = table.orbit(lambda x, psi, lam: (x, psi, {"lam": lam}), start, way[1:4], 1)
        (a, b, _), (c, d, _) = ((-x).gradient(p) for x in last)
        (e, f, _), trace, det = theta.gradient(p), a + d, a * d - b * c
        off = 0 not in e * (e * b + f * d) - f * (e * a + f * c)  # no eigenvector runs along the corner's preimage
        unstable = unstable or (det > 0 and trace - det > 1 and off)
    (motion, arc, _), (_, straight, fall) = slopes
    kink = (motion > 0 and straight < 0 and arc > 0) or (motion < 0 and arc < 0 and straight > 0)
    for item, holds in (("s4_minimum_at_a_kink", kink), ("s4_dips_below", fall < 0), ("unstable", unstable)):
        need(holds, f"{item}: this sign is not proved")


def called(free, theta1):
    """The name of a value of the corner orbit, from the place of the bounce between the corners."""
    true = {"lam": "lambda-star", "phi": "phi-star"}[free]
    return true if abs(theta1.real() - 0.2545) < 0.001 else "an orbit through both corners"
