# # 3. The cardioid and slap maps
#
# At $\lambda = 0$ a ball leaves along the normal and the map is one-dimensional: the *slap map* $T_0$. On the
# cardioid it is not expanding, but its second iterate is. The paper reads this off a plot (section 4.2); here it is
# proved, and after it that every orbit stretches, at every contraction $\lambda < 1$ (section 4.1).

# +
import numpy as np
from sympy import (
    Matrix,
    N,
    Poly,
    Rational,
    cos,
    diff,
    expand,
    expand_trig,
    factor,
    limit,
    log,
    numer,
    oo,
    pi,
    plot_parametric,
    reduced,
    resultant,
    simplify,
    sin,
    sqrt,
    symbols,
    tan,
    together,
    zeros,
)

from numeric import PinballMap, Status
from symbolic import arc_length, curvature, derivative_matrix, lam, slap_map, tables, theta, theta0, theta1

# -

# ## The table
#
# Arc length from the cusp at $\theta = -\pi$, and the curvature, negative where the boundary focuses:

arc_length("cardioid")

kappa = simplify(curvature("cardioid"))
kappa

# The centres of curvature form the evolute, the curve to which all normals are tangent:

X = Matrix(tables.cardioid.components[0].point)
velocity = X.diff(theta)
inward = Matrix([-velocity[1], velocity[0]]) / sqrt(simplify(velocity.dot(velocity)))
evolute = (X - inward / kappa).applyfunc(simplify)
evolute

# It is a mirror image of the cardioid, three times smaller, and every trajectory of the slap map is tangent to it:

mirrored = Matrix([Rational(2, 3), 0]) - X.subs(theta, theta + pi) / 3
assert (evolute - mirrored).applyfunc(simplify) == zeros(2, 1)

# ## A chord in half angles
#
# A chord from $\theta_0 = 2h$ to $\theta_1 = 2h + 2\delta$ has simple components in the frame of the tangent and the
# inward normal where it starts. Let $c_0 = \cos h$, $c_1 = \cos(h + \delta)$, and let $t$ be its length.

# +
h, delta, b = symbols("h delta b", real=True)
c0, c1 = cos(h), cos(h + delta)
chord = X.subs(theta, 2 * h + 2 * delta) - X.subs(theta, 2 * h)
tangent, normal = Matrix([-sin(3 * h), cos(3 * h)]), Matrix([-cos(3 * h), -sin(3 * h)])
along = 2 * sin(delta) * (c0 * cos(delta) + c1 * cos(2 * delta))
across = 2 * sin(delta) ** 2 * (c0 + 2 * c1 * cos(delta))


def vanishes(*expressions):
    """Are trigonometric polynomials in `h`, `delta` and `b` zero, modulo `sin**2 + cos**2 = 1`?"""
    ring = [f(angle) for angle in (h, delta, b) for f in (sin, cos)]
    circles = [sin(angle) ** 2 + cos(angle) ** 2 - 1 for angle in (h, delta, b)]
    return all(reduced(expand_trig(expand(each)), circles, *ring)[1] == 0 for each in expressions)


assert vanishes(*(velocity.subs(theta, 2 * h) - 2 * c0 * tangent))
assert vanishes(chord.dot(tangent) - along, chord.dot(normal) - across)
# -

# The flight equation of the slap map says that the chord has no component along the tangent:

slap = slap_map("cardioid")
residual = slap.residual.subs({theta0: 2 * h, theta1: 2 * h + 2 * delta}, simultaneous=True)
assert vanishes(residual - 2 * c0 * along)
along

# ## A rational slap map
#
# Let $b = \theta_1/2$ and $\tau = \tan\delta$. Then $c_0\cos\delta + c_1\cos 2\delta$ is
#
# $$\cos b\,(2\cos^2\delta - \sin^2\delta) + \sin b\,\sin\delta\cos\delta,$$
#
# so it vanishes for $\tan b = (\tau^2 - 2)/\tau$. The launch, at $\theta_0/2 = b - \delta$, follows by the tangent of a
# difference.

