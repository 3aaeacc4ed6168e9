"""Elementary functions written over an abstract float64: the same text for arrays and for LLVM lanes.

Coefficients are the nearest doubles to near-minimax polynomials; truncation stays below 2e-17, so
what remains is rounding. tests/numeric/backends/test_functions.py holds them against 50 digits.
"""

from typing import Any

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
TAN_EIGHTH = 0.41421356237309503  # tan(pi/8)
HALF_PI, HALF_PI_LOW = 1.5707963267948966, 6.123233995736766e-17  # their sum is pi/2 to 107 bits
TWO_OVER_PI = 0.6366197723675814


def horner(ops: Any, coefficients: tuple[float, ...], x: Any) -> Any:
    """The polynomial with these coefficients, constant first, at `x`."""
    value = ops.number(coefficients[-1])
    for c in reversed(coefficients[:-1]):
        value = value * x + ops.number(c)
    return value


def angle(ops: Any, y: Any, x: Any) -> Any:
    """`atan2(y, x)` for `x >= 0`, in radians; the pair need not have length one."""
    size = abs(y)
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


def turn(ops: Any, x: Any, quarters: int = 2) -> tuple[Any, Any]:
    """`(cos x, sin x)` for `|x| <= quarters*pi/2`; `quarters` is 1 or 2."""
    size = abs(x)
    if quarters == 1:
        odd = ops.number(HALF_PI / 2) < size
        j = ops.select(odd, ops.number(1.0), ops.number(0.0))
    else:
        j = ops.rounded(size * ops.number(TWO_OVER_PI))
        odd = abs(j - ops.number(1.0)) < ops.number(0.5)
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
