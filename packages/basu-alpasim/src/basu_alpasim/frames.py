"""CARLA's left-handed frames as AlpaSim's right-handed ones, and back.

AlpaSim's ``local`` frame is here CARLA's world with the sign of y changed. Its rig frame lies on the ground below the
middle of the rear axle, x forward, y left, z up. Quaternions and poses are those of ``carla_driver_interface``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np
from carla_driver_interface.geometry import Pose, body_to_optical
from carla_driver_interface.protocol import DynamicState, Vec3
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.agents.sensor_file import SensorSpec
    from basu.records.motion import VehicleMotion

UPRIGHT = 1.0 - 1e-9  # the sine of a pitch from which yaw and roll cannot be told apart


def pose_of(
    x_m: float, y_m: float, z_m: float, roll_rad: float = 0.0, pitch_rad: float = 0.0, yaw_rad: float = 0.0
) -> Pose:
    """Return a pose of CARLA's axes in right-handed ones."""
    turn = Rotation.from_euler("ZYX", [-yaw_rad, -pitch_rad, roll_rad])
    return Pose.from_rotation([x_m, -y_m, z_m], turn)


def rig_pose(motion: VehicleMotion, rear_axle_m: float) -> Pose:
    """Return the rig of a vehicle in the local frame; its rear axle lies ``rear_axle_m`` behind its origin."""
    return pose_of(*motion[:6]) @ Pose.from_xyz_yaw(-rear_axle_m, 0.0, 0.0, 0.0)


class OriginPose(NamedTuple):
    """The origin of a vehicle in CARLA's world."""

    x_m: float
    y_m: float
    yaw_rad: float  # clockwise from above


def origin_of(rig: Pose, rear_axle_m: float) -> OriginPose:
    """Return a vehicle's origin from the pose of its rig in the local frame."""
    x_m, y_m = (rig @ Pose.from_xyz_yaw(rear_axle_m, 0.0, 0.0, 0.0)).position[:2].tolist()
    return OriginPose(x_m, -y_m, -rig.yaw)


def dynamic_state(motion: VehicleMotion, rear_axle_m: float) -> DynamicState:
    """Return velocity and acceleration of the rig, in the rig's axes: m/s, m/s², rad/s.

    The velocity is that of the rear axle. The acceleration is that of the vehicle's origin, as CARLA measures it. The
    angular acceleration, which CARLA does not measure, stays 0.
    """
    into_rig = pose_of(*motion[:6]).rotation.inv()
    velocity, acceleration, spin = (np.array(motion[first : first + 3]) for first in (6, 9, 12))
    mirrored = np.array([1.0, -1.0, 1.0])
    spin_in_rig = into_rig.apply(-mirrored * spin)  # an axial vector: x and z change their signs
    velocity_in_rig = into_rig.apply(mirrored * velocity) + np.cross(spin_in_rig, [-rear_axle_m, 0.0, 0.0])
    return DynamicState(
        angular_velocity=_vec3(spin_in_rig),
        linear_velocity=_vec3(velocity_in_rig),
        linear_acceleration=_vec3(into_rig.apply(mirrored * acceleration)),
    )


def camera_in_rig(spec: SensorSpec, rear_axle_m: float) -> Pose:
    """Return a camera's optical frame (x right, y down, z along the axis) in the rig."""
    return body_to_optical(sensor_in_rig(spec, rear_axle_m))


def sensor_in_rig(spec: SensorSpec, rear_axle_m: float) -> Pose:
    """Return a sensor's frame (x forward, y left, z up) in the rig; the vehicle's origin is on the ground."""
    angles = (math.radians(angle) for angle in (spec.roll_deg, spec.pitch_deg, spec.yaw_deg))
    return pose_of(spec.x_m + rear_axle_m, spec.y_m, spec.z_m, *angles)


def _vec3(values: NDArray[np.float64]) -> Vec3:
    """Return three numbers as a message."""
    x, y, z = values.tolist()
    return Vec3(x=x, y=y, z=z)


def transform_of(pose: Pose) -> carla.Transform:
    """Return a pose of right-handed axes (x forward, y left, z up) in CARLA's axes; the inverse of `pose_of`."""
    turn = pose.rotation_matrix
    pitch = -math.asin(max(-1.0, min(1.0, -float(turn[2, 0]))))
    if abs(turn[2, 0]) < UPRIGHT:
        yaw, roll = -math.atan2(turn[1, 0], turn[0, 0]), math.atan2(turn[2, 1], turn[2, 2])
    else:  # it looks straight up or down, and yaw and roll are the same turn
        yaw, roll = -math.atan2(-turn[0, 1], turn[1, 1]), 0.0
    x_m, y_m, z_m = pose.position.tolist()
    angles = {"pitch": math.degrees(pitch), "yaw": math.degrees(yaw), "roll": math.degrees(roll)}
    return carla.Transform(carla.Location(x_m, -y_m, z_m), carla.Rotation(**angles))
