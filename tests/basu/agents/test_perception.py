"""Claims about what the basic agent sees, with a world of stand-ins that counts the questions it is asked."""

import math
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.agents.builtin.perception import LOOK_AGAIN_TICKS, RADIUS_M, SMALLEST_M, Lights, Perception, see_ego
from basu.agents.builtin.rules.traffic_lights import Light
from basu.agents.builtin.scene import Ego, Kind

EGO = Ego(0.0, 100.0, 50.0, 0.0, 5.0)


def seen(number: int, x_m: float, y_m: float, yaw_deg: float = 0.0) -> SimpleNamespace:
    """One actor of a snapshot."""
    return SimpleNamespace(
        id=number,
        get_transform=lambda: carla.Transform(carla.Location(x_m, y_m, 0.0), carla.Rotation(yaw=yaw_deg)),
        get_velocity=lambda: carla.Vector3D(3.0, 4.0, 0.0),
        get_angular_velocity=lambda: carla.Vector3D(0.0, 0.0, 90.0),
    )


class Snapshot(list[Any]):
    """A ``carla.WorldSnapshot`` as far as it is asked."""

    def find(self, number: int) -> Any:
        return next((actor for actor in self if actor.id == number), None)


class World:
    """A ``carla.World`` as far as it is asked."""

    def __init__(self, **types: str) -> None:
        self.types = {int(key[1:]): value for key, value in types.items()}
        self.questions: list[list[int]] = []

    def get_actors(self, ids: list[int]) -> list[Any]:
        self.questions.append(ids)
        box = carla.BoundingBox(carla.Location(0.5, 0.0, 0.0), carla.Vector3D(2.0, 0.9, 0.7))
        return [SimpleNamespace(id=i, type_id=self.types[i], bounding_box=box) for i in ids if i in self.types]


def test_vehicles_walkers_and_props_are_seen_and_nothing_else() -> None:
    world = World(
        _2="vehicle.tesla.model3",
        _3="walker.pedestrian.0001",
        _4="static.prop.barrel",
        _5="traffic.stop",
        _6="sensor.camera.rgb",
    )
    others = Perception(world, 1).others(Snapshot([seen(i, 110.0, 50.0) for i in (1, 2, 3, 4, 5, 6)]), EGO)
    assert [(other.id, other.kind) for other in others] == [(2, Kind.VEHICLE), (3, Kind.WALKER), (4, Kind.PROP)]


def test_an_actor_is_asked_about_once() -> None:
    world = World(_2="vehicle.tesla.model3", _5="traffic.stop")
    perception = Perception(world, 1)
    for _ in range(3):
        perception.others(Snapshot([seen(i, 110.0, 50.0) for i in (1, 2, 5)]), EGO)
    perception.others(Snapshot([seen(i, 110.0, 50.0) for i in (1, 2, 5, 7)]), EGO)
    assert world.questions == [[2, 5], [7]]


def test_who_comes_as_another_goes_is_seen_soon_and_who_is_gone_is_not_seen_at_all() -> None:
    world = World(_2="vehicle.tesla.model3", _3="vehicle.tesla.model3")
    perception = Perception(world, 1)
    met = [
        [other.id for other in perception.others(Snapshot([seen(i, 110.0, 50.0) for i in (1, there)]), EGO)]
        for there in (2, *[3] * LOOK_AGAIN_TICKS)
    ]
    assert met == [[2], *[[]] * (LOOK_AGAIN_TICKS - 1), [3]]


def test_who_is_far_away_does_not_matter() -> None:
    world = World(_2="vehicle.tesla.model3", _3="vehicle.tesla.model3")
    there = Snapshot([seen(2, 100.0 + RADIUS_M + 1.0, 50.0), seen(3, 100.0, 50.0 + RADIUS_M - 1.0)])
    assert [other.id for other in Perception(world, 1).others(there, EGO)] == [3]


def test_the_box_is_seen_where_it_is_and_as_it_moves() -> None:
    other = Perception(World(_2="vehicle.tesla.model3"), 1).others(Snapshot([seen(2, 110.0, 50.0, 90.0)]), EGO)[0]
    assert (other.x_m, other.y_m) == pytest.approx((110.0, 50.5))
    assert (other.half_length_m, other.half_width_m) == pytest.approx((2.0, 0.9))
    assert other.speed_mps == pytest.approx(5.0)
    assert other.yaw_rate_radps == pytest.approx(math.pi / 2)


def test_a_body_without_a_box_has_some_size_all_the_same() -> None:
    world = World(_4="static.prop.mesh")
    bare = SimpleNamespace(id=4, type_id="static.prop.mesh", bounding_box=carla.BoundingBox())
    world.get_actors = lambda _ids: [bare]  # type: ignore[method-assign]
    assert Perception(world, 1).others(Snapshot([seen(4, 110.0, 50.0)]), EGO)[0].half_width_m == SMALLEST_M


def test_the_own_speed_is_that_along_the_vehicles_axis() -> None:
    snapshot = SimpleNamespace(timestamp=SimpleNamespace(elapsed_seconds=7.5))
    ego = see_ego(snapshot, seen(1, 1.0, 2.0, 90.0), 3)
    assert ego[:3] == pytest.approx((7.5, 1.0, 2.0))
    assert ego.speed_mps == pytest.approx(4.0)
    assert ego.gear == 3


def test_lights_are_told_by_their_opendrive_id_and_a_missing_one_is_dark() -> None:
    states = {"12": carla.TrafficLightState.Red, "13": carla.TrafficLightState.Green, "14": carla.TrafficLightState.Off}

    def find(landmark_id: str) -> SimpleNamespace | None:
        state = states.get(landmark_id)
        return None if state is None else SimpleNamespace(get_state=lambda: state)

    lights = Lights(SimpleNamespace(get_traffic_light_from_opendrive_id=find), ["12", "13", "14", "99"])
    assert [lights.shows(i) for i in ("12", "13", "14", "99")] == [Light.RED, Light.GREEN, Light.DARK, Light.DARK]
