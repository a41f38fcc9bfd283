"""The loop of a drive, `drive`, and `DriveDone`: what came of a drive, from the worker to the end of the command."""

from __future__ import annotations

import time
import traceback
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.metrics.result import judge
from basu.metrics.success import Success
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from basu.episode import Episode
    from basu.errors import AgentError
    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.result import Result
    from basu.records.history import History


class Driven(NamedTuple):
    """How a run ended and what was measured until then."""

    outcome: Outcome
    history: History | None  # None where nothing was driven
    wall_s: float  # from the first step to the last
    first_frame: int | None  # the server's number of it
    bug: Exception | None  # an error of our own, to be raised again once all is written
    agent_error: AgentError | None  # what the agent failed with; its cause has the traceback


class DriveDone(NamedTuple):
    """A drive on a route or in a case that is over, or that could not begin."""

    folder: Path | None  # a draft until the command has given it its name; None where nothing is left
    result: Result
    bug: Exception | str | None = None  # an error of our own: itself, or its traceback from another process
    number: int = 0  # of the job
    attempts: int = 1  # at the job
    packed: bytes | None = None  # the folder as a tar file, from a worker that keeps no folder
    cost: Mapping[str, Any] = {}  # of the worker: processor time, memory, host

    def to_send(self) -> DriveDone:
        """Return what another process may have of it: no record, which lies in the folder, and no exception."""
        bug = "".join(traceback.format_exception(self.bug)) if isinstance(self.bug, Exception) else self.bug
        return self._replace(result=replace(self.result, history=None), bug=bug)


def not_begun(outcome: Outcome) -> DriveDone:
    """Return a drive that could not begin; nothing is left of it."""
    result = judge(outcome, None)
    return DriveDone(None, replace(result, success=Success(result.success.passed)))


def lost(sentence: str) -> DriveDone:
    """Return a drive over which every worker died; nothing is known of the agent."""
    return not_begun(Outcome(Status.BENCHMARK_FAILED, sentence))


def drive(episode: Episode, agents: AgentsManager) -> Driven:
    """Drive an episode, in which ``agents`` takes part, to its end, whatever that is."""
    began_s = time.perf_counter()
    try:
        seen, outcome = episode.reset(), None
        began_s = time.perf_counter()
        while outcome is None:
            agents.perceive(seen.sensor_data)
            agents.tick(seen.frame)
            seen, outcome, _ = episode.step(agents.control, requested=agents.requested, manual=agents.manual)
    except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001 - the episode classifies it
        outcome = episode.fail(error)
    wall_s = time.perf_counter() - began_s
    episode.end()
    return Driven(
        episode.outcome or outcome,
        episode.history,
        wall_s,
        episode.first_frame,
        episode.bug,
        episode.agent_error,
    )
