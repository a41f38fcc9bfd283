"""`OthersCheck` and `LightsCheck`, used by `Conduct`: other actors moved or removed, traffic lights changed too early.

All checks read the world snapshot, which is there anyway. They hold in a simulator of our own, where nothing but the
benchmark and its agent is connected. CARLA's rules for lights: TrafficLightGroup.cpp and TrafficLightController.cpp.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.errors import AgentCrashedError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.managers.base_manager import Frame, WorldChanges
    from basu.managers.observations import Neighbours
    from basu.routing import Route

JUMP_M = 1.0
"""Way in one step beyond what the velocity explains. In Linden's drives, crashes included, it is below 0.0001 m."""
DRIFT_M = 2.0
"""Such ways summed up, for many small jumps; here the sum fades with ``FADING`` a step. Crashes stay below 0.06 m."""
FADING = 0.95
BOX_M = 3.0  # from an actor's origin to the middle of its box, at most
ROUNDING_S = 0.001  # of times in a snapshot, which are single precision
COLOURS = {
    carla.TrafficLightState.Red: "red",
    carla.TrafficLightState.Yellow: "yellow",
    carla.TrafficLightState.Green: "green",
}
CONTROL_TOLERANCE = 1e-4  # a snapshot holds controls in single precision


class OthersCheck:
    """Other actors near the vehicle: each moves as its velocity says, and goes only when the benchmark removes it."""

    def __init__(self, neighbours: Neighbours, changes: WorldChanges, step_s: float) -> None:
        self._neighbours, self._changes, self._step_s = neighbours, changes, step_s
        self._rows: dict[int, tuple[float, ...]] = {}
        self._drift_m: dict[int, tuple[float, float]] = {}

    def fault(self, frame: Frame) -> str | None:
        """Half a sentence about an actor that was destroyed or moved; None where all is well."""
        before = self._rows
        self._rows = rows = {int(row[1]): row for row in self._neighbours.near(frame)}
        placed, self._changes.placed = self._changes.placed, set()
        for key, old in before.items():
            new = rows.get(key)
            if new is None:
                fault = None if key in self._changes.removed or key in placed else self._lost(key, old, frame)
                if fault is not None:
                    return fault
                continue
            away_m = self._unexplained_m(key, old, new, is_placed=key in placed)
            if away_m is not None:
                return f"moved {self._name(key)} by {away_m:.1f} m"
        return None

    def _lost(self, key: int, old: tuple[float, ...], frame: Frame) -> str | None:
        """Half a sentence about an actor that is not near any more, where it was destroyed or put far away."""
        actor: Any = frame.snapshot.find(key)
        if actor is None:
            return f"took {self._name(key)} out of the world"
        at = actor.get_transform().location
        away_m = math.hypot(at.x - old[2], at.y - old[3]) - self._step_s * math.hypot(*old[6:8])
        return f"moved {self._name(key)} by {away_m:.1f} m" if away_m > JUMP_M + BOX_M else None

    def _unexplained_m(
        self, key: int, old: tuple[float, ...], new: tuple[float, ...], *, is_placed: bool
    ) -> float | None:
        """How far an actor came that its velocity does not explain, where that is too far."""
        if is_placed:
            self._drift_m.pop(key, None)
            return None
        dx_m, dy_m = new[2] - old[2], new[3] - old[3]
        jump_m = math.hypot(dx_m, dy_m) - self._step_s * max(math.hypot(*old[6:8]), math.hypot(*new[6:8]))
        if jump_m > JUMP_M:
            return jump_m
        if not self._neighbours.met[key].startswith("vehicle."):
            return None  # the official client's crowd puts walkers along their way
        half_s = 0.5 * self._step_s
        x_m, y_m = self._drift_m.get(key, (0.0, 0.0))
        x_m = FADING * x_m + dx_m - half_s * (old[6] + new[6])
        y_m = FADING * y_m + dy_m - half_s * (old[7] + new[7])
        self._drift_m[key] = (x_m, y_m)
        drift_m = math.hypot(x_m, y_m)
        return drift_m if drift_m > DRIFT_M else None

    def _name(self, key: int) -> str:
        return f"the actor {key} ({self._neighbours.met.get(key, 'unknown')})"


