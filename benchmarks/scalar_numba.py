"""Baseline: one particle at a time in numba, with angles, libm and Newton's method, as one would first write it."""

import math

import numpy as np
from numba import njit
from sympy import pi

from symbolic.tables.table import theta as letter

TAU = 2 * math.pi


@njit
def _wrapped(theta):
    return theta - TAU * math.floor((theta + math.pi) / TAU)


@njit
def _incidence(psi, tangent):
    """The angle of incidence, from both directions, which are known as angles."""
    return _wrapped(psi - tangent + math.pi / 2)


@njit
def circle(theta, phi, lam, bounces, a):
    for _ in range(bounces):
        theta, phi = _wrapped(theta + math.pi - 2 * phi), lam * phi
    return theta, phi


@njit
def ellipse(theta, phi, lam, bounces, a):
    for _ in range(bounces):
        x, y = a * math.cos(theta), math.sin(theta)
        psi = math.atan2(math.cos(theta), -a * math.sin(theta)) + math.pi / 2 - phi
        vx, vy = math.cos(psi), math.sin(psi)
        t = -2 * (x * vx / (a * a) + y * vy) / (vx * vx / (a * a) + vy * vy)
        theta = math.atan2(y + t * vy, (x + t * vx) / a)
        phi = lam * _incidence(psi, math.atan2(math.cos(theta), -a * math.sin(theta)))
    return theta, phi


def _egg(law):
    """The next bounce on the egg, with a law that gives the exit angle."""

    @njit
    def bounce(theta, phi, lam, bounces, alpha):
        for _ in range(bounces):
            r, d = 1 + alpha * math.cos(3 * theta), -3 * alpha * math.sin(3 * theta)
            x, y = r * math.cos(theta), r * math.sin(theta)
            psi = theta + math.atan2(r, d) + math.pi / 2 - phi
            vx, vy = math.cos(psi), math.sin(psi)
            at = 2 * psi - math.pi - theta
            for _ in range(30):
                c, s, c3, s3 = math.cos(at), math.sin(at), math.cos(3 * at), math.sin(3 * at)
                r = 1 + alpha * c3
                dr = -3 * alpha * s3
                f = vx * (r * s - y) - vy * (r * c - x)
                df = vx * (dr * s + r * c) - vy * (dr * c - r * s)
                half = 0.5 * (at - theta)
                sh, ch = math.sin(half), math.cos(half)
                step = f / (df - 0.5 * f * ch / sh)
                at -= step
                if abs(step) < 1e-14:
                    break
            r, d = 1 + alpha * math.cos(3 * at), -3 * alpha * math.sin(3 * at)
            phi = law(lam, _incidence(psi, at + math.atan2(r, d)))
            theta = _wrapped(at)
        return theta, phi

    return bounce


@njit
def _uniform(lam, eta):
    return lam * eta


@njit
def _polynomial(lam, eta):
    return lam * eta * (1 - eta * eta / 8)


@njit
def _sine(lam, eta):
    return lam * eta + math.sin(2 * eta) / 50


egg, egg_polynomial, egg_sine = map(_egg, (_uniform, _polynomial, _sine))


@njit
def _arc(theta, phi, reach):
    """The first landing on the cardioid's arc within `reach`, or the start when there is none."""
    psi = 1.5 * theta + math.pi - phi
    vx, vy = math.cos(psi), math.sin(psi)
    p, q = math.cos(theta / 2), math.sin(theta / 2)
    k = math.sin(theta / 2 - phi)
    c3, c2 = k, k * q
    c1 = k * (1 + p * p) - vy
    c0 = q * c1 - 2 * p * vx
    best, found = 1e300, 1e300
    x, y = 2 * p * p * math.cos(theta), 2 * p * p * math.sin(theta)
    # a real zero by Newton from outside, then the other two from the quadratic
    S = -math.copysign(1 + max(abs(c2), abs(c1), abs(c0)) / max(abs(c3), 1e-300), c3 * 1.0)
    for _ in range(200):
        f, df = ((c3 * S + c2) * S + c1) * S + c0, (3 * c3 * S + 2 * c2) * S + c1
        step = f / df
        S -= step
        if abs(step) <= 1e-15 * abs(S):
            break
    b, c = c2 + c3 * S, 0.0
    c = c1 + b * S
    disc = b * b - 4 * c3 * c
    for i in range(3):
        if i == 0:
            root = S
        elif disc < 0:
            continue
        else:
            w = -0.5 * (b + math.copysign(math.sqrt(disc), b))
            root = w / c3 if i == 1 else c / w
        at = 2 * math.atan2(root, p)
        r = 1 + math.cos(at)
        t = (r * math.cos(at) - x) * vx + (r * math.sin(at) - y) * vy
        if 1e-9 < t < best and abs(at) <= reach:
            best, found = t, at
    return found, psi


@njit
def cardioid(theta, phi, lam, bounces, a):
    for _ in range(bounces):
        at, psi = _arc(theta, phi, math.pi)
        theta, phi = at, lam * _incidence(psi, 1.5 * at + math.pi / 2)
    return theta, phi


