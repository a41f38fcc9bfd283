"""Environments on a GPU are those on the processor, up to its last digits. Skipped where there is no GPU."""

import math

import numpy as np
import pytest

from linden_gym.environment import WorldsVectorEnv

COUNT, STEPS = 64, 40


def _why_not() -> str:
    """Why no GPU can be used here; empty if one can."""
    try:
        from numba import cuda  # noqa: PLC0415 - needs no device

        import linden.worlds_gpu  # noqa: F401, PLC0415 - needs the extra gpu
    except ImportError as error:
        return f"needs the extra gpu: pip install 'linden[gpu]' ({error})"
    return "" if cuda.is_available() else "there is no CUDA device"  # type: ignore[no-untyped-call] # numba has no hints


pytestmark = pytest.mark.skipif(bool(_why_not()), reason=_why_not() or "a GPU is there")


def test_environments_on_a_gpu_give_what_those_on_the_processor_give() -> None:
    envs = [WorldsVectorEnv(COUNT, device=device, start_m=(0.0, math.inf)) for device in ("cpu", "cuda")]
    seen = [each.reset(seed=5)[0] for each in envs]
    dice = np.random.default_rng(5)
    for _ in range(STEPS):
        for name, values in seen[0].items():
            np.testing.assert_allclose(seen[1][name], values, atol=1e-3, err_msg=name)
        actions = dice.uniform([0.0, -0.2], [0.8, 0.2], (COUNT, 2)).astype(np.float32)
        stepped = [each.step(actions) for each in envs]
        seen = [each[0] for each in stepped]
        np.testing.assert_allclose(stepped[1][1], stepped[0][1], atol=1e-3)
        assert np.array_equal(stepped[1][2], stepped[0][2])
        assert np.array_equal(stepped[1][3], stepped[0][3])
        assert np.array_equal(stepped[1][4]["infractions"], stepped[0][4]["infractions"])
    assert seen[1]["ego"][:, 0].max() > 1.0


def test_some_environments_on_a_gpu_begin_anew_and_the_others_go_on() -> None:
    envs = WorldsVectorEnv(4, device="cuda", autoreset_mode="Disabled")
    first, _ = envs.reset()
    for _ in range(20):
        seen, *_ = envs.step(np.full((4, 2), [0.5, 0.0], np.float32))
    mask = np.array([True, False, True, False])
    again, infos = envs.reset(options={"reset_mask": mask, "start_m": np.array([0.0, 0.0, 300.0, 0.0])})
    assert np.array_equal(again["ego"][0], first["ego"][0])
    assert np.array_equal(again["ego"][1], seen["ego"][1])
    assert abs(infos["route_s_m"][2] - 300.0) < 1.0
    envs.step(np.zeros((4, 2), np.float32))
