"""Play OpenSCENARIO files in our kinematic mode and in esmini, and compare every entity in every step.

usage: esmini_compare.py --esmini PROGRAM FILE.xosc... [--step S] [--longest S] [--table FILE.md]

Each file gets a line: played or refused and why, the greatest distance and angle over all entities and steps, and the
greatest difference of the same change of state in steps. A file counts as agreed within 1 cm, 1 mrad and no step.
Controllers are off in both: all entities play as the file is written. esmini then leaves out the actions that assign or
activate one, so that their changes of state do not count here.

esmini draws the way at a junction by its seed, and BASU takes the straightest one. A file that differs is therefore
compared with the draws of several seeds, and the nearest one counts.
"""

from __future__ import annotations

import argparse
import collections
import csv
import math
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import BasuError
from basu_openscenario.playing.at_once import ControllerActivation, ControllerAssignment
from basu_openscenario.playing.player import Change, Frame, Player, make_player
from basu_openscenario.reading.scenario_file import read_scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

CLOSE_M, CLOSE_RAD = 0.01, 0.001
SEEDS = tuple(range(1, 9))
"""The seeds of esmini whose draws are tried, until the file agrees."""
LARGEST_LOG = 200 * 1024 * 1024
"""Bytes that esmini may write: a scenario without an end goes on until then."""
HEAD = """# Files that esmini judges

<!-- written by scripts/outside/esmini_compare.py, which needs esmini -->

The kinematic mode and esmini 3.6.0 play the same files in steps of 10 ms. Distance and angle are the greatest ones over
all entities and steps. The events are changes of state that both have, with the greatest difference in steps. A file
agrees within 1 cm, 1 mrad and the same step. The last column has the first difference, or the refusal.
Vehicles of traffic are drawn by chance in both, and are not compared.
[The decision](../decisions/0127-esmini.md) has the causes of the differences.

{files} files: {played} played, {agreed} agree; {times}.

| file | result | distance, mm | angle, mrad | events, steps | where, or why |
|---|---|---|---|---|---|
"""
_CHANGE = re.compile(r"\[(-?[\d.]+)\] \[info\] (.*?) (\w+State) -> (\w+Transition) -> (\w+State)")
_HEADER = re.compile(r"#(\d+) (\w+)")


class Row(NamedTuple):
    """An entity in esmini's log: m, rad and m/s."""

    x_m: float
    y_m: float
    z_m: float
    h_rad: float
    p_rad: float
    speed_mps: float


class Judged(NamedTuple):
    """What came of a file; distances in m, angles in rad, events in steps."""

    played: bool
    why: str
    distance_m: float = math.nan
    angle_rad: float = math.nan
    where: str = ""
    events: int = 0
    event_steps: float = math.nan
    lost_events: int = 0
    own_s: float = 0.0
    esmini_s: float = 0.0
    length_s: float = 0.0
    other_length_s: float = 0.0

    @property
    def agrees(self) -> bool:
        """Whether all entities and events agree."""
        close = self.distance_m < CLOSE_M and self.angle_rad < CLOSE_RAD
        return self.played and close and self.event_steps < 0.5 and self.lost_events == 0


def esmini_log(
    program: Path, file: Path, step_s: float, seed: int = SEEDS[0], more: Sequence[str] = ()
) -> tuple[dict[int, dict[str, Row]], list[tuple[float, str, str]], float]:
    """Return esmini's poses by step and entity, its changes of state, and its wall time in s.

    ``more`` are further options of esmini.
    """
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        command = [str(program), "--headless", "--osc", str(file), "--fixed_timestep", str(step_s)]
        command += ["--csv_logger", "poses.csv", "--disable_controllers", "--path", str(file.parent)]
        command += ["--seed", str(seed), *more]
        limit = (LARGEST_LOG, LARGEST_LOG)
        try:
            done = subprocess.run(
                command,
                cwd=folder,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=60,
                check=False,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit),
            )
            output = done.stdout
        except subprocess.TimeoutExpired as error:
            output = (error.stdout or b"").decode(errors="replace")
        wall_s = time.perf_counter() - began
        poses = Path(folder) / "poses.csv"
        rows = _rows(poses, step_s) if poses.is_file() else {}
        log = Path(folder) / "log.txt"
        text = log.read_text(errors="replace") if log.is_file() else output
    changes = [(float(one[1]), one[2], f"{one[4]}>{one[5]}") for one in _CHANGE.finditer(text)]
    return rows, changes, wall_s


