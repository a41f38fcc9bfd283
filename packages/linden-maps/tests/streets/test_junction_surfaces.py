"""Claims about junctions on measured ground: they take its slope, and lanes that cross have one height."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from linden.maps.ground import Ground
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType
from linden_maps.checks.check import check
from linden_maps.statistics import count
from linden_maps.streets.build import Built, assembled, off_ground_m
from linden_maps.streets.curves import length
from linden_maps.streets.document import value
from linden_maps.streets.geojson import read
from linden_maps.streets.junction_surfaces import fitted
from linden_maps.streets.terrain import Terrain
from linden_maps.streets.writing import text

Heights = Callable[[np.ndarray, np.ndarray], np.ndarray]
HALF_M = 300.0
STEP_M = 4.0
LARGEST_STEP_M = 0.035  # between lanes that cross, on ground of 7 %


def terrain(heights: Heights) -> Terrain:
    places = np.arange(-HALF_M, HALF_M + STEP_M, STEP_M)
    return Terrain(heights(*np.meshgrid(places, places)), (-HALF_M, -HALF_M), STEP_M, "measured: a formula")


def slope(east: float, north: float) -> Terrain:
    return terrain(lambda x, y: 250.0 + east * x + north * y)


def two_junctions(sketch: Any, apart_m: float, **changes: object) -> list[Any]:
    """A street eastward, crossed by two streets."""
    middle = ((-120.0, 0.0), (0.0, 0.0), (apart_m, 0.0), (apart_m + 120.0, 0.0))
    return [
        sketch.street("east", *middle, **changes),
        sketch.street("first", (0.0, -100.0), (0.0, 0.0), (0.0, 100.0), **changes),
        sketch.street("second", (apart_m, -100.0), (apart_m, 0.0), (apart_m, 100.0), **changes),
    ]


def built_on(ground: Terrain, sketch: Any, features: list[Any]) -> Built:
    return assembled(read(sketch.collection(features))._replace(ground=ground))


def largest_step_m(xodr: bytes) -> float:
    """The largest difference in height, every half metre, between driving lanes of one junction."""
    mesh = road_mesh(parse(xodr))
    lanes = mesh.lanes[mesh.lane_of_triangle]
    chosen = (lanes["junction"] >= 0) & (lanes["type_bits"] & int(LaneType.DRIVING) != 0)
    corners = mesh.vertices[mesh.triangles[chosen]]
    low, high = corners[:, :, :2].min(axis=(0, 1)), corners[:, :, :2].max(axis=(0, 1))
    x_m, y_m = (
        axis.reshape(-1) for axis in np.meshgrid(*(np.arange(a, b, 0.5) for a, b in zip(low, high, strict=True)))
    )
    lowest, highest = np.full(len(x_m), np.inf), np.full(len(x_m), -np.inf)
    for road in np.unique(lanes["road_id"][chosen]):
        of_road = mesh.triangles[chosen][lanes["road_id"][chosen] == road]
        ground = Ground.from_triangles(mesh.vertices, of_road)
        heights, triangle = ground.surfaces_under(np.column_stack([x_m, y_m, np.full(len(x_m), 1e6)]))
        lowest = np.where(triangle >= 0, np.minimum(lowest, heights), lowest)
        highest = np.where(triangle >= 0, np.maximum(highest, heights), highest)
    return float((highest - lowest)[highest > lowest].max(initial=0.0))


def test_a_road_of_6_m_between_two_junctions_is_as_steep_as_its_ground(sketch: Any) -> None:
    built = built_on(slope(0.07, 0.0), sketch, two_junctions(sketch, 26.0))
    (short,) = (road for road in built.roads if road is not None and length(road.path) < 8.0)
    assert length(short.path) == pytest.approx(6.1, abs=0.2)
    grades = [abs(value(short.elevation, s + 0.01) - value(short.elevation, s)) / 0.01 for s in (0.0, 3.0, 6.0)]
    assert grades == pytest.approx([0.07] * 3, abs=1e-3)
    assert max(off_ground_m(built)) < 0.01
    opendrive = parse(text(built.document))
    assert count(opendrive).steepest_percent < 10.0
    assert {finding.kind for finding in check(opendrive)} == {"dead end"}  # the sketch's own ends


@pytest.mark.parametrize(("east", "north"), [(0.07, 0.0), (0.05, 0.05)])
@pytest.mark.parametrize("control", ["none", "signal", "roundabout"])
def test_lanes_that_cross_on_a_slope_have_one_height(control: str, east: float, north: float, sketch: Any) -> None:
    built = built_on(slope(east, north), sketch, sketch.crossing(control))
    opendrive = parse(text(built.document))
    assert count(opendrive).steepest_percent < 13.5
    assert largest_step_m(text(built.document)) < LARGEST_STEP_M
    assert {finding.kind for finding in check(opendrive)} == {"dead end"}


def test_every_road_of_a_junction_begins_and_ends_at_the_height_of_its_street(sketch: Any) -> None:
    built = built_on(slope(0.05, -0.05), sketch, sketch.crossing())
    streets = {road.id: road for road in built.roads if road is not None}
    inner = [road for road in built.document.roads if road.junction >= 0]
    assert len(inner) == 16
    for road in inner:
        for link, at_m in ((road.predecessor, 0.0), (road.successor, length(road.path))):
            assert link is not None
            street = streets[link.id]
            met_m = value(street.elevation, length(street.path) if link.contact == "end" else 0.0)
            assert value(road.elevation, at_m) == pytest.approx(met_m, abs=1e-6)
            for lane in (*road.left, *road.right):
                if lane.heights:  # the street is level from side to side
                    heights = lane.heights[0] if at_m == 0.0 else lane.heights[-1]
                    assert max(map(abs, heights[1:])) < 0.005


def test_the_island_of_a_roundabout_lies_on_the_slope(sketch: Any) -> None:
    built = built_on(slope(0.07, 0.0), sketch, sketch.crossing("roundabout"))
    (island,) = (road for road in built.document.roads if road.name == "roundabout island")
    heights = [value(island.elevation, length(island.path) * share) for share in (0.0, 0.25, 0.5, 0.75)]
    east, north, west, south = heights
    assert 0.2 < east - west < 0.7
    assert north == pytest.approx(south, abs=0.02)


def test_a_wall_in_the_ground_tilts_no_junction(sketch: Any) -> None:
    def walled(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 250.0 + 0.04 * x + np.where((abs(x - 8.0) < 1.0) & (abs(y - 8.0) < 1.0), 3.0, 0.0)

    built = built_on(slope(0.0, 0.0), sketch, sketch.crossing())
    ((_, legs),) = ((nodes, legs) for nodes, legs in built.network.junctions if len(legs) == 4)
    plane = fitted(terrain(walled), legs)
    assert (plane.east, plane.north) == pytest.approx((0.04, 0.0), abs=0.006)


def test_a_junction_is_never_steeper_than_a_tenth(sketch: Any) -> None:
    built = built_on(slope(0.0, 0.0), sketch, sketch.crossing())
    ((_, legs),) = ((nodes, legs) for nodes, legs in built.network.junctions if len(legs) == 4)
    plane = fitted(slope(0.12, 0.16), legs)
    assert math.hypot(plane.east, plane.north) == pytest.approx(0.10, abs=1e-5)
    assert plane.slope(math.atan2(0.16, 0.12)) == pytest.approx(0.10, abs=1e-5)


def test_a_step_in_the_ground_between_two_junctions_is_made_gentle(sketch: Any) -> None:
    """Junctions give way: one cubic is nowhere steeper than 15 %."""
    cliff = terrain(lambda x, y: 250.0 + 2.0 * (x > 13.0) + 0.0 * y)
    built = built_on(cliff, sketch, two_junctions(sketch, 26.0))
    (short,) = (road for road in built.roads if road is not None and length(road.path) < 8.0)
    places_m = np.linspace(0.0, length(short.path), 60)
    heights = [value(short.elevation, s) for s in places_m]
    assert np.abs(np.diff(heights) / np.diff(places_m)).max() < 0.155


def test_junctions_on_an_estimated_plane_stay_level(sketch: Any) -> None:
    built = assembled(read(sketch.collection(sketch.crossing(), ground={"base_m": 250.0, "rise_north": 0.01})))
    assert {road.elevation[-1].a > 250.5 for road in built.roads if road is not None} == {True, False}
    for road in built.document.roads:
        if road.junction >= 0:
            assert len(road.elevation) == 1
            assert road.elevation[0][2:] == (0.0, 0.0, 0.0)
            assert not any(lane.heights for lane in (*road.left, *road.right))
