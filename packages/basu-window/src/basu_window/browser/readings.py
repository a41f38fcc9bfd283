"""The figures of a drive for the page: setting, motion, controls, GNSS, IMU, collisions, time, actors nearby."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from linden_window.measured import compass_point

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.managers import Live
    from basu.managers.base_manager import Ego, Frame, Run
    from basu_window.browser.judge import Judgement

GRAVITY_MPS2 = 9.81
MPS_PER_KMH = 1.0 / 3.6
MPS_PER_MPH = 0.44704
OVER_MPS = 0.25
"""Above the limit by more than this, the speed turns red: a display of whole mph hides less."""
GEARS = {-1: "R", 0: "N"}
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


class DriveSetting(NamedTuple):
    """What stays the same for a while: where and in what the agent drives, in words."""

    town: str
    route: str
    weather: str
    sensors: str


class Readings(NamedTuple):
    """The figures of one frame."""

    vehicle: str
    driver: str
    setting: DriveSetting
    traffic: tuple[int, int]  # other vehicles and walkers in the world
    ticks_per_s: float  # of wall time
    real_time: float  # simulated seconds for each second of wall time
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
    lateral_m: float  # from the route
    impulses_ns: tuple[float, ...]  # of the latest ticks, the newest last
    tally: tuple[str, ...]  # infractions in words
    nearby: tuple[tuple[str, float], ...]  # blueprint id and distance in m, the nearest first


class Around(NamedTuple):
    """Data of the window itself for the readings."""

    setting: DriveSetting
    traffic: tuple[int, int]
    ticks_per_s: float
    nearby: tuple[tuple[str, float], ...]
    wall_s: float


def read(run: Run, live: Live, frame: Frame, judgement: Judgement, around: Around) -> Readings:
    """Return all figures of a frame, without a call of the server."""
    ego, person = frame.ego, live.agents.person
    limit_mps = float(run.vehicle.get_speed_limit()) * MPS_PER_KMH
    other = "autopilot" if person is not None and person.drives_first else "agent"
    return Readings(
        vehicle=run.vehicle.type_id,
        driver="a person" if live.agents.manual else other,
        setting=around.setting,
        traffic=around.traffic,
        ticks_per_s=around.ticks_per_s,
        real_time=around.ticks_per_s * run.step_s,
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
        lateral_m=live.routes.progress.lateral_m,
        impulses_ns=tuple(judgement.impulses(frame.tick).tolist()),
        tally=tuple(judgement.tally()),
        nearby=around.nearby,
    )


def note_of(shown: Readings, agent: str) -> dict[str, Any]:
    """Return the readings as a note for the page: groups of lines, and the graph of collisions."""
    setting, control, (vehicles, walkers) = shown.setting, shown.control, shown.traffic
    too_fast = shown.limit_mps is not None and shown.speed_mps > shown.limit_mps + OVER_MPS
    limit = "none" if shown.limit_mps is None else f"{shown.limit_mps / MPS_PER_MPH:.0f} mph"
    lamps = [name for name, lit in (("reverse", control.reverse), ("hand brake", control.hand_brake)) if lit]
    force, spin = shown.inertial
    groups = [
        ("", [
            _line("driver", f"{shown.driver} ({agent})" if shown.driver == "agent" else shown.driver),
            _line("vehicle", shown.vehicle.removeprefix("vehicle.")),
            _line("map, route", f"{setting.town}, {setting.route}"),
            _line("weather", setting.weather),
            _line("sensors", setting.sensors),
            _line("traffic", f"{vehicles} vehicles, {walkers} walkers"),
        ]),
        ("Motion", [
            _line("speed", f"{shown.speed_mps / MPS_PER_MPH:.0f} mph, {3.6 * shown.speed_mps:.0f} km/h", bad=too_fast),
            _line("limit", limit, bad=too_fast),
            _line("throttle", f"{control.throttle:.2f}", bar=control.throttle),
            _line("brake", f"{control.brake:.2f}", bar=control.brake),
            _line("steer", f"{control.steer:+.2f}", turn=control.steer),
            _line("gear", ", ".join([GEARS.get(shown.gear, f"D{shown.gear}"), *lamps])),
        ]),
        ("Place", [
            _line("heading", f"{shown.heading_deg:.0f}° {compass_point(shown.heading_deg)}"),
            _line("location", ", ".join(f"{value:.1f}" for value in shown.at_m) + " m"),
            _line("GNSS", ", ".join(degrees(shown.fix, 6))),
            _line("acceleration", f"{signed(force)} m/s²"),
            _line("turn rate", f"{signed(spin)} °/s"),
            _line("off the route", f"{shown.lateral_m:+.2f} m"),
        ]),
        ("Time", [
            _line("simulated, wall", f"{clock(shown.simulated_s)}, {clock(shown.wall_s)}"),
            _line("server", f"{shown.ticks_per_s:.0f} steps/s, {factor(shown.real_time)} real time"),
        ]),
        ("Nearest", [_line(type_id.split(".", 1)[-1], f"{away_m:.0f} m") for type_id, away_m in shown.nearby[:5]]),
    ]  # fmt: skip
    return {
        "type": "readings",
        "groups": [{"name": name, "lines": lines} for name, lines in groups if lines],
        "impulses": [round(value, 1) for value in shown.impulses_ns],
        "tally": shown.tally,
    }


def _line(name: str, value: str, **how: float) -> dict[str, Any]:
    return {"name": name, "value": value, **how}


def factor(value: float) -> str:
    """Return a factor with two figures or so."""
    return f"{value:.2f}x" if value < 1.0 else f"{value:.1f}x"


def clock(seconds: float) -> str:
    """Return minutes and seconds."""
    return f"{int(seconds // 60)}:{seconds % 60:04.1f}"


def signed(values: tuple[float, ...]) -> str:
    """Return values to one decimal place; a value that rounds to nothing has no minus before it."""
    return ", ".join(f"{round(value, 1) + 0.0:+.1f}" for value in values)


def heading_deg(yaw_rad: float) -> float:
    """From north, clockwise, in [0, 360): CARLA's yaw is from east."""
    return (math.degrees(yaw_rad) + 90.0) % 360.0


def felt(ego: Ego) -> Inertial:
    """Return what an ideal IMU on a level vehicle would read."""
    cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
    ahead = ego.acceleration_x_mps2 * cos + ego.acceleration_y_mps2 * sin
    right = ego.acceleration_y_mps2 * cos - ego.acceleration_x_mps2 * sin
    spin = (ego.angular_velocity_x_radps, ego.angular_velocity_y_radps, ego.angular_velocity_z_radps)
    roll, pitch, yaw = (math.degrees(rate) for rate in spin)
    return Inertial((ahead, right, ego.acceleration_z_mps2 + GRAVITY_MPS2), (roll, pitch, yaw))


def setting_of(run: Run, live: Live, weather: carla.WeatherParameters) -> DriveSetting:
    """Return where and in what the agent drives, in words."""
    return DriveSetting(run.route.town, run.route.id, weather_words(weather), sensor_words(live.sensors.types))


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
