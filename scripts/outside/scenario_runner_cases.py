"""Play exported cases with the public ScenarioRunner on `linden serve`, and compare its actors with the files.

usage: scenario_runner_cases.py --root SCENARIO_RUNNER --python PYTHON --agents FOLDER [--folder DIR] [--workers N]
       [--table FILE.md] [CASE...]

PYTHON has ScenarioRunner's requirements (docs/how-to/scenario-runner.md). FOLDER has CARLA's package `agents`. Each
case gets a line: how late its motions and its end come, seconds of simulated time, and how far each actor is from its
motions at most, over all frames of the run. The begin of each motion is the one that fits best, in steps of 50 ms.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import json
import math
import os
import queue
import socket
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np
from fitted_motions import fit, motions_in
from placed_cases import placed_cases, reasons

from basu.errors import BasuError
from basu.scenarios.cases import ALL
from basu.scenarios.stage import EGO
from basu_openscenario.exporting.case_export import SCENARIO_RUNNER, export_case

sys.path.append(str(Path(__file__).parents[2] / "tests"))
from servers import running_server

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu_openscenario.exporting.case_export import Exported

FRAME_S, EXACT_S = 0.05, 1e-6
"""The length of ScenarioRunner's frames. A frame by the clock is never as long so exactly."""
LONGEST_S = 300.0
"""A run of more wall time is broken off."""
NEAR_M = 0.2
MOVES = ("vehicle", "walker", "static")
HEAD = """# Exported cases in ScenarioRunner

<!-- written by scripts/outside/scenario_runner_cases.py, which needs ScenarioRunner -->

`basu scenario export --for scenario-runner` wrote {written} of {all} cases for this table. ScenarioRunner 0.9.16
played {played} of them to their end on `linden serve`, and {near} of these are within {limit} m. The table has a row
for each scenario:

- played: how many of the written cases came to their end.
- late: how much later or earlier than in the rehearsal a motion begins, an actor leaves or the case ends, at most, s.
  ScenarioRunner looks at conditions once in a frame of 50 ms.
- distance: the greatest distance of an actor from the motions in the file, m. All actors count, in all frames of the
  run. The motions begin where they fit best, in steps of 50 ms.

How to play such a case is on the [page of ScenarioRunner](../how-to/scenario-runner.md#cases-of-basu).

| scenario | written | played | late, s | distance, m | refused, because of |
|---|---|---|---|---|---|
"""
Rows = dict[str, list[tuple[float, float, float]]]
"""Time in s, x and y in m of each actor, by its role."""


class Line(NamedTuple):
    """The result of one case: how far and how late its actors were, or why it was not written."""

    case: str
    scenario: str
    refusal: str = ""
    late_s: float = math.nan
    simulated_s: float = math.nan
    worst_m: Mapping[str, float] = MappingProxyType({})
    said: str = ""
    """Why the run did not come to its end."""

    @property
    def distance_m(self) -> float:
        """The greatest distance of all actors."""
        return max(self.worst_m.values(), default=math.inf)

    def __str__(self) -> str:
        """Return how the result of the case is printed: refused, or with its figures."""
        if self.refusal:
            return f"refused  {self.case}: {self.refusal}"
        figures = ", ".join(f"{name} {value:.3f} m" for name, value in self.worst_m.items())
        return f"{self.case}: {self.late_s:.2f} s late, {self.simulated_s:.1f} s simulated, {figures}{self.said}"


def watch(port: int, is_over: threading.Event, rows: Rows) -> None:
    """Note the places of all actors with a role in each frame of the run, until ``is_over`` is set.

    These are the frames that ScenarioRunner ticks. Before and after them the server ticks by its clock.
    """
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(60.0)
    world = client.get_world()
    frames: list[carla.WorldSnapshot] = []
    called = world.on_tick(frames.append)
    roles: dict[int, str] = {}
    while not is_over.wait(0.05):
        snapshot = world.get_snapshot()
        for actor in world.get_actors([one.id for one in snapshot if one.id not in roles]):
            moves = actor.type_id.partition(".")[0] in MOVES
            roles[actor.id] = actor.attributes.get("role_name", "") if moves else ""
    world.remove_on_tick(called)
    for snapshot in frames:
        if abs(snapshot.timestamp.delta_seconds - FRAME_S) > EXACT_S:
            continue
        for one in snapshot:
            if roles.get(one.id):
                place = one.get_transform().location
                rows[roles[one.id]].append((snapshot.timestamp.elapsed_seconds, place.x, place.y))


