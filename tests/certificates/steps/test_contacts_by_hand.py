"""Steps of the second reader's tangencies, each by itself: frames, graphs under a round, equations of a contact."""

from fractions import Fraction
from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import by_hand
import pytest
from by_hand import number

P = 100
holds = partial(by_hand.holds, units=16)


@pytest.fixture(scope="module")
def tangency(check):
    return check.beside("tangency")


def framed(check, tangency, own):
    """A frame with its middle at (3/2, -2/3), which moves by (5, -7) with lam from 1/2 on, leaning by 1/4 and -1/2."""
    side = tangency.Manifold.__new__(tangency.Manifold)
    side.own, side.other, side.lam = own, 1 - own, number(check, "1/2")
    side.zero, side.drift = [number(check, "3/2"), number(check, "-2/3")], [number(check, 5), number(check, -7)]
    side.along, side.across = number(check, "1/4"), number(check, "-1/2")
    side.table = SimpleNamespace(p=P, letters={"b": "a letter"})
    side.w = [number(check, k) for k in (11, 12, 13, 14, 15)]
    return side


@pytest.mark.parametrize("own", [0, 1])
def test_a_frame_leans_and_moves_with_lam_and_coordinates_in_it_are_those_that_it_was_made_of(check, tangency, own):
    side, lam = framed(check, tangency, own), number(check, "3/4")
    along, across = number(check, "1/3"), number(check, "-2/5")
    letters = (across, along, lam) if own else (along, across, lam)
    theta, psi, names = side.launch(*letters)
    zero = Fraction(3, 2) + Fraction(5, 4), Fraction(-2, 3) - Fraction(7, 4)
    assert all(holds(x, true) for x, true in zip(side.centred(lam), zero, strict=True))
    assert holds(theta, zero[0] + Fraction(1, 3) + Fraction(1, 2) * Fraction(2, 5))
    assert holds(psi, zero[1] + Fraction(1, 4) * Fraction(1, 3) - Fraction(2, 5))
    assert all(holds(x, true, units=64) for x, true in zip(side.framed(theta, psi, lam), ("1/3", "-2/5"), strict=True))
    assert names["b"] == "a letter"
    assert names["lam"] is lam
    assert set(names) == ({"b", "lam", "1/lam"} if own else {"b", "lam"})
    assert not own or holds(names["1/lam"], "4/3")
    x = number(check, 1)
    assert side.boxes(x, lam) == ([side.w[0], x, lam] if own else [x, side.w[0], lam])


@pytest.mark.parametrize("own", [0, 1])
def test_a_jet_along_a_manifold_has_its_derivatives_whichever_letter_it_is_over(check, tangency, own):
    """`f(x, w(x, lam), lam)` by the chain rule; of the other letter nothing is left."""
    side = framed(check, tangency, own)
    _, wx, wl, wxx, wxl = numbers = [Fraction(k, 7) for k in (0, 2, -3, 5, 4)]
    side.w = [number(check, x) for x in numbers]
    exponents, at = check.algebra(2)[0], check.algebra(2)[1]
    f = {e: Fraction(k * k - 9, 5) for k, e in enumerate(exponents)}
    found = side.on(check.Jet([number(check, f[e]) for e in exponents], 2))
    turned = lambda a, b, c: (b, a, c) if own else (a, b, c)  # noqa: E731
    g = lambda *e: f[turned(*e)]  # noqa: E731
    wanted = dict.fromkeys(exponents, Fraction(0)) | {
        turned(0, 0, 0): g(0, 0, 0),
        turned(1, 0, 0): g(1, 0, 0) + g(0, 1, 0) * wx,
        turned(0, 0, 1): g(0, 0, 1) + g(0, 1, 0) * wl,
        turned(2, 0, 0): g(2, 0, 0) + g(1, 1, 0) * wx + g(0, 2, 0) * wx**2 + g(0, 1, 0) * wxx,
        turned(1, 0, 1): g(1, 0, 1) + g(1, 1, 0) * wl + g(0, 1, 1) * wx + 2 * g(0, 2, 0) * wx * wl + g(0, 1, 0) * wxl,
    }
    del wanted[0, 0, 2]  # second derivatives by lam alone are not known
    assert found.degree == 2
    assert len(found.c) == 10
    assert all(holds(check.I.of(found.c[at[e]], P), true, units=64) for e, true in wanted.items())


