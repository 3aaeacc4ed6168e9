# # 7. The crises
#
# At $\alpha = 0.08$ three chaotic attractors of the egg join near $\lambda = 0.4435$, and the one they make vanishes
# near 0.66 (paper: section 6.7, from plots). Both happen where an unstable and a stable manifold touch. This notebook
# computes the manifolds as power series, finds the tangencies, and compares them with sampled orbits.

# +
import numpy as np
from sympy import Matrix, Rational, atan, diff, lambdify, symbols

from numeric import PinballMap, attractors
from symbolic import alpha, lam, tables, theta, theta0, theta1
from verification import find_cycles, locate

# -

# ## Where they touch
#
# The boundary crisis: the unstable manifold of a triangle, which runs to the attractor, touches its stable one. The
# contraction is computed by two methods that share nothing but the equation of a chord: as a tangency of the two
# manifolds, and as the fold of a long cycle that shadows it. The tangency is proved; that the attractor ends there is
# not, and the checklist says so.

boundary = locate("boundary-crisis", 15, alpha="2/25")
boundary

boundary.notes["mechanism"]

boundary.notes["second_method"]

# The merging crisis, in the same way:

merging = locate("merging-crisis", 12, alpha="2/25")
merging

merging.notes["mechanism"]

# ## The saddle
#
# The triangle of the vertices is born at the fold of period 3 together with the attracting triangle. It is a saddle,
# and its stable manifold bounds the basin of the attracting one. At the boundary crisis the search finds both
# triangles, each with its mirror image:

crisis = float(boundary.value)
triangles = find_cycles("egg", alpha="2/25", lam=boundary.value, period=3)
triangles

# ## Its manifolds as power series
#
# At a bounce let $v$ be the tangent and $n$ the inward normal. A chord $c$ that starts there makes the angle
# $\arctan(c\cdot v/c\cdot n)$ with the normal: the exit angle $\varphi$ for the chord to the next bounce, and the
# incidence angle $\eta$ for the chord back to the one before. So $F = \varphi + \lambda\eta$ vanishes for three
# successive bounces of an orbit:

# +
theta2 = symbols("theta2", real=True)
point = Matrix(tables.egg(3).components[0].point).subs(alpha, Rational(2, 25))
before, here, after = (point.subs(theta, angle) for angle in (theta0, theta1, theta2))
tangent = point.diff(theta).subs(theta, theta1)
normal = Matrix([-tangent[1], tangent[0]])


def from_normal(chord):
    """The angle of a chord with the normal, towards the tangent."""
    return atan(chord.dot(tangent) / chord.dot(normal))


F = from_normal(after - here) + lam * from_normal(before - here)
arguments = (theta0, theta1, theta2, lam)
law = lambdify(arguments, F, "numpy")
exit_angle = lambdify(arguments[1:3], from_normal(after - here), "numpy")
slopes = lambdify(arguments, [diff(F, angle) for angle in arguments[:3]], "numpy")
# -

# The triangle turns by a third at each bounce, so one bounce and a turn back is a map with the fixed point $\theta^*$.
# Its multipliers $\mu$ solve $F_0 + F_1\mu + F_2\mu^2 = 0$, with the derivatives of $F$ by the three bounces:

# +
saddle = triangles.unstable[0]
turn = saddle.theta[1] - saddle.theta[0]
fixed = saddle.theta[1]
F0, F1, F2 = slopes(fixed - turn, fixed, fixed + turn, crisis)
mu_unstable, mu_stable = sorted(np.roots([F2, F1, F0]), key=abs, reverse=True)
float(mu_unstable), float(mu_stable)
# -

# A manifold is a curve $\theta = P(z)$ with $F(P(z/\mu), P(z), P(\mu z)) = 0$. With the coefficients below order $n$
# known, that of order $n$ follows from a linear equation. The power series of $F$ is read off values on a circle:


# +
def manifold(mu, scale, order=30):
    """The coefficients of `P`, lowest order first; `scale` is that of order 1."""
    circle = np.exp(2j * np.pi * np.arange(128) / 128)
    coefficients = np.array([fixed, scale] + [0.0] * (order - 1))
    for n in range(2, order + 1):
        values = defect(coefficients, mu, circle)
        coefficients[n] = -np.fft.fft(values)[n].real / 128 / (F0 / mu**n + F1 + F2 * mu**n)
    return coefficients


