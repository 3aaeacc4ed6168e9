"""Results do not depend on how a table was written: as a formula, in pieces, as points, as SVG, as DXF.

Scenes are random: polygons, half ellipses, stadiums and ellipses, with holes, cut into more pieces, turned, mirrored,
scaled and shifted. All numbers are finite decimals, so that each format describes the same curve exactly, except DXF,
which holds doubles.
"""

import io
import json
from contextlib import redirect_stderr, redirect_stdout
from fractions import Fraction
from math import isqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from verification.app.cli import main

FEW = settings.default.max_examples // 8  # a scene is written in some ten ways
TENTH = Fraction(1, 10)
QUARTERS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # cosine and sine at multiples of pi/2


class Line(NamedTuple):
    """The side from `p` to `q`."""

    p: tuple
    q: tuple

    start = property(lambda self: self.p)
    end = property(lambda self: self.q)

    def cut(self):
        middle = tuple((u + v) / 2 for u, v in zip(self.p, self.q, strict=True))
        return [Line(self.p, middle), Line(middle, self.q)]

    def moved(self, move):
        return Line(move(self.p), move(self.q))

    def turned(self):
        return Line(self.q, self.p)

    def formulas(self):
        return [f"{u} + ({v - u})*theta" for u, v in zip(self.p, self.q, strict=True)], ("0", "1")


class Arc(NamedTuple):
    """The arc `c + a*cos(t) + b*sin(t)` from `low` to `high` right angles, where `a` and `b` are perpendicular."""

    c: tuple
    a: tuple
    b: tuple
    low: int
    high: int

    start = property(lambda self: self.at(self.low))
    end = property(lambda self: self.at(self.high))

    def at(self, quarter):
        u, v = QUARTERS[quarter % 4]
        return tuple(c + u * a + v * b for c, a, b in zip(self.c, self.a, self.b, strict=True))

    def cut(self):
        middles = range(self.low, self.high)
        return [self._replace(low=quarter, high=quarter + 1) for quarter in middles]

    def moved(self, move):
        c = move(self.c)
        a, b = (tuple(u - v for u, v in zip(move(self.at(k)), c, strict=True)) for k in (0, 1))
        return self._replace(c=c, a=a, b=b)

    def turned(self):
        return self._replace(b=tuple(-v for v in self.b), low=-self.high, high=-self.low)

    def formulas(self):
        x, y = (f"{c} + ({a})*cos(theta) + ({b})*sin(theta)" for c, a, b in zip(self.c, self.a, self.b, strict=True))
        return [x, y], (f"{self.low}*pi/2", f"{self.high}*pi/2")


class Drawing(NamedTuple):
    """The pieces of the outer curve and of each hole, and a point and a direction inside."""

    curves: tuple
    point: tuple
    towards: tuple
    size: Fraction

    def moved(self, move, factor, mirrored):
        def curve(pieces):
            found = [piece.moved(move) for piece in pieces]
            return tuple(piece.turned() for piece in found[::-1]) if mirrored else tuple(found)

        ahead = move(tuple(u + v for u, v in zip(self.point, self.towards, strict=True)))
        point = move(self.point)
        towards = tuple(u - v for u, v in zip(ahead, point, strict=True))
        return Drawing(tuple(map(curve, self.curves)), point, towards, self.size * factor)

    def cut(self):
        return self._replace(
            curves=tuple(tuple(part for piece in curve for part in piece.cut()) for curve in self.curves)
        )

    @property
    def straight(self):
        return len(self.curves) == 1 and all(isinstance(piece, Line) for piece in self.curves[0])


# ---- ways of writing


def decimal(value):
    """The text of a fraction whose denominator has no prime factors but 2 and 5, exactly."""
    shift = 0
    while (value * 10**shift).denominator > 1:
        shift += 1
    return f"{int(value * 10**shift)}e-{shift}"


def pair(point, sign=1):
    return f"{decimal(point[0])} {decimal(sign * point[1])}"


def scene_file(drawing, folder):
    words = []
    for number, curve in enumerate(drawing.curves):
        for piece in curve:
            (x, y), (low, high) = piece.formulas()
            words.append(f'[[component]]\nx = "{x}"\ny = "{y}"\nfrom = "{low}"\nto = "{high}"')
            words[-1] += "\nhole = true" * (number > 0)
    path = folder / "a.toml"
    path.write_text("\n".join(words))
    return ["--scene", str(path)]


def svg_file(drawing, folder):
    """A file of the drawing; the `y` axis of SVG points down, that of a table up."""
    words = []
    for curve in drawing.curves:
        words.append(f"M {pair(curve[0].start, -1)}")
        for piece in curve:
            if isinstance(piece, Line):
                words.append(f"L {pair(piece.end, -1)}")
                continue
            radii = [length(piece.a), length(piece.b)]
            turn = -np.degrees(np.arctan2(float(piece.a[1]), float(piece.a[0]))) if radii[0] != radii[1] else 0
            sweep = int(piece.a[0] * piece.b[1] - piece.a[1] * piece.b[0] < 0)
            for part in piece.cut():
                words.append(f"A {decimal(radii[0])} {decimal(radii[1])} {turn:.17g} 0 {sweep} {pair(part.end, -1)}")
        words.append("Z")
    path = folder / "a.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{" ".join(words)}"/></svg>')
    return ["--data", str(path)]


