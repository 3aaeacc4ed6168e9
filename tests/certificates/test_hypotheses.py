"""Each hypothesis of the theorems that the independent checker uses: where it fails, nothing is proved."""

import random
from fractions import Fraction
from types import SimpleNamespace

import pytest
from committed import document


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
    """A round `(x, y) -> (m*x + cubic*x**3, other*y)` with `m` 1 or -1, in intervals.

    The coordinates are `x + 2*y` and `x + 3*y`, for which the matrix has four entries.
    """
    number = lambda text: check.I.of(Fraction(text), 100).wide(check.I.of(Fraction(1, 2**80), 100))  # noqa: E731
    u, v = (check.Jet.of(number("0"), 1, k) for k in (0, 1))
    x, y = (u * 3 - v * 2) * number("1" if kind == "fold" else "-1"), (v - u) * number(other)
    cycle = SimpleNamespace(p=100, sign=1, kind=kind)
    cycle.run = lambda *given: [None, None, (x + y * 2, x + y * 3)] if given == (image, 1) else None
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
    """The system `x - zero`, in one of three unknowns, over [-1, 1]: a zero at an end, or beyond, is not proved."""
    box = [check.I.of(-1, 60).hull(check.I.of(1, 60))] * 3

    def line(x, d):
        return [check.Jet.of(v, d, k) - Fraction(zero) * (k == unknown) for k, v in enumerate(x)]

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
    scene = {"polar": radius, "lam": "1/3"} | ({"law": law} if law else {})

    assert check.read_scene(scene, "", 60)[0].closed == [closed]


def test_a_fold_names_what_varies(check):
    given = document("saddle-node")
    for free in ("", 3, ["lam"], None):
        with pytest.raises(check.Wrong, match=r"free, radius or centre is out of range|free must be of type string"):
            check.checked(given | {"free": free})


def test_interval_newton_encloses_the_zero_of_any_three_equations_that_are_independent(check):
    """`A*x = A*zero` plus squares that vanish there, for random matrices; with two equal rows nothing is proved."""
    chance, p = random.Random(1), 100
    box = [check.I.of(-1, p).hull(check.I.of(1, p))] * 3
    for turn in range(20):
        rows = [[Fraction(chance.randint(-2, 2), 10) + 4 * (i == k) for k in range(3)] for i in range(3)]
        chance.shuffle(rows)
        rows[0] = rows[1] if turn % 4 == 3 else rows[0]
        zero = [Fraction(chance.randint(-9, 9), 20) for _ in range(3)]

        def equations(x, d, rows=rows, zero=zero):
            off = [check.Jet.of(v, d, k) - zero[k] for k, v in enumerate(x)]
            return [
                sum((y * a for y, a in zip(off, row, strict=True)), off[0] * off[0] * Fraction(1, 50)) for row in rows
            ]

        if turn % 4 == 3:
            with pytest.raises((check.Unproved, ZeroDivisionError)):
                check.newton(equations, box, p)
            continue
        for x, image in zip(zero, check.newton(equations, box, p), strict=True):
            assert image.lo <= x * 2**p <= image.hi
            assert image.width() < 2**p / 4


@pytest.mark.parametrize("spare", ["0", "1/50", "-1/50"])
@pytest.mark.parametrize("turn", range(6))
def test_the_coefficient_of_a_doubling_is_found_in_any_coordinates(check, turn, spare):
    """For `(x, y) -> (-x + a*x**2 + b*x*y + c*x**3, m*y + d*x**2)` it is `c + a**2 + b*d/(1 - m)`.

    This follows on the invariant curve `y = h*x**2`, `h = d/(1 - m)`. A matrix changes the coordinates.
    """
    chance, p = random.Random(turn), 120
    a, b, d, m = (Fraction(chance.randint(1, 9), 10) * chance.choice([-1, 1]) for _ in range(4))
    c = Fraction(spare) - a * a - b * d / (1 - m)
    known = {0: ((1, 0), (0, 1)), 1: ((0, 1), (1, 0))}  # where entries of a row and of a column vanish
    known |= {4: ((1, 0), (2, 1)), 5: ((1, 2), (0, 1))}
    (q, r), (s, t) = known.get(turn) or ((chance.randint(1, 3), 1), (-1, chance.randint(1, 3)))
    det = Fraction(q * t - r * s)
    number = lambda x: check.I.of(Fraction(x), p).wide(check.I.of(Fraction(1, 2**100), p))  # noqa: E731

    def around(u, v):
        x, y = u * q + v * r, u * s + v * t
        x, y = x * x * a + x * y * b + x * x * x * number(c) - x, y * m + x * x * d
        return (x * t - y * r) * (1 / det), (y * q - x * s) * (1 / det)

    image = [check.I.of(0, p)] * 3
    cycle = check.Cycle.__new__(check.Cycle)
    cycle.p, cycle.sign, cycle.kind, cycle.way, cycle.names = p, 1, "flip", [], lambda letter: {}
    cycle.run = lambda at, d: [None, None, around(*(check.Jet.of(at[k], d, k) for k in (0, 1)))]
    launched = lambda launch, at, d: around(*launch(*(check.Jet.of(x, d, k) for k, x in enumerate(at)))[:2])  # noqa: E731
    cycle.table = SimpleNamespace(orbit=lambda launch, at, way, d, states: [None, None, launched(launch, at, d)])

    if spare == "0":
        with pytest.raises(check.Unproved, match="nondegenerate"):
            cycle.generic(image)
    else:
        cycle.generic(image)


