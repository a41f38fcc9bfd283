"""Claims about starting a simulator: an error quotes the last line of its log."""

import socket
import sys
from types import SimpleNamespace

import pytest

from basu import simulator
from basu.conditions import SimulatorSpec
from basu.errors import SimulatorError, UserError
from basu.simulator import OwnServer, connect, started_early


def commanded(monkeypatch: pytest.MonkeyPatch, program: str) -> None:
    """Let a small program stand in for ``linden``."""
    monkeypatch.setattr(simulator, "linden_command", lambda: [sys.executable, "-c", program])


def test_a_server_that_ends_at_once_is_reported_with_its_last_words(monkeypatch: pytest.MonkeyPatch) -> None:
    commanded(monkeypatch, "import sys; print('linden: no map', file=sys.stderr, flush=True); sys.exit(2)")
    with pytest.raises(SimulatorError, match=r"ended by itself \(exit status 2\): linden: no map"):
        OwnServer()


def test_a_killed_server_is_reported_with_the_signal(monkeypatch: pytest.MonkeyPatch) -> None:
    commanded(monkeypatch, "import os, signal; os.kill(os.getpid(), signal.SIGKILL)")
    with pytest.raises(SimulatorError, match=r"was ended by the signal SIGKILL \(as the system does when memory"):
        OwnServer()


def test_a_port_that_nothing_listens_at_is_refused_at_once() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        with pytest.raises(UserError, match=rf"no simulator answers at 127\.0\.0\.1:{port}; start one with .*refused"):
            connect("127.0.0.1", port, 3600.0)


def test_a_server_that_is_never_ready_is_given_up_and_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    commanded(monkeypatch, "import time; print('linden: thinking', flush=True); time.sleep(3600)")
    monkeypatch.setattr(simulator, "START_LIMIT_S", 0.2)
    with pytest.raises(SimulatorError, match="was not ready within 0 s"):
        OwnServer()


def test_a_servers_progress_is_passed_on_until_it_is_ready(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commanded(
        monkeypatch,
        "import time; print('linden: compiling', flush=True); "
        "print('linden: ready, rpc port 4711, streaming port 4712', flush=True); time.sleep(3600)",
    )
    server = OwnServer()
    try:
        assert server.port == 4711
        assert server.gone() is None
    finally:
        server.end()
    assert "ended by the signal SIGTERM" in (server.gone() or "")
    assert capsys.readouterr().err == "linden: compiling\n"


def test_a_server_that_started_early_ends_where_no_run_takes_it_over(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[bool] = []
    server = SimpleNamespace(end=lambda: ended.append(True))
    monkeypatch.setattr(simulator, "own_server", lambda _: server)
    with started_early(SimulatorSpec()):
        assert simulator._early == [server]
    assert (simulator._early, ended) == ([], [True])
    with started_early(SimulatorSpec(host="localhost")):
        assert simulator._early == []


def test_a_timeout_names_the_option_that_extends_it() -> None:
    late = RuntimeError("time-out of 20000ms while waiting for the simulator, make sure the simulator is ready")
    assert simulator.reason(late).endswith("if the machine is busy, wait longer with --timeout S")
    assert simulator.reason(RuntimeError("map not found")) == "map not found"


def test_a_long_call_waits_longer_and_the_usual_timeout_comes_back() -> None:
    given_s: list[float] = []
    client = SimpleNamespace(set_timeout=given_s.append)
    known = simulator.Simulator(
        client,  # type: ignore[arg-type]
        ("", 0),
        own=True,
        why_gone=lambda: None,
        ended=lambda: False,
        timeout_s=7.0,
    )
    with known.long_call():
        assert given_s == [300.0]
    assert given_s == [300.0, 7.0]
