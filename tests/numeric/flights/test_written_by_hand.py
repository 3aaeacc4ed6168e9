"""What a flight writes by hand is what the symbolic storey derives, as an identity."""

import pytest
import sympy
from sympy import Rational

from numeric.flights.cardioid import Cardioid
from numeric.flights.circle import Circle
from numeric.flights.cuspless import Cuspless
from symbolic import tables
from symbolic.expressions.signs import vanishes
from symbolic.tables.geometry import arc_length
from symbolic.tables.table import theta


class Exact:
    """Expressions as a number system: what a flight computes, as a formula."""

    q = staticmethod(Rational)
    sin = staticmethod(sympy.sin)


WRITTEN = [(Circle, tables.circle, 0), (Cardioid, tables.cardioid, 0), (Cuspless, tables.cuspless, 0)]


@pytest.mark.parametrize(("flight", "table", "component"), [*WRITTEN, (Cuspless, tables.cuspless, 1)])
def test_arc_length_by_hand_is_the_integral_of_the_speed(flight, table, component):
    written = flight.arclength(object.__new__(flight), Exact, component, theta)

    assert vanishes(written - arc_length(table.components[component]))
