"""Traffic lights: colours, times, groups. Source of names: LibCarla 0.9.16."""

from linden.errors import Refusal
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.wire.decode import U8, U32
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method


@method("set_traffic_light_state")
def set_traffic_light_state(context: Context, actor_id: U32, state: U8) -> None:
    """Show a colour; the cycle goes on from it unless the light is frozen."""
    if state not in tuple(TrafficLightState):
        raise Refusal(
            f"a traffic light has no state {state}; the states are 0 red, 1 yellow, 2 green, 3 off, 4 unknown"
        )
    episode = context.world.episode
    episode.traffic.set_colour(episode.light(actor_id), TrafficLightState(state))


@method("set_traffic_light_green_time")
def set_traffic_light_green_time(context: Context, actor_id: U32, seconds: float) -> None:
    """Set how long green lasts."""
    _set_time(context, actor_id, TrafficLightState.GREEN, seconds)


@method("set_traffic_light_yellow_time")
def set_traffic_light_yellow_time(context: Context, actor_id: U32, seconds: float) -> None:
    """Set how long yellow lasts."""
    _set_time(context, actor_id, TrafficLightState.YELLOW, seconds)


@method("set_traffic_light_red_time")
def set_traffic_light_red_time(context: Context, actor_id: U32, seconds: float) -> None:
    """Set how long all lights of the group are red between two turns."""
    _set_time(context, actor_id, TrafficLightState.RED, seconds)


def _set_time(context: Context, actor_id: int, state: TrafficLightState, seconds: float) -> None:
    episode = context.world.episode
    episode.traffic.set_time(episode.light(actor_id), state, seconds)


@method("freeze_traffic_light")
def freeze_traffic_light(context: Context, actor_id: U32, freeze: bool) -> None:  # noqa: FBT001 - the wire's order
    """Stop the clock of a light's group, or let it go on."""
    episode = context.world.episode
    episode.traffic.freeze(episode.light(actor_id), frozen=freeze)


@method("freeze_all_traffic_lights")
def freeze_all_traffic_lights(context: Context, freeze: bool) -> None:  # noqa: FBT001 - the wire's order
    """Stop the clocks of all lights, or let them go on."""
    context.world.episode.traffic.freeze_all(frozen=freeze)


@method("reset_traffic_light_group")
def reset_traffic_light_group(context: Context, actor_id: U32) -> None:
    """Begin the cycle of a light's group anew."""
    episode = context.world.episode
    episode.traffic.reset_group(episode.light(actor_id))


@method("reset_all_traffic_lights")
def reset_all_traffic_lights(context: Context) -> None:
    """Begin all cycles anew."""
    context.world.episode.traffic.reset_all()


@method("get_group_traffic_lights")
def get_group_traffic_lights(context: Context, actor_id: U32) -> list[int]:
    """Return the ids of the lights that take turns with this one, its own among them."""
    episode = context.world.episode
    return [episode.light_ids[light] for light in episode.traffic.group(episode.light(actor_id))]
