"""The shipped map of Linden, read by LibCarla: silent, complete, connected, smooth, and its routes drivable."""

import itertools
import math
import random
import subprocess
import sys
from collections import Counter
from importlib import resources
from itertools import pairwise
from pathlib import Path
from typing import Any

import carla
import networkx as nx
import pytest
from lxml import etree

from linden.geometry import from_opendrive
from linden_maps.streets.build import Built, assembled
from linden_maps.streets.controls import without_lights
from linden_maps.streets.routes import drive, xml
from linden_maps.streets.writing import text

SEED = 20200205  # the shuttle's first day
MAP = Path(str(resources.files("linden").joinpath("data/Linden.xodr")))
THESIS_MAP = MAP.with_name("Linden_thesis.xodr")
ROUTES = Path(str(resources.files("basu"))) / "routes"
LaneKey = tuple[int, int]


@pytest.fixture(scope="module")
def town() -> Any:
    return carla.Map("Linden", MAP.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def waypoints(town: Any) -> list[Any]:
    found: list[Any] = town.generate_waypoints(2.0)
    return found


def test_the_shipped_map_is_what_the_shipped_streets_build(linden_built: Built) -> None:
    assert MAP.read_bytes() == text(linden_built.document)


def test_the_shipped_variant_is_what_the_streets_build_without_lights(linden_built: Built) -> None:
    built = assembled(without_lights(linden_built.facts))
    assert THESIS_MAP.read_bytes() == text(built.document)
    ours, theirs = (
        {signal.kind for road in one.document.roads for signal in road.signals} for one in (linden_built, built)
    )
    assert ours - theirs == {"1000001"}
    assert not built.document.controllers
    for road, other in zip(linden_built.document.roads, built.document.roads, strict=True):
        plain = road._replace(signals=(), objects=(), references=())
        assert plain == other._replace(signals=(), objects=(), references=())
    lit = {signal.id: signal.lanes for road in linden_built.document.roads for signal in road.signals if signal.dynamic}
    stops = {s.id: s.lanes for road in built.document.roads for s in road.signals if s.kind == "206"}
    assert lit.items() <= stops.items()  # every approach with lights has a stop sign with the same number


def test_linden_has_its_named_places_and_the_railroad(linden_built: Built) -> None:
    things = [thing for road in linden_built.document.roads for thing in road.objects]
    names = {thing.name for thing in things if thing.kind == "building"}
    assert linden_built.left_out == ()
    for name in (
        "Linden Transit Center",
        "St. Stephen's Community House",
        "Douglas Community Recreation Center",
        "Rosewind Resident Council",
        "Windsor STEM Academy",
        "Linden-McKinley STEM Academy",
    ):
        assert name in names
    assert sum("Cleveland Ave" in name for name in names) == 12
    assert [thing.name for thing in things if thing.kind == "railroadCrossing"] == ["Railroad, E 17th Ave"]
    assert sum(thing.kind == "railroad" for thing in things) == 1
    furniture = Counter(thing.name for thing in things if thing.kind == "obstacle")
    assert furniture == {"bench": 6, "bin": 6, "mailbox": 6}


def test_limits_stand_where_streets_with_sourced_limits_begin(linden_built: Built) -> None:
    signs = [(road, s) for road in linden_built.document.roads for s in road.signals if s.kind == "274"]
    assert {(sign.value, sign.unit) for _, sign in signs} == {(25.0, "mph"), (35.0, "mph")}
    for road, sign in signs:
        assert (sign.value, sign.unit) == road.speed
        assert "one source" in sign.confidence
        before_m = sign.s_m if sign.lanes[0] < 0 else sum(piece.length_m for piece in road.path) - sign.s_m
        assert before_m == pytest.approx(25.0)


@pytest.mark.parametrize(("route", "file"), [("leap_primary", "linden_leap.xml"), ("short_ab", "linden_short.xml")])
def test_the_shipped_routes_are_what_the_shipped_streets_build(linden_built: Built, route: str, file: str) -> None:
    number = ["leap_primary", "short_ab"].index(route)
    assert (ROUTES / file).read_bytes() == xml(linden_built, linden_built.facts.routes[route], number)


def test_libcarla_reads_the_map_without_a_word() -> None:
    code = f"import carla; carla.Map('Linden', open({str(MAP)!r}).read()).get_topology()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")


