"""Clients at their worst against one live server: how many, how long, and what they leave behind in it.

    python benchmarks/soak.py [--share 1.0] [--only WORD ...] [--towns DIR]

Every row begins with a look at the server's memory, open files and threads and ends with another, after a client that
behaves has ticked. The slope is that of the resident memory over the last three quarters of the row, per thousand
repetitions; the first quarter fills caches and pools. A row that ends the server ends the table.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import psutil
import soak_rows as rows
import soak_worlds as worlds
from soak_rows import Done, Target

from fakes import client_programs as programs

LEAST_FOR_A_SLOPE = 100
"""Repetitions; fewer say nothing about a thousand."""
TOWNS = "large maps, twice each"
ROWS: dict[str, tuple[int, Callable[[Target, int, Done], str]]] = {
    "clients that call once": (1000, rows.rpc_connects),
    "subscribers that leave": (1000, rows.stream_connects),
    "connections cut off": (1000, rows.cut_off),
    "silent connections at once": (1000, rows.silent),
    "official clients": (200, rows.whole_clients),
    "killed while ticking": (10, rows.killed(programs.TICKING)),
    "killed while sensors listen": (10, rows.killed(programs.LISTENING)),
    "killed with a Traffic Manager": (10, rows.killed(programs.TRAFFIC)),
    "ten clients tick at once": (5000, rows.ten_at_once),
    "never reads, asynchronous": (5000, rows.deaf_asynchronous),
    "never reads, synchronous": (3, rows.deaf_synchronous),
    "slow-loris clients at once": (500, rows.slow_loris),
    "reloads": (2000, worlds.reloads),
    "reloads by the official client": (200, worlds.official_reloads),
    TOWNS: (1, worlds.towns),
    "sensors made, heard, destroyed": (3000, worlds.sensor_cycles),
    "ten cameras made, seen, destroyed": (3000, worlds.camera_cycles),
    "vehicles one by one": (10_000, worlds.one_by_one),
    "props all at once": (10_000, worlds.all_at_once),
    "large batches": (30, worlds.large_batches),
    "bad packets": (20_000, worlds.bad_packets),
}
HEAD = (
    f"{'':34}{'count':>7}{'s':>7}  {'MiB before':>10}{'after':>7}{'KiB/1000':>10}  {'files':>9}{'threads':>9}  remarks"
)


class Look(NamedTuple):
    """What a server holds."""

    mib: float
    files: int
    threads: int

    @classmethod
    def at(cls, process: psutil.Process) -> "Look":
        return cls(process.memory_info().rss / 2**20, process.num_fds(), process.num_threads())


class Progress:
    """Called by a row after every repetition; keeps some twenty looks at the memory."""

    def __init__(self, process: psutil.Process, count: int) -> None:
        self.process, self.count, self.done = process, count, 0
        self.looks: list[tuple[int, float]] = []

    def __call__(self) -> None:
        self.done += 1
        if self.done * 20 // self.count > (self.done - 1) * 20 // self.count:
            self.looks.append((self.done, self.process.memory_info().rss / 2**10))

    def slope_kib(self) -> str:
        """Memory a thousand repetitions more would take, by the last three quarters of these."""
        late = [look for look in self.looks if look[0] > self.count / 4]
        if self.count < LEAST_FOR_A_SLOPE:
            return "-"
        done, kib = zip(*late, strict=True)
        return f"{np.polyfit(done, kib, 1)[0] * 1000.0 + 0.0:.1f}"


def measure(name: str, row: Callable[[Target, int, Done], str], target: Target, count: int) -> None:
    before, began_s = Look.at(target.process), time.monotonic()
    progress = Progress(target.process, count)
    remarks = row(target, count, progress)
    took_s = time.monotonic() - began_s
    rows.settle(target)
    after = Look.at(target.process)
    print(
        f"{name:34}{count:7}{took_s:7.1f}  {before.mib:10.0f}{after.mib:7.0f}{progress.slope_kib():>10}  "
        f"{before.files:4}{after.files:5}{before.threads:5}{after.threads:4}  {remarks}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--share", type=float, default=1.0, help="of the full counts (default: %(default)s)")
    parser.add_argument("--only", nargs="*", default=[], metavar="WORD", help="rows whose name has one of these words")
    parser.add_argument("--towns", type=Path, help="folder of large .xodr maps, to load one after the other")
    arguments = parser.parse_args()
    with tempfile.NamedTemporaryFile("w+", prefix="soak-", suffix=".log") as log:
        maps = ["--maps", str(arguments.towns)] if arguments.towns else []
        server = subprocess.Popen(
            [sys.executable, "-m", "linden.cli", "serve", "--port", "0", *maps],
            stdout=subprocess.PIPE, stderr=log, text=True,
        )  # fmt: skip
        try:
            ready = next((line for line in server.stdout if line.startswith("linden: ready")), None)
            if ready is None:
                raise SystemExit("the server ended before it was ready")
            port, streaming_port = (int(part.split(",")[0]) for part in ready.split("port ")[1:])
            target = Target(psutil.Process(server.pid), port, streaming_port, Path(log.name))
            rows.settle(target)
            print(HEAD)
            for name, (count, row) in ROWS.items():
                chosen = not arguments.only or any(word in name for word in arguments.only)
                if chosen and (name != TOWNS or arguments.towns):
                    measure(name, row, target, max(1, round(count * arguments.share)))
            with rows.caller(target) as last:
                assert last.call("version") == "0.9.16"
        finally:  # a row that ends the table must not leave the server behind
            began_s = time.monotonic()
            server.terminate()
        code = server.wait(10)
        lines = log.seek(0) or log.read().splitlines()
        bugs = sum("internal error" in line or "Traceback" in line for line in lines)
        print(
            f"ended with {code} in {time.monotonic() - began_s:.2f} s; {len(lines)} lines of log, {bugs} of them bugs"
        )


if __name__ == "__main__":
    main()
