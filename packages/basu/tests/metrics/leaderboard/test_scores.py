"""Claims about the leaderboard's scores of a record: computed by hand, cut where it would have ended it, candid."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from basu.metrics.leaderboard import Kind, LeaderboardScores, Version, leaderboard_scores
from basu.records.history import OTHER, History
from fakes.drives import at, driven, hit, stop_sign, straight_route, traffic_light

CAR = "vehicle.audi.tt"


def by_version(history: History) -> dict[Version, LeaderboardScores]:
    return {scores.version: scores for scores in leaderboard_scores(history)}


def test_a_clean_drive_to_the_end_is_a_hundred_in_all() -> None:
    for scores in leaderboard_scores(driven(at(10.0, 20.0))):
        assert (scores.driving, scores.route_completion, scores.infraction_penalty) == (100.0, 100.0, 1.0)
        assert scores.events == ()
        assert scores.ended_by is None


def full_of_events() -> History:
    """A car hit, a stop sign and a red light run, and a tenth of the way on the pavement; then the end of the route."""
    route = straight_route(500.0, controls=(stop_sign(100.0), traffic_light(200.0)))
    history = driven(at(10.0, 50.0), route=route, collisions=[hit(100, CAR, 7)])
    history.frames["route_light"] = 0
    history.frames["off_lane_m"][600:699] = 2.0
    return history


def test_the_figures_of_a_drive_full_of_events_are_those_computed_by_hand() -> None:
    scores = by_version(full_of_events())
    share = 50 / 496  # points of the plan passed; it arrives, for the leaderboard, four metres before the end
    product = 0.6 * 0.8 * 0.7 * (1.0 - share)
    assert scores[Version.V1_0].infraction_penalty == pytest.approx(product)
    assert scores[Version.V2_0].driving == pytest.approx(100.0 * product)
    points = 0.7 + 0.25 + 0.4
    assert scores[Version.V2_1].infraction_penalty == pytest.approx((1.0 - share) / (1.0 + points))
    for found in scores.values():
        kinds = [event.kind for event in found.events]
        assert kinds == [Kind.COLLISION_VEHICLE, Kind.STOP, Kind.RED_LIGHT, Kind.OUTSIDE_LANES]
        assert all(a.tick <= b.tick for a, b in pairwise(found.events))


def test_what_happens_after_the_leaderboards_end_is_not_counted() -> None:
    history = driven([*at(10.0, 10.0), *at(0.0, 190.0)], route=straight_route(500.0), collisions=[hit(3990, CAR, 7)])
    for scores in leaderboard_scores(history):
        assert scores.ended_by is Kind.BLOCKED
        assert [event.kind for event in scores.events] == [Kind.BLOCKED]
        assert scores.infraction_penalty == 1.0
        assert scores.route_completion == pytest.approx(20.0)


def test_a_run_broken_off_has_the_share_of_the_route_that_it_passed() -> None:
    scores = by_version(driven(at(10.0, 10.0), route=straight_route(300.0)))
    assert scores[Version.V1_0].route_completion == pytest.approx(33.0)
    assert scores[Version.V2_1].driving == pytest.approx(33.0)


@pytest.mark.parametrize(("standing", "completion"), [(True, 100.0), (False, 95.0)])
def test_a_short_route_is_complete_where_the_benchmark_ends_it(standing: bool, completion: float) -> None:  # noqa: FBT001 - a parameter
    speeds_mps = [*at(10.0, 5.7), *at(0.0, 1.0)] if standing else at(10.0, 5.75)
    scores = leaderboard_scores(driven(speeds_mps, route=straight_route(60.0)))
    assert [found.route_completion for found in scores] == pytest.approx([completion] * 3)


def test_what_needs_scenarios_is_named_as_not_measured() -> None:
    scores = by_version(driven(at(10.0, 20.0)))
    assert scores[Version.V1_0].not_measured == ()
    assert scores[Version.V2_0].not_measured == (Kind.SCENARIO_TIMEOUT, Kind.YIELD_EMERGENCY)


def test_keeping_up_with_traffic_is_required_from_2_0_on() -> None:
    history = driven(at(8.0, 25.0))
    rows = [(tick, 9, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0) for tick in range(500)]
    scores = by_version(replace(history, others=np.array(rows, dtype=OTHER)))
    assert scores[Version.V1_0].driving == 100.0
    assert scores[Version.V2_0].infraction_penalty == pytest.approx((1.0 - 0.3 * 0.2) ** 4)
    assert scores[Version.V2_1].infraction_penalty == pytest.approx(1.0 / (1.0 + 4 * 0.4 * 0.2))
