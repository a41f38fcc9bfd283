"""Sensor sets in both directions: a foreign agent's in BASU's fields, and a BASU agent's in the leaderboard's."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu_leaderboard.foreign_class import Dialect

if TYPE_CHECKING:
    from basu.agents.sensor_file import SensorSpec


SPEEDOMETER, OPENDRIVE_MAP = "sensor.speedometer", "sensor.opendrive_map"
PSEUDO = frozenset({SPEEDOMETER, OPENDRIVE_MAP})
"""Sensors of the leaderboard's own, which no simulator has: the adapter answers for them."""

POSE = ("x", "y", "z", "roll", "pitch", "yaw")
CAMERA = "sensor.camera."
TAKEN = {"sensor.lidar.ray_cast": (), "sensor.other.radar": ("horizontal_fov", "vertical_fov")}
"""What an agent of the leaderboard says of a sensor beside its pose; cameras: ``CAMERA_FIELDS``."""

CAMERA_FIELDS = ("width", "height", "fov")
FIXED: dict[str, dict[str, float]] = {
    "sensor.lidar.ray_cast": {
        "range": 85,
        "rotation_frequency": 10,
        "channels": 64,
        "upper_fov": 10,
        "lower_fov": -30,
        "points_per_second": 600000,
        "atmosphere_attenuation_rate": 0.004,
        "dropoff_general_rate": 0.45,
        "dropoff_intensity_limit": 0.8,
        "dropoff_zero_intensity": 0.4,
    },
    "sensor.other.radar": {"points_per_second": 1500, "range": 100},
    "sensor.other.gnss": {
        "noise_alt_stddev": 0.000005,
        "noise_lat_stddev": 0.000005,
        "noise_lon_stddev": 0.000005,
        "noise_alt_bias": 0.0,
        "noise_lat_bias": 0.0,
        "noise_lon_bias": 0.0,
    },
    "sensor.other.imu": {
        "noise_accel_stddev_x": 0.001,
        "noise_accel_stddev_y": 0.001,
        "noise_accel_stddev_z": 0.015,
        "noise_gyro_stddev_x": 0.001,
        "noise_gyro_stddev_y": 0.001,
        "noise_gyro_stddev_z": 0.001,
    },
}
"""What the leaderboard 2.x sets for every agent alike (``leaderboard/autoagents/agent_wrapper.py``)."""

LIDAR_OF_SCENARIO_RUNNER = (
    "range",
    "rotation_frequency",
    "channels",
    "upper_fov",
    "lower_fov",
    "points_per_second",
)
"""ScenarioRunner sets none of this itself and wants all of it (``srunner/autoagents/agent_wrapper.py``)."""


class SensorSet(NamedTuple):
    """A set taken apart."""

    entries: list[Any]  # for the simulator, in BASU's fields
    pseudo: dict[str, str]  # id and type of the sensors that the adapter makes itself


def translated(given: object, dialect: Dialect, source: str) -> SensorSet:
    """The set that ``sensors()`` gave; ``source`` is what complaints begin with.

    An entry that is none is handed on, and complained of where all sensor sets are read.

    Raises:
        UserError: it is no list, a sensor lacks a field, or an id is given twice.
    """
    if isinstance(given, str | Mapping) or not isinstance(given, Iterable):
        what = "None" if given is None else type(given).__name__
        raise UserError(f"{source} returned {what}; it must return a list of dicts, one a sensor, [] for none")
    entries: list[Any] = []
    pseudo: dict[str, str] = {}
    for entry in given:
        if isinstance(entry, Mapping) and entry.get("type") in PSEUDO and isinstance(entry.get("id"), str):
            if entry["id"] in pseudo:
                raise UserError(f"{source}: the id '{entry['id']}' is given twice; each sensor needs its own")
            pseudo[entry["id"]] = entry["type"]
        else:
            entries.append(_entry(entry, dialect, source))
    for entry in entries:
        if isinstance(entry, dict) and entry.get("id") in pseudo:
            raise UserError(f"{source}: the id '{entry['id']}' is given twice; each sensor needs its own")
    return SensorSet(entries, pseudo)


