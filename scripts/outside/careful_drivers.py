"""Let the Joint Research Centre's public program drive its grids, and compare BASU's models case by case.

usage: careful_drivers.py JRC-FSM [--results FOLDER] [--page FILE]

JRC-FSM is a clone of github.com/ec-jrc/JRC-FSM; its comparisons need pandas and numba in this environment, and
some minutes. FOLDER keeps its tables, and what is there is not computed again. FILE is a page with a table between the
comments `<!-- agreement -->`. The exit status is 1 if a case disagrees.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from basu.metrics.careful_driver.metric import MODELS

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from grids_ahead import cut_out_contacts, deceleration_contacts
from standard_grid import GAPS_M, LATERAL_MPS, by_speeds, contacts, speeds_kmh

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import CarefulDriver

THEIRS = {"FSM": "FSM", "CC": "CC_human_driver", "RSS": "RSS", "Reg157": "Reg157"}  # names of the program's files
START, END = "<!-- agreement -->\n", "<!-- /agreement -->"
RUN = "from utility import comparison_cut_in; comparison_cut_in.run_loop('low')"
AHEAD = {  # the grids of vehicles ahead: the program's module, BASU's contacts
    "cut_out": ("comparison_cut_out", cut_out_contacts),
    "car_following": ("comparison_car_following", deceleration_contacts),
}
NAMES = {"cut_out": "cut-out", "car_following": "deceleration"}


def main() -> int:
    """Compare all models."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--results", type=Path)
    parser.add_argument("--page", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = (arguments.results or Path(scratch)).resolve()
        compute(arguments.program.resolve(), folder)
        rows = [row_of(model, folder) for model in MODELS]
        rows += [row_ahead(model, grid, folder) for grid in AHEAD for model in MODELS if model.name != "Reg157"]
    table = "\n".join(
        [
            "| situation | model | cases | contacts, public program | contacts, BASU | agree | differ |",
            "|---|---|---|---|---|---|---|",
            *(row for row, _ in rows),
        ]
    )
    print(table)
    if arguments.page is not None:
        text = arguments.page.read_text(encoding="utf-8")
        before, after = text.split(START)[0], text.split(END)[1]
        arguments.page.write_text(f"{before}{START}{table}\n{END}{after}", encoding="utf-8")
    return 1 if any(differ for _, differ in rows) else 0


def compute(program: Path, folder: Path) -> None:
    """Let the public program write its tables into a folder, unless they are all there."""
    environment = {**os.environ, "PYTHONPATH": str(program)}
    for grid, (module, _) in AHEAD.items():
        if len(list((folder / "results" / grid).glob("*.csv"))) < len(THEIRS) - 1:
            (folder / "results").mkdir(parents=True, exist_ok=True)
            run = f"from utility import {module} as grid; grid.run_loop()"
            subprocess.run([sys.executable, "-c", run], cwd=folder, env=environment, check=True)
    tables = folder / "results" / "cut_in_low_speed"
    if len(list(tables.glob("*.csv"))) == len(speeds_kmh()) * len(THEIRS):
        return
    tables.mkdir(parents=True, exist_ok=True)
    subprocess.run([sys.executable, "-c", RUN], cwd=folder, env=environment, check=True)


def row_of(model: "CarefulDriver", folder: Path) -> tuple[str, int]:
    """Return a row of the table, and the number of cases that differ; each of these is printed."""
    differ = theirs = ours = cases = 0
    for (own_kmh, other_kmh), found in by_speeds(contacts(model)):
        public = read(folder / "results" / "cut_in_low_speed" / f"{THEIRS[model.name]}_{own_kmh}_{other_kmh}.csv")
        cases, theirs, ours = cases + found.size, theirs + int(public.sum()), ours + int(found.sum())
        for lateral, gap in np.argwhere(public != found):
            differ += 1
            case = f"{own_kmh} behind {other_kmh} km/h, {GAPS_M[gap]} m, {LATERAL_MPS[lateral]:.1f} m/s"
            print(f"{model.name} {case}: public {public[lateral, gap]}, ours {found[lateral, gap]}", file=sys.stderr)
    return f"| cut-in | {model.name} | {cases:,} | {theirs:,} | {ours:,} | {cases - differ:,} | {differ} |", differ


def row_ahead(model: "CarefulDriver", grid: str, folder: Path) -> tuple[str, int]:
    """Return a row of the table for a grid of vehicles ahead, and the number of cases that differ."""
    with (folder / "results" / grid / f"{THEIRS[model.name]}_{grid}.csv").open(newline="") as lines:
        public = np.array([row["Crash"] == "True" for row in csv.DictReader(lines)])
    found = AHEAD[grid][1](model).ravel()
    for case in np.flatnonzero(public != found):
        print(f"{model.name} {NAMES[grid]} {case}: public {public[case]}, ours {found[case]}", file=sys.stderr)
    differ, cases = int((public != found).sum()), len(found)
    counts = f"{cases:,} | {int(public.sum()):,} | {int(found.sum()):,} | {cases - differ:,} | {differ}"
    return f"| {NAMES[grid]} | {model.name} | {counts} |", differ


def read(file: Path) -> NDArray[np.bool_]:
    """Return the contacts of one table of the public program, (lateral speeds, gaps)."""
    with file.open(newline="") as lines:
        rows = [row["Crash"] == "True" for row in csv.DictReader(lines)]
    return np.array(rows).reshape(len(GAPS_M), len(LATERAL_MPS)).T


if __name__ == "__main__":
    sys.exit(main())
