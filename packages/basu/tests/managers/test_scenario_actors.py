"""The blueprint that an actor of a scenario gets, in a simulator with animals and in one without."""

import fnmatch
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from basu.errors import ScenarioError
from basu.managers.stage.scenario_actors import _blueprint, _half_height_m
from basu.scenarios.library.road_users import animal
from basu.scenarios.stage import ActorSpec, Pose

PEOPLE = ["walker.pedestrian.0009", "walker.pedestrian.0048"]
ANIMALS = ["walker.animal.deer", "walker.animal.dog"]
DEER = animal("deer", "deer", Pose(0.0, 0.0))


class Library:
    """A library of blueprints without attributes."""

    def __init__(self, *names: str) -> None:
        self._blueprints = [SimpleNamespace(id=name, has_attribute=lambda _name: False) for name in names]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._blueprints)

    def filter(self, pattern: str) -> list[Any]:
        return [one for one in self if fnmatch.fnmatch(one.id, pattern)]


def library(*names: str) -> Any:
    """The same, for typed functions."""
    return Library(*names)


def test_a_deer_is_a_deer_where_there_is_one_and_else_a_walker_of_a_childs_size() -> None:
    assert _blueprint(library(*PEOPLE, *ANIMALS), DEER, "case").id == "walker.animal.deer"
    assert _blueprint(library(*PEOPLE), DEER, "case").id == "walker.pedestrian.0048"  # the original CARLA


def test_a_pattern_for_walkers_takes_people_before_animals() -> None:
    spec = ActorSpec("walker", "walker.*", Pose(0.0, 0.0))
    assert _blueprint(library(*ANIMALS, *PEOPLE), spec, "case").id == "walker.pedestrian.0009"


def test_an_actor_is_refused_where_its_blueprint_and_its_stand_in_are_missing() -> None:
    with pytest.raises(ScenarioError, match=r"case needs a 'walker\.animal\.deer'"):
        _blueprint(library("vehicle.audi.a2"), DEER, "case")


def test_a_blueprint_that_says_its_height_stands_on_its_feet() -> None:
    height = SimpleNamespace(as_float=lambda: 0.91)
    deer: Any = SimpleNamespace(has_attribute=lambda name: name == "height", get_attribute=lambda _name: height)
    assert _half_height_m(deer) == pytest.approx(0.455)
