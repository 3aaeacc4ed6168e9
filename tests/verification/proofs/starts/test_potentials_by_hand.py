"""Potentials of standard pairs on a few labels: what each step makes of masses and ends, worked out by hand."""

from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats, integers

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.starts import typical as typical_of
from verification.proofs.starts.labels import Labels, Targets
from verification.proofs.starts.typical import LARGEST, SLACK, TINY, Balance, Cut

ONE, TWO = Chart("one", (0.0, 2.0), (-1.0, 1.0)), Chart("two", (2.0, 4.0), (-1.0, 1.0))


def labelled(cells, charts=(ONE, TWO), slope=1.0) -> Labels:
    """Labels of eight columns of width 1/4 and eight rows of height 1/4, of curves of one slope."""
    found = Labels(SimpleNamespace(charts=charts, closed=False), 8, 8)
    found.add(*np.array(cells, dtype=np.int64).T)
    found.low = found.top = np.full(found.count, slope)
    return found


def pairs(cells=((0, 0, 1), (0, 1, 2), (0, 2, 3)), edges=((0, 0, 1, 2), (1, 2, 2, 0)), broken=(), spread=None, **given):
    """Three labels in a row, with four edges; the first chart alone."""
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
    none = integers()
    empty = SimpleNamespace(
        targets=Targets(none, none, none, none, none), leaves=(floats(), floats()), last=np.zeros(0, dtype=bool)
    )
    edges = tuple(integers(*side) for side in edges)
    density = full(given.pop("density", 0.0))
    return SimpleNamespace(labels=labels, cast=cast, spread=spread or empty, edges=edges, density=density)


def test_densities_lengths_and_stretchings_of_a_balance_are_on_the_safe_side():
    made = Balance(pairs(density=(0.0, 1.0, 2.0), least=(1.5, 2.0, 3.0)), 8)
    exact = 0.25 / (1 - np.array([0.0, 0.25, 0.5]))
    assert np.all((exact < made.length) & (made.length < exact * (1 + 1e-11)))
    exact = np.array([1.5, 2.0, 3.0])
    assert np.all((exact * (1 - 1e-11) < made.least) & (made.least < exact))
    assert made.best(floats(5.0, 1.0, 3.0)).tolist() == [3.0, 3.0, 5.0]


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


def test_without_a_join_no_window_is_asked_for_and_one_column_is_enough():
    assert Balance(pairs(), 0).cuts == []
    assert Balance(pairs(labels=labelled(((0, 0, 1), (0, 1, 2), (0, 2, 3)))), 1).cuts == []


def test_what_is_gained_is_the_logarithm_of_the_stretching_of_each_part_from_either_side():
    rate = np.array([[2.0, 3.0, 4.0, 5.0], [-2.0, -2.0, -2.0, -2.0], [8.0, 1.5, 2.5, 1.5]])
    made = Balance(pairs(rate=rate, radius=0.25), 8)
    for gain, side in ((0, 1), (1, -1)):
        exact = side * np.log(np.abs(rate) + side * 0.25)
        mean, most = made.gains[gain]
        assert mean == pytest.approx(exact.mean(1) + SLACK / 10, abs=1e-12)
        assert most == pytest.approx(exact.max(1) + SLACK / 10, abs=1e-12)


def test_two_images_of_a_part_count_as_the_one_that_gains_more():
    found = pairs()
    found.cast = SimpleNamespace(**vars(found.cast) | {"label": integers(*[0] * 5, *[1] * 4, *[2] * 4)})
    found.cast.part = integers(0, 0, 1, 2, 3, *range(4), *range(4))
    found.cast.landed.stretch = BallArray(floats(2, 6, 2, 2, 2, *[2] * 8), 0.0)
    high, low = (mean[0] for mean, _ in Balance(found, 8).gains)
    assert high == pytest.approx((np.log(6.0) + 3 * np.log(2.0)) / 4, abs=1e-9)
    assert low == pytest.approx(-np.log(2.0), abs=1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.2, 0.5])
