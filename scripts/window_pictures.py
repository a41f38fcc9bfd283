"""Pictures of the window in a browser without a screen, at the width of a desktop and of a telephone.

    python scripts/window_pictures.py [SCENE ...] [--folder docs/images] [--carla CARLA/PythonAPI]

The scenes: `live` (100 vehicles and 50 walkers on Linden), `night` (the same at night in the rain), `debug` (what
CARLA's own `util/lane_explorer.py` draws; only with --carla), `ghosts` (a recorded run beside two others), `takeover`
(a person takes over from the agent). Each is written as window-SCENE.jpg and window-SCENE-phone.jpg.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import carla
import numpy as np
from playwright.sync_api import sync_playwright

from basu_window.browser.film import SWITCHES, browser_path

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

VEHICLES, WALKERS, SEED = 100, 50, 3
SIZES = {"": (1280, 800), "-phone": (390, 844)}
WAIT_MS = 300_000.0
BASU_FILES = Path(__file__).parents[1] / "packages" / "basu" / "src" / "basu"
ROUTE, KEYS = BASU_FILES / "routes" / "linden_short.xml", BASU_FILES / "data" / "human_session.json"
DRIVERS = (("basic",), ("behavioral",), ("human", "--keys", KEYS))
IS_DRAWN = """globalThis.page && page.poses.length > 0 && (page.isFlat ? page.map.edges !== null
    : page.world.total >= 0 && page.world.waiting.length + page.world.loading === 0 && !page.actors.isLoading)"""
LOOK_AT_WALKERS = """(() => {
  const street = ({id}) => ["vehicle", "walker"].includes(page.actors.known.get(id)?.kind);
  const near = (a) => page.poses.filter((b) => street(b) && Math.hypot(a.x - b.x, a.y - b.y) < 35).length;
  const walkers = page.poses.filter(({id}) => page.actors.known.get(id)?.kind === "walker");
  const best = walkers.map((pose) => ({...pose, near: near(pose)})).sort((a, b) => b.near - a.near)[0];
  page.hasPlace = true;
  page.map.centre = [best.x, best.y];
  page.cameras.lookAt(page.cameras.focus.clone().set(best.x, best.z, best.y), 38);
})()"""
LOOK_AT_SHAPES = """(() => {
  const [x, y, z] = page.debug.shapes.map((shape) => shape.at ?? shape.from).at(-1);
  page.hasPlace = true;
  page.map.centre = [x, y];
  page.map.metresPerPixel = 0.12;
  page.cameras.lookAt(page.cameras.focus.clone().set(x, z, y), 26);
})()"""
RAINY_NIGHT = carla.WeatherParameters(
    cloudiness=100.0, precipitation=80.0, precipitation_deposits=90.0, wetness=100.0, sun_altitude_angle=-40.0
)
LINDEN = (sys.executable, "-m", "linden.cli")
BASU = (sys.executable, "-c", "from basu.cli import entry_point; entry_point()")


@contextmanager
def running(*words: str | Path) -> Iterator[tuple[subprocess.Popen[str], str, int]]:
    """Start a program, and yield it with the address of its page and the port of its simulator (0: none of its own)."""
    process = subprocess.Popen(list(map(str, words)), stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    address, port, is_server = "", 0, "serve" in words
    try:
        while not address or (is_server and not port):
            line = process.stdout.readline()
            if not line:
                raise SystemExit(f"{' '.join(map(str, words))} ended before its page was open")
            if found := re.search(r"http://\S+", line):
                address = found[0]
            elif found := re.search(r"port (\d+)", line):
                port = int(found[1])
        yield process, address, port
    finally:
        process.terminate()
        process.wait()


def traffic(client: carla.Client) -> list[carla.Actor]:
    """Spawn vehicles under the Traffic Manager, and walkers that go to places of their own."""
    world = client.get_world()
    library, draw = world.get_blueprint_library(), np.random.default_rng(SEED)
    manager = client.get_trafficmanager(8000)
    manager.set_random_device_seed(SEED)
    world.set_pedestrians_seed(SEED)
    kinds = [each for each in library.filter("vehicle.*") if each.get_attribute("base_type").as_str() == "car"]
    points = sorted(world.get_map().get_spawn_points(), key=lambda point: np.hypot(point.location.x, point.location.y))
    actors: list[carla.Actor] = []
    for point in points:
        if len(actors) == VEHICLES:
            break
        kind = kinds[int(draw.integers(len(kinds)))]
        if kind.has_attribute("color"):
            colours = kind.get_attribute("color").recommended_values
            kind.set_attribute("color", colours[int(draw.integers(len(colours)))])
        if (vehicle := world.try_spawn_actor(kind, point)) is not None:
            vehicle.set_autopilot(True, manager.get_port())
            manager.update_vehicle_lights(vehicle, True)
            actors.append(vehicle)
    walkers: list[carla.Actor] = []
    people = list(library.filter("walker.pedestrian.*"))
    while len(walkers) < WALKERS:
        place = world.get_random_location_from_navigation()
        if place is None or np.hypot(place.x, place.y) > 250.0:
            continue
        place.z += 1.0
        walker = world.try_spawn_actor(people[int(draw.integers(len(people)))], carla.Transform(place))
        if walker is not None:
            walkers.append(walker)
    controller = library.find("controller.ai.walker")
    guides = [world.spawn_actor(controller, carla.Transform(), walker) for walker in walkers]
    world.wait_for_tick()
    for guide in guides:
        guide.start()
        guide.go_to_location(world.get_random_location_from_navigation())
        guide.set_max_speed(1.4)
    return [*actors, *walkers, *guides]


@contextmanager
def opened(browser: Browser, address: str, size: tuple[int, int]) -> Iterator[Page]:
    """A page of a size, as soon as all that it shows has been drawn."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]}, bypass_csp=True)
    page.set_default_timeout(WAIT_MS)
    page.goto(address)
    page.wait_for_function(IS_DRAWN)
    yield page
    page.close()


