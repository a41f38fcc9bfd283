"""The player of a data set's drives: drives a job of a campaign, replays its recording, and writes its shards."""

from __future__ import annotations

import contextlib
import io
import shutil
import tarfile
import tempfile
from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.campaigns.player import PlayerSettings, open_player
from basu.campaigns.records import DRIVE_FILE
from basu.episode.failures import outcome_of
from basu.errors import SimulatorError, UserError
from basu.jobs.job import After, JobOutcome, PlayerSpec
from basu.output.report.documents import write_json
from basu.running.batch import counts
from basu.running.drive import not_begun
from basu_carla_log.server_replay import Where
from basu_truth.dataset.shards import ShardWriter
from basu_truth.exporting import export
from basu_truth.recorded_run import read_run
from basu_truth.truth import read_truth

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from basu.jobs.job import Play
    from basu.running.drive import DriveDone
    from basu_truth.truth import Truth

OF_CONDITION = ("id", "subject", "identity", "town", "weather", "vehicles", "walkers", "density_per_km", "seed")
"""The fields of a campaign's job that describe its drive."""
TIMEOUT_S = 300.0  # of wall time for one frame of the replay; the first one may compile kernels


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetSettings:
    """What all drives of a data set share; plain values that any process understands."""

    player: PlayerSettings
    sensors: Path
    every: int  # of the frames of a recording, each so manyth is a sample
    per_shard: int  # samples of a full shard
    scratch: Path  # on the file system of the data set


def dataset_player(settings: DatasetSettings) -> PlayerSpec:
    """Return the player as a value that any process can open."""
    return PlayerSpec(f"{__name__}:open_dataset_player", (settings,))


@contextlib.contextmanager
def open_dataset_player(settings: DatasetSettings) -> Iterator[Play]:
    """Open the player of campaigns, and write the shards of each of its drives.

    Raises:
        UserError, SimulatorError: as the player of campaigns.
    """
    with open_player(settings.player) as drive:
        yield partial(_played, settings, drive)


def _played(settings: DatasetSettings, drive: Play, job: dict[str, Any]) -> JobOutcome:
    """Drive a job; its folder of shards lies in the scratch folder then.

    The next job gets a fresh simulator. Tracks have the ids of actors, and a simulator counts on from drive to drive.
    """
    outcome = drive(job)
    done: DriveDone = outcome.value
    packed, done = done.packed, done._replace(packed=None)
    if packed is None or not counts(done.result):
        return JobOutcome(done, outcome.after)
    try:
        folder = _shards(settings, job, packed, done)
    except (UserError, SimulatorError) as error:
        return JobOutcome(not_begun(outcome_of(error, lambda: None)), After.FRESH)
    return JobOutcome(done._replace(folder=folder), After.FRESH)


def _shards(settings: DatasetSettings, job: Mapping[str, Any], packed: bytes, done: DriveDone) -> Path:
    """Write the shards of a drive into a new folder of the scratch folder, and return it.

    Raises:
        UserError: the run cannot be replayed with these sensors.
        SimulatorError: a simulator went away.
    """
    folder: Path = settings.scratch / job["id"]
    shutil.rmtree(folder, ignore_errors=True)  # of an attempt that was killed
    with tempfile.TemporaryDirectory(dir=settings.scratch, prefix="run-") as temporary:
        run_folder = Path(temporary) / job["id"]
        with tarfile.open(fileobj=io.BytesIO(packed)) as tar:
            tar.extractall(run_folder, filter="data")
        recorded = read_run(run_folder, settings.sensors)
        make_writer = partial(ShardWriter, drive=job["drive"], per_shard=settings.per_shard)
        for _ in export(recorded, folder, make_writer, Where(None, 0, TIMEOUT_S), every=settings.every):
            pass
    truth = read_truth(folder)
    write_json(folder / DRIVE_FILE, _document(job, truth, done, sorted(path.name for path in folder.glob("*.tar"))))
    return folder


def _document(job: Mapping[str, Any], truth: Truth, done: DriveDone, shards: list[str]) -> dict[str, Any]:
    """Return what the data set says of a drive; nothing in it depends on the machine or the time."""
    return {
        "drive": job["drive"],
        "agent": job["agent_name"],
        **{name: job[name] for name in OF_CONDITION},
        "parameters": job["parameters"],
        "status": done.result.outcome.status.value,
        "success": done.result.success.passed,
        "samples": len(truth.frames),
        "objects": dict(sorted(Counter(each.category for each in truth.objects).items())),
        "shards": shards,
    }
