"""Worlds on a GPU: the kernels in numba's simulator, and the sentences where no GPU can be used."""

import os
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

from linden.errors import UserError
from linden.worlds import Worlds

TESTS = Path(__file__).parents[3] / "tests"


@pytest.mark.parametrize("where", [(), ("--in-place",)], ids=["local memory", "in place"])
def test_the_kernels_of_the_gpu_step_worlds_as_the_processor_does(where: tuple[str, ...]) -> None:
    program = TESTS / "fakes" / "worlds_gpu_in_python.py"
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(TESTS)}
    done = subprocess.run(
        [sys.executable, str(program), *where],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=200.0,
    )
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines()
    assert not [line for line in said if "other" in line]
    contacts, tumbling = (int(part.split()[1]) for part in said[0].split(", "))
    assert contacts > 0
    assert tumbling == 1
    assert said[1] == "valid [True, True, False], frames [6, 6, 1]"
    assert said[2] == "frames [6, 0, 1]"


def test_the_kernels_of_the_gpu_place_parts_and_sensors_as_the_processor_does() -> None:
    program = TESTS / "fakes" / "world_parts_in_python.py"
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(TESTS)}
    done = subprocess.run(
        [sys.executable, str(program)], env=environment, capture_output=True, text=True, check=False, timeout=200.0
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[0] == "parts", done.stdout
    assert int(done.stdout.split()[1]) > 50


def test_a_device_that_is_not_there_gets_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "linden.worlds_gpu", None)
    with pytest.raises(UserError, match=r"device='cuda' needs the extra gpu: pip install 'linden\[gpu\]'"):
        Worlds(count=2, device="cuda")


def test_worlds_on_the_processor_have_no_columns_on_a_gpu() -> None:
    worlds = Worlds(count=2)
    worlds.spawn("vehicle.tesla.model3", 30)
    for measure in (worlds.lidar, partial(worlds.pictures, "depth")):
        with pytest.raises(UserError, match="on_device=True needs worlds on a GPU; make them with device='cuda'"):
            measure([0.0] * 6, on_device=True)
    worlds.wait()
    with pytest.raises(UserError, match="read `state`, or use device='cuda'"):
        worlds.on_device("position")
