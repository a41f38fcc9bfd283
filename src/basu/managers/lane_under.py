"""Which lane lies under the vehicle's middle, and how the vehicle stands in it: asked of the client's map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import carla

if TYPE_CHECKING:
    from basu.managers.base_manager import Ego


class LaneUnder(NamedTuple):
    """One frame's lane, in the order of the columns of ``history.FRAME``."""

    road_id: int
    lane_id: int
    lane_type: int  # the value of carla.LaneType; 0 where there is no lane
    lane_offset_m: float  # of the vehicle's origin from the lane's middle, positive to the right; nan without a lane
    lane_heading_rad: float  # the vehicle's yaw less the lane's, in -pi..pi; nan without a lane
    lane_width_m: float  # nan without a lane
    in_junction: bool
    off_lane_m: float  # how far the origin is beyond the edge of the nearest driving or parking lane; 0 within one


FOR_VEHICLES = (carla.LaneType.Driving, carla.LaneType.Bidirectional, carla.LaneType.Parking)
NO_LANE = LaneUnder(0, 0, 0, math.nan, math.nan, math.nan, in_junction=False, off_lane_m=math.nan)


class LaneFinder:
    """Finds the lane under a vehicle; one that stands still is not looked for again."""

    def __init__(self, carla_map: carla.Map) -> None:
        self._map = carla_map
        self._pose: tuple[float, ...] = ()
        self._found = NO_LANE

    def under(self, ego: Ego) -> LaneUnder:
        """The lane, of whatever type, that the vehicle's origin lies on."""
        pose = (ego.x_m, ego.y_m, ego.z_m, ego.yaw_rad)
        if pose != self._pose:
            self._pose, self._found = pose, lane_under(self._map, ego)
        return self._found


def lane_under(carla_map: carla.Map, ego: Ego) -> LaneUnder:
    """The lane, of whatever type, that the vehicle's origin lies on."""
    place = carla.Location(ego.x_m, ego.y_m, ego.z_m)
    waypoint = carla_map.get_waypoint(place, project_to_road=False, lane_type=carla.LaneType.Any)
    if waypoint is None:
        return NO_LANE._replace(off_lane_m=_off_lane_m(carla_map, place))
    middle = waypoint.transform
    yaw_rad = math.radians(middle.rotation.yaw)
    to_x_m, to_y_m = ego.x_m - middle.location.x, ego.y_m - middle.location.y
    return LaneUnder(
        road_id=waypoint.road_id,
        lane_id=waypoint.lane_id,
        lane_type=int(waypoint.lane_type),
        lane_offset_m=to_y_m * math.cos(yaw_rad) - to_x_m * math.sin(yaw_rad),
        lane_heading_rad=math.remainder(ego.yaw_rad - yaw_rad, math.tau),
        lane_width_m=waypoint.lane_width,
        in_junction=waypoint.is_junction,
        off_lane_m=0.0 if waypoint.lane_type in FOR_VEHICLES else _off_lane_m(carla_map, place),
    )


def _off_lane_m(carla_map: carla.Map, place: carla.Location) -> float:
    """The distance to the edge of the nearest lane for vehicles, inf where the map has none; 0 within one."""
    nearest = (carla_map.get_waypoint(place, lane_type=lane_type) for lane_type in FOR_VEHICLES)
    beyond_m = (
        math.hypot(place.x - lane.transform.location.x, place.y - lane.transform.location.y) - lane.lane_width / 2.0
        for lane in nearest
        if lane is not None
    )
    return max(0.0, min(beyond_m, default=math.inf))
