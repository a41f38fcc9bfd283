"""Claims about noticing who is close behind, and what is done about it."""

import numpy as np
import pytest

from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL, Manner
from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.passing.pulling_over import FORGOTTEN_S, NOTICED_S, Tailgating
from basu.agents.builtin.scene import ActorKind, DrivenVehicle, Other
from driving_plant import SHUTTLE_BODY, Log, Plant, body_at, drive, line, make_behavioral, make_route

POINTS_M = line(200.0)
PATH = make_path(POINTS_M, POINTS_M[:, 0])


def notices(behind: Other | None, seconds: float, *, tailgating: Tailgating | None = None, from_s: float = 0.0) -> bool:
    """After that long at 6 m/s with an actor that keeps its place behind us."""
    tailgating = tailgating or Tailgating(SHUTTLE_BODY, 1.0)
    place = PATH.find(100.0, 0.0, 0.0)
    for k in range(round(seconds / 0.05) + 1):
        ego = DrivenVehicle(from_s + 0.05 * k, 100.0, 0.0, 0.0, 6.0)
        tailgating.step(ego, PATH, place, [] if behind is None else [behind])
    return tailgating.is_on


def follower(gap_m: float, y_m: float = 0.0, yaw_deg: float = 0.0) -> Other:
    velocity = (6.0 * np.cos(np.radians(yaw_deg)), 6.0 * np.sin(np.radians(yaw_deg)))
    return body_at(
        ActorKind.VEHICLE, 100.0 - SHUTTLE_BODY.rear_m - 2.2 - gap_m, y_m, velocity_mps=velocity, yaw_deg=yaw_deg
    )


def test_an_actor_that_stays_close_is_noticed_after_a_moment_and_forgotten_after_another() -> None:
    tailgating = Tailgating(SHUTTLE_BODY, 1.0)
    assert not notices(follower(4.0), NOTICED_S - 0.1, tailgating=tailgating)
    assert notices(follower(4.0), 0.5, tailgating=tailgating, from_s=NOTICED_S)
    assert notices(None, FORGOTTEN_S - 0.1, tailgating=tailgating, from_s=10.0)
    assert not notices(None, 0.5, tailgating=tailgating, from_s=10.0 + FORGOTTEN_S)


@pytest.mark.parametrize(
    "behind", [follower(6.5), follower(4.0, y_m=-3.2), follower(4.0, yaw_deg=180.0), follower(-30.0)]
)
def test_an_actor_that_keeps_off_drives_elsewhere_comes_towards_us_or_is_ahead_is_not_meant(behind: Other) -> None:
    assert not notices(behind, 5.0)


def drive_before(
    manner: Manner, gap_m: float, *, cap_mps: float = 9.0, limit_mps: float = 8.0, right_lane_m: float = 0.0
) -> Log:
    """With a car that keeps that far behind all the time."""
    plant = Plant(0.0, 0.0, 0.0)

    def behind(_time_s: float) -> list[Other]:
        x_m = plant.x_m - SHUTTLE_BODY.rear_m - 2.2 - gap_m
        return [body_at(ActorKind.VEHICLE, x_m, 0.0, velocity_mps=(plant.speed_mps, 0.0))]

    driver = make_behavioral(
        make_route(line(260.0), limit_mps=limit_mps), manner, cap_mps=cap_mps, right_lane_m=right_lane_m
    )
    return drive(driver, plant, 60.0, behind)


def test_the_cautious_one_speeds_up_a_little_and_stays_within_the_limit() -> None:
    hurried, calm = drive_before(CAUTIOUS, 3.0), drive_before(CAUTIOUS, 30.0)
    assert calm.speed_mps.max() == pytest.approx(8.0 + CAUTIOUS.above_limit_mps, abs=0.1)
    assert hurried.speed_mps.max() == pytest.approx(calm.speed_mps.max() + 1.0, abs=0.1)
    assert hurried.speed_mps.max() < 8.0


def test_the_normal_one_is_at_the_limit_already_and_brakes_more_softly() -> None:
    hurried, calm = drive_before(NORMAL, 3.0), drive_before(NORMAL, 30.0)
    assert hurried.speed_mps.max() == pytest.approx(calm.speed_mps.max(), abs=0.05)
    assert -hurried.accel_mps2[hurried.speed_mps[1:] > 3.0].min() < 0.8 < -calm.accel_mps2.min()


def test_the_aggressive_one_does_not_care() -> None:
    close, far = drive_before(AGGRESSIVE, 3.0), drive_before(AGGRESSIVE, 30.0)
    assert np.array_equal(close.speed_mps, far.speed_mps)


def test_the_vehicles_own_top_speed_is_not_exceeded() -> None:
    log = drive_before(CAUTIOUS, 3.0, cap_mps=6.0, limit_mps=11.2)
    assert log.speed_mps.max() < 6.2


@pytest.mark.parametrize("passes_s", [6.0, 25.0])
def test_where_a_lane_leads_the_same_way_one_moves_over_and_comes_back_when_the_other_is_past(passes_s: float) -> None:
    plant = Plant(0.0, 0.0, 0.0)
    at: list[float] = [-7.0, 0.0, 0.0]  # where it is, how fast, and since when we are out of its way

    def behind(time_s: float) -> list[Other]:
        gap_m = plant.x_m - SHUTTLE_BODY.rear_m - 2.2 - at[0]
        at[2] = at[2] or (time_s if plant.y_m > 2.9 else 0.0)
        hurries = at[2] and time_s > at[2] + passes_s - 5.0
        at[1] = min(at[1] + 0.1, 9.0) if hurries else max(0.0, plant.speed_mps + 0.5 * (gap_m - 3.0))
        at[0] += at[1] * 0.05
        gaps.append(max(abs(at[0] - plant.x_m) - 4.21, abs(plant.y_m) - 1.95))
        return [body_at(ActorKind.VEHICLE, at[0], 0.0, velocity_mps=(at[1], 0.0))]

    gaps: list[float] = []
    driver = make_behavioral(make_route(line(500.0)), right_lane_m=3.2)
    log = drive(driver, plant, 75.0, behind)
    assert log.y_m.max() == pytest.approx(3.2, abs=0.1)
    assert abs(log.y_m[-1]) < 0.1
    assert at[0] > plant.x_m  # it is past
    assert min(gaps[20:]) > 0.5


def test_a_lane_that_is_taken_is_left_alone() -> None:
    plant = Plant(0.0, 0.0, 0.0)

    def others(_time_s: float) -> list[Other]:
        x_m = plant.x_m - SHUTTLE_BODY.rear_m - 2.2 - 3.0
        velocity = (plant.speed_mps, 0.0)
        beside = body_at(ActorKind.VEHICLE, plant.x_m, 3.2, velocity_mps=velocity, number=8)
        return [body_at(ActorKind.VEHICLE, x_m, 0.0, velocity_mps=velocity), beside]

    log = drive(make_behavioral(make_route(line(300.0)), right_lane_m=3.2), plant, 30.0, others)
    assert np.abs(log.y_m).max() < 0.1