# +
tau = symbols("tau", real=True)
u = symbols("u", positive=True)
landing = (tau**2 - 2) / tau
launch = simplify((landing - tau) / (1 + landing * tau))
equation = cos(b - delta) * cos(delta) + cos(b) * cos(2 * delta)
assert vanishes(equation - cos(b) * (2 * cos(delta) ** 2 - sin(delta) ** 2) - sin(b) * sin(delta) * cos(delta))
# -

# There $c_0 + 2c_1\cos\delta = c_1/\cos\delta$, and the landing is ahead where this is positive. For a launch in the
# upper half, where $\tan(\theta_0/2) > 0$, that leaves $\tau < -1$. With $u = -\tau > 1$ both ends of the flight are
# rational, first $\tan(\theta_0/2)$, then $\tan(\theta_1/2)$:

launch = factor(launch.subs(tau, -u))
launch

landing = factor(landing.subs(tau, -u))
landing

# As $u$ falls from $\infty$ to 1 the launch runs once over the upper half, from the axis to the cusp. Arc length from
# the axis is $s = 4\sin(\theta/2)$, so the slope squared is a rational function, of $w = u^2 > 1$:

# +
w, v = symbols("w v", positive=True)


def sine(tangent):
    """The sine of an angle between -pi/2 and pi/2 that has this tangent."""
    return tangent / sqrt(1 + tangent**2)


slope_squared = factor(simplify((diff(sine(landing), u) / diff(sine(launch), u)) ** 2).subs(u, sqrt(w)))
slope_squared
# -

# Where it is below 1 the slap map contracts. The edges of this region are roots of a polynomial:

edges = [root for root in Poly(numer(together(slope_squared - 1)), w).real_roots() if root > 1]
low, high = sorted(N(4 * sine(launch).subs(u, sqrt(edge)), 8) for edge in edges)
print("T0' < 1 exactly for", low, "< |s| <", high)

# ## The second iterate
#
# The next flight has another value $v$ of $w$. It starts where the first one landed, perhaps in the other half, so that
# $\tan^2(\theta/2)$ agrees: $(2 - w)^2/w = 4/(v(v - 1)^2)$. The landing is in the other half for $w > 2$.

joined = (2 - w) ** 2 * v * (v - 1) ** 2 - 4 * w
next_slope_squared = slope_squared.subs(w, v)
assert simplify(joined - ((landing**2).subs(u, sqrt(w)) - (launch**2).subs(u, sqrt(v))) * w * v * (v - 1) ** 2) == 0

# The derivative $(T_0^2)' = T_0'(w)\,T_0'(v)$ is infinite at the ends of both branches, $1 < w < 2$ and $w > 2$. There
# $w$ tends to 1, or $v$ tends to 1 or to $\infty$:

[limit(slope_squared, w, end) for end in (1, oo)]

# ## The proof
#
# Where $|(T_0^2)'|$ equals a bound, a resultant that eliminates $v$ leaves a polynomial in $w$, and Sturm's theorem
# counts its roots. With the bound $3/2$ there are none, so $|(T_0^2)'| > 3/2$ everywhere:


# +
def eliminated(condition):
    """A polynomial in `w` that vanishes where the condition on `w` and `v` holds on two successive flights."""
    return Poly(resultant(numer(together(condition)), joined, v), w).sqf_part()


def roots_by_branch(bound):
    """The numbers of roots for which `(T0^2)'` may equal the bound, on both branches."""
    polynomial = eliminated(slope_squared * next_slope_squared - bound**2)
    return polynomial.count_roots(1, 2), polynomial.count_roots(2, oo)


at_three_halves = roots_by_branch(Rational(3, 2))
at_three_halves
# -

# The value $1.51$ is taken on the branch $w > 2$ only, so on the other one $(T_0^2)'$ stays above it:

above_least = roots_by_branch(Rational(151, 100))
above_least

# The least value is therefore taken on $w > 2$, at a critical point. Along a branch, $w$ and $v$ vary together, and the
# logarithmic derivative of $(T_0^2)'$ vanishes at roots of

