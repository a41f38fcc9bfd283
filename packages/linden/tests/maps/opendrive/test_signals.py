"""Claims about signals: LibCarla's places, and trigger boxes that those who read them understand."""

import math
from importlib import resources
from itertools import pairwise

import carla
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.signals import place
from linden.maps.records import PlacedSignal
from opendrive_texts import lane, line, opendrive, road, section, signal, street_through_junction

LINDEN = (resources.files("linden") / "data" / "Linden.xodr").read_text()


def the_only(text: str) -> PlacedSignal:
    (placed,) = place(parse(text))
    return placed


def box_points(placed: PlacedSignal, nth: int = 0) -> list[carla.Location]:
    """Where the leaderboard looks for the lanes of a light: along x of the box, a metre apart, at the box's height."""
    (x, y, z), (pitch, yaw, roll) = placed.transform
    pose = carla.Transform(carla.Location(x, y, z), carla.Rotation(pitch, yaw, roll))
    box = placed.trigger_volumes[nth]
    middle = pose.transform(carla.Location(*box.location))
    reach = np.arange(-0.9 * box.extent.x, 0.9 * box.extent.x, 1.0)
    turn = math.radians(yaw)
    return [middle + carla.Location(math.cos(turn) * step, math.sin(turn) * step, 0.0) for step in reach]


@settings(max_examples=60)
@given(
    st.floats(1.0, 49.0),
    st.integers(-80, 80).map(lambda nth: nth / 10.0 + 0.0137),  # never just where a push more or less decides
    st.floats(-3.2, 3.2),
    st.floats(0.0, 3.0),
    st.sampled_from(["206", "205", "1000001", "274"]),
)
def test_signals_stand_where_libcarla_puts_them(s: float, t: float, turn: float, lift: float, kind: str) -> None:
    sign = (
        signal("5", s, t, kind)
        .replace('hOffset="0"', f'hOffset="{turn!r}"')
        .replace('zOffset="0"', f'zOffset="{lift!r}"')
    )
    text = street_through_junction(signals=sign)
    (theirs,) = carla.Map("test", text).get_all_landmarks_of_type(kind)
    ours = the_only(text).landmark
    assert (
        math.dist(
            ours.location, (theirs.transform.location.x, theirs.transform.location.y, theirs.transform.location.z)
        )
        < 0.01
    )
    assert abs(math.remainder(ours.rotation.yaw - theirs.transform.rotation.yaw, 360.0)) < 0.1


def test_a_signal_with_a_place_of_its_own_stays_there() -> None:
    own = '<positionInertial x="12" y="3" z="4" hdg="0.5" pitch="0" roll="0"/>'
    text = street_through_junction(signals=signal("5", 20.0, 0.0, lanes=own))
    placed = the_only(text)
    assert placed.landmark.location == pytest.approx((12.0, -3.0, 4.0))
    assert placed.transform.rotation.yaw == pytest.approx(90.0 - math.degrees(0.5))


def test_the_actor_stands_upright_and_turned_as_carlas_models_are() -> None:
    placed = the_only(street_through_junction(signals=signal("5", 45.0, -5.5)))
    assert placed.transform.rotation == pytest.approx((0.0, 90.0, 0.0))
    assert placed.transform.location == placed.landmark.location


def test_lindens_signals_stand_where_libcarla_puts_them() -> None:
    landmarks = {mark.id: mark.transform for mark in carla.Map("Linden", LINDEN).get_all_landmarks()}
    placed = place(parse(LINDEN))
    assert {signal.signal_id for signal in placed} == set(landmarks)
    for ours in placed:
        theirs = landmarks[ours.signal_id]
        assert math.dist(ours.landmark.location, (theirs.location.x, theirs.location.y, theirs.location.z)) < 0.02


def test_the_box_lies_before_the_line_in_its_own_lane() -> None:
    placed = the_only(street_through_junction(signals=signal("5", 48.0, -5.5)))
    (box,) = placed.trigger_volumes
    # 1.5 m before the line begins a box of 3 m; the actor looks south, so its x axis points to the right of the traffic
    assert box.extent == pytest.approx((0.25 * 3.5, 1.5, 1.0))
    assert [(round(p.x, 2), round(p.y, 2)) for p in box_points(placed)] == [(45.0, 0.96), (45.0, 1.96)]


def test_one_box_covers_all_lanes_of_an_approach() -> None:
    both = '<validity fromLane="-2" toLane="-1"/>'
    text = opendrive(
        road(
            3,
            40.0,
            line(0, 0, 0, 0, 40),
            section(left=lane(1), right=lane(-1) + lane(-2)),
            more=f"<signals>{signal('8', 38.0, -9.0, '1000001', lanes=both)}</signals>",
        )
    )
    placed = the_only(text)
    assert [(lane.lane_id, lane.s_m) for lane in placed.lanes] == [(-1, 38.0), (-2, 38.0)]
    (box,) = placed.trigger_volumes
    assert box.extent.x == pytest.approx(3.5 - 0.25 * 3.5)
    theirs = carla.Map("test", text)
    assert {theirs.get_waypoint(point).lane_id for point in box_points(placed)} == {-1, -2}


def test_lanes_against_each_other_get_a_box_each() -> None:
    everyone = '<validity fromLane="-1" toLane="1"/>'
    placed = the_only(street_through_junction(signals=signal("5", 25.0, -5.5, lanes=everyone)))
    assert [lane.lane_id for lane in placed.lanes] == [1, -1]
    xs = sorted(box_points(placed, nth)[0].x for nth in range(2))
    assert xs == pytest.approx([22.0, 28.0])


def test_a_signal_inside_a_junction_acts_on_the_lane_that_leads_there() -> None:
    text = street_through_junction()
    inside = f"<signals>{signal('6', 1.0, -4.0, '1000001')}</signals></road>"
    head, _, tail = text.partition('id="10" junction="100"')
    placed = the_only(head + 'id="10" junction="100"' + tail.replace("</road>", inside, 1))
    assert [(lane.road_id, lane.lane_id) for lane in placed.lanes] == [(10, -1)]
    assert placed.junction_id == 100
    assert box_points(placed)[0].x == pytest.approx(47.0)


def test_a_reference_from_another_road_adds_its_lanes() -> None:
    reference = (
        '<signalReference s="5" t="0" id="5" orientation="+"><validity fromLane="1" toLane="1"/></signalReference>'
    )
    text = street_through_junction(signals=signal("5", 45.0, -5.5))
    head, _, tail = text.partition('id="2" junction="-1"')
    placed = the_only(
        head + 'id="2" junction="-1"' + tail.replace("</road>", f"<signals>{reference}</signals></road>", 1)
    )
    assert {(lane.road_id, lane.lane_id) for lane in placed.lanes} == {(1, -1), (2, 1)}
    assert len(placed.trigger_volumes) == 2


@pytest.mark.parametrize(("orientation", "lanes"), [("+", {1}), ("-", {-1}), ("none", {1, -1})])
def test_without_validity_the_orientation_decides_as_libcarla_has_it(orientation: str, lanes: set[int]) -> None:
    text = street_through_junction(
        signals=signal("5", 45.0, -5.5, lanes="").replace('orientation="+"', f'orientation="{orientation}"')
    )
    assert {lane.lane_id for lane in the_only(text).lanes} == lanes
    (theirs,) = carla.Map("test", text).get_all_landmarks()
    spoken = {n for low, high in theirs.get_lane_validities() for n in range(min(low, high), max(low, high) + 1)}
    assert lanes <= spoken


def test_signals_know_their_junction_and_controllers() -> None:
    switched = (
        '<controller id="77" name="phase"><control signalId="5" type="0"/></controller>|<controller id="77" type="0"/>'
    )
    light = the_only(street_through_junction(signals=signal("5", 48.0, -5.5, "1000001"), controllers=switched))
    assert (light.is_light, light.is_dynamic, light.controllers, light.junction_id) == (True, True, ("77",), 100)
    stop = the_only(street_through_junction(signals=signal("5", 48.0, -5.5)))
    assert (stop.is_light, stop.controllers, stop.junction_id) == (False, (), 100)


def test_roadrunners_speed_objects_are_signs_for_libcarla_and_for_us() -> None:
    stencil = '<object id="31" name="Speed_30" s="20" t="-5" zOffset="0" hdg="0" orientation="-" type="-1"/>'
    text = street_through_junction(objects=stencil)
    placed = the_only(text)
    (theirs,) = carla.Map("test", text).get_all_landmarks()
    assert (placed.signal_id, placed.type, placed.value, placed.unit) == (
        theirs.id,
        theirs.type,
        theirs.value,
        theirs.unit,
    )


def test_stop_lines_found_from_lindens_boxes_lie_in_the_lanes_the_signs_speak_to() -> None:
    """As TrafficLight.get_stop_waypoints and the leaderboard do it: from the box's points to the lanes."""
    theirs = carla.Map("Linden", LINDEN)
    guarded = [placed for placed in place(parse(LINDEN)) if placed.trigger_volumes]
    assert len(guarded) > 100
    for placed in guarded:
        lanes = {(lane.road_id, lane.lane_id) for lane in placed.lanes}
        found = [theirs.get_waypoint(point) for point in box_points(placed)]
        assert {(waypoint.road_id, waypoint.lane_id) for waypoint in found} == lanes
        assert not any(waypoint.is_junction for waypoint in found)


def test_the_box_lies_square_to_an_actor_that_faces_the_traffic() -> None:
    towards = signal("5", 48.0, -5.5).replace('hOffset="0"', 'hOffset="3.141592653589793"')
    boxes = [
        the_only(street_through_junction(signals=sign)).trigger_volumes[0]
        for sign in (towards, signal("5", 48.0, -5.5))
    ]
    for box in boxes:
        assert box.rotation.yaw == pytest.approx(0.0, abs=1e-9)
    assert all(one.extent == pytest.approx(other.extent) for one, other in pairwise(boxes))
