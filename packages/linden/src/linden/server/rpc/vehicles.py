"""Functions of vehicles: control, physics, lamps, doors, wheels. Source of names: LibCarla 0.9.16.

As in CARLA, a wheel's steering and pitch angles can be set only while the vehicle's physics is off, for otherwise the
physics moves the wheels.
"""

from linden.errors import Refusal
from linden.protocol.values.control import AckermannControl, AckermannSettings, VehiclePhysicsControl, VehicleTelemetry
from linden.protocol.values.space import Vector3D
from linden.protocol.wire.controls import ClientControl
from linden.protocol.wire.decode import U8, U32
from linden.protocol.wire.rpc import Packed, packed_result
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method
from linden.simulation.episode import Episode


@method("apply_control_to_vehicle")
def apply_control_to_vehicle(context: Context, actor_id: U32, control: ClientControl) -> None:
    """Set feet and hands of the driver; they stay until the next call."""
    episode = context.world.episode
    episode.bodies.set_control(episode.vehicle(actor_id), control)


@method("apply_ackermann_control_to_vehicle")
def apply_ackermann_control_to_vehicle(context: Context, actor_id: U32, control: AckermannControl) -> None:
    """Set a target motion that the vehicle's own controllers seek until the next call."""
    episode = context.world.episode
    episode.bodies.set_ackermann(episode.vehicle(actor_id), control)


@method("get_ackermann_controller_settings")
def get_ackermann_controller_settings(context: Context, actor_id: U32) -> AckermannSettings:
    """Return the gains of the controllers behind Ackermann control."""
    episode = context.world.episode
    return episode.bodies.ackermann_settings(episode.vehicle(actor_id))


@method("apply_ackermann_controller_settings")
def apply_ackermann_controller_settings(context: Context, actor_id: U32, settings: AckermannSettings) -> None:
    """Set the gains of the controllers behind Ackermann control."""
    episode = context.world.episode
    episode.bodies.set_ackermann_settings(episode.vehicle(actor_id), settings)


@method("get_physics_control")
def get_physics_control(context: Context, actor_id: U32) -> VehiclePhysicsControl:
    """Return engine, gears and wheels; wheel positions in cm in the world, friction that of a trigger inside one."""
    bodies = context.world.episode.bodies
    slot = context.world.episode.vehicle(actor_id)
    control = bodies.physics_control(slot)
    here = float(bodies.friction_here[slot])
    if here < 0.0:
        return control
    return control._replace(wheels=tuple(wheel._replace(tire_friction=here) for wheel in control.wheels))


@method("apply_physics_control")
def apply_physics_control(context: Context, actor_id: U32, control: VehiclePhysicsControl) -> None:
    """Replace engine, gears and wheels; the wheels stay where they are, whatever their positions say (as in CARLA)."""
    episode = context.world.episode
    slot = episode.vehicle(actor_id)
    wheels = tuple(wheel._replace(position=Vector3D()) for wheel in control.wheels)
    episode.bodies.set_physics_control(slot, control._replace(wheels=wheels))
    context.world.recorder.physics_changed(actor_id)
    episode.bodies.friction_here[slot] = -1.0
    if control.use_sweep_wheel_collision:
        context.warn_once("use_sweep_wheel_collision is kept and has no effect: a wheel meets the ground at one point")


@method("get_telemetry_data")
def get_telemetry_data(context: Context, actor_id: U32) -> VehicleTelemetry:
    """Return what moves the vehicle now."""
    episode = context.world.episode
    return episode.bodies.telemetry(episode.vehicle(actor_id))


@method("get_vehicle_light_state")
def get_vehicle_light_state(context: Context, actor_id: U32) -> tuple[int, ...]:
    """Return the lamps that are lit, as bits of VehicleLightState."""
    episode = context.world.episode
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
    episode = context.world.episode
    episode.vehicle(actor_id)
    episode.actors.set_lamps(actor_id, bits)


@method("get_vehicle_light_states")
def get_vehicle_light_states(context: Context) -> Packed:
    """Return (id, lamps) of every vehicle."""
    lamps = context.world.episode.actors.lamps()
    if context.lamps is None or context.lamps[0] is not lamps:
        context.lamps = lamps, packed_result(lamps)
    return context.lamps[1]


@method("set_actor_autopilot")
def set_actor_autopilot(context: Context, actor_id: U32, enabled: bool) -> None:  # noqa: FBT001 - the wire's order
    """Take note of a vehicle's autopilot: it is driven by the Traffic Manager of the client that set it."""
    episode = context.world.episode
    episode.bodies.set_autopilot(episode.vehicle(actor_id), on=enabled)


@method("open_vehicle_door")
def open_vehicle_door(context: Context, actor_id: U32, door: U8) -> None:
    """Open a door, or with 6 all of them; an open door takes no space."""
    _swing(context, actor_id, door, opens=True)


@method("close_vehicle_door")
def close_vehicle_door(context: Context, actor_id: U32, door: U8) -> None:
    """Close a door, or with 6 all of them."""
    _swing(context, actor_id, door, opens=False)


def _swing(context: Context, actor_id: int, door: int, *, opens: bool) -> None:
    episode = context.world.episode
    episode.vehicle(actor_id)
    episode.doors.swing(episode.actors.get(actor_id), door, opens=opens)


@method("get_wheel_steer_angle")
def get_wheel_steer_angle(context: Context, actor_id: U32, wheel: U8) -> float:
    """Return a wheel's steering angle in degrees, positive to the right; without physics the one that was set."""
    episode = context.world.episode
    return episode.bodies.wheel_steer_deg(_slot(episode, actor_id, wheel), wheel)


@method("set_wheel_steer_direction")
def set_wheel_steer_direction(context: Context, actor_id: U32, wheel: U8, angle_deg: float) -> None:
    """Let a wheel of a vehicle without physics point somewhere: for the eye only."""
    episode = context.world.episode
    slot = _still_slot(episode, actor_id, wheel, "wheel steer direction")
    episode.bodies.point_wheel(slot, wheel, angle_deg)


@method("get_wheel_pitch_angle")
def get_wheel_pitch_angle(context: Context, actor_id: U32, wheel: U8) -> float:
    """Return how far a wheel has rolled, in degrees from -180 to 180; forward is negative, as Unreal has it."""
    episode = context.world.episode
    return episode.bodies.wheel_pitch_deg(_slot(episode, actor_id, wheel), wheel)


@method("set_wheel_pitch_angle")
def set_wheel_pitch_angle(context: Context, actor_id: U32, wheel: U8, angle_deg: float) -> None:
    """Turn a wheel of a vehicle without physics about its axle: for the eye only."""
    episode = context.world.episode
    slot = _still_slot(episode, actor_id, wheel, "wheel pitch angle")
    episode.bodies.roll_wheel(slot, wheel, angle_deg)


def _slot(episode: Episode, actor_id: int, wheel: int) -> int:
    slot = episode.vehicle(actor_id)
    wheels = int(episode.bodies.spec(slot)["wheel_count"])
    if wheel >= wheels:
        raise Refusal(f"vehicle {actor_id} has no wheel {wheel}; its wheels are 0 to {wheels - 1}")
    return slot


def _still_slot(episode: Episode, actor_id: int, wheel: int, what: str) -> int:
    slot = _slot(episode, actor_id, wheel)
    if episode.bodies.simulate[slot]:
        raise Refusal(
            f"Cannot set {what}. Physics are enabled: they turn the wheels of vehicle {actor_id}; call "
            f"set_simulate_physics(False) first"
        )
    return slot
