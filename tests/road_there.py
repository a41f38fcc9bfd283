"""What the map has at a place of the ego's route: relation to a junction, traffic control, bend and highway.

The characteristics of a case state the same of the place where its conflict is (`basu.scenarios.characteristics`). The
test `test_true_characteristics.py` compares both over all cases.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.routing import ControlKind

if TYPE_CHECKING:
    from basu.routing import Route

APPROACH_M = 60.0  # before a junction: ten seconds at the shuttle's pace of 6 m/s
BEFORE_M, BEHIND_M = 2.0, 10.0  # of a junction that still belong to it: behind it is its crossing for pedestrians
LINE_M = 15.0  # before a junction, in which its stop line is
ROUND_RAD = math.radians(75.0)  # a way through a junction that turns so much in total goes round an island
BEND_RAD_PER_M = 1.0 / 100.0  # a radius of 100 m and less
BEND_M = 10.0  # before and behind the place
SEAM_M = 4.0  # beside a junction, where the turn in it still shows
HIGHWAY_MPS = 20.1  # 45 mph: from there on a posted limit means a highway
BEYOND_STEP_M = 2.0  # between looks at the map beyond the end of the route
_CONTROLS = {
    ControlKind.STOP_SIGN: "stop-sign",
    ControlKind.YIELD_SIGN: "yield-sign",
    ControlKind.TRAFFIC_LIGHT: "traffic-light",
}


class RoadThere(NamedTuple):
    """Values of the characteristics that follow from the map, as text."""

    junction: str
    control: str
    alignment: str
    highway: str


def road_there(route: Route, first_s_m: float, last_s_m: float | None = None) -> RoadThere:
    """Return what the map has from one place of a route to another; one place where the second is left out.

    A route without waypoints is not looked at beyond its end.
    """
    last_s_m = first_s_m if last_s_m is None else last_s_m
    junction, control = _junction(route, first_s_m, last_s_m)
    limits_mps = route.speed_limit_mps[_between(route, first_s_m, last_s_m)]
    is_fast = bool(np.isfinite(limits_mps).any() and np.nanmax(limits_mps) >= HIGHWAY_MPS)
    return RoadThere(junction, control, _alignment(route, first_s_m, last_s_m), "yes" if is_fast else "no")


def _between(route: Route, first_s_m: float, last_s_m: float) -> slice:
    """Return the points from one place to another, one at least."""
    first = min(int(np.searchsorted(route.s_m, first_s_m)), len(route.s_m) - 1)
    return slice(first, max(first + 1, int(np.searchsorted(route.s_m, last_s_m))))


def _junction(route: Route, first_s_m: float, last_s_m: float) -> tuple[str, str]:
    """Return the relation to the nearest junction, and its control on the ego's way."""
    stretches = junctions(route)
    for begin_m, end_m in stretches:
        if begin_m - BEFORE_M <= last_s_m and first_s_m <= end_m + BEHIND_M and begin_m > 0.0:
            return _kind(route, begin_m, end_m), _control(route, begin_m, end_m)
    for begin_m, end_m in stretches:
        if last_s_m < begin_m <= last_s_m + APPROACH_M:
            return "approach", _control(route, begin_m, end_m)
    return _beyond(route, last_s_m)


def junctions(route: Route) -> list[tuple[float, float]]:
    """Return where each junction of a route begins and ends, along the route."""
    steps = np.diff(np.concatenate([[0], route.is_junction.astype(np.int8), [0]]))
    begins, ends = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1
    return [(float(route.s_m[a]), float(route.s_m[b])) for a, b in zip(begins, ends, strict=True)]


def _kind(route: Route, begin_m: float, end_m: float) -> str:
    """Return whether a junction is a roundabout: the ego's way gives way at its entry and winds round an island."""
    yaw_rad = np.unwrap(route.yaw_rad[_between(route, begin_m, end_m)])
    gives_way = _control(route, begin_m, end_m) == "yield-sign"
    turned_rad = float(np.abs(np.diff(yaw_rad)).sum())
    return "roundabout" if gives_way and turned_rad >= ROUND_RAD else "intersection"


def _control(route: Route, begin_m: float, end_m: float) -> str:
    """Return the control with its line at a junction."""
    at_line = {control.kind for control in route.controls if begin_m - LINE_M <= control.s_m <= end_m}
    return next((word for kind, word in _CONTROLS.items() if kind in at_line), "none")


def _beyond(route: Route, from_s_m: float) -> tuple[str, str]:
    """Return whether the lane leads to a junction soon after the end of the route, and that junction's control."""
    left_m = APPROACH_M - (route.length_m - from_s_m)
    if not route.waypoints or left_m <= 0.0:
        return "none", "none"
    waypoint, gone_m = route.waypoints[-1], 0.0
    while gone_m < left_m:
        ahead = waypoint.next(BEYOND_STEP_M)
        if not ahead:
            break
        waypoint, gone_m = ahead[0], gone_m + BEYOND_STEP_M
        if waypoint.is_junction:
            found = {landmark.type for landmark in route.waypoints[-1].get_landmarks(gone_m + LINE_M)}
            words = {"206": "stop-sign", "205": "yield-sign", "1000001": "traffic-light"}
            return "approach", next((word for type_, word in words.items() if type_ in found), "none")
    return "none", "none"


def _alignment(route: Route, first_s_m: float, last_s_m: float) -> str:
    """Return whether the road bends there; a turn in a junction that is no roundabout is no bend."""
    if len(route.s_m) < 2:
        return "straight"
    bend = np.abs(np.gradient(np.unwrap(route.yaw_rad), route.s_m))
    near = (route.s_m >= first_s_m - BEND_M) & (route.s_m <= last_s_m + BEND_M)
    if _junction(route, first_s_m, last_s_m)[0] != "roundabout":
        for begin_m, end_m in junctions(route):
            near &= (route.s_m < begin_m - SEAM_M) | (route.s_m > end_m + SEAM_M)
    return "curve" if (bend[near] >= BEND_RAD_PER_M).any() else "straight"
