"""Kills workers, the driver and nodes of Ray under campaigns; shows what was lost, counted twice, or changed.

    python benchmarks/campaign_kills.py [--drives 200] [--seed 0] [--by processes raylets]

The plan, the pool, the table and the records are the real ones; the player computes a row in a few ms instead of
driving. Every kill is SIGKILL. A killed driver is started again with ``--resume``. "Equal" compares all rows with those
of an undisturbed run, but for hosts, times and attempts.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import psutil
import pyarrow as pa

from basu.campaigns import command
from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.columns import VOLATILE
from basu.campaigns.drive_table import read_drives
from basu.campaigns.player import PlayerSettings
from basu.jobs.job import JobOutcome, Play, PlayerSpec
from basu.metrics.result import Result
from basu.metrics.score import Scores
from basu.metrics.success import Success
from basu.outcome import Outcome, Status
from basu.running.drive import DriveDone

CAMPAIGN = """
name = "kills"
agents = ["basic", "blind"]
seeds = {{number = {seeds}}}
[[drives]]
cases = ["pedestrian_crossing_1"]
sweep = 10
[work]
block = 20
"""
DRIVE_S = 0.1  # mean time that the player takes for a row
WORKERS = 4
LIMIT_S = 240.0  # of wall time for a row of the table
OBJECT_STORE_BYTES = 80_000_000


def computed(_settings: PlayerSettings) -> PlayerSpec:
    """The player of this benchmark in place of the one that drives."""
    return PlayerSpec(f"{Path(__file__).stem}:open_computed")


@contextlib.contextmanager
def open_computed() -> Iterator[Play]:
    """A player whose rows follow from the jobs alone."""

    def play(job: dict[str, Any]) -> JobOutcome:
        share = int(job["id"][:8], 16) / 16**8
        time.sleep(2.0 * DRIVE_S * share)
        result = Result(
            outcome=Outcome(Status.SCENARIO_ENDED, "computed"),
            scores=Scores(share, 1.0, share),
            infractions=(),
            metrics={},
            scoring={},
            meta={},
            success=Success(share > 0.1),
        )
        cost = {"wall_s": time.perf_counter(), "cpu_s": 1.0, "memory_mb": 1.0, "host": "here", "worker": os.getpid()}
        return JobOutcome(DriveDone(None, result, cost=cost))

    yield play


class Kill(NamedTuple):
    """What is killed when so many drives are written."""

    at: int
    what: str  # worker, workers, driver, node


class Trial:
    """One campaign under kills."""

    def __init__(self, file: Path, output: Path, cluster: Any = None) -> None:  # noqa: ANN401 - Ray's cluster
        self._file, self._output, self._cluster = file, output, cluster
        self.folder = output / "kills"
        self._driver = self._start()

    def _start(self) -> subprocess.Popen[bytes]:
        words = [sys.executable, __file__, "--drive-file", str(self._file), "--output", str(self._output)]
        words += ["--address", self._cluster.address] if self._cluster is not None else []
        return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def run(self, kills: list[Kill]) -> list[str]:
        """Kill in this order, wait for the end, and return what was killed and after how many drives."""
        said = []
        for kill in kills:
            done = self._wait(kill.at)
            if self._driver.poll() is not None:
                raise SystemExit(f"the campaign ended after {done} drives, before the kill at {kill.at}")
            self._kill(kill.what)
            said.append(f"{kill.what} at {done}")
        if self._driver.wait(LIMIT_S):
            raise SystemExit(f"the command ended with {self._driver.returncode}")
        return said

    def _kill(self, what: str) -> None:
        if what == "node":
            self._cluster.remove_node(self._cluster.worker_nodes.copy().pop(), allow_graceful=False)
        elif what == "driver":
            self._driver.kill()
            self._driver.wait()
            self._driver = self._start()
        else:
            for worker in self._workers()[: 1 if what == "worker" else None]:
                worker.kill()

    def _workers(self) -> list[psutil.Process]:
        """The processes that play: children of the driver, or Ray's actors of this benchmark."""
        if self._cluster is None:
            found = psutil.Process(self._driver.pid).children(recursive=True)
            return [each for each in found if "basu.jobs.processes" in " ".join(each.cmdline())]
        below = psutil.Process().children(recursive=True)
        return [each for each in below if each.name().startswith("ray::_Remote")]

    def _wait(self, drives: int) -> int:
        """Wait until so many drives are written; their number."""
        deadline_s = time.monotonic() + LIMIT_S
        while (done := self._done()) < drives and self._driver.poll() is None:
            if time.monotonic() > deadline_s:
                raise SystemExit(f"{done} drives in {LIMIT_S:g} s, {drives} were awaited")
            time.sleep(0.02)
        return done

    def _done(self) -> int:
        lines = sum(path.read_bytes().count(b"\n") for path in self.folder.glob("journal/*.jsonl") if path.exists())
        blocks = {path.name for path in self.folder.glob("drives/*/*.parquet")}
        blocks -= {path.with_suffix(".parquet").name for path in self.folder.glob("journal/*.jsonl")}
        return lines + 20 * len(blocks)


