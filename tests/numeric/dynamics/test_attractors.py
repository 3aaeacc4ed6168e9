"""Laws of attractors: those of the paper's figures, and agreement with symmetry and with other modules."""

import json
from itertools import islice

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap, Status
from numeric.dynamics.attractors import UNSETTLED, Kind, classify, find, wilson
from numeric.dynamics.phase_points import PhasePoints, advanced, embedded, phase_points
from numeric.dynamics.symmetries import moved
from numeric.pinball.sampling import interior_starts
from symbolic import tables
from symbolic.tables import cardioid, cuspless, egg, ellipse
from symbolic.tables.geometry import group
from verification.app.cli import main
from verification.cycles.cascade import cascade
from verification.named.attractors import certificate

EGG = egg(3).at(alpha="0.08")


def an_egg(lam):
    return PinballMap("egg", alpha="0.08", lam=lam)


def kinds(found):
    return sorted((a.kind.name, a.period, a.symmetry) for a in found)


@pytest.mark.slow
def test_the_cuspless_table_has_a_cycle_of_period_2_and_a_chaotic_attractor_at_0_09():
    found = find(PinballMap("cuspless", lam="0.09"), 500, 1, images=True)

    assert kinds(found) == [("CHAOTIC", 0, "D1"), ("CYCLE", 2, "D1")]


@pytest.mark.slow
def test_three_localised_attractors_of_the_egg_merge_into_one():
    before, after = find(an_egg("0.43"), 500, 1, images=True), find(an_egg("0.45"), 500, 1, images=True)

    assert kinds(before) == [("CHAOTIC", 0, "D1")] * 3 + [("CYCLE", 3, "C3")] * 2
    assert kinds(after) == [("CHAOTIC", 0, "D3")] + [("CYCLE", 3, "C3")] * 2


@pytest.mark.slow
def test_period_3_runs_both_ways_round():
    cycles = [a for a in find(an_egg("0.7"), 300, 1, images=True) if a.period == 3]

    assert sorted(np.sign(a.points.phi).tolist() for a in cycles) == [[-1.0] * 3, [1.0] * 3]


def test_the_symmetric_cycles_of_period_4_have_given_way_to_twice_as_many():
    assert kinds(find(an_egg("0.28"), 200, 1, images=True)) == [("CYCLE", 4, "D1")] * 3
    assert kinds(find(an_egg("0.30"), 200, 1, images=True)) == [("CYCLE", 4, "C1")] * 6


@pytest.mark.slow
@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_the_period_doubles_at_each_member_of_the_cascade(n):
    lam = next(islice(cascade(Rational(2, 25)), n - 3, None)).lam
    gap = 2e-5 if n < 6 else 4e-6

    for side, period in ((-gap, 2 ** (n - 1)), (gap, 2**n)):
        found = classify(an_egg(lam + side), [0.05], [0.01], transient=100_000)
        assert [found.attractors[i].period for i in found.label] == [period]


def test_every_diameter_attracts_in_the_circle():
    label, found = classify(PinballMap("circle", lam="0.5"), [0.0, 1.0, 2.0], [0.5, -1.0, 0.1])

    assert label.tolist() == [0, 0, 0]
    assert [(a.kind, a.period) for a in found] == [(Kind.NEUTRAL, 2)]
    assert (found[0].nu_plus, found[0].nu_minus) == pytest.approx((0, np.log(0.5)))  # the sum rule: log(lam)


def test_the_share_of_both_ways_round_is_the_same_within_its_interval():
    one, other = find(an_egg("0.7"), 4000, 7, images=True)

    assert one.share.low < 0.5 < one.share.high
    assert one.share.count + other.share.count == 4000


@pytest.mark.slow
def test_labels_do_not_depend_on_the_company_of_a_particle():
    component, theta, phi = interior_starts(an_egg("0.66"), 300, 3)[:3]
    label, found = classify(an_egg("0.66"), theta, phi, component)
    alone, again = classify(an_egg("0.66"), theta[200:], phi[200:], component[200:], known=found)

    assert len(again) == len(found)
    assert alone.tolist() == label[200:].tolist()


def test_a_long_transient_is_no_attractor():
    found = find(an_egg("0.68"), 300, 1, images=True)

    assert kinds(found) == [("CYCLE", 3, "C3")] * 2
    assert sum(a.share.count for a in found) == 300


def test_what_has_not_settled_is_said_to_be_unsettled():
    starts = interior_starts(an_egg("0.666"), 2000, 1)
    label, _ = classify(an_egg("0.666"), starts.theta, starts.phi, starts.component, transient=100, rounds=3)

    assert UNSETTLED in label


def test_a_particle_that_stops_reaches_no_attractor():
    join = float(PinballMap("cuspless").states.ends[0][1])
    label, found = classify(PinballMap("cuspless", lam="0.5"), *_onto_the_join(join))

    assert [(found[i].kind, found[i].status) for i in label] == [(Kind.STOPPED, Status.JOIN)]


