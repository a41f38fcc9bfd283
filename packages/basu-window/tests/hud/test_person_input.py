"""Claims about the source of a person's input, and its options on the command line."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pygame
import pytest

from basu.cli import main
from basu.errors import SimulatorError, UserError
from basu.options.run import RunOptions
from basu_window.hud.person_input import KeysManager, person_for
from basu_window.hud.sensor_view import ChaseCamera
from basu_window.manual.inputs import Held, Input
from basu_window.manual.session import Played, RecordingSource, Session, Setting, read_session

SESSION = "data/human_session.json"


@pytest.fixture(autouse=True)
def no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"):
        monkeypatch.delenv(name, raising=False)
    pygame.display.quit()


def test_no_actor_sits_before_an_agent_that_is_not_watched() -> None:
    assert person_for(RunOptions(), by_hand=False) is None


@pytest.mark.parametrize(("options", "by_hand"), [(RunOptions(hud="map"), False), (RunOptions(agent="human"), True)])
def test_a_window_without_a_display_is_refused_before_anything_starts(options: RunOptions, *, by_hand: bool) -> None:
    with pytest.raises(UserError, match="no window can be opened here"):
        person_for(options, by_hand=by_hand)


def test_keys_are_played_without_a_window_and_without_waiting() -> None:
    person = person_for(RunOptions(agent="human", keys=SESSION), by_hand=True)
    assert person is not None
    assert (person.driving, person.live) == (True, False)


def test_under_an_agent_a_session_begins_with_the_agent() -> None:
    person = person_for(RunOptions(keys=SESSION), by_hand=False)
    assert person is not None
    assert not person.driving


def test_recording_needs_an_actor_one_that_does_something() -> None:
    with pytest.raises(UserError, match="there is no window; add --watch or --hud"):
        person_for(RunOptions(record_keys=Path("keys.json")), by_hand=False)


def test_a_folder_that_is_not_there_is_reported_before_anything_starts(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"keys\.json cannot be written: there is no folder"):
        person_for(RunOptions(keys=SESSION, record_keys=tmp_path / "no" / "keys.json"), by_hand=True)


def test_what_was_driven_is_written_with_where(tmp_path: Path) -> None:
    setting = Setting(town="Linden", route="7", vehicle="vehicle.audi.tt", step_s=0.05)
    tape = RecordingSource(Played(Session(setting=setting, inputs=(Input(Held.BRAKE),)), None))
    tape.read(0)
    manager = KeysManager(tape, tmp_path / "keys.json")
    run: Any = SimpleNamespace(
        route=SimpleNamespace(town="Linden", id="7"), vehicle=SimpleNamespace(type_id="vehicle.audi.tt"), step_s=0.05
    )
    manager.setup(run)
    manager.close()
    written = read_session(tmp_path / "keys.json")
    assert (written.setting, written.inputs) == (setting, (Input(Held.BRAKE),))


def test_a_run_that_was_never_set_up_leaves_no_session(tmp_path: Path) -> None:
    KeysManager(RecordingSource(Session(setting=None, inputs=())), tmp_path / "keys.json").close()  # type: ignore[arg-type]
    assert not (tmp_path / "keys.json").exists()


def test_a_simulator_without_cameras_says_so() -> None:
    def find(_name: str) -> None:
        raise IndexError("blueprint 'sensor.camera.rgb' not found")

    spot = SimpleNamespace(x=0.0, y=0.0, z=0.7)
    vehicle = SimpleNamespace(bounding_box=SimpleNamespace(location=spot, extent=spot))
    world = SimpleNamespace(get_blueprint_library=lambda: SimpleNamespace(find=find))
    run: Any = SimpleNamespace(world=world, vehicle=vehicle, timeout_s=1.0)
    with pytest.raises(SimulatorError, match=r"no camera: blueprint 'sensor\.camera\.rgb' not found"):
        ChaseCamera(run, (64, 48), 0.0)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--hud", "basic"], "an agent is named before --hud, as in `basu run basic --hud`"),
        (["basic", "--hud", "--hud-size", "big"], "--hud-size big: write WIDTHxHEIGHT"),
        (["basic", "--hud", "--hud-size", "10x10"], "--hud-size 10x10: it may be from 640x480 to 7680x4320"),
        (["basic", "--hud-screenshot", "a.png"], "takes a picture of the window; add --hud"),
        (["human"], "no window can be opened here"),
    ],
)
def test_a_mistake_is_one_sentence(capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str) -> None:
    assert main(["run", *arguments]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1
