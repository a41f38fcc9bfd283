"""Tests of ``basu.metrics.leaderboard.infractions``."""

import math
from dataclasses import replace

import carla
import numpy as np
import pytest

from basu.managers.base_manager import Ego
from basu.managers.observations import lane_under
from basu.metrics.leaderboard.infractions import collisions, in_wrong_lane, outside_lanes, too_slow
from basu.metrics.leaderboard.rules import Kind, Version
from basu.records.history import OTHER, Collision, History
from fakes.crossing_map import crossing
from fakes.drives import STEP_S, at, driven, hit, straight_route

CAR, FENCE = "vehicle.audi.tt", "static.fence"
V1, V2 = Version.V1_0, Version.V2_0


def ticks(history: History, version: Version) -> list[int]:
    return [event.tick for event in collisions(history, version)]


def drive(*contacts: Collision, speed_mps: float = 6.0) -> History:
    return driven(at(speed_mps, 25.0), route=straight_route(400.0), collisions=contacts)


@pytest.mark.parametrize(
    ("other", "kind"),
    [
        ("walker.pedestrian.0001", Kind.COLLISION_PEDESTRIAN),
        (CAR, Kind.COLLISION_VEHICLE),
        (FENCE, Kind.COLLISION_STATIC),
        ("traffic.stop", Kind.COLLISION_STATIC),
    ],
)
def test_what_was_hit_decides_the_kind(other: str, kind: Kind) -> None:
    assert [event.kind for event in collisions(drive(hit(50, other, 4)), V1)] == [kind]


@pytest.mark.parametrize("version", [V1, V2])
def test_a_pavement_is_no_collision(version: Version) -> None:
    assert ticks(drive(hit(50, "static.sidewalk")), version) == []


def test_in_version_2_a_pavement_hides_the_fence_behind_it() -> None:
    contacts = (hit(50, "static.sidewalk"), hit(55, FENCE))
    assert ticks(drive(*contacts), V1) == [55]
    assert ticks(drive(*contacts), V2) == []


@pytest.mark.parametrize("version", [V1, V2])
def test_one_party_counts_again_after_five_seconds(version: Version) -> None:
    contacts = [hit(tick, CAR, 7) for tick in range(50, 240)]
    assert ticks(drive(*contacts), version) == [50, 152]  # forgotten in frame 151, after its message was heard


def test_scraping_along_a_fence_counts_every_three_metres_then_every_five() -> None:
    contacts = [hit(tick, FENCE) for tick in range(50, 151)]  # 30 m at 0.31 m a tick
    assert len(ticks(drive(*contacts, speed_mps=6.2), V1)) == 11
    assert len(ticks(drive(*contacts, speed_mps=6.2), V2)) == 6


@pytest.mark.parametrize(("version", "number"), [(V1, 1), (V2, 0)])
def test_that_stands_and_is_hit_is_at_fault_in_1_0_alone(version: Version, number: int) -> None:
    assert len(ticks(drive(hit(50, CAR, 7), speed_mps=0.0), version)) == number


def test_two_parties_in_one_place_are_one_collision() -> None:
    assert ticks(drive(hit(50, CAR, 7), hit(52, CAR, 8)), V2) == [50]


def test_a_drive_without_contacts_has_no_collision() -> None:
    assert ticks(drive(), V2) == []


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


ROUTE_M = 200.0


def among(own_mps: list[float], *traffic: tuple[str, list[float]]) -> History:
    """A drive beside others, each with its type and its speed tick by tick."""
    history = driven(own_mps, route=straight_route(ROUTE_M))
    rows = [
        (tick, number, 0.0, 0.0, 0.0, 0.0, speeds[tick], 0.0)
        for tick in range(len(own_mps))
        for number, (_, speeds) in enumerate(traffic)
        if not np.isnan(speeds[tick])
    ]
    kinds = {number: kind for number, (kind, _) in enumerate(traffic)}
    return replace(history, others=np.array(rows, dtype=OTHER), facts=replace(history.facts, actor_types=kinds))


OWN = at(8.0, 25.0)


def test_alone_on_the_road_no_actor_is_too_slow() -> None:
    assert too_slow(among(OWN)) == ()


def test_slower_than_the_traffic_is_reported_for_each_quarter_with_the_share() -> None:
    found = too_slow(among(OWN, ("vehicle.audi.tt", at(10.0, 25.0))))
    assert [event.kind for event in found] == [Kind.MIN_SPEED] * 4
    assert {event.percentage for event in found} == {80.0}


def test_as_fast_as_the_mean_of_the_traffic_is_fast_enough() -> None:
    slow, fast = at(5.0, 25.0), at(10.0, 25.0)
    assert too_slow(among(OWN, ("vehicle.audi.tt", slow), ("vehicle.audi.tt", fast))) == ()


def test_quarters_are_judged_apart() -> None:
    own = [*at(5.0, 10.0), *at(15.0, 10.0)]
    found = too_slow(among(own, ("vehicle.audi.tt", at(10.0, 20.0))))
    assert [event.percentage for event in found] == [pytest.approx(50.0, abs=1.0)]


def test_a_drive_that_ends_before_its_last_twentieth_leaves_the_last_quarter_unjudged() -> None:
    assert len(too_slow(among(at(8.0, 23.0), ("vehicle.audi.tt", at(10.0, 23.0))))) == 3
    assert len(too_slow(among(at(8.0, 24.5), ("vehicle.audi.tt", at(10.0, 24.5))))) == 4


@pytest.mark.parametrize("kind", ["walker.pedestrian.0001", "vehicle.audi.tt"])
def test_walkers_and_parked_cars_are_no_traffic(kind: str) -> None:
    speeds = at(20.0, 25.0) if kind.startswith("walker") else at(0.0, 25.0)
    assert too_slow(among(OWN, (kind, speeds))) == ()


def test_actors_of_scenarios_are_no_traffic() -> None:
    history = among(OWN, ("vehicle.ford.ambulance", at(20.0, 25.0)))
    assert len(too_slow(history)) == 4
    assert too_slow(history, frozenset(history.facts.actor_types)) == ()


def test_frames_without_traffic_do_not_count() -> None:
    own = [*at(2.0, 5.0), *at(10.0, 19.0)]
    seen = [*at(float("nan"), 5.0), *at(10.0, 19.0)]
    assert too_slow(among(own, ("vehicle.audi.tt", seen))) == ()
