"""Each table family that is a file: every command finds it by name, and it is as its literature says."""

from pathlib import Path

import pytest
from sympy import Rational, S, pi, simplify, sqrt

from numeric import PinballMap
from symbolic import Scene, tables
from symbolic.tables import definition, families
from symbolic.tables.geometry import perimeter
from symbolic.tables.validity import enclosed_area
from verification.app.cli import main

FILES = [path.stem for path in Path(families.__file__).parent.glob("[a-z]*.py")]


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_all_that_a_family_takes(name, capsys):
    table = tables.GALLERY[name]()

    assert name in definition.GALLERY
    assert table.name == name
    assert Scene.parse(Scene(table, lam="1/2").text).table == table
    assert PinballMap(name, lam="1/2").step(0.1, 0.2).status.name == "REGULAR"
    assert main(["orbit", name, "--lam", "1/2", "--start", "0.1,0.2", "--bounces", "2"]) == 0
    assert "right" in capsys.readouterr().out


def test_a_name_that_no_file_has_is_none():
    with pytest.raises(KeyError, match="circus"):
        tables.GALLERY["circus"]
    assert len(tables.GALLERY) == len(list(tables.GALLERY)) == len(definition.GALLERY)


def test_the_elliptical_stadium_is_the_stadium_where_its_axes_are_equal():
    make = tables.GALLERY["elliptical_stadium"]
    like = make(straight=3, a=1)

    for ours, theirs in zip(like.components, tables.stadium(3).components, strict=True):
        assert ours.point == theirs.point
        assert (ours.start, ours.end) == (theirs.start, theirs.end)
    assert simplify(perimeter(like) - (6 + 2 * pi)) == 0
    assert simplify(enclosed_area(make()) - (4 + pi * Rational(21, 20))) == 0
    assert make().components[0].at(pi / 2) == (S.One, S.One)


def test_its_own_numbers_are_those_for_which_an_exponent_is_positive():
    """Markarian, Oliffson Kamphorst and Pinto de Carvalho prove it for sides longer than `4*a*a*sqrt(a*a - 1)`."""
    a = Rational(21, 20)
    found = PinballMap("elliptical_stadium", lam=1, kernels=False).exponents(0.1, 0.2, 400)

    assert 1 < a < sqrt(4 - 2 * sqrt(2))
    assert 4 * a**2 * sqrt(a**2 - 1) < 2
    assert found.nu_plus > 0.1
