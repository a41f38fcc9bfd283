"""Claims about people on foot: the network's crossings, walks by hour and place, passengers, and whole folders."""

import subprocess
from collections import Counter
from dataclasses import replace
from importlib import resources
from pathlib import Path

import pytest
from lxml import etree

from linden.errors import UserError
from linden_maps.sumo import programs, write_folder
from linden_maps.sumo.bus_stops import BusStop, RouteStop, bus_stops, parking_areas
from linden_maps.sumo.check import compare, walkable
from linden_maps.sumo.demand import Demand, draw
from linden_maps.sumo.net import point_at
from linden_maps.sumo.network import ConvertedNetwork
from linden_maps.sumo.people import FARTHER_M, WALK_REACH_M, draw_riders, draw_walks, people_file
from linden_maps.sumo.places import SCHOOL, TRANSIT, Place, car_streets, pavements, places_of

ORIGIN_DEG = (39.9937118, -82.9816685)
STOPS = (
    RouteStop("S1", "transit centre", 95.051, 14.766),
    RouteStop("S2N", "north", 471.599, -80.662),
    RouteStop("S4", "community house", 1175.661, -769.127),
    RouteStop("S2S", "south", 480.623, -93.025),
)


@pytest.fixture(scope="module")
def places() -> tuple[Place, ...]:
    return places_of(None, ORIGIN_DEG)


@pytest.fixture(scope="module")
def stops(linden: tuple[ConvertedNetwork, Path]) -> tuple[BusStop, ...]:
    return bus_stops(linden[0].net, STOPS)[0]


def test_a_crosswalk_without_a_crossing_and_cut_pavements_are_misfits(linden: tuple[ConvertedNetwork, Path]) -> None:
    converted = linden[0]
    net = converted.net
    assert walkable(net) == 1
    on_roads = tuple(each for each in net.connections if not each.start.startswith(":"))
    cut = replace(net, connections=on_roads, crossing_middles=net.crossing_middles[:1])
    found = compare(converted._replace(net=cut)).misfits
    assert any("the pavements fall into" in sentence for sentence in found)
    assert any("of 36 at junctions have no crossing within 12 m" in sentence for sentence in found)


def test_schools_and_stations_of_linden_lie_at_streets(
    linden: tuple[ConvertedNetwork, Path], places: tuple[Place, ...]
) -> None:
    assert Counter(place.kind for place in places) == {"school": 3, "transit": 4, "community": 2}
    assert len(car_streets(linden[0].net, places, SCHOOL)) == 3
    assert len(pavements(linden[0].net, places, TRANSIT)) == 4
    assert car_streets(linden[0].net, places_of(None, (42.0, 2.0)), SCHOOL) == [], "another town has none of them"


def test_walks_follow_seed_hour_and_scale_and_lead_to_schools_when_these_begin(
    linden: tuple[ConvertedNetwork, Path], places: tuple[Place, ...]
) -> None:
    net = linden[0].net
    walks = draw_walks(net, Demand(), places)
    assert walks == draw_walks(net, Demand(), places)
    assert walks != draw_walks(net, Demand(seed=Demand().seed + 1), places)
    assert len(draw_walks(net, Demand(scale=2.0), places)) > 1.9 * len(walks)
    schools = {edge.id for edge in pavements(net, places, SCHOOL)}
    to, back = draw_walks(net, Demand(hour=8.2), places), draw_walks(net, Demand(hour=14.2), places)
    assert sum(walk.end in schools for walk in to) > 0.25 * len(to)
    assert sum(walk.start in schools for walk in back) > 0.25 * len(back)
    assert sum(walk.end in schools for walk in back) < 0.05 * len(back)
    for walk in to:
        first, last = (net.edges[name].lanes[0].shape[0] for name in (walk.start, walk.end))
        assert sum((a - b) ** 2 for a, b in zip(first[:2], last[:2], strict=True)) <= WALK_REACH_M**2


