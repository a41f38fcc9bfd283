"""``basu record dataset``: drives a campaign, looks at each drive with a sensor rig, and writes shards of samples."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING

from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.command import player_settings
from basu.campaigns.planning import plan_of
from basu.campaigns.settings import read_campaign
from basu.cli.termination import terminated_as_interrupted
from basu.errors import UserError
from basu.files import find
from basu.jobs.playing import play_jobs
from basu.outcome import Fault
from basu.output.progress import drives_bar
from basu.running.folder_lock import locked
from basu_truth.dataset.dataset_batch import SCRATCH, DatasetBatch, conditions
from basu_truth.dataset.player import DatasetSettings, dataset_player
from basu_truth.dataset.shards import file_endings
from basu_truth.rig import cameras_and_lidars

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from basu.campaigns.plan import CampaignPlan
    from basu.running.drive import DriveDone

USUAL_RIG = "config/rig.json"  # three cameras and a lidar; with BASU


def run(arguments: argparse.Namespace) -> int:
    """Record a data set, or go on with one; the exit code is 130 where it was interrupted.

    Raises:
        UserError: it cannot be recorded like this, said before anything is driven; or drives could not be recorded.
        SimulatorError: there is no simulator.
    """
    for name in ("every", "per_shard", "workers", "drives"):
        value = getattr(arguments, name)
        if value is not None and value < 1:
            raise UserError(f"--{name.replace('_', '-')} is {value}; it must be 1 or more")
    plan = plan_of(read_campaign(arguments.file), arguments.file)
    if any(part.search is not None for part in plan.parts):
        raise UserError(
            f"{arguments.file} has a search, which chooses drives by the verdicts of others; a data set takes drives "
            "that are known before: take sweep or grid"
        )
    sensors = _sensors(arguments.sensors)
    drives = plan.size if arguments.drives is None else min(plan.size, arguments.drives)
    folder: Path = arguments.output
    with terminated_as_interrupted(), locked(folder):
        batch = DatasetBatch(folder, plan, drives)
        given = conditions(plan, sensors, every=arguments.every, per_shard=arguments.per_shard)
        batch.begin(given, resume=arguments.resume)
        return _record(batch, plan, sensors, arguments, drives)


def _sensors(given: Path | None) -> Path:
    """Return the sensor file, with its whole path.

    Raises:
        UserError: it has no camera and no lidar, or two sensors with files of one name.
    """
    path = find(USUAL_RIG if given is None else str(given), "sensor file").resolve()
    file_endings(cameras_and_lidars((), "", path))
    return path


def _record(batch: DatasetBatch, plan: CampaignPlan, sensors: Path, arguments: argparse.Namespace, drives: int) -> int:
    """Drive what is left, and write the lists."""
    scratch = batch.folder.resolve() / SCRATCH
    player = player_settings(plan, scratch, RunSettings(file=arguments.file, output=scratch))
    settings = DatasetSettings(
        player=replace(player, sample=1.0, scratch=scratch, record=True),
        sensors=sensors,
        every=arguments.every,
        per_shard=arguments.per_shard,
        scratch=scratch,
    )
    jobs = batch.jobs()
    failed: list[DriveDone] = []
    interrupted = False
    answers = batch.play(play_jobs(dataset_player(settings), jobs, arguments.workers))
    try:
        with drives_bar(drives, " drives", initial=drives - len(jobs)) as bar, contextlib.closing(answers):
            for done in answers:
                bar.update()
                if done.folder is None:
                    failed.append(done)
    except KeyboardInterrupt:
        interrupted = True
    found, samples = batch.finish()
    print(f"{batch.folder}: {found} of {drives} drives, {samples} samples")
    if failed:
        first = failed[0]
        raise UserError(
            f"{len(failed)} drives could not be recorded, the first ({batch.described(first.number)}): "
            f"{first.result.outcome.message}; with --resume the same command drives them again"
        )
    if interrupted:
        print("interrupted; the same command with --resume goes on")
        return Fault.USER.value
    return 0
