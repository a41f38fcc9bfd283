"""Claims about SUMO's traffic in a result: load, delay, encounters, passengers; and about its file."""

from dataclasses import replace
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.metrics.passengers.service import service
from basu.metrics.registry import Drive
from basu.metrics.scoring import Scoring
from basu.metrics.sumo_traffic import SumoTraffic
from basu.outcome import Outcome, Status
from basu.records.history import History
from basu.records.history.files import read_history, write_history
from basu.records.history.sumo import SUMO_FILE, Passenger, Second, SumoRecord
from basu.routing import Stop
from fakes.drives import at, driven, straight_route

SECONDS = (
    Second(1.0, vehicles=10, people=4, halted=1, driven_m=100.0, lost_s=1.0),
    Second(2.0, vehicles=20, people=6, halted=5, driven_m=100.0, lost_s=3.0),
)
STOPS = tuple(
    Stop(id=name, name="", s_m=s_m, x_m=s_m, y_m=0.0, z_m=0.0, yaw_rad=0.0) for name, s_m in (("A", 50.0), ("B", 150.0))
)
PASSENGERS = (
    Passenger("on time", "A", "B", came_s=0.0, boarded_s=12.0, alighted_s=40.0),
    Passenger("too late", "A", "B", came_s=15.0),
    Passenger("after it left", "A", "B", came_s=60.0),
    Passenger("no stop", "B", "A", came_s=1.0),
)


def record(passengers: tuple[Passenger, ...] = PASSENGERS) -> SumoRecord:
    return SumoRecord(
        departed=30, arrived=7, delayed=1, hidden=2, people=9, contacts=0, seconds=SECONDS, passengers=passengers
    )


def ride() -> History:
    """50 m at 5 m/s, 10 s at stop A, and on past stop B without a stop."""
    speeds = [*at(5.0, 10.0), *at(0.0, 10.0), *at(5.0, 25.0)]
    return replace(driven(speeds, route=straight_route(200.0, stops=STOPS)), sumo=record())


def figures(history: History) -> dict[str, object]:
    drive = Drive(history=history, scoring=Scoring(), outcome=Outcome(Status.COMPLETED, ""))
    return SumoTraffic().compute(drive) or {}


def test_load_and_delay_are_means_of_the_seconds() -> None:
    found = figures(ride())
    assert found["vehicles"] == {
        "mean": 15.0, "most": 20, "departed": 30, "arrived": 7, "delayed": 1, "hidden": 2, "met": 0
    }  # fmt: skip
    assert found["people"] == {"mean": 5.0, "most": 6, "met": 0}
    assert found["mean_speed_mps"] == pytest.approx(200.0 / 30.0)
    assert found["halted_share"] == pytest.approx(6 / 30)
    assert found["lost_s_per_km"] == pytest.approx(20.0)
    assert found["passengers"] == {"came": 4, "boarded": 1, "alighted": 1, "mean_wait_s": 12.0}


def test_a_run_without_sumo_has_no_figures_and_no_passengers() -> None:
    alone = replace(ride(), sumo=None)
    assert figures(alone) == {}
    assert {visit.waiting for visit in service(alone)} == {None}


def test_a_record_of_no_time_has_no_means() -> None:
    empty = replace(ride(), sumo=replace(record(()), seconds=()))
    found = figures(empty)
    assert (found["mean_speed_mps"], found["halted_share"], found["lost_s_per_km"]) == (None, None, None)


def test_the_service_counts_passengers_at_each_stop() -> None:
    first, second = service(ride())
    assert (first.waiting, first.boarded, first.left_behind, first.alighted) == (2, 1, 1, 0)
    assert first.mean_wait_s == 12.0
    assert (second.waiting, second.boarded, second.left_behind, second.alighted) == (1, 0, 1, 1)
    assert second.mean_wait_s is None


def test_the_record_is_written_and_read_back_whole(tmp_path: Path) -> None:
    history = ride()
    write_history(tmp_path, history)
    before = (tmp_path / SUMO_FILE).read_bytes()
    read = read_history(tmp_path)
    assert read.sumo == history.sumo
    write_history(tmp_path, read)
    assert (tmp_path / SUMO_FILE).read_bytes() == before
    (tmp_path / SUMO_FILE).unlink()
    assert read_history(tmp_path).sumo is None


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("rubbish", r"SUMO's record .*sumo\.json is no JSON"),
        ("{}", r"sumo\.json holds a record that this version cannot read: KeyError"),
        ('{"schema_version": 9}', r"sumo\.json has the schema version 9, and this version of basu reads 1"),
    ],
)
def test_a_record_that_is_none_is_refused_in_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    write_history(tmp_path, ride())
    (tmp_path / SUMO_FILE).write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_history(tmp_path)
