"""Functions that answer questions on a table: attractors, basins, exponents with errors, diagrams, parameter space.

A table is an exact one, a scene, a map, or the name of a table of the paper or of the gallery; `lam`, a reflection
`law` and the numbers of its shape are keywords. Numbers are exact or decimal, and a float means the decimal it shows.
Results have `.plot()`, and convert to xarray and pandas. Paper: section 4 to 6 and the appendix.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from numeric.dynamics.account import account
from numeric.dynamics.attractors import find
from numeric.dynamics.exponents import surveyed, with_families
from numeric.dynamics.recognition import Attractor
from numeric.pinball.map import PinballMap
from numeric.pinball.sampling import interior_starts
from numeric.pinball.states import counted, equal, html_table, many, plotted, shape_value
from numeric.sweeps import fields, space
from numeric.sweeps.run import in_memory
from numeric.sweeps.store import Memory
from numeric.sweeps.sweep import Array, Sweep, text_of
from numeric.sweeps.workers import cores
from symbolic.tables.scene import Law, Scene

if TYPE_CHECKING:
    import xarray as xr

Interval = tuple[Any, Any]


class Attractors(Sequence[Attractor]):
    """The attractors that `orbits` random starts of a map reach, the most visited first; their symmetry images follow.

    They are found by sampling: an attractor whose basin is below about `3/orbits` of the table is likely to be missed.
    """

    def __init__(self, map: PinballMap, found: Sequence[Attractor], orbits: int) -> None:
        self.map, self.found, self.orbits = map, tuple(found), orbits

    @overload
    def __getitem__(self, index: int) -> Attractor: ...
    @overload
    def __getitem__(self, index: slice) -> "tuple[Attractor, ...]": ...
    def __getitem__(self, index: int | slice) -> "Attractor | tuple[Attractor, ...]":
        return self.found[index]

    def __len__(self) -> int:
        return len(self.found)

    def __iter__(self) -> Iterator[Attractor]:
        return iter(self.found)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Attractors) and self.map.scene == other.map.scene and equal(self.found, other.found)

    __hash__ = None  # type: ignore[assignment]

    def plot(self, axes: Any = None) -> Any:
        """A Matplotlib figure of the attractors in the table and in phase space; on given `axes` only the latter."""
        return plotted("results.attractors", self.map, self.found, axes=axes)

    def _rows(self) -> list[tuple[str, ...]]:
        found: list[tuple[str, ...]] = []
        for one in self.found:
            found.append((one.name, str(one.share or ""), one.exponent, one.symmetry))
        return found

    def __repr__(self) -> str:
        told = "; ".join(f"{name}, {share} of the starts" for name, share, *_ in self._rows())
        return f"Attractors({len(self)} from {many(self.orbits, 'orbit')}: {told})"

    def _repr_html_(self) -> str:
        return html_table(("attractor", "share of the starts", "nu_plus", "symmetry"), self._rows())


@dataclass(frozen=True, eq=False)
class LyapunovExponents:
    """Both exponents per bounce of each attractor, with standard errors, as plain data: `document["groups"]`.

    If there is only one attractor, `nu_plus` and the other properties are its values; otherwise they are None, since
    nothing is averaged over attractors. Paper: appendix.
    """

    document: dict[str, Any]

    @property
    def groups(self) -> list[dict[str, Any]]:
        """The measured data of each attractor, the one that most orbits reach first."""
        found: list[dict[str, Any]] = self.document["groups"]
        return found

    @property
    def nu_plus(self) -> float | None:
        """The larger exponent."""
        return self._number("nu_plus")

    @property
    def nu_minus(self) -> float | None:
        """The smaller exponent."""
        return self._number("nu_minus")

    @property
    def nu_plus_error(self) -> float | None:
        """The standard error of `nu_plus`; 0 on a cycle, whose multipliers give the exponents."""
        return self._number("nu_plus_stderr")

    @property
    def nu_minus_error(self) -> float | None:
        """The standard error of `nu_minus`."""
        return self._number("nu_minus_stderr")

    def _number(self, name: str) -> float | None:
        value: float | None = self.document[name]
        return value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LyapunovExponents) and equal(self.document, other.document)

    __hash__ = None  # type: ignore[assignment]

    def plot(self, axes: Any = None) -> Any:
        """A Matplotlib figure of the exponents with twice their errors; without `axes` also of how the errors fell."""
        return plotted("results.exponents", self.document, axes=axes)

    def __repr__(self) -> str:
        told = "; ".join(f"{group['kind']}, {_measured(group)}" for group in self.groups)
        return f"LyapunovExponents({many(self.document['orbits'], 'orbit')}: {told})"

    def _repr_html_(self) -> str:
        rows = [(group["kind"], group["orbits"], _measured(group)) for group in self.groups]
        return html_table(("attractor", "orbits", "exponents per bounce"), rows)


def _measured(group: dict[str, Any]) -> str:
    both = (
        f"{name} = {group[name]:.6g} +- {group[f'{name}_stderr'] or 0:.1g}"
        for name in ("nu_plus", "nu_minus")
        if group[name] is not None
    )
    return ", ".join(both) or "no exponents"


@dataclass(frozen=True, eq=False, repr=False)
class GridResult:
    """The results on a grid: `arrays` by the names of the fields; `sweep` describes the grid."""

    sweep: Sweep
    arrays: dict[str, Array]
    picture: str  # the function of `verification.plots` that draws it

    def __getitem__(self, name: str) -> Array:
        return self.arrays[name] if name in self.arrays else self.sweep.axis[name].values

    def __eq__(self, other: object) -> bool:
        same = isinstance(other, GridResult) and self.sweep.attributes() == other.sweep.attributes()
        return same and equal(self.arrays, other.arrays)  # type: ignore[attr-defined]

    __hash__ = None  # type: ignore[assignment]

    def to_xarray(self) -> "xr.Dataset":
        """The fields with their units, as an xarray Dataset."""
        try:
            kept = Memory(self.sweep)
            kept.arrays = self.arrays
            return kept.dataset()
        except ImportError:
            raise ValueError(
                "to_xarray: xarray is missing; install it with: pip install '.[sweep]' in a checkout"
            ) from None

    def to_pandas(self) -> Any:
        """The fields as a pandas DataFrame over all cells of the grid."""
        return self.to_xarray().to_dataframe()

    def plot(self, axes: Any = None) -> Any:
        """A Matplotlib figure of the grid; on given `axes` its main panel alone."""
        return plotted(self.picture, self.to_xarray(), axes=axes)

    def __repr__(self) -> str:
        grid = " x ".join(f"{axis.size} {axis.name}" for axis in self.sweep.axes)
        return f"GridResult({self.sweep.about}: {', '.join(self.arrays)} over {grid})"


def attractors(
    table: Any,
    *,
    lam: Any = None,
    law: Law | str | None = None,
    orbits: int = 1000,
    seed: int = 1,
    transient: int = 1000,
    bounces: int = 4000,
    **shape: Any,
) -> Attractors:
    """The attractors that random starts reach, each with its share of the starts and its exponents. Paper: appendix.

    The first `transient` bounces do not count; the exponents of chaotic attractors are measured over `bounces`.

    >>> attractors("ellipse", a=2, lam="1/2", orbits=50)
    Attractors(1 from 50 orbits: period 2, 92.9% to 100.0% of the starts)
    """
    map, orbits = _one_map(table, lam, law, shape), counted("orbits", orbits)
    return Attractors(map, find(map, orbits, seed, transient, bounces, images=True), orbits)


def basins(
    table: Any,
    *,
    lam: Any = None,
    law: Law | str | None = None,
    columns: int = 360,
    rows: int = 240,
    orbits: int = 1000,
    seed: int = 1,
    transient: int = 1000,
    **shape: Any,
) -> GridResult:
    """The attractor that each start of a grid over phase space reaches. Paper: appendix.

    Attractors are first searched for from `orbits` random starts; `label` is -1 for a start that reaches none of them.

    >>> basins("ellipse", a=2, lam="1/2", columns=3, rows=2, orbits=20)["label"].tolist()
    [[0, 0, 0], [0, 0, 0]]
    """
    map = _one_map(table, lam, law, shape)
    columns, rows = counted("columns", columns), counted("rows", rows)
    scene, own = text_of(map.scene), float(map.lam)
    return _on_grid(
        fields.basins(scene, own, columns, rows, None, orbits, transient, seed, images=True), "grids.basins"
    )


def exponents(
    table: Any,
    *,
    lam: Any = None,
    law: Law | str | None = None,
    orbits: int = 100,
    bounces: int = 10_000,
    transient: int | None = None,
    seed: int = 1,
    **shape: Any,
) -> LyapunovExponents:
    """Both Lyapunov exponents per bounce with standard errors, for each attractor. Paper: appendix.

    >>> found = exponents("ellipse", a=2, lam="1/2", orbits=10, bounces=500)
    >>> round(found.nu_plus, 9), found.nu_plus_error  # log(1/2)/2
    (-0.34657359, 0.0)
    """
    map = _one_map(table, lam, law, shape)
    starts = interior_starts(map, counted("orbits", orbits, 2), seed)
    survey = surveyed(map, starts, counted("bounces", bounces, 10), bounces if transient is None else transient)
    return LyapunovExponents(account(map, with_families(map, survey)))


def bifurcation_diagram(
    table: Any,
    *,
    lam: Any = ("0", "1"),
    law: Law | str | None = None,
    values: int = 400,
    orbits: int = 20,
    points: int = 100,
    bounces: int = 2000,
    transient: int = 4000,
    seed: int = 1,
    **shape: Any,
) -> GridResult:
    """The phase points of random orbits after a long time, against the contraction or another parameter.

    Paper: section 6.6. One keyword is an interval: `lam=("0", "1")`, or a parameter of the table or law, as
    `b=("0", "1/5")` at one `lam`.

    >>> bifurcation_diagram("ellipse", a=2, lam=("0.3", "0.5"), values=3, orbits=2, points=4)
    GridResult(Attractors against the contraction, from 2 random particles each: s, phi, theta, component, nu_plus, \
nu_plus_error, chaotic over 3 lam x 2 orbit x 4 bounce)
    """
    given: dict[str, Any] = {"lam": lam, **shape}
    parameter, ends = _interval("bifurcation_diagram", given, table, law)
    scene, own = _scene_over(table, law, given, (parameter,))
    axis = np.linspace(*ends, counted("values", values, 2))
    sweep = fields.bifurcation(scene, axis, orbits, points, bounces, transient, seed, parameter, own)
    return _on_grid(sweep, "grids.bifurcation")


def parameter_space(
    table: Any,
    *,
    lam: Interval = ("0", "1"),
    law: Law | str | None = None,
    columns: int = 100,
    rows: int = 60,
    orbits: int = 20,
    bounces: int = 2000,
    transient: int = 2000,
    seed: int = 1,
    **shape: Any,
) -> GridResult:
    """Counts of chaotic orbits, and periods, over a parameter of the table or law and the contraction. Paper: section
    6.5.

    The parameter is given as an interval, such as `alpha=("0", "1/10")`.

    >>> found = parameter_space("egg", alpha=("0.02", "0.09"), lam=("0.1", "0.3"), columns=2, rows=2, orbits=3)
    >>> found["chaotic"].tolist()
    [[0, 0], [0, 3]]
    """
    parameter, ends = _interval("parameter_space", shape, table, law)
    first, last = _interval("parameter_space", {"lam": lam}, table, law)[1]
    scene, _ = _scene_over(table, law, {"lam": lam, **shape}, (parameter, "lam"))
    along, up = np.linspace(first, last, counted("columns", columns)), np.linspace(*ends, counted("rows", rows))
    sweep = space.parameter_space(up, along, orbits, bounces, transient, seed=seed, scene=scene, parameter=parameter)
    return _on_grid(sweep, "grids.parameter_space")


def _map(table: Any, lam: Any, law: Law | str | None, shape: dict[str, Any]) -> PinballMap:
    """The map of any kind of `table`; `lam`, `law` and `shape`, where given, replace those of a scene."""
    scene = table if isinstance(table, str) else getattr(table, "scene", table)
    if not isinstance(scene, Scene):
        return PinballMap(scene, lam=lam, law=law, **shape)
    numbers: dict[str, Any] = {name: shape_value(name, value) for name, value in shape.items()}
    changed = scene.at(law=law, **numbers) if numbers or law is not None else scene
    return PinballMap(changed, lam=lam)


def _one_map(table: Any, lam: Any, law: Law | str | None, shape: dict[str, Any]) -> PinballMap:
    map = _map(table, lam, law, shape)
    if map.lam.size > 1:
        raise ValueError(f"lam has {map.lam.size} values; give one contraction")
    return map


def _interval(
    question: str, given: dict[str, Any], table: Any, law: Law | str | None
) -> tuple[str, tuple[float, float]]:
    """The name of the one keyword that is an interval, and the ends of this interval."""
    varied = {name: value for name, value in given.items() if isinstance(value, tuple | list)}
    if len(varied) != 1:
        one_of_each = {name: value[0] if name in varied and value else value for name, value in given.items()}
        _map(table, one_of_each.pop("lam", None), law, one_of_each)  # refuses a keyword that is no parameter
        varies = f"{' and '.join(varied)} vary" if varied else "no keyword varies"
        raise ValueError(f"{question}: {varies}; accepted: one interval, as in lam=('0', '1')")
    (name,) = varied
    ends = given[name]
    low, high = (float(shape_value(name, end)) for end in ends) if len(ends) == 2 else (1.0, 0.0)
    if not low < high:
        raise ValueError(f"{question}: {name} = {ends!r} is no interval; accepted: two numbers, the smaller one first")
    return name, (low, high)


def _scene_over(table: Any, law: Law | str | None, given: dict[str, Any], varied: Sequence[str]) -> tuple[str, float]:
    """The text of the scene for a sweep, with the middle of each interval as its value; and its contraction."""
    middle = {name: (shape_value(name, given[name][0]) + shape_value(name, given[name][1])) / 2 for name in varied}
    numbers = {**given, **middle}
    map = _one_map(table, numbers.pop("lam"), law, numbers)
    scene = map.scene
    for name in varied:
        if name != "lam":  # all values share the kernels of one map
            scene = scene.spanning(name, *(shape_value(name, end) for end in given[name]))
    return text_of(scene), float(map.lam)


def _on_grid(sweep: Sweep, picture: str) -> GridResult:
    return GridResult(sweep, in_memory(sweep, cores()), picture)
