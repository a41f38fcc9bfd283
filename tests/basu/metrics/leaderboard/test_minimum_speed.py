"""Claims about keeping up with the traffic: quarter by quarter, against those who moved, none where nobody is."""

from dataclasses import replace

import numpy as np
import pytest

from basu.metrics.leaderboard.minimum_speed import too_slow
from basu.metrics.leaderboard.rules import Kind
from basu.records.history import OTHER, History
from fakes.drives import at, driven, straight_route

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


def test_alone_on_the_road_nobody_is_too_slow() -> None:
    assert too_slow(among(OWN)) == ()


def test_slower_than_the_traffic_is_told_for_each_quarter_with_the_share() -> None:
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


def test_frames_without_traffic_do_not_count() -> None:
    own = [*at(2.0, 5.0), *at(10.0, 19.0)]
    seen = [*at(float("nan"), 5.0), *at(10.0, 19.0)]
    assert too_slow(among(own, ("vehicle.audi.tt", seen))) == ()
