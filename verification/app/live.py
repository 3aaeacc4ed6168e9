"""The live table: a page in Panel with widgets on the left, the table and its phase space on the right."""

import os
import shlex
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any
from urllib.parse import parse_qsl, urlencode

import numpy as np
import panel as pn
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, CustomJS, PointDrawTool, Range1d, Span
from bokeh.plotting import figure

from numeric import PinballMap
from verification.app.choice import (
    DEFAULTS,
    MOST,
    OWN,
    SETTLING,
    TABLES,
    BoundaryParticle,
    Choice,
    basins_of,
    cycle_near,
    exponents_of,
    filling,
    particle_at,
    particle_in_phase,
    phase,
    placed,
    strip,
    tip,
)
from verification.app.cli import refusal
from verification.plots.results import outline
from verification.plots.sheet import PALETTE

INK, PARTICLE, CYCLE = "#30343a", "#c2410c", "#1d4ed8"
PATIENCE = 20.0  # seconds for a formula
PORTIONS = 25  # of phase space before it rests: what a browser draws without effort
EVERY = 200  # milliseconds between two of them
WIDE, HIGH = 520, 440  # pixels of a picture, at most
PHONE = 700  # pixels of a window, at most
STYLE = """
body { margin: 0; }
@media (prefers-color-scheme: dark) {
  html { background: #14161a; }
  body { background: #fff; filter: invert(0.92) hue-rotate(180deg); min-height: 100vh; }
}
"""
HANDLE = ".noUi-handle { background-color: #0072b5; }"  # of a slider: the blue of the button, seen in the dark as well
READY = """
function named(root) {  // names for screen readers, where the widgets have none
  for (const each of root.querySelectorAll("*")) {
    if (each.shadowRoot) named(each.shadowRoot);
    if (each.classList.contains("noUi-handle"))
      each.setAttribute("aria-label", root.querySelector(".bk-slider-title").textContent.split(":")[0]);
  }
}
named(document);
document.body.firstElementChild.setAttribute("role", "main");
"""


