"""Claims about the drawing: well-formed, complete, in CARLA's coordinates, the same every time."""

import re

from lxml import etree

from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.spawn_points import spawn_points
from linden_maps.drawing.svg import svg
from opendrive_texts import signal, street_through_junction

STOP_LINE = (
    '<object id="51" type="roadMark" name="StopLine" s="48" t="-1.75" hdg="0"><outline>'
    '<cornerLocal u="-0.2" v="-1.75" z="0"/><cornerLocal u="0.2" v="-1.75" z="0"/><cornerLocal u="0.2" v="1.75" z="0"/>'
    "</outline></object>"
)
TEXT = street_through_junction(
    signals=signal("7", 48.0, -5.8) + signal("8", 47.0, 5.8, "1000001") + signal("9", 20.0, -5.8, "205"),
    objects=STOP_LINE,
)


def groups(text: str) -> dict[str, etree._Element]:
    root = etree.fromstring(svg(parse(text)).encode())
    return {group.get("id", ""): group for group in root.iterchildren("{*}g")}


def test_everything_on_the_map_is_on_the_picture() -> None:
    drawn = groups(TEXT)
    assert {
        "driving",
        "pavement",
        "marks",
        "lines",
        "signals",
        "triggers",
        "spawn-points",
        "street-names",
        "frame",
    } == set(drawn)
    assert len(drawn["spawn-points"]) == len(spawn_points(parse(TEXT)))
    assert len(drawn["triggers"]) == 2  # of the stop sign and the light; a yield sign has no box to stop in
    assert {text.text for text in drawn["street-names"]} == {"Street 1", "Street 2"}


def test_things_are_drawn_where_carla_has_them() -> None:
    (corners,) = [polygon.get("points", "") for polygon in groups(TEXT)["lines"]]
    assert corners == "47.80,3.50 48.20,3.50 48.20,0.00"


def test_lanes_without_marks_are_drawn_without() -> None:
    bare = re.sub("<roadMark [^>]*/>", "", TEXT)
    assert "marks" not in groups(bare)


def test_names_are_escaped() -> None:
    assert "A &lt;b&gt; &amp; C" in svg(parse(TEXT.replace("Street 1", "A &lt;b&gt; &amp; C")))


def test_the_same_map_gives_the_same_picture() -> None:
    assert svg(parse(TEXT)) == svg(parse(TEXT))


def test_a_map_without_roads_is_an_empty_picture() -> None:
    assert etree.fromstring(svg(parse("<OpenDRIVE/>")).encode()).tag.endswith("svg")


def test_no_word_of_the_legend_lies_on_the_map() -> None:
    opendrive = parse(TEXT)
    west_m = float(road_mesh(opendrive).vertices[:, 0].min())
    (frame,) = (group for name, group in groups(TEXT).items() if name == "frame")
    rows = [text for text in frame.iter("{*}text") if text.get("font-weight") is None and text.text != "N"]
    ends_m = [float(t.get("x", "")) + 0.6 * float(t.get("font-size", "")) * len(t.text or "") for t in rows]
    assert max(ends_m) < west_m


def test_the_legend_names_buildings_and_railroads_where_the_map_has_them() -> None:
    def legend(text: str) -> list[str | None]:
        return [word.text for word in groups(text)["frame"].iterchildren("{*}text")]

    assert not {"building", "railroad"} & set(legend(TEXT))
    things = [STOP_LINE.replace('type="roadMark"', f'type="{kind}"') for kind in ("building", "railroadCrossing")]
    assert {"building", "railroad"} <= set(legend(TEXT.replace(STOP_LINE, "".join(things))))
