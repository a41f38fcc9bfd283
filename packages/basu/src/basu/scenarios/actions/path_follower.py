"""A vehicle led along a path: velocity and turning commanded each frame, with feedback on place and heading."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

from basu.errors import ScenarioError
from basu.scenarios.actions.one_frame import Action
from basu.scenarios.paths import Path
from basu.scenarios.stage import EGO, Pose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.paths import OnPath
    from basu.scenarios.stage import ActorBox, Stage

AtEnd = Literal["hold", "go on", "vanish"]
BACKWARDS_RAD = math.radians(100.0)  # a path that begins farther off a vehicle's heading leads behind it
STRAIGHT_M = 400.0  # of the path of a vehicle without one
PULL_PER_S = 2.0  # of the way off its path that a path follower makes good in a second
SIDEWAYS = 0.35  # of its speed that it may do so with
TURN_RADPS = 2.0  # no command turns faster
MARGIN_M = 0.4  # beside its own width, that a path follower minds
JAM_M, HEADWAY_S = 2.0, 1.0  # of the follower: the gap at rest, and what it keeps besides at speed
LOOK_M = 60.0  # ahead


class FollowerLimits(NamedTuple):
    """How hard a path follower accelerates and brakes, m/s²."""

    accelerate_mps2: float = 2.5
    brake_mps2: float = 4.0
    emergency_mps2: float = 8.0  # for those it minds


class PathFollower(Action):
    """The base of actions that lead a vehicle. Subclasses say how fast (``wanted_mps``) and how long (``over``).

    The path is followed from the place nearest to the vehicle, and its speed changed from what it is, so that one
    action takes over from another. A vehicle that the ego touches is let go.
    """

    def __init__(
        self,
        name: str,
        actor: str,
        path: Path | None,
        *,
        limits: FollowerLimits = FollowerLimits(),  # noqa: B008 - a tuple cannot be changed
        at_end: AtEnd = "go on",
        minds: Sequence[str] = (),
    ) -> None:
        """``path`` None: straight on from where it is. ``minds``: the actors on its path that it brakes for."""
        super().__init__(name)
        self.actor, self.given, self.limits, self.at_end, self.minds = actor, path, limits, at_end, tuple(minds)
        self.s_m = self.speed_mps = 0.0

    def begin(self) -> None:
        """Find the place on the path and take over the speed."""
        body = self.stage.body(self.actor)
        self.path = self.given or Path.straight(Pose(body.x_m, body.y_m, body.z_m, body.yaw_rad), STRAIGHT_M)
        self.near = self.path.nearest(body.x_m, body.y_m)
        off_rad = math.remainder(self.path.heading_rad(self.near.s_m) - body.yaw_rad, math.tau)
        if abs(off_rad) > BACKWARDS_RAD:
            raise ScenarioError(
                f"'{self.actor}' is led along a path that goes {math.degrees(abs(off_rad)):.0f}° off its heading; "
                "a vehicle is led forwards only: turn it, or let the path begin ahead of it"
            )
        self.began_m = self.s_m = self.near.s_m
        self.speed_mps = max(0.0, body.forward_mps)
        self.touched = False
        for name in self.minds:
            self.stage.body(name)

    def act(self) -> str | None:
        """One frame: go on, or say why not."""
        if self.actor in self.stage.ego_contacts:
            self.touched = True
            return f"touched by the ego at {self.speed_mps:.1f} m/s"
        body = self.stage.body(self.actor)
        self.near = self.path.nearest(body.x_m, body.y_m, self.s_m)
        self.s_m = self.near.s_m
        words = self.over()
        if words is None:
            self._drive(body)
        return words

    def leave(self, *, broken_off: bool) -> None:
        """Hold, go on straight or vanish; a touched vehicle rolls."""
        if not self.stage.is_there(self.actor):
            return
        if self.touched:
            self.stage.let_go(self.actor)
        elif self.at_end == "vanish" and not broken_off:
            self.stage.remove(self.actor)
        elif self.at_end == "hold" or self.speed_mps < 0.05:
            self.stage.move(self.actor, 0.0, 0.0, 0.0)
        else:
            yaw_rad = self.stage.body(self.actor).yaw_rad
            self.stage.move(self.actor, self.speed_mps * math.cos(yaw_rad), self.speed_mps * math.sin(yaw_rad), 0.0)

    def wanted_mps(self) -> float:
        """The speed it makes for in this frame."""
        raise NotImplementedError

    def over(self) -> str | None:
        """What is done, once it is; here, the end of the path."""
        if self.s_m < self.path.length_m - self.speed_mps * self.stage.step_s / 2.0 - 0.05:
            return None
        return f"{self.s_m - self.began_m:.0f} m driven, at {self.speed_mps:.1f} m/s"

    def _drive(self, body: ActorBox) -> None:
        """Change the speed within the limits and command this frame's motion."""
        step_s, wanted_mps = self.stage.step_s, self.wanted_mps()
        rise_mps, fall_mps = self.limits.accelerate_mps2 * step_s, self.limits.brake_mps2 * step_s
        speed_mps = min(max(wanted_mps, self.speed_mps - fall_mps), self.speed_mps + rise_mps)
        if self.minds:
            speed_mps = max(0.0, min(speed_mps, self._followed_mps(body)))
        self.speed_mps = speed_mps
        lead(self.stage, self.actor, self.path, self.near, speed_mps)

    def _followed_mps(self, body: ActorBox) -> float:
        """Return the speed that keeps the distance to the nearest minded actor; inf without one ahead."""
        slowest_mps = math.inf
        for name in self.minds:
            try:
                other = self.stage.body(name)
            except ScenarioError:  # it has left the world: `begin` has seen that there was one
                continue
            ahead = gap_ahead(self.path, self.s_m, body, other)
            if ahead is None:
                continue
            rate = following_mps2(self.speed_mps, ahead, self.limits)
            slowest_mps = min(slowest_mps, self.speed_mps + rate * self.stage.step_s)
        return slowest_mps