class LiveTable:
    """One visitor's live table: the current choice, and the page that shows it."""

    def __init__(self, choice: Choice | None = None) -> None:
        self.choice = Choice()
        self.map: PinballMap = self.choice.map()
        self.drawn = ""  # the scene of the bifurcation diagram
        self.portions: Iterator[Any] = iter(())
        self.left = 0
        self.tried = ("", "")  # the formulas that another process has read
        self._widgets()
        self._figures()
        self._restored(choice or Choice())

    # ---- the page

    def _widgets(self) -> None:
        self.table = pn.widgets.Select(label="Table", options=list(TABLES), value=self.choice.table)
        self.formula = pn.widgets.TextInput(
            label="Radius, a formula in theta", value=self.choice.formula, visible=False
        )
        self.shape = pn.widgets.TextInput(label="alpha, shape of the egg", value=self.choice.shape)
        self.law = pn.widgets.TextInput(label="Exit angle, a formula in eta and lam", value=self.choice.law)
        self.lam = pn.widgets.FloatSlider(label="Contraction lambda", start=0, end=1, step=0.001, value=0.45)
        self.bounces = pn.widgets.IntSlider(label="Bounces drawn", start=1, end=MOST, value=self.choice.bounces)
        for slider in (self.lam, self.bounces):
            slider.stylesheets = [HANDLE]
        self.find = pn.widgets.Button(label="Find the cycle", color="primary")
        self.basins = pn.widgets.Button(label="Show the basins")
        self.said = pn.pane.Markdown("", min_height=90)
        self.command = pn.widgets.TextAreaInput(label="As a command", height=80, auto_grow=True)
        self.python = pn.widgets.TextAreaInput(label="As Python", height=110, auto_grow=True)
        copy = "navigator.clipboard.writeText(source.value)"
        self.copies = [pn.widgets.Button(label=f"Copy as {name}") for name in ("command", "Python")]
        for button, text in zip(self.copies, (self.command, self.python), strict=True):
            button.js_on_click(args={"source": text}, code=copy)
        for widget in (self.table, self.formula, self.law, self.shape, self.lam):
            widget.param.watch(lambda _: in_turn(self.rebuild), "value")
        self.bounces.param.watch(lambda _: in_turn(self.redraw), "value")
        self.find.on_click(lambda _: in_turn(self.find_cycle))
        self.basins.on_click(lambda _: in_turn(self.show_basins))

    def _figures(self) -> None:
        self.wall, self.path, self.dots, self.cloud, self.here, self.ring, self.loop = (
            ColumnDataSource({"x": [], "y": []}) for _ in range(7)
        )
        self.cells = ColumnDataSource({"image": [], "x": [], "y": [], "dw": [], "dh": []})
        self.diagram, self.growth = (ColumnDataSource({"x": [], "y": []}) for _ in range(2))
        self.room = figure(title="The table: drag the particle or its arrow", match_aspect=True, height=HIGH)
        self.room.line("x", "y", source=self.wall, color=INK, line_width=2)
        self.room.line("x", "y", source=self.path, color=INK, alpha=0.35)
        self.room.line("x", "y", source=self.loop, color=CYCLE, line_width=2)
        self.room.line("x", "y", source=self.dots, color=PARTICLE, line_width=2)
        handles = self.room.scatter("x", "y", source=self.dots, size=13, color=PARTICLE)
        drag = PointDrawTool(renderers=[handles], add=False)
        self.room.add_tools(drag)
        self.room.toolbar.active_tap = drag
        self.dots.on_change("data", self._dragged)
        self.space = figure(title="Phase space: click to start there", height=HIGH)
        self.space.xaxis.axis_label, self.space.yaxis.axis_label = "s", "sin(phi)"
        self.space.image_rgba("image", "x", "y", "dw", "dh", source=self.cells)
        self.space.scatter("x", "y", source=self.cloud, size=1.5, color=INK, alpha=0.5)
        self.space.scatter("x", "y", source=self.here, size=11, color=PARTICLE)
        self.space.scatter("x", "y", source=self.ring, size=11, color=CYCLE, marker="x", line_width=2)
        self.space.on_event(Tap, self._tapped)
        self.marks = [Span(location=0.45, dimension="height", line_color=PARTICLE, line_width=2) for _ in range(2)]
        self.fan = figure(title="Where orbits end, against lambda: click to set it", height=260, x_range=Range1d(0, 1))
        self.fan.yaxis.axis_label = "s"
        self.fan.scatter("x", "y", source=self.diagram, size=1, color=INK, alpha=0.35)
        self.nu = figure(title="Largest exponent per bounce", height=170, x_range=self.fan.x_range)
        self.nu.xaxis.axis_label, self.nu.yaxis.axis_label = "lambda", "nu_plus"
        self.nu.line("x", "y", source=self.growth, color=INK)
        self.nu.add_layout(Span(location=0, dimension="width", line_color=INK, line_dash="dotted"))
        for each, mark in zip((self.fan, self.nu), self.marks, strict=True):
            each.add_layout(mark)
            each.on_event(Tap, self._picked)

    def view(self) -> Any:
        """The page; on a narrow window the table comes before the controls, and texts that can be copied come last."""
        controls = (self.table, self.formula, self.shape, self.law, self.lam, self.bounces)
        texts = (self.command, self.copies[0], self.python, self.copies[1])
        narrow = {"flex": "1 1 300px", "max-width": "360px"}
        wide = {"flex": f"1 1 {WIDE - 80}px", "max-width": f"{WIDE}px", "min-width": "0"}
        both = wide | {"flex": f"1 1 {WIDE}px", "max-width": f"{2 * WIDE + 8}px"}
        pn.state.add_periodic_callback(self.fill, EVERY)
        return pn.FlexBox(
            _column(["# Pinball billiards"], {"flex": "1 1 100%"}, phone=-2),
            _column([*controls, pn.FlexBox(self.find, self.basins), self.said], narrow),
            _column([_pane(self.room)], wide, phone=-1),
            _column([_pane(self.space)], wide),
            _column(texts, narrow, phone=1),
            _column([_pane(self.fan), _pane(self.nu)], both),
            flex_wrap="wrap",
            styles={"gap": "12px"},
            sizing_mode="stretch_width",
        )

    # ---- what changes

    def rebuild(self) -> None:
        """Takes another table, shape or contraction from the widgets; bad input shows an error, and nothing changes."""
        if self.table.value != self.choice.table:
            self._other_table()
            return
        texts = {"formula": self.formula.value, "shape": self.shape.value, "law": self.law.value}
        wanted = replace(self.choice, lam=f"{self.lam.value:.6g}", **texts)
        typed = (wanted.formula if wanted.table == OWN else "", wanted.law)
        if typed not in (("", Choice().law), self.tried):
            self.said.object = "The formula is being read."
            pn.state.execute(partial(self._try, wanted))
        else:
            self._take(wanted)

    async def _try(self, wanted: Choice) -> None:
        """Tries a new formula in another process, so that other visitors need not wait for it."""
        why = await refusal(shlex.split(wanted.command())[1:], PATIENCE)
        same = self.formula.value == wanted.formula and self.law.value == wanted.law
        if same and self.table.value == wanted.table:  # the visitor has not typed on
            in_turn(partial(self._tried, wanted, why))

    def _tried(self, wanted: Choice, why: str | None) -> None:
        self.said.object = why or ""
        if why is None:
            self.tried = (wanted.formula if wanted.table == OWN else "", wanted.law)
            self.rebuild()

    def _take(self, wanted: Choice) -> None:
        try:
            self.map = wanted.map()
            parts = len(self.map.ir.parts)
            self.choice = placed(self.map, wanted if wanted.component < parts else replace(wanted, component=0))
            self.redraw()
        except ValueError as error:
            self.said.object = str(error)
            return
        self.wall.data = dict(zip("xy", outline(self.map), strict=True))
        self.cloud.data = {"x": [], "y": []}
        self.cells.data = {name: [] for name in self.cells.data}
        self._strip()
        self.portions, self.left = filling(self.map), PORTIONS

    def _strip(self) -> None:
        """Moves the line at the contraction, and draws the bifurcation diagram anew if the table or the law changed."""
        for mark in self.marks:
            mark.location = self.lam.value
        family = str(self.choice.scene().at(lam=0))
        if family == self.drawn:
            return
        self.drawn = family
        try:
            points, lams, nu = strip(self.choice)
        except ValueError:  # the law is none for some contraction
            self.diagram.data = self.growth.data = {"x": [], "y": []}
            return
        self.diagram.data, self.growth.data = dict(zip("xy", points, strict=True)), {"x": lams, "y": nu}

    def _restored(self, choice: Choice) -> None:
        """Sets the page to a choice, such as that of an address; its formulas are read as if they had been typed."""
        self.choice = replace(choice, law=self.choice.law)
        self.table.value, self.formula.visible = choice.table, choice.table == OWN
        self.formula.value, self.shape.value, self.law.value = choice.formula, choice.shape, choice.law
        self.lam.value, self.bounces.value = float(choice.lam), choice.bounces
        self.shape.visible = choice.parameter is not None
        self.shape.label = f"{choice.parameter}, shape of the {choice.table}"
        self.rebuild()

    def _other_table(self) -> None:
        self.choice = Choice(table=self.table.value, formula=self.formula.value, lam=self.choice.lam)
        parameter = self.choice.parameter
        self.formula.visible = self.table.value == OWN
        self.shape.visible = parameter is not None
        if parameter is not None and self.shape.value != DEFAULTS[parameter]:
            self.shape.label = f"{parameter}, shape of the {self.table.value}"
            self.shape.value = DEFAULTS[parameter]  # which rebuilds
        else:
            self.rebuild()

    def redraw(self) -> None:
        """Draws the orbit and the particle, writes the texts, and removes the cycle that was found."""
        self.choice = replace(self.choice, bounces=self.bounces.value)
        orbit = self.map.orbit(self.choice.theta, self.choice.phi, self.choice.bounces, self.choice.component)
        made = orbit.code == 0
        self.path.data = {"x": orbit.x[made], "y": orbit.y[made]}
        x1, y1 = tip(self.map, self._particle(), 0.4)
        self.dots.data = {"x": [float(orbit.x[0]), x1], "y": [float(orbit.y[0]), y1]}
        s, sine = phase(self.map, orbit)
        self.here.data = {"x": s[:1], "y": sine[:1]}
        self.ring.data = self.loop.data = {"x": [], "y": []}
        self.said.object = (
            exponents_of(self.map, self._particle())
            if np.all(made)
            else f"The particle stops: {orbit.status[-1].value}."
        )
        if pn.state.location is not None:
            said = self.choice.address()
            pn.state.location.search = f"?{urlencode(said)}" if said else ""
        self.command.value = self.choice.command()
        self.python.value = self.choice.python()

    def fill(self) -> None:
        """Draws the next points of phase space."""
        if self.left > 0:
            self.left -= 1
            self.cloud.stream(dict(zip("xy", next(self.portions), strict=True)))

    def find_cycle(self) -> None:
        """Draws the cycle near the particle, and writes its multipliers."""
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
        attracting = abs(cycle.multipliers[0]) < 1
        where = "The orbit ends on" if attracting else f"After {SETTLING} bounces the orbit is on no cycle. Near it is"
        kind = "attracting" if attracting else "not attracting"
        self.said.object = f"{where} a cycle of period {cycle.period}, {kind}: multipliers {numbers}."

    def show_basins(self) -> None:
        """Draws the attractor that each cell of phase space reaches, a colour for each."""
        label, half, words = basins_of(self.map)
        colours = [int(colour[1:], 16) for colour in PALETTE]
        image = np.zeros(label.shape, dtype=np.uint32)
        for i in range(len(words)):
            red, green, blue = (colours[i % len(colours)] >> shift & 255 for shift in (16, 8, 0))
            image[label == i] = 0xB0 << 24 | blue << 16 | green << 8 | red
        self.cells.data = {"image": [image], "x": [-half], "y": [-1], "dw": [2 * half], "dh": [2]}
        shares = ", ".join(f"{word} ({np.mean(label == i):.0%})" for i, word in enumerate(words[:8]))
        self.said.object = f"Attractors from 200 random starts, with their share of the cells: {shares or 'none'}."

    # ---- what the visitor does

    def _picked(self, event: Any) -> None:
        """Sets the contraction to the one at which the diagram was clicked."""
        self.lam.value = round(float(np.clip(event.x, 0, 1)), 3)

    def start(self, particle: BoundaryParticle) -> None:
        """Starts a new orbit from `particle`."""
        before = self.choice
        self.choice = replace(before, component=particle.component, theta=particle.theta, phi=particle.phi)
        try:
            self.redraw()
        except ValueError as error:
            self.choice = before
            self.redraw()
            self.said.object = str(error)

    def _particle(self) -> BoundaryParticle:
        return BoundaryParticle(self.choice.component, self.choice.theta, self.choice.phi)

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
    """Schedules a change to run with this page's lock held; Panel calls the watchers of widgets without it."""
    pn.state.execute(change, schedule=True)


