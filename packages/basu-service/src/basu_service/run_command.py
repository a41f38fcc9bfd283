"""``basu service run``: one service on the console."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.cli.termination import terminated_as_interrupted
from basu.cli.typed_options import options_of
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.settings.option import Layer
from basu.simulator import started_early
from basu_service.console import table
from basu_service.running import ServiceConditions, drive_service, plan_service

if TYPE_CHECKING:
    import argparse

FAILED_CODE = 1
"""The exit code of a service that failed its passengers though no drive failed."""


def run(arguments: argparse.Namespace) -> int:
    """Drive a service; the exit code is that of the worst drive, or 1 for a service that failed.

    Raises:
        UserError, AgentError: it cannot be started like this.
        SimulatorError: there is no simulator, or it failed before the service began.
    """
    conditions = conditions_of(arguments)
    options = options_of(RunOptions, arguments, Layer({"shuttles": arguments.shuttles}))
    with terminated_as_interrupted(), started_early(options.simulator):
        driven = drive_service(options, plan_service(options, conditions), Scoring())
    for result in driven.done.results:
        if driven.document is None:
            print(f"basu: {result.outcome.message}")
    worst = max(int(result.outcome.status.fault.value) for result in driven.done.results)
    if driven.document is None:
        return worst
    print(table(driven.document))
    print(f"{'result folder':<18}{driven.done.folder}")
    if isinstance(driven.done.bug, Exception):
        raise driven.done.bug
    return worst if worst or driven.document["passed"] else FAILED_CODE


def conditions_of(arguments: argparse.Namespace) -> ServiceConditions:
    """Return the conditions of a command line.

    Raises:
        UserError: the service has no length.
    """
    return ServiceConditions(
        minutes=arguments.minutes,
        apart_min=arguments.apart,
        demand=arguments.demand,
        timetable=arguments.timetable,
        holds=not arguments.no_holding,
        bodies=arguments.bodies,
    )
