# # 8. A table of your own, from formula to certificate
#
# One formula is enough: curvature, thresholds, orbits, exponents and certificates follow from it. The table here is
# the five-pointed flower $\rho = 1 + \cos(5\theta)/40$.

# +
from sympy import N, Rational

from numeric import PinballMap, attractors
from symbolic import Scene, curvature, double_normals, monodromy, tables, theta, thresholds
from verification import certify, find_cycles, follow

# -

# The curvature at a tip:

flower = tables.polar("1 + cos(5*theta)/40", "flower")
curvature(flower).subs(theta, 0)

# ## Period 2, in closed form
#
# Each point of the flower faces a flat part, so there is a cycle of period 2 along that diameter, one up to rotations.

(diameter,) = double_normals(flower)
monodromy(diameter)

# It doubles its period at the contraction

threshold = thresholds(diameter)["flip"]
threshold

# or, in decimals,

float(threshold)

# ## An orbit, and both exponents
map = PinballMap(flower, lam="1/2")
orbit = map.orbit(0.3, 0.2, 5)
print(map.path)
print(orbit.theta)

found = map.exponents(0.3, 0.2, bounces=20000, transient=1000)
print(float(found.nu_plus), float(found.nu_minus))

# Where 500 random particles end:

attractors(flower, lam="1/2", orbits=500, seed=1).plot()

# ## A certified doubling
#
# The cycle is found at one contraction and followed to its doubling. This is proved in balls, with the whole checklist.

cycle = find_cycles(Scene(flower, lam="1/10"), period=2).stable[0]
branch = follow(cycle, lam=("1/10", "1/5"))
proof = certify(branch.flips[0], digits=30)
print(proof)
for item, answer in proof.checks.items():
    print(f"  {item:30} {answer}")

# ## A check that can fail

assert all(proof.checks.values())
assert abs(N(threshold, 50) - Rational(proof.value)) < Rational(proof.radius)
