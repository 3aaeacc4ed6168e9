"""A branch of an unstable manifold in balls, and the steps by which two basins are said to lie at a saddle's."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb

from symbolic.tables.scene import Scene
from verification.cycles.recurrence import Closure
from verification.paper.egg.basins import beyond_the_crisis
from verification.proofs.global_dynamics import branch as branches
from verification.proofs.global_dynamics import common_boundary
from verification.proofs.global_dynamics.branch import Branch, exact, unstable_branch
from verification.proofs.global_dynamics.common_boundary import CHECKS, SMALL, Disc, entered_around
from verification.proofs.manifolds.enclosed import TooWideError

FOUND = beyond_the_crisis()


def series(*coefficients):
    return SimpleNamespace(c=[acb(x) for x in coefficients])


@pytest.mark.parametrize("side", [1, -1])
def test_points_of_a_branch_are_those_of_its_series_within_the_error_on_its_side(side):
    """Of `1 + 3*z` and `2 - z + z**2` with the factor 4, from `z = 4**(low - 1)` on; the angle is their difference."""
    made = SimpleNamespace(factor=acb(4), pair=lambda: (series(1, 3), series(2, -1, 1)))
    map = SimpleNamespace(over=lambda _: SimpleNamespace(angle=lambda before, here: (here - before, None)))
    lows, highs = [0.0, 0.5, 0.25], [0.0, 0.75, 1.0]
    points = Branch(made, arb(2) ** -20, 100, map).points(side, lows, highs)
    assert len(points) == 3
    for (theta, phi), low, high in zip(points, lows, highs, strict=True):
        wanted = []
        for share in np.linspace(low, high, 9):
            z = side * 4 ** (share - 1)
            wanted.append((1 + 3 * z, 2 - z + z * z - (1 + 3 * z)))
        for ball, some, slack in zip((theta, phi), np.transpose(wanted), (2.0**-20, 2.0**-19), strict=True):
            least, most = float(ball.lower()), float(ball.upper())
            assert least < some.min() - 0.9 * slack
            assert some.max() + 0.9 * slack < most
            assert most - least < 3 * np.ptp(some) + 2.2 * slack


STEPS = {
    "": None,
    "another": "that of another cycle",
    "one": "not above 1",
    "below": "not above 1",
    "wide": "not above 1",
}


@pytest.mark.parametrize("wrong", STEPS)
@pytest.mark.parametrize("around", [None, "saddle"])
def test_a_branch_is_that_of_the_saddle_said_with_a_multiplier_above_1(monkeypatch, wrong, around):
    factor = {"one": acb(1), "below": acb(0.5), "wide": acb(arb(1.5, 0.5))}.get(wrong, acb(1.5))
    made, asked = SimpleNamespace(factor=factor), []

    def note(name, value):
        return lambda *given: asked.append((name, *given)) or value

    monkeypatch.setattr(branches, "scale", note("scale", SimpleNamespace(unit="unit", chief="chief")))
    monkeypatch.setattr(branches, "complex_balls", lambda bits: bits)
    monkeypatch.setattr(branches, "enclosed_saddle", note("saddle", "at"))
    monkeypatch.setattr(branches, "one_cycle", note("one", wrong != "another"))
    monkeypatch.setattr(branches, "enclosed", note("enclosed", made))
    monkeypatch.setattr(branches, "remainder", note("remainder", "error"))
    map = SimpleNamespace(over=lambda bits: ("over", bits))
    if STEPS[wrong] and (wrong != "another" or around):
        with pytest.raises(TooWideError, match=STEPS[wrong]):
            unstable_branch("orbit", map, Fraction(1, 2), 200, around)
        return
    assert unstable_branch("orbit", map, Fraction(1, 2), 200, around) == (made, "error", 200, map)
    said = [(name, *given) for name, *given in asked if name not in ("one", "saddle")]
    assert said == [
        ("scale", "orbit", map, 0.5, True, 16),
        ("enclosed", "at", True, 50, "unit", "chief"),
        ("remainder", made, 16),
    ]
    assert [given for name, *given in asked if name == "one"] == ([[around, "at"]] if around else [])
    assert [given[:2] for name, *given in asked if name == "saddle"] == [["orbit", ("over", 200)]]
    assert exact(Fraction(1, 3)).real.contains(arb(1) / 3)
    assert exact(Fraction(1, 3)).imag == 0


WRONG = {
    "": set(), "smooth": {"smooth"}, "disc 0": {"discs"}, "disc 1": {"discs"}, "apart": {"apart"},
    "saddle": {"saddle", "first", "second"}, "point": {"first", "second"}, "first": {"first"}, "second": {"second"},
}  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("error", [TooWideError("some", "thing"), ArithmeticError()])
def test_each_step_that_fails_leaves_its_items_of_a_common_boundary_open(monkeypatch, wrong, error):
    stated, asked = replace(FOUND), []
    stated.__dict__.update(map="map", discs=("first disc", "second disc"))

    def points(side, low, high):
        if wrong == "point":
            raise error
        asked.append((side, low, high))
        return [("at", low[0])]

    def branch(*given):
        if wrong == "saddle":
            raise error
        return SimpleNamespace(points=points)

    def attracts(map, one, turn):
        asked.append((map, one, turn))
        return wrong != f"disc {int(one == 'second disc')}"

    def enters(scene, lam, point, one, turns):
        assert (scene, lam, turns) == (FOUND.scene, FOUND.lam, FOUND.turns)
        asked.append((point, one))
        return wrong != one.partition(" ")[0]

    monkeypatch.setattr(common_boundary, "smooth", lambda _: wrong != "smooth")
    monkeypatch.setattr(common_boundary, "attracts", attracts)
    monkeypatch.setattr(common_boundary, "enters", enters)
    monkeypatch.setattr(common_boundary, "unstable_branch", branch)
    monkeypatch.setattr(common_boundary.CommonBoundary, "_apart", lambda _: wrong != "apart")
    checks = stated.checks
    assert {name for name, held in checks.items() if held is not True} == WRONG[wrong]
    assert set(checks) == set(CHECKS)
    assert all(held in (True, None) for name, held in checks.items() if name != "smooth")
    assert stated.proved is (wrong == "")
    if not wrong:
        turns = [2 * np.pi * float(part) for part in FOUND.turn]
        assert asked[:2] == [("map", "first disc", turns[0]), ("map", "second disc", turns[1])]
        (one, other), side = FOUND.starts, FOUND.side
        assert asked[2:] == [(side, [one], [one]), (("at", one), "first disc"), (side, [other], [other]),
                             (("at", other), "second disc")]  # fmt: skip


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [((-0.5, 0.25), (0.25, 0.4375), True), ((-0.5, 0.25), (0.25, 0.5), False), ((-0.5, 0.25), (0.25, 0.5625), False),
     ((0.0, 0.25), (0.0, 0.25), False), ((0.0, 0.125), (0.5, 0.25), True)],
)  # fmt: skip
def test_discs_are_apart_where_their_exit_angles_leave_a_gap(one, other, apart):
    discs = [SimpleNamespace(centre=(9.0, middle), rectangle=(7.0, half)) for middle, half in (one, other)]
    for pair in (discs, discs[::-1]):
        stated = replace(FOUND)
        stated.__dict__["discs"] = tuple(pair)
        assert stated._apart() is apart


def test_a_rectangle_about_a_disc_holds_its_edge_and_little_more():
    one = Disc((1.0, 2.0), ((0.5, -0.25), (0.125, 2.0)), 0.75)
    for half, row in zip(one.rectangle, one.inverse, strict=True):
        assert 0 < half / (0.75 * np.hypot(*row)) - 1 < 1e-8


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"side": 0}, "side = 0"), ({"side": 2}, "side = 2"), ({"lam": Fraction(0)}, "lam = 0"),
        ({"lam": Fraction(1)}, "lam = 1"), ({"turn": (Fraction(1, 3), Fraction(1, 4))}, "no symmetry"),
        ({"turn": (Fraction(1, 2), Fraction(2, 3))}, "no symmetry"),
        ({"scene": Scene("egg", alpha="0.08", law="-lam*sin(eta)")}, "one smooth closed curve"),
        ({"scene": Scene("cuspless")}, "one smooth closed curve"),
        ({"saddle": replace(FOUND.saddle, start=FOUND.saddle.start * 2)}, "no symmetry"),
        ({"saddle": replace(FOUND.saddle, closure=Closure(-1, FOUND.saddle.closure.shift))}, "no symmetry"),
        ({"saddle": replace(FOUND.saddle, closure=Closure(1, (1, 4)))}, "no symmetry"),
    ],
)  # fmt: skip
def test_each_hypothesis_of_a_common_boundary_is_asked_when_it_is_stated(changes, said):
    with pytest.raises(ValueError, match=said):
        replace(FOUND, **changes)
    again = replace(FOUND, side=-FOUND.side, turn=(Fraction(4, 3), Fraction(-1, 3)))
    assert again.turns == (0, Fraction(1, 3), Fraction(2, 3))


@pytest.mark.parametrize("which", [0, 1])
def test_a_small_disc_is_followed_that_holds_all_points_so_near_to_a_phase_point(monkeypatch, which):
    asked = []
    monkeypatch.setattr(common_boundary, "enters", lambda *given: asked.append(given) or True)
    stated = replace(FOUND)
    stated.__dict__["discs"] = ("first", "second")
    assert entered_around(stated, which, Fraction(1, 4), Fraction(-3, 8))
    ((scene, lam, start, disc, turns),) = asked
    assert (scene, lam, disc, turns) == (FOUND.scene, FOUND.lam, ("first", "second")[which], FOUND.turns)
    for ball, middle in zip(start, (0.25, -0.375), strict=True):
        assert float(ball.mid()) == middle
        assert SMALL <= float(ball.rad()) < 1.01 * SMALL