def test_a_mean_over_a_column_is_at_most_that_of_any_density_that_may_be(turn):
    """By all extreme shares of the first parts; and by densities `exp(d*x)` with `abs(d)` up to what is allowed."""
    values = np.random.default_rng(3).normal(size=(40, 4))
    found = Balance._mean(values, np.full(40, turn))
    shares = [[0.0, *x, 1.0] for x in product(*([k / 4 - turn / 4, k / 4 + turn / 4] for k in (1, 2, 3)))]
    exact = np.max([values @ np.diff(share) for share in shares], axis=0)
    assert found == pytest.approx(exact, abs=1e-12)
    for d in np.linspace(-turn, turn, 9):
        weight = np.diff(np.expm1(d * np.arange(5) / 4)) if d else np.full(4, 0.25)
        assert np.all(values @ (weight / weight.sum()) <= found + 1e-12)
    steep = Balance._mean(np.array([[5.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 5.0]]), floats(2.0, 2.0))
    assert steep.tolist() == [1 + 4 * 0.75, 5 - 4 * 0.25]  # shares of the first parts are 0 to 1
    wide = Balance._mean(np.array([[5.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 5.0]]), floats(4.0, 4.0))
    assert wide.tolist() == [5.0, 5.0]


CELLS = (0, 0, 1), (0, 1, 2), (0, 1, 3), (0, 2, 3), (0, 3, 4)
Y = floats(1.0, 4.0, 2.0, 7.0, 3.0)


def spread_over(leaves, sources=(0, 0, 0, 1, 1, 2)) -> SimpleNamespace:
    """The first label over three columns, the second over two, and the third within one."""
    number = len(sources)
    column = integers(1, 2, 3, 0, 1, 3)[:number]
    rows = integers(2, 3, 4, 1, 2, 4)[:number], integers(3, 3, 4, 1, 3, 4)[:number]
    last = np.append(np.diff(sources) > 0, True)
    return SimpleNamespace(
        targets=Targets(integers(*sources), np.zeros(number, dtype=np.int64), column, *rows), leaves=leaves, last=last
    )


EDGES = (0, 0, 0, 0, 1, 1, 1, 2, 3, 4), (1, 2, 3, 4, 0, 1, 2, 4, 0, 1)


@pytest.mark.parametrize("density", [0.0, 1.0])
def test_the_mean_over_an_image_is_at_most_that_of_all_shares_that_its_columns_may_have(density):
    """Of each column the best of its labels; the shares to the left of borders lie between what is known of them."""
    low, high = floats(0.25, 0.5, 1, 0.375, 1, 1), floats(0.375, 0.75, 1, 0.5, 1, 1)
    made = Balance(pairs(CELLS, EDGES, spread=spread_over((low, high)), density=density), 8)
    off = density * 0.25 / 4
    best = ([4.0, 7.0, 3.0], [1.0, 4.0], [3.0])
    for label, rows in enumerate((slice(0, 3), slice(3, 5), slice(5, 6))):
        ways = [(max(0, a - off), min(1, b + off)) for a, b in zip(low[rows][:-1], high[rows][:-1], strict=True)]
        shares = [[0.0, *x, 1.0] for x in product(*ways)]
        exact = max(float(np.dot(best[label], np.diff(share))) for share in shares)
        assert made.shared(Y)[label] == pytest.approx(exact, abs=1e-12)
    made.found.cast.broken[0] = True  # of a broken label the best edge is taken
    assert made.shared(Y)[0] == 7.0
    assert made.shared(Y)[1] < 4.0
    made.found.cast.broken[0] = False
    assert made.shared(Y / 16) == pytest.approx(made.shared(Y) / 16, abs=1e-15)


