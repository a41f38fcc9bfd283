"""Following a trajectory: by the entity's own speed, or by the trajectory's times."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from basu_openscenario.playing.curves import Curve, Vertex, lay
from basu_openscenario.playing.mover import Follower
from basu_openscenario.playing.running_action import ASIDE, BOTH, RunningAction
from basu_openscenario.playing.transition import SMALL, sign
from basu_openscenario.roads.place import wrapped

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import FollowTrajectoryAction


class TrajectoryFollowing(RunningAction):
    """Moves an entity along a trajectory."""

    def __init__(self, name: str, world: World, mover: Mover, action: FollowTrajectoryAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.domains = ASIDE if action.timing is None else BOTH
        self.clock_s = 0.0
        self.curve: Curve | None = None
        self.facing = 1.0
        """-1 where the body looks against the trajectory."""
        self.headed = False
        """Whether the present piece has a heading of its own."""

    @property
    def timed(self) -> bool:
        """Whether times decide how far the entity is."""
        return self.action.timing is not None and self.curve is not None and self.curve.timed

    def prepare(self) -> None:
        """Lay the trajectory, and put the entity on its start."""
        mover = self.mover
        curve = lay(
            self.action.trajectory,
            partial(self.world.place_of, mover=mover),
            follows=self.action.follows,
            speed_mps=mover.speed_mps,
            here=mover.place,
        )
        self.curve = curve
        start = curve.at(self.action.start_m)
        self.clock_s = start.time_s
        mover.follower = Follower(curve, self.action.start_m)
        backwards = sign(mover.speed_mps) < 0.0
        if self.timed:
            backwards = start.has_heading and abs(wrapped(start.h_rad - start.true_rad)) > math.pi / 2.0 + SMALL
        heading = start.h_rad if start.has_heading else start.true_rad + (math.pi if backwards else 0.0)
        self._stand(start, heading)
        self.facing = -1.0 if abs(wrapped(heading - start.true_rad)) > math.pi / 2.0 + SMALL else 1.0
        self.headed = start.has_heading
        if self.timed:
            mover.set_speed((-1.0 if backwards else 1.0) * start.speed_mps)

    def _stand(self, vertex: Vertex, h_rad: float) -> None:
        """Put the entity on a point of the trajectory."""
        place = self.mover.place
        place.on_surface = vertex.p_rad is None
        place.set_world(vertex.x_m, vertex.y_m, h_rad, vertex.z_m)
        if vertex.p_rad is not None:
            place.p_rad, place.r_rad = vertex.p_rad, vertex.r_rad or 0.0

    def work(self, step_s: float) -> bool:
        """Move a step along the trajectory, and straight on beyond its end."""
        mover, curve = self.mover, self.curve
        assert curve is not None, "it has begun"
        assert mover.follower is not None, "it follows this one"
        mover.moved_along = mover.speed_is_set = True
        old_m = mover.follower.s_m
        direction = self._advance(curve, step_s)
        vertex = curve.at(mover.follower.s_m)
        self._turn(vertex)
        if self.timed:
            ends_s = curve.first_s + curve.duration_s
            late_s = self._due_s() - ends_s
            is_over = late_s > -SMALL
            rest_m = late_s * mover.speed_mps if is_over else 0.0
        else:
            at_end = mover.follower.s_m > curve.length_m - SMALL and direction * abs(mover.speed_mps) > 0.0
            at_start = mover.follower.s_m < SMALL and direction * abs(mover.speed_mps) < 0.0
            is_over = not curve.closed and step_s > 0.0 and (at_end or at_start)
            rest_m = abs(mover.speed_mps) * step_s - abs(mover.follower.s_m - old_m) if is_over else 0.0
        if is_over:
            place = mover.place
            x_m, y_m = place.x_m + rest_m * math.cos(vertex.h_rad), place.y_m + rest_m * math.sin(vertex.h_rad)
            place.set_world(x_m, y_m, None, mover.fixed_z_m)
        return is_over

    def _due_s(self) -> float:
        """Return the time on the trajectory's clock."""
        return self.clock_s + self.action.offset_s

    def _advance(self, curve: Curve, step_s: float) -> float:
        """Go on along the trajectory; return the direction of movement, 1 or -1."""
        mover = self.mover
        follower = mover.follower
        assert follower is not None, "it follows this one"
        if not self.timed:
            direction = sign(mover.speed_mps) * self.facing
            s_m = follower.s_m + direction * abs(mover.speed_mps) * step_s
            if curve.closed:
                s_m %= curve.length_m
            follower.s_m = min(max(s_m, 0.0), curve.length_m)
            return direction
        if self.action.timing == "relative":
            self.clock_s += self.action.scale * step_s
        else:
            self.clock_s = (self.world.time_s + step_s) * self.action.scale
        old_m = follower.s_m
        before = curve.at(old_m)
        looks = -1.0 if abs(wrapped(mover.place.h_rad - before.true_rad)) > math.pi / 2.0 + SMALL else 1.0
        follower.s_m = curve.s_at(self._due_s())
        direction = sign(follower.s_m - old_m)
        if step_s > SMALL and self._due_s() < curve.first_s + curve.duration_s + SMALL:
            mover.set_speed(direction * looks * abs(follower.s_m - old_m) / step_s)
        return direction

    def _turn(self, vertex: Vertex) -> None:
        """Put the entity on a point, with the point's heading or that of the path, forwards or backwards."""
        if vertex.has_heading:
            self.headed = True
        elif self.headed:
            against = abs(wrapped(self.mover.place.h_rad - vertex.true_rad)) > math.pi / 2.0 + SMALL
            self.facing, self.headed = (-1.0 if against else 1.0), False
        backwards = not vertex.has_heading and self.facing < 0.0
        self._stand(vertex, vertex.h_rad + (math.pi if backwards else 0.0))

    def end(self) -> None:
        """Leave the trajectory."""
        super().end()
        follower = self.mover.follower
        if follower is not None and follower.curve is self.curve:
            self.mover.follower = None
