"""Things and boxes as clients see them: named, numbered, found again by their ids."""

import math

import numpy as np
import pytest

from linden.maps.ground import Ground
from linden.protocol.values.enums import MapLayer, SemanticTag
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.scene.objects import ObjectKind, Scene, boxes_on, join, object_id, things_with
from linden.scenery.scene.posts import Post, posts


def post(x: float, *, light: bool, yaw: float = 0.0) -> Post:
    return Post(Transform(Vector3D(x, 0.0, 0.0), Rotation(0.0, yaw, 0.0)), light)


@pytest.fixture
def scene() -> Scene:
    return posts([post(0.0, light=True), post(10.0, light=True), post(20.0, light=False, yaw=90.0)], Ground.flat(2.0))


def test_every_box_has_the_name_that_carla_would_give_it(scene: Scene) -> None:
    assert [item.name for item in scene.objects] == [
        "TrafficLight_0_Poles_0", "TrafficLight_0_TrafficLight_1", "TrafficLight_1_Poles_0",
        "TrafficLight_1_TrafficLight_1", "TrafficSign_0_SM_0", "TrafficSign_0_SM_1",
    ]  # fmt: skip
    assert scene.thing_names == ("TrafficLight_0", "TrafficLight_1", "TrafficSign_0")


def test_a_box_is_found_by_its_id_and_no_two_share_one(scene: Scene) -> None:
    assert [scene.box_of_id[item.id] for item in scene.objects] == list(range(6))
    assert all(0 < item.id < 2**63 for item in scene.objects)
    assert object_id("House_0_SM_0") == object_id("House_0_SM_0") != object_id("House_1_SM_0")


def test_a_box_stands_where_its_thing_is_turned_to(scene: Scene) -> None:
    things = things_with(ObjectKind.HOUSE, np.array([[5.0, 5.0, 0.0]]), np.array([math.pi / 2]))
    (box,) = boxes_on(things, np.array([2.0, 0.0, 1.0]), np.ones(3), SemanticTag.BUILDINGS)
    np.testing.assert_allclose(box["centre"], [5.0, 7.0, 1.0])
    plate = scene.objects[5]
    assert plate.transform.rotation.yaw == plate.bounding_box.rotation.yaw == 90.0
    assert plate.transform.location == (20.0, 0.0, 2.0)


def test_joined_scenes_keep_their_things_apart(scene: Scene) -> None:
    both = join([scene, scene])
    assert both.boxes["thing"].tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]
    assert both.boxes_of(4).tolist() == [8, 9]
    assert scene.boxes["thing"].max() == 2


def test_signals_belong_to_no_layer(scene: Scene) -> None:
    assert set(scene.layers.tolist()) == {MapLayer.NONE}


def test_signs_before_lights_would_mix_up_the_actors() -> None:
    with pytest.raises(ValueError, match="lights come before signs"):
        posts([post(0.0, light=False), post(1.0, light=True)], Ground.flat())
