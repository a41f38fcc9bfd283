"""`Vehicle` and `Moment`, the input of ROS messages: sensor mounts, motion, control, measurements, actors, lights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.records.motion import VehicleMotion
from linden_ros2 import frames
from linden_ros2.frames import Pose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from linden_ros2.frames import Vector
    from linden_ros2.mount import Mount


class Motion(VehicleMotion):
    """A vehicle's motion, which ROS's axes can be read from."""

    __slots__ = ()

    @property
    def pose(self) -> Pose:
        """The pose of the vehicle's origin in ROS's axes."""
        return Pose(frames.vector(*self[:3]), frames.attitude(*self[3:6]))

    @property
    def velocity_mps(self) -> Vector:
        """The velocity in the world, in ROS's axes."""
        return frames.vector(*self[6:9])

    @property
    def acceleration_mps2(self) -> Vector:
        """The acceleration in the world, in ROS's axes."""
        return frames.vector(*self[9:12])

    @property
    def angular_velocity_radps(self) -> Vector:
        """The angular velocity in the world, in ROS's axes."""
        return frames.axial(*self[12:15])


class Control(NamedTuple):
    """A control as CARLA has it: pedals 0 to 1, steer -1 (left) to 1 (right)."""

    throttle: float = 0.0
    steer: float = 0.0
    brake: float = 0.0
    hand_brake: bool = False
    reverse: bool = False
    gear: int = 0
    manual_gear_shift: bool = False


class Actor(NamedTuple):
    """Another actor: the middle of its box in CARLA's world, and half its box."""

    id: int
    type_id: str
    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    velocity_x_mps: float
    velocity_y_mps: float
    half_length_m: float
    half_width_m: float


class Measurement(NamedTuple):
    """What a sensor measured in a frame."""

    mount: Mount
    data: Any  # a carla.SensorData, or a thing with the same fields


class Light(NamedTuple):
    """A traffic light: its actor's id and the value of its carla.TrafficLightState."""

    id: int
    state: int


class Moment(NamedTuple):
    """One frame of a simulated vehicle."""

    t_s: float  # simulated time
    frame: int  # its number, from 0
    motion: Motion
    control: Control  # as applied
    others: Sequence[Actor] = ()
    lights: Sequence[Light] = ()
    measured: Sequence[Measurement] = ()  # in this frame
    server_frame: int | None = None  # CARLA's number of it; None where bytes must not depend on earlier drives


class Vehicle(NamedTuple):
    """What does not change about a simulated vehicle."""

    role: str
    mounts: Sequence[Mount] = ()
    step_s: float = 0.05
    rear_axle_m: float = 0.0  # how far base_link lies behind the vehicle's origin
