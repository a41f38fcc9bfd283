"""Records as the values of CARLA's client, as ScenarioRunner's log hands them out: m, degrees, m/s."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_carla_log.layouts import Physics

CM_PER_M = 100.0
_COPIED = (
    "max_rpm",
    "moi",
    "damping_rate_full_throttle",
    "damping_rate_zero_throttle_clutch_engaged",
    "damping_rate_zero_throttle_clutch_disengaged",
    "use_gear_autobox",
    "clutch_strength",
    "final_ratio",
    "mass",
    "drag_coefficient",
)
_WHEEL = (
    "tire_friction",
    "damping_rate",
    "max_steer_angle",
    "radius",
    "max_brake_torque",
    "max_handbrake_torque",
    "lat_stiff_max_load",
    "lat_stiff_value",
    "long_stiff_value",
)
_LAMPS = tuple(light for bit, light in sorted(carla.VehicleLightState.values.items()) if bit and bit & (bit - 1) == 0)


def vector(values: Sequence[float] | np.ndarray[Any, Any]) -> carla.Vector3D:
    """Three numbers."""
    return carla.Vector3D(*(float(value) for value in values))


def location(values_cm: Sequence[float]) -> carla.Location:
    """A place in cm, in m."""
    return carla.Location(*(value / CM_PER_M for value in values_cm))


def light_state(number: int) -> carla.TrafficLightState:
    """A traffic light's colour by its number."""
    return carla.TrafficLightState.values.get(number, carla.TrafficLightState.Unknown)


def transform(location_m: np.ndarray[Any, Any], rotation_deg: np.ndarray[Any, Any]) -> carla.Transform:
    """A place (3,) in m and a rotation (3,): roll, pitch, yaw."""
    roll, pitch, yaw = (float(angle) for angle in rotation_deg)
    return carla.Transform(
        carla.Location(*(float(value) for value in location_m)), carla.Rotation(pitch=pitch, yaw=yaw, roll=roll)
    )


def control(row: np.void) -> carla.VehicleControl:
    """A record of ``CONTROLS``."""
    gear = int(row["gear"])
    return carla.VehicleControl(
        throttle=float(row["throttle"]),
        steer=float(row["steer"]),
        brake=float(row["brake"]),
        hand_brake=bool(row["hand_brake"]),
        reverse=gear < 0,
        gear=gear,
    )


def lamps(bits: int) -> list[carla.VehicleLightState]:
    """The lamps that are on, ``[NONE]`` where none is."""
    return [light for light in _LAMPS if bits & int(light)] or [carla.VehicleLightState.NONE]


def box(row: np.void) -> carla.BoundingBox:
    """A record of ``BOXES`` or ``TRIGGER_VOLUMES``; zeros for an actor without a size, such as a sensor."""
    centre, extent = (
        np.nan_to_num(row[name] / np.float32(CM_PER_M), nan=0.0, posinf=0.0, neginf=0.0)
        for name in ("centre_cm", "extent_cm")
    )
    return carla.BoundingBox(carla.Location(*(float(value) for value in centre)), vector(extent))


def scene_light(row: np.void) -> carla.LightState:
    """A record of ``SCENE_LIGHTS``."""
    red, green, blue = (int(255 * min(1.0, max(0.0, float(part)))) for part in row["rgba"][:3])
    group = carla.LightGroup.values.get(int(row["group"]), carla.LightGroup.NONE)
    return carla.LightState(float(row["intensity"]), carla.Color(red, green, blue), group, bool(row["on"]))


def physics_control(made_of: Physics) -> carla.VehiclePhysicsControl:
    """What a vehicle is made of; a file has no ``gear_switch_time`` and no sweep flag: the client's defaults."""
    out = carla.VehiclePhysicsControl()
    for name in _COPIED:
        setattr(out, name, getattr(made_of, name))
    out.center_of_mass = vector(made_of.center_of_mass)
    out.torque_curve = [carla.Vector2D(*point) for point in made_of.torque_curve]
    out.steering_curve = [carla.Vector2D(*point) for point in made_of.steering_curve]
    out.forward_gears = [
        carla.GearPhysicsControl(ratio=ratio, down_ratio=down, up_ratio=up) for ratio, down, up in made_of.forward_gears
    ]
    out.wheels = [_wheel(wheel) for wheel in made_of.wheels]
    return out


def _wheel(numbers: tuple[float, ...]) -> carla.WheelPhysicsControl:
    out = carla.WheelPhysicsControl()
    for name, value in zip(_WHEEL, numbers[:9], strict=True):
        setattr(out, name, value)
    out.position = vector([value / CM_PER_M for value in numbers[9:]])
    return out
