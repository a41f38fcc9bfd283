"""Claims about comparisons: the columns of table 5.1, one frame for one route, a sentence for several."""

from pathlib import Path

import pytest
from PIL import Image

from basu.cli import main
from basu.output.report.comparison import remarks, rows, text
from fakes.drives import at, driven, straight_route
from fakes.run_records import crashing, record, written


def test_the_table_counts_what_table_5_1_counts() -> None:
    bad, good = rows([record(crashing(), agent="bad"), record(driven(at(8.0, 25.0)), agent="good")])
    counted = ("collisions", "collisions at fault", "stop signs", "red lights", "speeding")
    assert [bad.cell(head) for head in counted] == ["1", "1", "1", "0", "1"]
    assert bad.cell("infraction score") == f"{0.65 * 0.8 * 0.8:.3f}"
    assert [good.cell(head) for head in (*counted, "infraction score")] == ["0", "0", "0", "0", "0", "1.000"]
    assert bad.cell("passengers") == "failed"


def test_one_agent_twice_are_distinguished() -> None:
    assert [row.agent for row in rows([record(crashing()), record(None)])] == ["tester (1)", "tester (2)"]


def test_a_run_without_a_score_has_dashes() -> None:
    line = text(rows([record(None), record(crashing())])).splitlines()[3]
    assert line.split().count("\u2013") == 5
    assert line.endswith("SetupFailed")


def test_runs_on_one_route_need_no_remark() -> None:
    assert remarks([record(crashing()), record(driven(at(8.0, 25.0)))]) == []


def test_runs_on_different_routes_are_reported_of() -> None:
    other = record(driven(at(8.0, 25.0), route=straight_route(300.0)), route="2")
    (remark,) = remarks([record(crashing()), other])
    assert "different routes (1 of Nowhere, 2 of Nowhere)" in remark


def test_routes_of_one_name_that_differ_are_reported_of() -> None:
    other = record(driven(at(8.0, 25.0), route=straight_route(300.0)))
    assert remarks([record(crashing()), other])


def test_other_rules_are_reported_of() -> None:
    other = record(crashing())
    other.result.scoring["penalties"]["speeding"] = 0.5
    (remark,) = remarks([record(crashing()), other])
    assert "different penalties or weights" in remark


def test_the_command_writes_nothing_unless_a_folder_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, other = (written(tmp_path / name, record(crashing(), agent=name)) for name in ("one", "other"))
    before = sorted(tmp_path.rglob("*"))
    assert main(["compare", str(one), str(other)]) == 0
    assert sorted(tmp_path.rglob("*")) == before
    assert "no files were written; `-o DIR` writes compare.html and compare.png there" in capsys.readouterr().out


def test_the_command_writes_page_and_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = written(tmp_path / "one", record(crashing(), agent="<b>one</b>"))
    other = written(tmp_path / "the other", record(driven(at(8.0, 25.0)), agent="other"))
    nothing = written(tmp_path / "nothing", record(None, agent="nothing"))
    assert main(["report", str(other)]) == 0
    assert main(["compare", str(one), str(other), str(nothing), "--output", str(tmp_path / "out")]) == 0
    assert "0.416" in capsys.readouterr().out
    page = (tmp_path / "out" / "compare.html").read_text()
    assert "&lt;b&gt;one&lt;/b&gt;" in page
    assert 'href="../the%20other/report.html"' in page
    assert page.count('class="planned"') == 3  # two maps and the legend
    assert Image.open(tmp_path / "out" / "compare.png").width > 600


def test_one_run_alone_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", str(tmp_path)]) == 2
    assert "name two folders or more" in capsys.readouterr().err
