"""All cycles of a slap map up to a period, enclosed: the cuspless cardioid has none of period 4.

The slap map is one-dimensional, so subdivision settles it: a piece of the boundary is followed in
balls, each landing enclosed by an interval Newton step on the chord angle. A piece that does not
meet its image holds no periodic point; where `(T0**n)' - 1` keeps its sign it holds at most one; and
pieces that touch are joined, so that what is left are as many periodic points as are known already.
Paper: section 5.4 (`the graph of the 4th iterate confirms that there are no period-4 orbits`).
"""

from dataclasses import dataclass

from flint import arb
from sympy import pi, sqrt

from symbolic.chords import chord_kernel
from symbolic.codegen import kernel, load
from symbolic.tables import cuspless
from verification.arithmetic import FLOAT64, balls, working

BITS = 64
ARC, WALL = 0, 1
SMALLEST = 2.0**-30
TURN = 6.283185307179586


@dataclass(frozen=True)
class Piece:
    """A stretch of a component, and the derivative of what brought a ball there, in boundary parameters."""

    component: int
    theta: arb
    slope: arb


@dataclass(frozen=True)
class PeriodicPoints:
    """Stretches that hold at most one solution of `T0**n(x) = x` each, and all of them; None when open."""

    stretches: list[tuple[int, float, float]] | None
    boxes: int


def periodic_points(n: int, budget: int = 200_000) -> PeriodicPoints:
    """Where `T0**n(x) = x` on the cuspless cardioid, in stretches of the arc and of the wall.

    >>> [(c, round(a, 2), round(b, 2)) for c, a, b in periodic_points(2).stretches or []]
    [(0, -1.12, -0.99), (0, -0.02, 0.02), (0, 0.99, 1.12), (1, -0.01, 0.01)]
    """
    with working(BITS):
        slap = _Slap()
        found: list[tuple[int, float, float]] = []
        queue = [(ARC, *_halves(slap.ends[ARC])), (WALL, *_halves(slap.ends[WALL]))]
        boxes = 0
        while queue:
            component, middle, half = queue.pop()
            boxes += 1
            if boxes > budget or half < SMALLEST:
                return PeriodicPoints(None, boxes)
            box = arb(middle, half)
            images = slap.iterated([Piece(component, box, arb(1))], n)
            if images is not None and not any(p.component == component and p.theta.overlaps(box) for p in images):
                continue
            if images is not None and len(images) == 1 and _monotone(images[0].slope) and half < 1e-2:
                found.append((component, middle - half, middle + half))
                continue
            queue += [(component, middle - half / 2, half / 2), (component, middle + half / 2, half / 2)]
        return PeriodicPoints(_joined(sorted(found)), boxes)


class _Slap:
    """The slap map of the cuspless cardioid on stretches."""

    def __init__(self) -> None:
        pairs = ((ARC, ARC), (ARC, WALL), (WALL, ARC))
        self.balls = {pair: load(chord_kernel(cuspless, *pair, 1), balls(BITS)) for pair in pairs}
        self.floats = {pair: load(chord_kernel(cuspless, *pair, 1), FLOAT64) for pair in pairs}
        ends = load(kernel("ends", [], {"arc": 2 * pi / 3, "wall": sqrt(3) / 4}), balls(BITS))()
        self.ends = {ARC: ends[0], WALL: ends[1]}

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
        """The image of a piece: one piece, or two when it may straddle a join; None when not enclosed.

        The table is convex, so a root of the chord angle that is proved to lie on the boundary is the
        landing. Floats guess on which part: the wall when the normal passes between the corners.
        """
        if piece.component == WALL:
            return _all(self._root(piece, ARC, -1.05, 1.05))
        start, edge = float(piece.theta.mid()), float(self.ends[ARC])
        roots = {
            "upper": lambda: self._root(piece, ARC, start, edge + 0.2),
            "wall": lambda: self._root(piece, WALL, -0.6, 0.6),
            "lower": lambda: self._root(piece, ARC, TURN - edge - 0.2, start + TURN),
        }
        guess = self._guess(start, edge)
        first = roots[guess]()
        if first is None:
            return None
        if abs(first.theta) < self.ends[first.component]:
            return [first]
        if guess != "wall":
            return _all(first, roots["wall"]())
        return _all(first, roots["upper" if first.theta < 0 else "lower"]())

    def _guess(self, start: float, edge: float) -> str:
        near = self.floats[ARC, ARC]
        if start > edge - 1e-6 or (start > -edge + 1e-6 and near(start, -edge)[0] > 0):
            return "lower"
        return "upper" if start < -edge + 1e-6 or near(start, edge)[0] < 0 else "wall"

    def _root(self, piece: Piece, target: int, low: float, high: float) -> Piece | None:
        """The landing on a component, enclosed by an interval Newton step from a guess in floats."""
        angle, near = self.balls[piece.component, target], self.floats[piece.component, target]
        start = float(piece.theta.mid())
        for _ in range(60):
            middle = (low + high) / 2  # the angle falls along the boundary
            low, high = (middle, high) if near(start, middle)[0] > 0 else (low, middle)
        guess = (low + high) / 2 - (TURN if high > TURN / 2 else 0)
        radius = 4 * float(piece.theta.rad()) + 1e-12
        for _ in range(6):
            box = arb(guess, radius)
            image = guess - angle(piece.theta, arb(guess))[0] / angle(piece.theta, box)[2]
            if image.is_finite() and box.contains_interior(image):
                over = angle(piece.theta, image)
                return Piece(target, image, -piece.slope * over[1] / over[2])
            radius *= 2
        return None


def _all(*pieces: Piece | None) -> list[Piece] | None:
    found = [p for p in pieces if p is not None]
    return found if len(found) == len(pieces) else None


def _halves(end: arb) -> tuple[float, float]:
    return 0.0, float(end.upper()) * (1 + 2.0**-40)


def _monotone(slope: arb) -> bool:
    return bool(slope.is_finite() and (slope < 1 or slope > 1))


def _joined(stretches: list[tuple[int, float, float]]) -> list[tuple[int, float, float]]:
    """Touching stretches as one."""
    made: list[tuple[int, float, float]] = []
    for component, low, high in stretches:
        if made and made[-1][0] == component and low <= made[-1][2] + 1e-12:
            made[-1] = component, made[-1][1], max(high, made[-1][2])
        else:
            made.append((component, low, high))
    return made
