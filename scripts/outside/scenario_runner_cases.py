"""Play exported cases with the public ScenarioRunner on `linden serve`, and compare its actors with the files.

usage: scenario_runner_cases.py --root SCENARIO_RUNNER --python PYTHON --agents FOLDER [--folder DIR] CASE...

PYTHON has ScenarioRunner's requirements (docs/how-to/scenario-runner.md). FOLDER has CARLA's package `agents`. Each
case gets a line: seconds of wall time and of simulated time, and for each actor that moves the greatest distance in m
from the trajectory of the file. The begin of each motion is the one that fits best, in steps of 50 ms.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ET
from collections import defaultdict
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import carla
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

BIN = Path(sys.executable).parent
"""The folder of the commands of this environment."""

STEP_S = 0.05
LONGEST_S = 60.0
MOVES = ("vehicle", "walker", "static")
Rows = dict[str, list[tuple[float, float, float]]]
"""Time in s, x and y in m of each actor, by its role."""


@contextmanager
def serving() -> Iterator[int]:
    """Start a server on a free port, and yield the port."""
    command = [str(BIN / "linden"), "serve", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        try:
            ready = next(line for line in process.stdout if "rpc port" in line)
            yield int(re.findall(r"rpc port (\d+)", ready)[0])
        finally:
            process.terminate()


def watch(port: int, is_over: threading.Event, rows: Rows) -> None:
    """Note the places of all actors with a role in each frame, until ``is_over`` is set."""
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(60.0)
    roles: dict[int, str] = {}
    while not is_over.is_set():
        world = client.get_world()
        try:
            snapshot = world.wait_for_tick(5.0)
        except RuntimeError:  # nothing ticks yet, or any more
            continue
        for actor in snapshot:
            if actor.id not in roles:
                known = world.get_actor(actor.id)
                moves = known is not None and known.type_id.partition(".")[0] in MOVES
                roles[actor.id] = known.attributes.get("role_name", "") if moves else ""
            if roles[actor.id]:
                place = actor.get_transform().location
                rows[roles[actor.id]].append((snapshot.timestamp.elapsed_seconds, place.x, place.y))


def trajectories(path: Path) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield each actor's name with the rows (N, 3) of a trajectory: time in s, x and y in m in CARLA's frame."""
    for group in ET.parse(path).iter("ManeuverGroup"):
        actor = group.find(".//EntityRef")
        for trajectory in group.iter("Trajectory"):
            found = []
            for vertex in trajectory.iter("Vertex"):
                place = vertex.find(".//WorldPosition")
                assert place is not None
                found.append((float(vertex.attrib["time"]), float(place.attrib["x"]), -float(place.attrib["y"])))
            if actor is not None:
                yield actor.attrib["entityRef"], np.array(found)


def apart_m(wanted: NDArray[np.float64], driven: NDArray[np.float64]) -> float:
    """Return the greatest distance of driven rows (M, 3) from a trajectory (N, 3), begun when it fits best."""
    best_m, lasts_s = np.inf, wanted[-1, 0] - wanted[0, 0]
    for late_s in np.arange(driven[0, 0] - wanted[0, 0] - 1.0, driven[-1, 0] - wanted[0, 0] + STEP_S, STEP_S):
        times_s = driven[:, 0] - late_s
        inside = (times_s >= wanted[0, 0]) & (times_s <= wanted[-1, 0])
        if inside.sum() < 0.5 * min(len(driven), lasts_s / STEP_S):
            continue
        x_m, y_m = (np.interp(times_s[inside], wanted[:, 0], wanted[:, column]) for column in (1, 2))
        best_m = min(best_m, float(np.hypot(x_m - driven[inside, 1], y_m - driven[inside, 2]).max()))
    return best_m


def played(case: str, folder: Path, arguments: argparse.Namespace) -> str:
    """Return the line of a case."""
    path = folder / f"{case}.xosc"
    export = [str(BIN / "basu"), "scenario", "export", case, "-o", str(path), "--for", "scenario-runner"]
    done = subprocess.run(export, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return f"{case}: {done.stderr.strip()}"
    root = arguments.root.resolve()
    own = {"SCENARIO_RUNNER_ROOT": str(root), "PYTHONPATH": f"{arguments.agents.resolve()}:{root}"}
    rows: Rows = defaultdict(list)
    is_over, began = threading.Event(), time.monotonic()
    with serving() as port:
        watcher = threading.Thread(target=watch, args=(port, is_over, rows))
        watcher.start()
        command = [
            str(arguments.python),
            "scenario_runner.py",
            "--sync",
            "--timeout",
            "60",
            "--openscenario",
            str(path),
        ]
        try:
            done = subprocess.run(
                [*command, "--port", str(port)], cwd=root, env={**os.environ, **own}, capture_output=True, text=True,
                check=False, timeout=LONGEST_S,
            )  # fmt: skip
            said, end = done.stdout + done.stderr, ""
        except subprocess.TimeoutExpired as error:
            said, end = str(error.stdout), f", broken off after {LONGEST_S:.0f} s"
        is_over.set()
        watcher.join()
    (folder / f"{case}.txt").write_text(said, encoding="utf-8")
    worst: dict[str, float] = defaultdict(float)
    for name, wanted in trajectories(path):
        driven = np.array(rows.get(name, []))
        worst[name] = max(worst[name], apart_m(wanted, driven) if len(driven) else np.inf)
    simulated_s = max((row[-1][0] for row in rows.values()), default=0.0)
    figures = ", ".join(f"{name} {value:.3f} m" for name, value in worst.items())
    return f"{case}: {time.monotonic() - began:.0f} s, {simulated_s:.1f} s simulated, {figures}{end}"


def main() -> int:
    """Play the cases."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--root", type=Path, required=True, help="a checkout of ScenarioRunner")
    parser.add_argument("--python", type=Path, required=True, help="a Python with its requirements")
    parser.add_argument("--agents", type=Path, required=True, help="the folder that has CARLA's package `agents`")
    parser.add_argument("--folder", type=Path, metavar="DIR", help="keep files and outputs there")
    parser.add_argument("cases", nargs="+", metavar="CASE")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = (arguments.folder or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        for case in arguments.cases:
            print(played(case, folder, arguments), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
