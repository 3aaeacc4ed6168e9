"""Outer images contain the images of points, computed in balls of many bits; unproved images are marked lost."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.proofs.global_dynamics.images import PinballImages
from verification.rigorous.boxes import Boxes

FLOWER = Scene.of({"polar": "1 + cos(5*theta)/10", "lam": "3/5"})
LIMACON = Scene.of({"parametric": ["(3+cos(theta))*cos(theta)", "(3+cos(theta))*sin(theta)"], "lam": "2/5"})
SCENES = [
    Scene("egg", alpha="0.08", lam="1/2"),
    Scene("cuspless", lam="0.09"),
    Scene("cuspless", lam="0.9"),
    Scene("ellipse", a="3/2", lam="0.99"),
    Scene("circle", lam="0.7"),
    LIMACON,
    Scene("egg", alpha="0.08", lam="1/2", law="-lam*sin(eta) - b*atan(eta)", b="1/4"),
    Scene("egg", alpha="0.08", lam="1/2", law="-lam*eta*(1 + cos(3*theta)/4) + sin(theta)/8"),
    Scene("cuspless", lam="1/2", law="-lam*eta*(1 + theta/5) - theta/10"),  # on wall and arc another theta
]
PLACED = SCENES[-2:]
EXPONENTIAL = Scene.of({"polar": "exp(cos(2*theta)/40)", "lam": "1/2"})
SIZED = [(scene, size) for scene in SCENES[:6] for size in (1e-3, 0.05, 0.4)]
SIZED += [(SCENES[6], 0.05), *((scene, 1e-3) for scene in PLACED)]


def boxes(map: PinballImages, count: int, size: float, seed: int) -> Boxes:
    """Random boxes, a quarter of them at each end of their chart."""
    rng = np.random.default_rng(seed)
    chart = rng.integers(0, len(map.charts), count)
    low, high = (np.array([c.x[i] for c in map.charts])[chart] for i in (0, 1))
    w, h = size * rng.random(count), size * map.top * rng.random(count)
    x, y = low + (high - low - w) * rng.random(count), -map.top + (2 * map.top - h) * rng.random(count)
    x[: count // 4], x[count // 4 : count // 2] = low[: count // 4], (high - w)[count // 4 : count // 2]
    y[: count // 8] = -map.top
    return Boxes(chart, (x, x + w), (y, y + h))


def holds(images, index: int, chart: int, theta: arb, phi: arb) -> bool:
    """Whether some rectangle of a box's image may contain a point given as balls, up to whole turns, or is lost."""
    if index in images.lost:
        return True
    for at in np.flatnonzero((images.source == index) & (images.boxes.chart == chart)):
        (a, b), (c, d) = ((float(low[at]), float(high[at])) for low, high in (images.boxes.x, images.boxes.y))
        for turn in (-1, 0, 1):
            x = theta + 2 * turn * arb.pi()
            if not (x < a or x > b or phi < c or phi > d):
                return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "size"), [*SIZED, (EXPONENTIAL, 0.05)])
def test_images_hold_the_landings_that_balls_prove(scene, size):
    map = PinballImages(scene)
    chosen = boxes(map, 24, size, 3)
    images, judge = map.images(chosen), EnclosedMap(map.map, map.range[0], 120)
    rng, judged = np.random.default_rng(4), 0
    for index in range(24):
        for share in ((0, 0), (1, 1), (0, 1), rng.random(2)):
            chart = map.charts[int(chosen.chart[index])]
            x, y = (
                low[index] + (high[index] - low[index]) * s for (low, high), s in zip(chosen[1:], share, strict=True)
            )
            x = float(np.clip(x, *(c + s * 1e-12 for c, s in zip(chart.x, (1, -1), strict=True))))
            landed = judge.bounce(judge.start(Fraction(x), Fraction(float(y)), int(chosen.chart[index])))
            if isinstance(landed, Refusal) or landed.code:
                continue
            judged += 1
            assert holds(images, index, landed.component, landed.theta, landed.phi)

    assert judged > 60


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: f"{scene.name} {scene.lam}")
def test_small_boxes_are_not_lost_and_their_images_are_small(scene):
    map = PinballImages(scene)
    images = map.images(boxes(map, 400, 1e-3, 5))

    assert images.lost.size == 0
    assert np.median(images.boxes.x[1] - images.boxes.x[0]) < 0.02


