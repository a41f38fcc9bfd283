"""What cameras and radars say of motion, and of who is seen where, beside what the client knows of it: in Linden."""

from collections.abc import Iterator

import carla
import numpy as np
import pytest
from numpy.typing import NDArray

from spawn_points import spawn_point
from watching import Reading, made, watching

WIDTH, HEIGHT = 320, 240
FOCAL_PX = WIDTH / 2
STREET = 100
FIRST_OBJECT = 32768
"""Numbers of instance pictures below belong to actors."""
PICTURE = {"image_size_x": WIDTH, "image_size_y": HEIGHT, "fov": 90}
CAMERAS = ("depth", "instance_segmentation", "optical_flow")


def at(start: carla.Transform, ahead_m: float, right_m: float, up_m: float, yaw_deg: float) -> carla.Transform:
    """A place as seen from a spawn point."""
    place = start.transform(carla.Vector3D(ahead_m, right_m, up_m))
    return carla.Transform(carla.Location(place), carla.Rotation(yaw=start.rotation.yaw + yaw_deg))


def matrix(pose: carla.Transform) -> NDArray[np.float64]:
    return np.array(pose.get_matrix())


def numbers(instances: Reading) -> NDArray[np.int64]:
    """(HEIGHT, WIDTH): the lower 16 bits of whose each pixel is."""
    pixels = instances.pixels().astype(np.int64)
    return pixels[:, :, 1] + 256 * pixels[:, :, 0]


def on_picture(points: NDArray[np.float64], camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 2): column and row, from the picture's left upper corner, of points (..., 4) in the world."""
    seen = points @ np.linalg.inv(camera).T
    return np.stack(
        [WIDTH / 2 + FOCAL_PX * seen[..., 1] / seen[..., 0], HEIGHT / 2 - FOCAL_PX * seen[..., 2] / seen[..., 0]], -1
    )


@pytest.fixture
def start(client: carla.Client, world: carla.World) -> carla.Transform:
    client.set_timeout(60.0)
    return spawn_point(world, STREET)


@pytest.fixture
def others(world: carla.World, start: carla.Transform) -> Iterator[dict[str, carla.Actor]]:
    """A van, a car, a bicycle and a walker side by side ahead of the spawn point, who stay where they are put."""
    library, found = world.get_blueprint_library(), {}
    for type_id, ahead_m, right_m, yaw_deg in (
        ("vehicle.ford.ambulance", 19.0, -5.5, 20.0),
        ("vehicle.audi.tt", 13.0, 4.5, 60.0),
        ("vehicle.bh.crossbike", 9.0, -1.0, 75.0),
        ("walker.pedestrian.0001", 8.0, 1.2, 180.0),
    ):
        found[type_id] = world.spawn_actor(library.find(type_id), at(start, ahead_m, right_m, 1.2, yaw_deg))
        found[type_id].set_simulate_physics(False)
    yield found
    for actor in found.values():
        actor.destroy()


def test_a_flow_is_how_far_each_pixels_place_has_moved_in_the_picture(
    world: carla.World, start: carla.Transform, others: dict[str, carla.Actor]
) -> None:
    eyes = {name: made(world, f"sensor.camera.{name}", at(start, 0, 0, 2, 0), chosen=PICTURE) for name in CAMERAS}
    car = others["vehicle.audi.tt"]
    with watching(world, eyes) as next_frame:
        next_frame()
        found, poses = list[dict[str, Reading]](), list[NDArray[np.float64]]()
        for step in range(1, 4):
            for eye in eyes.values():
                eye.set_transform(at(start, 0.2 * step, 0.1 * step, 2.0 - 0.05 * step, 1.5 * step))
            car.set_transform(at(start, 13.0 - 0.3 * step, 4.5, 1.2, 60.0 - 4.0 * step))
            found.append(next_frame())
            poses.append(matrix(car.get_transform()))
    now, before = found[-1], found[-2]
    across, down = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    ahead = np.stack([np.ones_like(across), across / FOCAL_PX - 1.0, (HEIGHT / 2 - down) / FOCAL_PX], axis=-1)
    near = np.concatenate([ahead * now["depth"].depth_m()[:, :, None], np.ones((HEIGHT, WIDTH, 1))], axis=-1)
    place = near @ now["depth"].world_from_sensor.T
    of_car = numbers(now["instance_segmentation"]) == car.id % FIRST_OBJECT
    carried = place @ (poses[-2] @ np.linalg.inv(poses[-1])).T
    past = on_picture(np.where(of_car[:, :, None], carried, place), before["depth"].world_from_sensor)
    moved_px = np.stack([across, down], axis=-1) - past
    told_px = now["optical_flow"].flow() * (WIDTH / 2, -HEIGHT / 2)
    solid = now["depth"].depth_m() < 900.0
    assert of_car.sum() > 300
    assert np.abs(moved_px[of_car]).max(axis=1).mean() > 1.5
    for part in (of_car, solid & ~of_car):
        assert np.abs(told_px - moved_px)[part].max() < 0.05


