"""Steps of the second reader's long cycles, each by itself: chords, closures, matrices, and vectors by hand."""

from fractions import Fraction
from itertools import pairwise, product
from math import atan2, cos, pi, sin
from random import Random
from types import SimpleNamespace

import pytest
from by_hand import holds, number

P = 100


def cycle(check, long, parts, sign=1, twist=1):
    made = long.Long.__new__(long.Long)
    made.p, made.parts, made.sign, made.twist = P, parts, sign, twist
    return made


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("twist", [1, -1])
def test_after_a_round_a_bounce_is_its_image_times_the_twist(check, long, sign, twist):
    made = cycle(check, long, [0] * 3, sign, twist)
    assert [made.turned(k, twist) for k in range(3)] == [(0, 1), (1, 1), (2, 1)]
    assert [made.turned(k, twist) for k in (3, 4, 6, 7)] == [(0, sign * twist), (1, sign * twist), (0, 1), (1, 1)]
    assert all(type(by) is int for _, by in (made.turned(k, twist) for k in range(7)))
    found = made.round([number(check, k) for k in (5, 7, 11)], twist)
    assert [x.real() for x in found] == [5, 7, 11, 5 * sign * twist, 7 * sign * twist]


def jets(check, dice, n, degree):
    """Pairs of polynomials for each chord of a round and the first one after, with fractions for coefficients."""
    count = len(check.algebra(degree)[0])
    told = [[[Fraction(dice.randrange(-8, 9), 4) for _ in range(count)] for _ in range(2)] for _ in range(n + 1)]
    return told, [[check.Jet([number(check, x) for x in c], degree) for c in pair] for pair in told]


def later(bounces, sign):
    return [*bounces, *(x * sign for x in bounces[:2])]


def rule(check, told, bounces, letter, sign):
    """R of each bounce from the second on, for polynomials that are told: what is to be told of all linear parts."""
    degree = max(map(sum, check.algebra(3)[0][: len(told[0][0])]))
    powers = check.algebra(degree)[0]
    ends = later(bounces, sign)
    at = lambda c, x, y: sum(a * x ** e[0] * y ** e[1] * letter ** e[2] for a, e in zip(c, powers, strict=True))  # noqa: E731
    return [
        at(told[k][0], *ends[k : k + 2]) - at(told[k - 1][1], *ends[k - 1 : k + 1]) for k in range(1, len(bounces) + 1)
    ]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_matrix_of_a_round_has_the_slopes_of_its_rule(check, long, n, sign):
    """Of linear polynomials at 0: the rule itself at each unit vector, less that at 0. With a twist it is that of
    `x -> -x` after a round, and the letter has a column where it is free."""
    dice = Random(n)
    told, chords = jets(check, dice, n, 1)
    for twist in (1, -1):
        made = cycle(check, long, [0] * n, sign, twist)
        origin = rule(check, told, [0] * n, 0, sign * twist)
        for free in (False, True):
            found = made.matrix(chords, twist, free)
            assert len(found) == n
            for column in range(n + free):
                unit = [int(k == column) for k in range(n + 1)]
                moved = rule(check, told, unit[:n], unit[n], sign * twist)
                for row, one, zero in zip(found, moved, origin, strict=True):
                    assert holds(check.I.of(row.get(column, 0), P), one - zero)
            assert all(set(row) <= set(range(n + free)) for row in found)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("twist", [1, -1])
