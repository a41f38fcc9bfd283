"""``basu replay --viewer``: a run or a recorder file in Rerun's viewer, without a simulator."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.extras import require
from basu.metrics.scoring import Scoring, scoring_of_run
from basu.output.report.documents import CONFIG_FILE
from basu.records.recording_files import read_map
from basu.settings.resolve import resolve
from basu_carla_log.recorder_log import progress_bar, read_recording
from basu_window.extras import RERUN
from basu_window.viewer.log_replay import show_log
from basu_window.viewer.record_replay import show_run
from basu_window.viewer.stream import has_screen

RRD_FILE = "replay.rrd"


def run(arguments: argparse.Namespace) -> int:
    """Show a run's folder or a recorder file."""
    require(RERUN)
    recording: Path = arguments.recording
    return _run_in_viewer(arguments, recording) if recording.is_dir() else _log_in_viewer(arguments, recording)


def _run_in_viewer(arguments: argparse.Namespace, folder: Path) -> int:
    """A run's folder, from its history."""
    rrd = arguments.save or folder / RRD_FILE
    scoring = resolve(Scoring, [scoring_of_run(folder / CONFIG_FILE)])
    with progress_bar() as bar:
        said = show_run(folder, arguments.map, rrd, scoring, screen=has_screen(), on_tick=bar.update)
    print(f"viewer            {rrd} ({said}); `rerun {rrd}` opens it")
    return 0


def _log_in_viewer(arguments: argparse.Namespace, file: Path) -> int:
    """A recorder file by itself."""
    log, where = read_recording(arguments.recording, arguments.map)
    rrd = arguments.save or Path(f"{file.stem}.rrd")
    town = None if where.map is None else read_map(where.map, log.map_name)
    with progress_bar() as bar:
        said = show_log(log, town, rrd, screen=has_screen(), on_tick=bar.update)
    print(f"viewer            {rrd} ({said}); `rerun {rrd}` opens it")
    return 0
