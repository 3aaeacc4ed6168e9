"""Images of boxes for all parameters of a box at once: a range of contractions and a range of a shape parameter.

On a smooth closed curve the shape parameter is a third coordinate of the mean-value theorem: boundary, landing and
incidence have derivatives with respect to it. Phase space is taken modulo the rotation symmetry of the table. Landings
do not depend on the contraction, so boxes of parameters that differ only in the contraction share them.
"""

from collections.abc import Callable
from copy import copy
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from sympy import S

from numeric.lowering.lower import converted
from numeric.lowering.program import Builder, Program
from symbolic.tables.law import parameters_of_law
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table, theta
from verification.arithmetic.arrays import Array, BallArray, Indices, common_part, exactly, hull, spread
from verification.cycles.systems import rotations
from verification.maps.first_hit import closes_smoothly, convex
from verification.proofs.global_dynamics.flights import Flights, Landing, LandingArcs, incidence, turn_between
from verification.proofs.global_dynamics.images import QUARTER, PinballImages
from verification.rigorous.boxes import Boxes, Chart, Images, collected

Range = tuple[Fraction, Fraction]


class ParameterBox(PinballImages):
    """The map for a range of contractions and a range of a shape parameter, modulo the table's rotations.

    >>> box = ParameterBox(Scene("egg", alpha="1/20", lam="1/2"), (Fraction(1, 2), Fraction(33, 64)), "alpha",
    ...     (Fraction(1, 20), Fraction(33, 640)))
    >>> box.turns, box.label
    (3, 'egg, alpha = 1/20 to 33/640, lam = 1/2 to 33/64')
    """

    def __init__(self, scene: Scene, lam: Range, parameter: str, shape: Range) -> None:
        middle = (shape[0] + shape[1]) / 2
        free = "" if parameter in scene.ranges or "table" in scene.document else f":{shape[0]}..{shape[1]}"
        super().__init__(scene.at(**{parameter: f"{middle}{free}"}), lam)
        self.middle = PinballImages(self.scene, lam)
        self.over, self.known = shape, dict(zip(self.map.ir.parts[0].curve.inputs[1:], self.shape, strict=True))
        self.reach = hull(exactly(shape[0] - middle).lower(), exactly(shape[1] - middle).upper())
        self.known[parameter] = hull(exactly(shape[0]).lower(), exactly(shape[1]).upper())
        self.parameter, self.shape = parameter, list(self.known.values())
        self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in self.map.ir.parts]
        turns, self.rates = _over(self.scene.text, parameter, *map(str, shape))
        self.turns = 1 if self.placed else turns
        self.shared = BoxLandings() if self.closed and not self.placed else None

    def at(self, lam: Range) -> "ParameterBox":
        """The map for the same range of shapes and another range of contractions; computed landings are shared."""
        other = copy(self)
        other.range = lam
        other.contract()
        return other

    def flights(self, boxes: Boxes) -> Flights:
        return Flights(self, boxes) if self.shared is None else ParameterFlights(self, boxes)

    def images(self, boxes: Boxes) -> Images:
        if self.shared is None:
            return super().images(boxes)
        with np.errstate(all="ignore"):
            return collected([self.row(*self.shared.of(boxes, self.landed))], boxes.chart.size)

    def landed(self, boxes: Boxes) -> Landing:
        """The landings of boxes, computed without the cache."""
        flights = self.flights(boxes)
        (piece,) = flights.pieces(*flights.arcs())
        return flights.landing(piece)

    @property
    def charts(self) -> tuple[Chart, ...]:
        found = []
        for chart in super().charts:
            low, high = chart.x
            found.append(chart._replace(x=(low, low + (high - low) / self.turns), y=(-self.height, self.height)))
        return tuple(found)

    @property
    def height(self) -> float:
        """Half the height of the charts: a quarter turn, halved as often as it still bounds all exit angles.

        So the cells for different contractions coincide, or are parts of one another.
        """
        height = QUARTER
        while height / 2 >= self.top:
            height /= 2
        return height

    @property
    def label(self) -> str:
        said = {key: str(value) for key, value in self.scene.shape.items()}
        said |= {name: f"{low} to {high}" for name, (low, high) in ((self.parameter, self.over), ("lam", self.range))}
        return ", ".join([self.scene.name, *(f"{key} = {value}" for key, value in said.items())])


class BoxLandings:
    """A cache of the landings of boxes, on one smooth closed curve.

    >>> shared, box = BoxLandings(), Boxes(np.array([0]), (np.array([0.1]), np.array([0.2])), (np.zeros(1), np.ones(1)))
    >>> arcs = lambda boxes: LandingArcs(boxes.chart, boxes.chart, *boxes.x, True)
    >>> find = lambda boxes: (arcs(boxes), hull(*boxes.x), hull(*boxes.y), None)
    >>> first, again = shared.of(box, find), shared.of(box, None)
    >>> bool(first[1].m[0] == again[1].m[0])
    True
    """

    def __init__(self) -> None:
        self.index: dict[bytes, int] = {}
        self.known = np.empty((6, 0))  # ends of the arc; midpoints and radii of landing and incidence

    def of(self, boxes: Boxes, find: Callable[[Boxes], Landing]) -> Landing:
        """The landings of the boxes; `find` computes those that are not in the cache yet."""
        keys = np.stack([*boxes.x, *boxes.y], axis=-1).view("V32").ravel().tolist()
        new = {key: i for i, key in enumerate(keys) if key not in self.index}  # equal boxes once
        if new:
            self.index |= {key: len(self.index) + count for count, key in enumerate(new)}
            piece, theta, eta, _ = find(boxes.chosen(np.array([*new.values()])))
            columns = np.broadcast_arrays(piece.low, piece.high, theta.m, theta.r, eta.m, eta.r)
            self.known = np.concatenate([self.known, np.stack(columns)], axis=1)
        low, high, *balls = self.known[:, [self.index[key] for key in keys]]
        piece = LandingArcs(np.arange(len(keys)), boxes.chart, low, high, True)
        return piece, BallArray(balls[0], balls[1]), BallArray(balls[2], balls[3]), None


