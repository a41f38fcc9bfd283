"""Claims about the leaderboard's penalties: its own code gives these figures for these events.

The figures come from running ``StatisticsManager`` of carla-simulator/leaderboard (branches leaderboard-1.0, -2.0 and
-2.1) on each list of events; it rounds to six digits. On 600 random lists the two agreed to half of the last one.
"""

import pytest

from basu.metrics.leaderboard.rules import FACTORS, POINTS, Kind, LeaderboardEvent, Version, penalty

Happened = list[tuple[str, float | None]]
NOTHING: Happened = []
FENCE: Happened = [("collisions_layout", None)]
THREE: Happened = [("collisions_vehicle", None), ("red_light", None), ("stop_infraction", None)]
PEOPLE: Happened = [("collisions_pedestrian", None), ("collisions_pedestrian", None), ("outside_route_lanes", 12.5)]
SLOW: Happened = [("min_speed_infractions", 88.1)]
MANY: Happened = [
    ("min_speed_infractions", 40.0),
    ("min_speed_infractions", 75.5),
    ("outside_route_lanes", 3.2),
    ("collisions_layout", None),
    ("stop_infraction", None),
]
SCENARIOS: Happened = [("scenario_timeouts", None), ("yield_emergency_vehicle_infractions", None)]


@pytest.mark.parametrize(
    ("version", "happened", "expected"),
    [
        *((version, NOTHING, 1.0) for version in ("1.0", "2.0", "2.1")),
        ("1.0", FENCE, 0.65),
        ("2.0", FENCE, 0.65),
        ("2.1", FENCE, 0.625),
        ("1.0", THREE, 0.336),
        ("2.0", THREE, 0.336),
        ("2.1", THREE, 0.425532),
        ("1.0", PEOPLE, 0.21875),
        ("2.0", PEOPLE, 0.21875),
        ("2.1", PEOPLE, 0.291667),
        ("2.0", SLOW, 0.9643),
        ("2.1", SLOW, 0.954563),
        ("2.0", MANY, 0.382418),
        ("2.1", MANY, 0.442413),
        ("2.0", SCENARIOS, 0.49),
        ("2.1", SCENARIOS, 0.555556),
    ],
)
def test_the_penalty_is_that_of_the_leaderboards_own_code(version: str, happened: Happened, expected: float) -> None:
    events = [LeaderboardEvent(kind=Kind(kind), tick=0, percentage=percentage) for kind, percentage in happened]
    assert penalty(Version(version), events) == pytest.approx(expected, abs=6e-7)


def test_a_published_result_is_met() -> None:
    # public result files of leaderboard 2.0 have score_penalty 0.9643 and 0.94594 for these average speeds
    for percentage, expected in ((88.1, 0.9643), (81.98, 0.94594)):
        assert penalty(
            Version.V2_0, [LeaderboardEvent(kind=Kind.MIN_SPEED, tick=0, percentage=percentage)]
        ) == pytest.approx(expected, abs=1e-9)


def test_the_hundredth_infraction_still_counts_in_2_1() -> None:
    stops = [LeaderboardEvent(kind=Kind.STOP, tick=n) for n in range(100)]
    assert penalty(Version.V2_1, stops) == pytest.approx(1.0 / 26.0)
    assert penalty(Version.V2_0, stops) == pytest.approx(0.8**100)


@pytest.mark.parametrize("version", list(Version))
def test_what_ends_a_drive_costs_nothing_more(version: Version) -> None:
    ends = [LeaderboardEvent(kind=kind, tick=0) for kind in (Kind.ROUTE_DEVIATION, Kind.ROUTE_TIMEOUT, Kind.BLOCKED)]
    assert penalty(version, ends) == 1.0


def test_what_only_scenarios_tell_has_its_price_for_drives_with_scenarios() -> None:
    assert all(kind in FACTORS and kind in POINTS for kind in (Kind.SCENARIO_TIMEOUT, Kind.YIELD_EMERGENCY))
