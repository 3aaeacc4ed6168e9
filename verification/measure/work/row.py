"""Results of a benchmark: rows of error, promise and time, and their Pareto front.

Rows are shown as a table in text or Markdown with the facts of the run beneath, or as a diagram of error against
time.
"""

import os
import platform
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import log10
from statistics import median, quantiles
from typing import Any

import flint
import mpmath
import numpy as np

from numeric.kernels import machine

BALLS = ("error", "least", "promise")  # fields that a float may not hold
SMALLEST, LARGEST = Decimal("1e-300"), Decimal("1e300")  # limits of the errors that are written as floats


@dataclass(frozen=True)
class MethodResult:
    """One method at one setting: its error, what it promised, and the median of its times with their quartiles.

    Times are in seconds for one answer. An `error` of None means that there was no answer; `failure` says why.
    """

    question: str
    method: str
    arithmetic: str
    setting: str
    error: Decimal | None
    promise: Decimal | None
    seconds: float
    quartiles: tuple[float, float]
    runs: int
    textbook: bool = False
    proved: bool = False
    failure: str = ""
    digits: int | None = None  # the setting, where it is a number of digits
    least: Decimal | None = None  # lower bound of the error, where the reference has a radius

    @property
    def kept(self) -> bool | None:
        """True if the error is within the promise; None if there is no promise or the reference is too wide."""
        if self.error is None:
            return False
        if self.promise is None:
            return None
        least = self.error if self.least is None else self.least
        return True if self.error <= self.promise else False if least > self.promise else None

    @property
    def magnitude(self) -> float:
        """The decimal logarithm of the error, which may itself be too small for a float; infinite without an answer.

        >>> round(timed("q", "m", [1.0], error=Decimal("3e-900")).magnitude, 3)
        -899.523
        """
        if self.error is None:
            return float("inf")
        return float(self.error.log10()) if self.error else -float("inf")

    @property
    def spread(self) -> float:
        """The upper quartile of the times divided by the lower quartile."""
        return self.quartiles[1] / self.quartiles[0] if self.quartiles[0] else 1.0

    def to_dict(self) -> dict[str, Any]:
        """The row as JSON; a number outside the range of floats is a decimal string."""
        plain = {name: getattr(self, name) for name in self.__dataclass_fields__}
        plain |= {name: written(getattr(self, name)) for name in BALLS}
        plain["quartiles"] = list(self.quartiles)
        return plain | {"kept": self.kept}

    @staticmethod
    def from_dict(document: dict[str, Any]) -> "MethodResult":
        """The row from the JSON of `to_dict`."""
        fields = {name: value for name, value in document.items() if name != "kept"}
        for name in BALLS:
            fields[name] = None if fields[name] is None else Decimal(str(fields[name]))
        low, high = fields.pop("quartiles")
        return MethodResult(**fields, quartiles=(low, high))


def timed(question: str, method: str, seconds: Sequence[float], **more: Any) -> MethodResult:
    """A row with the median of some times and their quartiles.

    >>> timed("step", "kernel", [3.0, 1.0, 2.0], error=None).seconds
    2.0
    """
    low, _, high = quantiles(seconds, n=4, method="inclusive") if len(seconds) > 1 else (seconds[0],) * 3
    own = {"arithmetic": "", "setting": "", "promise": None} | more
    return MethodResult(question, method, seconds=median(seconds), quartiles=(low, high), runs=len(seconds), **own)


def written(number: Decimal | None) -> float | str | None:
    """An error as JSON: a float if it is in the range of floats, else a decimal string.

    >>> written(Decimal("1.5e-16")), written(Decimal("2e-1000"))
    (1.5e-16, '2E-1000')
    """
    if number is None:
        return None
    return float(number) if number == 0 or SMALLEST < abs(number) < LARGEST else str(number)


def front(rows: Iterable[MethodResult]) -> tuple[MethodResult, ...]:
    """The rows that no other row beats in error and time at once, quickest first: the Pareto front.

    >>> a, b, c = (timed("q", str(t), [t], error=Decimal(e)) for t, e in ((1.0, 1), (2.0, 2), (3.0, 0)))
    >>> [row.method for row in front([c, b, a])]
    ['1.0', '3.0']
    """
    best: list[MethodResult] = []
    for row in sorted((r for r in rows if r.error is not None), key=lambda r: (r.seconds, r.error)):
        if not best or (row.error is not None and best[-1].error is not None and row.error < best[-1].error):
            best.append(row)
    return tuple(best)


HEAD = ("", "method", "setting", "error", "claims", "time", "spread", "ratio", "")
MARKS = {True: "", False: "!", None: ""}


def table(rows: Sequence[MethodResult], base: MethodResult | None = None) -> list[tuple[str, ...]]:
    """Cells of a table, a row per result, with ratios to `base`; `*`: on the Pareto front, `!`: broken claim."""
    best, base = front(rows), base or baseline(rows)
    lines: list[tuple[str, ...]] = []
    for row in rows:
        ratio = f"{row.seconds / base.seconds:.3g}" if base and base.seconds else "-"
        claims = "-" if row.promise is None else short(row.promise)
        said = row.failure if row.error is None else short(row.error)
        times = duration(row.seconds), f"{row.spread:.2f}" if row.runs > 1 else "once", ratio
        lines.append(("*" if row in best else "", row.method, row.setting, said, claims, *times, MARKS[row.kept]))
    return lines


