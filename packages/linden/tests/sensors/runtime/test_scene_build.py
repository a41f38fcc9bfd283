"""The mesh without hidden objects, and what pictures know of the same bodies beside another one."""

import numpy as np
import pytest

from fakes.solids import box
from linden.scenery.mesh import Material, Mesh, join
from linden.sensors.camera.picture import rgb
from linden.sensors.camera.picture.smooth_normals import FLAT, relief
from linden.sensors.runtime.scene_build import present_of


def ball(thing: int, *, sides: int = 12) -> Mesh:
    """Return a prism of many sides, whose sides look round."""
    turn = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    ring = np.c_[np.cos(turn), np.sin(turn)]
    vertices = np.r_[np.c_[ring, np.full(sides, 1.0)], np.c_[ring, np.full(sides, -1.0)]].astype(np.float32)
    here, there = np.arange(sides), (np.arange(sides) + 1) % sides
    triangles = np.r_[np.c_[here, there, here + sides], np.c_[there, there + sides, here + sides]].astype(np.uint32)
    faces = np.resize(box((1.0, 1.0, 1.0), thing=thing).faces, len(triangles))
    faces["material"] = Material.CAR_PAINT
    return Mesh(vertices, triangles, faces)


TOWN = join([box((1.0, 2.0, 3.0)), *(ball(thing) for thing in range(4))])


@pytest.mark.parametrize("present", [(0, 0, 0, 0), (0, 1, 0, 0), (1, 1, 1, 0), (1, 1, 1, 1)])
def test_a_mesh_without_hidden_objects_has_the_other_triangles_in_their_order(present: tuple[int, ...]) -> None:
    left = present_of(TOWN, np.array(present, np.bool_))
    stays = [thing < 0 or bool(present[thing]) for thing in TOWN.faces["object"].tolist()]
    assert np.array_equal(left.faces, TOWN.faces[stays])
    assert np.array_equal(left.vertices_m[left.triangles], TOWN.vertices_m[TOWN.triangles[stays]])
    assert left.triangles.dtype == TOWN.triangles.dtype
    if sum(present) < 2:
        assert len(left.vertices_m) == len(np.unique(left.triangles))


def test_bodies_look_the_same_beside_another_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    bodies = [ball(-1), box((1.0, 1.0, 1.0)), ball(-1, sides=20)]
    monkeypatch.setattr(rgb, "_made", [])
    made = 0

    def counted(meshes: list[Mesh]) -> object:
        nonlocal made
        made += len(meshes)
        return relief(meshes)

    monkeypatch.setattr(rgb, "relief", counted)
    for present in ((1, 1, 1, 1), (0, 0, 1, 0), (1, 1, 0, 0)):
        standing = present_of(TOWN, np.array(present, np.bool_))
        found, expected = rgb.looks_of(standing, bodies).relief, relief([standing, *bodies])
        assert np.count_nonzero(found.row != FLAT) > 64
        for column, other in zip(found, expected, strict=True):
            assert column.dtype == other.dtype
            assert np.array_equal(column, other)
    assert made == len(bodies) + 3
