"""What keeps a contact from being one of a table under a law: each reason alone, with tables and laws by hand."""

from fractions import Fraction
from types import SimpleNamespace

import pytest
from sympy import Rational

from verification.cycles.recurrence import Closure
from verification.proofs.manifolds import proof
from verification.proofs.manifolds.known import SHAPE, table
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.proof import objection
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
