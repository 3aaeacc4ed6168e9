"""What the judges of a paper of your own import: `from verification.judging import Claim, Judgement, identity, judges`.

`judges` registers a function for the ids of sentences. It returns a `Judgement`, which the others make: `identity` for
a formula, `digits` for a number, `sampled` for evidence. A proof is a finding: `zero`, `equal`, `greater` and `answer`
make one, and `by` and `counterexample` join several. See docs/how_to/judge_a_paper.md.
"""

from verification.paper.claims.claim import Claim, Judgement, Verdict
from verification.paper.claims.judges import (
    answer,
    by,
    counterexample,
    digits,
    equal,
    greater,
    identity,
    judges,
    sampled,
    zero,
)

__all__ = [
    "Claim",
    "Judgement",
    "Verdict",
    "answer",
    "by",
    "counterexample",
    "digits",
    "equal",
    "greater",
    "identity",
    "judges",
    "sampled",
    "zero",
]
