"""Claims about the server as a process: signals, output that nobody reads, the limit of open files."""

import logging
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from linden.cli import main
from linden.cli.process import GRACE_S, LossyHandler, allow_connections

STUCK = """
import os
from linden.cli.process import Ending
with Ending() as ending:
    ending.ask_first(lambda: os.write(1, b"asked\\n"))  # print() may be under way when the signal comes
    os.write(1, b"stuck\\n")
    while True:
        sum(range(1000))
"""


@pytest.fixture
def stuck() -> Iterator[subprocess.Popen[str]]:
    """A server whose present call never ends."""
    with subprocess.Popen(
        [sys.executable, "-c", STUCK], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "stuck\n"
        yield process
        process.kill()


def test_what_does_not_end_when_asked_is_broken_off(stuck: subprocess.Popen[str]) -> None:
    began_s = time.monotonic()
    stuck.send_signal(signal.SIGTERM)
    out, err = stuck.communicate(timeout=10)
    assert (stuck.returncode, out, err) == (0, "asked\n", "")
    assert GRACE_S <= time.monotonic() - began_s < 2.0


def test_the_second_signal_breaks_off_at_once(stuck: subprocess.Popen[str]) -> None:
    began_s = time.monotonic()
    stuck.send_signal(signal.SIGINT)
    assert stuck.stdout is not None
    assert stuck.stdout.readline() == "asked\n"
    stuck.send_signal(signal.SIGINT)
    assert stuck.wait(10) == 0
    assert time.monotonic() - began_s < GRACE_S


SWALLOWS = """
import os
from linden.cli.process import Ending
with Ending():
    try:
        os.write(1, b"compiling\\n")
        while True:
            sum(range(1000))
    except SystemExit:  # as a callback of the compiler's would
        os.write(1, b"swallowed\\n")
    while True:
        sum(range(1000))
"""


def test_an_end_that_a_callback_swallows_comes_again() -> None:
    with subprocess.Popen([sys.executable, "-c", SWALLOWS], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "compiling\n"
        process.send_signal(signal.SIGTERM)
        assert process.stdout.readline() == "swallowed\n"
        assert process.wait(10) == 0


def pipe_of_log(monkeypatch: pytest.MonkeyPatch) -> tuple[int, logging.Logger]:
    """The reading end of a pipe, and a logger that writes into it."""
    reading, writing = os.pipe()
    monkeypatch.setattr(sys, "stderr", os.fdopen(writing, "w"))
    logger = logging.Logger("test")  # noqa: LOG001 - one that no other test knows
    logger.addHandler(LossyHandler())
    return reading, logger


def test_a_log_without_a_reader_loses_lines_and_stops_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    reading, logger = pipe_of_log(monkeypatch)
    for number in range(10_000):  # a pipe holds 64 KiB
        logger.warning("line %d", number)
    text = os.read(reading, 10_000_000).decode()
    read = text.count("\n")
    logger.warning("after")
    assert text.startswith("line 0\nline 1\n")
    lost = b"linden: %d lines of the log are lost here, because stderr was not read\n" % (10_000 - read)
    assert os.read(reading, 1000) == lost + b"after\n"
    os.close(reading)


def test_a_log_without_its_reader_is_written_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    reading, logger = pipe_of_log(monkeypatch)
    os.close(reading)
    logger.warning("into the void")


def test_a_server_started_without_stderr_has_a_log_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", None)
    logger = logging.Logger("test")  # noqa: LOG001 - one that no other test knows
    handler = LossyHandler()
    logger.addHandler(handler)
    logger.warning("into the void")
    handler.stream.close()


def test_the_limit_of_open_files_is_raised_as_far_as_allowed() -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(soft, 256), hard))
        allow_connections()
        raised, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        assert raised == (20_000 if hard == resource.RLIM_INFINITY else min(hard, 20_000))
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_no_command_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    shown = capsys.readouterr()
    assert "usage: linden" in shown.out
    assert shown.err == ""


IN_A_KERNEL = """
import os
from linden.cli.process import Ending
with Ending() as ending:
    ending.ask_first(lambda: None)
    os.write(1, b"busy\\n")
    import ctypes
    while True:  # compiled code that no handler of Python's interrupts
        ctypes.CDLL(None).sleep(60)
"""


@pytest.mark.parametrize(("signals", "most_s"), [(1, 2.0), (2, 1.0)])
def test_compiled_code_does_not_keep_a_server_from_its_end(signals: int, most_s: float) -> None:
    with subprocess.Popen([sys.executable, "-c", IN_A_KERNEL], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "busy\n"
        began_s = time.monotonic()
        for _ in range(signals):
            process.send_signal(signal.SIGINT)
            time.sleep(0.05)  # two of one kind at once are one to the kernel
        assert process.wait(10) == 0
        assert time.monotonic() - began_s < most_s
