"""When a sensor measures, as a table of frames."""

import pytest

from linden.sensors.devices.attributes import Schedule, advance


def frames_due(interval_s: float, times_s: list[float]) -> list[int]:
    schedule, due = Schedule(interval_s), []
    for frame, now_s in enumerate(times_s):
        is_due, schedule = advance(schedule, now_s)
        if is_due:
            due.append(frame)
    assert schedule.made == len(due)
    return due


def steps(dt_s: float, count: int) -> list[float]:
    """Return the times as the simulation reaches them: by adding up."""
    times, now_s = [], 0.0
    for _ in range(count):
        now_s += dt_s
        times.append(now_s)
    return times


def test_without_an_interval_every_frame_is_due() -> None:
    assert frames_due(0.0, steps(0.05, 5)) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("every", [1, 2, 3, 10])
@pytest.mark.parametrize("dt_s", [0.05, 0.1, 1 / 30, 0.01])
def test_an_interval_of_whole_steps_is_kept_to_the_frame(dt_s: float, every: int) -> None:
    assert frames_due(every * dt_s, steps(dt_s, 3000)) == list(range(0, 3000, every))


def test_an_overrun_is_credited_so_that_the_mean_rate_is_right() -> None:
    assert frames_due(0.1, steps(0.04, 11)) == [0, 3, 5, 8, 10]
    assert len(frames_due(0.07, steps(0.05, 1400))) == pytest.approx(1000, abs=1)


def test_an_interval_shorter_than_a_step_gives_one_measurement_a_frame() -> None:
    assert frames_due(0.01, steps(0.05, 6)) == [0, 1, 2, 3, 4, 5]


def test_what_was_missed_in_a_long_step_is_not_made_up_for() -> None:
    assert frames_due(1.0, [0.5, 1.0, 1.5, 6.0, 6.1, 6.4, 6.5, 7.1, 7.6]) == [0, 2, 3, 6, 8]
