"""Poses of signals as LibCarla 0.9.16 computes them: from the file, then moved sideways out of lanes.

Source: MapBuilder.cpp, ComputeSignalTransform, SolveSignalReferencesAndTransforms, CheckSignalsOnRoads.
"""

import math

import numpy as np

from linden.geometry import from_opendrive
from linden.maps.opendrive.evaluate.nearest import MiddleLines, Nearest, middle_lines
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import OpenDrive, Road
from linden.maps.opendrive.roadside import Signal
from linden.protocol.values.enums import LaneType
from linden.protocol.values.space import Rotation, Transform, Vector3D

_LIGHT_ADVANCE_M = 0.25  # lights are moved forward by this
_CLEAR_WIDTHS = 0.7  # of the lane's width: nearer to its middle than this, a signal stands in the way
_PUSH_WIDTHS = 0.2
_PUSHES = 10
_KEPT_NAMES = ("Stencil_STOP", "STATIC")  # signals of these names stay where they are


def landmark_transforms(opendrive: OpenDrive) -> tuple[Transform, ...]:
    """Return the pose of every signal in the order of the file, as ``carla.Landmark.transform`` gives it."""
    signals = [signal for _, signal in opendrive.signals()]
    if not signals:
        return ()
    tables = tables_of(opendrive)
    lines = middle_lines(tables, LaneType.DRIVING | LaneType.SHOULDER)
    return tuple(
        pose if _stays(signal) else _pushed_out(tables, lines, pose)
        for signal, pose in zip(signals, unmoved_transforms(opendrive), strict=True)
    )


def unmoved_transforms(opendrive: OpenDrive) -> tuple[Transform, ...]:
    """Return the pose of every signal as the file says it, before LibCarla moves signals that stand in a lane."""
    signals = [signal for _, signal in opendrive.signals()]
    if not signals:
        return ()
    poses = []
    for signal, beside_road in zip(signals, _beside_roads(tables_of(opendrive)), strict=True):
        if signal.inertial is None:
            poses.append(_tilted(beside_road, signal.pitch_rad, signal.roll_rad))
        else:
            x_m, y_m, z_m, heading_rad, pitch_rad, roll_rad = signal.inertial
            poses.append(_tilted(from_opendrive(x_m, y_m, z_m, heading_rad), pitch_rad, roll_rad))
    return tuple(poses)


def _stays(signal: Signal) -> bool:
    return signal.inertial is not None or any(name in signal.name for name in _KEPT_NAMES)


def _beside_roads(tables: Tables) -> list[Transform]:
    """Return every signal at its s and t, turned by its heading offset; lights a little forward."""
    road = np.array([index for index, road in enumerate(tables.roads) for _ in road.signals], dtype=np.int64)
    signals = [signal for road in tables.roads for signal in road.signals]
    s_m = np.clip([signal.s_m for signal in signals], 0.0, tables.road_length_m[road])
    pose, z_m = tables.curves.pose(road, s_m), tables.elevation.value(road, s_m)
    facing_rad = pose.heading_rad + [signal.heading_offset_rad for signal in signals]
    t_m = np.array([signal.t_m for signal in signals])
    advance_m = np.array([_LIGHT_ADVANCE_M * signal.is_light for signal in signals])
    x_m = pose.x_m - np.sin(pose.heading_rad) * t_m + np.cos(facing_rad) * advance_m
    y_m = pose.y_m + np.cos(pose.heading_rad) * t_m + np.sin(facing_rad) * advance_m
    z_m = z_m + [signal.z_offset_m for signal in signals]
    return [from_opendrive(*map(float, place)) for place in zip(x_m, y_m, z_m, facing_rad, strict=True)]


def _tilted(pose: Transform, pitch_rad: float, roll_rad: float) -> Transform:
    return pose._replace(rotation=Rotation(math.degrees(pitch_rad), pose.rotation.yaw, math.degrees(roll_rad)))


def _pushed_out(tables: Tables, lines: MiddleLines, pose: Transform) -> Transform:
    """Push a signal sideways, a fifth of the lane's width at a time, until it stands clear of all lanes."""
    x, y, z = pose.location
    found = lines.nearest(x, -y, z)
    if found is None:
        return pose
    width_m = _width_m(tables, found)
    if found.distance_m >= _CLEAR_WIDTHS * width_m:
        return pose
    lane_pose = _lane_pose(tables, found)
    yaw_rad = math.radians(lane_pose.rotation.yaw)
    pushes = 0
    while found.distance_m < _CLEAR_WIDTHS * width_m and pushes < _PUSHES:
        direction = _way_out(tables, found.lane)
        x -= math.sin(yaw_rad) * width_m * _PUSH_WIDTHS * direction
        y += math.cos(yaw_rad) * width_m * _PUSH_WIDTHS * direction
        found = lines.nearest(x, -y, z) or found
        width_m = _width_m(tables, found)
        pushes += 1
        if direction == 0:
            break
    if pushes == _PUSHES:
        return pose
    return Transform(Vector3D(x, y, z), lane_pose.rotation)


def _width_m(tables: Tables, found: Nearest) -> float:
    inner_m, outer_m = tables.lane_sides(np.array([found.lane]), np.array([found.s_m]))
    return abs(float(outer_m[0] - inner_m[0]))


def _lane_pose(tables: Tables, found: Nearest) -> Transform:
    """Return the lane's middle, turned the way its traffic goes."""
    places = tables.lane_centres(np.array([found.lane]), np.array([found.s_m]))
    x_m, y_m, z_m, heading_rad, slope, _ = (float(value[0]) for value in places)
    row = tables.lanes[found.lane]
    road: Road = tables.roads[row["road"]]
    backwards = (row["lane_id"] > 0) == road.is_right_hand
    pose = from_opendrive(x_m, y_m, z_m, heading_rad)
    yaw, pitch = pose.rotation.yaw + (180.0 if backwards else 0.0), math.degrees(slope)
    return pose._replace(rotation=Rotation(360.0 - pitch if backwards else pitch, yaw, 0.0))


def _way_out(tables: Tables, lane: int) -> int:
    """Return 1 for the right, -1 for the left of the lane's traffic, 0 where driving lanes lie on both sides."""
    row = tables.lanes[lane]
    road_index, section, lane_id = (int(row[name]) for name in ("road", "section", "lane_id"))
    outward = lane_id + (1 if lane_id > 0 else -1)
    inward = -lane_id if abs(lane_id) == 1 else lane_id - (1 if lane_id > 0 else -1)
    right_drives, left_drives = (
        neighbour is not None and tables.lanes["type_bits"][neighbour] == LaneType.DRIVING
        for neighbour in (tables.lane_row.get((road_index, section, other)) for other in (outward, inward))
    )
    if tables.roads[road_index].is_right_hand:
        return 1 if not right_drives else -1 if not left_drives else 0
    return -1 if not left_drives else 1 if not right_drives else 0
