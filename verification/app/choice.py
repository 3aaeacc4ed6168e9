"""The state of the live table (table, law, contraction and particle), and the data of its pictures."""

import shlex
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import Orbit, PinballMap
from numeric.backends import elementary
from numeric.dynamics.attractors import Kind, find
from numeric.dynamics.basins import labels, starts_at
from numeric.dynamics.phase_points import phase_points
from numeric.dynamics.recognition import Cycle, polished, shortest
from numeric.pinball.sampling import Starts, boundary, interior_starts
from numeric.sweeps.sweep import measured
from symbolic.tables.definition import GALLERY, PAPER, UNIFORM
from symbolic.tables.scene import Scene
from verification.app.scene import scene
from verification.paper.figures.phase import arc_length
from verification.plots.sheet import Array, Curve

STEEPEST = 0.999 * np.pi / 2
OWN = "polar formula"
TABLES = (*PAPER, *GALLERY, OWN)
DEFAULTS = {"a": "1.5", "alpha": "0.08"}
KEPT = ("table", "formula", "law", "shape", "lam", "component", "theta", "phi", "bounces")  # in an address
MOST = 500  # bounces drawn


@dataclass(frozen=True)
class Choice:
    """The table (name or formula), its shape and contraction as text, the particle's start and its number of bounces.

    The default particle ends on an attracting cycle of period 3.
    """

    table: str = "egg"
    formula: str = "1 + cos(5*theta)/40"
    shape: str = "0.08"
    lam: str = "0.45"
    component: int = 0
    theta: float = 0.4
    phi: float = -0.5
    law: str = UNIFORM
    bounces: int = 60

    @property
    def parameter(self) -> str | None:
        """The name of the table's shape parameter, if it has one."""
        return next(iter(PAPER.get(self.table, ())), None)

    def scene(self) -> Scene:
        """The scene of the choice; `ValueError` with a one-sentence message if its texts do not describe one."""
        given = {name: self.shape if name == self.parameter else None for name in DEFAULTS}
        law = None if self.law == UNIFORM else self.law
        if self.table == OWN:
            return scene(None, self.formula, None, None, self.lam, None, (), None, law, **given)
        return scene(self.table, None, None, None, self.lam, None, (), None, law, **given)

    def map(self) -> PinballMap:
        """The map of the scene."""
        return PinballMap(self.scene())

    def command(self) -> str:
        """The `pinball orbit` command for this particle.

        >>> Choice("ellipse", shape="1.5", lam="0.9", theta=0.5, phi=-0.25, bounces=10).command()
        'pinball orbit ellipse --a 1.5 --lam 0.9 --start=0.5,-0.25 --bounces 10'
        """
        table = ["--polar", self.formula] if self.table == OWN else [self.table]
        shape = [f"--{self.parameter}", self.shape] if self.parameter else []
        law = [] if self.law == UNIFORM else [f"--law={self.law}"]
        part = ["--component", self.map().ir.parts[self.component].name] if self.component else []
        start = [f"--start={self.theta!r},{self.phi!r}", "--bounces", str(self.bounces)]
        return shlex.join(["pinball", "orbit", *table, *shape, *law, "--lam", self.lam, *part, *start])

    def python(self) -> str:
        """Python code for this particle.

        >>> print(Choice("cardioid", lam="0.5", theta=0.5, phi=0.0, bounces=10).python())
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
        shape = f', {self.parameter}="{self.shape}"' if self.parameter else ""
        law = "" if self.law == UNIFORM else f", law={self.law!r}"
        part = f", component={self.component}" if self.component else ""
        body = [f'map = PinballMap({table}, lam="{self.lam}"{shape}{law})']
        body.append(f"orbit = map.orbit({self.theta!r}, {self.phi!r}, {self.bounces}{part})")
        return "\n".join([*head, "", *body])

    def address(self) -> dict[str, str]:
        """The fields that differ from the default, as text, for the address of the page.

        >>> Choice(lam="0.5", theta=0.25).address()
        {'lam': '0.5', 'theta': '0.25'}
        """
        first = Choice()
        return {name: str(getattr(self, name)) for name in KEPT if getattr(self, name) != getattr(first, name)}

    @classmethod
    def of_address(cls, said: Mapping[str, Any]) -> "Choice":
        """The choice that an address describes; unknown and unreadable fields are left out.

        >>> Choice.of_address({"lam": "0.5", "phi": "steep", "who": "?"}) == Choice(lam="0.5")
        True
        """
        known: dict[str, Any] = {name: str(said[name]) for name in ("formula", "law", "shape", "lam") if name in said}
        known |= {"table": said["table"]} if said.get("table") in TABLES else {}
        for name, kind in (("component", int), ("theta", float), ("phi", float), ("bounces", int)):
            with suppress(KeyError, ValueError, TypeError):
                known[name] = kind(said[name])
        with suppress(ValueError):
            if not 0 <= float(known.get("lam", 0)) <= 1 or not abs(known.get("phi", 0)) < STEEPEST:
                return cls()
            if not 1 <= known.get("bounces", 1) <= MOST:
                return cls()
            return cls(**known)
        return cls()


LONGEST = 64  # period of a cycle that is looked for
SETTLING = 4000  # bounces after which an orbit is where it ends


@dataclass(frozen=True)
class BoundaryParticle:
    """A particle on the boundary: component, parameter and exit angle."""

    component: int
    theta: float
    phi: float


def particle_at(map: PinballMap, x: float, y: float, towards: tuple[float, float]) -> BoundaryParticle:
    """The particle that starts at the boundary point nearest to `(x, y)` and flies towards the point `towards`.

    >>> particle = particle_at(PinballMap("circle", lam=1), 0.0, 2.0, (0.0, 0.0))
    >>> round(particle.theta, 6), round(particle.phi, 6) + 0.0
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
    phi = float(elementary.arctan2(vx * tx + vy * ty, vy * tx - vx * ty))
    return BoundaryParticle(int(where[0]), float(theta[0]), float(np.clip(phi, -STEEPEST, STEEPEST)) + 0.0)


