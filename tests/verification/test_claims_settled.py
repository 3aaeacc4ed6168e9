"""Numerical claims of the paper that proofs have settled, with what they came out as."""

import pytest

from verification.claims import verify
from verification.claims.claim import Verdict

LOCATED = {
    "cuspless.lambda_star": (Verdict.CORRECTED, "0.07121724524891598"),
    "cuspless.phi_star": (Verdict.CORRECTED, "-0.028979473786913"),
    "egg.doubling.3": (Verdict.CORRECTED, "0.3712355025279195"),
    "egg.doubling.4": (Verdict.CONFIRMED, "0.3887610234608403"),
    "egg.doubling.5": (Verdict.CONFIRMED, "0.3925015164860755"),
    "egg.doubling.6": (Verdict.CORRECTED, "0.3933022270938691"),
    "egg.saddle_node": (Verdict.CONFIRMED, "0.378121252590090"),
    "cardioid.slap_expanding": (Verdict.CONFIRMED, "1.506262239365"),
}


@pytest.mark.parametrize("name", LOCATED)
def test_a_certified_value_judges_the_printed_digits(name: str):
    """Digits: interval Newton at 20 digits beside mpmath shooting at 60; the slap infimum beside a sampled minimum."""
    verdict, digits = LOCATED[name]
    (result,) = verify(name, digits=17)

    assert result.verdict is verdict
    assert result.value is not None
    assert result.value.startswith(digits)
    assert float(result.radius or 1) < 1e-16


@pytest.mark.parametrize("name", ["cuspless.unstable_period4", "cuspless.corner_orbit", "cuspless.slap_no_period4"])
def test_what_the_paper_expects_or_sees_in_a_graph_is_confirmed(name: str):
    (result,) = verify(name)

    assert result.verdict is Verdict.CONFIRMED


def test_period_3_is_excluded_up_to_the_fold_though_not_by_the_papers_argument():
    (conclusion,) = verify("egg.no_period3_caption")
    (argument,) = verify("egg.projection_misses")

    assert conclusion.verdict is argument.verdict is Verdict.CORRECTED
    assert "meets the diagonal" in argument.derived


@pytest.mark.parametrize("name", ["egg.merging_crisis", "egg.boundary_crisis", "cardioid.slap_ergodic", "egg.cascade"])
def test_what_sampling_or_extrapolation_shows_is_supported_and_not_confirmed(name: str):
    (result,) = verify(name)

    assert result.verdict is Verdict.SUPPORTED