growth, next_growth = diff(log(slope_squared), w), diff(log(next_slope_squared), v)
critical = growth * diff(joined, v) - next_growth * diff(joined, w)
candidates = [root for root in eliminated(critical).real_roots() if root > 2]
[N(root, 10) for root in candidates]

# An elimination also counts roots with a value of $v$ below 1, which belongs to no flight. For each candidate there is
# one value above 1, and only at the first candidate does the condition hold there:


# +
def next_flight(root, digits=60):
    """The one value of `v` above 1 that follows this value of `w`."""
    (found,) = [x for x in Poly(joined.subs(w, N(root, digits)), v).nroots(digits) if x.is_real and x > 1]
    return found


left = [N(critical.subs({w: N(root, 60), v: next_flight(root)}), 20) for root in candidates]
left
# -

# So the branch $w > 2$ has one critical point, its minimum, and the infimum of $(T_0^2)'$ is the algebraic number

attained = N(candidates[0], 60)
infimum = N(sqrt(slope_squared.subs(w, attained) * slope_squared.subs(w, next_flight(attained))), 30)
infimum

# Against arc length on the upper half: $T_0'$, which falls below 1, and the two branches of $(T_0^2)'$, which do not.

# +
s0, half_way = 4 * sine(launch), sqrt(2 + (launch / 2) ** 2)
twice = sqrt(slope_squared * next_slope_squared)
other, same = half_way + launch / 2, half_way - launch / 2  # the u of the flight before one with this u
picture = plot_parametric(
    (s0, sqrt(slope_squared.subs(w, u**2)), (u, 1.01, 30), "$T_0'$"),
    (s0.subs(u, other), twice.subs({w: other**2, v: u**2}), (u, 1.02, 30), "$(T_0^2)'$, $w > 2$"),
    (s0.subs(u, same), twice.subs({w: same**2, v: u**2}), (u, 1.53, 30), "$(T_0^2)'$, $w < 2$"),
    xlim=(0, 4),
    ylim=(0, 6),
    xlabel="$s$",
    ylabel="slope",
    legend=True,
    size=(7, 4),
)
# -

# ## A check that can fail
#
# Slopes in float64, sampled over the table, agree with the formula. Those of $T_0^2$ stay above the proved infimum, and
# come near it; those of $T_0$ do not stay above 1.

# +
float_slap = PinballMap("cardioid", lam=0)
angles = np.linspace(-3.1, 3.1, 20000)  # not 0, whose normal runs into the cusp
once = float_slap.slap(angles, 1)
two = once.slope * float_slap.slap(once.theta[1], 1).slope
turning = np.tan((once.theta[1] - angles) / 2) ** 2  # w
formula = (turning + 1) ** 3 * (turning + 2) ** 2 / (4 * (turning - 1) ** 2 * (3 * turning - 1) ** 2)

assert at_three_halves == (0, 0)
assert above_least == (0, 2)
assert abs(left[0]) < 1e-30
assert all(abs(value) > 1e-3 for value in left[1:])
assert np.allclose(once.slope**2, formula, rtol=1e-6)
assert np.min(np.abs(once.slope)) < 1
assert np.min(two) >= float(infimum) * (1 - 1e-12)
assert np.min(two) < float(infimum) * (1 + 1e-3)
# -

# ## Every contraction below 1
#
# A narrow beam of balls has a width $q = \cos\varphi\,ds$, and its direction changes across it by $\omega = K ds +
# d\varphi$. Let $u = \omega/q$ be its curvature. A flight takes $u$ to $u' = u/(1 + tu)$. The reflection then takes it
# to $u_1$, with $d_1 = \cos\eta_1/|K_1|$:

# +
K0, K1 = symbols("K0 K1", negative=True)
t = symbols("t", positive=True)
phi0, eta1, phi1, q, bent = symbols("phi0 eta1 phi1 q u", real=True)
D = derivative_matrix(K0=K0, K1=K1, t=t, cos_phi0=cos(phi0), cos_eta1=cos(eta1))
ds1, dphi1 = D * Matrix([q / cos(phi0), bent * q - K0 * q / cos(phi0)])
q1, omega1 = cos(phi1) * ds1, K1 * ds1 + dphi1
arriving, d1 = bent / (1 + t * bent), -cos(eta1) / K1
bent1 = cos(eta1) / cos(phi1) * (lam * arriving - (1 + lam) / d1)

