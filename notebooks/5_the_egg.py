# # 5. The egg: period 2, period 3, fold
#
# The three-pointed egg $\rho = 1 + \alpha\cos 3\theta$ is smooth, and still has chaotic attractors. This notebook
# derives where its period-2 orbits lose stability, and where its period-3 orbits are born. Paper: sections 6.3 and
# 6.4.

# +
import numpy as np
from sympy import Eq, N, Rational, S, acos, atan, cos, diff, factor, pi, simplify, solve, sqrt, symbols

from numeric import PinballMap, phase_starts
from symbolic import alpha, double_normals, lam, monodromy, theta, thresholds
from verification import certify, find_cycles, follow, locate

# -

# ## Period 2
#
# Each vertex faces a flat point, and the chord between them is normal at both ends. Its stability matrix has
# determinant $\lambda^2$ and trace $(1 + \lambda)^2P - 2\lambda$ with a number $P$ that does not depend on $\lambda$:

(diameter,) = double_normals("egg")
M = monodromy(diameter)
P = factor((M.trace() + 2 * lam) / (1 + lam) ** 2)
P

# The multiplier is $-1$ where $1 + \operatorname{tr} + \det = 0$, which is $P = -((1-\lambda)/(1+\lambda))^2$. Now
# $1 - P$ is the square of

W = 18 * alpha / (1 - alpha**2)
W

# so that $W^2 = 2(1 + \lambda^2)/(1 + \lambda)^2$ at the doubling, and a quadratic equation gives the shape
# $\tilde\alpha(\lambda)$:

root, small = symbols("W alpha", positive=True)
(shape,) = solve(Eq(root * (1 - small**2), 18 * small), small)
alpha_tilde = shape.subs(root, sqrt(2 * (1 + lam**2)) / (1 + lam))
alpha_tilde

# At $\lambda = 0$ and 1:

for value in (0, 1):
    print(f"alpha-tilde({value}) =", N(alpha_tilde.subs(lam, value), 15))

# A search for the doubling at $\lambda = 1/2$, with a proof in balls, finds the same shape:

doubling = locate("alpha-tilde", 30, lam="1/2")
doubling

# ## Period 3: one bounce seen three times
#
# A triangle that turns by $2\pi/3$ at each bounce is *one* bounce, reduced by the symmetry. Its chords make the angle
# $\gamma = \pi/6$ with the radius. If the normal is tilted from the radius by $\delta$, the ball leaves at $\gamma -
# \delta$ and lands at $\gamma + \delta$, up to a common sign. The law $\gamma - \delta = \lambda(\gamma + \delta)$ says
# how far the normal must be tilted:

gamma, delta = symbols("gamma delta")
(required,) = solve(Eq(gamma - delta, lam * (gamma + delta)), delta)
required

# The normal of a polar curve tilts by $\tan\delta = -\rho'/\rho$. On the egg that is

rho = 1 + alpha * cos(3 * theta)
tilt = -diff(rho, theta) / rho
tilt

# It is largest where $\cos 3\theta = -\alpha$, since its derivative is

slope = factor(simplify(diff(tilt, theta) * rho**2)) / rho**2
slope

largest_tilt = simplify(tilt.subs(theta, acos(-alpha) / 3))
largest_tilt

# So triangles exist from $\lambda_c(\alpha)$ on, where the tilt that they need is the largest one:


# +
def polygon_fold(K, p, q):
    """The least contraction of polygons that turn by `2*pi*p/q` at each bounce of the `K`-pointed egg."""
    half_angle = pi / 2 - pi * Rational(p, q)
    most = atan(K * alpha / sqrt(1 - alpha**2))
    return (half_angle - most) / (half_angle + most)


fold = polygon_fold(3, 1, 3)
fold
# -

# The paper has about 0.39 at $\alpha = 0.08$, from plots:

N(fold.subs(alpha, Rational(2, 25)), 30)

# The same formula holds for any number of points and any polygon, for instance pentagons in the five-pointed egg:

pentagons = polygon_fold(5, 1, 5)
pentagons

# ## Certified twice
#
# `locate` finds the fold of the period-3 cycle from the equations of its chords, without this formula, and proves it in
# balls.

found = locate("saddle-node", 40, alpha="2/25")
found

# A second way knows nothing of triangles. A search finds the cycles at $\lambda = 1/2$:

triangles = find_cycles("egg", alpha="2/25", lam="1/2", period=3)
triangles

# A stable one, in the table and in phase space:

stable = triangles.stable[0]
PinballMap("egg", alpha="2/25", lam="1/2").orbit(stable.theta[0], stable.phi[0], 3).plot()

# It is followed down to the fold, where it meets an unstable one (dashed):

branch = follow(stable, lam=("37/100", "1"))
branch.plot()

followed = certify(branch.folds[0], digits=30)
followed

# ## A check that can fail
#
# Below the fold no random ball ends on a cycle of period 3, and above it many do.


# +
def share_on_triangles(contraction):
    """The share of random balls that end on a cycle of period 3."""
    egg = PinballMap("egg", lam=contraction, alpha="2/25")
    starts = phase_starts(egg, 200, seed=1)
    end = egg.orbit(starts.theta, starts.phi, 3000, starts.component)
    back = np.abs(end.phi[-1] - end.phi[-4]) + np.abs(np.sin((end.theta[-1] - end.theta[-4]) / 2))
    return np.mean((back < 1e-9) & (np.abs(end.phi[-1]) > 0.1))


assert simplify(1 - P - W**2) == 0
assert simplify((1 + M.trace() + M.det()).subs(alpha, alpha_tilde).subs(lam, Rational(1, 3))) == 0
assert simplify(M.det() - lam**2) == 0
assert abs(N(alpha_tilde.subs(lam, Rational(1, 2)), 40) - S(doubling.value)) < S(10) ** -29
assert abs(thresholds(diameter)["flip"].subs(alpha, alpha_tilde.subs(lam, Rational(1, 2))).evalf() - 0.5) < 1e-12
assert simplify(slope - 9 * alpha * (alpha + cos(3 * theta)) / rho**2) == 0
assert simplify(required - gamma * (1 - lam) / (1 + lam)) == 0
assert simplify(largest_tilt - 3 * alpha / sqrt(1 - alpha**2)) == 0

closed = N(fold.subs(alpha, Rational(2, 25)), 50)
assert found.certified
assert followed.certified
assert doubling.certified
assert abs(closed - S(found.value)) < S(10) ** -39
assert abs(closed - S(followed.value)) < S(10) ** -29
assert share_on_triangles(0.37) == 0
assert share_on_triangles(0.5) > 0.1
