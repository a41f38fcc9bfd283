"""Claims about triggers: when each comes true on a stage with bodies that move as commanded."""

import math

import pytest
from py_trees.common import Status

from basu.metrics import path_following
from basu.scenarios.paths import Path
from basu.scenarios.stage import Pose
from basu.scenarios.triggers import (
    ActorTimeToArrival,
    Circle,
    ClosesIn,
    CrossesLine,
    EgoArrives,
    EgoBeyond,
    EgoEntersJunction,
    EgoLeavesJunction,
    EgoNear,
    EgoPasses,
    EgoTouches,
    Elapsed,
    Faster,
    InRegion,
    Near,
    NearPlace,
    Polygon,
    Slower,
    StandsStill,
    Stretch,
    TimeToArrival,
    along_route,
)
from basu.testing import OfflineStage, steady, waiting_at
from fakes.paper import actor_at, play, stage_with

FRAME_S = 0.051  # a frame, and what rounding adds


def test_near_is_from_middle_to_middle() -> None:
    trigger = EgoNear("other", 20.0)
    assert play(trigger, stage_with(actor_at(60.0))) == pytest.approx(4.0, abs=FRAME_S)
    assert trigger.name == "ego within 20 m of other"
    assert trigger.feedback_message.startswith("ego at 20.0 m")


def test_near_may_be_between_two_others() -> None:
    third = actor_at(100.0, speed_mps=0.0)._replace(name="third")
    stage = stage_with(actor_at(50.0, speed_mps=5.0), third, driver=steady(0.0))
    assert play(Near("other", "third", 10.0), stage) == pytest.approx(8.0, abs=FRAME_S)


def test_near_a_place_works_for_any_actor() -> None:
    assert play(NearPlace(Pose(50.0, 0.0), 10.0), stage_with()) == pytest.approx(4.0, abs=FRAME_S)
    stage = stage_with(actor_at(0.0, 9.0, speed_mps=5.0))
    assert play(NearPlace(Pose(50.0, 9.0), 10.0, actor="other"), stage) == pytest.approx(8.0, abs=FRAME_S)


@pytest.mark.parametrize(
    "region",
    [
        Circle(50.0, 0.0, 10.0),
        Polygon(((40.0, -5.0), (60.0, -5.0), (60.0, 5.0), (40.0, 5.0))),
        Polygon(((40.0, 5.0), (60.0, 5.0), (60.0, -5.0), (40.0, -5.0))),
        Stretch(Path.through([(0.0, 1.0), (100.0, 1.0)]), 40.0, 60.0),
    ],
)
def test_the_ego_comes_into_a_region_at_its_edge(region: Circle | Polygon | Stretch) -> None:
    assert play(InRegion(region), stage_with()) == pytest.approx(4.0, abs=FRAME_S)
    assert not region.holds(50.0, 15.0)
    assert not region.holds(65.0, 0.0)


def test_a_polygon_with_a_dent_does_not_hold_its_dent() -> None:
    dented = Polygon(((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 2.0), (0.0, 10.0)))
    assert dented.holds(1.0, 5.0)
    assert dented.holds(9.0, 5.0)
    assert not dented.holds(5.0, 5.0)


def test_a_line_is_crossed_by_the_front_and_only_in_its_direction() -> None:
    line = Pose(50.0, 0.0, 0.0, 0.0)
    assert play(CrossesLine(line), stage_with()) == pytest.approx(4.8, abs=FRAME_S)  # the front is 2 m ahead
    against = stage_with(actor_at(80.0, 0.0, math.pi, speed_mps=10.0), driver=steady(0.0))
    with pytest.raises(AssertionError, match="not done"):
        play(CrossesLine(line, actor="other"), against, until_s=10.0)


def test_an_ego_that_passes_beside_the_line_does_not_cross_it() -> None:
    with pytest.raises(AssertionError, match="not done"):
        play(CrossesLine(Pose(50.0, 8.0, 0.0, 0.0), 3.0), stage_with(), until_s=15.0)


def test_an_ego_that_begins_beyond_the_line_has_not_crossed_it() -> None:
    with pytest.raises(AssertionError, match="not done"):
        play(CrossesLine(Pose(-10.0, 0.0)), stage_with(), until_s=5.0)


def test_passing_a_place_and_the_time_to_it() -> None:
    assert play(EgoPasses(70.0), stage_with()) == pytest.approx(7.0, abs=FRAME_S)
    assert play(TimeToArrival(70.0, 3.0), stage_with()) == pytest.approx(4.0, abs=FRAME_S)


def test_an_ego_that_stands_is_never_seconds_away() -> None:
    with pytest.raises(AssertionError, match="not done"):
        play(TimeToArrival(70.0, 100.0), stage_with(driver=steady(0.0)), until_s=5.0)


