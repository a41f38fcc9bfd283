"""A roundabout is driven counter-clockwise round its island, from every leg to every other."""

import math
from itertools import pairwise
from typing import Any

import pytest

from linden.errors import UserError
from linden_maps.streets.build import assembled
from linden_maps.streets.curves import along, length, pose_at, sampled, wrapped
from linden_maps.streets.document import value
from linden_maps.streets.geojson import read
from linden_maps.streets.junctions import Turn
from linden_maps.streets.network import ROUNDABOUT_SETBACK_M, build
from linden_maps.streets.rings import BEND_RADIUS_M, ISLAND_RADIUS_M, LANE_M, LANE_RADII_M
from linden_maps.streets.roundabouts import turns


@pytest.fixture
def ways(facts_of: Any, sketch: Any) -> tuple[Turn, ...]:
    legs = build(facts_of(sketch.crossing("roundabout"))).junctions[0][1]
    return turns(legs, (0.0, 0.0))


def angle_round_rad(turn: Turn) -> float:
    """How far a way goes round the middle, counter-clockwise positive."""
    angles = [math.atan2(pose.y_m, pose.x_m) for pose in sampled(turn.path, 0.5)]
    return sum(wrapped(b - a) for a, b in pairwise(angles))


def test_all_twelve_ways_go_round_counter_clockwise(ways: tuple[Turn, ...]) -> None:
    assert len(ways) == 12
    found = sorted(round(math.degrees(angle_round_rad(turn)) / 90) for turn in ways)
    assert found == [1] * 4 + [2] * 4 + [3] * 4


def test_no_lane_touches_the_island(ways: tuple[Turn, ...]) -> None:
    for turn in ways:
        total_m = length(turn.path)
        for i in range(201):
            s_m = total_m * i / 200
            inner_m = math.hypot(*pose_at(turn.path, s_m)[:2]) - value(turn.widths, s_m) / 2
            assert inner_m > ISLAND_RADIUS_M - 1e-6


def test_the_ways_are_smooth_and_wide_enough_to_be_driven(ways: tuple[Turn, ...]) -> None:
    for turn in ways:
        for piece, after in pairwise(turn.path):
            end = along(piece, piece.length_m)
            assert math.dist(end[:2], after.start[:2]) < 1e-6
            assert abs(wrapped(end.heading_rad - after.start.heading_rad)) < 1e-6
        assert max(abs(piece.curvature_per_m) for piece in turn.path) <= 1 / min(LANE_RADII_M[1], BEND_RADIUS_M) + 1e-9


def test_ways_that_share_the_ring_share_its_lane(ways: tuple[Turn, ...]) -> None:
    ring = pytest.approx(1 / LANE_RADII_M[1])
    found = [(turn, piece) for turn in ways for piece in turn.path if piece.curvature_per_m == ring]
    assert len(found) >= 8  # right turns may pass outside
    for turn, piece in found:
        assert math.hypot(*piece.start[:2]) == pytest.approx(LANE_RADII_M[1], abs=1e-6)
        before_m = length(turn.path[: turn.path.index(piece)])
        assert value(turn.widths, before_m) == pytest.approx(LANE_M)


def test_a_street_that_passes_beside_the_middle_is_refused(facts_of: Any, sketch: Any) -> None:
    legs = build(facts_of(sketch.crossing("roundabout"))).junctions[0][1]
    with pytest.raises(UserError, match="leads past the middle of a roundabout"):
        turns(legs, (0.0, 12.0))


def test_entries_yield_and_the_island_stands_in_the_middle(built_of: Any, sketch: Any) -> None:
    built = built_of(sketch.crossing("roundabout"))
    signals = [signal for road in built.document.roads for signal in road.signals]
    assert [signal.kind for signal in signals] == ["205"] * 4
    lines = [thing for road in built.document.roads for thing in road.objects if thing.name == "YieldLine"]
    assert len(lines) == 4
    (island,) = [road for road in built.document.roads if road.name == "roundabout island"]
    assert all(math.hypot(*piece.start[:2]) == pytest.approx(ISLAND_RADIUS_M) for piece in island.path)
    assert dict(built.document.junctions[0].notes)["roundabout"] == "mini"


def test_a_driver_at_the_end_of_a_street_turns_round_a_circle(sketch: Any) -> None:
    features = [sketch.street("main", (0.0, 0.0), (200.0, 0.0), lanes=4, width_m=13.4, parking="none")]
    built = assembled(read(sketch.collection(features, turning_circles=True)))
    assert [junction.name for junction in built.document.junctions] == ["main Street"] * 2
    assert [len(junction.connections) for junction in built.document.junctions] == [3, 3]  # two lanes and the kerb
    (road,) = [road for road in built.roads if road is not None]
    for way in built.ways:
        assert way.come == way.go
        assert way.record.predecessor == way.record.successor
        turned_rad = sum(piece.length_m * piece.curvature_per_m for piece in way.record.path)
        assert turned_rad == pytest.approx(math.pi, abs=1e-6)
        (lane,) = way.record.right
        assert (lane.predecessor, lane.successor) in {(-1, 1), (-2, 2), (1, -1), (2, -2)}
    assert length(road.path) == pytest.approx(200.0 - 2 * ROUNDABOUT_SETBACK_M, abs=0.2)


def test_streets_end_openly_where_circles_are_switched_off(built_of: Any, sketch: Any) -> None:
    built = built_of([sketch.street("main", (0.0, 0.0), (200.0, 0.0))])
    assert built.document.junctions == ()


def test_a_roundabout_too_close_to_a_junction_is_refused(built_of: Any, sketch: Any) -> None:
    features = [
        sketch.street("main", (-100.0, 0.0), (0.0, 0.0), (22.0, 0.0), (100.0, 0.0)),
        sketch.street("up", (0.0, 0.0), (0.0, 90.0)),
        sketch.street("down", (22.0, 0.0), (22.0, -90.0)),
        sketch.point("intersection", "ring", (0.0, 0.0), control="roundabout"),
    ]
    with pytest.raises(UserError, match="intersection ring: a roundabout needs more room"):
        built_of(features)
