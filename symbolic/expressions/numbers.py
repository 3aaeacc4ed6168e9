"""What a number system is: the meaning of the closed vocabulary for one kind of number.

Generated text (`symbolic.expressions.text`) and programs (`numeric.lowering.program`) speak the same words: `+ - * /`,
`q(p, n)` for a rational, `pi`, and elementary functions. A `NumberSystem[N]` gives them a meaning for numbers of type
`N`: floats, arrays, LLVM vectors, mpmath numbers, balls, jets. Checked by mypy, never at run time; imports nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, Self, TypeVar

T = TypeVar("T")


class Number(Protocol):
    """What generated text does with a number besides calling functions."""

    def __add__(self, other: Self, /) -> Self: ...
    def __sub__(self, other: Self, /) -> Self: ...
    def __mul__(self, other: Self, /) -> Self: ...
    def __truediv__(self, other: Self, /) -> Self: ...
    def __neg__(self) -> Self: ...


R = TypeVar("R", bound=Number)


class Real(Number, Protocol):
    """A number with an order. A comparison gives a mask of its number system, which Python's types cannot say."""

    def __abs__(self) -> Self: ...
    def __lt__(self, other: Self, /) -> Any: ...
    def __le__(self, other: Self, /) -> Any: ...
    def __eq__(self, other: object, /) -> Any: ...


class Mask(Protocol):
    """Where a comparison holds: a truth value, or one for each lane or element."""

    def __and__(self, other: Self, /) -> Self: ...
    def __or__(self, other: Self, /) -> Self: ...


class NumberSystem(Protocol[T]):
    """The words that every number system knows."""

    @property
    def pi(self) -> T: ...
    def q(self, p: int, n: int, /) -> T: ...
    def sqrt(self, x: T, /) -> T: ...
    def sin(self, x: T, /) -> T: ...
    def cos(self, x: T, /) -> T: ...


@dataclass(frozen=True)
class Words(Generic[T]):
    """A number system written down word by word; one that a kernel does not use may be left out.

    >>> from fractions import Fraction
    >>> Words(Fraction).q(1, 3)
    Fraction(1, 3)
    """

    q: Callable[[int, int], T]
    pi: T
    sqrt: Callable[[T], T]
    sin: Callable[[T], T]
    cos: Callable[[T], T]
    atan: Callable[[T], T]
    exp: Callable[[T], T]
    log: Callable[[T], T]
