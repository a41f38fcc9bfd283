"""Red lights: what each light on the route showed when the vehicle's rear crossed its line.

The rule is that of the CARLA leaderboard (ScenarioRunner, ``RunningRedLightTest``, the same in its versions 1.0, 2.0
and 2.1): a light is run when it is red in a frame in which the line lies under the vehicle's tail, the piece from 0.8
of half its length behind its middle to 1 m behind its bumper. So a vehicle that enters on
yellow and has its tail on the line when it turns red has run it; one that stops beyond the line with its tail still
before it has not. The record also states what the light showed when the front crossed.

The line of a light on the route is crossed in whichever lane the vehicle is. Off the planned lane, a vehicle also runs
another light: it leaves its zone forwards on red. The simulator says under which light a vehicle stands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from basu.metrics.incremental import ControlsWatcher, away_from
from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, evidence
from basu.metrics.json_schema import flag, listing, number, record, text
from basu.metrics.registry import Column, Drive, Metric, register
from basu.metrics.stretches import stretches
from basu.metrics.validity import in_planned_lane
from basu.records.history.model import NO_LIGHT
from basu.routing import ControlKind
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.registry import JudgedRun, Watcher
    from basu.metrics.scoring import Scoring
    from basu.records.history import History
    from basu.routing import RouteControl

STATES = ("red", "yellow", "green", "off", "unknown")  # the values of carla.TrafficLightState
RED = 0
TAIL_FROM, TAIL_BEHIND_M = 0.8, 1.0  # of half the length; beyond the bumper
ZONE_END_M = 5.0  # a zone of a light that ends so near to a line of the route is that line's


@dataclass(frozen=True, slots=True, kw_only=True)
class LightPassed:
    """What a light on the route showed when the vehicle passed it."""

    light: RouteControl
    tick: int  # in which the tail began to cross the line; where it was run, the first one on red
    front_state: str  # what it showed when the front bumper crossed
    state: str  # what it showed in ``tick``
    speed_mps: float  # in ``tick``
    run: bool


def lights_passed(history: History) -> tuple[LightPassed, ...]:
    """Every traffic light on the route with a line that the vehicle's tail crossed, in order."""
    vehicle, frames = history.facts.vehicle, history.frames
    s_m, shown = frames["route_s_m"], frames["route_light"]
    half_m = (vehicle.front_m + vehicle.rear_m) / 2.0
    speed_mps = history.speed_mps()
    found = []
    for light in history.facts.route.controls:
        if light.kind is not ControlKind.TRAFFIC_LIGHT:
            continue
        under_tail = (s_m - TAIL_FROM * half_m >= light.s_m) & (s_m - half_m - TAIL_BEHIND_M <= light.s_m)
        tail = np.flatnonzero(under_tail & (shown != NO_LIGHT))
        if len(tail) == 0:
            continue
        red = tail[shown[tail] == RED]
        tick = int(red[0]) if len(red) else int(tail[0])
        front = int(np.argmax(s_m + vehicle.front_m >= light.s_m))
        found.append(
            LightPassed(
                light=light,
                tick=tick,
                front_state=_state(shown[front]),
                state=_state(shown[tick]),
                speed_mps=float(speed_mps[tick]),
                run=len(red) > 0,
            )
        )
    return tuple(found)


def red_lights(history: History) -> tuple[Evidence, ...]:
    """One infraction for each red light that was run, on the route or beside it."""
    on_route = tuple(
        evidence(
            history,
            Infraction.RED_LIGHT,
            passed.tick,
            speed_mps=passed.speed_mps,
            other=f"traffic light {passed.light.landmark_id}",
            detail=(
                f"the rear crossed the line of traffic light {passed.light.landmark_id} on red at "
                f"{passed.speed_mps:.2f} m/s; it was {passed.front_state} when the front crossed"
            ),
        )
        for passed in lights_passed(history)
        if passed.run
    )
    return tuple(sorted((*on_route, *_off_route(history)), key=lambda found: found.tick))


