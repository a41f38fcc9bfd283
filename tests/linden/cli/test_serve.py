"""Claims about ``linden serve`` as a program: what it prints, how it ends, what it says to a mistake."""

import signal
import socket
from pathlib import Path

import psutil
import pytest

from linden.cli import main
from servers import running_server


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(number: signal.Signals) -> None:
    with running_server() as server:
        server.process.send_signal(number)
        assert server.process.wait(10) == 0
        assert server.log() == ""


def test_an_idle_server_is_light() -> None:
    with running_server() as server:
        process = psutil.Process(server.process.pid)
        assert process.memory_info().rss < 300e6
        before = process.cpu_times()
        with pytest.raises(psutil.TimeoutExpired):
            process.wait(3.0)  # three seconds of its life
        after = process.cpu_times()
        assert (after.user + after.system - before.user - before.system) / 3.0 < 0.2


def test_the_first_start_keeps_what_it_derived_of_the_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with running_server() as server:
        assert len(list((tmp_path / "linden" / "maps").glob("*.npz"))) == 1
        assert server.log() == ""


def test_it_listens_on_loopback_only() -> None:
    with running_server() as server:
        listening = [
            connection
            for connection in psutil.Process(server.process.pid).net_connections("tcp")
            if connection.status == psutil.CONN_LISTEN
        ]
        assert {connection.laddr.port for connection in listening} == {server.port, server.streaming_port}
        assert {connection.laddr.ip for connection in listening} == {"127.0.0.1"}


def test_a_port_in_use_is_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert main(["serve", "--port", str(taken.getsockname()[1])]) == 2
    assert "is in use" in capsys.readouterr().err


def test_a_map_that_is_not_there_is_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--port", "0", "--map", "Atlantis"]) == 2
    assert capsys.readouterr().err.startswith("linden: --map: Map 'Atlantis' not found; this server has: Linden")


def test_a_folder_without_maps_is_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--port", "0", "--maps", str(tmp_path)]) == 2
    assert "holds no .xodr file" in capsys.readouterr().err


def test_the_version_names_both(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert "CARLA 0.9.16" in capsys.readouterr().out