def test_shares_that_are_known_badly_are_between_0_and_1():
    low, high = floats(-0.5, 0.5, 1, -0.125, 1.5, 1), floats(0.375, 1.75, 1, 1.25, 1.5, 1)
    made = Balance(pairs(CELLS, EDGES, spread=spread_over((low, high))), 8)
    assert made.first[0].tolist() == [0, 0.5, 1, 0, 1, 1]
    assert made.first[1].tolist() == [0.375, 1, 1, 1, 1, 1]
    assert made.shared(Y)[1] == 4.0


def test_without_a_spread_the_best_edge_is_taken():
    assert Balance(pairs(), 8).shared(floats(5.0, 1.0, 3.0)).tolist() == [3.0, 3.0, 5.0]


def balanced(**given) -> SimpleNamespace:
    """Two labels, with two joins: what is at the first cuts the first, and the second both."""
    cuts = [
        SimpleNamespace(window=np.array([True, False]), near=np.array([True, True]), mass=floats(2, 3), size=5.0,
                        new=integers(0, 1)),
        SimpleNamespace(window=np.array([True, True]), near=np.array([False, True]), mass=floats(7, 11), size=13.0,
                        new=integers(1)),
    ]  # fmt: skip
    stub = SimpleNamespace(count=2, cuts=cuts, gains=((floats(0.5, 0.25), floats(1.5, 0.75)),) * 2, length=floats(3, 5),
                           least=floats(2, 4), best=lambda x: x[::-1], shared=lambda x: 2 * x, **given)  # fmt: skip
    for name in ("charged", "excess", "ends", "step", "holds", "roundings", "proved"):
        if name not in given:
            setattr(stub, name, lambda *a, name=name: getattr(Balance, name)(stub, *a))
    return stub


def test_cuts_cost_as_much_as_the_ends_that_they_make():
    mass, end = balanced().charged(floats(17.0, 1.0))
    assert mass.tolist() == [2 * 17 + 7 * 1, 11 * 1]
    assert end.tolist() == [5 * 17, 5 * 17 + 13 * 1]


def test_one_bounce_of_the_numbers_of_ends_and_masses():
    """By the inequalities of the module's docstring."""
    made, y, s = balanced(), floats(2.0, 8.0), floats(0.5, 0.25)
    w, v = floats(10.0, 30.0), floats(17.0, 1.0)
    assert made.excess(0, y, 0.5).tolist() == [1.5 + 8 - 2 - 0.5, 0.0]
    rest = np.array([30 / 2 + 85, 10 / 4 + 98]) + TINY
    for found, exact in zip(made.ends(s, w, v), (rest + np.array([1.5, 1.25]), rest), strict=True):
        assert np.all((exact < found) & (found < exact * (1 + 1e-11)))
    assert made.step(0, y, v).tolist() == [0.5 + 4 + 41, 0.25 + 16 + 11]
    least = floats(0.0, 0.0)
    made.charged = lambda v: (least, least)
    assert np.all(made.ends(least, least, v)[0] >= TINY)
    assert np.all(made.ends(least, least, v)[1] >= TINY)


def holding(**changed) -> bool:
    """Of numbers that just hold, some of them changed."""
    given = {"w": 2.0, "v": 3.0, "least": (2.0, 3.0), "left": 0.0, "high": SLACK, "y": 0.0, "roundings": 0.0} | changed
    pair = lambda x: np.broadcast_to(np.asarray(x, dtype=float), (2,)).copy()  # noqa: E731
    asked = []
    made = balanced(
        excess=lambda gain, y, high: asked.append((gain, high)) or pair(0.5),
        ends=lambda s, w, v: asked.append(s.tolist()) or tuple(map(pair, given["least"])),
        step=lambda gain, y, v: pair(given["left"]),
        roundings=lambda gain, y, left, high: given["roundings"],
    )
    found = Balance.holds(made, 1, *(pair(given[name]) for name in "ywv"), given["high"])
    assert asked == [(1, given["high"]), [0.5 + SLACK] * 2]
    return found