def placed(map: PinballMap, choice: Choice) -> Choice:
    """The choice, in which a `theta` outside the range of its component is replaced by the middle of the range.

    >>> from symbolic.tables.gallery import GALLERY
    >>> placed(PinballMap(GALLERY["diamond"]()), Choice("diamond")).theta == 3 * np.pi / 4
    True
    """
    low, high = map.states.ends[choice.component]
    if len(map.states.ends) == 1 or low < choice.theta < high:
        return choice
    return replace(choice, theta=float(low + high) / 2)


def tip(map: PinballMap, particle: BoundaryParticle, length: float) -> tuple[float, float]:
    """The point at `length` from the particle in its direction of flight."""
    where, theta = np.array([particle.component]), np.array([particle.theta])
    x, y = map.states.point(where, theta)
    vx, vy = map.states.direction(where, theta, np.array([particle.phi]))
    return float(x[0] + length * vx[0]), float(y[0] + length * vy[0])


def phase(map: PinballMap, orbit: Orbit) -> Curve:
    """The phase points `(s, sin(phi))` of all bounces until the particle stops; `s` is 0 in the middle of its range."""
    made = orbit.code == 0
    return Curve(arc_length(map, orbit.component[made], orbit.theta[made]), np.sin(orbit.phi[made]))


def particle_in_phase(map: PinballMap, s: float, sin_phi: float) -> BoundaryParticle:
    """The particle at the point `(s, sin(phi))` of phase space."""
    component, theta = boundary(map, np.array([s]))
    phi = float(elementary.arcsin(np.clip(sin_phi, -0.999, 0.999)))
    return BoundaryParticle(int(component[0]), float(theta[0]), phi)


def filling(map: PinballMap, particles: int = 100, bounces: int = 9, seed: int = 1) -> Iterator[Curve]:
    """Yields the phase points of random particles without end, a few bounces of all particles at a time."""
    starts = interior_starts(map, particles, seed)
    component, theta, phi = starts.component, starts.theta, starts.phi
    while True:
        orbit = map.orbit(theta, phi, bounces, component)
        yield phase(map, orbit)
        component, theta, phi = orbit.component[-1], orbit.theta[-1], orbit.phi[-1]


