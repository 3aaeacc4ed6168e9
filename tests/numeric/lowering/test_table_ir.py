"""Table IRs: shape values are checked against their ranges, and a table is restored unchanged from its text."""

from fractions import Fraction

import pytest

from numeric.lowering.lower import lower
from numeric.lowering.program import ShapeRange, TableIR, by_name, table_ir
from symbolic import tables
from symbolic.tables.scene import Scene


@pytest.mark.parametrize("name", ["circle", "ellipse", "cardioid", "cuspless", "egg"])
def test_a_blueprint_comes_back_from_its_text(name):
    made = table_ir(name)

    assert TableIR.from_text(made.as_text()) == made
    assert made.table == name


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (Fraction(-1, 10**9), r"flat: b = -1e-09 is odd; b must lie in \[0, 1/10\]"),
        (Fraction(1, 3), r"flat: b = 1/3 is odd; b must lie in \[0, 1/10\]"),
        (Fraction(999_998, 999_999), "b = 999998/999999 is odd"),
        (Fraction(10**6 + 1, 10**6), "b = 1.000001 is odd"),
    ],
)
def test_a_shape_outside_its_range_is_shown(value, words):
    with pytest.raises(ValueError, match=words):
        ShapeRange("b", "0", "1/10", "is odd").check("flat", value)


def test_eggs_are_kept_apart_by_their_number_of_points(tmp_path, monkeypatch):
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    two, three = table_ir("egg", 2), table_ir("egg")

    assert three == lower(tables.named("egg", 3))
    assert two == lower(tables.named("egg", 2)) != three
    assert len(list(tmp_path.iterdir())) == 2
    assert (table_ir("egg", 2), table_ir("egg", 3)) == (two, three)


def test_a_table_of_the_gallery_by_name_is_the_exact_one_with_its_lengths_and_is_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    made = {radius: lower(tables.stadium(radius=radius)) for radius in ("1", "1/2")}
    for _ in range(2):  # the second time from the file
        for written, radius in (("1/2", "1/2"), (0.5, "1/2"), (1, "1")):
            assert table_ir(by_name("stadium", {"radius": written})) == made[radius]
        assert table_ir(by_name("stadium", {})) == made["1"]

    assert len(list(tmp_path.glob("table_ir-*"))) == 3  # lengths that are left out are a text of their own
    assert table_ir(by_name("sinai", {})) == lower(tables.sinai())


def test_the_table_of_a_scene_is_kept_for_every_law_and_contraction_and_for_no_other_shape(tmp_path, monkeypatch):
    monkeypatch.setenv("PINBALL_CACHE", str(tmp_path))
    flower = Scene.of({"polar": "1 + b*cos(3*theta)", "shape": {"b": "1/20"}, "lam": "1/2"})
    alike = flower.at(lam="1/3", law="-lam*eta - c*sin(2*eta)", c="1/10")
    made = table_ir(flower)

    assert made == lower(flower.table)
    assert table_ir(alike) == made
    assert len(list(tmp_path.iterdir())) == 1
    assert table_ir(flower.at(b="1/30")) == lower(flower.at(b="1/30").table) != made
    assert len(list(tmp_path.iterdir())) == 2
