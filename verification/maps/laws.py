"""Laws that the map of any table obeys, as property tests of one line each (with the extra `hypothesis`)::

    from verification import laws

    test_the_derivative = laws.jacobian()  # the paper's tables, of any shape, under laws of several kinds
    test_mine = laws.symmetry(my_table, max_examples=100)

`tables` is a table, a scene, a map, the name of one of the paper's tables, or a list of these; None means all of the
paper's tables. Contractions, parameters that have a range, and the reflection law (unless a scene has its own) are
drawn at random. Other arguments are Hypothesis' settings. A failure is shown as the simplest particle for which the law
fails.

Each law allows rounding errors in proportion to the condition number of the flight. Particles whose flight grazes or
passes near a join are left out, since the map is not continuous there.
"""

from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import Any

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from sympy import Matrix

from numeric import Orbit, PinballMap
from numeric.backends import elementary
from symbolic.cycles.derivations import derivative_matrix, generate
from symbolic.tables import geometry, named
from symbolic.tables.geometry import group
from symbolic.tables.law import Law
from symbolic.tables.table import Component, Table
from symbolic.tables.table import eta as eta_letter
from symbolic.tables.table import s as s_letter
from symbolic.tables.table import theta as theta_letter
from verification.arithmetic.balls import bits_of, working
from verification.maps.enclosed import EnclosedMap, Refusal, number
from verification.maps.exact import Bounce, ExactMap
from verification.maps.strategies import Particle, listed, particles, reflections

__all__ = ["area_sum_rule", "determinant", "every", "first_hit", "jacobian", "symmetry", "time_reversal_at_lam_1"]

EPS = 2.0**-52
UNITS = 4096  # of rounding allowed, times the condition of the flight
GRAZING = 1e-3  # the least cosine of an angle of incidence
BESIDE = 1e-7  # distance of a particle's neighbours in `theta` and `phi`
NEAR = 1e-3  # greatest distance between the landings of neighbours
BOUNCES = 12  # in the sum rule: too few for rounding to grow to the size of the table
DIGITS = 30  # of the map in multiprecision
BITS = 160

Check = Callable[[Particle], None]
Test = Callable[[], None]


def __dir__() -> list[str]:
    return __all__


def _test(check: Check, tables: Any, options: dict[str, Any], **drawn: Any) -> Test:
    """The property as a test that Hypothesis runs; `drawn` are further arguments of `strategies.particles`."""
    options = {"deadline": None, "max_examples": 30, "suppress_health_check": [HealthCheck.too_slow], **options}

    @settings(**options)
    @given(particle=particles(listed(tables), **{"laws": reflections(), **drawn}))
    def test(particle: Particle) -> None:
        check(particle)

    test.__name__, test.__doc__ = check.__name__, check.__doc__
    return test


def _landed(particle: Particle) -> Any:
    """The next bounce of a particle; the example is discarded where the map is not continuous."""
    map, at = particle.map, (particle.theta, particle.phi, particle.component)
    step = map.step(*at)
    assume(step.code == 0 and np.cos(step.eta) > GRAZING)
    for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        beside = map.step(at[0] + i * BESIDE, at[1] + j * BESIDE, at[2])
        assume(beside.code == 0 and beside.component == step.component)
        assume(np.hypot(beside.x - step.x, beside.y - step.y) < NEAR)
    return step


def _bound(step: Any, *matrices: Any) -> float:
    """Allowed error: units of rounding times the condition of the flight, from its derivatives and landing angle."""
    size = 1 + max(float(np.abs(matrix).max()) for matrix in matrices)
    return float(UNITS * EPS * size**2 / np.cos(step.eta))


def jacobian(tables: Any = None, **options: Any) -> Test:
    """Test that the derivative of the map in `(s, phi)` is the symbolic one. Paper: eq. (derivative_of_map).

    The symbolic derivative is `symbolic.derivative_matrix`, generated for mpmath and evaluated where the exact map
    lands.
    """

    def the_derivative_is_the_symbolic_one(particle: Particle) -> None:
        step, exact = _landed(particle), ExactMap(particle.map, DIGITS)
        found = particle.map.derivative(particle.theta, particle.phi, particle.component)
        start = exact.start(particle.theta, particle.phi, particle.component)
        landed = exact.bounce(start)
        assume(not landed.code and landed.component == int(step.component))
        expected = np.reshape([float(x) for x in symbolic_derivative(exact, start, landed, DIGITS)], (2, 2))
        assert np.all(np.abs(found - expected) <= _bound(step, found, expected)), f"{found} and {expected}"

    return _test(the_derivative_is_the_symbolic_one, tables, options)


