"""What `PinballMap` answers with: arrays under the paper's names, with units when they are labelled."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.flights.status import Status

Array = NDArray[np.float64]
STATUSES = np.array(sorted(Status, key=lambda status: status.code), dtype=object)
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
    """Bounces along the first axis, balls along the others; `eta[0]` is nan, since nothing landed there.

    A ball that stopped repeats its last good state; `status` says from which bounce on, and why.
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

    def to_xarray(self) -> Any:
        """The fields with their units, as an xarray Dataset over `bounce` and `ball`.

        >>> from numeric import PinballMap
        >>> orbit = PinballMap("circle", lam=0.5).orbit([0.0, 1.0], 0.3, 4).to_xarray()
        >>> dict(orbit.sizes), orbit.phi.attrs["units"]
        ({'bounce': 5, 'ball': 2}, 'rad')
        """
        return labelled(self, ("bounce", "ball"))


class Exponents(NamedTuple):
    """Finite-time Lyapunov exponents per bounce, in the coordinates `(s, phi)`, and how far each ball came."""

    nu_plus: Array
    nu_minus: Array
    bounces: NDArray[np.int64]
    component: NDArray[np.int64]
    theta: Array
    phi: Array
    code: NDArray[np.int64]

    @property
    def status(self) -> Any:
        """The outcome of each ball: a `Status`, or an array of them."""
        return STATUSES[self.code]

    def to_xarray(self) -> Any:
        """The fields with their units, as an xarray Dataset over `ball`."""
        return labelled(self, ("ball",))


class Slap(NamedTuple):
    """Iterates of the slap map along the first axis, and its slope at the start."""

    component: NDArray[np.int64]
    theta: Array
    slope: Array
    code: NDArray[np.int64]

    def to_xarray(self) -> Any:
        """Iterates over `iterate` and `start`; `slope` over `start` alone."""
        return labelled(self, ("iterate", "start"))


def labelled(fields: Any, axes: tuple[str, ...]) -> Any:
    """Named arrays as an xarray Dataset, balls in a row; an array with fewer axes than the others has the last one."""
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
