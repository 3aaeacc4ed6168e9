"""What judges of the two cardioids ask, with which numbers, and the map whose Newton iteration stops early."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from sympy import Rational, S

from symbolic.cycles.splitting import rate
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import lam
from verification.paper.claims.claim import Verdict
from verification.paper.judges import hyperbolicity as judges
from verification.paper.report.report import catalogue

CLAIMS = {claim.id: claim for claim in catalogue()}
PROVED, UNKNOWN = Finding(Outcome.PROVED, "taken for proved"), Finding(Outcome.UNKNOWN, "not proved")


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple]:
    """What is asked of boxes and of the checklist of the corner orbit, each taken for proved."""
    found: list[tuple] = []

    def put(name, answer):
        def said(*given, tick=None, **named):
            found.append((name, *given, *sorted(named.items())))
            return answer

        monkeypatch.setattr(judges, name, said)

    put("fourth_on_wall", SimpleNamespace(on_wall=True, boxes=7))
    put("minimum_at_kink", True)
    put("kink_falls", True)
    monkeypatch.setattr(judges, "corner", lambda check, reason: found.append(("corner", check)) or PROVED)
    monkeypatch.setattr(judges, "splits", lambda: found.append(("splits",)) or PROVED)
    return found


def test_the_fourth_collision_is_asked_of_boxes_up_to_006_and_of_the_kink_from_there_on(asked):
    found = judges.fourth_collision_below(CLAIMS["cuspless.fourth_collision_below"])
    assert asked == [
        ("fourth_on_wall", 0.04, 0.0, 0.06),
        ("minimum_at_kink", 0.04, 0.06, 0.0713),
        ("kink_falls", 0.06, 0.0713),
        ("corner", "unique"),
    ]
    assert found.verdict is Verdict.CONFIRMED


def test_above_it_is_asked_at_09_on_either_side_and_of_the_kink_from_lambda_star_on(asked):
    found = judges.fourth_collision_above(CLAIMS["cuspless.fourth_collision_above"])
    assert asked == [
        ("fourth_on_wall", 0.05, 0.9, 0.9, ("or_lower", True)),
        ("corner", "s4_dips_below"),
        ("kink_falls", 0.0712, 0.1),
    ]
    assert found.verdict is Verdict.CORRECTED
    assert dict(found.printed.at) == {lam: Rational(9, 10)}


@pytest.mark.parametrize(
    ("trace", "determinant", "unstable"),
    [(-1.6, 0.5, True), (-1.5, 0.5, False), (1.6, 0.5, False), (-1.0, 0.5, False), (-2.9, 0.5, True)],
)
def test_a_multiplier_is_below_minus_1_where_the_trace_is_below_minus_1_less_the_determinant(
    monkeypatch, asked, trace, determinant, unstable
):
    """Its characteristic polynomial is then negative at -1."""
    arc = SimpleNamespace(trace=trace, determinant=determinant)
    monkeypatch.setattr(judges, "border", lambda: SimpleNamespace(pieces={judges.ARC: arc}))
    found = judges.corner_orbit_unstable(CLAIMS["cuspless.corner_orbit_unstable"])
    assert found.verdict is (Verdict.CONFIRMED if unstable else Verdict.OPEN)
    assert asked == [("corner", "unstable")]


@pytest.mark.parametrize(
    ("end", "verdict"),
    [(Rational(934, 10**4), Verdict.CORRECTED), (Rational(0.1), Verdict.REFUTED), (Rational(2, 10), Verdict.REFUTED)],
)
def test_two_attractors_exist_together_where_chaos_is_proved_beyond_the_flip(monkeypatch, end, verdict):
    monkeypatch.setattr(judges, "lambda_c", lambda: end)
    for name in ("subcritical", "certified"):
        monkeypatch.setattr(judges, name, lambda _: PROVED)
    for name in ("chaos", "attracting_below"):
        monkeypatch.setattr(judges, name, lambda: PROVED)
    found = judges.coexistence(CLAIMS["cuspless.coexistence"])
    assert found.verdict is verdict
    assert dict(found.printed.at) == {lam: end}


def test_the_attractor_is_measured_at_four_distances(monkeypatch):
    monkeypatch.setattr(judges, "measured", lambda *given: given)
    judges.sizes.cache_clear()
    assert judges.sizes() == ([1e-5, 1e-3, 8.8e-3, 0.0288], 20_000)
    judges.sizes.cache_clear()


@pytest.mark.parametrize(("kind", "robust"), [("FOLD", True), ("FOLD", False), ("OTHER", True)])
@pytest.mark.parametrize("thin", [((0.1, 0.01), (0.25, 0.002)), None])
def test_thin_at_birth_is_a_border_collision_with_robust_chaos_in_two_strips(monkeypatch, kind, robust, thin):
    piece = SimpleNamespace(trace=1.0, determinant=0.25)
    other = next(one for one in judges.Kind if one is not judges.Kind.FOLD)
    limit = SimpleNamespace(
        kind=judges.Kind.FOLD if kind == "FOLD" else other,
        robust=robust,
        pieces={"arc": piece, "wall": piece},
        extent=SimpleNamespace(inner=(-1, 2), strips=((3, 0.5), (4, 0.25))),
        exponent=(0.1, 0.2),
    )
    monkeypatch.setattr(judges, "border", lambda: limit)
    monkeypatch.setattr(judges, "strips_of_the_map", lambda near: thin)
    monkeypatch.setattr(judges, "chaos", lambda: PROVED)
    monkeypatch.setattr(judges, "sizes", list)
    monkeypatch.setattr(judges, "saddles", lambda: True)
    found = judges.thin_at_birth(CLAIMS["cuspless.thin_at_birth"])
    good = kind == "FOLD" and robust and thin is not None
    assert found.verdict is (Verdict.CONFIRMED if good else Verdict.OPEN)
    if good:
        assert "0.10 by 0.01000 and 0.25 by 0.00200 in units" in found.printed.reason


@pytest.mark.parametrize("table", ["cuspless", "cardioid"])
def test_a_dominated_splitting_is_told_with_its_rate_and_its_scope(asked, table):
    """At one half a return leaves so much of the cone's projective size; by the wall more than along the arc."""
    found = judges.dominated(CLAIMS[f"{table}.dominated_splitting"])
    left = rate(S.Half, wall=table == "cuspless").n(3)
    assert f"at lam = 1/2 a return to the arc leaves at most {left} of the cone's projective size" in found.derived
    assert ("off the cusp" in found.derived) == (table == "cardioid")
    assert ("miss the two joins" in found.derived) == (table == "cuspless")
    assert asked == [("splits",)]


