"""`WorldPublisher`: publishes a world on ROS 2 and applies the commands it receives, as CARLA with --ros2 does.

Topics and names are CARLA's (LibCarla's ros2). Values have the axes that REP 103 and the ros-bridge give them.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from linden.errors import Refusal
from linden.protocol.values.space import Transform
from linden.server.rpc.context import Context
from linden_ros2 import basic_messages as basic
from linden_ros2.commands import VehicleCommands
from linden_ros2.dds_node import DdsNode
from linden_ros2.frames import Pose
from linden_ros2.mount import Mount
from linden_ros2.names import is_driven, is_usable, path_of, ros_name
from linden_ros2.readings import data_of
from linden_ros2.sensor_messages import NATIVE, sensor_messages, sensor_types
from linden_ros2.topic import CLOCK, TF, Message, Topic

if TYPE_CHECKING:
    from linden.sensors.runtime.measure import Measurement
    from linden.simulation.actor_table import ActorRecord

MAP = "map"
LANE_INVASION = "sensor.other.lane_invasion"


class Sensor(NamedTuple):
    """A sensor that is published."""

    actor_id: int
    mount: Mount
    frame: str
    parent_id: int
    """The actor that carries it; 0 without one."""
    topics: tuple[Topic, ...]


class WorldPublisher:
    """Publishes after each frame, and applies commands before it.

    Attributes:
        streams: the sensors that are measured and published even without subscribers. As in CARLA, sensors
            with subscribers are published as well.
    """

    def __init__(self, context: Context, node: DdsNode) -> None:
        self.streams: set[int] = set()
        self._context, self._node = context, node
        self._commands = VehicleCommands(context, node)
        self._episode: object = None
        self._version = -1
        self._sensors: dict[int, Sensor | None] = {}
        self._frames: dict[int, str] = {}
        node.announce(CLOCK, TF)

    def enable(self, sensor: "ActorRecord") -> None:
        """Publish a sensor also without subscribers.

        Raises:
            Refusal: it has no topic.
        """
        self._survey()
        if sensor.stream_id not in self._sensors:
            self._sensors[sensor.stream_id] = self._described(sensor)
        if self._sensors[sensor.stream_id] is None:  # a subscriber's that could not be published; say why once more
            self._described(sensor)
        self.streams.add(sensor.stream_id)

    def before_frame(self) -> None:
        """Apply commands that have arrived."""
        self._survey()
        self._commands.apply()

    def after_frame(self, measured: "Sequence[Measurement]") -> None:
        """Publish the frame that the world has just made."""
        self._survey()
        world, types = self._context.world, self._node.types
        t_s, actors = world.elapsed_s, world.episode.actors
        found = [(each, self._of(each.sensor)) for each in measured]
        self._node.publish(Message(CLOCK, basic.clock(types, t_s)))
        if tree := self._tree():
            self._node.publish(Message(TF, basic.transforms(types, t_s, tree)))
        for measurement, sensor in found:
            if sensor is None:
                continue
            header = basic.header(types, t_s, sensor.frame)
            parts = sensor_messages(types, header, sensor.mount, data_of(measurement, actors), NATIVE)
            self._node.publish(
                *(Message(topic, content) for topic, (_, content) in zip(sensor.topics, parts, strict=True))
            )

    def _of(self, sensor: "ActorRecord") -> Sensor | None:
        """The publication of a sensor that was measured; None if it has no topic, which is logged."""
        if sensor.stream_id not in self._sensors:
            try:
                self._sensors[sensor.stream_id] = self._described(sensor)
            except Refusal as refusal:
                self._sensors[sensor.stream_id] = None
                if sensor_types(sensor.description.id, NATIVE):
                    self._context.warn_once(str(refusal))
        return self._sensors[sensor.stream_id]

    def _described(self, sensor: "ActorRecord") -> Sensor:
        """Make the writers of a sensor's topics.

        Raises:
            Refusal: the sensor has no topic.
        """
        kind, actors = sensor.description.id, self._context.world.episode.actors
        path = path_of(sensor, actors)
        parts = sensor_types(kind, NATIVE)
        what = f"sensor {sensor.id} ({kind})"
        if kind == LANE_INVASION:
            raise Refusal(f"{what} cannot be published on ROS 2: the client computes what it measures, not the server")
        if not parts:
            raise Refusal(f"{what} cannot be published on ROS 2: CARLA's publisher has no topic for its kind")
        if not is_usable(path):
            raise Refusal(
                f"{what} cannot be published on ROS 2: '{path}' cannot be part of a topic's name; set ros_name to "
                "letters, digits and _, beginning with a letter"
            )
        topics = tuple(Topic(f"/carla/{path}{suffix}", type_) for suffix, type_ in parts)
        for other in self._sensors.values():
            if other is not None and other.topics[0].name == topics[0].name:
                raise Refusal(
                    f"{what} cannot be published on ROS 2: {topics[0].name} is already the topic of sensor "
                    f"{other.actor_id}; give it another ros_name"
                )
        self._node.announce(*topics)
        name = ros_name(sensor)
        taken = {each.frame for each in self._sensors.values() if each is not None} | set(self._frames.values())
        frame = path if name in taken else name
        return Sensor(sensor.id, Mount(name, kind), frame, sensor.parent_id, topics)

    def _tree(self) -> list[tuple[str, str, Pose]]:
        """The transforms of this frame: vehicles in the map, sensors in what carries them."""
        actors = self._context.world.episode.actors
        tree = [(MAP, frame, _mounted("", actors.transform(actor_id)).pose) for actor_id, frame in self._frames.items()]
        for sensor in self._sensors.values():
            if sensor is None or sensor.actor_id not in actors:
                continue
            parent = self._frames.get(sensor.parent_id)
            is_free = parent is None
            pose = actors.transform(sensor.actor_id) if is_free else actors.relative_transform(sensor.actor_id)
            mount = _mounted(sensor.mount.type_id, pose)
            tree.append((MAP if parent is None else parent, sensor.frame, mount.pose))
        return tree

    def _survey(self) -> None:
        """Follow the actors that have come and gone."""
        episode = self._context.world.episode
        if self._episode is episode and self._version == episode.actors.version:
            return
        self._episode, self._version = episode, episode.actors.version
        alive = {record.stream_id for record in episode.actors if record.stream_id}
        self.streams &= alive
        for stream_id in [each for each in self._sensors if each not in alive]:
            sensor = self._sensors.pop(stream_id)
            if sensor is not None:
                self._node.drop(*sensor.topics)
        vehicles = [record for record in episode.actors if is_driven(record)]
        carriers = {record.parent_id for record in episode.actors if record.stream_id}
        self._frames = {}
        for record in episode.actors:
            if record in vehicles or record.id in carriers:
                name = ros_name(record)
                is_taken = name in self._frames.values()
                self._frames[record.id] = f"{name}_{record.id}" if is_taken else name
        self._commands.follow({record.id: path_of(record, episode.actors) for record in vehicles})


def _mounted(type_id: str, pose: Transform) -> Mount:
    """A pose of CARLA's as a mount, which turns it into ROS's axes."""
    place, turn = pose
    angles = (math.radians(turn.roll), math.radians(turn.pitch), math.radians(turn.yaw))
    return Mount("", type_id, *place, *angles)
