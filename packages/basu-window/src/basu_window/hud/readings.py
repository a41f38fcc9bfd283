"""`Readings`, the HUD's values in one frame: run, time, motion, control, GNSS, IMU, route, judgement, actors nearby."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import carla

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.managers import Live
    from basu.managers.base_manager import Ego, Frame, Run
    from basu_window.hud.notices import Judgement

GRAVITY_MPS2 = 9.81
MPS_PER_KMH = 1.0 / 3.6
SENSOR_WORDS = {
    "lidar": "lidar",
    "camera": "camera",
    "radar": "radar",
    "gnss": "GNSS",
    "imu": "IMU",
    "collision": "collision",
    "lane_invasion": "lane",
    "obstacle": "obstacle",
}
POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


class Fix(NamedTuple):
    """GNSS."""

    latitude_deg: float  # on Earth, so it grows northwards, other than CARLA's
    longitude_deg: float
    altitude_m: float


def degrees(fix: Fix, places: int) -> tuple[str, str]:
    """Return latitude and longitude with their half of the Earth."""
    return tuple(  # type: ignore[return-value]  # two
        f"{abs(value):.{places}f}° {halves[value < 0.0]}"
        for value, halves in ((fix.latitude_deg, "NS"), (fix.longitude_deg, "EW"))
    )


class Inertial(NamedTuple):
    """IMU, in the vehicle's axes: x ahead, y to the right, z up."""

    acceleration_mps2: tuple[float, float, float]  # with gravity, as an accelerometer feels it
    spin_degps: tuple[float, float, float]


class Setting(NamedTuple):
    """What stays the same for a while: where and in what the agent drives, in words."""

    town: str
    route: str
    weather: str
    sensors: str


class Rates(NamedTuple):
    """How fast the run goes, over the last second or two of wall time."""

    ticks_per_s: float  # steps of the server
    pictures_per_s: float  # drawings of this window
    real_time: float  # simulated seconds a second


class Readings(NamedTuple):
    """All of one frame."""

    vehicle: str
    setting: Setting
    traffic: tuple[int, int]  # other vehicles and walkers in the world
    rates: Rates
    manual: bool
    autopilot: bool  # whether the agent drives in a person's run
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


class Around(NamedTuple):
    """Data of the window itself for the instruments."""

    setting: Setting
    traffic: tuple[int, int]
    rates: Rates
    nearby: tuple[tuple[str, float], ...]
    wall_s: float


def read(run: Run, live: Live, frame: Frame, judgement: Judgement, around: Around) -> Readings:
    """Read all instruments, without a call of the server."""
    ego, person = frame.ego, live.agents.person
    limit_mps = float(run.vehicle.get_speed_limit()) * MPS_PER_KMH
    return Readings(
        vehicle=run.vehicle.type_id,
        setting=around.setting,
        traffic=around.traffic,
        rates=around.rates,
        manual=live.agents.manual,
        autopilot=person is not None and person.drives_first and not live.agents.manual,
        tick=frame.tick,
        simulated_s=frame.tick * run.step_s,
        wall_s=around.wall_s,
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
        nearby=around.nearby,
    )


def heading_deg(yaw_rad: float) -> float:
    """From north, clockwise, in [0, 360): CARLA's yaw is from east."""
    return (math.degrees(yaw_rad) + 90.0) % 360.0


def compass_point(degrees: float) -> str:
    """Return the nearest of the eight points of the compass."""
    return POINTS[round(degrees / 45.0) % 8]


def felt(ego: Ego) -> Inertial:
    """Return what an ideal IMU on a level vehicle would read."""
    cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
    ahead = ego.acceleration_x_mps2 * cos + ego.acceleration_y_mps2 * sin
    right = ego.acceleration_y_mps2 * cos - ego.acceleration_x_mps2 * sin
    spin = (ego.angular_velocity_x_radps, ego.angular_velocity_y_radps, ego.angular_velocity_z_radps)
    roll, pitch, yaw = (math.degrees(rate) for rate in spin)
    return Inertial((ahead, right, ego.acceleration_z_mps2 + GRAVITY_MPS2), (roll, pitch, yaw))