def _rows(path: Path, step_s: float) -> dict[int, dict[str, Row]]:
    """Return the poses of a log: one line a step, all entities beside each other."""
    found: dict[int, dict[str, Row]] = {}
    with path.open(newline="") as file:
        header: list[str] = []
        for cells in csv.reader(file, skipinitialspace=True):
            if cells and cells[0].startswith("Index"):
                header = [cell.split(" [")[0] for cell in cells]
                continue
            if not header or len(cells) < 20:
                continue
            width = (
                next(n for n, name in enumerate(header) if name.startswith("#2")) - 2
                if any(name.startswith("#2") for name in header)
                else len(header) - 2
            )
            names = [name.split(" ", 1)[1] for name in header[2 : 2 + width] if " " in name]
            entities = {}
            for start in range(2, len(cells) - 15, width):
                part = dict(zip(names, cells[start : start + width], strict=False))
                try:
                    entities[part["Entity_Name"]] = Row(
                        float(part["World_Position_X"]),
                        float(part["World_Position_Y"]),
                        float(part["World_Position_Z"]),
                        float(part["World_Heading_Angle"]),
                        float(part["World_Pitch_Angle"]),
                        float(part["Current_Speed"]),
                    )
                except (KeyError, ValueError):
                    break  # the last line of a log that was cut off
            found[round(float(cells[1]) / step_s)] = entities
    return found


def compare(program: Path, file: Path, step_s: float, longest_s: float) -> Judged:
    """Play a file twice and compare."""
    began = time.perf_counter()
    try:
        player = make_player(read_scenario(file), with_controllers=False)
        frames = list(player.play(step_s, longest_s))
    except BasuError as error:
        return Judged(played=False, why=str(error).replace(f"{file.parent}/", ""))
    own_s = time.perf_counter() - began
    best: Judged | None = None
    drawn: set[float] = set()
    for seed in SEEDS:
        rows, changes, esmini_s = esmini_log(program, file, step_s, seed)
        if not rows:
            return Judged(played=True, why="esmini wrote no poses", own_s=own_s, esmini_s=esmini_s)
        distance_m, angle_rad, where = _apart(frames, rows, step_s)
        events, steps, lost = _events(_without_controllers(player), changes, step_s, longest_s)
        ends = frames[-1].time_s, min(max(rows) * step_s, longest_s)
        found = Judged(True, "", distance_m, angle_rad, where, events, steps, lost, own_s, esmini_s, *ends)
        if best is None or found.distance_m < best.distance_m:
            best = found
        drawn.add(distance_m)
        if best.agrees or (seed == SEEDS[2] and len(drawn) == 1):  # nothing depends on the draws
            break
    assert best is not None, "there is a seed"
    return best


def _apart(frames: list[Frame], rows: dict[int, dict[str, Row]], step_s: float) -> tuple[float, float, str]:
    """Return the greatest distance in m and angle in rad, and where the distance first exceeds a centimetre."""
    worst_m = worst_rad = 0.0
    where = ""
    for frame in frames:
        others = rows.get(round(frame.time_s / step_s), {})
        for pose in frame.poses:
            other = others.get(pose.name)
            if other is None:
                continue
            gap_m = math.dist((pose.x_m, pose.y_m, pose.z_m), (other.x_m, other.y_m, other.z_m))
            gap_rad = max(
                abs(math.remainder(pose.h_rad - other.h_rad, math.tau)),
                abs(math.remainder(pose.p_rad - other.p_rad, math.tau)),
            )
            if not where and (gap_m > CLOSE_M or gap_rad > CLOSE_RAD):
                where = f"{pose.name} at {frame.time_s:.2f} s"
            worst_m, worst_rad = max(worst_m, gap_m), max(worst_rad, gap_rad)
    return worst_m, worst_rad, where


def _without_controllers(player: Player) -> list[Change]:
    """Return the changes of state of all elements but the actions on controllers."""
    kinds = (ControllerAssignment, ControllerActivation)
    left_out = {element.path for element in player.board.all() if isinstance(element, kinds)}
    return [change for change in player.changes if change.path not in left_out]


