"""Doors of vehicles. Source of names: LibCarla 0.9.16."""

from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.wire.decode import U8, U32


@method("open_vehicle_door")
def open_vehicle_door(context: Context, actor_id: U32, door: U8) -> None:
    """Open a door, or with 6 all of them; an open door takes no space."""
    _swing(context, actor_id, door, opens=True)


@method("close_vehicle_door")
def close_vehicle_door(context: Context, actor_id: U32, door: U8) -> None:
    """Close a door, or with 6 all of them."""
    _swing(context, actor_id, door, opens=False)


def _swing(context: Context, actor_id: int, door: int, *, opens: bool) -> None:
    episode = context.simulation.episode
    episode.vehicle(actor_id)
    episode.doors.swing(episode.actors.get(actor_id), door, opens=opens)
