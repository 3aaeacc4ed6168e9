"""User-defined reflection laws, for `check.py`: a law must map the half circle of angles into itself."""

from fractions import Fraction

from check import I, Jet, Unproved, Wrong, evaluate, need, pi, value
from curves import halves, piece_of, seen

BITS, LOOKS, POINTS = 96, 1000, 32  # of numbers; pieces of angles and places; angles to each side that are tried first
WHY = "law: it may lead out of the table, or have no value, at an angle of incidence up to pi/2"


def lawful(table, letters):
    """Proves `abs(phi) <= pi/2` for `abs(eta) <= pi/2`, for all places and letters, with phi finite and continuous.

    On each piece `abs(phi) < pi/2`; or phi is 0 at `eta = 0` with slopes up to 1, as for the elastic law.
    """
    places = [table.ends(part, BITS) for part in range(len(table.parts))]
    right = pi(BITS) / 2
    for k in range(-POINTS, POINTS + 1):  # a law that is none is seen at once
        at = exit_angle(table.law, letters, right * Fraction(k, POINTS), places[0][0])[0]
        need(at.lo <= right.hi and at.hi >= -right.hi, WHY, Wrong)
    try:
        everywhere(table.law, letters, places, inside)
    except Unproved:
        at_0 = [exit_angle(table.law, letters, 0, piece_of(ends, 0, 1, BITS))[0] for ends in places]
        need(all(x.lo == x.hi == 0 for x in at_0), WHY)
        everywhere(table.law, letters, places, flat)


def everywhere(law, letters, places, holds):
    """Proves a statement of the law for all angles and places, by bisection in both directions."""
    right, spent = pi(BITS) / 2, 0
    for ends in places:
        queue = [(Fraction(-1), Fraction(1), Fraction(0), Fraction(1))]
        while queue:
            a, b, c, d = queue.pop()
            spent += 1
            need(spent < LOOKS, WHY)
            eta, theta = right * I.of(a, BITS).hull(I.of(b, BITS)), piece_of(ends, c, d, BITS)
            if not seen(holds, law, letters, eta, theta):
                placed = exit_angle(law, letters, eta.mid(), theta.mid())[2] is not None
                sides = halves(c, d) if placed else [(c, d)]
                queue += [(*half, *side) for half in halves(a, b) for side in sides]


def exit_angle(law, letters, eta, theta):
    """The exit angle over angles and places, and its derivatives by both; by places only if the law has them."""
    at = [Jet.of(I.of(x, BITS), 1, k) for k, x in enumerate((eta, theta))]
    phi = evaluate(law, letters | {"eta": at[0], "theta": at[1]}, BITS)[0]
    if not isinstance(phi, Jet):
        return I.of(phi, BITS), I.of(0, BITS), None
    by_eta, by_theta, _ = phi.gradient(BITS)
    return I.of(value(phi), BITS), by_eta, None if by_theta.lo == by_theta.hi == 0 else by_theta


def inside(law, letters, eta, theta):
    whole, by_eta, by_theta = exit_angle(law, letters, eta, theta)
    near = exit_angle(law, letters, eta.mid(), theta.mid())[0].wide(by_eta * (eta - eta.mid()))
    near = near.wide((by_theta or I.of(0, BITS)) * (theta - theta.mid()))
    right = pi(BITS) / 2
    return any((x - right).hi < 0 < (x + right).lo for x in (whole, near))


def flat(law, letters, eta, theta):
    """True if the derivative of the exit angle by the incidence angle is proved to be at most 1."""
    slope = exit_angle(law, letters, eta, theta)[1]
    return slope.size().lo <= 1 << BITS
