"""The loop of a run: the agent answers each frame of an episode with a control until the episode is over."""

from __future__ import annotations

import time
import traceback
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

    from basu.episode import Episode
    from basu.errors import AgentError
    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.result import Result
    from basu.outcome import Outcome
    from basu.records.history import History


class Driven(NamedTuple):
    """How a run ended and what was measured until then."""

    outcome: Outcome
    history: History | None  # None where nothing was driven
    wall_s: float  # from the first step to the last
    first_frame: int | None  # the server's number of it
    bug: Exception | None  # an error of our own, to be raised again once all is written
    agent_error: AgentError | None  # what the agent failed with; its cause has the traceback


class WrittenDrive(NamedTuple):
    """A drive on a route or in a case that is over and written; its folder has no name yet."""

    draft: Path
    result: Result
    bug: Exception | str | None = None  # an error of our own: itself, or its traceback from another process

    def to_send(self) -> WrittenDrive:
        """Return what another process may have of it: no record, which lies in the folder, and no exception."""
        bug = "".join(traceback.format_exception(self.bug)) if isinstance(self.bug, Exception) else self.bug
        return WrittenDrive(self.draft, replace(self.result, history=None), bug)


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
