"""The checklist of a bifurcation, and stretches of contractions: each step is given what it says, and fails alone."""

import math
from dataclasses import replace
from itertools import pairwise, product
from types import SimpleNamespace

import pytest
from flint import arb
from sympy import Interval, Rational, oo

from symbolic.tables import cuspless, egg, ellipse
from verification.arithmetic.balls import balls, working
from verification.cycles.newton import refined
from verification.cycles.problem import Linearised, NormalForm, Problem
from verification.cycles.recurrence import BifurcationKind, Closure
from verification.proofs.periodic import bifurcation
from verification.proofs.periodic.bifurcation import (
    ROUNDING,
    Claim,
    OverInterval,
    Proof,
    Stability,
    over_interval,
    proved,
    twist,
)
from verification.proofs.periodic.interval_newton import Enclosure, Status, slope_bits

EGG = egg(3).at(alpha="2/25")
FLIP, FOLD = BifurcationKind.FLIP, BifurcationKind.FOLD
ZERO = [arb(0.5), arb(2), arb(0.25)]


def a_claim(problem, bits=80, digits=2):
    return Claim(problem, tuple(ZERO[: problem.period + 1]), arb(1e-3), bits, digits)


def test_a_proof_is_certified_by_all_items_and_its_value_is_the_last_unknown():
    claim = a_claim(Problem(cuspless, (1, 0), FLIP, "lam"))
    form = NormalForm(FLIP, arb(1), arb(1), arb(-1), arb(0.5))
    for values in product((True, False, None), repeat=2):
        made = Proof(claim, dict(zip("ab", values, strict=True)), Enclosure(Status.UNIQUE, ZERO), form)
        assert made.certified is (values == (True, True))
        assert made.value is ZERO[-1]
        assert made.supercritical is True
    assert replace(made, form=None).supercritical is None
    assert replace(made, form=replace(form, bend=arb(1))).supercritical is False


@pytest.fixture
def asked(monkeypatch):
    """What the steps of a checklist are asked; all of them agree."""
    given = {}

    def step(name, answer):
        def made(*arguments):
            given.setdefault(name, []).append(arguments)
            return answer

        monkeypatch.setattr(bifurcation, name, made)

    for name, answer in (("_allowed", True), ("_admissible", True), ("minimal", True), ("_form", None)):
        step(name, answer)
    given["step"] = step
    return given


def enclosed(monkeypatch, status, zero):
    monkeypatch.setattr(bifurcation, "interval_newton", lambda *_: Enclosure(status, zero))


def test_half_a_cycle_is_asked_with_its_mirror_image(monkeypatch, asked):
    half = Problem(cuspless, (0,), lam=Rational(1, 2), closure=Closure(turn=-1))
    enclosed(monkeypatch, Status.UNIQUE, [arb(0.5)])
    proved(a_claim(half))
    _, parts, zero, shape = asked["_admissible"][0]
    assert (parts, zero, shape) == ((0, 0), [arb(0.5), arb(-0.5)], ())
    assert asked["minimal"][0] == (cuspless, (0, 0), [arb(0.5), arb(-0.5)])

    enclosed(monkeypatch, Status.UNIQUE, ZERO)
    proved(a_claim(Problem(cuspless, (1, 0), FLIP, "lam")))
    assert asked["_admissible"][1][1:] == ((1, 0), ZERO[:2], ())
    assert asked["minimal"][1] == (cuspless, (1, 0), ZERO[:2])
    proved(a_claim(Problem(egg(3), (0, 0), FLIP, "alpha", Rational(1, 2))))
    assert asked["_admissible"][2][1:] == ((0, 0), ZERO[:2], (ZERO[2],))  # the shape is the last unknown
    assert [free for _, free in asked["_allowed"]] == [arb(0.5), ZERO[2], ZERO[2]]


def test_a_cycle_without_a_kind_has_no_items_of_a_normal_form(monkeypatch, asked):
    enclosed(monkeypatch, Status.UNIQUE, ZERO[:2])
    found = proved(a_claim(Problem(cuspless, (1, 0), lam=Rational(1, 2))))
    assert found.checks == dict.fromkeys(("exists", "unique", "precise", "admissible", "minimal_period"), True)
    assert found.form is None
    assert "_form" not in asked


