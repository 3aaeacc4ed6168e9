"""Two basins next to one stable manifold, and the discs that a contraction takes into themselves."""

from dataclasses import replace
from fractions import Fraction
from math import pi, tau
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.paper.egg.basins import MIDDLE, beyond_the_crisis
from verification.proofs.global_dynamics import common_boundary
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.common_boundary import CHECKS, Disc, attracts, disc, entered_around
from verification.proofs.global_dynamics.flights import Slopes
from verification.proofs.manifolds.saddle import Orbit

FOUND = beyond_the_crisis()


def test_the_stable_manifold_of_the_triangle_bounds_both_basins_beyond_the_crisis():
    assert FOUND.proved
    assert all(entered_around(FOUND, k, *point) for k, point in enumerate(MIDDLE))


def failing(**changes):
    """The checks that are not proved of a changed statement."""
    return {name for name, held in replace(FOUND, **changes).checks.items() if held is not True}


def test_the_orbits_go_to_the_one_triangle_and_not_to_the_other():
    assert failing(sinks=FOUND.sinks[::-1], turn=FOUND.turn[::-1]) == {"first", "second"}
    assert failing(starts=FOUND.starts[::-1]) == {"first", "second"}
    assert not any(entered_around(FOUND, 1 - k, *point) for k, point in enumerate(MIDDLE))


def test_one_cycle_twice_is_no_pair_of_cycles():
    twice = {"sinks": (FOUND.sinks[0],) * 2, "turn": (FOUND.turn[0],) * 2}
    assert failing(**twice, starts=(0.9, 0.9)) == {"apart"}


@pytest.mark.parametrize(
    "change",
    [
        {"radius": 0.04},  # the derivative is no contraction over so wide a disc
        {"radius": 1e-9},  # the centre is no closer to the cycle than that
        {"turn": (Fraction(2, 3), Fraction(1, 3))},  # each triangle goes the other way round
    ],
)
def test_a_disc_that_is_not_taken_into_itself_proves_nothing(change):
    assert "discs" in failing(**change)


def test_below_the_crisis_the_branch_goes_to_no_triangle():
    below = Orbit("triangle of the vertices", (-0.207952,), FOUND.saddle.closure)
    sink = 1.22591248, 0.39269908
    changed = replace(FOUND, lam=Fraction(3, 5), saddle=below, sinks=(sink, (-sink[0], -sink[1])))
    assert {name for name, held in changed.checks.items() if held is not True} == {"first", "second"}


def test_points_of_a_disc_approach_one_another():
    (one, _), map = FOUND.discs, PinballMap("egg", lam=0.7, alpha="0.08")
    angle = np.linspace(-pi, pi, 50, endpoint=False)
    edge = np.array(one.inverse) @ (one.radius * np.stack([np.cos(angle), np.sin(angle)]))
    next = map.step(one.centre[0] + edge[0], one.centre[1] + edge[1])
    back = np.remainder(next.theta - one.centre[0] - tau / 3 + pi, tau) - pi
    inside = np.linalg.solve(np.array(one.inverse), np.stack([back, next.phi - one.centre[1]]))
    assert np.all(np.hypot(*inside) < one.radius)


def test_a_saddle_is_no_disc():
    assert not attracts(FOUND.map, disc(FOUND.map, (-0.14235898, 0.43119899), 1e-3), tau / 3)


def test_every_check_may_fail_and_nothing_is_refuted():
    assert set(FOUND.checks) == set(CHECKS)
    with pytest.raises(ValueError, match="accepted: one smooth closed curve"):
        replace(FOUND, scene=Scene("cuspless"))
    with pytest.raises(ValueError, match="no symmetry of the table"):
        replace(FOUND, turn=(Fraction(1, 4), Fraction(2, 3)))
    with pytest.raises(ValueError, match="lam is in"):
        replace(FOUND, lam=Fraction(1))


def stub(matrix, image, lost=False):
    """A map with one derivative everywhere, `[[a, b], [c, d]]`, and the image of the centre within a radius."""
    (a, b, c, d), count = map(float, np.ravel(matrix)), common_boundary.CUT**2
    each = lambda x: BallArray(np.full(count, x))  # noqa: E731
    slopes = Slopes(each(a), each(b), each(-c / d), each(0.0), each(-d), each(0.0))
    boxes = Boxes(np.zeros(1, dtype=int), *(tuple(np.array([x + side * 1e-9]) for side in (-1, 1)) for x in image))
    found = SimpleNamespace(lost=np.zeros(int(lost)), boxes=boxes)
    piece = SimpleNamespace(on=np.arange(count))
    return SimpleNamespace(derivatives=lambda _: ((piece, slopes),), images=lambda _: found)


