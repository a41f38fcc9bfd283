"""Processes that compile groups of kernels: how a server waits for them, and what is printed."""

import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from linden.cli import compiling, main
from linden.cli.compiling import Compiling, FirstStart, compile_groups
from linden.maps.cache import MapCache
from linden.sensors.compiling import OF_PHYSICS, OF_SENSORS, is_compiled, note_compiled

WAITS = "import signal, sys; print('rays', flush=True); signal.pause()"


def test_a_group_can_be_waited_for_while_others_compile(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiling, "PROGRAM", WAITS)
    process = Compiling("rays", "cameras", background=True)
    process.wait_for("rays")
    assert process.has("rays")
    assert not process.has("cameras")
    process.end()
    process.wait_for("cameras")  # ends although it never was compiled: what is missing is compiled where it is needed
    assert process.wait() < 0


def test_groups_are_compiled_in_their_order_and_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    order: list[str] = []
    monkeypatch.setattr(compiling, "GROUPS", {name: lambda name=name: order.append(name) for name in "ab"})
    compile_groups(["b", "a"])
    assert order == ["b", "a"]
    assert capsys.readouterr().out.split() == ["b", "a"]


def test_a_group_that_cannot_be_compiled_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiling, "PROGRAM", "import sys; sys.exit(3 * ('rays' in sys.argv))")
    assert main(["compile"]) == 2
    said = capsys.readouterr()
    assert said.err == "linden: could not compile rays; the messages stand above\n"
    groups = len(compiling.GROUPS) + len(compiling._of_plugins())
    assert said.out.count("compiled kernels") == groups - 1
    assert f"of {groups}: driving" in said.out


def test_a_plugin_brings_a_group(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    order: list[str] = []
    brought = SimpleNamespace(name="theirs", load=lambda: lambda: order.append("theirs"))
    monkeypatch.setattr("importlib.metadata.entry_points", lambda group: [brought] if group == "linden.kernels" else [])
    compile_groups(["theirs"])
    assert order == ["theirs"]
    assert capsys.readouterr().out == "theirs\n"


def test_a_first_start_prints_each_step_and_ends_what_it_began(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(compiling, "PROGRAM", WAITS)
    said: list[str] = []
    start = FirstStart(said.append)
    start.begin(MapCache(tmp_path))
    parts = list(start._parts.values())
    start.step("the world")
    start.compile_sensors(scenery=True)
    start.await_sensors(False)
    assert start.is_compiling()
    start.end()
    start.await_sensors(True)
    assert not start.is_compiling()
    assert [part.wait() < 0 for part in parts] == [True, True]
    assert said[0].startswith("linden: compiling kernels, once on this machine")
    assert said[1:] == ["linden: compiling kernels, 1 of 5: the world"]


def test_a_start_with_everything_compiled_starts_no_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    cache, said = MapCache(tmp_path), list[str]()
    file = tmp_path / "kernel.nbc"
    file.touch()
    monkeypatch.setattr("linden.sensors.compiling._compiled_files", lambda _kernels: [os.fspath(file)])
    for kernels in (OF_PHYSICS, OF_SENSORS):
        assert not is_compiled(kernels, cache)
        note_compiled(kernels, cache)
    start = FirstStart(said.append)
    start.begin(cache)
    start.step("the world")
    start.compile_sensors(scenery=False)
    assert not start.is_compiling()
    start.await_sensors(True)
    start.end()
    assert said == []


def test_a_start_with_compiled_kernels_makes_missing_scenery_in_the_background(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("linden.sensors.compiling._are_shipped", lambda: True)
    monkeypatch.setattr(compiling, "PROGRAM", WAITS)
    start = FirstStart(print)
    start.begin(MapCache(tmp_path))
    start.compile_sensors(scenery=True)
    assert not start.is_compiling()  # pictures need no kernel that is not there
    start.await_sensors(True)
    assert start._background is not None
    start.end()
    assert start._background.wait() < 0
