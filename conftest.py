"""What all tests share: the hypothesis profile, the order of the files, and which tests measure coverage.

The hypothesis profile is repeatable and has no deadlines, because kernels compile on first use.
"""

import functools
import gc
import importlib
import importlib.util
import itertools
import os
import signal
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import coverage
import hypothesis
import pytest

from processor_time import measured
from tracing import save, untraced, untraced_here, untraced_processes

if coverage.Coverage.current() is not None:
    with untraced_here():  # libraries of most tests: their import takes twice as long where it is traced
        for library in ("carla", "matplotlib.pyplot", "numba", "pandas", "pyarrow.parquet", "pydantic"):
            importlib.import_module(library)

pytest_plugins = ["basu_fixtures", "campaign_fixtures"] if importlib.util.find_spec("basu") else []
"""Fixtures of several distributions; the tests of ``linden`` run where ``basu`` is not installed."""

LONGEST = (
    "packages/basu-window/tests/browser/test_whole_route.py",
    "packages/basu/tests/running/scenario_runs/test_catalogue.py",
    "packages/basu-truth/tests/test_export.py",
    "packages/basu-truth/tests/test_dataset.py",
    "packages/basu/tests/settings/test_command_line.py",
    "packages/basu-ros/tests/agents/test_run_with_ros1.py",
    "packages/basu-service/tests/test_run.py",
    "tests/docs/test_site.py",
    "packages/basu/tests/running/scenario_runs/test_command.py",
    "packages/basu/tests/managers/test_traffic_manager.py",
    "tests/test_wheel.py",
    "packages/linden-gym/tests/test_ppo.py",
    "packages/basu/tests/running/test_shuttles.py",
    "packages/basu-alpasim/tests/test_run_with_policy.py",
    "packages/linden-gym/tests/test_environment.py",
    "packages/basu/tests/running/test_run.py",
    "packages/linden-ros2/tests/test_services.py",
    "packages/basu-service/tests/test_run_with_sumo.py",
    "packages/basu-openscenario/tests/exporting/test_case_export.py",
    "packages/basu/tests/campaigns/test_campaign.py",
    "packages/basu/tests/running/scenario_runs/test_options_of_drives.py",
    "packages/basu/tests/test_rllib.py",
    "packages/basu/tests/test_api.py",
    "packages/linden-window/tests/test_bad_input_in_browser.py",
    "packages/basu-window/tests/browser/test_live.py",
    "packages/basu-alpasim/tests/test_basic_policy.py",
    "packages/linden-window/tests/test_page_server.py",
    "packages/basu/tests/test_notebook.py",
    "packages/linden-gym/tests/test_starts.py",
    "packages/linden-ros2/tests/test_serve_ros2.py",
    "packages/basu-ros/tests/agents/test_run_with_ros.py",
    "packages/basu/tests/running/scenario_runs/test_suite_cheats.py",
    "packages/linden/tests/cli/test_serve.py",
    "packages/basu-window/tests/browser/test_in_browser.py",
    "packages/basu-openscenario/tests/staging/test_distributions.py",
    "packages/basu/tests/scenarios/test_emergency_vehicle_live.py",
    "packages/basu/tests/managers/test_radios.py",
    "packages/linden/tests/test_worlds_sensors.py",
    "packages/basu/tests/test_gym_vector.py",
    "packages/basu/tests/test_python_api_page.py",
    "packages/basu-window/tests/browser/test_film.py",
    "tests/docs/test_tutorials.py",
    "packages/linden-gym/tests/test_reward.py",
    "packages/basu/tests/running/test_single_runs.py",
    "packages/basu/tests/running/test_series.py",
)
"""Files of tests that take longest, longest first: they start first, so that no worker idles at the end."""

TRACED_EXAMPLES = 20
"""Of hypothesis in a test, with coverage; a test has a hundred."""

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell that starts us in the background leaves it so
    signal.signal(signal.SIGINT, signal.default_int_handler)

hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, print_blob=True, max_examples=1000)
hypothesis.settings.register_profile("uncompiled", hypothesis.settings.get_profile("repeatable"), max_examples=10)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_report_header() -> str:
    """Say which profile chooses the random examples; "repeatable" takes its seed from each test's own text."""
    return f"hypothesis profile: {os.environ.get('HYPOTHESIS_PROFILE', 'repeatable')}"


@pytest.hookimpl(tryfirst=True)
def pytest_collection() -> None:
    """Have the garbage collector rest while the tests are collected: all of it stays, and it would look at it often."""
    gc.disable()


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, object, object]:
    """Import a file of tests with coverage, and make its tests without.

    Whatever the import raises, the making of the tests meets it again.
    """
    if not isinstance(collector, pytest.Module | pytest.Class):
        return (yield)
    with suppress(Exception, pytest.skip.Exception):
        _ = collector.obj
    with untraced_here():
        return (yield)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the longest files first; a file's tests keep their order."""
    here = Path(__file__).parent
    places = {here / name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path, len(LONGEST)))


def pytest_collection_finish() -> None:
    """Take all that the collection made out of the garbage collector's sight: it stays until the end."""
    gc.collect()
    gc.freeze()
    gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Measure no coverage in slow tests: they drive long ways through lines that quick tests reach.

    So do tests with the mark ``unmeasured``, which take some seconds.
    Processes that a test starts are measured where it has the mark ``measured_processes``. Others run lines that tests
    of these lines reach in their own process, and a process that measures starts 0.4 s later.
    Of the examples of hypothesis the first ones are measured: the others take the same lines.
    """
    with measured(item.nodeid), ExitStack() as stack:
        if item.get_closest_marker("measured_processes"):
            stack.enter_context(writable_coverage())
        else:
            stack.enter_context(untraced_processes())
        if item.get_closest_marker("slow"):
            stack.enter_context(untraced())
        elif item.get_closest_marker("unmeasured"):
            stack.enter_context(untraced_here())
        elif (random := getattr(getattr(item, "obj", None), "hypothesis", None)) is not None:
            stack.callback(setattr, random, "inner_test", random.inner_test)
            random.inner_test = traced_first(random.inner_test, stack)
        return (yield)


@contextmanager
def writable_coverage() -> Iterator[None]:
    """Let agents' processes write where coverage keeps its files: they are confined to folders of their own."""
    if coverage.Coverage.current() is None:
        yield
        return
    from basu.agents.process import agent_process  # noqa: PLC0415 - most tests start no agent

    before, agent_process.ALSO_WRITABLE = agent_process.ALSO_WRITABLE, (str(Path.cwd()),)
    try:
        yield
    finally:
        agent_process.ALSO_WRITABLE = before


def traced_first(test: Callable[..., object], stack: ExitStack) -> Callable[..., object]:
    """Return a test of hypothesis that stops the coverage until ``stack`` ends after its first examples."""
    numbers = itertools.count(1)

    @functools.wraps(test)
    def counted(*arguments: object, **options: object) -> object:
        if next(numbers) == TRACED_EXAMPLES + 1:
            stack.enter_context(untraced())
        return test(*arguments, **options)

    return counted


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish() -> None:
    """Write the coverage before the process ends: pytest-xdist kills a worker that takes more than 10 s to end."""
    save()