assert simplify(q1 / q + cos(phi1) / cos(eta1) * (1 + t * bent)) == 0
assert simplify(omega1 / q1 - bent1) == 0
bent1
# -

# Let $D = \cos\varphi/|K|$ where a ball leaves, so that $\cos\eta_1/\cos\varphi_1 = d_1/D_1$. Beams with $-(1 +
# \lambda)/D_0 \leq u \leq -1/D_0$ form a *cone*. If $t \geq D_0 + d_1$, they arrive with $0 < u' \leq 1/d_1$, and the
# values of $u_1D_1$ at the two ends show that they leave in the same cone:

# +
D0, D1, distance = symbols("D0 D1 d1", positive=True)
ends = [distance / D1 * (lam * x - (1 + lam) / distance) * D1 for x in (1 / distance, 0)]
assert simplify(ends[0] + 1) == simplify(ends[1] + 1 + lam) == 0
Matrix([ends]).applyfunc(simplify)
# -

# The beam $u = -1/D_0$, which is the vector $(ds, d\varphi) = (1, 0)$, widens least. In units of $D$ its width is
# $|K|\,|ds|$; it grows by the *gain* $(t - D_0)/d_1$, and $ds$ itself by the factor $|K_0|(t - D_0)/\cos\eta_1$:

gain_of_width = (t / D0 - 1) * (D1 / distance) * D0 / D1
assert simplify(gain_of_width - (t - D0) / distance) == 0
assert simplify(D[0, 0] - (-K0) * (t - (-cos(phi0) / K0)) / cos(eta1)) == 0

# On the cardioid $t\cos\varphi_0$ is the component across the tangent from above. The radius of curvature is $4c/3$,
# and $|K|\,ds$ is $\tfrac32 d\theta$, so that the whole boundary measures $3\pi$ in it:

arrival = Matrix([-cos(3 * (h + delta)), -sin(3 * (h + delta))])
assert vanishes(chord.dot(chord) - 4 * sin(delta) ** 2 * (c0**2 + c1**2 + 2 * c0 * c1 * cos(delta)))
assert vanishes(chord.dot(arrival) + 2 * sin(delta) ** 2 * (c1 + 2 * c0 * cos(delta)))
assert simplify(kappa.subs(theta, 2 * h) ** 2 * (4 * cos(h) / 3) ** 2 - 1) == 0
assert simplify(kappa**2 * velocity.dot(velocity) - Rational(9, 4)) == 0

# The chord makes an angle between $|\delta|$ and $2|\delta|$ with the tangent, since its cross products with these two
# directions are $2c_1\sin^2\delta$ and $2c_0\sin^2\delta$, both positive. An exit within $\lambda\pi/2$ of the normal
# makes an angle of at least $(1 - \lambda)\pi/2$ with the tangent, so $|\delta| \geq (1 - \lambda)\pi/4$ on every
# flight but the first.

assert vanishes(cos(delta) * across - sin(delta) * along - 2 * sin(delta) ** 2 * c1)
assert vanishes(along * sin(2 * delta) - across * cos(2 * delta) - 2 * sin(delta) ** 2 * c0)

# Not both ends of a flight are near the cusp. With $C = \cos\delta$ the first identity gives $\sin^2\delta$, the second
# $C > -\tfrac12$, since $\cos\varphi_0 + \cos\eta_1$ is positive, and the third $3c_1^2 \geq \sin^2\delta$ if $c_1 \geq
# c_0$:

squared = c0**2 + c1**2 - 2 * c0 * c1 * cos(delta)
assert vanishes(squared - sin(delta) ** 2)
assert vanishes(c0 + 2 * c1 * cos(delta) + c1 + 2 * c0 * cos(delta) - (c0 + c1) * (1 + 2 * cos(delta)))
assert vanishes(3 * c1**2 - squared - (c1 - c0) * (2 * c1 + c0) - c0 * c1 * (1 + 2 * cos(delta)))

