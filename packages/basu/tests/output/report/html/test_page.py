"""Claims about report.html as a file: self-contained, small, quick to write, the same for the same run."""

import re
import time
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from basu.cli import main
from basu.output.report.html.page import report
from basu.output.report.html.score_card import rows
from basu.output.report.templates import e, html
from basu.records.history.sumo import Passenger, Second, SumoRecord
from basu.routing import Stop
from fakes.drives import at, driven, ramp, straight_route
from fakes.run_records import crashing, record, written


def test_nothing_in_it_points_outside() -> None:
    page = report(record(crashing())).decode()
    assert not re.findall(r'(?:src|href)="(?!#)', page)
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "@import" not in page
    assert "url(" not in page


def test_the_browser_is_reported_to_ask_no_actor() -> None:
    page = report(record(crashing())).decode()
    assert "default-src 'none'" in page
    assert "unsafe-inline'; script-src 'sha256-" in page


def test_the_same_run_gives_the_same_bytes() -> None:
    assert report(record(crashing())) == report(record(crashing()))


def test_the_score_card_shows_how_the_score_came_about() -> None:
    page = report(record(crashing())).decode()
    assert "0.416" in page  # 0.65 x 0.8 x 0.8, the infraction score
    assert "collision static" in page


def test_the_leaderboard_and_the_passengers_judge_the_same_drive_beside_it() -> None:
    run = record(crashing())
    page = report(run).decode()
    assert f"{run.result.metrics['leaderboard']['2.1']['driving']:.3f}" in page
    assert '<b class="status agent">failed</b>' in page
    assert html(e("li", run.result.metrics["passengers"]["reasons"][0])) in page


def test_a_result_without_them_has_a_report_too() -> None:
    run = record(crashing())
    metrics = {**run.result.metrics, "leaderboard": None, "passengers": None}
    run = replace(run, result=replace(run.result, metrics=metrics))
    assert b"Timeline" in report(run)


def test_a_run_in_which_nothing_was_driven_has_a_report_that_says_so() -> None:
    page = report(record(None, message="no such vehicle")).decode()
    assert "Nothing was driven, so there is no score." in page
    assert "no such vehicle" in page
    assert "<script>" not in page


def test_a_run_of_one_tick_has_a_report() -> None:
    assert b"Timeline" in report(record(driven([0.0])))


@pytest.mark.parametrize("name", ["x_m", "y_m", "yaw_rad", "velocity_x_mps", "lane_offset_m", "speed_limit_mps"])
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_a_simulator_that_lost_the_vehicle_does_not_cost_the_report(name: str, value: float) -> None:
    history = crashing()
    run = record(history)
    history.frames[name][200:210] = value
    with np.errstate(all="ignore"):
        assert b"Timeline" in report(run)


def test_a_round_of_the_shuttle_is_small_and_written_within_a_second() -> None:
    rng = np.random.default_rng(5)
    speeds = np.concatenate([ramp(0.0, 8.0, 5.0) + at(8.0, 20.0) + ramp(8.0, 0.0, 5.0) + at(0.0, 7.0)] * 30)
    history = driven((speeds + rng.normal(size=len(speeds)) * 0.05).tolist(), route=straight_route(7000.0))
    run = record(history)
    assert len(history.frames) > 22_000
    began = time.process_time()
    page = report(run)
    assert time.process_time() - began < 2.0  # 0.4 s on a machine of its own
    assert len(page) < 1_500_000


def test_the_command_writes_it_again_from_the_folder_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = record(crashing())
    folder = written(tmp_path / "run", run)
    assert main(["report", str(folder)]) == 0
    assert (folder / "report.html").read_bytes() == report(run)
    assert str(folder / "report.html") in capsys.readouterr().out


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (lambda folder: (folder / "result.json").unlink(), "result.json cannot be read"),
        (lambda folder: (folder / "config.json").write_text("{"), "is no JSON"),
        (lambda folder: (folder / "config.json").write_text("[]"), "holds no JSON object"),
    ],
)
def test_a_folder_that_is_no_runs_is_refused(tmp_path: Path, capsys, spoil, sentence: str) -> None:
    folder = written(tmp_path / "run", record(crashing()))
    spoil(folder)
    assert main(["report", str(folder)]) == 2
    assert sentence in capsys.readouterr().err


def test_a_place_that_is_no_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(tmp_path / "nowhere")]) == 2
    assert "is no folder; name a run's" in capsys.readouterr().err


def test_figures_get_names_and_units_from_their_keys() -> None:
    found = rows({"top_speed_mps": 9.5, "served": True, "comfort": {"jerk_max_mps3": None}, "kinds": ["a_b", "c"]})
    assert [tuple(row) for row in found] == [
        ("top speed", "9.500 m/s"),
        ("served", "yes"),
        ("comfort: jerk max", "\u2013"),
        ("kinds", "a_b, c"),
    ]


def test_a_run_amid_sumo_s_traffic_shows_its_load_and_the_riders_of_each_stop() -> None:
    stop = Stop(id="A", name="a stop", s_m=50.0, x_m=50.0, y_m=0.0, z_m=0.0, yaw_rad=0.0)
    seconds = (Second(1.0, vehicles=12, people=3, halted=1, driven_m=100.0, lost_s=2.0),)
    riders = (Passenger("one", "A", "B", came_s=0.0, boarded_s=11.0), Passenger("two", "A", "B", came_s=1.0))
    counts = {"departed": 12, "arrived": 0, "delayed": 0, "hidden": 0, "people": 3, "contacts": 0}
    traffic = SumoRecord(**counts, seconds=seconds, passengers=riders)
    drive = driven([*at(5.0, 10.0), *at(0.0, 10.0), *at(5.0, 20.0)], route=straight_route(stops=(stop,)))
    page = report(record(replace(drive, sumo=traffic))).decode()
    assert "<h2>SUMO's traffic</h2>" in unescape(page)
    assert "20.000" in page, "2 s lost on 100 m are 20 s on a km"
    assert "left behind" in page
    assert '<section id="sumo">' not in report(record(drive)).decode(), "a run without SUMO has no such section"
    assert "left behind" not in report(record(drive)).decode()


def test_the_evidence_of_a_missed_stop_shows_the_line_and_the_sign() -> None:
    page = report(record(crashing())).decode()
    drawn = re.findall(
        r'<title>stop sign \S*</title><path d="M[^"]*" class="stop-line( broken)?">.*?<polygon points="([^"]*)"', page
    )
    assert all(len(sign.split()) == 8 for _, sign in drawn), "octagons"
    assert [broken for broken, _ in drawn].count(" broken") == 1, "red where the sign was missed, and nowhere else"
