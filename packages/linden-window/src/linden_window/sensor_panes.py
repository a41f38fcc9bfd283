"""`SensorPanes`: what the sensors of a world measure, as panes of the pages that ask for them.

Nothing is measured for a page alone: a sensor has measurements while a client listens to it.
"""

import math
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from linden.protocol.values.space import GeoLocation
from linden.sensors.camera.cameras import Image
from linden.sensors.camera.events import Events
from linden.sensors.devices.collision import Collision
from linden.sensors.devices.imu import ImuMeasurement
from linden.sensors.devices.lidar import SemanticSweep, Sweep
from linden.sensors.devices.radar import Detections
from linden_window import panes
from linden_window.link import PageLink
from linden_window.measured import imu_lines, lidar_points, radar_points, rgb_of, tag_colours

if TYPE_CHECKING:
    from linden.sensors.runtime.measure import Measurement
    from linden.world import World

EVERY_S = 0.1
"""Wall time between two measurements of one sensor that a page gets."""


class SensorPanes:
    """The wishes of all pages of one world."""

    def __init__(self, world: "World", link: PageLink) -> None:
        self._world, self._link = world, link
        self._wishes: dict[object, list[str]] = {}
        self._next_s: dict[str, float] = {}

    def wish(self, page: object, names: object) -> None:
        """Note which sensors a page shows; their names are ``KIND ID``, as ``page/main.js`` makes them."""
        self._wishes[page] = [str(name) for name in names] if isinstance(names, list) else []
        self._next_s = {}
        if not self._wishes[page]:
            del self._wishes[page]

    def after_frame(self, measured: "Sequence[Measurement]") -> None:
        """Send the measurements that a page shows, unless the link is behind."""
        if not self._wishes or self._link.is_behind:
            return
        wanted, now_s = {name for names in self._wishes.values() for name in names}, time.monotonic()
        for each in measured:
            name = f"{each.sensor.description.id.rpartition('.')[2]} {each.sensor.id}"
            if name in wanted and now_s >= self._next_s.get(name, 0.0):
                self._next_s[name] = now_s + EVERY_S
                self._link.pane(name, pane_of(name, self._world.frame, each.reading))


def pane_of(name: str, frame: int, reading: Any) -> bytes:  # noqa: ANN401 - the reading of any sensor
    """Return the bytes of a pane of a reading."""
    if isinstance(reading, Image) and reading.pixels.shape[2] == 4:
        return panes.picture(name, frame, rgb_of(np.asarray(reading.pixels, np.uint8), reading.blueprint))
    if isinstance(reading, Sweep):
        return panes.points(name, frame, *lidar_points(reading.points))
    if isinstance(reading, SemanticSweep):
        return panes.points(name, frame, reading.points["xyz"][:, :2], tag_colours(reading.points["tag"]))
    if isinstance(reading, Detections):
        return panes.points(name, frame, *radar_points(*(np.asarray(part, np.float64) for part in reading)))
    return panes.lines(name, frame, _lines(reading))


def _lines(reading: Any) -> list[tuple[str, str]]:  # noqa: ANN401 - see above
    if isinstance(reading, ImuMeasurement):
        return imu_lines(reading)
    if isinstance(reading, GeoLocation):
        return [
            ("Latitude as CARLA's client gives it", f"{reading.latitude:.7f}°"),
            ("Longitude", f"{reading.longitude:.7f}°"),
            ("Altitude", f"{reading.altitude:.2f} m"),
        ]
    if isinstance(reading, Collision):
        return [("Impulse", f"{math.hypot(*reading.impulse_ns):.0f} N s")]
    if isinstance(reading, Events):
        return [("Pixels that changed", str(len(reading.events)))]
    return [("Measured", type(reading).__name__)]
