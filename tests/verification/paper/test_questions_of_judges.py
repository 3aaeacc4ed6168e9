"""What judges of the circle, the ellipse and the map ask: which inequality, over which range, and where it fails.

Their proofs are those of `symbolic.expressions.signs`, which have tests of their own; here they are taken for proved.
"""

from collections.abc import Callable, Iterable
from types import ModuleType

import pytest
from sympy import Interval, Rational, pi

from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import alpha, lam, theta
from verification.paper.claims.claim import Claim, Judgement, Verdict
from verification.paper.claims.judges import JUDGES
from verification.paper.judges import ellipse
from verification.paper.judges import map as on_the_map
from verification.paper.report.report import catalogue

CLAIMS: dict[str, Claim] = {claim.id: claim for claim in catalogue()}
TAKEN = Finding(Outcome.PROVED, "taken for proved")
OPEN_A, OPEN_LAM, HALF_LAM = "a in Interval.open(1, oo)", "lam in Interval.open(0, 1)", "lam in Interval.Ropen(0, 1)"
CLOSED_A = "a in Interval(1, oo)"
MAJOR = "4*a**4*lam**2 + 8*a**4*lam + 4*a**4 - 4*a**2*lam**2 - 8*a**2*lam - 4*a**2"  # the trace less 1 and det
SADDLE = f"saddle {MAJOR} + lam**2 + 1, lam**2 if {OPEN_A}; "
MINOR = f"stable while nonnegative (a**2 - 2)**2/a**4 if {OPEN_A}; {OPEN_LAM}"
LANDS, HALVES = "2 zeros: the landing point is q0 + 2*cos(phi)*v", "1 zeros: J survives the flight (Joachimsthal)"
LYAPUNOV = [HALVES, f"positive 1 - lam if {HALF_LAM}", f"positive 1 - 1/a if {OPEN_A}", "2 zeros: ",
            f"positive a**2 - 1 if {OPEN_A}"]  # fmt: skip
