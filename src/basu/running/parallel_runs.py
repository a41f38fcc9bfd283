"""``basu run --workers``: several routes and repetitions at the same time, each worker with a simulator of its own."""

from __future__ import annotations

import contextlib
import shlex
import traceback
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.episode import Towns
from basu.errors import AgentError, SimulatorError, UserError
from basu.jobs.job import After, Job, Lost, Played, PlayerSpec
from basu.jobs.playing import play_jobs
from basu.metrics.registry import user_metrics
from basu.metrics.result import Result
from basu.outcome import Fault, Status
from basu.output.report.console import table
from basu.output.report.documents import CONFIG_FILE, plain, point_latest, publish, run_name
from basu.running.exit_code import exit_code
from basu.running.one_run import Session, next_agents, run_counted, run_one
from basu.running.preparation import prepare
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from basu.jobs.job import Done, Play
    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.running.preparation import Job as RunJob
    from basu.running.preparation import Plan
    from basu.running.series import Series


class RunDone(NamedTuple):
    """A run that a worker has driven; its folder is a draft."""

    draft: Path
    document: dict[str, Any]  # its result
    bug: str | None  # the traceback of an error of our own


class NotBegun(NamedTuple):
    """A run that could not begin."""

    sentence: str
    fault: Fault


@contextlib.contextmanager
def open_runs(options: RunOptions, scoring: Scoring) -> Iterator[Play]:
    """Prepare all runs as the command has done, start a simulator, and drive the runs that the command sends.

    Raises:
        UserError, AgentError: nothing can be started like this.
        SimulatorError: there is no simulator.
    """
    prepared = prepare(options)
    user_metrics(options.metric_files)
    with simulator_for(options) as simulator:
        session = Session(options, scoring, prepared, simulator, Towns(simulator), quiet=True)

        def play(data: tuple[int, Path, str]) -> Played:
            number, output, name = data
            job = prepared.jobs[number]
            try:
                if options.series is not None:
                    done = run_counted(session, None, job, output=output, name=name)
                else:
                    done = run_one(session, next_agents(session, job), job, output=output, name=name)
            except UserError as error:
                return Played(NotBegun(str(error), Fault.SETUP))
            except AgentError as error:
                return Played(NotBegun(str(error), Fault.AGENT))
            except SimulatorError as error:
                return Played(NotBegun(str(error), Fault.SIMULATOR), After.AGAIN)
            bug = None if done.bug is None else "".join(traceback.format_exception(done.bug))
            ends = done.outcome.status in {Status.SIMULATOR_FAILED, Status.BENCHMARK_FAILED}
            return Played(RunDone(done.draft, done.document, bug), After.FRESH if ends else After.GO_ON)

        yield play


def check_parallel(options: RunOptions) -> None:
    """Check that runs may be driven at the same time.

    Raises:
        UserError: they share a simulator, a window or keys.
    """
    if options.host is not None:
        raise UserError("--workers starts a simulator for each worker; leave out --host, or --workers")
    if options.hud is not None or options.viewer or options.keys is not None or options.record_keys is not None:
        raise UserError("--workers drives several runs at once, which no window or keys follow; leave out --workers")


def run_in_parallel(
    options: RunOptions, scoring: Scoring, prepared: Plan, series: Series | None, jobs: Sequence[RunJob]
) -> int:
    """Drive runs with several workers; the exit code of the worst.

    Raises:
        UserError, SimulatorError: the workers cannot drive like this.
    """
    by_number = {job.number: job for job in jobs}
    names = {
        job.number: series.name(job)
        if series is not None
        else run_name(datetime.now(timezone.utc).astimezone(), prepared.loaded.name, f"{job.label}-{job.repetition}")
        for job in jobs
    }
    output = options.output if series is None else series.folder
    player = PlayerSpec(f"{__name__}:open_runs", (options, scoring))
    to_play = [Job(job.number, (job.number, output, names[job.number])) for job in jobs]
    worst = 0
    with contextlib.closing(play_jobs(player, to_play, options.workers)) as answers:
        for answer in answers:
            print(f"run {answer.number + 1} of {len(prepared.jobs)}")
            name = plain(names[answer.number])
            worst = max(worst, _finished(answer, by_number[answer.number], name, series, options))
    return worst


def _finished(answer: Done | Lost, job: RunJob, name: str, series: Series | None, options: RunOptions) -> int:
    """Give a run's folder its name, show its result, and return its exit code.

    Raises:
        UserError: the disk does not let us.
    """
    if isinstance(answer, Lost):
        print(f"basu: {answer.sentence}")
        return Fault.BENCHMARK.value
    done = answer.value
    if isinstance(done, NotBegun):
        print(f"basu: {done.sentence}")
        return int(done.fault.value)
    result = Result.from_document(done.document)
    print(table(result))
    folder = publish(done.draft, name) if series is None else series.publish(done.draft, job, done.document)
    point_latest(folder, options.output)
    print(f"result folder     {folder}")
    print(f"to repeat         basu run --config {shlex.quote(str(folder / CONFIG_FILE))}")
    if done.bug is not None:
        print(done.bug)
    scores = None if result.scores is None else result.scores._asdict()
    return exit_code(result.outcome.status, scores, options.require)
