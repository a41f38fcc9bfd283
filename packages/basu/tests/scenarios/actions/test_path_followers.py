"""Claims about actions that lead a vehicle: its path, its speeds, the actors it brakes for, its end."""

import math

import numpy as np
import pytest
from py_trees.common import Status

from basu.scenarios.actions import (
    Accelerate,
    Brake,
    ChangeLane,
    Drift,
    DriveAlong,
    Either,
    FollowEgo,
    Hold,
    InTurn,
    ReachAtEgosArrival,
    Remove,
    Together,
    Wait,
)
from basu.scenarios.paths import Path
from basu.scenarios.stage import EGO, ActorSpec, Pose
from basu.testing import OfflineStage, careful, steady, waiting_at
from fakes.paper import actor_at, play, stage_with

ROAD = Path.through([(0.0, 20.0), (150.0, 20.0)])  # beside the ego's, 20 m to its right
BEND = Path.through(
    [(0.0, 20.0), (30.0, 20.0)]
    + [(30.0 + 12.0 * math.sin(a), 32.0 - 12.0 * math.cos(a)) for a in np.linspace(0.0, math.pi / 2.0, 20)]
    + [(42.0, 80.0)]
)


def parked(y_m: float = 20.0, x_m: float = 0.0, speed_mps: float = 0.0) -> ActorSpec:
    return actor_at(x_m, y_m, speed_mps=speed_mps)


@pytest.mark.parametrize("turn_share", [1.0, 0.5])
def test_a_bend_is_followed_to_a_hands_breadth_with_the_nose_ahead(turn_share: float) -> None:
    # a simulated vehicle turns by half of its command; the feedback has to make up for it
    stage = stage_with(parked(), turn_share=turn_share)
    off_m, off_rad = [], []

    def watch(stage: OfflineStage) -> None:
        body = stage.body("other")
        near = BEND.nearest(body.x_m, body.y_m)
        off_m.append(near.distance_m)
        off_rad.append(abs(math.remainder(body.yaw_rad - BEND.heading_rad(near.s_m), math.tau)))

    play(DriveAlong("other", BEND, 8.0), stage, watch=watch)
    assert max(off_m) < 0.15
    assert max(off_rad) < math.radians(8.0)


def test_speed_rises_and_falls_within_the_limits_and_it_holds_at_the_end() -> None:
    speeds: list[float] = []
    drive = DriveAlong("other", ROAD, 10.0, accelerate_mps2=2.0, brake_mps2=4.0)
    stage = stage_with(parked())
    play(drive, stage, watch=lambda stage: speeds.append(stage.body("other").forward_mps))
    change = np.diff(speeds) / stage.step_s
    assert max(speeds) == pytest.approx(10.0)
    assert change.max() == pytest.approx(2.0, abs=0.01)
    assert change.min() >= -4.01
    for _ in range(20):
        stage.advance()
    body = stage.body("other")
    assert body.speed_mps == 0.0
    assert body.x_m == pytest.approx(150.0, abs=0.5)
    assert "150 m driven" in drive.feedback_message


def test_an_actor_that_is_already_rolling_goes_on_at_its_speed() -> None:
    stage = stage_with(parked(speed_mps=8.0))
    least: list[float] = []
    drive = DriveAlong("other", ROAD, 8.0, at_end="go on")
    assert play(drive, stage, watch=lambda s: least.append(s.body("other").speed_mps)) == pytest.approx(18.75, abs=0.06)
    assert min(least) == pytest.approx(8.0)


def test_a_profile_of_speeds_is_kept_along_the_path() -> None:
    stage = stage_with(parked(speed_mps=10.0))
    at: dict[int, float] = {}

    def watch(stage: OfflineStage) -> None:
        body = stage.body("other")
        at[round(body.x_m)] = body.speed_mps

    play(DriveAlong("other", ROAD, ((0.0, 10.0), (40.0, 10.0), (80.0, 4.0)), at_end="go on"), stage, watch=watch)
    assert at[40] == pytest.approx(10.0, abs=0.1)
    assert at[60] == pytest.approx(7.0, abs=0.2)
    assert at[120] == pytest.approx(4.0, abs=0.05)


