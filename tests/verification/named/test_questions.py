"""Questions on a scene: answers agree with closed forms, and a senseless question is refused in a sentence."""

import json
from fractions import Fraction
from functools import cache
from math import pi

import numpy as np
import pytest
from sympy import Interval, Rational, Symbol, solve, sqrt

from symbolic import Scene, tables
from symbolic.cycles.polygons import saddle_node
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.gallery import mushroom, semi_ellipse, sinai
from symbolic.tables.table import Shape, alpha
from verification.cycles.chords import Chords
from verification.named.bifurcations import bifurcations
from verification.named.questions import PeriodicOrbit, certify, find_cycles, follow, morse_graph, trapping_region
from verification.named.theorems import checked

EGG = Scene("egg", alpha="2/25", lam="1/2")


@cache
def triangles():
    return find_cycles(EGG, period=3)


@pytest.mark.slow
def test_cycles_are_chosen_by_what_they_are():
    orbits = triangles()

    assert {orbit.period for orbit in orbits} == {3}
    assert len(orbits.stable) + len(orbits.unstable) == len(orbits)
    assert len(orbits.stable) == 2  # one each way round; paper, section 6.4
    assert orbits.of(3)[:2].orbits == orbits.orbits[:2]
    assert len(orbits.of(2)) == 0


def test_what_is_no_event_of_a_branch_is_refused_in_a_sentence():
    with pytest.raises(
        ValueError, match=r"int given; accepted: a cycle, .* or an event of a branch, as in branch.folds"
    ):
        certify(3)


def test_a_branch_is_followed_to_its_fold_and_the_fold_is_certified():
    branch = follow(triangles().stable[0], lam=("0.37", "1"))
    (fold,) = branch.folds
    found = certify(fold, digits=25)
    exact = saddle_node().subs(alpha, Rational(2, 25))

    assert found.certified
    assert repr(fold) == "BranchEvent(fold at lam = 0.378121253)"
    assert abs(Rational(found.value) - exact.evalf(40)) <= Rational(found.radius) + Rational(1, 10**39)
    assert branch.flips == branch.pitchforks == branch.border_collisions == ()
    assert str(found).endswith("certified)")


def test_a_graph_is_that_of_the_scene_s_own_contraction():
    cells = {"columns": 64, "rows": 32}
    scene = Scene("ellipse", a="3/2", lam="1/2")

    assert len(morse_graph(scene, **cells).sets) == len(morse_graph("ellipse", a="3/2", lam="1/2", **cells).sets)
    assert trapping_region(scene, **cells).lam == (Fraction(1, 2), Fraction(1, 2))


def ranged(name, low, high):
    return Shape(Symbol(name, real=True), Interval(Rational(low), Rational(high)), "lies outside")


@pytest.mark.slow
def test_a_length_of_a_table_of_pieces_varies_and_its_doubling_is_where_the_matrices_say():
    """Half an ellipse, 1 high: the vertical cycle of period 2 doubles where its multipliers are -1 and -lam**2."""
    half = Scene(semi_ellipse(ranged("a", "1/2", 1)), a="9/10", lam="1/2")
    straight = PeriodicOrbit(half, (0, 1), (pi / 2, 0.0), (0.0, 0.0), (-1.3, -0.2))  # on the base, whose ends move
    (doubling,) = follow(straight, a=("1/2", "1")).flips
    found = certify(doubling, digits=20)
    width = Symbol("width", positive=True)
    down, up = (
        derivative_matrix(K0=x, K1=y, t=1, cos_phi0=1, cos_eta1=1, lam=Rational(1, 2)) for x, y in curvatures(width)
    )
    (exact,) = solve((up * down).trace() + 1 + Rational(1, 4), width)

    assert found.certified
    assert exact == sqrt(Rational(9, 10))
    assert abs(Rational(found.value) - exact.evalf(40)) <= Rational(found.radius) + Rational(1, 10**39)


def curvatures(a):
    """The curvatures at both ends of each flight: the top has radius a**2, and the base is straight."""
    return ((-1 / a**2, 0), (0, -1 / a**2))


@pytest.mark.slow
def test_a_branch_ends_where_the_corner_that_moves_comes_to_a_bounce():
    """No bounce on the mushroom's cap or brims depends on the stem, until its corner reaches the bounce."""
    scene = Scene(mushroom(stem=ranged("stem", "1/10", "9/10")), stem="1/5", lam="1/2")
    bounces = 0.6325819859434174, -0.4334163350532527, 2.509010667646376, 0.4334163350532527
    square = PeriodicOrbit(scene, (0, 1, 0, 5), bounces, (0.0,) * 4, (5.6, 0.05))
    branch = follow(square, stem=("1/10", "9/10"))
    (collision,) = branch.border_collisions

    assert abs(collision.value + bounces[1]) < 1e-14
    assert max(branch.branch.values) == pytest.approx(collision.value, abs=1e-7)


@pytest.mark.parametrize(("low", "high"), [("1/10", "3/5"), ("0", "1/4")])
def test_a_length_may_not_vary_to_where_there_is_no_table(low, high):
    with pytest.raises(ValueError, match=r"sinai: radius = .* accepted: "):
        sinai(ranged("radius", low, high))


