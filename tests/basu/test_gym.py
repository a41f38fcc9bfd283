"""Claims about the gymnasium environment: it keeps gymnasium's contract, repeats by seed, and ends as a run does."""

from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from basu.errors import UserError
from basu.gym import Reward, ShuttleEnv
from servers import RunningServer

GENTLE = np.array([0.4, 0.0], np.float32)


@pytest.fixture
def env(simulator: RunningServer) -> Iterator[ShuttleEnv]:
    made = gymnasium.make("basu/Linden-v0", host="127.0.0.1", port=simulator.port)
    assert isinstance(made.unwrapped, ShuttleEnv)
    yield made.unwrapped
    made.close()


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
    env = ShuttleEnv(reward=Reward(progress=1.0, time=-2.0), host="127.0.0.1", port=simulator.port)
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
