"""Paths that cross the ego's way at a junction, and where they meet it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

import carla
import numpy as np

from basu.errors import ScenarioError
from basu.scenarios.paths.lanes import (
    Turn,
    back_along_lane,
    followed,
    point_of,
    through_junction,
    turn_of,
    turned_rad,
    yaw_rad_of,
)
from basu.scenarios.paths.path import Path

if TYPE_CHECKING:
    from basu.scenarios.place import Place

Side = Literal["left", "right", "opposite", "same"]
MEET_M = 1.0  # ways that come this near have met


class JunctionAhead(NamedTuple):
    """A junction on the ego's route, seen from the trigger point."""

    id: int
    from_m: float  # ahead of the trigger point, where the route enters
    to_m: float  # where it leaves
    turn: Turn  # what the ego's route does there


class Crossing(NamedTuple):
    """A way that meets the ego's at a junction."""

    path: Path
    meet_s_m: float  # along the path, where it first meets the ego's way
    ego_s_m: float  # the same place along the ego's route, from its beginning
    side: Side  # from which it comes, seen by the ego
    turn: Turn


def junctions(place: Place) -> list[JunctionAhead]:
    """The junctions of the route, in order; one that the trigger point lies in has a negative ``from_m``."""
    route, found = place.route, []
    edges = np.flatnonzero(np.diff(np.concatenate([[False], route.is_junction, [False]]).astype(np.int8)))
    for first, end in edges.reshape(-1, 2).tolist():
        turned = math.remainder(float(route.yaw_rad[end - 1] - route.yaw_rad[first]), math.tau)
        known = route.waypoints[first].junction_id if route.waypoints else -1
        from_m, to_m = float(route.s_m[first]), float(route.s_m[end - 1])
        found.append(JunctionAhead(known, from_m - place.trigger_s_m, to_m - place.trigger_s_m, turn_of(turned)))
    return found


def next_junction(place: Place, beyond_m: float = 0.0) -> JunctionAhead:
    """The first junction that the route enters beyond so many metres from the trigger point.

    Raises:
        ScenarioError: there is none.
    """
    for junction in junctions(place):
        if junction.from_m >= beyond_m:
            return junction
    raise ScenarioError(f"the ego's route enters no junction beyond {beyond_m:.0f} m from the trigger point")


def crossings(place: Place, junction: JunctionAhead, approach_m: float = 60.0, leave_m: float = 40.0) -> list[Crossing]:
    """All ways through a junction that meet the ego's, from as far before it to as far behind it."""
    ego_in = place.waypoint(junction.from_m)
    ego_rad, found = yaw_rad_of(ego_in), []
    for entry, _ in ego_in.get_junction().get_waypoints(carla.LaneType.Driving):
        side = _side_of(math.remainder(yaw_rad_of(entry) - ego_rad, math.tau))
        if side == "same":
            continue
        before = back_along_lane(entry, approach_m)
        last = through_junction(entry)
        inside_m = math.ceil(abs(last.s - entry.s))
        way = before[:-1] + followed(entry, inside_m + leave_m)
        path = Path.through([point_of(waypoint) for waypoint in way])
        met = meeting(path, place, junction)
        if met is not None:
            found.append(Crossing(path, *met, side, turn_of(turned_rad(entry, last))))
    return found


def crossing(
    place: Place,
    side: Side,
    turn: Turn | None = None,
    *,
    junction: JunctionAhead | None = None,
    approach_m: float = 60.0,
    leave_m: float = 40.0,
) -> Crossing:
    """The way that comes from a side and meets the ego's at its next junction, by default the straightest such one.

    Raises:
        ScenarioError: there is no such way; names those there are.
    """
    at = junction or next_junction(place)
    all_of_them = crossings(place, at, approach_m, leave_m)
    order: tuple[Turn, ...] = ("straight", "left", "right") if turn is None else (turn,)
    for wanted in order:
        fitting = [c for c in all_of_them if c.side == side and c.turn == wanted]
        if fitting:
            return fitting[0]
    there = ", ".join(sorted({f"{c.side} {c.turn}" for c in all_of_them})) or "none"
    raise ScenarioError(
        f"at the junction {at.from_m:.0f} m from the trigger point no path comes from the {side}"
        f"{f' going {turn}' if turn else ''} across the ego's way; there are: {there}"
    )


def meeting(path: Path, place: Place, junction: JunctionAhead, slack_m: float = 15.0) -> tuple[float, float] | None:
    """Return where a path first meets the ego's in a junction: m along path and route; None if they do not meet."""
    route, shift_m = place.route, place.trigger_s_m
    low, high = np.searchsorted(route.s_m, [junction.from_m + shift_m - slack_m, junction.to_m + shift_m + slack_m])
    ego_m = route.points_m[low:high, :2]
    s_m = np.arange(0.0, path.length_m, 0.5)
    ours_m = np.column_stack([np.interp(s_m, path.s_m, path.points_m[:, axis]) for axis in (0, 1)])
    away_m = np.hypot(ours_m[:, None, 0] - ego_m[None, :, 0], ours_m[:, None, 1] - ego_m[None, :, 1])
    nearest_m = away_m.min(axis=1)
    near = np.flatnonzero(nearest_m <= MEET_M)
    if not len(near):
        return None
    at = int(near[0])
    while at + 1 < len(nearest_m) and nearest_m[at + 1] < nearest_m[at]:
        at += 1
    return float(s_m[at]), float(route.s_m[low + int(np.argmin(away_m[at]))])


def _side_of(angle_rad: float) -> Side:
    """The side of origin of an actor with a heading that differs by this from the ego's."""
    if abs(angle_rad) < math.pi / 4.0:
        return "same"
    if abs(angle_rad) > 3.0 * math.pi / 4.0:
        return "opposite"
    return "left" if angle_rad > 0.0 else "right"
