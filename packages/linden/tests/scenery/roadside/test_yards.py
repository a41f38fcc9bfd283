"""Drives and paths lie on the lawn, reach the pavement and the street, and do not hide under the grass."""

from dataclasses import replace

import numpy as np
import pytest

from home_map import home_map
from linden.maps.ground import Ground
from linden.maps.library import LoadedMap
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Mesh
from linden.scenery.roadside.yards import paved_yards
from linden.scenery.scene.south_linden import home
from linden.scenery.streets.junction_floors import floors
from linden.scenery.streets.simplified_lanes import simplified_lanes
from linden.scenery.streets.terrain import land

HIGH_M = 1e6


@pytest.fixture(scope="module")
def linden() -> LoadedMap:
    ready = home_map()
    return replace(ready, lots=ready.lots[:120])


@pytest.fixture(scope="module")
def lawn(linden: LoadedMap) -> Ground:
    opendrive = parse(linden.text)
    made = land(simplified_lanes(opendrive), linden.ground, floors(road_mesh(opendrive), linden.ground))
    return Ground.from_triangles(made.vertices_m, made.triangles)


@pytest.fixture(scope="module")
def slabs(linden: LoadedMap, lawn: Ground) -> Mesh:
    made = paved_yards(linden.lots, home(linden), linden.ground, lawn)
    flat = made.faces["tag"] == SemanticTag.TERRAIN
    return Mesh(made.vertices_m, made.triangles[flat], made.faces[flat])


def test_no_slab_lies_under_the_grass(slabs: Mesh, linden: LoadedMap, lawn: Ground) -> None:
    corners = slabs.vertices_m[slabs.triangles].astype(np.float64)
    for weights in ((1 / 3, 1 / 3, 1 / 3), (0.8, 0.1, 0.1), (0.1, 0.8, 0.1), (0.1, 0.1, 0.8)):
        points = np.tensordot(corners, weights, axes=(1, 0))
        high = np.column_stack([points[:, :2], np.full(len(points), HIGH_M)])
        under, triangle = lawn.surfaces_under(high)
        on_lawn = (triangle >= 0) & (linden.ground.surfaces_under(high)[1] < 0)
        assert on_lawn.sum() > 200
        assert (points[on_lawn, 2] > under[on_lawn]).mean() > 0.99


def test_a_drive_begins_in_the_street(slabs: Mesh, linden: LoadedMap) -> None:
    low = slabs.vertices_m[slabs.triangles].reshape(-1, 3).astype(np.float64)
    height, triangle = linden.ground.surfaces_under(np.column_stack([low[:, :2], np.full(len(low), HIGH_M)]))
    paved = np.isin(linden.lanes["tag"][linden.lane_of_triangle[triangle]], [SemanticTag.ROADS]) & (triangle >= 0)
    assert paved.sum() > 60
    np.testing.assert_allclose(low[paved, 2], height[paved], atol=0.03)
