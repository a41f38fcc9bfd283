"""Claims about the look-ups that agents make in the running world."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from basu_leaderboard.provided.carla_data_provider import CarlaDataProvider

HERO: Any = SimpleNamespace(id=7, attributes={"role_name": "hero"})
OTHER: Any = SimpleNamespace(id=8, attributes={})


class World:
    asked = 0

    def get_map(self) -> str:
        return "the map"

    def get_actors(self) -> list[Any]:
        self.asked += 1
        return [HERO, OTHER]


@pytest.fixture(autouse=True)
def begun() -> Iterator[World]:
    world = World()
    CarlaDataProvider.set_world(world)
    CarlaDataProvider.register_actor(HERO)
    yield world
    CarlaDataProvider.cleanup()


def test_the_hero_is_the_vehicle_under_test() -> None:
    assert CarlaDataProvider.get_hero_actor() is HERO
    assert CarlaDataProvider.get_actor_by_name("hero") is HERO
    assert dict(CarlaDataProvider.get_actors()) == {7: HERO}


def test_an_actor_that_was_not_registered_is_not_found_by_id() -> None:
    assert CarlaDataProvider.get_actor_by_id(7) is HERO
    assert CarlaDataProvider.get_actor_by_id(8) is None
    assert not CarlaDataProvider.actor_id_exists(8)


def test_all_actors_is_read_once_a_step(begun: World) -> None:
    assert CarlaDataProvider.get_all_actors() == CarlaDataProvider.get_all_actors() == [HERO, OTHER]
    assert begun.asked == 1
    CarlaDataProvider.on_carla_tick()
    CarlaDataProvider.get_all_actors()
    assert begun.asked == 2


def test_after_the_run_nothing_is_left_of_it() -> None:
    CarlaDataProvider.cleanup()
    assert CarlaDataProvider.get_hero_actor() is None
    assert CarlaDataProvider.get_world() is None
    with pytest.raises(ValueError, match="no world yet"):
        CarlaDataProvider.get_map()


def test_what_is_scenario_runners_is_refused_by_name() -> None:
    with pytest.raises(AttributeError, match=r"CarlaDataProvider.request_new_actor .* put ScenarioRunner's folder"):
        CarlaDataProvider.request_new_actor("vehicle.audi.a2")
