"""Whole calls, as users make them, beside the kernel that does their work: ratios, each with a bar.

Seconds differ between machines, ratios hardly: the two times of a ratio are the best of runs that take turns.
"""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from numeric import PinballMap
from numeric.pinball.sampling import phase_starts
from verification.measure.extremes.orbits import SCENES
from verification.measure.work.bench import best

REST = 512, 1_000, 100_000  # balls at rest: how many, bounces of a short run, of a long one


class Call(NamedTuple):
    """A call and what it is compared with, in seconds for one bounce; `bar` is the largest ratio that is accepted."""

    scene: str
    call: str
    seconds: float
    against: str
    reference: float
    bar: float

    @property
    def ratio(self) -> float:
        """How many times the reference.

        >>> Call("egg", "a call", 3e-9, "the kernel", 2e-9, 2.0).ratio
        1.5
        """
        return self.seconds / self.reference

    def as_data(self) -> dict[str, Any]:
        """The row for the JSON document."""
        return self._asdict() | {"ratio": self.ratio}


def taking_turns(one: Callable[[], object], other: Callable[[], object], runs: int) -> tuple[float, float]:
    """The shortest times of two actions that take turns."""
    times = [(best(one, 1), best(other, 1)) for _ in range(runs)]
    return min(first for first, _ in times), min(second for _, second in times)


def call_rows(name: str, runs: int) -> Iterable[Call]:
    """The calls on one of the paper's tables."""
    yield at_rest(name, min(runs, 3))


def at_rest(name: str, runs: int, sizes: tuple[int, int, int] = REST) -> Call:
    """Exponents of balls of which many come to rest, where subnormal numbers would be: a bounce must cost the same."""
    count, short, long = sizes
    map = PinballMap(name, lam="9/10", **dict(SCENES[name]))
    starts = phase_starts(map, count, seed=1)

    def once(bounces: int) -> object:
        return map.exponents(starts.theta, starts.phi, bounces, component=starts.component, threads=1)

    once(1)
    seconds, reference = taking_turns(lambda: once(long), lambda: [once(short) for _ in range(10)], runs)
    made = f"exponents, {long:,} bounces"
    return Call(
        name, made, seconds / long / count, f"{short:,} bounces, lam = 9/10", reference / 10 / short / count, 1.1
    )
