"""The parts of a generated function give the same bits as the whole function."""

import random

import pytest
from flint import arb

from symbolic.expressions.parts import parted
from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import cardioid, cuspless, egg, ellipse
from verification.arithmetic.balls import FLOAT64, balls, working

BITS = 90
CASES = [(egg(3), 0, 0), (egg(3).at(alpha="2/25"), 0, 0), (cardioid, 0, 0), (ellipse, 0, 0)]
CASES += [(cuspless, 0, 0), (cuspless, 0, 1), (cuspless, 1, 0)]


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(("table", "here", "there"), CASES)
def test_a_chord_from_its_two_ends_has_the_bits_of_the_chord(table, here, there, order):
    shapes, draw = tuple(p.symbol.name for p in table.shapes), random.Random(order)
    whole = chord_kernel(table, here, there, order)
    at_here, _, rest = parts = parted(whole, ("theta0", *shapes), ("theta1", *shapes))
    assert "theta1" not in at_here.arguments
    assert "sin(" not in rest.text
    with working(BITS):
        for number, arithmetic in ((float, FLOAT64), (lambda x: arb(x, 1e-6), balls(BITS))):
            of_here, of_there, left = (load(part, arithmetic) for part in parts)
            one, other = number(draw.uniform(-0.4, 0.4)), number(draw.uniform(1, 2))
            shape = [number(draw.uniform(1.01, 1.1) if table is ellipse else 0.03) for _ in shapes]
            found = left(one, other, *shape, *of_here(one, *shape), *of_there(other, *shape))
            assert list(map(_bits, found)) == list(map(_bits, load(whole, arithmetic)(one, other, *shape)))


def _bits(x):
    return x if isinstance(x, float) else (x.mid().man_exp(), x.rad().man_exp())
