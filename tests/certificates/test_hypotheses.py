"""Each hypothesis of the theorems that the second reader quotes: where it fails, nothing is proved."""

from fractions import Fraction
from types import SimpleNamespace

import pytest


@pytest.mark.parametrize(
    ("kind", "other", "cubic", "answer"),
    [
        ("fold", "1/2", None, None),
        ("fold", "-1/2", None, None),
        ("fold", "1", None, "simple_multiplier, other_multiplier_stable"),
        ("fold", "3/2", None, "simple_multiplier, other_multiplier_stable"),
        ("fold", "-1", None, "simple_multiplier, other_multiplier_stable"),
        ("flip", "1/2", "1/9", None),
        ("flip", "1/2", "-1/9", None),
        ("flip", "1/2", "0", "nondegenerate"),
        ("flip", "-3/2", "1/9", "simple_multiplier, other_multiplier_stable"),
    ],
)
def test_a_normal_form_has_one_critical_multiplier_and_a_coefficient_that_is_not_zero(
    check, kind, other, cubic, answer
):
    """Of a round with the multipliers 1 or -1 and another: `(x, y) -> (m*x + cubic*x**3, other*y)`, in intervals."""
    number = lambda text: check.I.of(Fraction(text), 100).wide(check.I.of(Fraction(1, 2**80), 100))  # noqa: E731
    x, y = (check.Jet.of(number("0"), 1, k) for k in (0, 1))
    cycle = SimpleNamespace(p=100, sign=1, kind=kind)
    cycle.run = lambda *_: [None, (x * number("1" if kind == "fold" else "-1"), y * number(other))]
    cycle.along = lambda *_: ([number("0")] * 2, [number(cubic), number("0")])
    image = [number("0")] * 3

    if answer is None:
        check.Cycle.generic(cycle, image)
    else:
        with pytest.raises(check.Unproved, match=answer):
            check.Cycle.generic(cycle, image)


@pytest.mark.parametrize(
    ("zero", "unknown", "holds"),
    [("1/2", 0, True), ("1", 0, False), ("-1", 1, False), ("2", 1, False), ("-3", 2, False)],
)
def test_interval_newton_proves_a_zero_in_the_interior_of_the_box_alone(check, zero, unknown, holds):
    """Of `x - zero`, in one of three unknowns, over [-1, 1]: at an end of it, or beyond, nothing is proved."""
    box = [check.I.of(-1, 60).hull(check.I.of(1, 60))] * 3
    line = lambda x, d: [check.Jet.of(v, d, k) - Fraction(zero) * (k == unknown) for k, v in enumerate(x)]  # noqa: E731

    if holds:
        assert Fraction(zero) * 2**60 in range(check.newton(line, box, 60)[unknown].lo, 2**60)
    else:
        with pytest.raises(check.Unproved, match="exists, unique"):
            check.newton(line, box, 60)


@pytest.mark.parametrize(
    ("radius", "law", "closed"),
    [
        ("1 + cos(3*theta)/9", None, True),
        ("1 + cos(theta/2)/9", None, False),
        ("1 + cos(3*theta)/9", "-lam*eta*(1 + cos(theta)/9)", True),
        ("1 + cos(3*theta)/9", "-lam*eta*(1 + theta/99)", False),
    ],
)
def test_a_bounce_may_run_over_the_seam_where_a_whole_turn_changes_neither_curve_nor_law(check, radius, law, closed):
    assert check.Table([(radius, "-pi", "pi")], {}, law, 60).closed is closed
