"""One run: the managers set up, ticked until the run is over, and closed in every case."""

from __future__ import annotations

import time
import traceback
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import (
    AgentCrashedError,
    AgentError,
    AgentInvalidControlError,
    AgentTimedOutError,
    SimulatorError,
    UserError,
)
from basu.managers.base_manager import Frame, Live, Run, ego_in
from basu.managers.conduct import ticked
from basu.managers.metrics_manager import MetricsManager
from basu.managers.routes_manager import RoutesManager
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.managers.agents_manager import AgentsManager
    from basu.managers.base_manager import BaseManager
    from basu.managers.scenario_manager import ScenarioManager
    from basu.managers.sensors_manager import SensorsManager
    from basu.managers.traffic_manager import TrafficManager
    from basu.metrics.score import Scoring
    from basu.records.history import History

STATUS_OF: dict[type[AgentError], Status] = {
    AgentCrashedError: Status.AGENT_CRASHED,
    AgentTimedOutError: Status.AGENT_TIMED_OUT,
    AgentInvalidControlError: Status.AGENT_INVALID_CONTROL,
}
FAREWELL_S = 1.0  # wall time for each thing that is given back to a simulator that has failed
STRAGGLERS_S = 0.05  # wall time for events of the last frame, which come on connections of their own


class Driven(NamedTuple):
    """How a run ended and what was measured until then."""

    outcome: Outcome
    history: History | None  # None where nothing was driven
    wall_s: float  # from the first step to the last
    first_frame: int | None  # the server's number of it
    bug: Exception | None  # an error of our own, to be raised again once all is written
    agent_error: AgentError | None  # what the agent failed with; its cause has the traceback


def drive(
    run: Run,
    agents: AgentsManager,
    sensors: SensorsManager,
    traffic: TrafficManager,
    scoring: Scoring,
    *,
    why_gone: Callable[[], str | None],
    ended: Callable[[], bool],
    observers: Callable[[Live], Sequence[BaseManager]],
    scenarios: ScenarioManager,
    lane_invasions: bool = True,
) -> Driven:
    """Drive one run to its end, whatever that is.

    ``why_gone`` tells whether the simulator is still there, ``ended`` whether it is seen without asking that it is not;
    ``observers`` makes those who look on and change nothing; they are ticked after all others but the ``scenarios``.
    ``lane_invasions`` says whether those are recorded.
    """
    routes = RoutesManager()
    metrics = MetricsManager(agents, routes, scoring, lane_invasions=lane_invasions)
    scenarios.join(routes, metrics)
    live = Live(agents, sensors, routes, metrics)
    onlookers = tuple(observers(live))
    # the agent before its sensors: one of another program's says only once it is set up what it wants to see
    managers: tuple[BaseManager, ...] = (traffic, agents, sensors, routes, metrics, scenarios, *onlookers)
    began_s = time.perf_counter()
    bug = agent_error = None
    try:
        for manager in managers:
            manager.setup(run)
        began_s = time.perf_counter()
        outcome = _until_over(run, live, scenarios, onlookers, ended)
    except KeyboardInterrupt as interruption:
        outcome = Outcome(Status.INTERRUPTED, str(interruption) or "interrupted by the user")
    except AgentError as error:
        agent_error = error
        outcome = _agents_end(error, why_gone())
    except UserError as error:
        outcome = Outcome(Status.SETUP_FAILED, str(error))
    except SimulatorError as error:
        outcome = Outcome(Status.SIMULATOR_FAILED, why_gone() or str(error))
    except Exception as error:  # noqa: BLE001 - a bug of ours: the run is written as such, then it is raised again
        bug = error
        outcome = Outcome(Status.BENCHMARK_FAILED, "".join(traceback.format_exception_only(error)).strip())
    wall_s = time.perf_counter() - began_s
    if outcome.status is Status.SIMULATOR_FAILED:
        run.client.set_timeout(FAREWELL_S)
    history = None
    if metrics.ticks:
        _hear_stragglers(run)
        history = metrics.history()
    outcome = _closed(managers, outcome)
    return Driven(outcome, history, wall_s, metrics.first_frame, bug, agent_error)


def _until_over(
    run: Run, live: Live, scenarios: ScenarioManager, onlookers: tuple[BaseManager, ...], ended: Callable[[], bool]
) -> Outcome:
    """Tick, sense, ask the agent, apply, record; until the route manager or a scenario says that it is over.

    A simulator that has ended is not asked for a step: while one waited for its answer, the Traffic Manager's thread in
    the official client would run into its own time-out, and that ends the whole process.
    """
    agents, sensors, routes, metrics = live
    frame = _next_frame(run, None)
    while True:
        sensors.tick(frame)
        agents.perceive(sensors.data)
        try:
            agents.tick(frame)
        finally:  # what the agent failed in is recorded as well
            routes.tick(frame)
            metrics.tick(frame)
        for onlooker in onlookers:
            onlooker.tick(frame)
        scenarios.tick(frame)
        over = routes.outcome or scenarios.outcome
        if over is not None:
            return over
        if ended():
            raise SimulatorError("the simulator ended")
        control = scenarios.through(agents.control)
        metrics.applied(control)
        run.vehicle.apply_control(control)
        frame = _next_frame(run, frame)


def _next_frame(run: Run, before: Frame | None) -> Frame:
    """Let the simulator make one step and look at it."""
    try:
        number = run.world.tick(run.timeout_s)
        snapshot = run.world.get_snapshot()
    except RuntimeError as error:
        raise SimulatorError(f"the simulator did not make a step: {error}") from error
    ego = snapshot.find(run.vehicle.id)
    if ego is None and run.own_simulator:
        raise AgentCrashedError(f"the agent took the vehicle under test out of the world before frame {snapshot.frame}")
    if ego is None:
        raise SimulatorError(f"the vehicle under test is gone from the world in frame {snapshot.frame}")
    if before is not None and snapshot.frame != before.server_frame + 1 and run.own_simulator:
        raise AgentCrashedError(ticked("the agent", before.server_frame, snapshot.frame))
    if before is not None and snapshot.frame != before.server_frame + 1:
        raise UserError(
            f"the simulator went from frame {before.server_frame} to {snapshot.frame} (asked for: {number}); "
            "somebody else ticks it too, and a benchmark has to be the only one"
        )
    return Frame(0 if before is None else before.tick + 1, snapshot.frame, snapshot, ego_in(ego))


def _agents_end(error: AgentError, gone: str | None) -> Outcome:
    """The agent failed; unless the simulator had left it alone, that is the agent's doing."""
    if gone is not None:
        return Outcome(Status.SIMULATOR_FAILED, gone)
    return Outcome(STATUS_OF[type(error)], str(error))


def _hear_stragglers(run: Run) -> None:
    """Let events of the last frame arrive: one more step, which is not recorded, and a moment."""
    try:
        run.world.tick(run.timeout_s)
    except RuntimeError:
        return  # the simulator is gone, and says nothing more
    time.sleep(STRAGGLERS_S)


def _closed(managers: tuple[BaseManager, ...], outcome: Outcome) -> Outcome:
    """Close all managers; an agent that fails in that is told of, but its drive is over and keeps its status."""
    for manager in reversed(managers):
        try:
            manager.close()
        except AgentError as error:  # noqa: PERF203 - four managers, once a run
            outcome = outcome._replace(message=f"{outcome.message}; afterwards {error}")
    return outcome
