"""What is picked on the live table, as a map, as a command line and as Python.

What the live table draws: the boundary, an orbit, phase space, and the cycle near a point.
"""

import shlex
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from numeric import Orbit, PinballMap
from numeric.dynamics.cycles import Cycle, polished, shortest
from numeric.dynamics.phase_points import places
from numeric.pinball.sampling import boundary, interior_starts
from symbolic.tables.definition import PAPER
from symbolic.tables.scene import Scene
from verification.app.shell.scene import scene
from verification.paper.figures.phase import arc_length
from verification.plots.sheet import Curve

OWN = "polar formula"
TABLES = (*PAPER, OWN)
DEFAULTS = {"a": "1.5", "alpha": "0.08"}


@dataclass(frozen=True)
class Choice:
    """A table by name or formula, its shape and contraction as text, and where the ball starts."""

    table: str = "egg"
    formula: str = "1 + cos(5*theta)/40"
    shape: str = "0.08"
    lam: str = "0.45"
    component: int = 0
    theta: float = 0.3
    phi: float = 0.2

    @property
    def letter(self) -> str | None:
        """The name of the table's shape parameter, if it has one."""
        return next(iter(PAPER.get(self.table, ())), None)

    def scene(self) -> Scene:
        """The scene; `ValueError` with one sentence when there is none."""
        given = {name: self.shape if name == self.letter else None for name in DEFAULTS}
        if self.table == OWN:
            return scene(None, self.formula, None, None, self.lam, **given)
        return scene(self.table, None, None, None, self.lam, **given)

    def map(self) -> PinballMap:
        """The map of the scene."""
        return PinballMap(self.scene())

    def command(self, bounces: int = 100) -> str:
        """The command line for this ball.

        >>> Choice("ellipse", shape="1.5", lam="0.9", theta=0.5, phi=-0.25).command(10)
        'pinball orbit ellipse --a 1.5 --lam 0.9 --start=0.5,-0.25 --bounces 10'
        """
        table = ["--polar", self.formula] if self.table == OWN else [self.table]
        shape = [f"--{self.letter}", self.shape] if self.letter else []
        part = ["--component", self._names()[self.component]] if self.component else []
        start = [f"--start={self.theta!r},{self.phi!r}", "--bounces", str(bounces)]
        return shlex.join(["pinball", "orbit", *table, *shape, "--lam", self.lam, *part, *start])

    def python(self, bounces: int = 100) -> str:
        """The same in Python.

        >>> print(Choice("cardioid", lam="0.5", theta=0.5, phi=0.0).python(10))
        from numeric import PinballMap
        <BLANKLINE>
        map = PinballMap("cardioid", lam="0.5")
        orbit = map.orbit(0.5, 0.0, 10)
        """
        head = ["from numeric import PinballMap"]
        table = f'"{self.table}"'
        if self.table == OWN:
            head.append("from symbolic import tables")
            table = f"tables.polar({self.formula!r})"
        shape = f', {self.letter}="{self.shape}"' if self.letter else ""
        part = f", component={self.component}" if self.component else ""
        body = [f'map = PinballMap({table}, lam="{self.lam}"{shape})']
        body.append(f"orbit = map.orbit({self.theta!r}, {self.phi!r}, {bounces}{part})")
        return "\n".join([*head, "", *body])

    def _names(self) -> list[str]:
        return [part.name for part in self.map().blueprint.parts]


LONGEST = 64  # period of a cycle that is looked for
STEEPEST = 0.999 * np.pi / 2


@dataclass(frozen=True)
class Ball:
    """A place on the boundary and an exit angle."""

    component: int
    theta: float
    phi: float


def ball_at(map: PinballMap, x: float, y: float, towards: tuple[float, float]) -> Ball:
    """The ball on the boundary point nearest to `(x, y)` that flies towards a point.

    >>> ball = ball_at(PinballMap("circle", lam=1), 0.0, 2.0, (0.0, 0.0))
    >>> round(ball.theta, 6), round(ball.phi, 6) + 0.0
    (1.570796, 0.0)
    """
    s, span = 0.0, map.arclength.perimeter
    for _ in range(4):  # each time on a grid a hundred times finer
        near = s + span * np.linspace(-0.5, 0.5, 257)
        bx, by = map.states.point(*boundary(map, near))
        s, span = float(near[np.argmin(np.hypot(bx - x, by - y))]), span / 100
    where, theta = boundary(map, np.array([s]))
    px, py = (float(value[0]) for value in map.states.point(where, theta))
    tx, ty = (float(value[0]) for value in map.states.tangent(where, theta))
    vx, vy = towards[0] - px, towards[1] - py
    phi = float(np.arctan2(vx * tx + vy * ty, vy * tx - vx * ty))
    return Ball(int(where[0]), float(theta[0]), float(np.clip(phi, -STEEPEST, STEEPEST)) + 0.0)


def tip(map: PinballMap, ball: Ball, length: float) -> tuple[float, float]:
    """The point at `length` from the ball in its direction of flight."""
    where, theta = np.array([ball.component]), np.array([ball.theta])
    x, y = map.states.point(where, theta)
    vx, vy = map.states.direction(where, theta, np.array([ball.phi]))
    return float(x[0] + length * vx[0]), float(y[0] + length * vy[0])


def phase(map: PinballMap, orbit: Orbit) -> Curve:
    """`s` from `-L/2` to `L/2` and `sin(phi)` of every bounce that was made."""
    made = orbit.code == 0
    return Curve(arc_length(map, orbit.component[made], orbit.theta[made]), np.sin(orbit.phi[made]))


def ball_in_phase(map: PinballMap, s: float, sin_phi: float) -> Ball:
    """The ball at a point of phase space."""
    component, theta = boundary(map, np.array([s]))
    phi = float(np.arcsin(np.clip(sin_phi, -0.999, 0.999)))
    return Ball(int(component[0]), float(theta[0]), phi)


def filling(map: PinballMap, balls: int = 100, bounces: int = 9, seed: int = 1) -> Iterator[Curve]:
    """Phase space in portions, for ever: random balls, each portion a few bounces further."""
    starts = interior_starts(map, balls, seed)
    component, theta, phi = starts.component, starts.theta, starts.phi
    while True:
        orbit = map.orbit(theta, phi, bounces, component)
        yield phase(map, orbit)
        component, theta, phi = orbit.component[-1], orbit.theta[-1], orbit.phi[-1]


def cycle_near(map: PinballMap, ball: Ball) -> Cycle | None:
    """The cycle that Newton's method finds from the nearest return of the ball; None when it finds none.

    >>> axis = cycle_near(PinballMap("ellipse", a=2, lam="0.5"), Ball(0, 1.5, 0.01))
    >>> axis.period
    2
    """
    orbit = map.orbit(ball.theta, ball.phi, LONGEST, ball.component)
    if orbit.code[-1]:
        return None
    away = np.hypot(orbit.x[1:] - orbit.x[0], orbit.y[1:] - orbit.y[0]) + np.abs(orbit.phi[1:] - orbit.phi[0])
    for period in np.argsort(away)[:8] + 1:
        near = places(orbit.component[:period], orbit.theta[:period], orbit.phi[:period])
        found = polished(map, near)
        if found is not None:
            return shortest(map, found.points)
    return None
