"""The player of runs on routes: a simulator and its towns, kept from one run to the next."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NamedTuple

from basu.episode import Towns
from basu.episode.failures import outcome_of
from basu.episode.world import check_towns
from basu.errors import AgentError, SimulatorError, UserError
from basu.jobs.job import After, JobOutcome, PlayerSpec
from basu.metrics.registry import user_metrics
from basu.outcome import Status
from basu.running.drive import not_begun
from basu.running.one_run import Session, next_shuttles, run_counted, run_one
from basu.running.preparation import prepare
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from basu.jobs.job import Play
    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.running.drive import DriveDone
    from basu.running.preparation import Plan
    from basu.running.preparation import RequestedRun as RunJob
    from basu.running.shuttles import Shuttle
    from basu.simulator import Simulator

ENDING = frozenset({Status.SIMULATOR_FAILED, Status.BENCHMARK_FAILED})


class RunJobData(NamedTuple):
    """A run for a worker."""

    number: int  # of the job in the plan
    output: Path  # the parent of its folder
    name: str  # of its folder


class OpenWorld(NamedTuple):
    """What this process has ready for runs: the plan, and a simulator that is open already."""

    plan: Plan
    simulator: Simulator | None = None  # None: one is started, or connected to
    towns: Towns | None = None
    quiet: bool = False  # no progress bar


def run_player(options: RunOptions, scoring: Scoring, here: OpenWorld | None = None) -> PlayerSpec:
    """Return the player of runs; ``here`` is given where they are driven in this process."""
    return PlayerSpec(f"{__name__}:open_runs", (options, scoring, here))


@contextlib.contextmanager
def open_runs(options: RunOptions, scoring: Scoring, here: OpenWorld | None) -> Iterator[Play]:
    """Prepare all runs as the command has done, start a simulator, and drive the runs that the command sends.

    A run that cannot begin raises its error in this process; a worker answers with its sentence.

    Raises:
        UserError, AgentError: nothing can be started like this.
        SimulatorError: there is no simulator.
    """
    plan = prepare(options) if here is None else here.plan
    user_metrics(options.metric_files)
    with contextlib.ExitStack() as resources:
        simulator = None if here is None else here.simulator
        if simulator is None:
            simulator = resources.enter_context(simulator_for(options.simulator))
        towns = (None if here is None else here.towns) or Towns(simulator)
        wanted = {job.description.town for job in plan.jobs}
        check_towns(towns.names(wanted), wanted)
        session = Session(options, scoring, plan, simulator, towns, quiet=here is None or here.quiet)
        first = [] if here is None else [plan.shuttles]

        def play(data: RunJobData) -> JobOutcome:
            job = plan.jobs[data.number]
            # the agents that were made to be asked for their wishes drive the first run; they were made with its seed
            shuttles = first.pop() if first and job.seed == options.seed else None
            first.clear()
            try:
                done = _driven(session, shuttles, job, data)
            except (UserError, AgentError, SimulatorError) as error:
                if here is not None:
                    raise
                again = isinstance(error, SimulatorError)  # without a simulator it is tried again
                return JobOutcome(
                    not_begun(outcome_of(error, simulator.why_gone)), After.AGAIN if again else After.GO_ON
                )
            ends = any(result.outcome.status in ENDING for result in done.results)
            return JobOutcome(done.to_send() if here is None else done, After.FRESH if ends else After.GO_ON)

        yield play


def _driven(session: Session, shuttles: Sequence[Shuttle] | None, job: RunJob, data: RunJobData) -> DriveDone:
    """Drive one run; in a series, an agent that fails before its drive has had its run."""
    if session.options.series is not None:
        return run_counted(session, shuttles, job, output=data.output, name=data.name)
    return run_one(session, shuttles or next_shuttles(session, job), job, output=data.output, name=data.name)
