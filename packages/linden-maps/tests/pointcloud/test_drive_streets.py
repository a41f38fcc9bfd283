"""Claims about where the lidar is taken."""

import math

import numpy as np
import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.pointcloud.drive import places_along
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction


def test_a_street_has_a_place_all_along_and_none_too_near_to_another() -> None:
    places = np.array(places_along(parse(street_through_junction()), 5.0, 2.0))
    along = np.arange(0.5, 130.0, 1.0)
    for y in (-1.75, 1.75):  # both lanes, the junction as well
        nearest = np.hypot(along[:, None] - places[:, 0], y - places[:, 1]).min(axis=1)
        assert nearest.max() <= 5.0
    apart = np.hypot(*(places[:, None, :2] - places[None, :, :2]).transpose(2, 0, 1)) + 1e9 * np.eye(len(places))
    assert apart.min() >= 5.0


def test_a_place_is_in_the_lane_above_the_road_in_the_frame_of_the_map() -> None:
    slope = '<elevation s="0" a="100" b="0.1" c="0" d="0"/>'
    town = opendrive(road(1, 40.0, line(0, 7, 9, math.pi / 2, 40), section(right=lane(-1)), elevation=slope))
    places = places_along(parse(town), 4.0, 2.5)
    assert len(places) >= 8
    for place in places:
        assert place.x_m == pytest.approx(7.0 + 1.75)  # on the right of a road that leads north
        assert place.z_m == pytest.approx(102.5 + 0.1 * (place.y_m - 9.0))
        assert place.heading_rad == pytest.approx(math.pi / 2)


def test_both_frames_of_a_place_are_the_same_place() -> None:
    (place, *_) = places_along(parse(street_through_junction()), 200.0, 2.0)
    x, y, z = place.transform.location
    assert (x, -y, z) == pytest.approx((place.x_m, place.y_m, place.z_m))
    assert place.transform.rotation.yaw == pytest.approx(-math.degrees(place.heading_rad))
    np.testing.assert_allclose(place.map_from_sensor[:, 3], [place.x_m, place.y_m, place.z_m])


def test_lanes_without_traffic_are_left_out() -> None:
    town = opendrive(road(1, 40.0, line(0, 0, 0, 0, 40), section(right=lane(-1, "sidewalk"))))
    assert places_along(parse(town), 5.0, 2.0) == []
