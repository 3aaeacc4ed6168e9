"""Curves in two parameters: against closed forms, single branches, and universal constants at their ends."""

import json
from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner
from sympy import Rational, lambdify

from symbolic import Scene
from symbolic.cycles.polygons import saddle_node
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables import egg
from symbolic.tables.table import alpha as alpha_letter
from symbolic.tables.table import lam as lam_letter
from verification.app.commands.follow import command as follow
from verification.arithmetic.balls import FLOAT64
from verification.cycles.arc import CurvePoint, Steps
from verification.cycles.branch import Event, branch
from verification.cycles.chords import Chords
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import MIRROR, BifurcationKind, Closure, henon
from verification.cycles.switching import CodimensionTwo, curve
from verification.cycles.systems import CriticalCycles, coefficients
from verification.named.curves import (
    accumulation_curve,
    cascade,
    contracting_up_to,
    double_one,
    expanding_cycle,
    fold,
    largest_shape,
)
from verification.named.events import Plane, curve_of

CERTIFIED_END = 0.3935204685  # at alpha = 0.08, from certified doublings: `named.curves.accumulation_curve`
AREA_PRESERVING = 8.721097200  # Feigenbaum's ratio for area-preserving maps [GreeneMacKayVivaldiFeigenbaum1981]


@pytest.fixture(scope="module")
def curves():
    return list(cascade(3, 32))


@pytest.mark.slow
@pytest.mark.parametrize(("K", "p", "q"), [(3, 1, 3), (4, 1, 4), (5, 2, 5)])
def test_the_fold_of_a_polygon_is_followed_along_its_closed_form(K, p, q):
    plane = fold(K, p, q).curve.plane
    expected = lambdify(alpha_letter, saddle_node(K, p, q))(plane[:, 0])

    assert np.max(np.abs(plane[:, 1] - expected)) < 1e-12
    assert plane[-1, 0] == largest_shape(K)


@pytest.mark.slow
def test_the_first_doubling_is_followed_along_alpha_tilde(curves):
    plane = curves[0].curve.plane
    expected = lambdify(lam_letter, alpha_tilde())(plane[:, 1])

    assert np.max(np.abs(plane[:, 0] - expected)) < 1e-12
    assert plane[0, 1] == 1.0
    assert abs(plane[-1, 1]) < 1e-12


@pytest.mark.slow
def test_every_doubling_ends_in_a_resonance_where_nothing_is_lost(curves):
    for each in curves:
        (end,) = each.special

        assert end.kind is CodimensionTwo.ONE_TWO
        assert end.parameters[1] == 1.0


@pytest.mark.slow
def test_the_resonances_pile_up_as_in_area_preserving_maps(curves):
    ends = [c.special[0].parameters[0] for c in curves if c.kind is BifurcationKind.FLIP and c.period > 2]
    gaps = [b - a for a, b in pairwise(ends)]

    assert gaps[-2] / gaps[-1] == pytest.approx(AREA_PRESERVING, abs=0.01)


@pytest.mark.slow
def test_the_accumulation_is_that_of_the_certified_cascade(curves):
    found = accumulation_curve(curves, np.array([0.08]))

    assert abs(found.lam[0] - CERTIFIED_END) < found.error[0]
    assert 0 < found.error[0] < 1e-5


def test_henons_flip_and_fold_meet_nowhere_and_end_in_resonances():
    """Both are parabolas; at b = -1, where areas are kept, the flip ends in a 1:2 and the fold in a 1:1 resonance."""
    box, long = ((-1.0, 0.9), (-2.0, 4.0)), Steps(largest=2.0)
    flips = curve(henon(1), BifurcationKind.FLIP, np.array([0.95]), ("b", "a"), (0.3, 0.37), box, steps=long)
    folds = curve(henon(1), BifurcationKind.FOLD, np.array([2.8]), ("b", "a"), (0.3, -0.12), box, steps=long)

    assert np.allclose(flips.plane[:, 1], 3 * (1 - flips.plane[:, 0]) ** 2 / 4, atol=1e-10)
    assert np.allclose(folds.plane[:, 1], -((1 - folds.plane[:, 0]) ** 2) / 4, atol=1e-10)
    assert [d.kind for d in flips.special] == [CodimensionTwo.ONE_TWO]
    assert [d.kind for d in folds.special] == [CodimensionTwo.ONE_ONE]


def test_the_coefficients_are_those_of_the_certified_normal_form():
    """A second program, whose eigenvectors have last entry 1 instead of root mean square 1."""
    table = egg(3).at(alpha="7/100")
    one = branch(Chords(table, (0, 0)), np.array([0.0, np.pi]), "lam", 0.1, (0.0, 1.0))
    (flip,) = one.events
    at = Linearised(Problem(table, (0, 0), BifurcationKind.FLIP, "lam"), FLOAT64, [*map(float, flip.x), flip.value])
    v = np.array(at.critical.right)
    expected = at.normal_form(FLOAT64).branch / np.mean(v**2)

    assert coefficients(flip.ring, flip.x, {"lam": flip.value}, BifurcationKind.FLIP, "lam").branch == pytest.approx(
        expected, rel=1e-9
    )


