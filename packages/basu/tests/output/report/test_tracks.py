"""Claims about tracks in the reports of runs: every score has one beside it, and no table has scores of two."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from basu.cli import main
from basu.output.report.comparison import remarks, rows, text
from basu.output.report.console import table
from basu.output.report.documents import RunRecord
from basu.output.report.html.page import report
from basu.output.report.scenarios.matrix_text import matrix_text
from basu.output.report.scenarios.page.matrix_page import matrix_page
from basu.output.report.series_document import row, series_table, totals
from fakes.run_records import crashing, record, written
from fakes.scenario_documents import matrix


def access(track: str, *, is_open: bool = False, **refused: int) -> dict[str, Any]:
    return {"track": track, "open": is_open, "refused": refused}


def on_track(track: str, *, agent: str = "tester", is_open: bool = False, **refused: int) -> RunRecord:
    run = record(crashing(), agent=agent)
    meta = {**run.result.meta, "access": access(track, is_open=is_open, **refused)}
    return replace(run, result=replace(run.result, meta=meta))


def test_the_report_of_a_run_names_track_and_refused_calls() -> None:
    page = report(on_track("objects", destroy_actor=2)).decode()
    assert "track <b>objects</b>; refused calls: destroy_actor 2" in page
    assert "not comparable" not in page


def test_a_run_without_a_gate_has_that_as_its_reason() -> None:
    run = on_track("world", is_open=True)
    assert "no gate stood between the agent and the simulator (--open" in report(run).decode()
    assert "no gate stood between" in table(run.result)
    (remark,) = remarks([run, on_track("world", is_open=True, agent="other")])
    assert "tester (no gate stood between the agent and the simulator (--open" in remark
    assert "ended by a failure" not in remark


def test_runs_of_one_track_are_one_table_that_names_it() -> None:
    runs = [on_track("sensors", agent="one"), on_track("sensors", agent="two")]
    assert [row.cell("track") for row in rows(runs)] == ["sensors", "sensors"]
    assert "\n\n" not in text(rows(runs))
    assert remarks(runs) == []


def test_runs_of_different_tracks_are_tables_of_their_own_with_a_remark() -> None:
    runs = [on_track("sensors", agent="one"), on_track("world", agent="two"), on_track("sensors", agent="three")]
    written_tables = text(rows(runs)).split("\n\n")
    assert [each.splitlines()[0] for each in written_tables] == ["track sensors", "track world"]
    assert "two" not in written_tables[0]
    assert "three" in written_tables[0]
    (remark,) = remarks(runs)
    assert "(track sensors: one, three; track world: two)" in remark


def test_an_open_run_is_never_in_the_table_of_a_gated_one() -> None:
    runs = [on_track("world", agent="one"), on_track("world", agent="two", is_open=True)]
    assert "track world, NOT COMPARABLE: open\n" in text(rows(runs))
    assert len(remarks(runs)) == 2


def test_the_page_of_a_comparison_has_a_table_for_each_track(tmp_path: Path) -> None:
    runs = [on_track("sensors", agent="one"), on_track("world", agent="two", is_open=True)]
    folders = [str(written(tmp_path / run.agent, run)) for run in runs]
    assert main(["compare", *folders, "-o", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "compare.html").read_text()
    scores = page.split("<h2>Scores</h2>")[1].split("</section>")[0]
    assert scores.count("<table") == 2
    assert "<h3>track sensors</h3>" in scores
    assert "<b>two</b>, track world, NOT COMPARABLE: open: driving score" in page


def series(*runs: RunRecord) -> str:
    found = [row(run.result, number=n, repetition=n, folder=str(n)) for n, run in enumerate(runs)]
    return series_table("s", {"runs": found, "totals": totals(found, len(found))})


def test_a_series_names_its_track_and_averages_no_two_tracks() -> None:
    assert "track             world, NOT COMPARABLE: open" in series(on_track("world", is_open=True))
    assert "track             sensors\n" in series(on_track("sensors"), on_track("sensors"))
    mixed = series(on_track("sensors"), on_track("world"))
    assert "scores of different tracks are not averaged" in mixed
    assert "driving score" not in mixed


def matrix_with(tracks: dict[str, str]) -> dict[str, Any]:
    document = matrix(list(tracks))
    for case in document["cases"]:
        for agent, track in tracks.items():
            case["results"][agent]["access"] = access(track)
    return document


def test_a_matrix_has_a_table_for_each_track_with_a_sentence() -> None:
    document = matrix_with({"one": "sensors", "two": "world", "three": "sensors"})
    for found in (matrix_text(document), matrix_page(document, lambda _: "nothing").decode()):
        assert "each track has a table of its own" in " ".join(found.split())
    heads = [line.split() for line in matrix_text(document).splitlines() if line.startswith(" " * 30)]
    assert heads[:2] == [["one", "three"], ["two"]]
    page = matrix_page(document, lambda _: "nothing").decode().split("<h2>Matrix</h2>")[1].split("</section>")[0]
    assert page.count('<table class="matrix">') == 2
    assert "<h3>track sensors</h3>" in page


def test_a_matrix_of_one_track_names_it() -> None:
    document = matrix_with({"one": "objects", "two": "objects"})
    assert "\ntrack objects\n" in matrix_text(document)
    assert "own" not in matrix_text(document).split("track objects")[0]
    assert matrix_page(document, lambda _: "nothing").decode().count("<h3>track objects</h3>") >= 1
