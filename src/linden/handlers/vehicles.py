"""Vehicles: how they are driven, what they are made of, their lamps. Source of names: LibCarla 0.9.16."""

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.values.space import Vector3D
from linden.values.vehicles import (
    AckermannControl,
    AckermannSettings,
    VehiclePhysicsControl,
    VehicleTelemetry,
)
from linden.wire.controls import ClientControl
from linden.wire.decode import U32


@method("apply_control_to_vehicle")
def apply_control_to_vehicle(context: Context, actor_id: U32, control: ClientControl) -> None:
    """Set feet and hands of the driver; they stay until the next call."""
    episode = context.simulation.episode
    episode.bodies.set_control(episode.vehicle(actor_id), control)


@method("apply_ackermann_control_to_vehicle")
def apply_ackermann_control_to_vehicle(context: Context, actor_id: U32, control: AckermannControl) -> None:
    """Set a target motion that the vehicle's own controllers seek until the next call."""
    episode = context.simulation.episode
    episode.bodies.set_ackermann(episode.vehicle(actor_id), control)


@method("get_ackermann_controller_settings")
def get_ackermann_controller_settings(context: Context, actor_id: U32) -> AckermannSettings:
    """Return the gains of the controllers behind Ackermann control."""
    episode = context.simulation.episode
    return episode.bodies.ackermann_settings(episode.vehicle(actor_id))


@method("apply_ackermann_controller_settings")
def apply_ackermann_controller_settings(context: Context, actor_id: U32, settings: AckermannSettings) -> None:
    """Set the gains of the controllers behind Ackermann control."""
    episode = context.simulation.episode
    episode.bodies.set_ackermann_settings(episode.vehicle(actor_id), settings)


@method("get_physics_control")
def get_physics_control(context: Context, actor_id: U32) -> VehiclePhysicsControl:
    """Return engine, gears and wheels; wheel positions in cm in the world, friction that of a trigger inside one."""
    bodies = context.simulation.episode.bodies
    slot = context.simulation.episode.vehicle(actor_id)
    control = bodies.physics_control(slot)
    here = float(bodies.friction_here[slot])
    if here < 0.0:
        return control
    return control._replace(wheels=tuple(wheel._replace(tire_friction=here) for wheel in control.wheels))


@method("apply_physics_control")
def apply_physics_control(context: Context, actor_id: U32, control: VehiclePhysicsControl) -> None:
    """Replace engine, gears and wheels; the wheels stay where they are, whatever their positions say (as in CARLA)."""
    episode = context.simulation.episode
    slot = episode.vehicle(actor_id)
    wheels = tuple(wheel._replace(position=Vector3D()) for wheel in control.wheels)
    episode.bodies.set_physics_control(slot, control._replace(wheels=wheels))
    context.simulation.recorder.physics_changed(actor_id)
    episode.bodies.friction_here[slot] = -1.0
    if control.use_sweep_wheel_collision:
        context.warn_once("use_sweep_wheel_collision is kept and has no effect: a wheel meets the ground at one point")


@method("get_telemetry_data")
def get_telemetry_data(context: Context, actor_id: U32) -> VehicleTelemetry:
    """Return what moves the vehicle now."""
    episode = context.simulation.episode
    return episode.bodies.telemetry(episode.vehicle(actor_id))


@method("get_vehicle_light_state")
def get_vehicle_light_state(context: Context, actor_id: U32) -> tuple[int, ...]:
    """Return the lamps that are lit, as bits of VehicleLightState."""
    episode = context.simulation.episode
    episode.vehicle(actor_id)
    return (episode.actors.get(actor_id).light_state,)


@method("set_vehicle_light_state")
def set_vehicle_light_state(context: Context, actor_id: U32, state: tuple[U32, ...]) -> None:
    """Switch lamps, as bits of VehicleLightState in an array of one."""
    if len(state) != 1:
        raise Refusal(f"set_vehicle_light_state: expected one number of light bits, got {len(state)}")
    set_light_bits(context, actor_id, state[0])


def set_light_bits(context: Context, actor_id: int, bits: int) -> None:
    """Switch lamps, as bits of VehicleLightState."""
    episode = context.simulation.episode
    episode.vehicle(actor_id)
    episode.actors.set_lamps(actor_id, bits)


@method("get_vehicle_light_states")
def get_vehicle_light_states(context: Context) -> list[tuple[int, int]]:
    """Return (id, lamps) of every vehicle."""
    return context.simulation.episode.actors.lamps()


@method("set_actor_autopilot")
def set_actor_autopilot(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Take note of a vehicle's autopilot: it is driven by the Traffic Manager of the client that set it."""
    episode = context.simulation.episode
    episode.bodies.set_autopilot(episode.vehicle(actor_id), on=enabled)