def test_a_cycle_of_the_egg_expands_areas_although_lam_is_below_one():
    """So a determinant `det = lam**p < 1` cannot be assumed; `lam` itself is bounded instead."""
    proved, determinant = expanding_cycle()

    assert proved
    assert determinant > Rational(13, 10)
    assert [contracting_up_to(Rational(k, 50)) for k in (1, 4)] == [0.765625, 0.328125]


@pytest.mark.slow
def test_a_double_multiplier_one_below_lam_one_is_proved():
    """Next to it lies a Neimark-Sacker window, some 1e-13 wide, with complex multipliers of modulus 1."""
    found = double_one()

    assert found.status.name == "UNIQUE"
    assert found.zero[-1] < 0.97
    assert 0.0687 < found.zero[-2] < 0.0688


@pytest.mark.parametrize("kind", [BifurcationKind.FOLD, BifurcationKind.FLIP])
@pytest.mark.parametrize("turn", [1, -1])
def test_the_matrix_of_a_critical_cycle_is_that_of_the_difference_quotients(kind, turn):
    z = np.array([0.3, 2.9, -0.4, 0.05, 0.3])
    system = CriticalCycles.near(Chords(egg(3), (0, 0, 0), Closure(turn, (1, 31))), kind, ("alpha", "lam"), z)
    _, matrix = system.linear(z)
    h = 1e-6
    steps = [(system.linear(z + h * e)[0] - system.linear(z - h * e)[0]) / (2 * h) for e in np.eye(len(z))]

    assert np.max(np.abs(np.array(steps).T - matrix)) < 1e-6 * (1 + np.max(np.abs(matrix)))


def test_an_even_egg_has_no_cascade_of_diameters():
    with pytest.raises(ValueError, match="K = 4 is even"):
        next(cascade(4))


def run(*words):
    return CliRunner().invoke(follow, words, standalone_mode=False, catch_exceptions=True)


@pytest.mark.slow
def test_an_event_is_followed_in_any_second_parameter_and_from_either_of_the_two(tmp_path):
    """The same curve, from the event in lam at b = 1/40 and from the event in b at lam = 1/10."""
    start, ends = ("--start", "0,3.14159265"), []
    one = ("--shape", "b=1/40", "--lam", "0:0.3", "--at", "1/10", "--curves", "b=0:1/30")
    other = ("--shape", "b=1/40:0..1/30", "--shape", "b=1/60:1/30", "--lam", "1/10", "--curves", "lam=0:0.3")
    for number, words in enumerate((one, other)):
        file = tmp_path / f"{number}.json"
        assert (
            run("--polar", "1 + b*cos(5*theta)", *start, *words, "--points", "60", "--json", str(file)).return_value
            == 0
        )
        (curve,) = json.loads(file.read_text())["curves"]
        ends += [sorted([curve["b_lam"][0], curve["b_lam"][-1]])]

    assert np.allclose(ends[0], ends[1], atol=1e-9)
    assert [lam for _, lam in ends[0]] == [0.3, 0.0]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("circle", "--curves"), "a second parameter is needed with circle"),
        (("egg", "--alpha", "0.07", "--curves", "b=0:1"), "b is no second parameter here; accepted: NAME=LOW:HIGH"),
        (("egg", "--alpha", "0.07", "--curves", "alpha=1/20"), "is no interval"),
    ],
)
def test_a_second_parameter_that_is_none_is_refused_by_name(words, said):
    result = run(*words, "--start", "0,3.14159265", "--lam", "0:1", "--at", "0.1")

    assert said in str(result.exception)


def test_a_symmetry_that_a_table_has_at_one_value_alone_gives_a_pitchfork_no_curve():
    """The half cycle's equations use a mirror symmetry, which the neighbouring tables do not have."""
    half = Chords(egg(3).at(alpha="2/25"), (0, 0), MIRROR)
    x = np.array([0.3, 2.9])
    event = Event(BifurcationKind.PITCHFORK, CurvePoint(np.append(x, 0.2), np.zeros(3), 0.0, {}), half, x)
    lopsided = Scene.of({"polar": "1 + b*sin(theta)", "shape": {"b": "0"}})

    assert curve_of(event, Plane.of(lopsided, "b", ("0", "1/10")), (0.0, 0.2)) is None


def test_a_parameter_of_a_law_that_depends_on_the_place_spans_a_plane_and_one_that_is_no_law_there_is_refused():
    scene = Scene("circle", law="-lam*eta - b*cos(theta)*sin(2*eta)", b="1/10")

    assert Plane.of(scene, "b", ("0", "1/4")).two == ("b", "lam")
    with pytest.raises(ValueError, match="law = "):
        Plane.of(scene, "b", ("0", "2"))
