"""What CARLA can do only because of Unreal or of what is compiled into its server, refused with what it would need.

Source of names and meanings: LibCarla 0.9.16 and ``CarlaServer.cpp``.
"""

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.wire.decode import U32
from linden.world.actors import ActorRefusal

_NO_GBUFFERS = (
    "g-buffers are textures inside Unreal's renderer, and this server has none; depth, normals and semantic tags come "
    "as images of their own from sensor.camera.depth, .normals and .semantic_segmentation"
)


@method("get_gbuffer_token")
def get_gbuffer_token(context: Context, actor_id: U32, _buffer: U32) -> bytes:
    """Refuse: g-buffers are textures inside Unreal's renderer."""
    _check_sensor(context, actor_id)
    raise Refusal(_NO_GBUFFERS)


@method("enable_gbuffers")
def enable_gbuffers(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Refuse to switch g-buffers on; off they are."""
    _check_sensor(context, actor_id)
    if enabled:
        raise Refusal(_NO_GBUFFERS)


@method("are_gbuffers_enabled")
def are_gbuffers_enabled(context: Context, actor_id: U32) -> bool:
    """Whether a sensor sends g-buffers: never."""
    _check_sensor(context, actor_id)
    return False


@method("enable_sensor_for_ros")
def enable_sensor_for_ros(_context: Context, stream_id: U32) -> None:
    """Refuse: the ROS 2 publisher is compiled into CARLA's server."""
    raise Refusal(
        f"the sensor of stream {stream_id} cannot publish to ROS 2 by itself: that publisher is compiled into CARLA's "
        f"own server (--ros2); a bridge that is an ordinary client, such as carla-ros-bridge, does it instead"
    )


@method("disable_sensor_for_ros")
def disable_sensor_for_ros(_context: Context, _stream_id: U32) -> None:
    """Stop a sensor's publishing to ROS 2: none does."""


@method("is_sensor_enabled_for_ros")
def is_sensor_enabled_for_ros(_context: Context, _stream_id: U32) -> bool:
    """Whether a sensor publishes to ROS 2 by itself: never."""
    return False


@method("send")
def send(context: Context, actor_id: U32, _text: str) -> None:
    """Refuse to send a message by radio: no actor is a radio."""
    _check_sensor(context, actor_id)
    raise Refusal(
        f"actor {actor_id} cannot send: only sensor.other.v2x_custom does, and it needs a model of the radio channel, "
        f"which this version has not"
    )


@method("set_ignored_vehicles")
def set_ignored_vehicles(context: Context, actor_id: U32, vehicle_ids: list[U32]) -> None:
    """Check which vehicles a sensor shall not show; in 0.9.16 the cosmos camera alone asks, and it is not here."""
    _check_sensor(context, actor_id)
    for vehicle_id in vehicle_ids:
        if "vehicle" not in context.simulation.episode.actors.get(vehicle_id).description.id:
            raise ActorRefusal("Actor does not match the expected type", vehicle_id)
    if vehicle_ids:
        context.warn_once(
            "set_ignored_vehicles: as in CARLA 0.9.16, only sensor.camera.cosmos_visualization would leave vehicles "
            "out; the sensors here go on seeing them"
        )


def _check_sensor(context: Context, actor_id: int) -> None:
    """Refuse whoever is no sensor.

    Raises:
        ActorRefusal: there is no such actor, or it is no sensor.
    """
    if not context.simulation.episode.actors.get(actor_id).description.id.startswith("sensor."):
        raise ActorRefusal("Actor does not match the expected type", actor_id)
