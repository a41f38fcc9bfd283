"""The lamps of the streets, which ``carla.LightManager`` turns on and off. Source of names: LibCarla 0.9.16.

Every call names its client as ``host:port``, the same for all; nobody is told apart by it (:mod:`linden.scene.lamps`).
"""

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.values.enums import LightGroup
from linden.values.episode import LightState

_BRIGHTEST = 255


@method("query_lights_state")
def query_lights_state(context: Context, _client: str) -> tuple[LightState, ...]:
    """Return how all lamps stand."""
    return context.simulation.episode.surroundings.lamp_states()


@method("update_lights_state")
def update_lights_state(
    context: Context,
    _client: str,
    lights: list[LightState],
    _discard_client: bool,  # noqa: FBT001 - the wire's order
) -> None:
    """Change lamps; the next snapshots tell all clients to ask anew."""
    for light in lights:
        _check(light)
    unknown = context.simulation.episode.surroundings.lamps.update(lights)
    if unknown:
        context.warn_once(
            f"update_lights_state: no lamp has the id {unknown[0]} (get_all_lights lists those there are)"
        )


@method("update_day_night_cycle")
def update_day_night_cycle(context: Context, _client: str, active: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let the sun switch the lamps, or leave them to the clients."""
    episode = context.simulation.episode
    episode.surroundings.lamps.day_night_cycle = active
    episode.surroundings.lamps.follow_sun(episode.weather)


def _check(light: LightState) -> None:
    """Refuse what could not be sent back to other clients."""
    if not all(0 <= part <= _BRIGHTEST for part in light.color):
        raise Refusal(f"the colour of lamp {light.id} has parts from 0 to {_BRIGHTEST}, not {light.color}")
    if light.group not in tuple(LightGroup):
        raise Refusal(
            f"lamp {light.id} cannot belong to group {light.group}; groups are 0 none, 1 vehicle, 2 street, "
            f"3 building, 4 other"
        )
