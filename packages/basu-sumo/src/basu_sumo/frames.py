"""Poses of SUMO as poses of CARLA and back: pure functions in m, degrees and rad.

SUMO: x east, y north, angle clockwise from north, position of the front bumper. CARLA: y south, yaw clockwise from
east, position of the middle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

NORTH_YAW_DEG = 90.0  # SUMO's angle of a vehicle that faces CARLA's x axis


class Pose(NamedTuple):
    """The middle of a vehicle on the ground, CARLA's frame."""

    x_m: float
    y_m: float
    z_m: float
    pitch_deg: float
    yaw_deg: float


def from_sumo(
    front_m: tuple[float, float, float], angle_deg: float, slope_deg: float, length_m: float,
    offset_m: tuple[float, float],
) -> Pose:  # fmt: skip
    """Return the pose of a vehicle with its front bumper at ``front_m`` in SUMO's network."""
    heading, slope = math.radians(angle_deg), math.radians(slope_deg)
    back_m = 0.5 * length_m * math.cos(slope)
    x_m = front_m[0] - math.sin(heading) * back_m - offset_m[0]
    y_m = front_m[1] - math.cos(heading) * back_m - offset_m[1]
    z_m = front_m[2] - 0.5 * length_m * math.sin(slope)
    return Pose(x_m, -y_m, z_m, slope_deg, angle_deg - NORTH_YAW_DEG)


def to_sumo(
    x_m: float, y_m: float, yaw_deg: float, half_length_m: float, offset_m: tuple[float, float]
) -> tuple[float, float, float]:
    """Return the front bumper's x and y in SUMO's network, and SUMO's angle, of a vehicle in CARLA's frame."""
    yaw = math.radians(yaw_deg)
    front_x_m, front_y_m = x_m + math.cos(yaw) * half_length_m, y_m + math.sin(yaw) * half_length_m
    return front_x_m + offset_m[0], -front_y_m + offset_m[1], (yaw_deg + NORTH_YAW_DEG) % 360.0
