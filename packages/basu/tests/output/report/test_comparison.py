"""Claims about comparisons: the columns of table 5.1, one frame for one route, a sentence for several."""

import re
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Browser

from basu.cli import main
from basu.output.report.comparison import reasons, remarks, rows, text
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
    assert line.split().count("\u2013") == 4  # "not completed" stands in the place of the driving score
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


def test_conditions_that_differ_are_named_with_their_values() -> None:
    one, other = record(crashing(), agent="one"), record(crashing(), agent="other")
    other.result.meta.update(weather="HardRainNoon", seed=3, traffic={"vehicles": 30, "walkers": 0})
    (remark,) = remarks([one, other])
    assert "weather ClearNoon (one), HardRainNoon (other); seed 0 (one), 3 (other)" in remark
    assert "vehicles of the traffic 0 (one), 30 (other)" in remark
    assert "walkers" not in remark


def test_the_speeds_of_all_runs_have_common_axes(tmp_path: Path) -> None:
    slow, fast = record(driven(at(8.0, 25.0)), agent="slow"), record(driven(at(16.0, 12.0)), agent="fast")
    folders = [written(tmp_path / "slow", slow), written(tmp_path / "fast", fast)]
    assert main(["compare", *map(str, folders), "-o", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "compare.html").read_text()
    axes = [re.findall(r'class="height"[^>]*>[^<]*', part) for part in page.split("<figcaption>")[1:]]
    drawn = [each for each in axes if each]
    assert len(drawn) == 2
    assert drawn[0] == drawn[1]


@pytest.mark.parametrize("number", [2, 6])
def test_the_page_is_no_wider_than_a_phone_and_breaks_no_word(browser: Browser, tmp_path: Path, number: int) -> None:
    folders = [str(written(tmp_path / str(n), record(driven(at(8.0, 5.0)), agent=f"agent{n}"))) for n in range(number)]
    assert main(["compare", *folders, "-o", str(tmp_path)]) == 0
    for width in (390, 1280):
        page = browser.new_page(viewport={"width": width, "height": 800})
        page.goto((tmp_path / "compare.html").as_uri())
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        name = page.get_by_role("link", name="agent1") if page.get_by_role("link", name="agent1").count() else None
        cell = name or page.locator("th", has_text="agent1")
        assert cell.first.evaluate("node => node.getClientRects().length && node.offsetHeight") < 40  # one line
        page.close()


def test_escape_sequences_of_an_agents_name_do_not_reach_the_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = written(tmp_path / "bad", record(crashing(), agent="evil\x1b[2J\x07\x9b1m"))
    good = written(tmp_path / "good", record(crashing(), agent="good"))
    assert main(["compare", str(bad), str(good)]) == 0
    shown = capsys.readouterr().out
    assert "evil" in shown
    assert not any(character in shown for character in "\x1b\x07\x9b")


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


def test_a_run_that_failed_has_its_reasons_below_the_table() -> None:
    said = reasons([record(crashing()), record(driven(at(8.0, 25.0)))])
    assert [each.split(":")[0] for each in said] == ["tester (1) failed"]
    assert "ran stop sign 7 at " in said[0]
