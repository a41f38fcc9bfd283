"""The messages of one frame: the world snapshot and the measurements of the sensors, as bytes."""

from collections.abc import Callable, Sequence
from typing import Any

import msgpack
import numpy as np

from linden.physics.contact.statics import scenery_type
from linden.protocol.values.actors import Actor, ActorDescription
from linden.protocol.values.space import BoundingBox, Transform
from linden.protocol.wire.measurements import (
    RADAR_DETECTION,
    Parts,
    SensorType,
    SimulationState,
    episode_header,
    events_payload,
    image_payload,
    lidar_payload,
    radar_payload,
    sensor_header,
)
from linden.protocol.wire.v2x import cam_payload, text_payload
from linden.sensors.camera.cameras import Image
from linden.sensors.camera.events import Events
from linden.sensors.devices.collision import SCENERY, Collision
from linden.sensors.devices.imu import ImuMeasurement
from linden.sensors.devices.lidar import SemanticSweep, Sweep
from linden.sensors.devices.obstacle import Obstacle
from linden.sensors.devices.radar import Detections
from linden.sensors.devices.radio.radio import CamReading, TextReading
from linden.sensors.runtime.measure import Measurement
from linden.simulation.actor_table import ActorRecord
from linden.world import World

_KINDS = {
    "sensor.camera.cosmos_visualization": SensorType.CAMERA_COSMOS,
    "sensor.camera.depth": SensorType.CAMERA_DEPTH,
    "sensor.camera.normals": SensorType.CAMERA_NORMALS,
    "sensor.camera.optical_flow": SensorType.CAMERA_OPTICAL_FLOW,
    "sensor.camera.rgb": SensorType.CAMERA_RGB,
    "sensor.camera.semantic_segmentation": SensorType.CAMERA_SEMANTIC,
    "sensor.camera.instance_segmentation": SensorType.CAMERA_INSTANCE,
}


def image(_simulation: World, _measurement: Measurement, reading: Image) -> tuple[SensorType, Parts]:
    """Encode a picture."""
    return _KINDS[reading.blueprint], image_payload(reading.pixels, reading.fov_deg)


def events(_simulation: World, _measurement: Measurement, reading: Events) -> tuple[SensorType, Parts]:
    """Encode the events of an event camera."""
    return SensorType.CAMERA_DVS, events_payload(reading.events, reading.width_px, reading.height_px, reading.fov_deg)


Encode = Callable[[World, Measurement, Any], tuple[SensorType, Parts]]


def _sweep(_simulation: World, _measurement: Measurement, reading: Sweep) -> tuple[SensorType, Parts]:
    return SensorType.LIDAR, lidar_payload(*reading)


def _semantic(_simulation: World, _measurement: Measurement, reading: SemanticSweep) -> tuple[SensorType, Parts]:
    return SensorType.LIDAR_SEMANTIC, lidar_payload(*reading)


def _radar(_simulation: World, _measurement: Measurement, reading: Detections) -> tuple[SensorType, Parts]:
    packed = np.empty(len(reading.depth_m), RADAR_DETECTION)
    for name, column in zip(RADAR_DETECTION.names or (), reading, strict=True):
        packed[name] = column
    return SensorType.RADAR, radar_payload(packed)


def _obstacle(simulation: World, measurement: Measurement, reading: Obstacle) -> tuple[SensorType, Parts]:
    actors = simulation.episode.actors
    other = described(actors.get(reading.actor_id)) if reading.actor_id else scenery(scenery_type(reading.tag))
    return SensorType.OBSTACLE, (msgpack.packb((described(measurement.sensor), other, reading.distance_m)),)


def _cams(_simulation: World, _measurement: Measurement, reading: CamReading) -> tuple[SensorType, Parts]:
    return SensorType.V2X, cam_payload(reading.received)


def _texts(_simulation: World, _measurement: Measurement, reading: TextReading) -> tuple[SensorType, Parts]:
    return SensorType.V2X_CUSTOM, text_payload(reading.received)


def described(record: ActorRecord) -> Actor:
    """Return an actor that takes part in an event as the client learns of it."""
    return Actor(record.id, record.parent_id, record.description, record.box, record.semantic_tags)


def scenery(type_id: str) -> Actor:
    """Return the actor that stands for scenery in an event; it was never spawned."""
    return Actor(0, 0, ActorDescription(0, type_id), BoundingBox())


ENCODERS: dict[type, Encode] = {
    Sweep: _sweep,
    SemanticSweep: _semantic,
    Image: image,
    Events: events,
    Detections: _radar,
    Obstacle: _obstacle,
    CamReading: _cams,
    TextReading: _texts,
}


def world_payload(simulation: World) -> bytes:
    """Return the world snapshot: headers and one row for each actor.

    The platform's time stamp repeats the simulated time, for no clock's may be in it: two runs are equal byte by byte
    (docs/decisions/0003-determinism.md).
    """
    episode = simulation.episode
    state = SimulationState.MAP_CHANGE if simulation.map_changed else SimulationState.NONE
    if episode.surroundings.lamps.pending:
        state |= SimulationState.PENDING_LIGHT_UPDATE
    return b"".join(
        (
            sensor_header(SensorType.WORLD_OBSERVER, simulation.frame, episode.elapsed_s, Transform()),
            episode_header(simulation.episode_id, episode.elapsed_s, simulation.delta_s, state),
            episode.actors.rows[: len(episode.actors)].tobytes(),
        )
    )


def sensor_payloads(simulation: World, measured: Sequence[Measurement]) -> list[tuple[int, bytes]]:
    """Return (stream id, message) of measurements of this frame."""
    return [(item.sensor.stream_id, _payload(simulation, item)) for item in measured]


def _payload(simulation: World, measurement: Measurement) -> bytes:
    if (encode := ENCODERS.get(type(measurement.reading))) is not None:
        kind, parts = encode(simulation, measurement, measurement.reading)
    else:
        kind, body = _encoded(simulation, measurement)
        parts = (msgpack.packb(body),)
    header = sensor_header(kind, simulation.frame, simulation.elapsed_s, measurement.pose)
    return b"".join((header, *parts))  # type: ignore[arg-type] # numpy's stubs know buffers from Python 3.12 on


def _encoded(simulation: World, measurement: Measurement) -> tuple[SensorType, object]:
    """Return the sensor's index and the value that msgpack carries after the header."""
    reading = measurement.reading
    if isinstance(reading, Collision):
        actors = simulation.episode.actors
        own = described(actors.of_slot(reading.slot))
        if reading.other_slot == SCENERY:
            other = scenery(reading.scenery_type)
        else:
            other = described(actors.of_slot(reading.other_slot))
        return SensorType.COLLISION, (own, other, reading.impulse_ns)
    return SensorType.IMU if isinstance(reading, ImuMeasurement) else SensorType.GNSS, reading
