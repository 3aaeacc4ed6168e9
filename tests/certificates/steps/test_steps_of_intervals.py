"""The second reader's intervals and jets, step by step: ends that are exact, and enclosures with nothing to spare."""

import math
from fractions import Fraction
from itertools import product

import mpmath
import pytest

SMALL = [(a, b) for a in range(-3, 4) for b in range(a, 4)]  # ends of intervals in units of an eighth
FRACTIONS = [Fraction(n, d) for n in (-7, -2, -1, 0, 1, 3, 9) for d in (1, 2, 3, 5)]


def span(x):
    """The ends of an interval as fractions."""
    return Fraction(x.lo, 1 << x.p), Fraction(x.hi, 1 << x.p)


def holds(x, low, high=None, units=0):
    """Does an interval hold a range of values, with so many units in the last place beyond it at most?"""
    low, high = Fraction(low), Fraction(low if high is None else high)
    return (
        low - Fraction(units, 1 << x.p) <= span(x)[0] <= low <= high <= span(x)[1] <= high + Fraction(units, 1 << x.p)
    )


def precise(function, x):
    """The value of a function of mpmath to 600 bits more than it may have before the point."""
    context = mpmath.MPContext()
    context.prec = 600 + abs(x.numerator).bit_length()
    found = getattr(context, function)(context.mpf(x.numerator) / x.denominator)
    return Fraction(*map(int, mpmath.libmp.to_rational(found._mpf_)))


def test_a_number_is_rounded_down_and_up_to_the_next_of_so_many_bits(check):
    for x, p in product(FRACTIONS, (1, 2, 5)):
        found = check.I.of(x, p)
        assert (found.lo, found.hi, found.p) == (math.floor(x * 2**p), math.ceil(x * 2**p), p)
    for whole in (-3, 0, 5):
        found = check.I.of(whole, 4)
        assert (found.lo, found.hi) == (whole * 16, whole * 16)


@pytest.mark.parametrize("p", [1, 2, 3, 4, 7])
def test_an_interval_of_other_bits_is_the_least_that_holds_it(check, p):
    for low, high in SMALL:
        found = check.I.of(check.I(low, high, 3), p)
        assert found.p == p
        assert (found.lo, found.hi) == (math.floor(Fraction(low, 8) * 2**p), math.ceil(Fraction(high, 8) * 2**p))
        assert check.I.of(found, p) is found


def test_sums_and_products_of_intervals_are_the_least_that_hold_all_values(check):
    for (a, b), (c, d) in product(SMALL, SMALL):
        x, y = check.I(a, b, 3), check.I(c, d, 3)
        total, minus, both = x + y, x - y, x * y
        assert (total.lo, total.hi, minus.lo, minus.hi) == (a + c, b + d, a - d, b - c)
        ends = [Fraction(s * t, 8) for s in (a, b) for t in (c, d)]
        assert (both.lo, both.hi, both.p) == (math.floor(min(ends)), math.ceil(max(ends)), 3)


def test_a_product_with_an_exact_number_is_rounded_once(check):
    for (a, b), f in product(SMALL, FRACTIONS):
        x = check.I(a, b, 3)
        for found in (x * f, f * x):
            assert (found.lo, found.hi) == (math.floor(min(a * f, b * f)), math.ceil(max(a * f, b * f)))
        assert holds(x + f, Fraction(a, 8) + f, Fraction(b, 8) + f, 1)
        assert holds(f - x, f - Fraction(b, 8), f - Fraction(a, 8), 1)
        assert holds(x - f, Fraction(a, 8) - f, Fraction(b, 8) - f, 1)


def test_quotients_hold_all_values_and_little_more_and_none_is_by_what_may_be_0(check):
    for (a, b), (c, d) in product(SMALL, SMALL):
        x, y = (check.I(low << 27, high << 27, 30) for low, high in ((a, b), (c, d)))
        if c <= 0 <= d:
            with pytest.raises(check.Unproved, match="a divisor may be 0"):
                _ = x / y
            continue
        ends = [Fraction(s, t) for s in (a, b) for t in (c, d)]
        assert holds(x / y, min(ends), max(ends), 4)
        assert holds(1 / y, Fraction(8, d), Fraction(8, c), 1)
        assert holds(x / Fraction(3, 7), Fraction(a * 7, 24), Fraction(b * 7, 24), 3)


def test_an_interval_is_beyond_a_whole_number_or_holds_it_by_its_ends_alone(check):
    for (a, b), x in product(SMALL, (-1, 0, 1)):
        one = check.I(a, b, 1)
        assert (one > x, one < x, x in one) == (a > 2 * x, b < 2 * x, a <= 2 * x <= b)


