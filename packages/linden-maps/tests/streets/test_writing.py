"""Documents are written in the 1.4 schema's order, with fixed digits, the same bytes each time."""

from typing import Any

from lxml import etree

from linden_maps.streets.build import build
from linden_maps.streets.writing import _fixed, text


def test_numbers_have_no_closing_noughts_and_no_negative_nought() -> None:
    assert [_fixed(number, 3) for number in (1.5, 2.0, -0.0001, 100.0, 0.1234)] == ["1.5", "2", "0", "100", "0.123"]


def test_equal_facts_give_equal_bytes(sketch: Any) -> None:
    town = sketch.collection(sketch.crossing("signal"))
    assert build(town) == build(town)


def test_a_road_is_written_in_the_order_of_the_schema(built_of: Any, sketch: Any) -> None:
    root = etree.fromstring(text(built_of(sketch.crossing("all_way_stop")).document))
    road = next(road for road in root.iter("road") if road.find("signals") is not None)
    order = [
        "link",
        "type",
        "planView",
        "elevationProfile",
        "lateralProfile",
        "lanes",
        "objects",
        "signals",
        "userData",
    ]
    found = [child.tag for child in road]
    assert sorted(found, key=order.index) == found


def test_ids_of_roads_and_junctions_do_not_meet_and_all_are_numbers(built_of: Any, sketch: Any) -> None:
    root = etree.fromstring(text(built_of(sketch.crossing()).document))
    roads = {int(road.get("id", "")) for road in root.iter("road")}
    junctions = {int(junction.get("id", "")) for junction in root.findall("junction")}
    assert roads
    assert junctions
    assert roads.isdisjoint(junctions)
    assert 0 not in roads | junctions


def test_estimates_stay_marked(built_of: Any, sketch: Any) -> None:
    root = etree.fromstring(text(built_of(sketch.crossing(control_confidence="one source")).document))
    road = root.find("road")
    assert road is not None
    assert {(note.get("code"), note.get("value")) for note in road.findall("userData")} >= {("confidence", "estimated")}
    notes = {note.get("code"): note.get("value") for note in root.findall("junction/userData")}
    assert notes["control_confidence"] == "one source"
