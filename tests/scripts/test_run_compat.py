"""How the runner of the official client's tests tells a test that fails from a client that took its process along."""

import importlib.util
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "run_compat.py"


@pytest.fixture(scope="module")
def runner() -> ModuleType:
    spec = importlib.util.spec_from_file_location("run_compat", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("raise SystemExit(0)", "0"),
        ("raise SystemExit(1)", "1"),
        ("import os; os.abort()", "-6"),
        ("import signal; signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGABRT}); signal.sigwait({signal.SIGUSR1})",
         "stuck"),
        ("import time; time.sleep(60)", "stuck"),
    ],
)  # fmt: skip
def test_a_sentence_says_how_a_process_ended(runner: ModuleType, program: str, expected: str) -> None:
    runner.LAST_WORDS_S = 0.3
    code, _said = runner.run([sys.executable, "-c", program], silent_s=1.5)
    assert code == (runner.STUCK if expected == "stuck" else int(expected))


def test_a_process_that_rests_is_stuck_before_its_time_is_up_and_one_that_computes_is_not(
    runner: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "RESTS_S", 2.0)
    monkeypatch.setattr(runner, "RESTS_USED_S", 0.01)
    monkeypatch.setattr(runner, "LAST_WORDS_S", 0.3)
    resting = "import subprocess, sys; subprocess.run([sys.executable, '-c', 'import time; time.sleep(300)'])"
    computing = "import time; end = time.monotonic() + 6.0\nwhile time.monotonic() < end: pass"
    assert runner.run([sys.executable, "-c", resting])[0] == runner.STUCK
    assert runner.run([sys.executable, "-c", computing]) == (0, b"")


def test_what_a_process_said_is_kept_in_order(runner: ModuleType) -> None:
    program = "import sys; print('first', flush=True); print('second', file=sys.stderr)"
    assert runner.run([sys.executable, "-c", program]) == (0, b"first\nsecond\n")


def test_coverage_is_measured_in_servers_of_all_files_but_the_named_ones(
    runner: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    environments: list[dict[str, str] | None] = []

    def run(_command: list[str], environment: dict[str, str] | None) -> tuple[int, bytes]:
        environments.append(environment)
        return 0, b""

    monkeypatch.setattr(runner, "run", run)
    named = sorted(runner.UNMEASURED)
    assert all((runner.ROOT / name).exists() for name in named)
    for files in (named[:1], ["tests/compat/test_actors.py"], [named[0], "tests/compat/test_actors.py"]):
        runner.told(tuple(files), [])
    assert environments == [None, runner.MEASURED, runner.MEASURED]


def test_one_file_at_a_time_runs_while_the_neighbour_does(runner: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, both = threading.Semaphore(0), threading.Barrier(2, timeout=30.0)
    running: list[str] = []

    def told(files: tuple[str, ...], _options: list[str]) -> str:
        (name,) = files
        running.append(name)
        begun.release()
        if name != "alone":
            both.wait()  # passes when two run at a time
        else:
            assert running == ["alone"]
            neighbour.communicate(b"")
        return name

    monkeypatch.setattr(runner, "told", told)
    with subprocess.Popen(
        [sys.executable, "-c", "input()"], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as neighbour:
        turns = runner.Turns(2, neighbour.pid)
        with ThreadPoolExecutor(2) as workers:
            first = workers.submit(turns.take, ("alone",), [])
            assert begun.acquire(timeout=30.0)
            rest = [workers.submit(turns.take, (name,), []) for name in ("left", "right")]
            assert [each.result(60.0) for each in (first, *rest)] == ["alone", "left", "right"]


def test_every_file_runs_once_and_files_that_are_together_exist(runner: ModuleType) -> None:
    files = [f"tests/compat/{path.name}" for path in (SCRIPT.parents[1] / "tests" / "compat").glob("test_*.py")]
    groups = runner.grouped(files)
    assert sorted(file for group in groups for file in group) == sorted(files)
    assert {len(group) for group in groups if len(group) > 1} == {len(names) for names in runner.TOGETHER}
    assert groups == runner.grouped(reversed(files))
