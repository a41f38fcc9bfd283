"""Coverage of processes of tests: switched off for a while, and written before the process ends."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import coverage

OF_SERVERS = "COVERAGE_OF_SERVERS"
"""Names the configuration for servers where the process of tests itself is not measured (scripts/run_compat.py)."""
CONFIGURED = ("COVERAGE_PROCESS_CONFIG", "COVERAGE_PROCESS_START", OF_SERVERS)
"""What tells a new Python process to measure its coverage."""


@contextmanager
def untraced() -> Iterator[None]:
    """Measure no coverage within the block; without a measurement nothing changes."""
    with _without(CONFIGURED), untraced_here():
        yield


@contextmanager
def untraced_here() -> Iterator[None]:
    """Measure no coverage of this process within the block."""
    measured = coverage.Coverage.current()
    if measured is not None:
        measured.stop()
        measured._warn_preimported_source = False  # else start() looks at all imported modules, 0.1 s
    try:
        yield
    finally:
        if measured is not None:
            measured.start()


@contextmanager
def untraced_processes() -> Iterator[None]:
    """Measure the coverage of this process alone within the block, beside that of servers that are to be measured."""
    with _without(CONFIGURED[:2]):
        yield


@contextmanager
def _without(names: tuple[str, ...]) -> Iterator[None]:
    """Have the environment lack some names within the block."""
    kept = {name: os.environ.pop(name) for name in names if name in os.environ}
    try:
        yield
    finally:
        os.environ.update(kept)


def of_servers() -> dict[str, str]:
    """Return the environment in which a server measures its coverage, if it is to."""
    configuration = os.environ.get(OF_SERVERS)
    return {**os.environ} if configuration is None else {**os.environ, CONFIGURED[1]: configuration}


def save() -> None:
    """Write what this process has measured; threads of the official client may end it before it would do so itself."""
    measured = coverage.Coverage.current()
    if measured is not None:
        measured.save()
