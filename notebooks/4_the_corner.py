# # 4. The cuspless corner and lambda*
#
# The cuspless cardioid has two corners of curvature. At one contraction $\lambda^*$ an orbit of period 4 runs through
# both, and the chaotic attractor is born there. The paper finds $\lambda^* \simeq 0.0712173$, $\varphi^* \simeq
# -0.0289796$ by searching a plot (section 5.2); here both are certified, to as many digits as one likes.

# +
import numpy as np
from sympy import N, Rational, S, simplify

from numeric import PinballMap, Status, bifurcation_diagram
from symbolic import curvature, double_normals, lam, monodromy, thresholds
from verification import locate

# -

# ## The table
#
# An arc of the cardioid ends where its tangent is vertical, at $\theta = \pm 2\pi/3$, and a straight wall closes it.
# The tangent is continuous there; the curvature is not. On the arc and on the wall it is

curvatures = curvature("cuspless")
simplify(curvatures["arc"])

curvatures["wall"]

# ## The period-2 orbit and its doubling
#
# One chord is normal to the boundary at both ends. Its stability matrix, based at the arc:

(horizontal,) = double_normals("cuspless")
M = monodromy(horizontal)
M

# The multiplier $-1$ means $1 + \operatorname{tr} + \det = 0$, which happens at the contraction $\lambda_c$:

lambda_c = thresholds(horizontal)["flip"]
lambda_c

# The matrix that the paper prints at $(0, 0)$ belongs to the other end of the orbit, $(C, 0)$; the trace and the
# determinant, and so $\lambda_c$, are the same:

at_wall = monodromy(horizontal, base=1)
at_wall

# The doubling is **subcritical**: an unstable cycle of period 4 is born, which is why none was seen. The certificate
# does not use the formula above, and then agrees with it.

c = locate("lambda-c", 30)
c

c.notes["kind"]

# ## The corner orbit
#
# The orbit of period 4 leaves the upper corner at $\varphi^*$. The contraction and the angle solve one system of
# equations, which has one solution in a small box:

star = locate("lambda-star", 50)
star

angle = locate("phi-star", 50)
angle

# The seventh digits that the paper prints, 0.071217**3** and -0.028979**6**, are off by one or more:

print("printed 0.0712173, true", star.value[:12])
print("printed -0.0289796, true", angle.value[:13])

# ## The attractor and the orbit
#
# Where random balls are after a long time, against the contraction. The red lines are $\lambda^*$, where chaos begins,
# and $\lambda_c$, up to which the orbit of period 2 is stable too. Just above $\lambda^*$ few balls end in chaos.

diagram = bifurcation_diagram("cuspless", lam=("0.06", "0.1"), values=300, orbits=12, points=60, bounces=500).plot()
for value in (star.value, c.value):
    diagram.axes[0].axvline(float(value), color="red", linewidth=0.8)
diagram

# The corner orbit itself. It leaves a millionth of the angle beside the corner, since on the corner the next flight is
# not defined in float64:

upper, contraction, phi = 2 * np.pi / 3, float(star.value), float(angle.value)
cuspless = PinballMap("cuspless", lam=contraction)
beside = cuspless.orbit(upper, phi * (1 + 1e-6), 4)
beside.plot()

# ## A check that can fail
#
# In float64 the ball leaves the upper corner, meets the arc once and arrives at the lower corner within rounding.
# There the run stops and says why: on a join the curvature, and so the derivative, has two values.

# +
orbit = cuspless.orbit(upper, phi, 4)
assert all(found.certified for found in (star, angle, c))
assert list(orbit.status[:3]) == [Status.REGULAR, Status.REGULAR, Status.JOIN]
assert all(status is Status.REGULAR for status in beside.status)
assert np.hypot(beside.x[2] + 1 / 4, beside.y[2] + np.sqrt(3) / 4) < 1e-6
assert abs(N(lambda_c, 40) - S(c.value)) < S(10) ** -29
assert c.notes["kind"].startswith("subcritical")
assert simplify((1 + M.trace() + M.det()).subs(lam, lambda_c)) == 0
assert simplify(at_wall.trace() - M.trace()) == simplify(at_wall.det() - M.det()) == 0
assert S(star.value) < Rational(712173, 10**7) - Rational(5, 10**8)
assert S(angle.value) > -Rational(289796, 10**7) + Rational(5, 10**8)
