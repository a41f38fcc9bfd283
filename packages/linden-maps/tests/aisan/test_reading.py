import pytest

from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden_maps.aisan.convert import convert
from linden_maps.aisan.reading import complaints, read_folder
from linden_maps.lanelet2.convert import convert as lanelets_of
from vector_map_town import two_roads


@pytest.fixture
def folder(tmp_path):
    for name, data in convert(lanelets_of(parse(two_roads())).lanelet_map).tables.files().items():
        (tmp_path / name).write_bytes(data)
    return tmp_path


def _edit(folder, name, row, column, value):
    path = folder / f"{name}.csv"
    lines = path.read_text().split("\n")
    cells = lines[row].split(",")
    cells[column] = str(value)
    lines[row] = ",".join(cells)
    path.write_text("\n".join(lines))


@pytest.mark.parametrize(
    ("name", "row", "column", "value", "sentence"),
    [
        ("lane", 1, 6, 1, "JCT 1 is wrong"),
        ("lane", 5, 3, 9, "does not say so"),
        ("lane", 5, 5, 1, "does not end at the node"),
        ("lane", 1, 4, 999999, "BNID names no row of node.csv"),
        ("dtlane", 4, 3, 0.1, "Dir of lane row 4 is off by"),
        ("area", 1, 1, 2, "no closed, consecutive chain"),
        ("whiteline", 1, 5, 999999, "LinkID names no row of lane.csv"),
        ("node", 2, 0, 1, "ids stand twice"),
    ],
)
def test_each_rule_of_the_nodes_is_checked(folder, name, row, column, value, sentence):
    assert complaints(read_folder(folder)) == []
    _edit(folder, name, row, column, value)
    try:
        found = complaints(read_folder(folder))
    except (KeyError, IndexError) as error:  # a broken reference ends the check, and never silently
        pytest.fail(f"{error!r}")
    assert any(sentence in text for text in found), found


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("NID,PID\n1,1\n\n", "line 3: is blank"),
        ("NID,PID\n1\n", "line 2: has 1 columns; 2 are needed"),
        ("NID,PID\n1,x\n", "line 2: a column is no number"),
        ("NID,PID\n2147483648,1\n", "line 2: the id 2147483648 is none from 1"),
    ],
)
def test_lines_that_end_the_loader_are_reported(folder, text, sentence):
    (folder / "node.csv").write_text(text)
    with pytest.raises(UserError, match=f"node.csv, {sentence}"):
        read_folder(folder)


def test_a_folder_without_lanes_is_no_map(tmp_path):
    with pytest.raises(UserError, match=r"no Aisan vector map: it has no point.csv"):
        read_folder(tmp_path)
