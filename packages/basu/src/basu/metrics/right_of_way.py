"""Right of way: whether the ego took it from the vehicle that it collided with, and how, in words.

`entered_path` finds an ego that moved sideways into the path of a vehicle that had the lane. The ego pulled out of a
bay, or it opened a gap by changing lanes. The path is the one that the other really drove, extended straight on. So it
holds in bends, too. The gap that the other needs is that of UN Regulation No. 79 (03 series, 5.6.4.7):

    (v_other - v_ego) t_B + (v_other - v_ego)² / (2 a) + v_ego t_G,   t_B = 0.4 s, a = 3 m/s², t_G = 1 s

A gap above it may be taken. An ego that takes such a gap and then brakes by more than `a` takes it away again.

`not_yielded` finds an ego that entered a junction on red, or past a stop or yield sign before a crossing vehicle. It
also finds a left turn across an oncoming vehicle. The record holds the signs and lights of the ego's route only:

- An other vehicle that stood when the ego entered had no way to be taken. So the order at an all-way stop counts.
- A green arrow is not told from a full green; after a left turn across an oncoming vehicle the ego is at fault.
- Past a sign the clause holds for 5 s: an ego that stands in the junction for longer has been seen.
- Without a sign or light, and for priority to the right, there is no clause here.

Traffic keeps to the right, as in all of CARLA's towns: LibCarla knows no other.

The rules are those of the Ohio Revised Code: 4511.33 (changes of lanes), 4511.38 and 4511.44 (pulling out), 4511.13
(red), 4511.43 (stop and yield signs), 4511.42 (left turns).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import UNKNOWN_M, distance_m, own_boxes
from basu.metrics.lanes import DRIVING, within_one_lane
from basu.routing import ControlKind
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.routing import RouteControl

LOOK_S = 5.0  # a lane that the ego has had for longer is its own; a convention
REACTION_S, BRAKING_MPS2, TIME_GAP_S = 0.4, 3.0, 1.0  # UN Regulation No. 79, 5.6.4.7: t_B, a and t_G
BRAKED_OVER_S = 0.5  # a braking is the mean over this
AHEAD_M, SPACING_M = 60.0, 0.5  # the other's path is extended by so much both ways; records reach as far
ALONG_RAD = math.radians(135.0)  # a vehicle that comes at more is oncoming, and no follower
WAITING_MPS = 0.5  # an other vehicle that was slower when the ego entered the junction still waited
LINE_M = 15.0  # a line this far before a junction is that junction's
INSIDE_M = 3.0  # and so is one this far inside
SAME_WAY_RAD, ONCOMING_RAD = math.radians(45.0), math.radians(135.0)  # off the ego's approach to the junction
LEFT_TURN_RAD = math.radians(-45.0)  # yaw is clockwise from above
BEGUN_RAD = math.radians(-10.0)  # an ego turned by less still waits before its left turn
RED = 0  # carla.TrafficLightState


class Track(NamedTuple):
    """Where the other vehicle was, from tick to tick; CARLA's frame."""

    half_m: tuple[float, float]  # length and width of its box
    tick: NDArray[np.int64]  # (K,)
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    course_rad: NDArray[np.float64]  # of its motion; of its heading where it stands
    speed_mps: NDArray[np.float64]


def track_of(history: History, other_id: int, last: int) -> Track:
    """Return the other's track up to the tick ``last``; empty where the record does not hold it."""
    rows = history.others[(history.others["id"] == other_id) & (history.others["tick"] <= last)]
    speed_mps = np.hypot(rows["velocity_x_mps"], rows["velocity_y_mps"])
    course_rad = np.where(
        speed_mps > AT_REST_MPS, np.arctan2(rows["velocity_y_mps"], rows["velocity_x_mps"]), rows["yaw_rad"]
    )
    half_m = history.facts.actor_sizes.get(other_id, UNKNOWN_M)
    return Track(half_m, rows["tick"].astype(np.int64), rows["x_m"], rows["y_m"], course_rad, speed_mps)


