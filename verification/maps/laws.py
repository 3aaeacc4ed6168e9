"""Laws that the map of any table obeys, as property tests of one line each (with the extra `hypothesis`)::

    from verification import laws

    test_the_derivative = laws.jacobian()  # the paper's tables, of any shape, under laws of several kinds
    test_mine = laws.symmetry(my_table, max_examples=100)

`tables` is a table, a scene, the name of one of the paper's, or a list of such; nothing for all of the paper's. Where a
scene's parameters have ranges these are drawn, and so is the reflection law, unless a scene has one of its own.
Other arguments are Hypothesis' settings. What fails is shown as the simplest particle for which it does.

Each law has a bound of its own: the units of rounding that the condition of the flight allows. Left out are particles
whose flight is too close to a grazing one or to a join of the boundary for the map to be continuous.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from hypothesis import HealthCheck, assume, given, settings

from numeric import Orbit
from numeric.backends import elementary
from symbolic.tables.geometry import group
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.maps.exact import ExactMap
from verification.maps.strategies import Particle, particles, reflections

EPS = 2.0**-52
UNITS = 4096  # of rounding, times the condition of the flight
GRAZING = 1e-3  # the least cosine of an angle of incidence
BESIDE = 1e-7  # radians and parameters, to the neighbours of a particle
NEAR = 1e-3  # between the landings of neighbours
BOUNCES = 12  # of the sum rule: fewer than rounding needs to grow to the size of the table
DIGITS, STEP = 30, 10  # of the map in multiprecision, and of the differences taken in it
BITS = 160

Check = Callable[[Particle], None]
Test = Callable[[], None]


def _test(check: Check, tables: Any, options: dict[str, Any], **drawn: Any) -> Test:
    """The property as a test that Hypothesis runs."""
    options = {"deadline": None, "max_examples": 30, "suppress_health_check": [HealthCheck.too_slow], **options}

    @settings(**options)
    @given(particle=particles(tables, **{"laws": reflections(), **drawn}))
    def test(particle: Particle) -> None:
        check(particle)

    test.__name__, test.__doc__ = check.__name__, check.__doc__
    return test


def _landed(particle: Particle) -> Any:
    """The bounce of a particle; the example is left out where the map is not continuous."""
    map, at = particle.map, (particle.theta, particle.phi, particle.component)
    step = map.step(*at)
    assume(step.code == 0 and np.cos(step.eta) > GRAZING)
    for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        beside = map.step(at[0] + i * BESIDE, at[1] + j * BESIDE, at[2])
        assume(beside.code == 0 and beside.component == step.component)
        assume(np.hypot(beside.x - step.x, beside.y - step.y) < NEAR)
    return step


def _bound(step: Any, *matrices: Any) -> float:
    """Units of rounding: the condition of the flight, by its derivatives and by how steeply it lands."""
    size = 1 + max(float(np.abs(matrix).max()) for matrix in matrices)
    return float(UNITS * EPS * size**2 / np.cos(step.eta))


def jacobian(tables: Any = None, **options: Any) -> Test:
    """The derivative of the map in `(s, phi)` is the limit of differences, taken in multiprecision."""

    def the_derivative_is_the_limit_of_differences(particle: Particle) -> None:
        map, exact = particle.map, ExactMap(particle.map, DIGITS)
        step, found = _landed(particle), map.derivative(particle.theta, particle.phi, particle.component)
        mp = exact.context
        h = mp.mpf(10) ** -STEP
        before, after = (_speed(particle, end) for end in (particle, step))
        columns = []
        for along, unit in (((h, 0), before), ((0, h), 1.0)):
            ahead, behind = (
                exact.bounce(
                    exact.start(
                        mp.mpf(particle.theta) + sign * along[0],
                        mp.mpf(particle.phi) + sign * along[1],
                        particle.component,
                    )
                )
                for sign in (1, -1)
            )
            assume(ahead.component == behind.component == int(step.component) and not ahead.code and not behind.code)
            columns.append(
                [
                    float((ahead.theta - behind.theta) / (2 * h)) * after / unit,
                    float((ahead.phi - behind.phi) / (2 * h)) / unit,
                ]
            )
        limit = np.array(columns).T
        assert np.all(np.abs(found - limit) <= _bound(step, found, limit)), f"{found} and {limit}"

    return _test(the_derivative_is_the_limit_of_differences, tables, options)


def _place(end: Any) -> tuple[Any, Any]:
    """Component and parameter of a particle or a landing, as arrays."""
    return np.atleast_1d(end.component), np.atleast_1d(end.theta)


def _speed(particle: Particle, end: Any) -> float:
    """Arc length by the parameter at one end of a flight."""
    return float(np.ravel(particle.map.states.speed(*_place(end)))[0])


def determinant(tables: Any = None, **options: Any) -> Test:
    """`det DT = f'(eta1)*cos(phi0)/cos(eta1)`, with minus the slope of the law, which is `lam` for the paper's."""

    def the_determinant_is_the_slope_of_the_law_times_a_ratio_of_cosines(particle: Particle) -> None:
        step = _landed(particle)
        found = particle.map.derivative(particle.theta, particle.phi, particle.component)
        ratio = np.cos(particle.phi) / np.cos(step.eta)
        expected = float(_slopes(particle, step)[0] * ratio)
        value = float(np.linalg.det(found))
        assert abs(value - expected) <= _bound(step, found), f"{value} and {expected}"

    return _test(the_determinant_is_the_slope_of_the_law_times_a_ratio_of_cosines, tables, options)