@pytest.mark.parametrize("n", [2, 3])
def test_the_second_and_third_order_along_a_way_are_those_of_the_rule(check, long, n, twist, sign):
    """Of cubic polynomials: `R(w*e + h*e**2)` at `e = -3, ..., 3` has these coefficients, by exact differences."""
    dice = Random(n + twist)
    told, chords = jets(check, dice, n, 3)
    made = cycle(check, long, [0] * n, sign, twist)
    w, h = ([Fraction(dice.randrange(-4, 5), 2) for _ in range(n)] for _ in range(2))
    found = made.along(chords, [number(check, x) for x in w], [number(check, x) for x in h])
    wide_w, wide_h = later(w, sign * twist), later(h, sign)
    assert len(found) == n
    powers, at = check.algebra(3)[0], check.algebra(3)[1]
    for k, pair in enumerate(found, 1):
        wanted = [Fraction(0), Fraction(0)]
        for c, first, by in ((told[k][0], k, 1), (told[k - 1][1], k - 1, -1)):
            (a, b), (x, y) = wide_w[first : first + 2], wide_h[first : first + 2]
            q = {e: c[at[e]] * by for e in powers}
            wanted[0] += q[2, 0, 0] * a * a + q[1, 1, 0] * a * b + q[0, 2, 0] * b * b + q[1, 0, 0] * x + q[0, 1, 0] * y
            wanted[1] += 2 * q[2, 0, 0] * a * x + 2 * q[0, 2, 0] * b * y + q[1, 1, 0] * (a * y + b * x)
            wanted[1] += q[3, 0, 0] * a**3 + q[2, 1, 0] * a * a * b + q[1, 2, 0] * a * b * b + q[0, 3, 0] * b**3
        assert all(holds(ours, true, 64) for ours, true in zip(pair, wanted, strict=True))


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("twist", [1, -1])
@pytest.mark.parametrize("n", [2, 3])
def test_how_the_linear_rule_moves_between_two_vectors_is_minus_its_second_derivative(check, long, n, twist, sign):
    """Of quadratic polynomials, exactly: `-u * d/dx (dR * w)`, in each bounce and in the letter."""
    dice = Random(7 * n + twist)
    told, chords = jets(check, dice, n, 2)
    made = cycle(check, long, [0] * n, sign, twist)
    w, u = ([Fraction(dice.randrange(-4, 5), 2) for _ in range(n)] for _ in range(2))
    found = made.moving(chords, [number(check, x) for x in w], [number(check, x) for x in u])
    at, wide = check.algebra(2)[1], later(w, sign * twist)

    def slope(moved):
        """Between u and w, the linearised rule at a place."""
        ends, letter, total = later(moved[:n], sign), moved[n], Fraction(0)
        for k in range(1, n + 1):
            for c, first, by in ((told[k][0], k, 1), (told[k - 1][1], k - 1, -1)):
                (x, y), (a, b) = ends[first : first + 2], wide[first : first + 2]
                q = {e: c[at[e]] for e in at}
                here = q[1, 0, 0] + 2 * q[2, 0, 0] * x + q[1, 1, 0] * y + q[1, 0, 1] * letter
                there = q[0, 1, 0] + 2 * q[0, 2, 0] * y + q[1, 1, 0] * x + q[0, 1, 1] * letter
                total += u[k - 1] * by * (here * a + there * b)
        return total

    for column in range(n + 1):
        unit = [int(k == column) for k in range(n + 1)]
        assert holds(check.I.of(found.get(column, 0), P), slope([0] * (n + 1)) - slope(unit), 64)
    assert set(found) <= set(range(n + 1))


def test_a_bordered_system_has_one_entry_more_in_a_row_and_a_column_and_is_turned_over(check, long):
    made = cycle(check, long, [0] * 3)
    rows = [
        {0: number(check, 1), 1: number(check, 2)},
        {1: number(check, 3), 2: number(check, 7)},
        {2: number(check, 5)},
    ]
    found, over = made.bordered(rows, (2, 1))
    plain = lambda rows: [{j: x.real() for j, x in row.items()} for row in rows]  # noqa: E731
    assert plain(found.rows) == [{0: 1, 1: 2}, {1: 3, 2: 7}, {2: 5, 3: 1}, {1: 1}]
    assert plain(over) == [{0: 1}, {0: 2, 1: 3, 3: 1}, {1: 7, 2: 5}, {2: 1}]
    assert [set(row) for row in rows] == [{0, 1}, {1, 2}, {2}]


