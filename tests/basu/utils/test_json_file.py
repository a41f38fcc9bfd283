"""Claims about files of JSON that a person names: what is in them, or which file, why, and what to do."""

from pathlib import Path

import pytest

from basu.errors import UserError
from basu.utils.json_file import read_json


def test_what_is_in_the_file_comes_back(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"a": [1, null]}')
    assert read_json(tmp_path / "a.json", "the file") == {"a": [1, None]}


@pytest.mark.parametrize(
    ("content", "why"),
    [(None, "cannot be read: No such file"), (b'{"a": ', "is no JSON: Expecting value"), (b"\xff\xfe", "is no JSON")],
)
def test_what_is_wrong_is_told_with_what_to_do(content: bytes | None, why: str, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(UserError, match=f"the sheet .*a.json {why}.*; write another"):
        read_json(path, "the sheet", "write another")
