"""What keeps a contact from being one of a table under a law: each reason alone, with tables and laws by hand."""

import math
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import pytest
from flint import arb
from sympy import Rational, Symbol, sqrt

from verification.cycles.recurrence import Closure
from verification.proofs.manifolds import proof
from verification.proofs.manifolds.known import SHAPE, table
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.proof import PIECES, PLACES, falling, objection
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Contact

PLAIN, THIRD, MIRROR, GLIDE = Closure(), Closure(1, (1, 3)), Closure(-1, (0, 1)), Closure(-1, (1, 3))


class Finding:
    """Whether a law is one, over a range of contractions that is kept."""

    def __init__(self, held):
        self.held, self.reason, self.asked = held, "it rises", []

    def __bool__(self):
        return self.held

    def __call__(self, ends):
        self.asked.append(ends)
        return self


class Law(SimpleNamespace):
    """A law that is known by its properties."""

    def __str__(self):
        return "a law"


def law(held=True, **altered):
    """One that nothing is said against but what is altered."""
    free = {"uniform": False, "parameters": (), "measured": False, "placed": False, "odd": True, "phi": "periodic"}
    return Law(**(free | altered), proof=Finding(held))


@pytest.fixture
def objected(monkeypatch):
    """What is said against a contact of two orbits that close in some way, on a table with some symmetries."""

    def said(law, closures=(PLAIN, PLAIN), sign=1, own=(), turn=1, parameter=0.5):
        monkeypatch.setattr(proof, "symmetries", lambda _: own)
        monkeypatch.setattr(proof, "is_periodic", lambda phi: phi == "periodic")
        map = Pinball(SimpleNamespace(name="a table"), turn=turn, law=law)
        first, second = (Orbit("an orbit", (0.1,), closure) for closure in closures)
        return objection(Contact(first, second, 3, sign, 0.1, 0.1, 0.5), map, parameter)

    return said


@pytest.mark.parametrize(
    ("closures", "sign", "own", "has"),
    [
        ((PLAIN, PLAIN), 1, (), True),
        ((THIRD, PLAIN), 1, (), False),
        ((PLAIN, THIRD), 1, (), False),
        ((PLAIN, THIRD), 1, (THIRD,), True),
        ((Closure(1, (4, 3)), PLAIN), 1, (Closure(1, (-2, 3)),), True),
        ((Closure(1, (2, 3)), PLAIN), 1, (THIRD,), False),
        ((GLIDE, PLAIN), 1, (THIRD, MIRROR), False),
        ((MIRROR, MIRROR), 1, (MIRROR,), True),
        ((PLAIN, PLAIN), -1, (), False),
        ((PLAIN, PLAIN), -1, (GLIDE,), False),
        ((PLAIN, PLAIN), -1, (MIRROR,), True),
        ((PLAIN, MIRROR), -1, (THIRD,), False),
    ],
)
@pytest.mark.parametrize("uniform", [True, False])
def test_the_table_needs_the_symmetries_by_which_orbits_close_and_the_mirror_of_a_contact(
    objected, closures, sign, own, has, uniform
):
    found = objected(law(uniform=uniform), closures, sign, own)
    assert found == ("" if has else "a table: the orbit closes by a turn or a mirror that the table does not have")


@pytest.mark.parametrize(
    ("altered", "given", "says"),
    [
        ({}, {}, ""),
        ({"parameters": ("k", "m")}, {}, "k, m is no number"),
        ({"measured": True}, {}, "arc length"),
        ({"placed": True}, {}, ""),
        ({"placed": True}, {"turn": 3}, "closes by turns of the table"),
        ({"placed": True, "phi": "another"}, {}, "closes by turns of the table"),
        ({"placed": True}, {"closures": (THIRD, PLAIN), "own": (THIRD,)}, "closes by turns of the table"),
        ({"placed": True}, {"closures": (PLAIN, THIRD), "own": (THIRD,)}, "closes by turns of the table"),
        ({"placed": True}, {"closures": (Closure(1, (3, 3)), PLAIN)}, ""),
        ({"placed": False}, {"turn": 3, "closures": (THIRD, PLAIN), "own": (THIRD,)}, ""),
        ({"odd": False}, {}, ""),
        ({"odd": False}, {"closures": (MIRROR, PLAIN), "own": (MIRROR,)}, "no odd function"),
        ({"odd": False}, {"closures": (PLAIN, MIRROR), "own": (MIRROR,)}, "no odd function"),
        ({"odd": False}, {"sign": -1, "own": (MIRROR,)}, "no odd function"),
        ({"odd": False}, {"sign": -1, "closures": (MIRROR, MIRROR), "own": (MIRROR,)}, "no odd function"),
        ({"odd": True}, {"sign": -1, "closures": (MIRROR, MIRROR), "own": (MIRROR,)}, ""),
        ({"held": False}, {}, "it rises"),
    ],
)
def test_each_reason_against_a_law_is_told_alone_and_none_counts_where_the_law_is_the_papers(
    objected, altered, given, says
):
    found = objected(law(**altered), **given)
    assert says in found
    assert bool(found) is bool(says)
    assert objected(law(**altered | {"uniform": True}), **given) == ""