def test_an_actors_time_to_a_place_of_its_path() -> None:
    path = Path.through([(0.0, 20.0), (100.0, 20.0)])
    stage = stage_with(actor_at(0.0, 20.0, speed_mps=5.0))
    assert play(ActorTimeToArrival("other", path, 60.0, 4.0), stage) == pytest.approx(8.0, abs=FRAME_S)


def test_beyond_an_actor_is_tail_past_nose() -> None:
    # the ego's half is 2.0 m, the other's 2.3 m
    assert play(EgoBeyond("other", 1.0), stage_with(actor_at(40.0, 3.0))) == pytest.approx(4.53, abs=FRAME_S)


def test_beyond_an_actor_that_stands_across_counts_the_width() -> None:
    stage = stage_with(actor_at(40.0, 5.0, math.pi / 2.0))
    assert play(EgoBeyond("other"), stage) == pytest.approx(4.295, abs=FRAME_S)


def test_a_junction_is_entered_and_left() -> None:
    assert play(EgoEntersJunction(), stage_with(junctions_m=((50.0, 65.0),))) == pytest.approx(5.0, abs=2 * FRAME_S)
    assert play(EgoLeavesJunction(), stage_with(junctions_m=((50.0, 65.0),))) == pytest.approx(6.5, abs=2 * FRAME_S)


def test_a_junction_before_the_place_asked_for_does_not_count() -> None:
    stage = stage_with(junctions_m=((10.0, 25.0), (50.0, 65.0)))
    assert play(EgoLeavesJunction(beyond_m=30.0), stage) == pytest.approx(6.5, abs=2 * FRAME_S)


def test_speeds_of_the_ego_and_of_others() -> None:
    rising = stage_with(driver=lambda stage: 2.0 * stage.time_s)
    assert play(Faster(6.0), rising) == pytest.approx(3.05, abs=FRAME_S)
    falling = stage_with(driver=lambda stage: 10.0 - 2.0 * stage.time_s)
    play(Elapsed(0.5), falling)
    assert play(Slower(4.0), falling) == pytest.approx(3.05, abs=FRAME_S)
    assert play(Faster(3.0, actor="other"), stage_with(actor_at(30.0, speed_mps=3.5))) == 0.0


def test_standing_counts_only_without_a_break() -> None:
    def driver(stage: OfflineStage) -> float:
        return 1.0 if stage.time_s < 2.0 or 3.0 <= stage.time_s < 4.0 else 0.0

    trigger = StandsStill(2.0)
    assert play(trigger, stage_with(driver=driver)) == pytest.approx(6.0, abs=2 * FRAME_S)
    assert trigger.feedback_message == "stood for 2.0 s"


def test_closing_in_is_from_edge_to_edge_at_the_speed_of_both() -> None:
    stage = stage_with(actor_at(104.3, 0.0, math.pi, speed_mps=10.0))
    assert play(ClosesIn("other", 2.0), stage) == pytest.approx(3.0, abs=FRAME_S)  # 100 m at 20 m/s, less 2 s


def test_an_ego_that_drives_away_is_never_closed_in_on() -> None:
    with pytest.raises(AssertionError, match="not done"):
        play(ClosesIn("other", 100.0), stage_with(actor_at(10.0, speed_mps=12.0)), until_s=5.0)


def test_a_touch_is_seen_of_the_chosen_actor_and_of_any_actor() -> None:
    assert play(EgoTouches(), stage_with(actor_at(54.3))) == pytest.approx(5.0, abs=FRAME_S)
    assert play(EgoTouches("other"), stage_with(actor_at(54.3))) == pytest.approx(5.0, abs=FRAME_S)
    with pytest.raises(AssertionError, match="not done"):
        play(EgoTouches("third"), stage_with(actor_at(54.3)), until_s=10.0)


@pytest.mark.parametrize("speed_mps", [0.5, 5.0, 15.0, 30.0])
def test_arriving_is_known_no_later_than_the_run_knows_it(speed_mps: float) -> None:
    stage = stage_with(driver=steady(speed_mps), length_m=60.0)
    play(EgoArrives(), stage, until_s=200.0)
    left_m = 60.0 - stage.ego_s_m
    assert left_m > path_following.AT_END_M or left_m + speed_mps * stage.step_s > path_following.AT_END_M


def test_an_ego_that_parks_near_the_end_has_arrived_as_the_run_has_it() -> None:
    assert min(along_route.SLACK_M, along_route.SLACK_MPS) >= 0.0
    stage = stage_with(driver=waiting_at(56.5, 100.0, 8.0), length_m=60.0)
    play(EgoArrives(), stage)
    assert 3.0 < 60.0 - stage.ego_s_m <= path_following.PARKED_M


def test_a_trigger_that_waits_again_has_nothing_to_say() -> None:
    trigger, stage = Elapsed(1.0), stage_with()
    play(trigger, stage)
    assert trigger.feedback_message
    trigger.stop(Status.INVALID)
    stage = stage_with()
    trigger.setup(stage=stage)
    trigger.tick_once()
    assert (trigger.status, trigger.feedback_message) == (Status.RUNNING, "")
