"""Claims about where vehicles may be put."""

import math
from importlib import resources

import carla
import pytest

from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.spawn_points import spawn_points
from linden.protocol.values.space import Transform
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

LINDEN = (resources.files("linden") / "data" / "Linden.xodr").read_text()


def along(length: float, right: str, left: str = "", **more: str) -> tuple[Transform, ...]:
    return spawn_points(
        parse(opendrive(road(4, length, line(0, 0, 0, 0, length), section(left=left, right=right), **more)))
    )


def test_points_stand_thirty_metres_apart_in_the_middle_of_the_road() -> None:
    assert [point.location.x for point in along(80.0, lane(-1))] == pytest.approx([10.0, 40.0, 70.0])


def test_a_road_too_short_for_its_margins_has_none() -> None:
    assert along(11.9, lane(-1)) == ()
    assert len(along(12.0, lane(-1))) == 1


def test_each_driving_lane_looks_the_way_of_its_traffic() -> None:
    right, left = along(20.0, lane(-1), lane(1))
    assert (right.rotation.yaw, abs(left.rotation.yaw)) == pytest.approx((0.0, 180.0))
    assert (left.location.y, right.location.y) == pytest.approx((-1.75, 1.75))


def test_where_one_drives_on_the_left_the_headings_are_swapped() -> None:
    right, left = along(20.0, lane(-1), lane(1), rule="LHT")
    assert (abs(right.rotation.yaw), left.rotation.yaw) == pytest.approx((180.0, 0.0))


def test_pavements_parking_and_slivers_have_none() -> None:
    assert along(40.0, lane(-1, "sidewalk") + lane(-2, "parking") + lane(-3, width=1.9)) == ()


def test_points_stand_half_a_metre_above_a_slope_and_lean_with_it() -> None:
    right, left = along(20.0, lane(-1), lane(1), elevation='<elevation s="0" a="5" b="0.1" c="0" d="0"/>')
    assert right.location.z == pytest.approx(6.5)
    assert right.rotation.pitch == pytest.approx(math.degrees(math.atan(0.1)))
    assert left.rotation.pitch == pytest.approx(-right.rotation.pitch)


def test_junctions_have_none_and_the_order_is_that_of_the_roads() -> None:
    xs = [round(point.location.x) for point in spawn_points(parse(street_through_junction()))]
    assert all(x < 50 or x > 70 for x in xs)
    assert xs == sorted(xs)


def test_lindens_points_are_where_libcarla_has_its_lanes() -> None:
    theirs = carla.Map("Linden", LINDEN)
    points = spawn_points(parse(LINDEN))
    assert len(points) > 300
    for (x, y, z), rotation in points:
        waypoint = theirs.get_waypoint(carla.Location(x, y, z), project_to_road=False)
        assert waypoint is not None
        assert not waypoint.is_junction
        # LibCarla looks for the nearest place on chords of its own, so in bends it answers some way along the lane
        assert waypoint.transform.location.distance(carla.Location(x, y, z - 0.5)) < 0.2
        assert abs(math.remainder(waypoint.transform.rotation.yaw - rotation.yaw, 360.0)) < 3.0
