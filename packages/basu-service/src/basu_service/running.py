"""Drives a service with BASU's own runs: the plan of a run with rounds, operators of the doors, and the document."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import find
from basu.metrics.scoring import Scoring
from basu.output.report.shuttles import read_shuttles
from basu.routing.timetable import read_timetable
from basu.running.preparation import prepare
from basu.running.run_player import OpenWorld
from basu.running.runner import runs
from basu_service.demand import packaged_demand, read_demand
from basu_service.document import write_service
from basu_service.figures import Operated
from basu_service.operation import Service
from basu_service.operator import VehicleOperator
from basu_service.page import write_page
from basu_service.persons import draw_persons
from basu_service.plan import make_plan
from basu_service.result import service_document

if TYPE_CHECKING:
    from pathlib import Path

    from basu.episode import Towns
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


def drive_service(
    options: RunOptions,
    planned: PlannedService,
    scoring: Scoring,
    world: tuple[Simulator, Towns] | None = None,
    *,
    quiet: bool = False,
) -> DrivenService:
    """Drive a service, and write its document and page into the folder of the run.

    Raises:
        UserError, AgentError: it cannot begin.
        SimulatorError: the simulator failed before it began.
    """
    plan, conditions = planned.plan, planned.conditions
    lasts_s = 60.0 * conditions.minutes
    people = draw_persons(planned.demand, options.seed, plan.timetable.run_departure_s, lasts_s)
    due = (plan.planned_departure_s,) if conditions.holds else ()
    service = Service(people, len(planned.run.shuttles), *due)
    operators = [VehicleOperator(service, place, plan) for place in range(len(plan.starts_m))]
    shuttles = tuple(
        shuttle._replace(operator=operator) for shuttle, operator in zip(planned.run.shuttles, operators, strict=True)
    )
    run = replace(planned.run, shuttles=shuttles)
    options = replace(options, stop_after_s=lasts_s)
    simulator, towns = (None, None) if world is None else world
    done = next(iter(runs(options, scoring, OpenWorld(run, simulator, towns, quiet), run.jobs)))
    if done.folder is None:
        return DrivenService(done, None)
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
    return DrivenService(done, document)


def _contacts_between(folder: Path) -> int:
    """Return how many contacts two vehicles of the service had with each other."""
    shuttles: dict[str, Any] | None = read_shuttles(folder)
    return 0 if shuttles is None else len(shuttles["contacts"])