class Pictures:
    """Takes the pictures of all scenes into a folder."""

    def __init__(self, browser: Browser, folder: Path) -> None:
        self.browser, self.folder = browser, folder

    def take(self, scene: str, page: Page, suffix: str) -> None:
        """Write what a page shows now, and say how it is drawn."""
        page.wait_for_timeout(3000)
        file = self.folder / f"window-{scene}{suffix}.jpg"
        page.screenshot(path=file, type="jpeg", quality=82, timeout=WAIT_MS)
        per_s, bytes_per_s = page.evaluate("[page.perSecond, page.bytesPerSecond]")
        wide = page.evaluate("document.documentElement.scrollWidth")
        print(f"{file}: {per_s:.1f} pictures/s, {bytes_per_s / 1000:.0f} kB/s, {wide} px wide", flush=True)

    def of(self, scene: str, address: str, look: str, until: str = "true", first: str = "") -> None:
        """Take a scene at both widths.

        Args:
            scene: its name.
            address: of the page.
            look: query of the address.
            until: JavaScript that is true as soon as the page shows what the picture is about.
            first: JavaScript that moves the camera.
        """
        for suffix, size in SIZES.items():
            with opened(self.browser, f"{address}{look}", size) as page:
                page.wait_for_function(until)
                page.evaluate(first)
                self.take(scene, page, suffix)


def serve_scenes(pictures: Pictures, scenes: set[str], examples: Path | None) -> None:
    """The scenes of a server with traffic."""
    words = (*LINDEN, "serve", "--port", "0", "--streaming-port", "0", "--window-control")
    with running(*words) as (_, address, port):
        client = carla.Client("127.0.0.1", port)
        client.set_timeout(120.0)
        world = client.get_world()
        if scenes & {"live", "night"}:
            actors = traffic(client)
            time.sleep(15.0)
            if "live" in scenes:
                pictures.of("live", address, "?view=orbit", first=LOOK_AT_WALKERS)
            if "night" in scenes:
                world.set_weather(RAINY_NIGHT)
                pictures.of("night", address, "?view=orbit", first=LOOK_AT_WALKERS)
                world.set_weather(carla.WeatherParameters.ClearNoon)
            for guide in actors[-WALKERS:]:
                guide.stop()
            client.get_trafficmanager(8000).shut_down()
            client.apply_batch([carla.command.DestroyActor(actor) for actor in actors])
        if "debug" in scenes and examples is not None:
            explorer = [sys.executable, str(examples / "util" / "lane_explorer.py"), "-p", str(port), "-i", "-s", "4"]
            start = world.get_map().get_spawn_points()[0].location
            place = ["-x", f"{start.x:.1f}", "-y", f"{start.y:.1f}", "-z", f"{start.z:.1f}"]
            process = subprocess.Popen([*explorer, *place], stdout=subprocess.DEVNULL)
            try:
                pictures.of("debug", address, "?view=orbit", "page.debug.shapes.length > 20", LOOK_AT_SHAPES)
            finally:
                process.terminate()
                process.wait()


def driven(folder: Path, *driver: str | Path) -> Path:
    """Let a driver drive the short route; return the folder of the run."""
    subprocess.run([*BASU, "run", *driver, "--routes", ROUTE, "--output", folder], check=True, capture_output=True)
    return (folder / "latest").resolve()


def ghosts(pictures: Pictures) -> None:
    """A recorded run beside two others."""
    with tempfile.TemporaryDirectory() as place:
        runs = [driven(Path(place) / str(driver[0]), *driver) for driver in DRIVERS]
        with running(*BASU, "watch", *runs) as (_, address, _):
            pictures.of("ghosts", address, "?view=chase&t=14")


def takeover(pictures: Pictures) -> None:
    """A person takes over from the agent, at both widths."""
    for suffix, size in SIZES.items():
        with tempfile.TemporaryDirectory() as place:
            words = (*BASU, "run", "human", "--watch", "--routes", ROUTE, "--output", place)
            with running(*words) as (_, address, _), opened(pictures.browser, f"{address}?view=chase", size) as page:
                page.keyboard.press("p")  # the autopilot drives
                page.wait_for_function("(page.followed()?.speed ?? 0) > 3")
                page.keyboard.down("w")
                page.wait_for_function("document.getElementById('says').innerText.includes('A person drives')")
                page.keyboard.up("w")
                pictures.take("takeover", page, suffix)


def main() -> None:
    """Take the pictures that were asked for, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", help="live, night, debug, ghosts, takeover (default: all)"
    )
    parser.add_argument("--folder", type=Path, default=Path(__file__).parents[1] / "docs" / "images")
    parser.add_argument("--carla", type=Path, help="folder PythonAPI of CARLA 0.9.16, for the scene `debug`")
    arguments = parser.parse_args()
    known = {"live", "night", "debug", "ghosts", "takeover"}
    if unknown := set(arguments.scenes) - known:
        parser.error(f"there is no scene {', '.join(sorted(unknown))}; the scenes are {', '.join(sorted(known))}")
    scenes = set(arguments.scenes) or known
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=list(SWITCHES))
        pictures = Pictures(browser, arguments.folder)
        if scenes & {"live", "night", "debug"}:
            serve_scenes(pictures, scenes, arguments.carla)
        if "ghosts" in scenes:
            ghosts(pictures)
        if "takeover" in scenes:
            takeover(pictures)
        browser.close()


if __name__ == "__main__":
    main()
