"""The texts of a theorem follow from its declaration."""

from dataclasses import dataclass

import pytest

from verification.rigorous.theorem import Theorem, hypothesis


@dataclass(frozen=True)
class Power(Theorem):
    """The number is a power of two above one."""

    number: float
    asked: list

    @hypothesis
    def whole(self):
        """It is a whole number."""
        self.asked.append("whole")
        return self.number % 1 == 0

    @hypothesis(refutable=True, name="number")
    def even_after_halving(self):
        """Halves of it are even, up to one."""
        return None if self.number > 1e6 else self.number.is_integer() and int(self.number).bit_count() == 1

    @hypothesis
    def inverse(self):
        """Its inverse is below one."""
        return 1 / self.number < 1


class Large(Power):
    """The number is a power of two above a thousand."""

    @hypothesis
    def large(self):
        """It is above a thousand."""
        return self.number > 1000


@pytest.mark.parametrize(
    ("number", "checks"),
    [
        (8.0, {"whole": True, "number": True, "inverse": True}),
        (6.0, {"whole": True, "number": False, "inverse": True}),  # refuted
        (0.5, {"whole": None, "number": False, "inverse": None}),
        (0.0, {"whole": True, "number": False, "inverse": None}),  # there is no inverse
        (2e6, {"whole": True, "number": None, "inverse": True}),  # not decided
    ],
)
def test_a_theorem_is_proved_when_each_hypothesis_is(number, checks):
    found = Power(number, [])

    assert list(found.checks.items()) == list(checks.items())
    assert found.proved is all(checks.values())
    assert {*found.open} == {name for name, verdict in checks.items() if verdict is not True}


def test_a_hypothesis_is_worked_through_once():
    found = Power(8.0, [])

    assert (found.proved, found.whole, found.checks["whole"], found.asked) == (True, True, True, ["whole"])


def test_words_are_those_of_the_declaration():
    assert Power.statement() == "The number is a power of two above one."
    assert Power(0.5, []).open["inverse"] == "Its inverse is below one."


def test_a_theorem_has_the_hypotheses_of_what_it_derives_from():
    assert list(Large.hypotheses()) == ["whole", "number", "inverse", "large"]
    assert {*Large(8.0, []).open} == {"large"}


def test_a_theorem_without_hypotheses_is_not_proved():
    assert not Theorem().proved
