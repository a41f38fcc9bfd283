"""How what a looking sensor measured goes over the wire: its kind, and the bytes behind the header, by its type."""

from collections.abc import Callable
from typing import Any

import msgpack
import numpy as np

from linden.handlers import pictures
from linden.sensors.camera.cameras import Image
from linden.sensors.camera.events import Events
from linden.sensors.collision import scenery_type
from linden.sensors.lidar import SemanticSweep, Sweep
from linden.sensors.obstacle import Obstacle
from linden.sensors.radar import Detections
from linden.simulation import Simulation
from linden.simulation.measuring import Measurement
from linden.values.actors import Actor, ActorDescription
from linden.values.space import BoundingBox
from linden.wire.headers import SensorType
from linden.wire.points import RADAR_DETECTION, lidar_payload, radar_payload
from linden.wire.stream import Parts
from linden.world.actors import ActorRecord

Encode = Callable[[Simulation, Measurement, Any], tuple[SensorType, Parts]]


def _sweep(_simulation: Simulation, _measurement: Measurement, reading: Sweep) -> tuple[SensorType, Parts]:
    return SensorType.LIDAR, lidar_payload(*reading)


def _semantic(_simulation: Simulation, _measurement: Measurement, reading: SemanticSweep) -> tuple[SensorType, Parts]:
    return SensorType.LIDAR_SEMANTIC, lidar_payload(*reading)


def _radar(_simulation: Simulation, _measurement: Measurement, reading: Detections) -> tuple[SensorType, Parts]:
    packed = np.empty(len(reading.depth_m), RADAR_DETECTION)
    for name, column in zip(RADAR_DETECTION.names or (), reading, strict=True):
        packed[name] = column
    return SensorType.RADAR, radar_payload(packed)


def _obstacle(simulation: Simulation, measurement: Measurement, reading: Obstacle) -> tuple[SensorType, Parts]:
    actors = simulation.episode.actors
    other = described(actors.get(reading.actor_id)) if reading.actor_id else scenery(scenery_type(reading.tag))
    return SensorType.OBSTACLE, (msgpack.packb((described(measurement.sensor), other, reading.distance_m)),)


def described(record: ActorRecord) -> Actor:
    """Return an actor that takes part in an event as the client learns of it."""
    return Actor(record.id, record.parent_id, record.description, record.box, record.semantic_tags)


def scenery(type_id: str) -> Actor:
    """Return what stands for scenery in an event: an actor that nobody has spawned."""
    return Actor(0, 0, ActorDescription(0, type_id), BoundingBox())


ENCODERS: dict[type, Encode] = {
    Sweep: _sweep,
    SemanticSweep: _semantic,
    Image: pictures.image,
    Events: pictures.events,
    Detections: _radar,
    Obstacle: _obstacle,
}