def test_a_polynomial_with_jets_for_its_letters_is_the_polynomial_of_them(check, tangency):
    """`3 - 2*x*y + 5*z**2` at `x = 1 + 2*e`, `y = e - 3*e**2`, `z = 7*e`."""
    at = check.algebra(2)[1]
    f = check.Jet([{(0, 0, 0): 3, (1, 1, 0): -2, (0, 0, 2): 5}.get(e, 0) for e in check.algebra(2)[0]], 2)
    e = check.Jet.of(number(check, 0), 3, 0)
    found = tangency.composed(f, [e * 2 + 1, e - e * e * 3, e * 7])
    wanted = [3, -2, 245 + 2, 12]  # -2*(1 + 2*e)*(e - 3*e**2) = -2*e + 2*e**2 + 12*e**3
    assert found.degree == 3
    assert at[0, 0, 0] == 0
    assert all(holds(check.I.of(found.c[check.algebra(3)[1][k, 0, 0]], P), true) for k, true in enumerate(wanted))


BOUNDS = "1/1000", "1/20", "1/10", "1/5", "1/10"  # of w, w_x, w_lam, w_xx/2 and w_x_lam
FRAME = ["3/2", "-2/3", "1/4", "-1/2"]


def pair(x):
    """As a certificate writes a number, to 2**-100."""
    return [str(round(Fraction(x) * 2**P)), str(-P)]


def manifold(check, tangency, map, back, bounds=BOUNDS, reach="1/100", inner="1/250", saddle=("3/2",), calls=None):
    """What is proved of the manifold at the middle of the leaning frame of a map that is given in its coordinates."""
    given = {"bounces": [pair(x) for x in saddle], "frame": [pair(x) for x in FRAME], "drift": [pair(0), pair(0)]}
    given |= {"range": [pair(reach), pair(inner)], "bounds": [pair(x) for x in bounds]}
    lam = number(check, "1/2").wide(number(check, Fraction(1, 10**6)))

    def orbit(launch, boxes, way, d, view):
        letters = [check.Jet.of(box, d, k) for k, box in enumerate(boxes)]
        start = launch(*letters)[:2]
        if calls is not None:
            calls.append((boxes, way, d))
            seen = [check.value(x).mid().real() for x in view(*start, letters[2])]
            assert seen == pytest.approx([0, 0], abs=1e-12)  # in the frame
        last = map(letters[back], letters[1 - back], letters[2] - Fraction(1, 2))
        return [start, *([start] * (len(way) - 2)), last]

    table = SimpleNamespace(p=P, letters={}, orbit=orbit)
    return tangency.Manifold(table, given, lam, back)


def plane(a=3, b="1/4", d="1/2", bend=0, moved=0, pushed=0):
    """`x -> a*x + b*y + pushed*lam`, `y -> d*y + bend*x**2 + moved*lam`, `lam` from its middle on."""
    a, b, d, bend, moved, pushed = map(Fraction, (a, b, d, bend, moved, pushed))
    return lambda x, y, lam: (x * a + y * b + lam * pushed, y * d + x * x * bend + lam * moved)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(
    ("shape", "changed", "item"),
    [
        ({}, {}, None),
        ({}, {"inner": "1/100"}, None),  # as far as anything is known
        ({}, {"inner": Fraction(1, 100) + Fraction(1, 2**100)}, "saddle"),
        ({"a": "2/3", "d": "1/4"}, {"reach": "-1/250", "inner": "-1/200"}, "saddle"),  # below 0 nothing expands
        ({"bend": 1}, {}, None),
        ({"bend": 1}, {"bounds": (*BOUNDS[:3], "1/10", "1/10")}, "remainder"),
        ({"moved": "3/50"}, {}, "remainder"),
        ({"d": "11/10"}, {}, "remainder"),
        ({"a": "12/5"}, {}, "saddle"),
        ({"a": "3/2", "d": "1/4"}, {"inner": "7/1000"}, None),  # an expansion by less than 2 is one
        ({"b": 0}, {"inner": "0.0033334"}, None),
        ({"b": 0, "pushed": "1/2"}, {"inner": "0.0033334"}, "saddle"),
        ({"d": "19/20", "b": "1/2"}, {}, None),
        ({"d": "19/20", "b": "11/10"}, {}, "saddle"),
        ({"d": "1", "b": 0}, {"bounds": BOUNDS}, "remainder"),
    ],
    ids=str,
)
def test_in_a_frame_that_leans_and_with_time_running_back_the_same_is_proved(
    check, tangency, back, shape, changed, item
):
    if item is None:
        manifold(check, tangency, plane(**shape), back, **changed)
    else:
        with pytest.raises(check.Unproved, match=item):
            manifold(check, tangency, plane(**shape), back, **changed)


