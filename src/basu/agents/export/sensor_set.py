"""A BASU agent's sensors in the fields of the leaderboard and of ScenarioRunner."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from basu.agents.sensor_file import SensorSpec

KNOWN = ("sensor.camera.rgb", "sensor.lidar.ray_cast", "sensor.other.radar", "sensor.other.gnss", "sensor.other.imu")
"""What the leaderboard serves; it sets lidars, the radar's range and all noise itself."""

CAMERA = {"image_size_x": ("width", 800), "image_size_y": ("height", 600), "fov": ("fov", 90)}
"""By CARLA's attribute: the leaderboard's field, which it insists on, and CARLA's default."""

WHOLE = frozenset({"width", "height", "channels", "points_per_second"})


def theirs(specs: tuple[SensorSpec, ...]) -> tuple[list[dict[str, Any]], dict[str, SensorSpec]]:
    """The host's dicts, and the sensors by id; those that it does not serve are left out, and that is logged."""
    served = {spec.id: spec for spec in specs if spec.type_id in KNOWN}
    for spec in specs:
        if spec.id not in served:
            logging.getLogger("basu").warning("the host serves no %s: sensor '%s' is left out", spec.type_id, spec.id)
    return [_entry(spec) for spec in served.values()], served


def _entry(spec: SensorSpec) -> dict[str, Any]:
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
        defaults = dict(CAMERA.values())
    elif spec.type_id == "sensor.other.radar":
        defaults = {"horizontal_fov": 30.0, "vertical_fov": 30.0}
    renamed = {CAMERA[name][0] if name in CAMERA else name: text for name, text in spec.attributes}
    return entry | defaults | {name: _number(name, text) for name, text in renamed.items()}


def _number(name: str, text: str) -> Any:  # noqa: ANN401 - a number where it is one
    """A blueprint's text as the number that it says."""
    try:
        value = float(text)
    except ValueError:
        return text
    return int(value) if name in WHOLE else value
