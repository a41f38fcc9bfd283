"""Claims about an agent's own route: every form in which CARLA's tools give one is taken."""

import math
from enum import IntEnum
from typing import Any

import carla
import pytest

from basu.agents.calls import route_point
from basu.routing.route_file import RoutePoint
from fakes.one_road import one_road


class RoadOption(IntEnum):
    """As in CARLA's agents."""

    LANEFOLLOW = 4


def test_pairs_of_a_planner_are_points_of_a_route() -> None:
    waypoint = one_road().get_waypoint(carla.Location(20.0, 1.75, 0.0))
    at = waypoint.transform.location
    expected = RoutePoint(at.x, at.y, at.z, math.radians(waypoint.transform.rotation.yaw))
    option = RoadOption.LANEFOLLOW
    assert route_point((waypoint, option)) == expected
    assert route_point([waypoint.transform, option]) == expected
    assert route_point((at, option)) == RoutePoint(at.x, at.y, at.z)
    assert route_point(waypoint) == expected


@pytest.mark.parametrize("place", [(1.0, 2.0), "ab", None, (carla.Location(),), (None, RoadOption.LANEFOLLOW)])
def test_what_is_no_place_is_none(place: Any) -> None:
    with pytest.raises((TypeError, ValueError, AttributeError)):
        route_point(place)
