"""Claims about what `check` finds: nothing in a good map, and each mistake by its name and size when it is put in."""

import math
from importlib import resources

import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.checks.check import Finding, Severity, check
from opendrive_texts import follows, lane, line, opendrive, road, section, signal, street_through_junction, touches

CROSSWALK = (
    '<object id="50" type="crosswalk" name="crosswalk" s="40" t="0" zOffset="0" hdg="0" orientation="none" '
    'length="3" width="7"><outline>'
    '<cornerLocal u="-1.5" v="-3.5" z="0"/><cornerLocal u="1.5" v="-3.5" z="0"/><cornerLocal u="1.5" v="3.5" z="0"/>'
    '<cornerLocal u="-1.5" v="3.5" z="0"/><cornerLocal u="-1.5" v="-3.5" z="0"/></outline></object>'
)
CONTROLLER = '<controller id="77" name="phase"><control signalId="8" type="0"/></controller>|<controller id="77"/>'
GOOD = street_through_junction(
    signals=signal("7", 48.0, -5.8) + signal("8", 47.0, 5.8, "1000001"), objects=CROSSWALK, controllers=CONTROLLER
)
WEST, EAST = 'id="1" junction="-1"', 'id="2" junction="-1"'


def found(text: str) -> list[Finding]:
    return [finding for finding in check(parse(text)) if finding.severity is not Severity.NOTE]


def in_road(which: str, before: str, after: str) -> str:
    """Change something in one road only."""
    head, mark, tail = GOOD.partition(which)
    own, end, rest = tail.partition("</road>")
    assert before in own
    return head + mark + own.replace(before, after, 1) + end + rest


def test_nothing_is_wrong_with_a_good_map() -> None:
    assert found(GOOD) == []


@pytest.mark.unmeasured
def test_nothing_is_wrong_with_linden() -> None:
    assert found((resources.files("linden") / "data" / "Linden.xodr").read_text()) == []