def test_middle_size_width_meeting_hull_and_interior_are_those_of_the_ends(check):
    for a, b in SMALL:
        x = check.I(a, b, 3)
        assert (x.mid().lo, x.mid().hi, x.mid().p) == (math.floor(Fraction(a + b, 2)),) * 2 + (3,)
        assert (x.size().lo, x.size().hi, x.size().p) == (max(abs(a), abs(b)),) * 2 + (3,)
        assert (x.width(), x.real()) == (b - a, (a + b) / 16)
        assert ((-x).lo, (-x).hi, (-x).p) == (-b, -a, 3)
        for c, d in SMALL:
            y = check.I(c, d, 3)
            assert (x.meet(y).lo, x.meet(y).hi, x.meet(y).p) == (max(a, c), min(b, d), 3)
            assert (x.hull(y).lo, x.hull(y).hi, x.hull(y).p) == (min(a, c), max(b, d), 3)
            assert x.inside(y) == (c < a and b < d)
            size = max(abs(c), abs(d))
            assert (x.wide(y).lo, x.wide(y).hi, x.wide(y).p) == (a - size, b + size, 3)


ANGLES = [Fraction(n, 7) for n in range(-24, 25, 3)]
ANGLES += [Fraction(10**k) for k in (1, 3, 9, 40)] + [
    Fraction(-(2**90)),
    Fraction(2) ** -40,
    Fraction(33, 21),
    Fraction(1),
]


@pytest.mark.parametrize("p", [12, 64, 130])
def test_sines_and_cosines_are_within_two_units_of_the_true_ones(check, p):
    """By mpmath; the rounding of the number itself counts for one."""
    for x in ANGLES:
        low, high = (Fraction(end, 2**p) for end in (check.I.of(x, p).lo, check.I.of(x, p).hi))
        for name, found in zip(("sin", "cos"), check.I.of(x, p).sin_cos(), strict=True):
            for at in {low, high}:
                assert holds(found, *(precise(name, at),) * 2, 4)
            assert found.p == p


@pytest.mark.parametrize(
    ("name", "m"),
    [
        ("sin", 193230689), ("sin", 146495911), ("sin", 209319079), ("sin", 150459256), ("cos", 134396596),
        ("cos", 258719516),
    ],
)  # fmt: skip
def test_sines_and_cosines_that_are_hardest_to_round_are_enclosed(check, name, m):
    """Of all `m/2**28` from 1/2 to 1 those whose value is nearest to a whole number of last places."""
    x = Fraction(m, 2**28)
    found = dict(zip(("sin", "cos"), check.I.of(x, 28).sin_cos(), strict=True))[name]
    assert abs(precise(name, x) * 2**28 - round(precise(name, x) * 2**28)) < Fraction(1, 2**27)
    assert holds(found, precise(name, x), None, 2)


def test_nothing_is_asked_of_pi_for_angles_of_up_to_1_of_which_it_is_found(check, monkeypatch):
    monkeypatch.setattr(check, "pi", None)
    for x in (1, -1, Fraction(3, 4)):
        for name, found in zip(("sin", "cos"), check.I.of(x, 77).sin_cos(), strict=True):
            assert holds(found, precise(name, Fraction(x)), None, 4)


@pytest.mark.parametrize("radius", [Fraction(1, 100), Fraction(1, 3), Fraction(2)])
def test_sines_and_cosines_of_wide_angles_are_those_of_the_middle_give_or_take_the_radius(check, radius):
    p = 60
    for x in ANGLES[::2]:
        wide = check.I.of(x, p).wide(check.I.of(radius, p))
        for name, found in zip(("sin", "cos"), wide.sin_cos(), strict=True):
            middle = precise(name, x)
            low, high = max(-1, middle - radius), min(1, middle + radius)
            assert abs(span(found)[0] - low) < Fraction(8, 2**p)
            assert abs(span(found)[1] - high) < Fraction(8, 2**p)
            for k in range(5):
                assert span(found)[0] <= precise(name, x + radius * Fraction(k - 2, 2)) <= span(found)[1]


@pytest.mark.parametrize("p", [20, 49, 64, 101, 200, 450])
def test_angles_are_within_a_few_units_of_the_true_ones_at_both_ends(check, p):
    for x in [Fraction(n, 5) for n in (-40, -9, -5, -1, 0, 1, 4, 12, 77)]:
        for radius in (Fraction(0), Fraction(1, 3)):
            found = check.I.of(x, p).wide(check.I.of(radius, p)).atan()
            slack = 2 + abs(x) + radius  # the sines are rounded, and multiplied by the tangent
            assert holds(found, *(precise("atan", x + s * radius) for s in (-1, 1)), 12 * slack)


