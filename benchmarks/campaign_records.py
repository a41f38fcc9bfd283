"""Jobs of a campaign through the real plan, pool, worker processes and table, without driving: time, memory, files.

usage: campaign_records.py [--jobs N] [--workers N] [--block N] [--folder DIR]

Every row has all columns of a real one. The driver's memory is read from /proc every 1 % of the jobs.
"""

import argparse
import contextlib
import os
import resource
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from basu.campaigns.columns import schema_of
from basu.campaigns.drive_table import DriveTable
from basu.campaigns.plan import CampaignPlan
from basu.campaigns.planning import plan_of
from basu.campaigns.settings import checked
from basu.jobs.job import Done, Job, JobOutcome, Play, PlayerSpec
from basu.jobs.pool import Pool
from basu.jobs.processes import Processes

VALUES = 40  # numbers in a row beside ids and verdict, as a case has them


@contextlib.contextmanager
def open_nothing() -> Iterator[Play]:
    """A player that answers at once, with a row of the usual size."""
    values = {name: 1.0 / (1 + n) for n, name in enumerate(_columns()[:VALUES])}

    def play(job: dict[str, object]) -> JobOutcome:
        share = int(str(job["id"])[:8], 16) / 16**8
        verdict = {"status": "ScenarioEnded", "fault": "none", "judged": True, "success": share > 0.1}
        return JobOutcome({**values, **verdict, "message": "computed", "severity": share, "simulated_s": 20.0})

    yield play


def _columns() -> list[str]:
    schema = schema_of({})
    return [name for name in schema.names if name.startswith(("passengers_", "reported_", "route_", "outside_"))
            and str(schema.field(name).type) == "double"]  # fmt: skip


def plan_for(jobs: int) -> CampaignPlan:
    """A plan of at least so many jobs."""
    document = {
        "name": "records",
        "agents": ["basic", "behavioral", "blind"],
        "order": "shuffled",
        "seeds": {"number": -(-jobs // 30)},
        "drives": [{"cases": ["pedestrian_crossing_1"], "sweep": 10}],
    }
    return plan_of(checked(document, "the benchmark"), Path())


def resident_mb(pid: int | str = "self") -> float:
    """Memory that a process holds."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=1_000_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--block", type=int, default=10_000)
    parser.add_argument("--folder", type=Path, default=None)
    arguments = parser.parse_args()
    folder = arguments.folder or Path(tempfile.mkdtemp())
    plan = plan_for(arguments.jobs)
    table = DriveTable(folder, schema_of(plan.parameters()), arguments.block, arguments.jobs)
    pool = Pool(Processes(PlayerSpec(f"{Path(__file__).stem}:open_nothing")), arguments.workers)
    memory, began_s, began_cpu_s, done = [], time.perf_counter(), time.process_time(), 0
    given: dict[int, dict[str, Any]] = {}  # jobs in work, as a campaign's command holds them

    def jobs() -> Iterator[Job]:
        for number in table.pending(arguments.jobs):
            given[number] = plan.job(number)
            yield Job(number, given[number])

    try:
        for answer in pool.play(jobs()):
            assert isinstance(answer, Done)
            job = given.pop(answer.number)
            names = ("id", "kind", "subject", "identity", "town", "weather", "vehicles", "walkers", "seed")
            row = {"number": answer.number, "agent": job["agent_name"], **{name: job[name] for name in names}}
            table.add({**row, **{f"parameter_{k}": v for k, v in job["parameters"].items()}, **answer.value})
            done += 1
            if done % max(1, arguments.jobs // 100) == 0:
                memory.append(resident_mb())
    finally:
        pool.close()
        table.close()
    wall_s, cpu_s = time.perf_counter() - began_s, time.process_time() - began_cpu_s
    files = list(folder.glob("drives/*/*.parquet"))
    size = sum(path.stat().st_size for path in files)
    workers_s = resource.getrusage(resource.RUSAGE_CHILDREN)
    us_a_row = 1e6 / done
    theirs_s = workers_s.ru_utime + workers_s.ru_stime
    print(f"{done} rows in {wall_s:.0f} s ({done / wall_s:.0f}/s)")
    print(f"processor: driver {us_a_row * cpu_s:.0f} us a row, workers {us_a_row * theirs_s:.0f} us a row")
    print(f"{len(files)} files, {size / 1e6:.1f} MB, {size / done:.0f} bytes a row")
    first, middle, last = memory[0], memory[len(memory) // 2], memory[-1]
    print(f"memory of the driver: first {first:.0f} MB, middle {middle:.0f} MB, last {last:.0f} MB")
    if arguments.folder is None:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