def test_the_ends_of_the_map_are_notes() -> None:
    notes = check(parse(GOOD))
    assert [(note.kind, note.road_id, note.s_m) for note in notes] == [("dead end", 1, 0.0), ("dead end", 2, 60.0)]


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        (GOOD.replace("+lat_0=40", "+lat_0=forty"), "georeference", "cannot read"),
        (GOOD.replace('<speed max="25" unit="mph"/>', "", 1), "speed", "no speed limit"),
        (GOOD.replace(' laneChange="none"', ""), "road mark", "3 road marks say nothing of laneChange"),
        (GOOD.replace('x="70" y="0" hdg="0"', 'x="70" y="0.05" hdg="0"'), "gap", "0.050 m apart"),
        (GOOD.replace('x="70" y="0" hdg="0"', 'x="70" y="0" hdg="0.05"'), "kink", "2.86°"),
        (
            in_road(EAST, "<elevationProfile>", '<elevationProfile><elevation s="0" a="0.1" b="0" c="0" d="0"/>'),
            "step",
            "differ in height by 0.100 m",
        ),
        (
            in_road(
                WEST, "<elevationProfile>", '<elevationProfile><elevation s="0" a="0"/><elevation s="20" a="0.5"/>'
            ),
            "step",
            "height jumps by 0.500 m",
        ),
        (in_road(WEST, "<lanes>", '<lanes><laneOffset s="0" a="0"/><laneOffset s="9" a="0.3"/>'), "jump", "0.300 m"),
        (
            in_road(WEST, 'a="3.5" b="0" c="0" d="0"/>', 'a="3.5"/><width sOffset="30" a="3.4"/>'),
            "width jump",
            "changes its width by 0.100 m",
        ),
        (in_road(EAST, 'a="3.5"', 'a="3.2"'), "gap", "m apart"),
        (in_road(WEST, '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>', ""), "width", "no <width>"),
        (in_road(WEST, '<width sOffset="0" a="3.5"', '<width sOffset="2" a="3.5"'), "width", "before sOffset=2"),
        (in_road(WEST, 'a="1.5" b="0"', 'a="1.5" b="-0.1"'), "width", "narrower than nothing"),
        (in_road(WEST, 'lane id="2"', 'lane id="3"'), "lane ids", "no lane 2"),
        (in_road(WEST, 'length="50"', 'length="49"'), "length", "ends at s=49.000"),
        (GOOD.replace('elementId="100"', 'elementId="101"', 1), "link", "junction 101, which does not exist"),
        (GOOD.replace('elementId="2" contactPoint="start"', 'elementId="3" contactPoint="start"', 1), "link", "road 3"),
        (
            GOOD.replace('elementId="2" contactPoint="start"', 'elementId="2" contactPoint="end"', 1),
            "link",
            "not lead back",
        ),
        (GOOD.replace(' contactPoint="start"/></link>', "/></link>", 1), "link", "contactPoint"),
        (GOOD.replace('<predecessor id="-1"/>', "", 1), "lane", "driving lane -1 leads nowhere"),
        (GOOD.replace('<successor id="1"/>', "", 1), "lane", "driving lane -1 leads nowhere"),
        (GOOD.replace('<junction id="100"', '<junction id="2"').replace('"100"', '"2"'), "ids", "has the id of a road"),
        (GOOD.replace('from="-1" to="-1"', 'from="-1" to="-2"'), "junction", "names a lane that does not exist"),
        (GOOD.replace('from="1" to="-1"', 'from="2" to="-1"'), "junction", "does not link back"),
        (GOOD.replace('incomingRoad="1"', 'incomingRoad="9"'), "junction", "road 9 does not exist"),
        (GOOD.replace("</junction>", '<priority high="10" low="99"/></junction>'), "priority", "road 99"),
        (GOOD.replace('<validity fromLane="-1" toLane="-1"/>', "", 1), "signal lanes", "has no <validity>"),
        (
            GOOD.replace('fromLane="-1" toLane="-1"', 'fromLane="-5" toLane="-4"', 1),
            "signal lanes",
            "the road has none",
        ),
        (GOOD.replace('fromLane="-1" toLane="-1"', 'fromLane="-2" toLane="-2"', 1), "signal lanes", "no driving lane"),
        (GOOD.replace('t="-5.8"', 't="-2.0"'), "signal place", "LibCarla moves it by"),
        (GOOD.replace('t="-5.8"', 't="-25.0"'), "signal place", "off the road"),
        (GOOD.replace('s="48.0"', 's="51.0"'), "signal place", "of a road of 50.00 m"),
        (GOOD.replace('id="8" s=', 'id="7" s='), "signal id", "2 signals have this id"),
        (GOOD.replace('signalId="8"', 'signalId="9"'), "controller", "switches signal 9, which does not exist"),
        (GOOD.replace('<controller id="77"/></junction>', "</junction>"), "controller", "belongs to no junction"),
        (GOOD.replace('dynamic="yes"', 'dynamic="no"'), "signal", "is a light but says"),
        (GOOD.replace('<cornerLocal u="-1.5" v="-3.5" z="0"/></outline>', "</outline>"), "crosswalk", "open outline"),
        (GOOD.replace('s="40" t="0" zOffset', 's="60" t="0" zOffset'), "object place", "stands at s=60.00"),
    ],
)
def test_a_mistake_is_found_and_named(text: str, kind: str, told: str) -> None:
    assert text != GOOD
    assert [finding for finding in found(text) if finding.kind == kind and told in finding.what]


def test_a_finding_says_where_and_how_much() -> None:
    gap, *_ = found(GOOD.replace('x="70" y="0" hdg="0"', 'x="70" y="0.05" hdg="0"'))
    assert gap.size == pytest.approx(0.05)
    assert (gap.road_id, gap.s_m, gap.x_m) == (2, 0.0, pytest.approx(70.0))
    assert str(gap).startswith("error gap road 2 s=0.00 (x=70.00, y=")


