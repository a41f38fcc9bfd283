"""Claims about lanes: beyond them by half a metre, in a wrong one, against one; by length of the driven path."""

import numpy as np
import pytest

from basu.metrics.lanes import FORGIVEN_M, Where, outside_lanes, wrong_way
from basu.records.history import History
from fakes.drives import at, driven, straight_route

SIDEWALK, DRIVING, PARKING = 32, 2, 256
ROUTE = straight_route(1000.0)


def along(seconds: float = 20.0, speed_mps: float = 10.0) -> History:
    """A steady drive in its lane."""
    return driven(at(speed_mps, seconds), route=ROUTE)


def test_a_drive_in_its_lane_is_outside_of_none() -> None:
    history = along()
    assert outside_lanes(history).total.metres == 0.0
    assert outside_lanes(history).total.events == ()
    assert wrong_way(history).share == 0.0


def test_the_share_is_of_the_driven_path() -> None:
    history = along()
    history.frames["off_lane_m"][100:200] = 0.6
    found = outside_lanes(history)
    assert found.total.metres == pytest.approx(50.0)
    assert found.total.share == pytest.approx(50.0 / 199.5)
    assert found.total.seconds == pytest.approx(5.0)
    assert found.metres_by_where[Where.OFF_ROAD] == pytest.approx(50.0)


def test_half_a_metre_beyond_the_edge_is_allowed() -> None:
    history = along()
    history.frames["off_lane_m"] = 0.5
    assert outside_lanes(history).total.metres == 0.0


def test_on_a_pavement_is_reported_as_such_with_its_place() -> None:
    history = along()
    history.frames["off_lane_m"][100:140] = 1.0
    history.frames["lane_type"][100:140] = SIDEWALK
    (event,) = outside_lanes(history).total.events
    assert event.kind.value == "outside_lanes"
    assert (event.tick, event.x_m) == (100, pytest.approx(50.0))
    assert event.detail == "on the pavement for 20.0 m and 2.0 s"


def test_a_parking_lane_is_a_lane() -> None:
    history = along()
    history.frames["lane_type"] = PARKING
    assert outside_lanes(history).total.metres == 0.0


def test_an_oncoming_lane_is_a_wrong_one_and_driving_on_it_the_wrong_way() -> None:
    history = along()
    history.frames["lane_heading_rad"][200:300] = np.pi
    outside = outside_lanes(history)
    assert outside.metres_by_where[Where.WRONG_LANE] == pytest.approx(50.0)
    assert outside.total.events[0].detail.startswith("in a wrong lane for 50.0 m")
    assert wrong_way(history).metres == pytest.approx(50.0)
    assert wrong_way(history).events[0].detail == "against the direction of its lane for 50.0 m and 5.0 s"


def test_in_a_junction_no_lane_is_wrong() -> None:
    history = along()
    history.frames["lane_heading_rad"][200:300] = np.pi
    history.frames["in_junction"][200:300] = 1
    assert outside_lanes(history).total.metres == 0.0
    assert wrong_way(history).metres == 0.0


def test_reversing_along_ones_own_lane_is_the_wrong_way_in_the_right_lane() -> None:
    history = driven([*at(5.0, 4.0), *at(-2.0, 4.0)], route=ROUTE)
    assert outside_lanes(history).total.metres == 0.0
    assert wrong_way(history).metres == pytest.approx(8.0, abs=0.3)


def test_two_metres_backwards_are_forgiven() -> None:
    history = driven([*at(5.0, 4.0), *at(-1.0, FORGIVEN_M - 0.5)], route=ROUTE)
    assert wrong_way(history).metres == 0.0


def test_standing_across_is_not_driving_the_wrong_way() -> None:
    history = along(speed_mps=0.0)
    history.frames["lane_heading_rad"] = np.pi
    assert wrong_way(history).seconds == 0.0


def test_where_there_is_no_lane_there_is_no_direction() -> None:
    history = along()
    history.frames["lane_type"] = 0
    history.frames["lane_heading_rad"] = np.nan
    history.frames["off_lane_m"] = np.inf
    assert wrong_way(history).metres == 0.0
    assert outside_lanes(history).total.share == pytest.approx(1.0)
