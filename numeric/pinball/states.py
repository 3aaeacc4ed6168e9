"""Checks the input of `PinballMap`, with a message for each mistake, and names its results as the paper does."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from fractions import Fraction
from functools import cached_property
from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric.flights.family import Status

if TYPE_CHECKING:
    import xarray as xr

    from numeric.pinball.map import PinballMap

Array = NDArray[np.float64]
Contraction = ArrayLike | str | Fraction


def real(name: str, given: ArrayLike) -> Array:
    """`given` as an array of finite doubles; otherwise `ValueError`, which begins with `name`."""
    present(name, given)
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


def present(name: str, given: object) -> None:
    """Raises `ValueError` if entries of a masked array are missing."""
    missing = int(np.sum(np.ma.getmaskarray(given))) if isinstance(given, np.ma.MaskedArray) else 0
    if missing:
        raise ValueError(f"{name} is a masked array with {missing} missing entries; leave them out")


def angles(name: str, given: ArrayLike) -> Array:
    """`given` as an array of finite angles in radians."""
    return real(name, given)


def components(given: ArrayLike, names: Sequence[str]) -> NDArray[np.int64]:
    """Component indices, from indices or from one name."""
    if isinstance(given, str):
        if given not in names:
            raise ValueError(f"no component is called {given!r}; the table has: {', '.join(names)}")
        return np.array(names.index(given))
    present("component", given)
    array = np.asarray(given)
    if array.dtype.kind not in "iu":
        raise ValueError(f"component has dtype {array.dtype}; give indices from 0 to {len(names) - 1}")
    if array.size and (array.min() < 0 or array.max() >= len(names)):
        wrong = array[(array < 0) | (array >= len(names))].flat[0]
        raise ValueError(f"component {wrong} does not exist; the table has 0 to {len(names) - 1}: {', '.join(names)}")
    return array.astype(np.int64)


def together(theta: Array, phi: Array, component: NDArray[np.int64]) -> tuple[Array, Array, NDArray[np.int64]]:
    """The three in one shape; `ValueError` where NumPy cannot broadcast them."""
    try:
        theta, phi, component = np.broadcast_arrays(theta, phi, component)
    except ValueError:
        shapes = f"theta has shape {theta.shape}, phi {phi.shape} and component {component.shape}"
        raise ValueError(f"{shapes}; give arrays of one shape, or one number for all particles") from None
    return theta, phi, component


def contraction(given: Contraction) -> Array:
    """The contraction `lam` as an array, of one number or one for each particle; `ValueError` outside of [0, 1].

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
    """A shape parameter as an exact number, in which `0.08` is 2/25; a float if it is another kind of number.

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
    """`given` as an integer; `ValueError` unless it is a whole number of at least `least`."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or given < least:
        raise ValueError(f"{name} = {given!r} is not possible; give a whole number of at least {least}")
    return int(given)


KEYS = ("component", "theta", "s", "x", "y", "eta", "phi", "status")  # of a bounce, where nothing else is asked for
STATUSES = np.array(sorted(Status, key=lambda status: status.code), dtype=object)  # by their codes
UNITS = {"theta": "1", "phi": "rad", "eta": "rad", "x": "1", "y": "1", "nu_plus": "1/bounce", "nu_minus": "1/bounce"}
UNITS |= {"nu_plus_error": "1/bounce", "nu_minus_error": "1/bounce"}
MEANINGS = {
    "component": "component of the boundary",
    "theta": "boundary parameter",
    "phi": "exit angle",
    "eta": "incidence angle",
    "code": "outcome, 0 for a regular bounce",
    "nu_plus": "larger Lyapunov exponent",
    "nu_minus": "smaller Lyapunov exponent",
    "nu_plus_error": "standard error of nu_plus",
    "nu_minus_error": "standard error of nu_minus",
    "bounces": "bounces made",
}


BLOCKS = 16  # blocks of a run whose growth rates give an error bar
SHOWN = 6  # rows of a table in a notebook


