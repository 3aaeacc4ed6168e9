"""All cycles: known counts, index laws, a second count, and proofs of completeness."""

import json
from fractions import Fraction
from math import pi

import numpy as np
import pytest
from click.testing import CliRunner
from flint import arb
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.phase_points import phase_points
from symbolic import Law, Scene, tables
from symbolic.tables import circle, cuspless, egg, ellipse
from verification.app.commands.orbit import cycles_command as cycles
from verification.app.commands.orbit import provable
from verification.arithmetic.balls import working
from verification.cycles.cells import Corrector, fixed_points
from verification.cycles.problem import Problem
from verification.cycles.search import Catalogue, all_cycles
from verification.named.attractors import certificate
from verification.proofs.periodic.completeness import enclosed, no_others, reflection, start, stays_below, steepest
from verification.proofs.periodic.interval_newton import ZeroStatus, krawczyk
from verification.proofs.slap_map.exponent import periodic_points

TABLE = egg(3).at(alpha="2/25")
LAM = Rational(2, 5)


@pytest.fixture(scope="module")
def found():
    return all_cycles(TABLE, LAM, 6)


@pytest.mark.slow
def test_the_index_sums_vanish_for_every_period_and_every_number_of_turns(found):
    for n in range(2, 7):
        sums = found.catalogue.index_sums(n)

        assert set(sums.values()) <= {0}
    assert all(found.balanced.values())


def test_the_cycles_that_continuation_knows_are_among_them(found):
    """At lam = 0.4: three diameters, three parallels, four triangles; per diameter three cycles of period 4."""
    counts = {n: found.catalogue.count(n) for n in range(2, 7)}

    assert counts == {2: 6, 3: 4, 4: 9, 5: 0, 6: 0}
    assert [c.spectrum.stable for c in found.catalogue.cycles].count(True) == 2  # a triangle each way round


def test_every_cycle_obeys_the_map(found):
    map = PinballMap(TABLE, lam=float(LAM))
    for cycle in found.catalogue.cycles:
        landed = map.step(np.array(cycle.theta), np.array(cycle.phi))

        assert np.max(np.abs(np.sin((landed.theta - np.roll(cycle.theta, -1)) / 2))) < 1e-9
        assert np.max(np.abs(landed.phi - np.roll(cycle.phi, -1))) < 1e-9


@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_count_on_cells_agrees_with_the_search(found, n):
    zeros = fixed_points(PinballMap(TABLE, lam=float(LAM)), n)
    own = [sum(c.period for c in found.catalogue.of(n) if c.index(n) == sign) for sign in (1, -1)]

    assert zeros.open == 0
    assert [zeros.positive, zeros.negative] == own


@pytest.mark.slow
def test_squares_that_symmetry_makes_alike_are_told_apart():
    """A bug found by the index law: all squares had the same sums of cosines, 0, and two passed for one."""
    searched = all_cycles(egg(4).at(alpha="1/18"), Rational(7, 10), 4)
    squares = [c for c in searched.catalogue.cycles if c.period == 4 and np.ptp(c.phi) < 1e-9]

    assert searched.balanced[4] is True
    assert sorted(c.index(4) for c in squares) == [-1, -1, 1, 1]  # at the flats and at the vertices, each way round


def test_at_lam_zero_the_count_is_that_of_the_slap_map():
    searched = all_cycles(TABLE, Rational(0), 4).catalogue
    for n in (2, 4):
        zeros = fixed_points(PinballMap(TABLE, lam=0), n)

        assert zeros.positive + zeros.negative == sum(c.period for c in searched.of(n))


def test_the_slap_map_of_the_cuspless_cardioid_has_the_cycles_that_subdivision_encloses():
    searched = all_cycles(cuspless, Rational(0), 2).catalogue

    assert sum(c.period for c in searched.of(2)) == len(periodic_points(2).stretches)