# Here $D_0 = \tfrac43c_0\cos\varphi_0$ and $d_1 = \tfrac43c_1\cos\eta_1$. With $x = c_0/c_1$ the excess
# $t(t - D_0 - d_1)$ is $c_1^2\sin^2\delta$ times

x, C = symbols("x C", real=True)
excess = factor(4 * (x**2 + 1 + 2 * x * C) - Rational(4, 3) * (x * 2 * (x + 2 * C) + 2 * (1 + 2 * x * C)))
excess

# so that it equals $\tfrac43\sin^4\delta$ and is never negative: the cone is mapped into itself. The gain is

gain = 1 + excess / (Rational(8, 3) * (1 + 2 * x * C))
gain

# It is at least $1 + \tfrac12\tan^2(\delta/2)$ for $C \geq 0$, and at least $\tfrac32$ for $C \leq 0$: multiplied by
# positive numbers, both differences are sums of terms of which none is negative, for $x \geq 0$.

sums = {
    excess * 3 / 4: (x - 1) ** 2 + 2 * x * (1 - C),
    (gain - 1 - (1 - C) / (1 + C) / 2) * 2 * (1 + 2 * x * C) * (1 + C) ** 2: ((1 + C) * x - 2 * C) ** 2
    + 2 * C * (1 - C),
    (gain - Rational(3, 2)) * 2 * (1 + 2 * x * C): x**2 + 4 * x * (-C),
}
assert all(simplify(left_side - right_side) == 0 for left_side, right_side in sums.items())
assert tan(pi / 8) < 1  # so the first bound, at most 1 + tan(pi/8)**2/2, is below 3/2

# Altogether every bounce but the first widens the beam by at least $g = 1 + \tfrac12\tan^2((1 - \lambda)\pi/8)$. The
# first bounce has $|K|\,|ds| \geq 3/4$ and no gain below 1; the last has $t \leq 4$ and $t(t - D_0) \geq
# \tfrac43\sin^4\delta$. So on every orbit off the cusp
#
# $$|D(T^n)\,(1, 0)| \geq \tfrac14 \sin^4((1 - \lambda)\pi/4)\; g^{\,n - 2} \qquad (n \geq 2,\ \lambda < 1),$$
#
# and $\liminf \tfrac1n \log|D(T^n)(1, 0)|$ is at least

g = 1 + tan((1 - lam) * pi / 8) ** 2 / 2
log(g)

# For almost every start the smaller singular value shrinks, at the rate $\log g$ at least. Not shown for
# $0 < \lambda < 1$: that the exponents exist as limits, that $\nu_- < 0$ for every invariant measure, a natural
# measure, transitivity.
#
# ## A check that can fail
#
# The proved bound is held against orbits at $\lambda = 1/2$ that have not met the cusp after 30 bounces.

# +
half = PinballMap("cardioid", lam="1/2")
orbit = half.orbit(np.linspace(-3, 3, 501), np.linspace(-1.5, 1.4, 501), 30)
off_cusp = np.all(orbit.status == Status.REGULAR, axis=0)
bound = [float((sin((1 - lam) * pi / 4) ** 4 / 4 * g ** (n - 2)).subs(lam, Rational(1, 2))) for n in range(2, 30)]
vector = np.stack([np.ones(np.sum(off_cusp)), np.zeros(np.sum(off_cusp))])
stretch = []
for n in range(1, 30):
    D_n = half.derivative(orbit.theta[n - 1, off_cusp], orbit.phi[n - 1, off_cusp])
    vector = np.einsum("...ij,j...->i...", D_n, vector)
    stretch.append(np.min(np.abs(vector[0])))
print(np.sum(off_cusp), "orbits; least stretch after 29 bounces:", stretch[-1], "; proved:", bound[-1])
assert np.sum(off_cusp) >= 500
assert np.all(np.array(stretch[1:]) >= bound)
