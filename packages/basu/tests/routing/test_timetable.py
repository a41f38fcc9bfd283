"""Claims about timetables: the one that comes with the LEAP route, when rounds begin, and the errors of bad files."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from basu.errors import UserError
from basu.records.history.files import route_from_json, route_to_json
from basu.routing.route_file import read_routes
from basu.routing.timetable import read_timetable, timetable_from_json, timetable_to_json
from fakes.drives import straight_route

LEAP = Path(__file__).parents[4] / "packages" / "basu" / "src" / "basu" / "routes" / "linden_leap.timetable.json"
STOPS = ("S1", "S2N", "S3E", "S4", "S3W", "S2S")


def test_leap_pauses_at_school_times_on_weekdays_alone() -> None:
    leap = read_timetable(LEAP, STOPS)
    monday, sunday = leap.departures_s("Mon"), leap.departures_s("Sun")
    assert [t for t in monday if 8.0 * 3600 <= t < 9.5 * 3600 or 14.0 * 3600 <= t < 15.5 * 3600] == []
    assert (monday[0], monday[1] - monday[0]) == (6.0 * 3600, 720.0)
    assert max(monday) < 20.0 * 3600
    assert len(sunday) == 14 * 5
    assert len(monday) == 10 + 23 + 23  # two hours, and twice four and a half


def test_leap_is_round_in_24_minutes_with_20_seconds_at_each_stop() -> None:
    leap = read_timetable(LEAP, STOPS)
    assert leap.round_s == 1440.0
    assert [call.departure_s - call.arrival_s for call in leap.calls] == [20.0] * 6


def test_a_timetable_reads_back_as_it_was_written() -> None:
    leap = read_timetable(LEAP, STOPS)
    assert timetable_from_json(timetable_to_json(leap)) == leap


def changed(path: tuple[Any, ...], value: object) -> dict[str, Any]:
    """The LEAP timetable with one thing changed; ``None`` takes it out."""
    document = json.loads(LEAP.read_text(encoding="utf-8"))
    place = document
    for key in path[:-1]:
        place = place[key]
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return document


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        (("headway",), None, "lacks 'headway'"),
        (("headway",), "12", "the headway is '12'; write two numbers with a colon"),
        (("headway",), "00:00", "the headway is 0"),
        (("schema_version",), 7, "schema_version is 7"),
        (("service", 0, "days"), ["Monday"], "'Monday' is no day; write one of Mon, Tue"),
        (("service", 0, "days"), "Mon", "write a list such as"),
        (("service", 0, "to"), "05:00", "from 06:00 to 05:00, which is not later"),
        (("run", "departure"), "09:31", "no round departs on Mon at 09:31"),
        (("run", "departure"), "14:30", "no round departs on Mon at 14:30"),
        (("calls", 2, "arrival"), "03:00", "the call at S3E (03:00 to 06:50) does not lie between"),
        (("calls", 0, "stop"), "S9", "calls at 'S9', which is no stop of its route; it has S1, S2N"),
    ],
)
def test_a_mistake_is_reported_with_the_file_and_the_place(
    tmp_path: Path, path: tuple[Any, ...], value: object, sentence: str
) -> None:
    file = tmp_path / "mine.json"
    file.write_text(json.dumps(changed(path, value)), encoding="utf-8")
    with pytest.raises(UserError) as told:
        read_timetable(file, STOPS)
    assert str(told.value).startswith(f"the timetable {file}")
    assert sentence in str(told.value)


def test_the_leap_route_brings_its_timetable_and_the_record_keeps_it() -> None:
    (route,) = read_routes(LEAP.with_name("linden_leap.xml"))
    assert route.timetable == read_timetable(LEAP, STOPS)
    planned = replace(straight_route(), timetable=route.timetable)
    assert route_from_json(json.loads(json.dumps(route_to_json(planned)))).timetable == route.timetable
    assert route_from_json(route_to_json(straight_route())).timetable is None


def test_a_route_with_a_timetable_is_not_there_says_so(tmp_path: Path) -> None:
    points = '<waypoint x="0" y="0"/><waypoint x="9" y="0"/>'
    file = tmp_path / "mine.xml"
    file.write_text(f'<routes><route id="0" town="T" timetable="none.json">{points}</route></routes>', encoding="utf-8")
    with pytest.raises(UserError, match=r"the timetable .*none\.json cannot be read"):
        read_routes(file)


def test_a_file_that_is_not_there_or_no_json_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        read_timetable(tmp_path / "none.json", STOPS)
    (tmp_path / "text.json").write_text("06:00", encoding="utf-8")
    with pytest.raises(UserError, match="is no JSON"):
        read_timetable(tmp_path / "text.json", STOPS)