@pytest.mark.slow
def test_completeness_is_proved_for_short_periods_and_left_open_without_budget(found):
    assert no_others(found.catalogue, LAM, 2).complete is True
    assert no_others(found.catalogue, LAM, 3, budget=50).complete is None
    short = all_cycles(egg(3).at(alpha="2/25"), Rational(0), 3).catalogue
    assert no_others(short, Rational(0), 3).complete is True  # paper: section 6.2, no period 3 at lam = 0


@pytest.mark.slow
def test_a_catalogue_that_lacks_a_cycle_is_not_proved_complete():
    catalogue = all_cycles(ellipse.at(a="3/2"), Rational(1, 2), 2).catalogue
    assert no_others(catalogue, Rational(1, 2), 2).complete is True
    catalogue.cycles.pop()

    assert no_others(catalogue, Rational(1, 2), 2, budget=1500).complete is None
    assert any(catalogue.index_sums(2).values())


BENT = [
    "-lam*eta",
    "-lam*eta*(1 - eta**2/8)",
    "-lam*eta - sin(2*eta)/20",
    "-lam*eta + cos(theta)/20",
    "-eta*lam**2 - cos(theta)/9",
]


def near_the_axes(formula):
    """A catalogue of the two cycles of period 2 next to the ellipse's axes, made without a search."""
    law, table = Law(formula), ellipse.at(a="3/2")
    catalogue, corrector = Catalogue(table, 0.5, law=law), Corrector(table, 0.5, law)
    rows = corrector.closed((0, 0), np.array([[1.5, -1.6], [0.1, 3.1]]))
    for x, phi in zip(rows, corrector.exits((0, 0), rows), strict=True):
        catalogue.add((0, 0), x, phi)
    return catalogue


@pytest.mark.slow
@pytest.mark.parametrize("formula", BENT)
def test_completeness_is_proved_for_other_laws_and_not_of_a_catalogue_that_lacks_a_cycle(formula):
    catalogue = near_the_axes(formula)
    assert catalogue.count(2) == 2
    assert no_others(catalogue, Rational(1, 2), 2).complete is True
    for cycle in list(catalogue.cycles):
        catalogue.cycles.remove(cycle)
        assert no_others(catalogue, Rational(1, 2), 2, budget=4000).complete is None
        catalogue.cycles.append(cycle)


@pytest.mark.slow
def test_completeness_is_proved_across_the_jump_of_a_law_of_arc_length_and_not_without_a_cycle_beside_it():
    law, table = Law("-lam*eta + sin(s)/30"), ellipse.at(a="3/2")
    found = all_cycles(table, Rational(3, 10), 2, law=law).catalogue
    beside = min(found.cycles, key=lambda cycle: pi - max(map(abs, cycle.theta)))

    assert pi - max(map(abs, beside.theta)) < 0.02
    assert found.count(2) == 3
    assert no_others(found, Rational(3, 10), 2, budget=2000).complete is True
    found.cycles.remove(beside)
    assert no_others(found, Rational(3, 10), 2, budget=2000).complete is None


def test_boxes_of_a_cover_meet_without_a_rounding_between_them():
    """Two boxes 2**-51 apart once missed a cycle with gap pi between them, and the catalogue seemed complete."""
    box = start(2, 2, 0.5)
    for _ in range(64):  # down to the smallest
        low, high = box.halves()[:1], box.halves()[1:]
        ends = [[Fraction(m) + sign * Fraction(h) for sign in (-1, 1)] for part in (box, low, high)
                for m, h in zip(part.middle[0], part.half[0], strict=True)]  # fmt: skip
        whole, first, last = ends[:2], ends[2:4], ends[4:]
        cut = next(k for k in range(2) if first[k] != last[k])

        assert first[1 - cut] == last[1 - cut] == whole[1 - cut]
        assert [*first[cut], *last[cut]] == [whole[cut][0], first[cut][1], first[cut][1], whole[cut][1]]
        box = high


def test_all_exit_angles_are_below_the_bound_that_leaves_chords_out():
    law, grid = Law("-lam*eta + cos(theta)/20 - sin(2*eta)/9"), np.linspace(-pi / 2, pi / 2, 101)
    bound = steepest(law, reflection(law, enclosed(Rational(1, 2)), circle))
    largest = max(np.max(np.abs(-grid / 2 + c / 20 - np.sin(2 * grid) / 9)) for c in (-1, 1))

    assert largest <= bound < largest + 0.05
    assert not stays_below(Law("-eta"), 1, circle)


