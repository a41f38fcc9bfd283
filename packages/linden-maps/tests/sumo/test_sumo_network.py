"""Claims about SUMO networks of maps: every sign and light is kept, and the same map gives the same bytes."""

from dataclasses import replace
from importlib import resources
from pathlib import Path

import pytest
from lxml import etree
from shapely.geometry import LineString, Point, Polygon

from linden.errors import UserError
from linden.maps.navigation.areas import crosswalk_outlines
from linden_maps.sumo import programs
from linden_maps.sumo.bus_stops import RouteStop, bus_stops, stops_file
from linden_maps.sumo.check import compare
from linden_maps.sumo.demand import Demand, draw, trips_per_hour
from linden_maps.sumo.network import ConvertedNetwork, convert, with_lane_speeds
from linden_maps.sumo.vehicle_types import MIX, blueprints, types_file

pytest.importorskip("sumo", reason="the extra for SUMO is not installed")


def test_linden_keeps_every_sign_and_light(linden: tuple[ConvertedNetwork, Path]) -> None:
    compared = compare(linden[0])
    rows = {what: (in_map, in_net) for what, in_map, in_net in compared.table}
    assert rows["stop signs"] == ("157", "157")
    assert rows["yield signs"] == ("8", "8")
    assert rows["lights"] == ("22", "22")
    assert rows["parts that cannot reach each other by car"] == ("1", "1")
    assert rows["crosswalks at junctions"] == ("36", "36")
    assert rows["crosswalks within streets: SUMO has none"] == ("4", "0")
    assert rows["parts that cannot reach each other on foot"] == ("1", "1")
    assert compared.misfits == ()


def test_a_lost_sign_and_a_wrong_speed_are_misfits(linden: tuple[ConvertedNetwork, Path]) -> None:
    converted = linden[0]
    edge, signal = next(iter(converted.controls.stops.items()))
    unsigned = [each for each in converted.net.connections if each.start != edge]
    links = tuple(each._replace(state="M") for each in converted.net.connections if each.start == edge)
    net = replace(converted.net, connections=(*unsigned, *links))
    found = compare(converted._replace(net=net)).misfits
    kept = sum(each.signal_id == signal.signal_id for each in converted.controls.stops.values())
    assert found == (f"stop signs: {157 - kept} of 157 are kept",)


@pytest.mark.unmeasured
def test_the_network_has_no_date_and_the_same_bytes_twice(
    linden: tuple[ConvertedNetwork, Path], tmp_path: Path
) -> None:
    again = tmp_path / "again.net.xml"
    convert((resources.files("linden") / "data" / "Linden.xodr").read_bytes(), again)
    assert again.read_bytes() == linden[1].read_bytes()
    assert b"generated on" not in again.read_bytes()


