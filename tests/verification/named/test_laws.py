"""Cycles, branches and certificates under other reflection laws, against theorems that hold for every law."""

import json
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, arb_series
from sympy import S

from numeric import PinballMap
from symbolic import Law, Scene
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse, square, stadium
from verification import EnclosedMap, certify, find_cycles, follow
from verification.app.cli import main
from verification.arithmetic.balls import FLOAT64, balls, multiprecision, working
from verification.arithmetic.series import Jet, along, in_series, jets
from verification.cycles.chords import Chords
from verification.cycles.problem import Problem
from verification.cycles.recurrence import Closure
from verification.maps.exact import ExactMap
from verification.maps.measured import Lengths
from verification.named.locate import proof_near
from verification.named.theorems import checked

BENT = "-lam*eta - b*sin(2*eta)"
SCENE = Scene("ellipse", a="3/2", lam="1/2", law=BENT, b="1/20")


def test_double_normals_know_the_slope_of_the_law_at_normal_incidence_alone():
    found = find_cycles(SCENE, period=2)
    sigma = S(6) / 10  # 1/2 + 2/20
    short = derivative_matrix(K0=-S(4) / 9, K1=-S(4) / 9, t=2, cos_phi0=1, cos_eta1=1, lam=sigma) ** 2
    expected = sorted(complex(mu.n()).real for mu in short.eigenvals(multiple=True))

    (minor,) = [orbit for orbit in found if abs(abs(orbit.theta[0]) - np.pi / 2) < 1e-6]

    assert sorted(mu.real for mu in minor.multipliers) == pytest.approx(expected, abs=1e-9)
    assert len(found) == 2


def test_a_fold_is_followed_in_a_parameter_of_the_law_and_proved():
    scene = Scene("egg", alpha="2/25", lam="7/20", law=BENT, b="1/20")
    triangle = find_cycles(scene, period=3).stable[0]
    branch = follow(triangle, b=("0", "1/10"))
    (fold,) = branch.folds
    proof = certify(fold, digits=12)

    assert proof.certified
    assert 0 < fold.value < 1 / 20
    with pytest.raises(ValueError, match="is no parameter"):
        follow(triangle, c=("0", "1/10"))


ON = "-lam*eta*(1 + cos(2*s)/10) + b*sin(s) - eta*cos(theta)/30"


@pytest.mark.parametrize(
    ("table", "formula", "x"),
    [
        (ellipse, BENT, [0.1, 2.2, 4.0]),
        (ellipse, "-lam*eta*(1 + cos(theta)/10) - b*eta**3", [0.1, 2.2, 4.0]),
        (ellipse, "-lam*eta + b*cos(theta)", [0.1, 2.2, 4.0]),
        (cardioid, ON, [0.1, 2.2, -1.4]),
        (cuspless, ON, [0.1, 0.2, 0.05]),
        (stadium(), ON, [0.1, 0.2, 0.05]),
        (egg(3).at(alpha="2/25"), ON, [0.1, 2.2, -1.4]),  # arc length is an integral
        (ellipse.at(a="3/2"), ON, [0.1, 2.2, 4.0]),  # and counted from the other side beyond pi
    ],
)
def test_the_chord_rule_of_a_law_has_its_own_derivatives(table, formula, x):
    ring = Chords(table, (0, 0, min(1, len(table.components) - 1)), law=Law(formula))
    x, at = np.array(x), {"lam": 0.6, "b": 0.07, "a": 1.3}
    terms, h = ring.terms(x, at, 2), 1e-5

    for name in ring.parameters:
        up, down = (ring.terms(x, at | {name: at[name] + step}, 1) for step in (h, -h))
        assert np.max(np.abs((up.value - down.value) / (2 * h) - terms.by[name])) < 1e-8
        for own, over, under in zip(terms.slope_by[name], up.slope, down.slope, strict=True):
            assert np.max(np.abs((over - under) / (2 * h) - own)) < 1e-7
    for shift, by in ((1, 0), (0, 1), (-1, 2)):  # of the bounce before, the bounce, the one after
        for i in range(3):
            moved = np.eye(3)[(i - shift) % 3] * h
            up, down = ring.terms(x + moved, at, 1), ring.terms(x - moved, at, 1)
            assert abs((up.value[i] - down.value[i]) / (2 * h) - terms.slope[by][i]) < 1e-8
            for other in range(3):
                bend = terms.bend.get((min(by, other), max(by, other)))
                difference = (up.slope[other][i] - down.slope[other][i]) / (2 * h)
                assert abs(difference - (0 if bend is None else bend[i])) < 1e-7