def equal(one: Any, other: Any) -> bool:
    """Are two results equal, array by array? A nan equals a nan.

    >>> equal((np.array([1.0, np.nan]), "a"), (np.array([1.0, np.nan]), "a"))
    True
    """
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        first, second = np.asarray(one), np.asarray(other)
        return bool(np.array_equal(first, second, equal_nan=first.dtype.kind == second.dtype.kind == "f"))
    if type(one) is not type(other):
        return False
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(equal(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(equal, one, other))
    if is_dataclass(one):
        return all(equal(getattr(one, field.name), getattr(other, field.name)) for field in fields(one))
    return bool(one == other or (one != one and other != other))


def plotted(kind: str, *results: Any, axes: Any = None) -> Any:
    """The figure `kind` as `verification.plots` draws it, on the given axes or on a new page."""
    return import_module("verification.plots.results").shown(kind, results, axes)


class ComparedByValues:
    """Equality of results that hold arrays: all their values are equal."""

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and equal(self, other)

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        raise TypeError(f"{type(self).__name__} holds arrays, which have no hash")


class Labelled(ComparedByValues):
    """The common part of all results: comparison, a one-line text, and conversion to xarray and pandas."""

    axes: ClassVar[tuple[str, ...]]

    def _columns(self) -> dict[str, Any]:
        """The columns of a table of the result, by name."""
        found: dict[str, Any] = self._asdict()  # type: ignore[attr-defined]
        return found

    def to_xarray(self) -> "xr.Dataset":
        """The fields with their units, as an xarray Dataset.

        >>> from numeric import PinballMap
        >>> orbit = PinballMap("circle", lam=0.5).orbit([0.0, 1.0], 0.3, 4).to_xarray()
        >>> dict(orbit.sizes), orbit.phi.attrs["units"]
        ({'bounce': 5, 'particle': 2}, 'rad')
        """
        return labelled(self._columns(), self.axes)

    def to_pandas(self) -> Any:
        """The fields as a pandas DataFrame: a row for each bounce, and for each particle where there are several."""
        return to_pandas(self._columns(), self.axes)

    def _repr_html_(self) -> str:
        columns = {name: np.asarray(values) for name, values in self._columns().items()}
        deep = max(values.ndim for values in columns.values())
        firsts = {name: x.reshape(len(x), -1)[:, 0] if deep > 1 and x.ndim > 1 else x for name, x in columns.items()}
        rows = [[f"{x[i]:.6g}" for x in firsts.values() if x.ndim and i < len(x)] for i in range(SHOWN)]
        head = [name for name, x in firsts.items() if x.ndim]
        return f"<p>{escape(repr(self))}</p>{html_table(head, filter(None, rows))}"


class OrbitFields(NamedTuple):
    """The fields of an `Orbit`."""

    component: NDArray[np.int64]
    theta: Array
    phi: Array
    eta: Array
    x: Array
    y: Array
    code: NDArray[np.int64]


class Orbit(Labelled, OrbitFields):
    """Bounces along the first axis, particles along the others; `eta[0]` is nan, since nothing landed there.

    A particle that stopped repeats its last good state; `status` shows from which bounce on, and why. An orbit of
    `PinballMap.orbit` has its `map`, so that it can be drawn: `orbit.plot()`.

    >>> from numeric import PinballMap
    >>> PinballMap("circle", lam=0.5).orbit([0.0, 1.0], 0.3, 4)
    Orbit(4 bounces of 2 particles)
    """

    axes = ("bounce", "particle")
    map: "PinballMap | None" = None

    @property
    def status(self) -> Any:
        """The outcome at each bounce: a `Status`, or an array of them."""
        return STATUSES[self.code]

    @property
    def flight(self) -> Array:
        """The length of the flight before each bounce; nan at the start, and from where a particle stops.

        >>> from numeric import PinballMap
        >>> PinballMap("circle").orbit(0, 0, 2).flight.round(12).tolist()
        [nan, 2.0, 2.0]
        """
        return self._flights()[0]

    @property
    def time(self) -> Array:
        """The length of all flights up to each bounce, which is the time at speed 1; 0 at the start."""
        return self._flights()[1]

    def _flights(self) -> tuple[Array, Array]:
        if self.map is None:
            raise ValueError("flight: the result of one step does not contain its start; take it from PinballMap.orbit")
        return flights(self.x, self.y, self.code)

    def plot(self, axes: Any = None) -> Any:
        """A Matplotlib figure of the flights in the table and the bounces in phase space; on given `axes` only flights.

        `orbit.plot().savefig("orbit.png")` writes it.
        """
        if self.map is None:
            raise ValueError(
                "orbit.plot: this orbit does not contain its table; accepted: orbits from PinballMap.orbit"
            )
        return plotted("results.flights", self, axes=axes)

    def __repr__(self) -> str:
        if self.map is None:
            if np.ndim(self.theta) == 0:
                named = zip(self._fields[:-1], self, strict=False)
                told = ", ".join(f"{name}={float(value):.6g}" for name, value in named)
                return f"Orbit({told}, {self.status.name.lower()})"
            return f"Orbit(one bounce of {many(np.size(self.theta), 'particle')})"
        stopped = int(np.count_nonzero(np.atleast_1d(self.code[-1])))
        which = f"{many(len(self.theta) - 1, 'bounce')} of {many(self.theta[0].size, 'particle')}"
        return f"Orbit({which}{f', {stopped} stopped' if stopped else ''})"


class ExponentFields(NamedTuple):
    """The fields of `Exponents`."""

    nu_plus: Array
    nu_minus: Array
    bounces: NDArray[np.int64]
    component: NDArray[np.int64]
    theta: Array
    phi: Array
    code: NDArray[np.int64]


class Exponents(Labelled, ExponentFields):
    """Finite-time Lyapunov exponents per bounce, in the coordinates `(s, phi)`, and the bounces each particle made.

    `nu_plus_error` and `nu_minus_error` are standard errors, from the scatter over 16 blocks of the same run, which is
    repeated when they are first read. They are too small if an orbit is correlated over more than a block.
    """

    axes = ("particle",)
    again: "Callable[[int], tuple[Array, Array]] | None" = None  # gives both errors from a number of blocks

    @property
    def status(self) -> Any:
        """The outcome of each particle: a `Status`, or an array of them."""
        return STATUSES[self.code]

    @cached_property
    def errors(self) -> tuple[Array, Array]:
        """The standard errors of both exponents; nan for a run of fewer than two bounces."""
        nothing = np.full(np.shape(self.nu_plus), np.nan)
        return (nothing, nothing) if self.again is None else self.again(BLOCKS)

    @property
    def nu_plus_error(self) -> Array:
        """The standard error of `nu_plus`, per bounce."""
        return self.errors[0]

    @property
    def nu_minus_error(self) -> Array:
        """The standard error of `nu_minus`, per bounce."""
        return self.errors[1]

    def _columns(self) -> dict[str, Any]:
        errors = {"nu_plus_error": self.nu_plus_error, "nu_minus_error": self.nu_minus_error}
        return self._asdict() | errors

    def __repr__(self) -> str:
        made = many(int(np.max(self.bounces, initial=0)), "bounce")
        if np.size(self.nu_plus) > 1:
            return f"Exponents({made} of {many(np.size(self.nu_plus), 'particle')})"
        both = ((name, getattr(self, name), getattr(self, f"{name}_error")) for name in ("nu_plus", "nu_minus"))
        told = ", ".join(f"{name} = {float(np.ravel(x)[0]):.6g} +- {float(np.ravel(e)[0]):.1g}" for name, x, e in both)
        return f"Exponents({told}, {made})"


class SlapFields(NamedTuple):
    """The fields of `Slap`."""

    component: NDArray[np.int64]
    theta: Array
    slope: Array
    code: NDArray[np.int64]


class Slap(Labelled, SlapFields):
    """Iterates of the slap map along the first axis, and its slope at the start."""

    axes = ("iterate", "start")

    def __repr__(self) -> str:
        return f"Slap({many(len(self.theta) - 1, 'iterate')} of {many(self.theta[0].size, 'start')})"


def flights(x: Array, y: Array, code: NDArray[np.int64]) -> tuple[Array, Array]:
    """The length of the flight before each bounce, and of all up to it, along the first axis of the arrays.

    Both are nan from where a particle stops. At the start the first is nan and the second 0.

    >>> lengths, times = flights(np.array([0.0, 3.0, 3.0]), np.array([0.0, 4.0, 5.0]), np.array([0, 0, 0]))
    >>> lengths.tolist(), times.tolist()
    ([nan, 5.0, 1.0], [0.0, 5.0, 6.0])
    """
    lengths = np.full(np.shape(x), np.nan)
    lengths[1:] = np.where(code[1:] == 0, np.hypot(np.diff(x, axis=0), np.diff(y, axis=0)), np.nan)
    times = lengths.copy()
    times[0] = 0
    return lengths, np.cumsum(times, axis=0)


def many(count: int, word: str) -> str:
    """A number of things in words, as in `2 bounces`.

    >>> many(1, "bounce"), many(2, "bounce")
    ('1 bounce', '2 bounces')
    """
    return f"{count:,} {word}{'s' * (count != 1)}"


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in HTML, as notebooks show it.

    >>> html_table(["lam"], [[0.5]])
    '<table><tr><th>lam</th></tr><tr><td>0.5</td></tr></table>'
    """
    lines = [("th", head), *(("td", row) for row in rows)]
    cells = ("".join(f"<{tag}>{escape(str(cell))}</{tag}>" for cell in line) for tag, line in lines)
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in cells)}</table>"


def labelled(columns: Mapping[str, Any], axes: tuple[str, ...]) -> "xr.Dataset":
    """Named arrays as an xarray Dataset, with particles on one axis; an array with fewer axes lacks the first ones."""
    try:
        import xarray
    except ImportError:
        raise ValueError(
            "to_xarray: xarray is missing; install it with: pip install '.[sweep]' in a checkout"
        ) from None
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    whole = max(values.ndim for values in arrays.values())
    found = {}
    for name, values in arrays.items():
        all_axes = len(axes) > 1 and values.ndim == whole
        about = {"long_name": MEANINGS.get(name, name), "units": UNITS.get(name, "")}
        labels = {key: text for key, text in about.items() if text}
        flat = values.reshape(values.shape[0], -1) if all_axes else values.reshape(-1)
        found[name] = (axes if all_axes else axes[-1:], flat, labels)
    return xarray.Dataset(found)


def to_pandas(columns: Mapping[str, Any], axes: tuple[str, ...]) -> Any:
    """Named arrays as a pandas DataFrame; its index has the axes that are longer than one."""
    try:
        pandas: Any = import_module("pandas")
    except ImportError:
        raise ValueError("to_pandas: pandas is missing; install it with: pip install pandas") from None
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    deep = max(arrays.values(), key=lambda values: values.ndim)
    shape = (len(deep), deep[0].size) if len(axes) > 1 and deep.ndim else (deep.size,)
    columns = {
        name: np.broadcast_to(x.reshape(shape) if x.size == deep.size else x.reshape(shape[1:]), shape).ravel()
        for name, x in arrays.items()
    }
    places = {axis: index.ravel() for axis, index in zip(axes, np.indices(shape), strict=False)}
    kept = [axis for axis, size in zip(axes, shape, strict=False) if size > 1] or [axes[0]]
    return pandas.DataFrame({**{axis: places[axis] for axis in kept}, **columns}).set_index(kept)
