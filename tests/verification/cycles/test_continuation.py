"""Branches of cycles: against closed forms, certified values, published maps, and general laws."""

import json
from itertools import islice
from math import pi

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.optimize import fsolve
from sympy import Rational, cos, sin, sqrt, tan
from sympy import pi as exact_pi

from symbolic.cycles.polygons import saddle_node
from symbolic.cycles.thresholds import alpha_tilde, lambda_c
from symbolic.tables import circle, cuspless, egg, ellipse, polar
from symbolic.tables.table import alpha as letter
from symbolic.tables.table import lam as lam_letter
from symbolic.tables.table import theta
from verification.app.commands.follow import command as follow
from verification.cycles.arc import End, Steps
from verification.cycles.branch import branch
from verification.cycles.cascade import cascade as followed_in_lam
from verification.cycles.chords import Chords
from verification.cycles.recurrence import BifurcationKind, cubic, delayed, henon, logistic
from verification.cycles.switching import switched
from verification.cycles.systems import reflected, rotations
from verification.named.events import proof_of
from verification.named.locate import locate

ALPHA = Rational(2, 25)
TABLE = egg(3).at(alpha=ALPHA)
TRIANGLE = pi / 3 * np.array([1.0, 3.0, 5.0])
FOUR = np.array([0.09106847, -2.81341037, -0.09106847, 2.81341037])  # attracts at lam = 0.2
LOGISTIC = [3.0, 1 + 6**0.5, 3.5440903595, 3.5644072661, 3.5687594195]  # [May1976]; OEIS A086180, A086181, A091517
HENON = [0.3675, 0.9125, 1.0258554, 1.0511257, 1.0565638]  # [DerridaGervoisPomeau1979]; checked twice below


def cascade(one, interval, count):
    """The period-doubling bifurcations, found by switching from each branch to the next."""
    found = []
    for _ in range(count):
        event = next(e for e in one.events if e.kind is BifurcationKind.FLIP)
        found.append(event)
        (one,) = switched(one, event, interval)
    return found


@pytest.mark.parametrize("alpha", ["1/50", "1/20", "2/25", "1/10"])
def test_the_branch_of_triangles_passes_its_fold_where_the_closed_form_says(alpha):
    one = branch(Chords(egg(3).at(alpha=alpha), (0, 0, 0)), TRIANGLE, "lam", 1.0, (0.0, 1.0))
    (fold,) = [event for event in one.events if event.kind is BifurcationKind.FOLD]

    assert abs(fold.value - float(saddle_node().subs(letter, Rational(alpha)))) < 1e-12
    assert one.values[0] == one.values[-1] == 1.0
    assert one.ends[0][0] is one.ends[1][0] is End.INTERVAL
    at_the_vertices = one.points[0] if abs(np.cos(3 * one.points[0].z[0]) - 1) < 1e-9 else one.points[-1]
    assert np.allclose(np.cos(3 * at_the_vertices.z[:3]), 1)  # the paper's conjecture: the two kinds annihilate


@pytest.mark.slow
def test_the_events_of_the_cascade_are_the_located_ones():
    one = branch(Chords(TABLE, (0,) * 4), FOUR, "lam", 0.2, (0.0, 0.6))
    (pitchfork,) = one.events
    two, mirrored = switched(one, pitchfork, (0.0, 0.6))
    doublings = cascade(two, (0.0, 0.6), 4)
    members = [each.lam for each in islice(followed_in_lam(ALPHA), 4)]

    assert pitchfork.kind is BifurcationKind.PITCHFORK
    assert abs(pitchfork.value - float(locate("symmetry-breaking", 15, alpha=ALPHA).value)) < 1e-12
    assert [event.value for event in doublings] == pytest.approx(members, abs=1e-12)
    assert all(event.form.supercritical for event in doublings)
    assert [e.value for e in mirrored.events] == pytest.approx([e.value for e in two.events], abs=1e-12)
    assert proof_of(pitchfork, 20).proved
    proof = proof_of(doublings[0], 20)
    assert proof.proved
    assert abs(float(proof.value.mid()) - doublings[0].value) < 1e-13


