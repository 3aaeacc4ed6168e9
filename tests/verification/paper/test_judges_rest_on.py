"""Each step that a judge takes is one that its verdict rests on: left open, it leaves the claim open."""

import sys
from collections.abc import Callable

import pytest

from symbolic.expressions import signs
from symbolic.expressions.signs import Finding, Outcome
from verification.paper.claims import judges
from verification.paper.claims.claim import Judgement
from verification.paper.claims.folder import judge_of
from verification.paper.report.report import catalogue

STEPS = {
    name: getattr(home, name)
    for home, names in ((signs, "positive nonnegative"), (judges, "equal greater answer shown rounded implied"))
    for name in names.split()
}
OPEN = Finding(Outcome.UNKNOWN, "left open")
SPARE = {  # steps that the verdict does not need
    "ellipse.major_axis_eigenvalues": 1,  # what is printed is refuted at lam = 0, whatever the other inequality is
    "egg.alternating_points": 1,  # that the radius is positive is asked for the polygon, and proved of the table
}
SYMBOLIC = {claim.id: claim for claim in catalogue() if claim.kind != "numerical"}


def judged(name: str, step: Callable[[str, tuple], Finding], monkeypatch: pytest.MonkeyPatch) -> Judgement:
    """A claim's judgement, where each step of a proof is taken by another function."""
    claim = SYMBOLIC[name]
    judge = judge_of(claim)
    with monkeypatch.context() as patched:
        for module in [m for n, m in sys.modules.items() if n.startswith(("verification.paper", "symbolic."))]:
            for word, own in STEPS.items():
                if vars(module).get(word) is own:
                    patched.setattr(module, word, lambda *given, word=word: step(word, given))
        return judge(claim)


@pytest.mark.parametrize("name", SYMBOLIC)
def test_a_verdict_rests_on_each_step_of_its_proof(name, monkeypatch):
    known: dict[str, Finding] = {}
    asked: set[str] = set()

    def taken(word, given):
        key = f"{word}{given!r}"
        if key not in known:
            known[key] = STEPS[word](*given)
        asked.add(key)
        return known[key]

    judged(name, taken, monkeypatch)
    asked.clear()  # of steps that are known those are not asked of which they consist
    whole = judged(name, taken, monkeypatch).verdict
    spare = 0
    for left in {key for key in asked if known[key].outcome is not Outcome.UNKNOWN}:
        one = lambda word, given, left=left: OPEN if f"{word}{given!r}" == left else taken(word, given)  # noqa: E731
        spare += judged(name, one, monkeypatch).verdict is whole
    assert spare == SPARE.get(name, 0)