SETTLES = [
    LANDS,
    "2 zeros: the closed form holds at n = 0",
    "2 zeros: and one bounce takes it from n to n + 1: phi_n = lam^n*phi",
    "1 zeros: s_2n - 2*pi*n - limit = 2*phi_2n/(1 - lam)",
    "1 zeros: lam^n tends to 0 for 0 <= lam < 1",
]
EGG, STRICT = "-8*C**2*alpha**2 + 11*C*alpha + 18*alpha**2 + 1", "alpha in Interval.Ropen(0, 1/10)"
ASKED: dict[str, list[str]] = {
    "circle.elastic_angles": [LANDS, "1 zeros: "],
    "circle.nearer_diameter": [f"positive 1 - lam if {HALF_LAM}", LANDS],
    "circle.converges": SETTLES,
    "circle.limit_set": SETTLES,
    "circle.every_diameter": [LANDS, "2 zeros: "],
    "circle.dominated_splitting": ["4 zeros: ", f"positive 1 - lam if {OPEN_LAM}"],
    "ellipse.shape_range": ["equal everywhere"],
    "ellipse.elastic_integrable": ["1 zeros: "],
    "ellipse.two_period2": ["2 zeros: ", f"positive a**2 - 1 if {OPEN_A}"],
    "ellipse.minor_axis_stable": [MINOR],
    "ellipse.major_axis_invariant": ["decided: True"],
    "ellipse.limit_set": [*LYAPUNOV, MINOR, SADDLE + OPEN_LAM],
    "ellipse.basin": [SADDLE + OPEN_LAM, *LYAPUNOV],
    "ellipse.major_axis_leaves": [SADDLE + OPEN_LAM, *LYAPUNOV],
    "ellipse.major_axis_eigenvalues": [SADDLE + HALF_LAM, SADDLE + OPEN_LAM],
    "ellipse.major_axis_unstable": [f"positive {MAJOR} if {OPEN_A}; {HALF_LAM}"],
    "ellipse.evolute": ["equal everywhere"],
    "ellipse.slap_unstable_points": ["positive 1584/625 everywhere"],  # (2*a**2 - 1)**2 - 1
    "ellipse.slap_stable_orbits": ["positive 102575/104976 everywhere", "decided: True"],  # 1 - (7/18)**4
    "ellipse.slap_not_expanding": [f"nonnegative 1 - (a**2 - 2)**2/a**4 if {CLOSED_A}; lam in {{0}}"],
    "map.dissipative": ["9/5 > 1", "9*sqrt(5)*cos(9*acos(sqrt(5)/5)/10)/10 > 1", "1 zeros: the exit angle is -lam*eta"],
    "map.focusing_beam": ["positive lam + 1 if lam in Interval(0, 1)", "equal everywhere"],
    "map.birkhoff": ["1 zeros: Jacobian 1"],
    "map.stability_product": ["equal everywhere"] * 2,
    "map.elastic": ["1 zeros: phi = -eta"],
    "map.slap_normal": ["3 zeros: "],
    "map.slap_circle_map": ["12 zeros: "],  # x and y at the six ends of components
    "map.curvature_nonpositive": [
        "positive 1 everywhere",
        f"positive a if {CLOSED_A}",
        "nonnegative 3*C + 3 if C in Interval(-1, 1)",
        "2 zeros: the cuspless arc is the cardioid's",
        "1 zeros: the wall is straight",
        f"nonnegative {EGG} if C in Interval(-1, 1); alpha in Interval(0, 1/10)",
    ],
    "map.zero_curvature_excluded": ["1 zeros: kappa = 0 there", f"positive {EGG} if C in Interval(-1, 1); {STRICT}"],
    "map.slap_evolute": [
        "1 zeros: ",
        "1 zeros: phi = 0 at lam = 0",
        "1 zeros: the wall's normals are parallel: it has no evolute",
        "positive 1 everywhere",
        f"positive a if {CLOSED_A}",
        "positive 3*C + 3 if C in Interval.Lopen(-1, 1)",
        "2 zeros: the arc is the cardioid's",
        f"positive {EGG} if C in Interval(-1, 1); {STRICT}",
    ],
}


def where(box: dict) -> str:
    """A range in words, its letters in order."""
    return "if " + "; ".join(f"{letter} in {box[letter]}" for letter in sorted(box, key=str)) if box else "everywhere"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What judges ask, in order, each taken for proved."""
    found: list[str] = []

    def put(module: ModuleType, name: str, says: Callable[..., str]) -> None:
        if hasattr(module, name):
            monkeypatch.setattr(module, name, lambda *given: found.append(says(*given)) or TAKEN)

    for module in (ellipse, on_the_map):
        for name in ("positive", "nonnegative", "saddle", "stable_while_nonnegative"):
            said = name.replace("_", " ")
            put(module, name, lambda *given, said=said: f"{said} {', '.join(map(str, given[:-1]))} {where(given[-1])}")
        put(module, "zero", lambda argument, *gaps: f"{len(gaps)} zeros: {argument}")
        put(module, "equal", lambda left, right, box: f"equal {where(box)}")
        put(module, "greater", lambda left, right: f"{left} > {right}")
        put(module, "answer", lambda holds, reason: f"decided: {holds}")
    return found


def judged(name: str) -> Judgement:
    module = "map" if name.startswith("map.") else "ellipse"
    return JUDGES[f"verification.paper.judges.{module}", name](CLAIMS[name])


@pytest.mark.parametrize("name", ASKED)
def test_a_judge_asks_what_the_sentence_says_over_the_range_that_it_is_said_of(name: str, asked: list[str]):
    """By hand: traces and determinants on the axes are those of the paper's table of eigenvalues."""
    judged(name)
    assert asked == ASKED[name]


