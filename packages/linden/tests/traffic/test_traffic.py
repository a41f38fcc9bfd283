"""Lights and signs of a map as actors: a small crossing written out by hand."""

import math

import numpy as np
import pytest

from linden.errors import Refusal
from linden.maps.opendrive.give_way import give_way_areas
from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.signals import place as place_signals
from linden.protocol.values.enums import SemanticTag, TrafficLightState
from linden.protocol.values.snapshot import TRAFFIC_LIGHT_ROW
from linden.traffic.signal_actors import Signals
from linden.traffic.traffic import Traffic

RED, YELLOW, GREEN = TrafficLightState.RED, TrafficLightState.YELLOW, TrafficLightState.GREEN

LANES = """<lanes><laneSection s="0"><left><lane id="1" type="driving" level="false"><link>{left}</link>
<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left><center><lane id="0" type="none" level="false"/></center>
<right><lane id="-1" type="driving" level="false"><link>{right}</link>
<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>"""
ONE_LANE = """<lanes><laneSection s="0"><center><lane id="0" type="none" level="false"/></center><right>
<lane id="-1" type="driving" level="false"><link><predecessor id="-1"/><successor id="{exit}"/></link>
<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>"""


def signal(signal_id: str, kind: str, s: float = 98.0, value: str = "-1", name: str = "") -> str:
    return f"""<signal id="{signal_id}" name="{name}" s="{s}" t="-5" zOffset="3" hOffset="0" dynamic="no"
    orientation="-" country="OpenDRIVE" type="{kind}" subtype="-1" value="{value}" height="1" width="1">
    <validity fromLane="-1" toLane="-1"/></signal>"""


def arm(road: int, heading: float, signals: str) -> str:
    """A street of 100 m that ends 10 m before the middle of the crossing, driven towards it on lane -1."""
    x, y = -110.0 * math.cos(heading), -110.0 * math.sin(heading)
    lanes = LANES.format(left="", right="")
    return f"""<road name="" length="100" id="{road}" junction="-1"><link><successor elementType="junction"
    elementId="100"/></link><planView><geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="100"><line/></geometry>
    </planView>{lanes}<signals>{signals}</signals></road>"""


def crossing_lane(road: int, heading: float, start: int, end: int) -> str:
    """Straight across from one arm to the opposite one."""
    x, y = -10.0 * math.cos(heading), -10.0 * math.sin(heading)
    return f"""<road name="" length="20" id="{road}" junction="100"><link><predecessor elementType="road"
    elementId="{start}" contactPoint="end"/><successor elementType="road" elementId="{end}" contactPoint="end"/></link>
    <planView><geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="20"><line/></geometry></planView>
    {ONE_LANE.format(exit="1")}</road>"""


def crossing(*signals_of_arms: str) -> Traffic:
    quarter = math.pi / 2
    arms = "".join(arm(i + 1, i * quarter, signals) for i, signals in enumerate(signals_of_arms))
    lanes = "".join(crossing_lane(11 + i, i * quarter, i + 1, (i + 2) % 4 + 1) for i in range(4))
    links = "".join(
        f"""<connection id="{i}" incomingRoad="{i + 1}" connectingRoad="{11 + i}" contactPoint="start">
        <laneLink from="-1" to="-1"/></connection>"""
        for i in range(4)
    )
    text = f"""<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4" name="" north="0" south="0" east="0"
    west="0"/>{arms}{lanes}<controller id="8" name="across" sequence="2"><control signalId="north"/>
    <control signalId="south"/></controller><controller id="9" name="along" sequence="1"><control signalId="east"/>
    <control signalId="west"/></controller><junction id="100" name="">{links}<controller id="8" type="0"/>
    <controller id="9" type="0"/></junction></OpenDRIVE>"""
    opendrive = parse(text)
    placed = place_signals(opendrive)
    return Traffic(Signals.of(placed, opendrive.controllers, give_way_areas(opendrive, placed)))


LIGHT = "1000001"


