"""Lamps are switched by clients and by the sun, and everybody is told."""

import numpy as np
import pytest

from linden.protocol.values.enums import LightGroup
from linden.protocol.values.episode import WeatherParameters
from linden.protocol.values.space import Vector3D
from linden.scenery.scene.lamp_states import Lamps, is_night
from linden.scenery.scene.objects import BOX, ObjectKind, Scene, things_with

NIGHT, DAY = WeatherParameters(sun_altitude_angle=-20.0), WeatherParameters(sun_altitude_angle=20.0)
LEFT_TO_THE_MAP = WeatherParameters(*[-1.0] * 10)


@pytest.fixture
def lamps() -> Lamps:
    things = things_with(ObjectKind.STREET_LAMP, np.array([[0.0, 0.0, 1.0], [9.0, 0.0, 2.0]]), np.zeros(2))
    return Lamps(Scene(things, np.zeros(0, BOX)))


def frames_that_tell(lamps: Lamps) -> int:
    count = 0
    for _ in range(10):
        lamps.turn_page()
        count += lamps.pending
    return count


def test_lamps_are_those_of_the_street_and_off_by_day(lamps: Lamps) -> None:
    assert [(lamp.id, lamp.location.z, lamp.group, lamp.active) for lamp in lamps.states()] == [
        (1, 1.0, LightGroup.STREET, False), (2, 2.0, LightGroup.STREET, False),
    ]  # fmt: skip
    assert frames_that_tell(lamps) == 0


def test_what_a_client_sets_reaches_all_clients_and_moves_no_lamp(lamps: Lamps) -> None:
    changed = lamps.states()[0]._replace(active=True, color=(1, 2, 3), location=Vector3D(7.0, 7.0, 7.0))
    assert lamps.update([changed, changed._replace(id=99)]) == [99]
    assert lamps.states()[0] == changed._replace(location=Vector3D(0.0, 0.0, 1.0))
    assert not lamps.pending
    assert frames_that_tell(lamps) == 3


def test_the_sun_switches_all_of_them_unless_that_is_switched_off(lamps: Lamps) -> None:
    lamps.follow_sun(NIGHT)
    assert all(lamp.active for lamp in lamps.states())
    assert frames_that_tell(lamps) == 3
    lamps.follow_sun(NIGHT)
    assert frames_that_tell(lamps) == 0
    lamps.day_night_cycle = False
    lamps.follow_sun(DAY)
    assert all(lamp.active for lamp in lamps.states())


def test_night_is_when_the_sun_is_down_but_not_when_the_weather_is_left_to_the_map() -> None:
    assert [is_night(weather) for weather in (NIGHT, DAY, LEFT_TO_THE_MAP, WeatherParameters())] == [
        True, False, False, False,
    ]  # fmt: skip