def symbolic_derivative(own: ExactMap | EnclosedMap, start: Bounce, landed: Bounce, digits: int) -> list[Any]:
    """The four entries of the symbolic derivative matrix of a flight, row by row, in the numbers of the map `own`.

    For a law `phi = f(eta)` the number `-df/deta` takes the place of `lam`. Where the law depends on the place of the
    landing, its derivative by the arc length times the row of `ds1` is added to the row of `dphi1`.
    """
    map, in_balls = own.map, isinstance(own, EnclosedMap)
    table, shape = _with_letters(map)
    convert = own.exactly if isinstance(own, ExactMap) else partial(number, bits=own.bits)
    numbers = {name: convert(value) for name, value in shape.items()}
    at = {"theta": landed.theta, "eta": landed.eta, "lam": own.lam, **numbers}
    slope, drift = own.lam, 0
    if not map.reflection.uniform:
        law = map.reflection.on(map.table, landed.component)
        if law.measured:
            at["s"] = own.length(landed.component, landed.theta)
        part = map.table.components[landed.component]
        slope, drift = (f(**at) for f in _slopes_of_law(law, part, in_balls, digits))
    m = _matrix(table, start.component, landed.component, in_balls, digits)(
        **{**numbers, "theta0": start.theta, "theta1": landed.theta, "lam": slope}
    )
    with working(bits_of(digits, 64)):
        return [m[0, 0], m[0, 1], *(m[1, j] + drift * m[0, j] for j in (0, 1))]


def _with_letters(map: PinballMap) -> tuple[Table, dict[str, Any]]:
    """The table with free shape parameters, and their values, so that one formula serves all shapes."""
    scene = map.uniform(map.lam).scene
    if "table" in scene.document:
        return named(scene.name, scene.K), scene.shape
    return scene.family, {name: scene.shape[name] for name in scene.ranges if name in scene.shape}


@lru_cache(maxsize=256)
def _matrix(table: Table, here: int, there: int, in_balls: bool, digits: int) -> Callable[..., Any]:
    """The derivative matrix of flights between two components, as a function of its symbols as keyword arguments."""
    return _by_name(_formula(table, here, there), in_balls, digits)


@lru_cache(maxsize=64)
def _formula(table: Table, here: int, there: int) -> Matrix:
    """The symbolic derivative matrix, cached since it takes a second to derive."""
    return derivative_matrix(table, here, there)


@lru_cache(maxsize=256)
def _slopes_of_law(
    law: Law, part: Component, in_balls: bool, digits: int
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """`-dphi/deta` and `dphi/ds` as functions: derivatives by the incidence angle and by the landing's arc length."""
    by_place = law.phi.diff(theta_letter) / geometry.speed(part) + law.phi.diff(s_letter)
    return _by_name(-law.phi.diff(eta_letter), in_balls, digits), _by_name(by_place, in_balls, digits)


def _by_name(expression: Any, in_balls: bool, digits: int) -> Callable[..., Any]:
    """The expression as a function of its symbols, passed by name; further names are ignored."""
    letters = {letter.name for letter in expression.free_symbols}
    value = generate(expression, "arb" if in_balls else "mpmath", digits)
    return lambda **given: value(**{name: number for name, number in given.items() if name in letters})


def _place(end: Any) -> tuple[Any, Any]:
    """Component and parameter of a particle or a landing, as arrays."""
    return np.atleast_1d(end.component), np.atleast_1d(end.theta)


def determinant(tables: Any = None, **options: Any) -> Test:
    """Test that `det DT = f*cos(phi0)/cos(eta1)`, where `f` is minus the slope of the law: `lam` for the paper's."""

    def the_determinant_is_the_slope_of_the_law_times_a_ratio_of_cosines(particle: Particle) -> None:
        step = _landed(particle)
        found = particle.map.derivative(particle.theta, particle.phi, particle.component)
        ratio = np.cos(particle.phi) / np.cos(step.eta)
        expected = float(_slopes(particle, step)[0] * ratio)
        value = float(np.linalg.det(found))
        assert abs(value - expected) <= _bound(step, found), f"{value} and {expected}"

    return _test(the_determinant_is_the_slope_of_the_law_times_a_ratio_of_cosines, tables, options)


def _slopes(particle: Particle, orbit: Any) -> Any:
    """Minus the derivative of the law by the incidence angle, at each bounce."""
    eta, theta, component = (np.ravel(field) for field in (orbit.eta, orbit.theta, orbit.component))
    return particle.map.slopes(eta, theta, component)[0]


def area_sum_rule(tables: Any = None, **options: Any) -> Test:
    """Test that `nu_plus + nu_minus` is the mean of `log|det DT|` along the orbit. Paper: section 4.1."""

    def the_exponents_add_up_to_the_mean_logarithm_of_the_determinant(particle: Particle) -> None:
        at = particle.theta, particle.phi, BOUNCES
        orbit = particle.map.orbit(*at, particle.component)
        assume(not np.any(orbit.code) and np.all(np.cos(orbit.eta[1:]) > GRAZING))
        landings: Any = [field[1:] for field in orbit]
        slopes = np.abs(_slopes(particle, Orbit(*landings)))
        assume(np.all(slopes > GRAZING))  # at 0 the map is singular
        expected = float(np.mean(elementary.log(slopes * np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:]))))
        found = particle.map.exponents(*at, component=particle.component)
        value = float(found.nu_plus + found.nu_minus)
        grown = elementary.exp(BOUNCES * max(0.0, float(found.nu_plus)))  # growth of rounding errors along the orbit
        assume(grown < 1 / NEAR**2)
        assert abs(value - expected) <= UNITS * EPS * (1 + grown) / GRAZING, f"{value} and {expected}"

    return _test(the_exponents_add_up_to_the_mean_logarithm_of_the_determinant, tables, options)


