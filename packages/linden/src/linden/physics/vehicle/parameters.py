"""From CARLA's VehiclePhysicsControl to the numbers the kernels use, with what we take its vaguer fields to mean."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.errors import Refusal
from linden.geometry import rotation_matrix
from linden.physics.state import CURVE_POINTS, GEARS, VEHICLE_SPEC, WHEELS, Rows
from linden.physics.vehicle.wheels import WHEEL_MASS_KG
from linden.protocol.values.control import UNKNOWN_UNDERCARRIAGE, Gear, Undercarriage, VehiclePhysicsControl, Wheel
from linden.protocol.values.space import BoundingBox, Transform, Vector2D, Vector3D

F64 = NDArray[np.float64]

STANDARD_GRAVITY_MPS2 = 9.81
AIR_DENSITY_KGPM3 = 1.25  # Unreal's, as is the area that drag_coefficient is multiplied with: its chassis by default
CHASSIS_AREA_M2 = 1.8 * 1.4
FRONT_SHARE = 0.45  # of the torque, on four wheels: PhysX's differential by default
HULL_INERTIA = 0.75
"""Yaw inertia of a vehicle's hull over that of its box: PhysX takes the inertia of the hull, which is shorter at the
corners and has no mirrors. Recorded yaw rates fit best between 0.7 and 0.8 (docs/explanation/fidelity.md)."""
_RPM = 2.0 * math.pi / 60.0
_LEAST_COM_HEIGHT_M = 0.1


def default_wheel_offsets(box: BoundingBox, wheel_count: int) -> tuple[Vector3D, ...]:
    """Return the default places of wheels: axles at 0.6 of the half length, 0.75 of the half width; m, local."""
    x, y = 0.6 * box.extent.x, 0.75 * box.extent.y
    if wheel_count == 2:
        return Vector3D(x, 0.0, 0.0), Vector3D(-x, 0.0, 0.0)
    return Vector3D(x, -y, 0.0), Vector3D(x, y, 0.0), Vector3D(-x, -y, 0.0), Vector3D(-x, y, 0.0)


def local_wheels(control: VehiclePhysicsControl, pose: Transform, count: int) -> tuple[Vector3D, ...] | None:
    """Return the wheels' places in the vehicle's frame, m, of those in the world, cm; None if none is given.

    ``count``: how many it drives on; of four that stand for two, the middle of each pair.
    """
    world_m = np.array([wheel.position for wheel in control.wheels]) / 100.0
    if not world_m.any():
        return None
    local = (world_m - np.asarray(pose.location)) @ rotation_matrix(pose.rotation)
    local = local.reshape(count, -1, 3).mean(axis=1)
    return tuple(Vector3D(*map(float, row)) for row in local)


def world_wheels(control: VehiclePhysicsControl, pose: Transform, offsets_m: Sequence[Vector3D]) -> tuple[Wheel, ...]:
    """Return the wheels with their places in the world, cm: the inverse of :func:`local_wheels`."""
    local_m = np.repeat(np.asarray(offsets_m), len(control.wheels) // len(offsets_m), axis=0)
    world_cm = 100.0 * (local_m @ rotation_matrix(pose.rotation).T + np.asarray(pose.location))
    return tuple(
        wheel._replace(position=Vector3D(*map(float, place)))
        for wheel, place in zip(control.wheels, world_cm, strict=True)
    )


_APART = ("forward_gears", "wheels", "position")  # parts with fields of their own, and a place in the world


def axle_wheel(left: Wheel, right: Wheel) -> Wheel:
    """Return the one wheel of an axle on which CARLA's two-wheelers have two, side by side.

    What each of two wheels adds, torques and the forces of damping and slip, adds up; the rest is their mean.
    """
    return Wheel(
        tire_friction=0.5 * (left.tire_friction + right.tire_friction),
        damping_rate=left.damping_rate + right.damping_rate,
        max_steer_angle=0.5 * (left.max_steer_angle + right.max_steer_angle),
        radius=0.5 * (left.radius + right.radius),
        max_brake_torque=left.max_brake_torque + right.max_brake_torque,
        max_handbrake_torque=left.max_handbrake_torque + right.max_handbrake_torque,
        lat_stiff_max_load=0.5 * (left.lat_stiff_max_load + right.lat_stiff_max_load),
        lat_stiff_value=0.5 * (left.lat_stiff_value + right.lat_stiff_value),
        long_stiff_value=left.long_stiff_value + right.long_stiff_value,
    )


class Bounds(NamedTuple):
    """Least and greatest value, both included."""

    least: float
    most: float


ANY_NUMBER = Bounds(-1e6, 1e6)
"""Of a field without bounds of its own: what is far beyond any vehicle, and still moves by finite numbers."""

BOUNDS = {
    "mass": Bounds(1.0, 1e6),
    "moi": Bounds(1e-3, 1e4),
    "max_rpm": Bounds(1.0, 1e6),
    "final_ratio": Bounds(-1e3, 1e3),
    "ratio": Bounds(-1e3, 1e3),
    "drag_coefficient": Bounds(-1e3, 1e3),
    "radius": Bounds(1.0, 1e3),
    "tire_friction": Bounds(-1e3, 1e3),
    "max_brake_torque": Bounds(-1e8, 1e8),
    "max_handbrake_torque": Bounds(-1e8, 1e8),
}
"""Of the fields of a vehicle physics control, its gears and wheels, in their units (a wheel's radius in cm)."""


def check(control: VehiclePhysicsControl, wheel_count: int | None = None) -> None:
    """Refuse what cannot drive.

    Raises:
        Refusal: a number is not finite, a mass or radius not positive, a list too long or empty, or the number of
            wheels not ``wheel_count`` (where given) or neither 2 nor 4.
    """
    if len(control.wheels) not in ({2, WHEELS} if wheel_count is None else {wheel_count}):
        raise Refusal(f"this vehicle has {wheel_count or '2 or 4'} wheels, not {len(control.wheels)}")
    if not 1 <= len(control.forward_gears) <= GEARS:
        raise Refusal(f"a gearbox has 1 to {GEARS} forward gears, not {len(control.forward_gears)}")
    for name, curve in (("torque_curve", control.torque_curve), ("steering_curve", control.steering_curve)):
        if not 1 <= len(curve) <= CURVE_POINTS:
            raise Refusal(f"{name} has 1 to {CURVE_POINTS} points, not {len(curve)}")
    numbers = np.array([*_numbers(control)], np.float64)
    if not np.isfinite(numbers).all():
        raise Refusal("a number of the vehicle physics control is nan or infinite; give finite ones")
    if not (control.mass > 0.0 and control.moi > 0.0 and control.max_rpm > 0.0):
        raise Refusal(
            f"mass, moi and max_rpm must be positive, not {control.mass:g}, {control.moi:g} and {control.max_rpm:g}"
        )
    if any(wheel.radius <= 0.0 for wheel in control.wheels):
        raise Refusal("a wheel's radius must be positive (it is in cm)")
    parts: tuple[VehiclePhysicsControl | Gear | Wheel, ...] = (control, *control.forward_gears, *control.wheels)
    for part in parts:
        _check_bounds(part)


def _check_bounds(part: VehiclePhysicsControl | Gear | Wheel) -> None:
    """Raise a Refusal where a number by which a body moves is out of its bounds; where a wheel lies is no such one."""
    for name, value in zip(part._fields, part, strict=True):
        least, most = BOUNDS.get(name, ANY_NUMBER)
        for number in () if name in _APART else _numbers(value):
            if not least <= number <= most:
                owner = type(part).__name__
                raise Refusal(f"{name} of a {owner} lies between {least:g} and {most:g}, not at {number:g}")


def _numbers(value: object) -> list[float]:
    """Return all numbers within nested tuples."""
    if isinstance(value, tuple):
        return [number for item in value for number in _numbers(item)]
    return [float(value)]  # type: ignore[arg-type]  # the leaves of a VehiclePhysicsControl are numbers


def centre_of_mass(
    control: VehiclePhysicsControl,
    box: BoundingBox,
    offsets_m: Sequence[Vector3D],
    undercarriage: Undercarriage = UNKNOWN_UNDERCARRIAGE,
) -> Vector3D:
    """Return the centre of mass in the vehicle's frame, m.

    ``center_of_mass`` is an offset (Unreal adds it to the centre it computes from the body's shape); we add it to the
    middle of the hull where that is known, else to that of the box, and keep the result between the axles and over
    the ground, so that every wheel carries weight.
    """
    front, rear = offsets_m[0].x, offsets_m[-1].x
    hull_x_m = box.location.x if undercarriage.hull_x_m is None else undercarriage.hull_x_m
    x = hull_x_m + control.center_of_mass.x
    z = box.location.z + control.center_of_mass.z
    span = front - rear
    return Vector3D(
        float(np.clip(x, rear + 0.2 * span, front - 0.2 * span)),
        float(np.clip(box.location.y + control.center_of_mass.y, -0.2 * box.extent.y, 0.2 * box.extent.y)),
        float(max(_LEAST_COM_HEIGHT_M, z)),
    )


def yaw_inertia_kgm2(mass_kg: float, box: BoundingBox) -> float:
    """Return that of a uniform box about the vertical: m (l² + w²) / 12."""
    return mass_kg * ((2.0 * box.extent.x) ** 2 + (2.0 * box.extent.y) ** 2) / 12.0


def specification(
    control: VehiclePhysicsControl,
    offsets_m: Sequence[Vector3D],
    com_m: Vector3D,
    undercarriage: Undercarriage = UNKNOWN_UNDERCARRIAGE,
) -> Rows:
    """Return a VEHICLE_SPEC record. ``offsets_m``: wheels in the vehicle's frame, FL, FR, BL, BR.

    Two places (front, back) make a two-wheeler. Its control may have four wheels, as CARLA's have.
    """
    spec: Rows = np.zeros((), VEHICLE_SPEC)
    count, wheels = len(offsets_m), control.wheels
    if count < len(wheels):
        wheels = axle_wheel(*wheels[:2]), axle_wheel(*wheels[2:])
    spec["wheel_count"] = count
    spec["wheel_x_m"][:count] = [offset.x for offset in offsets_m]
    spec["wheel_y_m"][:count] = [offset.y for offset in offsets_m]
    for k, wheel in enumerate(wheels):
        _wheel(spec, k, wheel)
    rear_share = 1.0 - FRONT_SHARE
    spec["drive_share"][:count] = np.repeat((FRONT_SHARE, rear_share), 2) / 2.0 if count == WHEELS else (0.0, 1.0)
    _loads(spec, count, com_m)
    half = count // 2
    spec["axle_front_m"] = spec["wheel_x_m"][:half].mean()
    spec["axle_rear_m"] = spec["wheel_x_m"][half:count].mean()
    spec["wheelbase_m"] = max(0.1, float(spec["axle_front_m"] - spec["axle_rear_m"]))
    spec["track_m"] = np.ptp(spec["wheel_y_m"][:count])
    spec["sway_m"] = com_m.z if undercarriage.sway_m is None else undercarriage.sway_m
    spec["drag_kgpm"] = 0.5 * AIR_DENSITY_KGPM3 * max(0.0, control.drag_coefficient) * CHASSIS_AREA_M2
    spec["tyres_lag"] = undercarriage.tyres_lag
    _engine(spec, control)
    spec["reverse_ratio"] = min(undercarriage.reverse_ratio, 0.0) * control.final_ratio
    return spec


def _wheel(spec: Rows, k: int, wheel: Wheel) -> None:
    """Fill in one wheel's constants."""
    radius_m = wheel.radius / 100.0
    spec["wheel_radius_m"][k] = radius_m
    spec["wheel_inertia_kgm2"][k] = 0.5 * WHEEL_MASS_KG * radius_m**2
    spec["wheel_damping_nms"][k] = max(0.0, wheel.damping_rate)
    spec["friction"][k] = max(0.0, wheel.tire_friction)
    spec["cornering_per_rad"][k] = max(1e-3, wheel.lat_stiff_value)
    spec["cornering_full_load"][k] = max(1e-3, wheel.lat_stiff_max_load)
    spec["slip_stiffness_n"][k] = max(1e-3, wheel.long_stiff_value) * STANDARD_GRAVITY_MPS2
    spec["steer_max_rad"][k] = math.radians(max(-85.0, min(85.0, wheel.max_steer_angle)))
    spec["brake_nm"][k] = max(0.0, wheel.max_brake_torque)
    spec["hand_brake_nm"][k] = max(0.0, wheel.max_handbrake_torque)


def _loads(spec: Rows, count: int, com_m: Vector3D) -> None:
    """Fill in how the weight loads the wheels, and how far from the centre of mass it does.

    The plane of loads that balances both moments: Gillespie, Fundamentals of Vehicle Dynamics, eq. 1-6 for two axles;
    least squares over any set of wheels.
    """
    spec["load_share"][:count] = 1.0 / count
    for axis, com in (("wheel_x_m", com_m.x), ("wheel_y_m", com_m.y)):
        arm = spec[axis][:count] - com
        spread = arm - arm.mean()
        square = float((spread**2).sum())
        if square > 1e-6:
            spec["load_share"][:count] -= arm.mean() * spread / square
    for axis, com, column in (("wheel_x_m", com_m.x, "pitch_arm2_m2"), ("wheel_y_m", com_m.y, "roll_arm2_m2")):
        spec[column] = max(0.01, float((spec["load_share"][:count] * (spec[axis][:count] - com) ** 2).sum()))


def _engine(spec: Rows, control: VehiclePhysicsControl) -> None:
    """Fill in engine, gears and curves."""
    spec["engine_inertia_kgm2"] = control.moi
    spec["engine_max_radps"] = control.max_rpm * _RPM
    spec["damping_full_throttle"] = max(0.0, control.damping_rate_full_throttle)
    spec["damping_engaged"] = max(0.0, control.damping_rate_zero_throttle_clutch_engaged)
    spec["damping_disengaged"] = max(0.0, control.damping_rate_zero_throttle_clutch_disengaged)
    spec["clutch_nms"] = max(0.0, control.clutch_strength)
    spec["switch_time_s"] = max(0.0, control.gear_switch_time)
    spec["autobox"] = control.use_gear_autobox
    count = len(control.forward_gears)
    spec["gear_count"] = count
    spec["gear_ratio"][:count] = [gear.ratio * control.final_ratio for gear in control.forward_gears]
    spec["gear_down"][:count] = [gear.down_ratio for gear in control.forward_gears]
    spec["gear_up"][:count] = [gear.up_ratio for gear in control.forward_gears]
    spec["torque_points"] = _curve(spec["torque_radps"], spec["torque_nm"], control.torque_curve, _RPM)
    spec["steering_points"] = _curve(spec["steering_mps"], spec["steering_fraction"], control.steering_curve, 1.0 / 3.6)


def _curve(x: F64, y: F64, points: Sequence[Vector2D], x_unit: float) -> int:
    """Write points sorted by x, in SI, and return how many there are."""
    for k, point in enumerate(sorted(points, key=lambda point: point.x)):
        x[k], y[k] = point.x * x_unit, point.y
    return len(points)
