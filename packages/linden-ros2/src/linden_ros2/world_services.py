"""`WorldServices`: services of CARLA's ros-bridge on a server's world, and its topic of the weather.

Names and types are the ros-bridge's (carla_ros_bridge/bridge.py), so that its users' programs call them unchanged.
"""

import contextlib
import fnmatch
import math
import random
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.server.rpc import actors, scene
from linden_ros2 import frames
from linden_ros2.names import is_usable
from linden_ros2.rtps_services import Request, Service
from linden_ros2.topic import Topic

if TYPE_CHECKING:
    from linden.server.frame_clock import FrameClock
    from linden.server.rpc.context import Context
    from linden.simulation.actor_table import ActorRecord
    from linden_ros2.dds_node import DdsNode
    from linden_ros2.rtps_services import ServiceParticipant

SPAWN = Service("/carla/spawn_object", "carla_msgs/srv/SpawnObject")
DESTROY = Service("/carla/destroy_object", "carla_msgs/srv/DestroyObject")
BLUEPRINTS = Service("/carla/get_blueprints", "carla_msgs/srv/GetBlueprints")
SERVICES = (SPAWN, DESTROY, BLUEPRINTS)
WEATHER = Topic("/carla/weather_control", "carla_msgs/msg/CarlaWeatherParameters", is_reliable=False)
"""The ros-bridge's topic; publishers of either reliability are heard."""
FAILED = -1
"""The id in the answer where nothing was spawned."""
RANDOM_SEED = 0
SHORTEST = 1e-6


