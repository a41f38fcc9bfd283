"""What the sensors of an episode measured in a frame; called once a frame, after its step."""

from collections import defaultdict
from collections.abc import Container
from typing import NamedTuple, TypeAlias

from linden.sensors.collision import collisions
from linden.sensors.instrument import Moment, observe
from linden.simulation.episode import Episode
from linden.simulation.eyes import Now, look_around
from linden.values.space import Transform, Vector3D
from linden.world.actors import ActorRecord

COLLISION_SENSOR = "sensor.other.collision"


class Measurement(NamedTuple):
    """One reading of one sensor, and where the sensor was in the world."""

    sensor: ActorRecord
    pose: Transform
    reading: object
    """A Reading, a Collision, or what a sensor that looks around returned."""


Measurements: TypeAlias = list[Measurement]


def measure(episode: Episode, listened: Container[int], now: Now) -> Measurements:
    """Return what is due in this frame of the sensors whose streams somebody reads, in the order of the sensors."""
    found: Measurements = []
    for sensor_id, instrument in episode.instruments.items():
        sensor = episode.actors.get(sensor_id)
        moment = Moment(
            now_s=episode.elapsed_s,
            pose=episode.actors.transform(sensor_id),
            angular_velocity_radps=_turning(episode, sensor),
            origin_deg=episode.map.geo_origin_deg,
            gravity_mps2=episode.imu_gravity_mps2,
        )
        reading, after = observe(instrument, moment, wanted=sensor.stream_id in listened)
        episode.instruments[sensor_id] = after
        if reading is not None:
            found.append(Measurement(sensor, moment.pose, reading))
    if len(episode.contacts):
        found += _collisions(episode, listened)
    if episode.eyes:
        found += [Measurement(*seen) for seen in look_around(episode, now, listened)]
    return found


def _turning(episode: Episode, sensor: ActorRecord) -> Vector3D:
    """Return the angular velocity, rad/s in the world, of the body that carries a sensor."""
    carrier = episode.carrier(sensor)
    if carrier is None:
        return Vector3D()
    return Vector3D(*map(float, episode.bodies.angular_velocity[carrier.slot]))


def _collisions(episode: Episode, listened: Container[int]) -> Measurements:
    carriers: dict[int, list[int]] = defaultdict(list)
    for record in episode.actors:
        if record.description.id == COLLISION_SENSOR and record.stream_id in listened:
            carrier = episode.carrier(record)
            if carrier is not None:
                carriers[carrier.slot].append(record.id)
    if not carriers:
        return []
    return [
        Measurement(episode.actors.get(event.sensor_id), episode.actors.transform(event.sensor_id), event)
        for event in collisions(episode.contacts, carriers)
    ]
