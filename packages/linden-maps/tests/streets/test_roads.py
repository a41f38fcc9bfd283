"""Roads are level where they meet a junction, on the ground's plane elsewhere, and go on in each other lane by lane."""

import math
from typing import Any

import pytest

from linden_maps.streets.cross_section import Lane
from linden_maps.streets.curves import Piece, Pose, length
from linden_maps.streets.document import value
from linden_maps.streets.roads import blended, elevation
from linden_maps.streets.street_facts import Ground

GROUND = Ground(250.0, 0.01, 0.0, "estimated")
NORTHWARD = (Piece(Pose(0.0, 0.0, math.pi / 2), 200.0, 0.0),)


def test_a_road_in_the_open_lies_on_the_plane() -> None:
    heights = elevation(GROUND, NORTHWARD, (None, None))
    assert [value(heights, s) for s in (0.0, 63.0, 200.0)] == pytest.approx([250.0, 250.63, 252.0])


def test_a_road_meets_a_junction_level_and_at_its_height() -> None:
    heights = elevation(GROUND, NORTHWARD, ((250.2, 0.0), None))
    assert value(heights, 0.0) == pytest.approx(250.2)
    assert value(heights, 0.01) - value(heights, 0.0) < 1e-6
    assert value(heights, GROUND.profile.ramp_m) == pytest.approx(250.0 + 0.01 * GROUND.profile.ramp_m)


def test_pieces_of_a_profile_meet_in_height_and_slope() -> None:
    heights = elevation(GROUND, NORTHWARD, ((249.9, 0.0), (252.3, 0.0)))
    for cubic in heights[1:]:
        before, after = (value(heights, cubic.s_m + d) for d in (-1e-4, 1e-4))
        assert abs(after - before) < 1e-5
        assert value(heights[: heights.index(cubic)], cubic.s_m) == pytest.approx(cubic.a, abs=1e-9)


def test_lanes_are_paired_by_kind_and_what_has_no_partner_narrows_to_nothing() -> None:
    wide = ((-1, Lane("driving", 3.0)), (-2, Lane("parking", 2.1)), (-3, Lane("border", 0.15)))
    bare = ((1, Lane("driving", 3.4)), (2, Lane("border", 0.15)))
    assert [strip[1:] for strip in blended(wide, bare)] == [
        ((3.0, 3.4), -1, 1),
        ((2.1, 0.0), -2, None),
        ((0.15, 0.15), -3, 2),
    ]


def test_two_streets_that_go_on_in_each_other_are_joined_by_a_road_not_a_junction(built_of: Any, sketch: Any) -> None:
    built = built_of(
        [
            sketch.street("one", (-100.0, 0.0), (0.0, 0.0)),
            sketch.street("two", (0.0, 0.0), (0.0, 100.0), width_m=8.5),
        ]
    )
    assert built.document.junctions == ()
    (bend,) = [way.record for way in built.ways]
    first, second = built.roads
    assert bend.junction == -1
    assert {bend.predecessor.id, bend.successor.id} == {first.id, second.id}
    assert first.successor.id == second.predecessor.id == bend.id
    by_id = {lane.id: lane for lane in bend.right + bend.left}
    for road, touch in ((first, "successor"), (second, "predecessor")):
        for lane in road.right + road.left:
            other = by_id[getattr(lane, touch)]
            assert other.kind == lane.kind
            assert lane.id in {other.predecessor, other.successor}


def test_a_bend_has_no_sharper_turn_than_a_service_drive(built_of: Any, sketch: Any) -> None:
    built = built_of([sketch.street("one", (-100.0, 0.0), (0.0, 0.0)), sketch.street("two", (0.0, 0.0), (0.0, 100.0))])
    (bend,) = [way.record for way in built.ways]
    assert all(abs(piece.curvature_per_m) <= 1 / 11.9 for piece in bend.path)
    assert length(bend.path) == pytest.approx(12.0 * math.pi / 2, abs=0.5)