class WorldServices:
    """Answers requests at once, without waiting for a frame, and sets the weather before a frame."""

    def __init__(self, context: "Context", node: "DdsNode", participant: "ServiceParticipant") -> None:
        self._context, self._node, self._participant = context, node, participant
        self._random = random.Random(RANDOM_SEED)  # noqa: S311 - no secret
        self._answers: dict[Service, Callable[[Any], dict[str, Any]]] = {
            SPAWN: self._spawn,
            DESTROY: self._destroy,
            BLUEPRINTS: self._blueprints,
        }
        node.listen(WEATHER)

    def read(self, _clock: "FrameClock") -> bool:
        """Answer all requests that have arrived."""
        for request in self._participant.arrived():
            self._answer(request)
        return True

    def before_frame(self) -> None:
        """Set the newest weather that has arrived."""
        try:
            messages = self._node.received(WEATHER)
        except Exception as error:  # noqa: BLE001 - rosbags raises errors of all kinds on foreign bytes
            self._context.warn_once(
                f"{WEATHER.name}: a message is refused, because its bytes are no {WEATHER.type} ({error!r})"
            )
            return
        if not messages:
            return
        names = [name for name, _ in self._node.types.store.fielddefs[WEATHER.type][1]]
        values = {name: float(getattr(messages[-1], name)) for name in names}
        for name, value in values.items():
            if not math.isfinite(value):
                self._context.warn_once(
                    f"{WEATHER.name}: a message is refused, because its {name} is {value}; it must be a finite number"
                )
                return
        scene.set_weather_parameters(self._context, self._context.world.episode.weather._replace(**values))

    def _answer(self, request: Request) -> None:
        """Answer a request; bytes that are no request of its type get no answer, since no answer would fit."""
        service, types = request.service, self._node.types
        try:
            asked = types.parsed(request.payload, f"{service.type}_Request")
        except Exception as error:  # noqa: BLE001 - as above
            self._context.warn_once(
                f"{service.name}: a request is not answered, because its bytes are no {service.type} ({error!r})"
            )
            return
        reply = types.message(f"{service.type}_Response", **self._answers[service](asked))
        self._participant.reply(request, bytes(types.data(reply)))

    def _blueprints(self, asked: Any) -> dict[str, Any]:  # noqa: ANN401 - a message
        """Return the ids of blueprints that a pattern matches; an empty pattern matches all."""
        return {"blueprints": self._matching(asked.filter or "*")}

    def _matching(self, pattern: str) -> list[str]:
        ids = (blueprint.definition.id for blueprint in self._context.world.library)
        return [each for each in ids if fnmatch.fnmatchcase(each, pattern)]

    def _destroy(self, asked: Any) -> dict[str, Any]:  # noqa: ANN401 - a message
        """Destroy an actor and what is attached to it, as the ros-bridge does."""
        try:
            self._destroy_with_attached(asked.id)
        except Refusal as refusal:
            self._context.warn_once(f"{DESTROY.name}: {refusal}")
            return {"success": False}
        self._context.frame_is_due = True
        return {"success": True}

    def _destroy_with_attached(self, actor_id: int) -> None:
        """Destroy an actor and all that is attached to it; a client's call leaves the attached actors in the world.

        Raises:
            Refusal: there is none of that id, or it belongs to the map.
        """
        attached = [each.id for each in self._context.world.episode.actors.children(actor_id)]
        self._context.world.destroy(actor_id)
        for each in attached:
            self._destroy_with_attached(each)

    def _spawn(self, asked: Any) -> dict[str, Any]:  # noqa: ANN401 - a message
        """Spawn an actor; a sensor is published from now on."""
        try:
            return {"id": self._spawned(asked).id, "error_string": ""}
        except Refusal as refusal:
            self._context.warn_once(f"{SPAWN.name}: {refusal}")
            return {"id": FAILED, "error_string": str(refusal)}

    def _spawned(self, asked: Any) -> "ActorRecord":  # noqa: ANN401 - a message
        """Spawn an actor.

        Raises:
            Refusal: it cannot be spawned, or is a sensor without a topic.
        """
        kind = self._kind_of(asked)
        given = {each.key: each.value for each in asked.attributes}
        known = {each.id for each in self._context.world.library.find(kind).definition.attributes}
        if asked.id and not is_usable(asked.id):
            raise Refusal(
                f"the id '{asked.id}' cannot be part of a topic's name; use letters, digits and _, beginning with a "
                "letter"
            )
        for name in ("role_name", "ros_name"):
            if asked.id and name in known:
                given.setdefault(name, asked.id)
        values = tuple(AttributeValue(name, AttributeType.STRING, value) for name, value in given.items())
        description = ActorDescription(0, kind, values)
        if asked.random_pose:
            record = self._anywhere(description)
        else:
            record = actors.attach(self._context, description, _transform(asked.transform), asked.attach_to, "")
        if record.stream_id and self._context.publisher is not None:
            try:
                self._context.publisher.enable(record)
            except Refusal:
                self._context.world.destroy(record.id)
                raise
        return record

    def _kind_of(self, asked: Any) -> str:  # noqa: ANN401 - a message
        """The blueprint that a request asks for; of a pattern, one that it matches.

        Raises:
            Refusal: there is none.
        """
        if ".pseudo." in asked.type:
            raise Refusal(
                f"'{asked.type}' is a part of the ros-bridge and no blueprint; this server publishes /clock, /tf and "
                "sensors, and moves vehicles by /carla/NAME/vehicle_control_cmd and /carla/NAME/ackermann_control_cmd"
            )
        if "*" not in asked.type:
            return str(asked.type)
        matching = self._matching(asked.type)
        if not matching:
            raise Refusal(f"no blueprint matches '{asked.type}'; see {BLUEPRINTS.name}")
        return self._random.choice(matching)

    def _anywhere(self, description: ActorDescription) -> "ActorRecord":
        """Spawn an actor at a spawn point that is free.

        Raises:
            Refusal: none is, or the actor cannot be spawned.
        """
        points = list(self._context.world.spawn_points)
        self._random.shuffle(points)
        if not points:
            raise Refusal("this map has no spawn points; ask for a transform in place of random_pose")
        for point in points[:-1]:
            with contextlib.suppress(Refusal):  # something stands there
                return actors.attach(self._context, description, point, 0, "")
        return actors.attach(self._context, description, points[-1], 0, "")


def _transform(pose: Any) -> Transform:  # noqa: ANN401 - a message
    """A pose of ROS in CARLA's axes.

    Raises:
        Refusal: a value is no number, or the orientation is no rotation.
    """
    place = (pose.position.x, pose.position.y, pose.position.z)
    turn = (pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w)
    if not all(map(math.isfinite, (*place, *turn))):
        raise Refusal("the transform has a value that is no finite number")
    if math.hypot(*turn) < SHORTEST:
        raise Refusal("the transform's orientation is no rotation: all its values are 0; w is 1 for no rotation")
    roll, pitch, yaw = map(math.degrees, frames.angles(turn))
    return Transform(Vector3D(*frames.vector(*place)), Rotation(pitch, yaw, roll))
