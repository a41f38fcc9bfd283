"""Kernels that follow many vehicles along one route by the rules of `basu`: place, valid progress, end of the drive.

The rules are functions of numbers in `basu`. They are compiled here, so that `basu` needs no compiler.
"""

from __future__ import annotations

import math
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basu.conditions import STEP_S
from basu.metrics import delays, ending, path_following, scoring, speeding, stop_signs, validity
from basu.routing import planned_route
from linden.compiled import fingerprint, kept_part, part

F64 = NDArray[np.float64]

DRIVE = np.dtype(
    [
        ("tick", "i8"),  # of the latest frame; -1 before the first
        ("s_m", "f8"),  # along the route
        ("lateral_m", "f8"),  # off the route, positive to the right
        ("distance_m", "f8"),  # from the route
        ("at", "i8"),  # the route's point before the place
        ("off_edge_m", "f8"),  # beyond the edge of the planned lane, where that is too far; 0 otherwise
        ("x_m", "f8"),
        ("y_m", "f8"),
        ("in_lane", "?"),
        ("valid", "?"),
        ("spare_m", "f8"),  # these three: as `basu.metrics.validity.Follower` has them
        ("all_beside", "?"),
        ("reached_m", "f8"),
        ("gaps", "i8"),
        ("gap_m", "f8"),  # all gaps together
        ("moved_tick", "i8"),  # of the latest frame in which the vehicle was not at rest
        ("limit_s", "f8"),  # time that the drive may take
        ("ending", "i8"),  # of `basu.metrics.ending`
    ],
    align=True,
)

EPISODE = np.dtype([("is_open", "?"), ("first", "i8"), ("end", "i8"), ("pieces", "i8"), ("gained_m", "f8")], align=True)
"""An episode of speeding, as `basu.metrics.speeding.EpisodeFinder` has it."""

_MODULES = (delays, ending, path_following, planned_route, scoring, speeding, stop_signs, validity)
SOURCES = fingerprint(Path(__file__), *(Path(str(module.__file__)) for module in _MODULES))


def parts_of(module: ModuleType, *names: str) -> Any:  # noqa: ANN401 - numba's
    """Compile functions of a module, each of which calls only those before it, and return the last of them."""
    known = dict(vars(module))
    for name in names:
        known[name] = part(FunctionType(known[name].__code__, known, name))
    return known[names[-1]]


_search_window = part(planned_route.search_window)
_foot_on_segment = part(planned_route.foot_on_segment)
_too_far_beyond_m = part(validity.too_far_beyond_m)
_is_against = part(validity.is_against)
_jumped_m = part(validity.jumped_m)
_is_beside = part(validity.is_beside)
_followed = part(validity.followed)
_has_arrived = part(path_following.has_arrived)
_ending_of = part(ending.ending_of)
_stops_at = parts_of(stop_signs, "in_zone", "stops_at")
_exceeds = part(speeding.exceeds)
_is_whole = part(speeding.is_whole)
_lasts = part(speeding.lasts)
_BLOCKED_MPS, _TOLERANCE_MPS = delays.BLOCKED_MPS, scoring.TOLERANCE_MPS


def begun(s_m: F64, limit_s: F64) -> Any:  # noqa: ANN401 - an array of records
    """Return the records of drives (K,) that have had no frame, from places (K,) along the route."""
    drives = np.zeros(len(s_m), DRIVE)
    drives["s_m"], drives["reached_m"], drives["limit_s"] = s_m, s_m, limit_s
    drives["tick"], drives["valid"], drives["all_beside"] = -1, True, True
    drives["spare_m"] = validity.PASSING_M
    return drives


@kept_part(SOURCES)
def locate(
    drives: Any,  # noqa: ANN401 - an array of records
    rows: NDArray[np.int64],
    route_s_m: F64,
    points_m: F64,
    widths_m: F64,
    x_m: F64,
    y_m: F64,
) -> None:  # pragma: no cover - compiled
    """Advance the places of vehicles (K,) at (x, y), with drives in ``rows``, along the route of N points."""
    last = len(route_s_m) - 1
    for k in range(len(rows)):
        drive = drives[rows[k]]
        back_m, ahead_m = _search_window(drive.s_m, drive.distance_m)
        first = max(0, int(np.searchsorted(route_s_m, back_m)) - 1)
        end = min(last + 1, int(np.searchsorted(route_s_m, ahead_m)) + 1)
        nearest, least = first, math.inf
        for index in range(first, end):
            away2 = (points_m[index, 0] - x_m[k]) ** 2 + (points_m[index, 1] - y_m[k]) ** 2
            if away2 < least:
                nearest, least = index, away2
        s_m, lateral_m, distance_m = 0.0, 0.0, math.inf
        for index in range(max(0, nearest - 1), min(nearest, last - 1) + 1):
            place = _foot_on_segment(
                route_s_m[index],
                points_m[index, 0],
                points_m[index, 1],
                points_m[index + 1, 0],
                points_m[index + 1, 1],
                x_m[k],
                y_m[k],
            )
            if place[2] < distance_m:
                s_m, lateral_m, distance_m = place
        at = max(0, int(np.searchsorted(route_s_m, s_m, side="right")) - 1)
        drive.at, drive.off_edge_m = at, _too_far_beyond_m(lateral_m, widths_m[at])
        drive.lateral_m, drive.distance_m = lateral_m, distance_m
        drive.reached_m, drive.s_m = (s_m if drive.tick < 0 else drive.reached_m), s_m


