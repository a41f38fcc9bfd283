"""Maneuvers of a vehicle: accelerate, brake, hold, change lanes, drift and back up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from basu.scenarios.actions.one_frame import Action
from basu.scenarios.actions.path_follower import AtEnd, FollowerLimits, PathFollower, minded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.paths import Path


class _ToSpeed(PathFollower):
    """Change to a speed; done when it has it."""

    to_mps: float

    def wanted_mps(self) -> float:
        """The one to be reached."""
        return self.to_mps

    def over(self) -> str | None:
        """At the speed, once it is."""
        if abs(self.speed_mps - self.to_mps) > 1e-6:
            return None
        body = self.stage.body(self.actor)
        if abs(body.forward_mps - self.to_mps) > 0.3:
            return None
        return f"at {self.to_mps:.1f} m/s"


class Accelerate(_ToSpeed):
    """Let a vehicle accelerate to a speed, along a path or straight on; it goes on at that speed."""

    def __init__(
        self,
        actor: str,
        to_mps: float,
        at_mps2: float = 2.5,
        path: Path | None = None,
        *,
        considerate: bool = False,
        minds: Sequence[str] = (),
    ) -> None:
        super().__init__(
            f"{actor} accelerates to {to_mps:g} m/s",
            actor,
            path,
            limits=FollowerLimits(at_mps2, at_mps2),
            minds=minded(considerate=considerate, minds=minds),
        )
        self.to_mps = to_mps


class Brake(_ToSpeed):
    """Let a vehicle brake, by default to a stand, along a path or straight on."""

    def __init__(self, actor: str, to_mps: float = 0.0, at_mps2: float = 4.0, path: Path | None = None) -> None:
        goal = f" to {to_mps:g} m/s" if to_mps else ""
        at_end: AtEnd = "go on" if to_mps else "hold"
        super().__init__(
            f"{actor} brakes{goal} at {at_mps2:g} m/s²",
            actor,
            path,
            limits=FollowerLimits(at_mps2, at_mps2),
            at_end=at_end,
        )
        self.to_mps = to_mps


class Hold(PathFollower):
    """Hold a vehicle where it is, by its brakes, for some seconds."""

    def __init__(self, actor: str, seconds: float) -> None:
        super().__init__(f"{actor} stands for {seconds:.3g} s", actor, None, at_end="hold")
        self.seconds = seconds

    def begin(self) -> None:
        """Look at the clock."""
        super().begin()
        self.until_s = self.stage.time_s + self.seconds

    def wanted_mps(self) -> float:
        """None."""
        return 0.0

    def over(self) -> str | None:
        """When the time is over."""
        return f"stood for {self.seconds:.3g} s" if self.stage.time_s >= self.until_s - 1e-6 else None


class ChangeLane(PathFollower):
    """Lead a vehicle to ``to_right_m`` beside a path, from wherever beside it it is, within ``over_m`` or ``over_s``.

    Along the ego's route (``Path.of_route``) and with ``to_right_m=0`` it cuts in on the ego. The speed is
    ``speed_mps``, or stays. Done when it is there; it goes on straight, so let a ``DriveAlong`` follow.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        to_right_m: float = 0.0,
        *,
        over_m: float | None = None,
        over_s: float | None = None,
        speed_mps: float | None = None,
        considerate: bool = False,
        minds: Sequence[str] = (),
        limits: FollowerLimits = FollowerLimits(),  # noqa: B008 - a tuple cannot be changed
        at_end: AtEnd = "go on",
        name: str = "",
    ) -> None:
        """Without ``over_m`` and ``over_s`` it takes 3 s."""
        super().__init__(
            name or f"{actor} changes lane",
            actor,
            path,
            limits=limits,
            at_end=at_end,
            minds=minded(considerate=considerate, minds=minds),
        )
        self.to_right_m, self.over_m, self.over_s, self.keep_mps = to_right_m, over_m, over_s or 3.0, speed_mps

    def begin(self) -> None:
        """Lay the way across."""
        super().begin()
        self.goal_mps = self.speed_mps if self.keep_mps is None else self.keep_mps
        self.across_m = self.to_right_m - self.near.right_m
        base, from_m = self.path, self.near.s_m
        over_m = self.change_m()
        self.path = base.swerved(from_m, over_m, self.near.right_m, self.to_right_m)
        there = base.at(from_m + over_m, self.to_right_m)
        here = base.at(from_m, self.near.right_m)
        self.s_m = self.path.nearest(here.x_m, here.y_m).s_m
        self.there_s_m = self.path.nearest(there.x_m, there.y_m).s_m

    def change_m(self) -> float:
        """The length of the change, along the path."""
        return self.over_m if self.over_m is not None else self.over_s * max(self.goal_mps, self.speed_mps, 1.0)

    def wanted_mps(self) -> float:
        """The speed given, or what it had."""
        return self.goal_mps

    def over(self) -> str | None:
        """How far across, once it is."""
        side: Literal["right", "left"] = "right" if self.across_m > 0.0 else "left"
        return None if self.s_m < self.there_s_m else f"{abs(self.across_m):.1f} m to the {side}"


class Drift(ChangeLane):
    """Let a vehicle stray sideways at ``rate_mps``, as with a sleepy driver, to ``to_right_m`` beside its path."""

    def __init__(
        self,
        actor: str,
        path: Path,
        to_right_m: float,
        rate_mps: float = 0.5,
        *,
        speed_mps: float | None = None,
        at_end: AtEnd = "go on",
    ) -> None:
        side = "right" if to_right_m > 0.0 else "left"
        super().__init__(
            actor,
            path,
            to_right_m,
            speed_mps=speed_mps,
            at_end=at_end,
            name=f"{actor} strays {abs(to_right_m):g} m to the {side}",
        )
        self.rate_mps = rate_mps

    def change_m(self) -> float:
        """As long as the rate makes it."""
        return abs(self.across_m) / self.rate_mps * max(self.goal_mps, self.speed_mps, 1.0)


class BackUp(Action):
    """Let a vehicle back straight up for some metres and stand; a vehicle that the ego touches is let go."""

    def __init__(self, actor: str, way_m: float, speed_mps: float) -> None:
        super().__init__(f"{actor} backs up {way_m:.1f} m at {speed_mps:g} m/s")
        self.actor, self.way_m, self.speed_mps = actor, way_m, speed_mps

    def begin(self) -> None:
        """Store the pose from which the vehicle backs up."""
        body = self.stage.body(self.actor)
        self.x_m, self.y_m, self.yaw_rad = body.x_m, body.y_m, body.yaw_rad
        self.touched = False

    def act(self) -> str | None:
        """Move the vehicle back for one frame; return why the action ends, or None while it goes on."""
        if self.actor in self.stage.ego_contacts:
            self.touched = True
            return "touched by the ego"
        body = self.stage.body(self.actor)
        gone_m = math.hypot(body.x_m - self.x_m, body.y_m - self.y_m)
        if gone_m >= self.way_m - self.speed_mps * self.stage.step_s / 2.0:
            return f"{gone_m:.1f} m backwards"
        speed_mps, cos, sin = self.speed_mps, math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        self.stage.move(self.actor, -speed_mps * cos, -speed_mps * sin, 0.0)
        return None

    def leave(self, *, broken_off: bool) -> None:
        """Stand; a touched vehicle rolls."""
        del broken_off
        if not self.stage.is_there(self.actor):
            return
        if self.touched:
            self.stage.let_go(self.actor)
        else:
            self.stage.move(self.actor, 0.0, 0.0, 0.0)
