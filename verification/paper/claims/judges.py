"""The decorator that registers judges, and steps that many judgements share.

An identity is proved by reduction, or refuted by a ball at a witness. Printed ranges are judged including their end
points. A correction counts only if it is proved too.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

from flint import fmpq
from sympy import AccumBounds, Expr, Interval, Matrix, Rational, S, Symbol, nan, oo, zoo
from sympy.logic.boolalg import Boolean
from sympy.logic.inference import satisfiable

from symbolic.expressions.signs import Box, Outcome, SignFinding, conjunction, placed, vanishes
from verification.arithmetic.balls import enclose, real_ball
from verification.paper.claims.claim import Claim, Judgement, Number

Judge = Callable[[Claim], Judgement]
JUDGES: dict[tuple[str, str], Judge] = {}  # by module and id: two papers may use one id
WITHOUT_VALUE = (zoo, nan, oo, -oo, AccumBounds)  # SymPy's results at a pole


def judges(*ids: str) -> Callable[[Judge], Judge]:
    """Registers a function as the judge of the claims with these ids.

    The ids are read from the source text before any code runs. So they must be literals, and the decorator must be at
    the beginning of its line.
    """

    def enter(judge: Judge) -> Judge:
        JUDGES.update(dict.fromkeys(((judge.__module__, name) for name in ids), judge))
        return judge

    return enter


def identity(claim: Claim, derived: Expr | Matrix, mend: tuple[str, str] | None = None, erratum: str = "") -> Judgement:
    """The judgement on a printed formula, by comparison with the derived one; `mend` replaces misprinted text."""
    finding = equal(claim.formula, derived, claim.box)
    if mend is None:
        return Judgement(finding, text_of(derived))
    return Judgement(finding, text_of(derived), equal(mended(claim, *mend).formula, derived, claim.box), erratum)


def mended(claim: Claim, wrong: str, right: str) -> Claim:
    """The claim, with `wrong` replaced by `right` in each printed formula that contains `wrong` exactly once.

    >>> mended(Claim("t.x", "1", "", "identity", "a + 2"), "2", "3").printed
    'a + 3'
    """

    def repaired(text: str) -> str:
        return text.replace(wrong, right) if text.count(wrong) == 1 else text

    printed = claim.printed
    if isinstance(printed, str):
        return replace(claim, printed=repaired(printed))
    rows = [repaired(row) if isinstance(row, str) else [repaired(entry) for entry in row] for row in printed]
    return replace(claim, printed=rows)  # type: ignore[arg-type]  # rows keep their type


def equal(left: Expr | Matrix, right: Expr | Matrix, box: Box) -> SignFinding:
    """The finding that two formulas are equal: proved by reduction to 0, refuted by a ball that excludes 0.

    >>> from symbolic.tables.table import lam
    >>> equal(lam**2 - 1, (lam - 1) * (lam + 1), {}).outcome.name
    'PROVED'
    >>> equal(lam, 2 * lam, {}).outcome.name
    'REFUTED'
    """
    if isinstance(left, Matrix) or isinstance(right, Matrix):
        left, right = Matrix(left), Matrix(right)
        if left.shape != right.shape:
            return SignFinding(Outcome.REFUTED, f"the shapes {left.shape} and {right.shape} differ")
        findings = []
        for i in range(left.rows):
            for j in range(left.cols):
                finding = equal(left[i, j], right[i, j], box)
                where = "" if finding else f"entry ({i + 1}, {j + 1}): "
                findings.append(replace(finding, reason=where + finding.reason))
        return conjunction(*findings)
    difference = left - right
    # A ball that excludes 0 is cheaper to find than a reduction.
    for point in witnesses(difference.free_symbols, box):
        value = difference.subs(point)
        if value.has(*WITHOUT_VALUE):  # a pole, which decides nothing
            continue
        ball = enclose(value)
        if ball.is_finite() and not ball.contains(0):
            where = ", ".join(f"{x} = {v}" for x, v in point.items()) or "this number"
            reason = f"at {where} the two differ by {ball.str(6, radius=False)}"
            return placed(SignFinding(Outcome.REFUTED, reason, tuple(point.items())), box)
    if vanishes(difference):
        return SignFinding(Outcome.PROVED, "exact reduction to 0")
    return SignFinding(Outcome.UNKNOWN, "neither reduced to 0 nor told apart at a witness")


def witnesses(letters: Iterable[Symbol], box: Box) -> list[dict[Symbol, Expr]]:
    """A few rational points inside the given ranges, or in (0, 1) for symbols without a range."""
    points: list[dict[Symbol, Expr]] = [{}, {}, {}]
    for n, x in enumerate(sorted(letters, key=str)):
        interval = box.get(x, Interval(0, 1))
        low, high = interval.start, interval.end
        for k, point in enumerate(points):
            share = Rational(2 + k + n, 9 + 2 * n + k)
            point[x] = low + share * 3 if high is oo else low + share * (high - low)
    return points


def digits(claim: Claim, value: Number, mend: tuple[str, str] | None = None) -> Judgement:
    """The judgement on a printed decimal, by the true value; `mend` has the misprint and its correction."""
    shown_value = text_of(value) if isinstance(value, Expr) else real_ball(value, 20).str(15, radius=False) + "..."
    finding = rounded(str(claim.printed), value)
    if mend is None:
        return Judgement(finding, shown_value, value=value)
    wrong, right = mend
    repaired = str(mended(claim, wrong, right).printed)
    return Judgement(finding, shown_value, rounded(repaired, value), f"{wrong} should read {right}", value)


def rounded(decimal: str, value: Number) -> SignFinding:
    """The finding that `decimal` is `value` rounded to its last place.

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
        return SignFinding(Outcome.PROVED, f"the true value {true}... rounds to {decimal}")
    if room < 0:
        return SignFinding(Outcome.REFUTED, f"the true value {true}... does not round to {decimal}")
    return SignFinding(Outcome.UNKNOWN, "the enclosure does not decide the rounding")


