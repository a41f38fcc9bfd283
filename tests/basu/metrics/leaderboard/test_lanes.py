"""Claims about the leaderboard's outside lanes: its own criterion gives these shares for these drives on a map.

The shares come from running ``OutsideRouteLanesTest`` of carla-simulator/scenario_runner (branches leaderboard-1.0 and
leaderboard-2.0) on the official client's map of the crossing, along the same waves about the lane.
"""

import math

import carla
import numpy as np
import pytest

from basu.managers.base_manager import Ego
from basu.managers.lane_under import lane_under
from basu.metrics.leaderboard.lanes import in_wrong_lane, outside_lanes
from basu.metrics.leaderboard.rules import Version
from basu.records.history import History
from fakes.crossing_map import crossing
from fakes.drives import STEP_S, at, driven, straight_route

V1, V2 = Version.V1_0, Version.V2_0
SPEED_MPS, LANE_Y_M, END_M = 6.0, 1.75, 68.0  # eastwards through the crossing, the lane's middle 1.75 m to the south


@pytest.fixture(scope="module")
def town() -> carla.Map:
    return carla.Map("Crossing", crossing())


def wave(town: carla.Map, amplitude_m: float, period_m: float) -> History:
    """From end to end of the town in a sine about the lane's middle."""
    places = []
    x_m = -END_M
    while x_m <= END_M:
        phase = (x_m + END_M) / period_m
        yaw_rad = math.atan(amplitude_m / period_m * math.cos(phase))
        places.append((x_m, LANE_Y_M + amplitude_m * math.sin(phase), yaw_rad))
        x_m += SPEED_MPS * STEP_S * math.cos(yaw_rad)
    history = driven([SPEED_MPS] * len(places), route=straight_route(2.0 * END_M))
    for row, (x_m, y_m, yaw_rad) in zip(history.frames, places, strict=True):
        row["x_m"], row["y_m"], row["yaw_rad"], row["route_s_m"] = x_m, y_m, yaw_rad, x_m + END_M
        lane = lane_under(town, Ego(x_m, y_m, 0.0, 0.0, 0.0, yaw_rad, *[0.0] * 9))
        for name, value in lane._asdict().items():
            row[name] = value
    return history


@pytest.mark.parametrize(
    ("amplitude_m", "period_m", "version", "percentage"),
    [
        (3.0, 9.0, V1, 25.18),
        (3.0, 9.0, V2, 44.44),
        (-3.5, 15.0, V1, 48.15),
        (-3.5, 15.0, V2, 54.82),
        (4.5, 6.0, V1, 51.11),
        (4.5, 6.0, V2, 58.52),
    ],
)
def test_the_share_is_that_of_the_leaderboards_own_code(
    town: carla.Map, amplitude_m: float, period_m: float, version: Version, percentage: float
) -> None:
    (event,) = outside_lanes(wave(town, amplitude_m, period_m), version)
    assert event.percentage == pytest.approx(percentage, abs=0.006)


def test_a_drive_that_keeps_to_its_lane_has_no_event(town: carla.Map) -> None:
    assert outside_lanes(wave(town, 0.5, 10.0), V1) == outside_lanes(wave(town, 0.5, 10.0), V2) == ()


def changing(*lanes: tuple[int, float, int]) -> History:
    """A second on each lane: its id, the vehicle's angle to it, and whether it lies in a junction."""
    history = driven(at(5.0, float(len(lanes))), route=straight_route(400.0))
    for number, (lane_id, heading_rad, junction) in enumerate(lanes):
        rows = slice(20 * number, 20 * (number + 1))
        history.frames["lane_id"][rows] = lane_id
        history.frames["lane_heading_rad"][rows] = heading_rad
        history.frames["in_junction"][rows] = junction
    return history


def seconds_wrong(history: History, version: Version) -> list[bool]:
    wrong = in_wrong_lane(history, version)
    return [bool(wrong[first : first + 20].all()) for first in range(0, len(wrong), 20)]


def test_an_oncoming_lane_is_wrong_until_one_is_back() -> None:
    history = changing((-1, 0.0, 0), (1, np.pi, 0), (-1, 0.0, 0))
    assert seconds_wrong(history, V1) == seconds_wrong(history, V2) == [False, True, False]


def test_from_one_oncoming_lane_to_the_next_is_right_again_in_1_0_alone() -> None:
    history = changing((-1, 0.0, 0), (1, np.pi, 0), (2, np.pi, 0))
    assert seconds_wrong(history, V1) == [False, True, False]
    assert seconds_wrong(history, V2) == [False, True, True]


def test_a_junction_forgives_and_the_heading_behind_it_decides() -> None:
    history = changing((1, np.pi, 0), (-5, 0.0, 1), (1, np.pi, 0), (-5, 0.0, 1), (-1, 0.0, 0))
    assert seconds_wrong(history, V2) == [False, False, True, False, False]


def test_beside_the_road_the_last_lane_still_counts() -> None:
    history = changing((-1, 0.0, 0), (1, np.pi, 0), (1, np.pi, 0), (-1, 0.0, 0))
    history.frames["lane_type"][40:60] = 0
    history.frames["lane_heading_rad"][40:60] = np.nan
    assert seconds_wrong(history, V2) == [False, True, True, False]


def test_a_drive_beside_all_lanes_is_in_no_wrong_one() -> None:
    history = changing((0, np.nan, 0))
    history.frames["lane_type"] = 0
    assert seconds_wrong(history, V2) == [False]
