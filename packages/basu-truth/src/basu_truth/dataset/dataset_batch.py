"""`DatasetBatch`: the drives of a data set, which goes on after the command was killed.

The folder holds ``dataset.json`` with conditions and drives, and ``shards.txt`` with the names of all shards.
Each folder below ``drives`` holds the shards of one drive, ``truth.json`` and ``drive.json``. It gets its name in one
step when all is in it.
"""

from __future__ import annotations

import hashlib
import json
import math
import shutil
from typing import TYPE_CHECKING, Any

from basu.campaigns.records import DRIVE_FILE
from basu.errors import UserError
from basu.files import read_json, write_bytes
from basu.jobs.job import Job
from basu.output.report.documents import plain, write_json
from basu.running.batch import Batch, changes

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from basu.campaigns.plan import CampaignPlan

DATASET_FILE, SHARDS_FILE, DRIVES, SCRATCH = "dataset.json", "shards.txt", "drives", "scratch"
VERSION = 1
HINT = "name another folder with -o, or remove it"


class DatasetBatch(Batch):
    """The first ``drives`` jobs of a campaign, each with a folder of shards."""

    def __init__(self, folder: Path, plan: CampaignPlan, drives: int) -> None:
        """Take the first ``drives`` jobs of the plan and name a folder for each."""
        self._jobs = [plan.job(number) for number in range(drives)]
        names = [
            f"{number:06d}-{plain(job['agent_name'])}-{plain(job['subject'])}" for number, job in enumerate(self._jobs)
        ]
        super().__init__(folder, {number: f"{DRIVES}/{name}" for number, name in enumerate(names)})

    @property
    def done(self) -> frozenset[int]:
        """The numbers of the drives with a folder."""
        return frozenset(n for n in range(len(self._jobs)) if (self.folder / self.name(n) / DRIVE_FILE).is_file())

    def jobs(self) -> list[Job]:
        """Return a job for each drive that is still to be driven."""
        done = self.done
        return [
            # the player of campaigns keeps the folders of drives above the severity "bar"; a data set takes all
            Job(number, {**job, "bar": -math.inf, "drive": f"{number:06d}"})
            for number, job in enumerate(self._jobs)
            if number not in done
        ]

    def described(self, number: int) -> str:
        """Return a drive in words."""
        job = self._jobs[number]
        return f"drive {number}, {job['agent_name']} on {job['identity']}, seed {job['seed']}"

    def begin(self, given: Mapping[str, Any], *, resume: bool) -> None:
        """Write the conditions of a new data set, or check that one that goes on has the same.

        Raises:
            UserError: there is a data set already, none to go on with, or one that was begun differently.
        """
        path = self.folder / DATASET_FILE
        if not resume and path.exists():
            raise UserError(f"{self.folder} holds a data set already; add --resume to go on with it, or {HINT}")
        if resume and not path.exists():
            raise UserError(f"there is no data set in {self.folder} to go on with; run without --resume to begin it")
        if resume:
            before = read_json(path, "the conditions of a data set", HINT)
            changed = changes(before["conditions"], json.loads(json.dumps(given)))
            if changed:
                raise UserError(
                    f"the data set in {self.folder} was begun differently: {changed}; give what it was begun with, or "
                    f"{HINT}"
                )
        else:
            write_json(path, {"version": VERSION, "conditions": dict(given), "drives": [], "samples": 0})
        shutil.rmtree(self.folder / SCRATCH, ignore_errors=True)  # of a command that was killed
        for part in (DRIVES, SCRATCH):
            (self.folder / part).mkdir(exist_ok=True)

    def finish(self) -> tuple[int, int]:
        """Write the list of drives and shards, and return the numbers of drives and samples.

        Raises:
            UserError: the disk is full, or a document cannot be read.
        """
        found = list(self._documents())
        document = read_json(self.folder / DATASET_FILE, "the conditions of a data set", HINT)
        samples = sum(drive["samples"] for _, drive in found)
        rows = [{"folder": name, **drive} for name, drive in found]
        write_json(self.folder / DATASET_FILE, {**document, "drives": rows, "samples": samples})
        lines = [f"{name}/{shard}\n" for name, drive in found for shard in drive["shards"]]
        write_bytes(self.folder / SHARDS_FILE, "".join(lines).encode())
        shutil.rmtree(self.folder / SCRATCH, ignore_errors=True)
        return len(found), samples

    def _documents(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield the folder and the document of each drive that is done, in their order."""
        for number in sorted(self.done):
            yield self.name(number), read_json(self.folder / self.name(number) / DRIVE_FILE, "the document of a drive")


def conditions(plan: CampaignPlan, sensors: Path, *, every: int, per_shard: int) -> dict[str, Any]:
    """Return all that the samples of a data set depend on, by name."""
    return {
        **plan.identity(),
        "the sensors": f"sha256 {hashlib.sha256(sensors.read_bytes()).hexdigest()[:16]}",
        "--every": every,
        "--per-shard": per_shard,
    }
