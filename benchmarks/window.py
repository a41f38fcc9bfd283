"""Figures of the window: the cost of a watched tick, bytes of a frame, size of a scene, time to the first picture.

usage: window.py [--vehicles N] [--walkers N] [--picture]

``--picture`` starts ``linden serve --window`` and a Chromium that draws by the processor. It measures the time from the
start of the server to the first picture with scenery, with the scene in the cache.
"""

import argparse
import re
import shutil
import subprocess
import sys
import time
from statistics import median

import numpy as np

from linden.blueprints.library import BlueprintKind, packaged
from linden.errors import Refusal
from linden.maps.cache import MapCache
from linden.maps.library import MapLibrary
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform, Vector3D
from linden.world import World
from linden_window.link import PageLink
from linden_window.observer import WorldObserver
from linden_window.scene import MapText, scene_of

TICKS = 400
SWITCHES = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--walkers", type=int, default=50)
    parser.add_argument("--picture", action="store_true")
    arguments = parser.parse_args()
    cache = MapCache.of_user()
    world = World(MapLibrary((), cache.read).load("Linden"))
    populate(world, arguments.vehicles, arguments.walkers)
    ticks(world)
    scene(world, cache)
    if arguments.picture:
        first_picture()


def populate(world: World, vehicles: int, walkers: int) -> None:
    """Put vehicles on spawn points and walkers beside them; the seed is fixed."""
    draw = np.random.default_rng(3)
    of_kind = {
        kind: [each for each in packaged() if each.kind is kind]
        for kind in (BlueprintKind.VEHICLE, BlueprintKind.WALKER)
    }
    points = [world.spawn_points[row] for row in draw.permutation(len(world.spawn_points))]
    for kind, wanted, aside_m in ((BlueprintKind.VEHICLE, vehicles, 0.0), (BlueprintKind.WALKER, walkers, 6.0)):
        placed = 0
        for point in points:
            blueprint = of_kind[kind][int(draw.integers(len(of_kind[kind])))]
            x, y, z = point.location
            place = Transform(Vector3D(x + aside_m, y + aside_m, z + 1.0), point.rotation)
            if placed == wanted:
                break
            try:
                world.spawn(ActorDescription(0, blueprint.definition.id), place)
            except Refusal:
                continue
            placed += 1


def ticks(world: World) -> None:
    """Compare ticks with a page and without, one after the other in turns."""
    link = PageLink.start()
    observer = WorldObserver(world, link)
    sizes: list[int] = []
    send = link.frame
    link.frame = lambda packed: (sizes.append(len(packed)), send(packed))[1]  # type: ignore[method-assign]
    observer.has_pages(1)
    step_s, watched_s, busy_s = [], [], []
    for _ in range(TICKS):
        before_s = time.perf_counter()
        world.step(0.05)
        middle_s, used_s = time.perf_counter(), time.thread_time()
        observer.after_frame()
        watched_s.append(time.perf_counter() - middle_s)
        busy_s.append(time.thread_time() - used_s)
        step_s.append(middle_s - before_s)
        time.sleep(0.002)
    link.close()
    kinds = [record.kind for record in world.episode.actors]
    print(f"{kinds.count(BlueprintKind.VEHICLE)} vehicles, {kinds.count(BlueprintKind.WALKER)} walkers")
    print(f"step of the world      {1e3 * median(step_s):.3f} ms (median of {TICKS})")
    print(
        f"watched: more          {1e3 * median(watched_s):.3f} ms (90th percentile {1e3 * quantile(watched_s):.3f} ms)"
    )
    print(f"processor time of it   {1e3 * median(busy_s):.3f} ms")
    print(f"bytes of a frame       {int(median(sizes)):,}; at 20 frames/s {20 * median(sizes) / 1000:.0f} kB/s")
    print(f"dropped frames         {link.dropped} of {TICKS}")


def quantile(values: list[float]) -> float:
    return sorted(values)[int(0.9 * len(values))]


def scene(world: World, cache: MapCache) -> None:
    """Print the size of the scene and the time of reading it."""
    text = MapText(world.episode.map.name, world.opendrive_text)
    scene_of(text, cache)
    before_s = time.perf_counter()
    found = scene_of(text, cache)
    size = sum(len(content) for content in found.tiles.values())
    print(f"scene of {text.name}        {len(found.index['tiles'])} tiles, {found.index['triangles']:,} triangles, "
          f"{size / 1e6:.1f} MB; read in {time.perf_counter() - before_s:.2f} s")  # fmt: skip


def first_picture() -> None:
    """Measure from the start of the server to the first picture with scenery."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - only for this figure

    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(SWITCHES))
        page = browser.new_page(viewport={"width": 1280, "height": 800}, bypass_csp=True)
        before_s = time.perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--streaming-port", "0", "--window"],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert process.stdout is not None
        address = None
        while address is None:
            found = re.search(r"http://\S+", process.stdout.readline())
            address = found and found[0]
        ready_s = time.perf_counter()
        page.goto(address)
        page.wait_for_function("globalThis.page?.firstPictureMs > 0", timeout=120_000)
        print(f"first picture          {time.perf_counter() - before_s:.1f} s after the start, "
              f"{time.perf_counter() - ready_s:.1f} s after the address")  # fmt: skip
        page.wait_for_timeout(6000)
        print(f"pictures/s             {page.evaluate('page.perSecond'):.1f} at 1280x800, drawn by the processor")
        process.terminate()
        process.wait()
        browser.close()


if __name__ == "__main__":
    main()