@pytest.mark.slow
def test_a_parameter_of_ones_own_varies_as_the_paper_s_do():
    """The egg as a radius with another letter has the same fold of triangles and the same proof."""
    own = Scene.of({"polar": "1 + b*cos(3*theta)", "shape": {"b": "2/25"}, "lam": "1/2"})
    (fold,) = bifurcations(own, "saddle-node", period=3, digits=15, searches=1, b=("0.03", "0.09"))
    (eggs,) = follow(triangles()[0], alpha=("0.03", "0.09")).folds

    assert float(fold.value) == pytest.approx(eggs.value, abs=1e-12)
    assert fold.certified
    said = fold.proof.document()
    assert said["scene"] == {"polar": "b*cos(3*theta) + 1", "shape": {"b": "3/100..9/100"}, "lam": "1/2"}
    assert checked(json.loads(json.dumps(said))).proved
    for wrong, says in (("1/100..1/20", "b is not proved to lie in its range"), ("1/100..3/2", "is not positive at")):
        with pytest.raises(ValueError, match=says):
            checked({**said, "scene": {**said["scene"], "shape": {"b": wrong}}})


def test_a_chord_through_the_wall_is_no_cycle_for_any_shape():
    """The table is dented on the right, so the double normal along the axis leaves it, for a fixed or free shape."""
    bean = Scene.of({"polar": "1 + b*cos(2*theta)", "shape": {"b": "0.1:0..9/10"}, "lam": "1/2"})
    for table, at in ((bean.table, {}), (bean.over("b", "0", "0.9"), {"b": 0.6})):
        ring = Chords(table, (0, 0))
        near, far = (ring.obstacle(np.array(x), {"lam": 0.5, **at}) for x in ([0.0, pi], [0.6, pi - 0.6]))
        assert near == ""
        assert bool(at) == ("meets the boundary on its way" in far)


def test_a_table_over_an_interval_is_proved_or_refused_with_a_value():
    own = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}})

    assert own.over("b", 0, "1/2").shapes[0].range.end == Rational(1, 2)
    with pytest.raises(ValueError, match=r"polar: rho = .* is not positive at theta = .*, b = 1.5"):
        own.over("b", 0, 3)
    with pytest.raises(ValueError, match=r"^egg: alpha = 1/5 makes the table non-convex"):
        Scene("egg", alpha="2/25").over("alpha", 0, "1/5")
    with pytest.raises(ValueError, match="no shape parameter c; it has: b"):
        own.over("c", 0, 1)


def test_a_shape_is_a_letter_too():
    axis = find_cycles(Scene("ellipse", a="3/2", lam="1/2"), period=2).stable[0]
    branch = follow(axis, a=("1.2", "1.9"))

    assert branch.parameter == "a"
    assert branch.events == ()  # its multipliers stay inside the unit circle for every a > 1; paper, section 3.3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: find_cycles(EGG), "give one of"),
        (lambda: find_cycles(EGG, period=1), "accepted: integers from 2"),
        (lambda: follow(triangles()[0]), "one parameter varies"),
        (lambda: follow(triangles()[0], beta=(0, 1)), "accepted: lam, alpha"),
        (lambda: follow(triangles()[0], lam=("0.5", "0.4")), "first must be the smaller"),
        (lambda: follow(triangles()[0], lam="0.4"), "is no interval"),
        (lambda: bifurcations(EGG, "lambda-c", period=2, lam=("0", "1")), "accepted: saddle-node, doubling, symmetry"),
        (lambda: bifurcations(EGG, "doubling", period=2), "no parameter given; one parameter varies"),
    ],
)
def test_a_wrong_question_is_told_in_a_sentence(ask, says):
    with pytest.raises(ValueError, match=says):
        ask()


@pytest.mark.slow
def test_a_fold_near_the_end_of_the_interval_is_found_unasked():
    """The expected value is from a search at many more contractions."""
    scene = Scene.of({"polar": "1 + cos(2*theta)/10", "lam": "1/2"})
    (fold,) = bifurcations(scene, "saddle-node", period=4, digits=16, lam=("0.5", "0.999"))

    assert fold.certified
    assert fold.value == "0.93369386179537997"


def test_a_doubling_is_told_once_by_a_branch_that_returns_on_its_mirror_image():
    """The branch turns at its birth from the symmetric cycle, and returns along its cycles' mirror images."""
    orbits = find_cycles(Scene("egg", alpha="2/25", lam="3/10"), period=4)
    branch = follow(orbits.stable[0], lam=("1/20", "1/2"))

    assert [event.kind for event in branch.events] == ["period doubling"]
    assert len(branch.branch.at(0.36)) == 2


@pytest.mark.slow
def test_a_pitchfork_that_has_no_certificate_keeps_its_value_which_is_not_certified():
    scene = Scene(tables.polar("1 + cos(4*theta)/36"))
    (found,) = bifurcations(scene, "symmetry-breaking", period=12, searches=1, lam=("0.8879", "0.888"))

    assert (found.certified, found.radius, found.certificate) == (False, "inf", None)
    assert float(found.value) == pytest.approx(0.887936692, abs=1e-8)  # the report's, by another search
    with pytest.raises(ValueError, match="was not proved; accepted"):
        found.save("pitchfork.json")


def test_a_cycle_beside_a_join_at_which_the_law_jumps_is_not_certified():
    """Its equations hold on the continuation of a half whose bounce lies 5e-35 beyond its end, on the other half."""
    halves = [("upper", "2*cos(theta)", "sin(theta)"), ("lower", "-2*cos(theta)", "-sin(theta)")]
    parts = [{"name": name, "x": x, "y": y, "from": "0", "to": "pi"} for name, x, y in halves]
    law = "-lam*eta + (1 - cos(theta) + sin(theta) - cos(theta)/10^33)/10"
    found = find_cycles(Scene.of({"component": parts, "lam": "1/2", "law": law}), period=2)

    assert not any(certify(cycle, digits=30).certified for cycle in found if min(map(abs, cycle.theta)) < 1e-9)