def test_a_bounce_in_balls_holds_the_exit_angle_of_the_law():
    map = PinballMap(SCENE)
    enclosed = EnclosedMap(map, Fraction(1, 2), 100)
    bounce = enclosed.bounce(enclosed.start(Fraction(2, 5), Fraction(3, 10)))
    step = map.step(0.4, 0.3)

    assert abs(float(bounce.phi.mid()) - float(step.phi)) < 1e-14
    assert bounce.phi.rad() < 1e-25
    assert abs(float(bounce.phi.mid()) - (-float(step.eta) / 2 - np.sin(2 * float(step.eta)) / 20)) < 1e-14


def test_a_cycle_under_a_law_of_arc_length_is_one_of_the_map_and_followed():
    scene = Scene(square(), lam="1/2", law="-lam*eta + b*sin(2*pi*s)", b="1/20")
    found = find_cycles(scene, period=2)
    map, orbit = PinballMap(scene, kernels=False), found[0]
    step = map.step(orbit.theta[0], orbit.phi[0], orbit.components[0])
    branch = follow(orbit, b=("0", "1/10"))

    assert abs(float(step.theta) - orbit.theta[1]) < 1e-12
    assert abs(float(step.phi) - orbit.phi[1]) < 1e-12
    assert branch.parameter == "b"


INTEGRATED = [  # scenes whose arc length is no closed formula
    Scene("egg", alpha="2/25", lam="1/2", law="-lam*eta + sin(s)/300"),
    Scene("ellipse", a="3/2", lam="1/2", law="-lam*eta*(1 + cos(s)/9) + sin(2*s)/30"),
    Scene.of({"polar": "exp(cos(3*theta)/40)", "lam": "1/2", "law": "-lam*eta + s**2/300"}),
]


@pytest.mark.slow
@pytest.mark.parametrize("scene", INTEGRATED[1:], ids=lambda scene: scene.name)
def test_where_arc_length_is_an_integral_cycles_are_those_of_the_map_and_proved(scene):
    """Against flights in 40 digits, with arc length as mpmath's integral, instead of the chord rule."""
    orbit = find_cycles(scene, period=2).orbits[0]
    proof = proof_near(Problem(scene.table, (0, 0), lam=S(scene.lam), law=scene.law), list(orbit.theta), 25)
    exact = ExactMap(PinballMap(scene), 40)
    first, second = (exact.context.mpf(x.mid().str(40, radius=False)) for x in proof.enclosure.zero)
    here, there = (exact.frame(0, theta) for theta in (first, second))
    away = there.x - here.x, there.y - here.y
    start = exact.along(first, away)
    landed = exact.bounce(exact.bounce(start))
    said = json.loads(json.dumps(proof.document()))

    assert proof.proved
    assert said["scene"]["law"] == scene.law.formula
    assert checked(said).proved
    assert abs(exact.context.sin((landed.theta - first) / 2)) < 1e-24
    assert abs(landed.phi - start.phi) < 1e-24


@pytest.mark.slow
def test_a_fold_under_a_law_of_arc_length_that_is_an_integral_is_proved_and_below_it_cycles_are_fewer():
    scene = Scene("egg", alpha="2/25", lam="1/2", law="-lam*eta + sin(s)/30")
    branch = follow(find_cycles(scene, period=3).stable[0], lam=("0.37", "0.6"))
    found = certify(branch.folds[0], digits=15)

    assert found.certified
    assert abs(float(found.ball.mid()) - branch.folds[0].value) < 1e-9
    assert len(find_cycles(scene.at(lam="0.37836"), period=3)) < 4


