"""The questions of the work-precision diagrams, by name; each is made when it is asked."""

from collections.abc import Callable, Mapping
from importlib import import_module

from verification.work.question import Question


def _made(module: str, maker: str, *arguments: str) -> Callable[[], Question]:
    def make() -> Question:
        found: Question = getattr(import_module(f"verification.work.{module}"), maker)(*arguments)
        return found

    return make


QUESTIONS: Mapping[str, Callable[[], Question]] = {
    "step-egg": _made("flights", "steps", "egg"),
    "step-cardioid": _made("flights", "steps", "cardioid"),
    "jacobian": _made("flights", "jacobians"),
    "cycle-2": _made("cycles", "period_2"),
    "cycle-3": _made("cycles", "period_3"),
    "cycle-64": _made("cycles", "period_64"),
    "lambda-star": _made("values", "corner_orbit"),
    "fold-3": _made("cycles", "fold"),
    "doubling": _made("cycles", "doublings"),
    "exponent-cycle": _made("exponents", "of_a_cycle"),
    "exponent-chaos": _made("exponents", "of_chaos"),
    "arclength": _made("lengths", "lengths"),
    "arclength-inverse": _made("lengths", "parameters"),
    "slap-infimum": _made("values", "slap_infimum"),
}


def question(name: str) -> Question:
    """The question called `name`.

    >>> question("lambda-star").name
    'lambda-star'
    """
    if name not in QUESTIONS:
        raise ValueError(f"QUESTION = {name} is none that is measured; accepted: {', '.join(QUESTIONS)}")
    return QUESTIONS[name]()
