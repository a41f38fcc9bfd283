"""Claims about the gymnasium environment: it keeps gymnasium's contract, repeats by seed, and ends as a run does."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from basu.errors import UserError
from basu.gym import Reward, ShuttleEnv
from basu.gym_spaces import control_from
from servers import RunningServer

GENTLE = np.array([0.4, 0.0], np.float32)


@pytest.fixture
def env(simulator: RunningServer) -> Iterator[ShuttleEnv]:
    made = gymnasium.make("basu/Linden-v0", host="127.0.0.1", port=simulator.port)
    assert isinstance(made.unwrapped, ShuttleEnv)
    yield made.unwrapped
    made.close()


def open_files() -> int:
    """The number of open files of this process."""
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


def steps(env: ShuttleEnv, seed: int, number: int = 60) -> list[Any]:
    """Observations, rewards and infos of a gentle drive."""
    seen = [env.reset(seed=seed)]
    return [*seen, *(env.step(GENTLE) for _ in range(number))]


@pytest.mark.filterwarnings("error::UserWarning")
def test_gymnasiums_own_checker_is_content(env: ShuttleEnv) -> None:
    check_env(env)


def test_one_seed_gives_the_same_drive_again(simulator: RunningServer) -> None:
    env = ShuttleEnv(vehicles=6, walkers=4, host="127.0.0.1", port=simulator.port)
    try:
        first, again = steps(env, seed=5), steps(env, seed=5)
        for one, other in zip(first, again, strict=True):
            for name, values in one[0].items():
                assert np.array_equal(values, other[0][name]), name
        assert [each[1] for each in first[1:]] == [each[1] for each in again[1:]]
    finally:
        env.close()


def test_the_route_ahead_is_given_in_the_vehicles_frame(env: ShuttleEnv) -> None:
    seen, _ = env.reset(seed=0)
    assert seen["route"][0] == pytest.approx([5.0, 0.0], abs=0.1)  # the vehicle begins on the lane's middle
    assert seen["ego"][0] < 0.1  # at rest
    assert seen["others"].sum() == 0.0  # alone


def test_the_nearest_road_user_comes_first(simulator: RunningServer) -> None:
    env = ShuttleEnv(case="lead_vehicle_brakes_1", host="127.0.0.1", port=simulator.port)
    try:
        env.reset(seed=0)
        seen = env.step(GENTLE)[0]["others"]
        here = seen[seen[:, 0] == 1.0]
        away = np.hypot(here[:, 1], here[:, 2])
        assert len(here) >= 1
        assert list(away) == sorted(away)
        assert here[0, 1] > 0.0  # ahead
    finally:
        env.close()


def test_progress_is_rewarded_and_time_costs(simulator: RunningServer) -> None:
    env = ShuttleEnv(
        reward=Reward(progress=1.0, time=-2.0, discomfort=0.0, offset=0.0), host="127.0.0.1", port=simulator.port
    )
    try:
        env.reset(seed=0)
        stands = env.step(np.array([-1.0, 0.0], np.float32))
        assert stands[1] == pytest.approx(-2.0 * 0.05, abs=0.01)
        _, before = env.reset(seed=0)
        rewards = [env.step(GENTLE) for _ in range(60)]
        driven_m = rewards[-1][4]["route_s_m"] - before["route_s_m"]
        assert driven_m > 2.0
        assert sum(each[1] for each in rewards) == pytest.approx(driven_m - 2.0 * 0.05 * 60)
    finally:
        env.close()


def test_leaving_the_route_terminates_with_its_outcome(env: ShuttleEnv) -> None:
    env.reset(seed=0)
    for _ in range(400):
        _, reward, terminated, truncated, info = env.step(np.array([0.6, -0.12], np.float32))
        if terminated or truncated:
            break
    assert terminated
    assert info["outcome"] == "RouteDeviation"
    assert reward < -5.0


def test_an_unknown_route_is_a_sentence() -> None:
    with pytest.raises(UserError, match="has no route '77'; it has 1"):
        ShuttleEnv(route_id="77")


def test_a_misspelt_case_gets_the_nearest_one_as_a_hint() -> None:
    with pytest.raises(UserError, match="did you mean 'lead_vehicle_brakes_1'"):
        ShuttleEnv(case="lead_vehicle_brake_1")


def test_a_type_is_no_case_and_is_not_suggested_for_one() -> None:
    with pytest.raises(UserError, match="there is no case 'qqqq'; it may be a case's id"):
        ShuttleEnv(case="qqqq")


@pytest.mark.parametrize(
    ("action", "sentence"),
    [
        pytest.param([math.nan, 0.0], r"the action is \[nan, 0\]; both numbers must be in -1\.\.1", id="nan"),
        pytest.param([0.0, math.inf], r"the action is \[0, inf\]", id="inf"),
        pytest.param([5.0, 0.0], r"the action is \[5, 0\]; .*ClipAction", id="outside"),
        pytest.param([0.0, 0.0, 0.0], r"the shape \(3,\); give \(2,\)", id="three"),
        pytest.param(0.5, r"the shape \(\); give \(2,\)", id="scalar"),
        pytest.param([[0.0, 0.0]], r"the shape \(1, 2\)", id="batch"),
        pytest.param(["gas", 0.0], r"the action is \['gas', 0\.0\]; give two numbers", id="words"),
        pytest.param(None, "give two numbers|the shape", id="none"),
    ],
)
def test_an_action_outside_of_the_space_is_a_sentence(action: Any, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        control_from(action)


def test_pedals_become_throttle_or_brake() -> None:
    forward, back = control_from(np.array([0.5, -0.25])), control_from([-1.0, 1.0])
    assert (forward.throttle, forward.brake, forward.steer) == (0.5, 0.0, -0.25)
    assert (back.throttle, back.brake, back.steer) == (0.0, 1.0, 1.0)


def test_a_refused_action_leaves_the_episode_as_it_was(env: ShuttleEnv) -> None:
    env.reset(seed=0)
    expected = env.step(GENTLE)[0]
    env.reset(seed=0)
    with pytest.raises(UserError, match="the action is"):
        env.step(np.array([math.nan, 0.0], np.float32))
    assert np.array_equal(env.step(GENTLE)[0]["ego"], expected["ego"])


def test_the_parts_of_the_reward_add_up(env: ShuttleEnv) -> None:
    env.reset(seed=0)
    for _ in range(20):
        _, reward, _, _, info = env.step(GENTLE)
        assert set(info["reward_parts"]) == {
            "progress",
            "time",
            "infraction",
            "arrival",
            "failure",
            "discomfort",
            "offset",
        }
        assert sum(info["reward_parts"].values()) == reward


def test_a_closed_environment_leaves_no_file_open() -> None:
    ShuttleEnv().close()  # what the first one opens for good, such as a map's file, belongs to the process
    before = open_files()
    ShuttleEnv().close()
    assert open_files() <= before
