"""What the instruments of the HUD show in one frame, as plain values."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import carla

if TYPE_CHECKING:
    from collections.abc import Iterable

    from basu.managers.base_manager import Ego, Frame, Live, Run
    from basu.output.hud.notices import Judgement

GRAVITY_MPS2 = 9.81
MPS_PER_KMH = 1.0 / 3.6
POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


class Fix(NamedTuple):
    """GNSS."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float


class Inertial(NamedTuple):
    """IMU, in the vehicle's axes: x ahead, y to the right, z up."""

    acceleration_mps2: tuple[float, float, float]  # with gravity, as an accelerometer feels it
    spin_degps: tuple[float, float, float]


class Readings(NamedTuple):
    """All of one frame."""

    vehicle: str
    manual: bool
    autopilot: bool  # the one who drives while a person lets it, in a run that is the person's
    tick: int
    simulated_s: float
    wall_s: float
    speed_mps: float
    limit_mps: float | None
    gear: int
    control: carla.VehicleControl
    heading_deg: float  # from north, clockwise
    at_m: tuple[float, float, float]
    fix: Fix
    inertial: Inertial
    along_m: float  # of the route
    length_m: float
    lateral_m: float
    judgement: Judgement
    nearby: tuple[tuple[str, float], ...]  # blueprint id and distance in m, the nearest first


def read(
    run: Run, live: Live, frame: Frame, judgement: Judgement, nearby: Iterable[tuple[str, float]], wall_s: float
) -> Readings:
    """Read everything; the server is not asked."""
    ego, person = frame.ego, live.agents.person
    limit_mps = float(run.vehicle.get_speed_limit()) * MPS_PER_KMH
    return Readings(
        vehicle=run.vehicle.type_id,
        manual=live.agents.manual,
        autopilot=person is not None and person.drives_first and not live.agents.manual,
        tick=frame.tick,
        simulated_s=frame.tick * run.step_s,
        wall_s=wall_s,
        speed_mps=ego.speed_mps,
        limit_mps=limit_mps if limit_mps > 0.0 else None,
        gear=run.vehicle.get_control().gear,
        control=live.agents.control,
        heading_deg=heading_deg(ego.yaw_rad),
        at_m=(ego.x_m, ego.y_m, ego.z_m),
        fix=_fix(run, live, ego),
        inertial=_inertial(live, ego),
        along_m=live.routes.progress.s_m,
        length_m=run.route.length_m,
        lateral_m=live.routes.progress.lateral_m,
        judgement=judgement,
        nearby=tuple(nearby),
    )


def heading_deg(yaw_rad: float) -> float:
    """From north, clockwise, in [0, 360): CARLA's yaw is from east."""
    return (math.degrees(yaw_rad) + 90.0) % 360.0


def compass_point(degrees: float) -> str:
    """The nearest of eight."""
    return POINTS[round(degrees / 45.0) % 8]


def felt(ego: Ego) -> Inertial:
    """What an ideal IMU on a level vehicle would read."""
    cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
    ahead = ego.acceleration_x_mps2 * cos + ego.acceleration_y_mps2 * sin
    right = ego.acceleration_y_mps2 * cos - ego.acceleration_x_mps2 * sin
    spin = (ego.angular_velocity_x_radps, ego.angular_velocity_y_radps, ego.angular_velocity_z_radps)
    roll, pitch, yaw = (math.degrees(rate) for rate in spin)
    return Inertial((ahead, right, ego.acceleration_z_mps2 + GRAVITY_MPS2), (roll, pitch, yaw))


def _fix(run: Run, live: Live, ego: Ego) -> Fix:
    """The agent's GNSS where it has one, else where the map says the vehicle is."""
    for _, measured in live.sensors.data.values():
        if isinstance(measured, carla.GnssMeasurement):
            return Fix(measured.latitude, measured.longitude, measured.altitude)
    place = run.carla_map.transform_to_geolocation(carla.Location(ego.x_m, ego.y_m, ego.z_m))
    return Fix(place.latitude, place.longitude, place.altitude)


def _inertial(live: Live, ego: Ego) -> Inertial:
    """The agent's IMU where it has one, else what one would read."""
    for _, measured in live.sensors.data.values():
        if isinstance(measured, carla.IMUMeasurement):
            force, spin = measured.accelerometer, measured.gyroscope
            roll, pitch, yaw = (math.degrees(rate) for rate in (spin.x, spin.y, spin.z))
            return Inertial((force.x, force.y, force.z), (roll, pitch, yaw))
    return felt(ego)
