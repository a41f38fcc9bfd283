"""The asset of actor meshes that the server holds is the one that the models make."""

import numpy as np
import pytest

from linden.blueprints.library import BlueprintLibrary
from linden.scenery.actors.actor_meshes import BlueprintMeshes, actor_meshes, decoded, encoded
from linden_maps.models.all_blueprints import made


@pytest.fixture(scope="module")
def bodies() -> BlueprintMeshes:
    return made(BlueprintLibrary.load())


def test_the_asset_holds_what_the_models_make(bodies: BlueprintMeshes) -> None:
    """If it fails, run ``scripts/make_actor_meshes.py``. Processors may differ in the last bits of sines."""
    asset = actor_meshes()
    assert asset.all_parts == bodies.all_parts
    assert len(asset.meshes) == len(bodies.meshes)
    for here, there in zip(asset.meshes, bodies.meshes, strict=True):
        np.testing.assert_allclose(here.vertices_m, there.vertices_m, rtol=0.0, atol=1e-5)
        np.testing.assert_array_equal(here.triangles, there.triangles)
        np.testing.assert_array_equal(here.faces, there.faces)


def test_two_libraries_give_the_same_bytes(bodies: BlueprintMeshes) -> None:
    assert encoded(made(BlueprintLibrary.load())) == encoded(bodies)


def test_a_written_asset_is_read_as_it_was(bodies: BlueprintMeshes) -> None:
    content = encoded(bodies)
    assert encoded(decoded(content)) == content
