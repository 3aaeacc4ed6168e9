"""Elementary functions of arrays with the same bits on every processor, for orbits and statistics.

NumPy has several compiled forms of `arcsin`, `arctan`, `exp`, `log`, powers and others, and takes the one for the
widest registers that the processor has. These forms differ in the last bit, and within forty bounces a chaotic orbit
amplifies such a difference to its own size. The functions here consist of operations that IEEE 754 rounds, in one
order, as in the kernels. Of NumPy they use only sums, products, quotients, square roots and moves of the exponent. They
err by a unit or two in the last place. Unlike those of the kernels they are defined at the ends of their ranges too.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric.backends import functions
from numeric.backends.scalars import ArrayBackend

Array = NDArray[np.float64]
OPS = ArrayBackend()
WIDE, LIFT = 700.0, 200  # beyond, an exponential is a square; a subnormal number is made larger by 2**LIFT


def arctan2(y: ArrayLike, x: ArrayLike) -> Array:
    """The angle of the point `(x, y)`, in radians from -pi to pi; 0 at the origin.

    >>> [float(angle) for angle in arctan2([0, 1, 0, -1], [0, 0, -1, -1])]
    [0.0, 1.5707963267948966, 3.141592653589793, -2.356194490192345]
    """
    y, x = _doubles(y), _doubles(x)
    with np.errstate(all="ignore"):
        return _values(np.where((x == 0) & (y == 0), 0.0, OPS.atan2(y, x)))


def arctan(x: ArrayLike) -> Array:
    """The arc tangent, in radians.

    >>> float(arctan(-1))
    -0.7853981633974483
    """
    return arctan2(_doubles(x), np.ones(np.shape(x)))


def arcsin(x: ArrayLike) -> Array:
    """The arc sine, in radians; nan beyond -1 and 1.

    >>> [float(angle) for angle in arcsin([-1, 0, 0.5, 1])]
    [-1.5707963267948966, 0.0, 0.5235987755982989, 1.5707963267948966]
    """
    x = _doubles(x)
    with np.errstate(invalid="ignore"):
        return arctan2(x, np.sqrt((1 - x) * (1 + x)))


def exp(x: ArrayLike) -> Array:
    """The exponential.

    >>> [float(value) for value in exp([-np.inf, 0, np.inf])]
    [0.0, 1.0, inf]
    """
    x = _doubles(x)
    with np.errstate(all="ignore"):
        far = np.abs(x) > WIDE
        value = OPS.exp(np.where(far, x / 2, x))
        return _values(np.where(far, value * value, value))


def log(x: ArrayLike) -> Array:
    """The natural logarithm: minus infinity at 0, nan below.

    >>> [float(value) for value in log([0, 1, np.e, np.inf])]
    [-inf, 0.0, 1.0, inf]
    """
    x = _doubles(x)
    with np.errstate(all="ignore"):
        small, finite = x < np.finfo(float).tiny, np.abs(x) < np.inf
        value = OPS.log(np.where(finite, np.where(small, np.ldexp(x, LIFT), x), 1.0))
        value = np.where(small, value - LIFT * functions.LOG_2, value)
        return _values(np.where(x == 0, -np.inf, np.where(finite, value, np.where(x > 0, x, np.nan))))


def root(x: ArrayLike, n: int) -> Array:
    """The `n`-th root of a number that is not negative.

    >>> float(root(8, 3))
    2.0
    """
    with np.errstate(all="ignore"):
        return _values(OPS.root(_doubles(x), n))


def sinh(x: ArrayLike) -> Array:
    """The hyperbolic sine, of arguments up to 708."""
    return _values(OPS.sinh(_doubles(x)))


def cosh(x: ArrayLike) -> Array:
    """The hyperbolic cosine, of arguments up to 708."""
    return _values(OPS.cosh(_doubles(x)))


def tanh(x: ArrayLike) -> Array:
    """The hyperbolic tangent."""
    return _values(OPS.tanh(_doubles(x)))


def _doubles(x: ArrayLike) -> Array:
    return np.asarray(x, dtype=np.float64)


def _values(x: Array) -> Array:
    """The array, or a plain NumPy number where it has no axes."""
    return np.asarray(x)[()]
