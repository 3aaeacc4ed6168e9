"""The judges: each turns what is printed and what is derived into a judgement.

A judge never looks for what is hoped: an identity is proved by reduction or refuted by a ball at a
witness; a printed range is judged with its ends; a repair counts only when it is proved too.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

from flint import fmpq
from sympy import AccumBounds, Expr, Interval, Matrix, Rational, S, Symbol, nan, oo, zoo
from sympy.logic.boolalg import Boolean
from sympy.logic.inference import satisfiable

from symbolic.expressions.signs import Box, Finding, Outcome, conjunction, placed, vanishes
from verification.arithmetic.balls import enclose, real_ball
from verification.paper.claims.claim import Claim, Judgement, Number

Judge = Callable[[Claim], Judgement]
JUDGES: dict[tuple[str, str], Judge] = {}  # by the module and the claim's id: two papers may use one id
WITHOUT_VALUE = (zoo, nan, oo, -oo, AccumBounds)  # what SymPy makes of a formula at a pole


def judges(*ids: str) -> Callable[[Judge], Judge]:
    """Enters a function as the judge of the claims named.

    The ids are read before anything runs: they are written out, and the decorator begins its line.
    """

    def enter(judge: Judge) -> Judge:
        JUDGES.update(dict.fromkeys(((judge.__module__, name) for name in ids), judge))
        return judge

    return enter


def identity(claim: Claim, derived: Expr | Matrix, mend: tuple[str, str] | None = None, erratum: str = "") -> Judgement:
    """Is the printed formula equal to the derived one? `mend` replaces the text that is misprinted."""
    finding = equal(claim.formula, derived, claim.box)
    if mend is None:
        return Judgement(finding, text_of(derived))
    return Judgement(finding, text_of(derived), equal(mended(claim, *mend).formula, derived, claim.box), erratum)


def mended(claim: Claim, wrong: str, right: str) -> Claim:
    """The claim with one piece of printed text replaced, wherever it stands once.

    >>> mended(Claim("t.x", "1", "", "identity", "a + 2"), "2", "3").printed
    'a + 3'
    """

    def repaired(text: str) -> str:
        return text.replace(wrong, right) if text.count(wrong) == 1 else text

    printed = claim.printed
    if isinstance(printed, str):
        return replace(claim, printed=repaired(printed))
    rows = [repaired(row) if isinstance(row, str) else [repaired(entry) for entry in row] for row in printed]
    return replace(claim, printed=rows)  # type: ignore[arg-type]  # rows keep the kind that they had


def equal(left: Expr | Matrix, right: Expr | Matrix, box: Box) -> Finding:
    """Are two formulas the same function? Proved by reduction to 0, refuted by a ball that excludes 0.

    >>> from symbolic.tables.table import lam
    >>> equal(lam**2 - 1, (lam - 1) * (lam + 1), {}).outcome.name
    'PROVED'
    >>> equal(lam, 2 * lam, {}).outcome.name
    'REFUTED'
    """
    if isinstance(left, Matrix) or isinstance(right, Matrix):
        left, right = Matrix(left), Matrix(right)
        if left.shape != right.shape:
            return Finding(Outcome.REFUTED, f"the shapes {left.shape} and {right.shape} differ")
        findings = []
        for i in range(left.rows):
            for j in range(left.cols):
                finding = equal(left[i, j], right[i, j], box)
                where = "" if finding else f"entry ({i + 1}, {j + 1}): "
                findings.append(replace(finding, reason=where + finding.reason))
        return conjunction(*findings)
    difference = left - right
    # A ball that excludes 0 is cheaper than a reduction, and there is none where the two agree.
    for point in witnesses(difference.free_symbols, box):
        value = difference.subs(point)
        if value.has(*WITHOUT_VALUE):  # a pole: nothing can be told there
            continue
        ball = enclose(value)
        if ball.is_finite() and not ball.contains(0):
            where = ", ".join(f"{x} = {v}" for x, v in point.items()) or "this number"
            reason = f"at {where} the two differ by {ball.str(6, radius=False)}"
            return placed(Finding(Outcome.REFUTED, reason, tuple(point.items())), box)
    if vanishes(difference):
        return Finding(Outcome.PROVED, "exact reduction to 0")
    return Finding(Outcome.UNKNOWN, "neither reduced to 0 nor told apart at a witness")


def witnesses(letters: Iterable[Symbol], box: Box) -> list[dict[Symbol, Expr]]:
    """A few rational points, inside the ranges given, (0, 1) for letters without one."""
    points: list[dict[Symbol, Expr]] = [{}, {}, {}]
    for n, x in enumerate(sorted(letters, key=str)):
        interval = box.get(x, Interval(0, 1))
        low, high = interval.start, interval.end
        for k, point in enumerate(points):
            share = Rational(2 + k + n, 9 + 2 * n + k)
            point[x] = low + share * 3 if high is oo else low + share * (high - low)
    return points


def digits(claim: Claim, value: Number, mend: tuple[str, str] | None = None) -> Judgement:
    """Is the printed decimal the true value, correctly rounded? `mend` is the misprint and what it should read."""
    shown_value = text_of(value) if isinstance(value, Expr) else real_ball(value, 20).str(15, radius=False) + "..."
    finding = rounded(str(claim.printed), value)
    if mend is None:
        return Judgement(finding, shown_value, value=value)
    wrong, right = mend
    repaired = str(mended(claim, wrong, right).printed)
    return Judgement(finding, shown_value, rounded(repaired, value), f"{wrong} should read {right}", value)


def rounded(decimal: str, value: Number) -> Finding:
    """Does `decimal` show `value` rounded to its last place?

    >>> from sympy import sqrt
    >>> rounded("1.414", sqrt(S(2))).outcome.name, rounded("1.415", sqrt(S(2))).outcome.name
    ('PROVED', 'REFUTED')
    """
    shown_value = Fraction(decimal)
    places = len(decimal.partition(".")[2])
    ball = real_ball(value)
    gap = abs(ball - fmpq(shown_value.numerator, shown_value.denominator))
    room = fmpq(1, 2 * 10**places) - gap
    true = ball.str(places + 6, radius=False)
    if room > 0:
        return Finding(Outcome.PROVED, f"the true value {true}... rounds to {decimal}")
    if room < 0:
        return Finding(Outcome.REFUTED, f"the true value {true}... does not round to {decimal}")
    return Finding(Outcome.UNKNOWN, "the enclosure does not decide the rounding")


def on_range(
    claim: Claim,
    prove: Callable[[Mapping[Symbol, Interval]], Finding],
    derived: str,
    right: Mapping[Symbol, Interval] | None = None,
    erratum: str = "",
) -> Judgement:
    """Does a statement hold over the printed range, ends included? `right` is the range where it does."""
    finding = prove(claim.box)
    if right is None:
        return Judgement(finding, derived)
    return Judgement(finding, derived, prove({**claim.box, **right}), erratum)


def by(argument: str, *findings: Finding) -> Finding:
    """An argument in one sentence that rests on findings: proved when each of them is."""
    whole = conjunction(*findings)
    return Finding(whole.outcome, f"{argument} [{whole.reason}]" if whole else whole.reason)


def counterexample(argument: str, *findings: Finding, at: Mapping[Symbol, Expr] | None = None) -> Finding:
    """What is printed is refuted when every finding on the counterexample is proved.

    `at` is where it fails, a value for each letter whose printed range is more than a point.
    """
    whole = conjunction(*findings)
    witness = tuple((at or {}).items())
    return Finding(Outcome.REFUTED if whole else Outcome.UNKNOWN, f"{argument} [{whole.reason}]", witness)


def greater(left: Expr, right: Expr) -> Finding:
    """Is one real number larger than another? Decided by balls.

    >>> from sympy import pi
    >>> greater(pi, S(3)).outcome.name
    'PROVED'
    """
    gap = enclose(left - right).real
    if gap > 0:
        return Finding(Outcome.PROVED, f"{left} > {right}")
    if gap <= 0:
        return Finding(Outcome.REFUTED, f"{left} <= {right}")
    return Finding(Outcome.UNKNOWN, f"no order of {left} and {right} is proved")


def shown(argument: str, holds: bool | None) -> Finding:
    """An exact decision of SymPy (`True`, `False`, or `None` for undecided) as a finding."""
    outcome = {True: Outcome.PROVED, False: Outcome.REFUTED}.get(holds, Outcome.UNKNOWN)  # type: ignore[arg-type]
    return Finding(outcome, argument)


def answer(holds: bool | None, reason: str) -> Finding:
    """A proof in balls as a finding: one that fails refutes nothing.

    >>> answer(True, "").outcome.name, answer(False, "").outcome.name
    ('PROVED', 'UNKNOWN')
    """
    return Finding(Outcome.PROVED if holds else Outcome.UNKNOWN, reason)


def sampled(derived: str, evidence: str, agrees: bool) -> Judgement:
    """A claim that sampling supports within the error it states, and leaves open where it does not."""
    return Judgement(Finding(Outcome.UNKNOWN, evidence), derived, evidence=evidence if agrees else "")


def implied(argument: str, proposition: Boolean) -> Finding:
    """A step of logic alone: proved when no assignment of truth values makes `proposition` false, refuted by one.

    >>> from sympy.abc import p, q
    >>> implied("", (p & q) >> p).outcome.name, implied("", p >> (p & q)).outcome.name
    ('PROVED', 'REFUTED')
    """
    false_at = satisfiable(~proposition)
    if not false_at:
        return Finding(Outcome.PROVED, argument)
    return Finding(Outcome.REFUTED, f"it fails where {', '.join(f'{x} is {v}' for x, v in false_at.items())}")


def zero(argument: str, *expressions: Expr) -> Finding:
    """An argument that rests on expressions vanishing identically."""
    whole = conjunction(*(equal(expression, S.Zero, {}) for expression in expressions))
    return Finding(whole.outcome, argument if whole and argument else whole.reason)


def text_of(derived: Expr | Matrix) -> str:
    """A derived formula on one line."""
    return str(derived.tolist()) if isinstance(derived, Matrix) else str(derived)
