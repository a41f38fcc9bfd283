"""Cameras through the official client: what they see agrees with what the client knows of the world."""

import queue
from collections.abc import Iterator
from typing import NamedTuple

import carla
import numpy as np
import pytest
from numpy.typing import NDArray

from spawn_points import spawn_point

WIDTH, HEIGHT, FOV = 320, 240, 90.0
FOCAL = WIDTH / 2.0
KINDS = ("depth", "semantic_segmentation", "instance_segmentation", "normals", "rgb", "optical_flow")
SKY, ROADS, CAR = 11, 1, 14


class Rig(NamedTuple):
    """A car, another one ahead of it, and what all cameras on the first one's roof sent in one frame."""

    car: carla.Vehicle
    other: carla.Vehicle
    frame: int
    pictures: dict[str, NDArray[np.uint8]]
    poses: dict[str, carla.Transform]


def array(image: carla.Image) -> NDArray[np.uint8]:
    return np.frombuffer(image.raw_data, np.uint8).reshape(image.height, image.width, -1).copy()


@pytest.fixture
def rig(client: carla.Client, world: carla.World) -> Iterator[Rig]:
    client.set_timeout(60.0)  # who looks first waits for the scene, and this machine may be busy
    library = world.get_blueprint_library()
    start = spawn_point(world, 100)
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), start)
    ahead = carla.Transform(start.location + 12.0 * start.get_forward_vector(), start.rotation)
    other = world.spawn_actor(library.find("vehicle.lincoln.mkz_2020"), ahead)
    for _ in range(30):
        world.tick()
    arrived: queue.Queue[tuple[str, int, carla.Transform, NDArray[np.uint8]]] = queue.Queue()
    sensors = []
    for kind in KINDS:
        blueprint = library.find(f"sensor.camera.{kind}")
        for name, value in (("image_size_x", WIDTH), ("image_size_y", HEIGHT), ("fov", FOV)):
            blueprint.set_attribute(name, str(value))
        sensor = world.spawn_actor(blueprint, carla.Transform(carla.Location(x=2.4, z=1.8)), attach_to=car)
        sensor.listen(lambda image, kind=kind: arrived.put((kind, image.frame, image.transform, array(image))))
        sensors.append(sensor)
    yield Rig(car, other, *one_frame(world, arrived))
    for sensor in sensors:
        sensor.stop()
    for _ in range(3):
        world.tick()
    for actor in (*sensors, other, car):
        actor.destroy()


def one_frame(
    world: carla.World, arrived: "queue.Queue[tuple[str, int, carla.Transform, NDArray[np.uint8]]]"
) -> tuple[int, dict[str, NDArray[np.uint8]], dict[str, carla.Transform]]:
    """Tick until one frame has come from every camera."""
    frames: dict[int, dict[str, tuple[NDArray[np.uint8], carla.Transform]]] = {}
    for _ in range(60):
        world.tick()
        try:
            while True:
                kind, frame, pose, pixels = arrived.get(timeout=1.0)
                frames.setdefault(frame, {})[kind] = pixels, pose
                if len(frames[frame]) == len(KINDS):
                    found = frames[frame]
                    return frame, {k: v[0] for k, v in found.items()}, {k: v[1] for k, v in found.items()}
        except queue.Empty:
            continue
    raise AssertionError(f"no frame has all pictures: {frames.keys()}")


def metres(depth: NDArray[np.uint8]) -> NDArray[np.float64]:
    blue, green, red = (depth[:, :, channel].astype(np.float64) for channel in range(3))
    return 1000.0 * (red + 256.0 * green + 65536.0 * blue) / 16777215.0


