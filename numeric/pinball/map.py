"""`PinballMap`: a table with its shape and contraction, with methods for steps, orbits, derivatives and exponents."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from numeric.flights.family import FORMULA, NEAR, PINBALL, SLAP, Boundary, law_of
from numeric.flights.registry import family_of
from numeric.kernels.engine import Engine
from numeric.kernels.machine import MATRIX, TOLD, KernelSpec, starting
from numeric.lowering.cache import key_of
from numeric.lowering.program import Named, TableIR, TableSymmetry, by_name, symmetries, table_ir, table_ir_in_unit
from numeric.pinball.coordinates import States
from numeric.pinball.orbits import PIECE, OrbitRun, SingleBounce, derivatives, lowered_law
from numeric.pinball.sampling import Growth
from numeric.pinball.states import (
    Contraction,
    Exponents,
    Orbit,
    Slap,
    angles,
    components,
    contraction,
    counted,
    real,
    shape_value,
    together,
)
from numeric.pinball.unit import ONE, unit_of
from symbolic.tables.scene import GALLERY, Law, Scene, given_table, no_parameter

if TYPE_CHECKING:
    from numeric.pinball.coordinates import ArcLength
    from symbolic.tables.table import Table

Array = NDArray[np.float64]
ROUNDED = 2.0**-48  # of a component's range


class PinballMap:
    """The map `T_lambda` of a table; without `lam` it is elastic, `lam = 1`. Paper: section 2.

    `lam` is one number or one for each particle, and replaces that of a scene. `table` is a scene or another map, which
    determine everything, or an exact table, or a name of the paper or of `tables.GALLERY`. For these, shape parameters
    and lengths are keywords, exact or decimal: `0.08`, as text or float, means 2/25. `law` is a law other than the
    paper's, with numbers for its parameters. With `kernels=False` the same steps run on NumPy arrays.

    >>> ellipse = PinballMap("ellipse", lam=1, a=2)
    >>> step = ellipse.step(theta=0.0, phi=0.0)  # along the long axis
    >>> round(float(step.x), 12), round(float(step.phi), 12) + 0.0
    (-2.0, 0.0)
    """

    def __init__(
        self,
        table: "PinballMap | Scene | Table | Named | str | Any",  # or a function that makes a table
        lam: Contraction | None = None,
        K: int = 3,
        kernels: bool = True,
        law: Law | str | None = None,
        **shape: Any,
    ) -> None:
        table = table.scene if isinstance(table, PinballMap) else table
        if not isinstance(table, str | Scene | Named):
            table, shape = given_table(table, K, shape)
        proved = isinstance(table, Scene) and lam is None  # a scene has checked its law already
        self._contraction: Any = table.lam if isinstance(table, Scene) and lam is None else 1 if lam is None else lam
        if isinstance(table, Scene):
            law, (table, lam, K, shape) = table.law, _unpacked(table, lam, shape)
        elif isinstance(table, str) and table in GALLERY:
            table, shape = by_name(table, shape), {}
        self.reflection = law if isinstance(law, Law) else Law() if law is None else Law(law)
        self.ir: TableIR = table_ir(table, K)
        self.lam = contraction(1 if lam is None else lam)
        self._singles: dict[tuple[str, ...], SingleBounce] = {}
        self._given = table, K
        self.exact_shape = self._shape(shape)
        names = [entry.name for entry in self.ir.shape]
        if names and not isinstance(table, str | Scene | Named):
            from numeric.lowering.lower import proved_throughout

            _ = proved_throughout(table) or self.table  # which proves that the boundary bounds a table
        boundary = Boundary(self.ir, [float(value) for value in self.exact_shape])
        self.unit = unit_of(boundary)
        if self.unit != ONE:  # computations are done there, and results are converted back
            numbers = dict(zip(names, self.exact_shape, strict=True))
            x, y, z = map(Fraction, self.unit)
            names, boundary = [], Boundary(table_ir_in_unit(table, K, numbers, (x, y, z)), [])
        self.shape = boundary.shape
        self.family = family_of(boundary)
        self.family.unit = self.unit.length
        self.states = States(self.family, self.unit)
        if not self.reflection.uniform:
            if not proved:
                self._check_law()
            self.family.formula = lowered_law(self)
        own = [str(part) for part in self.family.formula or ()] + [repr(self.unit)] * (self.unit != ONE)
        self.engine = Engine(self.family, key_of(boundary.ir.as_text(), self.family.identity, *own), names, kernels)

    @cached_property
    def table(self) -> "Table":
        """The exact table, with the numbers of its shape."""
        from numeric.lowering.lower import exact_table

        names = [entry.name for entry in self.ir.shape]
        return exact_table(*self._given, dict(zip(names, self.exact_shape, strict=True)))

    @property
    def scene(self) -> Scene:
        """The exact scene of the map, in which a float is the decimal that it shows.

        >>> PinballMap("egg", lam=0.5, alpha=0.08).scene
        Scene('egg', alpha='2/25', lam='1/2')
        """
        if self.lam.size > 1:
            raise ValueError(f"lam has {self.lam.size} values; a scene has one contraction, so take map.at(lam) first")
        (table, K), given = self._given, self._contraction
        lam: Any = given if isinstance(given, str | int | Fraction) else shape_value("lam", given)
        if isinstance(lam, float):  # of an array, or of an irrational number
            lam = given if hasattr(given, "is_real") else shape_value("lam", float(given))
        numbers: dict[str, Any] = {}
        for entry, value in zip(self.ir.shape, self.exact_shape, strict=True):
            if isinstance(value, float):
                raise ValueError(f"{self.ir.table}: {entry.name} = {value} is not exact; make the map of a Scene")
            numbers[entry.name] = value
        if isinstance(table, Scene):
            return table.at(lam=lam, law=None if self.reflection == table.law else self.reflection, **numbers)
        own: Any = self.table if isinstance(table, Named) else table
        return Scene(own, lam=lam, law=self.reflection, K=K, **numbers)

    def __repr__(self) -> str:
        try:
            return repr(self.scene).replace("Scene", "PinballMap", 1)
        except ValueError:
            return f"PinballMap({self.ir.table!r}, lam={'...' if self.lam.size > 1 else float(self.lam.flat[0])})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PinballMap) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    @property
    def path(self) -> str:
        """The method by which flights are computed on this table, in words."""
        return self.family.path

    @property
    def law(self) -> str:
        """`slap`, `elastic` or `pinball`, or `formula`: the reflection for which kernels are made."""
        if not self.reflection.uniform:
            return FORMULA
        return law_of(float(np.min(self.lam)), float(np.max(self.lam)))

    @cached_property
    def symmetries(self) -> tuple[TableSymmetry, ...]:
        """The proved symmetries of the table, the identity first."""
        return symmetries(*self._given, dict(zip((s.name for s in self.ir.shape), self.exact_shape, strict=True)))

    @cached_property
    def arclength(self) -> "ArcLength":
        """Arc length and its inverse, on every component."""
        from numeric.pinball.coordinates import ArcLength

        return ArcLength(self.states)

    # ---- questions

    def step(self, theta: ArrayLike, phi: ArrayLike = 0.0, component: ArrayLike = 0) -> Orbit:
        """One bounce of each particle, as an `Orbit` whose fields have the shape of the arguments."""
        if self.unit == ONE and (told := self._single(TOLD).told(theta, phi, component)) is not None:
            where, *rest = told if len(told) == len(TOLD) else (0, *told)
            return Orbit(*(np.asarray(where, np.int64)[()], *np.array(rest), np.int64(0)))
        run = OrbitRun(self, theta, phi, component, Orbit._fields)
        return Orbit(**{name: rows[0].reshape(run.shape) for name, rows in run.advance(1, threads=None).items()})

    @overload
    def orbit(
        self, theta: ArrayLike, phi: ArrayLike, bounces: int, component: ArrayLike = 0, threads: int | None = None
    ) -> Orbit: ...

    @overload
    def orbit(
        self,
        theta: ArrayLike,
        phi: ArrayLike,
        bounces: int,
        component: ArrayLike = 0,
        threads: int | None = None,
        *,
        fields: Sequence[str],
        every: int = 1,
        dtype: DTypeLike = np.float64,
    ) -> dict[str, NDArray[Any]]: ...

    def orbit(
        self,
        theta: ArrayLike,
        phi: ArrayLike,
        bounces: int,
        component: ArrayLike = 0,
        threads: int | None = None,
        *,
        fields: Sequence[str] | None = None,
        every: int = 1,
        dtype: DTypeLike = np.float64,
    ) -> "Orbit | dict[str, NDArray[Any]]":
        """The orbit of each particle: the start and `bounces` bounces after it.

        If `fields` are given, names of an `Orbit`'s fields or `s` for arc length, only these are computed, for every
        `every`-th bounce, as float64 or float32, and returned as a dict of arrays.

        >>> told = PinballMap("ellipse", lam=0.5, a=2).orbit([0.1, 0.2], 0.3, 6, fields=("phi", "s"), every=3)
        >>> {name: rows.shape for name, rows in told.items()}
        {'phi': (3, 2), 's': (3, 2)}
        """
        run = OrbitRun(self, theta, phi, component, Orbit._fields if fields is None else fields, every, dtype)
        told = run.advance(counted("bounces", bounces), begin=True, threads=threads)
        found = {name: rows.reshape(len(rows), *run.shape) for name, rows in told.items()}
        if fields is not None:
            return found
        orbit = Orbit(**found)
        orbit.map = self
        return orbit

    def orbit_pieces(
        self,
        theta: ArrayLike,
        phi: ArrayLike,
        bounces: int,
        component: ArrayLike = 0,
        threads: int | None = None,
        *,
        fields: Sequence[str] = ("theta", "phi"),
        every: int = 1,
        dtype: DTypeLike = np.float64,
        piece: int = PIECE,
    ) -> Iterator[dict[str, NDArray[Any]]]:
        """`orbit` in pieces of at most `piece` numbers to a field, for orbits that do not fit in memory.

        The first piece begins with the start; joined, the pieces are what `orbit` gives, to the last bit.

        >>> pieces = PinballMap("egg", lam=0.5, alpha=0.08).orbit_pieces(0.3, 0.2, 100, fields=("theta",), piece=40)
        >>> [len(rows["theta"]) for rows in pieces]
        [41, 40, 20]
        """
        run = OrbitRun(self, theta, phi, component, fields, every, dtype, keep=True)
        rows = counted("bounces", bounces) // run.every
        most = max(1, counted("piece", piece) // run.theta.size)
        for done in range(0, max(rows, 1), most):
            part = min(most, rows - done) * run.every
            told = run.advance(part, begin=done == 0, threads=threads)
            yield {name: found.reshape(len(found), *run.shape) for name, found in told.items()}

    def derivative(self, theta: ArrayLike, phi: ArrayLike, component: ArrayLike = 0) -> Array:
        """`d(s1, phi1)/d(s0, phi0)`, a matrix for each particle. Paper: eq. (derivative_of_map).

        The second row is `lam*(K1*ds1 - K0*ds0 - dphi0)`, so that it keeps its digits however small `lam` is. For any
        other law, minus its slope replaces `lam`, and its derivative by arc length times `ds1` is added.
        """
        ordinary = self.unit == ONE
        single = self._single(MATRIX).told(theta, phi, component) if ordinary and self.reflection.uniform else None
        if single is not None:
            return np.array(single).reshape(2, 2)
        where, theta, phi = self._start(theta, phi, component)
        law, states, count = self._law(phi), self.states, theta.size
        law = PINBALL if law == SLAP else law
        start, lam = (where.ravel(), theta.ravel(), phi.ravel()), self._lams(theta)
        if ordinary and law != FORMULA and (told := derivatives(self, law, start, lam)) is not None:
            return told.reshape(*theta.shape, 2, 2)
        own = states.enter(*start, law)
        n0 = states.exit_normal_speed(own, law)
        rate, curvature = states.bending(where.ravel(), theta.ravel())
        q, omega = np.append(n0 / rate, np.zeros(count)), np.append(curvature, np.ones(count))  # of ds, then of dphi
        particles, tangent = [np.tile(field, 2) for field in own], starting(q, omega, np.tile(n0, 2))
        found = self.engine.run(KernelSpec(law, exponents=True), particles, np.tile(lam, 2), self.shape, 1, tangent)
        rows = {name: row.reshape(2, count) for name, row in found.rows.items()}
        rate, curvature = states.bending(*states.place([rows[name][0] for name in self.family.position]))
        moved = -np.ldexp(1.0, rows["growth"].astype(np.int64)) / rows["down"] * (rows["shift"] / rows["n0"] * rate)
        bent = curvature * moved - omega.reshape(2, count)
        turned = lam * bent
        if law == FORMULA:
            landed = self.step(theta, phi, where)
            flat = self._with(lam, self.reflection)  # a contraction for each, in one row
            slope, drift = flat.slopes(landed.eta.ravel(), landed.theta.ravel(), landed.component.ravel())
            turned = slope * bent + drift * moved
        return np.moveaxis(np.array([moved, turned]), 2, 0).reshape(*theta.shape, 2, 2)

    def exponents(
        self,
        theta: ArrayLike,
        phi: ArrayLike,
        bounces: int,
        transient: int = 0,
        component: ArrayLike = 0,
        threads: int | None = None,
    ) -> Exponents:
        """Both Lyapunov exponents of every particle over `bounces` bounces, after `transient` ones that do not count.

        `nu_plus` is the growth of one vector, which starts in a fixed generic direction and turns to the direction of
        growth in the last 256 bounces of the transient; `nu_minus` comes from the determinant. At `lam = 0` the map is
        one-dimensional and `nu_minus` is minus infinity. `nu_plus_error` and `nu_minus_error` are the standard errors.
        """
        bounces, transient = counted("bounces", bounces), counted("transient", transient, least=0)
        at = theta, phi, component
        growth = Growth(self, *at)
        growth.settle(transient, threads)
        growth.advance(bounces, threads)
        made = np.maximum(growth.bounces, 1)
        with np.errstate(divide="ignore"):
            plus = growth.stretch / made
            minus = growth.volume / made + growth.contraction - plus
        upper, lower = np.maximum(plus, minus), np.minimum(plus, minus)
        shape = np.broadcast_shapes(*map(np.shape, at))
        found = upper, lower, growth.bounces, growth.component, growth.theta, growth.phi, growth.code
        exponents = Exponents(*(np.asarray(field).reshape(shape) for field in found))
        exponents.again = partial(self._exponent_errors, at, bounces, transient, threads)
        return exponents

    def _exponent_errors(
        self, at: Sequence[ArrayLike], bounces: int, transient: int, threads: int | None, blocks: int
    ) -> tuple[Array, Array]:
        """Standard errors of both exponents, from the growth rates over `blocks` blocks of the run."""
        growth, count = Growth(self, *at), min(blocks, bounces)
        growth.settle(transient, threads)
        sizes = np.diff(np.arange(count + 1) * bounces // count)
        reached = growth.advance_blocks(sizes.tolist(), threads)
        with np.errstate(divide="ignore", invalid="ignore"):
            plus, volume = np.diff(reached, axis=1) / sizes[:, None]
            rates = np.array([plus, volume - plus])
            error = np.std(rates, axis=1, ddof=1) / np.sqrt(count) if count > 1 else np.full(rates[:, 0].shape, np.nan)
        shape = np.broadcast_shapes(*map(np.shape, at))
        return error[0].reshape(shape), error[1].reshape(shape)

    def slap(self, theta: ArrayLike, iterates: int = 1, component: ArrayLike = 0) -> Slap:
        """The slap map `T_0` and its iterates, whatever this map's `lam`; the start comes first. Paper: section 2.2.

        `slope` is `T_0'(s)` at the start, the derivative with respect to arc length.

        >>> abs(float(PinballMap("ellipse", a=2).slap(0.0).theta[1]))
        3.141592653589793
        """
        slapping = self if self.law == SLAP else self.uniform(lam=0)
        orbit = slapping.orbit(theta, 0.0, iterates, component)
        slope = slapping.derivative(theta, 0.0, component)[..., 0, 0]
        return Slap(orbit.component, orbit.theta, slope, orbit.code)

    def locate(self, x: ArrayLike, y: ArrayLike) -> tuple[NDArray[np.int64], Array]:
        """Component and parameter of boundary points given in Cartesian coordinates.

        >>> component, theta = PinballMap("ellipse", a=2).locate(0.0, 1.0)
        >>> int(component), float(theta)
        (0, 1.5707963267948966)
        """
        from numeric.pinball.coordinates import located

        return located(self.states, real("x", x), real("y", y))

    def at(self, lam: Contraction) -> "PinballMap":
        """The map of the same table with another contraction."""
        other = self._with(lam, self.reflection)
        if not self.reflection.uniform:
            other._check_law()
        return other

    def uniform(self, lam: Contraction) -> "PinballMap":
        """The map of the same table with the paper's law, `phi = -lam*eta`."""
        return self._with(lam, Law())

    def slopes(self, eta: Array, theta: Array, component: NDArray[np.int64]) -> tuple[Array, Array]:
        """The derivatives `-dphi/deta` and `dphi/ds` of the law, by incidence angle and arc length of the landing."""
        formula, lam = self.family.formula, np.broadcast_to(self.lam, eta.shape)
        if formula is None or self.reflection.uniform:
            return np.asarray(lam, dtype=float), np.zeros(eta.shape)
        place = (theta, self.arclength.s(theta, component)) if formula.measured else (theta,)
        slope, by_theta, *by_length = formula.slopes(self.states.ops, eta, lam, *place)
        drift = by_theta / self.states.speed(component, theta) if formula.placed else 0
        return slope + np.zeros(eta.shape), sum(by_length, start=drift) + np.zeros(eta.shape)

    def __getstate__(self) -> dict[str, Any]:
        """The attributes that are pickled and copied: without machine code and closures, which are made on demand."""
        return {name: value for name, value in vars(self).items() if name != "arclength"} | {"_singles": {}}

    # ---- within

    def _identity(self) -> tuple[Any, ...]:
        """What equal maps have in common: scene and choice of kernels. A map without a scene equals no other."""
        try:
            return self.scene, self.engine.kernels
        except ValueError:
            return (id(self),)

    def _with(self, lam: Contraction, reflection: Law) -> "PinballMap":
        """The map of the same table, without new computations, with another contraction and law."""
        other = object.__new__(PinballMap)
        vars(other).update(vars(self), lam=contraction(lam), reflection=reflection, _singles={}, _contraction=lam)
        return other

    def _check_law(self) -> None:
        """Raises `ValueError` for a law that leads out of the table at some of the contractions."""
        places = self.reflection.places(self.table) if self.reflection.placed else ()
        self.reflection.check((Fraction(float(np.min(self.lam))), Fraction(float(np.max(self.lam)))), *places)

    def _law(self, phi: Array) -> str:
        """The law whose kernel a run needs: not `slap`, even at `lam = 0`, if a start is not along the normal."""
        return PINBALL if self.law == SLAP and np.any(phi != 0) else self.law

    def _shape(self, given: dict[str, Any]) -> list[Fraction | float]:
        name, ranges = self.ir.table, {entry.name: entry for entry in self.ir.shape}
        for key in given:
            if key not in ranges:
                raise no_parameter(name, key, ranges)
        values: list[Fraction | float] = []
        for key, entry in ranges.items():
            if key not in given:
                raise ValueError(f"{name}: the shape parameter {key} needs a value, as in PinballMap(..., {key}=...)")
            value = shape_value(f"{name}: {key}", given[key])
            entry.check(name, Fraction(value))
            values.append(value)
        return values

    def _start(self, theta: ArrayLike, phi: ArrayLike, component: ArrayLike) -> tuple[NDArray[np.int64], Array, Array]:
        theta, phi = angles("theta", theta), angles("phi", phi)
        where = components(component, [part.name for part in self.ir.parts])
        theta, phi, where = together(theta, phi, where)
        if theta.size == 0:
            raise ValueError("theta and phi are empty; give at least one particle")
        if phi.max() >= np.pi / 2 or phi.min() <= -np.pi / 2:
            steep = phi[np.abs(phi) >= np.pi / 2].flat[0]
            raise ValueError(f"phi = {steep} does not point into the table; |phi| must be below pi/2, in radians")
        far = theta[np.abs(theta) > 3] if self.family.cusped else np.zeros(0)
        if np.any(at_cusp := np.cos(far / 2) < NEAR):
            raise ValueError(f"theta = {far[at_cusp].flat[0]} is the cusp, where no normal and so no exit is defined")
        for index, low, high in self.family.standing:
            if np.any(still := (where == index) & (low <= theta) & (theta <= high)):
                raise ValueError(
                    f"theta = {theta[still].flat[0]} has no tangent: from {low:.9g} to {high:.9g} the point of "
                    f"{self.ir.parts[index].name} moves by less than rounding; start elsewhere"
                )
        if self.lam.size > 1 and self.lam.shape != theta.shape:
            shapes = f"lam has shape {self.lam.shape} and the particles {theta.shape}"
            raise ValueError(f"{shapes}; give one lam for each particle, or one")
        for index, (low, high) in enumerate(self.states.ends):
            if low <= theta.min() and theta.max() <= high:
                continue
            off = (where == index) & ~((low <= theta) & (theta <= high))
            if not self.states.boundary.closed:  # a landing on a join is beyond an end by its rounding
                near = off & (np.abs(theta - np.clip(theta, low, high)) <= ROUNDED * (high - low))
                theta, off = np.where(near, np.clip(theta, low, high), theta), off & ~near
            if np.any(off):
                if self.states.boundary.closed:
                    theta = np.where(off, np.remainder(theta - low, 2 * np.pi) + low, theta)
                else:
                    name = self.ir.parts[index].name
                    lies = f"there theta lies in [{low:.17g}, {high:.17g}]"
                    raise ValueError(f"theta = {theta[off].flat[0]} is not on the {name}; {lies}")
        return where, theta, phi

    def _single(self, names: tuple[str, ...]) -> SingleBounce:
        """The cached `SingleBounce` that computes the fields `names` of one bounce of one particle."""
        found = self._singles.get(names)
        if found is None or not found.serves(self):
            law = PINBALL if names is MATRIX and self.law == SLAP else self.law
            asked = names[1:] if names is TOLD and len(self.states.ends) == 1 else names
            found = self._singles[names] = SingleBounce(self, law, asked)
        return found

    def _entered(self, start: tuple[NDArray[np.int64], Array, Array], law: str, lam: Array) -> list[Array]:
        """The states, as kernels hold them, of particles that leave boundary points at exit angles."""
        batch = self.engine.batch(law, (), lam.size, self.shape)
        if batch is None:
            return self.states.enter(*start, law)
        rows = batch.begin(start, lam).start().rows
        return [rows[name] for name in self.family.fields(law)]

    def _lams(self, theta: Array) -> Array:
        if self.lam.size == 1:
            return np.broadcast_to(self.lam.reshape(()), theta.size)
        return np.broadcast_to(self.lam, theta.shape).ravel()


def _unpacked(
    scene: Scene, lam: Contraction | None, shape: dict[str, Any]
) -> "tuple[Scene | str, Contraction, int, dict[str, Any]]":
    """A scene's table (the scene itself if that has no name), its contraction, its `K` for the egg, and its shape."""
    if shape:
        raise ValueError(f"{scene.name}: {', '.join(shape)} given beside a scene; change its shape by scene.at")
    numbers: dict[str, Any] = dict(scene.shape)
    own = scene.lam
    lam = lam if lam is not None else own if isinstance(own, Fraction) else float(own)
    if "table" in scene.document and all(isinstance(value, Fraction) for value in numbers.values()):
        return scene.name, lam, scene.K, numbers
    return scene, lam, 3, {name: numbers[name] for name in scene.ranges if name in numbers}
