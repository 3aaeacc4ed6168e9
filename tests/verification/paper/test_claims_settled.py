"""Numerical claims of the paper that have proofs, with their verdicts and values."""

import pytest
from sympy import Rational

from verification.arithmetic.iteration import heard
from verification.paper.claims.claim import Verdict
from verification.paper.egg.basins import without_triangles
from verification.paper.report.report import verify

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
    """Interval Newton at 20 digits against shooting in mpmath at 60; the slap infimum against a sampled minimum."""
    verdict, digits = LOCATED[name]
    (result,) = verify(name, digits=17)

    assert result.verdict is verdict
    assert result.value is not None
    assert result.value.startswith(digits)
    assert float(result.radius or 1) < 1e-16


@pytest.mark.parametrize("name", ["cuspless.corner_orbit", "cuspless.corner_orbit_unstable"])
def test_what_the_paper_says_of_the_corner_orbit_is_confirmed(name: str):
    (result,) = verify(name)

    assert result.verdict is Verdict.CONFIRMED


def test_period_3_is_excluded_up_to_the_fold_though_not_by_the_papers_argument():
    (conclusion,) = verify("egg.no_period3_caption")
    (argument,) = verify("egg.projection_misses")

    assert conclusion.verdict is argument.verdict is Verdict.CORRECTED
    assert "meets the diagonal" in argument.derived


def test_a_long_claim_tells_the_share_that_is_done():
    told: list[tuple[str, float]] = []
    with heard(lambda about, share: told.append((about, share))):
        without_triangles.__wrapped__(Rational(1, 20), Rational(1, 32))

    assert {about for about, _ in told} == {"triangles excluded at alpha = 1/20"}
    assert [share for _, share in told] == sorted(share for _, share in told)
    assert told[-1][1] > 0.99