def dxf_file(drawing, folder):
    import ezdxf

    document = ezdxf.new()
    space = document.modelspace()
    for curve in drawing.curves:
        for piece in curve:
            if isinstance(piece, Line):
                space.add_line(*(tuple(map(float, end)) for end in (piece.p, piece.q)))
                continue
            a, b, low, high = piece.a, piece.b, piece.low, piece.high
            if length(a) < length(b):  # the first is to be the longer one
                a, b, low, high = b, tuple(-v for v in a), low - 1, high - 1
            if a[0] * b[1] < a[1] * b[0]:
                b, low, high = tuple(-v for v in b), -high, -low
            ends = low * np.pi / 2, high * np.pi / 2
            centre, axis = (tuple(map(float, v)) for v in (piece.c, a))
            space.add_ellipse(centre, axis, float(length(b) / length(a)), *ends)
    path = folder / "a.dxf"
    document.saveas(path)
    return ["--data", str(path)]


def points_file(drawing, folder, again=True):
    corners = [piece.start for piece in drawing.curves[0]]
    rows = [*corners, corners[0]] if again else corners
    path = folder / "a.csv"
    path.write_text("".join(f"{decimal(x)},{decimal(y)}\n" for x, y in rows))
    return ["--data", str(path), "--smoothness", "0"]


def wkt_file(drawing, folder):
    corners = [piece.start for piece in drawing.curves[0]]
    path = folder / "a.wkt"
    path.write_text(f"POLYGON (({', '.join(map(pair, [*corners, corners[0]]))}))")
    return ["--data", str(path)]


def polygon_words(drawing, folder):
    return [
        "--polygon",
        " ".join(f"{decimal(x)},{decimal(y)}" for x, y in (piece.start for piece in drawing.curves[0])),
    ]


def ways(drawing):
    straight = [points_file, wkt_file, polygon_words] if drawing.straight else []
    return [scene_file, svg_file, dxf_file, *straight]


def length(vector):
    """The exact length of a vector in a direction like (1, 0), (3, 4) or (7, 24)."""
    square = sum(v * v for v in vector)
    return Fraction(isqrt(square.numerator), isqrt(square.denominator))


# ---- what is drawn

EIGHT = ((10, 0), (7, 7), (0, 10), (-7, 7), (-10, 0), (-7, -7), (0, -10), (7, -7))


def polygon(radii):
    corners = [(TENTH * r * x, TENTH * r * y) for r, (x, y) in zip(radii, EIGHT, strict=True)]
    return tuple(Line(p, q) for p, q in zip(corners, [*corners[1:], corners[0]], strict=True))


def arc(c, a, b, low, high):
    return Arc(*(tuple(Fraction(v) for v in vector) for vector in (c, a, b)), low, high)


def side(p, q):
    return Line(*(tuple(Fraction(v) for v in point) for point in (p, q)))


def half_ellipse(a):
    return (arc((0, 0), (a, 0), (0, 4), 0, 2), side((-a, 0), (a, 0)))


def stadium(h):
    right, left = arc((h, 0), (4, 0), (0, 4), -1, 1), arc((-h, 0), (4, 0), (0, 4), 1, 3)
    return right, side((h, 4), (-h, 4)), left, side((-h, -4), (h, -4))


def ellipse(a):
    return (arc((0, 0), (a, 0), (0, 4), -2, 2),)


def hole(r):
    """A disc away from the middle, clockwise."""
    return (arc((TENTH, 2), (r, 0), (0, -r), -2, 2),)


half = st.integers(2, 12).map(half_ellipse)
smooth = st.integers(1, 6).map(stadium) | st.integers(2, 9).map(ellipse)
outer = st.lists(st.integers(6, 12), min_size=8, max_size=8).map(polygon) | half | smooth
holes = st.none() | st.integers(1, 4).map(lambda n: hole(n * TENTH * 2))
direction = st.tuples(st.integers(-97, 97).map(lambda n: n + Fraction(137, 1000)), st.integers(1, 89))  # at no corner
similar = st.tuples(
    st.sampled_from([(1, 0), (0, 1), (Fraction(3, 5), Fraction(4, 5)), (Fraction(-7, 25), Fraction(24, 25))]),
    st.booleans(),
    st.sampled_from([Fraction(1), Fraction(10**9), Fraction(1, 10**9), Fraction(3, 8)]),
    st.sampled_from([0, 10, 10**6]),
)


@st.composite
def drawings(draw, outer=outer, holes=holes):
    inner = draw(holes)
    curves = (draw(outer), *([] if inner is None else [inner]))
    towards = tuple(map(Fraction, draw(direction)))
    return Drawing(curves, (-TENTH, TENTH * 7), towards, Fraction(8))


def similarity(given):
    (c, s), mirrored, factor, away = given

    def move(point):
        x, y = point
        y = -y if mirrored else y
        return factor * (c * x - s * y + away * 8), factor * (s * x + c * y - away * 3)

    return move, factor, mirrored