@pytest.mark.parametrize("table", ["cuspless", "cardioid"])
def test_each_table_has_the_cones_of_its_own_at_1(monkeypatch, asked, table):
    monkeypatch.setattr(judges, "expands", lambda: asked.append(("expands",)) or PROVED)
    found = judges.hyperbolic(CLAIMS[f"{table}.elastic_hyperbolic"])
    assert found.verdict is Verdict.CONFIRMED
    assert asked == ([("expands",), ("splits",)] if table == "cuspless" else [("expands",)])


def test_what_exponents_do_not_show_is_refuted_by_the_shear_at_1(asked):
    found = judges.by_exponents(CLAIMS["cuspless.splitting_by_exponents"])
    assert found.verdict is Verdict.CORRECTED
    assert dict(found.printed.at) == {lam: S.One}
    assert len(asked) == 2


@pytest.mark.parametrize(
    ("means", "errors", "later", "supported"),
    [
        ([[1, -1]] * 3, [[1, 1]] * 3, [0, 0, 0], True),
        ([[2, -2]] * 3, [[2, 2]] * 3, [0, 0, 0], True),
        ([[1.5, -1.5]] * 3, [[1, 1]] * 3, [0, 0, 0], False),
        ([[2, 0]] * 3, [[1, 1]] * 3, [0, 0, 0], False),  # of 2 exactly
        ([[1, -1], [1, 1], [2, 2]], [[1, 1]] * 3, [0, 0, 0], False),
        ([[1, -1]] * 3, [[1, 1]] * 3, [0, 0.02, 0], False),
        ([[1, -1]] * 3, [[1, 1]] * 3, [0, -0.5, 0.001], False),
        ([[1, -1]] * 3, [[1, 1]] * 3, [0.019, -0.019, 0], True),
    ],
)
def test_averages_support_ergodicity_below_2_in_each_and_correlations_below_2_hundredths(
    monkeypatch, means, errors, later, supported
):
    asked = []
    found = tuple(np.array(part, dtype=float) for part in (means, errors, later))
    monkeypatch.setattr(judges, "averages", lambda *given: asked.append(given) or found)
    wanted = Verdict.SUPPORTED if supported else Verdict.OPEN
    assert judges.ergodic(CLAIMS["cardioid.elastic_ergodic"]).verdict is wanted
    assert asked == [("cardioid",)]


def test_averages_of_a_made_up_orbit_are_those_that_sums_give(monkeypatch):
    """Three particles, ten bounces, of which blocks of four make two; correlations after two bounces."""
    for name, value in (("BALLS", 3), ("BOUNCES", 10), ("BLOCK", 4), ("LAG", 2)):
        monkeypatch.setattr(judges, name, value)
    rng, asked = np.random.default_rng(4), []
    orbit = SimpleNamespace(theta=rng.random((11, 3)), phi=rng.random((11, 3)), component=rng.integers(0, 2, (11, 3)))
    arclength = SimpleNamespace(s=lambda theta, component: theta + 5 * component, perimeter=7.0)
    made = SimpleNamespace(arclength=arclength, orbit=lambda *given: asked.append(given) or orbit)
    monkeypatch.setattr(judges, "PinballMap", lambda table, lam: asked.append((table, lam)) or made)
    start = SimpleNamespace(theta="THETA", phi="PHI", component="PART")
    monkeypatch.setattr(judges, "phase_starts", lambda *given: asked.append(given) or start)
    means, errors, later = judges.averages("egg")
    assert asked == [("egg", "1"), (made, 3, judges.SEED), ("THETA", "PHI", 10, "PART")]

    turn = 2 * math.pi * (orbit.theta + 5 * orbit.component) / 7
    functions = [
        lambda n, k: math.sin(orbit.phi[n, k]) ** 2 - 1 / 3,
        lambda n, k: math.cos(turn[n, k]),
        lambda n, k: math.sin(orbit.phi[n, k]) * math.sin(turn[n, k]),
    ]
    for number, f in enumerate(functions):
        for k in range(3):
            first, second = (sum(f(n, k) for n in range(low, low + 4)) / 4 for low in (1, 5))
            assert means[number, k] == pytest.approx(sum(f(n, k) for n in range(1, 11)) / 10)
            assert errors[number, k] == pytest.approx(abs(first - second) / 2)  # of the mean of two
        pairs = [f(n, k) * f(n + 2, k) for n in range(1, 9) for k in range(3)]
        squares = [f(n, k) ** 2 for n in range(1, 11) for k in range(3)]
        assert later[number] == pytest.approx(sum(pairs) / 24 / (sum(squares) / 30))