def _events(
    own: list[Change], other: list[tuple[float, str, str]], step_s: float, longest_s: float
) -> tuple[int, float, int]:
    """Return how many changes of state both have, the greatest difference in steps, and how many only one has."""
    ours: dict[tuple[str, str], list[float]] = collections.defaultdict(list)
    theirs: dict[tuple[str, str], list[float]] = collections.defaultdict(list)
    for change in own:
        if change.transition and change.kind != "storyboard" and change.time_s < longest_s - step_s:
            name = change.path.rsplit("::", 1)[-1]
            ours[name, change.state].append(change.time_s)
    names = {name for name, _ in ours} | {change.path.rsplit("::", 1)[-1] for change in own}
    for time_s, name, kind in other:
        transition, state = kind.split(">")  # esmini says that actions on the world stop, the standard that they end
        if name in names and transition != "initToStandbyTransition" and time_s < longest_s - step_s:
            theirs[name, state].append(time_s)
    both, lost, worst = 0, 0, 0.0
    for key in {*ours, *theirs}:
        mine, its = ours[key], theirs[key]
        pairs = list(zip(mine, its, strict=False))
        both += len(pairs)
        lost += abs(len(mine) - len(its))
        worst = max([worst, *(abs(a - b) / step_s for a, b in pairs)])
    return both, worst, lost


def line_of(file: Path, judged: Judged) -> str:
    """Return the line of a file."""
    if not judged.played:
        return f"refused  {file.name}: {judged.why}"
    if judged.why:
        return f"played   {file.name}: {judged.why}"
    verdict = "agrees " if judged.agrees else "differs"
    return (
        f"{verdict}  {file.name}: {judged.distance_m * 1000:.1f} mm, {judged.angle_rad * 1000:.2f} mrad, "
        f"{judged.events} events within {judged.event_steps:.0f} steps, {judged.lost_events} in one alone; "
        f"{judged.length_s:.2f}/{judged.other_length_s:.2f} s in {judged.own_s:.2f}/{judged.esmini_s:.2f} s"
        + (f"; first {judged.where}" if judged.where else "")
    )


def main() -> int:
    """Compare the files and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--esmini", type=Path, required=True, help="the program, built without graphics")
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--step", type=float, default=0.01, metavar="S")
    parser.add_argument("--longest", type=float, default=60.0, metavar="S")
    parser.add_argument("--table", type=Path, metavar="FILE.md", help="write the lines as a table there as well")
    arguments = parser.parse_args()
    results = []
    for file in arguments.files:
        judged = compare(arguments.esmini.resolve(), file.resolve(), arguments.step, arguments.longest)
        results.append((file, judged))
        print(line_of(file, judged), flush=True)
    played = [judged for _, judged in results if judged.played]
    agreed = [judged for judged in played if judged.agrees]
    own_s, esmini_s = (sum(getattr(one, name) for one in played) for name in ("own_s", "esmini_s"))
    times = f"{own_s:.1f} s here, {esmini_s:.1f} s in esmini"
    print(f"{len(results)} files, {len(played)} played, {len(agreed)} agree; {times}")
    if arguments.table is not None:
        rows = [_table_row(file, judged) for file, judged in results]
        head = HEAD.format(files=len(results), played=len(played), agreed=len(agreed), times=times)
        arguments.table.write_text(head + "".join(rows), encoding="utf-8")
    return 0


def _table_row(file: Path, judged: Judged) -> str:
    """Return a row of the table."""
    if not judged.played or judged.why:
        return f"| {file.name} | {'played' if judged.played else 'refused'} | | | | {judged.why} |\n"
    verdict = "agrees" if judged.agrees else "differs"
    events = f"{judged.events}, {judged.event_steps:.0f}" + (
        f", {judged.lost_events} alone" if judged.lost_events else ""
    )
    figures = f"{judged.distance_m * 1000:.1f} | {judged.angle_rad * 1000:.2f} | {events}"
    return f"| {file.name} | {verdict} | {figures} | {judged.where} |\n"


if __name__ == "__main__":
    sys.exit(main())
