"""Lidars and pictures of many worlds: those of the server's sensors in the same state, and refused with a sentence."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from linden.errors import UserError
from linden.maps.library import HOME_MAP, MapLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import VehicleControl, WalkerControl
from linden.protocol.values.enums import AttributeType, SemanticTag
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D
from linden.sensors.camera.cameras import Image
from linden.sensors.devices.lidar import Sweep
from linden.world import World
from linden.worlds import Worlds

CAR, SHUTTLE, WALKER, CONE = (
    "vehicle.tesla.model3",
    "vehicle.easymile.ez10",
    "walker.pedestrian.0003",
    "static.prop.trafficcone01",
)
ON_ROOF = [0.5, 0.1, 2.2, -3.0, 5.0, 0.0]
LIDAR: dict[str, Any] = {
    "channels": 8,
    "points_per_second": 8 * 90 * 20,
    "range": 60.0,
    "noise_stddev": 0.02,
    "noise_seed": 7,
}
DRIVEN = 30


@pytest.fixture(scope="module")
def maps() -> MapLibrary:
    library = MapLibrary()
    library.load(HOME_MAP)
    return library


def beside(maps: MapLibrary, along_m: float, up_m: float = 0.0) -> list[float]:
    """A pose so far ahead of spawn point 30."""
    (x, y, z), (pitch, yaw, roll) = maps.load(HOME_MAP).spawn_points[30]
    return [x + along_m * np.cos(np.radians(yaw)), y + along_m * np.sin(np.radians(yaw)), z + up_m, pitch, yaw, roll]


@pytest.fixture(scope="module")
def actors(maps: MapLibrary) -> list[tuple[str, list[float]]]:
    return [
        (CAR, beside(maps, 0.0)),
        (SHUTTLE, beside(maps, 14.0)),
        (WALKER, beside(maps, -6.0, 0.6)),
        (CONE, beside(maps, 6.0)),
    ]


@pytest.fixture(scope="module")
def worlds(maps: MapLibrary, actors: list[tuple[str, list[float]]]) -> Worlds:
    """Three worlds; in each a car drives with other pedals towards a shuttle, and a walker walks."""
    made = Worlds(count=3, maps=maps)
    for blueprint, pose in actors:
        made.spawn(blueprint, pose)
    for _ in range(DRIVEN):
        made.set_controls([[0.6, 0.0, 0.0], [0.9, 0.2, 0.0], [0.4, -0.2, 0.0]])
        made.set_walks([0.0, 1.0, 0.0], 1.4, slot=2)
        made.step()
    return made


@pytest.fixture(scope="module")
def measured(maps: MapLibrary, actors: list[tuple[str, list[float]]]) -> dict[str, Any]:
    """What the server's sensors on the car's roof measure in the state of world 0, by blueprint."""
    server = World(maps.load(HOME_MAP), EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05))
    for blueprint, pose in actors:
        server.spawn(ActorDescription(0, blueprint), Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])))
    car = next(record for record in server.episode.actors if record.description.id == CAR)
    place = Transform(Vector3D(*ON_ROOF[:3]), Rotation(*ON_ROOF[3:]))
    size = {"image_size_x": 70, "image_size_y": 50, "fov": 80.0}
    sensors = {
        "sensor.lidar.ray_cast": LIDAR | {"rotation_frequency": 20.0},
        "sensor.camera.depth": size,
        "sensor.camera.semantic_segmentation": size,
        "sensor.camera.rgb": size,
    }
    streams = [
        server.spawn(ActorDescription(0, name, given(asked)), place, parent_id=car.id).stream_id
        for name, asked in sensors.items()
    ]
    bodies = server.episode.bodies
    found: dict[str, Any] = {}
    for _ in range(DRIVEN):
        bodies.set_control(0, VehicleControl(0.6, 0.0, 0.0))
        bodies.set_walker_control(2, WalkerControl(Vector3D(y=1.0), 1.4))
        server.step(0.05)
        found = {"lidar before": found.get("sensor.lidar.ray_cast")} | {
            each.sensor.description.id: each.reading for each in server.measure(streams)
        }
    return found


def given(attributes: dict[str, float]) -> tuple[AttributeValue, ...]:
    return tuple(AttributeValue(name, AttributeType.STRING, str(value)) for name, value in attributes.items())


def picture(worlds: Worlds, kind: str) -> NDArray[Any]:
    return worlds.pictures(kind, ON_ROOF, size=(70, 50), fov=80.0)


def test_a_lidar_in_a_world_measures_what_the_server_measures(worlds: Worlds, measured: dict[str, Any]) -> None:
    sweep, before_deg = measured["sensor.lidar.ray_cast"], measured["lidar before"].horizontal_rad
    assert isinstance(sweep, Sweep)
    scans = worlds.lidar(ON_ROOF, start_deg=float(np.degrees(before_deg)), rotation_frequency=20.0, **LIDAR)
    assert scans.points.shape == (3, 8, 90, 4)
    assert len(sweep.points) > 100
    assert scans.points[0][scans.hit[0]].tobytes() == sweep.points.tobytes()
    assert scans.hit[0].sum(axis=1).tolist() == sweep.points_of_channel.tolist()
    assert not scans.points[~scans.hit].any()
    assert scans.points[1].tobytes() != scans.points[0].tobytes()


@pytest.mark.parametrize(
    ("kind", "blueprint", "shown"),
    [
        pytest.param("semantic", "sensor.camera.semantic_segmentation", lambda image: image[..., 2], id="semantic"),
        pytest.param("rgb", "sensor.camera.rgb", lambda image: image[..., 2::-1], id="rgb"),
    ],
)
def test_pictures_of_a_world_are_those_of_the_server(
    worlds: Worlds,
    measured: dict[str, Any],
    kind: str,
    blueprint: str,
    shown: Callable[[NDArray[np.uint8]], NDArray[np.uint8]],
) -> None:
    image = measured[blueprint]
    assert isinstance(image, Image)
    made = picture(worlds, kind)
    assert made[0].tobytes() == np.ascontiguousarray(shown(np.asarray(image.pixels, np.uint8))).tobytes()
    assert len(np.unique(made[0])) > 5
    assert made[1].tobytes() != made[0].tobytes()


def test_depth_is_that_of_the_server_in_metres(worlds: Worlds, measured: dict[str, Any]) -> None:
    blue, green, red = np.moveaxis(measured["sensor.camera.depth"].pixels[..., :3].astype(np.float64), -1, 0)
    server_m = 1000.0 * (red + 256.0 * green + 65536.0 * blue) / (2**24 - 1)
    depth_m = picture(worlds, "depth")
    assert depth_m.dtype == np.float32
    np.testing.assert_allclose(depth_m[0], server_m, rtol=1e-7)
    assert depth_m.min() < 12.0
    assert depth_m.max() == 1000.0


def test_each_body_is_seen_and_one_that_is_removed_is_not(maps: MapLibrary) -> None:
    worlds = Worlds(count=2, maps=maps)
    worlds.spawn(CAR, beside(maps, 0.0))
    worlds.spawn(SHUTTLE, beside(maps, 14.0), worlds=[1])
    tags = worlds.pictures("semantic", [2.5, 0.0, 1.4, 0.0, 0.0, 0.0])
    of_shuttle = (tags == int(SemanticTag.BUS)).sum(axis=(1, 2))
    assert of_shuttle[0] == 0
    assert of_shuttle[1] > 50
    worlds.bodies(1).remove(1)
    again = worlds.pictures("semantic", [2.5, 0.0, 1.4, 0.0, 0.0, 0.0])
    assert again[1].tobytes() == tags[0].tobytes()
    worlds.reset([1])
    assert worlds.pictures("semantic", [2.5, 0.0, 1.4, 0.0, 0.0, 0.0]).tobytes() == tags.tobytes()


def test_a_sensor_without_a_body_stands_in_the_world(worlds: Worlds, maps: MapLibrary) -> None:
    high = beside(maps, 7.0, 30.0)
    high[3] = -90.0
    above = worlds.pictures("semantic", high, slot=None)
    moved = worlds.pictures("semantic", [high, high, beside(maps, 7.0, 60.0)], slot=None)
    assert moved[:2].tobytes() == above[:2].tobytes()
    assert moved[2].tobytes() != above[2].tobytes()


def test_some_worlds_are_measured_as_all_are(worlds: Worlds) -> None:
    everything, some = worlds.lidar(ON_ROOF, **LIDAR), worlds.lidar(ON_ROOF, worlds=[2, 0], **LIDAR)
    assert some.points.tobytes() == everything.points[[2, 0]].tobytes()
    assert (
        picture(worlds, "depth")[1].tobytes()
        == worlds.pictures("depth", ON_ROOF, size=(70, 50), fov=80.0, worlds=[1])[0].tobytes()
    )


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        pytest.param(lambda w: w.lidar([np.nan] * 6), "transform .* must be finite", id="nan"),
        pytest.param(lambda w: w.lidar([0.0, 1.0]), r"transform .* needs the shape \(3, 6\) or \(6,\)", id="shape"),
        pytest.param(lambda w: w.lidar(ON_ROOF, slot=9), "slot is a whole number from 0 to 3", id="slot"),
        pytest.param(lambda w: w.lidar(ON_ROOF, worlds=[5]), "there are 3 worlds", id="world"),
        pytest.param(lambda w: w.lidar(ON_ROOF, worlds=[]), "worlds are whole numbers", id="no world"),
        pytest.param(lambda w: w.lidar(ON_ROOF, start_deg=400.0), "start_deg is an angle", id="angle"),
        pytest.param(lambda w: w.lidar(ON_ROOF, colour=3), "it has no attribute 'colour', only ", id="attribute"),
        pytest.param(lambda w: w.lidar(ON_ROOF, channels="many"), "'many' as channels", id="value"),
        pytest.param(lambda w: w.lidar(ON_ROOF, range=np.nan), "'nan' as range", id="nan range"),
        pytest.param(lambda w: w.pictures("xray", ON_ROOF), "no pictures of kind 'xray'; there are depth", id="kind"),
        pytest.param(lambda w: w.pictures("rgb", ON_ROOF, size=(0, 64)), "the width is a whole number from 1", id="0"),
        pytest.param(lambda w: w.pictures("rgb", ON_ROOF, size=64), "size is the width and the height", id="size"),
        pytest.param(lambda w: w.pictures("rgb", ON_ROOF, fov=200.0), "fov lies above 0 and below 180", id="fov"),
    ],
)
def test_what_cannot_be_measured_is_a_sentence(worlds: Worlds, call: Callable[[Worlds], Any], sentence: str) -> None:
    before = worlds.state.tobytes()
    with pytest.raises(UserError, match=sentence):
        call(worlds)
    assert worlds.state.tobytes() == before


def test_a_world_that_is_not_valid_is_refused_and_the_others_are_measured(maps: MapLibrary) -> None:
    worlds = Worlds(count=2, maps=maps)
    worlds.spawn(CAR, 30)
    worlds.bodies(1).position[0] = np.nan
    worlds.step()
    with pytest.raises(UserError, match="world 1 is not valid, since a body of it got lost; reset it or leave it out"):
        worlds.lidar(ON_ROOF)
    assert worlds.lidar(ON_ROOF, worlds=[0]).hit.any()


def test_a_body_without_a_look_is_refused(maps: MapLibrary) -> None:
    worlds = Worlds(count=2, maps=maps)
    worlds.spawn(CAR, 30)
    own = worlds.bodies(1)
    own.add_prop(Transform(Vector3D(0.0, 0.0, 300.0)), BoundingBox(Vector3D(), Vector3D(0.5, 0.5, 0.5)), 10.0)
    with pytest.raises(UserError, match="the body in slot 1 of world 1 was not made by `spawn`"):
        worlds.lidar(ON_ROOF)


def test_too_much_at_once_is_refused(maps: MapLibrary) -> None:
    worlds = Worlds(count=100, maps=maps)
    worlds.spawn(CAR, 30)
    with pytest.raises(UserError, match=r"100 worlds of 4000 x 4000 pixels take 6\.0 GiB, and 4 GiB are the most"):
        worlds.pictures("depth", ON_ROOF, size=(4000, 4000))
