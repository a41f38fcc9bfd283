"""Claims about where the leaderboard ends a drive: arrival, the way lost, standing still, time."""

import pytest

from basu.metrics.leaderboard.ending import completion_percent, ending
from basu.metrics.leaderboard.rules import Kind, Version
from fakes.drives import at, driven, straight_route

V1, V2 = Version.V1_0, Version.V2_0


@pytest.mark.parametrize("version", list(Version))
def test_arrival_is_the_last_hundredth_of_the_route_within_ten_metres_of_its_end(version: Version) -> None:
    history = driven(at(10.0, 60.0), route=straight_route(500.0))
    end = ending(history, version)
    assert (end.arrived, end.by) == (True, None)
    assert history.frames["x_m"][end.tick] == pytest.approx(496.0, abs=0.51)


def test_a_drive_that_stops_short_is_judged_to_its_last_frame() -> None:
    history = driven(at(10.0, 10.0), route=straight_route(500.0))
    end = ending(history, V2)
    assert (end.tick, end.arrived, end.by) == (199, False, None)
    assert completion_percent(history)[-1] == pytest.approx(100.0 * 99.0 / 500.0)


def test_coming_back_takes_nothing_from_what_was_passed() -> None:
    history = driven([*at(10.0, 10.0), *at(-10.0, 5.0)], route=straight_route(500.0))
    assert completion_percent(history)[-1] == completion_percent(history)[200]


def test_thirty_metres_off_is_the_end() -> None:
    history = driven(at(10.0, 10.0), route=straight_route(500.0))
    history.frames["lateral_m"][100:] = -30.0
    assert ending(history, V1)[:] == ending(history, V2)[:] == (100, False, Kind.ROUTE_DEVIATION)


def test_fifteen_metres_off_for_more_than_thirty_per_cent_of_the_route_is_the_end() -> None:
    history = driven(at(10.0, 40.0), route=straight_route(500.0), lateral_m=20.0)
    end = ending(history, V2)
    assert end.by is Kind.ROUTE_DEVIATION
    assert history.frames["x_m"][end.tick] == pytest.approx(151.0, abs=0.6)  # the first point beyond


def test_three_minutes_at_rest_are_the_end() -> None:
    history = driven([*at(10.0, 5.0), *at(0.0, 200.0)], route=straight_route(500.0))
    end = ending(history, V1)
    assert end.by is Kind.BLOCKED
    assert history.frames["t_s"][end.tick] == pytest.approx(185.0, abs=0.11)


@pytest.mark.parametrize(
    ("version", "limit_mps", "ends_at_s"),
    [
        (V1, 10.0, 0.8 * 100.0 + 5.0),  # 85 s, by length alone
        (V2, 10.0, 300.0 + 33.0),  # a second more for each metre made at a tenth of the limit
        (V2, 0.0, 300.0),
    ],
)
def test_time_is_given_by_length_in_1_0_and_by_way_made_in_2(
    version: Version, limit_mps: float, ends_at_s: float
) -> None:
    creeping = [0.1] * 8000  # never at rest
    history = driven(creeping, route=straight_route(100.0), limit_mps=limit_mps)
    end = ending(history, version)
    assert end.by is Kind.ROUTE_TIMEOUT
    assert history.frames["t_s"][end.tick] == pytest.approx(ends_at_s, abs=1.0)
