"""What the commands that drive share: the simulator they drive in, and how they are ended."""

from __future__ import annotations

import signal
from contextlib import contextmanager
from typing import TYPE_CHECKING, NoReturn

from basu.errors import UserError

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator
    from types import FrameType


def add_simulator(parser: argparse.ArgumentParser, otherwise: str) -> None:
    """Where to drive; ``otherwise`` says what is done without --host."""
    parser.add_argument("--host", help=f"a simulator that runs already (default: {otherwise})")
    parser.add_argument("--port", type=int, default=2000, help="of --host (default: %(default)s)")
    parser.add_argument(
        "--timeout", type=float, default=20.0, metavar="S", help="to wait for the simulator (default: %(default)s)"
    )


def add_agent_process(parser: argparse.ArgumentParser) -> None:
    """Where the agent's code runs, and what it may use."""
    parser.add_argument(
        "--in-process",
        action="store_true",
        help="drive the agent in BASU's own process, for debuggers: an agent that dies there ends everything",
    )
    parser.add_argument(
        "--agent-memory",
        type=float,
        metavar="GB",
        help="memory that the agent's process may use before the run ends as the agent's failure (default: no limit)",
    )


def agent_process_of(arguments: argparse.Namespace) -> tuple[bool, float | None]:
    """What was said about the agent's process: whether there is none, and its memory in GB.

    Raises:
        UserError: the two contradict each other, or the memory is not above zero.
    """
    in_process, memory_gb = arguments.in_process, arguments.agent_memory
    if memory_gb is not None and not memory_gb > 0.0:
        raise UserError(f"--agent-memory is {memory_gb:g} GB; it must be positive")
    if in_process and memory_gb is not None:
        raise UserError("--agent-memory limits the agent's own process, and --in-process gives it none; choose one")
    return in_process, memory_gb


def check_positive(arguments: argparse.Namespace, *names: str) -> None:
    """Whether options in seconds can be meant.

    Raises:
        UserError: one is not above zero.
    """
    for name in names:
        if not getattr(arguments, name) > 0.0:
            raise UserError(f"--{name.replace('_', '-')} is {getattr(arguments, name)} s; it must be positive")


@contextmanager
def terminated_as_interrupted() -> Iterator[None]:
    """Within, SIGTERM ends a run as Ctrl-C does: what was measured is written."""
    before = signal.signal(signal.SIGTERM, _terminated)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _terminated(_number: int, _frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt
