"""Linear systems of the second reader's long cycles: approximate inverses, what they leave, solutions that hold all."""

from fractions import Fraction

import pytest
from by_hand import holds, number

P = 100


def system(check, rows):
    """Of rows of numbers, or of pairs of ends, whose zeros are not told."""
    interval = lambda x: number(check, x[0]).hull(number(check, x[1])) if isinstance(x, tuple) else number(check, x)  # noqa: E731
    return [{j: interval(x) for j, x in enumerate(row) if x} for row in rows]


ROWS = [[4, "1/3", 0], ["-1/2", (3, "49/16"), 1], [0, ("-9/8", "-1"), "-7/2"]]


def corners(row):
    """A row of fractions for each choice of the ends of its entries."""
    made = [[]]
    for x in row:
        made = [[*some, Fraction(end)] for some in made for end in (x if isinstance(x, tuple) else (x,))]
    return made


def test_the_row_sums_of_what_an_approximate_inverse_leaves_are_bounded_within_two_units(check, long):
    """By exact fractions, at all ends of the entries: the largest sum is at one of them."""
    made, n = long.Linear(system(check, ROWS), P), len(ROWS)
    inverse = [[Fraction(x, 2**long.SHIFT) for x in row] for row in made.inverse]
    choices = [[]]
    for row in ROWS:
        choices = [[*some, one] for some in choices for one in corners(row)]
    middle = [[sum(matrix[k][j] for matrix in choices) / len(choices) for j in range(n)] for k in range(n)]
    radius = [[max(matrix[k][j] for matrix in choices) - middle[k][j] for j in range(n)] for k in range(n)]
    for i, row in enumerate(inverse):
        off = lambda matrix, j, i=i, row=row: abs((i == j) - sum(c * x[j] for c, x in zip(row, matrix, strict=True)))  # noqa: E731
        bound = sum(off(middle, j) + sum(abs(c) * r[j] for c, r in zip(row, radius, strict=True)) for j in range(n))
        assert max(sum(off(matrix, j) for j in range(n)) for matrix in choices) * 2**P <= made.sums[i]
        assert bound * 2**P <= made.sums[i] <= bound * 2**P + 1 + Fraction(1, 2)  # 1/3 is no such fraction
    assert made.norm.lo == made.norm.hi == max(made.sums)


def test_an_approximate_inverse_is_one_to_most_digits_of_doubles(check, long):
    rows = [[Fraction(x) for x in row] for row in ([4, 1, 0], [-1, 3, 1], [0, "-9/8", "-7/2"])]
    made = long.Linear(system(check, rows), P)
    for i in range(3):
        for j in range(3):
            product = sum(Fraction(made.inverse[i][k], 2**64) * rows[k][j] for k in range(3))
            assert abs(product - (i == j)) < Fraction(1, 2**48)
    assert max(made.sums) < 2 ** (P - 46)


def test_an_approximate_inverse_times_intervals_is_exact_but_for_a_rounding(check, long):
    made = long.Linear.__new__(long.Linear)
    made.p, made.inverse = P, [[3 << 62, -(1 << 63), 0], [-(1 << 64), 0, 5 << 62], [1, 1, 1]]
    vector = [check.I(-5, 7, P), check.I(1, 2, P), check.I(-9, -3, P)]
    found = made.times(vector)
    assert [(x.lo, x.hi) for x in found[:2]] == [(-5, 5), (-19, 2)]
    # 3/4*[-5, 7] - 1/2*[1, 2] = [-19/4, 19/4]; -[-5, 7] + 5/4*[-9, -3] = [-73/4, 5/4]
    assert (found[2].lo, found[2].hi) == (-1, 1)


@pytest.mark.parametrize("rounds", [0, 1, 3])
def test_a_solution_holds_those_of_all_matrices_and_of_all_right_sides(check, long, rounds):
    made = long.Linear(system(check, ROWS), P)
    right = [("1/2", "9/16"), -1, 2]
    found = made.solve([number(check, x[0]).hull(number(check, x[1])) if isinstance(x, tuple) else number(check, x)
                        for x in right], rounds)  # fmt: skip
    choices = [[]]
    for row in ROWS:
        choices = [[*some, one] for some in choices for one in corners(row)]
    true = [solved(matrix, [Fraction(b), Fraction(-1), Fraction(2)]) for matrix in choices for b in right[0]]
    for k, enclosure in enumerate(found):
        low, high = min(x[k] for x in true), max(x[k] for x in true)
        assert enclosure.lo <= low * 2**P
        assert high * 2**P <= enclosure.hi
    widest = max(max(x[k] for x in true) - min(x[k] for x in true) for k in range(3))
    assert not rounds or max(x.width() for x in found) < 8 * widest * 2**P


def solved(matrix, right):
    """By Cramer's rule."""
    det = lambda m: (  # noqa: E731
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )
    put = lambda k: [[b if j == k else x for j, x in enumerate(row)] for row, b in zip(matrix, right, strict=True)]  # noqa: E731
    return [det(put(k)) / det(matrix) for k in range(3)]


def test_after_rounds_of_improvement_a_solution_has_all_digits(check, long):
    """What is left of a residual is divided by how much less than 1 the largest sum is, which is very near 1 here."""
    rows = [[Fraction(x) for x in row] for row in ([4, 1, 0], [-1, 3, 1], [0, "-9/8", "-7/2"])]
    made = long.Linear(system(check, rows), P)
    found = made.solve([number(check, x) for x in (1, -2, 3)], 4)
    assert all(holds(x, true, 16) for x, true in zip(found, solved(rows, [1, -2, 3]), strict=True))
    wide = long.Linear(system(check, [[("1/4", "7/4")]]), P)  # sums up to 3/4: x is up to 4/3 from 1 for 1, at a step
    (one,) = wide.solve([number(check, 1)], 1)
    assert one.lo / 2**P == pytest.approx(-2, rel=1e-12)  # 1 - 3/4/(1 - 3/4)
    assert one.hi / 2**P == pytest.approx(4, rel=1e-12)


@pytest.mark.parametrize(("entry", "regular"), [(("1/64", "127/64"), True), ((0, 2), False), (("-1/64", "2"), False)])
def test_a_system_is_refused_where_a_row_sum_may_be_1(check, long, entry, regular):
    rows = system(check, [[1, 0], [0, entry]])
    if regular:
        assert long.Linear(rows, P).norm.real() == pytest.approx(63 / 64, rel=1e-12)
    else:
        with pytest.raises(check.Unproved, match="a linear system may be singular"):
            long.Linear(rows, P)
