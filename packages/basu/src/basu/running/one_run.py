"""One run: a fresh world, the vehicle at the beginning of its route, the drive, and the draft of its folder."""

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

if TYPE_CHECKING:
    from pathlib import Path

    from basu.episode import Episode, Towns
    from basu.episode.episode import Ground
    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.scoring import Scoring
    from basu.options.run import RunOptions
    from basu.routing.route_file import RoutePoint
    from basu.running.preparation import Plan, RequestedRun
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


def run_one(session: Session, agents: AgentsManager, job: RequestedRun, *, output: Path, name: str) -> DriveDone:
    """Make one run and write its folder as a draft for ``name`` in ``output``.

    Raises:
        UserError, AgentError: it cannot be begun like this.
        SimulatorError: the simulator failed before it began.
    """
    started = datetime.now(timezone.utc)
    points = agents.own_route()
    spec = _spec(session, agents, job, points)
    one = AgentDrive(
        session.simulator,
        session.towns,
        spec,
        agents,
        session.plan.sensors,
        session.options,
        agent=session.plan.loaded.name,
        name=name,
        by_agent=session.plan.loaded.file is not None,
        quiet=session.quiet,
    )
    episode = one.episode
    ground = _laid(episode, is_planned_by_agent=points is not None)
    if session.pictures:
        import_pictures()
    draft = make_draft(output, name)
    try:
        driven = one.play(job.seed, draft)
    except BaseException:  # nothing was driven: no folder is kept
        shutil.rmtree(draft, ignore_errors=True)
        raise
    config = run_config(
        session.options,
        session.scoring,
        session.plan.loaded,
        agents.config,
        ground.description,
        own_simulator=session.simulator.own,
        started=started,
        seed=job.seed,
        traffic=episode.traffic,
        log=one.log,
        access=agents.access,
        ignored=agents.ignored,
    )
    met = results_of(episode.playing, driven.history, driven.outcome)
    own = user_metrics(session.options.metric_files)
    try:
        result = write_run_folder(
            draft,
            driven,
            session.scoring,
            ground.town.lanes,
            config,
            met,
            own,
            pictures=session.pictures,
        )
    except UserError as error:
        raise UserError(f"{error}; {_rest_of(draft)}") from error
    return DriveDone(draft, result, driven.bug)


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


def next_agents(session: Session, job: RequestedRun) -> AgentsManager:
    """Return the agent of a further run, under the conditions of the first: its ``config()`` cannot change them.

    Raises:
        UserError, AgentError: the agent cannot be made.
    """
    agents = new_agents(session.plan.loaded, session.options, job.seed, session.options.routes)
    agents.config = session.plan.agents.config
    return agents


def run_counted(
    session: Session, agents: AgentsManager | None, job: RequestedRun, *, output: Path, name: str
) -> DriveDone:
    """Make one run of a series as `run_one` does; an agent that fails before its drive has had its run.

    Raises:
        UserError: the run cannot be begun like this.
        SimulatorError: the simulator failed before it began.
    """
    try:
        with agents_fault(session.plan.loaded):
            agents = agents or next_agents(session, job)
        return run_one(session, agents, job, output=output, name=name)
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
    return EpisodeSpec(
        town=job.description.town,
        route=description,
        config=agents.config,
        weather=weather_called(agents.config.weather),
        weather_along=() if options.weather is not None else description.weather,
        traffic=options.traffic,
        sumo=options.sumo_of(sumo_folder(agents.config), session.plan.loaded.file),
        scenarios=waiting,
        scoring=session.scoring,
        timeout_s=options.timeout_s,
        stop_after_s=options.stop_after_s,
    )
