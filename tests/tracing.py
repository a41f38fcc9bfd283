"""Coverage switched off for a while, in this process and in its child processes."""

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