@pytest.mark.parametrize("twist", [1, -1])
def test_the_vectors_of_a_singular_matrix_are_those_that_it_takes_to_0_from_both_sides(check, long, twist):
    """Of the matrix ((1, 1/2), (2, 1)), and for a twist of ((1, -1/2), (2, -1)): `w = (-1/2, 1)` up to sign."""
    made = cycle(check, long, [0] * 2, 1, twist)
    made.end, made.border, asked = [number(check, x) for x in (0, 0, 1)], (0, 1), []
    entries = [
        {0: number(check, 1), 1: number(check, Fraction(twist, 2))},
        {0: number(check, 2), 1: number(check, twist)},
    ]
    made.matrix = lambda chords, by, free: asked.append((chords, by, free)) or entries
    w, u = made.vectors("chords")
    assert asked == [("chords", twist, False)]
    assert len(w) == len(u) == 2
    assert all(holds(x, true, 64) for x, true in zip(w, (Fraction(-twist, 2), 1), strict=True))
    assert all(holds(x, true, 64) for x, true in zip(u, (1, Fraction(-1, 2)), strict=True))


def flown(theta0, theta1, alpha=0.08):
    """The angles at both ends of a chord of the egg, in floats."""

    def at(t):
        r, slope = 1 + alpha * cos(3 * t), -3 * alpha * sin(3 * t)
        return r * cos(t), r * sin(t), slope * cos(t) - r * sin(t), slope * sin(t) + r * cos(t)

    (x, y, tx, ty), (u, v, a, b) = at(theta0), at(theta1)
    dx, dy = u - x, v - y
    return atan2(dx * tx + dy * ty, dy * tx - dx * ty), atan2(dx * a + dy * b, dx * b - dy * a)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("law", [None, "-lam*eta + eta**3/9 + sin(theta)/99"])
def test_the_chords_of_a_round_leave_and_arrive_at_their_angles_with_their_slopes(check, long, sign, law):
    """By floats, and by differences of them; the law makes the angle of the next chord of that of arrival."""
    scene = {"table": "egg", "shape": {"alpha": "2/25"}} | ({"law": law} if law else {})
    table, bounces = check.read_scene(scene, "lam", P)[0], [0.4, 2.3, -1.9]
    made = long.Long(
        table, "fold", [0] * 3, [number(check, x) for x in bounces], sign, "lam", number(check, "1/2"), None
    )
    made.free = True
    found = made.chords(made.boxes, made.box, 2)
    assert len(found) == 4
    ends = later(bounces, sign)

    def true(x, y, lam):
        leaves, arrives = flown(x, y)
        return leaves, (arrives * lam if law is None else lam * arrives - arrives**3 / 9 + sin(y) / 99)

    for k, pair in enumerate(found):
        at = *ends[k : k + 2], 0.5
        for which, jet in enumerate(pair):
            assert check.value(jet).real() == pytest.approx(true(*at)[which], abs=1e-12)
            for place, slope in enumerate(jet.gradient(P)):
                step = [1e-5 * (place == j) for j in range(3)]
                up, down = (true(*(x + by * s for x, s in zip(at, step, strict=True)))[which] for by in (1, -1))
                assert slope.real() == pytest.approx((up - down) / 2e-5, abs=1e-8)
    made.free = False
    made.names = lambda letter: table.letters | {"lam": letter}
    fixed = made.chords(made.boxes, number(check, "1/2"), 1)
    assert all(jet.gradient(P)[2].width() == jet.gradient(P)[2].lo == 0 for pair in fixed for jet in pair)


def test_the_chords_of_a_round_run_from_part_to_part_and_the_last_is_the_first_again(check, long):
    disc, asked = check.read_scene({"polar": "1"}, "lam", P)[0], []
    made = cycle(check, long, [5, 6, 7], -1)
    made.free, made.names = False, lambda letter: {"lam": letter}

    def at(part, theta, names, p):
        asked.append((part, round(check.value(theta).real(), 9)))
        return disc.at(0, theta, names, p)

    made.table = SimpleNamespace(at=at, leaves=lambda psi, names: psi)
    made.chords([number(check, x) for x in (1, 2, 3)], number(check, "1/2"), 1)
    ends = [(5, 1), (6, 2), (7, 3), (5, -1), (6, -2)]
    assert asked == [end for chord in pairwise(ends) for end in chord]


