"""Claims about what is done to the ego's controls: how much, for how long, the same for the same seed."""

import numpy as np
import pytest

from basu.scenarios.actions import Either, JitterControls, PullSteering, Wait
from basu.scenarios.actions.one_frame import Action
from basu.scenarios.stage import Controls
from basu.testing import OfflineStage
from fakes.paper import play, stage_with

MEANT = Controls(0.5, 0.1, 0.2)


def disturbed(action: Action, seed: int = 0) -> tuple[np.ndarray, OfflineStage]:
    """What becomes of the controls, a row a frame; the stage afterwards."""
    stage, rows = stage_with(seed=seed), []
    play(action, stage, watch=lambda stage: rows.append(stage.controls(MEANT)))
    return np.array(rows), stage


def test_noise_has_the_spread_and_the_correlation_it_is_given() -> None:
    rows, _ = disturbed(JitterControls(60.0, steer=0.1, throttle=0.15, correlated_s=0.3))
    steer, throttle = rows[:-1, 1] - 0.1, rows[:-1, 0] - 0.5
    assert steer.std() == pytest.approx(0.1, rel=0.2)
    assert throttle.std() == pytest.approx(0.15, rel=0.2)
    after_a_frame = np.corrcoef(steer[:-1], steer[1:])[0, 1]
    assert after_a_frame == pytest.approx(np.exp(-0.05 / 0.3), abs=0.05)
    assert abs(np.corrcoef(steer, throttle)[0, 1]) < 0.25
    assert (rows[:, 2] == 0.2).all()  # the brake is left alone


def test_the_same_seed_gives_the_same_noise_and_another_another() -> None:
    first, again, other = (disturbed(JitterControls(2.0), seed)[0] for seed in (7, 7, 8))
    assert (first == again).all()
    assert (first != other).any()


def test_controls_stay_within_their_range() -> None:
    rows, _ = disturbed(JitterControls(10.0, steer=2.0, throttle=2.0))
    assert rows[:, 0].min() == 0.0
    assert rows[:, 0].max() == 1.0
    assert np.abs(rows[:, 1]).max() == 1.0


def test_a_pull_goes_with_the_noise() -> None:
    rows, _ = disturbed(JitterControls(20.0, steer=0.02, pull=0.3))
    assert rows[:-1, 1].mean() == pytest.approx(0.4, abs=0.02)


def test_the_steering_that_pulls_rises_and_stays() -> None:
    rows, _ = disturbed(PullSteering(-0.4, 3.0, rising_s=0.5))
    assert rows[0, 1] == pytest.approx(0.1 - 0.04)
    assert rows[9:-1, 1] == pytest.approx(-0.3)


@pytest.mark.parametrize("ended", ["done", "broken off"])
def test_the_controls_are_given_back(ended: str) -> None:
    action = JitterControls(2.0) if ended == "done" else Either(JitterControls(20.0), Wait(1.0))
    stage = stage_with()
    play(action, stage)
    assert stage.controls(MEANT) == MEANT
    assert [command.details[1] for command in stage.commands] == [True, False]
