# # 8. A table of your own, from formula to certificate
#
# One formula is enough: curvature, thresholds, orbits, exponents and certificates follow from it. The table here is
# the five-pointed flower $\rho = 1 + \cos(5\theta)/40$.

# +
from IPython.display import Math, display
from sympy import S, pi

from numeric import PinballMap
from symbolic import tables
from symbolic.cycles import thresholds as double_normal
from symbolic.cycles.cycle import Cycle
from symbolic.motion.chords import convexity
from symbolic.tables import geometry
from symbolic.tables.formula import latex
from symbolic.tables.table import theta


def show(left, right):
    display(Math(f"{left} = {latex(right)}"))


# -

flower = tables.polar("1 + cos(5*theta)/40", "flower")
show(r"\kappa(0)", geometry.curvature(flower.components[0]).subs(theta, 0))
print("convex:", convexity(flower).outcome.value)

# ## Period 2, in closed form
#
# Each point of the flower faces a flat part, so there is a cycle of period 2 along that diameter.

diameter = Cycle("diameter", flower, ((0, S.Zero), (0, pi)))
P = double_normal.stability_number(diameter)
show("P", P)
threshold = double_normal.flip_contraction(P)
show(r"\lambda_{\rm flip}", threshold)
print(float(threshold))

# ## An orbit, and both exponents
map = PinballMap(flower, lam="1/2")
orbit = map.orbit(0.3, 0.2, 5)
print(map.path)
print(orbit.theta)

found = map.exponents(0.3, 0.2, bounces=20000, transient=1000)
print(float(found.nu_plus), float(found.nu_minus))

# Where 500 random particles end:

# +
from IPython.display import Image

from numeric.dynamics.attractors import find
from verification.plots.results import drawn

Image(drawn("results.attractors", (map, find(map, 500, 1)), ".png"))
# -

# ## A certified doubling
#
# The same threshold on the chord system, in balls, with the whole checklist.

# +
from verification.arithmetic.balls import decimal
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.named.locate import proof_near

problem = Problem(flower, (0, 0), BifurcationKind.FLIP, free="lam")
proof = proof_near(problem, [0.0, 3.141592653589793, float(threshold)], 30)
print(decimal(proof.value, 30)[0])
for item, answer in proof.checks.items():
    print(f"  {item:30} {answer}")

# ## A check that can fail

# +
from verification.arithmetic.balls import real_ball

assert proof.proved
assert proof.value.overlaps(real_ball(threshold, 40))
