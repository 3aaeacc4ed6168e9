"""What the verdicts on the map, the circle and the ellipse rest on: the inequalities, and that none of them is idle.

An inequality that is too weak is proved as well as the right one, and the verdict is the same: so they are written out
here, with their ranges, as they were read beside the paper.
"""

from dataclasses import replace
from functools import cache
from itertools import starmap

import pytest
from sympy import Interval, S, expand, simplify

from symbolic.cycles.polygons import COSINE
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.formula import parse
from symbolic.tables.table import a, alpha, lam
from verification.paper.claims.claim import Verdict
from verification.paper.claims.judges import greater
from verification.paper.judges import ellipse, hyperbolicity, map
from verification.paper.report.report import catalogue, judge, verify
from verification.proofs.corner.border_collision import Kind
from verification.proofs.corner.evidence import border

MODULES = (ellipse, map)
CLAIMS = {c.id: c for c in catalogue() if c.home in {m.__name__ for m in MODULES} and c.kind != "numerical"}
INEQUALITIES = ("positive", "nonnegative", "greater", "saddle", "stable_while_nonnegative")
FINDINGS = (*INEQUALITIES, "zero", "equal", "answer")
LETTERS = {"a": a, "alpha": alpha, "lam": lam, "C": COSINE}

BEYOND, BELOW, OPEN = "a in (1, oo)", "lam in [0, 1)", "lam in (0, 1)"
TURNS = "-8*C^2*alpha^2 + 11*C*alpha + 18*alpha^2 + 1"  # the egg's x'y'' - y'x''
EGG = f"positive: {TURNS}; C in [-1, 1], alpha in [0, 1/10)"
TRACE = "4*a^4*(1 + lam)^2 - 4*a^2*(1 + lam)^2 + lam^2 + 1"  # on the major axis, where the determinant is lam^2
SADDLE = f"saddle: {TRACE}, lam^2; {BEYOND}, {OPEN}"
MINOR = f"stable_while_nonnegative: (a^2 - 2)^2/a^4; {BEYOND}, {OPEN}"
GROWS = [f"positive: 1 - lam; {BELOW}", f"positive: 1 - 1/a; {BEYOND}", f"positive: a^2 - 1; {BEYOND}"]
ROUND = ["positive: 1", "positive: a; a in [1, oo)"]
REST = {
    "map.dissipative": ["greater: 9/5, 1", "greater: 9/10*sqrt(5)*cos(9/10*atan(2)), 1"],
    "map.focusing_beam": ["positive: lam + 1; lam in [0, 1]"],
    "map.zero_curvature_excluded": [EGG],
    "map.focusing_and_flat": [EGG],
    "map.curvature_nonpositive": [
        *ROUND, "nonnegative: 3*C + 3; C in [-1, 1]", f"nonnegative: {TURNS}; C in [-1, 1], alpha in [0, 1/10]",
    ],
    "map.slap_evolute": [*ROUND, "positive: 3*C + 3; C in (-1, 1]", EGG],
    "circle.nearer_diameter": [f"positive: 1 - lam; {BELOW}"],
    "circle.dominated_splitting": [f"positive: 1 - lam; {OPEN}"],
    "ellipse.two_period2": [f"positive: a^2 - 1; {BEYOND}"],
    "ellipse.minor_axis_stable": [MINOR],
    "ellipse.limit_set": [*GROWS, MINOR, SADDLE],
    "ellipse.basin": [SADDLE, *GROWS],
    "ellipse.major_axis_eigenvalues": [f"saddle: {TRACE}, lam^2; {BEYOND}, {BELOW}", SADDLE],
    "ellipse.major_axis_unstable": [f"positive: 4*a^2*(a^2 - 1)*(1 + lam)^2; {BEYOND}, {BELOW}"],
    "ellipse.slap_unstable_points": ["positive: ((2*(6/5)^2 - 1)^2 - 1)"],
    "ellipse.slap_stable_orbits": ["positive: 1 - (((6/5)^2 - 2)^2/(6/5)^4)^2"],
    "ellipse.slap_not_expanding": ["nonnegative: 1 - (a^2 - 2)^2/a^4; a in [1, oo), lam in {0}"],
}  # fmt: skip


def range_of(letter, values):
    """A letter and its range as they are written above."""
    if not isinstance(values, Interval):
        return f"{letter} in {values}"
    left, right = "(" if values.left_open else "[", ")" if values.right_open else "]"
    if values.end.is_infinite:
        right = ")"
    return f"{letter} in {left}{values.start}, {values.end}{right}"


