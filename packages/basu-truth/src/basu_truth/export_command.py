"""``basu truth export``: what the sensors of a recorded run saw, in a public format."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from tqdm import tqdm

from basu.cli.typed_options import options_of
from basu.errors import UserError
from basu.options.run import RunOptions
from basu_carla_log.server_replay import Where
from basu_truth.exporting import WRITERS, export
from basu_truth.recorded_run import in_weather, read_run
from basu_truth.truth import read_truth

if TYPE_CHECKING:
    import argparse
    from pathlib import Path


def run(arguments: argparse.Namespace) -> int:
    """Export a run.

    Raises:
        UserError: the run was not recorded, has no sensors, or the folder cannot be written.
        SimulatorError: a simulator went away.
    """
    folder: Path = arguments.output
    write_export(arguments, arguments.run, folder, arguments.format)
    truth = read_truth(folder)
    objects = len({each.track for each in truth.objects})
    print(
        f"{folder}: {len(truth.frames)} frames, {len(truth.sensors)} sensors, {len(truth.objects)} views of "
        f"{objects} objects"
    )
    return 0


def write_export(arguments: argparse.Namespace, run_folder: Path, folder: Path, format_name: str | None) -> None:
    """Write an export with a bar of its frames on the console; ``format_name`` None writes the truth alone.

    Raises:
        UserError, SimulatorError: as `run`.
    """
    if arguments.every < 1:
        raise UserError(f"--every is {arguments.every}; it is a number of frames, 1 or more")
    options = options_of(RunOptions, arguments)
    where = Where(options.host, options.port, options.timeout_s)
    recorded = read_run(run_folder, arguments.sensors)
    if arguments.weather is not None:
        recorded = in_weather(recorded, arguments.weather)
    least_s = 0.1 if sys.stderr.isatty() else 10.0
    make_writer = None if format_name is None else WRITERS[format_name]
    with tqdm(total=recorded.log.frames, unit=" frames", desc="exporting", mininterval=least_s) as bar:
        for done in export(recorded, folder, make_writer, where, every=arguments.every):
            bar.update(done.frame - bar.n)
