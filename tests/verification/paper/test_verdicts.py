"""Each judge is brought to each of its verdicts: by an unproved finding, a false fact, or an altered claim."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from sympy import Integer, Rational, S

from symbolic import tables
from symbolic.expressions.signs import Outcome, SignFinding
from symbolic.tables.table import lam
from verification.cycles.recurrence import delayed
from verification.named.locate import locate
from verification.paper.claims.claim import Verdict
from verification.paper.claims.folder import judge_of
from verification.paper.egg import (
    barriers,
    basins,
    cascade,
    conclusions,
    crises,
    egg,
    elastic,
    expanding,
    merging,
    nearly_round,
    period2,
    period3,
    stability,
)
from verification.paper.egg.crises import AttractorExtent
from verification.paper.judges import (
    appendix,
    attractors,
    cardioid,
    cardioid_attractor,
    cuspless,
    cuspless_chaos,
    ellipse,
    ellipse_stability,
    exponents,
    hyperbolicity,
    located,
    map,
)
from verification.paper.judges.exponents import Spectrum
from verification.paper.report.report import catalogue
from verification.proofs.corner.border_collision import FixedPointChange
from verification.proofs.periodic.bifurcation import Twist
from verification.proofs.periodic.torus import Rotating
from verification.proofs.slap_map.exponent import PeriodicPoints, one_zero

CLAIMS = {claim.id: claim for claim in catalogue()}
CONFIRMED, CORRECTED, REFUTED, SUPPORTED, OPEN = Verdict
UNKNOWN, PROVED = SignFinding(Outcome.UNKNOWN, "no proof"), SignFinding(Outcome.PROVED, "a proof")


@cache
def kept():
    """The verdicts that `tests/test_golden.py` finds the judges to give."""
    lines = (Path(__file__).parents[2] / "golden" / "claims.txt").read_text()
    return {name: Verdict(said) for name, said in re.findall(r'^(\S+) \| verdict = "(\w+)"$', lines, re.MULTILINE)}


def driven(name, module, word, other, forget=()):
    """The verdict with one name of the judge's module replaced; the caches of the functions in `forget` are cleared."""
    for each in forget:
        getattr(module, each).cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, word, other)
        found = judge_of(CLAIMS[name])(CLAIMS[name]).verdict
    for each in forget:
        getattr(module, each).cache_clear()
    return found


def rows(module, verdicts, *names, words):
    return [(name, module, word, verdicts) for name in names for word in words.split()]


UNPROVED = [  # claim, module, the finding that is without a proof, verdicts before and after
    *rows(conclusions, (SUPPORTED, OPEN), "map.mixture", words="expands"),
    *rows(conclusions, (CONFIRMED, OPEN), "map.weak_chaos", words="attracted two_rates"),
    *rows(conclusions, (CONFIRMED, OPEN), "map.sudden_creation", words="chaos"),
    *rows(cardioid, (CONFIRMED, OPEN), "cardioid.slap_expanding", words="infimum_attained"),
    *rows(
        *(cardioid_attractor, (CONFIRMED, OPEN), "cardioid.lyapunov_signs", "cardioid.nonuniformly_hyperbolic"),
        *("cardioid.chaotic_attractor", "cardioid.attractor_near_cusp", "cardioid.lyapunov_exist"),
        words="expands",
    ),
    *rows(cardioid_attractor, (SUPPORTED, OPEN), "cardioid.exponents_bounded_away", words="expands"),
    *rows(
        *(cardioid_attractor, (CONFIRMED, OPEN), "cardioid.lyapunov_exist", "cardioid.finitely_many_attractors"),
        words="two_rates",
    ),
    *rows(cardioid_attractor, (CONFIRMED, OPEN), "cuspless.nontrivial_larger", words="settles_near_zero chaos"),
    *rows(attractors, (CONFIRMED, OPEN), "egg.only_smooth_chaos", words="two_cycles settles"),
    *rows(
        *(attractors, (SUPPORTED, OPEN), "map.no_irrational_rotation"),
        words="two_cycles settles expands splits every_return",
    ),
    *rows(attractors, (CORRECTED, REFUTED), "map.two_attractor_types", words="two_cycles settles splits"),
    *rows(exponents, (CORRECTED, REFUTED), "appendix.chaotic_sign", words="contracting_norm"),
    *rows(
        *(hyperbolicity, (CONFIRMED, OPEN), "cuspless.dominated_splitting", "cardioid.dominated_splitting"),
        *("cuspless.unfolded_defocusing", "cuspless.elastic_hyperbolic"),
        words="splits",
    ),
    *rows(hyperbolicity, (CORRECTED, OPEN), "cuspless.splitting_by_exponents", words="splits"),
    *rows(hyperbolicity, (CONFIRMED, OPEN), "cardioid.elastic_hyperbolic", words="expands"),
    *rows(hyperbolicity, (CONFIRMED, OPEN), "cuspless.fourth_collision_below", words="corner"),
    *rows(
        *(cuspless_chaos, (SUPPORTED, OPEN), "cuspless.global_near_one", "cuspless.chaotic_above_tenth"),
        words="splits",
    ),
    *rows(cuspless_chaos, (CONFIRMED, OPEN), "cuspless.accumulates_on_joins", words="every_return splits"),
    *rows(cuspless, (CORRECTED, OPEN), "cuspless.noncompact", words="joined_smoothly"),
    *rows(barriers, (CONFIRMED, OPEN), "egg.basins_above_below", words="divided"),
    *rows(barriers, (SUPPORTED, OPEN), "egg.basins_separate", words="divided"),
    *rows(barriers, (SUPPORTED, OPEN), "egg.crisis_below", words="barrier_ends"),
    *rows(nearly_round, (SUPPORTED, OPEN), "egg.periodic_only_near_zero", words="settles"),
    *rows(nearly_round, (CONFIRMED, OPEN), "map.smooth_basin_boundaries", words="settles"),
    *rows(cascade, (CORRECTED, REFUTED), "egg.period4_doubles", words="attracting_without_mirror"),
    *rows(cascade, (CORRECTED, OPEN), "egg.period4_doubles", "egg.negative_exponents", words="certified"),
    *rows(cascade, (CONFIRMED, SUPPORTED), "egg.only_period4", words="cycles_for_small_lam"),
    *rows(merging, (CORRECTED, REFUTED), "egg.three_attractors", words="apart"),
]