@pytest.mark.parametrize("back", [False, True])
def test_a_round_is_followed_over_the_inner_range_and_at_its_middle(check, tangency, back):
    """Twice: along bounces within 1/1000 of those of the file, back to the first; the chord's states are kept."""
    calls = []
    side = manifold(check, tangency, plane(), back, saddle=("3/2", "5/2", "7/2"), calls=calls)
    assert [d for *_, d in calls] == [2, 1]
    for boxes, way, _ in calls:
        assert [part for part, _ in way] == [0] * 4
        assert way[0] == way[-1]
        for (_, near), middle in zip(way, ("3/2", "5/2", "7/2"), strict=False):
            assert abs(near.real() - float(Fraction(middle))) < 1e-12
            assert near.width() / 2**P == pytest.approx(2 / 1000, rel=1e-12)
        assert boxes[1 - back] is side.w[0]
        assert boxes[2].mid().real() == 0.5
    assert (calls[0][0][back].lo, calls[0][0][back].hi) == pytest.approx((-(2**P) / 250, 2**P / 250), rel=1e-12)
    assert calls[1][0][back].lo == calls[1][0][back].hi == 0
    assert len(side.states) == 3
    assert side.reach.real() == pytest.approx(1 / 100)
    assert [x.hi / 2**P for x in side.w] == pytest.approx([float(Fraction(x)) for x in BOUNDS])
    assert [x.lo / 2**P for x in side.w] == pytest.approx([-float(Fraction(x)) for x in BOUNDS])
    assert isinstance(side.table, tangency.Back) == back
    assert (side.own, side.other) == (int(back), int(not back))


@pytest.mark.parametrize("back", [False, True])
def test_the_derivatives_of_a_graph_a_round_later_are_those_of_the_chain_rule(check, tangency, monkeypatch, back):
    """By hand, of the graph 0 of a map with all terms: `W_X = s/a`, `W_lam = m - W_X*push`,
    `W_XX = (2*q*a - 2*s*c)/a**3` and `W_X_lam = (v*a - s*e)/a**2 - W_XX*push`."""
    a, c, e, push, s, q, v, m = map(Fraction, ("3", "5", "7", "2/3", "1/2", "11", "13", "1/5"))
    bent = lambda x, y, lam: (  # noqa: E731
        x * a + x * x * c + x * lam * e + lam * push + y * 0,
        x * s + x * x * q + x * lam * v + lam * m + y * 0,
    )
    asked = []
    monkeypatch.setattr(check.I, "inside", lambda self, other: asked.append(self) or True)
    tiny = Fraction(1, 2**80)
    with pytest.raises(check.Unproved, match="saddle"):
        manifold(check, tangency, bent, back, [tiny] * 5, tiny, tiny)
    bending, slope = (2 * q * a - 2 * s * c) / a**3, s / a
    wanted = [0, slope, m - slope * push, bending / 2, (v * a - s * e) / a**2 - bending * push]
    assert [x.real() for x in asked] == pytest.approx([float(x) for x in wanted], abs=1e-4)
    # lam is 1/2 give or take 10**-6, which moves what is enclosed by some 10**-5


class Side:
    """A manifold that is proved, over numbers: a run gives what is told of its way."""

    def __init__(self, tangency, reach, states, run):
        self.reach, self.states, self.asked = reach, states, []
        self.table = SimpleNamespace(
            orbit=lambda launch, boxes, way, d: self.asked.append((launch, boxes, way, d)) or run(d)
        )
        self.launch, self.boxes, self.on = "launch", lambda x, lam: (x, lam), lambda f: f


