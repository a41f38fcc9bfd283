"""MetaDrive beside sensors.py: what a step of its own traffic takes with its lidar, and with its colour camera.

The camera is drawn by OpenGL: without a screen, run the whole under ``xvfb-run``.
"""

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
    print()
    for what, arguments in (("its lidar", []), ("its colour camera", ["camera"])):
        print(driven([str(python), str(METADRIVE), str(steps), *arguments], what), flush=True)


def driven(command: list[str], what: str) -> str:
    """Return what became of a run, in a sentence."""
    try:
        done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        return f"MetaDrive with {what} was not measured: it was not done after {PATIENCE_S:.0f} s"
    said = [line for line in done.stdout.splitlines() if line.count("|") == 2]
    if not said:
        why = next(iter(done.stderr.strip().splitlines()[-1:]), f"it ended with {done.returncode}")
        return f"MetaDrive with {what} was not measured: {why}"
    name, sensor, ms = said[-1].split("|")
    return f"{name}, {sensor}: {float(ms):.2f} ms a step, {1000.0 / float(ms):.0f} steps/s"
