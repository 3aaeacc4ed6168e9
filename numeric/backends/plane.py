"""Complex arithmetic on pairs, for points and directions in the plane."""

from typing import Any

Pair = tuple[Any, Any]


def times(z: Pair, w: Pair) -> Pair:
    """`z*w`.

    >>> times((1, 2), (3, 4))
    (-5, 10)
    """
    return z[0] * w[0] - z[1] * w[1], z[0] * w[1] + z[1] * w[0]


def conjugate(z: Pair) -> Pair:
    """The mirror image in the x axis; the inverse of a unit vector."""
    return z[0], -z[1]


def squared(z: Pair) -> Pair:
    """`z*z`, with the real part as a product so that nothing cancels twice."""
    return (z[0] - z[1]) * (z[0] + z[1]), (z[0] + z[0]) * z[1]


def dot(z: Pair, w: Pair) -> Any:
    """The scalar product, `Re(conj(z)*w)`."""
    return z[0] * w[0] + z[1] * w[1]


def cross(z: Pair, w: Pair) -> Any:
    """`Im(conj(z)*w)`, positive when `w` lies to the left of `z`."""
    return z[0] * w[1] - z[1] * w[0]


def exact_cross(ops: Any, z: Pair, w: Pair) -> Any:
    """`cross` to two units in the last place even where it almost vanishes, by Kahan [JeannerodLouvetMuller2013]."""
    product = z[1] * w[0]
    lost = ops.fma(-z[1], w[0], product)
    return ops.fma(z[0], w[1], -product) + lost


def exact_dot(ops: Any, z: Pair, w: Pair) -> Any:
    """`dot`, as `exact_cross`."""
    return exact_cross(ops, (z[0], -z[1]), (w[1], w[0]))


def product_and_rest(ops: Any, x: Any, y: Any) -> Pair:
    """`x*y` rounded, and what the rounding lost, exactly."""
    product = ops.product(x, y)
    return product, ops.fma(x, y, -product)


def cross_and_rest(ops: Any, z: Pair, w: Pair) -> Pair:
    """`cross`, and what it lost, to twice the digits."""
    (x, x_rest), (y, y_rest) = product_and_rest(ops, z[0], w[1]), product_and_rest(ops, z[1], w[0])
    total = x - y
    back = total - x
    return total, ((x - (total - back)) - (y + back)) + (x_rest - y_rest)


def unit(ops: Any, z: Pair) -> Pair:
    """`z` with its length set to one again, when it is one up to rounding."""
    short = ops.fma(-z[0], z[0], ops.fma(-z[1], z[1], ops.number(1.0)))
    half = short * ops.number(0.5)
    return ops.fma(z[0], half, z[0]), ops.fma(z[1], half, z[1])


def normalised(ops: Any, z: Pair) -> Pair:
    """`z` divided by its length, whatever that is."""
    scale = ops.number(1.0) / ops.sqrt(dot(z, z))
    return unit(ops, (z[0] * scale, z[1] * scale))