def steady(folder: Path) -> pa.Table:
    """The rows without hosts, times and attempts."""
    return read_drives(folder).drop_columns(list(VOLATILE))


def plans(drives: int, dice: random.Random, *, on_ray: bool) -> list[list[Kill]]:
    """The kills of each row, at random drives."""

    def sorted_at(*whats: str) -> list[Kill]:
        moments = sorted(dice.sample(range(drives // 10, drives * 8 // 10), len(whats)))
        return [Kill(at, what) for at, what in zip(moments, whats, strict=True)]

    if on_ray:
        return [sorted_at("node"), sorted_at("driver"), sorted_at("worker"), sorted_at("worker", "node", "driver")]
    rows = [sorted_at("worker"), sorted_at("workers"), sorted_at("driver")]
    return [*rows, sorted_at("worker", "driver", "workers", "driver", "worker")]


@contextlib.contextmanager
def raylets() -> Iterator[Callable[[], Any]]:
    """A function that returns the one cluster of three raylets, with a fresh node in place of a lost one."""
    from ray.cluster_utils import Cluster  # noqa: PLC0415 - an extra

    started: list[Any] = []

    def start() -> Any:  # noqa: ANN401 - Ray's cluster
        arguments = {"num_cpus": 2, "object_store_memory": OBJECT_STORE_BYTES}
        if not started:
            started.append(Cluster(initialize_head=True, head_node_args=arguments))
        while len(started[0].worker_nodes) < 2:
            started[0].add_node(**arguments)
        return started[0]

    try:
        yield start
    finally:
        for cluster in started:
            cluster.shutdown()


def show(by: str, kills: list[list[Kill]], scratch: Path, file: Path, start: Callable[[], Any]) -> None:
    """Print the rows of one kind of workers."""
    reference = steady(scratch / "undisturbed" / "kills")
    for nth, row in enumerate(kills):
        trial = Trial(file, scratch / f"{by}-{nth}", start())
        killed = ", ".join(trial.run(row))
        found, attempts = steady(trial.folder), read_drives(trial.folder, ["attempts"])["attempts"].to_pylist()
        numbers = found["number"].to_pylist()
        lost, twice = reference.num_rows - len(set(numbers)), len(numbers) - len(set(numbers))
        again, equal = sum(attempt > 1 for attempt in attempts), "yes" if found.equals(reference) else "NO"
        print(f"| {by} | {killed} | {again} | {lost} | {twice} | {equal} |", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0, help="of the moments of the kills")
    parser.add_argument(
        "--by", nargs="*", choices=["processes", "raylets"], default=["processes"], help="kind of workers"
    )
    parser.add_argument("--drive-file", dest="drive", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--output", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--address", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.drive is not None:
        setattr(command, "drive_player", computed)  # noqa: B010 - it has the name from another module
        resume = (given.output / "kills" / "campaign.json").exists()
        settings = RunSettings(file=given.drive, output=given.output, workers=WORKERS, resume=resume, ray=given.address)
        return command.run_campaign(settings)
    os.environ["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    dice = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        scratch = Path(folder)
        file = scratch / "campaign.toml"
        file.write_text(CAMPAIGN.format(seeds=-(-given.drives // 20)))
        Trial(file, scratch / "undisturbed").run([])
        print("| by | killed, at drives written | tried again | lost | twice | data set equal |")
        print("|---|---|---:|---:|---:|---|")
        if "processes" in given.by:
            show("processes", plans(given.drives, dice, on_ray=False), scratch, file, lambda: None)
        if "raylets" in given.by:
            show("3 raylets", plans(given.drives, dice, on_ray=True), scratch, file, stack.enter_context(raylets()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