def test_bends_are_slowed_down_for_before_they_begin() -> None:
    # a radius of 12 m at 3 m/s² sideways: 6 m/s
    stage, sideways = stage_with(parked(speed_mps=12.0)), []

    def watch(stage: OfflineStage) -> None:
        body = stage.body("other")
        near = BEND.nearest(body.x_m, body.y_m)
        if 32.0 < near.s_m < 46.0:
            sideways.append(body.speed_mps**2 / 12.0)

    play(DriveAlong("other", BEND, 12.0, bends_mps2=3.0, at_end="go on"), stage, watch=watch)
    assert 2.5 < max(sideways) < 3.4
    assert stage.body("other").speed_mps > 10.0


def test_the_three_ends_of_a_drive() -> None:
    rolling = stage_with(parked(speed_mps=5.0))
    play(DriveAlong("other", BEND, 5.0, at_end="go on"), rolling)
    before = rolling.body("other")
    for _ in range(20):
        rolling.advance()
    after = rolling.body("other")
    assert after.y_m - before.y_m == pytest.approx(5.0, abs=0.05)  # straight on, to the south
    assert after.yaw_rad == before.yaw_rad
    gone = stage_with(parked(speed_mps=5.0))
    play(DriveAlong("other", ROAD, 5.0, at_end="vanish"), gone)
    assert gone.names == (EGO,)


def test_a_drive_may_end_before_its_path_does() -> None:
    stage = stage_with(parked(speed_mps=5.0))
    assert play(DriveAlong("other", ROAD, 5.0, to_m=50.0, at_end="go on"), stage) == pytest.approx(10.0, abs=0.06)


def test_one_action_takes_over_from_another_in_the_same_frame() -> None:
    speeds: list[float] = []
    steps = InTurn(DriveAlong("other", ROAD, 6.0, to_m=30.0, at_end="go on"), DriveAlong("other", ROAD, 6.0))
    play(steps, stage_with(parked(speed_mps=6.0)), watch=lambda s: speeds.append(s.body("other").speed_mps))
    assert np.abs(np.diff(speeds[:400])).max() < 0.01


def test_an_actor_that_is_broken_off_holds_if_that_was_its_end() -> None:
    stage = stage_with(parked(speed_mps=6.0))
    play(Either(DriveAlong("other", ROAD, 6.0), Wait(2.0)), stage)
    for _ in range(30):
        stage.advance()
    assert stage.body("other").speed_mps == 0.0


def test_the_considerate_stop_behind_an_ego_that_stands_and_others_ram_it() -> None:
    lane = Path.through([(-40.0, 0.0), (150.0, 0.0)])

    def behind() -> OfflineStage:
        return stage_with(actor_at(-40.0, speed_mps=8.0), driver=waiting_at(30.0, 20.0, 6.0))

    considerate, ruthless = behind(), behind()
    with pytest.raises(AssertionError, match="not done"):
        play(DriveAlong("other", lane, 8.0, considerate=True), considerate, until_s=20.0)
    assert not considerate.ego_contacts
    gap_m = considerate.ego.x_m - considerate.body("other").x_m - 4.3
    assert 1.0 < gap_m < 4.0
    drive = DriveAlong("other", lane, 8.0)
    play(drive, ruthless)
    assert ruthless.ego_contacts == {"other"}
    assert drive.feedback_message.startswith("touched by the ego")
    assert ruthless.commands[-1].what == "let go"


def test_the_considerate_brake_for_an_ego_across_their_path_and_go_on_behind_it() -> None:
    lane = Path.through([(60.0, 90.0), (60.0, -60.0)])
    stage = stage_with(actor_at(60.0, 90.0, -math.pi / 2.0, speed_mps=8.0), driver=waiting_at(60.0, 4.0, 10.0))
    done_s = play(DriveAlong("other", lane, 8.0, considerate=True, at_end="go on"), stage)
    assert not stage.ego_contacts
    assert done_s > 150.0 / 8.0 + 2.0  # it stood while the ego did


