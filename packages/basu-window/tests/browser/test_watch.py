"""Claims about `basu watch`: frames, marks and panels from records, ghosts, and what bad folders get."""

import argparse
import gzip
import json
from pathlib import Path

import numpy as np
import pytest

from basu.errors import UserError
from basu.metrics.score import infractions, score
from basu.metrics.scoring import Scoring
from basu.records.history.files import HISTORY_FILE
from basu_window.browser.frames import EGO_ID, RUN_IDS, mark_of, record_frames
from basu_window.browser.watch import MOST_RUNS, map_text, panels_of, run
from fakes.run_records import crashing, record, written
from linden_window.poses import HEADER, POSE


def frames_of(content: bytes) -> list[tuple[float, np.ndarray]]:
    data, at, found = gzip.decompress(content), 0, []
    while at < len(data):
        _, _, t_s, count, _ = HEADER.unpack_from(data, at)
        at += HEADER.size
        found.append((t_s, np.frombuffer(data, POSE, count, at)))
        at += count * POSE.itemsize
    return found


def test_each_tick_of_the_record_is_a_frame_at_its_place_and_time() -> None:
    history = crashing()
    frames = frames_of(record_frames([history]))
    assert len(frames) == len(history.frames)
    for tick in (0, 50, 200):
        t_s, rows = frames[tick]
        assert t_s == pytest.approx(tick * 0.05)
        assert (rows["id"][0], rows["place"][0, 0]) == (EGO_ID, pytest.approx(history.frames["x_m"][tick], abs=1e-3))
        assert rows["speed"][0] == pytest.approx(100.0 * history.speed_mps()[tick], abs=1.0)


def test_a_second_run_is_a_ghost_beside_the_first_and_stays_at_its_end() -> None:
    long, short = crashing(), crashing().window(0, 100)
    frames = frames_of(record_frames([long, short]))
    assert len(frames) == len(long.frames)
    last = frames[-1][1]
    assert last["id"].tolist() == [EGO_ID, EGO_ID + RUN_IDS]
    assert last["ghost"].tolist() == [0, 1]
    assert last["place"][1, 0] == pytest.approx(short.frames["x_m"][-1], abs=1e-3)


def test_marks_and_panels_say_what_the_judgement_says() -> None:
    history = crashing()
    marks = [mark_of(each) for each in infractions(history)]
    assert {"stop sign", "collision static", "speeding"} <= {mark["text"].partition(":")[0] for mark in marks}
    assert all(0.0 <= mark["t"] <= 27.0 for mark in marks)
    panels = panels_of(history, Scoring(), "a run")
    assert [panel["t"] for panel in panels] == sorted(panel["t"] for panel in panels)
    assert panels[-1]["large"] == f"{score(history, Scoring()).driving:.3f}"
    assert json.loads(json.dumps(panels)) == panels
    assert panels[0]["found"] == []
    assert len(panels[-1]["found"]) == len(marks)


def arguments(*runs: Path) -> argparse.Namespace:
    return argparse.Namespace(runs=list(runs), map=None, port=0, film=None, at=None)


def test_a_cut_record_gets_a_sentence(tmp_path: Path) -> None:
    folder = written(tmp_path / "a", record(crashing()))
    content = (folder / HISTORY_FILE).read_bytes()
    for kept in (0, 10, len(content) // 2, len(content) - 1):
        (folder / HISTORY_FILE).write_bytes(content[:kept])
        with pytest.raises(UserError, match=r"record that this version cannot read|no run folder"):
            run(arguments(folder))


def test_no_folder_and_too_many_runs_get_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no run folder"):
        run(arguments(tmp_path / "none"))
    with pytest.raises(UserError, match="at most 8 runs"):
        run(arguments(*[tmp_path] * (MOST_RUNS + 1)))


def test_a_folder_of_runs_names_one_of_them(tmp_path: Path) -> None:
    for name in ("b", "a"):
        written(tmp_path / "series" / name, record(crashing()))
    (tmp_path / "series" / "latest").symlink_to("b")
    with pytest.raises(UserError, match=r"series holds 2 runs; name up to 8 of them, such as .*/series/a$"):
        run(arguments(tmp_path / "series"))


def test_a_run_on_a_map_that_is_not_there_names_the_option(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="name its OpenDRIVE file"):
        map_text(tmp_path, None, "Nowhere")
    with pytest.raises(UserError, match="cannot be read"):
        map_text(tmp_path, tmp_path / "none.xodr", "Nowhere")


def test_a_moment_outside_of_the_run_gets_a_sentence(tmp_path: Path) -> None:
    folder = written(tmp_path / "a", record(crashing()))
    given = arguments(folder)
    for at in (-1.0, 1000.0, float("nan")):
        given.at = at
        with pytest.raises(UserError, match=r"the run lasts from 0 to 26\.6 s of simulated time"):
            run(given)
