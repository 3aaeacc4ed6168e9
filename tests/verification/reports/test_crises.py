"""The tangencies of a report: found near changes of its diagram, and then proved."""

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import arb

from symbolic import Scene
from verification.arithmetic.balls import working
from verification.cycles.newton import refined
from verification.maps.first_hit import convex, unobstructed
from verification.named.questions import PeriodicOrbit
from verification.named.tangencies import round_of
from verification.proofs.manifolds.certificate import contact_said
from verification.proofs.manifolds.grow import touches
from verification.proofs.manifolds.known import shadow
from verification.proofs.manifolds.plane_map import pinball
from verification.proofs.manifolds.proof import ManifoldsTouch
from verification.reports.asked import Asked, Parts
from verification.reports.blocks import Known, Paragraph, ShownNumber
from verification.reports.crises import crises, proved, told
from verification.reports.parted import NONE, least_angle

ROOT = Path(__file__).parents[3]


def tangencies(tmp_path, text, lost, **more):
    """The report's blocks on tangencies before and after proofs, from a diagram that loses chaos between `lost`."""
    asked, counts = Asked(Scene.parse(text), at=("1/2",), **more), np.ones((240, 7), int)
    counts[50:, 3:] = 0  # the chaotic attractor is gone from the fourth contraction on
    parts = Parts(tmp_path, asked.digest)
    parts.made(asked)
    parts.keep("diagram-0", {"values": np.linspace(*lost, 7), "counts": counts, "chaotic": np.ones(7)})
    _, _, data = crises(asked, parts)
    made = {"crises": {"data": data}}
    before = told(asked, made)
    for i, said in enumerate(data["touches"]):
        made[f"tangency-{i}"] = {"data": json.loads(json.dumps(proved(asked, said, i)[2]))}
    return before, told(asked, made)


@pytest.mark.slow
def test_the_boundary_crisis_of_the_egg_is_found_and_proved_by_a_report_that_knows_no_name_of_it(tmp_path):
    """The table is a radius with an invented diagram; the named crisis has its certificate from other methods."""
    egg = 'scene = { polar = "1 + 2*cos(3*theta)/25", lam = "1/2" }'
    certificate = json.loads((ROOT / "certificates" / "boundary-crisis.json").read_text())
    mantissa, exponent = map(int, certificate["centre"][-1])
    exact = mantissa * Fraction(2) ** exponent

    for told_of, known in zip(tangencies(tmp_path, egg, (0.64, 0.69)), (Known.FLOAT, Known.PROVED), strict=True):
        (table, *files), (found,) = told_of.blocks, told_of.events
        assert [file.document["checks"] for file in files] == [
            dict.fromkeys(ManifoldsTouch.hypotheses(), True)
        ] * found["certified"]
        assert [file.name for file in files] == ["tangency-0"] * found["certified"]
        assert (found["kind"], found["period"]) == ("homoclinic_tangency", 3)
        assert found["certified"] is (known is Known.PROVED)
        assert abs(Fraction(found["value"]) - exact) <= Fraction(found["radius"])
        assert table.rows[0][0].known is known
        assert all(cell.error for row in table.rows for cell in row if isinstance(cell, ShownNumber))
    assert Fraction(found["radius"]) < Fraction(1, 10**20)


@pytest.mark.slow
def test_a_tangency_of_a_table_that_is_not_convex_is_proved_with_every_flight_on_the_way():
    """In the limacon; folds of long cycles, from other equations, approach it at the rate of the multiplier."""
    scene = Scene.of({"polar": "1 + 3*cos(theta)/5", "lam": "1/2"})
    bounces = (-2.3414388, -0.1354213, 2.3414388, 0.1354213)
    orbit = round_of(PeriodicOrbit(scene, (0,) * 4, bounces, (0.0,) * 4, (2j, 0j)), 1, True)
    map = pinball(scene.table, scene.law)
    touch = next(t for t in touches(orbit, map, 0.4336, 8, 4, True) if abs(t.parameter - 0.433637) < 1e-5)
    contact = replace(touch.contact, parameter=float(touch.parameter))
    said = {"contact": json.loads(json.dumps(contact_said(contact)))}
    _, _, proof = proved(Asked(scene), said, 0)
    cycles = [shadow(contact, map, contact.parameter, rounds) for rounds in (24, 32)]
    folds = [refined(cycle.problem, cycle.start, 15).z[-1] for cycle in cycles]
    first, second = (float(Fraction(str(fold)) - Fraction(proof["value"])) for fold in folds)

    assert convex(scene.table) is None
    assert len(orbit.start) == 2  # of four bounces the last two are mirror images
    assert orbit.closure.turn == -1
    assert proof["items"] == 7
    assert abs(first) < 1e-6
    assert first / second == pytest.approx(float(proof["multipliers"][0][0]) ** 8, rel=0.05)


def test_a_flight_that_the_boundary_cuts_is_no_proof():
    """The limacon's tangency with a bounce at the dent of the boundary, so that the chord leaves the table."""
    limacon = Scene.of({"polar": "1 + 3*cos(theta)/5", "lam": "1/2"}).table
    with working(96):
        straight, cut = ([(0, arb(at)) for at in places] for places in ((0.0, 2.0), (2.6, 3.6)))
        assert unobstructed(limacon, straight)
        assert not unobstructed(limacon, cut)


@pytest.mark.slow
def test_tangencies_are_proved_under_another_law(tmp_path):
    """The law of tests/verification/proofs/test_manifolds_proof.py, under which the shadowing cycles fold as well."""
    bent = 'scene = { polar = "1 + 2*cos(3*theta)/25", lam = "1/2", law = "-lam*eta*(1 - eta**2/40)" }'
    _, after = tangencies(tmp_path, bent, (0.645, 0.69))

    (found,) = (event for event in after.events if event["value"].startswith("0.66481"))
    assert found["certified"]


def parted(tmp_path, name, values, lost):
    """The report's block on a table in pieces, whose invented diagram loses chaos after some of its columns."""
    asked, counts = Asked(Scene(name)), np.ones((240, 7), int)
    for j in lost:
        counts[50:, j:] = 0
    parts = Parts(tmp_path, asked.digest)
    parts.made(asked)
    parts.keep("diagram-0", {"values": np.linspace(*values, 7), "counts": counts, "chaotic": np.ones(7)})
    (block,), _, data = crises(asked, parts)
    assert told(asked, {"crises": {"data": data}}).events == []  # nothing is claimed to touch
    return block, data["parted"]


def test_where_no_attractor_changes_the_report_says_that_there_is_no_tangency_to_seek(tmp_path):
    assert parted(tmp_path, "cardioid", (0.3, 0.4), ()) == (Paragraph(NONE), [])


@pytest.mark.slow
def test_the_attractor_of_the_cuspless_table_changes_far_from_a_tangency(tmp_path):
    """Near lambda-c (paper, section 5.2). From 1/10 on a cone of directions is proved to stay apart from the other."""
    block, ((row),) = parted(tmp_path, "cuspless", (0.10, 0.13), (3,))

    angle, error, points = row["angle"]
    assert angle > 0.2 > error
    assert points > 10_000
    assert block.rows[0][2].known is Known.SAMPLED


@pytest.mark.slow
def test_an_angle_near_a_tangency_is_small():
    """The egg just below its boundary crisis, 0.66214: manifolds of the triangle and of nearby cycles touch."""
    angle, _, _ = least_angle(Asked(Scene("egg", alpha="2/25")), 0.66)
    assert angle < 0.01