def _pane(picture: Any) -> Any:
    picture.sizing_mode = "stretch_width"
    return pn.pane.Bokeh(picture, sizing_mode="stretch_width")


def _column(parts: Sequence[Any], styles: dict[str, str], phone: int = 0) -> Any:
    """`parts` in a column; `phone` is the position of the column on a narrow window."""
    order = f"@media (max-width: {PHONE}px) {{ :host {{ order: {phone}; }} }}"
    return pn.Column(*parts, sizing_mode="stretch_width", styles=styles, stylesheets=[order])


def page() -> Any:
    """A new page for a visitor, which shows the choice that its address describes."""
    location = pn.state.location
    said = dict(parse_qsl(location.search.lstrip("?"))) if location is not None and location.search else {}
    if pn.state.curdoc is not None:
        pn.state.curdoc.js_on_event("document_ready", CustomJS(code=READY))
    return LiveTable(Choice.of_address(said)).view()


FROM_OUTSIDE = ("BOKEH_ALLOW_WS_ORIGIN", "BOKEH_ADDRESS")  # these would let pages of other addresses in
FORGOTTEN = 15_000  # milliseconds after which the table of a visitor who left is given up


def serve(port: int, show: bool, **more: Any) -> Any:
    """Serves the page on this machine only, until it is interrupted.

    Only the page's own origin may connect; environment variables that would allow others are removed.
    """
    pn.config.raw_css = [STYLE]
    for name in FROM_OUTSIDE:
        os.environ.pop(name, None)
    return pn.serve(
        {"": page}, port=port, address="127.0.0.1", websocket_origin=[f"127.0.0.1:{port}", f"localhost:{port}"],
        show=show, title="Pinball billiards", verbose=False, unused_session_lifetime=FORGOTTEN,
        check_unused_sessions=FORGOTTEN // 5, **more,
    )  # fmt: skip
