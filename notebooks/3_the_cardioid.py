# # 3. The cardioid and slap maps
#
# At $\lambda = 0$ a ball leaves along the normal and the map is one-dimensional: the *slap map* $T_0$. On the
# cardioid it is not expanding, but its second iterate is. The paper reads this off a plot (section 4.2); here it is
# proved.

# +
from IPython.display import Math, display
from sympy import N, Rational

from symbolic import tables
from symbolic.cycles import cardioid_slap as slap_cardioid
from symbolic.tables import geometry
from symbolic.tables import geometry as length
from symbolic.tables.formula import latex


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
#
# $|(T_0^2)'| = 3/2$ has no solution; and on the branch where the least value lies there is one critical point, on the
# other $(T_0^2)'$ stays above $1.51$:

proof = slap_cardioid.expands_by(Rational(3, 2))
least = slap_cardioid.infimum_attained()
print(proof.outcome.value, "-", proof.reason)
print(least.outcome.value, "-", least.reason)

# The slap map with its second iterate, and the slope of the first:

# +
import numpy as np
from IPython.display import Image

from numeric import PinballMap
from verification.plots.results import drawn

slap = PinballMap("cardioid", lam=0)
launch = np.linspace(-3.1, 3.1, 2000)
Image(drawn("results.slap", (slap, np.zeros(2000, dtype=int), launch, slap.slap(launch, 2)), ".png"))
# -

# ## A check that can fail
#
# Sampled slopes of $T_0^2$ stay above the proved infimum, and come near it; those of $T_0$ do not stay above 1.

theta = np.linspace(-3.1, 3.1, 20000)  # not 0, whose normal runs into the cusp
once = slap.slap(theta, 1)
twice = once.slope * slap.slap(once.theta[1], 1).slope
assert proof
assert least
assert np.min(np.abs(once.slope)) < 1
assert np.min(twice) >= float(infimum) * (1 - 1e-12)
assert np.min(twice) < float(infimum) * (1 + 1e-3)

# ## Every contraction below 1
#
# A cone of beams that every bounce maps into itself and widens makes every orbit off the cusp stretch exponentially:
# with $g = 1 + \tan^2((1 - \lambda)\pi/8)/2$,
#
# $$|D(T^n)\,(1, 0)| \geq \tfrac14 \sin^4((1 - \lambda)\pi/4)\; g^{\,n - 2} \qquad (n \geq 2,\ \lambda < 1).$$
#
# For almost every start the smaller singular value shrinks, at the rate $\log g$ at least. Not shown for
# $0 < \lambda < 1$: that the exponents exist as limits, that $\nu_- < 0$ for every invariant measure, a natural
# measure, transitivity.

# +
from symbolic.cycles import defocusing
from symbolic.tables.table import lam

show(r"\liminf \tfrac1n \log|D(T^n)(1, 0)| \geq", defocusing.least_exponent())
bound = [float(defocusing.least_stretch(n).subs(lam, Rational(1, 2))) for n in range(2, 30)]

half = PinballMap("cardioid", lam="1/2")
start = np.linspace(-3, 3, 501), np.linspace(-1.5, 1.4, 501)
orbit = half.orbit(*start, 30)
vector = np.stack([np.ones(501), np.zeros(501)])
stretch = []
for n in range(1, 30):
    vector = np.einsum("...ij,j...->i...", half.derivative(orbit.theta[n - 1], orbit.phi[n - 1]), vector)
    stretch.append(np.min(np.abs(vector[0])))
assert defocusing.expands()
assert np.all(np.array(stretch[1:]) >= bound)
print("least stretch of 501 orbits after 29 bounces:", stretch[-1], "; proved:", bound[-1])