def test_arc_length_is_the_same_in_every_kind_of_number_and_its_derivative_the_speed():
    length, context = Lengths(egg(3).at(alpha="2/25")), mpmath.MPContext()
    context.dps = 30
    at, floats = 2.2, length.placed(FLOAT64, 2.2)
    mp = length.placed(multiprecision(context), context.mpf(at))
    with working(100):
        ball = length.placed(balls(100), arb(at, 1e-9))
        moved = length.placed(jets(balls(100)), Jet(arb(at), arb(1), arb(0)))
        words = in_series(balls(100), arb_series)
        (again,) = along([Jet(arb(at), arb(1), arb(0))], lambda near: length.placed(words, near[0])[1:])
        h = arb(2) ** -20
        ends = [length.placed(balls(100), arb(at) + side * h)[1] for side in (-1, 0, 1)]
        first, second = (ends[2] - ends[0]) / (2 * h), (ends[2] - 2 * ends[1] + ends[0]) / (h * h)

        assert abs(ball[1] - arb(str(mp[1]))) < 2e-9
        assert ball[1].contains(ends[1])
        assert abs(moved[1].c[1] - first) < 1e-9
        assert abs(2 * moved[1].c[2] - second) < 1e-6
        assert all(c.overlaps(d) and d.rad() < 1e-9 for c, d in zip(moved[1].c, again.c, strict=True))
    assert abs(float(mp[1]) - floats[1]) < 1e-14
    around = length.placed(FLOAT64, at + 2 * np.pi)
    assert np.allclose(around, floats, atol=1e-14)


def test_a_cycle_under_a_law_of_the_place_closes_by_no_turn():
    with pytest.raises(ValueError, match="no cycle closes by a turn"):
        Problem(INTEGRATED[0].table, (0,), lam=S(1) / 2, closure=Closure(1, (1, 3)), law=INTEGRATED[0].law)


def test_a_mirror_asks_for_an_odd_law():
    problem = Problem(egg(3).at(alpha="2/25"), (0, 0), lam=S(1) / 2)
    with pytest.raises(ValueError, match="no odd function"):
        replace(problem, closure=replace(problem.closure, turn=-1), law=Law("-eta/2 + eta**2/9"))


def test_the_count_on_cells_agrees_with_the_search_for_another_law(capsys):
    assert main(["cycles", *EGG, "--law", "-lam*sin(eta)", "--period", "2", "--count", "2"]) == 0
    assert "cells: T^2 has 6 + 6 fixed points, agrees with the search" in capsys.readouterr().out


EGG = ["egg", "--alpha", "0.08", "--lam", "0.5"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["orbit", *EGG, "--start", "0.4,0.3", "--bounces", "2", "--law", "-2*eta"], "at eta = -0.785398"),
        (["orbit", *EGG, "--start", "0.4,0.3", "--bounces", "2", "--law", "-eta +"], "--law: the end at column 7"),
        (["slap", "egg", "--alpha", "0.08", "--law", "-eta/3"], "-eta/3 does not exit along the normal at lam = 0"),
        (["cycles", *EGG, "--period", "2", "--prove", "2", "--law", "-lam*eta + theta/20"], "period 2*pi in theta"),
        (["cycles", "square", "--lam", "0.5", "--period", "2", "--prove", "2"], "square is not proved to be one"),
    ],
)
def test_a_command_refuses_a_law_in_one_sentence(arguments, said, capsys):
    assert main(arguments) == 2
    assert said in capsys.readouterr().err


def test_restitution_halves_the_tangential_velocity_in_floats_and_in_balls(tmp_path):
    given = ["orbit", "ellipse", "--a", "3/2", "--lam", "1/2", "--law", "-atan(lam*tan(eta))", "--start", "0.3,0.2"]
    for arithmetic in ("float64", "arb"):
        path = tmp_path / f"{arithmetic}.json"

        assert main([*given, "--bounces", "4", "--arithmetic", arithmetic, "--json", str(path)]) == 0
        for bounce in json.loads(path.read_text())["bounces"][1:]:
            eta, phi = float(bounce["eta"]), float(bounce["phi"])
            assert np.tan(phi) == pytest.approx(-np.tan(eta) / 2, abs=1e-12)


def test_a_certificate_writes_arc_length_in_theta_where_one_formula_does():
    """On the circle arc length is theta; a stadium has no single formula, and its certificate is refused."""
    law = Law("-lam*eta + b*sin(2*s)").at(b="1/20")
    proof = proof_near(Problem(circle, (0, 0), lam=S(1) / 2, law=law), [0.0, np.pi], 20)
    other = Problem(stadium(), (0, 2), lam=S(1) / 2, law=law)

    assert proof.document()["scene"]["law"] == "-eta*lam + sin(2*theta)/20"
    assert checked(json.loads(json.dumps(proof.document()))) == proof
    with pytest.raises(ValueError, match="cannot state"):
        replace(proof, problem=other).document()
