"""The live table: a page in Panel with widgets on the left, the table and its phase space on the right."""

import os
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import panel as pn
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, PointDrawTool
from bokeh.plotting import figure

from numeric import Orbit, PinballMap
from numeric.dynamics.phase_points import phase_points
from numeric.dynamics.recognition import Cycle, polished, shortest
from numeric.pinball.sampling import boundary, interior_starts
from symbolic.tables.definition import PAPER
from symbolic.tables.scene import Scene
from verification.app.cli import refusal
from verification.app.scene import scene
from verification.paper.figures.phase import arc_length, outline
from verification.plots.sheet import Curve

OWN = "polar formula"
TABLES = (*PAPER, OWN)
DEFAULTS = {"a": "1.5", "alpha": "0.08"}


@dataclass(frozen=True)
class Choice:
    """A table by name or formula, its shape and contraction as text, and where the particle starts."""

    table: str = "egg"
    formula: str = "1 + cos(5*theta)/40"
    shape: str = "0.08"
    lam: str = "0.45"
    component: int = 0
    theta: float = 0.3
    phi: float = 0.2

    @property
    def parameter(self) -> str | None:
        """The name of the table's shape parameter, if it has one."""
        return next(iter(PAPER.get(self.table, ())), None)

    def scene(self) -> Scene:
        """The scene; `ValueError` with one sentence when there is none."""
        given = {name: self.shape if name == self.parameter else None for name in DEFAULTS}
        if self.table == OWN:
            return scene(None, self.formula, None, None, self.lam, **given)
        return scene(self.table, None, None, None, self.lam, **given)

    def map(self) -> PinballMap:
        """The map of the scene."""
        return PinballMap(self.scene())

    def command(self, bounces: int = 100) -> str:
        """The command line for this particle.

        >>> Choice("ellipse", shape="1.5", lam="0.9", theta=0.5, phi=-0.25).command(10)
        'pinball orbit ellipse --a 1.5 --lam 0.9 --start=0.5,-0.25 --bounces 10'
        """
        table = ["--polar", self.formula] if self.table == OWN else [self.table]
        shape = [f"--{self.parameter}", self.shape] if self.parameter else []
        part = ["--component", self.map().ir.parts[self.component].name] if self.component else []
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
        shape = f', {self.parameter}="{self.shape}"' if self.parameter else ""
        part = f", component={self.component}" if self.component else ""
        body = [f'map = PinballMap({table}, lam="{self.lam}"{shape})']
        body.append(f"orbit = map.orbit({self.theta!r}, {self.phi!r}, {bounces}{part})")
        return "\n".join([*head, "", *body])


LONGEST = 64  # period of a cycle that is looked for
STEEPEST = 0.999 * np.pi / 2


@dataclass(frozen=True)
class Particle:
    """A place on the boundary and an exit angle."""

    component: int
    theta: float
    phi: float


