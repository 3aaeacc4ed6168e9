# # 1. The map and its derivative
#
# A ball leaves the wall at arc length $s$ with exit angle $\varphi$, flies straight, and lands with incidence angle
# $\eta$; it leaves again at $\varphi = -\lambda\eta$. This notebook derives the derivative of that map from nothing
# but the flight equation and Frenet's formulas, and compares it with the float64 code that runs orbits. Paper:
# section 2.

# +
import numpy as np
from sympy import Matrix, cos, diag, diff, pi, simplify, sin, symbols, zeros

from numeric import PinballMap, phase_starts
from symbolic import derivative_matrix, generate, lam

X0, Y0, psi0, X1, Y1, psi1 = symbols("X0 Y0 psi0 X1 Y1 psi1", real=True)
K0, K1, phi0, eta1 = symbols("K0 K1 phi0 eta1", real=True)
t = symbols("t", positive=True)
# -

# ## The flight equation
#
# Let $\psi$ be the direction of the tangent. A ball that leaves $q_0 = (X_0, Y_0)$ at $\varphi_0$ flies in the
# direction $\omega = \psi_0 + \pi/2 - \varphi_0$. It lands at $q_1 = (X_1, Y_1)$, where $q_1 - q_0$ is parallel to that
# direction, so that the following expression vanishes:

omega = psi0 + pi / 2 - phi0
flight = (X1 - X0) * sin(omega) - (Y1 - Y0) * cos(omega)
flight

# The incidence angle is $\eta_1 = \psi_1 - \omega - \pi/2$. Both equations are differentiated along the boundary with
# Frenet's formulas $X' = \cos\psi$, $Y' = \sin\psi$, $\psi' = -K$, where $K$ is the signed curvature, negative where
# the boundary focuses. Nothing else is used of the boundary.


# +
def along_boundary(f, X, Y, psi, K):
    """The derivative of `f` by the arc length of one end of the flight."""
    return diff(f, X) * cos(psi) + diff(f, Y) * sin(psi) - diff(f, psi) * K


start, end = (X0, Y0, psi0, K0), (X1, Y1, psi1, K1)
minus_eta1 = omega - psi1 + pi / 2
# -

# Implicit differentiation of the flight equation gives $ds_1$, and then the chain rule gives $-d\eta_1$, both in terms
# of $ds_0$ and $d\varphi_0$:

flight_by = along_boundary(flight, *start), diff(flight, phi0)
s1_by = [-part / along_boundary(flight, *end) for part in flight_by]
minus_eta1_by = [
    along_boundary(minus_eta1, *start) + along_boundary(minus_eta1, *end) * s1_by[0],
    diff(minus_eta1, phi0) + along_boundary(minus_eta1, *end) * s1_by[1],
]

# A rotation of the plane changes none of this, so the flight may run along the first axis, over the length $t$. The
# matrix $\partial(s_1, -\eta_1)/\partial(s_0, \varphi_0)$ is then

first_axis = {X1: X0 + t, Y1: Y0, psi0: phi0 - pi / 2, psi1: eta1 + pi / 2}
J = Matrix([s1_by, minus_eta1_by]).subs(first_axis).applyfunc(simplify)
J

# ## The derivative of the map
#
# The reflection multiplies the second row by the slope of the law, here $\lambda$. The package holds the same matrix,
# eq. (derivative_of_map) of the paper:

D = derivative_matrix(K0=K0, K1=K1, t=t, cos_phi0=cos(phi0), cos_eta1=cos(eta1))
D

assert (diag(1, lam) * J - D).applyfunc(simplify) == zeros(2)

# Its determinant is short:

determinant = simplify(D.det())
determinant

# It exceeds 1 at grazing landings, so the map does **not** contract every area element, as the abstract suggests; it
# contracts on average.
#
# At $\lambda = 1$ the ball leaves with $\cos\varphi_1 = \cos\eta_1$. In the Birkhoff coordinates $(s, \sin\varphi)$ the
# elastic map preserves area, since the determinant of the following matrix is 1:

birkhoff = diag(1, cos(eta1)) * D.subs(lam, 1) * diag(1, 1 / cos(phi0))
birkhoff

birkhoff_determinant = simplify(birkhoff.det())
birkhoff_determinant

# ## The same matrix in float64
#
# `PinballMap` runs generated code. Its derivative must agree with the symbolic matrix at any phase point, up to
# rounding. For the egg with $\alpha = 2/25$ and $\lambda = 7/10$ the symbolic matrix is a function of both ends of the
# flight, $\theta_0$ and $\theta_1$:

egg = PinballMap("egg", lam="7/10", alpha="2/25")
along_chord = generate(derivative_matrix("egg", lam="7/10"), "numpy")
theta, phi = 0.4, 0.3
symbolic = np.array(along_chord(theta, egg.step(theta, phi).theta, 0.08), dtype=float)
symbolic

numeric = egg.derivative(theta, phi)
numeric

# ## An orbit
#
# Sixty bounces, in the table and in phase space:

egg.orbit(theta, phi, 60).plot()

# ## A check that can fail
#
# The two derivatives are compared once more at a hundred random phase points.

# +
starts = phase_starts(egg, 100, seed=1)
landings = egg.step(starts.theta, starts.phi).theta
pairs = [along_chord(*ends, 0.08) for ends in zip(starts.theta, landings, strict=True)]

assert simplify(determinant - lam * cos(phi0) / cos(eta1)) == 0
assert birkhoff_determinant == 1
assert np.allclose(symbolic, numeric, rtol=1e-12)
assert np.allclose(np.array(pairs, dtype=float), egg.derivative(starts.theta, starts.phi), rtol=1e-9)
