"""Baselines of `pinball work`: methods that readers of the paper would write first, in plain SciPy and NumPy.

They use brentq, numpy.roots, lambdify, differences and single shooting, one function for each method. `map` is a
compiled map with `step` and `orbit`, so that the method is compared and not the step.
"""

import math
from functools import partial

import mpmath
import numpy as np
from scipy.integrate import cumulative_trapezoid, quad
from scipy.optimize import brentq, minimize_scalar
from sympy import lambdify

# ---- one bounce


def cardioid_by_roots(theta, phi, lam):
    """One bounce on the cardioid: the cubic of [BackerDullin1997] in `tan(theta1/2)`, solved by `numpy.roots`."""
    direction = 1.5 * theta + math.pi - phi
    vx, vy = math.cos(direction), math.sin(direction)
    r = 1 + math.cos(theta)
    x, y = r * math.cos(theta), r * math.sin(theta)
    L, tau = vx * y - vy * x, math.tan(theta / 2)
    cubic = [-L, -L * tau, 2 * vy - L * (tau**2 + 2), 4 * vx + 2 * vy * tau - L * tau * (tau**2 + 2)]
    best, found = math.inf, theta
    for root in np.roots(cubic):
        if abs(root.imag) < 1e-9:
            at = 2 * math.atan(root.real)
            r1 = 1 + math.cos(at)
            t = (r1 * math.cos(at) - x) * vx + (r1 * math.sin(at) - y) * vy
            if 1e-9 < t < best:
                best, found = t, at
    return found, -lam * math.remainder(1.5 * found - direction, 2 * math.pi)


def egg_on_the_ray(theta, phi, lam, alpha):
    """One bounce on the egg: Newton-Raphson for the length of the flight, from its length in the unit circle."""

    def tangent(at):
        r, d = 1 + alpha * math.cos(3 * at), -3 * alpha * math.sin(3 * at)
        return math.atan2(d * math.sin(at) + r * math.cos(at), d * math.cos(at) - r * math.sin(at))

    r = 1 + alpha * math.cos(3 * theta)
    x, y = r * math.cos(theta), r * math.sin(theta)
    direction = tangent(theta) + math.pi / 2 - phi
    vx, vy = math.cos(direction), math.sin(direction)
    b = x * vx + y * vy
    t = -b + math.sqrt(max(0.0, b * b - x * x - y * y + 1))
    for _ in range(50):
        px, py = x + t * vx, y + t * vy
        r, at = math.hypot(px, py), math.atan2(py, px)
        slope = (px * vx + py * vy) / r + 3 * alpha * math.sin(3 * at) * (px * vy - py * vx) / (r * r)
        step = (r - 1 - alpha * math.cos(3 * at)) / slope
        t -= step
        if abs(step) < 1e-15:
            break
    at = math.atan2(y + t * vy, x + t * vx)
    return at, -lam * math.remainder(tangent(at) - direction - math.pi / 2, 2 * math.pi)


# ---- its derivative


def moved(step, speed, particle, ds, dphi):
    """Arc length (to first order about the landing) and exit angle after a step from a neighbouring point."""
    zero = np.zeros(1, dtype=int)
    theta = particle[0] + ds / float(speed(zero, np.array([particle[0]]))[0])
    landed = step(theta, particle[1] + dphi)
    return float(landed.theta), float(landed.phi)


def differences(step, speed, particle, one, other):
    """The derivative matrix from differences of neighbours, each given as a factor of `(ds, dphi)`."""
    columns = []
    here = step(*particle)
    rate = float(speed(np.zeros(1, dtype=int), np.array([float(here.theta)]))[0])
    for ds, dphi in ((1, 0), (0, 1)):
        a, b = (moved(step, speed, particle, h * ds, h * dphi) for h in (one, other))
        columns.append([math.remainder(a[0] - b[0], 2 * math.pi) * rate / (one - other), (a[1] - b[1]) / (one - other)])
    (ss, ps), (sp, pp) = columns
    return ss, sp, ps, pp


