"""`cause` finds the reason for a harsh stop in a record: contact, actor, line, stop, speed limit, bend, or nothing.

A cause is anything that demands less speed within the reach of a comfortable braking: a second of reaction, then
1.0 m/s² (`balance.STEP_MPS2`), and two metres to spare. What is farther away is no reason to brake harshly yet. A stop
with no such reason is a phantom stop, as that of 20 February 2020 was. An actor is ahead where its box, moving on,
touches the corridor that the vehicle is about to sweep.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import distance_m, other_boxes
from basu.metrics.passengers.felt import STEP_MPS2
from basu.metrics.speeding import limits_mps
from basu.metrics.validity import in_planned_lane
from basu.routing import ControlKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from basu.metrics.passengers.harsh_stops import HarshStop
    from basu.records.history import History


MARGIN_M = 0.3  # beside the vehicle
SPACING_M = 0.5
HORIZON_S, LOOK_S = 3.0, 0.25  # how far ahead others are moved on, and how finely
SLACK_S = 2.0  # an actor at a place within this of the vehicle's own arrival is in its way


class InTheWay(NamedTuple):
    """An actor ahead."""

    name: str  # blueprint id and actor id
    away_m: float  # from the front bumper along the corridor
    speed_mps: float  # along it, not below 0


def in_the_way(history: History, tick: int, reach_m: float) -> Iterator[InTheWay]:
    """All actors in the corridor within ``reach_m``, or about to be there, in the frame ``tick``."""
    facts, frame = history.facts, history.frames[tick]
    path_m = _corridor(history, tick, reach_m)
    near = history.others[history.others["tick"] == frame["tick"]]
    speed_mps = max(0.5, math.hypot(frame["velocity_x_mps"], frame["velocity_y_mps"]))
    arrival_s = np.arange(len(path_m)) * SPACING_M / speed_mps
    for row, box in zip(near, other_boxes(facts, near), strict=True):
        for after_s in np.arange(0.0, HORIZON_S + LOOK_S / 2.0, LOOK_S).tolist():
            moved = box + np.array([row["velocity_x_mps"], row["velocity_y_mps"], 0.0, 0.0, 0.0]) * after_s
            blocked = distance_m(path_m, moved) <= facts.vehicle.width_m / 2.0 + MARGIN_M
            if after_s > 0.0:
                blocked &= np.abs(arrival_s - after_s) <= SLACK_S
            if blocked.any():
                first = int(np.argmax(blocked))
                yield InTheWay(
                    name=f"{facts.actor_types.get(int(row['id']), 'an unknown type')} (actor {int(row['id'])})",
                    away_m=first * SPACING_M,
                    speed_mps=_along(path_m, first, float(row["velocity_x_mps"]), float(row["velocity_y_mps"])),
                )
                break


def _corridor(history: History, tick: int, reach_m: float) -> NDArray[np.float64]:
    """(K, 2) the middle of the way ahead of the front bumper: the route, as far beside it as the vehicle is.

    Off the planned lane the vehicle is taken to go straight on.
    """
    route, front_m, frame = history.facts.route, history.facts.vehicle.front_m, history.frames[tick]
    ahead_m = np.arange(0.0, reach_m + SPACING_M, SPACING_M)
    if not in_planned_lane(history)[tick]:
        yaw_rad, along_m = float(frame["yaw_rad"]), front_m + ahead_m
        heading = np.array([math.cos(yaw_rad), math.sin(yaw_rad)])
        straight: NDArray[np.float64] = np.array([frame["x_m"], frame["y_m"]]) + along_m[:, None] * heading
        return straight
    s_m = np.minimum(float(frame["route_s_m"]) + front_m + ahead_m, route.length_m)
    points_m = np.column_stack([np.interp(s_m, route.s_m, route.points_m[:, axis]) for axis in (0, 1)])
    yaw_rad = np.interp(s_m, route.s_m, np.unwrap(route.yaw_rad))
    beside: NDArray[np.float64] = np.column_stack([-np.sin(yaw_rad), np.cos(yaw_rad)]) * float(frame["lateral_m"])
    return points_m + beside


def _along(path_m: NDArray[np.float64], index: int, velocity_x_mps: float, velocity_y_mps: float) -> float:
    """The part of a velocity that goes the corridor's way, not below 0: an oncoming actor counts as a wall."""
    first = min(index, len(path_m) - 2)
    ahead = path_m[first + 1] - path_m[first]
    length_m = float(np.hypot(*ahead))
    if length_m == 0.0:
        return 0.0
    return max(0.0, float(ahead[0] * velocity_x_mps + ahead[1] * velocity_y_mps) / length_m)


