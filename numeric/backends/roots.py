"""The one zero of a function in an interval: Newton without questions, then Newton with a bracket.

The unconditional steps cost no branch; a lane that has not converged inside its bracket by then
enters a loop that keeps a change of sign and cannot leave it. Lanes that are done stay as they are,
so that no lane's result depends on its neighbours.
"""

from collections.abc import Callable
from typing import Any

TOLERANCE = 2.0**-27  # of the last Newton correction: the error left is its square
ENOUGH = 200  # passes of the bracketed loop, of which every second one at worst halves the bracket


Low = Any | Callable[[], Any]


def value_and_slope(p: list[Any], x: Any) -> tuple[Any, Any]:
    """A polynomial, constant first, and its derivative at `x`.

    >>> value_and_slope([5, 0, 1], 3)
    (14, 6)
    """
    value, slope = p[-1] * x + p[-2], p[-1]
    for c in reversed(p[:-2]):
        slope = slope * x + value
        value = value * x + c
    return value, slope


def halley(p: list[Any], x: Any) -> Any:
    """One step of Halley's method on a polynomial: third order for one division."""
    value, slope, half = p[-1] * x + p[-2], p[-1], None
    for c in reversed(p[:-2]):
        half = slope if half is None else half * x + slope
        slope = slope * x + value
        value = value * x + c
    if half is None:
        return x - value / slope
    return x - value * slope / (slope * slope - value * half)


def bracketed_zero(
    ops: Any,
    function: Callable[[Any], tuple[Any, Any]],
    x: Any,
    low: Low,
    high: Any,
    scale: Any,
    newton: int,
    wanted: Any = None,
    accepts: Callable[[Any], Any] | None = None,
) -> Any:
    """The only zero in `[low, high]` of a function that is negative at `low` and positive at `high`.

    `function` returns value and slope; `scale` is the size below which the zero's absolute error
    counts; `newton` is the number of steps before anything is asked. A lower bound that is dear may be
    given as a function, which is called when a lane needs it, with a cheap test `accepts` in its place.
    Lanes outside the mask `wanted` are left where Newton took them.
    """
    step = x
    for _ in range(newton):
        value, slope = function(x)
        step = value / slope
        x = x - step
    tolerance = ops.number(TOLERANCE)
    done = (abs(step) <= tolerance * ops.maximum(abs(x), scale)) & (x <= high)
    done = done & (accepts(x) if accepts is not None else low <= x)
    if wanted is not None:
        done = done | ops.negated(wanted)
    unfinished = ops.negated(done)

    def bracketed() -> list[Any]:
        bottom = low() if callable(low) else low
        inside = (bottom < x) & (x < high)
        start = ops.select(inside, x, ops.number(0.5) * (bottom + high))
        flag = ops.select(unfinished, ops.number(1.0), ops.number(0.0))
        state = [start, bottom, high, flag, high - bottom]
        found = ops.repeat(lambda state: ops.number(0.5) < state[3], improved, state, ENOUGH)[0]
        return [ops.select(unfinished, found, x)]

    def improved(state: list[Any]) -> list[Any]:
        x, low, high, flag, before = state
        value, slope = function(x)
        below = value < ops.number(0.0)
        low, high = ops.select(below, x, low), ops.select(below, high, x)
        step = value / slope
        middle, newton = ops.number(0.5) * (low + high), x - step
        good = (low < newton) & (newton < high) & (abs(step) <= before)
        moved = ops.select(good, newton, middle)
        change = abs(moved - x)
        small = tolerance * ops.maximum(abs(moved), scale)
        exact = value == ops.number(0.0)
        settled = (good & (abs(step) <= small)) | exact | (high - low <= ops.number(2.0**-26) * small)
        return [
            ops.select(exact, x, moved),
            low,
            high,
            ops.select(settled, ops.number(0.0), flag),
            ops.number(0.5) * change,
        ]

    return ops.when(unfinished, [x], bracketed)[0]


def polynomial_zero(
    ops: Any,
    p: list[Any],
    x: Any,
    low: Low,
    high: Any,
    scale: Any,
    steps: tuple[int, int],
    wanted: Any = None,
    accepts: Callable[[Any], Any] | None = None,
) -> Any:
    """`ops.zero` of a polynomial given by its coefficients; `steps` of Halley, then of Newton."""
    for _ in range(steps[0]):
        x = halley(p, x)
    return ops.zero(lambda at: value_and_slope(p, at), x, low, high, scale, steps[1], wanted, accepts)