@njit
def cuspless(theta, phi, lam, bounces, a):
    wall = False
    join = TAU / 3
    for _ in range(bounces):
        if not wall:
            at, psi = _arc(theta, phi, join)
            if at < 1e299:
                theta, phi = at, lam * _incidence(psi, 1.5 * at + math.pi / 2)
            else:
                r = 1 + math.cos(theta)
                x, y = r * math.cos(theta), r * math.sin(theta)
                theta = -(y + (-0.25 - x) * math.tan(psi))
                phi, wall = lam * _incidence(psi, -math.pi / 2), True
        else:
            psi = -phi
            vx, vy = math.cos(psi), math.sin(psi)
            at = psi
            low, high = -join, join
            for _ in range(60):
                r, c, s = 1 + math.cos(at), math.cos(at), math.sin(at)
                f = vx * (r * s + theta) - vy * (r * c + 0.25)
                df = vx * (-s * s + r * c) + vy * (s * c + r * s)
                if f < 0:
                    low = at
                else:
                    high = at
                new = at - f / df
                if not low < new < high:
                    new = 0.5 * (low + high)
                if abs(new - at) < 1e-15:
                    at = new
                    break
                at = new
            theta, phi, wall = at, lam * _incidence(psi, 1.5 * at + math.pi / 2), False
    return theta, phi


def _polar(radius):
    """The next bounce on a table `r(theta)`: first change of sign in sixty steps, bisection and Newton."""

    @njit
    def bounce(theta, phi, lam, bounces, a):
        for _ in range(bounces):
            r, d = radius(theta)
            x, y = r * math.cos(theta), r * math.sin(theta)
            psi = theta + math.atan2(r, d) + math.pi / 2 - phi
            vx, vy = math.cos(psi), math.sin(psi)
            sweep = _wrapped(psi - theta)
            side = 1.0 if sweep > 0 else -1.0
            low, high = theta, psi
            for i in range(1, 61):
                high = theta + sweep * i / 60
                r, d = radius(high)
                if side * (vx * (r * math.sin(high) - y) - vy * (r * math.cos(high) - x)) > 0:
                    break
                low = high
            at = 0.5 * (low + high)
            for _ in range(60):
                r, d = radius(at)
                c, s = math.cos(at), math.sin(at)
                f = side * (vx * (r * s - y) - vy * (r * c - x))
                df = vx * (d * s + r * c) - vy * (d * c - r * s)
                if f > 0:
                    high = at
                else:
                    low = at
                new = at - side * f / df
                if not min(low, high) < new < max(low, high):
                    new = 0.5 * (low + high)
                step, at = new - at, new
                if abs(step) < 1e-15:
                    break
            r, d = radius(at)
            phi = lam * _incidence(psi, at + math.atan2(r, d))
            theta = _wrapped(at)
        return theta, phi

    return bounce


@njit
def _limacon(theta):
    return 1 + 0.6 * math.cos(theta), -0.6 * math.sin(theta)


@njit
def _star(theta):
    return 1 + 0.25 * math.cos(5 * theta), -1.25 * math.sin(5 * theta)


@njit
def _peanut(theta):
    r = math.exp(0.25 * math.cos(2 * theta))
    return r, -0.5 * math.sin(2 * theta) * r


@njit
def _conic(theta):
    r = 1 / (2 + 0.5 * math.cos(theta))
    return r, 0.5 * math.sin(theta) * r * r


@njit
def _waves(theta):
    return 1 + math.cos(40 * theta) / 2000, -math.sin(40 * theta) / 50


limacon, star, peanut, conic, waves = map(_polar, (_limacon, _star, _peanut, _conic, _waves))


@njit
def every(step, theta, phi, lam, bounces, a):
    for i in range(theta.size):
        theta[i], phi[i] = step(theta[i], phi[i], lam, bounces, a)


def numbers(table):
    """A table of pieces with one row for each: kind, ends, and four numbers of `x` and of `y`.

    Sides and cubics are polynomials, of kinds 0 and 2; an arc of a circle, of kind 1, is `(x0 + x1*cos(theta), y0 +
    y1*sin(theta))`.
    """
    rows = []
    for part in table.components:
        if all(f.is_polynomial(letter) for f in part.point):
            x, y = ([float(f.expand().coeff(letter, k)) for k in range(4)] for f in part.point)
            kind = 2 if any((*x[2:], *y[2:])) else 0
        else:
            (right, _), (left, _), (_, top), (_, low) = (map(float, part.at(a * pi / 2)) for a in (0, 2, 1, 3))
            x, y = [(right + left) / 2, (right - left) / 2, 0, 0], [(top + low) / 2, (top - low) / 2, 0, 0]
            kind = 1
        rows.append([kind, float(part.start), float(part.end), *x, *y])
    return np.array(rows)


