"""Claims about the map and the timeline: things stand where and when they happened."""

import re

import numpy as np
import pytest

from basu.errors import UserError
from basu.output.report.events import events
from basu.output.report.plots.signals import signals
from basu.output.report.plots.timeline import timeline
from basu.output.report.plots.town_map import town_map
from basu.output.report.streets import Streets, around, bounds_of, read_streets, union, write_streets
from basu.output.report.templates import html
from basu.records.history import LaneInvasion
from basu.routing.lane_graph import Street
from fakes.drives import at, driven
from fakes.run_records import STREETS, crashing, record


def test_a_mark_stands_where_the_infraction_was() -> None:
    history = crashing()
    run = record(history)
    page = html(town_map(history, STREETS, events(run.result)))
    bounds = bounds_of(history)
    found = re.search(r'<a href="#infraction-3"[^>]*style="left:([\d.]+)%;top:([\d.]+)%', page)
    assert found is not None
    x_m = bounds.west_m + float(found[1]) / 100.0 * bounds.width_m
    assert x_m == pytest.approx(run.result.infractions[2].x_m, abs=0.01)
    assert float(found[2]) == pytest.approx(50.0)


def test_marks_at_one_place_do_not_hide_each_other() -> None:
    history = crashing()
    run = record(history)
    three = [events(run.result)[0]] * 3
    heights = re.findall(r"--up:(\d+)px", html(town_map(history, STREETS, three)).split('class="at mark"', 1)[1])
    assert heights == ["0", "22", "44"]


def test_streets_far_from_the_run_are_left_out_and_straight_ones_thinned() -> None:
    history = driven(at(8.0, 25.0))
    near = np.column_stack([np.linspace(-30.0, 230.0, 200), np.full(200, 5.0)])
    far = near + np.array([0.0, 500.0])
    found = around([Street(near, "E 15th Ave"), Street(near, "Road 12"), Street(far, "Far Street")], history)
    assert found == Streets([[(-30.0, 5.0), (230.0, 5.0)]] * 2, ["E 15th Ave", ""])
    assert around([Street(near, "E 15th Ave")], None) == Streets([], [])


def test_streets_come_back_from_their_file(tmp_path) -> None:
    write_streets(tmp_path, STREETS)
    assert read_streets(tmp_path) == STREETS


def test_a_folder_without_streets_has_none(tmp_path) -> None:
    assert read_streets(tmp_path) == Streets([], [])


def test_streets_of_an_earlier_version_have_no_names(tmp_path) -> None:
    (tmp_path / "streets.json").write_text('{"lanes_m": [[[1, 2], [3, 4]]]}')
    assert read_streets(tmp_path) == Streets([[(1.0, 2.0), (3.0, 4.0)]], [""])


def test_a_broken_file_of_streets_is_refused(tmp_path) -> None:
    (tmp_path / "streets.json").write_text('{"lanes_m": [[1]]}')
    with pytest.raises(UserError, match=r"streets\.json is no map of streets"):
        read_streets(tmp_path)


def test_the_union_holds_both() -> None:
    one, other = bounds_of(driven(at(8.0, 5.0))), bounds_of(driven(at(8.0, 25.0), lateral_m=90.0))
    both = union([one, other])
    assert both.south_m == other.south_m
    assert both.north_m == min(one.north_m, other.north_m)


def test_the_timeline_tells_signs_run_standing_and_lines_crossed() -> None:
    history = crashing()
    run = record(history)
    page = html(timeline(history, signals(history), run.result, events(run.result)))
    assert "stop sign 7 run" in page
    assert "standing from 6.7 s to 26.6 s" in page
    assert 'href="#infraction-1"' in page


def test_a_lane_line_crossed_is_a_stroke() -> None:
    history = driven(at(8.0, 25.0), lane_invasions=[LaneInvasion(tick=100, markings=("Solid/White",))])
    run = record(history)
    page = html(timeline(history, signals(history), run.result, ()))
    assert 'title="Solid/White at 5.0 s"' in page
