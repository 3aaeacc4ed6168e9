"""Elementary functions, arithmetic in the plane, and zeros, on any backend of float64: arrays and LLVM vectors alike.

The coefficients are the nearest doubles to near-minimax polynomials. Truncation stays below 2e-17, so that almost all
of the error is rounding; tests/numeric/backends/test_functions.py compares the functions with 50 digits.

Points and directions in the plane are pairs. The only zero of a function in an interval is found in two stages. First
come unconditional steps of Newton's method, which cost no branch. A lane that has not converged inside its bracket then
enters a loop that keeps a change of sign and cannot leave the bracket. Lanes that have converged stay as they are, so
that no lane's result depends on its neighbours.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from numeric.backends.protocol import Backend, Low, M, N, Pair, bound, modulus

ATAN = (
    -0.3333333333333333, 0.1999999999999552, -0.14285714284666542, 0.11111111015256347,
    -0.09090904578123339, 0.07692183190813, -0.06664511447197602, 0.05858148911200793,
    -0.0508544972956006, 0.03923165805348649, -0.019176886822567605,
)  # fmt: skip
SIN = (
    -0.16666666666666666, 0.008333333333330948, -0.00019841269836758574,
    2.7557316102552253e-06, -2.5051131844964674e-08, 1.5918129292060287e-10,
)  # fmt: skip
COS = (
    0.041666666666666664, -0.0013888888888887398, 2.480158729876569e-05,
    -2.7557317271729677e-07, 2.087614626837883e-09, -1.1382632423766107e-11,
)  # fmt: skip
TAN_EIGHTH, TWO_OVER_PI = 0.41421356237309503, 0.6366197723675814  # tan(pi/8), 2/pi
HALF_PI, HALF_PI_LOW = 1.5707963267948966, 6.123233995736766e-17  # their sum is pi/2 to 107 bits


def horner(ops: Backend[N, M], coefficients: tuple[float, ...], x: N) -> N:
    """The polynomial with these coefficients, constant first, at `x`."""
    value = ops.number(coefficients[-1])
    for c in reversed(coefficients[:-1]):
        value = value * x + ops.number(c)
    return value


def angle(ops: Backend[N, M], y: N, x: N) -> N:
    """`atan2(y, x)` for `x >= 0`, in radians; the pair need not have length one."""
    size = modulus(y)
    steep = x < size
    low, high = ops.select(steep, x, size), ops.select(steep, size, x)
    far = ops.number(TAN_EIGHTH) * high < low
    z = ops.select(far, low - high, low) / ops.select(far, low + high, high)
    w = z * z
    small = z * w * horner(ops, ATAN, w) + z
    small = ops.select(steep, -small, small)
    base = ops.select(steep, ops.number(HALF_PI), ops.number(0.0))
    base = ops.select(far, ops.number(HALF_PI / 2), base)
    return ops.with_sign(base * ops.number(HALF_PI_LOW / HALF_PI) + small + base, y)


def turn(ops: Backend[N, M], x: N, quarters: int = 2) -> Pair[N]:
    """`(cos x, sin x)` for `|x| <= quarters*pi/2`; `quarters` is 1 or 2."""
    size = modulus(x)
    if quarters == 1:
        odd = ops.number(HALF_PI / 2) < size
        j = ops.select(odd, ops.number(1.0), ops.number(0.0))
    else:
        j = ops.rounded(size * ops.number(TWO_OVER_PI))
        odd = modulus(j - ops.number(1.0)) < ops.number(0.5)
    r = ops.fma(-j, ops.number(HALF_PI), size)
    r = ops.fma(-j, ops.number(HALF_PI_LOW), r)
    w = r * r
    sine = r * w * horner(ops, SIN, w) + r
    cosine = w * w * horner(ops, COS, w) + (ops.number(1.0) - ops.number(0.5) * w)
    across, along = ops.select(odd, cosine, sine), ops.select(odd, sine, cosine)
    along = ops.select(ops.number(0.5) < j, -along, along)
    if quarters > 1:
        across = ops.select(ops.number(1.5) < j, -across, across)
    return along, ops.times_sign(across, x)


EXP = tuple(1 / math.factorial(n) for n in range(3, 14))  # of exp(r) - 1 - r - r**2/2, over r**3, for |r| < log(2)/2
LOG = tuple(2 / (2 * n + 3) for n in range(11))  # of log((1 + s)/(1 - s)) - 2*s, over s**3, for |s| < 0.172
LOG_2, LOG_2_LOW = 0.6931471805599453, 2.3190468138462996e-17  # their sum is log(2) to 107 bits
LARGEST = 708.0  # exp(LARGEST) is a double


def exp_less_one(ops: Backend[N, M], x: N) -> Pair[N]:
    """`(2**k, p)` with `exp(x) = 2**k*(1 + p)` and `|p| < 0.42`, for `|x| <= 708`; `p` is accurate even near 0."""
    k = ops.rounded(x * ops.number(1 / LOG_2))
    r = ops.fma(-k, ops.number(LOG_2), x)
    r = ops.fma(-k, ops.number(LOG_2_LOW), r)
    w = r * r
    return ops.two_to(k), w * r * horner(ops, EXP, r) + ops.number(0.5) * w + r


def within(ops: Backend[N, M], x: N) -> N:
    """`x`, clamped to the interval in which the exponential neither overflows nor underflows."""
    return ops.maximum(-ops.maximum(-x, ops.number(-LARGEST)), ops.number(-LARGEST))


def exponential(ops: Backend[N, M], x: N) -> N:
    """`exp(x)`."""
    scale, p = exp_less_one(ops, within(ops, x))
    return scale * p + scale


def hyperbolic(ops: Backend[N, M], x: N, word: str) -> N:
    """`sinh`, `cosh` or `tanh` of `x`."""
    one, half, size = ops.number(1.0), ops.number(0.5), within(ops, modulus(x))
    if word == "cosh":
        grown = exponential(ops, size)
        return half * grown + half / grown
    scale, p = exp_less_one(ops, size if word == "sinh" else within(ops, size + size))
    more = scale * p + (scale - one)  # exp - 1
    value = half * (more + more / (more + one)) if word == "sinh" else more / (more + ops.number(2.0))
    return ops.times_sign(value, x)


def logarithm(ops: Backend[N, M], x: N) -> N:
    """The natural logarithm of a normal positive number; nan elsewhere."""
    one = ops.number(1.0)
    scale, k = ops.power_of_two(x)
    m = x * scale
    large = ops.number(2.0**0.5) < m
    m, k = ops.select(large, ops.number(0.5) * m, m), ops.select(large, k + one, k)
    f = m - one
    s = f / (m + one)
    w = s * s
    square = ops.number(0.5) * f * f
    rest = s * (square + w * horner(ops, LOG, w)) + k * ops.number(LOG_2_LOW)
    value = k * ops.number(LOG_2) - ((square - rest) - f)
    return ops.select(ops.number(0.0) < x, value, ops.number(math.nan))


def root(ops: Backend[N, M], x: N, n: int) -> N:
    """The positive `n`-th root of a positive number: a guess by logarithms, and Newton's step on `y**n = x`.

    A very small number, for which the residual of Newton's step might be subnormal, is first scaled by a power of two.
    """
    positive, lift = ops.number(0.0) < x, 900 // n
    small = x < ops.number(2.0**-900)
    x = ops.select(small, x * ops.number(2.0 ** (n * lift)), x)
    y = exponential(ops, logarithm(ops, x) * ops.number(1 / n))
    power = y
    for _ in range(n - 2):
        power = power * y
    y = y - (power * y - x) / (power * ops.number(float(n)))
    y = y * ops.select(small, ops.number(2.0**-lift), ops.number(1.0))
    return ops.select(positive, y, ops.select(ops.negated(x < ops.number(0.0)), x, ops.number(math.nan)))


def times(z: Pair[N], w: Pair[N]) -> Pair[N]:
    """`z*w`.

    >>> times((1, 2), (3, 4))
    (-5, 10)
    """
    return z[0] * w[0] - z[1] * w[1], z[0] * w[1] + z[1] * w[0]


def scaled(factor: N, z: Pair[N]) -> Pair[N]:
    """`factor*z` for a real factor."""
    return factor * z[0], factor * z[1]


def conjugate(z: Pair[N]) -> Pair[N]:
    """The mirror image in the x axis; the inverse of a unit vector."""
    return z[0], -z[1]


def squared(z: Pair[N]) -> Pair[N]:
    """The square of a complex number; its real part is formed as a product, which loses no digits."""
    return (z[0] - z[1]) * (z[0] + z[1]), (z[0] + z[0]) * z[1]


def dot(z: Pair[N], w: Pair[N]) -> N:
    """The scalar product, `Re(conj(z)*w)`."""
    return z[0] * w[0] + z[1] * w[1]


def cross(z: Pair[N], w: Pair[N]) -> N:
    """`Im(conj(z)*w)`, positive when `w` lies to the left of `z`."""
    return z[0] * w[1] - z[1] * w[0]


def exact_cross(ops: Backend[N, M], z: Pair[N], w: Pair[N]) -> N:
    """`cross(z, w)` to two units in the last place, even if it is almost 0, by Kahan [JeannerodLouvetMuller2013]."""
    product = z[1] * w[0]
    lost = ops.fma(-z[1], w[0], product)
    return ops.fma(z[0], w[1], -product) + lost


def exact_dot(ops: Backend[N, M], z: Pair[N], w: Pair[N]) -> N:
    """`dot(z, w)` to two units in the last place, even if it almost vanishes."""
    return exact_cross(ops, (z[0], -z[1]), (w[1], w[0]))


def product_and_error(ops: Backend[N, M], x: N, y: N) -> Pair[N]:
    """`x*y` rounded, and the rounding error, exactly."""
    product = ops.product(x, y)
    return product, ops.fma(x, y, -product)


def cross_and_error(ops: Backend[N, M], z: Pair[N], w: Pair[N]) -> Pair[N]:
    """`cross(z, w)`, rounded, and its rounding error; their sum has twice the digits."""
    (x, x_error), (y, y_error) = product_and_error(ops, z[0], w[1]), product_and_error(ops, z[1], w[0])
    total = x - y
    back = total - x
    return total, ((x - (total - back)) - (y + back)) + (x_error - y_error)


def unit(ops: Backend[N, M], z: Pair[N]) -> Pair[N]:
    """`z`, a unit vector up to rounding, normalised again."""
    short = ops.fma(-z[0], z[0], ops.fma(-z[1], z[1], ops.number(1.0)))
    half = short * ops.number(0.5)
    return ops.fma(z[0], half, z[0]), ops.fma(z[1], half, z[1])


def half(ops: Backend[N, M], c: N, s: N) -> Pair[N]:
    """Cosine and sine of half an angle, up to a common factor, from its cosine and sine, without cancellation."""
    behind, one = c < ops.number(0.0), ops.number(1.0)
    return ops.select(behind, s, one + c), ops.select(behind, one - c, s)


def normalised(ops: Backend[N, M], z: Pair[N]) -> Pair[N]:
    """`z` divided by its length, whatever that is."""
    scale = ops.number(1.0) / ops.sqrt(dot(z, z))
    return unit(ops, (z[0] * scale, z[1] * scale))


class Series(NamedTuple):
    """How an arc length is computed from a list of numbers: in closed form, or as a finite Fourier sum.

    The list begins with the `offsets` of the components. A sum of sines is `sin(step*theta)` times a polynomial in
    `cos(step*theta)`. If the polynomial's coefficients are small, the list has them and `powers` is true; this takes
    half the operations of Clenshaw's rule, which serves otherwise.
    """

    offsets: int = 0
    step: int = 1  # the greatest common divisor of the frequencies of the sum
    terms: int = 0
    rises: int = 0  # as many as there are terms, or none on a boundary that mirrors `theta`
    powers: bool = False

    @property
    def size(self) -> int:
        """The length of the list of numbers: offsets, the mean speed, coefficients of sines and of `1 - cos`."""
        return self.offsets + (1 + self.terms + self.rises if self.terms else 0)


CLOSED = Series()


TOLERANCE = 2.0**-27  # of the last Newton correction: the error left is its square
ENOUGH = 200  # passes of the bracketed loop, of which every second one at worst halves the bracket


def value_and_slope(p: Sequence[N], x: N) -> Pair[N]:
    """A polynomial, constant first, and its derivative at `x`.

    >>> value_and_slope([5, 0, 1], 3)
    (14, 6)
    """
    value, slope = p[-1] * x + p[-2], p[-1]
    for c in reversed(p[:-2]):
        slope = slope * x + value
        value = value * x + c
    return value, slope


def halley(p: Sequence[N], x: N) -> N:
    """One step of Halley's method on a polynomial: third order for one division."""
    value, slope, half = p[-1] * x + p[-2], p[-1], None
    for c in reversed(p[:-2]):
        half = slope if half is None else half * x + slope
        slope = slope * x + value
        value = value * x + c
    if half is None:
        return x - value / slope
    return x - value * slope / (slope * slope - value * half)


