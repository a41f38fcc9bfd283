"""The sensors that cast rays: their constructors, their schedules, their readings in a frame."""

from collections.abc import Callable, Container, Hashable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform
from linden.sensors.camera.cameras import CAMERAS
from linden.sensors.camera.strokes import Strokes, joined
from linden.sensors.devices.attributes import Schedule, advance, interval_s
from linden.sensors.devices.lidar import Lidar, SemanticLidar
from linden.sensors.devices.obstacle import ObstacleDetector
from linden.sensors.devices.radar import Radar
from linden.sensors.runtime.sensor_scene import SensorScene
from linden.sensors.view import F64, AsynchronousSensor, LookingSensor, Seen, SensorLook
from linden.simulation.actor_table import ActorRecord

if TYPE_CHECKING:
    from linden.simulation.episode import Episode

MAKERS: dict[str, Callable[[ActorDescription], LookingSensor]] = {
    **CAMERAS,
    "sensor.lidar.ray_cast": Lidar,
    "sensor.lidar.ray_cast_semantic": SemanticLidar,
    "sensor.other.obstacle": ObstacleDetector,
    "sensor.other.radar": Radar,
}
"""The constructor of each ray-casting sensor by its blueprint."""


class ScheduledSensor:
    """A ray-casting sensor and its state between two frames."""

    def __init__(self, description: ActorDescription) -> None:
        self.sensor = MAKERS[description.id](description)
        self._schedule = Schedule(interval_s(description))
        self._last_s: float | None = None
        self._pose: Transform | None = None

    def turn(self, episode: "Episode", sensor: ActorRecord, now: "SensorFrame", *, wanted: bool) -> SensorLook | None:
        """Return what there is to be measured, None where nothing is; to be called once in every frame."""
        number = self._schedule.made
        due, self._schedule = advance(self._schedule, episode.elapsed_s)
        pose = episode.actors.transform(sensor.id)
        before, self._pose = self._pose or pose, pose
        if not due:
            return None
        passed_s = now.frame_s if self._last_s is None else episode.elapsed_s - self._last_s
        self._last_s = episode.elapsed_s
        if not wanted:
            self.sensor.skip(passed_s)
            return None
        return SensorLook(
            seen=now.seen(episode),
            shared=now.shared,
            pose=pose,
            before=before,
            velocity_mps=_velocity(episode, sensor, pose),
            carrier_id=sensor.parent_id,
            number=number,
            interval_s=passed_s,
            strokes=partial(now.strokes, episode),
        )


class SensorFrame:
    """What all sensors of a frame have in common."""

    def __init__(self, sensor_scene: SensorScene, frame: int, frame_s: float) -> None:
        self.sensor_scene, self.frame, self.frame_s = sensor_scene, frame, frame_s
        self.shared: dict[Hashable, object] = {}
        self._seen: Seen | None = None

    def strokes(self, episode: "Episode", ignored: frozenset[int]) -> Strokes:
        """Return the lines of the map and of the actors but for the ignored ones, once a frame for each such set."""
        key = (Strokes, ignored)
        if key not in self.shared:
            from linden.sensors.runtime.outlines import actor_strokes  # noqa: PLC0415 - few servers draw lines

            self.shared[key] = joined([self.sensor_scene.standing_strokes(episode), actor_strokes(episode, ignored)])
        return self.shared[key]  # type: ignore[return-value] # put there above

    def seen(self, episode: "Episode") -> Seen:
        """Return the moment as it is seen, the bodies posed."""
        if self._seen is None:
            self._seen = self.sensor_scene.look(episode, self.frame)
        return self._seen


def scheduled_sensor_of(description: ActorDescription) -> ScheduledSensor | None:
    """Return the sensor that a complete description asks for, None where it is no sensor that looks."""
    return ScheduledSensor(description) if description.id in MAKERS else None


def look_around(
    looking: dict[int, ScheduledSensor], episode: "Episode", now: SensorFrame, listened: Container[int]
) -> list[tuple[ActorRecord, Transform, object]]:
    """Return the readings that are due and have subscribers: sensor, its pose, reading."""
    sensors = [(episode.actors.get(sensor_id), eye) for sensor_id, eye in looking.items()]
    if any(sensor.stream_id in listened for sensor, _ in sensors):
        now.sensor_scene.follow(episode, now.frame)
    turned = [
        (sensor, eye, eye.turn(episode, sensor, now, wanted=sensor.stream_id in listened)) for sensor, eye in sensors
    ]
    looks = [(sensor, eye.sensor, look) for sensor, eye, look in turned if look is not None]
    for _, eye, look in looks:
        if isinstance(eye, AsynchronousSensor):
            eye.expect(look)
    readings = [(sensor, look.pose, eye.measure(look)) for sensor, eye, look in looks]
    return [(sensor, pose, reading) for sensor, pose, reading in readings if reading is not None]


def _velocity(episode: "Episode", sensor: ActorRecord, pose: Transform) -> F64:
    """Return how fast (3,) the body that carries a sensor moves it, m/s in the world."""
    carrier = episode.carrier(sensor)
    if carrier is None:
        return np.zeros(3)
    bodies, slot = episode.bodies, carrier.slot
    arm_m = np.asarray(pose.location) - bodies.position[slot]
    velocity: F64 = bodies.velocity[slot] + np.cross(bodies.angular_velocity[slot], arm_m)
    return velocity
