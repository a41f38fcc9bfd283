"""Classification of failures: the outcome of a drive from the error that ended it."""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING

from basu.errors import (
    AgentCrashedError,
    AgentEndedOutsideError,
    AgentError,
    AgentInvalidControlError,
    AgentTimedOutError,
    SimulatorError,
    UserError,
)
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from collections.abc import Callable

STATUS_OF: dict[type[AgentError], Status] = {
    AgentCrashedError: Status.AGENT_CRASHED,
    AgentEndedOutsideError: Status.ENDED_FROM_OUTSIDE,
    AgentTimedOutError: Status.AGENT_TIMED_OUT,
    AgentInvalidControlError: Status.AGENT_INVALID_CONTROL,
}


def outcome_of(error: BaseException, why_gone: Callable[[], str | None]) -> Outcome:
    """The outcome of a drive that ``error`` ended; ``why_gone`` says why the simulator is gone, or None.

    Raises:
        BaseException: ``error`` itself, where it is neither an exception nor the user's interruption.
    """
    if isinstance(error, KeyboardInterrupt):
        return Outcome(Status.INTERRUPTED, str(error) or "interrupted by the user")
    if isinstance(error, AgentError):
        return _agents_end(error, why_gone())
    if isinstance(error, UserError):
        return Outcome(Status.SETUP_FAILED, str(error))
    if isinstance(error, SimulatorError):
        return Outcome(Status.SIMULATOR_FAILED, why_gone() or str(error))
    if isinstance(error, Exception):
        return Outcome(Status.BENCHMARK_FAILED, "".join(traceback.format_exception_only(error)).strip())
    raise error


def _agents_end(error: AgentError, gone: str | None) -> Outcome:
    """The outcome of an agent's failure, which is the agent's unless the simulator had gone before."""
    if gone is not None:
        return Outcome(Status.SIMULATOR_FAILED, gone)
    return Outcome(STATUS_OF[type(error)], str(error))
