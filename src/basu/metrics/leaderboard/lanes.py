"""How much of the way the leaderboard holds to be outside the route's lanes.

Source: ``OutsideRouteLanesTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branches leaderboard-1.0
and leaderboard-2.0. Outside is beyond the edge of the nearest driving or parking lane, by more than 1.3 m in 1.0 and
0.5 m in 2.x, or in a wrong lane. Which lane is wrong is not asked of the plan: entering another lane whose direction
turns by more than 150 degrees is going wrong, doing it once more is coming back, and after a junction the vehicle's own
heading decides. The figure is the way along the plan made meanwhile, in per cent of all the way made.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.lanes import DRIVING
from basu.metrics.leaderboard.ending import made_m
from basu.metrics.leaderboard.rules import Event, Kind, Version
from basu.metrics.stretches import total_m

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History

ALLOWED_M = {Version.V1_0: 1.3, Version.V2_0: 0.5, Version.V2_1: 0.5}
ACROSS_RAD = np.radians(120.0)  # between the vehicle and the lane that it leaves a junction on
OPPOSITE_RAD = np.radians(150.0)  # between one lane and the next


def outside_lanes(history: History, version: Version) -> tuple[Event, ...]:
    """One event with the percentage, or none."""
    frames = history.frames
    outside = (frames["off_lane_m"] > ALLOWED_M[version]) | in_wrong_lane(history, version)
    along_m = made_m(history)
    wrong = np.flatnonzero(outside & (along_m > 0.0))
    if len(wrong) == 0:
        return ()
    percentage = 100.0 * total_m(along_m[wrong]) / total_m(along_m)
    return (Event(kind=Kind.OUTSIDE_LANES, tick=int(wrong[-1]), percentage=percentage),)


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
