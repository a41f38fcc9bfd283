"""The answer of a policy: its trajectory, checked, and as a path with speeds that a vehicle can follow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from carla_driver_interface.geometry import Pose

from basu.agents.builtin.driving.path import make_path
from basu.errors import AgentInvalidControlError
from basu_alpasim.frames import origin_of

if TYPE_CHECKING:
    from carla_driver_interface.protocol import DriveResponse, PoseAtTime
    from numpy.typing import NDArray

    from basu.agents.builtin.driving.path import SampledPath
    from basu_alpasim.frames import OriginPose

BEYOND_M = 15.0  # a path goes straight on this far beyond both ends of a trajectory, for lateral errors and previews
SAME_M = 0.02  # points that lie nearer together than this have no direction
MOST_POSES = 10_000  # of an answer; AlpaSim's policies give some 60
LEAST_QUATERNION = 1e-3  # the length of one that still is a direction


class Planned(NamedTuple):
    """One pose of a trajectory: time in µs, and the vehicle's origin in CARLA's world."""

    time_us: int
    origin: OriginPose


def read_plan(response: DriveResponse, now_us: int, rear_axle_m: float) -> list[Planned]:
    """Return the poses of a trajectory that lie after ``now_us``, in their order.

    Raises:
        AgentInvalidControlError: there is none, or a pose holds what is no pose or no time.
    """
    at = f"drive at {now_us * 1e-6:.2f} s"
    poses = response.trajectory.poses
    if not poses:
        raise AgentInvalidControlError(
            f"the policy answered {at} with an empty trajectory; one that wants to stand answers with its present pose "
            "at later times"
        )
    if len(poses) > MOST_POSES:
        raise AgentInvalidControlError(
            f"the policy answered {at} with a trajectory of {len(poses)} poses; at most {MOST_POSES} are read"
        )
    planned: list[Planned] = []
    before_us = -1
    for number, entry in enumerate(poses, start=1):
        time_us = int(entry.timestamp_us)
        if time_us <= before_us:
            raise AgentInvalidControlError(
                f"the policy answered {at} with times that do not rise: pose {number} is of {time_us} µs, the one "
                f"before it of {before_us} µs"
            )
        before_us = time_us
        _check(entry, number, at)
        if time_us > now_us:
            planned.append(Planned(time_us, origin_of(Pose.from_proto(entry.pose), rear_axle_m)))
    if not planned:
        raise AgentInvalidControlError(
            f"the policy answered {at} with a trajectory that ends at {before_us * 1e-6:.2f} s; it needs a pose after "
            "the time of the request"
        )
    return planned


def _check(entry: PoseAtTime, number: int, at: str) -> None:
    """Check one pose.

    Raises:
        AgentInvalidControlError: a value is no finite number, or the quaternion has no length.
    """
    vec, quat = entry.pose.vec, entry.pose.quat
    values = {"x": vec.x, "y": vec.y, "z": vec.z, "qw": quat.w, "qx": quat.x, "qy": quat.y, "qz": quat.z}
    for name, value in values.items():
        if not math.isfinite(value):
            raise AgentInvalidControlError(
                f"the policy answered {at} with {name} = {value} in pose {number}; it must be a finite number"
            )
    if math.hypot(quat.w, quat.x, quat.y, quat.z) < LEAST_QUATERNION:
        raise AgentInvalidControlError(
            f"the policy answered {at} with a quaternion of length 0 in pose {number}; without a turn it is w = 1"
        )


class Trajectory:
    """A trajectory as the vehicle follows it: the path of the vehicle's origin, and speeds by time.

    Attributes:
        path: through the poses after the present one, straight on at both ends. The present pose is left out: a policy
            that plans along the route's middle would otherwise seem to jump to it.
    """

    def __init__(self, planned: list[Planned], now_us: int, here: OriginPose) -> None:
        """Lay the path; ``here`` is where the vehicle's origin is at ``now_us``."""
        first = planned[0].origin
        places = [np.array([each.origin.x_m, each.origin.y_m]) for each in planned]
        ahead = _direction(first.yaw_rad)
        places_m = [places[0] - BEYOND_M * ahead, places[0]]
        lengths = [0.0]
        for place in places[1:]:
            step = place - places_m[-1]
            length_m = float(np.hypot(*step))
            if length_m < SAME_M or float(step @ ahead) < 0.0:  # standing, or backwards, which is not driven
                lengths.append(lengths[-1])
                continue
            ahead = step / length_m
            places_m.append(place)
            lengths.append(lengths[-1] + length_m)
        places_m.append(places_m[-1] + BEYOND_M * ahead)
        points_m = np.array(places_m)
        s_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m, axis=0).T))])
        self.path: SampledPath = make_path(points_m, s_m)
        self._set_speeds(np.array(lengths) + BEYOND_M, [each.time_us for each in planned], now_us, here)

    def _set_speeds(self, s_m: NDArray[np.float64], times_us: list[int], now_us: int, here: OriginPose) -> None:
        """Take the mean speed between two poses as the speed in the middle of their times.

        The speed now follows from the first two of these: a policy's first pose need not fit the place of the vehicle.
        A single pose is the place to be reached at its time.
        """
        times_s = np.array(times_us) * 1e-6
        if len(times_us) == 1:
            here_s_m = self.path.find(here.x_m, here.y_m, here.yaw_rad).s_m
            times_s, s_m = np.append(now_us * 1e-6, times_s), np.append(here_s_m, s_m)
        middles_s = (times_s[:-1] + times_s[1:]) / 2.0
        speeds_mps = np.diff(s_m) / np.diff(times_s)
        slope_mps2 = (
            float((speeds_mps[1] - speeds_mps[0]) / (middles_s[1] - middles_s[0])) if len(middles_s) > 1 else 0.0
        )
        now_mps = speeds_mps[0] - slope_mps2 * (middles_s[0] - now_us * 1e-6)
        self._times_s = np.append(now_us * 1e-6, middles_s)
        self._speeds_mps = np.maximum(np.append(now_mps, speeds_mps), 0.0)

    def speed_mps(self, time_s: float) -> float:
        """Return the speed at a time, in straight lines between the known ones, and constant beyond them."""
        return float(np.interp(time_s, self._times_s, self._speeds_mps))


def _direction(yaw_rad: float) -> NDArray[np.float64]:
    """Return the unit vector of a heading."""
    return np.array([math.cos(yaw_rad), math.sin(yaw_rad)])
