"""A theorem as a frozen dataclass: its fields are the data, its docstring is the statement, and some methods are
hypotheses.

A method marked by `hypothesis` proves one hypothesis, which its docstring states. From the verdicts follow the
checklist, whether the theorem is proved, and the list of open hypotheses.

>>> from dataclasses import dataclass, replace
>>> @dataclass(frozen=True)
... class Converges(Theorem):
...     '''Every orbit of `x -> factor*x + shift` converges to one point.'''
...     factor: float
...     shift: float
...
...     @hypothesis
...     def contracting(self) -> bool:
...         '''The derivative is below 1 in modulus.'''
...         return abs(self.factor) < 1
>>> found = Converges(0.5, 1.0)
>>> found.proved, found.checks, replace(found, factor=2.0).open
(True, {'contracting': True}, {'contracting': 'The derivative is below 1 in modulus.'})
"""

from collections.abc import Callable
from functools import cached_property
from inspect import getdoc
from typing import Any, overload

Verdict = bool | None


class Hypothesis(cached_property[Verdict]):
    """The verdict of a method, computed once: True if proved, None if not proved, False if refuted."""

    def __init__(self, method: Callable[[Any], object], name: str, refutable: bool) -> None:
        def verdict(theorem: Any) -> Verdict:
            try:
                held = method(theorem)
            except ArithmeticError:  # an enclosure failed
                return None
            return True if held else False if refutable and held is False else None

        verdict.__doc__ = method.__doc__
        super().__init__(verdict)
        self.item, self.words = name or method.__name__, getdoc(method) or ""


@overload
def hypothesis(method: Callable[[Any], object], /) -> Hypothesis:
    """A hypothesis named after its method."""


@overload
def hypothesis(*, name: str = "", refutable: bool = False) -> Callable[[Callable[[Any], object]], Hypothesis]:
    """A decorator that makes a hypothesis with this name and this refutability."""


def hypothesis(
    method: Callable[[Any], object] | None = None, /, *, name: str = "", refutable: bool = False
) -> Hypothesis | Callable[[Callable[[Any], object]], Hypothesis]:
    """A hypothesis of a theorem, from the method that proves it.

    A result that is not true, or an `ArithmeticError`, means *not proved*: an enclosure that is too wide refutes
    nothing. Only a `refutable` hypothesis is refuted by `False`. `name` replaces the method's name in `checks`, for
    instance if a field has that name already.
    """
    return Hypothesis(method, name, refutable) if method else lambda given: Hypothesis(given, name, refutable)


class Theorem:
    """A statement about data, proved if all its hypotheses are; theorems are frozen dataclasses derived from it."""

    @classmethod
    def hypotheses(cls) -> dict[str, Hypothesis]:
        """The hypotheses by name, in order of definition; those of base classes come first."""
        members = (member for base in reversed(cls.__mro__) for member in vars(base).values())
        return {member.item: member for member in members if isinstance(member, Hypothesis)}

    @classmethod
    def statement(cls) -> str:
        """The statement in words: the docstring of the class."""
        return getdoc(cls) or ""

    @property
    def checks(self) -> dict[str, Verdict]:
        """The verdict on each hypothesis: True if proved, None if not proved, False if refuted."""
        return {name: each.__get__(self) for name, each in self.hypotheses().items()}

    @property
    def open(self) -> dict[str, str]:
        """The hypotheses that are not proved, by name, with their docstrings."""
        return {name: self.hypotheses()[name].words for name, verdict in self.checks.items() if verdict is not True}

    @property
    def proved(self) -> bool:
        """True if there is at least one hypothesis and all hypotheses are proved."""
        return bool(self.checks) and not self.open