@njit
def _side(row, x, y, vx, vy):
    """The parameter and the length of the flight to a side; the length is infinite where it is missed."""
    across = vx * row[8] - vy * row[4]
    if across == 0:
        return 0.0, math.inf
    ex, ey = row[3] - x, row[7] - y
    at, t = (vy * ex - vx * ey) / across, (ex * row[8] - ey * row[4]) / across
    if row[1] <= at <= row[2] and t > 0:
        return at, t
    return 0.0, math.inf


@njit
def _circle(row, x, y, vx, vy, leaves):
    """The same for an arc of a circle: the nearer of the two intersections, among those on the arc."""
    ex, ey = x - row[3], y - row[7]
    half = ex * vx + ey * vy
    inside = half * half - (ex * ex + ey * ey - row[4] * row[4])
    if leaves:
        root = abs(half)
    elif inside >= 0:
        root = math.sqrt(inside)
    else:
        return 0.0, math.inf
    for t in (-half - root, -half + root):
        if t > 1e-12:
            at = math.atan2((ey + t * vy) / row[8], (ex + t * vx) / row[4])
            if row[1] <= at <= row[2]:
                return at, t
    return 0.0, math.inf


@njit
def _cubic(row, x, y, vx, vy, leaves, theta):
    """The same for a cubic: split where its distance from the line is extremal; bisection and Newton in each part."""
    c0, c1 = vx * (row[7] - y) - vy * (row[3] - x), vx * row[8] - vy * row[4]
    c2, c3 = vx * row[9] - vy * row[5], vx * row[10] - vy * row[6]
    if leaves:  # the zero that is known is divided out
        c0, c1, c2, c3 = c1 + theta * (c2 + theta * c3), c2 + theta * c3, c3, 0.0
    first = second = row[2]
    turns = c2 * c2 - 3 * c1 * c3
    if turns >= 0:
        w = -(c2 + math.copysign(math.sqrt(turns), c2))
        one = w / (3 * c3) if c3 != 0 else math.inf
        two = c1 / w if w != 0 else math.inf
        first = min(max(min(one, two), row[1]), row[2])
        second = min(max(max(one, two), row[1]), row[2])
    found, best = 0.0, math.inf
    for i in range(3):
        low, high = row[1] if i == 0 else first if i == 1 else second, first if i == 0 else second if i == 1 else row[2]
        rising = 1.0 if ((c3 * high + c2) * high + c1) * high + c0 > 0 else -1.0
        if low >= high or rising * (((c3 * low + c2) * low + c1) * low + c0) > 0:
            continue
        at = 0.5 * (low + high)
        for _ in range(60):
            f, slope = ((c3 * at + c2) * at + c1) * at + c0, (3 * c3 * at + 2 * c2) * at + c1
            if rising * f > 0:
                high = at
            else:
                low = at
            new = at - f / slope if slope != 0 else 0.5 * (low + high)
            if not low < new < high:
                new = 0.5 * (low + high)
            step, at = new - at, new
            if abs(step) < 1e-15:
                break
        X = ((row[6] * at + row[5]) * at + row[4]) * at + row[3]
        Y = ((row[10] * at + row[9]) * at + row[8]) * at + row[7]
        t = (X - x) * vx + (Y - y) * vy
        if 1e-12 < t < best:
            found, best = at, t
    return found, best


@njit
def _frame(row, theta):
    """A point of a piece, and the angle of its tangent."""
    if row[0] == 1:
        c, s = math.cos(theta), math.sin(theta)
        return row[3] + row[4] * c, row[7] + row[8] * s, math.atan2(row[8] * c, -row[4] * s)
    x = ((row[6] * theta + row[5]) * theta + row[4]) * theta + row[3]
    y = ((row[10] * theta + row[9]) * theta + row[8]) * theta + row[7]
    dx = (3 * row[6] * theta + 2 * row[5]) * theta + row[4]
    dy = (3 * row[10] * theta + 2 * row[9]) * theta + row[8]
    return x, y, math.atan2(dy, dx)


@njit
def every_on_pieces(rows, component, theta, phi, lam, bounces):
    """Particles on a table of pieces: each flight tries all pieces and keeps the nearest hit."""
    for i in range(theta.size):
        k, at, out = component[i], theta[i], phi[i]
        for _ in range(bounces):
            x, y, tangent = _frame(rows[k], at)
            psi = tangent + math.pi / 2 - out
            vx, vy = math.cos(psi), math.sin(psi)
            best, nearest, where = math.inf, k, at
            for j in range(len(rows)):
                row = rows[j]
                if row[0] == 1:
                    u, t = _circle(row, x, y, vx, vy, j == k)
                elif row[0] == 2:
                    u, t = _cubic(row, x, y, vx, vy, j == k, at)
                elif j != k:
                    u, t = _side(row, x, y, vx, vy)
                else:
                    continue
                if t < best:
                    best, nearest, where = t, j, u
            k, at = nearest, where
            out = lam * _incidence(psi, _frame(rows[k], at)[2])
        component[i], theta[i], phi[i] = k, at, out
