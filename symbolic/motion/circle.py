"""The pinball map of the unit circle, explicit. Paper: section 3.1."""

from sympy import Expr, pi

from symbolic.tables.symbols import lam, phi, s


def flight(s: Expr = s, phi: Expr = phi) -> tuple[Expr, Expr]:
    """`(s1, phi1)`: the ball advances by `pi - 2*phi` and keeps `lam` of its angle.

    >>> flight()
    (-2*phi + s + pi, lam*phi)
    """
    return s + pi - 2 * phi, lam * phi


def iterate(n: int) -> tuple[Expr, Expr]:
    """The map applied `n` times, not reduced modulo the perimeter.

    >>> iterate(2)
    (-2*lam*phi - 2*phi + s + 2*pi, lam**2*phi)
    """
    state: tuple[Expr, Expr] = (s, phi)
    for _ in range(n):
        state = flight(*state)
    return state


def limit_position() -> Expr:
    """Where even bounces settle, as an arc length: `s - 2*phi/(1 - lam)`.

    >>> limit_position().subs(lam, 0)
    -2*phi + s
    """
    return s - 2 * phi / (1 - lam)
