# # 1. The map and its derivative
#
# A ball leaves the wall at arc length $s$ with exit angle $\varphi$, flies straight, and lands with incidence angle
# $\eta$; it leaves again at $\varphi = -\lambda\eta$. This notebook derives the derivative of that map from nothing
# but the flight equation and Frenet's formulas, and holds it against the float64 kernels. Paper: section 2.

# +
from IPython.display import Math, display
from sympy import simplify, symbols

from symbolic.motion import collision
from symbolic.tables.formula import latex
from symbolic.tables.table import cos_eta1, cos_phi0, lam


def show(left, right):
    display(Math(f"{left} = {latex(right)}"))


# -

# ## From the flight equation
#
# With $\psi$ the direction of the tangent, a ball that leaves $q_0$ at $\varphi$ flies in the direction $\psi_0 +
# \pi/2 - \varphi$. That $q_1 - q_0$ is parallel to it is one equation, and differentiating it gives $\partial(s_1,
# -\eta_1)/\partial(s_0, \varphi_0)$. Only $X' = \cos\psi$, $Y' = \sin\psi$ and $\psi' = -\kappa$ are used.

show(r"\frac{\partial(s_1, -\eta_1)}{\partial(s_0, \varphi_0)}", collision.implicit_derivative())

# The reflection multiplies the second row by the slope of the law, here $\lambda$:

D = collision.derivative_matrix()
show("DT", D)

# This is eq. (derivative_of_map) of the paper, and its determinant is short:

show(r"\det DT", collision.determinant())

# It exceeds 1 at grazing landings, so the map does **not** contract every area element, as the abstract suggests; it
# contracts on average. In the Birkhoff coordinates $(s, \sin\varphi)$ the elastic map preserves area:

cos_phi1 = symbols("cos_phi1", positive=True)
birkhoff = collision.birkhoff_matrix(D.subs(lam, 1), cos_phi0, cos_eta1)
show(r"\det \frac{\partial(s_1, \sin\varphi_1)}{\partial(s_0, \sin\varphi_0)}", simplify(birkhoff.det()))

# ## The same matrix from the kernels
#
# `PinballMap` runs code that is generated from the same table. Its derivative must agree with the symbolic one at any
# phase point, up to rounding times the condition number.

# +
import numpy as np

from numeric import PinballMap

egg = PinballMap("egg", lam=0.7, alpha="2/25")
theta, phi = 0.4, 0.3
step = egg.step(theta, phi)
start = egg.orbit(theta, phi, 1)
length = float(np.hypot(step.x - start.x[0], step.y - start.y[0]))
K0, K1 = (float(egg.states.curvature(np.array([0]), np.array([at]))[0]) for at in (theta, float(step.theta)))
values = {"K0": K0, "K1": K1, "t": length, "cos_phi0": np.cos(phi), "cos_eta1": np.cos(float(step.eta)), "lam": 0.7}
symbolic = np.array(collision.derivative_matrix(**values).tolist(), dtype=float)
numeric = egg.derivative(theta, phi)
symbolic, numeric
# -

# ## An orbit
#
# Sixty bounces, in the table and in phase space:

# +
from IPython.display import Image

from verification.plots.results import drawn

flight = egg.orbit(theta, phi, 60)
places = {"x": flight.x, "y": flight.y, "s": egg.arclength.s(flight.theta, flight.component), "phi": flight.phi}
bounces = [{name: values[n] for name, values in places.items()} for n in range(61)]
Image(drawn("results.orbit", (egg, bounces), ".png"))
# -

# ## A check that can fail

assert simplify(D.det() - lam * cos_phi0 / cos_eta1) == 0
assert simplify(birkhoff.det()) == 1
assert np.allclose(symbolic, numeric, rtol=1e-12)
