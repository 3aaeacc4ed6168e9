"""Work that goes on in steps: iterations that end in rounding, and how far a long proof has come.

Newton's method and every other iteration have one loop and one rule for its end. The unknowns are a list of numbers of
any kind, or of arrays. Near a simple zero each correction is about the square of the one before, until rounding takes
over. So an iteration has settled when a correction is as small as is wanted, or when corrections that were small shrink
no more. At a double zero they halve, which is still shrinking.

A proof calls its `tick` with each share of its work that is done and knows of no progress bar; `telling` makes such a
function.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SHRINKS = 0.75  # of the correction before: what is larger no longer shrinks
Vector = list[Any]

Tick = Callable[[float], None]
Hearer = Callable[[str, float], None]
_hearer: ContextVar[Hearer | None] = ContextVar("hearer", default=None)
STEP = 1e-3  # a bar shows no smaller share


@dataclass(frozen=True)
class Stop:
    """When an iteration has settled, and when it is given up.

    A correction of at most `enough` is the last one. One below `small` that is no smaller than the one before is
    rounding and is not made. After so many `steps` nothing has settled. No unknown moves farther than `reach` at once.
    """

    small: float = 0.0
    enough: Any = 0.0
    steps: int = 40
    reach: float = inf

    def rounding(self, size: Any, before: Any) -> bool:
        """Is a correction of this size, after the one before, nothing but rounding?"""
        return bool(size < self.small and not size < SHRINKS * before)


@dataclass(frozen=True)
class Iteration:
    """Where an iteration ended, the sizes of the corrections it made, and how many it computed."""

    x: Vector
    settled: bool
    sizes: list[Any] = field(repr=False)
    steps: int


def iterated(
    correction: Callable[[Vector], Sequence[Any]],
    start: Sequence[Any],
    stop: Stop,
    size: Callable[[Sequence[Any]], Any] | None = None,
    kept: Callable[[Any], Any] = lambda x: x,
) -> Iteration:
    """The iteration `x - correction(x)` from `start` until it settles.

    `size` measures a correction, by default by its largest entry; `kept` is what is kept of each unknown, such as the
    midpoint of a ball. A division by 0 or a correction that is not finite ends it unsettled.

    >>> root = iterated(lambda x: [(x[0] * x[0] - 2) / (2 * x[0])], [1.0], Stop(small=1e-6))
    >>> root.x, root.settled
    ([1.414213562373095], True)
    """
    x, sizes = list(start), list[Any]()
    for step in range(1, stop.steps + 1):
        try:
            moved = correction(x)
        except ZeroDivisionError:
            return Iteration(x, False, sizes, step)
        length = size(moved) if size else max(abs(d) for d in moved)
        if not length < inf:
            break
        if not length or stop.rounding(length, sizes[-1] if sizes else inf):
            return Iteration(x, True, sizes, step)
        short = stop.reach / length if length > stop.reach else 1
        x = [kept(a - short * d) for a, d in zip(x, moved, strict=True)]
        sizes.append(length)
        if length <= stop.enough:
            return Iteration(x, True, sizes, step)
    return Iteration(x, False, sizes, stop.steps)


def in_rows(
    correction: "Callable[[NDArray[np.float64]], NDArray[np.float64]]", start: "NDArray[np.float64]", stop: Stop
) -> "tuple[NDArray[np.float64], NDArray[np.bool_]]":
    """The same in float64 for each row of `start` by itself, and which rows settled by a correction that was `enough`.

    >>> import numpy as np
    >>> x, settled = in_rows(lambda x: (x * x - 2) / (2 * x), np.array([[1.0], [0.0]]), Stop(enough=1e-11))
    >>> round(float(x[0, 0]), 12), settled.tolist()
    (1.414213562373, [True, False])
    """
    import numpy as np  # which most iterations do without

    x, settled = start.copy(), np.zeros(len(start), dtype=bool)
    with np.errstate(all="ignore"):
        for _ in range(stop.steps):
            active = ~settled
            if not np.any(active):
                break
            moved = correction(x[active])
            length = np.max(np.abs(moved), axis=1)
            x[active] -= np.minimum(1.0, stop.reach / np.maximum(length, 1e-300))[:, None] * moved
            settled[active] = length <= stop.enough
    return x, settled & np.all(np.isfinite(x), axis=1)


def largest(parts: Sequence[Any]) -> float:
    """The largest finite entry of numbers, arrays and Taylor series of either, in absolute value."""
    import numpy as np

    sizes = [0.0]
    for part in parts:
        for number in getattr(part, "c", (part,)):
            if isinstance(number, np.ndarray):
                sizes.append(float(np.max(np.abs(number), initial=0.0, where=np.isfinite(number))))
            else:
                sizes.append(float(abs(number)))
    return max(sizes)


@contextmanager
def heard(by: Hearer) -> Iterator[None]:
    """Within, `by` is called with what is being worked at and the share of it that is done.

    >>> heard_of = []
    >>> with heard(lambda about, share: heard_of.append((about, share))):
    ...     tick = telling("boxes")
    ...     tick(0.25)
    ...     tick(0.5)
    >>> heard_of
    [('boxes', 0.25), ('boxes', 0.75)]
    """
    before = _hearer.set(by)
    try:
        yield
    finally:
        _hearer.reset(before)


def silent(share: float) -> None:
    """The tick of a proof that nobody asked to tell."""


def telling(about: str) -> Tick:
    """A verb to call with each share that is done; it does nothing while nobody listens."""
    hear, done, told = _hearer.get(), 0.0, 0.0

    def tick(share: float) -> None:
        nonlocal done, told
        done += share
        if hear is not None and done - told >= STEP:
            told = done
            hear(about, min(done, 1.0))

    return tick
