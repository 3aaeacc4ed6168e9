"""What others published on polygons and on elastic tables: the proofs against the map, the judges against errors."""

from dataclasses import replace

import numpy as np
import pytest
from sympy import Rational, lambdify, pi, sympify

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import lam
from verification.paper.claims.claim import Verdict
from verification.paper.claims.folder import paper
from verification.paper.published import elastic, laws, polygons
from verification.paper.report.report import judge

SHIPPED = ("polygons", "elastic", "laws")
CLAIMS = {claim.id: claim for name in SHIPPED for claim in paper(name).claims}
PROVED = {
    "triangle.law": Verdict.CONFIRMED,
    "triangle.contraction": Verdict.CORRECTED,
    "triangle.expansion": Verdict.CONFIRMED,
    "triangle.cantor": Verdict.CONFIRMED,
    "triangle.nonaccessible": Verdict.CONFIRMED,
    "square.law": Verdict.CONFIRMED,
    "square.parabolic": Verdict.CONFIRMED,
    "square.integrable": Verdict.CONFIRMED,
    "slap.expanding": Verdict.CONFIRMED,
    "elastic.mean_free_path": Verdict.CONFIRMED,
    "law.non_hamiltonian": Verdict.CONFIRMED,
    "law.stability": Verdict.CONFIRMED,
    "law.rotation": Verdict.CONFIRMED,
}


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
    """Neither sentence holds on a range that reaches over it."""
    assert verdict(name, over=(("lam", range),)) in (Verdict.REFUTED, Verdict.OPEN)


@pytest.mark.parametrize(
    "name", ["triangle.expansion", "triangle.cantor", "triangle.nonaccessible", "square.parabolic", "square.integrable"]
)
def test_nothing_is_confirmed_of_another_map_of_angles(monkeypatch, name):
    monkeypatch.setattr(polygons, "next_exit_angle", lambda turn, angle: lam * (pi - turn - 2 * angle + pi / 50))

    assert verdict(name) is not Verdict.CONFIRMED


def scattered(value, count, bounces):
    """Random starts on every side of the triangle after so many bounces: the phase points that are reached."""
    rng = np.random.default_rng(3)
    map = PinballMap(tables.triangle(), lam=value)
    start = rng.random(count), rng.uniform(-np.pi / 2, np.pi / 2, count)
    found = map.orbit(*start, bounces, component=rng.integers(0, 3, count))
    going = found.code[-1] == 0
    return found.theta[-1][going], found.phi[-1][going], found.component[-1][going]


@pytest.mark.parametrize("value", ["0.4", "0.6", "0.9"])
def test_no_orbit_enters_the_region_that_is_proved_to_be_nonaccessible(value):
    """The share is that of the way from the common corner, which is the beginning of the next side."""
    contraction = float(value)
    place, angle, _ = scattered(value, 60_000, 2)
    before = np.pi / 3 - angle / contraction
    top = min(contraction * np.pi / 2, 2 * np.pi / 3 - contraction * np.pi / 2)
    theirs = (before > np.pi / 6) & (before < top)
    height = np.cos(before) / np.cos(np.pi / 3 - before)

    assert np.sum(theirs & (place < height)) > 100  # so that angles like these are reached,
    assert np.sum(theirs & (place > height + 1e-12)) == 0  # and never above


def test_below_a_third_an_orbit_ends_on_the_cantor_set_of_angles():
    """After n bounces the angle is in an image of the largest interval under n of the two maps."""
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
    """Directions at random from every point of the boundary, against 2*pi*|Q|/(2*|boundary|)."""
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


@pytest.mark.parametrize(
    ("name", "room", "attribute", "wrong"),
    [
        ("triangle.three_components", polygons, "components", (np.zeros(4, int), [5, 5])),
        ("square.coexistence", polygons, "ends_in_the_square", (0.0, np.inf, -np.inf)),
        ("sinai.small_disc", elastic, "from_disc_to_disc", (1.5, 0.01)),
    ],
)
def test_what_sampling_contradicts_is_left_open(monkeypatch, name, room, attribute, wrong):
    monkeypatch.setattr(room, attribute, lambda *_: wrong)

    assert verdict(name) is Verdict.OPEN


def test_the_two_published_constants_of_small_discs_are_told_apart(monkeypatch):
    """Where sampling meets the one, the other is not supported, and the other way round."""
    for value, first, second in ((-0.13, Verdict.SUPPORTED, Verdict.OPEN), (1.5648, Verdict.OPEN, Verdict.SUPPORTED)):
        monkeypatch.setattr(elastic, "from_disc_to_disc", lambda _, value=value: (value, 0.01))
        assert (verdict("sinai.small_disc"), verdict("sinai.constant")) == (first, second)


def test_sampled_sentences_are_supported():
    assert {verdict(name) for name in ("square.coexistence", "stadium.elliptical")} == {Verdict.SUPPORTED}


@pytest.mark.parametrize("angle", ["pi/6", "1"])
def test_in_the_circle_the_line_of_a_law_with_a_fixed_angle_attracts_and_is_turned(angle):
    """What `law.rotation` derives, against the map's own orbits: exact angles, the same turn at every bounce."""
    p = float(sympify(angle))
    map = PinballMap("circle", lam="1/2", law=f"({angle})/2 - eta/2")
    orbit = map.orbit(np.linspace(-3, 3, 9), np.linspace(-1.5, 1.5, 9), 80)
    turns = np.remainder(np.diff(orbit.theta[-20:], axis=0) - (np.pi - 2 * p) + 1, 2 * np.pi) - 1

    assert np.max(np.abs(orbit.phi[-20:] - p)) < 1e-14
    assert np.max(np.abs(turns)) < 1e-13


@pytest.mark.parametrize(
    ("name", "attribute", "wrong"),
    [
        ("law.non_hamiltonian", "area_factor", lambda phi: -phi.diff(laws.eta)),
        ("law.stability", "double_normal", lambda sigma: laws.Matrix([[3, 0], [0, sigma**2]])),
        ("law.rotation", "IRRATIONAL", Rational(2)),
        ("law.rotation", "RATIONAL", pi / 5),
        ("law.rotation", "landing", lambda formula: (laws.zero("", laws.phi), formula)),
    ],
)
def test_no_sentence_on_laws_is_confirmed_of_another_derivation(monkeypatch, name, attribute, wrong):
    monkeypatch.setattr(laws, attribute, wrong)

    assert verdict(name) is not Verdict.CONFIRMED
