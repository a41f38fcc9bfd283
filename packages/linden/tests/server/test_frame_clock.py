"""Claims about the rhythm of asynchronous mode, with a clock that the test turns."""

import pytest

from linden.server.frame_clock import LONGEST_STEP_S, SHORTEST_STEP_S, VARIABLE_HZ, FrameClock


def test_the_first_frame_is_due_after_one_period() -> None:
    assert FrameClock(100.0).wait_s(100.0, 0.05) == pytest.approx(0.05)
    assert FrameClock(100.0).wait_s(100.0, None) == pytest.approx(1.0 / VARIABLE_HZ)


def test_frames_of_a_fixed_step_keep_real_time_even_when_each_is_a_little_late() -> None:
    pace, now_s = FrameClock(0.0), 0.0
    for _ in range(100):
        now_s += pace.wait_s(now_s, 0.05) + 0.003
        pace.frame_made(now_s, 0.05)
    assert now_s == pytest.approx(100 * 0.05 + 0.003)


def test_time_lost_is_not_made_up_for_in_a_burst() -> None:
    pace = FrameClock(0.0)
    pace.frame_made(10.0, 0.05)
    assert pace.wait_s(10.0, 0.05) == pytest.approx(0.05)


def test_a_shorter_step_takes_effect_at_once() -> None:
    pace = FrameClock(0.0)
    pace.frame_made(1.0, 10.0)
    assert pace.wait_s(1.02, 0.05) == pytest.approx(0.03)


def test_a_variable_step_is_the_time_since_the_last_frame_within_limits() -> None:
    pace = FrameClock(0.0)
    pace.frame_made(1.0, None)
    assert pace.variable_step_s(1.04) == pytest.approx(0.04)
    assert pace.variable_step_s(1.0) == SHORTEST_STEP_S
    assert pace.variable_step_s(60.0) == LONGEST_STEP_S