class Lambdified:
    """One step with `sympy.lambdify` of the chord's angle and of the matrix, and `brentq` for the landing."""

    def __init__(self, ends, angle, entries):
        self.angle = lambdify(ends, angle, "math", cse=True)
        self.entries = lambdify(ends, entries, "math", cse=True)

    def __call__(self, theta, phi):
        near = 1e-3
        landing = brentq(lambda at: self.angle(theta, at) - phi, theta + near, theta + 2 * math.pi - near, xtol=4e-15)
        return self.entries(theta, landing)


# ---- cycles


def iterated(map, theta, phi, bounces):
    """The end of an orbit."""
    orbit = map.orbit(theta, phi, bounces)
    return float(orbit.theta[-1]), float(orbit.phi[-1])


def shooting(map, start, period, xtol, h=1e-7, most=25):
    """Single shooting: Newton's method on `T^n(x) - x` with its Jacobian by forward differences."""
    x = np.array(start, dtype=float)

    def gap(at):
        theta, phi = iterated(map, *at, period)
        return np.array([math.remainder(theta - at[0], 2 * math.pi), phi - at[1]])

    for _ in range(most):
        value = gap(x)
        slope = np.stack([(gap(x + e) - value) / h for e in h * np.eye(2)], -1)
        move = np.linalg.solve(slope, value)
        x = x - move
        if not np.all(np.isfinite(x)) or abs(x[1]) >= math.pi / 2:
            break
        if np.max(np.abs(move)) < xtol:
            return x
    raise ValueError(f"single shooting did not come to rest within {xtol:g}")


# ---- bifurcations


def largest_multiplier(map, x, period, h=1e-6):
    """The multiplier of largest modulus, from central differences of the iterated map."""
    columns = []
    for e in h * np.eye(2):
        a, b = iterated(map, *(x + e), period), iterated(map, *(x - e), period)
        columns.append([math.remainder(a[0] - b[0], 2 * math.pi) / (2 * h), (a[1] - b[1]) / (2 * h)])
    values = np.linalg.eigvals(np.array(columns).T)
    return values[np.argmax(np.abs(values))]


def flip(map_at, start, period, low, high, xtol):
    """The contraction at which the multiplier of a followed cycle is -1: `brentq`, with shooting inside."""

    def over(lam):
        map = map_at(lam)
        x = shooting(map, start, period, 1e-9)
        return (1 + largest_multiplier(map, x, period)).real

    return brentq(over, low, high, xtol=xtol)


def period_of(map, start, bounces, longest, same=1e-6):
    """The period of the cycle on which a particle is after so many bounces."""
    theta, phi = iterated(map, *start, bounces)
    orbit = map.orbit(theta, phi, longest)
    for period in range(1, longest + 1):
        if math.hypot(math.remainder(float(orbit.theta[period]) - theta, 2 * math.pi), orbit.phi[period] - phi) < same:
            return period
    return longest + 1


def doubling_seen(map_at, start, period, low, high, bounces):
    """The contraction at which a particle's period first exceeds `period`, by bisection, as read off a diagram."""
    while high - low > 1e-12:
        middle = (low + high) / 2
        if period_of(map_at(middle), start, bounces, 2 * period) > period:
            high = middle
        else:
            low = middle
    return (low + high) / 2


def fold_seen(map_at, start, period, low, high, xtol):
    """The contraction below which shooting no longer finds the cycle, by bisection on success."""
    x = np.array(start, dtype=float)
    while high - low > xtol:
        middle = (low + high) / 2
        try:
            found = shooting(map_at(middle), x, period, 1e-9)
        except (ValueError, np.linalg.LinAlgError):
            low = middle
            continue
        if abs(math.remainder(found[0] - x[0], 2 * math.pi)) > 0.3:
            low = middle
        else:
            high, x = middle, found
    return (low + high) / 2


def corner_angle(m, here, there):
    """The angle on the cardioid's arc from the inward normal at `here` to the chord to `there`, in `math` or mpmath."""
    (x0, y0), (x1, y1) = (((1 + m.cos(a)) * m.cos(a), (1 + m.cos(a)) * m.sin(a)) for a in (here, there))
    turned = 3 * here / 2 + m.pi - m.atan2(y1 - y0, x1 - x0)
    return turned - 2 * m.pi * m.floor(turned / (2 * m.pi) + 0.5)