@pytest.mark.parametrize("off", [1.272, math.pi, 2 * math.pi, -math.pi, -2 * math.pi])
def test_an_angle_from_a_wrong_guess_is_none(check, monkeypatch, off):
    """Half a turn or a whole one away Newton's method stays there; from 1.272 it comes beyond a right angle."""
    turn = check.pi(400)
    monkeypatch.setattr(check, "pi", lambda p: check.I.of(turn, p))  # which is found by an angle itself
    monkeypatch.setattr(check, "atan", lambda x: math.atan(x) + off)
    for p in (40, 64) if off != 1.272 else (40,):
        with pytest.raises(check.Unproved, match="too near pi/2"):
            check.I.of(10, p).atan()


@pytest.mark.parametrize("x", [Fraction(0), Fraction(1, 2), Fraction(-3), Fraction(7)])
@pytest.mark.parametrize("off", [0.25, -0.125, 0.0625])
def test_an_angle_that_newtons_method_has_not_yet_found_is_enclosed_by_its_residual(check, monkeypatch, x, off):
    """One step from `atan(x) + off` comes to `tan(off) - off` from it; twice the residual is on either side."""
    turn, p = check.pi(400), 40
    monkeypatch.setattr(check, "pi", lambda p: check.I.of(turn, p))
    monkeypatch.setattr(check, "atan", lambda at: math.atan(at) + off)
    found, true = check.I.of(x, p).atan(), precise("atan", x)
    residual = math.sin(abs(math.tan(off) - off)) * math.sqrt(1 + x * x)
    assert span(found)[0] <= true <= span(found)[1]
    assert found.width() / 2**p == pytest.approx(4 * residual, rel=0.02, abs=1e-10)


def test_the_exponents_of_three_letters_and_the_pairs_that_multiply_to_each(check):
    for degree, count in ((0, 1), (1, 4), (2, 10), (3, 20)):
        powers, at, pairs = check.algebra(degree)
        assert len(powers) == len(set(powers)) == len(pairs) == count
        assert powers == sorted(powers, key=lambda e: (sum(e), e))
        assert [at[e] for e in powers] == list(range(count))
        for e, found in zip(powers, pairs, strict=True):
            wanted = {(at[d], at[f]) for d in powers for f in powers if tuple(map(sum, zip(d, f, strict=True))) == e}
            assert (set(found), len(found)) == (wanted, len(wanted))


def made(check, p, degree, seed):
    """A jet of small numbers of every sort, exactly, with 0 among them; and their values."""
    exact, c = [], []
    for k in range(len(check.algebra(degree)[0])):
        low = Fraction((seed * 7 + k * 5) % 11 - 5, 4)
        high = low + Fraction((seed + k) % 3, 4)
        sort = (seed + k) % 5
        c.append([check.I.of(low, p).hull(check.I.of(high, p)), 0, low, int(low), check.I.of(low, p)][sort])
        exact.append([(low, high), (0, 0), (low, low), (int(low),) * 2, (low, low)][sort])
    return check.Jet(c, degree), exact


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_products_and_sums_of_jets_have_the_coefficients_of_polynomials(check, degree):
    """Ranges of the sums of products of the coefficients, exactly: quarters and their products are no rounding."""
    p = 12
    for s, t in product(range(5), range(5)):
        (x, a), (y, b) = made(check, p, degree, s), made(check, p, degree, t)
        found = [check.I.of(c, p) for c in (x * y).c]
        for k, pairs in enumerate(check.algebra(degree)[2]):
            low = sum(min(u * v for u in a[i] for v in b[j]) for i, j in pairs)
            high = sum(max(u * v for u in a[i] for v in b[j]) for i, j in pairs)
            assert span(found[k]) == (low, high)
        for z, c in (
            (x + y, [(u[0] + v[0], u[1] + v[1]) for u, v in zip(a, b, strict=True)]),
            (-x, [(-v, -u) for u, v in a]),
        ):
            assert [span(check.I.of(w, p)) for w in z.c] == c
            assert z.degree == degree
        by = Fraction(3, 2)
        assert [span(check.I.of(w, p)) for w in (x * by).c] == [(u * by, v * by) for u, v in a]
        assert [span(check.I.of(w, p)) for w in (x + by).c] == [(a[0][0] + by, a[0][1] + by), *a[1:]]


