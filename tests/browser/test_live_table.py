"""The live table in a real browser: it draws, follows dragging and typing, and finds cycles."""

import re
import subprocess
import sys
from urllib.request import urlopen

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from verification.app.live import serve

PATIENCE = 30_000  # milliseconds


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """The address of a page of `pinball explore`, served by the command, which must print no error."""
    asked = [sys.executable, "-u", "-m", "verification", "explore", "--no-open"]
    said = tmp_path_factory.mktemp("explore") / "stderr"
    with said.open("w") as errors, subprocess.Popen(asked, stdout=subprocess.PIPE, stderr=errors, text=True) as process:
        found = re.search(r"http://127\.0\.0\.1:\d+/", process.stdout.readline())[0]
        for _ in range(120):
            try:
                urlopen(found, timeout=5).close()
                break
            except OSError:
                with pytest.raises(subprocess.TimeoutExpired):
                    process.wait(0.25)
        yield found
        process.terminate()
    assert "Traceback" not in said.read_text()


def outside(url):
    return url.startswith("http") and not url.startswith("http://127.0.0.1:")


@pytest.fixture
def table(chromium, address):
    page = chromium.new_page(viewport={"width": 1400, "height": 1000})
    page.set_default_timeout(PATIENCE)
    said = []
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda asked: said.append(asked.url) if outside(asked.url) else None)
    page.goto(address)
    page.get_by_role("button", name="Find the cycle").wait_for()
    yield page
    page.close()
    assert said == []


def command(page, start):
    """Waits until the page shows a command that begins with this text."""
    expect(page.get_by_label("As a command")).to_have_value(re.compile(f"^{start}"), timeout=PATIENCE)


def test_it_shows_a_table_and_phase_space(table):
    assert table.locator("canvas").count() >= 2
    command(table, "pinball orbit egg --alpha 0.08 --lam 0.45")


def test_another_table_brings_its_own_shape(table):
    table.get_by_label("Table").select_option("ellipse")

    table.get_by_label("a, shape of the ellipse").wait_for()
    command(table, "pinball orbit ellipse --a 1.5")


def test_a_formula_that_is_none_is_answered_with_a_sentence(table):
    table.get_by_label("Table").select_option("polar formula")
    command(table, "pinball orbit --polar")  # the field is on the page to stay
    field = table.get_by_label("Radius, a formula in theta")
    field.fill("1 + __import__('os')")
    field.press("Enter")

    table.get_by_text("accepted:").wait_for()


def test_the_cycle_near_the_particle_is_found_with_its_multipliers(table):
    table.get_by_role("button", name="Find the cycle").click()

    table.get_by_text("The orbit ends on a cycle of period 3, attracting").wait_for()


def test_an_address_holds_the_bounces_that_are_drawn(table, address):
    table.goto(f"{address}?lam=0.9&bounces=7")

    command(table, "pinball orbit egg --alpha 0.08 --lam 0.9 .*--bounces 7$")


def test_an_impatient_visitor_is_answered(table):
    for alpha in range(91, 80, -1):  # while phase space is filled
        table.get_by_role("button", name="Find the cycle").click()
        table.get_by_label("alpha, shape of the egg").fill(f"0.0{alpha}")
        table.keyboard.press("Enter")

    command(table, "pinball orbit egg --alpha 0.081")
    table.get_by_role("button", name="Find the cycle").click()
    table.get_by_text("a cycle of period").wait_for()


def test_a_click_in_phase_space_starts_there(table):
    space = max((each.bounding_box() for each in table.locator("canvas").all()), key=lambda box: box["x"])
    table.mouse.click(space["x"] + space["width"] * 0.6, space["y"] + space["height"] * 0.4)

    command(table, r"pinball orbit egg --alpha 0.08 --lam 0.45 --start=(?!0\.4,)")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_accessible(table, scheme):
    """Labels, landmarks, contrast and keyboard, by axe."""
    table.emulate_media(color_scheme=scheme)
    table.locator("[role=main]").wait_for()

    found = Axe().run(table)
    assert found.violations_count == 0, found.generate_report()


def test_it_is_served_on_loopback_only(monkeypatch):
    given = {}
    monkeypatch.setattr("panel.serve", lambda *_, **options: given.update(options))
    serve(5006, show=False)

    assert given["address"] == "127.0.0.1"
    assert all(origin.split(":")[0] in ("127.0.0.1", "localhost") for origin in given["websocket_origin"])


def test_on_a_phone_the_table_comes_before_the_controls_and_the_texts_to_copy_come_last(table):
    table.set_viewport_size({"width": 390, "height": 844})
    command(table, "pinball orbit egg")
    room, space = (table.locator(".bk-Figure").nth(i) for i in (0, 1))
    shown = (room, table.get_by_label("Table"), space, table.get_by_label("As a command"))
    tops = [each.bounding_box()["y"] for each in shown]

    assert tops == sorted(tops)
    assert table.evaluate("document.documentElement.scrollWidth") <= 390
