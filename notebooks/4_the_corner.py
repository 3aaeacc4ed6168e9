# # 4. The cuspless corner and lambda*
#
# The cuspless cardioid has two corners of curvature. At one contraction $\lambda^*$ an orbit of period 4 runs through
# both, and the chaotic attractor is born there. The paper finds $\lambda^* \simeq 0.0712173$, $\varphi^* \simeq
# -0.0289796$ by searching a plot (section 5.2); here both are certified, to as many digits as one likes.

# +
from IPython.display import Math, display

from symbolic.cycles import cycle as cycles
from symbolic.cycles import thresholds
from symbolic.cycles.cycle import cuspless_horizontal
from symbolic.tables.formula import latex
from verification.named.locate import locate


def show(left, right):
    display(Math(f"{left} = {latex(right)}"))


# -

# ## The period-2 orbit and its doubling

M = cycles.monodromy(cuspless_horizontal())
show("D T^2", M)
show(r"\lambda_c", thresholds.lambda_c())

# The matrix that the paper prints at $(0, 0)$ belongs to the other end of the orbit, $(C, 0)$; the trace and the
# determinant, and so $\lambda_c$, are the same. The doubling is **subcritical**: an unstable cycle of period 4 is
# born, which is why none was seen.

c = locate("lambda-c", 30)
print(c.value, "certified" if c.certified else "not certified")
for item, answer in c.checks.items():
    print(f"  {item:30} {answer}")

# ## The corner orbit

star, angle = locate("lambda-star", 50), locate("phi-star", 50)
print("lambda* =", star.value)
print("phi*    =", angle.value)
for item, answer in star.checks.items():
    print(f"  {item:30} {answer}")

# The seventh digits that the paper prints, 0.071217**3** and -0.028979**6**, are off by one or more:

print("printed 0.0712173, true", star.value[:12])
print("printed -0.0289796, true", angle.value[:13])

# An orbit that leaves the upper corner as the angle varies: where its fourth bounce lies, and the angle proved

# +
from IPython.display import Image

from verification.plots.results import drawn

Image(drawn("dynamics.situated", ([star],), ".png"))
# -

# ## A check that can fail
#
# In float64 the ball leaves the upper corner, meets the arc once and arrives at the lower corner within rounding.
# There the kernel stops and says why: on a join the curvature, and so the derivative, has two values.

# +
import numpy as np

from numeric import PinballMap, Status

lam, phi = float(star.value), float(angle.value)
orbit = PinballMap("cuspless", lam=lam).orbit(2 * np.pi / 3, phi, 4)
assert all(found.certified for found in (star, angle, c))
assert list(orbit.status[:3]) == [Status.REGULAR, Status.REGULAR, Status.JOIN]
before = PinballMap("cuspless", lam=lam).orbit(2 * np.pi / 3, phi * (1 + 1e-6), 4)
assert all(status is Status.REGULAR for status in before.status)
assert np.hypot(before.x[2] + 1 / 4, before.y[2] + np.sqrt(3) / 4) < 1e-6