class _Shown(NamedTuple):
    """A light in one frame."""

    colour: carla.TrafficLightState
    elapsed_s: float  # of its stage, 0 while the turn is another light's
    frozen: bool
    times_s: tuple[float, float, float]  # of green, yellow, red

    def is_over(self, step_s: float) -> bool:
        """Whether its stage ends in the next step."""
        lasts_s = dict(zip((carla.TrafficLightState.Green, carla.TrafficLightState.Yellow), self.times_s, strict=False))
        return bool(self.elapsed_s + step_s > lasts_s.get(self.colour, self.times_s[2]) - ROUNDING_S)


class LightsCheck:
    """The lights along the route and those of their groups: they change only when their times are over."""

    def __init__(self, world: carla.World, route: Route, changes: WorldChanges, step_s: float) -> None:
        """Look the lights up, which costs one call for each light of the route."""
        self._changes, self._step_s = changes, step_s
        self._groups: list[list[carla.TrafficLight]] = []
        known: set[int] = set()
        for control in route.controls:
            light = world.get_traffic_light_from_opendrive_id(control.landmark_id) if control.landmark_id else None
            if light is None or light.id in known:
                continue
            group = [light, *(other for other in light.get_group_traffic_lights() if other.id != light.id)]
            known |= {other.id for other in group}
            self._groups.append(group)
        self._last: list[list[_Shown]] = []
        self._counted = -1

    def fault(self) -> str | None:
        """Half a sentence about a light that was changed; None where all is well."""
        shown = [[_shown(light) for light in group] for group in self._groups]
        last, self._last = self._last, shown
        if self._counted != self._changes.lights:
            self._counted, last = self._changes.lights, []  # a scenario's own change: begin anew
        for group, old, new in zip(self._groups, last, shown, strict=False):
            for light, how in zip(group, self._changed(old, new), strict=True):
                if how is not None:
                    return f"changed the traffic light {light.id}: {how}"
        return None

    def _changed(self, before: Sequence[_Shown], now: Sequence[_Shown]) -> list[str | None]:
        """For each light of a group, what is not its cycle's doing."""
        turn_over = any(
            old.colour == carla.TrafficLightState.Red and old.is_over(self._step_s) and new.elapsed_s < old.elapsed_s
            for old, new in zip(before, now, strict=True)
        )
        return [self._of_one(old, new, turn_over=turn_over) for old, new in zip(before, now, strict=True)]

    def _of_one(self, old: _Shown, new: _Shown, *, turn_over: bool) -> str | None:
        if old.frozen != new.frozen:
            return "its clock was stopped" if new.frozen else "its clock was started again"
        if old.times_s != new.times_s:
            return "the times of its colours were set"
        if new.elapsed_s < old.elapsed_s:  # its stage ended
            return None if old.is_over(self._step_s) else "its cycle was begun anew"
        if old.colour == new.colour:
            return None
        begins = new.colour == carla.TrafficLightState.Green and new.elapsed_s < ROUNDING_S and turn_over
        return None if begins else f"{COLOURS.get(old.colour, 'dark')} became {COLOURS.get(new.colour, 'dark')}"


def _shown(light: carla.TrafficLight) -> _Shown:
    """Return what a light shows in the latest snapshot; the client asks the server for none of it."""
    times_s = (light.get_green_time(), light.get_yellow_time(), light.get_red_time())
    return _Shown(light.get_state(), light.get_elapsed_time(), light.is_frozen(), times_s)


def is_same_control(one: carla.VehicleControl, other: carla.VehicleControl) -> bool:
    """Whether two controls are equal but for the rounding of the wire. Gears are left out: the vehicle shifts them."""
    return bool(
        abs(one.throttle - other.throttle) < CONTROL_TOLERANCE
        and abs(one.steer - other.steer) < CONTROL_TOLERANCE
        and abs(one.brake - other.brake) < CONTROL_TOLERANCE
        and one.hand_brake == other.hand_brake
        and one.reverse == other.reverse
    )


def taken_away(changes: WorldChanges, snapshot: carla.WorldSnapshot) -> str | None:
    """The first of the benchmark's own actors that is gone from a snapshot; None where all are there."""
    return next((name for key, name in changes.needed.items() if not snapshot.has_actor(key)), None)


def agents_change(name: str, how: str, frame: int) -> AgentCrashedError:
    """The agent's failure, for a change that the benchmark did not make."""
    return AgentCrashedError(
        f"{name} {how} before frame {frame}: an agent drives with the control that run_step() returns, and changes "
        "nothing else in the world"
    )
