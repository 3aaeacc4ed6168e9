"""What moved between two runs: ratios of times to a baseline within each run, so that machines and load cancel."""

from collections.abc import Sequence

from verification.diagram import duration
from verification.work.row import Row
from verification.work.text import baseline, short

MOVED = 1.5  # the factor from which on a change is told
WORSE = 10  # times the error is told as well


def moved(before: Sequence[Row], after: Sequence[Row]) -> list[str]:
    """A sentence for each row whose ratio to its question's baseline changed by more than a factor 1.5.

    Changes within the quartiles of both runs are not told; errors that grew tenfold, and answers lost, are.
    """
    said = []
    for name in dict.fromkeys(row.question for row in after):
        old = {_key(row): row for row in before if row.question == name}
        new = {_key(row): row for row in after if row.question == name}
        shared = [key for key in new if key in old]
        said += [f"{name}: {' '.join(key)} is gone" for key in old if key not in new]
        said += [f"{name}: {' '.join(key)} is new" for key in new if key not in old]
        base = baseline([new[key] for key in shared if old[key].error is not None])
        if base is None:
            continue
        unit = base.seconds / old[_key(base)].seconds
        for key in shared:
            said += [f"{name}: {' '.join(key)} {change}" for change in changes(old[key], new[key], unit)]
    return said


def changes(old: Row, new: Row, unit: float) -> list[str]:
    """What changed in a row, when everything else took `unit` times as long."""
    if old.error is not None and new.error is None:
        return [f"has no answer any more: {new.failure}"]
    told = []
    if old.error and new.error and new.error > WORSE * old.error:
        told.append(f"is off by {short(new.error)}, it was {short(old.error)}")
    factor = new.seconds / old.seconds / unit
    apart = new.quartiles[0] > old.quartiles[1] * unit or new.quartiles[1] < old.quartiles[0] * unit
    if (factor > MOVED or factor < 1 / MOVED) and apart:
        way = "slower" if factor > 1 else "quicker"
        told.append(f"is {max(factor, 1 / factor):.2g} times {way}: {duration(new.seconds)}")
    return told


def _key(row: Row) -> tuple[str, str]:
    return row.method, row.setting