def series(coefficients, z):
    """The value of a power series."""
    return np.polynomial.polynomial.polyval(z, coefficients)


def defect(coefficients, mu, z):
    """`F(P(z/mu), P(z), P(mu*z))`, which vanishes on the manifold."""
    return law(
        series(coefficients, z / mu) - turn, series(coefficients, z), series(coefficients, mu * z) + turn, crisis
    )


unstable, stable = manifold(mu_unstable, 0.03), manifold(mu_stable, 0.03)
interval = np.linspace(-1, 1, 1001)
residuals = [float(np.max(np.abs(defect(P, mu, interval)))) for P, mu in ((unstable, mu_unstable), (stable, mu_stable))]
residuals
# -

# ## The picture
#
# Both manifolds are short curves so far. The map stretches the unstable one. Its inverse stretches the stable one: a
# ball that left at $\varphi$ had landed with $\eta = -\varphi/\lambda$, and flies back along the line with that angle.


# +
egg = PinballMap("egg", alpha="2/25", lam=boundary.value)


def bounces(coefficients, mu, z):
    """Phase points `(theta, phi)` on a manifold."""
    angle = series(coefficients, z)
    return angle, exit_angle(angle, series(coefficients, mu * z) + turn)


def backwards(angle, phi):
    """The phase points one bounce before, of those that have one."""
    inside = np.abs(phi) < crisis * np.pi / 2
    flight = egg.step(angle[inside], -phi[inside] / crisis)
    return flight.theta, flight.eta


grid = np.linspace(-1, 1, 40001)
forward = egg.orbit(*bounces(unstable, mu_unstable, grid), 8)
piece, pieces = bounces(stable, mu_stable, grid), []
for _ in range(6):
    pieces.append(piece)
    piece = backwards(*piece)
backward = tuple(np.concatenate(parts) for parts in zip(*pieces, strict=True))
# -

# The attractors just below the crisis, and in a third of phase space the unstable manifold of one saddle (red) with its
# stable one (black). They cross at the saddle, near $s = -0.17$. Near $s = -0.3$ a tip of the attractor touches the
# black curve.

# +
found = attractors("egg", alpha="2/25", lam="0.662", orbits=200)
lines = (forward.theta, forward.phi), backward
figure = found.plot()
phase = figure.axes[1]
for (angle, phi), color in zip(lines, ("tab:red", "black"), strict=True):
    s = egg.arclength.s(np.ravel(angle), np.zeros(np.size(angle), dtype=int))
    phase.plot(s, np.sin(np.ravel(phi)), ".", color=color, markersize=0.3)
phase.set_xlim(-1.1, 1.1)
phase.set_xticks([-1, -0.5, 0, 0.5, 1])
figure
# -

# ## What sampling sees
#
# Below the crisis no ball leaves the attractor; above it the mean stay falls like a power of the distance, and the
# power follows from the multipliers of the saddle [GrebogiOttRomeirasYorke1987]:

exponent = float(np.log(abs(mu_stable)) / (2 * np.log(abs(mu_stable * mu_unstable))))
exponent


# +
def still_chaotic(contraction, bounces=20000, balls=200):
    """The share of balls, started near the diameter, whose neighbourhoods still grow after a while."""
    rng = np.random.default_rng(1)
    ball = PinballMap("egg", lam=contraction, alpha="2/25").exponents(
        rng.uniform(-0.05, 0.05, balls), rng.uniform(-0.05, 0.05, balls), 500, bounces
    )
    return float(np.mean(ball.nu_plus > 0))


shares = {contraction: still_chaotic(contraction) for contraction in (0.655, 0.662, 0.67, 0.68, 0.70)}
shares
# -

# ## A check that can fail

assert max(residuals) < 1e-12
assert np.allclose(sorted(abs(np.array(saddle.multipliers))), [abs(mu_stable) ** 3, abs(mu_unstable) ** 3], rtol=1e-6)
for located in (boundary, merging):
    assert located.checks["two_methods_agree"]
    assert located.checks["tangency"]
    assert located.checks["quadratic"]
    assert located.checks["transversal"]
    assert located.checks["is_the_crisis"] is None
assert abs(crisis - 0.66) < 0.005
assert abs(float(merging.value) - 0.4435) < 1e-4
assert f"^-{exponent:.4f}" in boundary.notes["transient"]
assert shares[0.655] == 1
assert shares[0.70] < 0.5
