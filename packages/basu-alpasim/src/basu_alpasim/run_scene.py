"""`RunScene`: a finished run as a scene of AlpaSim: its map, its ego trajectory, its actors and its cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from carla_driver_interface.geometry import Trajectory

from basu.errors import UserError
from basu.records.history.files import read_history
from basu.records.motion import VehicleMotion
from basu_alpasim.frames import rig_pose
from basu_alpasim.observations import CAMERA

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from basu.agents.sensor_file import SensorSpec

US_PER_S = 1_000_000


class RunScene(NamedTuple):
    """A scene that the renderer can show."""

    id: str
    town: str
    trajectory: Trajectory  # of the rig, in the local frame
    actors: Mapping[str, str]  # the blueprint of each track
    cameras: Sequence[SensorSpec]


def scene_of(folder: Path, cameras: Sequence[SensorSpec], rear_axle_m: float) -> RunScene:
    """Read the record of a run's folder.

    Args:
        folder: the run's folder; its name is the scene's id.
        cameras: declared for the scene; only those of type ``sensor.camera.rgb`` count.
        rear_axle_m: how far the rear axle lies behind the vehicle's origin.

    Raises:
        UserError: the folder has no record, or an empty one.
    """
    history = read_history(folder)
    if len(history.frames) == 0:
        raise UserError(f"the record of {folder} has no frame; name the folder of a run that has driven")
    times_us, poses = [], []
    for row in history.frames:
        motion = VehicleMotion(*(float(row[name]) for name in VehicleMotion._fields))
        times_us.append(round(float(row["t_s"]) * US_PER_S))
        poses.append(rig_pose(motion, rear_axle_m))
    actors = {str(number): blueprint for number, blueprint in history.facts.actor_types.items()}
    shown = [spec for spec in cameras if spec.type_id == CAMERA]
    return RunScene(folder.resolve().name, history.facts.route.town, Trajectory(times_us, poses), actors, shown)