def particle_at(map: PinballMap, x: float, y: float, towards: tuple[float, float]) -> Particle:
    """The particle on the boundary point nearest to `(x, y)` that flies towards a point.

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
    phi = float(np.arctan2(vx * tx + vy * ty, vy * tx - vx * ty))
    return Particle(int(where[0]), float(theta[0]), float(np.clip(phi, -STEEPEST, STEEPEST)) + 0.0)


def tip(map: PinballMap, particle: Particle, length: float) -> tuple[float, float]:
    """The point at `length` from the particle in its direction of flight."""
    where, theta = np.array([particle.component]), np.array([particle.theta])
    x, y = map.states.point(where, theta)
    vx, vy = map.states.direction(where, theta, np.array([particle.phi]))
    return float(x[0] + length * vx[0]), float(y[0] + length * vy[0])


def phase(map: PinballMap, orbit: Orbit) -> Curve:
    """`s` from `-L/2` to `L/2` and `sin(phi)` of every bounce that was made."""
    made = orbit.code == 0
    return Curve(arc_length(map, orbit.component[made], orbit.theta[made]), np.sin(orbit.phi[made]))


def particle_in_phase(map: PinballMap, s: float, sin_phi: float) -> Particle:
    """The particle at a point of phase space."""
    component, theta = boundary(map, np.array([s]))
    phi = float(np.arcsin(np.clip(sin_phi, -0.999, 0.999)))
    return Particle(int(component[0]), float(theta[0]), phi)


def filling(map: PinballMap, particles: int = 100, bounces: int = 9, seed: int = 1) -> Iterator[Curve]:
    """Phase space in portions, for ever: random particles, each portion a few bounces further."""
    starts = interior_starts(map, particles, seed)
    component, theta, phi = starts.component, starts.theta, starts.phi
    while True:
        orbit = map.orbit(theta, phi, bounces, component)
        yield phase(map, orbit)
        component, theta, phi = orbit.component[-1], orbit.theta[-1], orbit.phi[-1]


def cycle_near(map: PinballMap, particle: Particle) -> Cycle | None:
    """The cycle that Newton's method finds from the nearest return of the particle; None when it finds none.

    >>> axis = cycle_near(PinballMap("ellipse", a=2, lam="0.5"), Particle(0, 1.5, 0.01))
    >>> axis.period
    2
    """
    orbit = map.orbit(particle.theta, particle.phi, LONGEST, particle.component)
    if orbit.code[-1]:
        return None
    away = np.hypot(orbit.x[1:] - orbit.x[0], orbit.y[1:] - orbit.y[0]) + np.abs(orbit.phi[1:] - orbit.phi[0])
    for period in np.argsort(away)[:8] + 1:
        near = phase_points(orbit.component[:period], orbit.theta[:period], orbit.phi[:period])
        found = polished(map, near)
        if found is not None:
            return shortest(map, found.points)
    return None


INK, PARTICLE, CYCLE = "#30343a", "#c2410c", "#1d4ed8"
PATIENCE = 20.0  # seconds for a formula
PORTIONS = 25  # of phase space before it rests: what a browser draws without effort
EVERY = 200  # milliseconds between two of them


class LiveTable:
    """One visitor's table: what was picked, and the page that shows it."""

    def __init__(self) -> None:
        self.choice = Choice()
        self.map: PinballMap = self.choice.map()
        self.portions: Iterator[Any] = iter(())
        self.left = 0
        self.tried = ""  # the formula that another process has read
        self._widgets()
        self._figures()
        self.rebuild()

    # ---- the page

    def _widgets(self) -> None:
        self.table = pn.widgets.Select(name="Table", options=list(TABLES), value=self.choice.table)
        self.formula = pn.widgets.TextInput(name="Radius, a formula in theta", value=self.choice.formula, visible=False)
        self.shape = pn.widgets.TextInput(name="alpha, shape of the egg", value=self.choice.shape)
        self.lam = pn.widgets.FloatSlider(name="Contraction lambda", start=0, end=1, step=0.001, value=0.45)
        self.bounces = pn.widgets.IntSlider(name="Bounces drawn", start=1, end=500, value=60)
        self.find = pn.widgets.Button(name="Find the cycle near the particle", button_type="primary")
        self.said = pn.pane.Markdown("", min_height=90)
        self.command = pn.widgets.TextAreaInput(name="As a command", height=80, auto_grow=True)
        self.python = pn.widgets.TextAreaInput(name="As Python", height=110, auto_grow=True)
        copy = "navigator.clipboard.writeText(source.value)"
        self.copies = [pn.widgets.Button(name=f"Copy as {name}") for name in ("command", "Python")]
        for button, text in zip(self.copies, (self.command, self.python), strict=True):
            button.js_on_click(args={"source": text}, code=copy)
        for widget in (self.table, self.formula, self.shape, self.lam):
            widget.param.watch(lambda _: in_turn(self.rebuild), "value")
        self.bounces.param.watch(lambda _: in_turn(self.redraw), "value")
        self.find.on_click(lambda _: in_turn(self.find_cycle))

    def _figures(self) -> None:
        self.wall, self.path, self.dots, self.cloud, self.here, self.ring, self.loop = (
            ColumnDataSource({"x": [], "y": []}) for _ in range(7)
        )
        self.room = figure(title="The table: drag the particle or its arrow", match_aspect=True, height=440, width=520)
        self.room.line("x", "y", source=self.wall, color=INK, line_width=2)
        self.room.line("x", "y", source=self.path, color=INK, alpha=0.35)
        self.room.line("x", "y", source=self.loop, color=CYCLE, line_width=2)
        self.room.line("x", "y", source=self.dots, color=PARTICLE, line_width=2)
        handles = self.room.scatter("x", "y", source=self.dots, size=13, color=PARTICLE)
        drag = PointDrawTool(renderers=[handles], add=False)
        self.room.add_tools(drag)
        self.room.toolbar.active_tap = drag
        self.dots.on_change("data", self._dragged)
        self.space = figure(title="Phase space: click to start there", height=440, width=520)
        self.space.xaxis.axis_label, self.space.yaxis.axis_label = "s", "sin(phi)"
        self.space.scatter("x", "y", source=self.cloud, size=1.5, color=INK, alpha=0.5)
        self.space.scatter("x", "y", source=self.here, size=11, color=PARTICLE)
        self.space.scatter("x", "y", source=self.ring, size=11, color=CYCLE, marker="x", line_width=2)
        self.space.on_event(Tap, self._tapped)

    def view(self) -> Any:
        """The page."""
        controls = pn.Column(
            "## Pinball billiards",
            self.table,
            self.formula,
            self.shape,
            self.lam,
            self.bounces,
            self.find,
            self.said,
            self.command,
            self.copies[0],
            self.python,
            self.copies[1],
            width=340,
        )
        pictures = pn.FlexBox(pn.pane.Bokeh(self.room), pn.pane.Bokeh(self.space))
        pn.state.add_periodic_callback(self.fill, EVERY)
        return pn.Row(controls, pictures)

    # ---- what changes

    def rebuild(self) -> None:
        """Another table, shape or contraction; what is no scene is said in one sentence, and the old one stays."""
        if self.table.value != self.choice.table:
            self._other_table()
            return
        wanted = replace(self.choice, formula=self.formula.value, shape=self.shape.value, lam=f"{self.lam.value:.6g}")
        if wanted.table == OWN and wanted.formula != self.tried:
            self.said.object = "The formula is being read."
            pn.state.execute(partial(self._try, wanted))
        else:
            self._take(wanted)

    async def _try(self, wanted: Choice) -> None:
        """Reads a new formula in another process, so that no other visitor waits for it."""
        why = await refusal(shlex.split(wanted.command(1))[1:], PATIENCE)
        if self.formula.value == wanted.formula and self.table.value == OWN:  # the visitor has not typed on
            in_turn(partial(self._tried, wanted, why))

    def _tried(self, wanted: Choice, why: str | None) -> None:
        self.said.object = why or ""
        if why is None:
            self.tried = wanted.formula
            self.rebuild()

    def _take(self, wanted: Choice) -> None:
        try:
            self.map = wanted.map()
            parts = len(self.map.ir.parts)
            self.choice = wanted if wanted.component < parts else replace(wanted, component=0)
            self.redraw()
        except ValueError as error:
            self.said.object = str(error)
            return
        self.wall.data = dict(zip("xy", outline(self.map), strict=True))
        self.cloud.data = {"x": [], "y": []}
        self.portions, self.left = filling(self.map), PORTIONS

    def _other_table(self) -> None:
        self.choice = Choice(table=self.table.value, formula=self.formula.value, lam=self.choice.lam, theta=0.3)
        parameter = self.choice.parameter
        self.formula.visible = self.table.value == OWN
        self.shape.visible = parameter is not None
        if parameter is not None and self.shape.value != DEFAULTS[parameter]:
            self.shape.name = f"{parameter}, shape of the {self.table.value}"
            self.shape.value = DEFAULTS[parameter]  # which rebuilds
        else:
            self.rebuild()

    def redraw(self) -> None:
        """The orbit, the particle and the texts; the cycle that was found is forgotten."""
        orbit = self.map.orbit(self.choice.theta, self.choice.phi, self.bounces.value, self.choice.component)
        made = orbit.code == 0
        self.path.data = {"x": orbit.x[made], "y": orbit.y[made]}
        x1, y1 = tip(self.map, self._particle(), 0.4)
        self.dots.data = {"x": [float(orbit.x[0]), x1], "y": [float(orbit.y[0]), y1]}
        s, sine = phase(self.map, orbit)
        self.here.data = {"x": s[:1], "y": sine[:1]}
        self.ring.data = self.loop.data = {"x": [], "y": []}
        stopped = "" if np.all(made) else f"The particle stops: {orbit.status[-1].value}."
        self.said.object = stopped
        self.command.value = self.choice.command(self.bounces.value)
        self.python.value = self.choice.python(self.bounces.value)

    def fill(self) -> None:
        """One more portion of phase space."""
        if self.left > 0:
            self.left -= 1
            self.cloud.stream(dict(zip("xy", next(self.portions), strict=True)))

    def find_cycle(self) -> None:
        """The cycle near the particle, with its multipliers."""
        cycle = cycle_near(self.map, self._particle())
        if cycle is None:
            self.said.object = "No cycle was found from here; start nearer to one, or let the orbit settle first."
            return
        orbit = self.map.orbit(
            float(cycle.points.theta[0]), float(cycle.points.phi[0]), cycle.period, int(cycle.points.component[0])
        )
        s, sine = phase(self.map, orbit)
        self.ring.data, self.loop.data = {"x": s, "y": sine}, {"x": orbit.x, "y": orbit.y}
        numbers = ", ".join(f"{mu.real:.6g}" if mu.imag == 0 else f"{mu:.6g}" for mu in cycle.multipliers)
        kind = "attracting" if abs(cycle.multipliers[0]) < 1 else "not attracting"
        self.said.object = f"A cycle of period {cycle.period}, {kind}: multipliers {numbers}."

    # ---- what the visitor does

    def start(self, particle: Particle) -> None:
        """Starts the orbit anew from `particle`."""
        before = self.choice
        self.choice = replace(before, component=particle.component, theta=particle.theta, phi=particle.phi)
        try:
            self.redraw()
        except ValueError as error:
            self.choice = before
            self.redraw()
            self.said.object = str(error)

    def _particle(self) -> Particle:
        return Particle(self.choice.component, self.choice.theta, self.choice.phi)

    def _dragged(self, _: str, old: Any, new: Any) -> None:
        x, y = list(new["x"]), list(new["y"])
        here = self.map.states.point(np.array([self.choice.component]), np.array([self.choice.theta]))
        expected = (float(here[0][0]), *tip(self.map, self._particle(), 0.4)[:1])
        if len(x) != 2 or (abs(x[0] - expected[0]) < 1e-12 and abs(x[1] - expected[1]) < 1e-12):
            return  # our own drawing, or a handle that was taken away
        self.start(particle_at(self.map, x[0], y[0], (x[1], y[1])))

    def _tapped(self, event: Any) -> None:
        if abs(event.y) < 1:
            self.start(particle_in_phase(self.map, float(event.x), float(event.y)))


def in_turn(change: Callable[[], None]) -> None:
    """Makes a change when the page's lock is ours: Panel calls a widget's watchers without it, amid other writes."""
    pn.state.execute(change, schedule=True)


def page() -> Any:
    """A visitor's own page."""
    return LiveTable().view()


FROM_OUTSIDE = ("BOKEH_ALLOW_WS_ORIGIN", "BOKEH_ADDRESS")  # would let pages of other addresses in
FORGOTTEN = 15_000  # milliseconds after which the table of a visitor who left is given up


def serve(port: int, show: bool, **more: Any) -> Any:
    """Serves the page on this machine only, until it is interrupted.

    A page of another address that a browser shows cannot talk to it: its origin is not among those allowed, and what
    the environment says of origins and addresses is not heard.
    """
    for name in FROM_OUTSIDE:
        os.environ.pop(name, None)
    return pn.serve(
        {"": page}, port=port, address="127.0.0.1", websocket_origin=[f"127.0.0.1:{port}", f"localhost:{port}"],
        show=show, title="Pinball billiards", verbose=False, unused_session_lifetime=FORGOTTEN,
        check_unused_sessions=FORGOTTEN // 5, **more,
    )  # fmt: skip
