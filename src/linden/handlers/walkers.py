"""Walkers: how they go. Source of names: LibCarla 0.9.16."""

import math

from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.values.space import Transform, Vector3D
from linden.values.walkers import WalkerControl
from linden.wire.decode import U32


@method("apply_control_to_walker")
def apply_control_to_walker(context: Context, actor_id: U32, control: WalkerControl) -> None:
    """Set where a walker goes; it holds until the next call."""
    episode = context.simulation.episode
    episode.bodies.set_walker_control(episode.walker(actor_id), control)


def apply_walker_state(context: Context, actor_id: int, pose: Transform, speed_mps: float) -> None:
    """Put a walker onto its navigation mesh, going on at ``speed_mps``: z is that of the surface under its feet."""
    episode = context.simulation.episode
    slot = episode.walker(actor_id)
    half_height_m = episode.actors.get(actor_id).box.extent.z
    x_m, y_m, z_m = pose.location
    episode.bodies.set_pose(slot, pose._replace(location=Vector3D(x_m, y_m, z_m + half_height_m)))
    yaw_rad = math.radians(pose.rotation.yaw)
    direction = Vector3D(math.cos(yaw_rad), math.sin(yaw_rad), 0.0)
    episode.bodies.set_walker_control(slot, WalkerControl(direction, speed_mps))
