"""Solids are closed, as large as they should be, and seen from outside."""

import math
from collections import Counter

import numpy as np
import pytest

from fakes.solids import volume_m3
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Rotation
from linden.scenery.mesh import Material, Mesh
from linden_maps.models.fittings import hoop
from linden_maps.models.solids import (
    FaceLook,
    ball,
    bounds,
    box,
    lathe,
    moved,
    prism,
    rod,
    stretched,
    tube,
    turned,
    wedge,
)

PLAIN = FaceLook(Material.PLAIN, (1, 2, 3))

SOLIDS = {
    "box": (box((0, 0, 0), (1, 2, 3), PLAIN), 6.0),
    "wedge": (wedge((0, 0, 0), (1, 1, 1), PLAIN, top_x=(0.0, 0.0)), 0.5),
    "prism": (prism([(0, 0), (2, 0), (2, 1), (0, 1)], 0.0, 3.0, PLAIN, along=1), 6.0),
    "rod": (rod((0, 0, 0), (1, 2, 2), 0.1, PLAIN, sides=6), 3.0 * 6 * 0.5 * 0.01 * math.sin(math.tau / 6)),
    "ball": (ball((5, 0, 0), (1, 2, 3), PLAIN, sides=64, bands=64), 4.0 / 3.0 * math.pi * 6.0 * 0.997),
    "lathe": (lathe([0.0, 1.0], [1.0, 0.0], 64, PLAIN), math.pi / 3.0),
    "tube": (tube([(0, 0, 0), (0, 0, 1), (0, 0, 2)], [0.1, 0.1, 0.1], 4, PLAIN), 0.04),
    "hoop": (hoop(1.0, 0.1, PLAIN), 2 * 0.01 * 15 * math.sin(math.tau / 15)),  # two shorter sides of a 15-gon's ring
}


def is_closed(mesh: Mesh) -> bool:
    """Whether each edge is passed once in each direction, corners at one place being one corner."""
    _, number = np.unique(np.round(mesh.vertices_m, 6), axis=0, return_inverse=True)
    corners = number.reshape(-1)[mesh.triangles]
    edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in corners for k in range(3))
    return all(edges[b, a] == count for (a, b), count in edges.items())


@pytest.mark.parametrize("name", SOLIDS)
def test_a_solid_is_closed_and_has_the_volume_of_its_formula(name):
    mesh, expected_m3 = SOLIDS[name]
    assert is_closed(mesh)
    assert volume_m3(mesh) == pytest.approx(expected_m3, rel=0.01)


def test_a_mesh_with_a_triangle_missing_is_not_closed():
    mesh, _ = SOLIDS["box"]
    assert not is_closed(mesh._replace(triangles=mesh.triangles[1:], faces=mesh.faces[1:]))


def test_mirroring_and_turning_leave_a_solid_right_side_out():
    mesh = wedge((0, 0, 0), (1, 2, 3), PLAIN, top_x=(0.2, 0.4))
    mirrored = stretched(mesh, (1.0, -1.0, 2.0), (3.0, 0.0, 0.0))
    assert volume_m3(mirrored) == pytest.approx(2.0 * volume_m3(mesh), rel=1e-5)
    around = turned(mesh, rotation_matrix(Rotation(30.0, 50.0, 70.0)), about_m=(1.0, 1.0, 1.0))
    assert volume_m3(around) == pytest.approx(volume_m3(mesh), rel=1e-5)


def test_a_moved_box_reaches_from_corner_to_corner():
    low, high = bounds(moved(box((0, 0, 0), (1, 2, 3), PLAIN), (10.0, 20.0, 30.0)))
    assert low.tolist() == [10.0, 20.0, 30.0]
    assert high.tolist() == [11.0, 22.0, 33.0]