def _off_route(history: History) -> tuple[Evidence, ...]:
    """Lights that do not belong to the route, run where the vehicle is beside it."""
    frames = history.frames
    state, yaw_rad = frames["traffic_light_state"], frames["yaw_rad"]
    forward_mps = frames["velocity_x_mps"] * np.cos(yaw_rad) + frames["velocity_y_mps"] * np.sin(yaw_rad)
    beside = ~in_planned_lane(history) & ~_at_line_of_route(history)
    found = []
    for _, end in stretches(state != NO_LIGHT):
        if end == len(frames) or state[end - 1] != RED or not beside[end] or forward_mps[end] <= AT_REST_MPS:
            continue
        speed_mps = float(history.speed_mps()[end])
        found.append(
            evidence(
                history,
                Infraction.RED_LIGHT,
                end,
                speed_mps=speed_mps,
                other="traffic light off the route",
                detail=f"left the zone of a light off the route on red at {speed_mps:.2f} m/s",
            )
        )
    return tuple(found)


def _at_line_of_route(history: History) -> NDArray[np.bool_]:
    """(T,) whether the line of one of the route's lights is at the vehicle."""
    vehicle, s_m = history.facts.vehicle, history.frames["route_s_m"]
    at = np.zeros(len(s_m), dtype=np.bool_)
    for light in history.facts.route.controls:
        if light.kind is ControlKind.TRAFFIC_LIGHT:
            at |= (light.s_m >= s_m - vehicle.rear_m - ZONE_END_M) & (light.s_m <= s_m + vehicle.front_m + ZONE_END_M)
    return at


def _state(value: int) -> str:
    """A carla.TrafficLightState in words."""
    return "not known" if value == NO_LIGHT else STATES[int(value)]


def _no_light(history: History) -> NDArray[np.bool_]:
    """No light's line lies under the vehicle, and no zone of a light has it in it."""
    in_no_zone: NDArray[np.bool_] = history.frames["traffic_light_state"] == NO_LIGHT
    return away_from(history, ControlKind.TRAFFIC_LIGHT, 0.0, TAIL_BEHIND_M) & in_no_zone


@register
class RedLights(Metric):
    """What each traffic light on the route showed."""

    name = "red_lights"
    title = "red lights"
    order = 30
    schema = listing(
        record(
            id=text(),
            route_s_m=number("m"),
            t_s=number("s", low=0),
            speed_mps=number("m/s", low=0),
            state_at_front=text(),
            state_at_rear=text(),
            run=flag(),
        ),
        "every traffic light of the route that was passed; states are carla.TrafficLightState's in small letters",
    )
    nothing: ClassVar[list[Any]] = []
    penalties: ClassVar[dict[str, float]] = {Infraction.RED_LIGHT.value: DEFAULT_PENALTIES[Infraction.RED_LIGHT]}

    def compute(self, drive: Drive) -> list[dict[str, Any]]:
        """A row for each light."""
        t_s = drive.history.frames["t_s"]
        return [
            {
                "id": passed.light.landmark_id,
                "route_s_m": passed.light.s_m,
                "t_s": float(t_s[passed.tick]),
                "speed_mps": passed.speed_mps,
                "state_at_front": passed.front_state,
                "state_at_rear": passed.state,
                "run": passed.run,
            }
            for passed in lights_passed(drive.history)
        ]

    def watch(self, scoring: Scoring) -> Watcher:  # noqa: ARG002 - no rule of scoring changes them
        """Return what finds the events while a drive lasts."""
        return ControlsWatcher(red_lights, _no_light)

    def find(self, drive: Drive) -> tuple[Evidence, ...]:
        """Each light that was run, on the route or beside it."""
        return red_lights(drive.history)

    def lines(self, result: JudgedRun) -> list[str]:
        """Return a line with the number of traffic lights that were run on red."""
        lights = result.metrics[self.name]
        run = sum(light["run"] for light in lights)
        return [f"traffic lights    {run} of {len(lights)} run on red"] if lights else []

    def columns(self, result: JudgedRun) -> list[Column]:
        """How many were run, those off the route with them."""
        run = sum(found.kind is Infraction.RED_LIGHT for found in result.infractions)
        return [Column("red lights", str(run))]
