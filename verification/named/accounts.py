"""The account of a continuation: cycles that could not be followed, ranges without cycles, starts at unused values."""

from dataclasses import asdict, dataclass
from typing import Any

from verification.cycles.family import Interval


@dataclass(frozen=True)
class Unfollowed:
    """A cycle on which a share of the starts ends but which could not be followed, with the reason."""

    value: float
    period: int
    share: float
    why: str


@dataclass(frozen=True)
class Range:
    """A range of the parameter in which starts end on no cycle: chaotic or neutral; its ends lie between values."""

    kind: int
    low: Interval
    high: Interval

    def holds(self, value: float) -> bool:
        """Does the range contain a value?"""
        return self.low[0] <= value <= self.high[1]


@dataclass(frozen=True)
class Check:
    """Starts at values that were not used: how many end on a known attractor, and what the others end on."""

    values: tuple[float, ...]
    starts: int
    seed: int
    accounted: int
    unsettled: int
    missing: tuple[Unfollowed, ...]

    @property
    def words(self) -> str:
        """The counts of known and unsettled starts in a sentence, and what is missing."""
        total = len(self.values) * self.starts
        said = f"{self.accounted} of {total} random starts at {len(self.values)} other values end on what is known"
        said += f"; {self.unsettled} did not settle" if self.unsettled else ""
        each = "; ".join(
            f"{one.share:.2%} at {one.value:.6g}: " + (f"period {one.period}, " if one.period else "") + one.why
            for one in self.missing
        )
        return f"{said} (seed {self.seed})." + (f" NOT ACCOUNTED FOR: {each}." if each else "")

    def document(self) -> dict[str, Any]:
        """The counts as JSON."""
        return asdict(self)
