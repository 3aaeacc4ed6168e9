"""A scene is exact, and its one line of text gives the same scene, whichever form it was read from."""

import pickle
import re
import subprocess
import sys
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Interval, Rational, Symbol, cos

from symbolic import tables
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene
from symbolic.tables.table import Shape, theta

b = Symbol("b", real=True)
WAVES = tables.polar(1 + b * cos(5 * theta), "waves", [Shape(b, Interval(0, Rational(1, 30)), "crosses itself")])

TRIANGLE = """
name = "triangle"
lam = "3/10"
[shape]
b = "1/10"
[[component]]
name = "bottom"
x = "theta"
y = "0"
from = "0"
to = "1"
[[component]]
name = "right"
x = "1 - theta*(1/2 + b)"
y = "theta"
from = "0"
to = "1"
[[component]]
name = "left"
x = "(1 - theta)*(1/2 - b)"
y = "1 - theta"
from = "0"
to = "1"
"""
SCENES = [
    Scene("circle", lam=0),
    Scene("ellipse", a="sqrt(2)", lam="0.9"),
    Scene("egg", alpha=Rational(2, 25), lam=Fraction(1, 2)),
    Scene("egg", alpha="1/50", lam="1/2", K=5),
    Scene("cuspless", lam="0.0712"),
    Scene(tables.polar(1 + cos(5 * theta) / 40), lam="1/3"),
    Scene(tables.parametric("3*cos(theta)", "2*sin(theta) + sqrt(2)"), lam="1"),
    Scene.parse(TRIANGLE),
    Scene.of({"polar": "1 + cos(2*theta)/9", "origin": {"component": 0, "theta": "pi/2"}, "lam": "1/2"}),
]

HOLE = (
    TRIANGLE
    + """
[[component]]
name = "disc"
x = "1/2 + cos(theta)/10"
y = "1/4 - sin(theta)/10"
from = "-pi"
to = "pi"
hole = true
"""
)


def test_a_component_may_say_that_it_bounds_a_hole():
    scene = Scene.parse(HOLE)
    assert scene.table == Scene.parse(HOLE.replace("hole = true", "")).table
    assert Scene.parse(scene.text) == scene
    with pytest.raises(ValueError, match="component 1: hole = true"):
        _ = Scene.parse(TRIANGLE.replace('name = "bottom"', 'name = "bottom"\nhole = true')).table
    with pytest.raises(ValueError, match="component 4: hole = 1; accepted: true, false"):
        Scene.parse(HOLE.replace("hole = true", "hole = 1"))


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_a_scene_is_one_line_of_text_and_back(scene):
    assert "\n" not in scene.text
    assert Scene.parse(scene.text) == scene
    assert Scene.of(scene.document) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert hash(Scene.parse(scene.text)) == hash(scene)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_the_table_of_a_scene_makes_the_scene_again(scene):
    again = Scene(scene.table, lam=scene.lam)

    assert again.table == scene.table
    assert again == scene or (scene.document.get("shape") and "table" not in scene.document)  # letters became numbers


@pytest.mark.slow
@given(st.fractions(0, 1, max_denominator=10**6), st.fractions(0, Fraction(1, 10), max_denominator=10**6))
def test_every_way_to_write_a_number_is_the_same_scene(lam, alpha):
    scene = Scene("egg", alpha=alpha, lam=lam)

    assert scene == Scene(tables.egg(3), alpha=str(alpha), lam=Rational(lam.numerator, lam.denominator))
    assert scene.at(lam=0).at(lam=str(lam)) == scene
    assert (scene.lam, scene.shape) == (lam, {"alpha": alpha})


@pytest.mark.parametrize(
    ("table", "shape", "says"),
    [
        (WAVES, {"b": "1/40"}, "waves: b is 1/10 in the law and has 1/40 in the table"),
        (WAVES, {"b": "1/40:0..1/50 + 1/100"}, "waves: b is 1/10 in the law and has 1/40 in the table"),
        (WAVES, {}, "waves: b is 1/10 in the law and has no number in the table"),
        ("circle", {"b": "1/40"}, "circle: b is 1/10 in the law and has 1/40 in the scene"),
    ],
)
def test_a_name_means_one_number_in_table_and_law(table, shape, says):
    law = Law("-lam*eta - b*sin(2*eta)").at(b="0.1")

    with pytest.raises(ValueError, match=says + "; a name means one number, so rename one of the two$"):
        Scene(table, law=law, lam="1/2", **shape)


