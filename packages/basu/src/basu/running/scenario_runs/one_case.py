"""Plays one case with one agent in a fresh world and writes its folder."""

from __future__ import annotations

import shutil
import time
import traceback
from dataclasses import dataclass, field, replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.episode import case_spec
from basu.episode.failures import outcome_of
from basu.episode.world import weather_called
from basu.errors import AgentError, ScenarioError, SimulatorError, UserError
from basu.files import write_bytes
from basu.metrics.registry import user_metrics
from basu.metrics.result import judge
from basu.metrics.scoring import Scoring
from basu.output.report.documents import CONFIG_FILE, RESULT_FILE, make_draft, plain, write_json
from basu.output.report.scenarios.drawing.picture import PICTURE_FILE, case_picture
from basu.output.report.streets import around, write_streets
from basu.records.history.files import write_history
from basu.routing.route_file import RouteDescription
from basu.running.agent_drive import AgentDrive
from basu.running.drive import DriveDone, Driven
from basu.running.preparation import agents_fault, new_agents, sensor_set
from basu.running.run_folder import drive_facts, meta_of
from basu.running.scenario_runs.case_documents import case_config, case_part, typed_name
from basu.running.shuttles import SensorSet, Shuttle
from basu.scenarios.characteristics import WEATHER_OF_CASE
from basu.scenarios.verdict import judge as verdict_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.remote_agent import FoundAgent
    from basu.episode import Towns
    from basu.managers.agents_manager import AgentsManager
    from basu.managers.scenario_manager import Playing
    from basu.records.history import History
    from basu.routing.lane_graph import Street
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.playable import Playable
    from basu.scenarios.verdict import Judged
    from basu.scenarios.xml_elements import Case
    from basu.simulator import Simulator


NO_OTHERS = {"vehicles": 0, "walkers": 0}


@dataclass(frozen=True, slots=True)
class CaseSession:
    """What all cases of one worker share."""

    options: ScenarioOptions
    simulator: Simulator
    towns: Towns
    scoring: Scoring = field(default_factory=Scoring)
    pictures: bool = True  # whether each case gets its picture


def check_town(case: Case, names: frozenset[str]) -> None:
    """Whether a case can be played in a simulator with towns of these names.

    Raises:
        ScenarioError: its town is not among them.
    """
    if case.town not in names:
        there = ", ".join(sorted(names))
        raise ScenarioError(
            f"{case.name} is in {case.town}, which this simulator does not have (it has {there}): play it on one that "
            f"has, with --host, or give the case a place in {there} ({case.source})"
        )


class _Attempt(NamedTuple):
    """What came of a case, whatever that is."""

    driven: Driven
    config: AgentConfig
    playing: Playing | None = None
    streets: Sequence[Street] = ()
    access: dict[str, Any] | None = None  # of the agent to the simulator
    traffic: Mapping[str, int] = NO_OTHERS
    log: str | None = None  # CARLA's log, as the simulator gave its path
    ignored: str = ""  # a sentence about wishes of the agent that do not count


def play_case(
    session: CaseSession, loaded: FoundAgent, playable: Playable, output: Path, name: str, repetition: int = 0
) -> DriveDone:
    """Play a case and write its folder as a draft for ``name``; whatever goes wrong becomes its verdict."""
    started, began_s = datetime.now(timezone.utc), time.perf_counter()
    options = replace(session.options, seed=session.options.drive_seed + repetition, sweep=None)
    draft = make_draft(output, name)
    try:
        attempt = _attempt(session, options, loaded, playable, draft)
        driven = attempt.driven
        history = driven.history
        config = {
            **case_config(playable, options, session.scoring, loaded),
            **drive_facts(
                options,
                loaded,
                typed_name(options, loaded),
                attempt.config,
                RouteDescription(
                    id=playable.case.name, town=playable.case.town, points=(), stops=(), source=playable.case.source
                ),
                weather=options.weather or WEATHER_OF_CASE,
                own_simulator=session.simulator.own,
                started=started,
                seed=options.seed,
                traffic=attempt.traffic,
                log=attempt.log,
                access=attempt.access,
                ignored=attempt.ignored,
            ),
        }
        judged = _judged(attempt, history)
        case = case_part(
            playable,
            loaded,
            attempt.playing,
            judged,
            options,
            history=history,
            wall_s=time.perf_counter() - began_s,
        )
        result = judge(
            judged.outcome,
            history,
            session.scoring,
            meta_of(driven, config),
            own=user_metrics(options.metric_files),
            case=case,
        )
        write_json(draft / RESULT_FILE, result.document())
        write_json(draft / CONFIG_FILE, config)
        if history is not None:
            write_history(draft, history)
            streets = around(attempt.streets, history)
            write_streets(draft, streets)
            if session.pictures:
                write_bytes(draft / PICTURE_FILE, case_picture(case, history, streets.lines).encode())
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    return DriveDone(draft, result)


def _judged(attempt: _Attempt, history: History | None) -> Judged:
    """Return the verdict."""
    outcome = attempt.driven.outcome
    if attempt.playing is None or history is None:
        return verdict_of((), None, outcome, triggered=False)
    return attempt.playing.judged(history, outcome)


def _attempt(
    session: CaseSession, options: ScenarioOptions, loaded: FoundAgent, playable: Playable, folder: Path
) -> _Attempt:
    """Drive the case, or find out why that is not possible."""
    one = None
    spec = case_spec(playable, vehicle=options.vehicle, timeout_s=options.timeout_s)
    try:
        agents, sensors = _agents(loaded, options)
        check_town(playable.case, session.towns.names([playable.case.town]))
        agents.config = replace(agents.config, vehicle=spec.config.vehicle)
        spec = replace(
            spec,
            config=agents.config,
            weather=spec.weather if options.weather is None else weather_called(options.weather),
            traffic=options.traffic,
            sumo=options.sumo_of(None, None),
            scoring=session.scoring,
            stop_after_s=options.stop_after_s,
        )
        one = AgentDrive(
            session.simulator,
            session.towns,
            spec,
            [Shuttle(loaded.name, loaded, agents, sensors)],
            options,
            name=f"{plain(loaded.name)}-{plain(playable.case.name)}",
            quiet=True,
        )
        (driven,) = one.play(options.seed, folder)
    except (UserError, AgentError, SimulatorError) as error:
        outcome = outcome_of(error, session.simulator.why_gone)
        agent_error = error if isinstance(error, AgentError) else None
        return _Attempt(Driven(outcome, None, 0.0, None, None, agent_error), spec.config, streets=_streets(one))
    if driven.bug is not None:
        traceback.print_exception(driven.bug)
    playing = next(iter(one.episode.playing), None)
    return _Attempt(
        driven, spec.config, playing, _streets(one), agents.access, one.episode.traffic, one.log, agents.ignored
    )


def _streets(one: AgentDrive | None) -> list[Street]:
    """The lanes of an episode's town, where it was loaded."""
    return [] if one is None or one.episode.ground is None else one.episode.ground.town.streets


def _agents(loaded: FoundAgent, options: ScenarioOptions) -> tuple[AgentsManager, SensorSet]:
    """Return a new agent and its sensors; built-in agents read none, and have them only where they are shown.

    Raises:
        AgentError: the agent failed, or asks for what is no sensor set: it was loaded, so that is its own failure.
    """
    with agents_fault(loaded):
        agents = new_agents(loaded, options, options.seed, has_conditions=False)
        is_blind = loaded.file is None and not options.shows_sensors
        return agents, SensorSet((), loaded.name) if is_blind else sensor_set(agents, loaded)
