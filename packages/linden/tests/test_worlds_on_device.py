"""Worlds on a CUDA device: their sensors measure as on the processor. Skipped where there is no GPU."""

import importlib.util

import numpy as np
import pytest

from linden.errors import UserError
from linden.worlds import Worlds

ON_ROOF = [0.0, 0.0, 2.4, 0.0, 0.0, 0.0]


def _why_not() -> str:
    """Why no GPU can be used here; empty if one can."""
    missing = [name for name in ("warp", "numba_cuda") if importlib.util.find_spec(name) is None]
    if missing:
        return f"needs the extra gpu: {', '.join(missing)} is not installed"
    from numba import cuda  # noqa: PLC0415 - loads the driver

    return "" if cuda.is_available() else "there is no CUDA device"  # type: ignore[no-untyped-call] # numba has no hints


@pytest.mark.skipif(bool(_why_not()), reason=_why_not() or "a GPU is there")
def test_sensors_of_worlds_on_a_gpu_measure_as_on_the_processor() -> None:
    found = []
    for device in ("cpu", "cuda"):
        worlds = Worlds(count=3, device=device)
        worlds.spawn("vehicle.tesla.model3", 30)
        worlds.spawn("vehicle.tesla.model3", 10)
        worlds.set_controls([[0.5, 0.1, 0.0], [0.9, 0.0, 0.0], [0.3, -0.1, 0.0]])
        for _ in range(10):
            worlds.step()
        lidar = worlds.lidar(ON_ROOF, channels=8, points_per_second=8 * 90 * 20, dropoff_general_rate=0.0)
        found.append((lidar.hit, *(worlds.pictures(kind, ON_ROOF) for kind in ("depth", "semantic", "rgb"))))
    (hit, depth_m, tags, colours), (hit_gpu, depth_gpu_m, tags_gpu, colours_gpu) = found
    assert (hit_gpu == hit).mean() > 0.995
    assert (np.abs(depth_gpu_m - depth_m) < 0.01 * depth_m).mean() > 0.995
    assert (tags_gpu == tags).mean() > 0.995
    assert (np.abs(colours_gpu.astype(int) - colours.astype(int)) < 8).mean() > 0.97


@pytest.mark.skipif(bool(_why_not()), reason=_why_not() or "a GPU is there")
def test_measurements_stay_on_the_device() -> None:
    worlds = Worlds(count=3, device="cuda")
    worlds.spawn("vehicle.tesla.model3", 30)
    worlds.step()
    for kind in ("depth", "semantic"):
        there = worlds.pictures(kind, ON_ROOF, on_device=True)
        assert there.device.is_cuda
        assert np.array_equal(there.numpy(), worlds.pictures(kind, ON_ROOF))
    with pytest.raises(UserError, match=r"dropoff_general_rate=0\.0"):
        worlds.lidar(ON_ROOF, on_device=True)
    with pytest.raises(UserError, match="pictures of kind 'rgb' come back to the host"):
        worlds.pictures("rgb", ON_ROOF, on_device=True)
    certain = {
        "channels": 8,
        "points_per_second": 8 * 90 * 20,
        "dropoff_general_rate": 0.0,
        "dropoff_zero_intensity": 0.0,
    }
    scan, here = worlds.lidar(ON_ROOF, on_device=True, **certain), worlds.lidar(ON_ROOF, **certain)
    assert np.array_equal(scan.hit.numpy(), here.hit)
    np.testing.assert_allclose(scan.points.numpy(), here.points, atol=1e-4)
