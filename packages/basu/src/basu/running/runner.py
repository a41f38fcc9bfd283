"""``basu run``: an agent on one or more routes, each run driven, scored and left in a folder."""

from __future__ import annotations

import contextlib
import shlex
from datetime import datetime, timezone
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.jobs.job import Job
from basu.outcome import Status
from basu.output.report.console import table
from basu.output.report.documents import CONFIG_FILE, LATEST, plain, point_latest, read_run, run_name
from basu.running.batch import Batch
from basu.running.exit_code import exit_code
from basu.running.preparation import prepare
from basu.running.run_player import OpenWorld, RunJobData, run_player
from basu.running.series import conditions, open_series

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.running.batch import PublishedDrive
    from basu.running.preparation import Job as RunJob
    from basu.running.preparation import Plan
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
    shown = series is not None or (options.workers > 1 and len(jobs) > 1)
    try:
        for done in runs(options, scoring, OpenWorld(prepared), jobs, series):
            if shown:
                print(f"run {done.number + 1} of {len(prepared.jobs)}")
            worst = max(worst, show(done, options))
    finally:
        if series is not None:
            print(series.table())
            print(f"series folder     {series.folder}")
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
    options: RunOptions, scoring: Scoring, here: OpenWorld, jobs: Sequence[RunJob], series: Series | None = None
) -> Iterator[PublishedDrive]:
    """Drive runs, one after the other in this process or by workers, and publish the folder of each.

    In this process the runs end with one that is interrupted or loses the simulator.

    Raises:
        UserError, AgentError: a run cannot begin.
        SimulatorError: the simulator failed before a run began.
    """
    if not jobs:
        return
    is_parallel = options.workers > 1 and len(jobs) > 1
    batch = Batch(options.output, _names(here.plan, jobs, is_parallel=is_parallel)) if series is None else series
    player = run_player(options, scoring, None if is_parallel else here)
    to_play = [Job(job.number, RunJobData(job.number, batch.folder, batch.name(job.number))) for job in jobs]
    with contextlib.closing(batch.play(player, to_play, options.workers)) as answers:
        for done in answers:
            if done.folder is not None:
                point_latest(done.folder, options.output)
            yield done
            ended = None if done.written is None else done.written.result.outcome.status
            if not is_parallel and ended in BREAKING_OFF:
                return


def _names(plan: Plan, jobs: Sequence[RunJob], *, is_parallel: bool) -> dict[int, str]:
    """Return the names of the folders of runs by themselves; those at the same time tell their repetition."""
    now = datetime.now(timezone.utc).astimezone()
    return {
        job.number: run_name(now, plan.loaded.name, f"{job.label}-{job.repetition}" if is_parallel else job.label)
        for job in jobs
    }


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


def show(done: PublishedDrive, options: RunOptions) -> int:
    """Show the result of a run and the place of its folder, and return its exit code.

    Raises:
        Exception: an error of our own in this process, once all is in its place.
    """
    if done.written is None or done.folder is None:
        assert done.failure is not None, "a drive without a folder has a reason"
        print(f"basu: {done.failure.sentence}")
        return int(done.failure.fault.value)
    result = done.written.result
    print(table(result))
    if options.record:
        recording = read_run(done.folder).config["recording"]
        print(f"recording         {recording['file']} ({recording['where']})")
    print(f"result folder     {done.folder}")
    print(f"to repeat         basu run --config {shlex.quote(f'{done.folder}/{CONFIG_FILE}')}")
    if isinstance(done.written.bug, Exception):
        raise done.written.bug
    if done.written.bug is not None:
        print(done.written.bug)
    scores = None if result.scores is None else result.scores._asdict()
    return exit_code(result.outcome.status, scores, options.require)