def test_lights_have_the_server_s_program_and_name_their_heads(linden: tuple[ConvertedNetwork, Path]) -> None:
    root = etree.parse(str(linden[1])).getroot()
    lights = list(root.iter("tlLogic"))
    assert len(lights) == 6
    heads = {str(each.get("value")) for light in lights for each in light.iter("param")}
    assert heads == {signal.signal_id for signal in linden[0].controls.lights.values()}
    for light in lights:
        durations = [float(str(phase.get("duration"))) for phase in light.iter("phase")]
        assert durations == [10.0, 3.0, 2.0] * (len(durations) // 3)
        states = [str(phase.get("state")) for phase in light.iter("phase")]
        assert all(set(state) <= set("r") for state in states[2::3]), "between two turns all are red"
        assert all(any(state[link] in "Gg" for state in states) for link in range(len(states[0])))


def test_streets_end_at_the_stop_line_before_a_marked_crosswalk_and_people_cross_on_the_marking(
    linden: tuple[ConvertedNetwork, Path],
) -> None:
    converted, path = linden
    net = converted.net
    root = etree.parse(str(path)).getroot()
    crossings = {str(each.get("id")): each for each in root.iter("edge") if each.get("function") == "crossing"}
    marked = 0
    for road_id, outline in crosswalk_outlines(converted.opendrive):
        shape = Polygon([(x_m + net.offset_m[0], y_m + net.offset_m[1]) for x_m, y_m in outline])
        lanes = [lane for edge in net.car_edges() for lane in edge.car_lanes]
        if any(LineString(lane.shape).intersects(shape) for lane in lanes):
            continue  # within a street: SUMO has no crossing there
        marked += 1
        ends = [Point(lane.shape[-1]) for lane in lanes if f"{road_id}_" in " ".join(lane.origins)]
        assert min(end.distance(shape) for end in ends) == pytest.approx(1.8, abs=0.6)
        lines = [lane_line(each) for each in crossings.values()]
        (line,) = [line for line in lines if line.intersection(shape).length > 0.9 * line.length]
        assert line.length > 5.0
        assert all(z_m > 200.0 for *_, z_m in line.coords), "as high as the street"
    assert marked == 36


def lane_line(edge: etree._Element) -> LineString:
    """Return the line of an edge's lane, in SUMO's frame."""
    shape = str(next(edge.iter("lane")).get("shape"))
    return LineString([tuple(map(float, point.split(","))) for point in shape.split()])


def test_lanes_without_a_speed_take_that_of_their_road() -> None:
    text = b"""<OpenDRIVE><road><type s="0" type="town"><speed max="25" unit="mph"/></type><lanes><laneSection s="0">
      <right><lane id="-1" type="driving"/><lane id="-2" type="driving"><speed sOffset="0" max="10" unit="mph"/></lane>
      <lane id="-3" type="sidewalk"/></right></laneSection></lanes></road></OpenDRIVE>"""
    lanes = list(etree.fromstring(with_lane_speeds(text)).iter("lane"))
    speeds = [[(each.get("max"), each.get("unit")) for each in lane.iter("speed")] for lane in lanes]
    assert speeds == [[("25", "mph")], [("10", "mph")], []]


def test_stops_of_a_route_file_lie_on_their_side_of_the_street(linden: tuple[ConvertedNetwork, Path]) -> None:
    net = linden[0].net
    both = (RouteStop("S3E", "", 620.257, -368.426), RouteStop("S3W", "", 629.571, -370.938))
    found, lost = bus_stops(net, (*both, RouteStop("far", "", 1e5, 1e5)))
    lanes = [str(each.get("lane")) for each in etree.fromstring(stops_file(found, ())).iter("busStop")]
    assert [stop.id for stop in lost] == ["far"]
    assert len(lanes) == 2
    assert lanes[0].split("_")[0].lstrip("-") == lanes[1].split("_")[0].lstrip("-"), "the same street"
    assert lanes[0].startswith("-") != lanes[1].startswith("-"), "in both directions"


@pytest.mark.unmeasured
def test_a_demand_follows_its_seed_its_hour_and_its_scale(linden: tuple[ConvertedNetwork, Path]) -> None:
    net = linden[0].net
    trips = draw(net, Demand())
    assert trips == draw(net, Demand())
    assert trips != draw(net, Demand(seed=Demand().seed + 1))
    assert trips_per_hour(net, Demand(hour=17.0)) > 5 * trips_per_hour(net, Demand(hour=3.0))
    assert trips_per_hour(net, Demand(scale=2.0)) == pytest.approx(2 * trips_per_hour(net, Demand()))
    assert [trip.depart_s for trip in trips] == sorted(trip.depart_s for trip in trips)
    assert all(trip.start in net.edges and trip.end in net.edges for trip in trips)


@pytest.mark.parametrize(
    ("demand", "sentence"),
    [
        (Demand(hour=24.0), "the hour is 24; give one from 0 to below 24"),
        (Demand(duration_s=0.0), "the demand's duration is 0 s; give a time above 0"),
        (Demand(scale=-1.0), "the demand's scale is -1; give 0 or more"),
    ],
)
def test_figures_that_mean_nothing_are_refused(
    demand: Demand, sentence: str, linden: tuple[ConvertedNetwork, Path]
) -> None:
    with pytest.raises(UserError, match=sentence):
        draw(linden[0].net, demand)


def test_types_have_the_sizes_of_the_blueprints() -> None:
    root = etree.fromstring(types_file())
    types = {str(each.get("id")): each for each in root.iter("vType")}
    assert set(types) == {f"vehicle.{name}" for name in blueprints()}
    assert float(str(types["vehicle.audi.a2"].get("length"))) == pytest.approx(2 * 1.853)
    mix = next(root.iter("vTypeDistribution"))
    assert mix.get("id") == MIX
    assert "vehicle.easymile.ez10" not in str(mix.get("vTypes")).split()
    assert sum(map(float, str(mix.get("probabilities")).split())) == pytest.approx(1.0, abs=1e-3)


def test_a_map_that_netconvert_refuses_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="SUMO's netconvert refused the map: "):
        programs.run("netconvert", ("--opendrive", "none.xodr", "-o", "x.net.xml"), tmp_path)


def test_without_sumo_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SUMO_HOME", raising=False)
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    with pytest.raises(UserError, match=r"SUMO is not installed; install it with: pip install 'linden-maps\[sumo\]'"):
        programs.run("netconvert", (), tmp_path)
