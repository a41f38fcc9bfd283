"""Claims about the page in a real browser, drawn by the processor, and in a browser without WebGL."""

import select
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser

from browsers import running_browser
from linden.maps.library import MapLibrary
from linden.world import World
from linden_window import panes
from linden_window.link import PageLink
from opendrive_texts import SIGNS_AND_LIGHTS
from served_windows import BY_PROCESSOR
from window_pages import begin, drive, page_of


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser(*BY_PROCESSOR) as found:
        yield found


def test_the_world_is_drawn_and_actors_move_between_frames(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address + "?view=chase")
    page.wait_for_function("globalThis.page?.world.loaded > 0")
    drive(link, page, 20)
    page.wait_for_function("page.poses.length === 1 && page.renderer.info.render.triangles > 100")
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
    page.wait_for_function("globalThis.page?.world.loaded > 0")
    drive(link, page, 3)
    shape = {"form": "line", "colour": [255, 0, 0], "from": [0, 0, 1], "to": [5, 0, 1], "width": 0.1, "until": None}
    link.note({"type": "debug", "reset": False, "dropped": 0, "shapes": [shape, {**shape, "until": 0.01}]})
    page.wait_for_function("page.debug.shapes.length === 1")
    for digit, view in enumerate(("orbit", "chase", "driver", "free", "map", "spectator"), 1):
        page.keyboard.press(str(digit))
        page.wait_for_function(f"page.cameras.view === '{view}'")
    page.keyboard.press("?")
    assert "views: orbit" in page.inner_text("#help")
    assert page.errors == []
    page.close()