def test_images_for_a_range_of_contractions_hold_those_of_each():
    scene, ends = Scene("egg", alpha="0.05", lam="1/2"), (Fraction(2, 5), Fraction(1, 2))
    wide = PinballImages(scene, ends)
    chosen = boxes(wide, 200, 0.02, 6)
    images = wide.images(chosen)
    order = np.argsort(images.source)
    middle = [(low + high) / 2 for low, high in chosen[1:]]
    for lam in (0.4, 0.43, 0.5):
        landed = PinballMap("egg", lam=lam, alpha="0.05").step(*middle)
        low, high = (end[order] for end in images.boxes.y)

        assert np.all((low - 1e-12 <= landed.phi) & (landed.phi <= high + 1e-12))


def test_a_table_that_is_not_proved_convex_is_refused():
    with pytest.raises(ValueError, match="not proved convex"):
        PinballImages(Scene("cardioid", lam="1/2"))
    with pytest.raises(ValueError, match="not proved convex"):
        PinballImages(FLOWER)


@pytest.mark.parametrize(
    "lam", [(Fraction(0), Fraction(0)), (Fraction(1, 2), Fraction(1)), (Fraction(1, 2), Fraction(1, 4))]
)
def test_contractions_outside_the_range_are_refused(lam):
    with pytest.raises(ValueError, match="accepted: 0 <= LOW <= HIGH"):
        PinballImages(Scene("egg", alpha="0.08", lam="1/2"), tuple(map(Fraction, lam)))


def test_a_law_that_boxes_cannot_hold_is_refused_with_why():
    for law, says in (("-lam*eta - theta/10", "the period 2"), ("-eta", "by a margin, as boxes need it")):
        with pytest.raises(ValueError, match=says):
            PinballImages(Scene("egg", alpha="0.08", lam="1/2", law=law))


@pytest.mark.parametrize("scene", PLACED, ids=lambda scene: scene.name)
def test_the_derivative_under_a_law_of_the_place_is_enclosed(scene):
    map = PinballImages(scene)
    chart, x, y = boxes(map, 120, 1e-4, 7)
    chosen = Boxes(chart[60:], *((low[60:], high[60:]) for low, high in (x, y)))  # the others are at ends
    middles = [(low + high) / 2 for low, high in (chosen.x, chosen.y)]
    judged, step = 0, 1e-6
    around = [
        [map.map.step(middles[0] + i * (axis == 0), middles[1] + i * (axis == 1), chosen.chart) for i in (-step, step)]
        for axis in (0, 1)
    ]
    for piece, s in map.derivatives(chosen):
        rows = (
            (s.by_theta, s.drift * s.by_theta - s.law * (s.bend_there * s.by_theta - s.bend_here)),
            (s.by_phi, s.drift * s.by_phi - s.law * (s.bend_there * s.by_phi + 1)),
        )
        for (low, high), row in zip(around, rows, strict=True):
            same = (low.component == high.component)[piece.on] & (low.component[piece.on] == piece.chart)
            for ball, name in zip(row, ("theta", "phi"), strict=True):
                found = (getattr(high, name) - getattr(low, name))[piece.on] / (2 * step)
                good = same & np.isfinite(ball.r) & (ball.r < 0.1) & (np.abs(found) < 1e3)
                judged += int(np.sum(good))
                assert np.all(np.abs(found - ball.m)[good] <= (ball.r + 1e-5 * (1 + np.abs(found)))[good])

    assert judged > 100


@pytest.mark.parametrize(
    ("law", "most"),
    [
        ("-lam*sin(2*eta)", 0.5),
        ("-lam*sin(2*eta)*(1 + cos(3*theta)/2)", 0.75),
        ("-lam*(eta + eta**2)/3", 0.6730),
        ("-lam*(eta - eta**2)/3", 0.6730),
    ],
)
def test_the_strip_of_a_law_holds_its_exit_angles(law, most):
    """The largest angle is attained at incidence pi/8, at one place of the boundary, or at one end of the incidence."""
    map = PinballImages(Scene("egg", alpha="0.08", lam="1/2", law=law))
    eta, theta = (list(pieces) for pieces in zip(*map.incidences(), strict=True))

    assert most <= map.top < most + 0.02
    for pieces, end in ((eta[0], np.pi / 2), *([(theta, np.pi)] if map.placed else [])):
        low, high = (np.ravel([getattr(x, side)() for x in np.atleast_1d(pieces)]) for side in ("lower", "upper"))
        assert low[0] <= -end
        assert high[-1] >= end
        assert np.all(low[1:] <= high[:-1])
