"""A process that plays cases one after the other in a simulator of its own."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.agents.process.remote_agent import find_agent
from basu.errors import BasuError
from basu.outcome import Status
from basu.output.report.folder import plain
from basu.running.scenario_runs.one_case import Theatre, perform
from basu.scenarios.cases import open_library
from basu.simulator import asking, simulator_for, towns_of
from basu.utils import client_threads

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from multiprocessing.connection import Connection
    from pathlib import Path

    from basu.running.scenario_runs.options import ScenarioOptions

LEAVING = frozenset({Status.SIMULATOR_FAILED, Status.BENCHMARK_FAILED})
"""After these a process is not to be trusted: its simulator is gone, or something of ours is wrong."""
LEAVING_IN_PROCESS = LEAVING | {Status.AGENT_TIMED_OUT}  # the agent may still run in it


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
    leaves: bool  # whether the worker ends now


class Ready(NamedTuple):
    """A worker that has come into being; one that dies before has not died over a job."""


class Refused(NamedTuple):
    """A worker that cannot work, and why."""

    sentence: str


def play(options: ScenarioOptions, output: Path, jobs: Iterable[Job]) -> Iterator[Done]:
    """Play jobs in a simulator until there are no more, or it is better to begin with a fresh one; what came of each.

    Raises:
        UserError: an agent or a case cannot be had.
        SimulatorError: there is no simulator to play in.
        KeyboardInterrupt: the user interrupted a case; what came of it has been yielded.
    """
    library = open_library(options.all_files)
    agents = {
        agent: find_agent(agent, in_process=options.in_process, memory_gb=options.agent_memory_gb)
        for agent in options.agents
    }
    with simulator_for(options.run_options(options.agents[0])) as simulator:
        with asking("naming its towns"):
            theatre = Theatre(options, simulator, towns_of(simulator.client))
        for job in jobs:
            (playable,) = library.of_id(job.case)
            loaded = agents[job.agent]
            performed = perform(theatre, loaded, playable, output / plain(loaded.name))
            leaves = performed.outcome.status in (LEAVING_IN_PROCESS if options.in_process else LEAVING)
            yield Done(job.number, performed.document, str(performed.folder.relative_to(output)), leaves)
            if performed.outcome.status is Status.INTERRUPTED:
                raise KeyboardInterrupt
            if leaves:
                return


def work(connection: Connection, options: ScenarioOptions, output: Path) -> None:
    """The main function of a worker's process: takes jobs from a pipe and answers through it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for whoever started us, who ends us

    def jobs() -> Iterable[Job]:
        while (job := connection.recv()) is not None:
            yield job

    connection.send(Ready())
    try:
        for done in play(options, output, jobs()):
            connection.send(done)
    except BasuError as error:
        connection.send(Refused(str(error)))
    except EOFError:
        pass  # whoever started us is gone
    if client_threads.is_held():
        client_threads.leave(0)
