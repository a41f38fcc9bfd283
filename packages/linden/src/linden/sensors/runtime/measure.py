"""The sensors of an episode, and their measurements in each frame."""

from collections import defaultdict
from collections.abc import Container
from typing import NamedTuple, TypeAlias

from linden.errors import Refusal
from linden.protocol.values.space import Transform, Vector3D
from linden.sensors.devices.collision import collisions
from linden.sensors.devices.instruments import Instrument, Moment, instrument, observe
from linden.sensors.devices.radio.radio import RADIOS
from linden.sensors.runtime.looking_sensors import (
    MAKERS,
    ScheduledSensor,
    SensorFrame,
    look_around,
    scheduled_sensor_of,
)
from linden.sensors.runtime.radio_network import RadioNetwork
from linden.simulation.actor_table import ActorRecord, ActorTable
from linden.simulation.episode import Episode

COLLISION_SENSOR = "sensor.other.collision"


class Measurement(NamedTuple):
    """One reading of one sensor, and where the sensor was in the world."""

    sensor: ActorRecord
    pose: Transform
    reading: object
    """A Reading, a Collision, or what a sensor that looks around returned."""


Measurements: TypeAlias = list[Measurement]


MEASURING = ("sensor.other.gnss", "sensor.other.imu", "sensor.other.collision", "sensor.other.lane_invasion")
"""The sensors that measure; the last does so in the client."""

NOT_YET = {
    "sensor.other.rss": "it is computed in a client that is built with the ad-rss library; the wheel is not",
}
"""Blueprints without a sensor behind them, by the beginning of their ids, and the reason."""


def refuse_idle(blueprint_id: str) -> None:
    """Refuse a blueprint that the library lists, as CARLA's does, without a sensor behind it.

    Raises:
        Refusal: CARLA has it, this server not yet.
    """
    if blueprint_id in MEASURING or blueprint_id in MAKERS or blueprint_id in RADIOS:
        return
    for beginning, instead in NOT_YET.items():
        if blueprint_id.startswith(beginning):
            raise Refusal(
                f"Spawn failed because of invalid actor description: linden has no {blueprint_id} yet; {instead}"
            )


class EpisodeSensors:
    """The sensors of one episode by actor id, and what each remembers between two frames.

    Attributes:
        instruments: GNSS receivers and inertial units.
        looking: sensors that cast rays.
        radios: sensors that send messages to each other, along rays.
    """

    def __init__(self) -> None:
        self.instruments: dict[int, Instrument] = {}
        self.looking: dict[int, ScheduledSensor] = {}
        self.radios = RadioNetwork()

    def add(self, record: ActorRecord) -> None:
        """Make the sensor of an actor that was spawned, if the actor is a sensor that measures here.

        Raises:
            Refusal: no sensor can have these attributes together.
        """
        self.remove(record.id)  # an id can be that of an actor that a replay has destroyed
        if (made := instrument(record.description)) is not None:
            self.instruments[record.id] = made
        if (sensor := scheduled_sensor_of(record.description)) is not None:
            self.looking[record.id] = sensor
        self.radios.add(record)

    def remove(self, actor_id: int) -> None:
        """Drop the sensor of an actor that is destroyed."""
        self.instruments.pop(actor_id, None)
        self.looking.pop(actor_id, None)
        self.radios.remove(actor_id)

    def remove_destroyed(self, actors: ActorTable) -> None:
        """Drop the sensors of destroyed actors."""
        for actor_id in [*self.instruments, *self.looking, *self.radios]:
            if actor_id not in actors:
                self.remove(actor_id)

    def casts_rays(self, actor_id: int) -> bool:
        """Return whether an actor is a sensor that needs the scene."""
        return actor_id in self.looking or actor_id in self.radios

    def any_looking(self, actors: ActorTable, listened: Container[int]) -> bool:
        """Return whether a client subscribes to a sensor that casts rays; ``listened`` are stream ids."""
        casting = (actor_id for actor_id in (*self.looking, *self.radios) if actor_id in actors)
        return any(actors.get(actor_id).stream_id in listened for actor_id in casting)


def measure(sensors: EpisodeSensors, episode: Episode, listened: Container[int], now: SensorFrame) -> Measurements:
    """Return the measurements that are due in this frame and have subscribers, in the order of the sensors."""
    sensors.remove_destroyed(episode.actors)
    found: Measurements = []
    for sensor_id, before in sensors.instruments.items():
        sensor = episode.actors.get(sensor_id)
        moment = Moment(
            now_s=episode.elapsed_s,
            pose=episode.actors.transform(sensor_id),
            angular_velocity_radps=_turning(episode, sensor),
            origin_deg=episode.map.geo_origin_deg,
            gravity_mps2=episode.imu_gravity_mps2,
        )
        reading, after = observe(before, moment, wanted=sensor.stream_id in listened)
        sensors.instruments[sensor_id] = after
        if reading is not None:
            found.append(Measurement(sensor, moment.pose, reading))
    if len(episode.contacts):
        found += _collisions(episode, listened)
    if sensors.looking:
        found += [Measurement(*seen) for seen in look_around(sensors.looking, episode, now, listened)]
    found += [Measurement(*handed) for handed in sensors.radios.exchange(episode, now, listened)]
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
