"""The claims: complete, each with a verdict, and sensitive to every printed coefficient."""

import re
from dataclasses import replace
from functools import cache

import pytest

from symbolic.tables.formula import parse
from verification.paper.claims.claim import Claim, Printed, Verdict
from verification.paper.claims.folder import judge_of
from verification.paper.claims.judges import JUDGES
from verification.paper.report.report import Result, catalogue, judge, verify

FAIL_AT_A_WITNESS = (
    "map.whispering_gallery",
    "map.uniform_contraction",
    "egg.period4_created",
    "egg.period3_found",
    "egg.figure_attractors",
    "egg.no_period3_caption",
    "egg.projection_misses",
    "cuspless.coexistence",
)

SYMBOLIC = {claim.id: claim for claim in catalogue() if claim.kind != "numerical"}
ERRATA = {
    "map": "focusing_and_flat zero_curvature_excluded",
    "ellipse": "basin complex_above complex_near_one dominated_splitting lambda_plus_outside "
    "major_axis_eigenvalues P2_sqrt2 slap_stable_orbits splitting_hyperbolic stable_node",
    "cardioid": "contraction_implies slap_expanding_caption slap_slow_caption",
    "cuspless": "monodromy noncompact splitting_by_exponents stable_if_flatter",
    "egg": "convex curvature_max_location curvature_min_location monodromy mu_not_one no_period3_caption "
    "period2_stable_below period3_attracting period3_end_caption period3_lambda_c slap_critical_points two_period3 "
    "vertex_period3_unstable weak_dissipation_attracts",
    "appendix": "cuspless_plane exponents_sum incoming_angle periodic_sign trigonometry_unavoidable",
}
CORRECTED = {f"{table}.{thing}" for table, things in ERRATA.items() for thing in things.split()}

NUMERAL = re.compile(r"(?<![A-Za-z_0-9.])\d+(?:\.\d+)?(?![A-Za-z_0-9.])")


@cache
def judged(name: str) -> Result:
    """The result of a symbolic claim; numerical claims have tests beside their proofs."""
    next(verify("map.A"))  # enters the judges
    return judge(SYMBOLIC[name])


def claims(*kinds: str) -> list[Claim]:
    return [claim for claim in catalogue() if claim.kind in kinds]


def entries(printed: Printed) -> list[str]:
    if isinstance(printed, str):
        return [printed]
    return [entry for row in printed for entry in ([row] if isinstance(row, str) else row)]


def with_entry(printed: Printed, index: int, text: str) -> Printed:
    if isinstance(printed, str):
        return text
    numbered = iter(range(10**6))
    return [
        (text if next(numbered) == index else row)
        if isinstance(row, str)
        else [text if next(numbered) == index else entry for entry in row]
        for row in printed
    ]


def mutations(claim: Claim) -> list[Claim]:
    """Copies of the claim with one numeral changed, each in turn, and with each entry doubled."""
    mutants = []
    for index, entry in enumerate(entries(claim.printed)):
        texts = [f"2*({entry})"]
        for found in NUMERAL.finditer(entry):
            digits = found.group()
            other = digits[:-1] + str((int(digits[-1]) + 1) % 10) if "." in digits else str(int(digits) + 1)
            texts.append(entry[: found.start()] + other + entry[found.end() :])
        mutants += [replace(claim, printed=with_entry(claim.printed, index, text)) for text in texts]
    return [mutant for mutant in mutants if readable(mutant) and not same(mutant, claim)]


def readable(mutant: Claim) -> bool:
    """Whether the mutant parses; a square root changed to a third root, for example, does not."""
    try:
        return mutant.formula is not None
    except ValueError:
        return False


def same(mutant: Claim, claim: Claim) -> bool:
    """Whether the mutant equals the claim, for example because twice zero is zero."""
    pairs = zip(entries(mutant.printed), entries(claim.printed), strict=True)
    return all(parse(new, claim.names) == parse(old, claim.names) for new, old in pairs)


def test_ids_are_unique_and_every_judge_has_a_claim():
    ids = [claim.id for claim in catalogue()]

    assert len(ids) == len(set(ids))
    for claim in catalogue():
        judge_of(claim)  # enters the judges of its module
    assert {name for home, name in JUDGES if home in {claim.home for claim in catalogue()}} == set(ids)


@pytest.mark.slow
@pytest.mark.parametrize("name", SYMBOLIC)
def test_each_claim_that_symbols_settle_is_confirmed_but_for_those_that_are_corrected(name: str):
    """The errata are those that a reader has verified; a judge that is altered confirms too much or too little.

    A corrected claim says which symbol is wrong; a confirmed one names no erratum and no counterexample.
    """
    result = judged(name)

    assert result.verdict is (Verdict.CORRECTED if name in CORRECTED else Verdict.CONFIRMED)
    assert bool(result.erratum) is (name in CORRECTED)
    assert result.erratum or not result.witness


# nothing in these has a letter to be given
WITHOUT_LETTERS = {"appendix.cuspless_plane", "appendix.exponents_sum", "cuspless.stable_if_flatter"}
ON_LETTERS = [claim for claim in claims("identity", "relation", "property") if claim.id in CORRECTED]


def stray(claim: Claim, result: Result) -> list[str]:
    """The letters of a refuted claim for which the witness has no value, or one outside the printed range."""
    given = {x: parse(result.witness[x.name], {}) for x in claim.box if x.name in result.witness}
    return [f"{x} = {given.get(x)} for {x} in {r}" for x, r in claim.box.items() if x not in given or given[x] not in r]


@pytest.mark.slow
@pytest.mark.parametrize("claim", ON_LETTERS, ids=lambda claim: claim.id)
def test_a_refuted_sentence_fails_at_a_witness_inside_the_range_that_is_printed(claim: Claim):
    assert bool(judged(claim.id).witness) is (claim.id not in WITHOUT_LETTERS)
    assert stray(claim, judged(claim.id)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", FAIL_AT_A_WITNESS)
def test_a_refuted_observation_fails_at_a_witness_inside_the_range_that_is_printed(name):
    (result,) = verify(name)
    (claim,) = (claim for claim in catalogue() if claim.id == name)

    assert result.verdict in (Verdict.CORRECTED, Verdict.REFUTED)
    assert stray(claim, result) == []


def test_the_cuspless_erratum_is_the_base_point_and_not_a_coefficient():
    assert "(C, 0)" in judged("cuspless.monodromy").erratum


@pytest.mark.slow
@pytest.mark.parametrize("claim", claims("identity"), ids=lambda claim: claim.id)
def test_changing_any_printed_coefficient_flips_the_verdict(claim: Claim):
    next(verify("map.A"))
    verdict = judge(claim).verdict

    for mutant in mutations(claim):
        assert judge(mutant).verdict is not verdict, mutant.printed


@pytest.mark.parametrize("claim", claims("digits"), ids=lambda claim: claim.id)
def test_changing_any_printed_digit_flips_the_verdict(claim: Claim):
    next(verify("map.A"))
    text, verdict = str(claim.printed), judge(claim).verdict

    for place in range(text.index(".") + 1, len(text)):
        mutant = text[:place] + str((int(text[place]) + 3) % 10) + text[place + 1 :]
        assert judge(replace(claim, printed=mutant)).verdict is not verdict, mutant


def test_certified_values_carry_a_radius_that_shrinks_with_the_digits():
    few, many = (next(verify("cuspless.lambda_c", digits)) for digits in (10, 40))

    assert float(many.radius) < 1e-39 < float(few.radius) < 1e-9
    assert many.value.startswith("0.09340033543136")  # (27 - 8*sqrt(11))/5 by mpmath at 60 digits
