"""Claims about rays against boxes: made-up streets, and a comparison with the obvious version."""

import math
import random
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pytest

from basu.agents.sight import occlusion
from basu.agents.sight.occlusion import HIDING_LABELS, hidden, make_boxes, sample_points_m, static_boxes
from basu.simulator import connect
from naive.line_of_sight import blocks
from servers import RunningServer

SENSOR_M = np.array([0.0, 0.0, 2.9])
VAN = (20.0, 3.0, 1.28, 2.96, 0.99, 1.28, 0.0)
CAR = (20.0, 3.0, 0.72, 2.3, 0.92, 0.72, 0.0)


def child_at(x_m: float, y_m: float) -> tuple[float, ...]:
    return (x_m, y_m, 0.55, 0.25, 0.25, 0.55, 0.0)


def hides(rows: list[tuple[float, ...]], body: tuple[float, ...]) -> bool:
    """Whether the boxes hide one body."""
    bodies = make_boxes(np.array([body]))
    return bool(hidden(SENSOR_M, bodies, make_boxes(np.array(rows).reshape(-1, 7)).and_(bodies))[0])


def test_a_child_behind_a_van_is_hidden_and_beside_it_is_not() -> None:
    assert hides([VAN], child_at(24.0, 3.6))
    assert not hides([VAN], child_at(24.0, 1.0))
    assert not hides([], child_at(24.0, 3.6))


def test_from_the_roof_one_looks_over_a_car_but_not_at_an_actor_close_behind_it() -> None:
    assert hides([CAR], child_at(23.0, 3.45))
    assert not hides([CAR], child_at(50.0, 7.5))


def test_a_gap_between_two_boxes_is_looked_through() -> None:
    house, next_house = (20.0, -10.0, 3.0, 5.0, 8.0, 3.0, 0.0), (20.0, 10.0, 3.0, 5.0, 8.0, 3.0, 0.0)
    car = (40.0, 0.0, 0.72, 2.3, 0.92, 0.72, 0.0)
    assert not hides([house, next_house], car)
    assert hides([house, (20.0, 0.0, 3.0, 5.0, 2.1, 3.0, 0.0)], car)


def test_two_boxes_hide_together_what_neither_hides_alone() -> None:
    left, right, body = (
        (20.0, -1.0, 2.0, 0.2, 1.1, 2.0, 0.0),
        (22.0, 1.0, 2.0, 0.2, 1.1, 2.0, 0.0),
        (40.0, 0.0, 0.72, 2.3, 0.92, 0.72, 0.0),
    )
    assert not hides([left], body)
    assert not hides([right], body)
    assert hides([left, right], body)


def test_neither_the_box_around_the_sensor_nor_that_around_the_body_hides_it() -> None:
    assert not hides([(0.0, 0.0, 2.0, 5.0, 5.0, 5.0, 0.3)], child_at(24.0, 3.6))
    assert not hides([(24.0, 3.6, 2.0, 5.0, 5.0, 5.0, 0.3)], child_at(24.0, 3.6))


def test_a_box_behind_the_body_or_behind_the_sensor_hides_nothing() -> None:
    assert not hides([(30.0, 4.5, 2.0, 1.0, 3.0, 3.0, 0.0), (-5.0, 0.0, 2.0, 1.0, 3.0, 3.0, 0.0)], child_at(24.0, 3.6))


@pytest.mark.unmeasured
def test_the_answer_is_that_of_the_obvious_version() -> None:
    chance = random.Random(7)
    answers = []
    for _ in range(4):
        rows = [
            (
                *(chance.uniform(-25.0, 25.0) for _ in "xy"),
                chance.uniform(0.0, 3.0),
                *(chance.uniform(0.3, 5.0) for _ in "lwh"),
                chance.uniform(-4.0, 4.0),
            )
            for _ in range(12)
        ]
        bodies = make_boxes(np.array([(*row[:3], *(half / 3.0 for half in row[3:6]), row[6]) for row in rows]))
        expected = [
            all(any(blocks(SENSOR_M, point, row) for row in rows) for point in points)
            for points in sample_points_m(bodies).tolist()
        ]
        answers += expected
        assert hidden(SENSOR_M, bodies, make_boxes(np.array(rows))).tolist() == expected
    assert min(answers.count(True), answers.count(False)) >= 10


class Town:
    """A ``carla.World`` as far as it is asked; counts the questions."""

    def __init__(self, name: str, **boxes: list[tuple[float, float, float]]) -> None:
        self.name, self.boxes, self.questions = name, boxes, 0

    def get_names_of_all_objects(self) -> list[str]:
        return [self.name]

    def get_environment_objects(self, label: Any) -> list[SimpleNamespace]:
        self.questions += 1
        boxes = [
            carla.BoundingBox(carla.Location(30.0, 0.0, 2.0), carla.Vector3D(*half))
            for half in self.boxes.get(str(label), [])
        ]
        return [SimpleNamespace(bounding_box=box) for box in boxes]


def test_a_town_is_read_for_its_boxes_once() -> None:
    town = Town("once", Buildings=[(5.0, 5.0, 2.0)])
    static_boxes(town)
    assert town.questions == len(HIDING_LABELS)
    assert len(static_boxes(town).near(SENSOR_M, 100.0).cos) == 1
    assert town.questions == len(HIDING_LABELS)


def test_spawned_actors_never_become_boxes_of_the_town(simulator: RunningServer) -> None:
    """``get_level_bbs`` lists actors too: those of the case that asks first would hide others in all later cases."""
    client = connect("127.0.0.1", simulator.port, 20.0)
    world = client.get_world()
    van = world.get_blueprint_library().find("vehicle.mercedes.sprinter")
    pose = world.get_map().get_spawn_points()[0]
    occlusion._BOXES_OF_TOWN.clear()
    before = static_boxes(world).near(place_of(pose), 100.0).centre_m.tolist()
    actor = world.spawn_actor(van, pose)
    try:
        tick_or_wait(world)
        occlusion._BOXES_OF_TOWN.clear()
        assert static_boxes(world).near(place_of(pose), 100.0).centre_m.tolist() == before
    finally:
        actor.destroy()
        occlusion._BOXES_OF_TOWN.clear()


def place_of(pose: carla.Transform) -> np.ndarray:
    return np.array([pose.location.x, pose.location.y, pose.location.z + 2.0])


def tick_or_wait(world: carla.World) -> None:
    """Let the world make a frame, whoever makes them."""
    if world.get_settings().synchronous_mode:
        world.tick()
    else:
        world.wait_for_tick()


def test_thin_poles_and_crowns_of_trees_hide_nothing() -> None:
    town = Town("thin", Static=[(0.05, 0.05, 2.0), (0.03, 2.0, 1.25)], Vegetation=[(3.0, 3.0, 2.0), (0.2, 0.2, 2.0)])
    assert sorted(static_boxes(town).near(SENSOR_M, 100.0).half_m[:, 1].tolist()) == pytest.approx([0.2, 2.0])


def test_boxes_come_into_reach_as_the_vehicle_drives() -> None:
    static = static_boxes(Town("far", Buildings=[(5.0, 5.0, 2.0)]))
    far_m = np.array([-500.0, 0.0, 2.9])
    assert len(static.near(far_m, 100.0).cos) == 0
    for x_m in range(-500, 1, 5):
        reached = len(static.near(np.array([x_m, 0.0, 2.9]), 100.0).cos) == 1
        assert reached or math.hypot(30.0 - x_m, 0.0) > 100.0
    assert reached
