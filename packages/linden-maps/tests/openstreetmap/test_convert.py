"""Claims about the way from an extract to a map, on a quarter drawn by hand; netconvert reads the same extract."""

import re
import subprocess
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest
import sumo
import sumolib

from fakes.osm_quarter import Drawing, quarter
from linden.errors import UserError
from linden.maps.facts import derive
from linden.maps.opendrive.model import OpenDrive, Road
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType
from linden_maps.checks.check import Severity, check
from linden_maps.openstreetmap.convert import Imported, convert
from linden_maps.streets.build import Built, assembled
from linden_maps.streets.geojson import read
from linden_maps.streets.writing import text


@pytest.fixture(scope="module")
def imported() -> Imported:
    return convert(quarter().text(), "quarter.osm")


@pytest.fixture(scope="module")
def built(imported: Imported) -> Built:
    return assembled(read(imported.streets))


@pytest.fixture(scope="module")
def opendrive(built: Built) -> OpenDrive:
    return parse(text(built.document))


def features(imported: Imported, kind: str) -> dict[str, dict[str, Any]]:
    found = [feature["properties"] for feature in imported.streets["features"]]
    return {properties["id"]: properties for properties in found if properties["feature"] == kind}


def by_name(imported: Imported, *names: str) -> dict[str, Any]:
    """The intersection of streets with these names."""
    found = features(imported, "intersection").values()
    return next(one for one in found if set(one["name"].split(" & ")) == set(names))


def test_equal_extracts_give_equal_maps(built: Built) -> None:
    again = assembled(read(convert(quarter().text(), "quarter.osm").streets))
    assert text(again.document) == text(built.document)


def test_the_map_has_no_findings(opendrive: OpenDrive) -> None:
    assert [str(one) for one in check(opendrive) if one.severity is not Severity.NOTE] == []


@pytest.mark.parametrize(
    ("names", "control", "source", "waiting"),
    [
        (("Cleveland Avenue", "East 11th Avenue"), "signal", "tagged", None),
        (("Cleveland Avenue", "East 12th Avenue"), "two_way_stop", "tagged", ["4", "5"]),
        (("East 12th Avenue", "Brooks Avenue"), "all_way_stop", "tagged", None),
        (("East 12th Avenue", "Hamilton Avenue"), "roundabout", "tagged", None),
        (("Great Circle", "Joyce Avenue"), "give_way", "implied by junction=roundabout", ["16"]),
        (
            ("Cleveland Avenue", "Bonham Avenue"),
            "two_way_stop",
            "guessed: no tag, the lower class of street waits",
            ["6"],
        ),
    ],
)
def test_controls(imported: Imported, names: tuple[str, ...], control: str, source: str, waiting: Any) -> None:
    found = by_name(imported, *names)
    assert (found["control"], found["control_confidence"]) == (control, source)
    assert found.get("stop_controlled_streets") == waiting


def test_what_governs_a_junction_stands_in_the_map(opendrive: OpenDrive) -> None:
    types = [signal.type for _, signal in opendrive.signals()]
    assert types.count("1000001") == 4
    stops = [road.name for road, signal in opendrive.signals() if signal.type == "206"]
    assert (
        stops.count("East 12th Avenue") == 5
    )  # two at Cleveland Avenue, two at the all-way stop, one guessed at Joyce
    assert types.count("205") == 7  # four of the small roundabout, three of the large one


def test_signs_that_have_a_direction_belong_to_the_junction_ahead() -> None:
    for towards in ("forward", "backward"):
        draw = Drawing()
        draw.way(1, (-100.0, 0.0), (0.0, 0.0), (100.0, 0.0), highway="tertiary", name="A")
        draw.way(2, (0.0, -100.0), (0.0, -50.0), (0.0, 0.0), highway="tertiary", name="B")
        draw.way(3, (0.0, -100.0), (-100.0, -100.0), highway="tertiary", name="C")
        draw.way(4, (0.0, -100.0), (100.0, -100.0), highway="tertiary", name="C")
        draw.node(0.0, -50.0, highway="stop", direction=towards)
        found = [
            feature["properties"]
            for feature in convert(draw.text(), "x.osm").streets["features"]
            if feature["properties"].get("stop_controlled_streets")
        ]
        (one,) = found
        assert one["stop_controlled_streets"] == ["2"]
        assert ("A" in one["name"]) == (towards == "forward")