def test_a_normal_form_is_worked_out_with_more_bits_only_where_fewer_leave_it_open(monkeypatch, asked):
    problem, few = Problem(cuspless, (1, 0), FLIP, "lam"), 2 * slope_bits(3)
    enclosed(monkeypatch, Status.UNIQUE, ZERO)
    found = proved(a_claim(problem, bits=1000))
    assert [bits for _, _, bits in asked["_form"]] == [few, 1000]
    assert {found.checks[item] for item in bifurcation._generic(None)} == {None}
    form = NormalForm(FLIP, arb(1), arb(1), arb(-1), arb(0.5))
    asked["step"]("_form", form)
    found = proved(a_claim(problem, bits=1000))
    assert [bits for _, _, bits in asked["_form"]] == [few, 1000, few]
    assert found.form is form
    assert found.certified
    enclosed(monkeypatch, Status.UNKNOWN, ZERO)
    assert proved(a_claim(problem, bits=1000)).form is None
    assert len(asked["_form"]) == 3


@pytest.mark.parametrize(
    ("radius", "digits", "precise"),
    [(1, 0, False), (0.5, 0, True), (0.5, 1, False), (2, 0, False), (0.009, 2, True), (0.011, 2, False)],
)
def test_a_value_is_precise_where_its_radius_is_below_the_last_digit(monkeypatch, asked, radius, digits, precise):
    enclosed(monkeypatch, Status.UNIQUE, [*ZERO[:2], arb(0.25, radius)])
    assert proved(a_claim(Problem(cuspless, (1, 0), FLIP, "lam"), digits=digits)).checks["precise"] is precise
    assert len(asked["_admissible"]) == 1
    asked["step"]("_allowed", False)
    assert proved(a_claim(Problem(cuspless, (1, 0), FLIP, "lam"))).checks["admissible"] is None


@pytest.mark.parametrize(("status", "exists"), [(Status.EMPTY, False), (Status.UNKNOWN, None)])
def test_of_a_box_without_a_proved_zero_nothing_else_is_told(monkeypatch, asked, status, exists):
    enclosed(monkeypatch, status, ZERO)
    found = proved(a_claim(Problem(cuspless, (1, 0), FLIP, "lam")))
    assert (found.checks.pop("exists"), found.checks.pop("unique")) == (exists, exists)
    assert set(found.checks.values()) == {None}
    assert not {"_admissible", "minimal", "_form"} & set(asked)


@pytest.mark.parametrize("parts", [1, 2])
@pytest.mark.parametrize("measured", [False, True])
@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("placed", [False, True])
def test_a_law_is_asked_beyond_the_ends_only_where_a_whole_turn_leaves_it_as_it_is(
    monkeypatch, parts, measured, periodic, placed
):
    """Of arc length on one component all the box is asked, for its equations are of another law beyond."""
    told, given = {}, []
    monkeypatch.setattr(bifurcation, "is_periodic", lambda phi: periodic)
    monkeypatch.setattr(bifurcation, "inside", lambda *asked: given.append(asked) or told["inside"])
    monkeypatch.setattr(bifurcation, "convex", lambda *asked: given.append(asked) or told["convex"])
    monkeypatch.setattr(bifurcation, "first_hits", lambda *asked: given.append(asked) or told["first_hits"])
    law = SimpleNamespace(measured=measured, placed=placed, phi=None)
    table = SimpleNamespace(components=(1,) * parts)
    claim = Claim(SimpleNamespace(law=law, table=table, period=2), (arb(1), arb(2), arb(3)), arb(0.5), 80, 2)
    whole, shape = [arb(1, 0.1), arb(2, 0.1)], (arb(0.25),)
    box = [arb(1, 0.5), arb(2, 0.5)] if measured and parts == 1 else whole
    for place, bends, hits in product((True, False, None), (True, None), (True, None)):
        told |= {"inside": place, "convex": bends, "first_hits": hits}
        found = bifurcation._admissible(claim, (0, 0), whole, shape)
        assert found is (place if place is not True or bends else hits)
        (_, parts_, at, shape_, turns), *rest = given
        same = lambda xs, ys: all(x.mid() == y.mid() and x.rad() == y.rad() for x, y in zip(xs, ys, strict=True))  # noqa: E731
        assert (parts_, shape_, turns) == ((0, 0), shape, (periodic and not measured) or not placed)
        assert same(at, box)
        assert len(rest) == (0 if place is not True else 1 if bends else 2)
        if len(rest) == 2:
            assert rest[0] == (table, shape)
            assert rest[1][1] == (0, 0)
            assert same(rest[1][2], box)
            assert rest[1][3] == shape
        given.clear()


