"""A process that plays cases one after the other in a simulator of its own."""

from __future__ import annotations

import contextlib
import signal
import sys
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.agents.process.remote_agent import find_agent
from basu.episode import Towns
from basu.errors import BasuError
from basu.outcome import Status
from basu.output.report.folder import plain
from basu.running.scenario_runs.one_case import CaseSession, play_case
from basu.scenarios.cases import open_library
from basu.simulator import simulator_for
from basu.utils import client_threads

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from basu.agents.loader import LoadedAgent
    from basu.agents.process.remote_agent import FoundAgent
    from basu.running.scenario_runs.options import ScenarioOptions

ENDING = frozenset({Status.SIMULATOR_FAILED, Status.BENCHMARK_FAILED})
"""After these a worker ends: its simulator is gone, or the benchmark has a bug."""
ENDING_IN_PROCESS = ENDING | {Status.AGENT_TIMED_OUT}  # the agent's code may still run in it


class Job(NamedTuple):
    """A case for an agent."""

    number: int  # from 0, in the order of the matrix
    agent: str  # as it was typed
    case: str  # its id


class Done(NamedTuple):
    """A job that is over: its folder holds the rest."""

    number: int
    document: dict[str, Any]
    folder: str  # below the run's
    ends_worker: bool  # whether the worker ends now


class Ready(NamedTuple):
    """A worker is ready; one that ends before has not died over a job."""


class Refused(NamedTuple):
    """A worker that cannot work, and why."""

    sentence: str


def play(
    options: ScenarioOptions,
    output: Path,
    jobs: Iterable[Job],
    given: Mapping[str, LoadedAgent] | None = None,
) -> Iterator[Done]:
    """Play jobs in a simulator until there are none left, or a fresh process is needed; yield what came of each.

    ``given`` are agents' classes that are loaded, by name.

    Raises:
        UserError: an agent or a case cannot be had.
        SimulatorError: there is no simulator to play in.
        KeyboardInterrupt: the user interrupted a case; what came of it has been yielded.
    """
    library = open_library(options.all_files)
    agents: Mapping[str, FoundAgent] = given or {
        agent: find_agent(agent, in_process=options.in_process, memory_gb=options.agent_memory_gb)
        for agent in options.agents
    }
    with simulator_for(options.run_options(options.agents[0])) as simulator:
        session = CaseSession(options, simulator, Towns(simulator))
        for job in jobs:
            (playable,) = library.of_id(job.case)
            loaded = agents[job.agent]
            played = play_case(session, loaded, playable, output / plain(loaded.name))
            ends = played.outcome.status in (ENDING_IN_PROCESS if options.in_process or given else ENDING)
            yield Done(job.number, played.document, str(played.folder.relative_to(output)), ends)
            if played.outcome.status is Status.INTERRUPTED:
                raise KeyboardInterrupt
            if ends:
                return


def work(connection: Connection) -> None:
    """Play the jobs that come through a pipe, and answer through it; the options come first."""
    options, output = connection.recv()

    def jobs() -> Iterable[Job]:
        while (job := connection.recv()) is not None:
            yield job

    connection.send(Ready())
    try:
        for done in play(options, output, jobs()):
            connection.send(done)
    except BasuError as error:
        connection.send(Refused(str(error)))


def main() -> None:
    """Work at the pipe whose descriptor is the first argument."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command, which ends its workers
    with contextlib.suppress(EOFError, BrokenPipeError):  # the command has ended
        work(Connection(int(sys.argv[1])))
    if client_threads.is_held():
        client_threads.leave(0)
