"""Baseline: the paper's own methods to follow a particle, as a reader of its appendix would write them, in floats.

Ellipse: the quadratic. Cardioid: the cubic of [BackerDullin1997]. Cuspless: the same, cut off at the wall. Egg:
Newton-Raphson along the ray. Each takes and returns `(component, theta, phi)`.
"""

import math

import numpy as np


def leave(tangent, phi):
    """The direction of the exit angle `phi` from a boundary with unit tangent `tangent`."""
    (tx, ty), c, s = tangent, math.cos(phi), math.sin(phi)
    return s * tx - c * ty, s * ty + c * tx


def reflect(tangent, v, lam):
    """The exit angle `-lam*eta`, from `acos(v.n)` and the sign of `v.t` as in the appendix."""
    tx, ty = tangent
    along, across = v[0] * ty - v[1] * tx, v[0] * tx + v[1] * ty
    return math.copysign(lam * math.acos(min(1.0, max(-1.0, along))), across)


def unit(x, y):
    size = math.hypot(x, y)
    return x / size, y / size


def circle(component, theta, phi, lam):
    return ellipse(component, theta, phi, lam, a=1.0)


def ellipse(component, theta, phi, lam, a):
    """The far zero of the quadratic of the ray in `(x/a)**2 + y**2 = 1`."""
    x, y = a * math.cos(theta), math.sin(theta)
    v = leave(unit(-a * math.sin(theta), math.cos(theta)), phi)
    t = -2 * (x * v[0] / a**2 + y * v[1]) / (v[0] ** 2 / a**2 + v[1] ** 2)
    x, y = x + t * v[0], y + t * v[1]
    theta = math.atan2(y, x / a)
    return 0, theta, reflect(unit(-a * math.sin(theta), math.cos(theta)), v, lam)


def cardioid_tangent(theta):
    return -math.sin(1.5 * theta), math.cos(1.5 * theta)


def cardioid(component, theta, phi, lam, reach=math.pi):
    """The nearest real zero ahead of the cubic in `tan(theta1/2)`, by `numpy.roots`."""
    v = leave(cardioid_tangent(theta), phi)
    r = 1 + math.cos(theta)
    x, y = r * math.cos(theta), r * math.sin(theta)
    L, tau = v[0] * y - v[1] * x, math.tan(theta / 2)
    cubic = [-L, -L * tau, 2 * v[1] - L * (tau**2 + 2), 4 * v[0] + 2 * v[1] * tau - L * tau * (tau**2 + 2)]
    best, found = math.inf, theta
    for root in np.roots(cubic):
        if abs(root.imag) < 1e-9:
            at = 2 * math.atan(root.real)
            r1 = 1 + math.cos(at)
            t = (r1 * math.cos(at) - x) * v[0] + (r1 * math.sin(at) - y) * v[1]
            if 1e-9 < t < best and abs(at) <= reach:
                best, found = t, at
    if best == math.inf:
        return None
    return 0, found, reflect(cardioid_tangent(found), v, lam)


def cuspless(component, theta, phi, lam):
    """From the arc the cardioid's cubic, cut off at the wall; from the wall bisection along the arc."""
    join = 2 * math.pi / 3
    if component == 0:
        landed = cardioid(0, theta, phi, lam, reach=join)
        if landed is not None:
            return landed
        v = leave(cardioid_tangent(theta), phi)
        r = 1 + math.cos(theta)
        x, y = r * math.cos(theta), r * math.sin(theta)
        height = y + (-0.25 - x) * v[1] / v[0]
        return 1, -height, reflect((0.0, -1.0), v, lam)
    v = leave((0.0, -1.0), phi)

    def side(at):
        r = 1 + math.cos(at)
        return v[0] * (r * math.sin(at) + theta) - v[1] * (r * math.cos(at) + 0.25)

    low, high = -join, join
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if side(middle) < 0 else (low, middle)
    return 0, middle, reflect(cardioid_tangent(middle), v, lam)


def egg(component, theta, phi, lam, alpha):
    """Newton-Raphson for the length of the flight, from its length in the unit circle."""
    rho = 1 + alpha * math.cos(3 * theta)
    slope = -3 * alpha * math.sin(3 * theta)

    def tangent(at):
        r, d = 1 + alpha * math.cos(3 * at), -3 * alpha * math.sin(3 * at)
        return unit(d * math.cos(at) - r * math.sin(at), d * math.sin(at) + r * math.cos(at))

    x, y = rho * math.cos(theta), rho * math.sin(theta)
    v = leave(
        unit(slope * math.cos(theta) - rho * math.sin(theta), slope * math.sin(theta) + rho * math.cos(theta)), phi
    )
    b = x * v[0] + y * v[1]
    t = -b + math.sqrt(max(0.0, b * b - x * x - y * y + 1))
    for _ in range(50):
        px, py = x + t * v[0], y + t * v[1]
        r, at = math.hypot(px, py), math.atan2(py, px)
        f = r - 1 - alpha * math.cos(3 * at)
        df = (px * v[0] + py * v[1]) / r + 3 * alpha * math.sin(3 * at) * (px * v[1] - py * v[0]) / (r * r)
        t -= f / df
        if abs(f / df) < 1e-15:
            break
    at = math.atan2(y + t * v[1], x + t * v[0])
    return 0, at, reflect(tangent(at), v, lam)
