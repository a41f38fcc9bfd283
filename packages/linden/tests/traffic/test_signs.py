"""What stop and yield signs tell whoever is under them: two streets that cross, cars of 4.6 m by 2 m."""

import math

import numpy as np
import pytest

from fleet import column
from linden.maps.records import GIVE_WAY
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.space import BoundingBox, Rotation, Vector3D
from linden.traffic.signs import CLEAR_S, STOP_S, BodyColumns, SignWatch, sign_rules
from linden.traffic.trigger_volumes import trigger_grid

RED, GREEN = int(TrafficLightState.RED), int(TrafficLightState.GREEN)
AT_SIGN, FAR, IN_THE_WAY = (-12.0, 0.0, 0.0), (-40.0, 0.0, 0.0), (0.0, 8.0, math.pi / 2.0)


def crossing(*, is_stop: bool) -> SignWatch:
    """A sign before x = -10 for who comes along x; who comes along y goes first."""
    volume = BoundingBox(Vector3D(-13.0, 0.0, 0.0), Vector3D(1.5, 0.9, 1.0), Rotation())
    squares = np.zeros(8, GIVE_WAY)
    squares["centre_m"][:, 1] = np.arange(-10.5, 11.0, 3.0)
    squares["half_m"] = 1.5
    return SignWatch(sign_rules(trigger_grid([(0, volume)]), np.array([is_stop]), [squares]))


class Cars:
    """Cars at (x, y, yaw), told by a sign at a time."""

    def __init__(self, watch: SignWatch, *places: tuple[float, float, float]) -> None:
        self._watch, self.places = watch, list(places)

    def told(self, now_s: float, actor_ids: list[int] | None = None) -> list[int]:
        count = len(self.places)
        position, rotation = np.zeros((count, 3)), np.zeros((count, 3))
        position[:, :2] = [place[:2] for place in self.places]
        rotation[:, 1] = [place[2] for place in self.places]
        box, half = np.tile([0.0, 0.0, 0.75], (count, 1)), np.tile([2.3, 1.0, 0.75], (count, 1))
        slots = np.arange(count, dtype=np.int32)
        ids = np.array(actor_ids or range(10, 10 + count), np.int32)
        columns = BodyColumns(*map(column, (position, rotation, box, half)))
        return self._watch.told(columns, slots, ids, now_s).tolist()


def test_a_stop_sign_is_red_for_two_seconds_and_then_green() -> None:
    cars = Cars(crossing(is_stop=True), AT_SIGN)
    assert [cars.told(now_s) for now_s in (5.0, 5.0 + STOP_S - 0.05, 5.0 + STOP_S)] == [[RED], [RED], [GREEN]]


def test_a_yield_sign_is_green_where_no_vehicle_comes() -> None:
    assert Cars(crossing(is_stop=False), AT_SIGN).told(0.0) == [GREEN]


def test_a_vehicle_under_no_sign_reads_green() -> None:
    assert Cars(crossing(is_stop=True), FAR).told(0.0) == [GREEN]


@pytest.mark.parametrize("is_stop", [True, False])
def test_a_vehicle_in_the_way_keeps_it_red_until_a_little_after_it_has_gone(
    is_stop: bool,  # noqa: FBT001 - pytest gives it by name
) -> None:
    cars = Cars(crossing(is_stop=is_stop), AT_SIGN, IN_THE_WAY)
    assert cars.told(10.0) == [RED, GREEN]
    assert cars.told(20.0) == [RED, GREEN]
    cars.places[1] = (0.0, 80.0, math.pi / 2.0)
    assert cars.told(20.0 + CLEAR_S - 0.05) == [RED, GREEN]
    assert cars.told(20.0 + CLEAR_S) == [GREEN, GREEN]


def test_a_vehicle_that_drives_on_reads_green_and_stops_again_the_next_time() -> None:
    cars = Cars(crossing(is_stop=True), AT_SIGN)
    cars.told(0.0)
    cars.places[0] = FAR
    assert cars.told(0.5) == [GREEN]
    cars.places[0] = AT_SIGN
    assert cars.told(9.0) == [RED]


def test_another_car_in_the_same_slot_has_to_stop_for_itself() -> None:
    cars = Cars(crossing(is_stop=True), AT_SIGN)
    cars.told(0.0, [7])
    assert cars.told(STOP_S, [7]) == [GREEN]
    assert cars.told(STOP_S, [8]) == [RED]


def test_a_vehicle_that_waits_at_the_same_sign_is_in_no_others_way() -> None:
    beside = (-12.0, 0.5, 0.0)
    assert Cars(crossing(is_stop=False), AT_SIGN, beside).told(0.0) == [GREEN, GREEN]


def test_asked_twice_at_the_same_time_it_says_the_same() -> None:
    cars = Cars(crossing(is_stop=True), AT_SIGN, IN_THE_WAY)
    assert cars.told(1.0) == cars.told(1.0)


def test_more_cars_may_come_later() -> None:
    watch = crossing(is_stop=True)
    Cars(watch, AT_SIGN).told(0.0)
    assert Cars(watch, AT_SIGN, FAR, IN_THE_WAY).told(STOP_S) == [RED, GREEN, GREEN]


def test_a_map_without_signs_changes_no_vehicle() -> None:
    nothing = SignWatch(sign_rules(trigger_grid([]), np.zeros(0, bool), []))
    assert Cars(nothing, AT_SIGN, FAR).told(0.0) == [GREEN, GREEN]
