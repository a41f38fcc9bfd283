"""Tests of ``basu.files``."""

from pathlib import Path

import pytest

from basu.errors import UserError
from basu.files import PACKAGE_FOLDER, find, read_json


def test_what_is_in_the_file_comes_back(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"a": [1, null]}')
    assert read_json(tmp_path / "a.json", "the file") == {"a": [1, None]}


@pytest.mark.parametrize(
    ("content", "why"),
    [(None, "cannot be read: No such file"), (b'{"a": ', "is no JSON: Expecting value"), (b"\xff\xfe", "is no JSON")],
)
def test_what_is_wrong_is_reported_with_what_to_do(content: bytes | None, why: str, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(UserError, match=f"the sheet .*a.json {why}.*; write another"):
        read_json(path, "the sheet", "write another")


@pytest.fixture
def agent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("here", "beside"):
        (tmp_path / name / "config").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "beside" / "agent.py"


def test_what_comes_with_basu_is_found_from_anywhere(agent: Path) -> None:
    assert find("config/sensors.json", "sensor file", agent) == PACKAGE_FOLDER / "config" / "sensors.json"
    assert find("data/route_linden.xml", "route file") == PACKAGE_FOLDER / "data" / "route_linden.xml"


def test_beside_the_agent_goes_before_what_comes_with_basu(agent: Path) -> None:
    beside = agent.parent / "config" / "sensors.json"
    beside.write_text("[]")
    assert find("config/sensors.json", "sensor file", agent) == beside


def test_the_working_folder_goes_before_both(agent: Path) -> None:
    for folder in (agent.parent, Path.cwd()):
        (folder / "config" / "sensors.json").write_text("[]")
    assert find("config/sensors.json", "sensor file", agent) == Path.cwd() / "config" / "sensors.json"


def test_what_is_nowhere_is_reported_with_the_places_that_were_looked_in(agent: Path) -> None:
    with pytest.raises(UserError, match=r"sensor file 'x.json' was not found \(looked in .*here, .*beside, .*basu\)"):
        find("x.json", "sensor file", agent)
    with pytest.raises(UserError, match=r"route file '/no/such.xml' was not found \(looked in /no/such.xml\)"):
        find("/no/such.xml", "route file")