def _onto_the_join(join):
    """A particle at theta = 0 aimed at the upper join, `theta = 2 pi/3`."""
    x, y = np.cos(join) * (1 + np.cos(join)), np.sin(join) * (1 + np.cos(join))
    return [0.0], [-float(np.arctan2(y, 2 - x))]


@pytest.mark.parametrize(
    ("table", "lam", "shape"),
    [(ellipse.at(a=2), "0.3", {"a": 2}), (cardioid, "0.6", {}), (cuspless, "0.4", {}), (EGG, "0.8", {"alpha": "0.08"})],
    ids=lambda value: getattr(value, "name", None),
)
def test_symmetries_take_orbits_to_orbits(table, lam, shape):
    map = PinballMap(table.name, lam=lam, **shape)
    particles = PhasePoints(*interior_starts(map, 200, 5)[:3])

    for symmetry in group(table):
        left = moved(symmetry, advanced(map, particles, 1).points)
        right = advanced(map, moved(symmetry, particles), 1).points
        assert np.max(np.abs(embedded(map, left) - embedded(map, right))) < 1e-12


def test_a_certificate_proves_the_cycles_that_sampling_found():
    for attractor in find(an_egg("0.4"), 100, 1, images=True):
        proof = certificate(EGG, Rational(2, 5), attractor.points)
        trace = sum(attractor.multipliers).real
        assert proof.proved
        assert abs(float(proof.trace) - trace) < 1e-6


def test_a_certificate_does_not_prove_a_saddle_attracting():
    axis = certificate(ellipse.at(a=2), Rational(1, 2), phase_points([0.0, 3.14], 0.0))

    assert axis.checks["exists"] is True
    assert axis.checks["attracting"] is None


@pytest.mark.parametrize("count", [0, 1, 50, 99, 100])
def test_wilsons_interval_solves_its_own_equation(count):
    share = wilson(count, 100)

    for end in (share.low, share.high):
        if 0 < end < 1:
            assert abs(abs(count / 100 - end) - 1.96 * np.sqrt(end * (1 - end) / 100)) < 1e-12


def test_the_command_tells_programs_what_it_tells_people(capsys):
    code = main(["attractor", "egg", "--alpha", "0.08", "--lam", "0.7", "--orbits", "100", "--seed", "1", "--certify"])
    assert code == 0
    assert "period 3" in capsys.readouterr().out

    arguments = ["--orbits", "100", "--seed", "1", "--points", "3", "--certify", "--json", "-"]
    assert main(["attractor", "egg", "--alpha", "0.08", "--lam", "0.7", *arguments]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [(a["kind"], a["period"], len(a["points"])) for a in document["attractors"]] == [("cycle", 3, 3)] * 2
    assert all(all(a["checks"].values()) for a in document["attractors"])
    assert sum(a["starts"] for a in document["attractors"]) + document["unsettled"] == 100


def test_the_circle_is_neutral_for_the_command_too(capsys):
    assert main(["attractor", "circle", "--lam", "0.5", "--orbits", "20", "--seed", "1"]) == 0
    assert "neutral, period 2" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize(("lam", "symmetries"), [("0.381", ["C1"] * 6), ("0.3815", ["D1"] * 3)])
def test_mirror_images_join_at_their_crisis_and_not_before(lam, symmetries):
    """The crisis, a tangency enclosed in balls, is at 0.3810743: docs/crises.md."""
    found = [a for a in find(an_egg(lam), 1500, 1, images=True) if a.kind is Kind.CHAOTIC]

    assert [a.symmetry for a in found] == symmetries
    assert not any(a.doubt for a in found)


@pytest.mark.slow
@pytest.mark.parametrize("size", ["10**-10", "1", "10**10"])
def test_attractors_do_not_depend_on_the_unit_of_length(size):
    table = tables.parametric(f"3*cos(theta)*{size}/2", f"sin(theta)*{size}")
    found = find(PinballMap(table, lam="0.5"), 20, seed=1)
    assert [(a.kind, a.period) for a in found] == [(Kind.CYCLE, 2)]
    assert (found[0].nu_plus, found[0].nu_minus) == pytest.approx([np.log(0.5) / 2] * 2)


@pytest.mark.slow
def test_a_cycle_through_joins_is_found_where_they_are_smooth():
    quarters = [tables.arc(f"q{k}", "3*cos(theta)/2", "sin(theta)", f"{k}*pi/2", f"{k + 1}*pi/2") for k in range(4)]
    found = find(PinballMap(tables.piecewise(*quarters), lam="0.5"), 20, seed=1)
    assert [(a.kind, a.period) for a in found] == [(Kind.CYCLE, 2)]
    assert found[0].nu_plus == pytest.approx(np.log(0.5) / 2)