@pytest.mark.parametrize(
    ("ring", "start", "parameter", "value", "interval", "fixed", "published", "digits"),
    [
        (logistic(1), [0.6], "r", 2.5, (2.0, 3.6), {}, LOGISTIC, 1e-9),
        (henon(1), [1.2], "a", 0.1, (-0.1, 1.1), {"b": 0.3}, HENON, 1e-7),
    ],
)
def test_the_cascades_of_published_maps_are_found(ring, start, parameter, value, interval, fixed, published, digits):
    one = branch(ring, np.array(start), parameter, value, interval, fixed)
    found = cascade(one, interval, 5)

    assert [event.value for event in found] == pytest.approx(published, abs=digits)
    assert all(event.form.supercritical for event in found)
    assert abs(found[0].value - (3 if parameter == "r" else 3 * (1 - 0.3) ** 2 / 4)) < 1e-12


def test_no_pitchfork_is_lost_where_the_whole_ring_is_singular():
    """The corrector of the whole ring is singular there and missed the event; half of the cycle is regular."""
    one = branch(Chords(egg(5).at(alpha="53/2000"), (0, 0)), np.array([0.0, pi]), "lam", 0.0, (0.0, 1.0))
    (four,) = switched(one, one.events[0], (0.0, 1.0))
    (pitchfork,) = four.events
    proof = proof_of(pitchfork, 20)

    assert pitchfork.kind is BifurcationKind.PITCHFORK
    assert pitchfork.located
    assert proof.proved
    assert abs(float(proof.value.mid()) - pitchfork.value) < 1e-12


def test_henons_second_doubling_has_a_closed_form():
    """On the 2-cycle `x1 + x2 = (1-b)/a` and `a**2*x1*x2 = (1-b)**2 - a`; `tr M = 4*a**2*x1*x2 + 2*b = -1 - b**2`."""
    for b in (0.0, 0.2, 0.3):
        one = branch(henon(1), np.array([1.0]), "a", 0.1, (-0.1, 1.4), {"b": b})
        (two,) = switched(one, one.events[-1], (-0.1, 1.4))
        flip = next(e for e in two.events if e.kind is BifurcationKind.FLIP)

        assert abs(flip.value - ((1 - b) ** 2 + (1 + b) ** 2 / 4)) < 1e-10


def test_henons_later_doublings_agree_with_single_shooting():
    """A second method without rings: `tr + det + 1 = 0` at a fixed point of the iterated map."""
    one = branch(henon(1), np.array([1.2]), "a", 0.1, (-0.1, 1.1), {"b": 0.3})

    def equations(unknown, n):
        x, y, a = unknown
        slope = np.eye(2)
        for _ in range(n):
            slope = np.array([[-2 * a * x, 1.0], [0.3, 0.0]]) @ slope
            x, y = 1 - a * x * x + y, 0.3 * x
        return [x - unknown[0], y - unknown[1], np.trace(slope) + 1 + np.linalg.det(slope)]

    for event in cascade(one, (-0.1, 1.1), 5)[2:]:
        n = len(event.x)
        start = [event.x[0] + 1e-4, 0.3 * event.x[-1], event.value - 1e-5]
        found, _, success, _ = fsolve(equations, start, args=(n,), xtol=1e-13, full_output=True)

        assert success == 1
        assert found[2] == pytest.approx(event.value, abs=1e-10)


def test_the_window_of_period_three_opens_where_it_is_published():
    """At 1 + sqrt(8) [Myrberg1958]."""
    one = branch(logistic(3), np.array([0.1494, 0.4880, 0.9594]), "r", 3.84, (3.5, 3.9))
    fold = next(event for event in one.events if event.kind is BifurcationKind.FOLD)

    assert abs(fold.value - (1 + 8**0.5)) < 1e-12


def test_the_multipliers_of_henons_fixed_point():
    """[Henon1976]: at a = 1.4, b = 0.3 the fixed point 0.63135448 has slopes 0.15594632 and -1.92373886."""
    one = branch(henon(1), np.array([0.63]), "a", 1.4, (1.0, 1.4), {"b": 0.3})
    last = max(one.points, key=lambda point: point.z[-1])
    multipliers = one.system.spectrum(last.z).multipliers

    assert last.z[0] == pytest.approx(0.63135448, abs=1e-8)
    assert sorted(m.real for m in multipliers) == pytest.approx([-1.92373886, 0.15594632], abs=1e-8)


