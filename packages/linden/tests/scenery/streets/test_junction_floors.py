"""Gaps between the lanes of a junction have a floor; islands and the open land have none."""

import numpy as np

from linden.maps.ground import Ground
from linden.maps.opendrive.mesh import RoadMesh
from linden.maps.records import LANES
from linden.protocol.values.enums import LaneType
from linden.scenery.streets.junction_floors import floors


def ring(hole_m: float, outside_m: float = 30.0, z_m: float = 3.0) -> RoadMesh:
    """Return a junction of asphalt, a square with a square hole in its middle."""
    h, o = 0.5 * hole_m, 0.5 * outside_m
    inner = np.array([(-h, -h), (h, -h), (h, h), (-h, h)])
    outer = np.array([(-o, -o), (o, -o), (o, o), (-o, o)])
    vertices = np.column_stack([np.concatenate([inner, outer]), np.full(8, z_m)])
    triangles = [(k, k + 4, (k + 1) % 4 + 4) for k in range(4)] + [(k, (k + 1) % 4 + 4, (k + 1) % 4) for k in range(4)]
    lanes = np.zeros(1, LANES)
    lanes["junction"], lanes["type_bits"] = 7, LaneType.DRIVING
    return RoadMesh(vertices, np.array(triangles, np.int32), np.zeros(8, np.int32), lanes)


def test_a_small_gap_is_closed_just_under_the_road() -> None:
    road = ring(2.5)
    made = floors(road, Ground.from_triangles(road.vertices, road.triangles))
    assert made.take(np.array([[0.0, 0.0], [1.0, -1.0], [5.0, 5.0]])).all()
    heights = made.mesh.vertices_m[:, 2]
    assert ((heights < 3.0) & (heights > 2.95)).all()


def test_an_island_keeps_its_own_ground() -> None:
    road = ring(9.0)
    made = floors(road, Ground.from_triangles(road.vertices, road.triangles))
    assert not made.take(np.array([[0.0, 0.0], [3.0, 3.0]])).any()
    assert made.take(np.array([[8.0, 0.5]])).all()


def test_no_floor_reaches_beyond_the_junction() -> None:
    road = ring(2.0)
    made = floors(road, Ground.from_triangles(road.vertices, road.triangles))
    assert np.abs(made.mesh.vertices_m[:, :2]).max() <= 15.0 + 1e-3


def test_roads_outside_of_junctions_need_none() -> None:
    road = ring(2.0)
    road.lanes["junction"] = -1
    assert len(floors(road, Ground.from_triangles(road.vertices, road.triangles)).mesh.triangles) == 0
