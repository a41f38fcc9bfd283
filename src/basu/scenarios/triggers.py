"""What a scenario waits for: each RUNNING until it has come true, then SUCCESS."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

if TYPE_CHECKING:
    from basu.scenarios.stage import Stage

ARRIVED_M = 2.0  # before the end of its route, the ego has arrived


class Trigger(Behaviour):
    """The base of all: asks ``has_come`` each frame, which says in words what has come true, or None."""

    stage: Stage

    def setup(self, **kwargs: Any) -> None:  # noqa: ANN401 - py_trees' signature
        """Take the stage."""
        self.stage = kwargs["stage"]

    def has_come(self) -> str | None:
        """What has come true, in words; None until then."""
        raise NotImplementedError

    def update(self) -> Status:
        """Ask."""
        words = self.has_come()
        if words is None:
            return Status.RUNNING
        self.feedback_message = words
        return Status.SUCCESS


class EgoNear(Trigger):
    """The ego is nearer to an actor than ``distance_m``, middle to middle."""

    def __init__(self, actor: str, distance_m: float) -> None:
        super().__init__(f"ego within {distance_m:g} m of {actor}")
        self.actor, self.distance_m = actor, distance_m

    def has_come(self) -> str | None:
        """How near, once it is."""
        ego, other = self.stage.ego, self.stage.body(self.actor)
        away_m = math.hypot(ego.x_m - other.x_m, ego.y_m - other.y_m)
        return f"ego at {away_m:.1f} m" if away_m <= self.distance_m else None


class EgoArrives(Trigger):
    """The ego is at the end of its route."""

    def __init__(self) -> None:
        super().__init__("ego arrives")

    def has_come(self) -> str | None:
        """When, once it is."""
        left_m = self.stage.route.length_m - self.stage.ego_s_m
        return f"ego arrived after {self.stage.time_s:.1f} s" if left_m <= ARRIVED_M else None


class EgoPasses(Trigger):
    """The ego is so far along its route, seen from the beginning of the route."""

    def __init__(self, s_m: float, what: str = "") -> None:
        super().__init__(f"ego passes {what or f'{s_m:.0f} m'}")
        self.s_m = s_m

    def has_come(self) -> str | None:
        """How far, once it is."""
        s_m = self.stage.ego_s_m
        return f"ego at {s_m:.1f} m of its route" if s_m >= self.s_m else None


class TimeToArrival(Trigger):
    """The ego, at the speed it has, needs no more than ``seconds`` to a place ``s_m`` along its route."""

    def __init__(self, s_m: float, seconds: float, what: str = "") -> None:
        super().__init__(f"ego {seconds:g} s from {what or f'{s_m:.0f} m'}")
        self.s_m, self.seconds = s_m, seconds

    def has_come(self) -> str | None:
        """When and at which speed, once it is."""
        left_m, speed_mps = self.s_m - self.stage.ego_s_m, self.stage.ego.forward_mps
        if left_m > max(speed_mps, 0.0) * self.seconds:
            return None
        return f"ego at {left_m:.1f} m and {speed_mps:.1f} m/s"
