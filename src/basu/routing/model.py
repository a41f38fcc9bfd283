"""The planned route: lane-centre points with arc length, limits, service stops and the controls on the way."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import carla
    import numpy as np
    from numpy.typing import NDArray

    from basu.routing.timetable import Timetable


class ControlKind(enum.Enum):
    """What makes a driver stop or give way."""

    STOP_SIGN = "stop_sign"  # OpenDRIVE signal type 206
    YIELD_SIGN = "yield_sign"  # 205
    TRAFFIC_LIGHT = "traffic_light"  # 1000001 and its relatives


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """A stop sign, yield sign or traffic light that governs the route's lane."""

    kind: ControlKind
    landmark_id: str  # OpenDRIVE signal id; a traffic light's actor is world.get_traffic_light_from_opendrive_id(...)
    s_m: float  # along the route, where the line to stop at is crossed
    x_m: float  # the lane's centre at the line, CARLA frame
    y_m: float
    z_m: float
    yaw_rad: float  # of the lane at the line, CARLA frame (clockwise from above)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """A service stop, where passengers get on and off."""

    id: str
    name: str
    s_m: float  # along the route
    x_m: float  # as the route file has it, CARLA frame
    y_m: float
    z_m: float
    yaw_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Route:
    """A path along lane centres, about one point a metre, all arrays of one length N. CARLA frame, yaw in rad."""

    id: str
    town: str
    points_m: NDArray[np.float64]  # (N, 3)
    s_m: NDArray[np.float64]  # (N,) arc length in the plane from the first point, strictly increasing
    yaw_rad: NDArray[np.float64]  # (N,) of the lane
    lane_width_m: NDArray[np.float64]  # (N,)
    speed_limit_mps: NDArray[np.float64]  # (N,) as the map posts it, nan where it posts none
    is_junction: NDArray[np.bool_]  # (N,)
    road_id: NDArray[np.int64]  # (N,)
    lane_id: NDArray[np.int64]  # (N,)
    stops: tuple[Stop, ...] = ()  # in the order in which the route passes them
    controls: tuple[Control, ...] = ()  # likewise
    timetable: Timetable | None = None  # when it is due at its stops; None where nobody said
    waypoints: tuple[carla.Waypoint, ...] = field(default=(), repr=False)  # (N,)

    @property
    def length_m(self) -> float:
        """The arc length of the plan, L_I in equation 5.3."""
        return float(self.s_m[-1])
