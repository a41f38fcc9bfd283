"""Claims about `linden serve --window`: a page sees a running world, and the world does not depend on the page."""

import asyncio
import json
import signal
import subprocess
import sys
from collections.abc import Iterator

import carla
import pytest
from websockets.asyncio.client import ClientConnection, connect

from linden_window.poses import HEADER
from opendrive_texts import SIGNS_AND_LIGHTS
from served_windows import Served, serving
from window_pages import fetched

LIMIT_S = 60.0


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("maps")
    (folder / "Street.xodr").write_text(SIGNS_AND_LIGHTS)
    with serving("--maps", folder, "--map", "Street", "--window-control") as found:
        yield found


def live(served: Served) -> connect:
    headers = {"Origin": "http://127.0.0.1:1"}
    return connect(served.address.replace("http:", "ws:") + "live", additional_headers=headers, max_size=None)


async def until(page: ClientConnection, holds) -> dict:
    """Return the first note that is the one wanted."""
    while True:
        message = await asyncio.wait_for(page.recv(), LIMIT_S)
        if isinstance(message, str) and holds(note := json.loads(message)):
            return note


async def frame(page: ClientConnection) -> tuple:
    while isinstance(message := await asyncio.wait_for(page.recv(), LIMIT_S), str):
        pass
    return HEADER.unpack_from(message)


def test_a_page_gets_scene_actors_and_frames_and_changes_the_weather(served: Served) -> None:
    async def watch() -> None:
        async with live(served) as page:
            scene = await until(page, lambda note: note["type"] == "scene" and note["ready"])
            assert (scene["map"], scene["control"]) == ("Street", True)
            tile = scene["tiles"][0]["name"]
            assert (await asyncio.to_thread(fetched, f"{served.address}scene/{scene['number']}/{tile}"))[0] == 200
            numbers = [(await frame(page))[1] for _ in range(3)]
            assert numbers == sorted(set(numbers))
            await page.send(json.dumps({"order": "weather", "values": {"precipitation": 33.0}}))
            await until(page, lambda note: note["type"] == "weather" and note["weather"]["precipitation"] == 33.0)

    asyncio.run(watch())
    client = carla.Client("127.0.0.1", served.port)
    client.set_timeout(LIMIT_S)
    assert client.get_world().get_weather().precipitation == 33.0


def test_a_pause_holds_the_frames_until_the_world_goes_on(served: Served) -> None:
    async def pause() -> tuple[int, int]:
        async with live(served) as page:
            await page.send(json.dumps({"order": "pause", "on": True}))
            await until(page, lambda note: note.get("text") == "The world is paused.")
            held = await frame_after_silence(page)
            await page.send(json.dumps({"order": "step"}))
            stepped = (await frame(page))[1]
            await page.send(json.dumps({"order": "pause", "on": False}))
            await until(page, lambda note: note.get("text") == "The world goes on.")
            await frame(page)
            return held, stepped

    async def frame_after_silence(page: ClientConnection) -> int:
        last = 0
        try:
            while True:
                message = await asyncio.wait_for(page.recv(), 1.0)  # thirty frames of a world that goes on
                last = HEADER.unpack_from(message)[1] if isinstance(message, bytes) else last
        except asyncio.TimeoutError:
            return last

    held, stepped = asyncio.run(pause())
    assert held == 0 or stepped == held + 1


def test_the_world_goes_on_when_the_process_of_the_pages_dies(served: Served) -> None:
    served.pages.send_signal(signal.SIGKILL)
    client = carla.Client("127.0.0.1", served.port)
    client.set_timeout(LIMIT_S)
    world = client.get_world()
    first = world.wait_for_tick().frame
    assert world.wait_for_tick().frame > first


WITHOUT_LIBRARY = """import sys
sys.modules["websockets"] = None
from linden.cli import main
sys.exit(main())"""


def test_without_the_library_the_command_names_what_to_install() -> None:
    words = [sys.executable, "-c", WITHOUT_LIBRARY, "serve", "--port", "0", "--window"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "pip install linden-window" in done.stderr
    assert "Traceback" not in done.stderr