def test_libcarla_counts_what_was_built(town: Any, linden_built: Built) -> None:
    kinds = Counter(signal.kind for road in linden_built.document.roads for signal in road.signals)
    assert {kind: len({mark.id for mark in town.get_all_landmarks_of_type(kind)}) for kind in kinds} == kinds
    assert kinds == {"206": 157, "205": 8, "1000001": 22, "274": 10}
    things = Counter(thing.kind for road in linden_built.document.roads for thing in road.objects)
    corners = town.get_crosswalks()
    assert len(corners) == 5 * things["crosswalk"]
    for polygon in zip(*[iter(corners)] * 5, strict=True):
        assert polygon[0].distance(polygon[4]) < 1e-3
        assert 2.5 < polygon[0].distance(polygon[1]) < 3.5


def test_signs_stand_where_they_were_put(town: Any, linden_built: Built) -> None:
    lanes = {(str(s.id), road.id): s.lanes for road in linden_built.document.roads for s in road.signals}
    behind = {(str(r.signal), road.id): r.lanes for road in linden_built.document.roads for r in road.references}
    assert len(behind) > 50
    seen = set()
    for landmark in town.get_all_landmarks():
        seen.add((landmark.id, landmark.road_id))
        assert landmark.get_lane_validities() == [(lanes | behind)[landmark.id, landmark.road_id]]
        beside = town.get_waypoint(landmark.transform.location, lane_type=carla.LaneType.Driving)
        assert 1.0 < beside.transform.location.distance(landmark.transform.location) < 8.0
    assert seen == (lanes | behind).keys()


def test_every_way_behind_a_light_refers_to_it(linden_built: Built) -> None:
    lights = {s.id: road.id for road in linden_built.document.roads for s in road.signals if s.dynamic}
    ways = {c.connecting: c.incoming for j in linden_built.document.junctions if j.controllers for c in j.connections}
    driven = {road.id for road in linden_built.document.roads if any(lane.kind == "driving" for lane in road.right)}
    referring = {road.id: lights[r.signal] for road in linden_built.document.roads for r in road.references}
    assert referring == {way: come for way, come in ways.items() if way in driven}


@pytest.mark.unmeasured
def test_every_driving_lane_has_the_speed_of_its_road(linden_built: Built) -> None:
    root = etree.fromstring(text(linden_built.document))
    limited = [road for road in root.iter("road") if road.find("type/speed") is not None]
    assert len(limited) > 1000
    for road in limited:
        of_lanes = {speed.get("max") for speed in road.iterfind("lanes/laneSection//lane[@type='driving']/speed")}
        driving = road.findall("lanes/laneSection//lane[@type='driving']")
        assert of_lanes == ({road.find("type/speed").get("max")} if driving else set())
        assert all(lane.find("speed") is not None for lane in driving)


def test_every_driving_lane_can_be_reached_from_every_other(town: Any) -> None:
    # lanes of one direction count as one: who needs another changes over
    graph = nx.DiGraph(((a.road_id, a.lane_id > 0), (b.road_id, b.lane_id > 0)) for a, b in town.get_topology())
    assert nx.is_strongly_connected(graph)
    assert all(lanes for lanes in graph.succ.values())


