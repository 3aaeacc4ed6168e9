"""The shipped property tests hold for tables and laws of every kind, and each detects its own kind of fault."""

import pytest
from hypothesis import Phase, given, settings

from numeric import PinballMap
from symbolic import Scene
from symbolic.tables.gallery import GALLERY
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene as Exact
from verification import laws, strategies

FEW = {"max_examples": 6, "derandomize": True, "database": None, "phases": [Phase.generate]}
FLOWER = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/60:0..1/30"}})
STADIUM = GALLERY["stadium"]()

test_the_determinant_of_a_stadium = laws.determinant(STADIUM, **FEW)
test_the_sum_of_exponents_of_a_flower = laws.area_sum_rule(FLOWER, **FEW)
test_the_symmetries_of_the_papers_tables = laws.symmetry(["egg", "cuspless", "cardioid"], **FEW)
test_time_reversal_in_a_stadium = laws.time_reversal_at_lam_1(STADIUM, **FEW)
test_first_hits_in_a_flower = laws.first_hit(FLOWER, **FEW)


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


def larger(own):
    """A method whose results are too large by a part in a million."""
    return lambda *given, **named: own(*given, **named) * (1 + 1e-6)


def moved(own):
    """A step that starts 1e-6 beside the given parameter."""
    return lambda self, theta, *given, **named: own(self, theta + 1e-6, *given, **named)


def more(own):
    """The exponents, with the larger one too large by 1e-6."""
    return lambda *given, **named: (found := own(*given, **named))._replace(nu_plus=found.nu_plus + 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "method", "fault"),
    [
        (laws.jacobian, "derivative", larger),
        (laws.determinant, "derivative", larger),
        (laws.symmetry, "step", moved),
        (laws.time_reversal_at_lam_1, "step", moved),
        (laws.first_hit, "step", moved),
        (laws.area_sum_rule, "exponents", more),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_a_map_that_is_off_by_a_millionth_fails_with_a_note_on_its_particle(law, method, fault, monkeypatch):
    monkeypatch.setattr(PinballMap, method, fault(getattr(PinballMap, method)))

    with pytest.raises(AssertionError) as failed:
        law("ellipse", **FEW)()
    assert {law.__name__, "given"} & {*dir(laws)} == {law.__name__}
    assert "ellipse(a=" in "".join(failed.value.__notes__)
