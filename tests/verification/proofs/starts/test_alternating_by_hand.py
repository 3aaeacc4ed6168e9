"""Strips of two basins in turn, step by step: each item is what its own step proves, and chords are bounded by sums."""

from fractions import Fraction
from types import SimpleNamespace

import pytest
from flint import arb

from verification.arithmetic.balls import working
from verification.proofs.corner.corner import enclosed
from verification.proofs.starts import alternating
from verification.proofs.starts.alternating import BITS, CHECKS, WIDE, Alternating, on_the_arc
from verification.proofs.starts.core import Core

CORE = Core(0, 0.0, 0.0, 0.5, 0.5, 1.0, 4)


@pytest.mark.parametrize(("given", "taken"), [
    ({"starts": (0.0, 1.0)}, True), ({"starts": (1.0, 0.0), "side": -1}, True), ({"starts": (-0.1, 0.5)}, False),
    ({"starts": (0.5, 1.1)}, False), ({"side": 0}, False), ({"side": 2}, False),
])  # fmt: skip
def test_orbits_begin_on_a_piece_of_one_side(given, taken):
    if taken:
        assert Alternating(Fraction(3, 40), CORE, **given).core is CORE
    else:
        with pytest.raises(ValueError, match="accepted: side 1 or -1"):
            Alternating(Fraction(3, 40), CORE, **given)


@pytest.mark.parametrize(("series", "error", "held"), [
    (((1.0, 0.5), (0.25,)), 0.25, True), (((1.0, 0.5), (0.25,)), 0.5, False), (((1.0, -1.0), (0.25,)), 0.25, False),
    (((0.25,), (1.0, 1.0)), 0.25, False), (((-1.0, -0.5), (-1.0, 0.5)), 0.25, True), (((1.0,), (1.0,)), 1.0, False),
])  # fmt: skip
def test_chords_end_on_the_arc_where_the_sum_of_all_coefficients_and_the_rest_say_so(monkeypatch, series, error, held):
    """On an arc that ends at 2, which may not be reached."""
    monkeypatch.setattr(alternating, "corner_parameters", lambda: (arb(2), arb(0)))
    jets = [SimpleNamespace(c=[arb(x) for x in c]) for c in series]
    branch = SimpleNamespace(series=SimpleNamespace(pair=lambda: jets), error=arb(error))
    assert on_the_arc(branch) is held


MISSING = {
    "none": set(), "core": {"core"}, "polygon": {"polygon"}, "branch": {"saddle", "first", "second"},
    "wide": {"saddle", "first", "second"}, "arc": {"saddle", "first", "second"}, "first": {"first"},
    "second": {"second"},
}  # fmt: skip


@pytest.mark.parametrize(("fails", "missing"), MISSING.items())
@pytest.mark.parametrize("side", [1, -1])
def test_each_item_is_what_its_own_step_proves(monkeypatch, fails, missing, side):
    asked = []
    made = Alternating(Fraction(3, 40), CORE, (0.25, 0.75), side)
    made.__dict__["polygon"] = None if fails == "polygon" else "polygon"

    def branch(orbit, map, lam, bits):
        if fails in ("branch", "wide"):
            raise ValueError if fails == "branch" else ZeroDivisionError
        return SimpleNamespace(points=lambda side, low, high: [(side, *low, *high)])

    def comes(self, point, inside):
        asked.append((point, inside))
        return fails != ("first" if inside == self.in_core else "second")

    monkeypatch.setattr(alternating, "attracts", lambda images, core: {"one": True, "other": fails != "core"})
    monkeypatch.setattr(alternating, "unstable_branch", branch)
    monkeypatch.setattr(alternating, "on_the_arc", lambda _: fails != "arc")
    monkeypatch.setattr(Alternating, "_comes", comes)
    assert made.checks == {name: None if name in missing else True for name in CHECKS}
    assert made.proved is (not missing)
    if "saddle" not in missing:
        assert asked == [((side, 0.25, 0.25), made.in_core), ((side, 0.75, 0.75), made.in_polygon)]


@pytest.mark.parametrize(
    ("off", "found"), [(-1e-3, None), (WIDE / 2, None), (WIDE * 2, "the step"), (1e-3, "the step")]
)
def test_the_polygon_is_proved_over_contractions_about_the_one_above_lambda_star(monkeypatch, off, found):
    asked = []
    monkeypatch.setattr(alternating, "limit", lambda: "limit")
    monkeypatch.setattr(alternating, "step", lambda near, e: asked.append((near, e)) or ("pieces", "the step"))
    lam = Fraction(float(enclosed()[1].mid()) + off)
    made = Alternating(lam, CORE)
    assert made.polygon == found
    if found:
        ((near, (low, high)),) = asked
        with working(BITS):
            e = float((arb(lam.numerator) / lam.denominator - enclosed()[1]).mid())
        assert near == "limit"
        assert (low, high) == (e - WIDE, e + WIDE)
        monkeypatch.setattr(alternating, "step", lambda near, e: None)
        assert Alternating(lam, CORE).polygon is None
    else:
        assert not asked


@pytest.mark.parametrize(("theta", "aside", "held"), [
    (1.0, 0.375, False), (0.875, 0.0, True), (-0.875, 0.0, True), (0.5, 0.5, False), (0.5, -0.4375, True),
    (1.5, 0.125, True), (1.5, 0.25, False), (-2.0, 0.125, False), (0.875, 0.75, False),
])  # fmt: skip
def test_a_bounce_is_inside_of_a_core_or_of_a_gate_and_not_at_its_border(theta, aside, held):
    """The core reaches 1 and 1/2, and a gate 2 and 1/4, beside `theta/2 - theta**3/4`."""
    core = Core(1, 0.5, -0.25, 0.5, 0.5, 1.0, 4, ((2.0, 0.25),))
    made = Alternating(Fraction(3, 40), core)
    for component, inside in ((1, held), (0, False)):
        here = SimpleNamespace(component=component, theta=arb(theta), phi=arb(theta / 2 - theta**3 / 4 + aside))
        assert made.in_core(here, here) is inside
