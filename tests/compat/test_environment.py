"""Weather, lamps and drawn shapes through the official client."""

import time
from collections.abc import Callable

import carla
import pytest

from servers import RunningServer

PARTS = [name for name in dir(carla.WeatherParameters()) if isinstance(getattr(carla.WeatherParameters(), name), float)]
PRESETS = [name for name in dir(carla.WeatherParameters) if name[0].isupper()]
PATIENCE_S = 10.0


def eventually(true: Callable[[], bool], world: carla.World) -> bool:
    """Tick until something holds that the client learns of by itself, between ticks, in a thread of its own."""
    end_s = time.monotonic() + PATIENCE_S
    while not true() and time.monotonic() < end_s:
        world.tick()
    return true()


def lit(manager: carla.LightManager) -> int:
    return len(manager.get_turned_on_lights(carla.LightGroup.Street))


@pytest.mark.parametrize("name", PRESETS)
def test_every_weather_comes_back_as_it_was_set(world, name: str) -> None:
    preset = getattr(carla.WeatherParameters, name)
    world.set_weather(preset)
    back = world.get_weather()
    assert {part: getattr(back, part) for part in PARTS} == {part: getattr(preset, part) for part in PARTS}


def test_an_episode_begins_by_day_and_forgets_the_last_one_s_weather(client, world) -> None:
    first = world.get_weather()
    assert first.sun_altitude_angle > 0.0
    world.set_weather(carla.WeatherParameters.HardRainNight)
    assert client.reload_world().get_weather() == first


def test_lamps_stand_along_the_streets_and_burn_by_night(world) -> None:
    manager = world.get_lightmanager()
    lamps = manager.get_all_lights(carla.LightGroup.Street)
    assert len(lamps) == len(manager.get_all_lights()) > 500
    assert lit(manager) == 0
    world.set_weather(carla.WeatherParameters.ClearNight)
    assert eventually(lambda: lit(manager) == len(lamps), world)
    world.set_weather(carla.WeatherParameters.Default)
    assert eventually(lambda: lit(manager) == 0, world)


def test_lamps_that_are_left_to_the_client_do_not_follow_the_sun(world) -> None:
    manager = world.get_lightmanager()
    manager.set_day_night_cycle(False)
    manager.turn_on(manager.get_all_lights()[:2])
    world.set_weather(carla.WeatherParameters.ClearNight)
    for _ in range(10):
        world.tick()
    assert lit(manager) == 2
    manager.set_day_night_cycle(True)
    assert eventually(lambda: lit(manager) > 500, world)


def test_another_client_sees_what_one_has_done_to_lamps(world, server: RunningServer) -> None:
    ours, other = world.get_lightmanager(), carla.Client("127.0.0.1", server.port)
    other.set_timeout(PATIENCE_S)
    theirs = other.get_world().get_lightmanager()
    lamps = ours.get_all_lights()[:3]
    ours.set_color(lamps, carla.Color(10, 20, 30))
    ours.set_intensities(lamps, [100.0, 200.0, 300.0])
    ours.set_light_group(lamps, carla.LightGroup.Building)
    ours.turn_on(lamps)
    assert eventually(lambda: len(theirs.get_turned_on_lights(carla.LightGroup.Building)) == 3, world)
    seen = theirs.get_all_lights(carla.LightGroup.Building)
    assert [(lamp.id, lamp.intensity) for lamp in seen] == [
        (lamp.id, power) for lamp, power in zip(lamps, (100.0, 200.0, 300.0), strict=True)
    ]
    assert all((lamp.color.r, lamp.color.g, lamp.color.b) == (10, 20, 30) for lamp in seen)
    assert all(lamp.location == known.location for lamp, known in zip(seen, lamps, strict=True))


def test_every_shape_can_be_drawn_and_cleared(world, server: RunningServer) -> None:
    before, debug = server.log(), world.debug
    here, there = carla.Location(1.0, 2.0, 3.0), carla.Location(4.0, 5.0, 6.0)
    box, turn = carla.BoundingBox(here, carla.Vector3D(1.0, 1.0, 1.0)), carla.Rotation(0.0, 30.0, 0.0)
    for life_s in (-1.0, 0.0, 0.5):
        debug.draw_point(here, 0.2, carla.Color(0, 255, 0), life_s)
        debug.draw_line(here, there, 0.1, carla.Color(0, 255, 0), life_s)
        debug.draw_arrow(here, there, 0.1, 0.2, carla.Color(0, 255, 0), life_s)
        debug.draw_box(box, turn, 0.1, carla.Color(0, 255, 0), life_s)
        debug.draw_string(here, "here", False, carla.Color(0, 255, 0), life_s)
        debug.draw_hud_point(here, 2.0, carla.Color(0, 255, 0), life_s)
        debug.draw_hud_line(here, there, 1.0, carla.Color(0, 255, 0), life_s)
        debug.draw_hud_arrow(here, there, 1.0, 2.0, carla.Color(0, 255, 0), life_s)
        debug.draw_hud_box(box, turn, 1.0, carla.Color(0, 255, 0), life_s)
        world.tick()
    debug.clear_debug_shape()
    debug.clear_debug_string()
    world.tick()
    assert server.log() == before  # refusals of calls without answers are told there
