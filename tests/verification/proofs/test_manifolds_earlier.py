"""The search for earlier contacts finds the first where it is known, also that of the widening."""

import pytest
from flint import arb
from sympy import Rational

from verification.arithmetic.balls import working
from verification.proofs.manifolds.certificate import Tangency
from verification.proofs.manifolds.earlier import earlier
from verification.proofs.manifolds.known import CONTACTS, SEARCHED, SHAPE, contact, table, touching
from verification.proofs.manifolds.plane_map import Henon
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact

INNER = SaddleCycle("inner fixed point", (0.63,))
LATER = Contact(INNER, INNER, 11, 1, -0.3524733847360261, -0.16775805971867158, 1.39563615894)
# By a search of others that shares no code with this one, converged to 60 digits.
INDEPENDENT = "0.428419189868092478756523429733"


@pytest.mark.slow
def test_from_a_later_contact_of_the_henon_map_the_published_first_is_found():
    """[AraiMischaikow2006]: the first homoclinic tangency is between 1.392419807915 and 1.392419807931."""
    found = earlier(LATER, Henon(Rational(3, 10)), 1.39, 11)

    assert 1.392419807915 < found.first.parameter < 1.392419807931
    assert str(found).startswith("not the first: an earlier contact at 1.3924198079")
    assert earlier(found.first.contact, Henon(Rational(3, 10)), 1.39, 11).first is None


@pytest.mark.slow
def test_from_the_later_contact_of_the_widening_the_first_is_found_whatever_its_phase():
    """It arrives after 16 bounces, two rounds and four bounces, which a search by whole rounds misses."""
    found = earlier(CONTACTS["interior-crisis-1-later"], table(SHAPE), 0.42841914, 36)

    assert found.first.parameter == pytest.approx(float(INDEPENDENT), abs=1e-12)
    assert found.first.contact.bounces == 16


@pytest.mark.slow
def test_before_the_first_contact_of_the_widening_none_is_found():
    low, _ = SEARCHED["interior-crisis-1"]
    found = earlier(CONTACTS["interior-crisis-1"], table(SHAPE), float(low), 36)

    assert found.first is None
    assert found.extrema > 100
    assert str(found).startswith("not shown; none earlier found")


def test_both_contacts_of_the_widening_are_proved_and_the_first_has_the_independent_digits():
    first = Tangency(CONTACTS["interior-crisis-1"], table(SHAPE).table, INDEPENDENT, 20)
    later = touching("interior-crisis-1-later")

    for proof in (first, later):
        assert proof.proved
        assert proof.strange.proved
    with working(150):
        assert abs(first.value - arb(INDEPENDENT)) < 1e-30
        assert first.value + 8e-10 < later.value < first.value + 9e-10


def test_a_search_names_what_it_does_not_take():
    with pytest.raises(ValueError, match="heteroclinic"):
        earlier(
            Contact(INNER, SaddleCycle("outer", (-1.13,)), 1, 1, -0.627, 2.2, 1.4269), Henon(Rational(3, 10)), 1.4, 9
        )
    with pytest.raises(ValueError, match="not below"):
        earlier(LATER, Henon(Rational(3, 10)), 1.4, 11)


def test_every_catalogued_search_looks_below_its_contact():
    for kind, (low, bounces) in SEARCHED.items():
        assert float(low) < contact(kind, SHAPE).parameter
        assert bounces >= CONTACTS[kind].bounces
