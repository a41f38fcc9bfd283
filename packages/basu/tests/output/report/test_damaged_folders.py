"""Claims about damaged run folders: each command reads them or refuses them with one sentence.

Each case changes one thing of a good folder: a value, a key, a column, the bytes of a file.
"""

import copy
import json
import random
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from basu.cli import main
from fakes.run_records import crashing, record, written

VALUES = (None, "x", -1, 10**400, 1e308, float("nan"), [], {}, [[1]], True, "2")
DOCUMENTS = ("result.json", "route.json", "config.json")
DEEP = "[" * 100_000 + "]" * 100_000


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("good") / "run", record(crashing()))


def places(document: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all values in a document, of lists the first and the last."""
    if path:
        yield path
    if isinstance(document, dict):
        for key, value in document.items():
            yield from places(value, (*path, key))
    elif isinstance(document, list) and document:
        for index in {0, len(document) - 1}:
            yield from places(document[index], (*path, index))


def changed(document: Any, dice: random.Random) -> Any:
    """The document with one value replaced, left out or doubled."""
    found = copy.deepcopy(document)
    *parents, last = dice.choice(list(places(found)))
    parent = found
    for key in parents:
        parent = parent[key]
    how = dice.choice(("replace", "leave out", "double"))
    if how == "replace":
        parent[last] = dice.choice(VALUES)
    elif how == "double":
        parent[last] = [parent[last], parent[last]]
    else:
        del parent[last]
    return found


def changed_table(table: pa.Table, dice: random.Random) -> pa.Table:
    """The record with one column dropped or made useless, or with rows missing."""
    name = dice.choice(table.column_names)
    at = table.column_names.index(name)
    return dice.choice(
        (
            table.drop_columns([name]),
            table.slice(0, 0),
            table.slice(0, 1),
            table.slice(5, 10),
            table.set_column(at, name, pa.array(np.full(len(table), np.nan))),
            table.set_column(at, name, pa.array(["x"] * len(table))),
        )
    )


def damage(folder: Path, dice: random.Random) -> None:
    """Change one thing of a folder."""
    name = dice.choice((*DOCUMENTS, "route.json", "history.parquet"))
    file = folder / name
    if dice.random() < 0.2:
        file.write_bytes(dice.choice((b"", DEEP.encode(), b"\xff\x00" * 50, file.read_bytes()[:-200], b"[1, 2]")))
    elif name == "history.parquet":
        pq.write_table(changed_table(pq.read_table(file), dice), file)
    else:
        file.write_text(json.dumps(changed(json.loads(file.read_text()), dice)))


def test_no_damage_ends_in_a_traceback(good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dice, folder, codes = random.Random(3), tmp_path / "damaged", []
    for _ in range(60):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(good, folder)
        damage(folder, dice)
        command = dice.choice(("score", "report", "compare"))
        codes.append(main([command, str(folder), *([str(good)] if command == "compare" else [])]))
        said = capsys.readouterr().err
        assert codes[-1] in {0, 2}, said
        assert (codes[-1] == 2) == said.startswith("basu: "), said
    assert codes.count(2) > 10  # the sample has damage that is found


@pytest.mark.parametrize(
    ("file", "text", "sentence"),
    [
        ("result.json", DEEP, "result.json is no JSON: it is nested too deeply"),
        ("config.json", '{"a": ' + "9" * 400 + "}", "config.json is no JSON: a whole number has more than 18 digits"),
        ("route.json", '{"schema_version": 3}', "holds a record that this version cannot read: step_s is missing"),
    ],
)
def test_the_sentence_names_the_file_and_what_is_wrong(
    good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str, text: str, sentence: str
) -> None:
    folder = tmp_path / "damaged"
    shutil.copytree(good, folder)
    (folder / file).write_text(text)
    assert main(["report", str(folder)]) == 2
    assert sentence in capsys.readouterr().err


def test_a_result_of_another_run_is_refused(good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "damaged"
    shutil.copytree(good, folder)
    pq.write_table(pq.read_table(folder / "history.parquet").slice(0, 2), folder / "history.parquet")
    assert main(["report", str(folder)]) == 2
    assert "these are files of different runs" in capsys.readouterr().err
