"""Pictures made on a GPU are those of the CPU: here with numba's simulator, and on the device where there is one."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

TESTS = Path(__file__).parents[6] / "tests"
KINDS = ("depth", "semantic", "instance", "normals", "flow", "coloured")


@pytest.mark.measured_processes
def test_stages_of_the_gpu_make_the_pictures_of_the_cpu() -> None:
    path = os.pathsep.join([str(TESTS), *os.environ.get("PYTHONPATH", "").split(os.pathsep)]).rstrip(os.pathsep)
    simulated = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path}
    program = TESTS / "fakes" / "gpu_in_python.py"
    done = subprocess.run([sys.executable, program], env=simulated, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    assert [row[0] for row in rows] == 3 * list(KINDS)
    for kind, spread, apart, far_apart in rows:
        assert float(spread) > 0.0, f"{kind}: nothing is seen"
        if kind == "coloured":  # samples at edges ask for the sun each, where the CPU knows it from their neighbours
            assert float(far_apart) < 0.01
        else:
            assert float(apart) == 0.0, kind


@pytest.mark.skipif(
    importlib.util.find_spec("warp") is None or importlib.util.find_spec("numba_cuda") is None,
    reason="needs the extra gpu",
)
def test_on_the_device_labels_are_those_of_the_cpu() -> None:
    from fakes.gpu_on_device import apart  # noqa: PLC0415 - loads Warp

    found = apart()
    if found is None:
        pytest.skip("there is no GPU")
    assert set(found) == set(KINDS)
    for kind in ("semantic", "instance"):
        assert not found[kind].any()
    assert np.count_nonzero(found["depth"]) < 0.002 * found["depth"].size
    assert (found["coloured"] > 2.0).mean() < 0.002
