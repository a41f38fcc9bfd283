"""Coverage of processes of tests: switched off for a while, and written before the process ends."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import coverage

CONFIGURED = ("COVERAGE_PROCESS_CONFIG", "COVERAGE_PROCESS_START")
"""What tells a new Python process to measure its coverage."""


@contextmanager
def untraced() -> Iterator[None]:
    """Measure no coverage within the block; without a measurement nothing changes."""
    measured = coverage.Coverage.current()
    kept = {name: os.environ.pop(name) for name in CONFIGURED if name in os.environ}
    if measured is not None:
        measured.stop()
    try:
        yield
    finally:
        os.environ.update(kept)
        if measured is not None:
            measured.start()


def save() -> None:
    """Write what this process has measured; threads of the official client may end it before it would do so itself."""
    measured = coverage.Coverage.current()
    if measured is not None:
        measured.save()
