"""The base of triggers, and triggers on motion, time and touch."""

from __future__ import annotations

import math

from basu.scenarios.stage import EGO
from basu.scenarios.tree_node import Node
from basu.thresholds import AT_REST_MPS


def named(actor: str) -> str:
    """An actor's name in the tree."""
    return "ego" if actor == EGO else actor


class Trigger(Node):
    """Asks ``has_come`` each frame, which says in words what has come true, or None."""

    def has_come(self) -> str | None:
        """What has come true, in words; None until then."""
        raise NotImplementedError

    def done(self) -> str | None:
        """Ask."""
        return self.has_come()


class Faster(Trigger):
    """An actor is at least so fast."""

    def __init__(self, speed_mps: float, *, actor: str = EGO) -> None:
        super().__init__(f"{named(actor)} at {speed_mps:g} m/s or more")
        self.speed_mps, self.actor = speed_mps, actor

    def has_come(self) -> str | None:
        """How fast, once it is."""
        speed_mps = self.stage.body(self.actor).speed_mps
        return f"{speed_mps:.1f} m/s" if speed_mps >= self.speed_mps else None


class Slower(Trigger):
    """An actor is at most so fast."""

    def __init__(self, speed_mps: float, *, actor: str = EGO) -> None:
        super().__init__(f"{named(actor)} at {speed_mps:g} m/s or less")
        self.speed_mps, self.actor = speed_mps, actor

    def has_come(self) -> str | None:
        """How fast, once it is."""
        speed_mps = self.stage.body(self.actor).speed_mps
        return f"{speed_mps:.1f} m/s" if speed_mps <= self.speed_mps else None


class StandsStill(Trigger):
    """An actor has stood for so long, without a break."""

    def __init__(self, seconds: float, *, actor: str = EGO) -> None:
        super().__init__(f"{named(actor)} stands for {seconds:.3g} s")
        self.seconds, self.actor = seconds, actor

    def begin(self) -> None:
        """Count from now."""
        self.moved_s = self.stage.time_s

    def has_come(self) -> str | None:
        """How long, once it has."""
        now_s = self.stage.time_s
        if self.stage.body(self.actor).speed_mps >= AT_REST_MPS:
            self.moved_s = now_s
        stood_s = now_s - self.moved_s
        return f"stood for {stood_s:.1f} s" if stood_s >= self.seconds - 1e-6 else None


class ClosesIn(Trigger):
    """The ego would reach an actor within ``seconds`` at the present closing speed, edge to edge."""

    def __init__(self, actor: str, seconds: float) -> None:
        super().__init__(f"ego {seconds:.3g} s from {actor}")
        self.actor, self.seconds = actor, seconds

    def has_come(self) -> str | None:
        """How far away and how fast, once it would."""
        ego, other = self.stage.ego, self.stage.body(self.actor)
        dx_m, dy_m = other.x_m - ego.x_m, other.y_m - ego.y_m
        away_m = max(math.hypot(dx_m, dy_m), 1e-6)
        closing_mps = (
            dx_m * (ego.velocity_x_mps - other.velocity_x_mps) + dy_m * (ego.velocity_y_mps - other.velocity_y_mps)
        ) / away_m
        gap_m = max(0.0, away_m - ego.half_length_m - other.half_length_m)
        if closing_mps <= 0.0 or gap_m > closing_mps * self.seconds:
            return None
        return f"{gap_m:.1f} m away, closing at {closing_mps:.1f} m/s"


class Elapsed(Trigger):
    """``seconds`` have passed since the scenario began."""

    def __init__(self, seconds: float) -> None:
        super().__init__(f"{seconds:.3g} s since the beginning")
        self.seconds = seconds

    def has_come(self) -> str | None:
        """When, once it has."""
        now_s = self.stage.time_s
        return f"{now_s:.1f} s" if now_s >= self.seconds - 1e-6 else None


class EgoTouches(Trigger):
    """The ego has touched an actor, or any actor."""

    def __init__(self, actor: str | None = None) -> None:
        super().__init__(f"ego touches {actor or 'an actor'}")
        self.actor = actor

    def has_come(self) -> str | None:
        """The touched actors, once there is a contact."""
        touched = sorted(self.stage.ego_contacts)
        if not touched or (self.actor is not None and self.actor not in touched):
            return None
        return f"ego touched {self.actor or ', '.join(touched)}"
