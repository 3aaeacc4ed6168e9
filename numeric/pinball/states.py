"""What `PinballMap` is asked and what it answers: input checked, one sentence for each mistake; results by the paper's
names, with units when they are labelled."""

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric.flights.family import Status

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Contraction = ArrayLike | str | Fraction


def real(name: str, given: ArrayLike) -> Array:
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
    array = array.astype(np.float64, copy=False)
    if array.size and not (np.isfinite(array.min()) and np.isfinite(array.max())):  # which say nan if there is one
        bad = array[~np.isfinite(array)].flat[0]
        raise ValueError(f"{name} contains {bad}; every value must be finite")
    return array


def angles(name: str, given: ArrayLike) -> Array:
    """An array of angles in radians."""
    return real(name, given)


def components(given: ArrayLike, names: Sequence[str]) -> NDArray[np.int64]:
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


def contraction(given: Contraction) -> Array:
    """The contraction `lam`, one number or one for each particle.

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
        raise ValueError("lam is empty; give one number in [0, 1], or one for each particle")
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


def counted(name: str, given: object, least: int = 1) -> int:
    """A whole number of bounces."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or given < least:
        raise ValueError(f"{name} = {given!r} is not possible; give a whole number of at least {least}")
    return int(given)


STATUSES = np.array(sorted(Status, key=lambda status: status.code), dtype=object)  # by their codes
UNITS = {"theta": "1", "phi": "rad", "eta": "rad", "x": "1", "y": "1", "nu_plus": "1/bounce", "nu_minus": "1/bounce"}
MEANINGS = {
    "component": "component of the boundary",
    "theta": "boundary parameter",
    "phi": "exit angle",
    "eta": "incidence angle",
    "code": "outcome, 0 for a regular bounce",
    "nu_plus": "larger Lyapunov exponent",
    "nu_minus": "smaller Lyapunov exponent",
    "bounces": "bounces made",
}


class Orbit(NamedTuple):
    """Bounces along the first axis, particles along the others; `eta[0]` is nan, since nothing landed there.

    A particle that stopped repeats its last good state; `status` says from which bounce on, and why.
    """

    component: NDArray[np.int64]
    theta: Array
    phi: Array
    eta: Array
    x: Array
    y: Array
    code: NDArray[np.int64]

    @property
    def status(self) -> Any:
        """The outcome at each bounce: a `Status`, or an array of them."""
        return STATUSES[self.code]

    def to_xarray(self) -> "xr.Dataset":
        """The fields with their units, as an xarray Dataset over `bounce` and `particle`.

        >>> from numeric import PinballMap
        >>> orbit = PinballMap("circle", lam=0.5).orbit([0.0, 1.0], 0.3, 4).to_xarray()
        >>> dict(orbit.sizes), orbit.phi.attrs["units"]
        ({'bounce': 5, 'particle': 2}, 'rad')
        """
        return labelled(self, ("bounce", "particle"))


class Exponents(NamedTuple):
    """Finite-time Lyapunov exponents per bounce, in the coordinates `(s, phi)`, and how far each particle came."""

    nu_plus: Array
    nu_minus: Array
    bounces: NDArray[np.int64]
    component: NDArray[np.int64]
    theta: Array
    phi: Array
    code: NDArray[np.int64]

    @property
    def status(self) -> Any:
        """The outcome of each particle: a `Status`, or an array of them."""
        return STATUSES[self.code]

    def to_xarray(self) -> "xr.Dataset":
        """The fields with their units, as an xarray Dataset over `particle`."""
        return labelled(self, ("particle",))


class Slap(NamedTuple):
    """Iterates of the slap map along the first axis, and its slope at the start."""

    component: NDArray[np.int64]
    theta: Array
    slope: Array
    code: NDArray[np.int64]

    def to_xarray(self) -> "xr.Dataset":
        """Iterates over `iterate` and `start`; `slope` over `start` alone."""
        return labelled(self, ("iterate", "start"))


def labelled(fields: Orbit | Exponents | Slap, axes: tuple[str, ...]) -> "xr.Dataset":
    """Named arrays as an xarray Dataset, particles in a row; an array with fewer axes than the others has the last."""
    try:
        import xarray
    except ImportError:
        raise ValueError(
            "to_xarray: xarray is missing; install it with: pip install 'pinball-billiards[sweep]'"
        ) from None
    arrays = {name: np.asarray(values) for name, values in fields._asdict().items()}
    whole = max(values.ndim for values in arrays.values())
    found = {}
    for name, values in arrays.items():
        all_axes = len(axes) > 1 and values.ndim == whole
        about = {"long_name": MEANINGS.get(name, name), "units": UNITS.get(name, "")}
        labels = {key: text for key, text in about.items() if text}
        flat = values.reshape(values.shape[0], -1) if all_axes else values.reshape(-1)
        found[name] = (axes if all_axes else axes[-1:], flat, labels)
    return xarray.Dataset(found)
