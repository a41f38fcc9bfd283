"""Woods close the view beyond the streets, and stand neither near a road nor near a thing."""

import numpy as np

from home_map import home_map
from linden.scenery.roadside.trees import woods
from linden.scenery.scene.south_linden import home


def test_woods_stand_away_from_all_roads_and_things() -> None:
    linden = home_map()
    scene = home(linden)
    mesh = woods(scene, linden.ground)
    middles = mesh.vertices_m[mesh.triangles].mean(axis=1)[::20, :2]  # of each clump, a face
    assert 500 < len(middles) < 2500
    others = np.concatenate([linden.ground.planes[::3, :2], scene.boxes["centre"][:, :2]])
    nearest = [np.hypot(*(others - middle).T).min() for middle in middles[::10]]
    assert min(nearest) > 20.0
    low, high = others.min(axis=0), others.max(axis=0)
    beyond = ((middles < low) | (middles > high)).any(axis=1)
    assert beyond.sum() > 100  # on the horizon, whichever way one looks


def test_the_same_map_has_the_same_woods() -> None:
    linden = home_map()
    scene = home(linden)
    first, second = woods(scene, linden.ground), woods(scene, linden.ground)
    np.testing.assert_array_equal(first.vertices_m, second.vertices_m)