def test_a_name_in_table_and_law_has_the_number_that_both_say():
    law = Law("-lam*eta - alpha*sin(2*eta)")
    scene = Scene("egg", alpha="0.08", lam="1/2", law=law)

    assert scene == Scene("egg", alpha="2/25", lam="1/2", law=law.at(alpha="0.08"))
    assert scene.at(alpha="1/20").law == law.at(alpha="1/20")
    with pytest.raises(ValueError, match=r"alpha is 1/10 in the law and has 2/25 in the table"):
        Scene("egg", alpha="2/25", law="-lam*eta").at(law=law.at(alpha="1/10"))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('table = "egg"', "alpha needs a value"),
        ('table = "egg"\nlam = 0.5\nshape = { alpha = "0.08" }', "rounded float"),
        ('table = "eggs"', "no table is called 'eggs'"),
        ('table = "circle"\nlam = "2"', "no contraction"),
        ('table = "circle"\nlambda = "1"', "'lambda' is unknown"),
        ('table = "circle"\npolar = "1"', "table and polar given"),
        ('polar = "__import__(theta)"', "__import__"),
        ('polar = "1 + b*cos(theta)"', "b"),
        ('[[component]]\nx = "theta"\ny = "0"\nfrom = "0"', "component 1 has no to"),
        ('table = "circle', "scene:"),
        ('name = "a\\u001b[2J"\npolar = "1"', "is no name"),
    ],
)
def test_a_wrong_entry_is_named_in_one_sentence(text, says):
    with pytest.raises(ValueError, match="(?s)" + says.replace("(", r"\(")) as caught:
        Scene.parse(text)
    assert "\n" not in str(caught.value)


def test_one_of_the_paper_s_scenes_needs_no_sympy():
    code = "from symbolic import Scene as S; s = S('egg', alpha='0.08', lam='1/2'); S.parse(s.text).at(lam=0).lam"
    done = subprocess.run([sys.executable, "-c", code + "; import sys; sys.exit('sympy' in sys.modules)"], check=False)

    assert done.returncode == 0


def test_a_parameter_keeps_its_range_in_text_and_with_other_numbers():
    scene = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "0.1:0..0.25"}, "lam": "1/2"})

    assert scene.shape == {"b": Fraction(1, 10)}
    assert scene.ranges == {"b": (0, Fraction(1, 4))}
    assert Scene.parse(scene.text) == scene
    assert scene.at(b="1/5", lam=1).ranges == scene.ranges
    assert [p.range for p in scene.family.shapes] == [Interval(0, Rational(1, 4))]
    assert scene.table == tables.polar("1 + cos(5*theta)/10")


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("0.1:0..5/4", "rho = b*cos(5*theta) + 1 is not positive at theta = "),
        ("0.1:0-1/4", "b = 0.1:0-1/4 is no value with its range; accepted: VALUE:LOW..HIGH such as 0.1:0..1/4"),
        ("0.1:1/4..0", "b = 0.1:1/4..0: 1/4..0 is no range; accepted: LOW..HIGH with LOW < HIGH"),
        ("0.1:0.2..0.3", "b = 1/10 lies outside of its range 1/5..3/10"),
    ],
)
def test_a_range_in_which_there_is_no_table_is_refused_in_one_sentence(given, says):
    with pytest.raises(ValueError, match=re.escape(says)):
        Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": given}})


@pytest.mark.parametrize("text", [".".join("a" * 50_000) + " = 1", '"a".' * 20_000 + "b = 1", "x = " + "[" * 100_000])
def test_a_scene_file_that_is_nested_without_end_is_refused_in_one_sentence(text):
    with pytest.raises(ValueError, match="accepted: "):
        Scene.parse(text)
