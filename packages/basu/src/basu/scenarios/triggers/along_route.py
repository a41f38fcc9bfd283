"""Triggers on the ego's place along its route."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.metrics.path_following import has_arrived
from basu.scenarios.triggers.motion import Trigger

if TYPE_CHECKING:
    from basu.scenarios.paths import Path

# The tree has to know of an arrival no later than the run, so it allows for what a vehicle does in a frame.
SLACK_M, SLACK_MPS = 1.0, 0.05
COMFORT_MPS2 = 1.0  # with which an ego is taken to brake for a line: what standing passengers bear (Hoberock 1977)
LEAST_MPS = 0.5  # an ego slower than this is not taken to arrive ever later
AT_LINE_M = 3.0  # an ego that rests no farther than this before its place has come to it


def rests_in_s(left_m: float, speed_mps: float) -> float:
    """How long an ego needs to come to rest so many metres ahead: at its speed, then braking for it in comfort.

    0 once it rests there, or is beyond.
    """
    if left_m <= 0.0 or (left_m <= AT_LINE_M and speed_mps < LEAST_MPS):
        return 0.0
    speed_mps = max(speed_mps, LEAST_MPS)
    braking_m = speed_mps * speed_mps / (2.0 * COMFORT_MPS2)
    if left_m <= braking_m:
        return 2.0 * left_m / speed_mps
    return (left_m - braking_m) / speed_mps + speed_mps / COMFORT_MPS2


class EgoArrives(Trigger):
    """The ego is at the end of its route, or at rest just before it."""

    def __init__(self) -> None:
        super().__init__("ego arrives")

    def has_come(self) -> str | None:
        """When, once it is."""
        stage = self.stage
        left_m, speed_mps = stage.route.length_m - stage.ego_s_m, stage.ego.speed_mps
        if has_arrived(left_m, speed_mps, slack_m=SLACK_M, slack_mps=SLACK_MPS):
            return f"ego arrived after {stage.time_s:.1f} s"
        return None


class EgoPasses(Trigger):
    """The ego is so far along its route, seen from the beginning of the route."""

    def __init__(self, s_m: float, what: str = "") -> None:
        super().__init__(f"ego passes {what or f'{s_m:.0f} m'}")
        self.s_m = s_m

    def has_come(self) -> str | None:
        """How far, once it is."""
        s_m = self.stage.ego_s_m
        return f"ego at {s_m:.1f} m of its route" if s_m >= self.s_m else None


class EgoBeyond(Trigger):
    """The ego is past an actor by ``by_m``, along the route and tail to nose."""

    def __init__(self, actor: str, by_m: float = 0.0) -> None:
        super().__init__(f"ego is {f'{by_m:g} m ' if by_m else ''}past {actor}")
        self.actor, self.by_m = actor, by_m

    def has_come(self) -> str | None:
        """How far, once it is."""
        ego, other = self.stage.ego, self.stage.body(self.actor)
        cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
        behind_m = (ego.x_m - other.x_m) * cos + (ego.y_m - other.y_m) * sin
        turn_rad = other.yaw_rad - ego.yaw_rad
        reach_m = abs(math.cos(turn_rad)) * other.half_length_m + abs(math.sin(turn_rad)) * other.half_width_m
        clear_m = behind_m - ego.half_length_m - reach_m
        return f"ego {clear_m:.1f} m past {self.actor}" if clear_m >= self.by_m else None


class PassesEgo(Trigger):
    """An actor's tail is ``by_m`` ahead of the ego's bumper."""

    def __init__(self, actor: str, by_m: float) -> None:
        super().__init__(f"{actor} {by_m:g} m ahead of the ego")
        self.actor, self.by_m = actor, by_m

    def has_come(self) -> str | None:
        """How far, once it is."""
        ego, other = self.stage.ego, self.stage.body(self.actor)
        ahead_m = (other.x_m - ego.x_m) * math.cos(ego.yaw_rad) + (other.y_m - ego.y_m) * math.sin(ego.yaw_rad)
        clear_m = ahead_m - ego.half_length_m - other.half_length_m
        return f"{clear_m:.1f} m ahead" if clear_m >= self.by_m else None


class TimeToArrival(Trigger):
    """The ego, at the speed it has, needs no more than ``seconds`` to a place ``s_m`` along its route."""

    def __init__(self, s_m: float, seconds: float, what: str = "") -> None:
        super().__init__(f"ego {seconds:.3g} s from {what or f'{s_m:.0f} m'}")
        self.s_m, self.seconds = s_m, seconds

    def has_come(self) -> str | None:
        """When and at which speed, once it is."""
        left_m, speed_mps = self.s_m - self.stage.ego_s_m, self.stage.ego.forward_mps
        if left_m > max(speed_mps, 0.0) * self.seconds:
            return None
        return f"ego at {left_m:.1f} m and {speed_mps:.1f} m/s"


class TimeToRest(Trigger):
    """The ego, if it is to come to rest ``s_m`` along its route, needs no more than ``seconds`` until it does."""

    def __init__(self, s_m: float, seconds: float, what: str = "") -> None:
        super().__init__(f"ego {seconds:.3g} s from rest at {what or f'{s_m:.0f} m'}")
        self.s_m, self.seconds = s_m, seconds

    def has_come(self) -> str | None:
        """When and at which speed, once it is."""
        left_m, speed_mps = self.s_m - self.stage.ego_s_m, self.stage.ego.forward_mps
        if rests_in_s(left_m, speed_mps) > self.seconds:
            return None
        return f"ego at {left_m:.1f} m and {speed_mps:.1f} m/s"


class ActorTimeToArrival(Trigger):
    """An actor needs, at the speed it has, no more than ``seconds`` to a place ``s_m`` along its path."""

    def __init__(self, actor: str, path: Path, s_m: float, seconds: float) -> None:
        super().__init__(f"{actor} {seconds:.3g} s from {s_m:.0f} m of its path")
        self.actor, self.path, self.s_m, self.seconds = actor, path, s_m, seconds

    def has_come(self) -> str | None:
        """How far away and at which speed, once it does."""
        body = self.stage.body(self.actor)
        left_m = self.s_m - self.path.nearest(body.x_m, body.y_m).s_m
        if left_m > body.speed_mps * self.seconds:
            return None
        return f"{self.actor} at {left_m:.1f} m and {body.speed_mps:.1f} m/s"


class _Junction(Trigger):
    """The base of the two below."""

    beyond_m: float

    def inside(self) -> bool:
        """Whether the ego's origin is in a junction of its route."""
        route, s_m = self.stage.route, self.stage.ego_s_m
        index = min(max(int(route.s_m.searchsorted(s_m)), 0), len(route.s_m) - 1)
        return s_m >= self.beyond_m and bool(route.is_junction[index])


class EgoEntersJunction(_Junction):
    """The ego is in a junction of its route, the first beyond ``beyond_m`` of it."""

    def __init__(self, beyond_m: float = 0.0) -> None:
        super().__init__("ego enters a junction")
        self.beyond_m = beyond_m

    def has_come(self) -> str | None:
        """Where, once it is."""
        return f"in the junction at {self.stage.ego_s_m:.1f} m" if self.inside() else None


class EgoLeavesJunction(_Junction):
    """The ego was in a junction of its route, the first beyond ``beyond_m`` of it, and has left it."""

    def __init__(self, beyond_m: float = 0.0) -> None:
        super().__init__("ego leaves a junction")
        self.beyond_m = beyond_m

    def begin(self) -> None:
        """Not yet in one."""
        self.was_inside = False

    def has_come(self) -> str | None:
        """Where, once it has."""
        inside, was_inside = self.inside(), self.was_inside
        self.was_inside = inside or was_inside
        return f"out of the junction at {self.stage.ego_s_m:.1f} m" if was_inside and not inside else None