def test_a_visible_actor_fills_the_projected_box_and_has_the_tag_the_client_knows(
    world: carla.World, start: carla.Transform, others: dict[str, carla.Actor]
) -> None:
    eyes = {"instances": made(world, "sensor.camera.instance_segmentation", at(start, 0, 0, 2, 0), chosen=PICTURE)}
    with watching(world, eyes) as next_frame:
        next_frame()
        picture = next_frame()["instances"]
    known, tags = {actor.id: actor for actor in world.get_actors()}, picture.pixels()[:, :, 2]
    of_actors = numbers(picture)
    seen_ids = {int(number) for number in np.unique(of_actors) if 0 < number < FIRST_OBJECT}
    for number in seen_ids:
        assert set(np.unique(tags[of_actors == number])) <= set(known[number].semantic_tags), known[number].type_id
    assert seen_ids >= {actor.id for actor in others.values()}
    for type_id, actor in others.items():
        rows, columns = np.nonzero(of_actors == actor.id)
        corners = actor.bounding_box.get_world_vertices(actor.get_transform())
        box = on_picture(np.array([[p.x, p.y, p.z, 1.0] for p in corners]), picture.world_from_sensor)
        first, last = np.array([columns.min(), rows.min()]), np.array([columns.max(), rows.max()]) + 1
        assert (first > box.min(axis=0) - 1.5).all(), type_id
        assert (last < box.max(axis=0) + 1.5).all(), type_id
        assert ((last - first) > 0.8 * np.ptp(box, axis=0)).all(), type_id


def test_a_radar_on_the_move_reads_the_relative_speed_of_what_drives_and_of_what_stands(
    world: carla.World, start: carla.Transform, others: dict[str, carla.Actor]
) -> None:
    library = world.get_blueprint_library()
    ego = world.spawn_actor(library.find("vehicle.tesla.model3"), at(start, 0, 0, 0.3, 0))
    van = others["vehicle.ford.ambulance"]
    van.set_simulate_physics(True)
    ego.enable_constant_velocity(carla.Vector3D(x=8.0))
    van.enable_constant_velocity(carla.Vector3D(x=-5.0))
    chosen = {"horizontal_fov": 70, "vertical_fov": 16, "points_per_second": 40_000, "range": 80}
    radar = made(world, "sensor.other.radar", carla.Transform(carla.Location(x=2.4, z=1.0)), on=ego, chosen=chosen)
    with watching(world, {"radar": radar}) as next_frame:
        next_frame()
        found = next_frame()["radar"]
        speeds = {actor.id: actor.get_velocity() for actor in (ego, van)}
        box, pose = van.bounding_box, van.get_transform()
        box.extent += carla.Vector3D(0.02, 0.02, 0.02)
        speed, azimuth, altitude, depth_m = found.columns().astype(np.float64).T
        ahead = np.column_stack(
            [np.cos(altitude) * np.cos(azimuth), np.cos(altitude) * np.sin(azimuth), np.sin(altitude)]
        )
        places = np.column_stack([ahead * depth_m[:, None], np.ones(len(ahead))]) @ found.world_from_sensor.T
        of_van = np.array([box.contains(carla.Location(*place[:3]), pose) for place in places])
    ego.destroy()
    direction = ahead @ found.world_from_sensor[:3, :3].T
    own, its = (np.array([v.x, v.y, v.z]) for v in speeds.values())
    assert [np.linalg.norm(own), np.linalg.norm(its)] == pytest.approx([8.0, 5.0], rel=0.05)
    assert min(of_van.sum(), (~of_van).sum()) > 50
    expected = np.where(of_van, direction @ (its - own), direction @ -own)
    assert np.abs(speed - expected).max() < 0.01