@pytest.mark.parametrize(
    "changed",
    [
        {"w": (2.0, np.nextafter(2, 0))},
        {"v": (np.nextafter(3, 0), 3.0)},
        {"high": np.nextafter(SLACK, 0)},
        {"left": (0.0, 1e-12)},
        {"w": LARGEST, "least": (2.0, 3.0)},
        {"w": (LARGEST, 2.0)},
        {"v": LARGEST},
        {"y": LARGEST},
        {"left": -LARGEST},
        {"roundings": SLACK / 2},
        {"w": (0.0, 2.0), "least": (0.0, 3.0)},
        {"v": (3.0, 0.0), "least": (2.0, 0.0)},
        {"w": (-1.0, 2.0), "least": (-1.0, 3.0)},
    ],
)
def test_each_inequality_of_a_potential_fails_alone(changed):
    assert holding()
    assert holding(w=0.5, v=0.25, least=(0.5, 0.25))
    assert holding(w=LARGEST - 1, v=LARGEST - 1, y=LARGEST - 1, left=1 - LARGEST, roundings=SLACK / 2.1)
    assert not holding(**changed)


def test_roundings_are_bounded_by_the_number_of_terms_and_their_size():
    """Three targets of a label, 4 parts and 2 cuts; sizes by the greatest moduli, and of the bound itself."""
    made = balanced()
    made.found = SimpleNamespace(
        labels=SimpleNamespace(parts=4), spread=SimpleNamespace(targets=SimpleNamespace(source=integers(0, 1, 1, 1)))
    )
    found = made.roundings(0, floats(-8.0, 2.0), floats(1.0, 16.0), -0.25)
    assert found == pytest.approx((3 + 4 + 2 + 8) ** 2 * (8 + 16 + 0.5 + 1.5 + 0.25) * 2.0**-50, rel=1e-12, abs=0)
    made.found.spread.targets.source = integers()
    assert made.roundings(0, floats(0.0, 0.0), floats(0.0, 0.0), 0.0) == pytest.approx(
        (0 + 4 + 2 + 8) ** 2 * 2.0 * 2.0**-50, abs=0
    )


@pytest.mark.parametrize(("enough", "first", "bound"), [
    (0.0, 1.0, 1.0), (3.0, 1.0, 3.0 + 4 * SLACK), (3.0 + 10 * SLACK, 1.0, 3.0 + 12 * SLACK),
    (3.0 + 30 * SLACK, 1.0, None), (0.0, LARGEST, None), (0.0, np.inf, None), (0.0, np.nan, None),
    (3.0 + 19 * SLACK, 1.0, 3.0 + 20 * SLACK), (3.0 + 21 * SLACK, 1.0, None),
])  # fmt: skip
def test_a_bound_is_one_for_which_all_inequalities_hold(enough, first, bound):
    """With a step that takes `y` up by 3: the next bound asked is above it, and then above the last one; six are."""
    made = balanced(
        potential=lambda gain: (floats(1.0, 2.0), first), weights=lambda gain, y, high: (floats(high, 1), floats(2, 2)),
        step=lambda gain, y, v: y + floats(3.0, 1.0),
        holds=lambda gain, y, w, v, high: w[0] == high and high >= enough,
    )  # fmt: skip
    found = Balance.proved(made, 0)
    assert found == bound or found == pytest.approx(bound, abs=SLACK / 100)


DIAGONAL = tuple((0, k, k) for k in range(8))


def cut(window: int = 1, broken: int = 4, cells=DIAGONAL, edges=((4, 4, 4, 3), (0, 7, 2, 1)), **given) -> Cut:
    """Curves along the diagonal of eight columns, one of which is broken."""
    found = pairs(tuple(sorted(cells)), edges, labels=labelled(cells, (ONE,)), **{"most": 0.5} | given)
    return Cut(found, integers(broken), window)