def _slopes(particle: Particle, orbit: Any) -> Any:
    """Minus the slope of the law at each bounce."""
    eta, theta, component = (np.ravel(field) for field in (orbit.eta, orbit.theta, orbit.component))
    return particle.map.slopes(eta, theta, component)[0]


def area_sum_rule(tables: Any = None, **options: Any) -> Test:
    """`nu_plus + nu_minus` is the mean of `log|det DT|` along the orbit. Paper: section 4.1."""

    def the_exponents_add_up_to_the_mean_logarithm_of_the_determinant(particle: Particle) -> None:
        at = particle.theta, particle.phi, BOUNCES
        orbit = particle.map.orbit(*at, particle.component)
        assume(not np.any(orbit.code) and np.all(np.cos(orbit.eta[1:]) > GRAZING))
        landings: Any = [field[1:] for field in orbit]
        slopes = np.abs(_slopes(particle, Orbit(*landings)))
        assume(np.all(slopes > GRAZING))  # at 0 the map forgets a direction
        expected = float(np.mean(elementary.log(slopes * np.cos(orbit.phi[:-1]) / np.cos(orbit.eta[1:]))))
        found = particle.map.exponents(*at, component=particle.component)
        value = float(found.nu_plus + found.nu_minus)
        grown = elementary.exp(BOUNCES * max(0.0, float(found.nu_plus)))  # what rounding has become at the end
        assume(grown < 1 / NEAR**2)
        assert abs(value - expected) <= UNITS * EPS * (1 + grown) / GRAZING, f"{value} and {expected}"

    return _test(the_exponents_add_up_to_the_mean_logarithm_of_the_determinant, tables, options)


def symmetry(tables: Any = None, **options: Any) -> Test:
    """The image of a bounce under a symmetry of the table is the bounce of the image; a mirror asks for an odd law."""

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
    """Where the angle of exit is that of incidence, a particle that is turned around flies back to its start."""

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
    """The landing in float64 is the one that balls prove to be the first, on its component and in its place."""

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
    """All of these laws, in the order of this page."""
    for law in (jacobian, determinant, area_sum_rule, symmetry, time_reversal_at_lam_1, first_hit):
        yield law(tables, **options)
