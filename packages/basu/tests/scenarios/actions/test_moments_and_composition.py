"""Claims about what is done in one frame, and about how behaviours are put together."""

import pytest
from py_trees.common import Status

from basu.errors import ScenarioError
from basu.scenarios.actions import (
    CloseDoor,
    DriveAlong,
    Either,
    InTurn,
    LetGo,
    Meanwhile,
    OpenDoor,
    PutAt,
    Remove,
    SetFriction,
    SetLight,
    SetWeather,
    Together,
    Wait,
)
from basu.scenarios.paths import Path
from basu.scenarios.stage import EGO, ActorSpec, Door, Pose
from basu.scenarios.triggers import EgoPasses
from basu.testing import OfflineStage
from fakes.paper import actor_at, play, stage_with


def noted(stage: OfflineStage) -> list[tuple[object, ...]]:
    return [(command.what, *command.details) for command in stage.commands]


def test_what_is_done_to_the_world_is_done_in_one_frame_and_named() -> None:
    stage, place = stage_with(actor_at(50.0, 5.0)), Pose(3.0, 4.0)
    steps = InTurn(
        SetWeather(precipitation=80.0, wetness=90.0),
        SetFriction(place, 20.0, 0.4),
        SetLight("17", "Red"),
        OpenDoor("other"),
        CloseDoor("other", Door.REAR_RIGHT),
        PutAt("other", place),
    )
    assert play(steps, stage) == 0.0
    assert noted(stage) == [
        ("weather", {"precipitation": 80.0, "wetness": 90.0}),
        ("friction", place, 20.0, 0.4),
        ("light", "17", "Red"),
        ("open door", "other", Door.FRONT_LEFT),
        ("close door", "other", Door.REAR_RIGHT),
        ("put", "other", place),
    ]
    assert stage.body("other")[:2] == (3.0, 4.0)
    assert [step.name for step in steps.children] == [
        "weather: precipitation 80, wetness 90",
        "friction 0.4 within 20 m",
        "light 17 shows Red",
        "other opens its front left door",
        "other closes its rear right door",
        "other is put elsewhere",
    ]


def test_an_actor_that_is_removed_is_gone_and_one_that_is_let_go_rolls_out() -> None:
    stage = stage_with(actor_at(50.0, 5.0, speed_mps=6.0))
    play(LetGo("other"), stage)
    for _ in range(40):
        stage.advance()
    assert 4.0 < stage.body("other").speed_mps < 6.0
    play(Remove("other"), stage)
    assert stage.names == (EGO,)


def test_an_action_on_no_actor_is_refused_with_the_actors_that_are_there() -> None:
    with pytest.raises(ScenarioError, match="no actor on the stage is called 'lorry'; there are other, hero"):
        play(OpenDoor("lorry"), stage_with(actor_at(50.0, 5.0)))


def test_in_turn_takes_the_sum_of_times_together_the_longest_and_either_the_shortest() -> None:
    assert play(InTurn(Wait(1.0), Wait(2.0), Wait(3.0)), stage_with()) == pytest.approx(6.0)
    assert play(Together(Wait(1.0), Wait(3.0), Wait(2.0)), stage_with()) == pytest.approx(3.0)
    assert play(Either(Wait(2.0), Wait(1.0), Wait(3.0)), stage_with()) == pytest.approx(1.0)


def test_meanwhile_lasts_as_long_as_its_first_whatever_the_others_do() -> None:
    drive = DriveAlong("other", Path.through([(0.0, 9.0), (100.0, 9.0)]), 5.0)
    short = Wait(0.5)
    both = Meanwhile(EgoPasses(50.0), drive, short)
    assert play(both, stage_with(actor_at(0.0, 9.0))) == pytest.approx(5.0, abs=0.06)
    assert (drive.status, short.status) == (Status.INVALID, Status.SUCCESS)
    assert both.name == "until ego passes 50 m"


def test_an_actor_that_waits_again_waits_as_long_again() -> None:
    wait, stage = Wait(1.0), stage_with()
    play(wait, stage)
    assert play(wait, stage) == pytest.approx(2.0)


def test_an_actor_that_is_added_has_its_speed_and_a_name_of_its_own() -> None:
    stage = stage_with(actor_at(50.0, 5.0))
    spec = ActorSpec("late", "vehicle.nissan.micra", Pose(10.0, 20.0), speed_mps=4.0)
    stage.add(spec)
    stage.advance()
    assert stage.body("late").x_m == pytest.approx(10.0 + 4.0 * stage.step_s)
    assert stage.body("late").speed_mps == pytest.approx(4.0)
    with pytest.raises(ScenarioError, match="two actors are called 'late'; give each its own role"):
        stage.add(spec)
