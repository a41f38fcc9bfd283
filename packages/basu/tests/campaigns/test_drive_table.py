"""Claims about the table of drives: its files depend on the rows alone, and a kill costs at most the row in work."""

import json
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from basu.campaigns.drive_table import DriveTable, read_drives
from basu.errors import UserError

SCHEMA = pa.schema([("number", pa.int64()), ("agent", pa.string()), ("score", pa.float64())])


WRITER = """
import sys, tempfile
from pathlib import Path
import pyarrow as pa
from basu.campaigns.columns import schema_of
from basu.campaigns.drive_table import DriveTable

pa.set_cpu_count(16)  # as on a larger machine: each thread of Arrow keeps memory of its own
schema = schema_of({})
numbers = {name: 0.0 for name in schema.names if str(schema.field(name).type) == "double"}
resident_mb = lambda: int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6
with tempfile.TemporaryDirectory() as folder:
    table = DriveTable(Path(folder), schema, 400, 4800)
    for number in range(4800):
        values = {name: (number * 7919 + place) % 9973 / 7.0 for place, name in enumerate(numbers)}
        table.add({**values, "number": number, "agent": "abc"[number % 3], "message": f"drive {number}"})
        if number in (1599, 4799):
            print(resident_mb())
"""


def row_of(number: int) -> dict[str, Any]:
    return {"number": number, "agent": ("basic", "blind")[number % 2], "score": number / 7.0}


def filled(folder: Path, order: list[int]) -> DriveTable:
    table = DriveTable(folder, SCHEMA, 8, 30)
    for number in order:
        table.add(row_of(number))
    return table


def files_of(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*.parquet")}


def test_files_are_the_same_in_whatever_order_drives_end(tmp_path: Path) -> None:
    order = list(range(30))
    filled(tmp_path / "one", order).close()
    random.Random(3).shuffle(order)
    filled(tmp_path / "other", order).close()
    files = files_of(tmp_path / "one")
    assert files == files_of(tmp_path / "other")
    assert len(files) == 2 * 4
    assert not list((tmp_path / "one" / "journal").iterdir())
    rows = read_drives(tmp_path / "one").to_pylist()
    assert [row["number"] for row in rows] == list(range(30))
    assert all(row == row_of(row["number"]) for row in rows)


def test_a_half_line_is_driven_again_and_a_row_is_counted_once(tmp_path: Path) -> None:
    table = filled(tmp_path, [0, 1, 2])
    table.add(row_of(2))
    journal = tmp_path / "journal" / "block-000000.jsonl"
    with journal.open("ab") as file:
        file.write(json.dumps(row_of(3)).encode()[:-5])
    again = DriveTable(tmp_path, SCHEMA, 8, 30)
    assert again.number == 3
    assert next(again.pending(30)) == 3
    for number in again.pending(30):
        again.add(row_of(number))
    again.close()
    filled(tmp_path / "undisturbed", list(range(30))).close()
    assert files_of(tmp_path / "undisturbed") == {
        name: data for name, data in files_of(tmp_path).items() if not name.startswith("undisturbed")
    }


def test_rows_of_an_open_block_can_be_read_and_the_block_goes_on(tmp_path: Path) -> None:
    filled(tmp_path, [0, 1, 2, 9]).close()
    assert read_drives(tmp_path)["number"].to_pylist() == [0, 1, 2, 9]
    again = DriveTable(tmp_path, SCHEMA, 8, 30)
    assert list(again.pending(12)) == [3, 4, 5, 6, 7, 8, 10, 11]


def test_a_table_is_cut_behind_a_block(tmp_path: Path) -> None:
    table = filled(tmp_path, [*range(20), 25])
    table.cut(1)
    table.close()
    assert read_drives(tmp_path)["number"].to_pylist() == list(range(8))


def test_a_full_disk_is_one_sentence_and_loses_no_row(tmp_path: Path) -> None:
    limit = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200));"
        "import pyarrow as pa; from pathlib import Path;"
        "from basu.campaigns.drive_table import DriveTable; from basu.errors import UserError\n"
        "table = DriveTable(Path(sys.argv[1]), pa.schema([('number', pa.int64())]), 100, 100)\n"
        "try:\n    for number in range(100): table.add({'number': number, 'agent': 'basic', 'score': 0.5})\n"
        "except UserError as error: print(error)\n"
    )
    said = subprocess.run([sys.executable, "-c", limit, str(tmp_path)], capture_output=True, text=True, check=True)
    assert "make room and go on with --resume" in said.stdout
    assert said.stdout.count("\n") == 1
    again = DriveTable(tmp_path, SCHEMA, 100, 100)
    written = next(again.pending(100))
    assert 0 < written < 10
    again.add(row_of(written))
    assert again.number == written + 1


def test_a_folder_without_drives_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no drives of a campaign yet"):
        read_drives(tmp_path)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_the_memory_of_the_driver_does_not_grow_with_the_number_of_blocks() -> None:
    done = subprocess.run([sys.executable, "-c", WRITER], capture_output=True, text=True, check=True)
    early_mb, late_mb = map(float, done.stdout.split())
    assert late_mb < early_mb + 6.0
