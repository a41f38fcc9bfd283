"""Claims about trips that would begin in sight of a vehicle of the simulator: they begin later, as planned."""

from pathlib import Path

import pytest

from basu_sumo.link import Link, in_process
from basu_sumo.random_trips import RandomTrips
from basu_sumo.trip_ends import Streets
from basu_sumo.trip_starts import TripStarts

pytest.importorskip("libsumo", reason="the extra for SUMO is not installed")
STEP_S = 0.05
NEAR, FAR = ((300.0, 0.0),), ((9_000.0, 0.0),)
CONFIG = """<configuration><input><net-file value="small.net.xml"/>
<additional-files value="types.add.xml,spaces.add.xml"/></input></configuration>"""
SPACES = """<additional><parkingArea id="here" lane="bc_0" startPos="100" endPos="107" roadsideCapacity="1"/>
<parkingArea id="there" lane="cb_0" startPos="60" endPos="67" roadsideCapacity="1"/></additional>"""


@pytest.fixture
def link(folder: Path) -> Link:
    (folder / "spaces.add.xml").write_text(SPACES, encoding="utf-8")
    (folder / "spaces.sumocfg").write_text(CONFIG, encoding="utf-8")
    return in_process(folder / "spaces.sumocfg", step_s=STEP_S, seed=0)


def driven(link: Link, starts: TripStarts, viewers_m: tuple[tuple[float, float], ...], steps: int) -> set[str]:
    """Let SUMO make steps; return what was held back."""
    held: set[str] = set()
    for _ in range(steps):
        link.step()
        held |= starts.look(viewers_m)
    return held


def test_a_car_leaves_its_parking_space_once_nothing_sees_it(link: Link) -> None:
    vehicle, starts = link.api.vehicle, TripStarts(link, lambda: Streets(link))
    driven(link, starts, NEAR, 2)
    link.api.route.add("way", ["bc", "cb"])
    vehicle.add("one", "way", typeID="vehicle.audi.a2", departPos="stop", departSpeed="0")
    vehicle.setParkingAreaStop("one", "here", duration=5.0)
    vehicle.setParkingAreaStop("one", "there", duration=50.0)
    assert driven(link, starts, NEAR, 100) == {"one"}
    assert vehicle.getIDList() == ()
    driven(link, starts, FAR, 12)
    assert vehicle.getRoute("one") == ("bc", "cb")
    assert [stop.stoppingPlaceID for stop in vehicle.getStops("one")] == ["here", "there"]
    assert vehicle.isStoppedParking("one")
    assert 100.0 <= vehicle.getLanePosition("one") <= 107.0
    driven(link, starts, NEAR, 1200)
    assert vehicle.isStoppedParking("one"), "in the other space, and not held back a second time"
    assert (vehicle.getRoadID("one"), starts.delayed) == ("cb", 1)
    link.close()


def test_a_car_in_the_midst_of_a_street_begins_where_it_would_have(link: Link) -> None:
    vehicle, starts = link.api.vehicle, TripStarts(link, lambda: Streets(link))
    driven(link, starts, NEAR, 2)
    link.api.route.add("way", ["bc"])
    vehicle.add("one", "way", typeID="vehicle.audi.a2", departPos="50")
    assert driven(link, starts, NEAR, 20) == {"one"}
    driven(link, starts, FAR, 11)
    assert vehicle.getLanePosition("one") == pytest.approx(50.0, abs=2.0)
    link.close()


@pytest.mark.parametrize(
    ("edges", "viewers_m", "line"),
    [
        pytest.param(["ab"], ((0.0, 0.0),), "", id="where the network begins"),
        pytest.param(["bc"], FAR, "", id="out of sight"),
        pytest.param(["bc"], (), "", id="without a viewer"),
        pytest.param(["bc"], NEAR, "shuttle", id="public line"),
    ],
)
def test_other_trips_begin_as_planned(
    link: Link, edges: list[str], viewers_m: tuple[tuple[float, float], ...], line: str
) -> None:
    vehicle, starts = link.api.vehicle, TripStarts(link, lambda: Streets(link))
    driven(link, starts, viewers_m, 2)
    link.api.route.add("way", edges)
    vehicle.add("one", "way", typeID="vehicle.audi.a2", line=line)
    assert driven(link, starts, viewers_m, 3) == set()
    assert vehicle.getIDList() == ("one",)
    link.close()


def test_a_random_trip_that_is_held_back_is_not_replaced(link: Link, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("basu_sumo.random_trips.LEAST_EDGES", 2)
    starts = TripStarts(link, lambda: Streets(link))
    trips = RandomTrips(link, 1, 0, held=lambda: starts.held)
    driven(link, starts, FAR, 2)
    monkeypatch.setattr(trips, "_route", lambda: ["bc"])  # it was out of sight when it was drawn
    for _ in range(5):
        trips.fill()
        driven(link, starts, NEAR, 1)
    assert list(starts.held) == ["random0"]
    link.close()


def test_what_drives_from_the_first_step_on_is_left_there(link: Link) -> None:
    starts = TripStarts(link, lambda: Streets(link))
    link.api.route.add("way", ["bc"])
    link.api.vehicle.add("one", "way", typeID="vehicle.audi.a2")
    assert driven(link, starts, NEAR, 3) == set()
    link.close()
