"""Claims about `--window-control` in a real browser: spawn with a click, choose, send somewhere, weather, pause."""

import math
from collections.abc import Iterator
from pathlib import Path

import carla
import pytest
from playwright.sync_api import Browser, Page

from browsers import running_browser
from linden.maps.library import MapLibrary
from linden.world import World
from opendrive_texts import SIGNS_AND_LIGHTS
from served_windows import BY_PROCESSOR, Served, serving
from window_pages import page_of

ON_SCREEN = """([x, y, z]) => { const at = page.cameras.focus.clone().set(x, z, y).project(page.cameras.camera);
    return [(at.x + 1) / 2 * innerWidth, (1 - at.y) / 2 * innerHeight]; }"""
OURS = "[...page.actors.known.values()].find((actor) => actor.role === 'window')?.id"
POSE = "page.poses.filter(({{id}}) => id === {id}).map(({{x, y, z}}) => [x, y, z])[0]"
SAYS = "document.getElementById('says').innerText.includes({words!r})"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser(*BY_PROCESSOR) as found:
        yield found


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    (tmp_path / "Street.xodr").write_text(SIGNS_AND_LIGHTS)
    with serving("--maps", tmp_path, "--map", "Street", "--window-control") as found:
        yield found


def click(page: Page, place: list[float]) -> None:
    """Click at a place of the world."""
    x, y = page.evaluate(ON_SCREEN, place)
    page.mouse.click(x, y)


@pytest.mark.slow
def test_a_click_spawns_a_vehicle_and_another_sends_it_somewhere(browser: Browser, served: Served) -> None:
    page = page_of(browser, served.address + "?view=map", 1200, 800)
    page.wait_for_function("globalThis.page?.world.loaded > 0 && page.world.waiting.length + page.world.loading === 0")
    spawn = World(MapLibrary().from_opendrive(SIGNS_AND_LIGHTS)).spawn_points[0]
    x, y, z = spawn.location
    page.evaluate("([x, y, z]) => { page.cameras.focus.set(x, z, y); page.cameras.height = 90; }", [x, y, z])
    page.wait_for_timeout(500)
    page.select_option("[aria-label='Spawn with a click']", "vehicle.tesla.model3")
    click(page, [x, y, z])
    page.wait_for_function(f"{OURS} !== undefined")
    car = page.evaluate(OURS)
    page.select_option("[aria-label='Spawn with a click']", "")
    page.wait_for_function(POSE.format(id=car) + " !== undefined")
    yaw = page.evaluate(f"page.poses.find(({{id}}) => id === {car}).yaw")
    assert (yaw - spawn.rotation.yaw + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=3.0), "along its lane"
    click(page, page.evaluate(POSE.format(id=car)))
    page.wait_for_function(f"page.chosen === {car}")
    page.wait_for_function("document.getElementById('actor').innerText.includes('vehicle.tesla.model3')")
    page.click("text=Send somewhere")
    page.wait_for_timeout(300)
    x, y, z = page.evaluate(POSE.format(id=car))
    ahead = math.radians(yaw)
    goal = [x + 18.0 * math.cos(ahead), y + 18.0 * math.sin(ahead), z]
    click(page, goal)
    page.wait_for_function(SAYS.format(words="is on its way"))
    page.wait_for_function(f"page.poses.find(({{id}}) => id === {car}).speed > 1")
    page.wait_for_function(SAYS.format(words="has arrived"))
    there = page.evaluate(POSE.format(id=car))
    assert abs(there[0] - goal[0]) + abs(there[1] - goal[1]) < 8.0
    assert page.evaluate("page.timeline.path(page.chosen, 60).length") > 5, "its path is shown"
    page.click("text=Take away")
    page.wait_for_function(f"page.poses.every(({{id}}) => id !== {car})")
    assert page.errors == []
    page.close()


@pytest.mark.slow
def test_weather_pause_and_one_step_work_from_the_page(browser: Browser, served: Served) -> None:
    page = page_of(browser, served.address + "?flat", 1200, 800)
    page.wait_for_function("globalThis.page?.timeline.frames.length > 2")
    page.select_option("[aria-label='Weather']", "rainy night")
    page.wait_for_function("page.world.isNight && page.world.rain.visible")
    page.wait_for_function("document.getElementById('figures').innerText.includes('night, rain')")
    page.click("text=Pause")
    page.wait_for_function(SAYS.format(words="The world is paused."))
    page.wait_for_timeout(500)
    before = page.evaluate("page.timeline.frames.at(-1).number")
    page.click("text=One step")
    page.wait_for_function(f"page.timeline.frames.at(-1).number === {before} + 1")
    page.wait_for_timeout(500)
    assert page.evaluate("page.timeline.frames.at(-1).number") == before + 1
    page.click("text=Go on")
    page.wait_for_function(f"page.timeline.frames.at(-1).number > {before} + 5")
    assert page.errors == []
    page.close()


@pytest.mark.slow
def test_sensors_of_the_chosen_vehicle_have_panes(browser: Browser, served: Served) -> None:
    client = carla.Client("127.0.0.1", served.port)
    client.set_timeout(60.0)
    world = client.get_world()
    library = world.get_blueprint_library()
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), world.get_map().get_spawn_points()[0])
    above = carla.Transform(carla.Location(z=2.5))
    lidar, idle = (
        world.spawn_actor(library.find(f"sensor.{name}"), above, car) for name in ("lidar.ray_cast", "other.imu")
    )
    lidar.listen(lambda _measured: None)
    page = page_of(browser, served.address + "?flat", 1200, 800)
    page.wait_for_function(f"globalThis.page?.poses.some(({{id}}) => id === {car.id})")
    assert not page.is_visible("#sensors"), "no actor is chosen"
    page.keyboard.press("f")
    page.wait_for_function(f"page.chosen === {car.id}")
    page.click(f"#sensors >> text=ray_cast {lidar.id}")
    page.wait_for_function(f"page.panes.drawn.get('ray_cast {lidar.id}') > 2")
    page.click(f"#sensors >> text=imu {idle.id}")
    assert "nothing measured yet" in page.inner_text("#panes"), "nothing is measured for a page alone"
    lidar.destroy()
    page.wait_for_function("document.querySelectorAll('#panes figure').length === 1")
    assert page.errors == []
    page.close()