DEAR = {"cuspless.global_near_one", "cuspless.chaotic_above_tenth", "egg.merging_crisis", "egg.coexistence_near_tenth"}
DEAR |= {"cuspless.only_attractor", "cuspless.two_basins"}


def named(row):
    """A test parameter under the name of its claim, marked as slow if the claim takes long."""
    words = [each for each in row[1:] if isinstance(each, str)]
    return pytest.param(row, id=f"{row[0]}-{words[0]}", marks=[pytest.mark.slow] if row[0] in DEAR else [])


@pytest.mark.slow
@pytest.mark.parametrize("row", [named(row) for row in UNPROVED])
def test_a_verdict_rests_on_each_finding_that_its_judge_asks_for(row):
    name, module, word, verdicts = row
    assert (kept()[name], driven(name, module, word, lambda *_, **__: UNKNOWN)) == verdicts


def unproved(real):
    """Certificates with the numbers of the real ones, but without the proof that there is a cycle."""

    def certificate(*given):
        found = real(*given)
        return SimpleNamespace(is_cycle=False, trace=found.trace, determinant=found.determinant)

    return certificate


def returns(value):
    """A replacement for a function: it always returns this value."""
    return lambda _: lambda *_, **__: value


def altered(**changes):
    """A replacement for a function: its result has these fields changed."""
    return lambda real: lambda *given, **named: replace(real(*given, **named), **changes)


def turned(found):
    return Spectrum(found.lams, -found.plus, -found.minus)


def elliptic(twist_at, wrong):
    """The triangle at the flat points, with a wrong trace, twist or drift."""
    return lambda real: lambda: tuple(Integer(wrong) if k == twist_at else x for k, x in enumerate(real()))


NOISE = np.random.default_rng(0).normal(size=(11, 100))

