"""Claims about `basu index`: everything below a folder is on one page, and trends between versions cannot be gamed."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.output.report.documents import RESULT_FILE, write_json
from basu.output.report.index.found import contents
from basu.output.report.index.trends import Trend, trends
from basu.records.history import History
from fakes.drives import at, driven
from fakes.run_records import crashing, record, written

GOOD, BAD = driven(at(8.0, 25.0)), crashing()


def left(
    folder: Path,
    history: History,
    started: str,
    *,
    version: str = "",
    status: Status = Status.COMPLETED,
    **meta: Any,
) -> Path:
    """Write the folder of a run of an agent's file with this SHA-256."""
    run = record(history)
    told = {**run.result.meta, "started": started, "seed": 0, "own_route": False, **meta}
    config = {**run.config, "scoring": dict(run.result.scoring)}
    config["files"] = [{"path": "agents/tester.py", "sha256": version * 8}] if version else []
    return written(folder, replace(run, config=config, result=judge(Outcome(status, "as told"), history, meta=told)))


def only(folder: Path) -> Trend:
    """Return the one trend below a folder."""
    (found,) = trends(contents(folder, lambda: None).all_runs)
    return found


def test_versions_of_an_agent_stand_in_the_order_of_their_first_runs_with_the_change(tmp_path: Path) -> None:
    left(tmp_path / "b", GOOD, "2026-01-02", version="bbbbbbb")
    left(tmp_path / "a", BAD, "2026-01-01", version="aaaaaaa")
    left(tmp_path / "c", GOOD, "2026-01-03", version="bbbbbbb")
    old, new = only(tmp_path).versions
    assert (old.version, new.version) == ("file aaaaaaa", "file bbbbbbb")
    assert (old.runs, new.runs) == (1, 2)
    assert new.change == pytest.approx(new.driving - old.driving)
    assert new.change > 0.0
    assert old.infractions_per_km is not None
    assert old.infractions_per_km > 10.0


def test_an_agent_that_crashes_where_it_would_drive_badly_gains_nothing(tmp_path: Path) -> None:
    left(tmp_path / "a", GOOD, "2026-01-01", version="aaaaaaa")
    left(tmp_path / "b", BAD, "2026-01-02", version="aaaaaaa")
    left(tmp_path / "c", GOOD, "2026-01-03", version="bbbbbbb")
    left(tmp_path / "d", GOOD.window(0, 40), "2026-01-04", version="bbbbbbb", status=Status.AGENT_CRASHED)
    honest, crasher = only(tmp_path).versions
    assert crasher.runs == 2
    assert crasher.driving < honest.driving


def test_what_simulator_or_setup_ended_and_what_no_gate_guarded_is_in_no_trend(tmp_path: Path) -> None:
    left(tmp_path / "a", BAD, "2026-01-01", status=Status.SIMULATOR_FAILED)
    left(tmp_path / "d", BAD, "2026-01-04", status=Status.STOPPED)
    left(tmp_path / "b", GOOD, "2026-01-02", access={"track": "world", "open": True, "refused": {}})
    left(tmp_path / "c", GOOD, "2026-01-03", own_route=True)
    found = contents(tmp_path, lambda: None)
    assert len(found.runs) == 4
    assert trends(found.all_runs) == []


def test_other_conditions_are_another_trend_and_other_seeds_are_named(tmp_path: Path) -> None:
    left(tmp_path / "a", GOOD, "2026-01-01", version="aaaaaaa")
    left(tmp_path / "b", GOOD, "2026-01-02", version="bbbbbbb", seed=7)
    left(tmp_path / "c", GOOD, "2026-01-03", version="bbbbbbb", weather="HardRainNoon")
    first, rain = trends(contents(tmp_path, lambda: None).all_runs)
    assert first.seeds_differ
    assert [version.version for version in rain.versions] == ["file bbbbbbb"]


def test_series_scenario_runs_campaigns_and_comparisons_have_their_pages(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    left(tmp_path / "alone", BAD, "2026-01-02")
    (tmp_path / "alone" / "report.html").write_text("the report")
    (tmp_path / "latest").symlink_to(tmp_path / "alone")
    left(tmp_path / ".draft.part", BAD, "2026-01-02")
    left(tmp_path / "often" / "0001", GOOD, "2026-01-01")
    spread = {"mean": 0.9, "deviation": 0.01, "lowest": 0.9, "highest": 0.9}
    totals = {"done": 1, "planned": 2, "scores": {"driving": spread}, "passed": {"passed": 1}}
    write_json(tmp_path / "often" / "series.json", {"runs": [{"folder": "0001"}], "totals": totals})
    cases = [{"results": {"basic": {"verdict": verdict}}} for verdict in ("SUCCESS", "FAILURE", "NOT_EXERCISED")]
    (tmp_path / "cases").mkdir()
    write_json(tmp_path / "cases" / "matrix.json", {"agents": ["basic"], "cases": cases})
    (tmp_path / "cases" / "matrix.html").write_text("the matrix")
    (tmp_path / "many").mkdir()
    write_json(tmp_path / "many" / "campaign.json", {"name": "night", "planned": 9, "agents": ["basic"]})
    (tmp_path / "beside").mkdir()
    (tmp_path / "beside" / "compare.html").write_text("two runs")
    assert main(["index", str(tmp_path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "index.html")
    page = (tmp_path / "index.html").read_text()
    assert "1 run, 1 series, 1 scenario run, 1 campaign, 1 comparison" in page
    assert 'href="alone/report.html?index=../index.html"' in page
    assert 'href="alone/report.html?index=../index.html#configuration"' in page
    assert "1 of 2 runs done; driving score 0.900 ± 0.010; 1 passed" in page
    assert '<a href="cases/matrix.html">cases</a>: basic: 1 of 2 judged cases passed, 3 played' in page
    assert "night: 9 drives planned; agents: basic" in page
    assert 'href="beside/compare.html"' in page
    assert page.count('<a href="#agent-1">') == 2, "the run by itself and that of the series, and no draft or link"
    again = (tmp_path / "index.html").read_bytes()
    assert main(["index", str(tmp_path)]) == 0
    assert (tmp_path / "index.html").read_bytes() == again


def test_what_cannot_be_read_is_named_and_the_rest_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    left(tmp_path / "good", GOOD, "2026-01-01")
    left(tmp_path / "cut", GOOD, "2026-01-01")
    (tmp_path / "cut" / RESULT_FILE).write_bytes((tmp_path / "cut" / RESULT_FILE).read_bytes()[:90])
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases" / "matrix.json").write_text(json.dumps({"agents": 3}))
    assert main(["index", str(tmp_path)]) == 0
    said = capsys.readouterr().err
    assert str(tmp_path / "cut" / RESULT_FILE) in said
    assert f"{tmp_path / 'cases'}: its documents are damaged" in said
    page = (tmp_path / "index.html").read_text()
    assert "1 run" in page
    assert "Not read" in page


def test_names_of_others_are_text(tmp_path: Path) -> None:
    hostile = "<script>alert(1)</script>"
    left(tmp_path / "a", GOOD, "2026-01-01", agent={"name": hostile, "class": "T", "file": "t.py"}, weather=hostile)
    assert main(["index", str(tmp_path)]) == 0
    assert hostile not in (tmp_path / "index.html").read_text()


def test_a_folder_that_is_not_there_gets_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["index", str(tmp_path / "none")]) == 2
    assert "is no folder; name one with results, such as runs" in capsys.readouterr().err