def setting_of(run: Run, live: Live) -> Setting:
    """Return where and in what the agent drives; asks the server for the weather."""
    return Setting(
        run.route.town, run.route.id, weather_words(run.world.get_weather()), sensor_words(live.sensors.types)
    )


def weather_words(weather: carla.WeatherParameters) -> str:
    """Return the name of CARLA's preset, or the sun's height, rain and fog."""
    for name, preset in vars(carla.WeatherParameters).items():
        if isinstance(preset, carla.WeatherParameters) and preset == weather:
            return str(name)
    parts = [f"sun {weather.sun_altitude_angle:.0f}°"]
    parts += [f"rain {weather.precipitation:.0f} %"] if weather.precipitation > 0.0 else []
    parts += [f"fog {weather.fog_density:.0f} %"] if weather.fog_density > 0.0 else []
    return ", ".join(parts)


def sensor_words(types: Mapping[str, str]) -> str:
    """Return a sensor set in words, by kind: "3 cameras, lidar, GNSS"."""
    kinds = [
        next((word for part, word in SENSOR_WORDS.items() if part in type_id), "other") for type_id in types.values()
    ]
    counted = {kind: kinds.count(kind) for kind in kinds}
    return ", ".join(kind if number == 1 else f"{number} {kind}s" for kind, number in counted.items()) or "none"


def true_latitude_deg(carla_map: carla.Map, latitude_deg: float, x_m: float, y_m: float) -> float:
    """Return the latitude on Earth of what a client or a GNSS sensor of CARLA 0.9.16 measured at a place.

    There latitude grows southwards: CARLA's y points south, and the client projects it as if it pointed north. The true
    latitude is the one that it gives to the place mirrored at the map's origin; noise is kept. A client that has this
    right is left as it is.

    Args:
        carla_map: which projects places.
        latitude_deg: as it was measured.
        x_m: of the place, in CARLA's frame.
        y_m: likewise; grows southwards.
    """

    def projected_deg(x_m: float, y_m: float) -> float:
        return float(carla_map.transform_to_geolocation(carla.Location(x_m, y_m, 0.0)).latitude)

    if projected_deg(0.0, -1000.0) > projected_deg(0.0, 0.0):
        return latitude_deg
    return latitude_deg + projected_deg(x_m, -y_m) - projected_deg(x_m, y_m)


def _fix(run: Run, live: Live, ego: Ego) -> Fix:
    """Return the agent's GNSS where it has one, else where the map says the vehicle is."""
    for _, measured in live.sensors.data.values():
        if isinstance(measured, carla.GnssMeasurement):
            return fix_of(run.carla_map, measured, measured.transform.location)
    at = carla.Location(ego.x_m, ego.y_m, ego.z_m)
    return fix_of(run.carla_map, run.carla_map.transform_to_geolocation(at), at)


def fix_of(carla_map: carla.Map, measured: carla.GnssMeasurement | carla.GeoLocation, at: carla.Location) -> Fix:
    """Return what was measured at a place, with the true latitude."""
    latitude_deg = true_latitude_deg(carla_map, measured.latitude, at.x, at.y)
    return Fix(latitude_deg, measured.longitude, measured.altitude)


def _inertial(live: Live, ego: Ego) -> Inertial:
    """Return the agent's IMU where it has one, else what one would read."""
    for _, measured in live.sensors.data.values():
        if isinstance(measured, carla.IMUMeasurement):
            force, spin = measured.accelerometer, measured.gyroscope
            roll, pitch, yaw = (math.degrees(rate) for rate in (spin.x, spin.y, spin.z))
            return Inertial((force.x, force.y, force.z), (roll, pitch, yaw))
    return felt(ego)