def cycle_near(map: PinballMap, particle: BoundaryParticle) -> Cycle | None:
    """The attracting cycle on which the particle's orbit ends; else a cycle near a return of it, or None.

    >>> axis = cycle_near(PinballMap("ellipse", a=2, lam="0.5"), BoundaryParticle(0, 1.5, 0.01))
    >>> axis.period
    2
    """
    at = np.array([particle.theta]), np.array([particle.phi]), np.array([particle.component])
    end = map.exponents(at[0], at[1], 1, SETTLING, at[2])
    if not end.code[0]:
        found = _returning(
            map, BoundaryParticle(int(end.component[0]), float(end.theta[0]), float(end.phi[0])), SETTLED
        )
        if found is not None and abs(found.multipliers[0]) < 1:
            return found
    return _returning(map, particle, np.inf)


SETTLED = 1e-4  # in lengths and radians: an orbit that has settled returns to within this


def _returning(map: PinballMap, particle: BoundaryParticle, within: float) -> Cycle | None:
    """The cycle that Newton's method finds from returns to within `within` of the start, nearest first; or None."""
    orbit = map.orbit(particle.theta, particle.phi, LONGEST, particle.component)
    if orbit.code[-1]:
        return None
    away = np.hypot(orbit.x[1:] - orbit.x[0], orbit.y[1:] - orbit.y[0]) + np.abs(orbit.phi[1:] - orbit.phi[0])
    for period in np.argsort(away)[:8] + 1:
        near = phase_points(orbit.theta[:period], orbit.phi[:period], orbit.component[:period])
        found = polished(map, near) if away[period - 1] < within else None
        if found is not None:
            return shortest(map, found.points)
    return None


LAMS, EACH, SHOWN = 201, 6, 48  # contractions of the strip, particles of each, bounces drawn of each


def strip(choice: Choice, seed: int = 1) -> tuple[Curve, Array, Array]:
    """Points `(lam, s)` of orbits after a long time; the contractions; the largest exponent at each contraction.

    `ValueError` if the formula is not a law at some contraction.
    """
    map = replace(choice, lam="1").map()
    lams = np.linspace(0, 1, LAMS)
    starts = interior_starts(map, LAMS * EACH, seed)
    several = map.at(np.repeat(lams, EACH))
    with np.errstate(invalid="ignore", divide="ignore"):  # at lam = 0
        found = several.exponents(starts.theta, starts.phi, 400, 600, starts.component)
    alive = found.code == 0
    nu = np.where(alive, found.nu_plus, -np.inf).reshape(LAMS, EACH).max(axis=1)
    theta, phi, component = (
        np.where(alive, end, start)
        for end, start in zip(found[4:6] + found[3:4], (starts.theta, starts.phi, starts.component), strict=True)
    )
    orbit = several.orbit(theta, phi, SHOWN, component)
    made = (orbit.code == 0) & alive
    lam = np.broadcast_to(several.lam, made.shape)[made]
    s = arc_length(map, orbit.component[made], orbit.theta[made])
    return Curve(lam, s), lams, np.where(np.isfinite(nu), nu, np.nan)


def exponents_of(map: PinballMap, particle: BoundaryParticle) -> str:
    """Both exponents of a particle's orbit in words, with their standard errors; empty if it stops."""
    at = np.array([particle.component]), np.array([particle.theta]), np.array([particle.phi])
    with np.errstate(invalid="ignore", divide="ignore"):  # at lam = 0
        found = measured(map, Starts(*at, np.zeros(1), np.zeros(1)), 4000, 1000)
    if found.code[0]:
        return ""
    plus, minus = (
        f"{float(nu[0]):.4f} ± {float(error[0]):.1g}" if np.isfinite(nu[0]) else "minus infinity"
        for nu, error in ((found.nu_plus, found.nu_plus_error), (found.nu_minus, found.nu_minus_error))
    )
    return f"Exponents per bounce: {plus} and {minus}."


CELLS = (120, 60)  # of a picture of basins


def basins_of(map: PinballMap, seed: int = 1) -> tuple[NDArray[np.int64], float, list[str]]:
    """The index of the attractor that each cell of phase space reaches, half the perimeter, the attractors in words."""
    attractors = find(map, 200, seed, images=True)
    half = map.arclength.perimeter / 2
    s, sine = ((np.arange(n) + 0.5) / n * 2 - 1 for n in CELLS)
    grid = np.meshgrid(s * half, sine)
    found = labels(map, starts_at(map, *grid), attractors).reshape(grid[0].shape)
    words = [f"period {a.period}" if a.kind is Kind.CYCLE else a.kind.name.lower() for a in attractors]
    return found, half, words
