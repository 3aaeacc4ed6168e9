# # 5. The egg: period 2, period 3, fold
#
# The three-pointed egg $\rho = 1 + \alpha\cos 3\theta$ is smooth, and still has chaotic attractors. This notebook
# derives where its period-2 orbits lose stability, and where its period-3 orbits are born. Paper: sections 6.3 and
# 6.4.

# +
from IPython.display import Math, display
from sympy import N, Rational, S

from symbolic.cycles import polygons, thresholds
from symbolic.cycles import thresholds as double_normal
from symbolic.cycles.cycle import egg_diameter
from symbolic.tables.formula import latex
from symbolic.tables.table import alpha, lam
from verification.named.locate import locate


def show(left, right):
    display(Math(f"{left} = {latex(right)}"))


# -

# ## Period 2

P = double_normal.stability_number(egg_diameter())
show("P", P)
show(r"\tilde\alpha(\lambda)", thresholds.alpha_tilde())

# The doubling happens where $P = -((1-\lambda)/(1+\lambda))^2$. At $\lambda = 0$ and 1:

for value in (0, 1):
    print(f"alpha-tilde({value}) =", N(thresholds.alpha_tilde().subs(lam, value), 15))

# ## Period 3: one bounce seen three times
#
# A triangle that turns by $2\pi/3$ at each bounce is *one* bounce, reduced by the symmetry. Its chords make the angle
# $\gamma = \pi/6$ with the radius, and the collision rule says how far the normal must be tilted from the radius:

show(r"\delta(\lambda)", polygons.required_tilt())

# The egg's normal tilts by at most

show(r"\tan\delta_{\max}", polygons.largest_tilt())

# so triangles exist from $\lambda_c(\alpha)$ on, in closed form. The paper has about 0.39 at $\alpha = 0.08$, from
# plots:

fold = polygons.saddle_node()
show(r"\lambda_c(\alpha)", fold)
print("lambda_c(0.08) =", N(fold.subs(alpha, Rational(2, 25)), 30))

# The same formula for any number of points and any polygon, for instance pentagons in the five-pointed egg:

show(r"\lambda_c^{K=5,\,1/5}(\alpha)", polygons.saddle_node(5, 1, 5))

# ## Certified twice
#
# `locate` finds the fold of the period-3 cycle on the chord system, without this formula, and proves it in balls.

found = locate("saddle-node", 40, alpha=Rational(2, 25))
print(found.value, "+-", found.radius)
for item, answer in found.checks.items():
    print(f"  {item:30} {answer}")

# The triangle at its birth, and the two branches that begin there:

# +
from IPython.display import Image

from verification.plots.results import drawn

Image(drawn("dynamics.situated", ([found],), ".png"))
# -

# ## A check that can fail

# +
import numpy as np

from numeric import PinballMap
from numeric.pinball.sampling import phase_starts

closed = N(fold.subs(alpha, Rational(2, 25)), 50)
assert found.certified
assert abs(closed - S(found.value)) < S(10) ** -39


def share_on_triangles(contraction):
    """The share of random particles that end on a cycle of period 3."""
    egg = PinballMap("egg", lam=contraction, alpha="0.08")
    starts = phase_starts(egg, 200, seed=1)
    settled = egg.orbit(starts.theta, starts.phi, 3000, starts.component)
    back = np.abs(settled.phi[-1] - settled.phi[-4]) + np.abs(np.sin((settled.theta[-1] - settled.theta[-4]) / 2))
    return np.mean((back < 1e-9) & (np.abs(settled.phi[-1]) > 0.1))


assert share_on_triangles(0.37) == 0
assert share_on_triangles(0.5) > 0.1