class Ahead(NamedTuple):
    """An actor on the path."""

    gap_m: float  # from the front of one to the nearest point of the other
    speed_mps: float  # of the other, along the path


def following_mps2(speed_mps: float, ahead: Ahead, limits: FollowerLimits) -> float:
    """Return the acceleration by the intelligent driver model towards an actor ahead, at most that of an emergency.

    Treiber, Hennecke and Helbing 2000, "Congested traffic states", eq. 2-3.
    """
    comfortable = 2.0 * math.sqrt(limits.accelerate_mps2 * limits.brake_mps2)
    closing = speed_mps * (speed_mps - ahead.speed_mps) / comfortable
    gap_m = JAM_M + max(0.0, speed_mps * HEADWAY_S + closing)
    return max(limits.accelerate_mps2 * (1.0 - (gap_m / max(ahead.gap_m, 0.1)) ** 2), -limits.emergency_mps2)


def gap_ahead(path: Path, s_m: float, body: ActorBox, other: ActorBox, look_m: float = LOOK_M) -> Ahead | None:
    """Return how far another is ahead on a path that ``body`` follows at ``s_m``; None if it is not on it.

    Actors farther than ``look_m`` are not seen.
    """
    if math.hypot(other.x_m - body.x_m, other.y_m - body.y_m) > look_m:
        return None
    reach_m = body.half_width_m + MARGIN_M
    middle = path.nearest(other.x_m, other.y_m, s_m, look_m + 10.0)
    if middle.distance_m > reach_m + math.hypot(other.half_length_m, other.half_width_m):
        return None
    cos, sin = math.cos(other.yaw_rad), math.sin(other.yaw_rad)
    on_path = [middle]
    for along, across in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        forward_m, right_m = along * other.half_length_m, across * other.half_width_m
        x_m, y_m = other.x_m + forward_m * cos - right_m * sin, other.y_m + forward_m * sin + right_m * cos
        on_path.append(path.nearest(x_m, y_m, s_m, look_m + 10.0))
    if min(p.right_m for p in on_path) > reach_m or max(p.right_m for p in on_path) < -reach_m:
        return None
    gap_m = min(p.s_m for p in on_path) - s_m - body.half_length_m
    if max(p.s_m for p in on_path) < s_m or gap_m > look_m:
        return None
    yaw_rad = path.heading_rad(middle.s_m)
    speed_mps = other.velocity_x_mps * math.cos(yaw_rad) + other.velocity_y_mps * math.sin(yaw_rad)
    return Ahead(gap_m, max(0.0, speed_mps))


def lead(stage: Stage, actor: str, path: Path, near: OnPath, speed_mps: float) -> None:
    """Command a frame's motion along a path at a speed: tangent, pull towards the path, and turning."""
    if speed_mps < 0.01:
        stage.move(actor, 0.0, 0.0, 0.0)
        return
    body = stage.body(actor)
    ahead_m = near.s_m + speed_mps * stage.step_s
    yaw_rad = path.heading_rad((near.s_m + ahead_m) / 2.0)
    sideways_mps = min(max(-PULL_PER_S * near.right_m, -SIDEWAYS * speed_mps), SIDEWAYS * speed_mps)
    forward_mps = math.sqrt(speed_mps**2 - sideways_mps**2)
    aim_rad = path.heading_rad(ahead_m) + math.atan2(sideways_mps, forward_mps)
    turn_radps = math.remainder(aim_rad - body.yaw_rad, math.tau) / stage.step_s
    stage.move(
        actor,
        forward_mps * math.cos(yaw_rad) - sideways_mps * math.sin(yaw_rad),
        forward_mps * math.sin(yaw_rad) + sideways_mps * math.cos(yaw_rad),
        min(max(turn_radps, -TURN_RADPS), TURN_RADPS),
    )


def minded(*, considerate: bool, minds: Sequence[str]) -> tuple[str, ...]:
    """The actors that a path follower brakes for: the named ones, and the ego where it is considerate."""
    return (EGO, *minds) if considerate else tuple(minds)
