"""The benchmark from Python: ``basu.run``, ``basu.run_scenarios``, ``basu.load`` and ``basu.open_simulator``.

Keywords are called as the command line's options. Runs without a simulator of their own share one: it starts with the
first run, begins its world anew for every further one, and ends with the process or by ``basu.close_simulator()``.
"""

from __future__ import annotations

import atexit
import contextlib
import inspect
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.loader import LoadedAgent
from basu.conditions import SimulatorSpec
from basu.episode import Towns
from basu.errors import UserError
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.output.report.console import table
from basu.results import RunResult, ScenarioResults, load
from basu.running.preparation import prepare
from basu.running.run_player import OpenWorld
from basu.running.runner import runs
from basu.running.scenario_runs.command import play_matrix
from basu.running.scenario_runs.options import ScenarioOptions
from basu.settings.option import Layer
from basu.settings.resolve import resolve
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu.simulator import Simulator

__all__ = ["OpenSimulator", "close_simulator", "load", "open_simulator", "run", "run_scenarios"]

Agent = str | Path | type[AutonomousAgent] | AutonomousAgent


class OpenSimulator:
    """A simulator that several runs share, with what is known of its towns. ``open_simulator`` makes one."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator, self.towns = simulator, Towns(simulator)


@contextlib.contextmanager
def open_simulator(host: str | None = None, port: int = 2000, *, timeout_s: float = 20.0) -> Iterator[OpenSimulator]:
    """Start a simulator, or connect to the one at ``host``, for the runs inside the ``with`` block.

    Raises:
        UserError: no simulator answers at ``host``.
        SimulatorError: ours did not start.
    """
    with simulator_for(SimulatorSpec(host=host, port=port, timeout_s=timeout_s)) as simulator:
        yield OpenSimulator(simulator)


class _Shared:
    """The simulator of all runs that name none."""

    def __init__(self) -> None:
        self._stack = contextlib.ExitStack()
        self._open: OpenSimulator | None = None

    def get(self) -> OpenSimulator:
        """The running simulator, started where there is none or the last one has ended."""
        if self._open is not None and self._open.simulator.ended():
            self.close()
        if self._open is None:
            self._open = self._stack.enter_context(open_simulator())
        return self._open

    def close(self) -> None:
        """End it."""
        self._open = None
        self._stack.close()


_shared = _Shared()
atexit.register(_shared.close)


def close_simulator() -> None:
    """End the simulator that runs share; the next run starts another."""
    _shared.close()


def run(
    agent: Agent = "basic",
    *,
    routes: str | Path | None = None,
    route_id: str | None = None,
    seed: int = 0,
    repetitions: int = 1,
    vehicles: int = 0,
    walkers: int = 0,
    traffic_density: float | None = None,
    weather: str | None = None,
    vehicle: str | None = None,
    output: str | Path = "runs",
    simulator: OpenSimulator | None = None,
    scoring: Scoring | None = None,
    progress: bool = False,
    **options: Any,  # noqa: ANN401 - a field of ScenarioOptions each
) -> RunResult | list[RunResult]:
    """Drive an agent along a route and score the drive, as ``basu run`` does.

    Args:
        agent: a name (`basu list`), a file (``my_agent.py`` or ``my_agent.py:Class``), or a subclass of
            ``AutonomousAgent`` defined where you are, which then drives in this process: its step limit cannot
            interrupt native code, and its crash is ours. An instance drives one run.
        routes: the route file; by default the agent's.
        route_id: only this route of the file.
        seed: of everything random; each repetition has the next.
        repetitions: how often each route is driven.
        vehicles: other vehicles, driven by the Traffic Manager.
        walkers: walkers on the pavements near the route.
        traffic_density: other vehicles on a km of lane near the route, in place of ``vehicles``.
        weather: one of CARLA's presets.
        vehicle: the blueprint to drive.
        output: the parent of the run folders.
        simulator: from ``open_simulator``; by default the one that all runs share.
        scoring: penalties, weights and thresholds.
        progress: whether to show a progress bar and the table.
        options: any other option of the command line by its name, such as ``record=True`` or ``step_limit_s=1.0``.

    Returns:
        The result of the run; a list where there are several routes or repetitions.

    Raises:
        UserError, AgentError: nothing can be run like this.
        SimulatorError: there is no simulator, or it failed before the run began.
    """
    scoring = Scoring() if scoring is None else scoring
    given = _given(agent)
    values = {
        "agent": given.name if given is not None else str(agent),
        "routes": None if routes is None else str(routes),
        "route_id": route_id,
        "seed": seed,
        "repetitions": repetitions,
        "vehicles": vehicles,
        "walkers": walkers,
        "traffic_density": traffic_density,
        "weather": weather,
        "vehicle": vehicle,
        "output": Path(output),
        **options,
    }
    wanted = resolve(RunOptions, [Layer(values)])
    if wanted.series is not None or wanted.resume:
        raise UserError("run() keeps no series; give repetitions=N, or use `basu run --series`")
    if wanted.workers > 1:
        raise UserError("run() drives one run after the other; use `basu run --workers`, or a campaign")
    if simulator is not None and not simulator.simulator.own:
        host, port = simulator.simulator.address
        wanted = replace(wanted, host=host, port=port)
    prepared = prepare(wanted, given)
    if isinstance(agent, AutonomousAgent) and len(prepared.jobs) > 1:
        raise UserError(f"an instance drives one run, and these are {len(prepared.jobs)}; give the class itself")
    with contextlib.ExitStack() as stack:
        if simulator is None and (wanted.record or wanted.host is not None):
            simulator = OpenSimulator(stack.enter_context(simulator_for(wanted.simulator)))
        opened = simulator or _shared.get()
        here = OpenWorld(prepared, opened.simulator, opened.towns, quiet=not progress)
        results = []
        for done in runs(wanted, scoring, here, prepared.jobs):
            assert done.folder is not None, "a drive in this process that cannot begin raises its error"
            result = RunResult(done.folder)
            if progress:
                sys.stdout.write(f"{table(result.result, details=False)}\n")
            if result.outcome.status is Status.SIMULATOR_FAILED and simulator is None:
                _shared.close()
            if isinstance(done.bug, Exception):
                raise done.bug
            results.append(result)
    return results[0] if len(prepared.jobs) == 1 else results


def run_scenarios(
    what: str | Sequence[str] = "all",
    *,
    agent: Agent | Sequence[Agent] = "basic",
    sweep: int | None = None,
    grid: int | None = None,
    vary: Sequence[str] = (),
    fixed: Mapping[str, object] | None = None,
    seed: int = 0,
    vehicle: str | None = None,
    workers: int | None = None,
    output: str | Path = "scenario-runs",
    progress: bool = False,
    **options: Any,  # noqa: ANN401 - a field of ScenarioOptions each
) -> ScenarioResults:
    """Play cases with agents, as ``basu scenario run`` does.

    Args:
        what: "all", groups, scenarios, cases' ids or files.
        agent: one agent or several, each as in ``run``. Classes play in this process, one case after the other.
        sweep: play so many samples of each case (Latin hypercube), drawn by ``seed``.
        grid: play each case with so many values of every number.
        vary: the parameters to sample; by default all.
        fixed: parameters that are set, by name; the command line's ``--set``.
        seed: of the samples, or of chance in the drives where there is no sweep.
        vehicle: the blueprint to drive; by default the case's.
        workers: simulators that run at the same time; by default one a processor.
        output: the parent of the folder.
        progress: whether to show a progress bar.
        options: any other option of the command line by its name, such as ``timeout_s=60.0``.

    Raises:
        UserError: nothing can be played like this.
        SimulatorError: there is no simulator to play in.
        KeyboardInterrupt: the user interrupted it before the first case was over.
    """
    agents = [agent] if isinstance(agent, str | Path | type | AutonomousAgent) else list(agent)
    given = _all_given(agents)
    values = {
        "what": (what,) if isinstance(what, str) else tuple(what),
        "agents": tuple(str(each) for each in agents) if given is None else tuple(given),
        "sweep": sweep,
        "grid": grid,
        "vary": tuple(vary),
        "fixed": tuple((name, str(value)) for name, value in (fixed or {}).items()),
        "seed": seed,
        "vehicle": vehicle,
        "output": Path(output),
        **({} if workers is None else {"workers": workers}),
        **options,
    }
    wanted = resolve(ScenarioOptions, [Layer(values)])
    played = play_matrix(wanted, given, quiet=not progress)
    if played.matrix is None:
        raise KeyboardInterrupt
    return ScenarioResults(played.folder)


def _given(agent: Agent) -> LoadedAgent | None:
    """An agent's class or instance as if it had been loaded; None where it is named.

    Raises:
        UserError: it is no agent.
    """
    if isinstance(agent, str | Path):
        return None
    if isinstance(agent, type) and issubclass(agent, AutonomousAgent):
        if inspect.isabstract(agent):
            missing = ", ".join(sorted(agent.__abstractmethods__))
            raise UserError(f"{agent.__name__} lacks {missing}; an agent has setup, run_step and config")
        return LoadedAgent(agent, agent.__name__, _file_of(agent))
    if isinstance(agent, AutonomousAgent):
        kind = type(agent)
        made = type(kind.__name__, (kind,), {"__new__": lambda _cls: agent})
        return LoadedAgent(made, kind.__name__, _file_of(kind))
    raise UserError(f"{agent!r} is no agent; give a name, a file, or a subclass of basu.AutonomousAgent")


def _all_given(agents: Sequence[Agent]) -> dict[str, LoadedAgent] | None:
    """Agents' classes by name; None where all agents are named.

    Raises:
        UserError: some are classes and others are named, or two have one name.
    """
    given = [_given(each) for each in agents]
    classes = {each.name: each for each in given if each is not None}
    if not classes:
        return None
    if any(isinstance(each, AutonomousAgent) for each in agents):
        raise UserError("an instance drives one run, and there may be several cases; give its class")
    if len(classes) != len(agents):
        raise UserError("name agents or give classes, not both at once; and give each class once")
    return classes


def _file_of(agent: type[AutonomousAgent]) -> Path:
    """The file that an agent's class was defined in; what it names is looked for beside it. A notebook has none."""
    try:
        return Path(inspect.getfile(agent))
    except (OSError, TypeError):
        return Path.cwd() / f"{agent.__name__}.py"
