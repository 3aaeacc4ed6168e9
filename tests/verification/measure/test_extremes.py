"""Stiff and extreme cases: each verdict is as recorded, and unstable cases are measured as unstable."""

import json
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from sympy import Rational

from numeric import Status
from verification.arithmetic.balls import multiprecision
from verification.cycles.critical import corner, corner_angle
from verification.cycles.newton import Conditioning, refined
from verification.measure.extremes import flights as cases
from verification.measure.extremes import kernels as products
from verification.measure.extremes import near, page
from verification.measure.extremes.flights import CASES, ReferenceState, Truth, findings
from verification.measure.extremes.kernels import KERNELS, LONGDOUBLE, TEXTBOOK
from verification.measure.extremes.near import SMALL, StabilityVerdict
from verification.measure.extremes.page import rows

DOCS = Path(page.__file__).parents[3] / "docs"
WIDE = np.finfo(np.longdouble).nmant >= 63


@pytest.fixture(scope="module")
def found():
    """The rows of all cases, computed once."""
    return list(rows())


@pytest.mark.slow
def test_every_verdict_and_every_outcome_is_as_recorded(found):
    kept = {
        (one["case"], one["kernel"]): (one["verdict"], one["stopped_by"]) for one in json.loads(page.RECORD.read_text())
    }
    now = {(one["case"], one["kernel"]): (one["verdict"], one["stopped_by"]) for one in page.record(found)}
    beyond = {one.name for one in chain(near.LONGER, products.LONGER)}
    missing = {key for key in kept if key not in now and key[0] not in beyond and (WIDE or key[1] != LONGDOUBLE.name)}

    assert {key: value for key, value in now.items() if kept.get(key) != value} == {}
    assert missing == set()


@pytest.mark.slow
def test_the_kernels_that_users_call_are_stable_or_name_why_they_stopped(found):
    own = [one for *_, several in found for one in several if one.kernel in ("llvm", "numpy", "engine")]

    assert len(own) > 100
    assert all(one.measured.backward <= SMALL if one.measured else one.status in Status.__members__ for one in own)


@pytest.mark.slow
def test_whatever_is_not_stable_says_what_to_use_in_its_place(found):
    odd = [one for *_, several in found for one in several if one.stability is not StabilityVerdict.STABLE]

    assert odd
    assert [one for one in odd if not one.instead] == []


def test_the_page_is_what_the_records_make():
    made = page.page(page.lines(page.RECORD), page.lines(page.LONG))

    assert (DOCS / "extremes.md").read_text() == made


@pytest.mark.slow
def test_whatever_is_not_plainly_stable_says_why_on_the_page(found):
    odd = [one for one in page.lines(page.RECORD) if one.verdict is not StabilityVerdict.STABLE or one.stopped_by]

    assert {one.case for one in odd} >= {one.case for *_, several in found for one in several if one.status}
    assert [one for one in odd if not one.reason] == []


@pytest.mark.slow
def test_what_newtons_method_names_by_itself_is_what_a_hundred_digits_measure(found):
    cycles = [one for *_, several in found for one in several if one.named is not None]

    assert {one.named for one in cycles} == set(Conditioning)
    assert [one for one in cycles if one.measured and one.stability is not one.measured.stability] == []


@pytest.mark.slow
@pytest.mark.parametrize("case", [case for case in CASES if "join, the angle" in case.name], ids=lambda case: case.name)
def test_a_join_is_named_where_the_true_flight_passes_it_and_nowhere_else(case):
    truth = Truth(case)
    for state in truth.starts(case):
        asked = ReferenceState(truth, state)
        miss, _ = asked.why(Status.JOIN.name)
        for kernel in KERNELS:
            if kernel.runs(truth.map):
                named = kernel.bounce(truth.map, state)[1] == Status.JOIN.name
                assert not named or miss < 10  # 2^-50 is 4 units of a way of at most 2, and the landing is off by two
                assert named or miss > 0.5


def test_the_corner_orbit_of_the_fixtures_is_the_proved_one():
    exact = refined(corner(), [0.25, 0.07], 30)
    words = multiprecision(type(exact.z[0]).context)

    assert abs(exact.z[1] - words.q(*Rational(cases.LAMBDA_STAR).as_numer_denom())) < 1e-27
    assert float(exact.z[0]) == cases.THETA_STAR
    assert float(corner_angle(words, exact.z[0])) == cases.PHI_STAR


def test_the_textbook_discriminant_is_called_unstable_where_it_is_and_nowhere_else():
    grazing = next(case for case in CASES if case.name.startswith("ellipse: exits grazing"))
    usual = next(case for case in CASES if case.name == "a = sqrt(2), exactly")
    verdicts = {case.name: {one.kernel: one.stability for one in findings(case)} for case in (grazing, usual)}

    assert verdicts[grazing.name][TEXTBOOK.name] is StabilityVerdict.UNSTABLE
    assert verdicts[grazing.name]["llvm"] is StabilityVerdict.STABLE
    assert verdicts[usual.name][TEXTBOOK.name] is StabilityVerdict.STABLE


def test_the_condition_number_next_to_a_fold_is_one_over_the_multipliers_distance():
    tight, tighter = (near.findings(near.CYCLES[i])[0].measured.condition for i in (0, 1))

    assert tighter / tight == pytest.approx(float(near.COARSE_GAP / near.FINE_GAP), rel=1e-4)


@pytest.mark.slow
def test_no_forward_error_exceeds_condition_times_backward(found):
    flights = [one.measured for *_, several in found[: len(CASES)] for one in several if one.measured]

    assert all(m.forward <= m.condition * m.backward * 1.001 for m in flights if np.isfinite(m.forward))
