"""``basu serve sensorsim``: listen, and render until Ctrl-C."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from basu.agents.sensor_file import read_sensors
from basu.conditions import SimulatorSpec
from basu.errors import UserError
from basu.files import find
from basu.simulator import simulator_for
from basu_alpasim.renderer import SceneRenderer
from basu_alpasim.run_scene import scene_of
from basu_alpasim.sensorsim import SensorsimService, serving_scenes
from basu_alpasim.serve import end_of_service

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from basu_alpasim.run_scene import RunScene

CAMERAS = "config/egodriver_sensors.json"  # that of ``basu run egodriver``


def run(arguments: argparse.Namespace) -> int:
    """Offer the runs as scenes until Ctrl-C or SIGTERM.

    Raises:
        UserError: a run, the cameras or an address cannot be used.
        SimulatorError: the simulator did not start.
    """
    scenes = _scenes(arguments.runs, arguments.sensors, arguments.rear_axle)
    ended = end_of_service()
    host, _, port = (arguments.simulator or "").rpartition(":")
    if arguments.simulator and not (host and port.isdecimal()):
        raise UserError(f"--simulator {arguments.simulator} is no address; give HOST:PORT, such as 127.0.0.1:2000")
    where = SimulatorSpec(host=host or None, port=int(port or 0), timeout_s=arguments.timeout, is_open=True)
    with simulator_for(where) as simulator:
        renderer = SceneRenderer(simulator)
        service = SensorsimService(scenes, renderer, arguments.rear_axle)
        try:
            with contextlib.closing(renderer), serving_scenes(service, arguments.host, arguments.port) as bound:
                names = ", ".join(scene.id for scene in scenes)
                print(f"the scenes {names} are rendered at {arguments.host}:{bound}; end it with Ctrl-C", flush=True)
                ended.wait()
        except RuntimeError as error:
            raise UserError(
                f"nothing can listen at {arguments.host}:{arguments.port} ({error}); choose another --port"
            ) from None
    return 0


def _scenes(folders: list[Path], sensors: Path | None, rear_axle_m: float) -> list[RunScene]:
    """Return the scenes of run folders.

    Raises:
        UserError: a folder has no record, the file of sensors no camera, or two folders have the same name.
    """
    cameras = read_sensors(sensors or find(CAMERAS, "sensor file"))
    scenes = [scene_of(folder, cameras, rear_axle_m) for folder in folders]
    if not scenes[0].cameras:
        raise UserError(f"{sensors} has no sensor.camera.rgb, the only kind that AlpaSim asks for; name another file")
    ids = [scene.id for scene in scenes]
    twice = sorted({each for each in ids if ids.count(each) > 1})
    if twice:
        raise UserError(f"two runs are called '{twice[0]}', and a scene's id is the name of its folder; rename one")
    return scenes