@pytest.mark.parametrize(
    ("box", "told"),
    [(None, OPEN_LAM), ({}, OPEN_LAM), ({lam: Interval(Rational(1, 4), Rational(1, 2))}, "lam in Interval(1/4, 1/2)")],
    ids=["none", "empty", "some"],
)
def test_two_cycles_are_all_that_attracts_over_the_contractions_that_are_asked_or_all_between_0_and_1(
    box: dict | None, told: str, asked: list[str]
):
    ellipse.two_cycles(box)
    assert asked == [*LYAPUNOV, f"stable while nonnegative (a**2 - 2)**2/a**4 if {OPEN_A}; {told}", SADDLE + told]


SHARED = {"circle.elastic_integrable", "circle.slap_period2", "map.elastic_measure", "map.focusing_and_flat"}
IDENTITIES = {
    *("circle.exit_angle", "circle.slap", "ellipse.parametrisation", "ellipse.curvature"),
    *("ellipse.curvature_major", "ellipse.curvature_minor", "map.reflection_rule", "map.derivative_matrix"),
    *("map.A", "map.B", "map.slap_derivative"),
}
CORRECTED = {
    *("ellipse.basin", "ellipse.major_axis_leaves", "ellipse.major_axis_eigenvalues", "ellipse.slap_stable_orbits"),
    *("map.dissipative", "map.zero_curvature_excluded", "map.focusing_and_flat"),
}


def test_no_other_judge_of_these_asks_for_more_than_that_two_formulas_are_one():
    homes: Iterable[tuple[str, str]] = JUDGES
    names = {name for home, name in homes if home in (ellipse.__name__, on_the_map.__name__)}
    assert names == {*ASKED} | SHARED | IDENTITIES


@pytest.mark.parametrize("name", sorted({*ASKED} | SHARED | IDENTITIES))
def test_each_sentence_is_confirmed_or_corrected_by_what_its_judge_proves(name: str):
    """With nothing taken for proved: each identity and each inequality that a judge asks for holds."""
    assert judged(name).verdict is (Verdict.CORRECTED if name in CORRECTED else Verdict.CONFIRMED)


@pytest.mark.parametrize(
    ("name", "at"),
    [
        ("ellipse.basin", {lam: Rational(1, 2)}),
        ("ellipse.slap_stable_orbits", {}),
        ("map.dissipative", {lam: Rational(9, 10)}),
        ("map.zero_curvature_excluded", {alpha: Rational(1, 10), theta: pi / 3}),
    ],
)
def test_what_is_corrected_fails_where_the_judge_says(name: str, at: dict, asked: list[str]):
    found = judged(name)
    assert found.verdict is Verdict.CORRECTED
    assert dict(found.printed.at) == at
    assert asked


def test_a_contraction_below_1_is_one_over_more_than_1_and_its_powers_are_what_tends_to_0(
    monkeypatch, asked: list[str]
):
    given = []
    monkeypatch.setattr(ellipse, "limit", lambda *all_of: given.append(tuple(map(str, all_of))) or 0)
    ellipse.settles()
    assert given == [("(more + 1)**(-n)", "n", "oo")]


def test_the_judges_of_the_ellipse_say_what_is_true_in_place_of_what_is_printed(asked: list[str]):
    """Slopes on the axes of `a = 6/5`: `(2*a**2 - 1)**2` at the tips, `((a**2 - 2)/a**2)**2` at the flanks."""
    a = Rational(6, 5)
    assert judged("ellipse.slap_unstable_points").derived == f"(T0^2)' = {(2 * a**2 - 1) ** 2}"
    assert f"(T0^2)' = {((a**2 - 2) / a**2) ** 2}" in judged("ellipse.slap_stable_orbits").derived
    assert judged("ellipse.slap_not_expanding").derived == "(a**2 - 2)**2/a**4"
    assert judged("circle.converges").derived == "s_2n -> -2*phi/(1 - lam) + s (mod 2*pi), phi_n -> 0"
    assert judged("ellipse.evolute").derived == "[(a**2 - 1)*cos(theta)**3/a, (1 - a**2)*sin(theta)**3]"
