# # 7. The crises
#
# At $\alpha = 0.08$ three chaotic attractors of the egg join near $\lambda = 0.4435$, and the one they make vanishes
# near 0.66 (paper: section 6.7, from plots). Both happen where an unstable and a stable manifold touch. This notebook
# computes the manifolds as power series, finds the tangencies, and compares them with sampled orbits.

# +
import numpy as np
from mpmath import nstr
from sympy import Rational

from verification.arithmetic.balls import FLOAT64
from verification.proofs.manifolds.known import TRIANGLE, contact, table
from verification.proofs.manifolds.saddle import local, saddle

SHAPE = Rational(2, 25)
# -

# ## A saddle and its manifolds
#
# The triangle of the vertices is born at the fold of period 3 together with the attracting triangle. It is a saddle,
# and its stable manifold bounds the basin of the attracting one. With $P(z)$ a power series and $\mu$ a multiplier, the
# manifold is the curve with $T(P(z)) = P(\mu z)$; that equation gives the coefficients order by order.

egg = table(SHAPE).over(FLOAT64)
triangle = saddle(TRIANGLE, egg, 0.6621442733)
unstable, stable = local(triangle, unstable=True), local(triangle, unstable=False)
print("multipliers", float(triangle.unstable), float(triangle.stable))
print("residuals of the series of order", unstable.order, ":", unstable.residual, stable.residual)

# ## Where they touch
#
# The boundary crisis: the unstable manifold of the triangle, which runs to the attractor, touches its stable one. Two
# methods that share nothing but the chord: a tangency of the two series, and the fold of a long cycle that shadows it.

# +
from verification.proofs.manifolds.known import crisis

boundary = crisis("boundary", SHAPE, 15)
merging = crisis("merging", SHAPE, 12)
for found in (merging, boundary):
    print(f"{found.kind:9} {nstr(found.parameter, 13)} +- {nstr(found.error, 2)}, methods apart {found.apart:.1e}")
# -

# The attractor with both manifolds, in a third of phase space, and the place where they touch:

# +
from IPython.display import Image

from verification.plots.results import drawn

Image(drawn("dynamics.portrait", ("boundary", SHAPE, 0.0, 0.2), ".png"))
# -

# ## What sampling sees
#
# Below the crisis no ball leaves the attractor; above it the mean stay falls like a power of the distance, and the
# power follows from the multipliers of the saddle [GrebogiOttRomeirasYorke1987].

print("predicted exponent of the stay:", boundary.exponent)

# +
from numeric import PinballMap


def still_chaotic(contraction, bounces=20000, balls=200):
    """The share of balls, started near the diameter, whose neighbourhoods still grow after a while."""
    rng = np.random.default_rng(1)
    ball = PinballMap("egg", lam=contraction, alpha="0.08").exponents(
        rng.uniform(-0.05, 0.05, balls), rng.uniform(-0.05, 0.05, balls), 500, bounces
    )
    return float(np.mean(ball.nu_plus > 0))


shares = {contraction: still_chaotic(contraction) for contraction in (0.655, 0.662, 0.67, 0.68, 0.70)}
shares
# -

# ## A check that can fail

assert unstable.residual < 1e-12
assert stable.residual < 1e-12
assert boundary.agrees
assert merging.agrees
assert abs(float(boundary.parameter) - 0.66) < 0.005
assert contact("boundary", SHAPE).parameter < 0.67
assert shares[0.655] == 1
assert shares[0.70] < 0.5
