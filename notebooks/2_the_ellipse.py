# # 2. The ellipse
#
# An ellipse has two orbits of period 2, along its axes. Their stability matrices follow from the curvature, and every
# formula of section 3.3 follows from one number. Paper: section 3.

# +
from sympy import Rational, factor, pi, simplify, sqrt

from numeric import PinballMap
from symbolic import a, curvature, double_normals, lam, monodromy, theta, thresholds
from verification import find_cycles

# -

# ## Curvature and stability matrix

kappa = curvature("ellipse")
kappa

# The two cycles are found as chords that are normal to the boundary at both ends. The stability matrix of the one along
# the minor axis:

major, minor = double_normals("ellipse")
M = monodromy(minor)
M

# ## One number decides
#
# For *any* cycle of period 2, in any table, the monodromy has determinant $\lambda^2$ and trace $(1+\lambda)^2 P -
# 2\lambda$ with $P = (1 + tK_0)(1 + tK_1)$, where $t$ is the length of the flight and $K_0$, $K_1$ are the curvatures
# at its ends. The minor axis has $t = 2$:

P = (1 + 2 * simplify(kappa.subs(theta, pi / 2))) ** 2
P

# +
assert simplify((1 + lam) ** 2 * P - 2 * lam - M.trace()) == 0
assert simplify(M.det() - lam**2) == 0
# -

# The multipliers are real or complex according to the sign of $\operatorname{tr}^2 - 4\det$; the paper's $P_2$ is
# that number up to a positive factor:

factor(M.trace() ** 2 - 4 * M.det())

# so they turn complex at $\lambda_-(a)$, in closed form:

lambda_minus = thresholds(minor)["focus"]
lambda_minus

# For example $\lambda_-(5)$:

lambda_minus.subs(a, 5)

# At $a = \sqrt 2$ the minor axis has $P = 0$: both multipliers are $-\lambda$, real and equal. The paper's "for any
# $a \geq 1$ there is a number $\lambda_a$" therefore needs care at this shape and at the circle.

P.subs(a, sqrt(2))

# ## The major axis is a saddle
#
# It has $t = 2a$, so that $P$ is greater than 1 for $a > 1$: it neither doubles nor turns into a focus.

P_major = factor((1 + 2 * a * simplify(kappa.subs(theta, 0))) ** 2)
P_major

thresholds(major)

# The two of them at $a = 3/2$, found by a search that knows nothing of axes:

find_cycles("ellipse", a="3/2", lam="9/10", period=2)

# ## A check that can fail
#
# An orbit that starts next to the major axis is carried away from it and ends on the minor axis.

orbit = PinballMap("ellipse", lam=0.9, a="3/2").orbit(1e-9, 0.0, 2000)
orbit.plot()

# +
assert abs(orbit.x[-1]) < 1e-9
assert abs(abs(orbit.y[-1]) - 1) < 1e-9

printed = (a**4 + 4 * a**2 - 4 - 4 * a**2 * sqrt(a**2 - 1)) / (a**2 - 2) ** 2
assert simplify((lambda_minus - printed).subs(a, 5)) == 0
assert simplify((1 + lam) ** 2 * P_major - 2 * lam - monodromy(major).trace()) == 0
assert lambda_minus.subs(a, 5) < Rational(45, 100)