def plain(rows: Sequence[MethodResult]) -> str:
    """The table of results as text with aligned columns.

    >>> from verification.measure.work.row import timed
    >>> print(plain([timed("q", "kernel", [2e-9], error=Decimal("1e-16"), promise=Decimal("1e-17"), setting="s")]))
       method  setting  error  claims  time  spread  ratio
    *  kernel  s        1e-16  1e-17   2 ns  once    -      !
    """
    lines = [HEAD, *table(rows)]
    wide = [max(len(line[i]) for line in lines) for i in range(len(HEAD))]
    wide[3] = min(wide[3], 48)
    return "\n".join(
        "  ".join(text[:48].ljust(width) for text, width in zip(line, wide, strict=True)).rstrip() for line in lines
    )


def markdown(rows: Sequence[MethodResult], base: MethodResult | None = None) -> str:
    """The table of results in Markdown; each column has a heading, which screen readers use."""
    lines = [("front", *HEAD[1:-1], "broken"), ("---",) * len(HEAD), *table(rows, base)]
    return "\n".join(
        "| " + " | ".join(text.replace("|", "/").replace("*", "\\*") for text in line) + " |" for line in lines
    )


def baseline(rows: Sequence[MethodResult]) -> MethodResult | None:
    """The row whose time the others are compared with: this package's first float64 method, at its finest setting."""
    own = [row for row in rows if row.arithmetic == "float64" and not row.textbook and row.error is not None]
    return [row for row in own if row.method == own[0].method][-1] if own else None


def short(number: Decimal) -> str:
    """A number to two digits, as text; it may be outside the range of floats.

    >>> short(Decimal("1.234e-1000")), short(Decimal("0.02"))
    ('1.2e-1000', '2e-2')
    """
    if number == 0:
        return "0"
    lead, exponent = f"{number:.1e}".split("e")
    return f"{lead.removesuffix('.0')}e{int(exponent)}"


def machine_facts() -> dict[str, str]:
    """The machine and the versions of packages, by name."""
    import llvmlite
    import scipy

    facts = {"python": platform.python_version(), "system": f"{platform.system()} {platform.machine()}"}
    facts |= {"numpy": np.__version__, "scipy": scipy.__version__, "llvmlite": llvmlite.__version__}
    facts |= {
        "mpmath": mpmath.__version__,
        "mpmath's integers": mpmath.libmp.BACKEND,
        "python-flint": flint.__version__,
    }
    if machine.available():
        import llvmlite.binding as llvm

        facts["processor"] = llvm.get_host_cpu_name()
    return facts | {"processors": str(os.cpu_count())}


def facts() -> dict[str, str]:
    """The machine, the package versions and the machine's load, by name."""
    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    return machine_facts() | {"load": load}


def footer(known: dict[str, str]) -> str:
    """The facts of the run on one line."""
    return ", ".join(f"{key} {value}" for key, value in known.items())


WIDTH, HEIGHT = 72, 14  # characters
UNIT_LOG10 = -52 * log10(2)  # decimal logarithm of the unit of errors
Point = tuple[float, Decimal | None]  # seconds, and an error in units of 2**-52


def duration(seconds: float) -> str:
    """A time as text in a suitable unit.

    >>> duration(7.5e-9), duration(2e-3)
    ('7.5 ns', '2 ms')
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.2g} ns"


def magnitude(error: Decimal) -> float:
    """The decimal logarithm of an error that is given in units of 2**-52 and may be too small for a float.

    >>> round(magnitude(Decimal("4.5036e-984")), 3)
    -999.0
    """
    return float(error.log10()) + UNIT_LOG10 if error else -float("inf")


def diagram(points: Sequence[Point], front: Collection[int] = ()) -> str:
    """A text diagram of error (upwards) against time (to the right), both logarithmic; capitals mark the front.

    If errors span hundreds of decades, the vertical scale is the logarithm of the number of correct digits.

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
    """The number `10**y` as text with one digit."""
    exponent = int(y // 1)
    lead = round(10 ** (y - exponent))
    return f"{1 if lead == 10 else lead}e{exponent + (lead == 10)}"


@dataclass(frozen=True)
class WorkDiagram:
    """The work-precision diagram of a question, to be drawn when a page needs it: its rows, and machine facts."""

    name: str
    caption: str
    title: str
    unit: str
    rows: tuple[MethodResult, ...]
    machine: dict[str, str]
    section: str = ""
    shows: str = ""
    seconds: float = 0.2
    module: str = "verification.measure.work.figure"

    def drawn(self) -> bytes:
        """The diagram as a transparent WebP image, so that the page may be dark."""
        from verification.measure.work.figure import drawn, image

        figure = drawn(self.title, self.unit, self.rows, self.machine)
        figure.patch.set_alpha(0)
        return image(figure, "webp")
