"""What a kernel is asked, and the rows of state that the question needs."""

from dataclasses import dataclass

from numeric.families.family import Family

WIDTH = 32  # lanes: four registers of AVX-512 for every value, enough to hide latency and no more
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