def test_on_a_circle_the_first_guess_is_the_landing():
    """With a tolerance that any step is below one step is made, of next to nothing."""
    theta, phi = np.linspace(-3, 3, 40), np.linspace(-1.5, 1.5, 40)[::-1]
    there, exit = judges.bounced(theta, phi, np.full(40, 0.3), 0.0, 1e9)
    assert np.max(np.abs(np.remainder(there - (theta + np.pi - 2 * phi) + np.pi, 2 * np.pi) - np.pi)) < 1e-13
    assert np.max(np.abs(exit - 0.3 * phi)) < 1e-12
    assert np.all((there >= -np.pi) & (there < np.pi))


def test_next_to_a_tangent_the_sine_of_an_angle_is_never_beyond_1():
    """Nor along it, where a particle stays: at these places it is exactly where it was, and quotients are rounded."""
    theta = np.arange(-3072, 3073) / 1024
    for phi in (np.pi / 2, np.pi / 2 - 1e-12, -np.pi / 2, -np.pi / 2 + 1e-12):
        _, exit = judges.bounced(theta, np.full(theta.size, phi), np.full(theta.size, 0.5), 0.0, 1e9)
        assert np.all(np.isfinite(exit))
        assert np.max(np.abs(exit)) <= np.pi / 4 + 1e-12


def stopped(theta, phi, alpha, tolerance):
    """By a loop for one row: the landing after the first step of Newton's method of which all are below a tolerance."""
    rho = lambda t: 1 + alpha * np.cos(3 * t)  # noqa: E731
    at = lambda t: np.array([rho(t) * np.cos(t), rho(t) * np.sin(t)])  # noqa: E731
    slope = lambda t: -3 * alpha * np.sin(3 * t)  # noqa: E731
    along = lambda t: np.array(  # noqa: E731
        [slope(t) * np.cos(t) - rho(t) * np.sin(t), slope(t) * np.sin(t) + rho(t) * np.cos(t)]
    )
    tangent, landing = along(theta) / np.hypot(*along(theta)), theta + np.pi - 2 * phi
    normal = np.array([-tangent[1], tangent[0]])
    v = normal * np.cos(phi) + tangent * np.sin(phi)
    cross = lambda a, b: a[0] * b[1] - a[1] * b[0]  # noqa: E731
    for _ in range(judges.MOST):
        step = cross(at(landing) - at(theta), v) / cross(along(landing), v)
        landing = landing - step
        if np.max(np.abs(step)) < tolerance:
            break
    ahead = along(landing) / np.hypot(*along(landing))
    return landing, np.arcsin(ahead[0] * v[0] + ahead[1] * v[1])


@pytest.mark.parametrize("tolerance", [1e9, 0.1, 1e-3, 1e-12])
def test_newtons_method_ends_after_the_first_steps_that_are_all_short(tolerance):
    theta, phi = np.linspace(-2, 2.5, 12), np.linspace(0.6, -0.7, 12)
    there, exit = judges.bounced(theta, phi, np.full(12, 0.4), 0.08, tolerance)
    landing, psi = stopped(theta, phi, 0.08, tolerance)
    assert np.max(np.abs(np.remainder(there - landing + np.pi, 2 * np.pi) - np.pi)) < 1e-12
    assert np.max(np.abs(exit - 0.4 * psi)) < 1e-12


def test_an_orbit_is_looked_at_after_its_transient_and_once_more_a_period_later(monkeypatch):
    """Of a made-up map that moves by `1/4` for so many bounces, and then by lam."""
    count = [0]

    def moved(theta, phi, lams, alpha, least):
        assert alpha == 0.08
        assert least.tolist() == [[1e-3], [1e-6]]
        count[0] += 1
        return theta + (0.25 if count[0] <= 10 else lams), phi

    monkeypatch.setattr(judges, "bounced", moved)
    ends = judges.ends_of_period(3, np.array([0.0, 0.1, 0.25, 0.5]), 0.08, [1e-3, 1e-6], (5.0, 0.3), 10, 0.75)
    assert [list(each) for each in ends] == [[0.5], [0.5]]  # three quarters are not more than that
    assert count == [13]
