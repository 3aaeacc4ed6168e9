"""Reflection laws: which functions are laws, where the others fail, and facts that hold for every law."""

import math
import re

import pytest
from sympy import Rational, diff, pi, simplify, sin, symbols

from symbolic import Law, Scene, tables
from symbolic.motion.collision import area_factor, derivative_matrix, determinant, exit_angle, exit_slope, telescoped
from symbolic.tables import cardioid, circle, egg
from symbolic.tables.table import eta, lam, theta

BENT = "-lam*eta - b*sin(2*eta)"
TWISTED = "-lam*eta*(1 + cos(theta)/10)"


def test_a_scene_with_a_law_reads_its_own_text():
    scene = Scene("egg", alpha="2/25", lam="1/2", law=BENT, b="0.1")

    assert Scene.parse(scene.text) == scene
    assert scene.law == Law(BENT).at(b="1/10")
    assert list(scene.shape) == ["alpha"]
    assert scene.at(law="-lam*eta") == Scene("egg", alpha="2/25", lam="1/2")


@pytest.mark.parametrize(
    ("formula", "ranges"),
    [
        ("-lam*eta", {}),
        ("-eta", {}),
        ("0", {}),
        ("-sin(eta)*pi/2", {}),
        ("-tanh(eta)", {}),
        ("-eta + eta**3/12", {}),
        ("-eta - sin(2*eta)/2", {}),  # touches pi/2 to third order at both ends
        (BENT, {"b": (0, Rational(1, 2))}),
        ("-lam*eta - (1 - lam)*eta**3/4", {}),
        (TWISTED, {"lam": (0, Rational(9, 10))}),
    ],
)
def test_a_law_that_points_into_the_table_is_proved_to(formula, ranges):
    assert Law(formula).proof(**ranges)


@pytest.mark.parametrize(
    ("formula", "ranges"),
    [
        ("-2*eta", {}),
        ("-eta - eta**3/5", {}),
        ("-eta - 1", {}),
        (BENT, {"lam": (1, 1), "b": (Rational(3, 5), Rational(3, 5))}),
        (TWISTED, {"lam": (1, 1)}),
    ],
)
def test_a_law_that_leads_out_is_refused_with_an_angle_at_which_it_does(formula, ranges):
    with pytest.raises(ValueError, match="does not lie between -pi/2 and pi/2") as refusal:
        Law(formula).check(**ranges)

    said = {name: Rational(text) for name, text in re.findall(r"(\w+) = (-?\d+\.?\d*)", str(refusal.value))}
    phi = Law(formula).phi.subs({symbol: said[symbol.name] for symbol in Law(formula).phi.free_symbols})

    assert abs(said["eta"]) < pi / 2
    assert abs(phi) > pi / 2 - Rational(1, 10**4)


@pytest.mark.parametrize("formula", ["abs(eta)", "-lam*s", "foo(eta)", "-eta +", "sqrt(eta)", "1/eta", "0.5*eta.real"])
def test_what_is_no_smooth_formula_is_no_law(formula):
    with pytest.raises(ValueError, match="law"):
        Law(formula).check()


def test_arc_length_is_written_in_theta_component_by_component_where_it_is_a_formula():
    law = Law("-lam*eta + sin(s)/9")

    assert law.measured
    assert law.placed
    assert law.on(cardioid).phi == -eta * lam + sin(4 * sin(theta / 2)) / 9
    assert [law.on(tables.square(), i).phi for i in (0, 3)] == [-eta * lam + sin(theta + i) / 9 for i in (0, 3)]
    assert not law.on(circle).measured
    assert law.on(egg(3).at(alpha="2/25")) is law
    with pytest.raises(ValueError, match="no closed formula, as it has to be over a range of shapes"):
        law.on(egg(3))
    with pytest.raises(ValueError, match="no closed formula, as it has to be on several pieces"):
        law.on(tables.semi_ellipse())


def test_a_law_of_arc_length_is_proved_over_the_whole_boundary():
    wave = Law("-lam*eta + s/10")
    low, high = wave.places(egg(3).at(alpha="2/25"))[1]

    assert wave.places(tables.square())[1] == (0, 4)
    assert wave.places(cardioid)[1] == (-4, 4)
    assert abs(low + high) < Rational(1, 10**20)
    assert 3.187 < high < 3.2  # half of 6.3728, from above
    Scene("cardioid", lam="1/2", law="-lam*eta + s/10")
    with pytest.raises(ValueError, match="s = -4"):
        Scene("cardioid", lam="1/2", law="-lam*eta + s/4")
    with pytest.raises(ValueError, match="the range of the arc length s is not given"):
        wave.check()


def test_contracting_is_strict():
    assert Law("-lam*eta").contracting(lam=(0, Rational(99, 100)))
    assert Law("-lam*sin(eta)").contracting()
    assert not Law("-eta").contracting()
    assert not Law(BENT).contracting(lam=(1, 1), b=(Rational(1, 10), Rational(1, 10)))


def test_only_an_odd_law_that_is_the_same_everywhere_keeps_mirror_images():
    assert Law(BENT).odd
    assert not Law("-eta/2 + eta**2/9").odd
    assert not Law(TWISTED).odd


# ---- theorems for any law


def test_the_slope_of_the_papers_law_gives_the_papers_matrix():
    assert derivative_matrix(lam=exit_slope()) == derivative_matrix()
    assert derivative_matrix(lam=Law().slope) == derivative_matrix()
    assert exit_angle(eta + Law(BENT).phi) == Law(BENT).phi


def test_the_determinant_of_a_law_that_depends_on_the_place_has_no_trace_of_it():
    slope, drift = symbols("slope drift", real=True)

    assert simplify(determinant(slope, drift) - determinant().subs(lam, slope)) == 0


@pytest.mark.parametrize("formula", ["-lam*eta", "-lam*sin(eta)", "-eta + eta**3/12", BENT])
def test_areas_change_as_sines_do_and_add_up_along_orbits(formula):
    phi = Law(formula).phi
    by_sines = -diff(sin(phi), eta) / diff(sin(eta), eta)

    assert simplify(area_factor(phi) - by_sines) == 0
    assert telescoped(2, phi) == 1


@pytest.mark.parametrize("percent", [1, 37, 99])
def test_restitution_multiplies_the_tangent_of_the_angle(percent):
    law, part = Law("-atan(lam*tan(eta))"), Rational(percent, 100)

    assert law.proof((part, part))
    for angle in (-1.57, -0.8, 0.0, 0.3, 1.5):
        value = law.phi.subs({lam: part, eta: angle}).evalf()
        assert float(value) == pytest.approx(-math.atan(percent / 100 * math.tan(angle)), abs=1e-12)


def test_restitution_has_its_limits_at_right_angles_and_at_both_ends_of_lam():
    law = Law("-atan(lam*tan(eta))")

    assert [law.phi.subs(eta, sign * pi / 2) for sign in (-1, 1)] == [pi / 2, -pi / 2]
    assert law.elastic(1)
    assert law.odd
    assert law.proof((0, 0))
    with pytest.raises(ValueError, match=r"may be larger than 1048576 near eta = -1\.5708"):
        law.check((0, 1))