@pytest.fixture
def traffic() -> Traffic:
    return crossing(
        signal("east", LIGHT) + signal("limit", "274", s=20, value="25"),
        signal("north", LIGHT) + signal("stop", "206") + signal("painted", "206", name="Stencil_STOP"),
        signal("west", LIGHT) + signal("yield", "205"),
        signal("south", LIGHT) + signal("camera", "1000099") + signal("alone", "1000002"),
    )


def light(traffic: Traffic, sign_id: str) -> int:
    return next(actor.light for actor in traffic.actors if actor.sign_id == sign_id)


def colours(traffic: Traffic) -> dict[str, int]:
    return {traffic.actors[index].sign_id: int(traffic.state.colour[n]) for n, index in enumerate(traffic.lights)}


def test_signals_become_actors_named_as_carla_names_them(traffic: Traffic) -> None:
    assert {actor.sign_id: actor.type_id for actor in traffic.actors} == {
        "east": "traffic.traffic_light",
        "north": "traffic.traffic_light",
        "west": "traffic.traffic_light",
        "south": "traffic.traffic_light",
        "alone": "traffic.traffic_light",
        "limit": "traffic.speed_limit.25",
        "stop": "traffic.stop",
        "yield": "traffic.yield",
        "camera": "traffic.unknown",
    }


def test_lights_and_signs_carry_their_tags(traffic: Traffic) -> None:
    for actor in traffic.actors:
        tag = SemanticTag.TRAFFIC_LIGHT if actor.light >= 0 else SemanticTag.TRAFFIC_SIGNS
        assert actor.semantic_tags == bytes([tag])


def test_lights_come_first_in_the_order_of_the_map(traffic: Traffic) -> None:
    assert [actor.light for actor in traffic.actors] == [0, 1, 2, 3, 4, -1, -1, -1, -1]
    assert [traffic.actors[index].sign_id for index in traffic.lights] == ["east", "north", "west", "south", "alone"]


def test_the_controllers_of_a_junction_form_one_group(traffic: Traffic) -> None:
    assert traffic.group(light(traffic, "south")) == (0, 1, 2, 3)
    assert traffic.group(light(traffic, "alone")) == (4,)
    assert [traffic.pole_index(number) for number in range(5)] == [0, 1, 2, 3, 0]


def test_turns_follow_the_sequence_of_the_controllers(traffic: Traffic) -> None:
    assert colours(traffic) == {"east": GREEN, "west": GREEN, "north": RED, "south": RED, "alone": GREEN}
    for _ in range(18):
        traffic.step(1.0)
    assert colours(traffic) == {"east": RED, "west": RED, "north": GREEN, "south": GREEN, "alone": RED}


def test_a_light_without_controller_is_red_for_ten_seconds(traffic: Traffic) -> None:
    shown = []
    for _ in range(40):
        traffic.step(1.0)
        shown.append(colours(traffic)["alone"])
    assert shown == [GREEN] * 10 + [YELLOW] * 4 + [RED] * 11 + [GREEN] * 11 + [YELLOW] * 4


def place(traffic: Traffic, x: float, y: float, yaw_deg: float) -> int:
    """Return the light over a car of 4.8 m by 2 m."""
    position, rotation = np.array([[x, y, 0.0]]), np.radians([[0.0, yaw_deg, 0.0]])
    box_centre, half_extent = np.array([[0.0, 0.0, 0.7]]), np.array([[2.4, 1.0, 0.7]])
    return int(traffic.over(position, rotation, box_centre, half_extent, np.array([0], np.int32))[0])


def test_a_car_before_the_line_is_under_its_light_and_one_behind_it_is_not(traffic: Traffic) -> None:
    east = light(traffic, "east")  # its line lies at x = -12 m, the lane's middle at y = 1.75 m
    assert place(traffic, -15.0, 1.75, 0.0) == east
    assert place(traffic, -18.8, 1.75, 0.0) == east
    assert place(traffic, -19.2, 1.75, 0.0) == -1
    assert place(traffic, -10.0, 1.75, 0.0) == -1
    assert place(traffic, -15.0, -1.75, 180.0) == -1


