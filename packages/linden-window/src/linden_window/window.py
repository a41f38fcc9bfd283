"""`Window`: the hub, the page server and the scene of one window, in the process of the pages."""

import asyncio
import gzip
import json
import logging
from collections.abc import Callable, Coroutine
from typing import Any

import numpy as np

from linden.errors import UserError
from linden.maps.cache import MapCache
from linden_window.hub import Hub
from linden_window.models import Models, gait
from linden_window.page_server import PageServer
from linden_window.scene import MapText, Scene, is_kept, scene_of
from linden_window.ways import Ways

log = logging.getLogger("linden")

CONTROLS = frozenset({"pause", "step", "speed", "spawn", "send", "destroy", "weather"})
"""Orders that change the world; pages may give them only if the window was started for it."""


class Window:
    """Takes notes and frames from a source, and orders from pages."""

    def __init__(self, order: Callable[[dict[str, Any]], None], *, may_control: bool) -> None:
        """``order`` sends orders to the source."""
        self._to_source, self._may_control = order, may_control
        self._hub = Hub()
        self._server = PageServer(self._hub, self._found, self._ordered)
        self._cache = MapCache.of_user()
        self._models = Models()
        self._scene: Scene | None = None
        self._scene_number = 0
        self._map: MapText | None = None
        self._ways: Ways | None = None
        self._records: dict[str, bytes] = {}
        self._work: set[asyncio.Task[None]] = set()

    async def start(self, host: str, port: int) -> str:
        """Open the port and return the page's address.

        Raises:
            OSError: the port is taken.
        """
        return await self._server.start(host, port)

    async def close(self) -> None:
        """Close the port and all pages."""
        await self._server.close()

    def frame(self, packed: bytes) -> None:
        """Send a frame of the server to all open pages."""
        self._hub.frame(packed)

    def pane(self, name: str, packed: bytes) -> None:
        """Send a sensor's measurement to all open pages."""
        self._hub.pane(name, packed)

    def note(self, facts: dict[str, Any]) -> None:
        """Pass on facts; a map is made a scene first, in the background."""
        if facts.get("type") != "map":
            self._hub.note(facts)
            return
        self._scene_number += 1
        self._scene = None
        world = self._map = MapText(facts["name"], facts["text"])
        self._ways = None
        self._say_scene(world.name, is_ready=False, is_kept=is_kept(world, self._cache))
        self._begin(self._make_scene(world, self._scene_number))

    def keep(self, name: str, content: bytes) -> None:
        """Keep a compressed file that pages can fetch as ``record/NAME``."""
        self._records[name] = content

    def end(self) -> None:
        """Say in all pages that the source has ended."""
        self._hub.note(
            {
                "type": "end",
                "text": "The program that this page shows has ended. Start it again, and open its new address.",
            }
        )

    async def _make_scene(self, world: MapText, number: int) -> None:
        try:
            scene = await asyncio.to_thread(scene_of, world, self._cache)
        except UserError as error:
            scene = Scene(world.name, {}, {"tiles": [], "error": f"The map has no scenery: {error}"})
        if number == self._scene_number:
            self._scene = scene
            self._say_scene(world.name, is_ready=True, is_kept=True)

    def _say_scene(self, name: str, *, is_ready: bool, is_kept: bool) -> None:
        note = {"type": "scene", "map": name, "number": self._scene_number, "ready": is_ready, "kept": is_kept}
        self._hub.note(note | {"control": self._may_control} | (self._scene.index if self._scene else {}))

    def _found(self, path: str, query: dict[str, str]) -> bytes | None:
        """Return a tile, a model or a record."""
        place, _, rest = path.partition("/")
        if place == "model":
            if rest == "gait.json":
                return gzip.compress(json.dumps(gait()).encode())
            return self._models.file(rest.removesuffix(".glb"), query.get("choice", ""))
        if place == "record":
            return self._records.get(rest)
        number, _, name = rest.partition("/")
        scene = self._scene
        return scene.tiles.get(name) if scene is not None and number == str(self._scene_number) else None

    def _ordered(self, order: dict[str, Any]) -> None:
        """Pass an order on to the source, unless it would change the world and pages may not."""
        if order["order"] in CONTROLS and not self._may_control:
            self._say("This window only watches; add --window-control to change the world.")
            return
        if order["order"] == "send":
            self._begin(self._send(order))
        elif order["order"] == "spawn":
            self._begin(self._spawn(order))
        else:
            self._to_source(order)

    async def _send(self, order: dict[str, Any]) -> None:
        """Find the way of an actor that a page sends somewhere, and send it to the source."""
        try:
            x_m, y_m, yaw_deg, to_x_m, to_y_m = (float(value) for value in (*order["from"], *order["to"]))
            way: list[list[float]] = [[to_x_m, to_y_m, 0.0]]
            if order["on_lanes"]:
                ways = await self._ways_of_map()
                found = None if ways is None else await asyncio.to_thread(ways.way, x_m, y_m, yaw_deg, to_x_m, to_y_m)
                if found is None:
                    self._say("No lane leads from the vehicle to this place; choose a place on a street.")
                    return
                way = np.round(found, 2).tolist()
            self._to_source({"order": "send", "id": int(order["id"]), "way": way, "page": order["page"]})
        except UserError as error:
            self._say(f"The map has no lanes to drive on: {error}")
        except (KeyError, TypeError, ValueError) as error:
            self._say(f"The page sent an order that cannot be read ({error!r}); load it again.")

    async def _spawn(self, order: dict[str, Any]) -> None:
        """Turn a vehicle that a page spawns on a lane into its direction of travel, and pass the order on."""
        try:
            if str(order["type"]).startswith("vehicle."):
                x_m, y_m = (float(value) for value in order["place"][:2])
                ways = await self._ways_of_map()
                heading_deg = None if ways is None else await asyncio.to_thread(ways.heading_deg, x_m, y_m)
                order = order if heading_deg is None else {**order, "yaw": heading_deg}
        except (UserError, KeyError, TypeError, ValueError):
            pass  # the source answers for what it cannot read
        self._to_source(order)

    async def _ways_of_map(self) -> Ways | None:
        """Return the lanes of the present map; they are read once.

        Raises:
            UserError: the text is no OpenDRIVE that can be used.
        """
        world = self._map
        if self._ways is None and world is not None:
            ways = await asyncio.to_thread(Ways, world.text)
            if world is self._map:
                self._ways = ways
        return self._ways

    def _say(self, text: str) -> None:
        self._hub.note({"type": "says", "text": text})

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Begin work beside the pages, and keep it until it ends."""
        task = asyncio.create_task(work)
        self._work.add(task)
        task.add_done_callback(self._work.discard)
