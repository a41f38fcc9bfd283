"""Claims about the environment under Ray's RLlib: RLlib makes vectors of it, and the example trains a policy."""

import os
import runpy
import signal
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from basu.gym import ShuttleEnv
from basu.gym_vector import ShuttleVectorEnv
from ray_clusters import connected_cluster

EXAMPLE = Path(__file__).parents[3] / "examples" / "rllib_training.py"


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    pytest.importorskip("ray.rllib", reason="RLlib is not installed; `pip install basu[rllib]` brings it")
    return runpy.run_path(str(EXAMPLE))


def test_rllib_makes_a_vector_of_environments_by_the_registered_name(example: dict[str, Any]) -> None:
    """As RLlib's runner does it (``SingleAgentEnvRunner.make_env``), which itself needs PyTorch."""
    from ray.rllib.env.env_context import EnvContext  # noqa: PLC0415 - an extra
    from ray.tune.registry import ENV_CREATOR, _global_registry, register_env  # noqa: PLC0415 - likewise

    register_env(example["NAME"], example["environment"])
    creator = _global_registry.get(ENV_CREATOR, example["NAME"])
    context = EnvContext({"weather": "HardRainNoon"}, worker_index=1)
    gymnasium.register("rllib-test-v0", vector_entry_point=lambda num_envs: creator(context | {"num_envs": num_envs}))
    environments = gymnasium.make_vec("rllib-test-v0", num_envs=1, vectorization_mode="vector_entry_point")
    try:
        assert isinstance(environments.unwrapped, ShuttleVectorEnv)
        seen, _ = environments.reset(seed=3)
        assert seen["ego"].shape == (1, 6)
        _, rewards, *_ = environments.step(np.array([[1.0, 0.0]], np.float32))
        assert rewards.shape == (1,)
    finally:
        environments.close()
        gymnasium.registry.pop("rllib-test-v0")


def test_without_a_number_the_creator_makes_one_environment(
    example: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[dict[str, Any]] = []
    monkeypatch.setattr(ShuttleEnv, "__init__", lambda _self, **settings: given.append(settings))
    assert type(example["environment"]({"vehicles": 3})) is ShuttleEnv
    assert given == [{"vehicles": 3}]


@pytest.mark.slow
def test_the_example_trains_and_a_lost_worker_costs_one_episode(
    example: dict[str, Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch", reason="PyTorch is not installed; `pip install basu[rllib]` brings it")
    monkeypatch.setenv("OMP_NUM_THREADS", "1")  # threads that wait take the processor from the simulators
    with connected_cluster(cpus=2):
        algorithm = example["configuration"](environments=1, runners=0, steps=48, seed=1).build_algo()
        try:
            environments = algorithm.env_runner.env.unwrapped
            assert isinstance(environments, ShuttleVectorEnv)
            before = _weights(algorithm)
            assert example["train"](algorithm, 1)[0][:2] == (48, 0)
            assert any(not np.array_equal(before[name], values) for name, values in _weights(algorithm).items())
            os.kill(environments._workers[0].process.pid, signal.SIGKILL)
            ((_, episodes, mean),) = example["train"](algorithm, 1)
            assert episodes == 1
            assert np.isfinite(mean)
        finally:
            algorithm.stop()
        assert not environments._workers
    assert capsys.readouterr().out.count("iteration 0: ") == 2


def _weights(algorithm: Any) -> dict[str, Any]:
    """A copy of the weights of the policy's network."""
    state = algorithm.get_module().state_dict()
    return {name: values.numpy().copy() for name, values in state.items()}
