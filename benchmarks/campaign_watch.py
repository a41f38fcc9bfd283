"""Drives a campaign for a while and shows its memory over time, its drives a second, and its processor time.

    python benchmarks/campaign_watch.py --seconds 500 --every 30 -- campaign.toml [OPTIONS OF basu campaign run]

A row has the drives so far and the resident memory, in MB, of the command (the driver) and the largest of its workers,
simulators and agents. After ``--seconds`` the command gets Ctrl-C, so it can go on with ``--resume``.
``taskset -c 0,1`` before it keeps everything on two processors.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil

from basu.campaigns.campaign_folder import PROGRESS_FILE
from basu.campaigns.cost import cost_of
from basu.campaigns.drive_table import read_drives
from basu.campaigns.planning import plan_of
from basu.campaigns.settings import read_campaign
from basu.files import read_json

ROLES = {"worker": "basu.jobs.processes", "agent": "basu.agents.process", "simulator": "linden"}  # by command lines
END_S = 60.0
BASU = [sys.executable, "-c", "from basu.cli import entry_point; entry_point()"]


def largest_mb(driver: psutil.Process) -> dict[str, float]:
    """The memory of the driver, and of the largest of each role below it."""
    found = {"driver": driver.memory_info().rss / 1e6, **dict.fromkeys(ROLES, 0.0)}
    for child in driver.children(recursive=True):
        try:
            words, resident_mb = " ".join(child.cmdline()), child.memory_info().rss / 1e6
        except psutil.Error:  # it has ended
            continue
        for role, word in ROLES.items():
            if word in words:
                found[role] = max(found[role], resident_mb)
                break
    return found


def driven(folder: Path) -> int:
    """The rows so far."""
    path = folder / PROGRESS_FILE
    return int(read_json(path, "the progress")["done"]) if path.exists() else 0


def watch(command: subprocess.Popen[bytes], folder: Path, seconds: float, every: float) -> tuple[float, float]:
    """Print a row every so many s; return s of wall time and of processor time until the interrupt or the end."""
    began_s, driver = time.monotonic(), psutil.Process(command.pid)
    cpu_s = 0.0
    for row in range(1, round(seconds / every) + 1):
        try:
            command.wait(max(0.0, began_s + row * every - time.monotonic()))
            break
        except subprocess.TimeoutExpired:
            cpu_s = cost_of(command.pid).cpu_s
            memory = "".join(f"{value:11.0f}" for value in largest_mb(driver).values())
            print(f"{row * every:8.0f}{driven(folder):8d}{memory}", flush=True)
    took_s = time.monotonic() - began_s
    if command.poll() is None:
        command.send_signal(signal.SIGINT)
        command.wait(END_S)
    return took_s, cpu_s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign", type=Path)
    parser.add_argument("--seconds", type=float, default=500.0)
    parser.add_argument("--every", type=float, default=30.0)
    parser.add_argument("--output", type=Path, default=Path("campaigns"))
    parser.add_argument("options", nargs="*", help="of basu campaign run")
    given = parser.parse_args()
    if any(option.startswith("--output") for option in given.options):
        parser.error("--output stands before --: this script reads the folder as well")
    folder = given.output / plan_of(read_campaign(given.campaign), given.campaign).campaign.name
    before = read_drives(folder).num_rows if folder.exists() else 0
    print(f"{len(os.sched_getaffinity(0))} processors for it, load {os.getloadavg()[0]:.1f}")
    print("".join(name.rjust(8) for name in ("s", "drives")) + "".join(name.rjust(11) for name in ("driver", *ROLES)))
    words = [*BASU, "campaign", "run", str(given.campaign), "--output", str(given.output), *given.options]
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a script's shell ignores it for commands with &
    command = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    took_s, cpu_s = watch(command, folder, given.seconds, given.every)
    rows = read_drives(folder, ["simulated_s", "cpu_s", "fault"])
    done, simulated_s = rows.num_rows - before, sum(rows["simulated_s"].to_pylist()[-(rows.num_rows - before) :])
    drives_s = sum(rows["cpu_s"].to_pylist()) * 3600.0 / sum(rows["simulated_s"].to_pylist())
    print(f"{done} drives in {took_s:.0f} s with the start of the workers: {done / took_s:.2f} a second")
    print(f"{rows.num_rows} rows; processor seconds for a simulated hour: {drives_s:.0f} in drives")
    print(f"with driver, start and idle: {3600.0 * cpu_s / simulated_s:.0f}")


if __name__ == "__main__":
    main()
