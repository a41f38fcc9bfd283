"""`VehicleCommands`: commands of ROS 2 nodes drive vehicles of a server's world.

CARLA's own subscriber ends for good when its first publisher leaves. Here the next node takes over.
"""

import math
import time
from typing import TYPE_CHECKING, Any

from linden.protocol.values.control import AckermannControl, VehicleControl
from linden.server.rpc.vehicles import apply_ackermann_control_to_vehicle, apply_control_to_vehicle
from linden_ros2.names import is_usable
from linden_ros2.topic import Topic, control_of

if TYPE_CHECKING:
    from linden.server.rpc.context import Context
    from linden_ros2.dds_node import DdsNode

DEPTH = 10
"""Commands of a topic that are kept between two frames; older ones are dropped."""
LOOKS_EACH_S = 1.0
"""Wall time between two looks for publishers that cannot be heard, or have left."""
_PEDALS = ("throttle", "steer", "brake")
_MOTION = ("steering_angle", "steering_angle_velocity", "speed", "acceleration", "jerk")


class VehicleCommands:
    """Hears the topics of vehicles that ROS 2 may drive; the newest command counts, and holds until the next one."""

    def __init__(self, context: "Context", node: "DdsNode") -> None:
        self._context, self._node = context, node
        self._vehicles: dict[str, int] = {}
        self._topics: dict[Topic, str] = {}
        self._commanded: set[Topic] = set()
        self._next_look_s = 0.0

    def follow(self, paths: dict[int, str]) -> None:
        """Hear the topics of these vehicles alone; ``paths`` is what follows ``/carla/`` by actor id."""
        vehicles: dict[str, int] = {}
        for actor_id, path in paths.items():
            if not is_usable(path):
                self._context.warn_once(
                    f"vehicle {actor_id} hears no commands of ROS 2: '{path}' cannot be part of a topic's name; set "
                    "ros_name to letters, digits and _, beginning with a letter"
                )
            elif path in vehicles:
                self._context.warn_once(
                    f"vehicle {actor_id} hears no commands of ROS 2: /carla/{path} is vehicle {vehicles[path]} "
                    "already; give it another ros_name"
                )
            else:
                vehicles[path] = actor_id
        if vehicles.keys() != self._vehicles.keys():
            topics = {topic: path for path in vehicles for topic in (_pedals_of(path), _motion_of(path))}
            self._node.drop(*(self._topics.keys() - topics.keys()))
            self._commanded &= topics.keys()
            self._node.listen(*topics)
            self._topics = topics
        self._vehicles = vehicles

    def apply(self) -> None:
        """Apply the newest command of each topic that has come since the last frame, if it can be applied."""
        for topic, path in self._topics.items():
            commands = self._heard(topic)
            if not commands:
                continue
            self._commanded.add(topic)
            if len(commands) >= DEPTH:
                self._warn(topic, f"{DEPTH} or more commands came within a frame; only the newest counts")
            if topic.type == "ackermann_msgs/msg/AckermannDriveStamped":
                self._seek(topic, self._vehicles[path], commands[-1].drive)
            else:
                self._press(topic, self._vehicles[path], commands[-1])
        if self._topics and time.monotonic() >= self._next_look_s:
            self._next_look_s = time.monotonic() + LOOKS_EACH_S
            self._look()

    def _heard(self, topic: Topic) -> list[Any]:
        """The commands that have come; bytes that are no message are refused."""
        try:
            return self._node.received(topic)
        except Exception as error:  # noqa: BLE001 - rosbags raises errors of all kinds on foreign bytes
            self._warn(topic, f"a message is refused, because its bytes are no {topic.type} ({error!r})")
            return []

    def _press(self, topic: Topic, actor_id: int, message: Any) -> None:  # noqa: ANN401 - a message
        if self._is_finite(topic, message, _PEDALS):
            control = VehicleControl(
                message.throttle,
                message.steer,
                message.brake,
                bool(message.hand_brake),
                bool(message.reverse),
                bool(message.manual_gear_shift),
                message.gear,
            )
            apply_control_to_vehicle(self._context, actor_id, control)

    def _seek(self, topic: Topic, actor_id: int, message: Any) -> None:  # noqa: ANN401 - a message
        """Apply an Ackermann command; its angles are positive to the left, CARLA's to the right."""
        if self._is_finite(topic, message, _MOTION):
            angle, rate, *motion = (float(getattr(message, name)) for name in _MOTION)
            apply_ackermann_control_to_vehicle(self._context, actor_id, AckermannControl(-angle, rate, *motion))

    def _is_finite(self, topic: Topic, message: Any, names: tuple[str, ...]) -> bool:  # noqa: ANN401 - a message
        """Whether a command can be applied; what is no number is refused as a whole."""
        for name in names:
            if not math.isfinite(value := getattr(message, name)):
                self._warn(topic, f"a command is refused, because its {name} is {value}; it must be a finite number")
                return False
        return True

    def _look(self) -> None:
        """Tell of publishers that cannot be heard, are too many, or have left."""
        for topic in self._topics:
            for reason in self._node.unheard(topic):
                self._warn(topic, f"a node cannot be heard, because it publishes {reason}")
        for topic in tuple(self._commanded):
            count = self._node.writers_of(topic)
            if count == 0:
                self._commanded.discard(topic)
                self._warn(topic, "the last node that commanded has left; the vehicle keeps its last command")
            elif count > 1:
                self._warn(topic, f"{count} nodes command; the newest command counts")

    def _warn(self, topic: Topic, sentence: str) -> None:
        self._context.warn_once(f"{topic.name}: {sentence} (frame {self._context.world.frame + 1})")


def _pedals_of(path: str) -> Topic:
    """The topic of commands as CARLA 0.9.16 has it; publishers of either reliability are heard, as in CARLA."""
    return control_of(path)._replace(is_reliable=False, depth=DEPTH)


def _motion_of(path: str) -> Topic:
    """The topic of Ackermann commands, as CARLA's publisher has it since 2026."""
    kind = "ackermann_msgs/msg/AckermannDriveStamped"
    return Topic(f"/carla/{path}/ackermann_control_cmd", kind, is_reliable=False, depth=DEPTH)
