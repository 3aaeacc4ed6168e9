"""What a kernel is asked, and the rows of state that the question needs."""

from dataclasses import dataclass
from typing import Any

from numeric.families.family import Family

FARTHEST = 400  # powers of two; a single bounce adds far less than the 600 that are left
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
    """`dp, omega, growth, ratio, volume` with mantissas brought back near one where they have gone far.

    What is taken out goes into the exponents `growth` and `volume`, so no logarithm is needed on the way.
    """
    dp, omega, growth, ratio, volume = rows
    size = ops.maximum(abs(dp), abs(omega))
    low, high = ops.number(2.0**-FARTHEST), ops.number(2.0**FARTHEST)
    inside = (low < size) & (size < high) & (low < ratio) & (ratio < high)
    outside = ops.negated(inside)

    def brought_back() -> list[Any]:
        small, gained = ops.power_of_two(size)
        tiny, lost = ops.power_of_two(ratio)
        scaled = [dp * small, omega * small, growth + gained, ratio * tiny, volume + lost]
        return [ops.select(outside, new, old) for new, old in zip(scaled, rows, strict=True)]

    return list(ops.when(outside, rows, brought_back))
