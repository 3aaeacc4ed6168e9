"""How far a long proof has come: shares of the work are reported to a progress bar, if there is one.

A proof calls its `tick` with each share that is done and knows of no bar; `telling` makes such a function.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Tick = Callable[[float], None]
Hearer = Callable[[str, float], None]
_hearer: ContextVar[Hearer | None] = ContextVar("hearer", default=None)
STEP = 1e-3  # a bar shows no smaller share


@contextmanager
def heard(by: Hearer) -> Iterator[None]:
    """Within, `by` is called with what is being worked at and the share of it that is done.

    >>> heard_of = []
    >>> with heard(lambda about, share: heard_of.append((about, share))):
    ...     tick = telling("boxes")
    ...     tick(0.25)
    ...     tick(0.5)
    >>> heard_of
    [('boxes', 0.25), ('boxes', 0.75)]
    """
    before = _hearer.set(by)
    try:
        yield
    finally:
        _hearer.reset(before)


def silent(share: float) -> None:
    """The tick of a proof that nobody asked to tell."""


def telling(about: str) -> Tick:
    """A verb to call with each share that is done; it does nothing while nobody listens."""
    hear, done, told = _hearer.get(), 0.0, 0.0

    def tick(share: float) -> None:
        nonlocal done, told
        done += share
        if hear is not None and done - told >= STEP:
            told = done
            hear(about, min(done, 1.0))

    return tick