def test_a_sum_of_products_of_jets_is_rounded_once_and_outwards(check):
    third, p = check.I.of(Fraction(1, 3), 10), 10
    found = check.Jet([third] * 4, 1) * check.Jet([third] * 4, 1)
    low, high = Fraction(third.lo, 1 << p), Fraction(third.hi, 1 << p)
    for k, n in enumerate((1, 2, 2, 2)):
        assert (found.c[k].lo, found.c[k].hi) == (math.floor(n * low**2 * 2**p), math.ceil(n * high**2 * 2**p))


def test_the_derivative_of_a_jet_is_that_of_its_polynomial(check):
    for degree, letter in product((1, 2, 3), range(3)):
        powers, at, _ = check.algebra(degree)
        numbers = [Fraction(k * k + 1, 3) for k in range(len(powers))]
        found = check.Jet(numbers, degree).diff(letter)
        assert found.degree == degree - 1
        for e, c in zip(check.algebra(degree - 1)[0], found.c, strict=True):
            raised = tuple(n + (k == letter) for k, n in enumerate(e))
            assert c == numbers[at[raised]] * raised[letter]


def test_the_gradient_of_a_jet_is_by_the_three_letters_in_their_order(check):
    for letter in range(3):
        jet = check.Jet.of(check.I.of(5, 30), 2, letter)
        assert [x.real() for x in jet.gradient(30)] == [float(k == letter) for k in range(3)]
        assert check.value(jet).real() == 5
        assert check.Jet.of(check.I.of(5, 30), 2).gradient(30)[letter].real() == 0
    assert check.Jet.of(7, 0, 1).c == [7]


def test_coefficients_over_a_box_are_tightened_by_those_at_its_middle_and_slopes_times_what_is_off(check):
    """Of degree 2 by a middle of degree 1: the first order by the second, then the value by the new first order."""
    p = 20
    box = lambda low, high: check.I.of(Fraction(low), p).hull(check.I.of(Fraction(high), p))  # noqa: E731
    second = [box(1, 2), 0, 0, box(-1, 1), 0, box(3, 3)]  # zz, yz, yy, xz, xy, xx
    jet = check.Jet([box(-9, 9), *[box(-9, 9)] * 3, *second], 2)
    middle = check.Jet([box(1, 1), box(2, 2), box(-1, -1), box("1/2", "1/2")], 1)
    off = [box("-1/4", "1/4"), box("-1/8", "1/8"), box("-1/2", "1/2")]
    jet.tighten(middle, off, p)
    radius = {"x": Fraction(3, 2) + Fraction(1, 2), "y": Fraction(0), "z": 2 + Fraction(1, 4)}
    assert span(jet.c[3]) == (Fraction(1, 2) - radius["x"], Fraction(1, 2) + radius["x"])
    assert span(jet.c[2]) == (-1, -1)
    assert span(jet.c[1]) == (2 - radius["z"], 2 + radius["z"])
    reach = Fraction(5, 2) / 4 + Fraction(1, 8) + Fraction(17, 4) / 2
    assert span(jet.c[0]) == (1 - reach, 1 + reach)
    assert [span(check.I.of(c, p)) for c in jet.c[4:]] == [span(check.I.of(c, p)) for c in second]


def test_a_value_is_tightened_by_another_and_the_slopes_are_left(check):
    jet, other = (check.Jet([check.I(a, b, 4), check.I(-9, 9, 4), 0, 0], 1) for a, b in ((-8, 3), (-2, 7)))
    other.c[1] = check.I(1, 1, 4)
    jet.tighten(other, None, 4)
    assert [(x.lo, x.hi) for x in jet.c[:2]] == [(-2, 3), (-9, 9)]


@pytest.mark.parametrize("name", ["sin", "cos", "atan", "inverse"])
@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_a_function_of_a_jet_has_the_taylor_coefficients_of_the_function_of_a_polynomial(check, name, degree):
    """Of `at + 2*x - y/2`, whose powers are by hand; to within 2000 units in the last place of 80 bits."""
    p, context = 80, mpmath.MPContext()
    context.dps = 40
    for at in (Fraction(-5, 4), Fraction(3, 8), Fraction(2)):
        x = check.Jet.of(check.I.of(at, p), degree, 0) * 2 + check.Jet.of(0, degree, 1) * Fraction(-1, 2) - at
        found, real = check.function(name, x, p), {"inverse": lambda z: 1 / z}.get(name) or getattr(context, name)
        terms = context.taylor(real, context.mpf(at.numerator) / at.denominator, degree)
        for e, c in zip(check.algebra(degree)[0], found.c, strict=True):
            n, (a, b, third) = sum(e), e
            truth = 0 if third else terms[n] * math.comb(n, a) * 2**a * context.mpf(-0.5) ** b
            low, high = span(check.I.of(c, p))
            assert context.mpf(low.numerator) / low.denominator - 1e-35 <= truth
            assert truth <= context.mpf(high.numerator) / high.denominator + 1e-35
            assert high - low <= Fraction(2000, 2**p)
        number = check.function(name, check.I.of(at, p), p)
        assert span(number) == span(check.I.of(check.value(found), p))
        assert found.degree == degree


