"""Sweeps: named axes, the fields measured over them, and one task for each part of the grid.

A scene is a line of text, which labels results and is sent to other machines.

The sign of a finite-time Lyapunov exponent is decided by its error. A run is cut into blocks, and the scatter of the
growth over the blocks gives the standard error of the mean. Two other effects can make a regular orbit look chaotic.
First, on an elliptic or a neutral orbit vectors grow like the number of bounces, so that `B` bounces give an exponent
of `log(B)/B`; so an exponent counts as positive only above twice this value. Second, an orbit may be in a chaotic
transient. Then the growth falls in late blocks, which the scatter shows, unless the transient is longer than the run.
"""

import itertools
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from numeric import PinballMap
from numeric.backends import elementary
from numeric.pinball.sampling import Growth, Starts, interior_starts
from symbolic.tables.scene import Scene

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Axis:
    """A dimension of the grid and its coordinates. A task takes `part` of them at a time, or all if `part` is 0."""

    name: str
    values: Array
    units: str
    about: str
    part: int = 0

    @property
    def size(self) -> int:
        """The number of values."""
        return len(self.values)

    @property
    def length(self) -> int:
        """The number of values that a task takes at a time."""
        return self.part or self.size


class Field(NamedTuple):
    """A quantity on some of the axes; these include all axes that are cut into parts."""

    name: str
    dims: tuple[str, ...]
    dtype: str
    units: str
    about: str


class SweepPart(NamedTuple):
    """One task's share of the grid: its index, the coordinates there, and a seed that no other part has."""

    at: tuple[int, ...]
    values: Mapping[str, Array]
    seed: int


Task = Callable[[SweepPart], dict[str, Array]]