def test_guesses_are_marked_in_the_map(opendrive: OpenDrive) -> None:
    notes = {dict(road.user_data).get("street"): dict(road.user_data) for road in opendrive.roads}
    assert notes["1.1"]["lanes_confidence"] == "tagged"
    assert notes["1.1"]["width_confidence"] == "tagged"
    assert notes["6"]["lanes_confidence"] == "guessed from highway=residential"
    assert notes["6"]["parking_confidence"] == "tagged"
    assert notes["6"]["speed_limit_confidence"] == "guessed from highway=residential"


def driving(road: Road) -> tuple[int, int]:
    """Driving lanes along the road and against it."""
    lanes = [lane.id for lane in road.sections[0].lanes if lane.type == LaneType.DRIVING]
    return sum(lane < 0 for lane in lanes), sum(lane > 0 for lane in lanes)


def test_a_street_with_traffic_against_its_nodes_is_turned_about(opendrive: OpenDrive, imported: Imported) -> None:
    road = next(road for road in opendrive.roads if dict(road.user_data).get("street") == "20")
    assert driving(road) == (1, 0)
    assert features(imported, "street")["20"]["oneway"] == "forward"


def test_crossings_lie_where_they_are_drawn(opendrive: OpenDrive) -> None:
    walks = [(road.name, thing.s_m) for road in opendrive.roads for thing in road.objects if thing.is_crosswalk]
    assert len(walks) == 9  # four at the lights (one of them drawn), four at the all-way stop, one between junctions
    between = [s_m for name, s_m in walks if name == "East 11th Avenue" and 30.0 < s_m < 120.0]
    assert len(between) == 1


def test_buildings_stand_on_their_footprints(built: Built) -> None:
    facts = derive(text(built.document).decode())
    found = {thing.name: thing for thing in facts.standing if thing.kind == "building"}
    assert set(found) == {"Corner Shop", "building", "garage", "Windsor Academy"}
    shop = found["Corner Shop"]
    (box,) = shop.boxes
    assert sorted((2 * box.half_x_m, 2 * box.half_y_m)) == pytest.approx([10.0, 14.0], abs=0.03)
    assert 2 * box.half_z_m == pytest.approx(7.5)


def test_a_building_over_a_street_is_left_out(built: Built) -> None:
    assert built.left_out == ("w44",)


def test_an_extract_without_streets_is_refused() -> None:
    draw = Drawing()
    draw.way(1, (0.0, 0.0), (50.0, 0.0), highway="footway")
    with pytest.raises(UserError, match=r"x\.osm holds no street that cars may drive on"):
        convert(draw.text(), "x.osm")


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The network that SUMO's netconvert makes of the same extract."""
    folder = tmp_path_factory.mktemp("peer")
    (folder / "quarter.osm").write_bytes(quarter().text())
    command = [str(Path(sumo.SUMO_HOME) / "bin" / "netconvert"), "--osm-files", "quarter.osm", "-o", "net.xml"]
    command += ["--no-turnarounds", "--remove-edges.by-type", "highway.footway,highway.service"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return sumolib.net.readNet(str(folder / "net.xml"))


def test_lanes_equal_the_lanes_that_netconvert_reads(peer: Any, imported: Imported, opendrive: OpenDrive) -> None:
    theirs: dict[int, set[tuple[int, bool]]] = defaultdict(set)
    for edge in peer.getEdges():
        found = re.fullmatch(r"(-?)(\d+)(?:#\d+)?", edge.getID())
        assert found is not None
        theirs[int(found[2])].add((edge.getLaneNumber(), found[1] == "-"))
    ours: dict[int, set[int]] = defaultdict(set)
    streets = features(imported, "street")
    for road in opendrive.roads:
        street = dict(road.user_data).get("street")
        if street is not None and not road.is_in_junction:
            for way in streets[street]["osm_ways"]:
                ours[way] |= {count for count in driving(road) if count}
    assert set(ours) == set(theirs) - {9, 10}  # the small ring is a place of ours, and a ring of edges of theirs
    for way, counts in ours.items():
        assert counts == {count for count, _ in theirs[way]}, way


def test_junctions_equal_the_junctions_that_netconvert_reads(peer: Any, opendrive: OpenDrive) -> None:
    def ends(node: Any) -> int:
        return len({edge.getID().lstrip("-") for edge in (*node.getIncoming(), *node.getOutgoing())})

    ring = {edge.getFromNode().getID() for edge in peer.getEdges() if re.match(r"-?(9|10)(#|$)", edge.getID())}
    theirs = [node for node in peer.getNodes() if ends(node) > 2 and node.getID() not in ring]
    ours = []
    for junction in opendrive.junctions:
        roads = {connection.incoming_road for connection in junction.connections}
        if len(roads) > 2:
            ours.append(junction)
    assert len(ours) == len(theirs) + 1  # theirs has four nodes for the small ring
