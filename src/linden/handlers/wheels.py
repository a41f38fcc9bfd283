"""The wheels as they are seen: which way they point, how far they have rolled. Source of names: LibCarla 0.9.16.

As in CARLA they can be set only while the vehicle's physics is off, for otherwise the physics moves them.
"""

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.simulation.episode import Episode
from linden.wire.decode import U8, U32


@method("get_wheel_steer_angle")
def get_wheel_steer_angle(context: Context, actor_id: U32, wheel: U8) -> float:
    """Return a wheel's steering angle in degrees, positive to the right; without physics the one that was set."""
    episode = context.simulation.episode
    return episode.bodies.wheel_steer_deg(_slot(episode, actor_id, wheel), wheel)


@method("set_wheel_steer_direction")
def set_wheel_steer_direction(context: Context, actor_id: U32, wheel: U8, angle_deg: float) -> None:
    """Let a wheel of a vehicle without physics point somewhere: for the eye only."""
    episode = context.simulation.episode
    slot = _still_slot(episode, actor_id, wheel, "wheel steer direction")
    episode.bodies.point_wheel(slot, wheel, angle_deg)


@method("get_wheel_pitch_angle")
def get_wheel_pitch_angle(context: Context, actor_id: U32, wheel: U8) -> float:
    """Return how far a wheel has rolled, in degrees from -180 to 180; forward is negative, as Unreal has it."""
    episode = context.simulation.episode
    return episode.bodies.wheel_pitch_deg(_slot(episode, actor_id, wheel), wheel)


@method("set_wheel_pitch_angle")
def set_wheel_pitch_angle(context: Context, actor_id: U32, wheel: U8, angle_deg: float) -> None:
    """Turn a wheel of a vehicle without physics about its axle: for the eye only."""
    episode = context.simulation.episode
    slot = _still_slot(episode, actor_id, wheel, "wheel pitch angle")
    episode.bodies.roll_wheel(slot, wheel, angle_deg)


def _slot(episode: Episode, actor_id: int, wheel: int) -> int:
    slot = episode.vehicle(actor_id)
    wheels = int(episode.bodies.specs["wheel_count"][slot])
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
