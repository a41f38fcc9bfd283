"""Streets become roads that end where the kerbs of a junction's corners begin."""

import math
from typing import Any

import pytest

from linden.errors import UserError
from linden_maps.streets.curves import length, sharpest
from linden_maps.streets.network import CORNER_RADII_M, SHORTEST_ROAD_M, build, nearest_road


def test_a_crossing_has_four_legs_counter_clockwise_that_look_in(facts_of: Any, sketch: Any) -> None:
    network = build(facts_of(sketch.crossing()))
    ((_, legs),) = network.junctions
    assert [leg.street.id for leg in legs] == ["east", "north", "east", "north"]
    looking_deg = [round(math.degrees(leg.pose.heading_rad)) % 360 for leg in legs]
    assert looking_deg == [180, 270, 0, 90]
    assert all(math.dist(leg.pose[:2], (0.0, 0.0)) == pytest.approx(leg.setback_m, abs=0.01) for leg in legs)


def test_legs_at_right_angles_are_cut_to_the_other_kerb_and_the_corner_radius(facts_of: Any, sketch: Any) -> None:
    ((_, legs),) = build(facts_of(sketch.crossing())).junctions
    assert legs[0].setback_m == pytest.approx(7.9 / 2 + CORNER_RADII_M[0], abs=0.05)


def test_an_acute_corner_cuts_further_back(facts_of: Any, sketch: Any) -> None:
    features = [
        sketch.street("main", (-100.0, 0.0), (0.0, 0.0), (100.0, 0.0)),
        sketch.street("slant", (0.0, 0.0), (80.0, 80.0)),
    ]
    ((_, legs),) = build(facts_of(features)).junctions
    slant = next(leg for leg in legs if leg.street.id == "slant")
    # kerb lines 3.95 m off axes 45 degrees apart meet 3.95 / tan(22.5) out; the arc's tangent adds 6 / tan(22.5)
    assert slant.setback_m == pytest.approx((7.9 / 2 + CORNER_RADII_M[0]) / math.tan(math.radians(22.5)), abs=0.1)


def test_junctions_that_leave_no_road_between_them_become_one(facts_of: Any, sketch: Any) -> None:
    features = [
        sketch.street("main", (-100.0, 0.0), (0.0, 0.0), (15.0, 0.0), (100.0, 0.0)),
        sketch.street("up", (0.0, 0.0), (0.0, 90.0)),
        sketch.street("down", (15.0, 0.0), (15.0, -90.0)),
    ]
    network = build(facts_of(features))
    ((nodes, legs),) = network.junctions
    assert len(nodes) == 2
    assert len(legs) == 4
    assert [road is None for road in network.roads] == [False, True, False, False, False]


def test_junctions_that_leave_a_road_with_tighter_corners_stay_two(facts_of: Any, sketch: Any) -> None:
    features = [
        sketch.street("main", (-100.0, 0.0), (0.0, 0.0), (21.0, 0.0), (100.0, 0.0)),
        sketch.street("up", (0.0, 0.0), (0.0, 90.0)),
        sketch.street("down", (21.0, 0.0), (21.0, -90.0)),
    ]
    network = build(facts_of(features))
    assert len(network.junctions) == 2
    between = network.roads[1]
    assert between is not None
    assert SHORTEST_ROAD_M <= length(between) < 7.0


def test_streets_that_pass_without_a_shared_point_do_not_meet(facts_of: Any, sketch: Any) -> None:
    features = [
        sketch.street("below", (-50.0, 0.0), (50.0, 0.0)),
        sketch.street("above", (0.0, -50.0), (0.0, 50.0)),
    ]
    network = build(facts_of(features))
    assert network.junctions == ()
    assert [length(road) for road in network.roads if road is not None] == pytest.approx([100.0, 100.0], abs=0.1)


def test_a_bent_street_is_rounded_by_its_class(facts_of: Any, sketch: Any) -> None:
    features = [sketch.street("lane", (0.0, 0.0), (100.0, 0.0), (200.0, 30.0))]
    (road,) = build(facts_of(features)).roads
    assert road is not None
    assert 1 / sharpest(road) == pytest.approx(20.0)


def test_an_intersection_where_no_streets_meet_is_refused(facts_of: Any, sketch: Any) -> None:
    lost = sketch.point("intersection", "lost", (40.0, 40.0), control="none")
    with pytest.raises(UserError, match="intersection lost: no two streets share its point"):
        build(facts_of([*sketch.crossing(), lost]))


def test_the_nearest_road_of_a_street_is_found_with_the_place_on_it(facts_of: Any, sketch: Any) -> None:
    network = build(facts_of(sketch.crossing()))
    edge, s_m = nearest_road(network, "east", (60.0, 5.0))
    assert network.edges[edge].street.id == "east"
    assert edge == 1
    assert s_m == pytest.approx(60.0 - 7.9 / 2 - CORNER_RADII_M[0], abs=0.2)