@kept_part(SOURCES)
def judge(
    drives: Any,  # noqa: ANN401 - an array of records
    rows: NDArray[np.int64],
    before_s_m: F64,
    route_s_m: F64,
    route_yaw_rad: F64,
    widths_m: F64,
    x_m: F64,
    y_m: F64,
    yaw_rad: F64,
    velocity_x_mps: F64,
    velocity_y_mps: F64,
    speed_mps: F64,
    off_lane_m: F64,
    same_side: NDArray[np.bool_],
) -> None:  # pragma: no cover - compiled
    """Check the frames of vehicles (K,) after `locate`, add their way, and note how drives end.

    ``before_s_m`` are the places of the frames before. ``off_lane_m`` and ``same_side`` are read where a vehicle is too
    far beyond its lane. They say how far it is from all lanes, and whether it is in another lane of the planned road.
    """
    for k in range(len(rows)):
        drive = drives[rows[k]]
        at = drive.at
        against = _is_against(yaw_rad[k], velocity_x_mps[k], velocity_y_mps[k], route_yaw_rad[at])
        beyond_m = 0.0 if same_side[k] else drive.off_edge_m
        jump_m = 0.0
        if drive.tick >= 0:
            jump_m = _jumped_m(drive.s_m - before_s_m[k], x_m[k] - drive.x_m, y_m[k] - drive.y_m)
        beside = _is_beside(off_lane_m[k], beyond_m, widths_m[at], against, jump_m)
        in_lane = beyond_m == 0.0 and not against
        valid = in_lane and jump_m == 0.0
        if drive.tick >= 0:
            spare_m, all_beside, reached_m, gap_m = _followed(
                drive.s_m, in_lane, valid, beside, drive.valid, drive.spare_m, drive.all_beside, drive.reached_m
            )
            drive.spare_m, drive.all_beside, drive.reached_m = spare_m, all_beside, reached_m
            drive.gap_m += gap_m
            drive.gaps += gap_m > 0.0
        drive.in_lane, drive.valid, drive.x_m, drive.y_m = in_lane, valid, x_m[k], y_m[k]
        drive.tick += 1
        if speed_mps[k] >= _BLOCKED_MPS:
            drive.moved_tick = drive.tick
        left_m = route_s_m[-1] - drive.s_m
        arrived = valid and _has_arrived(left_m, speed_mps[k], 0.0, 0.0)
        still_s, t_s = (drive.tick - drive.moved_tick) * STEP_S, drive.tick * STEP_S
        drive.ending = _ending_of(arrived, drive.gaps, drive.distance_m, still_s, t_s, drive.limit_s, math.inf)


@kept_part(SOURCES)
def pass_signs(
    drives: Any,  # noqa: ANN401 - an array of records
    rows: NDArray[np.int64],
    signs_m: F64,
    front_m: float,
    middle_m: float,
    speed_mps: F64,
    stopped: NDArray[np.bool_],
    passed: NDArray[np.bool_],
    run: NDArray[np.int64],
) -> None:  # pragma: no cover - compiled
    """Note in ``stopped`` and ``passed`` (W, S) where vehicles (K,) stop and pass; write how many signs each runs.

    ``front_m`` is from a vehicle's place to its front bumper, ``middle_m`` to the middle of its length.
    """
    for k in range(len(rows)):
        row, drive = rows[k], drives[rows[k]]
        run[k] = 0
        for sign in range(len(signs_m)):
            if _stops_at(signs_m[sign] - (drive.s_m + front_m), speed_mps[k], drive.in_lane):
                stopped[row, sign] = True
            if drive.s_m + middle_m > signs_m[sign] and not passed[row, sign]:
                passed[row, sign] = True
                run[k] += drive.tick > 0 and not stopped[row, sign]


@kept_part(SOURCES)
def watch_speed(
    drives: Any,  # noqa: ANN401 - an array of records
    rows: NDArray[np.int64],
    episodes: Any,  # noqa: ANN401 - likewise
    speed_mps: F64,
    limit_mps: F64,
    settled: NDArray[np.int64],
    pending: NDArray[np.int64],
) -> None:  # pragma: no cover - compiled
    """Advance the episodes (W,) of EPISODE of vehicles (K,) by a frame; ``limit_mps`` (K,) hold.

    Infractions of episodes that end are added to ``settled`` (W,). Those of episodes that go on are ``pending`` (K,).
    """
    for k in range(len(rows)):
        now, tick = episodes[rows[k]], drives[rows[k]].tick
        was_open = now.is_open
        belongs = _exceeds(speed_mps[k], limit_mps[k], _TOLERANCE_MPS, was_open)
        now.is_open, pending[k] = belongs, 0
        if not belongs:
            if was_open and _lasts(now.first, now.end, STEP_S):
                settled[rows[k]] += now.pieces
            now.pieces, now.gained_m = 0, 0.0
            continue
        if not was_open:
            now.first, now.pieces = tick, 0
        if not was_open or _is_whole(now.gained_m):
            now.pieces += 1
            now.gained_m = 0.0
        now.gained_m += (speed_mps[k] - limit_mps[k]) * STEP_S
        now.end = tick + 1
        if _lasts(now.first, now.end, STEP_S):
            pending[k] = now.pieces
