"""``basu metrics`` and ``basu replay``: question a recording, or play it again."""

from __future__ import annotations

import argparse
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.cli.run import SIMULATOR, options_of
from basu.errors import UserError
from basu.options.run import RunOptions
from basu.settings.command_line import add_options

if TYPE_CHECKING:
    from basu.records.carla_log import Log
    from basu.records.carla_log.sources import Source

RRD_FILE = "replay.rrd"


def add_metrics(metrics: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu metrics``."""
    metrics.description = ask_recording.__doc__
    metrics.add_argument(
        "recording", type=Path, metavar="RUN", help="a run's folder (of --record), or a recorder file of CARLA's (.log)"
    )
    metrics.add_argument(
        "--metric",
        required=True,
        metavar="FILE.py",
        help="a class that is a BasicMetric, as for ScenarioRunner; FILE.py:Class where the file has several",
    )
    metrics.add_argument(
        "--map", type=Path, metavar="FILE.xodr", help="the map the recording lies in (default: the run's)"
    )
    metrics.add_argument(
        "--criteria", type=Path, metavar="FILE.json", help="handed to the metric (default: the run's infractions)"
    )
    metrics.add_argument(
        "--plot", type=Path, metavar="FILE.png", help="keep what the metric draws with matplotlib (further: FILE-2.png)"
    )
    metrics.add_argument("--debug", action="store_true", help="show the traceback of a metric that fails")
    metrics.set_defaults(command=ask_recording)


def add_replay(replay: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu replay``."""
    replay.description = replay_run.__doc__
    replay.add_argument(
        "recording", type=Path, metavar="RUN", help="a run's folder, or a recorder file of CARLA's (.log)"
    )
    replay.add_argument(
        "--viewer", action="store_true", help="in Rerun's viewer, from the record alone; a run needs no log for that"
    )
    replay.add_argument(
        "--save",
        type=Path,
        metavar="FILE.rrd",
        help=f"where --viewer keeps it (default: {RRD_FILE} in the run's folder)",
    )
    replay.add_argument("--map", type=Path, metavar="FILE.xodr", help="to draw with --viewer (default: the run's)")
    add_options(replay, RunOptions, only=SIMULATOR)
    replay.add_argument(
        "--speed", type=float, default=1.0, metavar="X", help="times real time, 0 for unbraked (default: %(default)s)"
    )
    replay.set_defaults(command=replay_run)


def ask_recording(arguments: argparse.Namespace) -> int:
    """Run a metric on a recording alone, without a simulator."""
    from basu.records.carla_log import read_log  # noqa: PLC0415 - brings in the client, which `--help` does not need
    from basu.records.carla_log.metric_file import drawn, off_screen, run_metric  # noqa: PLC0415 - likewise
    from basu.records.carla_log.metrics_log import MetricsLog  # noqa: PLC0415 - likewise
    from basu.records.carla_log.sources import source  # noqa: PLC0415 - likewise

    where = source(arguments.recording, arguments.map)
    log = read_log(where.log)
    if log.problem is not None:
        print(f"basu: warning: {log.problem}", file=sys.stderr)
    off_screen(arguments.plot)
    criteria = _criteria(where, arguments.criteria)
    try:
        run_metric(arguments.metric, _map(where, log.map_name), MetricsLog(log), criteria)
    except UserError as error:
        if arguments.debug and error.__cause__ is not None:
            traceback.print_exception(error.__cause__)
        raise
    for line in drawn(arguments.plot):
        print(line)
    return 0


def _map(where: Source, name: str) -> Any:  # noqa: ANN401 - a carla.Map, or what stands for one
    from basu.records.carla_log.sources import AbsentMap, read_map  # noqa: PLC0415 - as above

    return AbsentMap(name) if where.map is None else read_map(where.map, name)


def _criteria(where: Source, given: Path | None) -> dict[str, Any] | None:
    from basu.records.carla_log.sources import criteria_of, read_criteria  # noqa: PLC0415 - as above

    if given is not None:
        return read_criteria(given)
    return None if where.result is None else criteria_of(where.result)


def replay_run(arguments: argparse.Namespace) -> int:
    """Play a run again: on a simulator, where any client can watch it, or with --viewer in Rerun's, without one."""
    if not arguments.speed >= 0.0:
        raise UserError(f"--speed is {arguments.speed}; it is a factor, or 0")
    recording: Path = arguments.recording
    if not arguments.viewer:
        return _on_simulator(arguments)
    from basu.output.viewer.stream import require  # noqa: PLC0415 - with the rest of the viewer, which needs an extra

    require()
    return _run_in_viewer(arguments, recording) if recording.is_dir() else _log_in_viewer(arguments, recording)


def _run_in_viewer(arguments: argparse.Namespace, folder: Path) -> int:
    """A run's folder, from its history."""
    from basu.metrics.scoring import Scoring, scoring_of_run  # noqa: PLC0415 - as above
    from basu.output.report.documents import CONFIG_FILE  # noqa: PLC0415 - as above
    from basu.output.viewer.record_replay import show_run  # noqa: PLC0415 - as above
    from basu.output.viewer.stream import has_screen  # noqa: PLC0415 - as above
    from basu.settings.resolve import resolve  # noqa: PLC0415 - pydantic, which `--help` does not need

    rrd = arguments.save or folder / RRD_FILE
    scoring = resolve(Scoring, [scoring_of_run(folder / CONFIG_FILE)])
    with _bar() as bar:
        said = show_run(folder, arguments.map, rrd, scoring, screen=has_screen(), on_tick=bar.update)
    print(f"viewer            {rrd} ({said}); `rerun {rrd}` opens it")
    return 0


def _log_in_viewer(arguments: argparse.Namespace, file: Path) -> int:
    """A recorder file by itself."""
    from basu.output.viewer.log_replay import show_log  # noqa: PLC0415 - as above
    from basu.output.viewer.stream import has_screen  # noqa: PLC0415 - as above
    from basu.records.carla_log.sources import read_map  # noqa: PLC0415 - as above

    log, carla_map = _log(arguments)
    rrd = arguments.save or Path(f"{file.stem}.rrd")
    town = None if carla_map is None else read_map(carla_map, log.map_name)
    with _bar() as bar:
        said = show_log(log, town, rrd, screen=has_screen(), on_tick=bar.update)
    print(f"viewer            {rrd} ({said}); `rerun {rrd}` opens it")
    return 0


def _on_simulator(arguments: argparse.Namespace) -> int:
    """The log on a simulator."""
    from basu.output.viewer.server_replay import Progress, Where, play  # noqa: PLC0415 - brings in the client

    if arguments.save is not None or arguments.map is not None:
        raise UserError("--save and --map belong to --viewer; add it, or leave them out")
    log, _ = _log(arguments)
    options = options_of(arguments)
    where = Where(options.host, options.port, options.timeout_s)
    with _bar(log.frames) as bar:

        def ready(address: str) -> None:
            bar.write(f"watch it at {address}, with any client of CARLA's", file=sys.stderr)

        play(log, where, speed=arguments.speed, progress=Progress(ready, bar.update))
    return 0


def _log(arguments: argparse.Namespace) -> tuple[Log, Path | None]:
    """The recorder file that is meant, and its map."""
    from basu.records.carla_log import read_log  # noqa: PLC0415 - brings in the client, which `--help` does not need
    from basu.records.carla_log.sources import source  # noqa: PLC0415 - likewise

    where = source(arguments.recording, arguments.map)
    log = read_log(where.log)
    if log.problem is not None:
        print(f"basu: warning: {log.problem}", file=sys.stderr)
    return log, where.map


def _bar(total: int | None = None) -> Any:  # noqa: ANN401 - tqdm is generic to the type checker only
    from tqdm import tqdm  # noqa: PLC0415 - as above

    return tqdm(total=total, unit=" frames", desc="replaying", mininterval=0.1 if sys.stderr.isatty() else 10.0)
