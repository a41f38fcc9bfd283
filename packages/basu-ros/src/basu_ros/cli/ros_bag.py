"""``basu ros bag``: the record of a run, written as a ROS bag."""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from basu.errors import UserError
from basu.records.history.files import read_history
from basu_ros.output.record_bag import write_record
from linden_ros2.types import Generation


def run(arguments: argparse.Namespace) -> int:
    """Write a run's record as a ROS bag: state, controls, other actors, events, TF; no sensors, which it has not."""
    output: Path = arguments.output
    if output.exists():
        raise UserError(f"{output} exists already; name another place with --output, or remove it")
    history = read_history(arguments.folder)
    generation = Generation.ROS_1 if output.suffix == ".bag" else Generation.ROS_2
    name = output.stem if output.suffix == ".mcap" else output.name
    draft = output.with_name(f".{output.name}.part")
    shutil.rmtree(draft, ignore_errors=True)
    try:
        draft.mkdir(parents=True)
        messages = write_record(history, draft / name, generation)
        written = draft / name / f"{name}.mcap" if output.suffix == ".mcap" else draft / name
        written.replace(output)
    except OSError as error:
        raise UserError(f"{output} cannot be written: {error.strerror}; name another place with --output") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    print(f"ROS bag           {output} ({messages} messages, {history.frames['t_s'][-1]:.2f} s)")
    return 0
