"""Claims about a record as tables: units in the metadata, and nothing lost."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from basu.errors import UserError
from basu.records.history import History, LaneInvasion
from basu.records.history.model import FRAME
from basu.records.history.tables import unit_of
from fakes.drives import at, driven, hit


def record() -> History:
    return driven(
        at(5.0, 1.0),
        collisions=[hit(3)],
        lane_invasions=[LaneInvasion(tick=4, markings=("Solid/White", "Broken/White"))],
    )


@pytest.mark.parametrize(
    ("column", "unit"),
    [
        ("x_m", "m"),
        ("velocity_x_mps", "m/s"),
        ("acceleration_x_mps2", "m/s²"),
        ("angular_velocity_z_radps", "rad/s"),
        ("throttle", ""),
        ("tick", ""),
        ("impulse_x_ns", "N s"),
    ],
)
def test_a_columns_unit_is_the_end_of_its_name(column: str, unit: str) -> None:
    assert unit_of(column) == unit


def test_the_arrow_table_is_made_without_pandas() -> None:
    code = (
        "import sys; from fakes.drives import at, driven, hit; from basu.records.history.tables import to_arrow; "
        "print(to_arrow(driven(at(5.0, 1.0), collisions=[hit(3)])).num_rows > 0, 'pandas' in sys.modules)"
    )
    path = os.pathsep.join([str(Path(__file__).parents[5] / "tests"), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["True", "False"]


def test_the_arrow_table_has_the_units_in_its_fields() -> None:
    table = record().to_arrow()
    assert table.schema.field("velocity_x_mps").metadata == {b"unit": b"m/s"}
    assert table.schema.field("throttle").metadata is None
    assert table.num_rows == 20


def test_the_units_are_in_the_file_too(tmp_path: Path) -> None:
    pq.write_table(record().to_arrow(), tmp_path / "history.parquet")
    assert pq.read_schema(tmp_path / "history.parquet").field("yaw_rad").metadata == {b"unit": b"rad"}


def test_the_data_frame_has_the_units_in_its_attributes() -> None:
    pytest.importorskip("pandas")
    history = record()
    table = history.to_pandas()
    assert list(table.columns) == list(FRAME.names or ())
    assert table.attrs["units"]["velocity_x_mps"] == "m/s"
    np.testing.assert_array_equal(table["x_m"].to_numpy(), history.frames["x_m"])


def test_events_are_tables_too() -> None:
    pytest.importorskip("pandas")
    history = record()
    assert history.to_pandas("collisions")["impulse_x_ns"].tolist() == [100.0]
    assert history.to_pandas("collisions").attrs["units"]["impulse_x_ns"] == "N s"
    assert history.to_pandas("lane_invasions")["marking"].tolist() == ["Solid/White", "Broken/White"]
    assert len(history.to_pandas("others")) == 0


def test_an_unknown_table_gets_a_sentence() -> None:
    with pytest.raises(UserError, match="no table 'other'; there are frames, others, collisions, lane_invasions"):
        record().to_pandas("other")


def test_without_pandas_there_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(UserError, match=r"pandas is not installed; install it, or use to_arrow\(\)"):
        record().to_pandas()
