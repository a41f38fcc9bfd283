"""Jobs, players and answers: the values that a command and its workers exchange."""

from __future__ import annotations

import enum
import importlib
import platform
from collections.abc import Callable
from contextlib import AbstractContextManager
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple

import basu
from basu.errors import BasuError, SimulatorError, UserError


class Job(NamedTuple):
    """A unit of work: plain data that every worker understands."""

    number: int  # from 0, unique in one command
    data: Any  # plain values


class After(enum.Enum):
    """What a worker does after a job."""

    GO_ON = "go on"
    FRESH = "fresh"  # the worker ends, and a fresh one plays the next job
    AGAIN = "again"  # likewise, and the job is tried again while it has attempts left
    INTERRUPTED = "interrupted"  # the user interrupted it; nothing more is played


class JobOutcome(NamedTuple):
    """What came of a job."""

    value: Any
    after: After = After.GO_ON


class Done(NamedTuple):
    """A job that is over."""

    number: int
    value: Any
    attempts: int = 1


class Lost(NamedTuple):
    """A job over which every worker died."""

    number: int
    sentence: str
    attempts: int


Play = Callable[[Any], JobOutcome]


class PlayerSpec(NamedTuple):
    """A player that any process can open: a function's place in a module, and its arguments, which can be pickled."""

    target: str  # MODULE:FUNCTION, which returns a context manager of `Play`
    arguments: tuple[Any, ...] = ()

    def open(self) -> AbstractContextManager[Play]:
        """Import the function and call it."""
        module, _, name = self.target.partition(":")
        made: AbstractContextManager[Play] = getattr(importlib.import_module(module), name)(*self.arguments)
        return made


class Ready(NamedTuple):
    """A worker that can take a job, with the versions of its programs."""

    versions: dict[str, str]


class Refused(NamedTuple):
    """A worker that cannot work, and the reason."""

    sentence: str
    is_users: bool = False  # whether what was given is wrong; else the simulator cannot be had


class Died(NamedTuple):
    """A worker that has ended without an answer."""

    sentence: str


PlayerAnswer = Ready | JobOutcome | Refused | Died


def versions() -> dict[str, str]:
    """The versions on which results depend."""
    return {"basu": basu.__version__, "carla": _version("carla"), "python": platform.python_version()}


def refusal(error: BasuError) -> Refused:
    """An error that keeps a worker from working, as an answer."""
    return Refused(str(error), isinstance(error, UserError))


def raised(refused: Refused) -> BasuError:
    """The error of a worker's refusal."""
    return UserError(refused.sentence) if refused.is_users else SimulatorError(refused.sentence)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "missing"