def test_the_trigger_volume_lies_across_the_lane_before_the_line(traffic: Traffic) -> None:
    north = next(actor for actor in traffic.actors if actor.sign_id == "north")
    assert north.transform.rotation.yaw % 360 == pytest.approx(0.0, abs=1e-6)  # northward is -90, turned by 90
    centre_y = north.transform.location.y + north.box.location.y
    centre_x = north.transform.location.x + north.box.location.x
    assert (centre_x, centre_y) == pytest.approx((1.75, 12.0 + 3.0), abs=0.02)
    assert north.box.extent.x == pytest.approx(0.5 * 3.5 / 2, abs=0.01)
    assert north.box.extent.y == pytest.approx(1.5)


def test_rows_of_the_snapshot_show_colours_times_and_freezing(traffic: Traffic) -> None:
    traffic.set_time(light(traffic, "north"), GREEN, 7.5)
    traffic.set_colour(light(traffic, "alone"), TrafficLightState.OFF)
    traffic.freeze(light(traffic, "alone"), frozen=True)
    traffic.step(0.5)
    rows = np.zeros(5, TRAFFIC_LIGHT_ROW)
    traffic.write(rows)
    assert rows["state"].tolist() == [GREEN, RED, GREEN, RED, TrafficLightState.OFF]
    assert rows["frozen"].tolist() == [0, 0, 0, 0, 1]
    assert rows["green_time"].tolist() == [10.0, 7.5, 10.0, 7.5, 10.0]
    assert rows["yellow_time"].tolist() == [3.0] * 5
    assert rows["red_time"].tolist() == [2.0, 2.0, 2.0, 2.0, 10.0]
    assert rows["elapsed_time"].tolist() == [0.5, 0.0, 0.5, 0.0, 0.0]


@pytest.mark.parametrize("seed", range(5))
def test_rows_written_from_call_to_call_are_as_if_written_at_once(traffic: Traffic, seed: int) -> None:
    random = np.random.default_rng(seed)
    rows = np.zeros(5, TRAFFIC_LIGHT_ROW)
    for _ in range(60):
        number, choice = int(random.integers(5)), int(random.integers(8))
        if choice == 0:
            traffic.set_time(number, YELLOW, float(random.uniform(1, 5)))
        elif choice == 1:
            traffic.set_colour(number, TrafficLightState.OFF)
        elif choice == 2:
            traffic.freeze(number, frozen=bool(random.integers(2)))
        elif choice == 3:
            traffic.reset_group(number)
        else:
            traffic.step(1.5)
        traffic.write(rows)
    fresh = np.zeros(5, TRAFFIC_LIGHT_ROW)
    traffic._shown = None
    traffic.write(fresh)
    assert rows.tobytes() == fresh.tobytes()


def test_freezing_and_resetting_reach_one_group_or_all(traffic: Traffic) -> None:
    traffic.freeze_all(frozen=True)
    for _ in range(30):
        traffic.step(1.0)
    assert traffic.state.elapsed_s.tolist() == [0.0, 0.0]
    traffic.freeze_all(frozen=False)
    for _ in range(12):
        traffic.step(1.0)
    traffic.reset_group(light(traffic, "west"))
    assert colours(traffic) == {"east": GREEN, "west": GREEN, "north": RED, "south": RED, "alone": YELLOW}
    traffic.reset_all()
    assert colours(traffic)["alone"] == GREEN


@pytest.mark.parametrize("time_s", [-1.0, math.nan, math.inf])
def test_a_time_that_cannot_pass_is_refused(traffic: Traffic, time_s: float) -> None:
    with pytest.raises(Refusal, match="a light cannot be green for"):
        traffic.set_time(0, GREEN, time_s)


def test_off_lasts_for_no_time(traffic: Traffic) -> None:
    with pytest.raises(Refusal, match="not off"):
        traffic.set_time(0, TrafficLightState.OFF, 1.0)


def test_a_map_without_signals_steps_and_has_no_vehicle_under_a_light() -> None:
    empty = crossing("", "", "", "")
    empty.step(1.0)
    assert empty.actors == ()
    assert place(empty, 0.0, 0.0, 0.0) == -1
