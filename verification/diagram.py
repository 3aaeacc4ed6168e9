"""A diagram of errors against times, in text: from float64 to a thousand digits on one page."""

from collections.abc import Collection, Sequence
from decimal import Decimal
from math import log10

WIDTH, HEIGHT = 72, 14  # characters
UNIT = -52 * log10(2)  # decimal logarithm of the unit of errors
Point = tuple[float, Decimal | None]  # seconds, and an error in units of 2**-52


def duration(seconds: float) -> str:
    """A time in the unit that suits it.

    >>> duration(7.5e-9), duration(2e-3)
    ('7.5 ns', '2 ms')
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.2g} ns"


def magnitude(error: Decimal) -> float:
    """The decimal logarithm of an error given in units of 2**-52, which may lie below every float.

    >>> round(magnitude(Decimal("4.5036e-984")), 3)
    -999.0
    """
    return float(error.log10()) + UNIT if error else -float("inf")


def diagram(points: Sequence[Point], front: Collection[int] = ()) -> str:
    """A letter at each time (to the right) and error (upwards), both logarithmic; capitals are on the front.

    Where errors span hundreds of decades the upward scale is the logarithm of the number of digits that are right.

    >>> print(diagram([(1e-9, Decimal(1)), (1e-3, Decimal("1e-90"))], front={1}).splitlines()[0].strip())
    1e-16 |a
    """
    placed = {
        i: (log10(seconds), magnitude(error))
        for i, (seconds, error) in enumerate(points)
        if error is not None and error.is_finite() and error > 0
    }
    if not placed:
        return ""
    left, right = min(x for x, _ in placed.values()), max(x for x, _ in placed.values())
    top, bottom = max(y for _, y in placed.values()), min(y for _, y in placed.values())
    wide = bottom < 3 * top < 0

    def height(y: float) -> float:
        return -log10(-y) if wide else y

    span = max(height(top) - height(bottom), 1e-9)
    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    for i, (x, y) in placed.items():
        column = round((x - left) / max(right - left, 1e-9) * (WIDTH - 1))
        line = round((height(top) - height(y)) / span * (HEIGHT - 1))
        while canvas[line][column] != " " and column < WIDTH - 1:
            column += 1
        canvas[line][column] = chr(ord("A" if i in front else "a") + i)
    texts = []
    for line, letters in enumerate(canvas):
        at = height(top) - span * line / (HEIGHT - 1)
        label = (f"1e{-round(10**-at)}" if wide else _power(at)) if line % 4 == 0 or line == HEIGHT - 1 else ""
        texts.append(f"  {label:>8} |{''.join(letters).rstrip()}")
    first, last = duration(10**left), duration(10**right)
    return "\n".join([*texts, f"{'':>11}+{'-' * WIDTH}", f"{'':>12}{first}{last:>{WIDTH - len(first)}} a bounce"])


def _power(y: float) -> str:
    """`10**y` with one digit."""
    exponent = int(y // 1)
    lead = round(10 ** (y - exponent))
    return f"{1 if lead == 10 else lead}e{exponent + (lead == 10)}"
