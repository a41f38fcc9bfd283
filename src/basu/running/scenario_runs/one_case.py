"""Plays one case with one agent in a fresh world and writes its folder, or draws its behaviour tree."""

from __future__ import annotations

import shutil
import time
import traceback
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.episode import case_spec
from basu.episode.failures import outcome_of
from basu.episode.spec import description_of
from basu.episode.world import asking, towns_of, weather_called, world_with
from basu.errors import AgentError, ScenarioError, SimulatorError, UserError
from basu.files import write_bytes
from basu.managers.placed_scenario import call_scenario, place_scenario
from basu.outcome import Outcome, Status
from basu.output.report.documents import CONFIG_FILE, RESULT_FILE, make_draft, plain, publish, write_json
from basu.output.report.scenarios.drawing.picture import PICTURE_FILE, case_picture
from basu.output.report.streets import around, write_streets
from basu.records.history.files import write_history
from basu.routing import lane_graph, plan
from basu.running.agent_drive import AgentDrive
from basu.running.preparation import SensorSet, agents_fault, new_agents, sensor_set
from basu.running.scenario_runs.case_documents import case_config, document_of
from basu.scenarios.cases import cases_of
from basu.scenarios.tree_picture import draw
from basu.scenarios.verdict import judge
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from basu.agents.process.remote_agent import FoundAgent
    from basu.episode import Towns
    from basu.managers.agents_manager import AgentsManager
    from basu.managers.scenario_manager import Playing
    from basu.records.history import History
    from basu.running.drive import Driven
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.playable import Playable
    from basu.scenarios.verdict import Judged
    from basu.scenarios.xml_elements import Case
    from basu.simulator import Simulator


@dataclass(frozen=True, slots=True)
class CaseSession:
    """What all cases of one worker share."""

    options: ScenarioOptions
    simulator: Simulator
    towns: Towns
    pictures: bool = True  # whether each case gets its picture
    weather: str | None = None  # one of CARLA's presets in place of the case's own


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


class PlayedCase(NamedTuple):
    """A case that is over and written."""

    document: dict[str, Any]
    folder: Path
    outcome: Outcome
    history: History | None  # None where nothing was driven


class _Attempt(NamedTuple):
    """What came of a case, whatever that is."""

    driven: Driven | None
    playing: Playing | None
    outcome: Outcome
    streets_m: list[NDArray[np.float64]]
    access: dict[str, Any] | None = None  # of the agent to the simulator


def play_case(session: CaseSession, loaded: FoundAgent, playable: Playable, output: Path) -> PlayedCase:
    """Play a case and write its folder below ``output``; whatever goes wrong becomes its verdict."""
    began_s = time.perf_counter()
    case, options = playable.case, session.options
    draft = make_draft(output, plain(case.name))
    try:
        attempt = _attempt(session, loaded, playable, draft)
        history = None if attempt.driven is None else attempt.driven.history
        judged = _judged(attempt, history)
        document = document_of(
            playable,
            loaded,
            attempt.playing,
            judged,
            options,
            history=history,
            wall_s=time.perf_counter() - began_s,
            access=attempt.access,
        )
        write_json(draft / RESULT_FILE, document)
        write_json(draft / CONFIG_FILE, case_config(playable, options, loaded))
        if history is not None:
            write_history(draft, history)
            streets = around(attempt.streets_m, history)
            write_streets(draft, streets)
            if session.pictures:
                write_bytes(draft / PICTURE_FILE, case_picture(document, history, streets).encode())
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    return PlayedCase(document, publish(draft, plain(case.name)), attempt.outcome, history)


def _judged(attempt: _Attempt, history: History | None) -> Judged:
    """The verdict."""
    if attempt.playing is None or history is None:
        return judge((), None, attempt.outcome, triggered=False)
    return attempt.playing.judged(history, attempt.outcome)


def _attempt(session: CaseSession, loaded: FoundAgent, playable: Playable, folder: Path) -> _Attempt:
    """Drive it, or find out why that is not possible."""
    options, one = session.options, None
    try:
        agents, sensors = _agents(loaded, options)
        check_town(playable.case, session.towns.names([playable.case.town]))
        spec = case_spec(playable, vehicle=options.vehicle, timeout_s=options.timeout_s)
        if session.weather is not None:
            spec = replace(spec, weather=weather_called(session.weather))
        agents.config = replace(agents.config, vehicle=spec.config.vehicle)
        one = AgentDrive(
            session.simulator,
            session.towns,
            replace(spec, config=agents.config),
            agents,
            sensors,
            options.run_options(loaded.name),
            name=f"{plain(loaded.name)}-{plain(playable.case.name)}",
            by_agent=loaded.file is not None,
            quiet=True,
        )
        driven = one.play(options.drive_seed, folder)
    except UserError as error:
        return _Attempt(None, None, Outcome(Status.SETUP_FAILED, str(error)), _streets(one))
    except AgentError as error:
        return _Attempt(None, None, outcome_of(error, session.simulator.why_gone), _streets(one))
    except SimulatorError as error:
        return _Attempt(None, None, Outcome(Status.SIMULATOR_FAILED, str(error)), _streets(one))
    if driven.bug is not None:
        traceback.print_exception(driven.bug)
    return _Attempt(driven, next(iter(one.episode.playing), None), driven.outcome, _streets(one), agents.access)


def _streets(one: AgentDrive | None) -> list[NDArray[np.float64]]:
    """The lanes of an episode's town, where it was loaded."""
    return [] if one is None or one.episode.ground is None else one.episode.ground.town.streets_m


def _agents(loaded: FoundAgent, options: ScenarioOptions) -> tuple[AgentsManager, SensorSet]:
    """A new agent and its sensors; built-in agents read none, and theirs serve observers, which a case has not.

    Raises:
        AgentError: the agent failed, or asks for what is no sensor set: it was loaded, so that is its own failure.
    """
    with agents_fault(loaded):
        agents = new_agents(loaded, options.run_options(loaded.name), options.drive_seed, has_conditions=False)
        return agents, SensorSet((), loaded.name) if loaded.file is None else sensor_set(agents, loaded)


def drawn(options: ScenarioOptions, form: str) -> str:
    """The tree of the first case that ``options.what`` means, in a form of ``basu.scenarios.tree_picture.FORMS``.

    Raises:
        UserError: there is no such case, or it cannot be laid on its map.
        SimulatorError: there is no simulator to ask for the map.
    """
    playable = cases_of(options.what, options.files)[0]
    case = playable.case
    with (
        simulator_for(options.run_options("basic")) as simulator,
        asking(f"loading {case.town}"),
        simulator.long_call(),
    ):
        check_town(case, towns_of(simulator, [case.town]))
        _, carla_map = world_with(simulator, case.town)
        route = plan(carla_map, description_of(playable, carla_map), lane_graph.build(carla_map))
        placed = place_scenario(playable, route, carla_map, own=True)
        return call_scenario(case.name, partial(draw, placed.scenario, form))