THINK_S, SPARE_M = 1.0, 2.0
BEYOND_M = 1.0  # a line this far behind the front bumper is still braked for
CONTACT_S = 0.5  # a braking that begins this near to a contact is the contact's
SLOWER_MPS = 0.5  # a limit or bend asks for a slowdown only where it is lower than the speed by this
BEND_M = 3.0  # over which a bend's curvature is taken
RED, YELLOW = 0, 1  # carla.TrafficLightState
LOOK_BACK_S = 2.0  # what the vehicle did before a phantom stop


class StopCause(enum.Enum):
    """What a harsh stop was for."""

    CONTACT = "contact"
    ACTOR = "actor"
    STOP_SIGN = "stop_sign"
    YIELD_SIGN = "yield_sign"
    TRAFFIC_LIGHT = "traffic_light"
    SERVICE_STOP = "service_stop"
    ROUTE_END = "route_end"
    LIMIT = "limit"
    BEND = "bend"
    NOTHING = "nothing"


class Cause(NamedTuple):
    """One reason, and the braking from the stop's onset on that would have met it."""

    kind: StopCause
    away_m: float  # from the front bumper; nan for nothing
    needed_mps2: float  # 0 for nothing
    detail: str


def cause(history: History, stop: HarshStop) -> Cause:
    """A contact, else the reason with the largest demand, else `StopCause.NOTHING` with its details."""
    contact = _contact(history, stop)
    if contact is not None:
        return contact
    found = max(_reasons(history, stop), key=lambda reason: reason.needed_mps2, default=None)
    return _nothing(history, stop) if found is None else found


def reach_m(speed_mps: float) -> float:
    """How far ahead something may be a reason."""
    return speed_mps * THINK_S + speed_mps**2 / (2.0 * STEP_MPS2) + SPARE_M


def _reasons(history: History, stop: HarshStop) -> Iterator[Cause]:
    """All reasons for less speed within reach."""
    yield from _lines(history, stop)
    yield from _halts(history, stop)
    yield from _slowdowns(history, stop)
    for actor in in_the_way(history, stop.onset_tick, reach_m(stop.from_mps)):
        yield _reason(StopCause.ACTOR, stop, actor.away_m, actor.speed_mps, actor.name)


def _reason(kind: StopCause, stop: HarshStop, away_m: float, target_mps: float, name: str) -> Cause:
    """A reason to be no faster than ``target_mps`` after ``away_m``."""
    excess = max(0.0, stop.from_mps**2 - target_mps**2)
    needed_mps2 = excess / (2.0 * max(away_m, 0.5))
    return Cause(kind, away_m, needed_mps2, f"{name} {away_m:.1f} m ahead demanded {needed_mps2:.2f} m/s²")


def _contact(history: History, stop: HarshStop) -> Cause | None:
    """Return the collision that explains a braking, if there was one."""
    slack = round(CONTACT_S / history.facts.step_s)
    for event in history.collisions:
        if stop.onset_tick - slack <= event.tick <= stop.tick:
            return Cause(StopCause.CONTACT, 0.0, stop.strongest_mps2, f"the vehicle hit {event.other_type}")
    return None


