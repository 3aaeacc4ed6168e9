"""Baseline: one ball at a time in numba, with angles, libm and Newton; what one writes in numba first."""

import math

from numba import njit

TAU = 2 * math.pi


@njit
def _wrapped(theta):
    return theta - TAU * math.floor((theta + math.pi) / TAU)


@njit
def _incidence(psi, tangent):
    """The incidence as an angle: both directions are known as angles already."""
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


@njit
def egg(theta, phi, lam, bounces, alpha):
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
        phi = lam * _incidence(psi, at + math.atan2(r, d))
        theta = _wrapped(at)
    return theta, phi


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
    """A table `r(theta)`: sixty steps along the ray's polar angle, the first change of sign, bisection and Newton."""

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
