"""Outside the lanes and against them: how far, which share of the way, and where.

Outside is, as in the CARLA leaderboard (ScenarioRunner, ``OutsideRouteLanesTest``), a vehicle with its middle more than
0.5 m beyond the edge of the nearest driving or parking lane; the evidence names a pavement. A vehicle with its middle
in a lane of oncoming traffic is in a wrong lane. Wrong way is to move against the direction of the
lane under one's middle: overtaking through the opposite lane does, and so does reversing along one's own.

In junctions, where lanes lie over one another, no vehicle is in a wrong lane or on the wrong way: the leaderboard says
the same. Metres are of the driven path (equation 5.2), a share is of all of it.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.metrics.infraction import Incident
from basu.metrics.json_schema import mapping, number
from basu.metrics.registry import Drive, Metric, register
from basu.metrics.stretches import (
    Share,
    chords,
    path_m,
    share_line,
    share_of,
    share_record,
    share_row,
    stretches,
    total_m,
)
from basu.metrics.validity import AGAINST_RAD, BEYOND_M, PASSING_M, validity
from basu.records.partners import UNPROTECTED
from basu.thresholds import AT_REST_MPS, IN_MOTION_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.infraction import Evidence
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History

FORGIVEN_M = 2.0  # a stretch against the lane no longer than this; nuPlan's direction compliance forgives as much
PUSHED_S = 2.0  # after a message of a contact: the other party may push the vehicle, which is no driving; a convention
BEFORE_S = 5.0  # that an obstacle may have stood before the ego is beside it
AROUND_M = 20.0  # before and behind: the shifting taper of `basu.metrics.validity.PASSING_M`
BESIDE_LANE_M = 1.5  # from the lane's edge to the middle of an obstacle that stands half on it
NO_OBSTACLE, TOO_FAR = "with nothing to pass", "farther than passing takes"
# values of carla.LaneType
DRIVING, SIDEWALK = 2, 32


class Where(enum.Enum):
    """In which way a vehicle is outside its lanes."""

    OFF_ROAD = "off_road"
    SIDEWALK = "sidewalk"
    WRONG_LANE = "wrong_lane"


WORDS = {Where.OFF_ROAD: "off the road", Where.SIDEWALK: "on the pavement", Where.WRONG_LANE: "in a wrong lane"}


@dataclass(frozen=True, slots=True, kw_only=True)
class OutsideLanes:
    """How much of a drive was outside the lanes, in all and by the way of it."""

    total: Share
    metres_by_where: dict[Where, float]


def outside_lanes(history: History) -> OutsideLanes:
    """How far the vehicle went outside its lanes, one event for each stretch."""
    where = wheres(history)
    words = [WORDS[way] for way in Where]
    total = share_of(
        history,
        where >= 0,
        Incident.OUTSIDE_LANES,
        lambda first, end: words[int(np.bincount(where[first:end]).argmax())],
    )
    pieces = chords(path_m(history.frames))
    at = where[pieces.end]
    metres = {way: total_m(pieces.length_m[at == index]) for index, way in enumerate(Where)}
    return OutsideLanes(total=total, metres_by_where=metres)


def wrong_way(history: History) -> Share:
    """How far the vehicle moved against the direction of its lane, one event for each stretch of 2 m and more."""
    frames = history.frames
    moving = np.hypot(frames["velocity_x_mps"], frames["velocity_y_mps"]) > AT_REST_MPS
    course_rad = np.arctan2(frames["velocity_y_mps"], frames["velocity_x_mps"])
    lane_rad = frames["yaw_rad"] - frames["lane_heading_rad"]
    against = np.cos(course_rad - lane_rad) < np.cos(AGAINST_RAD)  # nan, where there is no lane, is not
    directed = (frames["lane_type"] == DRIVING) & (frames["in_junction"] == 0)
    return share_of(
        history,
        moving & directed & against,
        Incident.WRONG_WAY,
        lambda _first, _end: "against the direction of its lane",
        forgiven_m=FORGIVEN_M,
    )


def off_road(history: History) -> tuple[Evidence, ...]:
    """One event for each stretch off the road or on the pavement; a wrong lane may be needed to pass something."""
    where = wheres(history)
    beside = [list(Where).index(way) for way in (Where.OFF_ROAD, Where.SIDEWALK)]
    share = share_of(
        history,
        np.isin(where, beside),
        Incident.OUTSIDE_LANES,
        lambda first, end: WORDS[list(Where)[int(np.bincount(where[first:end]).argmax())]],
    )
    return share.events


def against_route(history: History) -> tuple[Evidence, ...]:
    """Return one event for each stretch of more than 2 m in which the vehicle points or moves against its route.

    The 2 s after a contact do not count: a contact has a fault of its own (`basu.metrics.fault`).
    """
    pushed = np.zeros(len(history.frames), dtype=np.bool_)
    for event in history.collisions:
        pushed[event.tick : event.tick + round(PUSHED_S / history.facts.step_s) + 1] = True
    share = share_of(
        history,
        _is_against(history) & ~pushed,
        Incident.WRONG_WAY,
        lambda _first, _end: "against the direction of the route",
        forgiven_m=FORGIVEN_M,
    )
    return share.events


def in_oncoming_lane(history: History) -> tuple[Evidence, ...]:
    """Return one event for each stretch of more than 2 m in a lane of oncoming traffic that passes no obstacle.

    An obstacle is slower than 0.5 m/s, or a walker or a cyclist. Its middle is at most 1.5 m beyond the planned lane's
    edge and at most 20 m before or behind the stretch. It counts from 5 s before the stretch to its end. A stretch of
    more than `PASSING_M` passes none. What is against the route is left to `against_route`.
    """
    oncoming = wheres(history) == list(Where).index(Where.WRONG_LANE)
    if not oncoming.any():
        return ()
    oncoming &= ~_is_against(history)
    unneeded = np.zeros_like(oncoming)
    for first, end in stretches(oncoming):
        unneeded[first:end] = not _passes(history, first, end)
    found = [
        share_of(history, frames, Incident.OUTSIDE_LANES, words, forgiven_m=forgiven_m).events
        for frames, words, forgiven_m in (
            (unneeded, lambda _first, _end: NO_OBSTACLE, FORGIVEN_M),
            (oncoming & ~unneeded, lambda _first, _end: TOO_FAR, PASSING_M),
        )
    ]
    return tuple(sorted((event for events in found for event in events), key=lambda event: event.tick))


def _is_against(history: History) -> NDArray[np.bool_]:
    """(T,) whether the vehicle points or moves against its route."""
    return np.array([check.against for check in validity(history).checks], dtype=np.bool_)


def _passes(history: History, first: int, end: int) -> bool:
    """Whether an obstacle stands on the planned lane beside the frames from ``first`` to ``end``."""
    frames, others, route = history.frames, history.others, history.facts.route
    ticks = frames["tick"][[max(0, first - round(BEFORE_S / history.facts.step_s)), end - 1]]
    near = others[(others["tick"] >= ticks[0]) & (others["tick"] <= ticks[1])]
    speed_mps = np.hypot(near["velocity_x_mps"], near["velocity_y_mps"])
    slow = [key for key, kind in history.facts.actor_types.items() if kind.startswith(UNPROTECTED)]
    near = near[(speed_mps < IN_MOTION_MPS) | np.isin(near["id"], slow)]
    if not len(near):
        return False
    way_s_m = frames["route_s_m"][first:end]
    beside = (route.s_m >= way_s_m.min() - AROUND_M) & (route.s_m <= way_s_m.max() + AROUND_M)
    points_m, reach_m = route.points_m[beside, :2], np.nan_to_num(route.lane_width_m[beside]) / 2.0 + BESIDE_LANE_M
    places_m = np.column_stack([near["x_m"], near["y_m"]])
    away_m = np.linalg.norm(places_m[:, None, :] - points_m[None, :, :], axis=2)
    return bool((away_m <= reach_m).any())


def wheres(history: History) -> NDArray[np.int64]:
    """(T,) the index in ``Where`` of each frame, -1 within the lanes."""
    frames = history.frames
    off = frames["off_lane_m"] > BEYOND_M
    oncoming = (
        (frames["lane_type"] == DRIVING)
        & (frames["in_junction"] == 0)
        & (np.abs(frames["lane_heading_rad"]) > AGAINST_RAD)
    )
    order = list(Where)
    found = np.full(len(frames), -1, dtype=np.int64)
    found[oncoming] = order.index(Where.WRONG_LANE)
    found[off] = order.index(Where.OFF_ROAD)
    found[off & (frames["lane_type"] == SIDEWALK)] = order.index(Where.SIDEWALK)
    return found


def within_one_lane(history: History, tick: int) -> bool:
    """Whether the whole box of the ego lies in one lane; in a junction, where lanes overlap, in the planned one.

    nuPlan asks whether all corners of the ego's box lie in one lane or in connected ones.
    """
    frame, route = history.frames[tick], history.facts.route
    if frame["in_junction"]:
        index = max(0, int(np.searchsorted(route.s_m, frame["route_s_m"], side="right")) - 1)
        offset_m, width_m = float(frame["lateral_m"]), float(route.lane_width_m[index])
        heading_rad = float(frame["yaw_rad"]) - float(
            np.interp(frame["route_s_m"], route.s_m, np.unwrap(route.yaw_rad))
        )
    else:
        offset_m, width_m = float(frame["lane_offset_m"]), float(frame["lane_width_m"])
        heading_rad = float(frame["lane_heading_rad"])
    if not (math.isfinite(offset_m) and math.isfinite(width_m)) or frame["off_lane_m"] > 0.0:
        return False
    vehicle = history.facts.vehicle
    corners_m = [
        offset_m + along_m * math.sin(heading_rad) + beside_m * math.cos(heading_rad)
        for along_m in (vehicle.front_m, -vehicle.rear_m)
        for beside_m in (vehicle.width_m / 2.0, -vehicle.width_m / 2.0)
    ]
    return max(map(abs, corners_m)) <= width_m / 2.0


@register
class OutsideOfLanes(Metric):
    """How much of the way lay outside of lanes for vehicles."""

    name = "outside_lanes"
    title = "outside lanes"
    order = 61
    schema = share_record("driven outside of lanes for vehicles", metres_by_where=mapping(number("m", low=0)))

    def compute(self, drive: Drive) -> dict[str, Any]:
        """Way, share, time and stretches, and the way by the kind of place."""
        found = outside_lanes(drive.history)
        return {
            **share_row(found.total),
            "metres_by_where": {where.value: metres for where, metres in found.metres_by_where.items()},
        }

    def lines(self, result: JudgedRun) -> list[str]:
        """A line where it happened."""
        return share_line(self.title, result.metrics[self.name])


@register
class WrongWay(Metric):
    """How much of the way went against the direction of the lane."""

    name = "wrong_way"
    title = "wrong way"
    order = 62
    schema = share_record("driven against the lane's direction")

    def compute(self, drive: Drive) -> dict[str, Any]:
        """Return way, share, time and stretches against the lane's direction."""
        return share_row(wrong_way(drive.history))

    def lines(self, result: JudgedRun) -> list[str]:
        """A line where it happened."""
        return share_line(self.title, result.metrics[self.name])
