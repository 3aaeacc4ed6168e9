"""Two interval arithmetics, python-flint's balls and the independent checker's integers, agree."""

import math
import random
from fractions import Fraction

import pytest
from flint import arb, arb_series

from symbolic.tables import formula
from verification.arithmetic.balls import working

P = 200


def as_fraction(x: arb) -> Fraction:
    mantissa, exponent = x.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def ends(x: arb) -> tuple[Fraction, Fraction]:
    """The ends of a ball, rounded outwards."""
    middle, radius = as_fraction(x.mid()), as_fraction(x.rad())
    return middle - radius, middle + radius


def overlap(x: arb, y) -> bool:
    """True if a ball and an interval of integers meet, as they must if both contain the true value."""
    low, high = ends(x)
    return low <= Fraction(y.hi, 1 << y.p) and Fraction(y.lo, 1 << y.p) <= high


def exactly(x: Fraction) -> arb:
    """A dyadic fraction as a ball of radius 0."""
    return arb(x.numerator) / x.denominator


def arguments() -> list[Fraction]:
    """Small, large and huge dyadic numbers of both signs, and numbers near a multiple of a quarter turn."""
    dice = random.Random(20)
    found = [Fraction(0), Fraction(1), Fraction(-1), Fraction(2) ** -150, Fraction(2) ** 300, -(Fraction(2) ** 1000)]
    for _ in range(60):
        found.append(Fraction(dice.getrandbits(180) - 2**179, 2 ** dice.choice((0, 40, 120, 178, 182, 190))))
    for k in (1, 2, 3, 7, 10**6, 10**20):
        found.append(Fraction(round(math.pi * 2**60) * k, 2**61))
    return found


PAPER_WORDS = ("sin", "cos")
WORDS = (*PAPER_WORDS, "tan", "atan", "exp", "log", "sinh", "cosh", "tanh", "sqrt", "abs")


def read(check, word: str, x, bits: int):
    """A function of formulas at an interval."""
    return check.evaluate(check.parse(f"{word}(x)"), {"x": x}, bits)[0]


def in_domain(word: str, x: Fraction) -> bool:
    """True if the function is real there, and its value has at most some thousand digits."""
    return {
        "exp": abs(x) < 3000,
        "sinh": abs(x) < 3000,
        "cosh": abs(x) < 3000,
        "log": x > 0,
        "sqrt": x >= 0,
    }.get(word, True)


@pytest.mark.parametrize("word", WORDS)
def test_both_enclose_the_same_functions(check, word):
    """Widths are below 2**-340 of the value's size, or of its square for a tangent near its pole."""
    met = 0
    for x in filter(lambda x: in_domain(word, x), arguments()):
        with working(P + 1200):
            theirs = getattr(exactly(x), "__abs__" if word == "abs" else word)()
        ours = read(check, word, check.I.of(x, P + 200), P + 200)
        size = max(1, *map(abs, ends(theirs))) ** (2 if word == "tan" else 1)

        assert overlap(theirs, ours), x
        assert Fraction(ours.hi - ours.lo, 1 << ours.p) < size * Fraction(2, 1 << P + 140), x
        met += 1
    assert met > 15


def test_an_angle_nearer_to_a_right_one_than_the_precision_is_enclosed(check):
    """Of 2**k, at 64 bits, where the cosine of the angle is at most a few units in the last place."""
    for k in range(40, 80):
        x = Fraction(2**k) + Fraction(k, 2**7)
        with working(300):
            theirs = exactly(x).atan()

        assert overlap(theirs, check.I.of(x, 64).atan())


@pytest.mark.parametrize("word", ["exp", "sinh", "cosh"])
def test_an_exponential_beyond_any_use_proves_nothing_and_takes_no_time(check, word):
    for x in (Fraction(2) ** 17, Fraction(2) ** 1000):
        with pytest.raises(check.Unproved):
            read(check, word, check.I.of(x, 64), 64)
    tiny = read(check, "exp", check.I.of(-(Fraction(2) ** 1000), 64), 64)

    assert (tiny.lo, tiny.hi) == (0, 1)


@pytest.mark.parametrize("exponent", [Fraction(1, 2), Fraction(-1, 3), Fraction(7, 12), Fraction(-5, 2), Fraction(-3)])
def test_both_enclose_the_same_powers(check, exponent):
    node = check.parse(f"x**({exponent})")
    for x in (x for x in arguments() if Fraction(1, 2**40) < x < 2**40):
        with working(P + 400):
            theirs = exactly(x) ** (arb(exponent.numerator) / exponent.denominator)
        ours = check.evaluate(node, {"x": check.I.of(x, P + 400)}, P + 400)[0]

        assert overlap(theirs, ours), x
        assert ours.hi - ours.lo < 2**300  # of 600 bits, at numbers of 120 times 5


