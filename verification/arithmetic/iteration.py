"""Newton's method and other iterations, with a common stopping rule; and progress reports of long proofs.

The unknowns are a list of numbers of any kind, or of arrays. Near a simple zero each correction is about the square of
the one before, until rounding takes over. So an iteration has converged when a correction is as small as is wanted, or
when small corrections shrink no more. At a double zero they halve, which is still shrinking.

A proof calls a function `tick` with each share of its work that is done; `telling` makes such a function.
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

SHRINKS = 0.75  # a correction above this share of the one before no longer shrinks
Vector = list[Any]

Tick = Callable[[float], None]
Hearer = Callable[[str, float], None]
_hearer: ContextVar[Hearer | None] = ContextVar("hearer", default=None)
STEP = 1e-3  # the least share of the work that is reported


@dataclass(frozen=True)
class Stop:
    """Conditions under which an iteration has converged, and under which it is given up.

    A correction of at most `enough` is the last one. One below `small` that is no smaller than the one before is
    rounding and is not made. After `steps` steps the iteration is given up. No unknown moves farther than `reach` in a
    step.
    """

    small: float = 0.0
    enough: Any = 0.0
    steps: int = 40
    reach: float = inf

    def rounding(self, size: Any, before: Any) -> bool:
        """True if a correction of size `size`, after one of size `before`, is due to rounding alone."""
        return bool(size < self.small and not size < SHRINKS * before)


@dataclass(frozen=True)
class Iteration:
    """Result of an iteration: the last `x`, whether it converged, the sizes of its corrections, and its steps."""

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
    """Result of the iteration `x -> x - correction(x)` from `start`, until it converges or is given up.

    `size` measures a correction, by default by its largest entry; `kept` is applied to each new unknown, for instance
    to take the midpoint of a ball. Division by 0 or a correction that is not finite ends it with `settled` False.

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


def bracketed(f: Callable[[float], float], start: float, end: float, small: float, relative: float) -> float:
    """A zero between two values of opposite signs, by Brent's method, to within `small + relative*abs(zero)`.

    The steps are those of SciPy's `brentq`, whose import takes half a second. `ValueError` where the signs agree.

    >>> round(bracketed(lambda x: x * x - 2, 0.0, 2.0, 1e-12, 1e-12), 11)
    1.41421356237
    """
    old, here, f_old, f_here = start, end, f(start), f(end)
    if 0 in (f_old, f_here):
        return old if f_old == 0 else here
    if (f_old < 0) == (f_here < 0):
        raise ValueError(f"the function does not change sign between {start:.9g} and {end:.9g}")
    other, f_other, before, step = old, f_old, here - old, here - old
    for _ in range(100):
        if f_old and f_here and (f_old < 0) != (f_here < 0):
            other, f_other, before, step = old, f_old, here - old, here - old
        if abs(f_other) < abs(f_here):
            old, here, other, f_old, f_here, f_other = here, other, here, f_here, f_other, f_here
        near, half = (small + relative * abs(here)) / 2, (other - here) / 2
        if f_here == 0 or abs(half) < near:
            return here
        tried = inf
        if abs(before) > near and abs(f_here) < abs(f_old):
            if old == other:
                tried = -f_here * (here - old) / (f_here - f_old)
            else:
                one, two = (f_old - f_here) / (old - here), (f_other - f_here) / (other - here)
                tried = -f_here * (f_other * two - f_old * one) / (two * one * (f_other - f_old))
        good = 2 * abs(tried) < min(abs(before), 3 * abs(half) - near)
        before, step = (step, tried) if good else (half, half)
        old, f_old = here, f_here
        here += step if abs(step) > near else near if half > 0 else -near
        f_here = f(here)
    raise ValueError(f"no zero is reached between {start:.9g} and {end:.9g}")


def in_rows(
    correction: "Callable[[NDArray[np.float64]], NDArray[np.float64]]", start: "NDArray[np.float64]", stop: Stop
) -> "tuple[NDArray[np.float64], NDArray[np.bool_]]":
    """Iterates each row of `start` in float64, shape `(rows, unknowns)`; returns the rows and a mask of converged ones.

    >>> import numpy as np
    >>> x, settled = in_rows(lambda x: (x * x - 2) / (2 * x), np.array([[1.0], [0.0]]), Stop(enough=1e-11))
    >>> round(float(x[0, 0]), 12), settled.tolist()
    (1.414213562373, [True, False])
    """
    import numpy as np  # here, since most iterations do without it

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
    """The largest absolute value among finite entries of numbers, arrays, and Taylor series of either."""
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
    """Context in which `by(about, share)` is called with the name of the current work and the share of it that is done.

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


def silent(said: object) -> None:
    """A `tick` that does nothing, for work that does not report its progress."""


def telling(about: str) -> Tick:
    """A function `tick(share)` that adds up the shares done of the work `about` and reports the sum to `heard`."""
    hear, done, told = _hearer.get(), 0.0, 0.0

    def tick(share: float) -> None:
        nonlocal done, told
        done += share
        if hear is not None and done - told >= STEP:
            told = done
            hear(about, min(done, 1.0))

    return tick
