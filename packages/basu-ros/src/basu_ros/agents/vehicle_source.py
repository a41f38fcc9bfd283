"""Moments of an agent's vehicle, the source of its ROS messages; values of the client turned into ours."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.agents.sight.actors import ActorKind
from basu.records.motion import motion_of
from basu_ros.moment import Actor, Control, Light, Measurement, Moment, Motion
from basu_ros.topics import info_of
from linden_ros2.basic_messages import vector3
from linden_ros2.frames import vector
from linden_ros2.mount import Mount
from linden_ros2.topic import Message

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import carla

    from basu.agents.sensor_file import SensorSpec
    from basu.agents.sight import Other
    from linden_ros2.types import Types

TYPE_OF_KIND = {ActorKind.VEHICLE: "vehicle.", ActorKind.WALKER: "walker.", ActorKind.PROP: "static.prop."}
"""The beginning of a blueprint's id, which is all that an agent sees of it."""
BRAKED = Control(brake=1.0)  # what the vehicle has before its first control


class VehicleSource:
    """Makes moments of an agent's frames; time runs from ``first_s`` at the first of them."""

    def __init__(
        self,
        world: carla.World,
        vehicle: carla.Vehicle,
        specs: Sequence[SensorSpec],
        step_s: float,
        first_s: float = 0.0,
    ) -> None:
        """Look up the traffic lights; ``specs`` are the agent's sensors."""
        self._world, self._vehicle, self._step_s, self._first_s = world, vehicle, step_s, first_s
        self.mounts = {spec.id: mount_of(spec) for spec in specs}
        self._lights = sorted(world.get_actors().filter("traffic.traffic_light"), key=lambda light: light.id)
        self._last_lights: tuple[Light, ...] = ()
        self._sent: dict[str, int] = {}  # the frame of the latest measurement, by sensor
        self._first_frame: int | None = None

    def moment(self, sensor_data: Mapping[str, tuple[int, Any]], control: Control) -> Moment | None:
        """Return the latest frame, ``control`` applied in it; None while the vehicle is not in the world yet."""
        snapshot = self._world.get_snapshot()
        own = snapshot.find(self._vehicle.id)
        if own is None:
            return None
        if self._first_frame is None:
            self._first_frame = snapshot.frame
        frame = snapshot.frame - self._first_frame
        lights = tuple(Light(light.id, int(light.get_state())) for light in self._lights)
        changed, self._last_lights = lights != self._last_lights, lights
        return Moment(
            t_s=self._first_s + frame * self._step_s,
            frame=frame,
            motion=Motion(*motion_of(own)),
            control=control,
            lights=lights if changed else (),
            measured=self._measured(sensor_data),
            server_frame=snapshot.frame,
        )

    def _measured(self, sensor_data: Mapping[str, tuple[int, Any]]) -> list[Measurement]:
        """Measurements that are new since the last frame, in the order of the sensors."""
        fresh = []
        for sensor_id, mount in self.mounts.items():
            made_in, data = sensor_data.get(sensor_id, (None, None))
            if made_in is not None and self._sent.get(sensor_id) != made_in:
                self._sent[sensor_id] = made_in
                fresh.append(Measurement(mount, data))
        return fresh


INFO = (
    "max_rpm", "moi", "damping_rate_full_throttle", "damping_rate_zero_throttle_clutch_engaged",
    "damping_rate_zero_throttle_clutch_disengaged", "use_gear_autobox", "gear_switch_time", "clutch_strength", "mass",
    "drag_coefficient",
)  # fmt: skip
"""The members of carla.VehiclePhysicsControl that a message takes as they are."""
WHEEL = ("tire_friction", "damping_rate", "radius", "max_brake_torque", "max_handbrake_torque")
"""Likewise of carla.WheelPhysicsControl; the radius is in cm, as in the ros-bridge."""
M_PER_CM = 0.01  # of wheels' places


def info_message(types: Types, vehicle: carla.Vehicle) -> Message:
    """Return wheels, engine and mass of a vehicle that is in the world, with the wheels' places in its frame in m."""
    physics = vehicle.get_physics_control()
    into_vehicle = np.array(vehicle.get_transform().get_inverse_matrix())
    wheels = []
    for wheel in physics.wheels:
        at = np.array([wheel.position.x, wheel.position.y, wheel.position.z]) * M_PER_CM
        place = (into_vehicle @ np.append(at, 1.0))[:3].tolist()
        values = {name: float(getattr(wheel, name)) for name in WHEEL}
        angle, position = math.radians(wheel.max_steer_angle), vector3(types, vector(*place))
        kind = "carla_msgs/msg/CarlaEgoVehicleInfoWheel"
        wheels.append(types.message(kind, **values, max_steer_angle=angle, position=position))
    middle, role = physics.center_of_mass, vehicle.attributes["role_name"]
    topic = info_of(role)
    known = {name: getattr(physics, name) for name in INFO}
    content = types.message(
        topic.type,
        id=vehicle.id,
        type=vehicle.type_id,
        rolename=role,
        wheels=wheels,
        center_of_mass=vector3(types, vector(middle.x, middle.y, middle.z)),
        **known,
    )
    return Message(topic, content)


def actor_of(other: Other) -> Actor:
    """Return an actor that the agent sees."""
    return Actor(
        other.id,
        TYPE_OF_KIND[other.kind],
        other.x_m,
        other.y_m,
        other.z_m,
        other.yaw_rad,
        other.velocity_x_mps,
        other.velocity_y_mps,
        other.half_length_m,
        other.half_width_m,
    )


def mount_of(spec: SensorSpec) -> Mount:
    """Return a sensor of a set with its place in rad."""
    roll, pitch, yaw = (math.radians(angle) for angle in (spec.roll_deg, spec.pitch_deg, spec.yaw_deg))
    return Mount(spec.id, spec.type_id, spec.x_m, spec.y_m, spec.z_m, roll, pitch, yaw, dict(spec.attributes))


def control_of(control: carla.VehicleControl) -> Control:
    """Return a control of the client; the gear is the vehicle's own affair unless it is shifted by hand."""
    return Control(
        float(control.throttle),
        float(control.steer),
        float(control.brake),
        bool(control.hand_brake),
        bool(control.reverse),
        int(control.gear) if control.manual_gear_shift else 0,
        bool(control.manual_gear_shift),
    )