@pytest.mark.parametrize(("window", "columns"), [(1, {3, 5}), (2, {2, 3, 5, 6})])
def test_windows_are_the_labels_that_curves_have_in_so_many_columns_on_either_side(window, columns):
    made = cut(window, most=0.25)
    assert set(np.flatnonzero(made.window).tolist()) == columns
    assert set(np.flatnonzero(made.near).tolist()) == columns | {4}
    assert made.new.tolist() == [0, 7]


def test_a_window_holds_each_row_that_a_curve_of_the_label_may_cross_and_no_other():
    """Curves of slope 1: from row 4 to rows 4 to 6 on the right, borders included, of those that are in use."""
    cells = ((0, 4, 4), *((0, k, row) for k in (3, 5) for row in range(8)), (0, 0, 0), (0, 7, 7))
    labels = labelled(cells, (ONE,))
    name = {cell: k for k, cell in enumerate(zip(labels.chart, labels.column, labels.row, strict=True))}
    own = name[0, 4, 4]
    found = pairs(labels=labels, edges=((own,), (name[0, 0, 0],)), most=0.25)
    held = [(int(labels.column[k]), int(labels.row[k])) for k in np.flatnonzero(Cut(found, integers(own), 1).window)]
    assert set(held) == {(3, 2), (3, 3), (3, 4), (5, 4), (5, 5), (5, 6)}


@pytest.mark.parametrize(("broken", "window", "taken"), [(1, 1, True), (0, 1, False), (6, 1, True), (7, 1, False),
                                                         (1, 2, False)])  # fmt: skip
def test_a_window_that_goes_beyond_its_component_is_refused(broken, window, taken):
    """Curves of slope 0, all in one row."""
    labels = labelled([(0, k, 4) for k in range(8)], (ONE,), 0.0)
    found = pairs(labels=labels, edges=((broken,), (0,)), most=0.25)
    if taken:
        assert Cut(found, integers(broken), window).new.tolist() == [0]
    else:
        with pytest.raises(ValueError, match="next to a join"):
            Cut(found, integers(broken), window)


@pytest.mark.parametrize(("change", "why"), [
    ({"most": 1.6}, None), ({"most": 1.61}, "twice"), ({"most": np.where(np.arange(8) == 1, 9.0, 1.0)}, None),
    ({"most": np.where(np.arange(8) == 4, 1.61, 1.0)}, "twice"),
    ({"most": np.where(np.arange(8) == 5, 1.61, 1.0)}, "twice"),
    ({"density": 1.0}, None), ({"density": 1.01}, "too much"),
    ({"density": np.where(np.arange(8) == 6, 9.0, 0.5)}, None),
    ({"density": np.where(np.arange(8) == 3, 1.01, 0.5)}, "too much"),
    ({"edges": ((4, 3), (2, 0))}, "no label is known"),
    ({"window": 2, "most": 8 / 7, "density": 0.5}, None), ({"window": 2, "most": 1.15}, "twice"),
    ({"window": 2, "density": 0.67}, "too much"),
])  # fmt: skip
def test_each_hypothesis_of_a_cut_fails_alone(change, why):
    """A window of one column: five columns of width 1/4, stretched, are at most 2; densities vary over two."""
    if why:
        with pytest.raises(ValueError, match=why):
            cut(**change)
    else:
        cut(**change)


def test_the_mass_next_to_a_cut_bounds_the_density_there():
    """The density at the cut, by the stretching; on half of each side of the window, of which the mass is taken."""
    made = cut(2, density=0.25, least=np.where(np.arange(8) == 4, 1.5, 0.25), most=0.5)
    exact = 1 / (1.5 * (1 - 3 * 0.25 * 0.25))
    assert exact < made.size < exact * (1 + 1e-11)
    assert made.mass == pytest.approx(np.full(8, exact / (2 * 0.25)), rel=1e-11)
    assert np.all(made.mass > exact / (2 * 0.25))


