"""Claims about starting a simulator: its last words are told, and names are looked up in sentences."""

import sys
from types import SimpleNamespace

import carla
import pytest

from basu import simulator
from basu.errors import SimulatorError, UserError
from basu.simulator import OwnServer, check_towns, weather_called


def commanded(monkeypatch: pytest.MonkeyPatch, program: str) -> None:
    """Let a small program stand in for ``linden``."""
    monkeypatch.setattr(simulator, "linden_command", lambda: [sys.executable, "-c", program])


def test_a_server_that_ends_at_once_is_told_with_its_last_words(monkeypatch: pytest.MonkeyPatch) -> None:
    commanded(monkeypatch, "import sys; print('linden: no map', file=sys.stderr, flush=True); sys.exit(2)")
    with pytest.raises(SimulatorError, match=r"ended by itself \(exit status 2\): linden: no map"):
        OwnServer()


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
    assert "ended by itself" in (server.gone() or "")
    assert capsys.readouterr().err == "linden: compiling\n"


def test_a_weather_is_one_of_carlas_presets() -> None:
    assert weather_called("ClearSunset") == carla.WeatherParameters.ClearSunset
    with pytest.raises(UserError, match=r"no weather called 'Frogs'; there are .*ClearNoon.*WetSunset"):
        weather_called("Frogs")


class OneTown:
    """A client of a simulator with a map of its own and one town."""

    def get_world(self) -> SimpleNamespace:
        return SimpleNamespace(get_map=lambda: SimpleNamespace(name="OpenDriveMap"))

    def get_available_maps(self) -> list[str]:
        return ["Carla/Maps/Linden"]


def test_all_towns_that_are_missing_are_told_at_once() -> None:
    check_towns(OneTown(), ["Linden", "OpenDriveMap", "Linden"])
    with pytest.raises(UserError, match=r"routes are in Town12, Town13, which .* it has Linden, OpenDriveMap: name"):
        check_towns(OneTown(), ["Town13", "Linden", "Town12", "Town13"])