def test_the_series_of_a_function_without_a_letter_is_its_value(check):
    assert check.taylor(check.I.of(1, 9), [7]) == 7
    x = check.Jet.of(5, 2, 1)
    found = check.taylor(x, [1, 2, 3])
    assert found.c == [1, 0, 2, 0, 0, 0, 3, 0, 0, 0]  # of y: the value, the slope, and the coefficient of its square


@pytest.mark.parametrize(("near", "width"), [("7/5", "1/10"), ("7/5", "1/1000"), ("3/2", "1/4"), ("17/12", "1/400")])
def test_a_root_near_an_interval_is_found_with_its_jet(check, near, width):
    """`t**2 = 2 + x*t + y`, where t_x = 1/2, t_y = 1/(2*sqrt(2)), t_xx/2 = 1/(8*sqrt(2)), t_yy/2 = -1/(16*sqrt(2))."""
    p, root = 90, Fraction(math.isqrt(2 << 400), 2**200)
    x, y = (check.Jet.of(check.I.of(0, p), 2, k) for k in (0, 1))
    start = check.I.of(Fraction(near), p).wide(check.I.of(Fraction(width), p))
    off = lambda t, cut: (t * t - 2 - cut(x) * t - cut(y), t * 2 - cut(x))  # noqa: E731
    found = check.implicit(off, start, 2)
    wanted = {(0, 0): root, (1, 0): Fraction(1, 2), (0, 1): 1 / (2 * root), (2, 0): 1 / (8 * root)}
    wanted |= {(0, 2): -1 / (8 * root * 2), (1, 1): Fraction(0)}
    for (a, b), truth in wanted.items():
        enclosed = check.I.of(found.c[check.algebra(2)[1][a, b, 0]], p)
        assert abs(enclosed.real() - truth) < 1e-15
        assert enclosed.width() < 2**12
    assert [check.I.of(found.c[k], p).real() for e, k in check.algebra(2)[1].items() if e[2]] == [0] * 4
    assert span(found.c[0])[0] <= root <= span(found.c[0])[1]


def test_a_landing_that_is_nowhere_or_everywhere_is_not_enclosed(check):
    p = 60
    near = check.I.of(1, p).wide(check.I.of(Fraction(1, 8), p))
    for off in (lambda t, _: (t * t + 1, t * 2), lambda t, _: (t * t, t * 2), lambda t, _: (t * 0, t * 0)):
        with pytest.raises((check.Unproved, ZeroDivisionError)):
            check.implicit(off, near, 0)


def looked_for(check, images, p=20):
    """Where a zero is looked for, in units, when Newton's steps come to these images one after the other."""
    seen, steps = [], iter(images)
    unit = lambda low, high: check.I(low << 8, high << 8, p)  # noqa: E731

    def off(t, cut):
        if t.width() == 0:
            return t - unit(*next(steps)), None  # the step is from a middle: to the image, by the slope 1
        seen.append((t.lo >> 8, t.hi >> 8))
        return None, check.I.of(1, p)

    found = check.implicit(off, unit(0, 40), 0)
    return seen, (found.c[0].lo >> 8, found.c[0].hi >> 8)


def test_a_landing_is_looked_for_about_an_image_that_lies_outside_and_then_while_steps_more_than_halve(check):
    """Outside: in the hull of both, by the width of the image wider at both ends. Inside: in what both have."""
    seen, found = looked_for(check, [(30, 50), (-10, 30), (12, 50), (14, 23), (15, 16)])
    assert (seen, found) == ([(0, 40), (-20, 70), (-10, 30), (12, 30)], (14, 23))
    for outside in ((0, 20), (20, 40)):  # at an end of it is not inside
        assert looked_for(check, [outside, (1, 39), (1, 39)])[0] == [(0, 40), (-20, 60), (1, 39)]


def test_what_no_letter_reaches_stays_the_number_0(check):
    """So it costs nothing: neither a product with an interval nor a sum of none makes an interval of it."""
    p = 40
    x, y = (check.Jet.of(check.I.of(k, p), 2, k) for k in (1, 2))
    for jet in (x * y, y * x, x * x * y, (x + y) * x, x * Fraction(2, 3)):
        for (in_x, _, _), c in zip(check.algebra(2)[0], jet.c, strict=True):
            assert in_x == 0 or (type(c) is int and c == 0)
