"""MetaDrive beside eyes.py: what a step of its own traffic takes with its lidar, and with its colour camera."""

import subprocess
from pathlib import Path

METADRIVE = Path(__file__).with_name("peer_metadrive.py")
PATIENCE_S = 240.0


def having(module: str, pythons: list[Path]) -> Path | None:
    """Return the first Python that has a module."""
    for python in pythons:
        command = [str(python), "-c", f"import importlib.util as u; raise SystemExit(u.find_spec('{module}') is None)"]
        if subprocess.run(command, check=False, capture_output=True).returncode == 0:
            return python
    return None


def drive(pythons: list[Path], steps: int) -> None:
    """Print what MetaDrive's steps take, where a Python has it."""
    python = having("metadrive", pythons)
    if python is None:
        print("MetaDrive was not measured: name a Python that has it by --peer-python")
        return
    for what in ([], ["camera"]):
        command = [str(python), str(METADRIVE), str(steps), *what]
        try:
            done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            print(f"MetaDrive with {what or 'its lidar'} was not measured: {PATIENCE_S:.0f} s were too short")
            continue
        said = [line for line in done.stdout.splitlines() if line.count("|") == 2]
        if done.returncode and not said:
            print(f"MetaDrive with {what or 'its lidar'} was not measured: {done.stderr.strip().splitlines()[-1:]}")
            continue
        name, sensor, ms = said[-1].split("|")
        print(f"{name}, {sensor}: {float(ms):.2f} ms a step, {1000.0 / float(ms):.0f} steps/s")
