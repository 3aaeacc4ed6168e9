"""What a kernel is asked, and the rows of state that the question needs."""

from dataclasses import dataclass
from typing import Any

from numeric.families.family import Family

OFTEN = 8  # bounces; no single one grows a vector by more than 2**100, a double holds 2**1000
TANGENT = ("dp", "omega", "growth", "ratio", "volume")


@dataclass(frozen=True)
class Question:
    """What a kernel is asked besides the end of the trajectory."""

    law: str
    record: bool = False
    exponents: bool = False

    @property
    def text(self) -> str:
        """The question as part of a name."""
        return "-".join([self.law, *(["record"] if self.record else []), *(["exponents"] if self.exponents else [])])


def fields(family: Family, question: Question) -> tuple[str, ...]:
    """The rows of `state`."""
    extra = TANGENT if question.exponents else ()
    return (*family.fields(question.law), *(("code", "lost") if family.stops else ()), *extra)


def rescaled(ops: Any, rows: list[Any]) -> list[Any]:
    """`dp, omega, growth, ratio, volume` with their mantissas brought back near one, to be done every `OFTEN` bounces.

    What is taken out goes into the exponents `growth` and `volume`, so no logarithm is needed on the way.
    """
    dp, omega, growth, ratio, volume = rows
    small, gained = ops.power_of_two(ops.maximum(abs(dp), abs(omega)))
    tiny, lost = ops.power_of_two(ratio)
    return [dp * small, omega * small, growth + gained, ratio * tiny, volume + lost]
