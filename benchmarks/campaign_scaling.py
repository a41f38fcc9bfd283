"""Drives a second of one campaign with more and more workers: processes of this machine, and Ray with several raylets.

    python benchmarks/campaign_scaling.py [--workers 1 2 4] [--raylets 1 2 4 --cpus 4] [--drives-a-worker 24]

Every row has as many drives for each worker. All rows take equally long where workers do not disturb each other.
"Share of linear" compares drives a second and worker with the first row. A row's time includes the workers' start.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import psutil
import pyarrow.dataset as ds

CAMPAIGN = """
name = "scaling"
agents = ["basic", "behavioral", "blind"]
[[drives]]
cases = ["pedestrian_crossing_1"]
sweep = {sweep}
[keep]
failures = 0
narrowest = 0
sample = 0.0
"""
AGENTS = 3
OBJECT_STORE_BYTES = 120_000_000


def drive(folder: Path, drives: int, options: list[str]) -> tuple[float, float, float]:
    """Drive a campaign; return s of wall time, s of processor time, and simulated s."""
    folder.mkdir(parents=True)
    file = folder / "campaign.toml"
    file.write_text(CAMPAIGN.format(sweep=-(-drives // AGENTS)))
    command = [str(Path(sys.executable).with_name("basu"))]
    if not Path(command[0]).exists():
        command = [sys.executable, "-c", "from basu.cli import entry_point; entry_point()"]
    command += ["campaign", "run", str(file), "--drives", str(drives), "--output", str(folder / "out"), *options]
    began_s = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    took_s = time.perf_counter() - began_s
    (table,) = (folder / "out").glob("*/drives")
    columns = ds.dataset(table).to_table(columns=["cpu_s", "simulated_s"]).to_pydict()
    if len(columns["cpu_s"]) != drives:
        raise RuntimeError(f"{drives} drives were planned, and the table has {len(columns['cpu_s'])}")
    return took_s, sum(columns["cpu_s"]), sum(columns["simulated_s"])


def on_ray(raylets: int, cpus: int) -> Any:  # noqa: ANN401 - Ray's cluster
    """Start a cluster of several raylets on this machine."""
    from ray.cluster_utils import Cluster  # noqa: PLC0415 - an extra

    arguments = {"num_cpus": cpus, "object_store_memory": OBJECT_STORE_BYTES}
    cluster = Cluster(initialize_head=True, head_node_args=arguments)
    for _ in range(raylets - 1):
        cluster.add_node(**arguments)
    return cluster


def main() -> None:
    """Print a row for each number of workers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--raylets", type=int, nargs="*", default=[])
    parser.add_argument("--cpus", type=int, default=1, help="workers for each raylet")
    parser.add_argument("--drives-a-worker", type=int, default=24)
    arguments = parser.parse_args()
    heads = ("workers", "by", "drives", "wall s", "drives/s", "share of linear", "CPU-s an hour simulated", "busy")
    print(f"{psutil.cpu_count()} processors, load {psutil.getloadavg()[0]:.1f}", flush=True)
    print("  ".join(heads), flush=True)
    first: float | None = None
    rows = [(count, "processes", 0) for count in arguments.workers]
    rows += [(raylets * arguments.cpus, f"{raylets} raylets", raylets) for raylets in arguments.raylets]
    with tempfile.TemporaryDirectory() as scratch:
        for nth, (workers, name, raylets) in enumerate(rows):
            drives = workers * arguments.drives_a_worker
            cluster = on_ray(raylets, arguments.cpus) if raylets else None
            options = ["--workers", str(workers), *(["--ray", cluster.address] if cluster else [])]
            psutil.cpu_percent()
            try:
                took_s, cpu_s, simulated_s = drive(Path(scratch) / str(nth), drives, options)
            finally:
                busy = psutil.cpu_percent() / 100.0
                if cluster:
                    cluster.shutdown()
            rate = drives / took_s
            first = rate / workers if first is None else first
            share, hour_s = rate / workers / first, 3600.0 * cpu_s / simulated_s
            row = (
                workers,
                name,
                drives,
                f"{took_s:.1f}",
                f"{rate:.2f}",
                f"{share:.0%}",
                f"{hour_s:.0f}",
                f"{busy:.0%}",
            )
            print("  ".join(str(each).rjust(len(head)) for each, head in zip(row, heads, strict=True)), flush=True)


if __name__ == "__main__":
    main()
