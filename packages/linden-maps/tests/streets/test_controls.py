"""Signs stand right of the traffic they are for, at a line that it reaches before the junction."""

import math
from typing import Any

import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.checks.check import Severity, check
from linden_maps.streets.build import Built
from linden_maps.streets.curves import length, moved, pose_at, seen_from
from linden_maps.streets.document import RoadRecord, Signal
from linden_maps.streets.writing import text


def signals_of(built: Built) -> list[tuple[RoadRecord, Signal]]:
    return [(road, signal) for road in built.document.roads for signal in road.signals]


def test_two_way_stops_stand_on_the_named_street_alone(built_of: Any, sketch: Any) -> None:
    built = built_of(sketch.crossing("two_way_stop", stop_controlled_streets=["north Street"]))
    assert [(road.name, signal.kind) for road, signal in signals_of(built)] == [("north Street", "206")] * 2


def test_all_way_stops_stand_on_every_leg_with_a_crosswalk(built_of: Any, sketch: Any) -> None:
    built = built_of(sketch.crossing("all_way_stop"))
    assert [signal.kind for _, signal in signals_of(built)] == ["206"] * 4
    names = [thing.name for road in built.document.roads for thing in road.objects]
    assert (names.count("Crosswalk"), names.count("StopLine")) == (4, 4)


def test_a_sign_is_valid_for_the_lanes_that_come_in_and_stands_right_of_them(built_of: Any, sketch: Any) -> None:
    for road, signal in signals_of(built_of(sketch.crossing("all_way_stop"))):
        arrives_along = signal.lanes[0] < 0
        at_end = signal.s_m > length(road.path) / 2
        assert arrives_along == at_end
        at = pose_at(road.path, signal.s_m)
        ahead = at if arrives_along else at._replace(heading_rad=at.heading_rad + math.pi)
        stands = moved(at, left_m=signal.t_m)
        _, left_m = seen_from(ahead, stands[:2])
        assert left_m == pytest.approx(-(7.9 / 2 + 0.75), abs=0.01)


def test_crosswalk_outlines_are_closed(built_of: Any, sketch: Any) -> None:
    things = [thing for road in built_of(sketch.crossing("signal")).document.roads for thing in road.objects]
    walks = [thing for thing in things if thing.kind == "crosswalk"]
    assert len(walks) == 4
    assert all(walk.outline[0] == walk.outline[-1] and len(walk.outline) == 5 for walk in walks)


def test_every_approach_with_a_light_has_a_turn_of_its_own(built_of: Any, sketch: Any) -> None:
    built = built_of(sketch.crossing("signal"))
    lights = [signal for _, signal in signals_of(built)]
    assert all(signal.dynamic and signal.kind == "1000001" for signal in lights)
    turns = [controller.signals for controller in built.document.controllers]
    assert [len(turn) for turn in turns] == [1, 1, 1, 1]
    assert sorted(turn[0] for turn in turns) == sorted(signal.id for signal in lights)
    assert built.document.junctions[0].controllers == tuple(one.id for one in built.document.controllers)


def test_ways_without_a_sign_go_first(built_of: Any, sketch: Any) -> None:
    built = built_of(sketch.crossing("two_way_stop", stop_controlled_streets=["north Street"]))
    come = {way.record.id: built.network.edges[way.come.edge].street.id for way in built.ways}
    pairs = built.document.junctions[0].priorities
    assert pairs
    assert {(come[high], come[low]) for high, low in pairs} == {("east", "north")}


def test_a_shuttle_stop_has_a_crosswalk_behind_it(built_of: Any, sketch: Any) -> None:
    stop = sketch.point("shuttle_stop", "S1", (60.0, -4.0), street_id="east", forward=True)
    built = built_of([*sketch.crossing(), stop])
    (walk,) = [thing for road in built.document.roads for thing in road.objects if thing.kind == "crosswalk"]
    road = next(road for road in built.document.roads if walk in road.objects)
    assert pose_at(road.path, walk.s_m).x_m == pytest.approx(52.0, abs=0.3)


@pytest.mark.parametrize("control", ["signal", "all_way_stop"])
@pytest.mark.parametrize("width_m", [6.0, 8.0, 10.0])
def test_libcarla_leaves_every_post_where_it_stands(control: str, width_m: float, built_of: Any, sketch: Any) -> None:
    wide = {"width_m": width_m, "lanes": 2, "parking": "none"}
    streets = [
        sketch.street("east", (-100.0, 0.0), (0.0, 0.0), (100.0, 0.0), **wide),
        sketch.street("north", (0.0, -100.0), (0.0, 0.0), (0.0, 100.0), **wide),
        sketch.point("intersection", "middle", (0.0, 0.0), control=control),
    ]
    found = check(parse(text(built_of(streets).document)))
    assert [str(finding) for finding in found if finding.severity is not Severity.NOTE] == []
