# # 2. The ellipse
#
# An ellipse has two orbits of period 2, along its axes. Their stability matrices follow from the curvature, and every
# formula of section 3.3 follows from one number. Paper: section 3.

# +
from IPython.display import Math, display
from sympy import Rational, factor, simplify, sqrt

from symbolic import tables
from symbolic.cycles import cycle as cycles
from symbolic.cycles import thresholds
from symbolic.cycles import thresholds as double_normal
from symbolic.cycles.cycle import major_axis, minor_axis
from symbolic.tables import geometry
from symbolic.tables.formula import latex
from symbolic.tables.table import a, lam


def show(left, right):
    display(Math(f"{left} = {latex(right)}"))


# -

# ## Curvature and stability matrix

show(r"\kappa", geometry.curvature(tables.ellipse.components[0]))
M = cycles.monodromy(minor_axis())
show("D T^2", M)

# ## One number decides
#
# For *any* cycle of period 2, in any table, the monodromy has determinant $\lambda^2$ and trace $(1+\lambda)^2 P -
# 2\lambda$ with $P = (1 + tK_0)(1 + tK_1)$.

P = double_normal.stability_number(minor_axis())
show("P", P)
show(r"\operatorname{tr}", double_normal.trace_of(P))
assert simplify(double_normal.trace_of(P) - M.trace()) == 0
assert simplify(M.det() - lam**2) == 0

# The multipliers are real or complex according to the sign of $\operatorname{tr}^2 - 4\det$; the paper's $P_2$ is
# that number up to a positive factor:

show(r"\operatorname{tr}^2 - 4\det", cycles.discriminant(M.trace(), M.det()))

# so they turn complex at $\lambda_-(a)$, in closed form:

lambda_minus = thresholds.lambda_minus()
show(r"\lambda_-(a)", simplify(lambda_minus))
show(r"\lambda_-(5)", lambda_minus.subs(a, 5))

# At $a = \sqrt 2$ the minor axis has $P = 0$: both multipliers are $-\lambda$, real and equal. The paper's "for any
# $a \geq 1$ there is a number $\lambda_a$" therefore needs care at this shape and at the circle.

show(r"P(\sqrt 2)", P.subs(a, sqrt(2)))

# ## The major axis is a saddle

show("P", double_normal.stability_number(major_axis()))

# The two of them at $a = 3/2$, found by a search that knows nothing of axes:

# +
from IPython.display import Image

from symbolic import Scene
from verification.cycles.search import all_cycles
from verification.plots.results import drawn

scene = Scene("ellipse", a="3/2", lam="9/10")
found = all_cycles(scene.table, scene.lam, 2)
Image(drawn("results.cycles", (scene, found.catalogue), ".png"))
# -

# ## A check that can fail
#
# An orbit that starts next to the major axis is carried away from it and ends on the minor axis.

# +
from numeric import PinballMap

end = PinballMap("ellipse", lam=0.9, a="3/2").orbit(1e-9, 0.0, 2000)
assert abs(end.x[-1]) < 1e-9
assert abs(abs(end.y[-1]) - 1) < 1e-9

printed = (a**4 + 4 * a**2 - 4 - 4 * a**2 * sqrt(a**2 - 1)) / (a**2 - 2) ** 2
assert simplify((lambda_minus - printed).subs(a, 5)) == 0
assert factor(P.subs(a, sqrt(2))) == 0
assert lambda_minus.subs(a, 5) < Rational(45, 100)