class ParameterFlights(Flights):
    """Flights in a table whose shape parameter lies in a range; the parameter is a third coordinate of the boxes."""

    map: ParameterBox

    def __init__(self, map: ParameterBox, boxes: Boxes) -> None:
        super().__init__(map, boxes)
        self.middle = Flights(map.middle, boxes)

    def guess(self) -> tuple[Indices, Array, Array, Array]:
        chart, theta, ahead, behind = super().guess()
        with np.errstate(all="ignore"):
            at = BallArray(np.nan_to_num(theta))
            rate, _ = self._by_shape(np.arange(chart.size), chart, at, self.theta)
            more = np.abs(rate.m) * float(self.map.reach.magnitude()) * 1.1
        return chart, theta, ahead + more, behind + more

    def mean_value(
        self, on: Indices, chart: Indices, arc: BallArray, eta: BallArray
    ) -> tuple[BallArray, BallArray, BallArray | None]:
        by_theta, by_phi, here, there, _, _ = self.slopes(on, chart, arc)
        by_shape, turned = self._by_shape(on, chart, arc, self.thetas[on])
        reach = self.reach[0][on], self.reach[1][on], self.map.reach
        middle = self.middle.midpoint(on, chart, arc)
        theta = middle + by_theta * reach[0] + by_phi * reach[1] + by_shape * reach[2]
        turn = turn_between(self.middle.tangent(on, self.middle.centre), self.map.middle.place(chart, middle)[2:4])
        fine = self.phi[on] + turn + (there * by_theta - here) * reach[0] + (there * by_phi + 1) * reach[1]
        fine = fine + (there * by_shape + turned) * reach[2]
        return theta, common_part(eta, incidence(fine)), None

    def _by_shape(self, on: Indices, chart: Indices, arc: BallArray, start: BallArray) -> tuple[BallArray, BallArray]:
        """Derivatives by the shape parameter of the landing, and of the tangent's turn between start and landing."""
        at, (dx, dy, *_), along, slope = self.across(on, chart, arc)
        here, there = (self._rates(place) for place in (start, arc))
        dx0, dy0 = self.map.place(self.chart[on], start)[2:4]
        turn_here = (dx0 * here[3] - dy0 * here[2]) / (dx0 * dx0 + dy0 * dy0)
        turn_there = (dx * there[3] - dy * there[2]) / (dx * dx + dy * dy)
        leaves = at["v"] * (there[1] - here[1]) - at["w"] * (there[0] - here[0]) - turn_here * along
        return -leaves / slope, turn_there - turn_here

    def _rates(self, theta: BallArray) -> list[BallArray]:
        """The derivatives of point and velocity with respect to the shape parameter."""
        values = self.map.rates(self.map.ops, theta, *(self.map.known[name] for name in self.map.rates.inputs[1:]))
        return [spread(value, np.asarray(theta.m)) for value in values]


@lru_cache(maxsize=256)
def _over(text: str, parameter: str, low: str, high: str) -> tuple[int, Program]:
    """The order of a table's rotation symmetry for a range of a parameter, and a program for derivatives by the
    parameter.

    The program gives the derivatives of point and velocity of the first component. `ValueError` where the table is not
    proved convex.
    """
    table = varied(Scene.parse(text), parameter, low, high)
    if convex(table) is not True:
        raise ValueError(f"{table.name}: not proved convex for {parameter} = {low} to {high}; accepted: convex tables")
    symbols = {p.symbol.name: p.symbol for p in table.shapes}
    builder = Builder("theta", *symbols)
    nodes = dict(zip((theta, *symbols.values()), builder.nodes, strict=True))
    point = table.components[0].point
    rates = [each.diff(symbols[parameter]) for each in (*point, *(x.diff(theta) for x in point))]
    program = builder.program(*(converted(builder, rate, nodes) for rate in rates))
    return turns_of(table), program


def varied(scene: Scene, parameter: str, low: Any, high: Any) -> Table:
    """The table with one parameter free; `ValueError` if the parameter moves ends of components or enters the law.

    All boxes of parameters must have the same charts and the same law.
    """
    table: Table = scene.over(parameter, low, high)
    if any(parameter in map(str, S(end).free_symbols) for part in table.components for end in (part.start, part.end)):
        raise ValueError(f"{table.name}: the ends of components depend on {parameter}; accepted: fixed ends")
    if scene.law.measured or parameter in parameters_of_law(scene.law.formula):
        raise ValueError(
            f"law = {scene.law}: it depends on {parameter} or s; accepted: laws that do not depend on the shape"
        )
    return table


def turns_of(table: Table) -> int:
    """The order of the rotation symmetry of a table that closes smoothly; 1 for other tables."""
    return rotations(table) if closes_smoothly(table) else 1
