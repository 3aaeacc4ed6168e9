"""Runs the methods of a question and gives a row for each setting: errors against balls, medians of times.

Times are processor time of one core, which other work on the machine disturbs least.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

from verification.work.question import GUARD, Answer, Claimed, Method, Question, distance
from verification.work.row import Row, timed

RUNS = 5
SHORTEST = 1e-3  # seconds of a sample; what takes less is repeated within it
HOPELESS = 5.0  # seconds of a first call that is not made twice
PATIENCE = 0.4  # seconds for all runs of one setting; what takes longer runs once
Say = Callable[[str], None]


def silent(_: str) -> None:
    """Says nothing."""


def measured(question: Question, runs: int = RUNS, most_digits: int = 1000, say: Say = silent) -> list[Row]:
    """The rows of a question, method by method; `say` hears of each method before it runs.

    A method that raises a `ValueError` or an arithmetical error has no answer at that setting, and its row says why.
    """
    digits = min(most_digits, question.most_digits)
    say("the reference")
    reference = question.reference(digits + GUARD)
    rows: list[Row] = []
    for method in question.methods:
        say(method.name)
        rows += _rows(question, method, method.within(digits), reference, digits, runs)
    return rows


def _rows(
    question: Question, method: Method, settings: tuple[Any, ...], reference: Answer, digits: int, runs: int
) -> Iterator[Row]:
    if not settings:
        return
    if method.elsewhere:
        from verification.work.elsewhere import sampled

        found = sampled(question.name, method.name, settings, runs)
    else:
        found = [sample(method, setting, runs, warm=i > 0) for i, setting in enumerate(settings)]
    for setting, (answer, seconds, failure) in zip(settings, found, strict=True):
        least, error = (None, None) if answer is None else distance(answer, reference, digits)
        if answer is not None and error is None:
            failure = "no finite number"
        yield timed(
            question.name,
            method.name,
            [each / method.answers(setting) for each in seconds],
            arithmetic=method.arithmetic,
            setting=method.labelled(setting),
            error=error,
            least=least,
            promise=answer.claim if isinstance(answer, Claimed) else method.promise(setting),
            textbook=method.textbook,
            proved=method.proved,
            failure=failure,
            digits=setting if method.unit == "digits" else None,
        )


def sample(method: Method, setting: Any, runs: int, warm: bool = False) -> tuple[Answer | None, list[float], str]:
    """The answer at a setting, the seconds of some calls, and what went wrong; the first call warms up.

    A way so slow that `runs` of it would try the patience is timed less often, at least once; when it is `warm` by
    another setting, its first call may be that once.
    """
    clock = time.perf_counter(), time.process_time()
    answer, failure = None, ""
    try:
        answer = method.call(setting)
    except (ValueError, ArithmeticError) as error:
        failure = " ".join(str(error).split()) or type(error).__name__
    first, spent = time.perf_counter() - clock[0], time.process_time() - clock[1]
    if answer is None:
        return None, [spent], failure
    if first > PATIENCE and (warm or first > HOPELESS):
        return answer, [spent], ""
    repeats = max(1, int(SHORTEST / max(first, 1e-9)))
    seconds = []
    for _ in range(max(1, min(runs, int(PATIENCE / max(first, 1e-9))))):
        start = time.process_time()
        for _ in range(repeats):
            method.call(setting)
        seconds.append((time.process_time() - start) / repeats)
    return answer, seconds, ""
