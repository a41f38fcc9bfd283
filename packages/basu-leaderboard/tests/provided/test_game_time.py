"""Claims about the clock of a run."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from basu_leaderboard.provided.carla_data_provider import GameTime


@pytest.fixture(autouse=True)
def begun() -> Iterator[None]:
    GameTime.restart()
    yield
    GameTime.restart()


def step(frame: int) -> Any:
    return SimpleNamespace(frame=frame, delta_seconds=0.05, elapsed_seconds=frame * 0.05)


def test_the_first_step_is_one_step_late_whatever_its_number() -> None:
    GameTime.on_carla_tick(step(1000))
    assert GameTime.get_time() == pytest.approx(0.05)
    assert GameTime.get_carla_time() == pytest.approx(50.0)
    assert GameTime.get_frame() == 1000


def test_steps_that_were_missed_are_counted_and_old_ones_are_not() -> None:
    for frame in (10, 13, 12, 13):
        GameTime.on_carla_tick(step(frame))
    assert GameTime.get_time() == pytest.approx(0.2)
    assert GameTime.get_wallclocktime() is not None