def test_a_minded_actor_may_be_another_one() -> None:
    third = ActorSpec("third", "vehicle.audi.a2", Pose(80.0, 20.0))
    stage = stage_with(parked(speed_mps=8.0), third)
    with pytest.raises(AssertionError, match="not done"):
        play(DriveAlong("other", ROAD, 8.0, minds=("third",)), stage, until_s=25.0)
    assert 70.0 < stage.body("other").x_m < 74.5


def test_a_minded_actor_may_vanish_before_it() -> None:
    third = ActorSpec("third", "vehicle.audi.a2", Pose(20.0, 20.0), speed_mps=4.0)
    stage = stage_with(parked(speed_mps=4.0), third)
    row = Together(
        DriveAlong("third", ROAD, 4.0, to_m=60.0, at_end="vanish"), DriveAlong("other", ROAD, 8.0, minds=("third",))
    )
    play(row, stage)
    assert stage.names == ("other", EGO)


def test_an_actor_that_is_removed_by_others_is_left_alone() -> None:
    stage = stage_with(parked(speed_mps=4.0))
    play(Either(DriveAlong("other", ROAD, 4.0), InTurn(Wait(1.0), Remove("other"))), stage)
    assert stage.names == (EGO,)


def test_braking_and_accelerating_take_the_distance_that_mechanics_has() -> None:
    stage = stage_with(parked(speed_mps=10.0))
    brake = Brake("other", at_mps2=5.0)
    assert play(brake, stage) == pytest.approx(2.05, abs=0.11)
    assert stage.body("other").x_m == pytest.approx(10.0, abs=0.4)
    stage = stage_with(parked())
    assert play(Accelerate("other", 8.0, 4.0), stage) == pytest.approx(2.05, abs=0.11)
    assert (brake.name, brake.feedback_message) == ("other brakes at 5 m/s²", "at 0.0 m/s")


def test_braking_in_a_bend_keeps_to_the_bend() -> None:
    stage = stage_with(parked(speed_mps=10.0))
    play(InTurn(DriveAlong("other", BEND, 10.0, to_m=33.0, at_end="go on"), Brake("other", 2.0, 4.0, BEND)), stage)
    body = stage.body("other")
    assert BEND.nearest(body.x_m, body.y_m).distance_m < 0.15
    assert body.speed_mps == pytest.approx(2.0)


def test_an_actor_that_is_held_stays() -> None:
    stage = stage_with(parked())
    assert play(Hold("other", 3.0), stage) == pytest.approx(3.0, abs=0.06)
    assert stage.body("other").x_m == 0.0


@pytest.mark.parametrize("offset_s", [-1.0, 0.0, 2.0])
@pytest.mark.parametrize("ego_mps", [4.0, 6.0, 12.0])
def test_the_meeting_is_met_whatever_the_egos_speed(ego_mps: float, offset_s: float) -> None:
    crossing = Path.through([(170.0, 80.0), (170.0, -60.0)])  # they do not touch
    stage = stage_with(actor_at(170.0, 80.0, -math.pi / 2.0), driver=steady(ego_mps))
    there_s = play(ReachAtEgosArrival("other", crossing, 80.0, 120.0, offset_s, high_mps=15.0), stage)
    assert there_s == pytest.approx(120.0 / ego_mps + offset_s, abs=0.15)


def test_an_actor_that_waits_for_an_ego_that_slows_down_slows_down_too_and_settles_before_the_point() -> None:
    crossing = Path.through([(170.0, 80.0), (170.0, -60.0)])  # they do not touch
    stage = stage_with(actor_at(170.0, 80.0, -math.pi / 2.0), driver=lambda stage: 8.0 if stage.ego_s_m < 80.0 else 4.0)
    last: list[float] = []
    meet = ReachAtEgosArrival("other", crossing, 80.0, 120.0, settled_s=1.0)
    there_s = play(meet, stage, watch=lambda s: last.append(s.body("other").speed_mps))
    assert there_s == pytest.approx(20.0, abs=0.3)
    assert np.ptp(last[-18:]) < 1e-9
    assert "the ego 0." in meet.feedback_message


