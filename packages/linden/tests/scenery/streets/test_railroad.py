"""The railroad lies on a bed of gravel, comes down to the streets that it crosses, and goes on in their asphalt."""

import numpy as np
import pytest

from linden.maps.ground import Ground
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh
from linden.scenery.streets.railroad import railroad

STREET_HALF_M = 6.0
LINE_M = np.array([(-150.0, 0.0), (150.0, 0.0)])


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    """A railroad from west to east, across a street along x = 0 on flat land."""
    x, far = STREET_HALF_M, 200.0
    street = [(-x, -far, 0.0), (x, -far, 0.0), (x, far, 0.0), (-x, far, 0.0)]
    return railroad(LINE_M, Ground.from_triangles(street, [(0, 1, 2), (0, 2, 3)]), Ground.flat())


def corners(mesh: Mesh, material: Material) -> np.ndarray:
    return mesh.vertices_m[mesh.triangles[mesh.faces["material"] == material]].reshape(-1, 3)


def test_the_bed_is_high_on_open_land_and_low_beside_the_street(mesh: Mesh) -> None:
    bed = corners(mesh, Material.GRAVEL)
    away = np.abs(bed[:, 0])
    assert bed[away > 60.0, 2].max() == pytest.approx(0.28, abs=1e-3)
    assert bed[away < STREET_HALF_M + 8.0, 2].max() < 0.1
    assert away.min() > STREET_HALF_M


def test_rails_go_on_through_the_street_flush_with_its_panels(mesh: Mesh) -> None:
    rails = corners(mesh, Material.METAL)
    across = np.abs(rails[:, 0]) < STREET_HALF_M
    assert across.any()
    assert rails[across, 2].max() < 0.02
    panels = mesh.vertices_m[mesh.triangles[mesh.faces["tag"] == SemanticTag.ROADS]].reshape(-1, 3)
    assert 0.0 < panels[:, 2].max() < rails[across, 2].max()


def test_no_tie_lies_on_a_street(mesh: Mesh) -> None:
    assert np.abs(corners(mesh, Material.WOOD)[:, 0]).min() > STREET_HALF_M
