"""The ready property tests: they hold for tables and laws of every kind, and each sees the fault that is its own."""

import numpy as np
import pytest
from hypothesis import Phase, given, settings

from numeric import PinballMap
from symbolic import Scene
from symbolic.tables.gallery import GALLERY
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene as Exact
from verification import laws, strategies
from verification.maps import laws as module

FEW = {"max_examples": 6, "derandomize": True, "database": None, "phases": [Phase.generate]}
FLOWER = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/60:0..1/30"}})
STADIUM = GALLERY["stadium"]()

test_the_derivative_of_the_papers_tables = laws.jacobian(**FEW)
test_the_determinant_of_a_stadium = laws.determinant(STADIUM, **FEW)
test_the_sum_of_exponents_of_a_flower = laws.area_sum_rule(FLOWER, **FEW)
test_the_symmetries_of_the_papers_tables = laws.symmetry(["egg", "cuspless", "cardioid"], **FEW)
test_time_reversal_in_a_stadium = laws.time_reversal_at_lam_1(STADIUM, **FEW)
test_first_hits_in_a_flower = laws.first_hit(FLOWER, **FEW)


def scaled(name, factor):
    """The method of the map whose answer is too large by a part in a million."""
    own = getattr(PinballMap, name)
    return lambda self, *given, **named: own(self, *given, **named) * factor


@pytest.mark.parametrize("law", [laws.jacobian, laws.determinant])
def test_a_derivative_that_is_off_by_a_millionth_is_seen(law, monkeypatch):
    monkeypatch.setattr(PinballMap, "derivative", scaled("derivative", 1 + 1e-6))

    with pytest.raises(AssertionError):
        law("ellipse", **FEW)()


@pytest.mark.parametrize("law", [laws.symmetry, laws.time_reversal_at_lam_1, laws.first_hit])
def test_a_landing_that_is_off_by_a_millionth_is_seen(law, monkeypatch):
    own = PinballMap.step

    def moved(self, theta, phi=0.0, component=0):
        return own(self, np.asarray(theta) + 1e-6, phi, component)

    monkeypatch.setattr(PinballMap, "step", moved)

    with pytest.raises(AssertionError):
        law("ellipse", **FEW)()


def test_an_exponent_that_is_off_by_a_millionth_is_seen(monkeypatch):
    own = PinballMap.exponents

    def more(self, *given, **named):
        found = own(self, *given, **named)
        return found._replace(nu_plus=found.nu_plus + 1e-6)

    monkeypatch.setattr(PinballMap, "exponents", more)

    with pytest.raises(AssertionError):
        laws.area_sum_rule("egg", **FEW)()


@settings(**{**FEW, "max_examples": 40})
@given(strategies.reflections())
def test_every_law_that_is_drawn_is_one_of_the_forms_that_are_laws_for_all_contractions(formula):
    law = Law(formula)

    assert not law.parameters
    assert law.uniform or law.phi.free_symbols


@pytest.mark.parametrize("lam", ["0", "1"])
@pytest.mark.parametrize("end", [0, 1])
@pytest.mark.parametrize("form", sorted({**strategies.BENT, **strategies.PLACED}))
def test_the_largest_bend_of_each_form_is_still_proved_to_be_a_law(form, end, lam):
    largest = {**strategies.BENT, **strategies.PLACED}[form][end]

    assert Exact("circle", law=form.format(a=f"({largest})"), lam=lam).lam in (0, 1)


def test_a_law_that_fails_names_its_table_law_and_particle(monkeypatch):
    monkeypatch.setattr(module, "UNITS", 0.0)

    with pytest.raises(AssertionError) as failed:
        laws.determinant("ellipse", **FEW)()
    assert "Particle(ellipse(a=" in "".join(failed.value.__notes__)
