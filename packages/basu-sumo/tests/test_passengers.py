"""Claims about passengers: they wait, board one after the other, alight, walk on, or are left behind."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from basu.metrics.passengers.service import ONE_BOARDS_S
from basu_sumo.link import Link, in_process
from basu_sumo.passengers import Passengers

STEP_S = 0.05


@pytest.fixture
def link(walked: Path) -> Iterator[Link]:
    link = in_process(walked / "walk.sumocfg", step_s=STEP_S, seed=0)
    yield link
    link.close()


class Ride:
    """A shuttle that only says which stop it serves."""

    def __init__(self, link: Link) -> None:
        self.link, self.passengers, self.t_s = link, Passengers(link, ["S1", "S2", "elsewhere"]), 0.0

    def go_on(self, time_s: float, served: str | None) -> None:
        for _ in range(round(time_s / STEP_S)):
            self.link.step()
            self.passengers.tick(self.t_s, served)
            self.t_s += STEP_S

    def names(self, of: str) -> list[str]:
        found = {
            "came": [each.name for each in self.passengers.found],
            "boarded": [each.name for each in self.passengers.found if each.boarded_s is not None],
            "alighted": [each.name for each in self.passengers.found if each.alighted_s is not None],
        }
        return found[of]


def test_people_wait_for_the_shuttle_and_nothing_else(link: Link) -> None:
    ride = Ride(link)
    ride.go_on(5.0, None)
    assert ride.names("came") == ["early", "second"]
    ride.go_on(20.0, None)
    assert ride.names("came") == ["early", "second", "walker"]
    assert ride.passengers.found[2].came_s > 5.0
    assert ride.names("boarded") == []


def test_passengers_board_one_after_the_other_and_leave_sumo_for_the_ride(link: Link) -> None:
    ride = Ride(link)
    ride.go_on(2.0, None)
    ride.go_on(ONE_BOARDS_S - 0.5, "S1")
    assert ride.names("boarded") == ["early"]
    assert "early" not in link.api.person.getIDList()
    assert "second" in link.api.person.getIDList()
    ride.go_on(ONE_BOARDS_S, "S1")
    assert ride.names("boarded") == ["early", "second"]
    first_s, second_s = (each.boarded_s or 0.0 for each in ride.passengers.found[:2])
    assert second_s - first_s == pytest.approx(ONE_BOARDS_S, abs=0.06)


def test_a_passenger_alights_and_walks_on_and_the_late_one_is_left_behind(link: Link) -> None:
    ride = Ride(link)
    ride.go_on(2.0, None)
    ride.go_on(6.0, "S1")
    ride.go_on(20.0, None)
    assert ride.names("came") == ["early", "second", "walker"]
    ride.go_on(5.0, "S2")
    assert ride.names("alighted") == ["early", "second"]
    assert "early" in link.api.person.getIDList(), "it walks the rest of its way"
    assert "second" not in link.api.person.getIDList(), "it has no further way"
    assert ride.passengers.found[2].boarded_s is None
    assert "walker" in link.api.person.getIDList()


def test_a_full_shuttle_takes_no_further_passenger(link: Link, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("basu_sumo.passengers.CAPACITY", 1)
    ride = Ride(link)
    ride.go_on(2.0, None)
    ride.go_on(20.0, "S1")
    assert ride.names("boarded") == ["early"]


def test_a_scenario_without_the_route_s_stops_has_no_passengers(link: Link) -> None:
    ride = Ride(link)
    ride.passengers = Passengers(link, ["other"])
    ride.go_on(3.0, "other")
    assert ride.passengers.found == []
