"""``basu run``: an agent, a simulator, one or more routes; each run driven, scored and left in a folder."""

from __future__ import annotations

import shlex
from datetime import datetime, timezone
from typing import TYPE_CHECKING

from basu.episode import Towns
from basu.episode.world import check_towns
from basu.errors import UserError
from basu.outcome import Status
from basu.output.report.documents import CONFIG_FILE, LATEST, plain, point_latest, publish, run_name
from basu.routing.route_file import OWN_ROUTE
from basu.running.exit_code import exit_code
from basu.running.one_run import Session, next_agents, run_counted, run_one
from basu.running.parallel_runs import check_parallel, run_in_parallel
from basu.running.preparation import prepare
from basu.running.series import conditions, open_series
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.running.one_run import Finished
    from basu.running.preparation import Job, Plan
    from basu.running.series import Series

BREAKING_OFF = frozenset({Status.INTERRUPTED, Status.SIMULATOR_FAILED})  # no further run would fare better


def run(options: RunOptions, scoring: Scoring) -> int:
    """Run all requested runs; the exit code is that of the worst outcome.

    Raises:
        UserError, AgentError: nothing can be started like this.
        SimulatorError: there is no simulator to run in.
    """
    if options.workers > 1:
        check_parallel(options)
    prepared = prepare(options)
    series = _series(options, scoring, prepared)
    jobs = [job for job in prepared.jobs if series is None or job.number not in series.done]
    worst = 0 if series is None else series.worst(options.require)
    try:
        if jobs:
            play = run_in_parallel if options.workers > 1 and len(jobs) > 1 else _run_all
            worst = max(worst, play(options, scoring, prepared, series, jobs))
    finally:
        if series is not None:
            print(series.table())
            print(f"series folder     {series.folder}")
    return worst


def _series(options: RunOptions, scoring: Scoring, prepared: Plan) -> Series | None:
    """The series of all runs, where the options name one.

    Raises:
        UserError: it can be neither begun nor gone on with.
    """
    if options.series is None:
        return None
    name = plain(options.series)
    if name == LATEST:
        raise UserError(f"--series {options.series}: that name is kept for the newest run; choose another")
    folder = options.output / name
    given = conditions(options, scoring, prepared)
    return open_series(folder, given, prepared.jobs, prepared.loaded.name, resume=options.resume)


def _run_all(options: RunOptions, scoring: Scoring, prepared: Plan, series: Series | None, jobs: list[Job]) -> int:
    """Run one job after the other in one simulator; the exit code of the worst."""
    worst = 0
    with simulator_for(options) as simulator:
        session = Session(options, scoring, prepared, simulator, Towns(simulator))
        for done, folder in runs(session, jobs, series):
            print(f"result folder     {folder}")
            print(f"to repeat         basu run --config {shlex.quote(str(folder / CONFIG_FILE))}")
            if done.bug is not None:
                raise done.bug
            scores = None if done.result.scores is None else done.result.scores._asdict()
            worst = max(worst, exit_code(done.outcome.status, scores, options.require))
    return worst


def runs(session: Session, jobs: Sequence[Job], series: Series | None = None) -> Iterator[tuple[Finished, Path]]:
    """Run one job after the other; each run with its folder, until a run is interrupted or loses the simulator.

    Raises:
        UserError, AgentError: a run cannot begin.
        SimulatorError: the simulator failed before a run began.
    """
    options, prepared = session.options, session.plan
    wanted = {job.description.town for job in jobs}
    check_towns(session.towns.names(wanted), wanted)
    for nth, job in enumerate(jobs):
        agents = prepared.agents if nth == 0 and job.seed == options.seed else None
        if series is not None:
            print(f"run {job.number + 1} of {len(prepared.jobs)}")
            done = run_counted(session, agents, job, output=series.folder, name=series.name(job))
            folder = series.publish(done.draft, job, done.document)
        else:
            name = run_name(datetime.now(timezone.utc).astimezone(), prepared.loaded.name, job.label)
            done = run_one(session, agents or next_agents(session, job), job, output=options.output, name=name)
            folder = publish(done.draft, _final(name, done))
        point_latest(folder, options.output)
        yield done, folder
        if done.outcome.status in BREAKING_OFF:
            return


def _final(name: str, done: Finished) -> str:
    """Return the name of a run's folder: that of a route that the agent has planned says that it is its own."""
    return f"{name}{OWN_ROUTE}" if done.result.has_own_route and not name.endswith(OWN_ROUTE) else name
