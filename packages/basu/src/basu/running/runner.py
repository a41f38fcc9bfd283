"""``basu run``: an agent on one or more routes, each run driven, scored and left in a folder."""

from __future__ import annotations

import contextlib
import shlex
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.jobs.job import Job
from basu.jobs.playing import play_jobs
from basu.outcome import Status
from basu.output.report.console import table
from basu.output.report.documents import CONFIG_FILE, LATEST, TEXT_FILE, plain, point_latest, read_run, run_name
from basu.output.report.shuttles import contact_lines, read_shuttles, shuttle_line
from basu.running.batch import Batch
from basu.running.exit_code import exit_code
from basu.running.folder_lock import locked
from basu.running.preparation import prepare
from basu.running.run_player import OpenWorld, RunJobData, run_player
from basu.running.series import conditions, open_series
from basu.running.single_runs import open_runs

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.running.drive import DriveDone
    from basu.running.preparation import Plan
    from basu.running.preparation import RequestedRun as RunJob

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
    given = conditions(options, scoring, prepared)
    if options.series is not None:
        return _run_series(options, scoring, prepared, given)
    names = _names(prepared, prepared.jobs, is_parallel=options.workers > 1 and len(prepared.jobs) > 1)
    with open_runs(options.output, given, names, resume=options.resume) as batch:
        jobs = [job for job in prepared.jobs if job.number not in batch.done]
        is_parallel = options.workers > 1 and len(jobs) > 1
        return _drive(options, scoring, prepared, jobs, batch, shown=is_parallel or options.resume)


def _run_series(options: RunOptions, scoring: Scoring, prepared: Plan, given: Mapping[str, Any]) -> int:
    """Begin the series that the options name, or go on with it; return the exit code of its worst run.

    Raises:
        UserError, AgentError, SimulatorError: see ``run``.
    """
    name = plain(options.series or "")
    if name == LATEST:
        raise UserError(f"--series {options.series}: that name is kept for the newest run; choose another")
    folder = options.output / name
    with locked(folder):
        series = open_series(folder, given, prepared.jobs, prepared.loaded.name, resume=options.resume)
        jobs = [job for job in prepared.jobs if job.number not in series.done]
        worst = series.worst(options.require)
        try:
            worst = max(worst, _drive(options, scoring, prepared, jobs, series, shown=True))
        finally:
            print(series.table())
            print(f"series folder     {series.folder}")
    return worst


def _drive(
    options: RunOptions, scoring: Scoring, prepared: Plan, jobs: Sequence[RunJob], batch: Batch, *, shown: bool
) -> int:
    """Drive ``jobs`` and show what came of each, with its number if ``shown``; return the exit code of the worst."""
    worst = 0
    for done in runs(options, scoring, OpenWorld(prepared), jobs, batch):
        if shown:
            print(f"run {done.number + 1} of {len(prepared.jobs)}")
        worst = max(worst, show(done, options))
    return worst


def check_parallel(options: RunOptions) -> None:
    """Check that runs may be driven at the same time.

    Raises:
        UserError: they share a simulator, a window, keys or topics.
    """
    if options.host is not None:
        raise UserError("--workers starts a simulator for each worker; leave out --host, or --workers")
    if options.needs_one_simulator:
        raise UserError(
            "--workers drives several runs at once, which no window, keys or topics follow; leave out --workers"
        )


def runs(
    options: RunOptions, scoring: Scoring, here: OpenWorld, jobs: Sequence[RunJob], batch: Batch | None = None
) -> Iterator[DriveDone]:
    """Drive runs, one after the other in this process or by workers, and publish the folder of each.

    Without ``batch`` their folders are called by the time, and cannot be resumed.
    In this process the runs end with one that is interrupted or loses the simulator.

    Raises:
        UserError, AgentError: a run cannot begin.
        SimulatorError: the simulator failed before a run began.
    """
    if not jobs:
        return
    is_parallel = options.workers > 1 and len(jobs) > 1
    if batch is None:
        batch = Batch(options.output, _names(here.plan, jobs, is_parallel=is_parallel))
    player = run_player(options, scoring, None if is_parallel else here)
    drafts = batch.drafts or batch.folder
    to_play = [Job(job.number, RunJobData(job.number, drafts, batch.name(job.number))) for job in jobs]
    with contextlib.closing(batch.play(play_jobs(player, to_play, options.workers))) as answers:
        for done in answers:
            if done.folder is not None:
                point_latest(done.folder, options.output)
            yield done
            if not is_parallel and any(result.outcome.status in BREAKING_OFF for result in done.results):
                return


def _names(plan: Plan, jobs: Sequence[RunJob], *, is_parallel: bool) -> dict[int, str]:
    """Return the names of the folders of runs by themselves; those at the same time tell their repetition."""
    now = datetime.now(timezone.utc).astimezone()
    return {
        job.number: run_name(now, plan.loaded.name, f"{job.label}-{job.repetition}" if is_parallel else job.label)
        for job in jobs
    }


def show(done: DriveDone, options: RunOptions) -> int:
    """Show the result of a run and the place of its folder, and return its exit code.

    Raises:
        Exception: an error of our own in this process, once all is in its place.
    """
    result = done.result
    if done.folder is None:
        print(f"basu: {result.outcome.message}")
        return int(result.outcome.status.fault.value)
    document = read_shuttles(done.folder)
    for number, each in enumerate(done.results):
        if document is not None:
            print(shuttle_line(document, number))
        print(table(each, details=options.details))
    if document is not None:
        print("\n".join(contact_lines(document)))
    recording = read_run(done.folder).config["recording"] if options.record else None
    if recording is not None:  # else nothing was driven
        print(f"recording         {recording['file']} ({recording['where']})")
    print(f"result folder     {done.folder}")
    if not options.details:
        print(f"further figures   {TEXT_FILE} in this folder; --details prints them here")
    print(f"to repeat         basu run --config {shlex.quote(f'{done.folder}/{CONFIG_FILE}')}")
    if isinstance(done.bug, Exception):
        raise done.bug
    if done.bug is not None:
        print(done.bug)
    return max(
        exit_code(each.outcome.status, None if each.scores is None else each.scores._asdict(), options.require)
        for each in done.results
    )