@pytest.mark.parametrize(
    ("psi", "arrives"),
    [("0", True), ("1/2", True), ("-1", True), ("3", False), ("-3", False), ("7", False), ("31/5", False)],
)
def test_a_flight_runs_forwards_from_the_inward_side_and_its_angle_is_named_once(check, psi, arrives):
    """In the circle it lands opposite minus two angles; a backward line or an angle with another turn is refused."""
    p, scene = 100, {"polar": "1 + 0*cos(theta)", "lam": "1/3"}
    table, lam, _ = check.read_scene(scene, "", p)
    names = table.letters | {"lam": lam}
    launched = Fraction(psi)
    start = [check.Jet.of(check.I.of(x, p), 1, k) for k, x in enumerate((Fraction(1, 3), launched))]
    turn = {"7": 44, "31/5": 44}.get(psi, 0)  # a whole turn is 44/7, nearly
    near = check.I.of(Fraction(1, 3) + Fraction(22, 7) - 2 * (launched - Fraction(turn, 7)), p).wide(
        check.I.of(Fraction(1, 100), p)
    )

    def landed():
        return table.flight(0, (0, near), start, names)

    if arrives:
        theta, psi1 = landed()
        for found, truth in (
            (theta, check.pi(p) + Fraction(1, 3) - launched * 2),
            (psi1, check.I.of(launched, p) * Fraction(1, 3)),
        ):
            off = check.value(found) - truth
            assert 0 in off
            assert off.width() < 2 ** (p - 60)
    else:
        with pytest.raises(check.Unproved, match="may not arrive from inside"):
            landed()


@pytest.mark.parametrize(
    ("entry", "accepted", "refused"),
    [
        ("bits", [16, 16_000], [15, 200_000, 200_001]), ("digits", [1, 60_000], [0, 60_001]),
        ("radius", [["1", "0"], ["1", "-16000"]], [["2", "0"], ["1", "-16400"], ["1", "-500000"], ["0", "0"]]),
        ("components", [[0] * 1024], [[0] * 1025]), ("mirror", [False, True], [0, None]), ("free", [""], ["lam", "a"]),
        ("centre", [[["999999", "0"]] * 2], [[["1000000", "0"]] * 2, [["-1000000", "0"]] * 2]),
    ],
)  # fmt: skip
def test_an_entry_at_the_end_of_its_range_is_read_on_and_one_beyond_it_is_not(check, entry, accepted, refused):
    """Documents with entries in range are refused later, for their statement."""
    given = document("minor-axis") | {"statement": "so"}
    for value in accepted:
        with pytest.raises(check.Wrong, match=r"the statement must be|do not fit"):
            check.checked(given | {entry: value})
    for value in refused:
        with pytest.raises(check.Wrong, match=r"out of range|up to 16384 bits|too many digits|not of its format"):
            check.checked(given | {entry: value})


@pytest.mark.parametrize(
    "change",
    [{"scene": {"table": "circle"}}, {"components": [0, 1]}, {"components": [0, 0, 0]}, {"mirror": False},
     {"scene": {"table": "cuspless", "law": "-lam*eta"}}, {"free": "alpha"}],
    ids=str,
)  # fmt: skip
def test_the_corner_orbit_is_one_of_the_cuspless_cardioid_and_closed_by_its_mirror(check, change):
    given = document("lambda-star")
    with pytest.raises(check.Wrong, match=r"do not fit|out of range"):
        check.checked(given | change)


TURNS = ["1/3", "1/3+2", "1/3+4"]


@pytest.mark.parametrize(
    ("table", "what", "bounces", "sign", "name"),
    [
        ("egg", ("fold", "lam"), TURNS, 1, "saddle-node"),
        ("egg", ("fold", "lam"), ["1/3", "2/3+2", "1/3+4"], 1, "fold of a cycle of period 3 in lam: title"),
        ("egg", ("fold", "lam"), TURNS, -1, "fold of half of a symmetric cycle, of period 3 in lam: title"),
        ("egg", ("flip", "lam"), TURNS, 1, "flip of a cycle of period 3 in lam: title"),
        ("cuspless", ("flip", "lam"), ["0", "0"], 1, "lambda-c"),
        ("cuspless", ("flip", "lam"), ["0", "1/9"], 1, "flip of a cycle of period 2 in lam: title"),
        ("cuspless", ("flip", "lam"), ["0", "0"], -1, "flip of half of a symmetric cycle, of period 2 in lam: title"),
        ("egg", ("flip", "alpha"), ["0", "3"], 1, "alpha-tilde"),
        ("egg", ("flip", "alpha"), ["1", "3"], 1, "flip of a cycle of period 2 in alpha: title"),
        ("egg", ("focus", "alpha"), ["0", "3"], 1, "alpha-hat"),
        ("ellipse", ("flip", "alpha"), ["0", "3"], 1, "flip of a cycle of period 2 in alpha: title"),
        ("egg", ("cycle", ""), ["0", "3"], 1, "a cycle of period 2: title"),
    ],
)
def test_a_value_has_its_name_by_symmetry_and_any_other_by_what_is_stated(check, table, what, bounces, sign, name):
    """Bounces `+2` and `+4` are two and four thirds of pi further, `3` is pi."""
    p = 100
    third = lambda text: [part.strip() for part in (text + "+0").split("+")[:2]]  # noqa: E731
    at = [check.I.of(Fraction(a), p) + check.pi(p) * Fraction(int(b), 3) for a, b in map(third, bounces)]
    at = [check.pi(p) if text == "3" else x for text, x in zip(bounces, at, strict=True)]
    boxes = [x.wide(check.I.of(Fraction(1, 2**20), p)) for x in at]
    for scene, wanted in (
        ({"table": table}, name),
        ({"table": table, "law": "-lam*eta"}, None),
        ({"table": table, "K": 5}, None),
    ):
        found = check.named(what[0], sign, [0] * len(at), at, boxes, scene, what[1], "title", p)
        assert found == (wanted or found)
        assert wanted is not None or found.endswith("title")
