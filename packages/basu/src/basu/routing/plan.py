"""Plans a route on a map: lane-centre points a metre apart, limits, stops, and the signs and lights on the way."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from basu.errors import UserError
from basu.routing import lane_graph
from basu.routing.join import Piece, join
from basu.routing.planned_route import ControlKind, Route, RouteControl, Stop

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu.routing.lane_graph import LaneGraph, Road
    from basu.routing.route_file import RouteDescription


# OpenDRIVE signal types as LibCarla's landmarks carry them (client reference, section "Signals")
KIND_OF_TYPE = {
    "206": ControlKind.STOP_SIGN,
    "205": ControlKind.YIELD_SIGN,
    **{str(code): ControlKind.TRAFFIC_LIGHT for code in (1000001, 1000002, *range(1000007, 1000021))},
}
SAME_LINE_M = 40.0  # a light and a reference to it on the connecting road behind its line lie within this
PASS_SLACK_M = 3.0  # a line this near beyond the end of a stretch on its road still belongs to it


def controls_on(
    landmarks: list[carla.Landmark],
    *,
    road_id: NDArray[np.int64],
    lane_id: NDArray[np.int64],
    road_s_m: NDArray[np.float64],
    s_m: NDArray[np.float64],
    points_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
) -> tuple[RouteControl, ...]:
    """Controls in the order in which the route meets them; one that is met twice appears twice.

    All arrays describe the route's N points; ``road_s_m`` is the place along each point's road, ``landmarks`` are
    ``carla.Landmark`` of the whole map.
    """
    by_road: dict[int, list[carla.Landmark]] = defaultdict(list)
    for landmark in landmarks:
        if landmark.type in KIND_OF_TYPE:
            by_road[landmark.road_id].append(landmark)
    found = []
    changes = np.flatnonzero((np.diff(road_id) != 0) | (np.diff(lane_id) != 0)) + 1
    for first, end in zip([0, *changes.tolist()], [*changes.tolist(), len(road_id)], strict=True):
        lane = int(lane_id[first])
        for landmark in by_road.get(int(road_id[first]), ()):
            at = _nearest(landmark, lane, road_s_m[first:end])
            if at is None:
                continue
            at += first
            ahead_m = (landmark.s - float(road_s_m[at])) * (1.0 if lane < 0 else -1.0)
            found.append(
                RouteControl(
                    kind=KIND_OF_TYPE[landmark.type],
                    landmark_id=landmark.id,
                    s_m=float(s_m[at]) + ahead_m,
                    x_m=float(points_m[at, 0] + ahead_m * np.cos(yaw_rad[at])),
                    y_m=float(points_m[at, 1] + ahead_m * np.sin(yaw_rad[at])),
                    z_m=float(points_m[at, 2]),
                    yaw_rad=float(yaw_rad[at]),
                )
            )
    return _lines(sorted(found, key=lambda control: (control.s_m, control.landmark_id)))


def _lines(found: list[RouteControl]) -> tuple[RouteControl, ...]:
    """Controls without references on connecting roads to a signal with its own line a few metres before them."""
    kept: list[RouteControl] = []
    for control in found:
        again = any(
            control.landmark_id == other.landmark_id and control.s_m - other.s_m < SAME_LINE_M for other in kept[-4:]
        )
        if not again:
            kept.append(control)
    return tuple(kept)


def _nearest(landmark: carla.Landmark, lane: int, stretch_m: NDArray[np.float64]) -> int | None:
    """The point of a stretch on the landmark's road that is nearest to its line; None where it does not govern it."""
    if not any(min(pair) <= lane <= max(pair) for pair in landmark.get_lane_validities()):
        return None
    if not stretch_m.min() - PASS_SLACK_M <= landmark.s <= stretch_m.max() + PASS_SLACK_M:
        return None
    return int(np.argmin(np.abs(stretch_m - landmark.s)))


SPACING_M = 1.0  # between the points of a planned route
MERGE_M = 0.3  # points nearer than this to their predecessor are the seam of two lanes
SEAM_M = 1e-3  # how far inside its lane a lane's first and last point is taken
STOP_OFF_ROUTE_M = 8.0  # a service stop farther than this from the route is a mistake in the file