def on_range(
    claim: Claim,
    prove: Callable[[Mapping[Symbol, Interval]], SignFinding],
    derived: str,
    right: Mapping[Symbol, Interval] | None = None,
    erratum: str = "",
) -> Judgement:
    """The judgement on a statement over the printed range; `right` is the range over which it does hold."""
    finding = prove(claim.box)
    if right is None:
        return Judgement(finding, derived)
    return Judgement(finding, derived, prove({**claim.box, **right}), erratum)


def by(argument: str, *findings: SignFinding) -> SignFinding:
    """The finding on an argument that rests on `findings`: proved if all of them are proved."""
    whole = conjunction(*findings)
    return SignFinding(whole.outcome, f"{argument} [{whole.reason}]" if whole else whole.reason)


def counterexample(argument: str, *findings: SignFinding, at: Mapping[Symbol, Expr] | None = None) -> SignFinding:
    """The finding that refutes the printed claim, if all `findings` on the counterexample are proved.

    `at` is the point at which the claim fails: a value for each symbol whose printed range is not a single point.
    """
    whole = conjunction(*findings)
    witness = tuple((at or {}).items())
    return SignFinding(Outcome.REFUTED if whole else Outcome.UNKNOWN, f"{argument} [{whole.reason}]", witness)


def greater(left: Expr, right: Expr) -> SignFinding:
    """The finding that `left` is larger than `right` (two real numbers), decided in balls.

    >>> from sympy import pi
    >>> greater(pi, S(3)).outcome.name
    'PROVED'
    """
    gap = enclose(left - right).real
    if gap > 0:
        return SignFinding(Outcome.PROVED, f"{left} > {right}")
    if gap <= 0:
        return SignFinding(Outcome.REFUTED, f"{left} <= {right}")
    return SignFinding(Outcome.UNKNOWN, f"no order of {left} and {right} is proved")


def shown(argument: str, holds: bool | None) -> SignFinding:
    """The finding from an exact decision by SymPy: `True`, `False`, or `None` if undecided."""
    outcome = {True: Outcome.PROVED, False: Outcome.REFUTED}.get(holds, Outcome.UNKNOWN)  # type: ignore[arg-type]
    return SignFinding(outcome, argument)


def answer(holds: bool | None, reason: str) -> SignFinding:
    """The finding from a three-valued proof: proved or, if the proof fails, unknown (never refuted).

    >>> answer(True, "").outcome.name, answer(False, "").outcome.name
    ('PROVED', 'UNKNOWN')
    """
    return SignFinding(Outcome.PROVED if holds else Outcome.UNKNOWN, reason)


def sampled(derived: str, evidence: str, agrees: bool) -> Judgement:
    """The judgement on a sampled claim: supported if the sample agrees within its stated error, else open."""
    return Judgement(SignFinding(Outcome.UNKNOWN, evidence), derived, evidence=evidence if agrees else "")


def implied(argument: str, proposition: Boolean) -> SignFinding:
    """The finding on a logical step: proved if `proposition` is a tautology, otherwise refuted by an assignment.

    >>> from sympy.abc import p, q
    >>> implied("", (p & q) >> p).outcome.name, implied("", p >> (p & q)).outcome.name
    ('PROVED', 'REFUTED')
    """
    false_at = satisfiable(~proposition)
    if not false_at:
        return SignFinding(Outcome.PROVED, argument)
    return SignFinding(Outcome.REFUTED, f"it fails where {', '.join(f'{x} is {v}' for x, v in false_at.items())}")


def zero(argument: str, *expressions: Expr) -> SignFinding:
    """The finding on an argument that holds if all the expressions vanish identically."""
    whole = conjunction(*(equal(expression, S.Zero, {}) for expression in expressions))
    return SignFinding(whole.outcome, argument if whole and argument else whole.reason)


def text_of(derived: Expr | Matrix) -> str:
    """A derived formula as text on one line."""
    return str(derived.tolist()) if isinstance(derived, Matrix) else str(derived)