@pytest.mark.parametrize(
    ("range", "allowed", "off"),
    [
        ((0, Rational(1, 10)), ["0", "0.05"], ["-1e-9", "0.2", "0.1 +/- 0.01", "nan"]),
        ((0, oo), ["0", "1e20"], ["-1e-9"]),
        ((-oo, 2), ["-1e20", "2"], ["2.1"]),
        ((-oo, oo), ["0", "1e20"], []),
    ],
)
def test_a_shape_is_allowed_in_its_range_also_where_that_has_no_end(range, allowed, off):
    made = SimpleNamespace(symbol=SimpleNamespace(name="b"), range=Interval(*range))
    problem = SimpleNamespace(free="b", table=SimpleNamespace(shapes=(made,)))
    assert all(bifurcation._allowed(problem, arb(x)) for x in allowed)
    assert not any(bifurcation._allowed(problem, arb(x)) for x in off)
    letter = SimpleNamespace(free="c", table=SimpleNamespace(shapes=(made,)))
    assert bifurcation._allowed(letter, arb(5))  # of a law, which has no range
    contraction = SimpleNamespace(free="lam", table=SimpleNamespace(shapes=()))
    assert [bifurcation._allowed(contraction, arb(x)) for x in ("0", "1", "-0.1", "1.1")] == [True, True, False, False]


@pytest.mark.parametrize("signs", list(product((1, -1), repeat=4)))
def test_a_diameter_doubles_supercritically_where_bend_and_turn_differ_in_sign(monkeypatch, signs):
    """`turn = -(1 - lam**2)*u0*u1/d0`: of all signs of bend, u0, u1 and d0; and of none of what may be 0."""
    given = []

    def made(bend, upper, diagonal):
        def linearised(problem, words, z):
            given.append((problem, z))
            plain = SimpleNamespace(upper=upper, diagonal=diagonal)
            return SimpleNamespace(plain=plain, normal_form=lambda words: SimpleNamespace(bend=bend))

        monkeypatch.setattr(bifurcation, "Linearised", linearised)
        return bifurcation._supercritical(3, arb(0.5), arb(0.02))

    bend, u0, u1, d0 = map(arb, signs)
    assert made(bend, [u0, u1], [d0, arb(7)]) is (math.prod(signs) > 0)
    problem, z = given[0]
    assert (problem.lam, problem.free, problem.kind, problem.components) == (arb(0.5), "alpha", FLIP, (0, 0))
    assert z[0] == 0
    assert z[1].overlaps(arb.pi())
    assert z[2] == arb(0.02)
    for unknown in (arb(0, 1), arb(0), arb("nan")):
        assert made(unknown, [u0, u1], [d0]) is False
        assert made(bend, [unknown, u1], [d0]) is False
        assert made(bend, [u0, u1], [unknown]) is False


