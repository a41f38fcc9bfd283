"""Drives services by the one engine of drives: the plan of a run with rounds, operators of the doors, the document.

A worker writes a service whole into its draft, `service.json` included. So a folder under its name is a whole service,
and a command that goes on after a kill finds what is there (`basu.running.batch`).
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.episode import Towns
from basu.episode.failures import outcome_of
from basu.episode.world import check_towns
from basu.errors import AgentError, SimulatorError, UserError
from basu.files import find
from basu.jobs.job import After, Job, JobOutcome, PlayerSpec
from basu.jobs.playing import play_jobs
from basu.metrics.registry import user_metrics
from basu.metrics.scoring import Scoring
from basu.outcome import Status
from basu.output.report.documents import point_latest, run_name
from basu.output.report.shuttles import read_shuttles
from basu.routing.timetable import read_timetable
from basu.running.batch import Batch
from basu.running.drive import not_begun
from basu.running.one_run import Session, run_one
from basu.running.preparation import prepare
from basu.running.run_player import ENDING
from basu.simulator import simulator_for
from basu_service.bodies import Bodies
from basu_service.demand import packaged_demand, read_demand
from basu_service.document import SERVICE_FILE, read_service, write_service
from basu_service.figures import Operated
from basu_service.operation import Service
from basu_service.operator import VehicleOperator
from basu_service.page import write_page
from basu_service.persons import draw_persons
from basu_service.plan import make_plan
from basu_service.result import service_document

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from basu.jobs.job import Play
    from basu.options.run import RunOptions
    from basu.running.drive import DriveDone
    from basu.running.preparation import Plan
    from basu.simulator import Simulator
    from basu_service.demand import Demand
    from basu_service.document import ServiceDocument
    from basu_service.plan import ServicePlan

MOST_MINUTES = 24 * 60


@dataclass(frozen=True, kw_only=True)
class ServiceConditions:
    """What a service is beside its vehicles and agents."""

    minutes: float = 30.0
    apart_min: float | None = None  # between two vehicles at the start, by the timetable; None: equal times
    demand: str | None = None  # a file; None: that of this distribution
    timetable: str | None = None  # a file; None: that of the route
    holds: bool = True  # whether vehicles wait at stops for the timetable
    bodies: bool = False  # whether persons that wait are walkers in the world

    def __post_init__(self) -> None:
        """Check the length.

        Raises:
            UserError: it is none.
        """
        if not 0.0 < self.minutes <= MOST_MINUTES:
            raise UserError(
                f"--minutes is {self.minutes:g}; a service lasts more than 0 and at most {MOST_MINUTES} min"
            )


class PlannedService(NamedTuple):
    """A service with its files read and checked; nothing was started."""

    run: Plan
    plan: ServicePlan
    demand: Demand
    conditions: ServiceConditions


class DrivenService(NamedTuple):
    """A service that was driven."""

    done: DriveDone
    document: ServiceDocument | None  # None where nothing was driven


def plan_service(options: RunOptions, conditions: ServiceConditions) -> PlannedService:
    """Read and check agents, route, timetable and demand.

    Raises:
        UserError, AgentError: nothing can be started like this.
    """
    run = prepare(options)
    if len(run.jobs) != 1:
        raise UserError(f"a service drives one route, and the file has {len(run.jobs)}; choose one with --route-id")
    job = run.jobs[0]
    description = job.description
    stop_ids = [mark.id for mark in description.stops]
    if conditions.timetable is not None:
        path = find(conditions.timetable, "timetable", None)
        description = replace(description, timetable=read_timetable(path, stop_ids))
    plan = make_plan(
        description, len(run.shuttles), None if conditions.apart_min is None else 60.0 * conditions.apart_min
    )
    path = packaged_demand() if conditions.demand is None else find(conditions.demand, "demand", None)
    demand = read_demand(path, stop_ids)
    lasts_s = 60.0 * conditions.minutes
    job = job._replace(description=plan.rounds(lasts_s), scenarios=())
    shuttles = tuple(
        shuttle._replace(start_m=start_m) for shuttle, start_m in zip(run.shuttles, plan.starts_m, strict=True)
    )
    return PlannedService(replace(run, jobs=(job,), shuttles=shuttles), plan, demand, conditions)


class ServiceJob(NamedTuple):
    """A service for a worker."""

    agent: str
    seed: int
    output: Path  # the parent of its folder
    name: str  # of its folder


class OpenService(NamedTuple):
    """What this process has ready for a service: its plan, and a simulator that is open already."""

    planned: PlannedService
    world: tuple[Simulator, Towns] | None = None  # None: a simulator is started, or connected to
    quiet: bool = False  # no progress bar


def drive_service(
    options: RunOptions,
    planned: PlannedService,
    scoring: Scoring,
    world: tuple[Simulator, Towns] | None = None,
    *,
    quiet: bool = False,
) -> DrivenService:
    """Drive one service in this process, with its document and page in the folder of the run.

    Raises:
        UserError, AgentError: it cannot begin.
        SimulatorError: the simulator failed before it began.
    """
    loaded, label = planned.run.loaded, planned.run.jobs[0].label
    name = run_name(datetime.now(timezone.utc).astimezone(), loaded.name, label)
    batch = Batch(options.output, {0: name})
    player = service_player(options, planned.conditions, scoring, OpenService(planned, world, quiet))
    jobs = [Job(0, ServiceJob(options.agent, options.seed, options.output, name))]
    with contextlib.closing(batch.play(play_jobs(player, jobs, 1))) as answers:
        done = next(answers)
    if done.folder is None:
        return DrivenService(done, None)
    point_latest(done.folder, options.output)
    return DrivenService(done, read_service(done.folder) if (done.folder / SERVICE_FILE).exists() else None)


def service_player(
    options: RunOptions, conditions: ServiceConditions, scoring: Scoring, here: OpenService | None = None
) -> PlayerSpec:
    """Return the player of services; ``here`` is given where one is driven in this process, with its progress."""
    return PlayerSpec(f"{__name__}:open_services", (options, conditions, scoring, here))


@contextlib.contextmanager
def open_services(
    options: RunOptions, conditions: ServiceConditions, scoring: Scoring, here: OpenService | None
) -> Iterator[Play]:
    """Start a simulator, and drive the services that the command sends; each has a fresh world in it.

    A service that cannot begin raises its error where ``here`` is given; else the answer has its sentence.

    Raises:
        UserError: a metric's file has none.
        SimulatorError: there is no simulator.
    """
    user_metrics(options.metric_files)
    with contextlib.ExitStack() as resources:
        world = None if here is None else here.world
        if world is None:
            simulator = resources.enter_context(simulator_for(options.simulator))
            world = simulator, Towns(simulator)

        def play(job: ServiceJob) -> JobOutcome:
            one = replace(options, agent=job.agent, seed=job.seed)
            try:
                planned = plan_service(one, conditions) if here is None else here.planned
                done = _driven(one, planned, scoring, world, job, quiet=here is None or here.quiet)
            except (UserError, AgentError, SimulatorError) as error:
                if here is not None:
                    raise
                again = isinstance(error, SimulatorError)
                outcome = outcome_of(error, world[0].why_gone)
                return JobOutcome(not_begun(outcome), After.AGAIN if again else After.GO_ON)
            ends = {result.outcome.status for result in done.results}
            after = After.FRESH if ends & ENDING else After.GO_ON
            if Status.INTERRUPTED in ends:
                after = After.INTERRUPTED
            return JobOutcome(done.to_send() if here is None else done, after)

        yield play


def _driven(
    options: RunOptions,
    planned: PlannedService,
    scoring: Scoring,
    world: tuple[Simulator, Towns],
    job: ServiceJob,
    *,
    quiet: bool,
) -> DriveDone:
    """Drive a service, and write its document and page into the draft of its folder."""
    plan, conditions = planned.plan, planned.conditions
    lasts_s = 60.0 * conditions.minutes
    people = draw_persons(planned.demand, options.seed, plan.timetable.run_departure_s, lasts_s)
    due = (plan.planned_departure_s,) if conditions.holds else ()
    service = Service(people, len(planned.run.shuttles), *due)
    beside = [(Bodies(service),) if conditions.bodies and place == 0 else () for place in range(len(plan.starts_m))]
    operators = [VehicleOperator(service, place, plan, others) for place, others in enumerate(beside)]
    shuttles = tuple(
        shuttle._replace(operator=operator) for shuttle, operator in zip(planned.run.shuttles, operators, strict=True)
    )
    run = replace(planned.run, shuttles=shuttles)
    simulator, towns = world
    town = run.jobs[0].description.town
    check_towns(towns.names({town}), {town})
    session = Session(replace(options, stop_after_s=lasts_s), scoring, run, simulator, towns, quiet=quiet)
    done = run_one(session, shuttles, run.jobs[0], output=job.output, name=job.name)
    assert done.folder is not None, "a run that began has a draft"
    ended_s = min(lasts_s, max(operator.last_s for operator in operators))
    service.finish(ended_s)
    operated = Operated(plan, planned.demand, service, done.results, conditions.minutes, ended_s)
    document = service_document(
        operated,
        seed=options.seed,
        holds=conditions.holds,
        agents=[shuttle.loaded.name for shuttle in shuttles],
        contacts_between=_contacts_between(done.folder),
    )
    write_service(done.folder, document)
    write_page(done.folder, document, plan, [operator.trace for operator in operators])
    return done


def _contacts_between(folder: Path) -> int:
    """Return how many contacts two vehicles of the service had with each other."""
    shuttles: dict[str, Any] | None = read_shuttles(folder)
    return 0 if shuttles is None else len(shuttles["contacts"])
