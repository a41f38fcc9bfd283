"""Claims about the source of a person's input, and its options on the command line."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from basu.cli import main
from basu.errors import UserError
from basu.options.run import RunOptions
from basu_window.manual.inputs import Held, Input
from basu_window.manual.session import Played, RecordingSource, Session, Setting, read_session
from basu_window.person_input import KeysManager, person_for

SESSION = "data/human_session.json"


def test_no_actor_sits_before_an_agent_that_is_not_watched() -> None:
    assert person_for(RunOptions(), by_hand=False) is None


@pytest.mark.parametrize(("options", "by_hand"), [(RunOptions(watch=True), False), (RunOptions(agent="human"), True)])
def test_a_person_acts_at_a_page_and_human_needs_no_option_for_it(options: RunOptions, *, by_hand: bool) -> None:
    person = person_for(options, by_hand=by_hand)
    assert person is not None
    assert person.page is not None
    assert (person.driving, person.live) == (by_hand, True)


def test_keys_are_played_without_a_window_and_without_waiting() -> None:
    person = person_for(RunOptions(agent="human", keys=SESSION), by_hand=True)
    assert person is not None
    assert (person.driving, person.live, person.page) == (True, False, None)


def test_under_an_agent_a_session_begins_with_the_agent() -> None:
    person = person_for(RunOptions(keys=SESSION), by_hand=False)
    assert person is not None
    assert not person.driving


def test_recording_needs_an_actor_one_that_does_something() -> None:
    with pytest.raises(UserError, match="there is no page; add --watch"):
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


@pytest.mark.parametrize(
    ("flag", "words"),
    [
        (["--hud"], "--hud is no option any more: --watch shows the drive, its sensors and its figures in a page"),
        (["--hud", "map"], "--hud is no option any more: --watch shows"),
        (["--hud-size", "800x600"], "--hud-size is no option any more: the page has the size of the browser's window"),
        (["--hud-screenshot", "a.png"], "--hud-screenshot is no option any more: press K in the page of --watch"),
        (["--viewer"], "--viewer is no option any more: --watch shows the drive"),
    ],
)
@pytest.mark.parametrize("command", [["run", "basic"], ["scenario", "run", "all"]])
def test_options_of_former_windows_name_the_page(
    capsys: pytest.CaptureFixture[str], command: list[str], flag: list[str], words: str
) -> None:
    with pytest.raises(SystemExit):
        main([*command, *flag])
    assert words in capsys.readouterr().err