def test_heights_follow_the_ground_of_the_facts(waypoints: list[Any], linden_built: Built) -> None:
    ground = linden_built.facts.ground
    apart = []
    for waypoint in waypoints:
        at = waypoint.transform.location
        apart.append(abs(at.z - (ground.base_m + ground.east * at.x - ground.north * at.y)))
    assert max(apart) < 0.4  # junctions are level, up to 25 m about their middle
    assert sum(apart) / len(apart) < 0.03
    steepest_deg = max(abs(math.remainder(waypoint.transform.rotation.pitch, 180.0)) for waypoint in waypoints)
    assert steepest_deg < math.degrees(0.022)


def test_lanes_go_on_without_jumps_or_kinks(waypoints: list[Any]) -> None:
    chance = random.Random(SEED)
    sharpest_deg = 0.0
    for start in chance.sample(waypoints, 300):
        at = start
        for _ in range(300):
            ways = at.next(1.0)
            assert ways, at
            after = chance.choice(ways)
            assert 0.5 < at.transform.location.distance(after.transform.location) < 1.3, (at, after)
            turn_deg = math.remainder(after.transform.rotation.yaw - at.transform.rotation.yaw, 360.0)
            sharpest_deg = max(sharpest_deg, abs(turn_deg))
            at = after
    assert sharpest_deg < 13.0  # a turn of 4.5 m radius, the tightest of the map


@pytest.mark.parametrize(("route", "least_m", "most_m"), [("leap_primary", 4550, 4700), ("short_ab", 600, 900)])
@pytest.mark.unmeasured
def test_a_route_is_driven_lane_by_lane(
    town: Any, linden_built: Built, route: str, least_m: float, most_m: float
) -> None:
    driven = drive(linden_built, linden_built.facts.routes[route])
    assert least_m < driven.length_m < most_m
    places = [from_opendrive(*s.pose[:2], s.z_m, s.pose.heading_rad).location for s in driven.samples]
    roads = [road for road, _ in itertools.groupby(sample.road for sample in driven.samples)]
    at = town.get_waypoint(carla.Location(*places[0]))
    assert at.road_id == roads[0]
    passed = 0
    total_m = 0.0
    while total_m < driven.length_m - 1.0:
        ways = [way for way in at.next(0.5) if way.road_id in roads[passed : passed + 2]]
        assert ways, f"after {total_m:.0f} m road {at.road_id} does not lead to road {roads[passed + 1]}"
        after = max(ways, key=lambda way: way.road_id == roads[passed])
        passed += after.road_id != roads[passed]
        total_m += at.transform.location.distance(after.transform.location)
        at = after
        here = at.transform.location
        nearest = min(math.dist((here.x, here.y, here.z), place) for place in places[int(total_m * 0.98) :][:150])
        assert nearest < 0.6
    here = at.transform.location
    assert math.dist((here.x, here.y, here.z), places[-1]) < 3.0


def test_no_light_stands_on_the_shuttles_way_but_stops_and_roundabouts_do(linden_built: Built) -> None:
    driven = drive(linden_built, linden_built.facts.routes["leap_primary"])
    records = {road.id: road for road in linden_built.document.roads}
    met: Counter[str] = Counter()
    for before, after in pairwise(driven.samples):
        if not before.in_junction and after.in_junction:
            arrives_along = math.dist(before.pose[:2], records[before.road].path[0].start[:2]) > 3.0
            signals = records[before.road].signals
            met.update(s.kind for s in signals if (s.lanes[0] < 0) == arrives_along)
    assert met["1000001"] == 0
    assert met["206"] >= 8
    assert met["205"] == 4


def test_the_stops_are_called_at_in_the_order_of_the_service(linden_built: Built) -> None:
    driven = drive(linden_built, linden_built.facts.routes["leap_primary"])
    assert [called.stop.id for called in driven.stops] == ["S1", "S2N", "S3E", "S4", "S3W", "S2S"]
    distances = [called.at.driven_m for called in driven.stops]
    assert distances == sorted(distances)
    records = {road.id: road for road in linden_built.document.roads}
    assert all(records[called.at.road].junction == -1 for called in driven.stops)