def _entry(entry: object, dialect: Dialect, source: str) -> object:
    """One sensor that the simulator has."""
    if not isinstance(entry, Mapping) or not isinstance(kind := entry.get("type"), str) or "id" not in entry:
        return entry
    placed = {name: entry[name] for name in ("type", "id", *POSE) if name in entry}
    if kind == f"{CAMERA}rgb":
        return placed | _taken(entry, CAMERA_FIELDS, source)
    if dialect is Dialect.SCENARIO_RUNNER:
        wanted = LIDAR_OF_SCENARIO_RUNNER if kind == "sensor.lidar.ray_cast" else ()
        return placed | _taken(entry, wanted, source)
    if kind in FIXED:
        return placed | FIXED[kind] | _taken(entry, TAKEN.get(kind, ()), source)
    return dict(entry)  # the leaderboard would refuse it; agents for making data sets ask for others


def _taken(entry: Mapping[str, Any], names: Iterable[str], source: str) -> dict[str, Any]:
    """The fields that a sensor must have; pixels as whole numbers."""
    taken = {}
    for name in names:
        if name not in entry:
            raise UserError(f"{source}: sensor '{entry['id']}' ({entry['type']}) lacks its field '{name}'")
        value = entry[name]
        taken[name] = int(value) if name in {"width", "height"} and isinstance(value, float) else value
    return taken


KNOWN = ("sensor.camera.rgb", "sensor.lidar.ray_cast", "sensor.other.radar", "sensor.other.gnss", "sensor.other.imu")
"""What the leaderboard serves; it sets lidars, the radar's range and all noise itself."""

EXPORTED_CAMERA_FIELDS = {"image_size_x": ("width", 800), "image_size_y": ("height", 600), "fov": ("fov", 90)}
"""By CARLA's attribute: the leaderboard's field, which it insists on, and CARLA's default."""

WHOLE = frozenset({"width", "height", "channels", "points_per_second"})


def theirs(specs: tuple[SensorSpec, ...]) -> tuple[list[dict[str, Any]], dict[str, SensorSpec]]:
    """The host's dicts, and the sensors by id; sensors that it does not serve are left out with a log entry."""
    served = {spec.id: spec for spec in specs if spec.type_id in KNOWN}
    for spec in specs:
        if spec.id not in served:
            logging.getLogger("basu").warning("the host serves no %s: sensor '%s' is left out", spec.type_id, spec.id)
    return [_exported_entry(spec) for spec in served.values()], served


def _exported_entry(spec: SensorSpec) -> dict[str, Any]:
    """One sensor, with all of its pose, which the host insists on too."""
    entry: dict[str, Any] = {
        "type": spec.type_id,
        "id": spec.id,
        "x": spec.x_m,
        "y": spec.y_m,
        "z": spec.z_m,
        "roll": spec.roll_deg,
        "pitch": spec.pitch_deg,
        "yaw": spec.yaw_deg,
    }
    defaults: dict[str, Any] = {}
    if spec.type_id == "sensor.camera.rgb":
        defaults = dict(EXPORTED_CAMERA_FIELDS.values())
    elif spec.type_id == "sensor.other.radar":
        defaults = {"horizontal_fov": 30.0, "vertical_fov": 30.0}
    renamed = {
        EXPORTED_CAMERA_FIELDS[name][0] if name in EXPORTED_CAMERA_FIELDS else name: text
        for name, text in spec.attributes
    }
    return entry | defaults | {name: _number(name, text) for name, text in renamed.items()}


def _number(name: str, text: str) -> Any:  # noqa: ANN401 - a number where it is one
    """Convert a blueprint's attribute to a number; return other text unchanged."""
    try:
        value = float(text)
    except ValueError:
        return text
    return int(value) if name in WHOLE else value