def _lines(history: History, stop: HarshStop) -> Iterator[Cause]:
    """Stop and yield lines ahead, and traffic lights that do not show green."""
    front_s_m = float(history.frames["route_s_m"][stop.onset_tick]) + history.facts.vehicle.front_m
    shown = history.frames["route_light"][stop.onset_tick : stop.tick + 1]
    for control in history.facts.route.controls:
        away_m = control.s_m - front_s_m
        if not -BEYOND_M <= away_m <= reach_m(stop.from_mps):
            continue
        if control.kind is ControlKind.TRAFFIC_LIGHT and not np.isin(shown, (RED, YELLOW)).any():
            continue
        name = f"{control.kind.value.replace('_', ' ')} {control.landmark_id}"
        yield _reason(StopCause(control.kind.value), stop, max(away_m, 0.0), 0.0, name)


def _halts(history: History, stop: HarshStop) -> Iterator[Cause]:
    """Service stops, where the vehicle's origin halts, and the end of the route."""
    route, at_m = history.facts.route, float(history.frames["route_s_m"][stop.onset_tick])
    ends = [(StopCause.SERVICE_STOP, s.s_m, f"service stop '{s.name}'") for s in route.stops]
    for kind, s_m, name in [*ends, (StopCause.ROUTE_END, route.length_m, "the end of the route")]:
        if -BEYOND_M <= s_m - at_m <= reach_m(stop.from_mps):
            yield _reason(kind, stop, max(s_m - at_m, 0.0), 0.0, name)


def _slowdowns(history: History, stop: HarshStop) -> Iterator[Cause]:
    """A limit, here or ahead, below the speed; a bend too tight for it."""
    route, tick = history.facts.route, stop.onset_tick
    at_m = float(history.frames["route_s_m"][tick])
    here_mps = float(limits_mps(history)[tick])
    if here_mps < stop.from_mps - SLOWER_MPS:
        needed_mps2 = (stop.from_mps**2 - here_mps**2) / (2.0 * reach_m(stop.from_mps))
        detail = f"the limit of {here_mps:.1f} m/s, exceeded already, demanded {needed_mps2:.2f} m/s²"
        yield Cause(StopCause.LIMIT, 0.0, needed_mps2, detail)
    ahead = np.flatnonzero((route.s_m > at_m) & (route.s_m <= at_m + reach_m(stop.from_mps)))
    for index in ahead.tolist():
        limit_mps = float(route.speed_limit_mps[index])
        if limit_mps < min(stop.from_mps - SLOWER_MPS, here_mps):
            yield _reason(
                StopCause.LIMIT, stop, float(route.s_m[index]) - at_m, limit_mps, f"a limit of {limit_mps:.1f} m/s"
            )
            break
    for index in ahead.tolist():
        other = min(int(np.searchsorted(route.s_m, route.s_m[index] + BEND_M)), len(route.s_m) - 1)
        turn_rad = np.angle(np.exp(1j * (route.yaw_rad[other] - route.yaw_rad[index])))
        curvature_1pm = abs(float(turn_rad)) / max(float(route.s_m[other] - route.s_m[index]), 1.0)
        bend_mps = (STEP_MPS2 / max(curvature_1pm, 1e-6)) ** 0.5
        if bend_mps < stop.from_mps - SLOWER_MPS:
            name = f"a bend of {1.0 / curvature_1pm:.0f} m radius"
            yield _reason(StopCause.BEND, stop, float(route.s_m[index]) - at_m, bend_mps, name)


def _nothing(history: History, stop: HarshStop) -> Cause:
    """A phantom stop, with what the vehicle did in the seconds before it."""
    frames, tick = history.frames, stop.onset_tick
    before = frames[max(0, tick - round(LOOK_BACK_S / history.facts.step_s)) : tick + 1]
    drift_m = float(np.ptp(before["lateral_m"]))
    detail = (
        f"nothing was ahead within {reach_m(stop.from_mps):.1f} m; in the {LOOK_BACK_S:.0f} s before, the place across "
        f"the route changed by {drift_m:.2f} m and the steering by {float(np.ptp(before['steer'])):.3f} of full lock"
    )
    return Cause(StopCause.NOTHING, float("nan"), 0.0, detail)
