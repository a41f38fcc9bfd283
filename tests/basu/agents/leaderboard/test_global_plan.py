"""Claims about the plan in the leaderboard's terms: which way a junction is crossed, and both forms of a place."""

import enum
import math
import sys
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pytest

from basu.agents.leaderboard.global_plan import global_plan, road_options
from basu.agents.leaderboard.gps import Place
from basu.agents.leaderboard.provided.road_option import RoadOption

FOLLOW = RoadOption.LANEFOLLOW


def crossing(turn_deg: float, before: int = 3, inside: int = 4, after: int = 3) -> list[int]:
    """The options of a way through one junction that turns evenly inside of it."""
    inner = np.linspace(0.0, turn_deg, inside + 1)[1:]
    yaw_deg = np.concatenate([np.zeros(before), inner, np.full(after, turn_deg)])
    is_junction = np.array([False] * before + [True] * inside + [False] * after)
    options: list[int] = road_options(np.radians(yaw_deg), is_junction).tolist()
    return options


@pytest.mark.parametrize(
    ("turn_deg", "option"),
    [
        (0.0, RoadOption.STRAIGHT),
        (34.0, RoadOption.STRAIGHT),
        (-34.0, RoadOption.STRAIGHT),
        (36.0, RoadOption.RIGHT),
        (90.0, RoadOption.RIGHT),
        (-90.0, RoadOption.LEFT),
        (-140.0, RoadOption.LEFT),
    ],
)
def test_a_junction_is_crossed_by_the_turn_it_makes(turn_deg: float, option: RoadOption) -> None:
    assert crossing(turn_deg) == [FOLLOW] * 3 + [option] * 4 + [FOLLOW] * 3


def test_a_turn_over_the_seam_of_yaw_is_no_turn_back() -> None:
    yaw_rad = np.array([math.radians(170.0), math.radians(-175.0), math.radians(-100.0)])
    assert road_options(yaw_rad, np.array([False, True, True])).tolist() == [FOLLOW, RoadOption.RIGHT, RoadOption.RIGHT]


def test_who_begins_in_a_junction_follows_the_lane() -> None:
    assert crossing(90.0, before=0) == [FOLLOW] * 7


def test_a_plan_may_end_in_a_junction() -> None:
    assert crossing(-90.0, after=0) == [FOLLOW] * 3 + [RoadOption.LEFT] * 4


class Degrees:
    """Of a flat earth."""

    def place(self, at: carla.Location) -> Place:
        return Place(40.0 - at.y / 1e5, -74.0 + at.x / 1e5, at.z)


def route(count: int = 3) -> Any:
    waypoints = [
        SimpleNamespace(transform=carla.Transform(carla.Location(float(x_m), 2.0, 0.5))) for x_m in range(count)
    ]
    return SimpleNamespace(yaw_rad=np.zeros(count), is_junction=np.zeros(count, bool), waypoints=waypoints)


def test_both_forms_say_the_same_place() -> None:
    plan = global_plan(route(), Degrees())
    assert [pose.location.x for pose, _ in plan.world] == [0.0, 1.0, 2.0]
    assert plan.gps[2][0] == {"lat": pytest.approx(39.99998), "lon": pytest.approx(-73.99998), "z": 0.5}
    assert {option for _, option in (*plan.gps, *plan.world)} == {RoadOption.LANEFOLLOW}


def test_options_are_carlas_own_where_an_agent_has_loaded_them(monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = enum.IntEnum("RoadOption", {option.name: option.value for option in RoadOption})
    monkeypatch.setitem(sys.modules, "agents.navigation.local_planner", SimpleNamespace(RoadOption=theirs))
    assert isinstance(global_plan(route(), Degrees()).world[0][1], theirs)
