"""Arguments of ``basu truth`` and of ``basu record``: ground truth of runs, scores of detectors, and data sets."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.driving import SIMULATOR
from basu.cli.later import later
from basu.options.run import RunOptions
from basu.plugins import Command
from basu.settings.command_line import add_options

FORMATS = ("coco", "kitti", "nuscenes")
USUAL_EVERY = 10  # two frames a second of a run's twenty, as in nuScenes
USUAL_PER_SHARD = 500  # samples, with three pictures and a cloud each some 500 MB to 1 GB


def add_truth(truth: argparse.ArgumentParser) -> None:
    """Add the commands below ``basu truth``."""
    truth.description = "Ground truth of recorded runs: what each camera and lidar saw, and how well a detector saw it."
    commands = truth.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_export(commands.add_parser("export", help="write the truth of a run in a public format"))
    _add_evaluate(commands.add_parser("evaluate", help="score a detector's output against the truth"))


def _add_export(export: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu truth export``."""
    export.description = (
        "Replay a recorded run and write what its cameras and lidars saw: pictures, clouds and objects with boxes, "
        "tracks, velocities and counted visible shares."
    )
    export.add_argument("run", type=Path, metavar="RUN", help="a run's folder (of --record), such as runs/latest")
    export.add_argument("--format", required=True, choices=FORMATS, help="the format of the folder")
    export.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="the folder to write")
    _add_replay(export)


def _add_evaluate(evaluate: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu truth evaluate``."""
    evaluate.description = (
        "Score detections: AP by class, distance, visibility and weather, and MOTA and IDF1 where they have tracks."
    )
    evaluate.add_argument(
        "truth", type=Path, metavar="RUN|EXPORT", help="what `basu truth export` wrote, or a run's folder (of --record)"
    )
    evaluate.add_argument(
        "--detections",
        type=Path,
        required=True,
        metavar="FILE",
        help="results of COCO (.json), results of nuScenes (.json), or a folder with label files of KITTI",
    )
    evaluate.add_argument("--sensor", metavar="ID", help="the sensor that was looked at (default: the first that fits)")
    evaluate.add_argument(
        "--least", type=int, default=None, metavar="N",
        help="objects with fewer visible pixels or points count neither way (default: 20 pixels, 1 point)",
    )  # fmt: skip
    evaluate.add_argument("--json", type=Path, metavar="FILE.json", help="write the scores to this file too")
    _add_replay(evaluate)


def _add_replay(command: argparse.ArgumentParser) -> None:
    """Add what says how a run is replayed."""
    command.add_argument(
        "--sensors", type=Path, metavar="FILE.json", help="look with these sensors (default: those of the run)"
    )
    command.add_argument(
        "--weather", metavar="NAME", help="replay in one of CARLA's presets (default: as the run was driven)"
    )
    command.add_argument(
        "--every",
        type=int,
        default=USUAL_EVERY,
        metavar="N",
        help="take each Nth frame of the recording (default: %(default)s)",
    )
    add_options(command, RunOptions, only=SIMULATOR)
    command.set_defaults(command=later(f"basu_truth.{command.prog.split()[-1]}_command:run"))


TRUTH = Command("write the ground truth of a recorded run, and score detectors against it", add_truth)


def add_record(record: argparse.ArgumentParser) -> None:
    """Add the commands below ``basu record``."""
    record.description = "Recordings as data sets for training."
    commands = record.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_dataset(commands.add_parser("dataset", help="drive a campaign with a sensor rig and write shards of samples"))


def _add_dataset(dataset: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu record dataset``."""
    dataset.description = (
        "Drive each job of a campaign and look at it with a sensor rig. Write pictures, clouds and objects as tar "
        "files in the convention of WebDataset, which training programs stream."
    )
    dataset.add_argument("file", type=Path, metavar="CAMPAIGN.toml", help="a file of `basu campaign run`")
    dataset.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FOLDER", help="the folder of the data set"
    )
    dataset.add_argument(
        "--sensors", type=Path, metavar="FILE.json", help="the rig (default: three cameras and a lidar)"
    )
    dataset.add_argument(
        "--every",
        type=int,
        default=USUAL_EVERY,
        metavar="N",
        help="take each Nth frame of a drive (default: %(default)s)",
    )
    dataset.add_argument(
        "--per-shard",
        type=int,
        default=USUAL_PER_SHARD,
        metavar="N",
        help="samples of a full shard; a shard has frames of one drive (default: %(default)s)",
    )
    dataset.add_argument("--drives", type=int, metavar="N", help="only the first N drives (default: all)")
    dataset.add_argument(
        "--workers", type=int, default=1, metavar="N", help="drives that are recorded at the same time (default: 1)"
    )
    dataset.add_argument("--resume", action="store_true", help="go on with a data set that was interrupted")
    dataset.set_defaults(command=later("basu_truth.dataset.record_command:run"))


RECORD = Command("drive a campaign with a sensor rig and write a data set for training", add_record)