def contact(check, tangency, monkeypatch, **changed):
    """All that `touching` asks of a contact, and the equations that it solves."""

    def polynomial(k, d):
        numbers = [number(check, Fraction(d * k + (j * k) % 7, 8)) for j in range(len(check.algebra(d)[0]))]
        return check.Jet(numbers, d)

    runs = [lambda d: [(polynomial(1, d), 0), (polynomial(7, d), 0), (polynomial(2, d), polynomial(3, d))],
            lambda d: [(polynomial(4, d), 0), (polynomial(8, d), 0), (polynomial(5, d), polynomial(6, d))]]  # fmt: skip
    reach = [number(check, x) for x in changed.get("reach", ("1/2", "1/4"))]
    sides = [Side(tangency, r, [(number(check, x), 0) for x in (k, k + 1, k + 2)], run)
             for k, (r, run) in enumerate(zip(reach, runs, strict=True))]  # fmt: skip
    made, asked, free = [], [], []
    monkeypatch.setattr(tangency, "Manifold", lambda *given: made.append(given) or sides[len(made) - 1])
    monkeypatch.setattr(
        tangency, "newton", lambda *given: asked.append(given) or [given[0](given[1], d) for d in (1, 0)]
    )
    table = SimpleNamespace(
        p=P, closed=changed.get("closed", [True]), marks=changed.get("marks", []), letters={"b": "letter"}
    )
    table.free = lambda *given: free.append(given)
    leaving = []
    table.leaves = lambda psi, names: leaving.append(names) or psi * 2
    given = {"name": "tangency of two manifolds: T", "unstable": "U", "stable": "S", "meets": 2}
    given |= {"centre": [pair(x) for x in changed.get("centre", ("3/8", "-1/8", "1/3"))]}
    given |= {"orbit": [pair(x) for x in (1, 2, 3, 4, 5)]}
    given |= {key: changed[key] for key in ("name", "meets") if key in changed}
    lam = number(check, "1/3")
    image, true = tangency.touching(given, table, lam, "T")
    return SimpleNamespace(image=image, true=true, made=made, asked=asked, free=free, sides=sides, table=table,
                           lam=lam, leaving=leaving, polynomial=polynomial)  # fmt: skip


def test_a_contact_is_of_both_manifolds_over_the_box_of_lam(check, tangency, monkeypatch):
    found = contact(check, tangency, monkeypatch)
    assert found.true == "tangency of two manifolds: T"
    assert found.made == [(found.table, "U", found.lam, False), (found.table, "S", found.lam, True)]
    ((_, box, bits),) = found.asked
    assert bits == P
    assert box[2] is found.lam
    for x, middle in zip(box[:2], (Fraction(3, 8), Fraction(-1, 8)), strict=True):
        assert x.mid().real() == float(middle)
        assert x.width() == 2 * abs(middle) / 2**36 * 2**P
    assert len(box) == 3


def test_one_way_comes_to_the_place_of_contact_and_the_other_from_the_end_of_the_orbit(check, tangency, monkeypatch):
    found = contact(check, tangency, monkeypatch)
    for side, wanted, place in zip(found.sides, ((1, 2, 3), (5, 4, 3)), (0, 1), strict=True):
        assert [d for *_, d in side.asked] == [3, 2]
        for launch, boxes, way, _ in side.asked:
            assert launch == "launch"
            assert boxes == (found.asked[0][1][place], found.lam)
            assert [part for part, _ in way] == [0, 0, 0]
            assert [x.mid().real() for _, x in way] == list(wanted)
            assert all(x.width() / 2**P == pytest.approx(2e-5, rel=1e-9) for _, x in way)


def test_at_a_contact_places_and_angles_agree_and_tangents_are_parallel(check, tangency, monkeypatch):
    """Angles by the law, which here doubles what arrives: `v` becomes `-2*v`."""
    found = contact(check, tangency, monkeypatch)
    for (first, second, third), degree in zip(found.image, (3, 2), strict=True):
        a, b, u, v = (check.Jet(found.polynomial(k, degree).c[:10], 2) for k in (2, 3, 5, 6))
        v = v * -2
        wanted = a - u, b - v, a.diff(0) * v.diff(1) - b.diff(0) * u.diff(1)
        assert (first.degree, second.degree, third.degree) == (2, 2, 1)
        for ours, true in zip((first, second, third), wanted, strict=True):
            assert len(ours.c) == len(true.c)
            assert [(x.lo, x.hi) for x in ours.c] == [(x.lo, x.hi) for x in true.c]
    for names, degree in zip(found.leaving, (3, 2), strict=True):
        assert set(names) == {"b", "lam", "eta", "theta"}
        assert (names["lam"].degree, names["lam"].c[0]) == (2, found.lam)
        assert names["lam"].c[1:] == check.Jet.of(found.lam, 2, 2).c[1:]
        for key, k in (("theta", 5), ("eta", 6)):
            assert [x.lo for x in names[key].c] == [x.lo for x in found.polynomial(k, degree).c[:10]]


