"""Questions on a scene: what they answer agrees with closed forms, and a wrong one is told in a sentence."""

from functools import cache

import pytest
from sympy import Rational

from symbolic import Scene
from symbolic.cycles.polygons import saddle_node
from symbolic.tables.table import alpha
from verification.named.questions import certify, find_cycles, follow

EGG = Scene("egg", alpha="2/25", lam="1/2")


@cache
def triangles():
    return find_cycles(EGG, period=3)


def test_cycles_are_chosen_by_what_they_are():
    orbits = triangles()

    assert {orbit.period for orbit in orbits} == {3}
    assert len(orbits.stable) + len(orbits.unstable) == len(orbits)
    assert len(orbits.stable) == 2  # one each way round; paper, section 6.4
    assert orbits.of(3)[:2].orbits == orbits.orbits[:2]
    assert len(orbits.of(2)) == 0


def test_a_branch_is_followed_to_its_fold_and_the_fold_is_certified():
    branch = follow(triangles().stable[0], lam=("0.37", "1"))
    (fold,) = branch.folds
    found = certify(fold, digits=25)
    exact = saddle_node().subs(alpha, Rational(2, 25))

    assert found.certified
    assert abs(Rational(found.value) - exact.evalf(40)) <= Rational(found.radius) + Rational(1, 10**39)
    assert branch.flips == branch.pitchforks == branch.border_collisions == ()
    assert str(found).endswith("certified)")


def test_a_parameter_of_ones_own_varies_as_the_paper_s_do():
    """The egg written as a radius with a letter of its own: the same fold of the triangles, and the same proof."""
    own = Scene.of({"polar": "1 + b*cos(3*theta)", "shape": {"b": "2/25"}, "lam": "1/2"})
    (fold,) = follow(find_cycles(own, period=3).stable[0], b=("0.03", "0.09")).folds
    (eggs,) = follow(triangles()[0], alpha=("0.03", "0.09")).folds

    assert fold.value == pytest.approx(eggs.value, abs=1e-12)
    assert certify(fold, digits=15).certified


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


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: find_cycles(EGG), "give one of"),
        (lambda: find_cycles(EGG, period=1), "accepted: integers from 2"),
        (lambda: follow(triangles()[0]), "one parameter varies"),
        (lambda: follow(triangles()[0], beta=(0, 1)), "accepted: lam, alpha"),
        (lambda: follow(triangles()[0], lam=("0.5", "0.4")), "first must be the smaller"),
        (lambda: follow(triangles()[0], lam="0.4"), "is no interval"),
    ],
)
def test_a_wrong_question_is_told_in_a_sentence(ask, says):
    with pytest.raises(ValueError, match=says):
        ask()
