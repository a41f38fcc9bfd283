"""Every allowed turn has a smooth way, every lane a way on and a way in, and kerbs go round the corners."""

import math
from itertools import pairwise
from typing import Any

import pytest

from linden_maps.streets.curves import along, length, moved, wrapped
from linden_maps.streets.document import value
from linden_maps.streets.junctions import conflicting, corner_road, lane_pairs, pose_in, pose_out, surface, turns
from linden_maps.streets.network import Leg, build


@pytest.fixture
def crossing_legs(facts_of: Any, sketch: Any) -> tuple[Leg, ...]:
    found: tuple[Leg, ...] = build(facts_of(sketch.crossing())).junctions[0][1]
    return found


def legs_of(features: Any, facts_of: Any) -> tuple[Leg, ...]:
    found: tuple[Leg, ...] = build(facts_of(features)).junctions[0][1]
    return found


def test_a_crossing_of_two_lane_streets_has_twelve_turns(crossing_legs: tuple[Leg, ...]) -> None:
    pairs = lane_pairs(crossing_legs)
    assert len(pairs) == 12
    assert {(come, go) for come, _, go, _ in pairs} == {(a, b) for a in range(4) for b in range(4) if a != b}


def test_turns_begin_and_end_in_lane_middles_without_a_kink(crossing_legs: tuple[Leg, ...]) -> None:
    for turn in turns(crossing_legs):
        begin, end = pose_in(turn.come, turn.lane_in), pose_out(turn.go, turn.lane_out)
        arrived = along(turn.path[-1], turn.path[-1].length_m)
        assert math.dist(turn.path[0].start[:2], begin[:2]) < 1e-6
        assert math.dist(arrived[:2], end[:2]) < 1e-5
        assert abs(wrapped(arrived.heading_rad - end.heading_rad)) < 1e-3
        for piece, after in pairwise(turn.path):
            assert abs(wrapped(along(piece, piece.length_m).heading_rad - after.start.heading_rad)) < 1e-6


def test_a_lane_is_as_wide_as_the_lanes_it_joins(facts_of: Any, sketch: Any) -> None:
    features = sketch.crossing()
    features[1]["properties"]["width_m"] = 11.0
    for turn in turns(legs_of(features, facts_of)):
        assert value(turn.widths, 0.0) == pytest.approx(turn.come.view.lane(turn.lane_in).width_m)
        assert value(turn.widths, length(turn.path)) == pytest.approx(turn.go.view.lane(turn.lane_out).width_m)


def test_on_four_lanes_left_goes_from_the_inner_and_right_from_the_outer_lane(facts_of: Any, sketch: Any) -> None:
    features = sketch.crossing()
    features[0]["properties"].update(lanes=4, width_m=13.4, street_class="arterial", parking="none")
    legs = legs_of(features, facts_of)
    west = next(i for i, leg in enumerate(legs) if abs(leg.pose.heading_rad) < 0.1)
    ways = {(pair[1], (pair[2] - west) % 4) for pair in lane_pairs(legs) if pair[0] == west}
    # counter-clockwise from the west leg: 1 south (right), 2 east (straight on), 3 north (left)
    assert ways == {(-2, 1), (-2, 2), (-1, 2), (-1, 3)}


def test_no_lane_is_left_without_a_way_on_or_a_way_in(facts_of: Any, sketch: Any) -> None:
    features = [
        sketch.street("wide", (-100.0, 0.0), (0.0, 0.0), lanes=4, width_m=12.2, parking="limited"),
        sketch.street("thin", (0.0, 0.0), (100.0, 0.0)),
        sketch.street("side", (0.0, 0.0), (0.0, 100.0)),
    ]
    legs = legs_of(features, facts_of)
    pairs = lane_pairs(legs)
    assert {pair[:2] for pair in pairs} == {(i, n) for i, leg in enumerate(legs) for n in leg.view.driving(right=True)}
    assert {pair[2:] for pair in pairs} == {(i, n) for i, leg in enumerate(legs) for n in leg.view.driving(right=False)}


def test_no_turn_leads_into_a_one_way_street_against_it(facts_of: Any, sketch: Any) -> None:
    features = sketch.crossing()
    features[1]["properties"].update(oneway="forward", lanes=1)
    legs = legs_of(features, facts_of)
    south = next(i for i, leg in enumerate(legs) if leg.pose.y_m < -1.0)
    pairs = lane_pairs(legs)
    assert any(come == south for come, *_ in pairs)
    assert all(go != south for _, _, go, _ in pairs)


def test_crossing_ways_are_in_conflict_and_parallel_ones_are_not(crossing_legs: tuple[Leg, ...]) -> None:
    straight = {
        round(math.degrees(turn.come.pose.heading_rad)) % 360: turn
        for turn in turns(crossing_legs)
        if abs(wrapped(turn.path[-1].start.heading_rad - turn.path[0].start.heading_rad)) < 0.1
    }
    assert conflicting(straight[0], straight[90])
    assert not conflicting(straight[0], straight[180])


def test_a_corner_leads_the_kerb_round_and_paves_the_rest(crossing_legs: tuple[Leg, ...]) -> None:
    east, north = crossing_legs[:2]
    road = corner_road(7, 100, (east, north), (1, 2), surface(turns(crossing_legs)))
    begin = moved(east.pose, left_m=east.view.kerb_m(right=True))
    assert math.dist(road.path[0].start[:2], begin[:2]) < 1e-6
    assert [lane.kind for lane in road.right] == ["border", "none", "sidewalk"]
    # incoming traffic's kerb is the north one there, and parked cars stand on the south side of an eastward street
    paved = sum(lane.kind == "shoulder" for lane in road.left)
    assert paved == 1
    assert [lane.height_m for lane in road.right] == [0.15] * 3
