"""Posts of lights and signs: what they stand on."""

import numpy as np

from linden.maps.ground import Ground
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.scene.posts import Post, posts

STREET = Ground.flat(0.0)


def _foot_m(says_m: float) -> float:
    """Height of the lowest point of a sign whose road, says the map, is at this height."""
    at = Transform(Vector3D(4.0, 3.0, says_m), Rotation(0.0, 90.0, 0.0))
    scene = posts([Post(at, is_light=False)], STREET)
    return float(np.min(scene.boxes["centre"][:, 2] - scene.boxes["half"][:, 2]))


def test_a_sign_stands_on_the_ground_wherever_the_map_hangs_it() -> None:
    assert abs(_foot_m(0.3)) < 1e-9
    assert abs(_foot_m(5.0)) < 1e-9


def test_a_sign_of_a_bridge_does_not_stand_on_the_street_below() -> None:
    assert abs(_foot_m(10.2) - 10.2) < 1e-9
