"""A branch as a labelled table: an xarray Dataset, a record for JSON, and lines for people.

Points and events stand in one order, by arc length; `event` is empty at an ordinary point.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from verification.continuation.arc import Point
from verification.continuation.branch import Branch, Event
from verification.continuation.linear import Spectrum

if TYPE_CHECKING:
    import xarray


def rows(branch: Branch) -> list[tuple[Point, Event | None]]:
    """Points and events in order."""
    both: list[tuple[Point, Event | None]] = [(point, None) for point in branch.points]
    both += [(event.point, event) for event in branch.events]
    return sorted(both, key=lambda row: (row[0].s, row[1] is not None))


def spectrum_of(point: Point) -> Spectrum:
    """The multipliers at a point."""
    return Spectrum(point.tests["one"], point.tests["minus_one"], point.tests["volume"] + 1)


def dataset(branch: Branch) -> "xarray.Dataset":
    """Dimensions `point`, `bounce` and `which` (multiplier); the letter and the event are coordinates.

    >>> from verification.continuation.branch import branch as followed
    >>> from verification.continuation.maps import logistic
    >>> table = dataset(followed(logistic(1), np.array([0.6]), "r", 2.5, (2.0, 3.4)))
    >>> [str(name) for name in table["event"].values if name], table["x"].dims
    (['period doubling'], ('point', 'bounce'))
    """
    import xarray

    listed = rows(branch)
    letter, n = branch.system.letter, branch.system.recurrence.period
    spectra = [spectrum_of(point) for point, _ in listed]
    multipliers = np.array([s.multipliers for s in spectra]).reshape(len(listed), 2)
    values = {
        "x": (("point", "bounce"), np.array([point.z[:-1] for point, _ in listed]).reshape(len(listed), n)),
        "multiplier_real": (("point", "which"), multipliers.real),
        "multiplier_imaginary": (("point", "which"), multipliers.imag),
        "determinant": ("point", np.array([s.determinant for s in spectra])),
        "stable": ("point", np.array([s.stable for s in spectra])),
        "branch_coefficient": (
            "point",
            np.array([np.nan if e is None or e.form is None else e.form.branch for _, e in listed]),
        ),
    }
    coordinates = {
        letter: ("point", np.array([point.z[-1] for point, _ in listed])),
        "arclength": ("point", np.array([point.s for point, _ in listed])),
        "event": ("point", np.array(["" if e is None else e.what.value for _, e in listed])),
    }
    about = {"cycle": branch.system.label, "letter": letter, **_ended(branch)}
    return xarray.Dataset(values, coordinates, attrs=about)


def record(branch: Branch) -> dict[str, Any]:
    """The same for JSON."""
    letter, points = branch.system.letter, []
    for point, event in rows(branch):
        spectrum = spectrum_of(point)
        form = event.form if event is not None else None
        points.append(
            {
                letter: float(point.z[-1]),
                "arclength": point.s,
                "theta": [float(x) for x in point.z[:-1]],
                "multipliers": [{"real": m.real, "imaginary": m.imag} for m in spectrum.multipliers],
                "determinant": spectrum.determinant,
                "stable": spectrum.stable,
                "event": event.what.value if event is not None else None,
                "branch_coefficient": form.branch if form is not None else None,
                "supercritical": form.supercritical if form is not None else None,
            }
        )
    return {"cycle": branch.system.label, "letter": letter, **_ended(branch), "points": points}


def _ended(branch: Branch) -> dict[str, str]:
    return {"first_end": branch.ends[0][1], "last_end": branch.ends[1][1]}
