"""What a continuation has missed: cycles it could not follow, parameter ranges without cycles, checks at new values."""

from dataclasses import asdict, dataclass
from typing import Any

from verification.cycles.family import Interval


@dataclass(frozen=True)
class Unfollowed:
    """A cycle that a fraction `share` of the starts reach, but which could not be followed, and the reason."""

    value: float
    period: int
    share: float
    why: str


@dataclass(frozen=True)
class Range:
    """A parameter range in which starts end on chaotic or neutral orbits; each end is an interval that contains it."""

    kind: int
    low: Interval
    high: Interval

    def holds(self, value: float) -> bool:
        """True if the range contains the value."""
        return self.low[0] <= value <= self.high[1]


@dataclass(frozen=True)
class Check:
    """A check by starts at new parameter values: how many reach a known attractor, and which attractors are missing."""

    values: tuple[float, ...]
    starts: int
    seed: int
    accounted: int
    unsettled: int
    missing: tuple[Unfollowed, ...]

    @property
    def words(self) -> str:
        """The counts of known and unsettled starts as a sentence, with the attractors that are missing."""
        total = len(self.values) * self.starts
        said = f"{self.accounted} of {total} random starts at {len(self.values)} other values end on what is known"
        said += f"; {self.unsettled} did not settle" if self.unsettled else ""
        each = "; ".join(
            f"{one.share:.2%} at {one.value:.6g}: " + (f"period {one.period}, " if one.period else "") + one.why
            for one in self.missing
        )
        return f"{said} (seed {self.seed})." + (f" NOT ACCOUNTED FOR: {each}." if each else "")

    def document(self) -> dict[str, Any]:
        """The result of the check as JSON."""
        return asdict(self)