NEAR = Rational(1, 10**6)


@pytest.mark.parametrize(
    ("parameter", "low", "high"),
    [(0.5, Rational(1, 2) - NEAR, Rational(1, 2) + NEAR), (0.0, Rational(0), NEAR), (1.0, 1 - NEAR, Rational(1))],
)
def test_a_law_is_proved_to_be_one_for_contractions_near_the_contacts_between_0_and_1(objected, parameter, low, high):
    asked = law()
    assert objected(asked, parameter=parameter) == ""
    assert asked.proof.asked == [(low, high)]


def test_no_law_is_asked_of_another_map_than_the_pinball_map():
    orbit = Orbit("mirrored", (0.1,), GLIDE)
    assert objection(Contact(orbit, orbit, 3, -1, 0.1, 0.1, 0.5), Henon(Rational(3, 10)), 0.5) == ""
    assert Fraction(*GLIDE.shift) == Fraction(1, 3)
    third = Orbit("a triangle", (0.1,), THIRD)
    assert objection(Contact(third, third, 3, -1, 0.1, 0.1, 0.5), table(SHAPE), 0.5) == ""


def ends(ball):
    """Of a ball, in float64."""
    return float(ball.lower()), float(ball.upper())


def pieces(some, end):
    """Whether balls follow one another without a gap from `-end` to `end`, each of the same width."""
    some = sorted(some, key=lambda ball: float(ball.mid()))
    met = all(a.overlaps(b) for a, b in pairwise(some))
    wide = {round(float(ball.rad()) * len(some) / end, 6) for ball in some}
    return met and wide == {1.0} and some[0].contains(-end) and some[-1].contains(end)


@pytest.mark.parametrize("placed", [True, False])
def test_a_law_falls_where_its_slope_is_negative_over_pieces_of_all_angles_and_places(monkeypatch, placed):
    asked, wrong = [], []

    def slope(eta, parameter, theta):
        asked.append((eta, theta))
        return None, arb(0) if any(eta.contains(a) and theta.contains(b) for a, b in wrong) else arb(-1)

    monkeypatch.setattr(proof, "law_kernel", lambda law: None)
    monkeypatch.setattr(proof, "load", lambda kernel, words: slope)
    given = SimpleNamespace(placed=placed, phi=Symbol("x") ** 2)
    assert falling(given, arb(0.5))
    angles, places = ({ends(pair[i]): pair[i] for pair in asked}.values() for i in (0, 1))
    assert pieces(angles, math.pi / 2)
    assert pieces(places, math.pi)
    turns = PLACES if placed else 1
    assert (len(places), len(angles)) == (turns, PIECES // turns)
    assert len({(ends(a), ends(b)) for a, b in asked}) == len(asked) == PIECES
    for a in (-1.57, 0.3, 1.57):
        for b in (-3.14, 3.14):
            wrong[:] = [(a, b)]
            assert not falling(given, arb(0.5))


def test_a_law_with_a_root_or_at_no_contraction_is_not_known_to_fall(monkeypatch):
    monkeypatch.setattr(proof, "law_kernel", lambda law: None)
    monkeypatch.setattr(proof, "load", lambda kernel, words: lambda *_: (None, arb(-1)))
    x = Symbol("x")
    for phi, falls in ((x**3 + 1 / x, True), (sqrt(x), False), (x**2 + x**x, False)):
        given = SimpleNamespace(placed=False, phi=phi)
        assert falling(given, arb(0.5)) is falls
        assert not falling(given, None)
