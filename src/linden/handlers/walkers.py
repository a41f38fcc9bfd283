"""Walkers: how they go. Source of names: LibCarla 0.9.16."""

from collections.abc import Sequence

import numpy as np

from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.values.space import Transform
from linden.values.walkers import WalkerControl
from linden.wire.decode import U32


@method("apply_control_to_walker")
def apply_control_to_walker(context: Context, actor_id: U32, control: WalkerControl) -> None:
    """Set where a walker goes; it holds until the next call."""
    episode = context.simulation.episode
    slot = episode.walker(actor_id)
    episode.walkers.refuse_dead(actor_id)
    episode.bodies.set_walker_control(slot, control)


def apply_walker_state(context: Context, actor_id: int, pose: Transform, speed_mps: float) -> None:
    """Put a walker onto its navigation mesh, going on at ``speed_mps``: z is that of the surface under its feet."""
    lead(context, [(actor_id, pose, speed_mps)])


def lead(context: Context, states: Sequence[tuple[int, Transform, float]]) -> None:
    """Put walkers onto the mesh: what a client that has AI controllers sends every tick.

    Raises:
        ActorRefusal: one of them is none, or dead; then none is moved.
    """
    episode = context.simulation.episode
    for actor_id, _, _ in states:
        episode.walker(actor_id)
        episode.walkers.refuse_dead(actor_id)
    speeds_mps = np.array([speed_mps for _, _, speed_mps in states])
    episode.walkers.lead(episode, [state[0] for state in states], [state[1] for state in states], speeds_mps)


@method("set_actor_dead")
def set_actor_dead(context: Context, actor_id: U32) -> None:
    """Let a walker fall and lie for ten seconds, then go; the client's crowd says so of those that a vehicle caught."""
    episode = context.simulation.episode
    episode.walkers.die(episode, actor_id)
