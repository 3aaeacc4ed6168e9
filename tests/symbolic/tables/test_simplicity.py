"""A boundary is proved to bound a table, or refused in one sentence that names the place."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Add, Interval, Rational, S, Symbol, cos, exp, pi, sin, sqrt, tanh

from symbolic import tables
from symbolic.tables import arc, cardioid, disc, egg, ellipse, parametric, piecewise, polar, polygon, prove_table
from symbolic.tables.arcs import FourierSum
from symbolic.tables.curves import waves
from symbolic.tables.scene import Scene
from symbolic.tables.table import Mark, Shape, Table, a, alpha, theta

b = Symbol("b", real=True)
TINY, TENTH, HALF = Rational(1, 10**7), Rational(1, 10), Rational(1, 2)


def corners(side):
    return [(0, 0), (side, 0), (side, side), (0, side)]


def sides(points):
    ring = zip(points, [*points[1:], points[0]], strict=True)
    return [
        arc(f"side{i}", x + theta * (S(u) - x), y + theta * (S(v) - y), 0, 1) for i, ((x, y), (u, v)) in enumerate(ring)
    ]


def with_discs(side, *discs):
    return piecewise(*sides(corners(side)), *(disc(f"disc{i}", (x, y), r) for i, (x, y, r) in enumerate(discs)))


def grid(n, spacing, radius):
    places = [spacing * k + spacing / S(2) for k in range(n)]
    return with_discs(n * spacing, *((x, y, radius) for x in places for y in places))


def loop():
    w = 1 / (1 + 10**4 * (1 - cos(theta - Rational(259, 250)))) ** 2
    return parametric(2 * cos(theta) + w * cos(100 * theta) / 10, sin(theta) + w * sin(100 * theta) / 10)


def needle(**more):
    return polar(2 * cos(theta / 2) ** 2 - 3 / (5 * (10**24 * cos(theta / 2) ** 2 + 1) ** 2), **more)


def limacon(swing):
    rho = 1 + swing * cos(theta)
    return rho * cos(theta), rho * sin(theta)


INNER = 1 + Rational(1, 10**13)
REFUSED = {
    "49 discs that overlap": (lambda: grid(7, 2, Rational(6, 5)), "near disc.* and disc"),
    "a disc across another": (lambda: with_discs(20, (5, 5, 1), (12, 12, 1), (6, 5, 1)), "near disc0 .* and disc2"),
    "a disc across the wall": (lambda: with_discs(20, (5, 5, 1), (20, 9, 1)), "near side1 .* and disc1"),
    "discs that overlap by a hundredth": (
        lambda: with_discs(20, (5, 5, 1), (Rational(699, 100), 5, 1)), "near disc0 at theta = 0.1.* and disc1",
    ),
    "a disc through the wall by little": (lambda: with_discs(20, (1 - TINY, 5, 1)), "near side3 .* and disc0"),
    "discs that touch": (lambda: with_discs(20, (5, 5, "5/2"), (8, 9, "5/2")), "near disc0 at theta = -0.927.* disc1"),
    "a disc that touches the wall": (lambda: with_discs(20, (1, 5, 1)), "near side3 at theta = 0.75 and disc0"),
    "a disc in a disc": (lambda: with_discs(20, (5, 5, 2), (5, 5, 1)), "the hole through disc1"),
    "a disc outside": (lambda: with_discs(20, (50, 5, 2)), "the hole through disc0"),
    "a narrow loop": (loop, "near parametric at theta = 1.03"),
    "a radius with a needle": (needle, "is not positive"),
    "the same beside a named cusp": (lambda: needle(undefined=cardioid.undefined), "near polar at theta = -3.14159"),
    "a small inner loop": (lambda: polar(1 + INNER * cos(theta)), "is not positive"),
    "the same by coordinates": (lambda: parametric(*limacon(INNER)), "near parametric at theta = -3.14159"),
    "the same with a named cusp": (lambda: polar(1 + INNER * cos(theta), undefined=cardioid.undefined), "near polar"),
    "a spike": (lambda: polygon((0, 0), (2, 0), (4, 0), (2, 0), (2, 2), (0, 2)), "near side2 .* and side3"),
    "a corner on a side": (lambda: polygon((0, 0), (4, 0), (4, 4), (2, 0), (0, 4)), "near side1 at theta = 0.5"),
    "two corners in one point": (lambda: polygon((0, 0), (2, 0), (1, 1), (2, 3), (1, 1), (0, 3)), "near side"),
    "a curve that stops and turns back": (lambda: parametric(cos(theta) ** 3, sin(theta) ** 3), "has no tangent near"),
    "a side of length 0": (lambda: polygon((0, 0), (1, 0), (1, 0), (0, 1)), "corners 2 and 3 are both .1, 0."),
    "a component of length 0": (
        lambda: piecewise(*sides(corners(1))[:1], arc("point", 1, 0, 0, 1), *sides(corners(1))[1:]), "point is the",
    ),
    "a path with a piece of length 0": (
        lambda: tables.from_path([[[(0, 0), (2, 0)], [(2, 0), (2, 0)], [(2, 0), (2, 2)], [(2, 2), (0, 0)]]]),
        "a piece at .2, 0. has length 0",
    ),
    "two corners of one place": (lambda: polygon((0, 0), (1, 0), (0, 0)), "2 corners make no polygon"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_no_table_is_refused_with_the_place(what):
    build, sentence = REFUSED[what]
    with pytest.raises(ValueError, match=sentence) as refusal:
        build()

    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 220


def sum_of(wave, harmonics):
    return Add(*(wave(k * theta) / (10 * k**2) for k in range(2, harmonics)))


ACCEPTED = {
    "25 discs": lambda: grid(5, 4, 1),
    "100 discs": lambda: grid(10, 4, 1),
    "discs that nearly touch": lambda: with_discs(20, (5, 5, 1), (7 + TINY, 5, 1), (1 + TINY, 9, 1)),
    "a limacon that has nearly a loop": lambda: parametric(*limacon(1 - Rational(1, 10**13))),
    "a comb": lambda: polygon((0, 0), (60, 0), *((x, 1 + 99 * (x % 2)) for x in range(60, -1, -1))),
    "a cusp where arcs bend by different curvatures": lambda: piecewise(
        arc("outer", 2 + 2 * cos(theta), 2 * sin(theta), 0, pi),
        arc("inner", 1 - cos(theta), sin(theta), 0, pi),
        arc("foot", theta, 0, 2, 4),
    ),
    "a cusp where an arc touches a side": lambda: piecewise(
        arc("side", theta, 0, 0, 1), arc("end", 1, theta, 0, 1), arc("arc", cos(theta), 1 - sin(theta), 0, pi / 2)
    ),
    "cusps by powers": lambda: parametric(
        cos(theta) ** 3, sin(theta) ** 3, undefined=[Mark("cusp", 0, k * pi / 2) for k in range(-1, 3)]
    ),
    "a circle whose speed vanishes once": lambda: parametric(cos(theta + sin(theta)), sin(theta + sin(theta))),
    "a spike of a thousandth": lambda: polar(1 + exp(-(10**6) * (1 - cos(theta))) / 4),
    "a dent": lambda: polar(1 - 1 / (4 * (1 + 10**10 * (1 - cos(theta - 1))))),
    "steep steps": lambda: parametric(2 * cos(theta), sin(theta) + tanh(100000 * cos(theta)) / 3),
    "400 harmonics": lambda: parametric(2 * cos(theta) + sum_of(cos, 400), sin(theta) + sum_of(sin, 400)),
    "a small table": lambda: parametric(2 * cos(theta) / 10**80, sin(theta) / 10**80),
    "a large table": lambda: parametric(2 * 10**80 * cos(theta), 10**80 * sin(theta)),
    "a small square far away": lambda: polygon(
        *((10**9 + x / S(10**9), 10**9 + y / S(10**9)) for x, y in corners(1))
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", ACCEPTED)
def test_what_is_a_table_is_proved_to_be_one(what):
    prove_table(ACCEPTED[what]())


@pytest.mark.parametrize("name", tables.GALLERY)
def test_every_table_of_the_gallery_is_proved(name):
    prove_table(tables.GALLERY[name]())


def test_the_first_corner_again_makes_no_other_polygon():
    assert polygon(*corners(1), (0, 0)) == polygon(*corners(1))


# ---- laws

SIZES = st.sampled_from([S(1), S(10) ** -9, S(10) ** 9, Rational(3, 7)])
ANGLES = st.sampled_from([(S(1), S(0)), (Rational(3, 5), Rational(4, 5)), (S(0), S(-1)), (sqrt(2) / 2, -sqrt(2) / 2)])


@st.composite
def crooked_ovals(draw):
    """`exp(i*theta)` plus three harmonics so small that the tangent turns forwards, so the curves are simple."""
    shares = [Rational(draw(st.integers(-9, 9)), 40 * k) for k in (2, 3, 4)]
    x = cos(theta) + Add(*(c * cos(k * theta) for k, c in zip((2, 3, 4), shares, strict=True)))
    return x, sin(theta) + Add(*(c * sin(k * theta) for k, c in zip((2, 3, 4), shares, strict=True)))


@pytest.mark.slow
@given(curve=crooked_ovals(), size=SIZES, angle=ANGLES, mirror=st.booleans(), start=st.integers(-3, 3))
def test_a_simple_curve_stays_a_table_however_it_is_moved(curve, size, angle, mirror, start):
    sense = -1 if mirror else 1  # a mirror image is run backwards
    x, y = (coordinate.subs(theta, sense * theta + start) for coordinate in curve)
    c, s = angle
    y *= sense

    assert parametric(size * (c * x - s * y) + start, size * (s * x + c * y)).components


@given(size=SIZES, gap=st.integers(-6, 6).filter(bool), angle=st.sampled_from([(3, 4), (-4, 3), (5, 12), (1, 0)]))
def test_two_discs_are_holes_exactly_when_they_are_apart(size, gap, angle):
    u, v = angle
    far = Rational(round((u * u + v * v) ** 0.5)) * size
    near = (1 + S(gap) / 10**5) / 2 * far
    walls = [(20 * size * x, 20 * size * y) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    boundary = [*sides(walls), disc("one", (0, 0), near), disc("other", (u * size, v * size), near)]
    if gap < 0:
        assert piecewise(*boundary).components
    else:
        with pytest.raises(ValueError, match=r"near one .* and other"):
            piecewise(*boundary)


@given(low=st.integers(-400, 400), width=st.integers(1, 10**6), share=st.integers(0, 100), order=st.integers(0, 3))
def test_a_finite_sum_lies_within_its_enclosure(low, width, share, order):
    x = 2 * cos(theta) + sum_of(cos, 30)
    one = 2**96
    over = low * one // 100, low * one // 100 + one // width
    at = Rational(over[0] * (100 - share) + over[1] * share, 100 * one)
    (below, above), _, _ = FourierSum(waves(x), order)(over)

    assert below <= (x.diff(theta, order).subs(theta, at) * one).evalf(40) <= above


# ---- ranges of letters


def half_discs(bulge):
    """The upper half of the unit circle, raised by a multiple of `sin(theta)**2`, and the lower half."""
    upper = arc("upper", cos(theta), sin(theta) + bulge * sin(theta) ** 2, 0, pi)
    return piecewise(upper, arc("lower", cos(theta), sin(theta), pi, 2 * pi), shapes=[Shape(b, Interval(0, TENTH), "")])


def vanishing_at_nine_values():
    """A polynomial in `b` with nine zeros and minimum -2.203; half discs cross at -2, the area vanishes at -3*pi/4."""
    product = S(6) * 10**13
    for k in range(9):
        product *= b - Rational(k, 80)
    return product


DISC = Shape(b, Interval(TENTH, HALF - TENTH), "reaches the walls")
RANGES = {
    "ellipses": (lambda: ellipse, {a: (1, 100)}, ""),
    "eggs": (lambda: egg(3), {alpha: (0, Rational(99, 100))}, ""),
    "eggs that stop": (lambda: egg(3), {alpha: (0, Rational(101, 100))}, "where alpha = 1.00"),
    "stadiums": (lambda: tables.stadium(Shape(b, Interval(1, 3), "")), {b: (Rational(1, 10), 3)}, ""),
    "squares with a disc": (lambda: tables.sinai(DISC), {b: (TENTH, HALF - TENTH)}, ""),
    "a disc that grows to the walls": (lambda: tables.sinai(DISC), {b: (TENTH, HALF)}, r"(near|where) b = 0\.5"),
    "half discs": (lambda: half_discs(b), {b: (0, 1)}, ""),
    "half discs that cross between nine values": (
        lambda: half_discs(vanishing_at_nine_values()), {b: (0, TENTH)}, r"near upper .* where b = 0\.0",
    ),
    "no range": (lambda: ellipse, {a: (1, S.Infinity)}, "is no range"),
}  # fmt: skip


@pytest.mark.parametrize("what", RANGES)
def test_a_family_is_proved_over_its_range_or_refused_at_a_value(what):
    build, ranges, sentence = RANGES[what]
    table = build()
    if not sentence:
        prove_table(table, ranges)
    else:
        with pytest.raises(ValueError, match=sentence):
            prove_table(table, ranges)


def test_a_chain_that_closes_at_nine_values_is_not_closed():
    table: Table = half_discs(b)
    first, last = table.components
    raised = arc("raised", first.point[0], first.point[1] + vanishing_at_nine_values() * cos(theta), 0, pi)
    with pytest.raises(ValueError, match="is not closed"):
        piecewise(raised, last, shapes=table.shapes)


def test_a_scene_over_a_range_is_proved_over_all_of_it():
    text = str(vanishing_at_nine_values())
    upper = {"x": "cos(theta)", "y": f"sin(theta) + ({text})*sin(theta)**2", "from": "0", "to": "pi"}
    lower = {"x": "cos(theta)", "y": "sin(theta)", "from": "pi", "to": "2*pi"}
    scene = Scene.of({"component": [upper, lower], "shape": {"b": "0"}})

    assert scene.table.components
    with pytest.raises(ValueError, match="is not proved to be a table"):
        scene.over("b", 0, "1/10")


def test_a_table_that_is_made_again_is_a_table_again():
    for _ in range(2):
        assert ACCEPTED["cusps by powers"]().undefined
