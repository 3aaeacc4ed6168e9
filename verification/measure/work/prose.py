"""What a diagram says, in sentences made from its rows: who wins where, what a proof costs, what usual ways lose."""

from collections.abc import Sequence

from verification.measure.speed.baselines import duration
from verification.measure.work.choice import crossovers, entries
from verification.measure.work.row import Row, front, short
from verification.measure.work.sought import WITHOUT

PLENTY = 100  # digits at which a proof is compared with none


def paragraph(rows: Sequence[Row]) -> str:
    """The sentences, each with its numbers."""
    told = [
        quickest(rows) if not _with_bars(rows) else "",
        picked(rows),
        bars(rows),
        proofs(rows),
        integers(rows),
        *usual(rows),
    ]
    return "\n".join(f"- {sentence}" for sentence in told if sentence)


def quickest(rows: Sequence[Row]) -> str:
    """The best that float64 does, in time and in error."""
    own = [row for row in rows if row.arithmetic == "float64" and row.error is not None]
    if not own:
        return ""
    finest = min(own, key=lambda row: row.error or 0)
    quick = min((row for row in own if row.magnitude < finest.magnitude + 1), key=lambda row: row.seconds)
    said = f"Float64 ends at an error of {short(finest.error)} ({_named(finest)})" if finest.error else ""
    if quick.method == finest.method:
        return f"{said}, reached in {duration(quick.seconds)}."
    return f"{said}; within a digit of it the quickest is {_named(quick)}, {duration(quick.seconds)}."


def picked(rows: Sequence[Row]) -> str:
    """Which of this package's ways is the cheapest, by digits."""
    known = entries(rows)
    if not known or _with_bars(rows):
        return ""
    parts = [
        f"from {digits} on {choice.method} ({duration(choice.seconds)} for {choice.digits})"
        for digits, choice in crossovers(rows[0].question, measured=known)
    ]
    return "Cheapest of what keeps its promise, by digits: " + "; ".join(parts) + "."


def bars(rows: Sequence[Row]) -> str:
    """Error bars against collisions, and the part of each that the error was."""
    own = [row for row in _with_bars(rows) if row.promise and row.error is not None]
    parts = [f"{short(row.promise)} after {row.setting}" for row in own if row.promise]
    shares = [f"{float(row.error / row.promise):.2f}" for row in own if row.error is not None and row.promise]
    return f"Half the 95 % interval is {', '.join(parts)}; the errors were {', '.join(shares)} of it." if own else ""


def _with_bars(rows: Sequence[Row]) -> list[Row]:
    return [row for row in rows if row.promise and row.setting.split()[1:] == ["bounces"]]


def proofs(rows: Sequence[Row]) -> str:
    """What a certificate costs."""
    at = {row.method: row for row in rows if row.digits == PLENTY}
    if "arb, certified" not in at:
        return ""
    proof = at["arb, certified"]
    pairs = [(name, at[name]) for name in ("arb, no proof", "mpmath") if name in at]
    compared = " and ".join(f"{times(proof.seconds / row.seconds)} times {name}" for name, row in pairs)
    return f"With a proof {PLENTY} digits take {duration(proof.seconds)}{': ' if compared else ''}{compared}."


def integers(rows: Sequence[Row]) -> str:
    """What gmpy2 is worth."""
    own = {row.digits: row for row in rows if row.method == "mpmath" and row.error is not None}
    bare = {row.digits: row for row in rows if row.method == WITHOUT and row.error is not None}
    both = sorted(d for d in own.keys() & bare.keys() if d)
    if not both:
        return ""
    ratios = ", ".join(f"{times(bare[d].seconds / own[d].seconds)} at {d} digits" for d in both if d in (30, 300, 1000))
    return f"Without gmpy2 mpmath takes as many times longer: {ratios}."


def usual(rows: Sequence[Row]) -> list[str]:
    """What each of the usual ways reaches, against this package's quickest way to do no worse, and what it claims."""
    names = dict.fromkeys(row.method for row in rows if row.textbook)
    own = [row for row in rows if not row.textbook]
    return [_judged(name, [row for row in rows if row.method == name], own) for name in names]


def _judged(name: str, rows: Sequence[Row], own: Sequence[Row]) -> str:
    found = [(row.error, row.seconds, row) for row in rows if row.error is not None]
    if not found:
        return f"*{name}* gives no answer: {rows[0].failure}."
    error, seconds, _ = min(found, key=lambda each: each[:2])
    text = f"*{name}* gets to {short(error)} in {duration(seconds)}"
    rivals = [row for row in front(own) if row.error is not None and row.error <= error]
    if rivals and rivals[0].seconds < seconds:
        text += f"; {rivals[0].method} does no worse {times(seconds / rivals[0].seconds)} times as fast"
    elif rivals:
        text += f", {times(rivals[0].seconds / seconds)} times as fast as {rivals[0].method}"
    else:
        text += ", which no way of this package beats"
    broken = [(row.error / row.promise, row) for row in rows if row.kept is False and row.error and row.promise]
    if broken:
        _, worst = max(broken, key=lambda each: each[0])
        text += f"; asked for {worst.setting} it is off by {short(worst.error or error)}"
    lost = [row for row in rows if row.error is None]
    if lost:
        text += f"; asked for {lost[-1].setting} it fails: {lost[-1].failure}"
    return text + "."


def times(ratio: float) -> str:
    """A ratio with two digits, and no power of ten.

    >>> times(1.234), times(58.3), times(14_321.0)
    ('1.2', '58', '14,000')
    """
    return f"{ratio:.2g}" if ratio < 99.5 else f"{int(float(f'{ratio:.2g}')):,}"


def _named(row: Row) -> str:
    return f"{row.method}, {row.setting}" if row.setting else row.method
