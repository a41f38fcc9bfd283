"""The leaderboard's infractions: contacts that count as collisions, distance outside the lanes, too low a speed.

Sources: ``CollisionTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branches leaderboard-1.0 and
leaderboard-2.0 (2.1 is the same). In all of them a party that was just hit is not counted again for 5 s. Version 1.0
forgets a place when the vehicle is 5 m away and counts nothing within 3 m of one it remembers. Version 2 remembers the
last place only, counts nothing within 5 m of it, and nothing that happens to a vehicle at rest, which is not its fault.
Both ignore pavements. The two seconds of silence that divide contacts in BASU's own score are another rule: there, a
wall that is scraped along for 20 m is hit once, here every 5 m.

Source: ``OutsideRouteLanesTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branches leaderboard-1.0
and leaderboard-2.0. Outside is beyond the edge of the nearest driving or parking lane, by more than 1.3 m in 1.0 and
0.5 m in 2.x, or in a wrong lane. The plan does not decide which lane is wrong: entering another lane with a direction
that turns by more than 150 degrees is going wrong, doing it once more is coming back, and after a junction the
vehicle's own heading decides. The figure is the way along the plan made meanwhile, in per cent of all the way made.

Source: ``MinimumSpeedRouteTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branch leaderboard-2.0,
with the four check points that ``route_scenario.py`` gives it. On each quarter of the route the vehicle's mean speed is
compared with the mean speed of all background vehicles; what is below 100 % is an infraction by its percentage. A drive
without traffic has none. The leaderboard asks the whole world for its background vehicles; the record has the sixteen
nearest within 60 m, so these count, and of them the ones that moved at all (a parked car is no traffic).
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.lanes import DRIVING
from basu.metrics.leaderboard.ending import made_m, passed_m
from basu.metrics.leaderboard.rules import Kind, LeaderboardEvent, Version
from basu.metrics.stretches import total_m

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray

    from basu.records.history import Collision, History


Place = tuple[float, float]
SAME_PLACE_M, FORGOTTEN_M, SAME_PARTY_S = 3.0, 5.0, 5.0  # 1.0: MIN_AREA, MAX_AREA, MAX_ID_TIME
RADIUS_M, AT_REST_MPS = 5.0, 0.1  # 2.x: COLLISION_RADIUS, EPSILON


@dataclass(slots=True)
class _CollisionMemory:
    """What a version still knows of earlier collisions."""

    places: list[Place] = field(default_factory=list)
    party: int | None = None
    party_t_s: float = 0.0

    def forget(self, here: Place, t_s: float) -> None:
        """Drop what is far away or long ago."""
        self.places = [place for place in self.places if math.dist(place, here) <= FORGOTTEN_M]
        if self.party is not None and t_s - self.party_t_s > SAME_PARTY_S:
            self.party = None


def collisions(history: History, version: Version) -> tuple[LeaderboardEvent, ...]:
    """The collisions that ``version`` counts."""
    frames, speed_mps = history.frames, history.speed_mps()
    near_m = SAME_PLACE_M if version is Version.V1_0 else RADIUS_M
    memory = _CollisionMemory()
    found = []
    messages: dict[int, list[Collision]] = defaultdict(list)
    for event in history.collisions:
        messages[event.tick].append(event)
    for tick in range(min(messages, default=0), len(frames) if messages else 0):
        here: Place = (float(frames["x_m"][tick]), float(frames["y_m"][tick]))
        t_s = float(frames["t_s"][tick])
        for event in messages.get(tick, ()):
            if memory.party == event.other_id or any(math.dist(place, here) <= near_m for place in memory.places):
                continue
            if version is not Version.V1_0 and speed_mps[max(0, tick - 1)] < AT_REST_MPS:
                continue
            kind = _kind(event)
            if version is Version.V1_0 and kind is None:
                continue
            memory.places = [*memory.places, here] if version is Version.V1_0 else [here]
            memory.party_t_s = t_s
            if event.other_id != 0:
                memory.party = event.other_id
            if kind is not None:
                found.append(LeaderboardEvent(kind=kind, tick=tick))
        memory.forget(here, t_s)
    return tuple(found)


def _kind(event: Collision) -> Kind | None:
    """What was hit, None for what does not count."""
    what = event.other_type
    if ("static" in what or "traffic" in what) and "sidewalk" not in what:
        return Kind.COLLISION_STATIC
    if "vehicle" in what:
        return Kind.COLLISION_VEHICLE
    return Kind.COLLISION_PEDESTRIAN if "walker" in what else None


ALLOWED_M = {Version.V1_0: 1.3, Version.V2_0: 0.5, Version.V2_1: 0.5}
ACROSS_RAD = np.radians(120.0)  # between the vehicle and the lane that it leaves a junction on
OPPOSITE_RAD = np.radians(150.0)  # between one lane and the next


def outside_lanes(history: History, version: Version) -> tuple[LeaderboardEvent, ...]:
    """One event with the percentage, or none."""
    frames = history.frames
    outside = (frames["off_lane_m"] > ALLOWED_M[version]) | in_wrong_lane(history, version)
    along_m = made_m(history)
    wrong = np.flatnonzero(outside & (along_m > 0.0))
    if len(wrong) == 0:
        return ()
    percentage = 100.0 * total_m(along_m[wrong]) / total_m(along_m)
    return (LeaderboardEvent(kind=Kind.OUTSIDE_LANES, tick=int(wrong[-1]), percentage=percentage),)


def in_wrong_lane(history: History, version: Version) -> NDArray[np.bool_]:
    """(T,) whether the leaderboard takes the vehicle to be in a wrong lane.

    The leaderboard looks for the nearest driving lane even from beside the road. The record has the lane under the
    vehicle, so beside the road the last driving lane is the one that counts.
    """
    frames = history.frames
    wrong = np.zeros(len(frames), dtype=np.bool_)
    on_lane = np.flatnonzero(frames["lane_type"] == DRIVING)
    if len(on_lane) == 0:
        return wrong
    rows = frames[on_lane]
    lane_rad = rows["yaw_rad"] - rows["lane_heading_rad"]
    junction = rows["in_junction"] != 0
    entered = (np.diff(rows["road_id"]) != 0) | (np.diff(rows["lane_id"]) != 0) | (np.diff(rows["in_junction"]) > 0)
    state, since = False, 0
    for row in (np.flatnonzero(entered) + 1).tolist():
        wrong[on_lane[since] : on_lane[row]] = state
        since = row
        if junction[row]:
            state = False
        elif junction[row - 1]:
            state = bool(np.cos(rows["lane_heading_rad"][row]) < np.cos(ACROSS_RAD))
        elif np.cos(lane_rad[row] - lane_rad[row - 1]) < np.cos(OPPOSITE_RAD):
            state = not state
        elif version is Version.V1_0:
            state = False
    wrong[on_lane[since] :] = state
    return wrong


CHECKPOINTS = 4
LAST_AT = 0.95  # of the route: a drive that ends beyond it has its last quarter judged
MOVED_MPS = 0.1


def too_slow(history: History, cast: Collection[int] = ()) -> tuple[LeaderboardEvent, ...]:
    """One event for each quarter of the route on which the vehicle was slower than the traffic.

    ``cast`` are the actors of scenarios, which are no traffic: the leaderboard takes its background vehicles alone.
    """
    route, frames = history.facts.route, history.frames
    farthest_m = passed_m(history)
    quarter_m = route.length_m / CHECKPOINTS
    traffic_mps = _traffic_mps(history, cast)
    speed_mps = history.speed_mps()
    first, begun_m = 0, 0.0
    found = []
    while first < len(frames):
        beyond = np.flatnonzero(farthest_m[first:] - begun_m > quarter_m)
        if len(beyond) == 0:
            break
        end = first + int(beyond[0])
        found.append(_judged(traffic_mps[first:end], speed_mps[first:end], end))
        first, begun_m = end, float(farthest_m[end])
    if float(farthest_m[-1]) / route.length_m > LAST_AT:
        found.append(_judged(traffic_mps[first:], speed_mps[first:], len(frames) - 1))
    return tuple(event for event in found if event is not None)


def _judged(traffic_mps: NDArray[np.float64], speed_mps: NDArray[np.float64], tick: int) -> LeaderboardEvent | None:
    """What comes of one stretch; frames without traffic do not count."""
    with_traffic = np.isfinite(traffic_mps)
    mean_mps = float(traffic_mps[with_traffic].mean()) if with_traffic.any() else 0.0
    if mean_mps == 0.0:
        return None
    percentage = round(float(speed_mps[with_traffic].mean()) / mean_mps * 100.0, 2)
    return LeaderboardEvent(kind=Kind.MIN_SPEED, tick=tick, percentage=percentage) if percentage < 100.0 else None


def _traffic_mps(history: History, cast: Collection[int]) -> NDArray[np.float64]:
    """(T,) mean speed of the vehicles near in each frame, nan where there are none."""
    others = history.others
    speed_mps = np.hypot(others["velocity_x_mps"], others["velocity_y_mps"])
    types = history.facts.actor_types.items()
    vehicles = [actor for actor, what in types if what.startswith("vehicle.") and actor not in cast]
    traffic = np.isin(others["id"], np.unique(others["id"][speed_mps > MOVED_MPS])) & np.isin(others["id"], vehicles)
    count = np.bincount(others["tick"][traffic], minlength=len(history.frames))
    summed = np.bincount(others["tick"][traffic], weights=speed_mps[traffic], minlength=len(history.frames))
    mean_mps: NDArray[np.float64] = np.divide(summed, count, out=np.full(len(count), np.nan), where=count > 0)
    return mean_mps
