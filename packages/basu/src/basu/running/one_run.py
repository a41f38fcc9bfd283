"""One run: a fresh world, its vehicles on the route, the drive, and the draft of its folder."""

from __future__ import annotations

import shutil
import sys
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING

from basu.episode import EpisodeSpec
from basu.episode.failures import outcome_of
from basu.episode.world import weather_called
from basu.errors import AgentCrashedError, AgentError, UserError
from basu.managers.scenario_results import results_of
from basu.metrics.registry import user_metrics
from basu.output.report.documents import make_draft
from basu.running.agent_drive import AgentDrive
from basu.running.drive import DriveDone, Driven
from basu.running.preparation import agents_fault, new_agents, sumo_folder
from basu.running.run_folder import import_pictures, run_config, write_run_folder
from basu.running.shuttle_documents import known_as, shuttle_facts, write_shuttles

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu.episode import Episode, Towns
    from basu.episode.episode import Ground
    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.routing.route_file import RoutePoint
    from basu.running.preparation import Plan, RequestedRun
    from basu.running.shuttles import Shuttle
    from basu.simulator import Simulator


@dataclass(frozen=True, slots=True)
class Session:
    """What all runs of one command share."""

    options: RunOptions
    scoring: Scoring
    plan: Plan
    simulator: Simulator
    towns: Towns
    quiet: bool = False  # no progress bar
    pictures: bool = True  # whether each run gets its picture and its report


def run_one(session: Session, shuttles: Sequence[Shuttle], job: RequestedRun, *, output: Path, name: str) -> DriveDone:
    """Make one run and write its folder as a draft for ``name`` in ``output``.

    Raises:
        UserError, AgentError: it cannot be begun like this.
        SimulatorError: the simulator failed before it began.
    """
    started = datetime.now(timezone.utc)
    first = shuttles[0]
    points = first.agents.own_route()
    spec = _spec(session, first.agents, job, points)
    one = AgentDrive(
        session.simulator,
        session.towns,
        spec,
        shuttles,
        session.options,
        name=name,
        quiet=session.quiet,
        watched=session.options.watch_shuttle,
    )
    episode = one.episode
    ground = _laid(episode, is_planned_by_agent=points is not None)
    if session.pictures:
        import_pictures()
    draft = make_draft(output, name)
    try:
        for shuttle in shuttles[1:]:
            (draft / shuttle.folder).mkdir()
        driven = one.play(job.seed, draft)
    except BaseException:  # nothing was driven: no folder is kept
        shutil.rmtree(draft, ignore_errors=True)
        raise
    own = user_metrics(session.options.metric_files)
    results = []
    for shuttle, drive in zip(shuttles, driven, strict=True):
        config = run_config(
            session.options,
            session.scoring,
            shuttle.loaded,
            shuttle.agents.config,
            ground.description,
            typed=shuttle.typed,
            own_simulator=session.simulator.own,
            started=started,
            seed=job.seed,
            traffic=episode.traffic,
            log=one.log,
            access=shuttle.agents.access,
            ignored=shuttle.agents.ignored,
            shuttle=shuttle_facts(shuttle, shuttles),
        )
        met = results_of(episode.playing, drive.history, drive.outcome) if shuttle is first else ()
        try:
            result = write_run_folder(
                draft / shuttle.folder,
                drive,
                session.scoring,
                ground.town.lanes,
                config,
                met,
                own,
                pictures=session.pictures,
            )
        except UserError as error:
            raise UserError(f"{error}; {_rest_of(draft)}") from error
        results.append(result)
    if len(shuttles) > 1:
        write_shuttles(draft, shuttles, results, known_as(episode.vehicles))
    bug = next((drive.bug for drive in driven if drive.bug is not None), None)
    return DriveDone(draft, results[0], bug, beside=tuple(results[1:]))


def _laid(episode: Episode, *, is_planned_by_agent: bool) -> Ground:
    """Lay the route on its town.

    Raises:
        UserError: the route has no place there.
        AgentCrashedError: neither has the route that the agent planned, which is its own failure.
    """
    try:
        return episode.lay()
    except UserError as error:
        if is_planned_by_agent:
            raise AgentCrashedError(f"get_initial_route_locations() gives no route: {error}") from error
        raise


def next_shuttles(session: Session, job: RequestedRun) -> tuple[Shuttle, ...]:
    """Return the shuttles of a further run, under the conditions of the first: no ``config()`` can change them.

    Raises:
        UserError, AgentError: an agent cannot be made.
    """
    found = []
    for planned in session.plan.shuttles:
        is_first = planned.number == 1
        routes = session.options.routes if is_first else None
        agents = new_agents(
            planned.loaded,
            session.options,
            job.seed,
            routes,
            has_conditions=is_first,
            shuttle=planned.number,
            is_watched=planned.number == session.options.watch_shuttle,
        )
        agents.config = planned.agents.config
        found.append(planned._replace(agents=agents))
    return tuple(found)


def run_counted(
    session: Session, shuttles: Sequence[Shuttle] | None, job: RequestedRun, *, output: Path, name: str
) -> DriveDone:
    """Make one run of a series as `run_one` does; an agent that fails before its drive has had its run.

    Raises:
        UserError: the run cannot be begun like this.
        SimulatorError: the simulator failed before it began.
    """
    try:
        with agents_fault(session.plan.loaded):
            shuttles = shuttles or next_shuttles(session, job)
        return run_one(session, shuttles, job, output=output, name=name)
    except AgentError as error:
        outcome = outcome_of(error, session.simulator.why_gone)
        driven = Driven(outcome, None, 0.0, None, None, error)
    options, plan = session.options, session.plan
    config = run_config(
        options,
        session.scoring,
        plan.loaded,
        plan.agents.config,
        job.description,
        typed=options.agent,
        own_simulator=session.simulator.own,
        started=datetime.now(timezone.utc),
        seed=job.seed,
        traffic={"vehicles": 0, "walkers": 0},
        log=None,
        access=plan.agents.access,
    )
    draft = make_draft(output, name)
    result = write_run_folder(draft, driven, session.scoring, None, config, pictures=False)
    return DriveDone(draft, result)


def _rest_of(draft: Path) -> str:
    """Return what became of the draft of a run that could not be written; an empty one is removed."""
    try:
        draft.rmdir()
    except OSError:
        return f"what could be written of the run lies in the hidden folder {draft}, which may be deleted"
    return "nothing of the run was written"


def _spec(
    session: Session, agents: AgentsManager, job: RequestedRun, points: tuple[RoutePoint, ...] | None
) -> EpisodeSpec:
    """Return the episode of a job; ``points`` are a route of the agent's own, without the scenarios of the file's."""
    description, waiting = job.description, job.scenarios
    if points is not None:
        description = replace(description.as_own(), points=points, stops=())
        if waiting:
            sys.stderr.write(
                f"basu: warning: the agent goes a way of its own, so the {len(waiting)} scenarios on the way of route "
                f"'{job.description.id}' are skipped\n"
            )
            waiting = ()
    options = session.options
    sumo = options.sumo_of(sumo_folder(agents.config), session.plan.loaded.file)
    if sumo is not None and session.plan.shuttles[0].operator is not None:
        sumo = sumo._replace(has_riders=False)
    return EpisodeSpec(
        town=job.description.town,
        route=description,
        config=agents.config,
        weather=weather_called(agents.config.weather),
        weather_along=() if options.weather is not None else description.weather,
        traffic=options.traffic,
        sumo=sumo,
        scenarios=waiting,
        scoring=session.scoring,
        timeout_s=options.timeout_s,
        stop_after_s=options.stop_after_s,
    )
