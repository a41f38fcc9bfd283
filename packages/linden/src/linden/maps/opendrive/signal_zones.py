"""The boxes before a stop line in which a signal takes effect.

CARLA puts a small box into every lane a signal concerns and hands the client the first one (TrafficLightComponent.cpp,
StopSignComponent.cpp, BoundingBoxCalculator.cpp, GetTrafficSignTriggerVolume). What reads it (CARLA's agents, the
leaderboard's criteria, TrafficLight::GetStopWaypoints) walks along the box's x axis to find the lanes, for in CARLA's
hand-made towns one box covers all lanes and its x axis lies across the road. Such boxes are made here.
"""

import math
from collections import defaultdict
from typing import NamedTuple

import numpy as np

from linden.geometry import from_opendrive
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.links import LaneLinks, is_forward
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D

# Half sizes and distances of CARLA's own boxes, in m (StopSignComponent.cpp, InitializeSign).
HALF_LENGTH_M = 1.5
HALF_HEIGHT_M = 1.0
GAP_M = 1.5  # between the box and the line
INSET_WIDTHS = 0.25  # of the lane's width, kept free on either side


class LanePlace(NamedTuple):
    """A place on a lane: its row in ``Tables.lanes``, and s along its road."""

    lane: int
    s_m: float


class _LineApproach(NamedTuple):
    """Lanes of one road that reach the same line side by side: rows ``first`` to ``last`` of the places asked for."""

    signal: int
    first: int
    last: int


def trigger_boxes(
    tables: Tables, links: LaneLinks, world_from_signals: list[Transform], places: list[list[LanePlace]]
) -> list[tuple[BoundingBox, ...]]:
    """Return the trigger boxes of each signal in its actor's frame, one for each approach.

    If the signal stands square to the lanes, x points across them.
    """
    approaches: list[_LineApproach] = []
    ordered: list[LanePlace] = []
    for signal, own in enumerate(places):
        groups: dict[tuple[int, int, bool, float], list[LanePlace]] = defaultdict(list)
        for place in dict.fromkeys(_before_line(tables, links, place) for place in own):
            row = tables.lanes[place.lane]
            key = (int(row["road"]), int(row["section"]), _is_forward(tables, place.lane), round(place.s_m, 3))
            groups[key].append(place)
        for group in groups.values():
            approaches.append(_LineApproach(signal, len(ordered), len(ordered) + len(group)))
            ordered += group
    boxes: list[list[BoundingBox]] = [[] for _ in places]
    for signal, area in zip(
        (approach.signal for approach in approaches), _areas(tables, approaches, ordered), strict=True
    ):
        boxes[signal].append(_box(world_from_signals[signal], *area))
    return [tuple(own) for own in boxes]


def _areas(tables: Tables, approaches: list[_LineApproach], places: list[LanePlace]) -> list[tuple[Transform, float]]:
    """Return the middle of each approach's box, turned along the road, and half its width across the lanes in m."""
    if not approaches:
        return []
    lanes = np.array([place.lane for place in places])
    s_m = np.array([place.s_m for place in places])
    sides = np.sort(np.stack(tables.lane_sides(lanes, s_m)), axis=0)  # lower and upper t of each lane
    inset_m = INSET_WIDTHS * (sides[1] - sides[0])
    first = np.array([approach.first for approach in approaches])
    low_m = np.minimum.reduceat(sides[0] + inset_m, first)
    high_m = np.maximum.reduceat(sides[1] - inset_m, first)
    t_m = (low_m + high_m) / 2.0
    road = tables.lanes["road"][lanes[first]].astype(np.int64)
    pose, z_m = tables.curves.pose(road, s_m[first]), tables.elevation.value(road, s_m[first])
    x_m = pose.x_m - np.sin(pose.heading_rad) * t_m
    y_m = pose.y_m + np.cos(pose.heading_rad) * t_m
    half_m = np.maximum((high_m - low_m) / 2.0, 0.01)
    return [
        (from_opendrive(*map(float, place)), float(half))
        for *place, half in zip(x_m, y_m, z_m, pose.heading_rad, half_m, strict=True)
    ]


def _before_line(tables: Tables, links: LaneLinks, place: LanePlace) -> LanePlace:
    """Return where the middle of the box lies; never inside a junction where a single lane leads there."""
    lane, s_m = place
    if _road_is_in_junction(tables, lane):
        before = links.predecessors[lane]
        if len(before) == 1 and not _road_is_in_junction(tables, before[0]):
            lane = before[0]
            s_m = float(tables.lanes["end_m" if _is_forward(tables, lane) else "start_m"][lane])
    back_m = GAP_M + HALF_LENGTH_M
    s_m += -back_m if _is_forward(tables, lane) else back_m
    start_m, end_m = float(tables.lanes["start_m"][lane]), float(tables.lanes["end_m"][lane])
    return LanePlace(lane, min(max(s_m, start_m), end_m))


def _road_is_in_junction(tables: Tables, lane: int) -> bool:
    return bool(tables.roads[tables.lanes["road"][lane]].is_in_junction)


def _is_forward(tables: Tables, lane: int) -> bool:
    return is_forward(tables.roads[tables.lanes["road"][lane]], int(tables.lanes["lane_id"][lane]))


def _box(world_from_signal: Transform, area: Transform, half_width_m: float) -> BoundingBox:
    across, along = half_width_m, HALF_LENGTH_M
    turn_deg = math.remainder(area.rotation.yaw + 90.0 - world_from_signal.rotation.yaw, 180.0)
    if abs(turn_deg) > 45.0:  # the actor stands along the road: its x axis is the box's length
        turn_deg -= math.copysign(90.0, turn_deg)
        across, along = along, across
    return BoundingBox(
        location=_local(world_from_signal, area.location),
        extent=Vector3D(across, along, HALF_HEIGHT_M),
        rotation=Rotation(0.0, turn_deg, 0.0),
    )


def _local(world_from_signal: Transform, point: Vector3D) -> Vector3D:
    """Return a point of the world in the frame of an upright actor."""
    yaw_rad = math.radians(world_from_signal.rotation.yaw)
    dx, dy, dz = (float(a - b) for a, b in zip(point, world_from_signal.location, strict=True))
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return Vector3D(cos * dx + sin * dy, -sin * dx + cos * dy, dz)
