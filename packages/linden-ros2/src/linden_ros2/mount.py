"""`Mount`: a sensor on a vehicle, its place and its frame in ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from linden_ros2 import frames
from linden_ros2.frames import Pose

if TYPE_CHECKING:
    from collections.abc import Mapping


class Mount(NamedTuple):
    """A sensor on a vehicle: its place in the vehicle's frame, CARLA's axes, m and rad."""

    id: str
    type_id: str
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    roll_rad: float = 0.0
    pitch_rad: float = 0.0
    yaw_rad: float = 0.0
    attributes: Mapping[str, str] = {}

    @property
    def is_camera(self) -> bool:
        """Whether it makes pictures; its frame in ROS is an optical one."""
        return self.type_id.startswith("sensor.camera.")

    @property
    def pose(self) -> Pose:
        """The pose of its frame in the vehicle's, in ROS's axes; that of a camera is optical."""
        turn = frames.attitude(self.roll_rad, self.pitch_rad, self.yaw_rad)
        return Pose(frames.vector(*self[2:5]), frames.times(turn, frames.OPTICAL) if self.is_camera else turn)