def test_cars_fetch_from_schools_and_park_at_homes(
    linden: tuple[ConvertedNetwork, Path], places: tuple[Place, ...]
) -> None:
    net = linden[0].net
    schools = {edge.id for edge in car_streets(net, places, SCHOOL)}
    spaces = parking_areas(net)
    trips = draw(net, Demand(hour=14.5), places, spaces)
    assert sum(trip.start in schools for trip in trips) > 0.08 * len(trips)
    edge_of = {space.id: space.edge for space in spaces}
    used = [space for trip in trips for space in (trip.from_space, trip.to_space) if space is not None]
    assert len(used) > 0.5 * len(trips)
    assert len(used) == len(set(used)), "no space is given away twice"
    assert all(trip.to_space is None or edge_of[trip.to_space] == trip.end for trip in trips)
    assert all(trip.from_space is None or edge_of[trip.from_space] == trip.start for trip in trips)


def test_a_trip_ends_in_a_parking_space_or_where_the_network_ends(linden: tuple[ConvertedNetwork, Path]) -> None:
    net = linden[0].net
    trips = draw(net, Demand(), (), parking_areas(net))
    assert len(net.outer) == 11, "the ends of Linden's map"
    ends = [trip.to_space is not None or net.edges[trip.end].end in net.outer for trip in trips]
    assert sum(ends) == len(ends)
    assert all(trip.is_under_way or trip.from_space or net.edges[trip.start].start in net.outer for trip in trips)


def test_parking_spaces_keep_clear_of_what_stands_at_the_kerb(linden: tuple[ConvertedNetwork, Path]) -> None:
    net = linden[0].net
    spaces = parking_areas(net)
    space = spaces[len(spaces) // 2]
    at_m = point_at(net.edges[space.edge].lanes[0], (space.from_m + 3.0) / net.edges[space.edge].length_m)
    fewer = parking_areas(net, [(*at_m, 10.0)])
    assert space not in fewer
    assert 0 < len(spaces) - len(fewer) < 10


def test_passengers_ride_onwards_and_never_to_the_other_side_of_the_street(
    linden: tuple[ConvertedNetwork, Path], stops: tuple[BusStop, ...]
) -> None:
    net = linden[0].net
    riders = draw_riders(net, Demand(hour=17.0, scale=3.0), stops)
    order = [stop.id for stop in stops]
    at_m = {stop.id: stop.at_m for stop in stops}
    assert {rider.stop_id for rider in riders} == {"S1", "S2N", "S4"}, "the last stop has none"
    for rider in riders:
        assert order.index(rider.destination_id) > order.index(rider.stop_id)
        here, there = at_m[rider.stop_id], at_m[rider.destination_id]
        assert (here[0] - there[0]) ** 2 + (here[1] - there[1]) ** 2 > FARTHER_M**2
    assert [rider.depart_s for rider in riders] == sorted(rider.depart_s for rider in riders)
    persons = list(etree.fromstring(people_file([], riders, stops)))
    assert len(persons) == len(riders)
    assert all(str(next(person.iter("ride")).get("lines")) == "shuttle" for person in persons)


def test_sumo_takes_the_folder_and_its_people_cross(tmp_path: Path) -> None:
    text = (resources.files("linden") / "data" / "Linden.xodr").read_bytes()
    folder = tmp_path / "net"
    written = write_folder(text, "Linden", folder, Demand(seed=3), STOPS)
    assert written.walks > 100
    assert written.riders > 5
    arguments = ("--end", "60", "--step-length", "1", "--fcd-output", "fcd.xml", "--no-warnings", "--no-step-log")
    command = [str(programs.home() / "bin" / "sumo"), "-c", str(written.config), *arguments]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    seen = {str(each.get("edge")) for each in etree.parse(str(tmp_path / "fcd.xml")).iter("person")}
    assert any(edge.startswith(":") and "_c" in edge for edge in seen), "people are on crossings"
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with pytest.raises(UserError):
        write_folder(b"<OpenDRIVE/>", "Linden", folder, Demand(seed=4), STOPS)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before, "a refused map changes nothing"
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == [], "and leaves no draft"


def test_a_folder_with_other_files_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(UserError, match=r"holds thesis\.tex"):
        write_folder(b"", "Linden", tmp_path, Demand())
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_places_that_cannot_be_read_are_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot read the places of .*none: No such file"):
        places_of(tmp_path / "none", ORIGIN_DEG)
    bad = tmp_path / "bad.geojson"
    bad.write_text('{"features": [{"type": "Feature"}]}')
    with pytest.raises(UserError, match=r"bad\.geojson is no GeoJSON with points that have a kind of school, transit"):
        places_of(bad, ORIGIN_DEG)
