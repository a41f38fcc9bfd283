"""Claims about recorded sessions of keys."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.errors import UserError
from basu_window.manual.inputs import DRIVING_STRIKES, Axes, Held, Input, Strike
from basu_window.manual.session import RecordingSource, Session, Setting, read_session, write_session

SETTING = Setting(town="Linden", route="1", vehicle="vehicle.tesla.model3", step_s=0.05)
HUNDREDTHS = st.integers(0, 100).map(lambda n: n / 100)
AXES = st.builds(Axes, st.integers(-100, 100).map(lambda n: n / 100), HUNDREDTHS, HUNDREDTHS, st.booleans())
STRIKES = st.lists(st.sampled_from(sorted(DRIVING_STRIKES, key=str)), max_size=2, unique=True)
INPUTS = st.lists(
    st.builds(
        Input,
        st.integers(0, 31).map(Held),
        STRIKES.map(lambda strikes: tuple(sorted(strikes, key=[Strike.REVERSE, Strike.AUTOPILOT].index))),
        st.none() | AXES,
    ),
    max_size=50,
)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("session") / "session.json"


@given(inputs=INPUTS)
def test_what_is_written_is_read(file: Path, inputs: list[Input]) -> None:
    session = Session(setting=SETTING, inputs=tuple(inputs), by="a tester")
    write_session(file, session)
    assert read_session(file) == session


def test_a_file_can_be_read_by_people(tmp_path: Path) -> None:
    inputs = [Input(Held.THROTTLE)] * 35 + [Input(Held.THROTTLE | Held.LEFT)] * 2 + [Input()] * 4
    write_session(tmp_path / "s.json", Session(setting=SETTING, inputs=(*inputs, Input(strikes=(Strike.AUTOPILOT,)))))
    document = json.loads((tmp_path / "s.json").read_text())
    assert document["keys"] == ["35W 2WA 4- 1P"]
    assert document["ticks"] == 42
    assert document["recorded"]["vehicle"] == "vehicle.tesla.model3"


def test_after_the_end_nothing_is_pressed() -> None:
    session = Session(setting=SETTING, inputs=(Input(Held.THROTTLE),))
    assert session.read(0) == Input(Held.THROTTLE)
    assert session.read(1) == Input()


def test_a_tape_keeps_what_drives_and_passes_everything_on() -> None:
    done = Input(Held.LEFT, (Strike.QUIT, Strike.REVERSE))
    tape = RecordingSource(Session(setting=SETTING, inputs=(done,)))
    assert tape.read(0) == done
    assert tape.inputs == [Input(Held.LEFT, (Strike.REVERSE,))]


def test_a_session_of_another_vehicle_is_refused() -> None:
    session = Session(setting=SETTING, inputs=())
    session.check(SETTING)
    shuttle = Setting(town="Linden", route="1", vehicle="vehicle.easymile.ez10", step_s=0.05)
    with pytest.raises(UserError, match=r"with vehicle vehicle\.tesla\.model3, and this run has vehicle\.easymile"):
        session.check(shuttle)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"keys": ["35W 2X"]}, "'2X' is no number of ticks with keys"),
        ({"keys": ["W"]}, "'W' is no number of ticks"),
        ({"keys": ["99999999W"]}, "more than 1000000 ticks"),
        ({"keys": [3]}, "is not a session of keys"),
        ({"recorded": {"town": "Linden"}}, "is not a session of keys"),
        ({"version": 2}, "has version 2; this BASU reads 1"),
    ],
)
def test_a_damaged_file_gets_a_sentence(tmp_path: Path, change: dict[str, object], sentence: str) -> None:
    path = tmp_path / "s.json"
    write_session(path, Session(setting=SETTING, inputs=(Input(Held.BRAKE),)))
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(UserError, match=sentence):
        read_session(path)


def test_a_missing_file_and_one_that_is_no_json_get_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read: No such file"):
        read_session(tmp_path / "none.json")
    (tmp_path / "text.json").write_text("W W A")
    with pytest.raises(UserError, match="is not a session of keys"):
        read_session(tmp_path / "text.json")
