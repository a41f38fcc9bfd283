"""The record of a run: its frames as one packed array, its events, and the facts that do not change meanwhile.

A frame's ``tick`` counts from 0 at the first step of the agent and ``t_s`` is ``tick`` times the step, so that two
runs of one seed leave the same bytes whatever the server's own frame counter says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.routing import Route

# One row a tick. World quantities in CARLA's frame (x east, y south, z up), angles in rad, yaw clockwise from above.
FRAME = np.dtype(
    [
        ("tick", "<i8"),
        ("t_s", "<f8"),
        ("x_m", "<f8"),
        ("y_m", "<f8"),
        ("z_m", "<f8"),
        ("roll_rad", "<f8"),
        ("pitch_rad", "<f8"),
        ("yaw_rad", "<f8"),
        ("velocity_x_mps", "<f8"),
        ("velocity_y_mps", "<f8"),
        ("velocity_z_mps", "<f8"),
        ("acceleration_x_mps2", "<f8"),
        ("acceleration_y_mps2", "<f8"),
        ("acceleration_z_mps2", "<f8"),
        ("angular_velocity_x_radps", "<f8"),
        ("angular_velocity_y_radps", "<f8"),
        ("angular_velocity_z_radps", "<f8"),
        ("throttle", "<f8"),  # what the agent answered in this frame; its last answer where it gave none
        ("steer", "<f8"),
        ("brake", "<f8"),
        ("hand_brake", "<i1"),
        ("reverse", "<i1"),
        ("speed_limit_mps", "<f8"),  # as the simulator posts it to the vehicle; 0 where it posts none
        (
            "traffic_light_state",
            "<i1",
        ),  # carla.TrafficLightState of the light the vehicle stands under, NO_LIGHT for none
        ("route_s_m", "<f8"),  # progress along the planned route
        ("lateral_m", "<f8"),  # off the route, positive to the right
        ("route_light", "<i1"),  # of the next light on the route whose line is not 1 m behind the rear, as above
        ("manual", "<i1"),  # a person drives
        ("road_id", "<i4"),  # the lane under the vehicle's origin, whatever its type
        ("lane_id", "<i4"),
        ("lane_type", "<i4"),  # carla.LaneType; 0 where there is no lane
        ("lane_offset_m", "<f8"),  # off that lane's middle, positive to the right; nan where there is none
        ("lane_heading_rad", "<f8"),  # the vehicle's yaw less the lane's; nan where there is none
        ("lane_width_m", "<f8"),  # nan where there is none
        ("in_junction", "<i1"),
        ("off_lane_m", "<f8"),  # beyond the edge of the nearest driving or parking lane; 0 within one
    ]
)

# Who was near, nearest first: at most NEAREST rows a tick.
OTHER = np.dtype(
    [
        ("tick", "<i8"),
        ("id", "<u4"),
        ("x_m", "<f8"),
        ("y_m", "<f8"),
        ("z_m", "<f8"),
        ("yaw_rad", "<f8"),
        ("velocity_x_mps", "<f8"),
        ("velocity_y_mps", "<f8"),
    ]
)
NO_LIGHT = -1
NEAREST, NEAR_M = 16, 60.0  # how many others are recorded, and out to which distance


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """One message of the collision sensor: a contact lasts for many."""

    tick: int
    other_id: int  # 0 for scenery
    other_type: str  # blueprint id, `static.<tag>` for scenery
    impulse_ns: tuple[float, float, float]  # world frame


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneInvasion:
    """One message of the client's lane-invasion sensor."""

    tick: int
    markings: tuple[str, ...]  # what was crossed, as `type/colour`


@dataclass(frozen=True, slots=True, kw_only=True)
class Vehicle:
    """The vehicle under test; distances from its origin in m."""

    type_id: str
    front_m: float  # to the front bumper
    rear_m: float  # to the rear bumper, positive
    width_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """What does not change during a run."""

    step_s: float  # simulated time from tick to tick
    vehicle: Vehicle
    route: Route
    actor_types: Mapping[int, str]  # blueprint ids of all who were ever near
    actor_sizes: Mapping[int, tuple[float, float]]  # half the length and half the width of their boxes, m


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """The whole record of a run."""

    facts: Facts
    frames: NDArray[np.void]  # (T,) of FRAME, ticks ascending without a gap
    others: NDArray[np.void]  # (M,) of OTHER, ticks ascending
    collisions: tuple[Collision, ...]  # ticks ascending
    lane_invasions: tuple[LaneInvasion, ...]  # ticks ascending

    def speed_mps(self) -> NDArray[np.float64]:
        """(T,) speed over ground."""
        frames = self.frames
        squared: NDArray[np.float64] = np.sum([frames[f"velocity_{axis}_mps"] ** 2 for axis in "xyz"], axis=0)
        return np.sqrt(squared)