@pytest.mark.parametrize("bad", [0, 1, 2])
def test_each_chord_of_a_round_has_to_leave_inwards_and_to_arrive_from_inside(check, long, bad):
    """Told from (1, 0) to (3, 0), where velocities are upright: the table is to the left of them."""
    made, letters = cycle(check, long, [0, 1]), [number(check, x) for x in (1, 2)]
    made.free, made.names = False, lambda letter: {"lam": letter}
    for one, other in product((-1, 0, 1), repeat=2):
        told = [
            end for k in range(3) for end in ((1, 0, 0, one if k == bad else -1), (3, 0, 0, other if k == bad else 1))
        ]
        ends = iter([[check.Jet.of(number(check, x), 1) for x in end] for end in told])
        made.table = SimpleNamespace(at=lambda *_, ends=ends: next(ends), leaves=lambda psi, _: psi)
        if (one, other) == (-1, 1):
            assert len(made.chords(letters, None, 1)) == 3
        else:
            with pytest.raises(check.Unproved, match="may not leave or arrive inwards"):
                made.chords(letters, None, 1)


@pytest.mark.parametrize("radii", [("1/8", "1/8", "1/8"), ("1/8", "1/32", "1/64"), ("1/64", "1/32", "1/8")])
def test_what_a_step_from_the_middle_may_miss_is_within_the_largest_radius_times_the_row_sum(check, long, radii):
    """The worst case: slopes within 1/16 of 1, all of them at the lower end, and a solution at nine tenths of a box."""
    made, off = cycle(check, long, [0] * 3), Fraction(1, 16)
    made.kind, made.lam, made.box = "cycle", number(check, "1/3"), None
    middles, radii = [Fraction(k, 4) for k in (1, -2, 3)], [Fraction(r) for r in radii]
    made.boxes = [number(check, m).wide(number(check, r)) for m, r in zip(middles, radii, strict=True)]
    share = [Fraction(9, 10) if r == max(radii) else 0 for r in radii]
    zeros = [m + by * (-r if k == 1 else r) for k, (m, r, by) in enumerate(zip(middles, radii, share, strict=True))]

    def chords(bounces, letter, degree):
        slope = number(check, 1).wide(number(check, off)) if bounces is made.boxes else number(check, 1 - off)
        found = []
        for k in range(4):
            at = bounces[k % 3] * (1 - off) - zeros[k % 3] * (1 - off) + (k - 1) * (k - 1)
            rest = check.Jet([number(check, k * k), *([number(check, 0)] * 3)], 1)
            found.append((check.Jet([at, number(check, 0), number(check, 0), slope], 1), rest))
        return found

    made.chords = chords
    _, bounces = made.solved()
    assert all(x.lo <= zero * 2**P <= x.hi for x, zero in zip(bounces, zeros, strict=True))
    assert all(x.width() <= 2 * off * max(radii) * 2**P * (1 + off) for x in bounces)


@pytest.mark.parametrize("n", [2, 3])
def test_the_other_multiplier_of_a_fold_is_the_determinant_of_the_matrices_of_its_bounces(check, long, n):
    """Each takes two parameters to the next two. Whether the multiplier 1 is one, as well, is asked elsewhere."""
    dice, seen = Random(n), set()
    made = cycle(check, long, [0] * n)
    made.kind, made.bounces = "fold", [number(check, 0)] * n
    for _ in range(60):
        slope = lambda: Fraction(dice.choice((-5, -3, -2, 2, 3, 5)), 4)  # noqa: E731
        told = [[[slope() for _ in range(3)] for _ in range(2)] for _ in range(n)]
        chords = [[check.Jet([number(check, x) for x in (0, *slopes[::-1])], 1) for slopes in pair] for pair in told]
        made.chords = lambda bounces, letter, degree, chords=chords: [*chords, chords[0]]
        (a, b), (c, d) = (Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))
        for (_, (before, back, _)), ((here, after, _), _) in zip(told, told[1:] + told[:1], strict=True):
            a, b, c, d = c, d, (before * a + (back - here) * c) / after, (before * b + (back - here) * d) / after
        seen.add(abs(a * d - b * c) < 1)
        if abs(a * d - b * c) < 1:
            made.generic([None, None, None])
        else:
            with pytest.raises(check.Unproved, match="other_multiplier_stable"):
                made.generic([None, None, None])
    assert len(seen) == 2


