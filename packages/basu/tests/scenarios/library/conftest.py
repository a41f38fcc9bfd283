"""Packaged cases laid on Linden's map, without a server: ``laid("pedestrian_crossing_1")``."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path as File

import carla
import pytest

import linden
from basu.episode.spec import description_of
from basu.routing import Route, lane_graph, plan
from basu.scenarios.cases import open_library
from basu.scenarios.parameters import narrowed, read_values
from basu.scenarios.paths import Path
from basu.scenarios.place import Place
from basu.scenarios.playable import Playable
from basu.scenarios.scenario import Scenario

Laid = Callable[..., Scenario]


@pytest.fixture(scope="session")
def laid() -> Laid:
    """Makes the scenario of a case, with other values where some are given."""
    text = (File(linden.__file__).parent / "data" / "Linden.xodr").read_text(encoding="utf-8")
    town = carla.Map("Linden", text)
    lanes, library = lane_graph.build(town), open_library()

    @cache
    def route(name: str) -> tuple[Playable, Route]:
        (playable,) = library.of_id(name)
        return playable, plan(town, description_of(playable, town), lanes)

    def make(name: str, **values: str) -> Scenario:
        playable, way = route(name)
        given = replace(playable.case, values={**playable.case.values, **values})
        read = read_values(*narrowed(playable.scenario.parameters, given.values))
        at = given.trigger or given.ego.pose
        along = Path.through(way.points_m).nearest(at.x_m, at.y_m)
        place = Place(route=way, trigger_s_m=max(0.0, along.s_m), carla_map=town, others=given.others)
        return playable.scenario(place, read)

    return make
