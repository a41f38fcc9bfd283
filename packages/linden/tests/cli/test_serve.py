"""Claims about ``linden serve`` as a program: what it prints, how it ends, what it says to a mistake."""

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import carla
import msgpack
import psutil
import pytest

from fakes.raw_client import RawClient, RawSubscriber
from linden.cli import main
from linden.maps.cache import MapCache
from opendrive_texts import PLAIN_ROAD
from servers import START_LIMIT_S, running_server


@pytest.fixture
def street(tmp_path: Path) -> tuple[str, ...]:
    """Options for a server of one street, of which there is little to derive."""
    folder = tmp_path / "maps"
    folder.mkdir()
    (folder / "Street.xodr").write_text(PLAIN_ROAD, "utf-8")
    return "--maps", str(folder), "--map", "Street"


@pytest.mark.measured_processes
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(street: tuple[str, ...], number: signal.Signals) -> None:
    with running_server(*street) as server:
        server.process.send_signal(number)
        assert server.process.wait(10) == 0
        assert server.log() == ""


def test_an_idle_server_is_light_and_listens_on_loopback_only() -> None:
    with running_server() as server:
        process = psutil.Process(server.process.pid)
        listening = [each for each in process.net_connections("tcp") if each.status == psutil.CONN_LISTEN]
        assert {each.laddr.port for each in listening} == {server.port, server.streaming_port}
        assert {each.laddr.ip for each in listening} == {"127.0.0.1"}
        assert process.memory_info().rss < 300e6
        before = process.cpu_times()
        with pytest.raises(psutil.TimeoutExpired):
            process.wait(3.0)  # three seconds of its life
        after = process.cpu_times()
        assert (after.user + after.system - before.user - before.system) / 3.0 < 0.2


@pytest.mark.measured_processes
def test_the_first_start_keeps_what_it_derived_of_the_map(
    tmp_path: Path, street: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    maps = tmp_path / "linden" / "maps"
    maps.mkdir(parents=True)
    for note in MapCache.of_user()._folder.glob("*.compiled"):  # else other processes look through all kernels for 5 s
        shutil.copy(note, maps)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with running_server(*street) as server:
        assert len(list(maps.glob("*.npz"))) == 1
        assert server.log() == ""


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


def started(*options: str, **how: Any) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-m", "linden.cli", "serve", *options], text=True, **how)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        pytest.param(["--port", "65535"], "--streaming-port is the one after --port", id="no port after the last"),
        pytest.param(["--port", "2000", "--streaming-port", "2000"], "cannot be both", id="one port for both"),
        pytest.param(["--port", "-1"], "ports go from 0 to 65535", id="no such port"),
        pytest.param(["--port", "0", "--host", "192.0.2.1"], "this machine has no such address", id="no such address"),
    ],
)
def test_ports_that_cannot_be_are_a_sentence(
    options: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["serve", *options]) == 2
    said = capsys.readouterr().err
    assert said.startswith("linden: ")
    assert sentence in said
    assert said.count("\n") == 1


@pytest.mark.measured_processes
def test_it_serves_on_although_its_output_is_not_read() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with (
        socket.create_server(("127.0.0.1", 0)) as one,
        socket.create_server(("127.0.0.1", 0)) as other,
    ):
        rpc, streaming = one.getsockname()[1], other.getsockname()[1]
    process = started("--port", str(rpc), "--streaming-port", str(streaming), stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    try:
        until_it_answers(rpc)
        process.terminate()
        _, err = process.communicate(timeout=10)
    finally:
        process.kill()
    assert process.returncode == 0
    assert err.count("\n") == 1
    assert "cannot print 'linden: ready" in err


def until_it_answers(port: int) -> None:
    while True:
        with contextlib.suppress(ConnectionRefusedError), RawClient(port) as client:
            client.socket.settimeout(START_LIMIT_S)  # the port is open before the server is ready
            assert client.call("version") == "0.9.16"
            return


@pytest.mark.measured_processes
def test_a_cache_that_cannot_be_written_stops_no_server(
    tmp_path: Path, street: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "linden").write_text("a file where the folder should be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with running_server(*street) as server, RawClient(server.port) as client:
        assert client.call("get_map_info")[0] == "Carla/Maps/Street"
        line = next(line for line in server.log().splitlines() if "derived cannot be kept" in line)
        assert line.startswith(f"linden: WARNING: what was compiled and derived cannot be kept in {tmp_path}")
        assert "set XDG_CACHE_HOME to a folder that can be written" in line


def test_a_signal_during_a_long_call_ends_it_cleanly_within_two_seconds() -> None:
    with running_server("--sync") as server, RawClient(server.port) as client:
        client.socket.sendall(b"".join(client.request("load_new_episode", "", True, 0xFFFF) for _ in range(5000)))
        client.answer()
        began_s = time.monotonic()
        server.process.terminate()
        assert server.process.wait(10) == 0
        assert time.monotonic() - began_s < 2.0
        assert "Traceback" not in server.log()


@pytest.mark.parametrize("after_s", [0.2, 0.7, 1.2])
def test_a_signal_while_a_scene_is_built_ends_it_cleanly(after_s: float) -> None:
    """Compiled code of the building thread went on during the exit, and ended the process by SIGABRT."""
    with running_server() as server, RawClient(server.port) as client:
        point = client.call("get_map_info")[1][0]
        client.call("spawn_actor", [0, "sensor.camera.rgb", []], point)
        time.sleep(after_s)
        server.process.terminate()
        assert server.process.wait(20) == 0, server.log()


def test_it_ends_while_a_subscriber_reads_nothing(street: tuple[str, ...]) -> None:
    with (
        running_server("--sync", *street) as server,
        RawClient(server.port) as client,
        RawSubscriber(server.streaming_port, 1) as deaf,
    ):
        deaf.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        for _ in range(500):
            client.call("tick_cue")
        server.process.send_signal(signal.SIGINT)
        assert server.process.wait(2) == 0
        assert server.log() == ""


def test_it_listens_on_ipv6_too(street: tuple[str, ...]) -> None:  # the official client looks for IPv4 alone
    with running_server("--host", "::1", *street) as server:
        with socket.create_connection(("::1", server.port), 10.0) as client:
            client.sendall(msgpack.packb([0, 1, "version", [[False]]]))
            assert msgpack.unpackb(client.recv(1000)) == [1, 1, None, [[1, "0.9.16"]]]
        with pytest.raises(ConnectionRefusedError), socket.create_connection(("127.0.0.1", server.port), 10.0):
            pass


def test_the_official_client_finds_it_by_name(street: tuple[str, ...]) -> None:
    with running_server(*street) as server:
        client = carla.Client("localhost", server.port)
        client.set_timeout(20.0)
        assert client.get_world().get_map().name == "Carla/Maps/Street"
