"""Measurements of a server's sensors with the fields of ``carla.SensorData``, which `sensor_messages` reads."""

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from linden.sensors.camera.cameras import Image
from linden.sensors.camera.events import Events
from linden.sensors.devices.collision import SCENERY, Collision
from linden.sensors.devices.imu import ImuMeasurement
from linden.sensors.devices.lidar import SemanticSweep, Sweep
from linden.sensors.devices.radar import Detections

if TYPE_CHECKING:
    from linden.sensors.runtime.measure import Measurement
    from linden.simulation.actor_table import ActorTable


def data_of(measurement: "Measurement", actors: "ActorTable") -> Any:  # noqa: ANN401 - as a carla.SensorData
    """Return a measurement as a client would see it; a GNSS receiver's has its fields already."""
    reading = measurement.reading
    fields: dict[str, Any]
    if isinstance(reading, Image):
        height, width = reading.pixels.shape[:2]
        pixels = np.ascontiguousarray(reading.pixels)
        fields = {"raw_data": pixels, "height": height, "width": width, "fov": reading.fov_deg}
    elif isinstance(reading, Events):
        size = {"height": reading.height_px, "width": reading.width_px, "fov": reading.fov_deg}
        fields = {"raw_data": reading.events.tobytes(), **size}
    elif isinstance(reading, Sweep | SemanticSweep):
        fields = {"raw_data": np.ascontiguousarray(reading.points)}
    elif isinstance(reading, Detections):
        fields = {"raw_data": np.column_stack(reading).astype(np.float32)}
    elif isinstance(reading, ImuMeasurement):
        fields = {"transform": measurement.pose, **reading._asdict()}
    elif isinstance(reading, Collision):
        other = None if reading.other_slot == SCENERY else actors.of_slot(reading.other_slot)
        fields = {"normal_impulse": reading.impulse_ns, "other_actor": other}
    else:
        return reading
    return SimpleNamespace(**fields)