def crossing(height: float) -> str:
    """Two streets that cross in the open, the second one higher."""
    lanes = section(left=lane(1), right=lane(-1))
    under = road(1, 80.0, line(0, -40, 0, 0, 80), lanes)
    elevation = f'<elevation s="0" a="{height}" b="0" c="0" d="0"/>'
    over = road(2, 80.0, line(0, 0, -40, math.pi / 2, 80), lanes, elevation=elevation)
    return opendrive(under, over)


def test_streets_that_cross_on_the_level_overlap() -> None:
    (overlap,) = found(crossing(0.0))
    assert (overlap.kind, overlap.road_id) == ("overlap", 1)
    assert overlap.size > 1.0
    assert math.hypot(overlap.x_m, overlap.y_m) < 15.0


def test_a_bridge_does_not_overlap_the_street_below() -> None:
    assert found(crossing(6.0)) == []


def test_a_pavement_that_reaches_into_another_roads_lane_is_found() -> None:
    drive = road(1, 40.0, line(0, 0, 0, 0, 40), section(right=lane(-1)))
    walk = road(2, 10.0, line(0, 20, -8, math.pi / 2, 10), section(left=lane(1, "sidewalk", 1.5)))
    (overlap,) = found(opendrive(drive, walk))
    assert overlap.kind == "overlap"
    assert "driving lane -1 of road 1" in overlap.what
    assert "sidewalk lane 1 of road 2" in overlap.what


def test_roads_that_meet_end_to_end_do_not_overlap() -> None:
    first = road(
        1,
        30.0,
        line(0, 0, 0, 0, 30),
        section(right=lane(-1, link=follows(None, -1))),
        link=touches("successor", "road", 2, "start"),
    )
    second = road(
        2,
        30.0,
        line(0, 30, 0, 0, 30),
        section(right=lane(-1, link=follows(-1))),
        link=touches("predecessor", "road", 1, "end"),
    )
    assert found(opendrive(first, second)) == []


def test_a_lane_that_tapers_away_may_end_but_a_whole_one_may_not() -> None:
    def two_sections(end_width: float) -> str:
        taper = f'<width sOffset="0" a="3" b="{(end_width - 3.0) / 40.0}" c="0" d="0"/>'
        link = follows(None, -1)
        first = section(right=lane(-1, link=link) + lane(-2, widths=taper))
        return opendrive(road(1, 80.0, line(0, 0, 0, 0, 80), first + section(40.0, right=lane(-1, link=follows(-1)))))

    assert found(two_sections(0.0)) == []
    assert [finding.what for finding in found(two_sections(3.0))] == ["driving lane -2 leads nowhere"]


def test_lanes_that_do_not_name_each_other_are_found() -> None:
    first = road(
        1,
        30.0,
        line(0, 0, 0, 0, 30),
        section(right=lane(-1, link=follows(None, -1))),
        link=touches("successor", "road", 2, "start"),
    )
    second = road(
        2, 30.0, line(0, 30, 0, 0, 30), section(right=lane(-1)), link=touches("predecessor", "road", 1, "end")
    )
    assert [(finding.kind, finding.road_id) for finding in found(opendrive(first, second))] == [("lane link", 1)]


@pytest.mark.parametrize(("percent", "count"), [(14.9, 0), (15.1, 1), (-40.0, 1)])
def test_a_road_that_is_steeper_than_streets_are_is_found(percent: float, count: int) -> None:
    steep = f'<elevationProfile><elevation s="0" a="3" b="{percent / 100}" c="0" d="0"/></elevationProfile>'
    text = opendrive(road(1, 80.0, line(0, 0, 0, 0, 80), section(right=lane(-1)))).replace(
        "<lanes", f"{steep}<lanes", 1
    )
    assert [one.kind for one in found(text)] == ["grade"] * count