def entered_path(history: History, before: int, track: Track) -> str | None:
    """Return how the ego moved sideways into the other's path until the tick ``before``; None where it did not."""
    entry = _entry(history, track, before)
    if entry is None or history.frames["in_junction"][entry] or within_one_lane(history, entry):
        return None
    at = min(int(np.searchsorted(track.tick, entry)), len(track.tick) - 1)
    gap_m = _gap_m(history, track, entry, at)
    if gap_m is None:
        return None
    course_rad, other_mps = float(track.course_rad[at]), float(track.speed_mps[at])
    frame = history.frames[entry]
    own_mps = float(frame["velocity_x_mps"] * math.cos(course_rad) + frame["velocity_y_mps"] * math.sin(course_rad))
    needed_m = needed_gap_m(other_mps, own_mps)
    way = _way(history, entry)
    if gap_m < needed_m:
        return f"the ego {way} {gap_m:.1f} m ahead of the other, which needed {needed_m:.1f} m at {other_mps:.1f} m/s"
    braked_mps2 = _braked_mps2(history, entry, before)
    if braked_mps2 > BRAKING_MPS2:
        return f"the ego {way} ahead of the other and then braked by {braked_mps2:.1f} m/s²"
    return None


def needed_gap_m(other_mps: float, own_mps: float) -> float:
    """Return the gap in m that the vehicle behind needs; ``own_mps`` is along its course, below 0 towards it."""
    forward_mps = max(0.0, own_mps)
    closing_mps = max(0.0, other_mps - forward_mps)
    return closing_mps * REACTION_S + closing_mps**2 / (2.0 * BRAKING_MPS2) + forward_mps * TIME_GAP_S


def _entry(history: History, track: Track, before: int) -> int | None:
    """The tick in which the ego came into the other's path for the last time; None where it was in it all the time."""
    first = max(int(track.tick[0]), before - round(LOOK_S / history.facts.step_s))
    path = _path_m(track)
    boxes = own_boxes(history.facts, history.frames[first : before + 1])
    outside = [index for index, box in enumerate(boxes) if float(distance_m(path, box).min()) > track.half_m[1]]
    return first + min(outside[-1] + 1, len(boxes) - 1) if outside else None


def _path_m(track: Track) -> NDArray[np.float64]:
    """(K, 2) the way that the other drove, extended straight on to both sides."""
    more_m = np.arange(SPACING_M, AHEAD_M, SPACING_M)[:, None]
    driven_m = np.column_stack([track.x_m, track.y_m])
    begin, end = (np.array([math.cos(track.course_rad[at]), math.sin(track.course_rad[at])]) for at in (0, -1))
    return np.concatenate([driven_m[0] - more_m[::-1] * begin, driven_m, driven_m[-1] + more_m * end])


def _gap_m(history: History, track: Track, entry: int, at: int) -> float | None:
    """The way from the other's front to the ego, 0 beside it; None where the ego is behind it or comes towards it."""
    course_rad = float(track.course_rad[at])
    box = own_boxes(history.facts, history.frames[entry : entry + 1])[0]
    turned_rad = float(box[2]) - course_rad
    if math.cos(turned_rad) < math.cos(ALONG_RAD):
        return None
    ahead_m = (box[0] - track.x_m[at]) * math.cos(course_rad) + (box[1] - track.y_m[at]) * math.sin(course_rad)
    reach_m = abs(math.cos(turned_rad)) * box[3] + abs(math.sin(turned_rad)) * box[4]
    if ahead_m + reach_m < -track.half_m[0]:
        return None
    return max(0.0, float(ahead_m - reach_m - track.half_m[0]))


def _way(history: History, entry: int) -> str:
    """How the ego came: out of a bay, from beside the road or from rest, or out of another lane."""
    first = max(0, entry - round(LOOK_S / history.facts.step_s))
    frames = history.frames[first : entry + 1]
    beside = (frames["lane_type"] != DRIVING) | (frames["off_lane_m"] > 0.0)
    pulled_out = beside.any() or (history.speed_mps()[first : entry + 1] < AT_REST_MPS).any()
    return "pulled out" if pulled_out else "opened a gap by changing lanes"


def _braked_mps2(history: History, entry: int, before: int) -> float:
    """The hardest braking of the ego from its entry on, mean over half a second."""
    over = max(1, round(BRAKED_OVER_S / history.facts.step_s))
    speed_mps = history.speed_mps()[max(0, entry - over) : before + 1]
    if len(speed_mps) <= over:
        return 0.0
    return float((speed_mps[:-over] - speed_mps[over:]).max()) / (over * history.facts.step_s)


class RouteJunction(NamedTuple):
    """The junction of the route that the ego is in; places along the route in m, directions in rad."""

    begin_m: float
    end_m: float
    approach_rad: float
    turn_rad: float  # from the approach to the exit, clockwise


class Entered(NamedTuple):
    """The ego's entry to a junction of its route."""

    junction: RouteJunction
    line: RouteControl | None  # the sign or light before it
    tick: int