# ---- questions


def asked(command, words):
    """The exit status, the JSON result, and the printed text of a command."""
    printed = io.StringIO()
    with TemporaryDirectory() as folder, redirect_stdout(printed), redirect_stderr(printed):
        path = Path(folder) / "answer.json"
        status = main([command, *words, "--json", str(path)])
        return status, json.loads(path.read_text()) if path.is_file() else None, printed.getvalue()


def answers(command, drawing, *words, ways=ways):
    with TemporaryDirectory() as folder:
        for way in ways(drawing):
            status, answer, printed = asked(command, [*way(drawing, Path(folder)), *words])
            assert status < 2, (way.__name__, printed)
            yield way.__name__, answer


def orbit(drawing, lam, ways=ways):
    start = ",".join(decimal(v) for v in drawing.point), ",".join(decimal(v) for v in drawing.towards)
    words = ["--from", start[0], "--towards", start[1], "--lam", lam, "--bounces", "6"]
    for name, answer in answers("orbit", drawing, *words, ways=ways):
        rows = [(row["x"], row["y"], row["phi"], row["status"] == "regular") for row in answer["bounces"]]
        yield name, np.array(rows, dtype=float)


@pytest.mark.slow
@settings(max_examples=FEW)
@given(drawings(), similar, st.sampled_from(["0", "1/4", "1/2", "9/10", "1"]))
def test_an_orbit_is_the_same_however_its_table_is_written(drawing, given, lam):
    ((_, first),) = orbit(drawing, lam, lambda _: [scene_file])
    move, factor, mirrored = similarity(given)
    assert np.all(first[:, 3])  # regular: joins that are smooth stop nothing
    places = np.array([[float(v) for v in move(tuple(map(Fraction, row[:2])))] for row in first])
    size, away = float(drawing.size * factor), float(np.max(np.abs(places)))
    near = 1e-8 * size + 1e-11 * away
    other = drawing.moved(move, factor, mirrored)
    for written in (other, other.cut()):
        for name, rows in orbit(written, lam):
            assert len(rows) == len(first), name
            assert np.allclose(rows[:, :2], places, rtol=0, atol=near), (name, rows, places)
            assert np.allclose(rows[1:, 2], first[1:, 2] * (-1 if mirrored else 1), atol=1e-7), name


def in_one_way(number):
    return lambda drawing: [ways(drawing)[number % len(ways(drawing))]]


def two_answers(command, drawing, given, number, *words):
    """The results for a drawing in pieces, and for a copy that is moved, cut and written in another format."""
    yield from answers(command, drawing, *words, ways=in_one_way(0))
    yield from answers(command, drawing.moved(*similarity(given)).cut(), *words, ways=in_one_way(number))


def attractors(answer, least=0.0):
    """The reported properties of the attractors with a share of at least `least`."""
    keys = ("kind", "period", "status", "nu_plus", "nu_plus_stderr", "nu_minus", "nu_minus_stderr")
    return [[found[key] for key in keys] for found in answer["attractors"] if found["share_low"] >= least]


def alike(one, other):
    (*kind, p, dp, m, dm), (*its, q, dq, n, dn) = one, other
    return kind == its and all(
        u == v or abs(u - v) <= 6 * ((du or 0) + (dv or 0)) + 1e-6 for u, v, du, dv in ((p, q, dp, dq), (m, n, dm, dn))
    )


@pytest.mark.slow
@settings(max_examples=max(1, FEW // 2))
@given(drawings(), similar, st.sampled_from(["1/4", "1/2", "9/10"]), st.integers(1, 5))
def test_attractors_and_their_exponents_are_the_same_however_a_table_is_written(drawing, given, lam, number):
    words = "--lam", lam, "--orbits", "40"
    (_, first), (way, second) = two_answers("attractor", drawing, given, number, *words)
    for one, other in ((first, second), (second, first)):  # no forty starts miss an attractor of a large share
        for found in attractors(one, least=0.15):
            assert any(alike(found, its) for its in attractors(other)), (way, found, attractors(other))


def of_cycles(answer, size):
    def told(cycle):
        multipliers = ((round(m["real"], 5), round(abs(m["imaginary"]), 5)) for m in cycle["multipliers"])
        return (
            cycle["period"],
            cycle["winding"],
            cycle["stability"],
            round(cycle["length"] / size, 6),
            *sorted(multipliers),
        )

    return sorted(map(told, answer["cycles"]))


@pytest.mark.slow
@settings(max_examples=max(1, FEW // 2))
@given(drawings(half | smooth, st.none()), similar, st.sampled_from(["1/4", "1/2", "9/10"]), st.integers(1, 5))
def test_cycles_are_the_same_however_a_table_is_written(drawing, given, lam, number):
    turn, mirrored, factor, away = given
    given = turn, mirrored, factor, min(away, 10)  # farther off the doubles of DXF do not say which tangents agree
    (_, first), (way, second) = two_answers("cycles", drawing, given, number, "--lam", lam, "--period", "2")
    size = float(drawing.size)
    assert of_cycles(first, size) == of_cycles(second, size * float(given[2])), way
