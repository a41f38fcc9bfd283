"""Functions that CARLA can offer only because of Unreal or its build; they are refused with a reason.

Source of names and meanings: LibCarla 0.9.16 and ``CarlaServer.cpp``.
"""

from linden.errors import Refusal
from linden.protocol.wire.decode import U32, U64
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method
from linden.server.rpc.sensors import check_sensor

_NO_GBUFFERS = (
    "g-buffers are textures inside Unreal's renderer, and this server has none; depth, normals and semantic tags come "
    "as images of their own from sensor.camera.depth, .normals and .semantic_segmentation"
)


@method("get_gbuffer_token")
def get_gbuffer_token(context: Context, actor_id: U32, _buffer: U32) -> bytes:
    """Refuse: g-buffers are textures inside Unreal's renderer."""
    check_sensor(context, actor_id)
    raise Refusal(_NO_GBUFFERS)


@method("enable_gbuffers")
def enable_gbuffers(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Refuse to enable g-buffers; accept a call that disables them."""
    check_sensor(context, actor_id)
    if enabled:
        raise Refusal(_NO_GBUFFERS)


@method("are_gbuffers_enabled")
def are_gbuffers_enabled(context: Context, actor_id: U32) -> bool:
    """Whether a sensor sends g-buffers: never."""
    check_sensor(context, actor_id)
    return False


@method("enable_carsim")
def enable_carsim(context: Context, actor_id: U32, _simfile: str) -> None:
    """Refuse: CarSim is a commercial program that CARLA reaches through a plugin of Unreal's."""
    context.world.episode.vehicle(actor_id)
    raise Refusal(
        "CarSim is not here: it would need the VehicleSim library of Mechanical Simulation and a licence; vehicle "
        f"{actor_id} goes on with linden's own physics"
    )


@method("use_carsim_road")
def use_carsim_road(context: Context, actor_id: U32, _enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Refuse: there is no CarSim, and so no road of its."""
    context.world.episode.vehicle(actor_id)
    raise Refusal(
        "CarSim is not here, nor are its roads: it would need the VehicleSim library of Mechanical Simulation and a "
        f"licence; vehicle {actor_id} drives on the map"
    )


@method("enable_chrono_physics")
def enable_chrono_physics(
    context: Context,
    actor_id: U32,
    _substeps: U64,
    _substep_s: float,
    _vehicle_json: str,
    _powertrain_json: str,
    _tire_json: str,
    _folder: str,
) -> None:
    """Refuse: Project Chrono would have to be compiled in."""
    context.world.episode.vehicle(actor_id)
    raise Refusal(
        "Chrono is not here: it would need the Project Chrono vehicle library (CARLA has it only if built with "
        f"ARGS=--chrono); vehicle {actor_id} goes on with linden's own physics"
    )


@method("restore_physx_physics")
def restore_physx_physics(context: Context, actor_id: U32) -> None:
    """Accept: a vehicle never leaves the server's own physics, so it has what is to be restored."""
    context.world.episode.vehicle(actor_id)


@method("show_vehicle_debug_telemetry")
def show_vehicle_debug_telemetry(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Refuse to show, for there is no spectator window; not to show is what happens anyway."""
    context.world.episode.vehicle(actor_id)
    if enabled:
        raise Refusal(
            f"the telemetry of vehicle {actor_id} cannot be drawn: this server has no spectator window; "
            "vehicle.get_telemetry_data() returns the same figures"
        )
