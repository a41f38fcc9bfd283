"""Velocities of vehicles that a client puts to their places, such as SUMO's: the simulator gives them none.

CARLA's ``get_velocity`` is zero for a vehicle without physics, also while a client moves it. Its places in successive
frames show its motion.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import carla

FASTEST_MPS = 60.0
"""A change of place that means more is a jump to another place, and no motion."""


class PlanarMotion(NamedTuple):
    """A vehicle's motion in the plane, CARLA's world frame."""

    velocity_x_mps: float
    velocity_y_mps: float
    yaw_rate_radps: float


class _Seen(NamedTuple):
    """A vehicle in one frame, and its motion since the frame before."""

    t_s: float
    x_m: float
    y_m: float
    yaw_rad: float
    motion: PlanarMotion


AT_REST = PlanarMotion(0.0, 0.0, 0.0)


class PlacedMotion:
    """The motion of vehicles, frame by frame: the simulator's, or that of their places where it has none."""

    def __init__(self) -> None:
        self._seen: dict[int, _Seen] = {}

    def of(self, actor: carla.ActorSnapshot, pose: carla.Transform, t_s: float) -> PlanarMotion:
        """Return the motion of a vehicle in the frame of simulated time ``t_s``; at rest in its first frame."""
        own = own_motion(actor)
        if own.velocity_x_mps != 0.0 or own.velocity_y_mps != 0.0:
            self._seen.pop(actor.id, None)
            return own
        before = self._seen.get(actor.id)
        if before is not None and before.t_s == t_s:
            return before.motion
        at, yaw_rad = pose.location, math.radians(pose.rotation.yaw)
        motion = AT_REST if before is None else _between(before, t_s, at.x, at.y, yaw_rad)
        self._seen[actor.id] = _Seen(t_s, at.x, at.y, yaw_rad, motion)
        return motion


def own_motion(actor: carla.ActorSnapshot) -> PlanarMotion:
    """The motion that the simulator tells."""
    velocity = actor.get_velocity()
    return PlanarMotion(velocity.x, velocity.y, math.radians(actor.get_angular_velocity().z))


def _between(before: _Seen, t_s: float, x_m: float, y_m: float, yaw_rad: float) -> PlanarMotion:
    """The motion from one frame to the next."""
    since_s = t_s - before.t_s
    if since_s <= 0.0:  # a new episode
        return AT_REST
    turned_rad = math.remainder(yaw_rad - before.yaw_rad, math.tau)
    motion = PlanarMotion((x_m - before.x_m) / since_s, (y_m - before.y_m) / since_s, turned_rad / since_s)
    return motion if math.hypot(motion.velocity_x_mps, motion.velocity_y_mps) <= FASTEST_MPS else AT_REST
