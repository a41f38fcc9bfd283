"""Claims about the vectorised environment: it steps as single ones do, and a worker that dies costs one episode."""

import multiprocessing
import os
import runpy
import signal
from collections.abc import Iterator
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from basu.errors import UserError
from basu.gym import ShuttleEnv
from basu.gym_vector import ShuttleVectorEnv
from servers import RunningServer

pytestmark = pytest.mark.measured_processes
EXAMPLE = Path(__file__).parents[3] / "examples" / "gym_training.py"
GENTLE = np.array([[0.4, 0.0], [0.6, 0.1]], np.float32)


@pytest.fixture(scope="module")
def env() -> Iterator[ShuttleVectorEnv]:
    made = gymnasium.make_vec("basu/Linden-v0", num_envs=2)
    assert isinstance(made, ShuttleVectorEnv)
    yield made
    made.close()


def test_each_environment_steps_as_one_by_itself(env: ShuttleVectorEnv, simulator: RunningServer) -> None:
    seen, _ = env.reset(seed=5)
    assert seen in env.observation_space
    together = [seen, *(env.step(GENTLE) for _ in range(12))]
    alone = ShuttleEnv(host="127.0.0.1", port=simulator.port)
    try:
        for index in range(2):
            first, _ = alone.reset(seed=5 + index)
            steps = [alone.step(GENTLE[index]) for _ in range(12)]
            assert all(np.array_equal(first[name], together[0][name][index]) for name in first)
            for one, many in zip(steps, together[1:], strict=True):
                assert all(np.array_equal(one[0][name], many[0][name][index]) for name in first)
                assert one[1] == pytest.approx(many[1][index])
                assert many[4]["route_s_m"][index] == pytest.approx(one[4]["route_s_m"])
    finally:
        alone.close()


def test_an_environment_begins_again_in_the_step_after_its_end(env: ShuttleVectorEnv) -> None:
    env.reset(seed=0)
    worker = env._workers[1]
    os.kill(worker.process.pid, signal.SIGKILL)
    seen, rewards, terminated, truncated, infos = env.step(GENTLE)
    assert truncated.tolist() == [False, True]
    assert infos["restarted"].tolist() == [False, True]
    assert rewards[1] == 0.0
    assert not terminated.any()
    assert env._workers[1] is not worker
    seen, rewards, terminated, truncated, _ = env.step(GENTLE)  # a reset of the second, a step of the first
    assert (rewards[1], terminated[1], truncated[1]) == (0.0, False, False)
    assert seen["ego"][1][0] < 0.1  # at rest again
    assert seen in env.observation_space
    env.step(GENTLE)


def test_no_worker_is_left_and_mistakes_are_one_sentence() -> None:
    with pytest.raises(UserError, match="has no route '77'; it has 1"):
        ShuttleVectorEnv(1, route_id="77")
    with pytest.raises(UserError, match="leave out host and port"):
        ShuttleVectorEnv(2, host="127.0.0.1")
    with pytest.raises(UserError, match="num_envs is 0"):
        ShuttleVectorEnv(0)
    with pytest.raises(UserError, match="choose NextStep or SameStep"):
        ShuttleVectorEnv(1, autoreset_mode=AutoresetMode.DISABLED)
    assert not multiprocessing.active_children()


def test_the_example_learns_to_drive(env: ShuttleVectorEnv, capsys: pytest.CaptureFixture[str]) -> None:
    training = runpy.run_path(str(EXAMPLE))
    found = training["train"](env, generations=6, steps=40, seed=2)
    assert found[-1][1] > found[0][1] + 0.06  # the mean of a generation
    standing = np.tile([0.0, -1.0, 0.0], (2, 1))  # a policy that brakes
    assert found[-1][2] > training["returns_of"](env, standing, 40, 2).max() + 0.1
    assert capsys.readouterr().out.count("generation") == 6