@dataclass(frozen=True, eq=False)
class Sweep:
    """A grid of independent tasks. `task` can be sent to another machine, where it needs only its part.

    The results also depend on `settings` and `scene`; `collisions` is the number of bounces of the whole sweep, and
    `map` makes the map on which their speed is measured. If `python` is true, a task is mostly Python and not a kernel,
    and is done in processes, since threads would wait for one another.
    """

    name: str
    about: str
    axes: tuple[Axis, ...]
    fields: tuple[Field, ...]
    task: Task
    seed: int
    scene: str
    settings: Mapping[str, Any]
    collisions: int
    map: Callable[[], PinballMap]
    python: bool = False

    def __post_init__(self) -> None:
        cut = [axis.name for axis in self.axes if axis.length < axis.size]
        for field in self.fields:
            if not set(cut) <= set(field.dims):
                raise ValueError(f"{field.name} has the axes {field.dims}; accepted: all axes cut into parts, {cut}")

    @cached_property
    def axis(self) -> dict[str, Axis]:
        """The axes by name."""
        return {axis.name: axis for axis in self.axes}

    def indices(self) -> list[tuple[int, ...]]:
        """The indices of the parts along each axis, in order."""
        return list(itertools.product(*(range(-(-axis.size // axis.length)) for axis in self.axes)))

    def part(self, index: tuple[int, ...]) -> SweepPart:
        """The part at `index`."""
        values = {axis.name: axis.values[self.within(axis.name, i)] for axis, i in zip(self.axes, index, strict=True)}
        return SweepPart(index, values, seed_of(self.seed, index))

    def within(self, name: str, i: int) -> slice:
        """The slice of an axis in its part `i`."""
        length = self.axis[name].length
        return slice(i * length, min((i + 1) * length, self.axis[name].size))

    def where(self, field: Field, index: tuple[int, ...]) -> tuple[slice, ...]:
        """The slices of a field's array that a part fills."""
        at = dict(zip(self.axis, index, strict=True))
        return tuple(self.within(name, at[name]) for name in field.dims)

    def shape(self, field: Field) -> tuple[int, ...]:
        """The shape of a field's array."""
        return tuple(self.axis[name].size for name in field.dims)

    @property
    def size(self) -> int:
        """Bytes of all fields and coordinates, before compression."""
        fields = sum(prod(self.shape(field)) * np.dtype(field.dtype).itemsize for field in self.fields)
        return fields + sum(axis.values.nbytes for axis in self.axes)

    def attributes(self) -> dict[str, Any]:
        """The labels of the results: scene, seed, settings and versions."""
        return {
            "sweep": self.name,
            "scene": self.scene,
            "seed": self.seed,
            "settings": json.dumps(dict(self.settings), sort_keys=True),
            "versions": json.dumps(versions(), sort_keys=True),
            "grid": self.grid(),
            "title": self.about,
        }

    def grid(self) -> str:
        """A digest of the axes and of how they are cut."""
        digest = sha256()
        for axis in self.axes:
            digest.update(f"{axis.name} {axis.length} {axis.values.dtype} ".encode() + axis.values.tobytes())
        return digest.hexdigest()


def seed_of(seed: int, index: tuple[int, ...]) -> int:
    """A seed for one part of a sweep, independent of the seeds of all others.

    >>> seed_of(1, (0, 2)) == seed_of(1, (0, 2)), seed_of(1, (0, 2)) == seed_of(1, (2, 0))
    (True, False)
    """
    words = np.random.SeedSequence(seed, spawn_key=index).generate_state(2, np.uint64)
    return int(words[0]) << 64 | int(words[1])


def versions() -> dict[str, str]:
    """The versions of the packages that may affect the last bits of results."""
    found = {}
    for name in ("pinball-billiards", "numpy", "scipy", "llvmlite"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "unknown"
    return found


def missing_value(dtype: str) -> float:
    """The value where nothing was measured: nan, or -1 for whole numbers."""
    return np.nan if np.dtype(dtype).kind == "f" else -1


KEPT = 16  # maps


def text_of(scene: Scene) -> str:
    """The scene's text for a sweep: at `lam = 1`, since the contraction is an axis of the sweep.

    For a law other than the paper's `lam` is unchanged, since at `lam = 1` such a law may lead out of the table.

    >>> text_of(Scene("egg", alpha="2/25", lam="1/2"))
    'scene = { table = "egg", shape = { alpha = "2/25" }, lam = "1" }'
    """
    return (scene.at(lam=1) if scene.law.uniform else scene).text


def map_of(text: str, lam: ArrayLike) -> PinballMap:
    """The map of a scene written by `text_of`, with a contraction, or one for each particle.

    >>> map_of(text_of(Scene("ellipse", a=2)), 0.5).law
    'pinball'
    """
    return _elastic(text).at(lam)


def spread(text: str, lams: Array, each: int, seed: int) -> tuple[PinballMap, Starts]:
    """Particles of one scene at several contractions: `each` random starts for each `lam`, one `lam` after the other.

    >>> map, starts = spread(text_of(Scene("circle")), np.array([0.0, 0.5]), 3, seed=1)
    >>> map.lam.tolist(), starts.theta.size
    ([0.0, 0.0, 0.0, 0.5, 0.5, 0.5], 6)
    """
    return map_of(text, np.repeat(lams, each)), interior_starts(_elastic(text), len(lams) * each, seed)


def at_value(text: str, parameter: str, value: float) -> str:
    """The scene's text with another value of a parameter, as a decimal, limited to the range of the parameter.

    >>> at_value(text_of(Scene("egg", alpha="2/25")), "alpha", 0.05)
    'scene = { table = "egg", shape = { alpha = "1/20" }, lam = "1" }'
    """
    scene, shown = Scene.parse(text), Fraction(repr(float(value)))
    low, high = scene.ranges.get(parameter, (shown, shown))  # an end of a range may have no decimal
    number: dict[str, Any] = {parameter: low if shown < low else high if shown > high else shown}
    return scene.at(**number).text


def spread_over(
    text: str, parameter: str, values: Array, lam: float, each: int, seed: int
) -> Iterator[tuple[str, PinballMap, Starts]]:
    """Random starts of one scene at several values of a parameter, with the map and the scene's text at these values.

    Contractions come all at once in one map; shapes come one after the other.
    """
    if parameter == "lam":
        yield text, *spread(text, values, each, seed)
        return
    for value, own in zip(values, np.random.default_rng(seed).integers(0, 2**63, len(values)), strict=True):
        here = at_value(text, parameter, value)
        yield here, *spread(here, np.array([lam]), each, int(own))


def against(parameter: str, fields: Iterable[Field]) -> tuple[Field, ...]:
    """The fields, each with the axis of the varied parameter before its own axes."""
    return tuple(field._replace(dims=(parameter, *field.dims)) for field in fields)


def parameter_axis(parameter: str, values: Array, part: int) -> Axis:
    """The axis of the varied parameter; a task takes `part` contractions at a time, or one shape."""
    about, part = ("contraction", part) if parameter == "lam" else ("parameter of the scene", 1)
    return Axis(parameter, np.asarray(values, dtype=np.float64), "1", about, part)


def said(parameter: str) -> str:
    """The name of a varied parameter in words."""
    return "the contraction" if parameter == "lam" else parameter


def fixed(parameter: str, lam: float) -> dict[str, Any]:
    """The contraction as a label of the results, if another parameter is varied; empty if `lam` itself is varied."""
    return {} if parameter == "lam" else {"lam": lam}


@lru_cache(KEPT)
def _elastic(text: str) -> PinballMap:
    return PinballMap(Scene.parse(text))


BLOCKS = 4  # too few for a fine error, and enough to see a transient end
SIGMAS = 2.0  # standard errors by which an exponent is beyond the floor


class OrbitExponents(NamedTuple):
    """Exponents of orbits, as means over blocks with standard errors; their last phase points, and status codes."""

    nu_plus: Array
    nu_minus: Array
    nu_plus_error: Array
    nu_minus_error: Array
    floor: float
    end: Starts
    code: NDArray[np.int64]

    @property
    def chaotic(self) -> NDArray[np.bool_]:
        """The mask of orbits whose exponent exceeds the floor by `SIGMAS` standard errors: these count as chaotic."""
        return np.asarray((self.code == 0) & (self.nu_plus - SIGMAS * self.nu_plus_error > self.floor))

    @property
    def regular(self) -> NDArray[np.bool_]:
        """The mask of orbits with an exponent not above the floor. Those neither chaotic nor regular are undecided."""
        return np.asarray((self.code == 0) & (self.nu_plus <= self.floor))

    def ended(self, which: NDArray[np.int64]) -> Starts:
        """The ends of some of the orbits, as starts from which they can go on."""
        return self.end.only(which)


def floor_of(bounces: int) -> float:
    """The exponent below which a run of `bounces` bounces cannot distinguish exponential growth from shear.

    >>> round(floor_of(1000), 4)
    0.0138
    """
    return float(2 * elementary.log(bounces) / bounces)


def measured(
    map: PinballMap, starts: Starts, bounces: int, transient: int, threads: int | None = None
) -> OrbitExponents:
    """The exponents of particles over `bounces` bounces in `BLOCKS` blocks, after `transient` further ones before them.

    >>> circle = PinballMap("circle", lam=1)
    >>> from numeric.pinball.sampling import phase_starts
    >>> found = measured(circle, phase_starts(circle, 8, seed=0), 2000, 0)
    >>> bool(found.chaotic.any()), bool(found.regular.all())
    (False, True)
    """
    growth = Growth(map, starts.theta, starts.phi, starts.component)
    growth.settle(transient, threads)
    return counted(growth, bounces, threads)


def counted(growth: Growth, bounces: int, threads: int | None = None) -> OrbitExponents:
    """The exponents over `bounces` bounces of particles after `Growth.settle`; `ValueError` for too few bounces."""
    block = bounces // BLOCKS
    if block < 2:
        raise ValueError(f"bounces = {bounces} is too few for {BLOCKS} blocks; give at least {2 * BLOCKS}")
    map, reached = growth.map, growth.advance_blocks([block] * BLOCKS, threads)
    with np.errstate(divide="ignore", invalid="ignore"):  # at lam = 0 areas vanish
        plus, volume = np.diff(reached, axis=1) / block
        minus = volume + growth.contraction - plus
        means = [(x.mean(axis=0), x.std(axis=0, ddof=1) / BLOCKS**0.5) for x in (plus, minus)]
    end = Starts(growth.component, growth.theta, growth.phi, *map.states.point(growth.component, growth.theta))
    (nu_plus, nu_plus_error), (nu_minus, nu_minus_error) = means
    return OrbitExponents(nu_plus, nu_minus, nu_plus_error, nu_minus_error, floor_of(block * BLOCKS), end, growth.code)