@pytest.mark.parametrize("word", [*WORDS, "power"])
def test_derivatives_of_jets_are_those_of_the_other_library(check, word):
    """Taylor coefficients up to the third, and the derivative that a formula has beside its value."""
    text = "(1 + u)**(2/3)" if word == "power" else f"{word}(u + 1/8)"
    for at in (Fraction(1, 3), Fraction(5, 4)):
        jet = check.Jet.of(check.I.of(at, P), 3, 0)
        ours = check.evaluate(check.parse(text), {"u": jet}, P)[0]
        theta = check.evaluate(check.parse(text.replace("u", "theta")), {"theta": check.I.of(at, P)}, P)[1]
        with working(P):
            x = arb_series([exactly(at), 1], 4)
            y = x + arb(1) / 8
            e, f = y.exp(), (-y).exp()
            own = {"abs": y, "power": ((x + 1).log() * (arb(2) / 3)).exp(), "sinh": (e - f) / 2, "cosh": (e + f) / 2}
            own["tanh"] = (e - f) / (e + f)
            series = own[word] if word in own else getattr(y, word)()
            theirs = [series[k] for k in range(4)]
        mine = [ours.c[check.algebra(3)[1][k, 0, 0]] for k in range(4)]

        assert all(overlap(b, check.I.of(a, P)) for a, b in zip(mine, theirs, strict=True))
        assert overlap(theirs[1], check.I.of(theta, P))


@pytest.mark.parametrize("bits", [53, 64, 113, 300])
def test_wide_intervals_hold_the_values_at_all_their_points(check, bits):
    dice, met = random.Random(bits), 0
    for _ in range(40):
        low = Fraction(dice.getrandbits(80) - 2**79, 2**76)
        high = low + Fraction(dice.getrandbits(80), 2 ** dice.choice((78, 90, 120)))
        wide = check.I.of(low, bits).hull(check.I.of(high, bits))
        for word in WORDS:
            try:
                ours = read(check, word, wide, bits)
            except (check.Unproved, check.Wrong):  # a pole, or a number that may be negative
                assert word in ("tan", "log", "sqrt")
                continue
            met += 1
            for share in (Fraction(0), Fraction(1, 3), Fraction(1)):
                with working(400):
                    place = exactly(low) + exactly(high - low) * share.numerator / share.denominator
                    inner = getattr(place, "__abs__" if word == "abs" else word)()
                assert overlap(inner, ours)
    assert met > 350


@pytest.mark.parametrize("operation", ["+", "-", "*", "/", "neg", "mid", "hull", "times a fraction", "by a fraction"])
def test_rounding_is_outwards(check, operation):
    """At a coarse precision, where every operation rounds, exact fractions at the ends and inside stay inside."""
    dice = random.Random(7)
    for _ in range(300):
        a, b, c, d = (Fraction(dice.getrandbits(40) - 2**39, dice.randrange(1, 2**20)) for _ in range(4))
        x, y = (check.I.of(min(p), 20).hull(check.I.of(max(p), 20)) for p in ((a, b), (c, d)))
        inner = [(s, t) for s in (a, b, (a + b) / 2) for t in (c, d, (c + d) / 2)]
        made = {
            "+": lambda x, y: x + y,
            "-": lambda x, y: x - y,
            "*": lambda x, y: x * y,
            "/": lambda x, y: x / y,
            "neg": lambda x, y: -x,
            "mid": lambda x, y: x,
            "hull": lambda x, y: x,
            "times a fraction": lambda x, y, b=b: x * b,
            "by a fraction": lambda x, y, b=b: x * (1 / (b or 1)),
        }[operation]
        if operation == "/" and 0 in y:
            with pytest.raises(check.Unproved):
                made(x, y)
            continue
        box = x.mid().hull(x) if operation == "mid" else x.hull(y) if operation == "hull" else made(x, y)
        for s, t in inner:
            value = made(s, t)
            assert Fraction(box.lo, 1 << box.p) <= value <= Fraction(box.hi, 1 << box.p)


def test_pi_is_that_of_the_other_library(check):
    for bits in (20, 64, 333, 4000):
        with working(bits + 100):
            assert overlap(arb.pi(), check.pi(bits))


def test_every_function_that_formulas_may_have_is_a_word_of_the_second_reader(check):
    for word in formula.FUNCTIONS:
        read(check, word, check.I.of(Fraction(1, 2), 64), 64)


def test_the_second_reader_refuses_what_is_no_word_of_formulas(check):
    for text in ("gamma(theta)", "exp(theta, theta)", "theta**theta", "2**pi", "theta**(1/13)", "exp", "theta.real"):
        with pytest.raises(check.Wrong):
            check.evaluate(check.parse(text), {"theta": check.I.of(1, 64)}, 64)
    for text in ("log(theta - 2)", "theta**(1/3) + (theta - 2)**(1/3)", "1/(theta - 1)", "abs(theta - 1)"):
        with pytest.raises(check.Unproved):
            check.evaluate(check.parse(text), {"theta": check.I.of(1, 64)}, 64)
