"""Sensors: streams, topics of ROS 2, texts that they send, vehicles that they leave out.

Source of names: LibCarla 0.9.16.
"""

from linden.errors import Refusal
from linden.protocol.wire.decode import U32
from linden.protocol.wire.stream import Token
from linden.sensors.camera.cameras import CosmosCamera
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method
from linden.simulation.actor_table import ActorRefusal


@method("get_sensor_token")
def get_sensor_token(context: Context, stream_id: U32) -> Token:
    """Return where to subscribe to a stream."""
    return context.streams.token(stream_id)


@method("enable_sensor_for_ros")
def enable_sensor_for_ros(context: Context, stream_id: U32) -> None:
    """Publish a sensor on ROS 2 from now on, also without subscribers."""
    if context.publisher is None:
        raise Refusal(
            f"the sensor of stream {stream_id} is not published on ROS 2, because this server was started without "
            "--ros2; start it with `linden serve --ros2`, which needs: pip install linden-ros2"
        )
    for record in context.world.episode.actors:
        if record.stream_id == stream_id and stream_id:
            context.publisher.enable(record)
            return
    raise Refusal(f"no sensor of this episode has the stream {stream_id}, so nothing is published on ROS 2")


@method("disable_sensor_for_ros")
def disable_sensor_for_ros(context: Context, stream_id: U32) -> None:
    """Publish a sensor on ROS 2 no more, unless a client subscribes to it."""
    if context.publisher is not None:
        context.publisher.streams.discard(stream_id)


@method("is_sensor_enabled_for_ros")
def is_sensor_enabled_for_ros(context: Context, stream_id: U32) -> bool:
    """Whether a sensor is published on ROS 2 also without subscribers."""
    return context.publisher is not None and stream_id in context.publisher.streams


@method("send")
def send(context: Context, actor_id: U32, text: str) -> None:
    """Let a ``sensor.other.v2x_custom`` send a text in the next frame."""
    check_sensor(context, actor_id)
    context.world.sensors.radios.say(actor_id, text)


@method("set_ignored_vehicles")
def set_ignored_vehicles(context: Context, actor_id: U32, vehicle_ids: list[U32]) -> None:
    """Set which vehicles a sensor does not show; as in CARLA, ``sensor.camera.cosmos_visualization`` alone asks."""
    check_sensor(context, actor_id)
    for vehicle_id in vehicle_ids:
        if "vehicle" not in context.world.episode.actors.get(vehicle_id).description.id:
            raise ActorRefusal("Actor does not match the expected type", vehicle_id)
    looking = context.world.sensors.looking.get(actor_id)
    if looking is not None and isinstance(looking.sensor, CosmosCamera):
        looking.sensor.ignored = frozenset(vehicle_ids)
    elif vehicle_ids:
        context.warn_once(
            "set_ignored_vehicles: as in CARLA 0.9.16, only sensor.camera.cosmos_visualization leaves vehicles out; "
            "the other sensors go on seeing them"
        )


def check_sensor(context: Context, actor_id: int) -> None:
    """Refuse actors that are no sensors.

    Raises:
        ActorRefusal: there is no such actor, or it is no sensor.
    """
    if not context.world.episode.actors.get(actor_id).description.id.startswith("sensor."):
        raise ActorRefusal("Actor does not match the expected type", actor_id)
