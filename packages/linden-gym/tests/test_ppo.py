"""Claims about the example with PPO: it repeats by its seed, and its policy drives in a world as it does in a run."""

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import gymnasium
import numpy as np
import pytest

import basu
from basu.gym import Reward
from linden_gym import ID

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(scope="module", autouse=True)
def examples() -> Iterator[None]:
    sys.path.append(str(EXAMPLES))  # the files of the example import each other
    yield
    sys.path.remove(str(EXAMPLES))


@pytest.fixture(scope="module")
def training() -> ModuleType:
    pytest.importorskip("stable_baselines3", reason="`pip install basu[sb3]` brings Stable-Baselines3 and PyTorch")
    import ppo_training  # type: ignore[import-not-found] # noqa: PLC0415 - in the folder of examples

    module: ModuleType = ppo_training
    return module


@pytest.mark.slow
def test_the_same_seed_gives_the_same_policy_and_curve(training: ModuleType, tmp_path: Path) -> None:
    folders = [tmp_path / name for name in ("first", "again", "other")]
    short = {"n_steps": 16, "batch_size": 64, "n_epochs": 2}
    for folder, seed in zip(folders, (3, 3, 4), strict=True):
        training.train(512, 8, seed, folder, Reward(), **short)
    first, again, other = ((folder / "policy.npz").read_bytes() for folder in folders)
    assert first == again
    assert first != other
    curves = [(folder / "curve.csv").read_text(encoding="utf-8").splitlines() for folder in folders]
    assert curves[0][0] == ",".join(training.COLUMNS)
    assert len(curves[0]) == 1 + 512 // (8 * 16)
    without_seconds = [[line.rsplit(",", 1)[0] for line in lines] for lines in curves]
    assert without_seconds[0] == without_seconds[1]
    assert (folders[0] / "curve.png").stat().st_size > 0


def test_a_driver_that_stops_in_comfort_pays_no_help(training: ModuleType) -> None:
    worlds = training.TrainingWorlds(2, Reward(), seed=0)
    worlds.comfort = 1.0
    nothing = {"discomfort": np.zeros(2), "offset": np.zeros(2), "infraction": np.zeros(2)}
    seen = {"ego": np.zeros((2, 6)), "stop_sign": np.array([[1.0, 20.0], [0.0, 0.0]])}
    seen["ego"][:, 0] = training.fastest_mps(20.0) - 0.01, 11.0
    assert worlds._help(seen, {"reward_parts": nothing}).tolist() == [0.0, 0.0]
    seen["ego"][0, 0] += 1.01
    assert worlds._help(seen, {"reward_parts": nothing})[0] == pytest.approx(training.TOO_FAST * 0.05)


@pytest.mark.slow
def test_the_policy_drives_in_a_run_as_in_a_world(tmp_path: Path) -> None:
    import mlp_policy  # type: ignore[import-not-found] # noqa: PLC0415 - in the folder of examples
    import ppo_agent  # type: ignore[import-not-found] # noqa: PLC0415 - in the folder of examples

    envs = gymnasium.make_vec(ID, num_envs=1, autoreset_mode="Disabled")
    driver = ppo_agent.Driver(mlp_policy.Policy(ppo_agent.BASELINE))
    seen, infos = envs.reset()
    places_m, infractions, is_over = [infos["route_s_m"][0]], 0, False
    while not is_over:
        seen, _, terminated, truncated, infos = envs.step(driver(seen))
        places_m.append(infos["route_s_m"][0])
        infractions += int(infos["infractions"][0])
        is_over = bool(terminated[0] or truncated[0])
    result = basu.run(str(EXAMPLES / "ppo_agent.py"), output=tmp_path, progress=False)
    assert result.outcome.status.value == infos["outcome"][0] == "Completed"
    assert len(result.infractions) == infractions == 0
    assert np.array_equal(result.history.frames["route_s_m"], places_m)
    assert result.scores.driving > 0.99


def test_the_baseline_is_small_and_its_curve_rises() -> None:
    baseline = EXAMPLES / "ppo_baseline"
    assert (baseline / "policy.npz").stat().st_size < 200_000
    shares = np.genfromtxt(baseline / "curve.csv", delimiter=",", names=True)["route_share"]
    assert np.nanmean(shares[:10]) < 0.2
    assert np.nanmean(shares[-10:]) > 0.9
