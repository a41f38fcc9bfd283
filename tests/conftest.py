"""What all tests share: the hypothesis profile, the order of the files, and which tests measure coverage.

The hypothesis profile is repeatable and has no deadlines, because kernels compile on first use.
"""

import os
import signal
from collections.abc import Generator
from contextlib import nullcontext

import hypothesis
import pytest

from tracing import untraced

LONGEST = (
    "test_catalogue.py",
    "test_run.py",
    "test_behavioral_live.py",
    "test_live.py",
    "test_python_api_page.py",
    "test_traffic.py",
    "test_command.py",
    "test_notebook.py",
    "test_series_runs.py",
    "test_run_folder.py",
    "test_gym.py",
    "test_fuzzed_files.py",
    "test_api.py",
    "test_serve.py",
    "test_conduct.py",
    "test_incident.py",
)
"""Files of tests that take longest, longest first: they start first, so that no worker idles at the end."""

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell that starts us in the background leaves it so
    signal.signal(signal.SIGINT, signal.default_int_handler)

hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, print_blob=True, max_examples=1000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_report_header() -> str:
    """Say which profile chooses the random examples; "repeatable" takes its seed from each test's own text."""
    return f"hypothesis profile: {os.environ.get('HYPOTHESIS_PROFILE', 'repeatable')}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the longest files first; a file's tests keep their order."""
    places = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path.name, len(LONGEST)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Measure no coverage in slow tests: they drive long ways through lines that quick tests reach."""
    with untraced() if item.get_closest_marker("slow") else nullcontext():
        return (yield)
