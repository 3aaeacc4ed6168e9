# # 6. The cascade and delta
#
# At $\alpha = 0.08$ the stable period-4 orbit of the egg doubles again and again. The paper gives $\lambda_3$ to
# $\lambda_6$ from plots (section 6.6); here each is certified, and the end of the cascade is extrapolated with an
# error estimate.

# +
from itertools import pairwise

from mpmath import nstr
from sympy import Rational

from verification.named.curves import accumulation
from verification.named.locate import locate

SHAPE = Rational(2, 25)
# -

# ## Certified doublings
#
# `doubling` with $n$ is the change from period $2^{n-1}$ to $2^n$. Each carries the whole checklist of a period
# doubling: a cycle in the box, unique, admissible, of minimal period, one simple multiplier $-1$, crossed with
# non-zero speed, and a normal-form coefficient of known sign.

doublings = {n: locate("doubling", 20, alpha=SHAPE, n=Rational(n)) for n in (3, 4, 5, 6)}
printed = {3: "0.372", 4: "0.389", 5: "0.393", 6: "0.3935"}
for n, each in doublings.items():
    print(n, each.value, "certified" if each.certified else "not certified", "| printed", printed[n])

# $\lambda_3$ is 0.371 to three digits, not 0.372, and $\lambda_6$ is 0.3933, not 0.3935.
#
# Where random particles are after a long time, as a density, with the certified values as lines:

# +
import numpy as np
from IPython.display import Image

from numeric.sweeps.fields import bifurcation
from numeric.sweeps.run import run
from numeric.sweeps.sweep import text_of
from symbolic import Scene
from verification.plots.results import Marked, drawn

sweep = bifurcation(text_of(Scene("egg", alpha=SHAPE)), np.linspace(0.35, 0.4, 400), 20, 100, 2000, 4000, 1)
lines = [Marked(float(each.value), f"doubling {n}") for n, each in doublings.items()]
Image(drawn("grids.bifurcation", (run(sweep), lines), ".png"))
# -

# ## The end of the cascade
#
# Two extrapolations that share nothing but the doublings (iterated Aitken and Wynn's epsilon) give $\lambda_\infty$ and
# Feigenbaum's $\delta$; their difference is the error estimate. These two are *estimated*, not certified.

end = accumulation(SHAPE, 8)
print("lambda_oo =", nstr(end.limit.value, 12), "+-", nstr(end.limit.error, 2))
print("delta     =", nstr(end.ratio.value, 8), "+-", nstr(end.ratio.error, 2))

# Work grows linearly with the period, because the chord system is cyclic and tridiagonal and is never written as a
# dense matrix; the cascade goes on to period $2^{15}$.

# ## A check that can fail
#
# The first ratios of the gaps approach $\delta = 4.669201609\ldots$ [Feigenbaum1979].

values = [float(doublings[n].value) for n in (3, 4, 5, 6)]
gaps = [b - a for a, b in pairwise(values)]
ratios = [a / b for a, b in pairwise(gaps)]
print(ratios)
assert all(each.certified for each in doublings.values())
assert abs(ratios[-1] - 4.669201609) < 0.15
assert abs(end.ratio.value - 4.669201609) < 3 * end.ratio.error < 1e-2
