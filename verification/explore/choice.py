"""What is picked on the live table, as a map, as a command line and as Python."""

import shlex
from dataclasses import dataclass

from numeric import PinballMap
from symbolic.definition import PAPER
from symbolic.scene import Scene
from verification.commands.mapped import pinball_map
from verification.commands.scene import scene

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
        return pinball_map(self.scene())

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