def test_depth_of_the_road_ahead_is_that_of_a_plane_under_the_camera(rig: Rig) -> None:
    deep = metres(rig.pictures["depth"])
    tags = rig.pictures["semantic_segmentation"][:, :, 2]
    rows = np.arange(HEIGHT - 30, HEIGHT)
    columns = np.full(len(rows), WIDTH // 2)
    assert (tags[rows, columns] == ROADS).all()
    pose = rig.poses["depth"]
    up, forward = pose.get_up_vector(), pose.get_forward_vector()
    below = (rows + 0.5 - HEIGHT / 2) / FOCAL
    drop = forward.z - below * up.z  # of a metre ahead
    height = pose.location.z - rig.car.get_location().z
    assert deep[rows, columns] == pytest.approx(height / -drop, rel=0.03)


def test_sky_is_as_far_as_a_depth_picture_goes(rig: Rig) -> None:
    sky = rig.pictures["semantic_segmentation"][:, :, 2] == SKY
    assert sky.sum() > 1000
    assert (metres(rig.pictures["depth"])[sky] == 1000.0).all()


def test_tags_and_instances_agree_to_the_pixel(rig: Rig) -> None:
    semantic, instance = (rig.pictures[f"{kind}_segmentation"] for kind in ("semantic", "instance"))
    assert (semantic[:, :, 2] == instance[:, :, 2]).all()
    assert not semantic[:, :, :2].any()


def test_a_cars_pixels_lie_in_its_projected_box_and_fill_it(rig: Rig) -> None:
    instance = rig.pictures["instance_segmentation"]
    number = instance[:, :, 1].astype(int) + 256 * instance[:, :, 0].astype(int)
    rows, columns = np.nonzero((number == rig.other.id % 65536) & (instance[:, :, 2] == CAR))
    inverse = np.array(rig.poses["depth"].get_inverse_matrix())
    corners = [[v.x, v.y, v.z, 1.0] for v in rig.other.bounding_box.get_world_vertices(rig.other.get_transform())]
    seen = inverse @ np.array(corners).T
    across, down = FOCAL * seen[1] / seen[0] + WIDTH / 2, FOCAL * -seen[2] / seen[0] + HEIGHT / 2
    edges = ((columns.min(), across.min()), (columns.max(), across.max()), (rows.min(), down.min()))
    assert len(rows) > 200
    for pixel, edge in edges:
        assert pixel == pytest.approx(edge, abs=6.0)  # a car is rounder than its box
    assert across.min() - 1 <= columns.min() <= columns.max() <= across.max() + 1


def test_the_road_looks_up_in_the_cameras_view(rig: Rig) -> None:
    normals = rig.pictures["normals"]
    road = rig.pictures["semantic_segmentation"][:, :, 2] == ROADS
    blue, green, red = np.median(normals[road][:, :3], axis=0)
    assert green > 245
    assert abs(red - 127.5) < 12
    assert abs(blue - 127.5) < 20


def test_what_stands_does_not_flow_while_the_camera_stands(rig: Rig) -> None:
    flow = rig.pictures["optical_flow"].view(np.float32)
    assert flow.shape == (HEIGHT, WIDTH, 2)
    assert np.abs(flow).max() < 1e-3


def test_a_colour_picture_shows_a_bright_sky_above_a_darker_street(rig: Rig) -> None:
    colour = rig.pictures["rgb"][:, :, :3].astype(float)
    tags = rig.pictures["semantic_segmentation"][:, :, 2]
    assert colour[tags == SKY].mean() > 1.3 * colour[tags == ROADS].mean()
    blue, green, red = colour[tags == SKY].mean(axis=0)
    assert blue > red
    assert green > 60


@pytest.mark.parametrize(
    ("sensor", "attribute", "value", "sentence"),
    [
        ("sensor.lidar.ray_cast", "channels", "2000000000", "expected at most 4096"),
        ("sensor.lidar.ray_cast_semantic", "points_per_second", "2000000000", "expected at most 20000000"),
        ("sensor.other.radar", "points_per_second", "2000000000", "expected at most 20000000"),
        ("sensor.camera.dvs", "positive_threshold", "1e-30", "expected at least 0.01"),
    ],
)
def test_a_sensor_that_would_take_all_memory_is_refused(
    world: carla.World, sensor: str, attribute: str, value: str, sentence: str
) -> None:
    blueprint = world.get_blueprint_library().find(sensor)
    blueprint.set_attribute(attribute, value)
    with pytest.raises(RuntimeError, match=sentence):
        world.spawn_actor(blueprint, carla.Transform())


def test_a_picture_without_pixels_is_refused(world: carla.World) -> None:
    blueprint = world.get_blueprint_library().find("sensor.camera.rgb")
    blueprint.set_attribute("image_size_x", "9000")
    with pytest.raises(RuntimeError, match="a picture of 9000 x 600 pixels cannot be made"):
        world.spawn_actor(blueprint, carla.Transform())
    for axis in "xy":
        blueprint.set_attribute(f"image_size_{axis}", "8192")
    with pytest.raises(RuntimeError, match="it has at most 16777216 pixels"):
        world.spawn_actor(blueprint, carla.Transform())


def test_the_camera_of_lines_frames_the_car_ahead_unless_it_shall_leave_it_out(
    client: carla.Client, world: carla.World
) -> None:
    client.set_timeout(60.0)
    library, start = world.get_blueprint_library(), spawn_point(world, 100)
    hero = library.find("vehicle.tesla.model3")
    hero.set_attribute("role_name", "hero")
    car = world.spawn_actor(hero, start)
    ahead = carla.Transform(start.location + 12.0 * start.get_forward_vector(), start.rotation)
    other = world.spawn_actor(library.find("vehicle.lincoln.mkz_2020"), ahead)
    blueprint = library.find("sensor.camera.cosmos_visualization")
    for name, value in (("image_size_x", WIDTH), ("image_size_y", HEIGHT)):
        blueprint.set_attribute(name, str(value))
    camera = world.spawn_actor(blueprint, carla.Transform(carla.Location(x=2.4, z=1.8)), attach_to=car)
    arrived: queue.Queue[carla.Image] = queue.Queue()
    camera.listen(arrived.put)
    try:
        world.tick()
        image = arrived.get(timeout=60.0)
        assert (image.width, image.height, image.fov) == (WIDTH, HEIGHT, FOV)
        before = array(image)
        camera.set_ignored_vehicles([other.id])
        world.tick()
        after = array(arrived.get(timeout=60.0))
    finally:
        camera.stop()
        for actor in (camera, other, car):
            actor.destroy()
    colours = {tuple(pixel) for pixel in before[:, :, :3].reshape(-1, 3)}
    assert {(0, 0, 0), (0, 0, 255), (249, 183, 98), (35, 36, 200)} <= colours  # black, boxes, lane lines, kerbs
    middle = slice(WIDTH // 2 - 40, WIDTH // 2 + 40)
    framed, left_out = ((picture[:, middle, 2] == 255).sum() for picture in (before, after))
    assert framed > 100
    assert left_out < framed // 4
    assert (before[:, :, 3] == 255).all()