def test_lights_night_and_rain_reach_the_scene(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page?.world.loaded > 0 && page.world.switched.length > 0")
    colours = "page.world.switched.map(({geometry}) => [...geometry.getAttribute('color').array]).flat().join()"
    before = page.evaluate(colours)
    link.note({"type": "lights", "states": [2] * 50})
    page.wait_for_function(f"{colours} !== {before!r}")
    weather = {"cloudiness": 90, "precipitation": 80, "sun_altitude_angle": -30, "wetness": 80, "fog_density": 5}
    link.note({"type": "weather", "weather": weather})
    page.wait_for_function("page.world.isNight && page.world.rain.visible")
    page.wait_for_function("document.getElementById('figures').innerText.includes('night, rain')")
    page.close()


def test_the_page_says_when_the_program_has_ended(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page?.connection.bytes > 0")
    link.close()
    page.wait_for_function("document.getElementById('says').innerText.includes('has ended')")
    page.close()


def test_a_page_connects_again_and_the_keys_that_are_down_hold(link: PageLink, browser: Browser) -> None:
    begin(link)
    link.note({"type": "route", "ego": 7, "drives": True, "stops": [], "points": [], "controls": [], "half": 1.75})
    page = page_of(browser, link.address + "?flat")
    page.wait_for_function("globalThis.page?.input.isOn")
    page.keyboard.down("w")
    found: list[dict[str, Any]] = []

    def driven(number: int) -> bool:
        return any(order["order"] == "drive" and order["held"] and order["page"] == number for order in found)

    for number in (1, 2):
        while not driven(number) and link.is_open:
            select.select([link], [], [], 1.0)
            found += link.orders()
        page.evaluate("page.connection.socket.close(4000, 'keepalive ping timeout')")
        page.wait_for_function("document.getElementById('says').innerText.includes('tries to connect again')")
    assert page.errors == []
    page.close()


SENSORS = [
    {"name": "FRONT", "type": "sensor.camera.rgb"},
    {"name": "TOP", "type": "sensor.lidar.ray_cast"},
    {"name": "GPS", "type": "sensor.other.gnss"},
]
PIXELS = "[...document.querySelector('#panes canvas').getContext('2d').getImageData({x}, {y}, 1, 1).data]"


def test_sensors_have_panes_that_buttons_and_n_open_and_close(link: PageLink, browser: Browser) -> None:
    begin(link)
    link.note({"type": "sensors", "sensors": SENSORS})
    page = page_of(browser, link.address + "?flat")
    page.wait_for_function("document.querySelectorAll('#sensors button').length === 3")
    page.keyboard.press("n")
    assert page.locator("#panes figure").count() == 1
    picture = np.zeros((40, 60, 3), np.uint8)
    picture[:, 30:] = (10, 200, 30)
    link.pane("FRONT", panes.picture("FRONT", 12, picture))
    page.wait_for_function("page.panes.drawn.get('FRONT') === 1")
    assert page.evaluate(PIXELS.format(x=10, y=5)) == [0, 0, 0, 255]
    assert page.evaluate(PIXELS.format(x=50, y=5)) == [10, 200, 30, 255]
    assert "FRONT: camera.rgb" in page.inner_text("#panes")
    assert "frame 12" in page.inner_text("#panes")
    page.keyboard.press("n")
    ahead_and_right = np.array([[6.0, 0.0], [0.0, 6.0]])
    link.pane("FRONT", panes.picture("FRONT", 13, picture))  # of a pane that is closed
    link.pane("TOP", panes.points("TOP", 13, ahead_and_right, np.array([[255, 0, 0], [0, 0, 255]], np.uint8)))
    page.wait_for_function("page.panes.drawn.get('TOP') === 1")
    assert page.evaluate(PIXELS.format(x=180, y=72)) == [255, 0, 0, 255]
    assert page.evaluate(PIXELS.format(x=288, y=180)) == [0, 0, 255, 255]
    page.click("#sensors button >> text=GPS")
    link.pane("GPS", panes.lines("GPS", 14, [("Latitude", "40.0000000° N")]))
    page.wait_for_function("document.getElementById('panes').innerText.includes('40.0000000° N')")
    assert page.locator("#panes figure").count() == 2
    page.click("[aria-label='Close TOP']")
    assert page.evaluate("[...page.panes.open.keys()]") == ["GPS"]
    assert page.evaluate("page.panes.drawn.get('FRONT')") == 1
    wanted = [[], ["FRONT"], ["TOP"], ["TOP", "GPS"], ["GPS"]]
    asked: list[list[str]] = []
    while len(asked) < len(wanted) and link.is_open:
        select.select([link], [], [], 1.0)
        asked += [order["names"] for order in link.orders() if order["order"] == "sensors"]
    assert asked == wanted
    assert page.errors == []
    page.close()


def lights_of_street() -> list[str]:
    world = World(MapLibrary().from_opendrive(SIGNS_AND_LIGHTS))
    return [actor.sign_id for actor in world.episode.traffic.actors if actor.light == 0]


def test_figures_lines_and_paths_of_a_drive_are_shown(link: PageLink, browser: Browser) -> None:
    begin(link)
    sign = {"kind": "stop_sign", "id": "9", "x": 20.0, "y": 0.0, "z": 0.0, "yaw": 0.0}
    light = {**sign, "kind": "traffic_light", "id": lights_of_street()[0], "x": 30.0}
    path = {"points": [[0, 0, 0], [60, 0, 0]], "controls": [sign, light], "half": 1.75}
    link.note({"type": "route", "ego": 7, "drives": True, "stops": [{"name": "Stop A", "x": 40.0, "y": 3.0}], **path})
    lines = [{"name": "gear", "value": "D1"}, {"name": "steer", "value": "-0.50", "turn": -0.5}]
    note = {"groups": [{"name": "Motion", "lines": lines}], "impulses": [0.0] * 199 + [80.0]}
    link.note({"type": "signals", "states": [-1, 2]})
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page?.input.isOn")
    drive(link, page, 8)
    link.note({"type": "readings", "tally": ["1 x collision static"], **note})
    page.wait_for_function("document.getElementById('actor').innerText.includes('collision static')")
    assert "D1" in page.inner_text("#actor")
    fill = page.evaluate("(() => { const {width, marginLeft} = document.querySelector('.bar i').style;"
                         " return [width, marginLeft]; })()")  # fmt: skip
    assert fill == ["25%", "25%"]
    assert page.evaluate("page.lines.map((line) => line.color.getHexString())") == ["c8102e", "1f9d45"]
    page.wait_for_function("page.world.total >= 0")
    assert page.evaluate("page.world.lightStates") == [2], "its lamp is green in three dimensions"
    assert page.evaluate("page.map.trail.length") > 1
    page.keyboard.press("i")
    assert not page.is_visible("#panel")
    page.keyboard.press("m")
    with page.expect_download() as kept:
        page.keyboard.press("k")
    assert kept.value.path().read_bytes().startswith(b"\x89PNG")
    assert page.errors == []
    page.close()


def test_a_telephone_shows_the_map_without_overflow(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = page_of(browser, link.address, 390, 844)
    page.wait_for_function("globalThis.page?.map.edges")
    assert page.is_visible("#map")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    page.close()