def symmetry(tables: Any = None, **options: Any) -> Test:
    """Test that the map commutes with the table's symmetries; reflections only if the law is odd."""

    def the_map_commutes_with_the_symmetries_of_the_table(particle: Particle) -> None:
        map, step = particle.map, _landed(particle)
        found = map.derivative(particle.theta, particle.phi, particle.component)
        for each in group(map.table):
            if each.sign < 0 and not map.reflection.odd:
                continue
            i = particle.component
            theta = each.sign * particle.theta + float(each.shift[i])
            image = map.step(theta, each.sign * particle.phi, each.onto[i])
            x, y = np.array(each.matrix, dtype=float) @ (step.x, step.y)
            gap = np.hypot(image.x - x, image.y - y) + abs(image.phi - each.sign * step.phi)
            assert gap <= _bound(step, found), f"{each.name}: {gap}"

    return _test(the_map_commutes_with_the_symmetries_of_the_table, tables, options, laws=reflections(placed=False))


def time_reversal_at_lam_1(tables: Any = None, **options: Any) -> Test:
    """Test that a particle that is turned around flies back to its start if exit and incidence angles are equal."""

    def a_classical_particle_that_is_turned_around_flies_back(particle: Particle) -> None:
        map = particle.map.uniform(lam=1.0)
        step = _landed(Particle(map, 1.0, particle.component, particle.theta, particle.phi))
        assume(np.cos(particle.phi) > GRAZING)
        back = map.step(step.theta, -step.phi, step.component)
        x, y = (float(field[0]) for field in map.states.point(*_place(particle)))
        found = map.derivative(step.theta, -step.phi, step.component)
        gap = np.hypot(back.x - x, back.y - y) + abs(back.phi + particle.phi)
        assert gap <= _bound(back, found), f"{gap}"

    return _test(a_classical_particle_that_is_turned_around_flies_back, tables, options, laws=None)


def first_hit(tables: Any = None, **options: Any) -> Test:
    """Test that the float64 landing agrees with the landing that balls prove to be the first hit."""

    def the_landing_is_the_first_hit(particle: Particle) -> None:
        step = _landed(particle)
        balls = EnclosedMap(particle.map, particle.lam, BITS)
        proved = balls.bounce(balls.start(particle.theta, particle.phi, particle.component))
        if isinstance(proved, Refusal):
            assume(False)
        assert not proved.code, proved.code
        found = particle.map.derivative(particle.theta, particle.phi, particle.component)
        gap = np.hypot(float(proved.x.mid()) - step.x, float(proved.y.mid()) - step.y)
        assert proved.component == step.component, f"{proved.component} and {step.component}"
        assert gap + abs(float(proved.phi.mid()) - step.phi) <= _bound(step, found), f"{gap}"

    return _test(the_landing_is_the_first_hit, tables, options)


def every(tables: Any = None, **options: Any) -> Iterator[Test]:
    """All these tests, in the order of this module."""
    for law in (jacobian, determinant, area_sum_rule, symmetry, time_reversal_at_lam_1, first_hit):
        yield law(tables, **options)
