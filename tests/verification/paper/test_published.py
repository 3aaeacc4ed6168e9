"""Published results on polygons and elastic tables: proofs against the map, judges against altered claims."""

from dataclasses import replace

import numpy as np
import pytest
from sympy import Rational, lambdify, sympify

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import lam
from verification.paper.claims.claim import Verdict
from verification.paper.claims.folder import paper
from verification.paper.published import polygons
from verification.paper.report.report import judge

SHIPPED = ("polygons", "elastic", "laws")
CLAIMS = {claim.id: claim for name in SHIPPED for claim in paper(name).claims}
CONFIRMED = (
    "triangle.law", "triangle.expansion", "triangle.cantor", "triangle.nonaccessible", "square.law", "square.parabolic",
    "square.integrable", "slap.expanding", "elastic.mean_free_path", "law.non_hamiltonian", "law.stability",
    "law.rotation",
)  # fmt: skip
PROVED = dict.fromkeys(CONFIRMED, Verdict.CONFIRMED) | {"triangle.contraction": Verdict.CORRECTED}


def verdict(name, **changes):
    return judge(replace(CLAIMS[name], **changes)).verdict


@pytest.mark.parametrize("name", PROVED)
def test_what_is_proved_is_told_as_proved(name):
    assert verdict(name) is PROVED[name]


def test_every_section_names_its_source():
    for name in SHIPPED:
        about = paper(name)
        assert all(about.sections.values())
        assert {claim.section for claim in about.claims} <= set(about.sections)


def test_a_law_that_is_printed_wrongly_is_refuted():
    assert verdict("triangle.law", printed="-2*lam*eta") is Verdict.REFUTED


@pytest.mark.parametrize("name", ["triangle.cantor", "triangle.nonaccessible"])
@pytest.mark.parametrize("range", ["(0, 2/5)", "(3/10, 1)"])
def test_a_third_is_where_the_triangle_changes(name, range):
    """No statement holds on a range that contains 1/3 in its interior."""
    assert verdict(name, over=(("lam", range),)) in (Verdict.REFUTED, Verdict.OPEN)


def scattered(value, count, bounces):
    """`(theta, phi, component)` after so many bounces of random starts on all sides of the triangle."""
    rng = np.random.default_rng(3)
    map = PinballMap(tables.triangle(), lam=value)
    start = rng.random(count), rng.uniform(-np.pi / 2, np.pi / 2, count)
    found = map.orbit(*start, bounces, component=rng.integers(0, 3, count))
    going = found.code[-1] == 0
    return found.theta[-1][going], found.phi[-1][going], found.component[-1][going]


@pytest.mark.parametrize("value", ["0.4", "0.6", "0.9"])
def test_no_orbit_enters_the_region_that_is_proved_to_be_nonaccessible(value):
    """The share is measured along a side from the common corner, where the next side begins."""
    contraction = float(value)
    place, angle, _ = scattered(value, 60_000, 2)
    before = np.pi / 3 - angle / contraction
    top = min(contraction * np.pi / 2, 2 * np.pi / 3 - contraction * np.pi / 2)
    theirs = (before > np.pi / 6) & (before < top)
    height = np.cos(before) / np.cos(np.pi / 3 - before)

    assert np.sum(theirs & (place < height)) > 100  # so that angles like these are reached,
    assert np.sum(theirs & (place > height + 1e-12)) == 0  # and never above


def test_below_a_third_an_orbit_ends_on_the_cantor_set_of_angles():
    """After n bounces the angle lies in an image of the largest interval under n of the two affine maps."""
    contraction, n = 0.3, 6
    half = float(polygons.hull().subs(lam, Rational(3, 10)))
    maps = [lambdify("phi", polygons.next_exit_angle(turn, polygons.phi).subs(lam, Rational(3, 10)))
            for turn in (polygons.RIGHT, polygons.LEFT)]  # fmt: skip
    centres = np.array([0.0])
    for _ in range(n):
        centres = np.concatenate([step(centres) for step in maps])
    place, angle, _ = scattered("0.3", 3000, 40)
    distance = np.min(np.abs(angle[:, None] - centres), axis=1)

    assert len(angle) > 2900
    assert np.max(distance) < contraction**n * half * (1 + 1e-9)
    assert len(set(np.argmin(np.abs(angle[:, None] - centres), axis=1))) > 2**n * 0.8  # nearly each is met
    assert np.ptp(place) > 0.99


def test_two_bounces_of_the_triangle_stretch_as_much_as_is_proved():
    value = 0.95
    place, angle, side = scattered("0.95", 20_000, 1)
    map = PinballMap(tables.triangle(), lam="0.95")
    orbit = map.orbit(place, angle, 2, component=side)
    eta = np.abs(orbit.phi[1:]) / value
    stretch = np.prod(np.cos(value * eta) / np.cos(eta), axis=0)

    assert np.min(stretch) >= np.cos(value * np.pi / 6) / np.cos(np.pi / 6) - 1e-12


def test_the_mean_free_path_of_a_table_with_a_hole_is_the_formula():
    """Random directions from all boundary points, against 2*pi*|Q|/(2*|boundary|)."""
    radius = 0.25
    rng = np.random.default_rng(5)
    count, length = 40_000, 4 + 2 * np.pi * radius
    s = rng.uniform(0, length, count)
    side = np.minimum(s.astype(int), 4)
    place = np.where(side < 4, s - side, (s - 4) / radius - np.pi)
    angle = np.arcsin(rng.uniform(-1, 1, count))
    map = PinballMap(tables.sinai("1/4"), lam=1)
    orbit = map.orbit(place, angle, 1, component=side)
    flight = np.hypot(np.diff(orbit.x, axis=0), np.diff(orbit.y, axis=0))[0]
    going = orbit.code[-1] == 0

    mean, error = np.mean(flight[going]), np.std(flight) / np.sqrt(count)
    assert abs(mean - np.pi * (1 - np.pi * radius**2) / length) < 4 * error


def test_sampled_sentences_are_supported():
    assert {verdict(name) for name in ("square.coexistence", "stadium.elliptical")} == {Verdict.SUPPORTED}


@pytest.mark.parametrize("angle", ["pi/6", "1"])
def test_in_the_circle_the_line_of_a_law_with_a_fixed_angle_attracts_and_is_turned(angle):
    """The results of `law.rotation`, against orbits of the map: exact angles, the same turn at every bounce."""
    p = float(sympify(angle))
    map = PinballMap("circle", lam="1/2", law=f"({angle})/2 - eta/2")
    orbit = map.orbit(np.linspace(-3, 3, 9), np.linspace(-1.5, 1.5, 9), 80)
    turns = np.remainder(np.diff(orbit.theta[-20:], axis=0) - (np.pi - 2 * p) + 1, 2 * np.pi) - 1

    assert np.max(np.abs(orbit.phi[-20:] - p)) < 1e-14
    assert np.max(np.abs(turns)) < 1e-13