def test_a_neimark_sacker_bifurcation_is_named_where_there_is_one():
    """The delayed logistic map's fixed point at r = 2: multipliers exp(+-i*pi/3). [AronsonChoryHallMcGehee1982]."""
    one = branch(delayed(1), np.array([0.4]), "r", 1.7, (1.2, 2.2))
    (torus,) = one.events

    assert torus.kind is BifurcationKind.TORUS
    assert abs(torus.value - 2) < 1e-12
    assert abs(np.angle(one.system.spectrum(torus.point.z).multipliers[0])) == pytest.approx(pi / 3, abs=1e-9)


def test_a_branch_point_without_a_fold_is_switched_at():
    """In `x -> r*x - x**3` at r = 1 the branch `x = 0` meets `x = +-sqrt(r - 1)`."""
    one = branch(cubic(1), np.array([0.0]), "r", 0.5, (0.2, 1.5))
    (crossing,) = one.events
    both = switched(one, crossing, (0.2, 1.5))

    assert crossing.kind is BifurcationKind.BRANCH_POINT
    assert abs(crossing.value - 1) < 1e-12
    for side in both:
        assert side.points[-1].z[0] ** 2 == pytest.approx(side.points[-1].z[1] - 1, abs=1e-10)
    assert both[0].points[-1].z[0] * both[1].points[-1].z[0] < 0


def test_the_determinant_is_the_product_of_the_areas_of_the_bounces_not_a_power_of_lam():
    one = branch(Chords(TABLE, (0, 0, 0)), TRIANGLE, "lam", 1.0, (0.3, 1.0), steps=Steps(largest=0.3))
    for point in one.points:
        lam = point.z[-1]
        _, eta = one.system.recurrence.angles(point.z[:-1], {"lam": lam})
        product = float(np.prod(lam * np.cos(lam * eta) / np.cos(eta)))
        determinant = point.tests["volume"] + 1

        assert determinant == pytest.approx(product, rel=1e-10)
        assert determinant >= lam**3 - 1e-12


def test_the_cycle_born_at_the_cuspless_doubling_ends_on_the_corner_orbit():
    """The doubling is subcritical, so its cycle exists below it, down to the border collision at `lambda-star`."""
    one = branch(Chords(cuspless, (1, 0)), np.zeros(2), "lam", 0.2, (0.0, 1.0))
    (doubling,) = one.events
    (two,) = switched(one, doubling, (0.0, 1.0))
    (collision,) = two.events
    beyond = switched(two, collision, (0.0, 1.0))

    assert abs(doubling.value - float(lambda_c())) < 1e-12
    assert doubling.form.supercritical is False
    assert collision.kind is BifurcationKind.BORDER_COLLISION
    assert abs(collision.value - float(locate("lambda-star", 15).value)) < 1e-12
    assert sorted(b.system.recurrence.components for b in beyond) == [(0, 0, 0, 0), (0, 0, 1, 0), (1, 0, 0, 0)]
    assert all(b.values.min() > collision.value for b in beyond)  # all four exist on one side only