def free_port() -> int:
    """Return a port that is free now."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def played(line: Line, exported: Exported, path: Path, arguments: argparse.Namespace, port: int) -> Line:
    """Return the line of an exported case, after it was played on the server at a port."""
    root = arguments.root.resolve()
    own = {"SCENARIO_RUNNER_ROOT": str(root), "PYTHONPATH": f"{arguments.agents.resolve()}:{root}"}
    rows: Rows = collections.defaultdict(list)
    is_over = threading.Event()
    watcher = threading.Thread(target=watch, args=(port, is_over, rows))
    watcher.start()
    command = [str(arguments.python), "scenario_runner.py", "--sync", "--timeout", "60", "--openscenario", str(path)]
    command += ["--port", str(port), "--trafficManagerPort", str(free_port())]
    try:
        done = subprocess.run(
            command, cwd=root, env={**os.environ, **own}, capture_output=True, text=True, check=False,
            timeout=LONGEST_S,
        )  # fmt: skip
        said, end = done.stdout + done.stderr, "" if done.returncode == 0 else f", ended with {done.returncode}"
    except subprocess.TimeoutExpired as error:
        said, end = str(error.stdout), f", broken off after {LONGEST_S:.0f} s"
    is_over.set()
    watcher.join()
    path.with_suffix(".txt").write_text(said, encoding="utf-8")
    path.with_suffix(".json").write_text(json.dumps(rows), encoding="utf-8")
    return compared(line._replace(said=end), exported, path, rows)


def compared(line: Line, exported: Exported, path: Path, rows: Rows) -> Line:
    """Return the line with the distances of the actors from the file, and how late they are."""
    motions, places = motions_in(ET.parse(path).getroot())
    if not set(places) <= set(rows):
        return line._replace(said=f"{line.said}, actors in the run: {', '.join(rows) or 'none'}")
    driven = {name: np.array(rows[name]) for name in places}
    begin_s = fit(places[EGO], motions[EGO], exported.begins_s, driven[EGO]).begins_s[0]
    fits = {name: fit(places[name], motions[name], exported.begins_s, driven[name], begin_s) for name in places}
    late_s = [
        began_s - begin_s - exported.begins_s[motion.event]
        for name in places
        for motion, began_s in zip(motions[name], fits[name].begins_s, strict=True)
    ]
    for name in places:  # its departure, or the end of the case
        lasts_s = exported.played.times_s[~np.isnan(exported.played.trails[name][:, 0])][-1]
        late_s.append(driven[name][-1, 0] - begin_s - lasts_s)
    return line._replace(
        late_s=max(late_s, key=abs),
        simulated_s=driven[EGO][-1, 0] - driven[EGO][0, 0],
        worst_m={name: each.worst_m for name, each in fits.items()},
    )


def written(words: Sequence[str], folder: Path) -> Iterator[tuple[Line, Exported | None, Path]]:
    """Export cases, each into a file in ``folder``."""
    for playable, scenario, opendrive in placed_cases(words):
        case = playable.case.name
        line, path = Line(case, playable.scenario.__name__), folder / f"{case}.xosc"
        try:
            yield line, export_case(playable, scenario, opendrive, path, SCENARIO_RUNNER), path
        except BasuError as error:
            yield line._replace(refusal=str(error)), None, path


def table(lines: Sequence[Line]) -> str:
    """Return the page with a row of the table for each scenario."""
    by_scenario: dict[str, list[Line]] = collections.defaultdict(list)
    for line in lines:
        by_scenario[line.scenario].append(line)
    rows = []
    for name, of_it in sorted(by_scenario.items()):
        own = [line for line in of_it if not line.refusal]
        ended = [line for line in own if not line.said]
        late_s, far_m = (
            max((abs(one.late_s) for one in own), default=0),
            max((one.distance_m for one in own), default=0),
        )
        figures = f"{late_s:.2f} | {far_m:.2f}" if own else " | "
        short = reasons(line.refusal for line in of_it)
        rows.append(f"| {name} | {len(own)} | {len(ended)} | {figures} | {short} |")
    own = [line for line in lines if not line.refusal]
    ended = [line for line in own if not line.said]
    near = sum(line.distance_m <= NEAR_M for line in ended)
    head = HEAD.format(written=len(own), all=len(lines), played=len(ended), near=near, limit=NEAR_M)
    return head + "\n".join(rows) + "\n"


def main() -> int:
    """Export, play and compare the cases."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--root", type=Path, required=True, help="a checkout of ScenarioRunner")
    parser.add_argument("--python", type=Path, required=True, help="a Python with its requirements")
    parser.add_argument("--agents", type=Path, required=True, help="the folder that has CARLA's package `agents`")
    parser.add_argument("--folder", type=Path, metavar="DIR", help="keep files, outputs and places of actors there")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="how many play at once (default: 1)")
    parser.add_argument("--table", type=Path, metavar="FILE.md", help="write the table there, after each case anew")
    parser.add_argument("cases", nargs="*", default=[ALL], metavar="CASE")
    arguments = parser.parse_args()
    lines: dict[str, Line] = {}
    ports: queue.Queue[int] = queue.Queue()

    def play(line: Line, exported: Exported | None, path: Path) -> None:
        began = time.monotonic()
        done = line
        if exported is not None:
            port = ports.get()
            done = played(line, exported, path, arguments, port)
            ports.put(port)
        print(f"{done} ({time.monotonic() - began:.0f} s)", flush=True)
        lines[line.case] = done
        if arguments.table is not None:
            arguments.table.write_text(table(list(lines.values())), encoding="utf-8")

    with (
        tempfile.TemporaryDirectory() as temporary,
        contextlib.ExitStack() as servers,
        ThreadPoolExecutor(arguments.workers) as pool,
    ):
        for _ in range(arguments.workers):
            ports.put(servers.enter_context(running_server()).port)
        folder = (arguments.folder or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        for one in [pool.submit(play, *made) for made in written(arguments.cases, folder)]:
            one.result()
    return 0


if __name__ == "__main__":
    sys.exit(main())
