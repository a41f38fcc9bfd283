"""A controller for CARLA's ScenarioRunner, which moves an actor along a trajectory at its times.

``basu scenario export --for scenario-runner`` writes this file beside the case. ScenarioRunner imports it from there,
without BASU. Its own controllers leave out the times for pedestrians, and end with an error after the last one.
"""

from __future__ import annotations

import bisect
import math
from typing import TYPE_CHECKING

import carla

if TYPE_CHECKING:
    from collections.abc import Sequence

COLLISIONS = "collisions"
"""The property of the controller with which others pass through the actor, if its value is "false"."""
COLLISIONS_END = "collisions_end_at"
"""The property with the place, "x,y" in m, from which on they and scenery do so: the trajectory leaves the roads."""
REACH_M = 1.0
"""An actor so near to a place is there."""
SPARE_MPS = 2.0
"""How much faster than the trajectory an actor may come back to it, so that one that was blocked does not jump."""

LEAST_M = 0.01
"""A walker is not moved besides if it would be off by no more."""


class TimedTrajectory:
    """Gives an actor the velocity with which the next frame finds it where the trajectory is then.

    ScenarioRunner calls its methods, which are those of the base class of its own controllers.
    """

    def __init__(self, actor: carla.Actor, arguments: dict[str, str] | None = None) -> None:
        """Take the actor; it stands until there is a trajectory."""
        self._actor = actor
        arguments = arguments or {}
        if arguments.get(COLLISIONS) == "false":
            actor.set_collisions(False)
        self._collides_to = [float(value) for value in arguments.get(COLLISIONS_END, "").split(",") if value]
        self._places: list[carla.Transform] = []
        self._times_s: list[float] = []
        self._begin_s = 0.0

    def update_waypoints(self, waypoints: Sequence[carla.Transform], times: Sequence[float] | None = None) -> None:
        """Begin a trajectory now.

        Args:
            waypoints: its places, in CARLA's axes.
            times: when the actor is there, in s from now.

        Raises:
            ValueError: there are no times.
        """
        if not times:
            raise ValueError("the controller timed_trajectory needs a trajectory with times")
        self._places, self._times_s = list(waypoints), list(times)
        self._begin_s = self._now_s()

    def update_target_speed(self, speed: float) -> None:
        """Leave a speed out: the times say how fast it is."""

    def update_offset(self, offset: float) -> None:
        """Leave an offset out: the places say where it is."""

    def set_init_speed(self) -> None:
        """Leave the first speed out, likewise."""

    def check_reached_waypoint_goal(self) -> bool:
        """Return whether the trajectory is over."""
        return bool(self._times_s) and self._now_s() - self._begin_s >= self._times_s[-1]

    def reset(self) -> None:
        """Forget the trajectory."""
        self._places, self._times_s = [], []

    def run_step(self) -> None:
        """Move the actor through the next frame."""
        if not self._actor.is_alive:
            return
        frame_s = self._actor.get_world().get_snapshot().timestamp.delta_seconds
        here = self._actor.get_transform()
        if self._collides_to and math.dist(self._collides_to, (here.location.x, here.location.y)) < REACH_M:
            self._actor.set_collisions(False)
            self._collides_to = []
        elapsed_s = self._now_s() - self._begin_s
        x_m, y_m, _ = self._place(elapsed_s, here)
        next_x_m, next_y_m, next_yaw_deg = self._place(elapsed_s + frame_s, here)
        ahead_m, aside_m = next_x_m - here.location.x, next_y_m - here.location.y
        speed_mps = math.hypot(ahead_m, aside_m) / frame_s
        most_mps = math.hypot(next_x_m - x_m, next_y_m - y_m) / frame_s + SPARE_MPS
        share = min(1.0, most_mps / speed_mps) if speed_mps else 0.0
        turn_deg = (next_yaw_deg - here.rotation.yaw + 180.0) % 360.0 - 180.0
        if self._actor.type_id.startswith("walker."):
            self._walk(share * ahead_m, share * aside_m, frame_s, here)
        elif self._actor.type_id.startswith("vehicle."):
            up_mps = self._actor.get_velocity().z
            self._actor.set_target_velocity(
                carla.Vector3D(share * ahead_m / frame_s, share * aside_m / frame_s, up_mps)
            )
            self._actor.set_target_angular_velocity(carla.Vector3D(0.0, 0.0, turn_deg / frame_s))
        else:
            place = carla.Location(here.location.x + ahead_m, here.location.y + aside_m, here.location.z)
            self._actor.set_transform(carla.Transform(place, carla.Rotation(0.0, next_yaw_deg, 0.0)))

    def _walk(self, ahead_m: float, aside_m: float, frame_s: float, here: carla.Transform) -> None:
        """Let a walker go on; it keeps its direction where it stands.

        A walker takes time to reach the speed of its control. What it lacks in the next frame is made up by its place.
        """
        control, velocity = self._actor.get_control(), self._actor.get_velocity()
        length_m = math.hypot(ahead_m, aside_m)
        if length_m:
            control.direction = carla.Vector3D(ahead_m / length_m, aside_m / length_m, 0.0)
        control.speed = length_m / frame_s
        self._actor.apply_control(control)
        lacks_m, lacks_aside_m = ahead_m - velocity.x * frame_s, aside_m - velocity.y * frame_s
        if math.hypot(lacks_m, lacks_aside_m) > LEAST_M:
            place = carla.Location(here.location.x + lacks_m, here.location.y + lacks_aside_m, here.location.z)
            self._actor.set_transform(carla.Transform(place, here.rotation))

    def _place(self, elapsed_s: float, here: carla.Transform) -> tuple[float, float, float]:
        """Return x and y in m and the yaw in deg at a time of the trajectory; without one, where the actor is."""
        if not self._places:
            return here.location.x, here.location.y, here.rotation.yaw
        after = bisect.bisect_right(self._times_s, elapsed_s)
        one, other = self._places[max(after - 1, 0)], self._places[min(after, len(self._places) - 1)]
        from_s, to_s = self._times_s[max(after - 1, 0)], self._times_s[min(after, len(self._places) - 1)]
        share = (elapsed_s - from_s) / (to_s - from_s) if to_s > from_s else 0.0
        turn_deg = (other.rotation.yaw - one.rotation.yaw + 180.0) % 360.0 - 180.0
        return (
            one.location.x + share * (other.location.x - one.location.x),
            one.location.y + share * (other.location.y - one.location.y),
            one.rotation.yaw + share * turn_deg,
        )

    def _now_s(self) -> float:
        return float(self._actor.get_world().get_snapshot().timestamp.elapsed_seconds)