def run(*words):
    return CliRunner().invoke(follow, words, standalone_mode=False, catch_exceptions=True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--cycle", "triangle", "--lam", "1:0.3"), "no interval of contractions; accepted: LOW:HIGH"),
        (("--start", "0.1,1.7", "--lam", "0.1:0.3"), "the start is no cycle at lam = 0.1"),
        (("--start", "0.1", "--lam", "0.1:0.3"), "a cycle has at least 2"),
        (("--cycle", "square", "--lam", "0.1:0.3"), "no cycle with a name; accepted: diameter, triangle"),
        (("--lam", "0.1:0.3"), "one start is needed"),
        (("--cycle", "triangle", "--lam", "0.4:0.9"), "outside the interval"),
        (("--start", "1e400,2", "--lam", "0:1"), "inf is no boundary parameter"),
        (("--cycle", "triangle", "--lam", "0.5", "--shape", "0.05:0.2"), "--shape: egg: alpha = 1/5 makes the table"),
        (("--cycle", "triangle", "--lam", "0.4:0.5", "--shape", "0.05:0.1"), "one number between 0 and 1"),
        (("--cycle", "triangle", "--lam", "0.2", "--shape", "0.05:0.1"), "does not reach lam = 0.2"),
        (("--cycle", "triangle", "--lam", "0.5", "--shape", "0.09:0.1"), "alpha = 0.08 lies outside the interval"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(words, said):
    result = run("egg", "--alpha", "0.08", *words)

    assert isinstance(result.exception, ValueError)
    assert said in str(result.exception)


def test_the_shape_is_followed_to_the_fold_and_the_doubling_of_the_closed_forms(tmp_path):
    """At `lam = 1/2` the triangles fold where `tan(pi/18) = 3*alpha/sqrt(1 - alpha**2)`."""
    file = tmp_path / "shape.json"
    found = {}
    for cycle, alpha in (("triangle", "0.08"), ("diameter", "0.05")):
        words = ("egg", "--alpha", alpha, "--cycle", cycle, "--lam", "1/2", "--shape", "0.04:0.1", "--digits", "20")
        run(*words, "--json", str(file))
        (one,) = json.loads(file.read_text())["branches"]
        (found[cycle],) = one["events"]
        assert one["parameter"] == "alpha"
    slope = tan(exact_pi / 18)
    expected = {"triangle": slope / sqrt(9 + slope**2), "diameter": alpha_tilde().subs(lam_letter, Rational(1, 2))}

    assert {name: event["event"] for name, event in found.items()} == {
        "triangle": "fold",
        "diameter": "period doubling",
    }
    for name, event in found.items():
        proof = event["certificate"]
        assert proof["certified"]
        assert abs(Rational(proof["value"]) - expected[name].evalf(40)) < Rational("1e-20")


def test_a_table_without_a_shape_has_none_to_follow():
    result = run("circle", "--cycle", "diameter", "--lam", "0.5", "--shape", "0:1")

    assert "--shape: circle has no shape parameter; accepted: the ellipse, the egg, and tables" in str(result.exception)


def test_a_start_in_a_family_of_cycles_is_refused_as_one():
    result = run("circle", "--cycle", "diameter", "--lam", "0:1")

    assert isinstance(result.exception, ValueError)
    assert "one of a family or at a bifurcation" in str(result.exception)


def test_a_branch_that_meets_a_join_says_where_it_stopped_and_keeps_its_points(tmp_path):
    file = tmp_path / "branch.json"
    start = "-0.337,0.2,0.337,-0.2"
    result = run(
        *("cuspless", "--start", start, "--components", "wall,arc,wall,arc", "--at", "0.0797", "--lam", "0:0.093"),
        *("--json", str(file)),
    )
    found = json.loads(file.read_text())["branches"][0]

    assert result.return_value == 1
    assert "the branch stopped at lam = 0.07121" in result.output
    assert "left the wall" in result.output
    assert len(found["points"]) > 5
    assert found["events"][-1]["event"] == "border collision"


def test_curves_of_the_events_come_with_their_special_points(tmp_path):
    file = tmp_path / "curves.json"
    words = ("egg", "--alpha", "0.07", "--cycle", "diameter", "--lam", "0:1", "--curves", "--json", str(file))
    result = run(*words)
    (curve,) = json.loads(file.read_text())["curves"]

    assert result.return_value == 0
    assert "1:2 resonance at (0.055385138, 1.000000000)" in result.output  # 1/(9 + sqrt(82))
    assert [point["what"] for point in curve["special"]] == ["1:2 resonance"]


WAVES = polar(1 + cos(6 * theta) / 50 + sin(9 * theta) / 100, "waves")


@pytest.mark.parametrize(
    ("table", "turns", "mirror"),
    [
        (egg(3), 3, True), (egg(13), 13, True), (egg(24), 24, True), (ellipse, 2, True), (circle, 12, True),
        (cuspless, 1, True), (WAVES, 3, False), (polar(1 + cos(theta - 1) / 9, "aside"), 1, False),
    ],
    ids=lambda value: getattr(value, "name", None),
)  # fmt: skip
def test_turns_of_a_table_are_counted_up_to_any_order_and_its_mirror_apart(table, turns, mirror):
    """A turn by `2*pi/n` keeps `sum c_k exp(i*k*theta)` if `n` divides all differences of the occurring `k`."""
    assert rotations(table) == turns
    assert reflected(table) is mirror