def test_a_disc_is_taken_into_itself_exactly_where_norm_and_offset_leave_room():
    """Of matrices in frames of all shapes, by singular values; up to whole turns of the angle."""
    rng, seen = np.random.default_rng(4), []
    for _ in range(400):
        inverse, centre, radius = rng.uniform(-1, 1, (2, 2)), rng.uniform(-1, 1, 2), rng.uniform(0.05, 1)
        if abs(np.linalg.det(inverse)) < 0.2:
            continue
        m = rng.uniform(-0.6, 0.6, (2, 2))
        norm = np.linalg.svd(np.linalg.solve(inverse, m @ inverse))[1][0]
        off = rng.uniform(-0.1, 0.1, 2) * radius
        spare = radius - norm * radius - np.hypot(*np.linalg.solve(inverse, off))
        turn, whole = rng.uniform(-2, 2), 2 * pi * rng.integers(-2, 3)
        one = Disc(tuple(centre), tuple(map(tuple, inverse)), radius)
        some = stub(m, (centre[0] + turn + whole + off[0], centre[1] + off[1]))
        if abs(spare) > 1e-6 and abs(norm - 1) > 1e-6:
            assert attracts(some, one, turn) is bool(spare > 0)
            seen.append(spare > 0)
            assert not attracts(some, one, turn + 1.0 * np.linalg.norm(inverse) * radius + 0.5)
    assert min(sum(seen), len(seen) - sum(seen)) > 10


def test_an_orbit_enters_a_disc_when_a_landing_is_proved_to_lie_in_it_or_a_copy(monkeypatch):
    """Of three landings the second is near a copy turned by thirds: within the disc, or hardly beyond."""
    rng, seen, landings = np.random.default_rng(5), [], []
    whole = SimpleNamespace(start=lambda *_: None, orbit=lambda *_: iter(landings))
    monkeypatch.setattr(common_boundary, "EnclosedMap", lambda *_: whole)
    monkeypatch.setattr(common_boundary, "PinballMap", lambda *_, lam: None)
    for _ in range(200):
        inverse, centre, radius = rng.uniform(-1, 1, (2, 2)), rng.uniform(-1, 1, 2), rng.uniform(0.1, 0.5)
        part, u = int(rng.integers(0, 3)), rng.uniform(-1, 1, 2) * radius
        if abs(np.linalg.det(inverse)) < 0.3 or abs(np.hypot(*u) / radius - 1) < 1e-6:
            continue
        at = centre + inverse @ u + np.array([tau * (part / 3 + rng.integers(-1, 2)), 0])
        one, away = Disc(tuple(centre), tuple(map(tuple, inverse)), radius), SimpleNamespace(theta=arb(0), phi=arb(40))
        landings[:] = [away, SimpleNamespace(theta=arb(at[0]), phi=arb(at[1])), away]
        for turns in ((0, 1, 2), (part,), ((part + 1) % 3,)):
            copies = [np.hypot(*np.linalg.solve(inverse, off(at, centre, k))) < radius for k in turns]
            parts = tuple(Fraction(k, 3) for k in turns)
            assert common_boundary.enters(FOUND.scene, FOUND.lam, (arb(0), arb(0)), one, parts) is any(copies)
            seen.append(any(copies))
        landings[1].phi = arb(at[1], 10)
        assert not common_boundary.enters(FOUND.scene, FOUND.lam, (arb(0), arb(0)), one, (Fraction(part, 3),))
    assert min(sum(seen), len(seen) - sum(seen)) > 30


@pytest.mark.parametrize(
    ("theta", "phi", "held"), [(0.5, 0, False), (0.4375, 0, True), (0, -0.5, False), (0, 0.25, True)]
)
def test_the_edge_itself_of_a_disc_is_no_part_of_it(monkeypatch, theta, phi, held):
    whole = SimpleNamespace(
        start=lambda *_: None, orbit=lambda *_: iter([SimpleNamespace(theta=arb(theta), phi=arb(phi))])
    )
    monkeypatch.setattr(common_boundary, "EnclosedMap", lambda *_: whole)
    monkeypatch.setattr(common_boundary, "PinballMap", lambda *_, lam: None)
    one = Disc((0.0, 0.0), ((1.0, 0.0), (0.0, 1.0)), 0.5)
    assert common_boundary.enters(FOUND.scene, FOUND.lam, (arb(0), arb(0)), one, (Fraction(0),)) is held


def test_a_disc_without_a_point_is_taken_nowhere():
    """Of a radius below 0 the image would be smaller whatever the norm."""
    unit = ((1.0, 0.0), (0.0, 1.0))
    assert not attracts(stub([[1.5, 0], [0, 1.5]], (0.0, 0.0)), Disc((0.0, 0.0), unit, -1.0), 0.0)
    assert attracts(stub([[0.5, 0], [0, 0.5]], (0.0, 0.0)), Disc((0.0, 0.0), unit, 1.0), 0.0)


def off(at, centre, part):
    """From the middle of a copy turned by thirds, up to whole turns."""
    theta = at[0] - centre[0] - tau * part / 3
    return np.array([theta - tau * np.rint(theta / tau), at[1] - centre[1]])
