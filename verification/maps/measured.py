"""The paper's arc length, for curves where it is an integral, in every kind of number in which a law is evaluated."""

from functools import cache, lru_cache
from typing import Any

import numpy as np
from flint import arb, arb_series, ctx
from sympy import pi

from symbolic.expressions.text import kernel, load
from symbolic.tables.geometry import speed
from symbolic.tables.table import Table, theta
from verification.arithmetic.balls import Arithmetic
from verification.arithmetic.series import Jet
from verification.maps.enclosed import EnclosedMap
from verification.maps.exact import ExactMap


@cache
def map_of(table: Table, maker: Any) -> Any:
    """The map with `lam = 1` of a table without free shape parameters, made by `maker` and cached."""
    return maker(table, lam=1)


class Lengths:
    """The paper's arc length on a closed curve where it is an integral: of floats, arrays, mpmath numbers, balls, jets.

    The length grows over one turn of the curve's parameter and jumps by the perimeter at the ends of its range.
    """

    def __init__(self, table: Table) -> None:
        from numeric import PinballMap

        self.map, self.exact, self.enclosed = map_of(table, PinballMap), dict[int, ExactMap](), dict[int, Any]()
        (whole,) = table.components
        if (whole.start, whole.end) != (-pi, pi):
            raise ValueError(
                f"{table.name}: theta runs from {whole.start} to {whole.end}; s is integrated over -pi to pi only"
            )
        self.rate = kernel("speed", [theta], {"speed": speed(whole)})

    def placed(self, arithmetic: Arithmetic, here: Any) -> list[Any]:
        """The parameter, moved by whole turns to between -pi and pi, followed by the arc length there."""
        middle = here.c[0] if isinstance(here, Jet) else here[0] if isinstance(here, arb_series) else here
        turns = np.round(np.asarray(middle, dtype=float) / (2 * np.pi))
        here = here - 2 * arithmetic.pi * (turns if turns.ndim else int(turns)) if np.any(turns) else here
        if not isinstance(here, (Jet, arb_series)):
            return [here, self.of(here)]
        (rate,) = load(self.rate, arithmetic)(here)
        if isinstance(here, arb_series):
            return [here, (rate * here.derivative()).integral() + self.of(here[0])]
        steps = rate * Jet(*(k * c for k, c in enumerate(here.c[1:], 1)), 0)
        return [here, Jet(self.of(here.c[0]), *(c / k for k, c in enumerate(steps.c[:-1], 1)))]

    def of(self, here: Any) -> Any:
        """Arc length at a number; for a ball, enclosed by the length at its midpoint and the speed over the ball."""
        if isinstance(here, arb):
            if ctx.prec not in self.enclosed:
                self.enclosed[ctx.prec] = EnclosedMap(self.map, 1, ctx.prec)
            return _enclosed(self.enclosed[ctx.prec], here.lower().man_exp(), here.upper().man_exp())
        if not hasattr(here, "context"):
            return self.map.arclength.s(here)
        if here.context.dps not in self.exact:
            self.exact[here.context.dps] = ExactMap(self.map, here.context.dps)
        return here.context.mpf(self.exact[here.context.dps].length(0, here))


@lru_cache(256)  # since boxes often differ in other bounces only
def _enclosed(map: EnclosedMap, low: Any, high: Any) -> arb:
    found: arb = map.length(0, arb(low).union(arb(high)))
    return found


arc_length = cache(Lengths)
