"""Boxes, prisms and fans look outwards and lie where they are put."""

import numpy as np
import pytest

from fakes.solids import volume_m3
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material
from linden.scenery.patches import ALL_SIDES, PatchFrames, PatchLook, boxes, polygons, prisms

LOOK = PatchLook(Material.PLAIN, SemanticTag.STATIC, (1, 2, 3))
FRAMES = PatchFrames(np.array([[10.0, 20.0, 5.0], [-3.0, 4.0, 0.0]]), np.array([0.3, -2.0]))


def test_closed_boxes_hold_what_their_sizes_say_so_they_look_outwards() -> None:
    mesh = boxes(FRAMES, (1.0, 2.0, 3.0), (0.5, 1.0, 2.0), LOOK, ALL_SIDES)
    assert len(mesh.triangles) == 2 * 12
    assert volume_m3(mesh) == pytest.approx(2 * 1.0 * 2.0 * 4.0, rel=1e-4)


def test_a_box_stands_in_the_frame_of_its_thing() -> None:
    frames = PatchFrames(np.array([[10.0, 20.0, 5.0]]), np.array([np.pi / 2]))
    mesh = boxes(frames, (3.0, 0.0, 1.0), (1.0, 0.5, 1.0), LOOK)
    np.testing.assert_allclose(mesh.vertices_m.min(axis=0), [9.5, 22.0, 5.0], atol=1e-5)
    np.testing.assert_allclose(mesh.vertices_m.max(axis=0), [10.5, 24.0, 7.0], atol=1e-5)


@pytest.mark.parametrize("end", [(0.0, 0.0, 2.0), (2.0, 0.0, 0.0), (0.0, -1.0, 0.5), (0.0, 0.0, -2.0)])
def test_the_sides_of_a_prism_look_away_from_its_axis(end: tuple[float, float, float]) -> None:
    begin, tip = np.zeros((1, 3)), np.array([end])
    mesh = prisms(begin, tip, (0.3, 0.2), 8, LOOK)
    a, b, c = (mesh.vertices_m[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    away = (a + b + c) / 3.0 - 0.5 * tip
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), away) > 0.0).all()


def test_a_patch_is_turned_to_look_where_it_should() -> None:
    square = np.array([[(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)]], np.float64)
    for way in (1.0, -1.0):
        mesh = polygons(square, LOOK, (0.0, 0.0, way))
        a, b, c = (mesh.vertices_m[mesh.triangles[:, k]] for k in range(3))
        assert (np.sign(np.cross(b - a, c - a)[:, 2]) == way).all()


def test_colours_and_objects_go_with_their_patches() -> None:
    look = PatchLook(Material.WOOD, SemanticTag.FENCES, np.array([[1, 1, 1], [2, 2, 2]]), np.array([7, 9]))
    mesh = boxes(FRAMES, np.zeros(3), np.ones(3), look)
    assert mesh.faces["object"].tolist() == [7] * 10 + [9] * 10
    assert (mesh.faces["colour"][mesh.faces["object"] == 9] == 2).all()


def test_a_shape_for_all_is_not_taken_for_one_point_of_each() -> None:
    frames = PatchFrames(np.arange(12.0).reshape(4, 3), np.zeros(4))
    square = np.array([(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)], np.float64)
    np.testing.assert_allclose(frames.world(square), frames.base_m[:, None] + square[None])
