# # 3. The cardioid and slap maps
#
# At $\lambda = 0$ a ball leaves along the normal and the map is one-dimensional: the *slap map* $T_0$. On the
# cardioid it is not expanding, but its second iterate is. The paper reads this off a plot (section 4.2); here it is
# proved.

# +
from IPython.display import Math, display
from sympy import N, Rational

from symbolic import geometry, length, slap_cardioid, tables
from symbolic.notation import latex


def show(left, right):
    display(Math(f"{left} = {latex(right)}"))


cardioid = tables.cardioid.components[0]
show("s", length.arc_length(cardioid))
show(r"\kappa", geometry.curvature(cardioid))
show(r"\mathrm{evolute}", geometry.evolute(cardioid))
# -

# The evolute is a mirror image of the cardioid, three times smaller: every slap trajectory is tangent to it.
#
# ## An algebraic slap map
#
# In a rational coordinate $q$ of the launching point both the landing point and the slope are algebraic, so that what
# the map expands can be decided by Sturm's theorem:

show(r"(T_0')^2", slap_cardioid.slope_squared())
low, high = slap_cardioid.slow_region()
print("T0' < 1 exactly for", N(low, 8), "< |s| <", N(high, 8))

# The infimum of $(T_0^2)'$ is an algebraic number:

infimum = slap_cardioid.expansion_infimum()
print("inf (T0^2)' =", N(infimum, 30))

# ## The proof

proof = slap_cardioid.expands_by(Rational(3, 2))
print(proof.outcome.value, "-", proof.reason[:200])

# ## A check that can fail
#
# Sampled slopes of $T_0^2$ stay above the proved infimum, and come near it; those of $T_0$ do not stay above 1.

# +
import numpy as np

from numeric import PinballMap

theta = np.linspace(-3.1, 3.1, 20000)  # not 0, whose normal runs into the cusp
slap = PinballMap("cardioid", lam=0)
once = slap.slap(theta, 1)
twice = once.slope * slap.slap(once.theta[1], 1).slope
assert proof
assert np.min(np.abs(once.slope)) < 1
assert np.min(twice) >= float(infimum) * (1 - 1e-12)
assert np.min(twice) < float(infimum) * (1 + 1e-3)
