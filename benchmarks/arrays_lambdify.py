"""Baseline: NumPy over trajectories, with the functions that `sympy.lambdify(..., cse=True)` makes of the table.

It is what one writes first with SymPy: angles are the state, Newton's method solves the flight equation.
"""

from fractions import Fraction

import numpy as np
from sympy import cos, lambdify, sin, symbols

from symbolic import tables
from symbolic.tables.geometry import velocity
from symbolic.tables.table import theta as parameter


class Lambdified:
    """The map of a one-component table of radius about 1, by Newton on the flight equation over sin(B)."""

    def __init__(self, table, steps=8):
        component = table.components[0]
        x, y = component.point
        at, start, psi = symbols("at start psi", real=True)
        flight = cos(psi) * (y.subs(parameter, at) - y.subs(parameter, start)) - sin(psi) * (
            x.subs(parameter, at) - x.subs(parameter, start)
        )
        F = flight / sin((at - start) / 2)
        self.newton = lambdify((at, start, psi), [F, F.diff(at)], "numpy", cse=True)
        self.velocity = lambdify(parameter, list(velocity(component)), "numpy", cse=True)
        self.steps = steps

    def tangent_angle(self, theta):
        dx, dy = self.velocity(theta)
        return np.arctan2(dy, dx)

    def bounce(self, theta, phi, lam):
        psi = self.tangent_angle(theta) + np.pi / 2 - phi
        at = 2 * psi - np.pi - theta
        for _ in range(self.steps):
            value, slope = self.newton(at, theta, psi)
            at = at - value / slope
        tangent = self.tangent_angle(at)
        incidence = np.arctan2(np.cos(psi - tangent), -np.sin(psi - tangent))
        return np.remainder(at + np.pi, 2 * np.pi) - np.pi, lam * incidence


class LambdifiedEllipse:
    """The quadratic of the ellipse, with frames from lambdify."""

    def __init__(self, a):
        table = tables.ellipse.at(a=a)
        self.a = float(Fraction(a))
        self.point = lambdify(parameter, list(table.components[0].point), "numpy", cse=True)
        self.velocity = lambdify(parameter, list(velocity(table.components[0])), "numpy", cse=True)

    def bounce(self, theta, phi, lam):
        x, y = self.point(theta)
        dx, dy = self.velocity(theta)
        psi = np.arctan2(dy, dx) + np.pi / 2 - phi
        vx, vy = np.cos(psi), np.sin(psi)
        t = -2 * (x * vx / self.a**2 + y * vy) / (vx**2 / self.a**2 + vy**2)
        at = np.arctan2(y + t * vy, (x + t * vx) / self.a)
        dx, dy = self.velocity(at)
        return at, lam * np.arctan2(vx * dx + vy * dy, vx * dy - vy * dx)


class LambdifiedCardioid:
    """The cubic in `tan(theta1/2)`, solved in closed form by complex arithmetic; the nearest zero ahead."""

    def bounce(self, theta, phi, lam):
        psi = 1.5 * theta + np.pi - phi
        vx, vy = np.cos(psi), np.sin(psi)
        r = 1 + np.cos(theta)
        x, y = r * np.cos(theta), r * np.sin(theta)
        L, tau = vx * y - vy * x, np.tan(theta / 2)
        b, c = tau, (tau**2 + 2) - 2 * vy / L
        d = -(4 * vx + 2 * vy * tau) / L + tau * (tau**2 + 2)
        d0, d1 = b * b - 3 * c, 2 * b**3 - 9 * b * c + 27 * d
        C = ((d1 + np.sqrt((d1 * d1 - 4 * d0**3).astype(complex))) / 2) ** (1 / 3)
        best, found = np.full(theta.shape, np.inf), theta
        for k in range(3):
            w = C * np.exp(2j * np.pi * k / 3)
            root = -(b + w + d0 / w) / 3
            at = 2 * np.arctan(root.real)
            r1 = 1 + np.cos(at)
            t = (r1 * np.cos(at) - x) * vx + (r1 * np.sin(at) - y) * vy
            good = (abs(root.imag) < 1e-6) & (t > 1e-9) & (t < best)
            best, found = np.where(good, t, best), np.where(good, at, found)
        tangent = 1.5 * found + np.pi / 2
        return found, lam * np.arctan2(np.cos(psi - tangent), -np.sin(psi - tangent))


def baseline(name, shape):
    """The NumPy baseline of a table; None where there is none."""
    if name == "ellipse":
        return LambdifiedEllipse(shape["a"])
    if name == "cardioid":
        return LambdifiedCardioid()
    if name == "egg":
        return Lambdified(tables.egg(3).at(**shape))
    if name == "circle":
        return LambdifiedEllipse("1")
    return None