def bracketed_zero(
    ops: Backend[N, M],
    function: Callable[[N], Pair[N]],
    x: N,
    low: Low[N],
    high: N,
    scale: N,
    newton: int,
    wanted: M | None = None,
    accepts: Callable[[N], M] | None = None,
) -> N:
    """The only zero in `[low, high]` of a function that is negative at `low` and positive at `high`.

    `function` returns the value and the slope, `scale` is the size below which the zero's absolute error counts, and
    `newton` is the number of Newton steps before convergence is tested. A lower bound that is expensive may be given as
    a function, together with a cheap test `accepts`; it is called only when a lane needs it. Lanes outside the mask
    `wanted` keep the value that the Newton steps gave.
    """
    step = x
    for _ in range(newton):
        value, slope = function(x)
        step = value / slope
        x = x - step
    tolerance = ops.number(TOLERANCE)
    done = (modulus(step) <= tolerance * ops.maximum(modulus(x), scale)) & (x <= high)
    above = accepts(x) if accepts is not None else bound(low) <= x
    done = done & above
    if wanted is not None:
        done = done | ops.negated(wanted)
    unfinished = ops.negated(done)

    def bracketed() -> list[N]:
        bottom = bound(low)
        inside = (bottom < x) & (x < high)
        start = ops.select(inside, x, ops.number(0.5) * (bottom + high))
        flag = ops.select(unfinished, ops.number(1.0), ops.number(0.0))
        state = [start, bottom, high, flag, high - bottom]
        found = ops.repeat(lambda state: ops.number(0.5) < state[3], improved, state, ENOUGH)[0]
        return [ops.select(unfinished, found, x)]

    def improved(state: Sequence[N]) -> list[N]:
        x, low, high, flag, before = state
        value, slope = function(x)
        below = value < ops.number(0.0)
        low, high = ops.select(below, x, low), ops.select(below, high, x)
        step = value / slope
        middle, newton = ops.number(0.5) * (low + high), x - step
        good = (low < newton) & (newton < high) & (modulus(step) <= before)
        moved = ops.select(good, newton, middle)
        change = modulus(moved - x)
        small = tolerance * ops.maximum(modulus(moved), scale)
        exact = value == ops.number(0.0)
        settled = (good & (modulus(step) <= small)) | exact | (high - low <= ops.number(2.0**-26) * small)
        return [
            ops.select(exact, x, moved),
            low,
            high,
            ops.select(settled, ops.number(0.0), flag),
            ops.number(0.5) * change,
        ]

    return ops.when(unfinished, [x], bracketed)[0]


def polynomial_zero(
    ops: Backend[N, M],
    p: Sequence[N],
    x: N,
    low: Low[N],
    high: N,
    scale: N,
    steps: tuple[int, int],
    wanted: M | None = None,
    accepts: Callable[[N], M] | None = None,
) -> N:
    """The zero of a polynomial, constant first, as by `bracketed_zero`; first `steps` by Halley, then by Newton."""
    for _ in range(steps[0]):
        x = halley(p, x)
    return ops.zero(lambda at: value_and_slope(p, at), x, low, high, scale, steps[1], wanted, accepts)