def test_chords_of_both_saddles_and_of_all_starts_in_the_box_have_to_be_free(check, tangency, monkeypatch):
    """Of the first run, over the box; of saddles, whose states are told here as 0, 1, 2 and 1, 2, 3."""
    found = contact(check, tangency, monkeypatch)
    ends = [(start[0], end[0], names) for start, end, names in found.free]
    assert all(part == 0 for start, end, _ in ends for part, _ in (start, end))
    assert all(names is found.table.letters for *_, names in ends)
    places = [(start[1].real(), end[1].real()) for start, end, _ in ends]
    ways = [[check.value(found.polynomial(k, 3)).real() for k in way] for way in ((1, 7, 2), (4, 8, 5))]
    assert places == [(0, 1), (1, 2), (1, 2), (2, 3), *(chord for way in ways for chord in pairwise(way))]


@pytest.mark.parametrize(
    ("changed", "error", "why"),
    [
        ({"name": "tangency"}, "Wrong", "the name must be 'tangency of two manifolds: T'"),
        ({"closed": [False]}, "Wrong", "a single closed curve without marked points"),
        ({"closed": [True, True]}, "Wrong", "a single closed curve without marked points"),
        ({"marks": [(0, 1)]}, "Wrong", "a single closed curve without marked points"),
        *(({"meets": k}, "Wrong", "meets is out of range") for k in (0, 4, 5, -1, 2.0, True)),
        ({"centre": ("5/8", "-1/8", "1/3")}, "Unproved", "a start beyond the manifold"),
        ({"centre": ("3/8", "-3/8", "1/3")}, "Unproved", "a start beyond the manifold"),
        ({"centre": ("-5/8", "1/8", "1/3")}, "Unproved", "a start beyond the manifold"),
        ({"centre": ("1/2", "1/8", "1/3")}, "Unproved", "a start beyond the manifold"),  # its box reaches beyond
    ],
)
def test_a_contact_that_is_none_is_refused_in_its_own_words(check, tangency, monkeypatch, changed, error, why):
    with pytest.raises(getattr(check, error), match=why):
        contact(check, tangency, monkeypatch, **changed)


@pytest.mark.parametrize("meets", [1, 3])
def test_a_contact_may_be_next_to_an_end_of_its_orbit(check, tangency, monkeypatch, meets):
    found = contact(check, tangency, monkeypatch, meets=meets)
    assert [len(side.asked[0][2]) for side in found.sides] == [meets + 1, 5 - meets]


def test_a_start_may_reach_as_far_as_its_manifold(check, tangency, monkeypatch):
    """To the last place, and not a unit further."""
    end = Fraction(3, 8) + Fraction(3, 8) / 2**36
    last = Fraction(-(-end.numerator * 2**P // end.denominator), 2**P)
    contact(check, tangency, monkeypatch, reach=(last, "1/4"))
    with pytest.raises(check.Unproved, match="a start beyond the manifold"):
        contact(check, tangency, monkeypatch, reach=(last - Fraction(1, 2**P), "1/4"))


def test_backwards_under_the_papers_law_an_angle_is_divided_by_lam(check, tangency):
    back = tangency.Back(SimpleNamespace(law=None))
    assert holds(back.leaves(number(check, "2/7"), {"1/lam": number(check, "3/2"), "lam": number(check, "2/3")}), "3/7")


def test_backwards_of_two_angles_the_one_next_to_0_is_told(check, tangency):
    """`eta - eta**3/2` is 31/128 at 1/4 and at 1.26..., and largest between them."""
    back = tangency.Back(SimpleNamespace(law=check.parse("eta - eta**3/2"), p=P))
    assert holds(check.value(back.leaves(check.Jet.of(number(check, "-31/128"), 0), {})), "1/4")