@cache
def undisturbed():
    """The verdict on each claim, each inequality that was asked for it, and every finding with its outcome."""
    next(verify("map.A"))  # enters the judges
    return {name: disturbed(name, None) for name in CLAIMS}


def disturbed(name, idle):
    """A claim judged while the finding of this number is unknown."""
    asked, outcomes = [], []
    with pytest.MonkeyPatch.context() as patch:
        for module in MODULES:
            for word in FINDINGS:
                if hasattr(module, word):
                    patch.setattr(module, word, watched(word, getattr(module, word), asked, outcomes, idle))
        return judge(CLAIMS[name]).verdict, asked, outcomes


def watched(word, real, asked, outcomes, idle):
    """The function of this name, which notes what it is asked."""

    def found(*given):
        if word in INEQUALITIES:
            asked.append((word, *given))
        finding = real(*given)
        outcomes.append(finding.outcome)
        return Finding(Outcome.UNKNOWN, "idle") if len(outcomes) - 1 == idle else finding

    return found


def equals(x, y):
    """Whether two formulas are one; numbers by thirty digits."""
    gap = expand(x - y)
    return simplify(gap) == 0 if gap.free_symbols else abs(gap.n(30)) < 1e-28


def same(asked, text):
    """Whether an inequality is the one that is written out."""
    word, _, said = text.partition(": ")
    formulas, _, ranges = said.partition("; ")
    box = asked[-1] if isinstance(asked[-1], dict) else {}
    values = [x for x in asked[1:] if not isinstance(x, dict)]
    written = [parse(part, LETTERS) for part in formulas.split(", ")]
    told = ", ".join(sorted(range_of(letter, values) for letter, values in box.items()))
    alike = len(values) == len(written) and all(starmap(equals, zip(values, written, strict=True)))
    return word == asked[0] and alike and told == ranges


@pytest.mark.parametrize("name", CLAIMS)
def test_the_inequalities_that_a_verdict_rests_on_are_those_that_were_read(name):
    _, asked, _ = undisturbed()[name]
    written = REST.get(name, [])

    assert len(asked) == len(written)
    assert [text for given, text in zip(asked, written, strict=True) if not same(given, text)] == []


@pytest.mark.parametrize("name", CLAIMS)
def test_no_finding_that_a_judge_asks_for_is_idle(name):
    """With any one of those that are proved left open, the claim is neither confirmed nor corrected."""
    verdict, _, outcomes = undisturbed()[name]
    assert verdict in (Verdict.CONFIRMED, Verdict.CORRECTED)
    for number, outcome in enumerate(outcomes):
        if outcome is Outcome.PROVED:
            assert disturbed(name, number)[0] is not verdict, number


def test_no_number_is_greater_than_itself():
    assert greater(S(2), S(2)).outcome is Outcome.REFUTED


def test_the_areas_that_grow_are_said_to_grow_at_the_contraction_that_they_were_computed_with():
    undisturbed()
    assert judge(CLAIMS["map.dissipative"]).witness == {"lam": "9/10"}


@pytest.mark.parametrize("wrong", [{"kind": Kind.PERSISTENCE}, {"kind": Kind.UNKNOWN}, {"robust": None}])
def test_what_is_thin_at_birth_is_born_in_a_fold_with_robust_chaos(monkeypatch, wrong):
    """All else is taken as proved; each of both is asked for."""
    limit = border()
    proved = Finding(Outcome.PROVED, "proved")
    monkeypatch.setattr(hyperbolicity, "chaos", lambda: proved)
    monkeypatch.setattr(hyperbolicity, "sizes", list)
    monkeypatch.setattr(hyperbolicity, "strips_of_the_map", lambda most: ((0.1, 0.01),))
    monkeypatch.setattr(hyperbolicity, "saddles", lambda: True)
    claim = next(c for c in catalogue() if c.id == "cuspless.thin_at_birth")
    monkeypatch.setattr(hyperbolicity, "border", lambda: limit)
    found = hyperbolicity.thin_at_birth(claim)
    assert found.verdict is Verdict.CONFIRMED
    assert "in two strips, 0.10 by 0.01000 in units" in found.printed.reason
    monkeypatch.setattr(hyperbolicity, "border", lambda: replace(limit, **wrong))
    assert hyperbolicity.thin_at_birth(claim).verdict is Verdict.OPEN
