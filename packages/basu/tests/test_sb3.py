"""Claims about the example with Stable-Baselines3: it trains, its policy needs numpy alone, and the baseline drives."""

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
BASELINE = ROOT / "examples" / "sb3_baseline"


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    sys.path.append(str(ROOT / "examples"))  # it imports a file beside it
    return runpy.run_path(str(ROOT / "examples" / "sb3_training.py"))


@pytest.mark.slow
def test_the_example_trains_and_its_policy_acts_as_the_librarys(
    example: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("stable_baselines3", reason="`pip install basu[sb3]` brings Stable-Baselines3 and PyTorch")
    model = example["train"](example["TRAINING"][:1], 512, 1, tmp_path, n_steps=256, batch_size=64)
    assert model.num_timesteps == 512
    before, after = (np.load(tmp_path / name) for name in ("untrained.npz", "policy.npz"))
    assert not np.array_equal(before["action_net.weight"], after["action_net.weight"])
    policy, seen = example["Policy"](tmp_path / "policy.npz"), np.linspace(-3.0, 8.0, 26, dtype=np.float32)
    expected, _ = model.predict(model.get_vec_normalize_env().normalize_obs(seen), deterministic=True)
    assert policy(seen) == pytest.approx(expected, abs=1e-5)
    lines = (tmp_path / "curve.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == ",".join(example["COLUMNS"])
    assert len(lines) >= 2  # the vehicle stood, and training gave up
    assert capsys.readouterr().out.count("of the route") == len(lines) - 1
    assert (tmp_path / "curve.png").stat().st_size > 0


def test_the_baseline_drives_along_a_route_that_it_has_never_driven(example: dict[str, Any]) -> None:
    env = example["environment"](example["UNSEEN"][0])
    try:
        policy, offsets_m = example["Policy"](example["BASELINE"]), []
        seen, _ = env.reset(seed=0)
        for _ in range(100):
            seen, _, terminated, truncated, info = env.step(policy(seen))
            offsets_m.append(abs(float(seen[3])))
            assert not terminated
            assert not truncated
        assert info["route_share"] > 0.15
        assert not info["infractions"]
        assert max(offsets_m) < example["OFF_LANE_M"]
    finally:
        env.close()


def test_the_built_in_driver_drives_in_the_same_environment(
    example: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    drivers = {"basic": (example["built_in"], 1)}
    (found,) = example["compare"](drivers, example["UNSEEN"][:1], most_actions=150).values()
    total, share, infractions, _, passed = found
    assert total > 1.0
    assert 0.01 < share < 0.2
    assert (infractions, passed) == (0.0, 0.0)  # it is still under way
    assert "0 of 1" in capsys.readouterr().out


def test_the_baseline_is_small_and_its_curve_rises() -> None:
    assert (BASELINE / "policy.npz").stat().st_size < 200_000
    shares = np.genfromtxt(BASELINE / "curve.csv", delimiter=",", names=True)["route_share"]
    assert shares[:40].mean() < 0.1
    assert shares[-40:].mean() > 0.8
