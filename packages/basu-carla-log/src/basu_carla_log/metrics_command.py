"""``basu metrics``: a metric of the user's on a recording."""

from __future__ import annotations

import argparse
import traceback
from pathlib import Path
from typing import Any

from basu.errors import UserError
from basu.records.recording_files import read_map
from basu_carla_log.metric_file import drawn, off_screen, run_metric
from basu_carla_log.metrics_log import MetricsLog
from basu_carla_log.recorder_log import read_recording
from basu_carla_log.sources import AbsentMap, Source, criteria_of, read_criteria


def run(arguments: argparse.Namespace) -> int:
    """Run a metric on a recording alone, without a simulator."""
    log, where = read_recording(arguments.recording, arguments.map)
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
    return AbsentMap(name) if where.map is None else read_map(where.map, name)


def _criteria(where: Source, given: Path | None) -> dict[str, Any] | None:
    if given is not None:
        return read_criteria(given)
    return None if where.result is None else criteria_of(where.result)
