"""Refused potentials and refused cuts at joins: each hypothesis fails alone."""

from types import SimpleNamespace

import numpy as np
import pytest

from verification.arithmetic.arrays import BallArray
from verification.proofs.starts.labels import Labels, Targets
from verification.proofs.starts.typical import Balance, Cut
from verification.rigorous.boxes import Chart

ONE, TWO = Chart("one", (0.0, 2.0), (-1.0, 1.0)), Chart("two", (2.0, 4.0), (-1.0, 1.0))


def labelled(cells, charts=(ONE, TWO), slope=1.0) -> Labels:
    """Labels on eight columns of width 1/4 and eight rows of height 1/4, for curves of one slope."""
    found = Labels(SimpleNamespace(charts=charts, closed=False), 8, 8)
    found.add(*np.array(cells, dtype=np.int64).T)
    found.low = found.top = np.full(found.count, slope)
    return found


def pairs(cells=((0, 0, 1), (0, 1, 2), (0, 2, 3)), edges=((0, 0, 1, 2), (1, 2, 2, 0)), broken=(), spread=None, **given):
    """Three labels in a row and four edges, on the first chart."""
    labels = given.pop("labels", None) or labelled(cells, (ONE,))
    count, full = labels.count, lambda x: np.broadcast_to(np.asarray(x, dtype=float), (labels.count,)).copy()
    rate = np.asarray(given.pop("rate", np.full((count, 4), 2.0)))
    landed = SimpleNamespace(
        chart=np.repeat(labels.chart, 4), theta=BallArray(np.full(4 * count, given.pop("theta", 1.0)), 0.125),
        stretch=BallArray(rate.ravel(), given.pop("radius", 0.0)),
    )  # fmt: skip
    cast = SimpleNamespace(
        landed=landed, label=np.repeat(np.arange(count), 4), part=np.tile(np.arange(4), count),
        broken=np.isin(np.arange(count), broken), least=full(given.pop("least", 2.0)),
        most=full(given.pop("most", 2.0)),
    )  # fmt: skip
    none = np.zeros(0, dtype=np.int64)
    empty = SimpleNamespace(
        targets=Targets(none, none, none, none, none), leaves=(np.zeros(0), np.zeros(0)), last=np.zeros(0, dtype=bool)
    )
    edges = tuple(np.array(side) for side in edges)
    density = full(given.pop("density", 0.0))
    return SimpleNamespace(labels=labels, cast=cast, spread=spread or empty, edges=edges, density=density)


@pytest.mark.parametrize(("change", "window", "why"), [
    ({"density": (0.0, 0.0, 2.01)}, 8, "within a column"),
    ({"edges": ((0, 0, 1), (1, 2, 2))}, 8, "no image"),
    ({"edges": ((0, 0, 2), (1, 2, 2))}, 8, "no image"),
    ({"edges": ((0, 0, 1), (1, 2, 0))}, 8, "no image"),
    ({"labels": labelled(((0, 0, 1), (0, 1, 2), (0, 2, 3)))}, 0, "at least one column"),
])  # fmt: skip
def test_what_is_no_balance_is_refused(change, window, why):
    with pytest.raises(ValueError, match=why):
        Balance(pairs(**change), window)


DIAGONAL = tuple((0, k, k) for k in range(8))


def cut(window: int = 1, broken: int = 4, cells=DIAGONAL, edges=((4, 4, 4, 3), (0, 7, 2, 1)), **given) -> Cut:
    """Curves along the diagonal of eight columns, with one broken column."""
    found = pairs(tuple(sorted(cells)), edges, labels=labelled(cells, (ONE,)), **{"most": 0.5} | given)
    return Cut(found, np.array([broken]), window)


@pytest.mark.parametrize(("broken", "window", "taken"), [(1, 1, True), (0, 1, False), (6, 1, True), (7, 1, False),
                                                         (1, 2, False)])  # fmt: skip
def test_a_window_that_goes_beyond_its_component_is_refused(broken, window, taken):
    """Curves of slope 0, all in one row."""
    labels = labelled([(0, k, 4) for k in range(8)], (ONE,), 0.0)
    found = pairs(labels=labels, edges=((broken,), (0,)), most=0.25)
    if taken:
        assert Cut(found, np.array([broken]), window).new.tolist() == [0]
    else:
        with pytest.raises(ValueError, match="a window beside a join"):
            Cut(found, np.array([broken]), window)


@pytest.mark.parametrize(("change", "why"), [
    ({"most": 1.6}, None), ({"most": 1.61}, "twice"), ({"most": np.where(np.arange(8) == 1, 9.0, 1.0)}, None),
    ({"most": np.where(np.arange(8) == 4, 1.61, 1.0)}, "twice"),
    ({"most": np.where(np.arange(8) == 5, 1.61, 1.0)}, "twice"),
    ({"density": 1.0}, None), ({"density": 1.01}, "too much"),
    ({"density": np.where(np.arange(8) == 6, 9.0, 0.5)}, None),
    ({"density": np.where(np.arange(8) == 3, 1.01, 0.5)}, "too much"),
    ({"edges": ((4, 3), (2, 0))}, "no label holds"),
    ({"window": 2, "most": 8 / 7, "density": 0.5}, None), ({"window": 2, "most": 1.15}, "twice"),
    ({"window": 2, "density": 0.67}, "too much"),
])  # fmt: skip
def test_each_hypothesis_of_a_cut_fails_alone(change, why):
    """A window of one column: five columns of width 1/4 are stretched to 2 at most, with densities that vary."""
    if why:
        with pytest.raises(ValueError, match=why):
            cut(**change)
    else:
        cut(**change)
