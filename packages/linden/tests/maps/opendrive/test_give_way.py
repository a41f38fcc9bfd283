"""Whom a sign lets go first: squares on the ways that cross, on a crossing of four streets with a sign on each."""

import numpy as np
import pytest
from numpy.typing import NDArray

from fakes.crossing_map import LANE_M, REACH_M, crossing
from linden.maps.opendrive.give_way import COVERED_WIDTHS, give_way_areas
from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.signals import place


def areas(text: str) -> tuple[NDArray[np.void], list[str]]:
    opendrive = parse(text)
    placed = place(opendrive)
    return give_way_areas(opendrive, placed), [signal.signal_id for signal in placed]


@pytest.fixture(params=[1, 3], ids=["one section", "three sections"])
def squares(request: pytest.FixtureRequest) -> dict[str, NDArray[np.void]]:
    found, ids = areas(crossing(request.param))
    return {signal_id: found[found["signal"] == nth] for nth, signal_id in enumerate(ids)}


def test_every_sign_at_a_crossing_has_traffic_to_give_way_to(squares: dict[str, NDArray[np.void]]) -> None:
    assert sorted(squares) == ["100", "101", "102", "103"]
    assert all(len(own) for own in squares.values())


def test_squares_cover_the_middle_of_the_lanes(squares: dict[str, NDArray[np.void]]) -> None:
    for own in squares.values():
        assert own["half_m"] == pytest.approx(COVERED_WIDTHS * LANE_M / 2.0)
        assert (np.abs(own["centre_m"][:, :2]) <= REACH_M + 0.1).all()


def test_the_way_straight_across_is_covered_without_a_gap(squares: dict[str, NDArray[np.void]]) -> None:
    # from the east (sign 100): the lane from south to north lies at x = half a lane, in CARLA's frame as in OpenDRIVE's
    own = squares["100"]
    column = own[np.abs(own["centre_m"][:, 0] - LANE_M / 2.0) < 0.01]
    y_m = np.sort(column["centre_m"][:, 1])
    assert y_m[0] - own["half_m"][0] < -REACH_M + 0.5
    assert y_m[-1] + own["half_m"][0] > REACH_M - 0.5
    assert np.diff(y_m).max() <= 2.0 * own["half_m"][0] + 0.5


def test_nothing_that_comes_out_of_ones_own_street_is_in_the_way(squares: dict[str, NDArray[np.void]]) -> None:
    # the lane into the crossing from the east lies at y = -1.75 in CARLA's frame (north of the middle)
    own = squares["100"]
    at_entry = (own["centre_m"][:, 0] > REACH_M - 1.0) & (np.abs(own["centre_m"][:, 1] + LANE_M / 2.0) < 0.5)
    assert not at_entry.any()


def test_before_the_crossing_only_those_without_a_sign_count() -> None:
    found, ids = areas(crossing().replace('type="206"', 'type="274"'))  # no stop sign from the north and the south
    own = found[found["signal"] == ids.index("100")]
    assert (np.abs(own["centre_m"][:, 1]) > REACH_M).any()
    guarded, ids = areas(crossing())
    own = guarded[guarded["signal"] == ids.index("100")]
    assert not (np.abs(own["centre_m"][:, :2]) > REACH_M).any()


def test_a_map_without_signs_has_none() -> None:
    found, _ = areas(crossing().replace('type="206"', 'type="274"').replace('type="205"', 'type="274"'))
    assert len(found) == 0
