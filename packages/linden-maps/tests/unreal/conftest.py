"""A small town's mesh in parts: one street, a house, a sign, drawn by hand."""

import numpy as np
import pytest

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import ABOVE_GROUND, PatchFrames, PatchLook, boxes, polygons
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, things_with
from linden.scenery.streets.road import KERB_STONE
from linden_maps.unreal.parts import Part, parts_of

UP = (0.0, 0.0, 1.0)


def quad(x_m: float, y_m: float, size_m: float, look: PatchLook) -> Mesh:
    """A level square of CARLA's frame, its corner with least x and y given."""
    corners = [(x_m, y_m), (x_m + size_m, y_m), (x_m + size_m, y_m + size_m), (x_m, y_m + size_m)]
    return polygons(np.array([[(x, y, 1.0) for x, y in corners]]), look, UP)


def scene() -> Scene:
    kinds = things_with(ObjectKind.HOUSE, np.array([[20.0, 30.0, 0.0]]), np.zeros(1))
    sign = things_with(ObjectKind.TRAFFIC_SIGN, np.array([[5.0, 5.0, 0.0]]), np.zeros(1))
    things = np.concatenate([kinds, sign])
    half = np.array([[4.0, 5.0, 3.0], [0.1, 0.1, 1.4]])
    return assembled(things, boxes_on(things, half * UP, half, SemanticTag.BUILDINGS))


def mesh() -> Mesh:
    road = PatchLook(Material.ASPHALT, SemanticTag.ROADS, (60, 60, 60))
    line = PatchLook(Material.PAINT, SemanticTag.ROAD_LINES, (230, 230, 230))
    kerb = PatchLook(Material.CONCRETE, SemanticTag.SIDEWALKS, KERB_STONE)
    walk = PatchLook(Material.CONCRETE, SemanticTag.SIDEWALKS, (156, 151, 141))
    wall = PatchLook(Material.BRICK, SemanticTag.BUILDINGS, (142, 78, 60), 0)
    sign = PatchLook(Material.METAL, SemanticTag.TRAFFIC_SIGNS, (90, 90, 90), 1)
    frames = PatchFrames(np.array([[20.0, 30.0, 0.0]]), np.zeros(1))
    return join(
        [
            quad(0.0, 0.0, 10.0, road),
            quad(0.0, -600.0, 10.0, road),
            quad(1.0, 1.0, 0.1, line),
            quad(10.0, 0.0, 0.15, kerb),
            quad(11.0, 0.0, 1.5, walk),
            boxes(frames, (0.0, 0.0, 3.0), (4.0, 5.0, 3.0), wall, ABOVE_GROUND),
            boxes(frames, (-15.0, -25.0, 1.4), (0.1, 0.1, 1.4), sign),
        ]
    )


@pytest.fixture(scope="session")
def parts() -> list[Part]:
    return parts_of(mesh(), scene(), "Town")
