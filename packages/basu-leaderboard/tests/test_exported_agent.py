"""Claims about the file that names the exported agent."""

from pathlib import Path

import pytest

from basu.errors import UserError
from basu_leaderboard.exported_agent import ExportConfig, read_config


def written(folder: Path, text: str) -> str:
    path = folder / "basu_agent.json"
    path.write_text(text)
    return str(path)


def test_without_a_file_the_basic_agent_drives() -> None:
    assert read_config("") == ExportConfig(agent="basic", sensors=None, track="SENSORS")


def test_the_file_names_agent_sensors_and_track(tmp_path: Path) -> None:
    text = '{"agent": "mine.py:Mine", "sensors": "config/rig.json", "track": "MAP"}'
    assert read_config(written(tmp_path, text)) == ExportConfig(
        agent="mine.py:Mine", sensors="config/rig.json", track="MAP"
    )


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("basic", "is no JSON"),
        ('"basic"', r'must hold an object, such as {"agent": "basic"}'),
        ('{"agnet": "basic"}', "has the key 'agnet', which means nothing here; did you mean 'agent'"),
        ('{"zzz": "basic"}', "it may have agent, sensors, track"),
        ('{"agent": 3}', "'agent' is 3; it must be a text"),
    ],
)
def test_a_file_that_says_nothing_useful_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        read_config(written(tmp_path, text))


def test_a_file_that_is_not_there_gets_a_sentence() -> None:
    with pytest.raises(UserError, match=r"agent config nowhere.json cannot be read: No such file"):
        read_config("nowhere.json")
