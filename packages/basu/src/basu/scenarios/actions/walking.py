"""Walk along a path: people, and the animals that are walkers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from basu.scenarios.actions.one_frame import Action

if TYPE_CHECKING:
    from basu.scenarios.paths import Path

Then = Literal["stand", "go on", "turn back", "vanish"]


class WalkAlong(Action):
    """Let a walker go along a path.

    ``pause_at_m`` along the path it stands for ``pause_s``. At the end it stands, goes on straight, turns back to
    where it came from, or vanishes. A touched walker stands.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        speed_mps: float = 1.4,
        *,
        pause_at_m: float | None = None,
        pause_s: float = 0.0,
        at_end: Then = "stand",
    ) -> None:
        verb = "runs" if speed_mps > 2.2 else "walks"
        super().__init__(f"{actor} {verb} {path.length_m:.0f} m at {speed_mps:g} m/s")
        self.actor, self.whole, self.speed_mps, self.at_end = actor, path, speed_mps, at_end
        self.pause_at_m, self.pause_s = pause_at_m, pause_s

    def begin(self) -> None:
        """Find the place on the path."""
        self.path, self.back, self.moving = self.whole, False, True
        self.pause_left_s = self.pause_s if self.pause_at_m is not None else 0.0
        body = self.stage.body(self.actor)
        self.s_m = self.path.nearest(body.x_m, body.y_m).s_m
        self.walked_m = 0.0

    def act(self) -> str | None:
        """One frame's walk."""
        if self.actor in self.stage.ego_contacts:
            self.moving = False
            return f"touched by the ego after {self.walked_m:.1f} m"
        body, step_s = self.stage.body(self.actor), self.stage.step_s
        near = self.path.nearest(body.x_m, body.y_m, self.s_m)
        self.s_m = near.s_m
        if self._pauses():
            self.pause_left_s -= step_s
            self.stage.walk(self.actor, 0.0, 0.0)
            return None
        stride_m = self.speed_mps * step_s
        if self.s_m >= self.path.length_m - stride_m / 2.0:
            if self.at_end != "turn back" or self.back:
                return f"{self.walked_m:.1f} m walked"
            self.path, self.back = self.whole.reversed(), True
            self.s_m = self.path.length_m - self.s_m
        self.walked_m += stride_m
        aim = self.path.at(self.s_m + max(0.5, 2.0 * stride_m))
        self._walk(math.atan2(aim.y_m - body.y_m, aim.x_m - body.x_m))
        return None

    def leave(self, *, broken_off: bool) -> None:
        """Stand, go on or vanish; a walker broken off in the middle of a walk stands, unless it was to go on."""
        if not self.stage.is_there(self.actor):
            return
        if self.at_end == "vanish" and self.moving and not broken_off:
            self.stage.remove(self.actor)
        elif self.at_end != "go on" or not self.moving:
            self.stage.walk(self.actor, 0.0, 0.0)
        else:
            self._walk(self.stage.body(self.actor).yaw_rad if broken_off else self.path.at(self.path.length_m).yaw_rad)

    def _pauses(self) -> bool:
        """Whether it stands in the middle of its walk."""
        return (
            self.pause_at_m is not None and not self.back and self.s_m >= self.pause_at_m and self.pause_left_s > 1e-6
        )

    def _walk(self, yaw_rad: float) -> None:
        """Go this way."""
        self.stage.walk(self.actor, self.speed_mps * math.cos(yaw_rad), self.speed_mps * math.sin(yaw_rad))