def corner_by_brentq(xtol):
    """The value `lambda*`: a particle from the corner is followed for two bounces on the cardioid's arc."""
    join, angle = 2 * math.pi / 3, partial(corner_angle, math)

    def landing(lam):
        return brentq(lambda at: angle(join, at) + lam * angle(join, -at), 0.01, 1.0, xtol=xtol)

    def missed(lam):
        at = landing(lam)
        return angle(at, -join) + lam * angle(at, join)

    return brentq(missed, 0.02, 0.2, xtol=xtol)


def corner_by_findroot(digits):
    """The same two equations by `mpmath.findroot`, whose Jacobian is made of differences."""
    context = mpmath.MPContext()
    context.dps = digits + 5
    join, angle = 2 * context.pi / 3, partial(corner_angle, context)

    def equations(at, lam):
        return angle(join, at) + lam * angle(join, -at), angle(at, -join) + lam * angle(at, join)

    return context.findroot(
        equations, (context.mpf("0.254"), context.mpf("0.071")), tol=context.mpf(10) ** (-2 * digits)
    )[1]


# ---- exponents


def two_particles(step, particle, bounces, apart=1e-8):
    """The largest exponent, by a neighbour rescaled after each bounce [BenettinGalganiStrelcyn1976]."""
    theta, phi = particle
    near_theta, near_phi, total = theta + apart, phi, 0.0
    for _ in range(bounces):
        a, b = step(theta, phi), step(near_theta, near_phi)
        theta, phi = float(a.theta), float(a.phi)
        along, across = math.remainder(float(b.theta) - theta, 2 * math.pi), float(b.phi) - phi
        size = math.hypot(along, across)
        total += math.log(size / apart)
        near_theta, near_phi = theta + along * apart / size, phi + across * apart / size
    return total / bounces


def by_qr(step, derivative, particle, bounces):
    """Both exponents from QR decompositions of the derivative matrices, one bounce at a time."""
    theta, phi = particle
    Q, sums = np.eye(2), np.zeros(2)
    for _ in range(bounces):
        Q, R = np.linalg.qr(derivative(theta, phi) @ Q)
        with np.errstate(divide="ignore"):  # at lam = 0 the other exponent is minus infinity
            sums += np.log(np.abs(np.diag(R)))
        landed = step(theta, phi)
        theta, phi = float(landed.theta), float(landed.phi)
    return float(np.max(sums)) / bounces


# ---- arc length


def length_by_quad(speed, theta, epsabs):
    """The length of the boundary by `scipy.integrate.quad` of the speed."""
    return quad(speed, 0.0, theta, epsabs=epsabs, epsrel=epsabs, limit=200)[0]


def length_by_sums(speed, theta, points):
    """Arc length by cumulative trapezoids on a grid over the whole boundary, and interpolation."""
    grid = np.linspace(-math.pi, math.pi, points)
    sums = cumulative_trapezoid(speed(grid), grid, initial=0.0)
    return float(np.interp(theta, grid, sums) - np.interp(0.0, grid, sums))


def parameter_by_brentq(speed, s, xtol):
    """The parameter at arc length `s`, by `brentq` over `quad`."""
    return brentq(lambda at: quad(speed, 0.0, at, epsabs=1e-13, epsrel=1e-13)[0] - s, -math.pi, math.pi, xtol=xtol)


def parameter_by_sums(speed, s, points):
    """The same by interpolation in cumulative trapezoids."""
    grid = np.linspace(-math.pi, math.pi, points)
    sums = cumulative_trapezoid(speed(grid), grid, initial=0.0)
    return float(np.interp(s + np.interp(0.0, grid, sums), sums, grid))


# ---- the slap map's expansion


def expansion_on_grid(slap, points):
    """The least `|(T_0^2)'|` over a grid of launching points."""
    with np.errstate(all="ignore"):
        theta = np.linspace(1e-3, 2.2, points)
        there = slap(theta)
        return float(np.min(np.abs(there.slope * slap(there.theta[1]).slope)))


def expansion_by_search(slap, xtol):
    """The same by `scipy.optimize.minimize_scalar` on the bracket that a plot shows."""

    def expansion(theta):
        there = slap(np.array([theta]))
        return abs(float((there.slope * slap(there.theta[1]).slope)[0]))

    return float(minimize_scalar(expansion, bracket=(1.4, 1.53, 1.65), method="brent", options={"xtol": xtol}).fun)