def plan(carla_map: carla.Map, description: RouteDescription, lanes: LaneGraph | None = None) -> Route:
    """Lay ``description`` on ``carla_map``; ``lanes``, its graph, spares making it again.

    Raises:
        UserError: a point lies off the road, points cannot be joined, or a stop lies off the route.
    """
    lanes = lanes or lane_graph.build(carla_map)
    roads = lanes.roads
    pieces = join(lanes, description)
    waypoints = _thin([waypoint for piece in pieces for waypoint in _sample(carla_map, roads, piece)])
    points_m, yaw_rad = _poses(waypoints)
    s_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m[:, :2], axis=0).T))])
    if s_m[-1] < SPACING_M:
        raise UserError(f"route '{description.id}' in {description.source} has no length: its points fall together")
    road_id = np.array([w.road_id for w in waypoints], dtype=np.int64)
    lane_id = np.array([w.lane_id for w in waypoints], dtype=np.int64)
    road_s_m = np.array([w.s for w in waypoints], dtype=np.float64)
    limit_mps = np.array([roads[int(road)].limit_at(float(s)) for road, s in zip(road_id, road_s_m, strict=True)])
    return Route(
        id=description.id,
        town=description.town,
        points_m=points_m,
        s_m=s_m,
        yaw_rad=yaw_rad,
        lane_width_m=np.array([w.lane_width for w in waypoints], dtype=np.float64),
        speed_limit_mps=_carried_on(limit_mps),
        is_junction=np.array([w.is_junction for w in waypoints], dtype=np.bool_),
        road_id=road_id,
        lane_id=lane_id,
        stops=_stops(description, points_m, s_m, yaw_rad),
        timetable=description.timetable,
        controls=controls_on(
            carla_map.get_all_landmarks(),
            road_id=road_id,
            lane_id=lane_id,
            road_s_m=road_s_m,
            s_m=s_m,
            points_m=points_m,
            yaw_rad=yaw_rad,
        ),
        waypoints=tuple(waypoints),
    )


def _sample(carla_map: carla.Map, roads: dict[int, Road], piece: Piece) -> list[carla.Waypoint]:
    """Way points of one piece, about ``SPACING_M`` apart, both ends included."""
    low_m, high_m = roads[piece.key.road].section_extent_m(piece.key.section)
    low_m, high_m = low_m + SEAM_M, high_m - SEAM_M
    begin_m, end_m = (low_m, high_m) if piece.key.lane < 0 else (high_m, low_m)
    first_s_m = begin_m if piece.from_s_m is None else piece.from_s_m
    last_s_m = end_m if piece.to_s_m is None else piece.to_s_m
    count = max(2, 1 + math.ceil(abs(last_s_m - first_s_m) / SPACING_M))
    places_m = np.clip(np.linspace(first_s_m, last_s_m, count), low_m, high_m)
    found = [carla_map.get_waypoint_xodr(piece.key.road, piece.key.lane, float(s_m)) for s_m in places_m]
    return [waypoint for waypoint in found if waypoint is not None]


def _thin(waypoints: list[carla.Waypoint]) -> list[carla.Waypoint]:
    """Drop the doubles where one lane ends and the next begins."""
    kept: list[carla.Waypoint] = []
    for waypoint in waypoints:
        if not kept or waypoint.transform.location.distance(kept[-1].transform.location) > MERGE_M:
            kept.append(waypoint)
    return kept


def _poses(waypoints: list[carla.Waypoint]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions (N, 3) in m and yaw (N,) in rad within (-pi, pi], CARLA frame."""
    rows = []
    for waypoint in waypoints:
        transform = waypoint.transform
        at = transform.location
        rows.append((at.x, at.y, at.z, math.radians(transform.rotation.yaw)))
    pose = np.array(rows, dtype=np.float64)
    return pose[:, :3].copy(), np.arctan2(np.sin(pose[:, 3]), np.cos(pose[:, 3]))


def _carried_on(limit_mps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Extend a limit through a junction; its roads post none of their own."""
    known = ~np.isnan(limit_mps)
    if not known.any():
        return limit_mps
    latest = np.maximum.accumulate(np.where(known, np.arange(len(limit_mps)), -1))
    first = int(np.argmax(known))
    held: NDArray[np.float64] = limit_mps[np.where(latest < 0, first, latest)]
    return held


def _stops(
    description: RouteDescription,
    points_m: NDArray[np.float64],
    s_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
) -> tuple[Stop, ...]:
    """Return the service stops on the route, each searched for beyond the one before it, in the file's order."""
    found: list[Stop] = []
    after_m = 0.0
    for mark in description.stops:
        away_m = np.hypot(points_m[:, 0] - mark.point.x_m, points_m[:, 1] - mark.point.y_m)
        ahead = s_m >= after_m
        near = ahead & (away_m <= min(STOP_OFF_ROUTE_M, float(away_m[ahead].min(initial=math.inf)) + 1.0))
        if not near.any():
            raise UserError(
                f"route '{description.id}' in {description.source}: stop '{mark.name}' "
                f"({mark.point.x_m:.1f}, {mark.point.y_m:.1f}) lies {away_m[ahead].min(initial=math.inf):.1f} m from "
                f"the route where it is due; move it to within {STOP_OFF_ROUTE_M:.0f} m or reorder the stops"
            )
        index = _first_minimum(away_m, near)
        found.append(
            Stop(
                id=mark.id,
                name=mark.name,
                s_m=float(s_m[index]),
                x_m=mark.point.x_m,
                y_m=mark.point.y_m,
                z_m=mark.point.z_m,
                yaw_rad=float(yaw_rad[index]) if mark.point.yaw_rad is None else mark.point.yaw_rad,
            )
        )
        after_m = float(s_m[index])
    return tuple(found)


def _first_minimum(away_m: NDArray[np.float64], near: NDArray[np.bool_]) -> int:
    """Return the nearest point of the first run of near ones: a route may pass the same place again later."""
    first = int(np.argmax(near))
    end = first + int(np.argmin(near[first:])) if not near[first:].all() else len(near)
    return first + int(np.argmin(away_m[first:end]))
