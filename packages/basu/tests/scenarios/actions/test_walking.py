"""Claims about walkers: where they go, how fast, and what they do on the way and at the end."""

import math

import pytest

from basu.scenarios.actions import Either, Wait, WalkAlong
from basu.scenarios.paths import Path
from basu.scenarios.stage import EGO
from basu.testing import OfflineStage, steady
from fakes.paper import actor_at, play, stage_with

ACROSS = Path.through([(60.0, 6.0), (60.0, -6.0)])
CORNER = Path.through([(60.0, 6.0), (60.0, 0.0), (66.0, 0.0)])


def stage_with_walker() -> OfflineStage:
    return stage_with(actor_at(60.0, 6.0, kind="walker.pedestrian.0001"), driver=steady(0.0))


def test_a_walk_takes_its_length_over_its_speed_and_then_it_stands() -> None:
    stage, walk = stage_with_walker(), WalkAlong("other", ACROSS, 1.5)
    assert play(walk, stage) == pytest.approx(8.0, abs=0.06)
    stage.advance()
    body = stage.body("other")
    assert (body.x_m, body.y_m) == pytest.approx((60.0, -6.0), abs=0.1)
    assert body.speed_mps == 0.0
    assert walk.name == "other walks 12 m at 1.5 m/s"
    assert walk.feedback_message.startswith("12.0 m walked") or walk.feedback_message.startswith("11.9 m walked")


def test_an_actor_that_is_fast_runs() -> None:
    assert WalkAlong("dog", ACROSS, 4.0).name == "dog runs 12 m at 4 m/s"


def test_a_corner_is_walked_round() -> None:
    stage, off_m = stage_with_walker(), []

    def watch(stage: OfflineStage) -> None:
        body = stage.body("other")
        off_m.append(CORNER.nearest(body.x_m, body.y_m).distance_m)

    play(WalkAlong("other", CORNER, 1.5), stage, watch=watch)
    assert max(off_m) < 0.4


def test_an_actor_that_pauses_stands_there_for_so_long() -> None:
    stage, stood = stage_with_walker(), []

    def watch(stage: OfflineStage) -> None:
        body = stage.body("other")
        if body.speed_mps == 0.0 and stage.time_s > 1.0:
            stood.append(body.y_m)

    done_s = play(WalkAlong("other", ACROSS, 1.5, pause_at_m=4.5, pause_s=3.0), stage, watch=watch)
    assert done_s == pytest.approx(11.0, abs=0.15)
    assert len(stood) * stage.step_s == pytest.approx(3.0, abs=0.1)
    assert set(stood) == {stood[0]}
    assert stood[0] == pytest.approx(1.5, abs=0.1)


def test_an_actor_that_turns_back_ends_where_it_began() -> None:
    stage = stage_with_walker()
    assert play(WalkAlong("other", ACROSS, 1.5, at_end="turn back"), stage) == pytest.approx(16.0, abs=0.15)
    assert stage.body("other").y_m == pytest.approx(6.0, abs=0.1)


def test_an_actor_that_turns_back_in_the_middle_of_the_road_is_known_by_a_shorter_path() -> None:
    stage = stage_with_walker()
    play(WalkAlong("other", ACROSS.part(0.0, 6.0), 1.5, at_end="turn back"), stage)
    assert stage.time_s == pytest.approx(8.0, abs=0.15)


def test_an_actor_that_goes_on_goes_on_and_one_that_vanishes_is_gone() -> None:
    stage = stage_with_walker()
    play(WalkAlong("other", ACROSS, 1.5, at_end="go on"), stage)
    for _ in range(20):
        stage.advance()
    assert stage.body("other").y_m == pytest.approx(-7.5, abs=0.1)
    stage = stage_with_walker()
    play(WalkAlong("other", ACROSS, 1.5, at_end="vanish"), stage)
    assert stage.names == (EGO,)


def test_an_actor_that_is_broken_off_stands() -> None:
    stage = stage_with_walker()
    play(Either(WalkAlong("other", ACROSS, 1.5, at_end="vanish"), Wait(2.0)), stage)
    stage.advance()
    assert stage.body("other").speed_mps == 0.0


def test_an_actor_that_is_touched_stands() -> None:
    stage = stage_with(actor_at(60.0, 6.0, kind="walker.pedestrian.0001"), driver=steady(12.0))
    walk = WalkAlong("other", ACROSS, 1.2)
    play(walk, stage)
    assert walk.feedback_message.startswith("touched by the ego after 5.")
    stage.advance()
    assert stage.body("other").speed_mps == 0.0


def test_a_walker_faces_where_it_goes() -> None:
    stage = stage_with_walker()
    play(WalkAlong("other", CORNER, 1.5), stage)
    assert stage.body("other").yaw_rad == pytest.approx(0.0, abs=math.radians(5.0))
