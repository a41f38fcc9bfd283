"""Export all cases as OpenSCENARIO files, play each in our kinematic mode and in esmini, and write the table of them.

usage: exported_cases.py --esmini PROGRAM [--table FILE.md] [--folder DIR] [--most N] [--workers N] [CASE...]

Each case gets a line: how late its motions begin, and how far its entities are from the rehearsal that the file was
made of, over all entities and steps of 10 ms. The table has a row for each scenario, with its worst figures.
"""

from __future__ import annotations

import argparse
import collections
import itertools
import math
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from esmini_compare import esmini_log
from placed_cases import placed_cases, reasons

from basu.errors import BasuError, ScenarioError
from basu.scenarios.cases import ALL, cases_of
from basu_openscenario.exporting.case_export import STEP_S, export_case
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.testing import Rehearsal
    from basu_openscenario.exporting.case_export import Exported

LONGEST_S = 95.0
HEAD = """# Exported cases

<!-- written by scripts/outside/exported_cases.py, which needs esmini -->

`basu scenario export` writes {written} of the {all} cases that come with BASU; {played} of them were played for this
table. It has a row for each scenario:

- played: how many of the written cases were played.
- late: how much later or earlier than in the rehearsal a motion begins, at most, s.
- here: the greatest distance of an entity from the rehearsal in the kinematic mode of `basu-openscenario`, m.
- esmini: the same in esmini 3.6.0 with `--traj_filter 0`. Without this option esmini merges points of a trajectory that
  are within 5 cm, and an actor that starts slowly can be 0.6 m off.

The distances are over all entities and all steps of 10 ms, in the plane. See [OpenSCENARIO](openscenario.md). What
ScenarioRunner makes of the cases is in a [table of its own](scenario-runner-cases.md).

| scenario | cases | written | played | late, s | here, m | esmini, m | refused, because of |
|---|---|---|---|---|---|---|---|
"""


class Line(NamedTuple):
    """The result of one case: whether it was written, and its distances from the rehearsal."""

    case: str
    scenario: str
    refusal: str = ""
    late_s: float = math.nan
    own_m: float = math.nan
    esmini_m: float = math.nan

    @property
    def is_played(self) -> bool:
        """Whether it was played and compared."""
        return not math.isnan(self.esmini_m)

    def __str__(self) -> str:
        """Return how the result of the case is printed: refused, written, or with its figures."""
        if self.refusal:
            return f"refused  {self.case}: {self.refusal}"
        if not self.is_played:
            return f"written  {self.case}"
        return f"written  {self.case}: {self.late_s:.2f} s, {self.own_m:.3f} m here, {self.esmini_m:.3f} m in esmini"


def apart_m(played: Rehearsal, steps: Mapping[int, Mapping[str, tuple[float, float]]]) -> float:
    """Return the greatest distance in m of places in OpenDRIVE's axes, by step and name, from a rehearsal."""
    worst_m = 0.0
    for nth, time_s in enumerate(played.times_s):
        there = steps.get(round(float(time_s) / STEP_S), {})
        for name, trail in played.trails.items():
            if name in there and not math.isnan(trail[nth, 0]):
                worst_m = max(worst_m, math.dist(there[name], (trail[nth, 0], -trail[nth, 1])))
    return worst_m


def judged(case: str, scenario: str, exported: Exported, path: Path, program: Path) -> Line:
    """Return the line of an exported case, after it was played twice."""
    player = make_player(read_scenario(path))
    own = {
        round(frame.time_s / STEP_S): {pose.name: (pose.x_m, pose.y_m) for pose in frame.poses}
        for frame in player.play(STEP_S, LONGEST_S)
    }
    begun = {
        change.path.rsplit("::", 1)[-1]: change.time_s
        for change in reversed(player.changes)
        if change.kind == "event" and change.state == "runningState"
    }
    late_s = max((abs(begun.get(name, math.inf) - at_s) for name, at_s in exported.begins_s.items()), default=0.0)
    rows, _, _ = esmini_log(program, path, STEP_S, more=["--traj_filter", "0"])
    others = {step: {name: (row.x_m, row.y_m) for name, row in rows[step].items()} for step in rows}
    if not others:
        raise ScenarioError(f"{case}: esmini wrote no poses")
    return Line(case, scenario, "", late_s, apart_m(exported.played, own), apart_m(exported.played, others))


def lines_of(words: Sequence[str], folder: Path, program: Path, most: int) -> list[Line]:
    """Return the lines of all cases; of each scenario, at most so many are played."""
    folder.mkdir(parents=True, exist_ok=True)
    found: list[Line] = []
    for playable, scenario, opendrive in placed_cases(words):
        case, kind = playable.case.name, playable.scenario.__name__
        path = folder / f"{case}.xosc"
        try:
            exported = export_case(playable, scenario, opendrive, path)
            is_enough = sum(one.scenario == kind and one.is_played for one in found) >= most
            line = Line(case, kind) if is_enough else judged(case, kind, exported, path, program)
        except BasuError as error:
            line = Line(case, kind, str(error))
        print(line, flush=True)
        found.append(line)
    return found


def table(lines: Sequence[Line]) -> str:
    """Return the page with a row of the table for each scenario."""
    by_scenario: dict[str, list[Line]] = collections.defaultdict(list)
    for line in lines:
        by_scenario[line.scenario].append(line)
    rows = []
    for name, of_it in sorted(by_scenario.items()):
        written = [line for line in of_it if not line.refusal]
        played = [line for line in written if line.is_played]
        figures = (max((getattr(line, part) for line in played), default=math.nan) for part in Line._fields[3:])
        cells = [str(len(played)), *(f"{value:.2f}" if played else "" for value in figures)]
        short = reasons(line.refusal for line in of_it)
        rows.append(f"| {name} | {len(of_it)} | {len(written)} | {' | '.join(cells)} | {short} |")
    all_written = sum(not line.refusal for line in lines)
    all_played = sum(line.is_played for line in lines)
    return HEAD.format(written=all_written, all=len(lines), played=all_played) + "\n".join(rows) + "\n"


def main() -> int:
    """Export and compare the cases."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--esmini", type=Path, required=True, help="the program, built without graphics")
    parser.add_argument("--table", type=Path, metavar="FILE.md", help="write the table there")
    parser.add_argument(
        "--folder", type=Path, metavar="DIR", help="keep the files there, in a folder for each scenario"
    )
    parser.add_argument("--most", type=int, default=sys.maxsize, metavar="N", help="play N cases of each scenario")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes (default: 1)")
    parser.add_argument("cases", nargs="*", default=[ALL], metavar="CASE")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary, ProcessPoolExecutor(arguments.workers) as pool:
        folder = (arguments.folder or Path(temporary)).resolve()
        by_scenario: dict[str, list[str]] = collections.defaultdict(list)
        for playable in cases_of(arguments.cases):
            by_scenario[playable.scenario.__name__].append(playable.case.name)
        parts = pool.map(
            lines_of,
            by_scenario.values(),
            (folder / name for name in by_scenario),  # processes must not write one road file at once
            itertools.repeat(arguments.esmini.resolve()),
            itertools.repeat(arguments.most),
        )
        lines = [line for part in parts for line in part]
    if arguments.table is not None:
        arguments.table.write_text(table(lines), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
