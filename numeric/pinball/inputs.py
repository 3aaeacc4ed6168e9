"""What users type, checked: one sentence for each mistake."""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def real(name: str, given: Any) -> Array:
    """An array of finite doubles."""
    try:
        array = np.asarray(given)
    except ValueError as reason:
        raise ValueError(f"{name} is no array of numbers: {reason}") from None
    if array.dtype == object:
        try:
            array = array.astype(float)
        except (TypeError, ValueError):
            raise ValueError(f"{name} = {given!r} is not a number or an array of numbers") from None
    if array.dtype.kind not in "iuf" or array.dtype.itemsize > 8:
        raise ValueError(f"{name} has dtype {array.dtype}; give real numbers that fit float64")
    array = array.astype(np.float64)
    if not np.all(np.isfinite(array)):
        bad = array[~np.isfinite(array)].flat[0]
        raise ValueError(f"{name} contains {bad}; every value must be finite")
    return array


def angles(name: str, given: Any) -> Array:
    """An array of angles in radians."""
    return real(name, given)


def components(given: Any, names: Sequence[str]) -> NDArray[np.int64]:
    """Component indices, from indices or from one name."""
    if isinstance(given, str):
        if given not in names:
            raise ValueError(f"no component is called {given!r}; the table has: {', '.join(names)}")
        return np.array(names.index(given))
    array = np.asarray(given)
    if array.dtype.kind not in "iu":
        raise ValueError(f"component has dtype {array.dtype}; give indices from 0 to {len(names) - 1}")
    if array.size and (array.min() < 0 or array.max() >= len(names)):
        wrong = array[(array < 0) | (array >= len(names))].flat[0]
        raise ValueError(f"component {wrong} does not exist; the table has 0 to {len(names) - 1}: {', '.join(names)}")
    return array.astype(np.int64)


def contraction(given: Any) -> Array:
    """The contraction `lam`, one number or one for each ball.

    >>> float(contraction("1/4"))
    0.25
    """
    if isinstance(given, str | Fraction):
        try:
            given = float(Fraction(given))
        except (ValueError, ZeroDivisionError):
            raise ValueError(f"lam = {given!r} is no number such as 9/10 or 0.9") from None
    array = real("lam", given)
    if array.size == 0:
        raise ValueError("lam is empty; give one number in [0, 1], or one for each ball")
    wrong = (array < 0) | (array > 1)
    if np.any(wrong):
        raise ValueError(f"lam = {array[wrong].flat[0]} is no contraction; lam must lie in [0, 1]")
    return array


def shape_value(label: str, given: Any) -> Fraction | float:
    """A shape parameter as the number it shows: `0.08` is 2/25.

    >>> shape_value("alpha", 0.08)
    Fraction(2, 25)
    """
    if isinstance(given, bool):
        raise ValueError(f"{label} = {given} is no number")
    try:
        if isinstance(given, str | int | Fraction):
            return Fraction(given)
        if isinstance(given, float):
            return Fraction(repr(float(given)))
        if getattr(given, "is_Rational", False):
            return Fraction(int(given.p), int(given.q))
        value = float(given)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        raise ValueError(f"{label} = {given!r} is no number such as 2/25 or 0.08") from None
    return value


def counted(name: str, given: Any, least: int = 1) -> int:
    """A whole number of bounces."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or given < least:
        raise ValueError(f"{name} = {given!r} is not possible; give a whole number of at least {least}")
    return int(given)