FACTS = [  # claim, verdicts before and after, module, word, what it means of what it meant
    ("map.kink_structure", CONFIRMED, OPEN, conclusions, "born",
     lambda real: lambda: SimpleNamespace(steps=(*real().steps[:-1],
                                                 replace(real().steps[-1], cycle=(arb(0), arb(2)))))),
    ("map.cascades_of_different_periods", SUPPORTED, OPEN, conclusions, "doublings",
     lambda real: lambda: [replace(real()[0], proved=False), *real()[1:]]),
    ("map.collapse_in_crises", SUPPORTED, OPEN, conclusions, "egg", lambda real: lambda lam: real("0.65")),
    ("map.weak_shows_elliptic", CONFIRMED, OPEN, conclusions, "elastic", returns(False)),
    ("map.uniform_contraction", CORRECTED, OPEN, conclusions, "rotating", returns((UNKNOWN, {}))),
    ("cuspless.unstable_period4", CONFIRMED, OPEN, located, "located",
     lambda real: lambda *given, **named: replace(
         real(*given, **named), notes={"kind": "subcritical: an unstable cycle is born"},
         proof=locate("saddle-node", 10, alpha=Rational(2, 25)).proof)),  # a fold has no such sign
    ("cardioid.vertical_orbit", CONFIRMED, OPEN, cardioid, "fixed_points", returns([(-S.One / 5, -S.One / 5)] * 2)),
    ("cardioid.lyapunov_sum_area", CONFIRMED, REFUTED, cardioid, "growth_defects", returns([lam])),
    ("appendix.exponents_growth", CONFIRMED, REFUTED, appendix, "growth_defects", returns([lam])),
    ("appendix.exponents_sum", CORRECTED, REFUTED, appendix, "growth_defects", returns([lam])),
    ("map.slap_evolute", CONFIRMED, OPEN, map, "curved", returns([UNKNOWN])),
    ("map.slap_circle_map", CONFIRMED, REFUTED, map, "ALL",
     lambda _: (tables.circle, replace(tables.cuspless, components=tables.cuspless.components[:1]))),
    ("egg.only_smooth_chaos", CONFIRMED, OPEN, attractors, "strange", returns((UNKNOWN, arb(0)))),
    ("map.two_attractor_types", CORRECTED, OPEN, attractors, "strange", returns((UNKNOWN, arb(0.66)))),
    *(("map.no_irrational_rotation", SUPPORTED, OPEN, attractors, "invariant_circle", altered(**other), ("rotating",))
      for other in ({"lyapunov": arb(1)}, {"lyapunov": arb(0, 1)}, {"growth": arb(-1)}, {"checks": {"exists": None}},
                    {"problem": Rotating(delayed(1), ("r", "trace"))})),
    ("cuspless.period2_attracts", CONFIRMED, OPEN, attractors, "near_zero", altered(grid=(64, 8))),
    ("cuspless.compact_near_zero", CONFIRMED, OPEN, attractors, "near_zero", altered(grid=(64, 8))),
    ("egg.figure_chaos", SUPPORTED, OPEN, attractors, "egg", lambda real: lambda *_: real("0.45")),
    ("egg.coexistence_near_tenth", SUPPORTED, OPEN, attractors, "attracting", returns(None),
     ("both_near_tenth", "triangles_attract")),
    *(("egg.coexistence_near_tenth", SUPPORTED, OPEN, attractors, "strange",
       lambda _, ends=ends: lambda alpha, kind="boundary": (PROVED, arb(ends[kind == "boundary"])),
       ("both_near_tenth",))
      for ends in (("0.29", "0.47"), ("0.3", "0.48"), ("0.3", "0.3"))),  # outside of the range, or no range
    ("egg.exponent_period3", CONFIRMED, OPEN, exponents, "certificate", unproved),
    ("egg.weak_dissipation_attracts", CORRECTED, OPEN, exponents, "certificate", unproved),
    ("egg.chaos_by", CONFIRMED, OPEN, exponents, "strange", returns((UNKNOWN, arb(0.39)))),
    ("egg.chaos_by", CONFIRMED, OPEN, exponents, "strange", returns((PROVED, arb(0.394)))),
    ("cardioid.contraction_implies", CORRECTED, OPEN, located, "expanding_cycle", returns((False, arb(2)))),
    ("cardioid.lyapunov_sum_negative", SUPPORTED, OPEN, located, "spectrum", lambda real: lambda *a: turned(real(*a))),
    ("cardioid.slap_ergodic", CONFIRMED, OPEN, cardioid_attractor, "slap_proof", altered(checks={"symmetric": None})),
    ("cardioid.transitive", SUPPORTED, OPEN, cardioid_attractor, "slap_proof", altered(checks={"symmetric": None})),
    ("cardioid.finitely_many_attractors", CONFIRMED, OPEN, cardioid_attractor, "slap_proof",
     altered(checks={"symmetric": None})),
    ("cuspless.stable_if_flatter", CORRECTED, REFUTED, cardioid_attractor, "coefficient", returns((S.One, S.One))),
    ("cuspless.visits_more_boundary", SUPPORTED, OPEN, cardioid_attractor, "coverage",
     lambda real: lambda table: real(table)[::-1]),
    ("cardioid.error_bars", SUPPORTED, OPEN, cardioid_attractor, "spectrum",
     returns(Spectrum(np.linspace(0, 1, 11), NOISE, NOISE - 1))),
    ("cuspless.below_star_converges", CONFIRMED, OPEN, cuspless_chaos, "below",
     lambda real: lambda: replace(real(), ranges=real().ranges[::2])),
    ("cuspless.only_attractor", SUPPORTED, OPEN, cuspless_chaos, "found",
     lambda real: lambda *_: real("cuspless", "0.09")),
    ("map.noncompact_domain", CONFIRMED, REFUTED, cuspless, "pi", lambda _: S.Half),
    ("ellipse.major_by_inversion", CONFIRMED, REFUTED, ellipse_stability, "minor_axis",
     lambda _: ellipse_stability.major_axis),
    ("ellipse.slap_stable_orbits", CORRECTED, REFUTED, ellipse, "axis_slope", returns(S(3) / 2)),
    ("circle.converges", CONFIRMED, REFUTED, ellipse, "after",
     lambda real: lambda n: (real(n)[0] + n * ellipse.phi, real(n)[1])),
    ("cuspless.elastic_ergodic", SUPPORTED, OPEN, hyperbolicity, "averages",
     lambda real: lambda name: real(name, "0.9")),
    *(("cardioid.elastic_ergodic", SUPPORTED, after, hyperbolicity, "averages",
       returns((np.array([[off, -off]] * 2 + [[1.0, -1.0]]), np.ones((3, 2)), np.array([0.0, later, 0.0]))))
      for off, later, after in ((1, 0.01, SUPPORTED), (1, -0.03, OPEN), (1, 0.03, OPEN), (2, 0.01, OPEN))),
    ("cuspless.fourth_collision_above", CORRECTED, REFUTED, hyperbolicity, "kink_falls", returns(None)),
    ("cuspless.fourth_collision_below", CONFIRMED, OPEN, hyperbolicity, "kink_falls", returns(None)),
    ("cuspless.fourth_collision_below", CONFIRMED, OPEN, hyperbolicity, "minimum_at_kink", returns(None)),
    *((f"cuspless.fourth_collision_{side}", before, OPEN, hyperbolicity, "fourth_on_wall",
       returns(SimpleNamespace(proved=None, boxes=1)))
      for side, before in (("above", CORRECTED), ("below", CONFIRMED))),
    *((f"cuspless.{name}", before, after, hyperbolicity, "born",
       lambda real: lambda: replace(real(), budget=1))
      for name, before, after in (("chaotic_above_star", CONFIRMED, OPEN), ("thin_at_birth", CONFIRMED, OPEN),
                                  ("coexistence", CORRECTED, REFUTED))),
    *(("cuspless.thin_at_birth", CONFIRMED, OPEN, hyperbolicity, "border", altered(**wrong))
      for wrong in ({"kind": FixedPointChange.PERSISTENCE}, {"kind": FixedPointChange.UNKNOWN}, {"robust": None})),
    ("egg.figure_attractors", CORRECTED, REFUTED, stability, "cycles_at", returns((PROVED, UNKNOWN))),
    ("egg.figure_attractors", CORRECTED, OPEN, stability, "cycles_at", returns((UNKNOWN, PROVED))),
    ("egg.cascade", SUPPORTED, OPEN, stability, "accumulation", altered(supercritical=False)),
    ("egg.after_crisis", CORRECTED, OPEN, barriers, "bounces", returns(None), ("window",)),
    ("cuspless.slap_no_period4", CONFIRMED, OPEN, basins, "points_of_period_4",
     returns(PeriodicPoints([(0, 0.0, 1.0)] * 5, 9))),
    ("cuspless.basins_intermingled", CONFIRMED, OPEN, basins, "alternating",
     lambda real: lambda: replace(real(), starts=real().starts[::-1])),
    ("egg.basins_intermingled", SUPPORTED, OPEN, basins, "common", returns((PROVED, UNKNOWN))),
    ("cuspless.two_basins", CONFIRMED, OPEN, basins, "division",
     lambda real: lambda: replace(real(), annulus=replace(real().annulus, growth=1.06))),  # by 1.0105 and more it is
    ("egg.slap_critical_points", CORRECTED, REFUTED, period2, "crossings", lambda _: lambda: one_zero(budget=10)),
    ("egg.period3_attracting", CORRECTED, REFUTED, period3, "elastic_trace", lambda real: lambda _: real(False)),
    ("map.smooth_basin_boundaries", CONFIRMED, OPEN, nearly_round, "edge", altered(radius=0.03)),
    *((f"egg.{name}", SUPPORTED, OPEN, cascade, "chaotic_lams", returns({shape: [0.5] for shape in cascade.TONGUE}))
      for name in ("alpha_destabilises", "tongue")),
    ("egg.representative", SUPPORTED, OPEN, cascade, "located",
     lambda real: lambda *a, **k: SimpleNamespace(certified=False, ball=real(*a, **k).ball)),
    ("egg.tolerance_sensitive", SUPPORTED, OPEN, cascade, "seen_ends", returns(dict.fromkeys(cascade.STOPS, 0.37115))),
    ("egg.isolated_resolution", SUPPORTED, OPEN, cascade, "cascade", altered(proved=False)),
    ("egg.both_grow", SUPPORTED, OPEN, crises, "extent", lambda _: lambda lam: AttractorExtent(1 - float(lam), 0.1)),
    ("egg.both_grow", SUPPORTED, OPEN, crises, "period_3", returns(0.4)),
    ("egg.just_two", SUPPORTED, OPEN, crises, "LEFT", lambda _: "0.83"),
    ("egg.region_taken_over", SUPPORTED, OPEN, crises, "LEFT", lambda _: "0.83"),
    ("egg.elastic_mixed", SUPPORTED, OPEN, elastic, "chaotic_shares", returns([("0.05", 0.0)])),
    ("egg.elastic_mixed", SUPPORTED, OPEN, elastic, "chaotic_shares", returns([("0.05", 1.0)])),
    *((f"egg.{name}", SUPPORTED, OPEN, elastic, "chaotic_shares", lambda _: lambda shapes: [(x, 0.1) for x in shapes])
      for name in ("chaotic_sea_panels", "transition_to_chaos")),
    ("egg.alternating_points", CONFIRMED, REFUTED, elastic, "elastic_trace", returns(Integer(1))),
    ("egg.period3_bias", CONFIRMED, REFUTED, elastic, "flat_triangle", elliptic(0, 2)),
    *(("egg.period3_islands", CONFIRMED, REFUTED, elastic, "flat_triangle", elliptic(*wrong))
      for wrong in ((1, 0), (0, -1), (2, 1))),  # no twist, at a resonance, or an area that is lost
    ("egg.no_full_chaos", CONFIRMED, OPEN, elastic, "isosceles", returns((True, Twist(arb(1), arb(0, 1), arb(0))))),
    ("egg.period3_direction", CONFIRMED, REFUTED, egg, "required_tilt", lambda real: lambda: -real()),
    ("egg.stays_long", SUPPORTED, OPEN, egg, "stay", returns(9.0)),
    ("egg.noise", SUPPORTED, OPEN, egg, "chaotic_share", returns(0.0)),
    ("egg.noise", SUPPORTED, OPEN, egg, "chaotic_share", returns(0.1)),
    ("egg.noise", SUPPORTED, OPEN, egg, "side_cascade",
     returns((SimpleNamespace(proved=False, supercritical=True, value=arb(0.38)),))),
    ("egg.merging_crisis", SUPPORTED, OPEN, merging, "goes_over", returns(False), ("merges",)),
    ("egg.merging_crisis", SUPPORTED, OPEN, merging, "LAST", lambda _: "0.4435", ("merges",)),
    ("egg.single_expands", CORRECTED, REFUTED, expanding, "ceiling", returns(np.inf), ("expands",)),
    ("egg.single_expands", CORRECTED, OPEN, expanding, "kept", lambda real: lambda: real()[:1] * 3,
     ("several", "expands")),
    ("egg.attractor_expands", SUPPORTED, OPEN, expanding.crises, "extent", returns(SimpleNamespace(height=0.15))),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("row", [named(row) for row in FACTS])
def test_a_verdict_changes_with_the_facts(row):
    name, before, after, module, word, made, *forget = row
    real = getattr(module, word)
    assert (kept()[name], driven(name, module, word, made(real), *forget)) == (before, after)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "printed", "after"),
    [
        ("egg.exponent_period3", "-0.4", REFUTED),
        ("egg.exponent_period32", "-0.02", REFUTED),
        ("egg.chaos_by", "0.3", OPEN),
        ("egg.no_chaos_below", "0.03", SUPPORTED),
        ("egg.no_chaos_below", "0.1", OPEN),
        ("egg.chaotic_interval", "[0.42, 0.66]", OPEN),
        ("egg.chaotic_interval", "[0.394, 0.66]", SUPPORTED),
        ("egg.chaotic_interval", "[0.394, 0.70]", OPEN),
    ],
)
def test_a_verdict_changes_with_the_sentence(name, printed, after):
    claim = replace(CLAIMS[name], printed=printed)
    assert judge_of(claim)(claim).verdict is after


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "after"),
    [("map.other_K", OPEN), ("egg.chaotic_interval", OPEN), ("egg.basins_intermingled", SUPPORTED)],
)
def test_a_question_and_a_report_of_what_was_seen_have_no_erratum(name, after):
    judgement = judge_of(CLAIMS[name])(CLAIMS[name])
    assert (judgement.verdict, judgement.erratum) == (after, "")
