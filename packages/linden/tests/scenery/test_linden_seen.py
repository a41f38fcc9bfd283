"""All of Linden as it is seen: few enough triangles, on the road that wheels feel, with its paint on top."""

import numpy as np
import pytest

from home_map import home_map
from linden.maps.ground import Ground
from linden.maps.library import LoadedMap
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import SemanticTag
from linden.scenery.map_mesh import standing
from linden.scenery.mesh import Material, Mesh
from linden.scenery.streets.road import surface
from linden.scenery.streets.simplified_lanes import ABOVE_M, simplified_lanes
from linden.simulation.surroundings import scenery_of

MOST_TRIANGLES = 1_220_000
"""Of them 20,992 are 66 street-name signs with legible names on both faces (docs/decisions/0088)."""
CORNERS = ((1 / 3, 1 / 3, 1 / 3), (0.9, 0.05, 0.05), (0.05, 0.9, 0.05), (0.05, 0.05, 0.9))
NEAR_M = 0.05
"""What is looked for lies so much below at most: elsewhere another lane lies over it."""
UP_M = np.array([0.0, 0.0, NEAR_M])


@pytest.fixture(scope="module")
def linden() -> LoadedMap:
    return home_map()


@pytest.fixture(scope="module")
def drawn(linden: LoadedMap) -> Mesh:
    return surface(simplified_lanes(parse(linden.text)))


@pytest.mark.slow
def test_linden_is_not_seen_in_too_many_triangles_and_its_paint_lies_on_the_lanes(
    linden: LoadedMap, drawn: Mesh
) -> None:
    mesh = standing(parse(linden.text), linden, scenery_of(linden).scene)
    assert 0.8 * MOST_TRIANGLES < len(mesh.triangles) <= MOST_TRIANGLES
    lanes = Ground.from_triangles(drawn.vertices_m, drawn.triangles)
    painted = (mesh.faces["material"] == Material.PAINT) & (mesh.faces["tag"] == SemanticTag.ROAD_LINES)
    corners = mesh.vertices_m[mesh.triangles[painted]].astype(np.float64)
    assert len(corners) > 10_000
    for weights in CORNERS:
        points = np.tensordot(corners, weights, axes=(1, 0))
        height, triangle = lanes.surfaces_under(points + UP_M)
        above = (points[:, 2] - height)[(triangle >= 0) & (np.abs(points[:, 2] - height) < NEAR_M)]
        assert len(above) > 0.99 * len(corners)
        assert above.min() > 0.002


def test_what_is_drawn_of_the_road_is_what_wheels_feel_to_three_millimetres(linden: LoadedMap, drawn: Mesh) -> None:
    corners = drawn.vertices_m[drawn.triangles].astype(np.float64)
    points = np.concatenate([np.tensordot(corners, weights, axes=(1, 0)) for weights in CORNERS])
    height, triangle = linden.ground.surfaces_under(points + UP_M)
    near = (triangle >= 0) & (np.abs(points[:, 2] - height) < NEAR_M)
    assert near.mean() > 0.98
    assert np.quantile(np.abs(points[near, 2] - height[near]), 0.999) < ABOVE_M + 1e-3