def test_where_a_chain_of_a_diameter_is_singular_nothing_is_said_of_its_doubling(monkeypatch):
    def singular(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(bifurcation, "Linearised", singular)
    assert bifurcation._supercritical(3, arb(0.5), arb(0.02)) is False


def test_a_doubling_curve_is_asked_piece_by_piece_until_all_of_it_is_covered(monkeypatch):
    """Pieces that are proved once they are short; those about one contraction never are."""
    asked, told = [], []

    def short(K, lam, alpha):
        asked.append((lam, alpha))
        return bool(lam.rad() < 0.13)

    monkeypatch.setattr(bifurcation, "_supercritical", short)
    monkeypatch.setattr(bifurcation, "load", lambda kernel, words: lambda lam: [lam + 1])
    found = bifurcation.doubling_curve(tick=told.append)
    assert found == bifurcation.Sign(True, 7)  # 1 + 2 + 4 pieces
    assert told == [0.25] * 4
    small = sorted(float(lam.mid()) for lam, _ in asked if lam.rad() < 0.13)
    assert small == [0.125, 0.375, 0.625, 0.875]
    assert all((alpha - 1).overlaps(lam) and alpha.rad() >= lam.rad() for lam, alpha in asked)
    assert bifurcation.doubling_curve(budget=6).supercritical is None
    assert bifurcation.doubling_curve(budget=7).supercritical is True
    for hole in (0.0, 0.3, 1.0):
        monkeypatch.setattr(bifurcation, "_supercritical", lambda K, lam, alpha, hole=hole: not lam.overlaps(arb(hole)))
        assert bifurcation.doubling_curve().supercritical is None


@pytest.mark.parametrize(("shortest", "proved"), [(2.0**-40, True), (2.0**-41, None)])
def test_pieces_of_a_curve_are_halved_until_they_are_too_short(monkeypatch, shortest, proved):
    """About one contraction only a piece is proved that reaches no further than `shortest`."""
    short = lambda K, lam, alpha: not lam.overlaps(arb(0.3)) or bool(lam.rad() <= shortest * 1.0001)  # noqa: E731
    monkeypatch.setattr(bifurcation, "_supercritical", short)
    monkeypatch.setattr(bifurcation, "load", lambda kernel, words: lambda lam: [lam])
    assert bifurcation.doubling_curve(budget=400).supercritical is proved


@pytest.mark.parametrize("ends", [(0.25, 0.75), (0.9, 0.5), (0.0, 0.001)])
@pytest.mark.parametrize("hole", [None, 0.3125, 0.6])
@pytest.mark.parametrize("wanted", [Stability.ATTRACTING, Stability.SADDLE])
def test_the_steps_of_a_stretch_cover_it_up_to_what_is_not_proved(monkeypatch, ends, hole, wanted):
    """A cycle of which nothing but one contraction is in the way; it moves by twice and once as much as that."""
    proved_of, told, halves = [], [], [(ends[1] - ends[0]) / 16 / 1.3 / 2]

    def asked(table, components, theta, middle, half, radii):
        assert theta == pytest.approx([2 * middle, -middle])
        assert all(r >= half * rate for r, rate in zip(radii, (2, 1), strict=True)) or not proved_of
        refused = len(halves) > 1 and halves[-1] > 0
        wanted_half = abs(halves[-1]) * (0.5 if refused else 1.3)
        assert half == pytest.approx(min(wanted_half, abs(ends[1] - middle)), rel=1e-6)
        halves.append(half)
        if half > 0.05 or (hole is not None and abs(hole - middle) <= half):
            return Stability.UNKNOWN
        halves[-1] = -half
        proved_of.append((middle - half, middle + half))
        return wanted

    monkeypatch.setattr(bifurcation, "Problem", lambda table, components, lam: lam)
    monkeypatch.setattr(bifurcation, "floats", lambda lam, start: [2 * float(lam), -float(lam)])
    monkeypatch.setattr(bifurcation, "_proved", asked)
    found = over_interval(None, (0, 0), [0.0, 0.0], ends, wanted, tick=told.append)
    low, high = min(ends), max(ends)
    whole = hole is None or not low <= hole <= high
    assert found.proved is whole
    reached = sorted(proved_of)
    assert all(abs(b[0] - a[1]) < 1e-15 for a, b in pairwise(reached))
    begun, done = (reached[0][0], reached[-1][1]) if ends[0] < ends[1] else (reached[-1][1], reached[0][0])
    assert begun == pytest.approx(ends[0], abs=1e-15)
    assert done == pytest.approx(found.reached, abs=1e-15)
    assert found.reached == pytest.approx(ends[1] if whole else hole, abs=1e-8)
    assert sum(told) == pytest.approx(abs(found.reached - ends[0]) / (high - low))
    assert min(told) > 0
    assert found.balls >= len(reached)


def test_a_stretch_ends_with_its_budget_or_where_no_step_is_long_enough(monkeypatch):
    monkeypatch.setattr(bifurcation, "Problem", lambda table, components, lam: lam)
    monkeypatch.setattr(bifurcation, "floats", lambda lam, start: [float(lam)])
    monkeypatch.setattr(bifurcation, "_proved", lambda *_: Stability.SADDLE)
    assert over_interval(None, (0,), [0.0], (0.0, 1.0), Stability.SADDLE, budget=3).proved is False
    assert over_interval(None, (0,), [0.0], (0.0, 1.0), Stability.SADDLE).proved is True
    other = over_interval(None, (0,), [0.0], (0.0, 1.0), Stability.ATTRACTING)
    assert (other.proved, other.reached) == (False, 0.0)
    assert over_interval(None, (0,), [0.0], (0.5, 0.5), Stability.SADDLE) == OverInterval(True, 0.5, 0)

    def lost(lam, start):
        if lam > 0.5:
            raise ValueError
        return [float(lam)]

    monkeypatch.setattr(bifurcation, "floats", lost)
    found = over_interval(None, (0,), [0.0], (0.0, 1.0), Stability.SADDLE)
    assert found.proved is False
    assert 0.5 < found.reached + 1e-8 < 1.0


STEPS = ["over", "at", "convex", "inside", "minimal", "_slopes", ""]


@pytest.mark.parametrize("fails", STEPS)
def test_a_step_along_contractions_needs_each_of_its_proofs(monkeypatch, fails):
    """Its trace and determinant are those at the middle, and their slopes times how far a contraction is from it."""
    statuses = [Status.UNKNOWN if fails == name else Status.UNIQUE for name in ("over", "at")]
    zeros = [[arb(1, 0.1)], [arb(1)]]
    calls, judged = [], []

    def krawczyk(problem, centre, radii, bits):
        calls.append((problem, centre, radii))
        k = len(calls) - 1
        return Enclosure(statuses[k], zeros[k])

    monkeypatch.setattr(bifurcation, "krawczyk", krawczyk)
    monkeypatch.setattr(bifurcation, "convex", lambda table: None if fails == "convex" else True)
    monkeypatch.setattr(bifurcation, "inside", lambda table, parts, zero: fails != "inside" and zero is zeros[0])
    monkeypatch.setattr(bifurcation, "minimal", lambda table, parts, zero: fails != "minimal" and zero is zeros[0])
    monkeypatch.setattr(bifurcation, "_slopes", lambda *_: None if fails == "_slopes" else (arb(3), arb(-5)))
    monkeypatch.setattr(bifurcation, "trace_and_determinant", lambda rows: (arb(0.5), arb(0.25)))
    made = SimpleNamespace(terms=SimpleNamespace(rows=()))
    monkeypatch.setattr(bifurcation, "Linearised", lambda problem, words, z: made if z is zeros[1] else None)
    monkeypatch.setattr(bifurcation, "stability", lambda *found: judged.append(found) or Stability.SADDLE)
    found = bifurcation._proved(EGG, (0,), [1.0], 0.5, 0.125, [0.1])
    assert found is (Stability.UNKNOWN if fails else Stability.SADDLE)
    wide, thin = (problem.lam for problem, *_ in calls)
    assert thin == 0.5
    assert wide.rad() >= 0.125 + ROUNDING * (1 - 1e-6)
    assert not wide.contains(arb(0.5 + 0.1251))
    if not fails:
        ((trace, determinant),) = judged
        assert trace.contains(arb(0.5) + arb(0.375))
        assert determinant.contains(arb(0.25) - arb(0.625))
        assert trace.rad() < 0.376
        assert determinant.rad() < 0.626


def test_slopes_along_a_cycle_are_those_of_neighbouring_contractions():
    """By differences of trace and determinant at solutions of 30 digits."""
    step, found = Rational(1, 10**8), []
    near = [1.05, 3.14, 5.24]
    with working(100):
        for lam in (Rational(1, 2) - step, Rational(1, 2), Rational(1, 2) + step):
            z = [arb(str(x)) for x in refined(Problem(EGG, (0, 0, 0), lam=lam), near, 30).z]
            ball = arb(lam.p) / lam.q
            thin = Problem(EGG, (0, 0, 0), lam=ball)
            rows = Linearised(thin, balls(100), z).terms.rows
            found.append(bifurcation.trace_and_determinant(rows))
            if lam == Rational(1, 2):
                slopes = bifurcation._slopes(thin, z)
        for k in range(2):
            difference = (found[2][k] - found[0][k]) / (2 * arb(step.p) / step.q)
            assert abs(difference - slopes[k]) < 1e-6 * abs(slopes[k])


def test_the_twist_of_the_axis_of_an_ellipse_is_the_same_begun_at_either_end():
    """Its trace is `4*(1 - 2/a**2)**2 - 2`, of the minor axis; the area that a map keeps makes the drift 0."""
    with working(100):
        ends = [-arb.pi() / 2, arb.pi() / 2]
        made = [twist(ellipse.at(a=3), (0, 0), way, 100) for way in (ends, ends[::-1])]
        assert all((81 * each.trace).contains(34) for each in made)
        assert all(each.drift.contains(0) and each.drift.rad() < 1e-20 for each in made)
        assert abs(made[0].twist - made[1].twist) < 1e-20
        assert not made[0].twist.contains(0)
