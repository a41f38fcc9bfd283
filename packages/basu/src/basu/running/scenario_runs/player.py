"""The player of cases: a simulator, its towns and the agents, kept from one case to the next."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NamedTuple

from basu.episode import Towns
from basu.jobs.job import After, JobOutcome, PlayerSpec
from basu.outcome import Status
from basu.output.report.documents import plain
from basu.running.preparation import agent_of
from basu.running.scenario_runs.chosen_cases import files_of
from basu.running.scenario_runs.maps_of_cases import maps_of, with_maps
from basu.running.scenario_runs.one_case import CaseSession, play_case
from basu.scenarios.cases import open_library
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from basu.agents.loader import LoadedAgent
    from basu.agents.process.remote_agent import FoundAgent
    from basu.jobs.job import Play
    from basu.metrics.scoring import Scoring
    from basu.running.scenario_runs.options import ScenarioOptions

ENDING = frozenset({Status.SIMULATOR_FAILED, Status.BENCHMARK_FAILED})
"""After these a worker ends: its simulator is gone, or the benchmark has a bug."""
ENDING_IN_PROCESS = ENDING | {Status.AGENT_TIMED_OUT}  # the agent's code may still run in it


class CaseJob(NamedTuple):
    """A case for an agent."""

    agent: str  # as it was typed
    case: str  # its id
    name: str  # of its folder, below that of the agent
    repetition: int = 0


def case_player(
    options: ScenarioOptions, scoring: Scoring, output: Path, given: Mapping[str, LoadedAgent] | None = None
) -> PlayerSpec:
    """The player that writes its cases' folders below ``output``; ``given`` are loaded classes, by name."""
    return PlayerSpec(f"{__name__}:open_cases", (options, scoring, output, given))


@contextlib.contextmanager
def open_cases(
    options: ScenarioOptions, scoring: Scoring, output: Path, given: Mapping[str, LoadedAgent] | None
) -> Iterator[Play]:
    """Start a simulator, and play cases in it.

    Raises:
        UserError: an agent or a case cannot be had.
        SimulatorError: there is no simulator to play in.
    """
    library = open_library(files_of(options))
    agents: Mapping[str, FoundAgent] = given or {each: agent_of(options, each) for each in options.agents}
    ending = ENDING_IN_PROCESS if options.in_process or given else ENDING
    with maps_of(library.cases) as folders, simulator_for(with_maps(options.simulator, folders)) as simulator:
        session = CaseSession(options, simulator, Towns(simulator), scoring)

        def play(job: CaseJob) -> JobOutcome:
            (playable,) = library.of_id(job.case)
            loaded = agents[job.agent]
            played = play_case(session, loaded, playable, output / plain(loaded.name), job.name, job.repetition)
            done = played.to_send()
            status = played.result.outcome.status
            if status is Status.INTERRUPTED:
                return JobOutcome(done, After.INTERRUPTED)
            return JobOutcome(done, After.FRESH if status in ending else After.GO_ON)

        yield play
