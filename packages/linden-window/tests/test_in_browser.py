"""Claims about the page in a real browser, drawn by the processor, and in a browser without WebGL."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from browsers import running_browser
from linden_window.link import PageLink
from window_pages import WAIT_MS, begin, drive, page_of

BY_PROCESSOR = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser(*BY_PROCESSOR) as found:
        yield found


def test_the_world_is_drawn_and_actors_move_between_frames(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address + "?view=chase")
    page.wait_for_function("globalThis.page?.world.loaded > 0", timeout=WAIT_MS)
    drive(link, page, 20)
    page.wait_for_function("page.poses.length === 1 && page.renderer.info.render.triangles > 100", timeout=WAIT_MS)
    assert page.evaluate("page.cameras.view") == "chase"
    assert "vehicle.tesla.model3" in page.inner_text("#actor")
    assert "18.0 km/h" in page.inner_text("#actor")
    middle = page.evaluate(
        "(() => { const [a, b] = page.timeline.frames.slice(-2);"
        " return page.timeline.poses((a.clock + b.clock) / 2)[0].x; })()"
    )
    assert middle == pytest.approx(9.75, abs=0.01)
    assert page.errors == []
    page.close()


def test_views_help_and_shapes(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page?.world.loaded > 0", timeout=WAIT_MS)
    drive(link, page, 3)
    shape = {"form": "line", "colour": [255, 0, 0], "from": [0, 0, 1], "to": [5, 0, 1], "width": 0.1, "until": None}
    link.note({"type": "debug", "reset": False, "dropped": 0, "shapes": [shape, {**shape, "until": 0.01}]})
    page.wait_for_function("page.debug.shapes.length === 1", timeout=WAIT_MS)
    for digit, view in enumerate(("orbit", "chase", "driver", "free", "map", "spectator"), 1):
        page.keyboard.press(str(digit))
        page.wait_for_function(f"page.cameras.view === '{view}'", timeout=WAIT_MS)
    page.keyboard.press("?")
    assert "views: orbit" in page.inner_text("#help")
    assert page.errors == []
    page.close()


def test_lights_night_and_rain_reach_the_scene(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page?.world.loaded > 0 && page.world.switched.length > 0", timeout=WAIT_MS)
    colours = "page.world.switched.map(({geometry}) => [...geometry.getAttribute('color').array]).flat().join()"
    before = page.evaluate(colours)
    link.note({"type": "lights", "states": [2] * 50})
    page.wait_for_function(f"{colours} !== {before!r}", timeout=WAIT_MS)
    weather = {"cloudiness": 90, "precipitation": 80, "sun_altitude_angle": -30, "wetness": 80, "fog_density": 5}
    link.note({"type": "weather", "weather": weather})
    page.wait_for_function("page.world.isNight && page.world.rain.visible", timeout=WAIT_MS)
    page.wait_for_function("document.getElementById('figures').innerText.includes('night, rain')", timeout=WAIT_MS)
    page.close()


def test_the_page_says_when_the_program_has_ended(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page?.connection.bytes > 0", timeout=WAIT_MS)
    link.close()
    page.wait_for_function("document.getElementById('says').innerText.includes('has ended')", timeout=WAIT_MS)
    page.close()


def test_a_telephone_shows_the_map_without_overflow(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address, 390, 844)
    page.wait_for_function("globalThis.page?.map.edges", timeout=WAIT_MS)
    assert page.is_visible("#map")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    page.close()