def not_yielded(history: History, before: int, track: Track) -> str | None:
    """Return how the ego entered its junction against the other vehicle's right of way; None where it did not."""
    entered = _entered(history, before)
    return None if entered is None else _against(history, before, track, entered)


def entered_on_red(history: History, before: int) -> str | None:
    """Return in words that the ego entered its junction on red; None where it did not."""
    entered = _entered(history, before)
    if entered is None or entered.line is None or entered.line.kind is not ControlKind.TRAFFIC_LIGHT:
        return None
    if history.frames["route_light"][entered.tick] != RED:
        return None
    return f"the ego entered the junction on red, past traffic light {entered.line.landmark_id}"


def _entered(history: History, before: int) -> Entered | None:
    """The ego's entry; None where it is in no junction, or has not reached the line of the junction yet."""
    junction = _junction(history, before)
    if junction is None:
        return None
    line = _line(history, junction)
    begin_m = junction.begin_m if line is None else line.s_m
    front_m = history.frames["route_s_m"][: before + 1] + history.facts.vehicle.front_m
    reached = np.flatnonzero(front_m >= begin_m)
    return Entered(junction, line, int(reached[0])) if len(reached) else None


def _against(history: History, before: int, track: Track, entered: Entered) -> str | None:
    """How the ego entered this junction against the other's right of way."""
    at = min(int(np.searchsorted(track.tick, entered.tick)), len(track.tick) - 1)
    other_mps = float(track.speed_mps[at])
    off_rad = abs(_turned_rad(float(track.course_rad[at]) - entered.junction.approach_rad))
    if off_rad < SAME_WAY_RAD:
        return None
    on_red = entered_on_red(history, before)
    if on_red is not None or other_mps < WAITING_MPS:
        return on_red
    if off_rad >= ONCOMING_RAD:
        return _turned_left(history, before, entered.junction, other_mps)
    return _passed_sign(entered.line, (before - entered.tick) * history.facts.step_s, other_mps)


def _passed_sign(line: RouteControl | None, since_s: float, other_mps: float) -> str | None:
    """The words for an ego that passed a stop or yield sign not long ago."""
    if line is None or line.kind is ControlKind.TRAFFIC_LIGHT or since_s > LOOK_S:
        return None
    name = f"{line.kind.value.replace('_', ' ')} {line.landmark_id}"
    return f"the ego did not yield at {name} to the other, which came at {other_mps:.1f} m/s"


def _turned_left(history: History, before: int, junction: RouteJunction, other_mps: float) -> str | None:
    """The words for an ego that turns left and no longer waits along its approach."""
    turned_rad = _turned_rad(float(history.frames["yaw_rad"][before]) - junction.approach_rad)
    if junction.turn_rad > LEFT_TURN_RAD or turned_rad > BEGUN_RAD:
        return None
    return f"the ego turned left across the path of the other, which came towards it at {other_mps:.1f} m/s"


def _junction(history: History, before: int) -> RouteJunction | None:
    """The junction between the ego's bumpers, on its route."""
    route, vehicle = history.facts.route, history.facts.vehicle
    at_m = float(history.frames["route_s_m"][before])
    inside = np.flatnonzero(
        route.is_junction & (route.s_m >= at_m - vehicle.rear_m) & (route.s_m <= at_m + vehicle.front_m)
    )
    if len(inside) == 0:
        return None
    open_road = np.flatnonzero(~route.is_junction)
    first = int(open_road[open_road < inside[0]][-1]) if (open_road < inside[0]).any() else 0
    last = int(open_road[open_road > inside[0]][0]) if (open_road > inside[0]).any() else len(route.s_m) - 1
    approach_rad = float(route.yaw_rad[first])
    turn_rad = float(np.unwrap(route.yaw_rad[first : last + 1])[-1]) - approach_rad
    return RouteJunction(float(route.s_m[first]), float(route.s_m[last]), approach_rad, turn_rad)


def _line(history: History, junction: RouteJunction) -> RouteControl | None:
    """The sign or light that governs the entry to the junction: the last one near its beginning."""
    near = [
        control
        for control in history.facts.route.controls
        if junction.begin_m - LINE_M <= control.s_m <= junction.begin_m + INSIDE_M
    ]
    return near[-1] if near else None


def _turned_rad(angle_rad: float) -> float:
    """An angle within -pi to pi."""
    return math.atan2(math.sin(angle_rad), math.cos(angle_rad))