@pytest.mark.parametrize(("law", "said"), [("-lam*eta + theta/20", "to have period 2"), ("-eta", "below pi/2")])
def test_prove_refuses_a_law_that_its_theorem_does_not_know(law, said):
    with pytest.raises(ValueError, match=said):
        provable(Scene("ellipse", a="3/2", lam="1/2", law=law))


@pytest.mark.parametrize("radius", [0.018, 0.1])
def test_krawczyks_operator_moves_with_a_contraction_in_which_the_law_is_not_linear(radius):
    """The cycle moves four times as far as its derivative at the midpoint says: a narrow box does not contain it."""
    catalogue = near_the_axes("lam**8*cos(theta)/2 - eta/9")
    law, table, found = catalogue.law, catalogue.table, min(catalogue.cycles, key=lambda cycle: abs(cycle.theta[0]))
    near = Corrector(table, 0.7, law).closed((0, 0), np.array([found.theta]))[0]
    with working(64):
        wide = Problem(table, (0, 0), lam=arb("0.5", "0.2"), law=law)
        image = krawczyk(wide, [arb(x) for x in found.theta], [radius] * 2, 64)

    assert (image.status is ZeroStatus.UNIQUE) == (radius > 0.05)
    if image.status is ZeroStatus.UNIQUE:
        assert all(x.contains(arb(y)) for x, y in zip(image.zero, near, strict=True))


@pytest.mark.slow
def test_the_command_writes_every_cycle(tmp_path):
    file = tmp_path / "cycles.json"
    words = ["egg", "--alpha", "0.08", "--lam", "0.2", "--period", "4", "--count", "2", "--prove", "2"]
    result = CliRunner().invoke(cycles, [*words, "--json", str(file)], standalone_mode=False)
    document = json.loads(file.read_text())

    assert result.return_value == 0
    assert [row["cycles"] for row in document["periods"]] == [6, 0, 3]
    assert all(row["index_sums_vanish"] for row in document["periods"])
    assert [row["agrees"] for row in document["second_count"]] == [True]
    assert document["completeness"][0]["complete"] is True


def test_a_count_on_cells_is_refused_for_a_table_with_joins():
    result = CliRunner().invoke(
        cycles, ["cuspless", "--lam", "0.2", "--period", "2", "--count", "2"], standalone_mode=False
    )

    assert isinstance(result.exception, ValueError)
    assert "is not proved to be one smooth convex curve" in str(result.exception)


def test_families_of_cycles_are_said_to_be_there_and_not_listed():
    """Each diameter of the circle is a cycle with multiplier 1."""
    searched = all_cycles(circle, Rational(1, 2), 2)

    assert searched.catalogue.cycles == []
    assert searched.catalogue.degenerate > 100
    assert searched.balanced == {2: None}


@pytest.mark.parametrize(
    ("table", "components", "theta"),
    [
        (tables.sinai(), [1, 4], [0.5, 0.0]),  # a side and the disc within
        (tables.stadium(), [0, 2], [0.0, 0.0]),
        (tables.mushroom(), [0, 3], [pi / 2, 0.0]),
        (tables.diamond(), [0, 2], [3 * pi / 4, -pi / 4]),  # cusps
        (tables.polar("1 + 3*cos(theta)/5", "limacon"), [0, 0], [0.0, pi]),  # not convex
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_double_normal_is_proved_on_tables_with_holes_cusps_corners_and_dents(table, components, theta):
    found = certificate(table, Rational(1, 2), phase_points(theta, 0.0, components))

    checks = dict(found.checks)
    assert checks.pop("attracting") is None
    assert set(checks) >= {"exists", "unique", "admissible", "minimal_period"}
    assert all(value is True for value in checks.values())
    assert found.determinant.contains(0.25)  # det DT = lam at each of two bounces
