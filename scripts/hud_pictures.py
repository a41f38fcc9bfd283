"""Makes the pictures of docs/how-to/hud.md: in traffic, from above with a person at the keys, the help page, a lidar.

    SDL_VIDEODRIVER=dummy python scripts/hud_pictures.py

Agents strike the window's keys at their moment; a few minutes, most of them for simulating traffic.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image

from basu.agents.builtin.basic import BasicAgent, HumanAgent
from basu.cli import main as basu

if TYPE_CHECKING:
    from collections.abc import Mapping

    import carla

IMAGES = Path(__file__).parents[1] / "docs" / "images"
COLOURS = 255
"""Of a picture's palette: a third of the bytes, and nobody sees it."""
SESSION = ("--keys", "data/human_session.json")
PICTURES = {
    "hud.png": ("Watched", "--hud-size", "1920x1080", "--vehicles", "40", "--walkers", "10", "--seed", "4"),
    "hud-map.png": ("Seen", *SESSION),
    "hud-help.png": ("Helped", *SESSION),
    "hud-lidar.png": ("Scanned", "--vehicles", "40", "--walkers", "10", "--seed", "4"),
}


class Watched(BasicAgent):
    """Drives along the short route; changes from the map to the camera shortly before its picture."""

    keys: Mapping[int, tuple[str, ...]] = {445: ("TAB",), 460: ("F12",), 461: ("ESCAPE",)}
    steps = 0

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Strike what is to be struck."""
        strike(self.keys.get(self.steps, ()))
        self.steps += 1
        return super().run_step(sensor_data)

    def config(self) -> dict[str, str]:
        """As the human agent."""
        return HumanAgent().config()


class Seen(HumanAgent):
    """The session of the experiment, after its second haste."""

    keys: Mapping[int, tuple[str, ...]] = {1752: ("F12",), 1753: ("ESCAPE",)}
    steps = 0

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Strike what is to be struck."""
        strike(self.keys.get(self.steps, ()))
        self.steps += 1
        return super().run_step(sensor_data)


class Helped(Seen):
    """Somebody who asks for help soon."""

    keys: Mapping[int, tuple[str, ...]] = {60: ("h", "F12"), 61: ("ESCAPE",)}


class Scanned(Watched):
    """Looks at its lidar instead of the camera."""

    keys: Mapping[int, tuple[str, ...]] = {445: ("n",), 460: ("F12",), 461: ("ESCAPE",)}

    def sensors(self) -> list[dict[str, Any]]:
        """A lidar on the roof, a camera, and a receiver."""
        lidar = {"channels": 64, "range": 60.0, "points_per_second": 1_000_000, "rotation_frequency": 20.0}
        return [
            {"type": "sensor.lidar.ray_cast", "id": "ROOF", "x": 0.0, "y": 0.0, "z": 1.8, **lidar},
            {"type": "sensor.other.gnss", "id": "GNSS", "x": 0.0, "y": 0.0, "z": 1.8},
            {"type": "sensor.other.imu", "id": "IMU", "x": 0.0, "y": 0.0, "z": 0.5},
        ]

    def config(self) -> dict[str, str]:
        """As the human agent, with the sensors above."""
        return {key: value for key, value in super().config().items() if key != "sensors"}


def strike(keys: tuple[str, ...]) -> None:
    """As if somebody had."""
    import pygame  # noqa: PLC0415 - an extra

    for key in keys:
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=getattr(pygame, f"K_{key}")))


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    wanted = sys.argv[1:] or PICTURES
    for name in wanted:
        agent, *options = PICTURES[name]
        with tempfile.TemporaryDirectory() as folder:
            shot = Path(folder) / name
            basu(
                [
                    "run",
                    f"{__file__}:{agent}",
                    "--output",
                    folder,
                    "--hud",
                    "map",
                    "--hud-screenshot",
                    str(shot),
                    *options,
                ]
            )
            Image.open(shot).quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=4).save(IMAGES / name, optimize=True)