@pytest.mark.parametrize(("chart", "theta", "joins"), [
    (0, (1.9, 2.0), [0]), (0, (1.9, 2.0 - 2e-7), [0]), (0, (1.9, 2.0 - 1e-6), None), (1, (2.0, 2.1), [0]),
    (1, (2.0 + 2e-7, 2.1), [0]), (1, (2.0 + 1e-6, 2.1), None), (1, (3.9, 4.0), [1]), (2, (4.0, 4.1), [1]),
    (2, (4.9, 5.0), [2]), (0, (0.0, 0.1), [2]), (0, (0.0, 2.0), [0, 2]), (1, (2.0, 4.0), [0, 1]),
])  # fmt: skip
def test_a_broken_label_is_cut_at_the_joins_that_its_images_come_to(monkeypatch, chart, theta, joins):
    """Of three charts side by side, whose ends meet too; a label broken elsewhere is refused, if only one is."""
    asked = []
    monkeypatch.setattr(typical_of, "Cut", lambda found, which, window: asked.append((which.tolist(), window)))
    labels = labelled(((0, 0, 1), (0, 1, 2), (1, 2, 3)), (ONE, TWO, Chart("three", (4.0, 5.0), (-1.0, 1.0))))
    found, on = pairs(labels=labels, broken=(1,)), np.arange(12)
    middle, half = sum(theta) / 2, (theta[1] - theta[0]) / 2
    found.cast.landed.theta = BallArray(
        np.where(on == 6, middle, np.where(on < 8, 1.0, 3.0)), np.where(on == 6, half, 0.1)
    )
    found.cast.landed.theta.r[:4] = 1.0  # of an unbroken label nothing is asked
    found.cast.landed.chart[6] = chart
    if joins is None:
        with pytest.raises(ValueError, match="where no join is"):
            Balance(found, 3)
    else:
        assert len(Balance(found, 3).cuts) == len(joins)
        assert asked == [([1], 3)] * len(joins)
        found.cast.landed.chart[7], found.cast.landed.theta.m[7] = 1, 2.0  # another part comes to the first join
        assert len(Balance(found, 3).cuts) == len({0, *joins})
        found.cast.broken[2] = True
        with pytest.raises(ValueError, match="where no join is"):
            Balance(found, 3)


@pytest.mark.parametrize(("most", "taken"), [(0.8, True), (0.81, False)])
def test_a_window_is_compared_with_the_shortest_component_and_the_widest_columns(most, taken):
    """Of lengths 2 and 1, in columns of 1/4 and 1/8: five of 1/4, stretched, are at most 1."""
    labels = labelled([(0, k, 4) for k in range(8)], (ONE, Chart("half", (2.0, 3.0), (-1.0, 1.0))), 0.0)
    labels.columns, labels.wide = integers(8, 8), floats(0.25, 0.125)
    found = pairs(labels=labels, edges=((4, 4), (0, 2)), most=most)
    if taken:
        assert Cut(found, integers(4), 1).new.tolist() == [0]
    else:
        with pytest.raises(ValueError, match="twice"):
            Cut(found, integers(4), 1)


def test_of_several_broken_labels_the_one_that_is_stretched_least_counts():
    labels = labelled([(0, k, 4) for k in range(8)], (ONE,), 0.0)
    least = np.where(np.arange(8) == 3, 1.5, np.where(np.arange(8) == 4, 2.0, 0.25))
    found = pairs(labels=labels, edges=((3, 4), (0, 7)), most=0.25, least=least)
    made = Cut(found, integers(3, 4), 1)
    assert made.size == pytest.approx(1 / 1.5, rel=1e-11)
    assert np.flatnonzero(made.window).tolist() == [2, 3, 4, 5]
    assert made.new.tolist() == [0, 7]
    with pytest.raises(ValueError, match="next to a join"):
        Cut(found, integers(3, 7), 1)
