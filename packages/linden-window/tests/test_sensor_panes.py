"""Claims about measurements of a world's sensors in the pages."""

import json
from typing import Any

import numpy as np
import pytest

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform, Vector3D
from linden.world import World
from linden_window import panes, sensor_panes
from linden_window.measured import tag_colours
from linden_window.sensor_panes import SensorPanes

ABOVE = Transform(Vector3D(0.0, 0.0, 2.0))
MOUNTED = ("camera.rgb", "lidar.ray_cast", "lidar.ray_cast_semantic", "other.radar", "other.imu", "other.gnss")


def unpacked(pane: bytes) -> tuple[dict[str, Any], bytes]:
    _, length = panes.HEADER.unpack_from(pane)
    return json.loads(pane[8 : 8 + length]), pane[8 + length :]


@pytest.fixture
def streams(world: World) -> dict[str, int]:
    """Name of a pane -> stream, of the sensors of a car."""
    car = world.spawn(ActorDescription(0, "vehicle.tesla.model3"), world.spawn_points[0])
    made = [world.spawn(ActorDescription(0, f"sensor.{each}"), ABOVE, parent_id=car.id) for each in MOUNTED]
    return {f"{each.description.id.rpartition('.')[2]} {each.id}": each.stream_id for each in made}


def test_each_kind_of_sensor_has_a_pane_and_only_those_asked_for(world: World, recorder, streams) -> None:
    shown = SensorPanes(world, recorder)
    names = list(streams)
    for _ in range(2):
        world.step(0.05)
        measured = world.measure(frozenset(streams.values()))
    shown.after_frame(measured)
    assert recorder.panes == []
    shown.wish(1, names[:-1])
    shown.after_frame(measured)
    heads = {name: unpacked(pane) for name, pane in recorder.panes}
    assert sorted(heads) == sorted(names[:-1])
    camera, lidar, semantic, radar, imu = (heads[name] for name in names[:-1])
    assert (camera[0]["kind"], len(camera[1])) == ("picture", 3 * camera[0]["width"] * camera[0]["height"])
    assert [head["kind"] for head, _ in (lidar, semantic, radar, imu)] == ["points", "points", "points", "lines"]
    assert lidar[0]["count"] > 100
    colours = {tuple(row) for row in np.frombuffer(semantic[1], panes.POINT)["colour"].tolist()}
    assert colours <= {tuple(row) for row in tag_colours(np.arange(30)).tolist()}
    values = {line["name"]: line["value"] for line in imu[0]["lines"]}
    assert values["Acceleration z"].startswith("+")


def test_a_sensor_is_sent_ten_times_a_second_until_the_page_closes_its_pane(
    world: World, recorder, streams, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock_s = 0.0
    monkeypatch.setattr(sensor_panes.time, "monotonic", lambda: clock_s)
    shown = SensorPanes(world, recorder)
    *_, gnss = streams
    shown.wish(1, [gnss])
    shown.wish(2, "no list")
    for _ in range(20):
        world.step(0.02)
        clock_s += 0.02
        shown.after_frame(world.measure(frozenset([streams[gnss]])))
    assert len(recorder.panes) == 4
    head, _ = unpacked(recorder.panes[0][1])
    assert [line["name"] for line in head["lines"]][1:] == ["Longitude", "Altitude"]
    shown.wish(1, None)
    shown.after_frame(world.measure(frozenset([streams[gnss]])))
    assert len(recorder.panes) == 4
