"""The live table without a browser: choices, dragging, clicks and typed input."""

import asyncio
import re
import runpy
import shlex

import numpy as np
import pytest

from symbolic.tables.definition import PAPER
from verification.app.choice import OWN, BoundaryParticle, Choice
from verification.app.cli import main, refusal
from verification.app.live import LiveTable

SEVERAL = (*PAPER, OWN, "diamond")


@pytest.fixture
def live():
    return LiveTable()


@pytest.mark.slow
@pytest.mark.parametrize("table", SEVERAL)
def test_the_command_on_the_page_is_one_that_runs(table, live, capsys):
    live.table.value = table
    live.bounces.value = 3

    words = shlex.split(live.command.value)
    assert words[0] == "pinball"
    assert main(words[1:]) == 0
    assert "3 bounces" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("table", SEVERAL)
def test_the_python_on_the_page_gives_the_orbit_that_is_drawn(table, live, tmp_path):
    live.table.value = table
    live.bounces.value = 5
    script = tmp_path / "script.py"
    script.write_text(live.python.value)

    assert np.array_equal(runpy.run_path(str(script))["orbit"].x, live.path.data["x"])


def test_the_dragged_particle_starts_where_the_boundary_is_nearest(live):
    live.table.value = "circle"
    live.dots.data = {"x": [0.0, 0.0], "y": [1.3, 0.0]}

    assert live.choice.theta == pytest.approx(np.pi / 2, abs=1e-6)
    assert live.choice.phi == pytest.approx(0, abs=1e-6)
    assert f"--start={live.choice.theta!r}," in live.command.value


def test_the_dragged_arrow_turns_the_particle(live):
    live.table.value = "circle"
    before = dict(live.dots.data)
    live.dots.data = {"x": [before["x"][0], 0.0], "y": [before["y"][0], 0.0]}

    assert live.choice.phi == pytest.approx(0, abs=1e-6)


def test_a_bad_shape_is_one_sentence_and_the_old_table_stays(live):
    before = live.choice
    live.shape.value = "0.5"

    assert "accepted" in live.said.object or "must lie in" in live.said.object
    assert live.choice == before


def test_nobody_waits_while_the_formula_of_another_is_read():
    """The event loop keeps turning while a formula is read; a blocking call would let it turn once."""

    async def turns() -> int:
        reading = asyncio.create_task(refusal(["orbit", "--polar", "1 + cos(9*theta)/90", "--lam", "1/2"], 60))
        count = 0
        while not reading.done():
            await asyncio.sleep(0.001)
            count += 1
        assert "--start" in await reading
        return count

    assert asyncio.run(turns()) > 1


@pytest.mark.slow
def test_what_is_typed_is_never_executed(live):
    live.table.value = "polar formula"
    live.formula.value = "__import__('os').getcwd()"

    assert re.search("accepted", live.said.object)


@pytest.mark.slow
def test_the_first_page_finds_the_triangle_that_its_orbit_ends_on_and_says_when_an_orbit_ends_on_none(live):
    live.find_cycle()
    assert "The orbit ends on a cycle of period 3, attracting" in live.said.object

    live.start(BoundaryParticle(0, 0.3, 0.2))  # in the chaotic sea
    live.find_cycle()
    assert "the orbit is on no cycle" in live.said.object
    assert "not attracting" in live.said.object


@pytest.mark.slow
def test_the_cycle_that_a_settling_orbit_ends_on_is_found_from_far_away(live):
    """The egg's triangle attracts at 0.9, and the first bounces of this orbit are far from it."""
    live.lam.value = 0.9
    live.find_cycle()

    assert "ends on a cycle of period 3, attracting" in live.said.object


def test_the_strip_shows_where_orbits_end_for_all_contractions_and_where_the_slider_is(live):
    before = live.diagram.data["x"]
    live.lam.value = 0.2

    assert [mark.location for mark in live.marks] == [0.2, 0.2]
    assert live.diagram.data["x"] is before  # another contraction has the same diagram
    settled = live.diagram.data["y"][np.abs(live.diagram.data["x"] - 0.05) < 1e-9]
    assert len(np.unique(settled.round(5))) <= 12  # two bounces of a diameter that the egg has thrice
    nu = dict(zip(live.growth.data["x"].round(3), live.growth.data["y"], strict=True))
    assert nu[0.6] > 0 > nu[0.2]
    live.table.value = "circle"
    assert live.diagram.data["x"] is not before


def test_the_exponents_of_the_orbit_come_with_their_errors(live):
    live.start(BoundaryParticle(0, 0.3, 0.2))  # in the chaotic sea

    assert re.search(r"Exponents per bounce: 0\.\d+ ± \S+ and -\d", live.said.object)


def test_basins_are_coloured_when_they_are_asked_for_and_gone_with_the_next_table(live):
    live.show_basins()
    (image,) = live.cells.data["image"]

    assert "chaotic" in live.said.object
    assert "period 3" in live.said.object
    assert len(np.unique(image)) >= 3
    live.table.value = "ellipse"
    assert live.cells.data["image"] == []


@pytest.mark.slow
def test_a_law_of_ones_own_is_drawn_and_one_that_is_none_is_a_sentence(live, capsys):
    live.law.value = "-lam*sin(eta)"
    assert "'--law=-lam*sin(eta)'" in live.command.value
    assert "law='-lam*sin(eta)'" in live.python.value
    before = live.map
    live.law.value = "-4*eta"

    assert "law" in live.said.object
    assert live.map is before


def test_an_address_brings_back_the_page_and_nonsense_in_one_does_no_harm():
    choice = Choice("ellipse", shape="1.25", lam="0.7", theta=0.5, phi=-0.125, bounces=7)
    again = LiveTable(Choice.of_address(choice.address()))

    assert Choice.of_address(choice.address()) == choice
    assert again.choice == choice
    assert again.command.value == choice.command()
    for said in (
        {"lam": "2"},
        {"lam": "x"},
        {"table": "__import__"},
        {"phi": "1e9"},
        {"component": "-1"},
        {"theta": "nan"},
    ):
        LiveTable(Choice.of_address(said))