def test_the_low_speed_takes_it_through_before_an_ego_that_never_comes() -> None:
    crossing = Path.through([(120.0, 40.0), (120.0, -60.0)])
    stage = stage_with(actor_at(120.0, 40.0, -math.pi / 2.0), driver=steady(0.0))
    assert play(ReachAtEgosArrival("other", crossing, 40.0, 120.0, low_mps=2.0), stage) < 21.0


def test_a_lane_change_ends_in_the_other_lane_heading_along_it() -> None:
    lane = Path.through([(0.0, 0.0), (150.0, 0.0)])
    stage = stage_with(actor_at(10.0, 3.5, speed_mps=10.0), driver=steady(0.0))
    change = ChangeLane("other", lane, over_m=30.0)
    assert play(change, stage) == pytest.approx(3.0, abs=0.15)
    body = stage.body("other")
    assert body.y_m == pytest.approx(0.0, abs=0.1)
    assert abs(body.yaw_rad) < math.radians(1.5)
    assert body.speed_mps == pytest.approx(10.0, abs=0.1)
    assert change.feedback_message == "3.5 m to the left"


def test_a_cut_in_may_change_speed_on_the_way() -> None:
    lane = Path.through([(0.0, 0.0), (150.0, 0.0)])
    stage = stage_with(actor_at(10.0, 3.5, speed_mps=10.0), driver=steady(0.0))
    play(ChangeLane("other", lane, over_s=4.0, speed_mps=6.0), stage)
    assert stage.body("other").speed_mps == pytest.approx(6.0)


def test_a_drift_goes_sideways_as_slowly_as_commanded() -> None:
    lane = Path.through([(150.0, -3.5), (0.0, -3.5)])  # towards the ego; the ego's lane is on its left
    stage = stage_with(actor_at(150.0, -3.5, math.pi, speed_mps=8.0), driver=steady(0.0))
    y_m: list[float] = []
    done_s = play(Drift("other", lane, -2.0, 0.5), stage, watch=lambda s: y_m.append(s.body("other").y_m))
    assert done_s == pytest.approx(4.0, abs=0.2)
    assert stage.body("other").y_m == pytest.approx(-1.5, abs=0.1)
    assert np.abs(np.diff(y_m)).max() / stage.step_s < 1.0  # twice the mean at the quintic's steepest


def test_a_tailgater_keeps_its_gap_and_a_slow_one_runs_into_a_sudden_stop() -> None:
    lane = Path.through([(-60.0, 0.0), (150.0, 0.0)])

    def sudden(stage: OfflineStage) -> float:
        return 7.0 if stage.time_s < 10.0 else 0.0

    attentive = stage_with(actor_at(-14.0, speed_mps=7.0), driver=sudden)
    play(FollowEgo("other", lane, 8.0, 9.5), attentive)
    assert attentive.ego.x_m - attentive.body("other").x_m - 4.3 == pytest.approx(8.0, abs=0.3)
    slow = stage_with(actor_at(-9.0, speed_mps=7.0), driver=sudden)
    play(FollowEgo("other", lane, 3.0, 15.0, reaction_s=1.0), slow)
    assert slow.ego_contacts == {"other"}


def test_a_careful_ego_stops_behind_one_that_brakes_and_a_steady_one_does_not() -> None:
    lane = Path.through([(0.0, 0.0), (150.0, 0.0)])
    for driver, touched in ((careful(7.0), frozenset()), (steady(7.0), frozenset({"other"}))):
        stage = stage_with(actor_at(15.0, speed_mps=7.0), driver=driver)
        play(InTurn(DriveAlong("other", lane, 7.0, to_m=50.0, at_end="go on"), Brake("other"), Wait(6.0)), stage)
        assert stage.ego_contacts == touched


def test_a_drive_that_begins_again_goes_on_from_where_it_is() -> None:
    drive, stage = DriveAlong("other", ROAD, 6.0), stage_with(parked(speed_mps=6.0))
    play(Either(drive, Wait(5.0)), stage)
    drive.setup(stage=stage)
    drive.tick_once()
    assert drive.status == Status.RUNNING
    assert drive.s_m == pytest.approx(30.0, abs=0.1)
