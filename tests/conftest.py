"""What all tests share: the hypothesis profile, the order of the files, and which tests measure coverage.

The hypothesis profile is repeatable and has no deadlines, because kernels compile on first use.
"""

import os
import signal
from collections.abc import Generator
from contextlib import nullcontext
from pathlib import Path

import hypothesis
import pytest

from tracing import save, untraced

LONGEST = (
    "basu/running/scenario_runs/test_catalogue.py",
    "basu/running/test_run.py",
    "basu/agents/builtin/test_behavioral_live.py",
    "basu/output/hud/test_live.py",
    "basu/test_python_api_page.py",
    "basu/managers/test_traffic_manager.py",
    "basu/running/scenario_runs/test_command.py",
    "basu/test_notebook.py",
    "basu/running/test_series.py",
    "basu/running/test_run_folder.py",
    "basu/test_gym.py",
    "linden/test_fuzzed_files.py",
    "basu/test_api.py",
    "linden/cli/test_serve.py",
    "basu/managers/test_conduct.py",
    "basu/test_incident.py",
)
"""Files of tests that take longest, longest first: they start first, so that no worker idles at the end."""

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell that starts us in the background leaves it so
    signal.signal(signal.SIGINT, signal.default_int_handler)

hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, print_blob=True, max_examples=1000)
hypothesis.settings.register_profile("uncompiled", hypothesis.settings.get_profile("repeatable"), max_examples=10)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_report_header() -> str:
    """Say which profile chooses the random examples; "repeatable" takes its seed from each test's own text."""
    return f"hypothesis profile: {os.environ.get('HYPOTHESIS_PROFILE', 'repeatable')}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the longest files first; a file's tests keep their order."""
    here = Path(__file__).parent
    places = {here / name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path, len(LONGEST)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Measure no coverage in slow tests: they drive long ways through lines that quick tests reach."""
    with untraced() if item.get_closest_marker("slow") else nullcontext():
        return (yield)


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish() -> None:
    """Write the coverage before the process ends: pytest-xdist kills a worker that takes more than 10 s to end."""
    save()
