"""Claims about orders of pages that change a running world."""

from types import SimpleNamespace

import pytest

from linden.protocol.values.episode import EpisodeSettings
from linden.server.frame_clock import FrameClock
from linden.world import World
from linden_window.control import FASTEST, carry_out
from linden_window.errands import Errands


@pytest.fixture
def context(world: World) -> SimpleNamespace:
    return SimpleNamespace(world=world, frame_is_due=False)


def order(context: SimpleNamespace, clock: FrameClock, **values: object) -> str:
    return carry_out(values, context, clock, Errands(context.world, print))


def test_a_pause_stops_the_clock_and_a_step_makes_one_frame(context: SimpleNamespace) -> None:
    clock = FrameClock(0.0)
    order(context, clock, order="pause", on=True)
    assert clock.wait_s(100.0, 0.05) == float("inf")
    order(context, clock, order="step")
    assert clock.wait_s(100.0, 0.05) == 0.0
    clock.frame_made(100.0, 0.05)
    assert clock.wait_s(200.0, 0.05) == float("inf")
    order(context, clock, order="pause", on=False)
    assert clock.wait_s(200.0, 0.05) == 0.0


def test_a_client_that_ticks_keeps_time_for_itself(context: SimpleNamespace) -> None:
    context.world.settings = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)
    clock = FrameClock(0.0)
    for values in ({"order": "pause", "on": True}, {"order": "step"}, {"order": "speed", "value": 2}):
        assert "synchronous mode" in carry_out(values, context, clock, Errands(context.world, print))
    assert (clock.is_paused, clock.speed) == (False, 1.0)


def test_the_speed_has_limits(context: SimpleNamespace) -> None:
    clock = FrameClock(0.0)
    order(context, clock, order="speed", value=1e9)
    assert clock.speed == FASTEST
    assert clock.wait_s(0.0, 0.08) == pytest.approx(0.08 / FASTEST)


def test_a_click_spawns_above_the_place(context: SimpleNamespace) -> None:
    x, y, z = context.world.spawn_points[0].location
    said = order(context, FrameClock(0.0), order="spawn", type="vehicle.tesla.model3", place=[x, y, z], yaw=30.0)
    assert "is spawned" in said
    (car,) = [record for record in context.world.episode.actors if record.description.id == "vehicle.tesla.model3"]
    assert context.world.episode.transform(car.id).rotation.yaw == pytest.approx(30.0)
    assert "destroyed" in order(context, FrameClock(0.0), order="destroy", id=car.id)
    assert car.id not in context.world.episode.actors


def test_weather_changes_what_is_named_and_nothing_else(context: SimpleNamespace) -> None:
    before = context.world.episode.weather
    order(context, FrameClock(0.0), order="weather", values={"precipitation": 60.0, "unknown": 1.0})
    assert context.world.episode.weather == before._replace(precipitation=60.0)


@pytest.mark.parametrize(
    "values",
    [
        {"order": "spawn", "type": "vehicle.none", "place": [0, 0, 0], "yaw": 0},
        {"order": "spawn", "type": "sensor.camera.rgb", "place": [0, 0, 0], "yaw": 0},
        {"order": "spawn", "type": "vehicle.tesla.model3", "place": [0, "x", 0], "yaw": 0},
        {"order": "spawn", "type": "vehicle.tesla.model3", "place": [float("nan"), 0, 0], "yaw": 0},
        {"order": "spawn"},
        {"order": "weather", "values": {"cloudiness": None}},
        {"order": "weather", "values": 3},
        {"order": "destroy", "id": 10**6},
        {"order": "speed", "value": "fast"},
    ],
)
def test_an_order_that_cannot_be_carried_out_gets_a_sentence_and_changes_nothing(
    context: SimpleNamespace, values: dict[str, object]
) -> None:
    before = len(context.world.episode.actors), context.world.episode.weather
    said = carry_out(values, context, FrameClock(0.0), Errands(context.world, print))
    assert len(said) > 20
    assert (len(context.world.episode.actors), context.world.episode.weather) == before


def test_an_unknown_order_does_nothing(context: SimpleNamespace) -> None:
    assert order(context, FrameClock(0.0), order="drive") == ""
