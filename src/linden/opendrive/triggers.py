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
from linden.opendrive.evaluate.tables import Tables
from linden.opendrive.links import LaneLinks, is_forward
from linden.values.space import BoundingBox, Rotation, Transform, Vector3D

# Half sizes and distances of CARLA's own boxes, in m (StopSignComponent.cpp, InitializeSign).
HALF_LENGTH_M = 1.5
HALF_HEIGHT_M = 1.0
GAP_M = 1.5  # between the box and the line
INSET_WIDTHS = 0.25  # of the lane's width, kept free on either side


class LanePlace(NamedTuple):
    """A place on a lane: its row in ``Tables.lanes``, and s along its road."""

    lane: int
    s_m: float


def trigger_boxes(
    tables: Tables, links: LaneLinks, world_from_signal: Transform, places: list[LanePlace]
) -> tuple[BoundingBox, ...]:
    """Return a box for each approach, local to the signal's actor, x across the lanes where the actor stands square."""
    approaches: dict[tuple[int, int, bool, float], list[LanePlace]] = defaultdict(list)
    for place in dict.fromkeys(_before_line(tables, links, place) for place in places):
        row = tables.lanes[place.lane]
        forward = is_forward(tables.roads[row["road"]], int(row["lane_id"]))
        approaches[int(row["road"]), int(row["section"]), forward, round(place.s_m, 3)].append(place)
    return tuple(_box(tables, world_from_signal, approach) for approach in approaches.values())


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


def _box(tables: Tables, world_from_signal: Transform, approach: list[LanePlace]) -> BoundingBox:
    lanes = np.array([place.lane for place in approach])
    s_m = np.array([place.s_m for place in approach])
    sides = np.sort(np.stack(tables.lane_sides(lanes, s_m)), axis=0)  # lower and upper t of each lane
    inset = INSET_WIDTHS * (sides[1] - sides[0])
    low_m, high_m = float((sides[0] + inset).min()), float((sides[1] - inset).max())
    road = tables.lanes["road"][lanes[:1]].astype(np.int64)
    x_m, y_m, heading_rad = (float(value[0]) for value in tables.curves.pose(road, s_m[:1]))
    z_m = float(tables.elevation.value(road, s_m[:1])[0])
    t_m = (low_m + high_m) / 2.0
    world = from_opendrive(x_m - math.sin(heading_rad) * t_m, y_m + math.cos(heading_rad) * t_m, z_m, heading_rad)
    across, along = max((high_m - low_m) / 2.0, 0.01), HALF_LENGTH_M
    turn_deg = math.remainder(world.rotation.yaw + 90.0 - world_from_signal.rotation.yaw, 180.0)
    if abs(turn_deg) > 45.0:  # the actor stands along the road: its x axis is the box's length
        turn_deg -= math.copysign(90.0, turn_deg)
        across, along = along, across
    return BoundingBox(
        location=_local(world_from_signal, world.location),
        extent=Vector3D(across, along, HALF_HEIGHT_M),
        rotation=Rotation(0.0, turn_deg, 0.0),
    )


def _local(world_from_signal: Transform, point: Vector3D) -> Vector3D:
    """Return a point of the world in the frame of an upright actor."""
    yaw_rad = math.radians(world_from_signal.rotation.yaw)
    dx, dy, dz = (float(a - b) for a, b in zip(point, world_from_signal.location, strict=True))
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return Vector3D(cos * dx + sin * dy, -sin * dx + cos * dy, dz)
