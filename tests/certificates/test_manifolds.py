"""The independent checker's unstable manifolds, for maps whose manifolds are computed by hand."""

from fractions import Fraction
from types import SimpleNamespace

import pytest


def manifold(check, map, bounds, reach="1/100", inner="1/250", drift=("0", "0")):
    """The proved unstable manifold at 0 of a map of the plane, given in jets; `lam` is a ball around 1/2."""
    p, zero = 100, ["0", "0"]
    pair = lambda text: [str(round(Fraction(text) * 2**90)), "-90"]  # noqa: E731
    given = {"bounces": [zero], "frame": [zero, zero, zero, zero], "drift": [pair(x) for x in drift]}
    given |= {"range": [pair(reach), pair(inner)], "bounds": [pair(x) for x in bounds]}
    lam = check.I.of(Fraction(1, 2), p).wide(check.I.of(Fraction(1, 10**6), p))

    def orbit(launch, boxes, way, d, view):
        x, y, letter = (check.Jet.of(box, d, k) for k, box in enumerate(boxes))
        theta, psi, _ = launch(x, y, letter)
        return [(theta, psi), view(*map(theta, psi, letter - Fraction(1, 2)), letter)]

    table = SimpleNamespace(p=p, letters={}, orbit=orbit)
    return check.beside("tangency").Manifold(table, given, lam, False)


def plane(a=3, b="1/4", d="1/2", bend=0, moved=0, pushed=0):
    """The map `x -> a*x + b*y + pushed*lam`, `y -> d*y + bend*x**2 + moved*lam`, with `lam` minus its middle."""
    a, b, d, bend, moved, pushed = map(Fraction, (a, b, d, bend, moved, pushed))
    return lambda x, y, lam: (x * a + y * b + lam * pushed, y * d + x * x * bend + lam * moved)


BOUNDS = "1/1000", "1/20", "1/10", "1/5", "1/10"  # of w, w_x, w_lam, w_xx/2 and w_x_lam


@pytest.mark.parametrize(
    ("shape", "changed", "item"),
    [
        ({}, {}, None),
        ({"a": -3, "d": "-1/2"}, {}, None),
        ({"bend": 1}, {}, None),  # w_xx/2 = 1/(9 - 1/2); what 1/5 is mapped to is (1 + 1/10)/9
        ({"bend": 1}, {"bounds": (*BOUNDS[:3], "1/10", "1/10")}, "remainder"),  # (1 + 1/20)/9 is more than 1/10
        ({"bend": 20}, {"bounds": ("1/1000", "1/20", "1/10", "3", "1/10")}, "remainder"),  # nor is w_x so small
        ({"moved": "1/25"}, {}, None),  # w_lam = 2/25
        ({"moved": "3/50"}, {}, "remainder"),  # 3/50 + 1/20 is more than 1/10
        ({"moved": "3/50"}, {"drift": ("0", "3/50")}, None),  # the frame goes with it
        ({"d": "11/10"}, {}, "remainder"),
        ({"a": "12/5"}, {}, "saddle"),  # 1/100 over 12/5 is more than 1/250
        ({"a": "1/3"}, {"reach": "1/1000"}, "remainder|saddle"),
        ({}, {"inner": "1/90"}, "saddle"),  # beyond the reach nothing is known of graphs
        ({"b": 0}, {"inner": "0.0033334"}, None),
        ({"b": 0, "pushed": "1/2"}, {"inner": "0.0033334"}, "saddle"),  # the image of 0 is up to 5e-7 from 0
        ({"d": "19/20", "b": "1/2"}, {}, None),  # two graphs come closer by 19/20 + 1/40
        ({"d": "19/20", "b": "11/10"}, {}, "saddle"),  # 19/20 + 11/200 is more than 1
        ({"d": "-19/20", "b": "-11/10"}, {}, "saddle"),
        ({}, {"bounds": BOUNDS[:4]}, "."),
    ],
    ids=str,
)
def test_an_unstable_manifold_is_a_graph_within_bounds_that_a_round_makes_smaller(check, shape, changed, item):
    """The manifold is computed by hand; each hypothesis of the graph transform fails alone."""
    map, bounds = plane(**shape), changed.get("bounds", BOUNDS)
    rest = {key: value for key, value in changed.items() if key != "bounds"}
    if item is None:
        manifold(check, map, bounds, **rest)
    else:
        with pytest.raises((check.Unproved, ValueError), match=item):
            manifold(check, map, bounds, **rest)


def test_a_jet_along_a_manifold_holds_its_derivatives_by_the_place_and_by_lam(check):
    """`f(x, w(x, lam), lam)` by the chain rule, for numbers instead of bounds of `w` and its derivatives."""
    numbers = _, wx, wl, wxx, wxl = [Fraction(k, 7) for k in (0, 2, -3, 5, 4)]
    side = manifold(check, plane(), BOUNDS)
    side.w = [check.I.of(x, 100) for x in numbers]
    f = {e: Fraction(k * k - 9, 5) for k, e in enumerate(check.algebra(2)[0])}
    found = side.on(check.Jet([check.I.of(f[e], 100) for e in check.algebra(2)[0]], 2))
    at = check.algebra(2)[1]
    wanted = {
        (0, 0, 0): f[0, 0, 0],
        (1, 0, 0): f[1, 0, 0] + f[0, 1, 0] * wx,
        (0, 0, 1): f[0, 0, 1] + f[0, 1, 0] * wl,
        (2, 0, 0): f[2, 0, 0] + f[1, 1, 0] * wx + f[0, 2, 0] * wx**2 + f[0, 1, 0] * wxx,
        (1, 0, 1): f[1, 0, 1] + f[1, 1, 0] * wl + f[0, 1, 1] * wx + 2 * f[0, 2, 0] * wx * wl + f[0, 1, 0] * wxl,
    }
    for e, true in wanted.items():
        ours = check.I.of(found.c[at[e]], 100)
        assert Fraction(ours.lo, 2**100) <= true <= Fraction(ours.hi, 2**100)
        assert ours.width() < 2**20
