"""Flights in the cuspless cardioid, in balls: where a piece of phase space lands.

A landing is enclosed by an interval Newton step on the chord angle, from a guess in floats.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import arb
from sympy import pi, sqrt

from symbolic.chords import chord_kernel
from symbolic.codegen import kernel, load
from symbolic.tables import cuspless
from verification.arithmetic import FLOAT64, balls, working

BITS = 64
ARC, WALL = 0, 1
Angles = dict[tuple[int, int], Callable[..., Any]]
TURN = 6.283185307179586


@dataclass(frozen=True)
class Piece:
    """A stretch of a component, the exit angles there, and the slope of the slap map that led there."""

    component: int
    theta: arb
    slope: arb
    phi: arb


@cache
def _loaded() -> tuple[Angles, Angles, dict[int, arb]]:
    pairs = ((ARC, ARC), (ARC, WALL), (WALL, ARC))
    kernels = {pair: chord_kernel(cuspless, *pair, 1) for pair in pairs}
    enclosing = {pair: load(made, balls(BITS)) for pair, made in kernels.items()}
    guessing = {pair: load(made, FLOAT64) for pair, made in kernels.items()}
    with working(BITS):
        arc, wall = load(kernel("ends", [], {"arc": 2 * pi / 3, "wall": sqrt(3) / 4}), balls(BITS))()
    return enclosing, guessing, {ARC: arc, WALL: wall}


class Flights:
    """The map of the cuspless cardioid on pieces, for all contractions of a ball."""

    def __init__(self, lam: arb | int = 0) -> None:
        self.lam = lam
        self.balls, self.floats, self.ends = _loaded()

    def iterated(self, pieces: list[Piece], n: int) -> list[Piece] | None:
        """The images under `n` flights; None when one could not be enclosed."""
        for _ in range(n):
            following: list[Piece] = []
            for piece in pieces:
                landed = self.landing(piece)
                if landed is None:
                    return None
                following += landed
            pieces = following
        return pieces

    def landing(self, piece: Piece) -> list[Piece] | None:
        """The image of a piece: one piece, or up to three when it may straddle the joins; None when not enclosed.

        The table is convex, so a root of the chord angle that is proved to lie on the boundary is the
        landing. Floats guess on which part: the wall when the ray passes between the corners. When the root
        there may lie beyond a corner, the place where the ray meets the line of the wall tells which parts
        are possible: the upper arc unless that is below the upper corner, the lower one unless it is above the
        lower corner, and each of them has to be enclosed.
        """
        if piece.component == WALL:
            landed = self._root(piece, ARC, -1.05, 1.05)
            return [landed] if landed and abs(landed.theta) < self.ends[ARC] else None
        start, edge = float(piece.theta.mid()), float(self.ends[ARC])
        roots = {
            "upper": lambda: self._root(piece, ARC, start, edge + 0.2),
            "wall": lambda: self._root(piece, WALL, -0.6, 0.6),
            "lower": lambda: self._root(piece, ARC, TURN - edge - 0.2, start + TURN),
        }
        guess = self._guess(start, float(piece.phi.mid()), edge)
        first = roots[guess]()
        if first is None:
            return None
        if abs(first.theta) < self.ends[first.component]:
            return [first]
        wall = first if guess == "wall" else roots["wall"]()
        if wall is None:
            return None
        found: list[Piece | None] = [wall]
        if not wall.theta > -self.ends[WALL]:  # the wall's parameter grows downwards
            found.append(first if guess == "upper" else roots["upper"]())
        if not wall.theta < self.ends[WALL]:
            found.append(first if guess == "lower" else roots["lower"]())
        return _all(*found)

    def _guess(self, start: float, phi: float, edge: float) -> str:
        near = self.floats[ARC, ARC]
        if start > edge - 1e-6 or (start > -edge + 1e-6 and near(start, -edge)[0] > phi):
            return "lower"
        return "upper" if start < -edge + 1e-6 or near(start, edge)[0] < phi else "wall"

    def _root(self, piece: Piece, target: int, low: float, high: float) -> Piece | None:
        """The landing on a component, enclosed by an interval Newton step from a guess in floats."""
        angle, near = self.balls[piece.component, target], self.floats[piece.component, target]
        start, phi = float(piece.theta.mid()), float(piece.phi.mid())
        for _ in range(60):
            middle = (low + high) / 2  # the angle falls along the boundary
            low, high = (middle, high) if near(start, middle)[0] > phi else (low, middle)
        guess = (low + high) / 2 - (TURN if high > TURN / 2 else 0)
        radius = 4 * float(piece.theta.rad() + piece.phi.rad()) + 1e-12
        for _ in range(6):
            box = arb(guess, radius)
            image = guess - (angle(piece.theta, arb(guess))[0] - piece.phi) / angle(piece.theta, box)[2]
            if image.is_finite() and box.contains_interior(image):
                over = angle(piece.theta, image)
                phi_1 = -self.lam * self.balls[target, piece.component](image, piece.theta)[0] + arb(0)
                return Piece(target, image, -piece.slope * over[1] / over[2], phi_1)
            radius *= 2
        return None


def _all(*pieces: Piece | None) -> list[Piece] | None:
    found = [p for p in pieces if p is not None]
    return found if len(found) == len(pieces) else None
