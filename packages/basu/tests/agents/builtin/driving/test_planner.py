"""Claims about the choice of acceleration."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.agents.builtin.driving.planner import COMFORT, FIRM, FULL_MPS2, HARD, STRAY_MPS, Planner
from basu.agents.builtin.scene import Restriction, Urgency

DT_S = 0.05


def driven(
    mark_m: float, urgency: Urgency, *, speed_mps: float = 0.0, limit_mps: float = 6.7, last_resort_m: float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ways, speeds and accelerations on the way to a mark that is to be stopped at, followed exactly."""
    planner = Planner(DT_S)
    planner.speed_mps = speed_mps
    way_m, rows = 0.0, []
    for _ in range(2000):
        mark = Restriction(mark_m - way_m, 0.0, urgency, "mark", last_resort_m)
        accel = planner.step(planner.speed_mps, limit_mps, [mark])
        way_m += planner.speed_mps * DT_S
        rows.append((way_m, planner.speed_mps, accel))
        if planner.holding:
            break
    return tuple(np.array(rows).T)  # type: ignore[return-value]


@given(mark_m=st.floats(2.0, 120.0), limit_mps=st.floats(1.5, 11.0))
def test_a_mark_is_reached_in_comfort_and_to_the_hand(mark_m: float, limit_mps: float) -> None:
    way_m, speed_mps, accel = driven(mark_m, Urgency.GENTLE, limit_mps=limit_mps)
    assert way_m[-1] == pytest.approx(mark_m, abs=0.15)
    assert speed_mps.max() <= limit_mps + 0.01
    assert np.abs(accel).max() <= COMFORT.accel_mps2 + 1e-9
    jerk = np.diff(accel[:-1]) / DT_S  # the last step is that in which it stands
    assert np.abs(jerk).max() <= 1.6 * COMFORT.jerk_mps3


def test_no_actor_nods_when_the_vehicle_comes_to_rest() -> None:
    _, speed_mps, accel = driven(60.0, Urgency.FIRM)
    moving = np.flatnonzero(speed_mps > 0.0)
    assert abs(accel[moving[-1]]) < 0.15


@pytest.mark.parametrize(
    ("mark_m", "deepest_mps2"),
    [(40.0, COMFORT.accel_mps2), (18.0, FIRM.accel_mps2), (9.0, HARD.accel_mps2), (4.5, FULL_MPS2)],
)
def test_braking_is_no_rougher_than_the_way_left_demands(mark_m: float, deepest_mps2: float) -> None:
    way_m, _, accel = driven(mark_m, Urgency.VITAL, speed_mps=6.7, last_resort_m=1.0)
    assert way_m[-1] <= mark_m + 1.0
    assert -accel.min() <= deepest_mps2 + 1e-9


def test_a_speed_to_slow_down_to_is_never_worth_more_than_comfort() -> None:
    _, _, accel = driven(5.0, Urgency.GENTLE, speed_mps=6.7)
    assert -accel.min() <= COMFORT.accel_mps2 + 1e-9


def test_a_line_is_worth_firm_braking_and_no_more() -> None:
    _, _, accel = driven(6.0, Urgency.FIRM, speed_mps=6.7)
    assert COMFORT.accel_mps2 < -accel.min() <= FIRM.accel_mps2 + 1e-9


def test_standing_at_a_mark_one_stays_until_it_is_taken_away() -> None:
    planner = Planner(DT_S)
    near = Restriction(0.4, 0.0, Urgency.FIRM, "line")
    assert [planner.step(0.0, 6.7, [near]) for _ in range(50)] == [0.0] * 50
    assert planner.holding
    assert planner.step(0.0, 6.7, []) > 0.0
    assert not planner.holding


def test_the_reason_names_what_is_braked_for() -> None:
    planner = Planner(DT_S)
    planner.speed_mps = 6.0
    planner.step(
        6.0, 6.7, [Restriction(8.0, 0.0, Urgency.VITAL, "walker ahead"), Restriction(90.0, 2.0, Urgency.GENTLE, "bend")]
    )
    assert planner.reason == "walker ahead"


def test_after_a_push_the_reference_is_near_the_vehicle_again() -> None:
    planner = Planner(DT_S)
    planner.step(5.0, 6.7, [])
    assert planner.speed_mps == pytest.approx(5.0, abs=STRAY_MPS + 0.1)
