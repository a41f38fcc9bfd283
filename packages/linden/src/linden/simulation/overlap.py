"""Overlap of upright boxes: the bodies that a box would touch at a place."""

import math

import numpy as np
from numpy.typing import NDArray

from linden.physics.state import Rows
from linden.protocol.values.space import BoundingBox, Transform

F64 = NDArray[np.float64]


def world_centres(state: Rows) -> F64:
    """Return the middles of all boxes of BODY (N,) in the world (N, 3), m; what little they lean is left out."""
    cosine, sine = np.cos(state["rotation"][:, 1]), np.sin(state["rotation"][:, 1])
    x, y, z = state["box_centre"].T
    centres: F64 = state["position"] + np.column_stack([cosine * x - sine * y, sine * x + cosine * y, z])
    return centres


def touching(
    box: BoundingBox, pose: Transform, centre_m: F64, half_extent_m: F64, yaw_rad: F64, candidates: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the ``candidates`` with boxes that touch ``box`` at ``pose``, in their order.

    The columns are (N, 3), (N, 3) and (N,), in the world, centres being those of the boxes. Boxes are upright: they
    touch where their heights overlap and no edge direction of either separates them in the plane (Ericson, Real-Time
    Collision Detection, section 4.4.1, separating axes).
    """
    yaw = math.radians(pose.rotation.yaw)
    cosine, sine = math.cos(yaw), math.sin(yaw)
    local = box.location
    centre = np.array(
        [
            pose.location.x + cosine * local.x - sine * local.y,
            pose.location.y + sine * local.x + cosine * local.y,
            pose.location.z + local.z,
        ]
    )
    apart = centre_m[candidates] - centre
    half = half_extent_m[candidates]
    meets = np.abs(apart[:, 2]) < half[:, 2] + box.extent.z
    directions = yaw_rad[candidates]
    for axis_yaw in (np.full(len(candidates), yaw), directions):
        for quarter in (0.0, math.pi / 2):
            axis = axis_yaw + quarter
            gap = np.abs(apart[:, 0] * np.cos(axis) + apart[:, 1] * np.sin(axis))
            own = _reach(box.extent.x, box.extent.y, yaw - axis)
            meets &= gap < own + _reach(half[:, 0], half[:, 1], directions - axis)
    found: NDArray[np.int64] = candidates[meets]
    return found


def _reach(half_x_m: F64 | float, half_y_m: F64 | float, angle_rad: F64) -> F64:
    """Return how far a rectangle reaches along an axis that makes ``angle_rad`` with its x side."""
    reach: F64 = half_x_m * np.abs(np.cos(angle_rad)) + half_y_m * np.abs(np.sin(angle_rad))
    return reach
