"""How the runner of the official client's tests tells a test that fails from a client that took its process along."""

import importlib.util
import sys
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
def test_how_a_process_ended_is_told(runner: ModuleType, program: str, expected: str) -> None:
    runner.LAST_WORDS_S = 0.3
    code, _said = runner.run([sys.executable, "-c", program], silent_s=1.5)
    assert code == (runner.STUCK if expected == "stuck" else int(expected))


def test_what_a_process_said_is_kept_in_order(runner: ModuleType) -> None:
    program = "import sys; print('first', flush=True); print('second', file=sys.stderr)"
    assert runner.run([sys.executable, "-c", program]) == (0, b"first\nsecond\n")
