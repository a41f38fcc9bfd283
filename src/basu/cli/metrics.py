"""``basu metrics``: puts a question of the user's own to a recording."""

from __future__ import annotations

import argparse
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.errors import UserError

if TYPE_CHECKING:
    from basu.records.carla_log.sources import Source


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``metrics``."""
    metrics = commands.add_parser(
        "metrics", help="run a metric of your own on a recording", description=ask_recording.__doc__
    )
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


def ask_recording(arguments: argparse.Namespace) -> int:
    """Run a metric on a recording alone; no simulator is asked."""
    from basu.records.carla_log import read_log  # noqa: PLC0415 - brings in the client, which `--help` does not need
    from basu.records.carla_log.metric_file import run_metric  # noqa: PLC0415 - likewise
    from basu.records.carla_log.metrics_log import MetricsLog  # noqa: PLC0415 - likewise
    from basu.records.carla_log.pictures import drawn, off_screen  # noqa: PLC0415 - likewise, and matplotlib
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