def test_a_short_chord_of_a_small_disc_leaves_and_arrives_inwards(check, long):
    """Each of both products is far below 1, and only the sign is asked."""
    table = check.read_scene({"polar": "1/10"}, "lam", P)[0]
    boxes = [number(check, x) for x in ("0", "1/2", "1")]
    made = long.Long(table, "cycle", [0] * 3, boxes, 1, "", None, number(check, "1/2"))
    made.free = False
    found = made.chords(boxes, made.lam, 1)
    assert check.value(found[0][0]).real() == pytest.approx(pi / 2 - 1 / 4, abs=1e-12)
    assert check.value(found[0][1]).real() == pytest.approx((pi / 2 - 1 / 4) / 2, abs=1e-12)


def test_a_cycle_of_another_kind_is_none_of_long_equations(check, long):
    made = cycle(check, long, [0] * 2)
    for kind in ("focus", "corner", "tangency"):
        made.kind = kind
        with pytest.raises(check.Wrong, match="kind: that of a long cycle is another"):
            made.solved()


def line(check, long, kind, radius, slope="1/2", beside="0", bend="0"):
    """A cycle of the rule `x[k+1] = slope*x[k] + bend*x[k]**2 + lam - 1/3 - x[k-1]/9` near 0, by boxes beside."""
    made = cycle(check, long, [0] * 3)
    made.kind, made.lam = kind, number(check, "1/3").mid()
    made.boxes = [number(check, beside).wide(number(check, radius))] * 3
    made.box = number(check, "1/3").wide(number(check, radius))
    s, q = Fraction(slope), Fraction(bend)

    def chords(bounces, letter, degree):
        found = []
        ends = later(bounces, 1)
        for k in range(4):
            here, there = (check.Jet.of(x, degree, place) for place, x in enumerate(ends[k : k + 2]))
            lam = check.Jet.of(letter, degree, 2) if made.free else check.Jet.of(letter, degree)
            found.append((there * 1, there * s + there * there * q + (lam - Fraction(1, 3)) - here * Fraction(1, 9)))
        return found

    made.chords = chords
    return made


@pytest.mark.parametrize(("beside", "inside"), [("0", True), ("1/3000", True), ("1/900", False), ("-1/900", False)])
def test_a_cycle_is_one_where_interval_newton_maps_its_boxes_into_themselves(check, long, beside, inside):
    """Of a linear rule the zero is at 0, whatever the boxes: enclosed within a few units, or outside of them."""
    made = line(check, long, "cycle", "1/1000", beside=beside)
    if inside:
        image, bounces = made.solved()
        assert all(holds(x, 0, 2**60) for x in bounces)
        assert image[0] is bounces[0]
        assert image[1] is None
        assert image[2] is made.box
        assert made.bounces == bounces
        assert len(bounces) == 3
    else:
        with pytest.raises(check.Unproved, match="interval Newton does not map the box into itself"):
            made.solved()


@pytest.mark.parametrize(
    ("kind", "slope", "proved"),
    [("fold", "10/9", True), ("fold", "-10/9", False), ("flip", "-10/9", True), ("flip", "10/9", False)],
)
def test_a_fold_and_a_flip_are_told_apart_by_their_twist(check, long, kind, slope, proved):
    """At 0 the rule with the slope `+-(1 + 1/9)` has the multiplier `+-1`: it folds in lam = 1/3."""
    made = line(check, long, kind, "1/100000", slope=slope, bend="1/2")
    if proved:
        image, bounces = made.solved()
        assert all(0 in x for x in bounces)
        assert image[2].lo <= Fraction(2**P, 3) <= image[2].hi
        assert image[2].width() < 2 ** (P - 25)
    else:
        with pytest.raises(check.Unproved):
            made.solved()
