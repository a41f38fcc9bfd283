"""Depth and lidars in a world that is known to the millimetre: a straight and flat street between two walls."""

import carla
import numpy as np
import pytest
from numpy.typing import NDArray

from opendrive_texts import lane, line, opendrive, road, section
from servers import RunningServer
from watching import Reading, made, watching

WIDTH, HEIGHT = 320, 240
ROADS, WALLS = 1, 4
TENTH_MM = 1e-4
"""A step of a depth picture is 0.06 mm."""
NEAR_M = 60.0
EYE = carla.Transform(carla.Location(30.0, 1.2, 2.1), carla.Rotation(pitch=-6.0, yaw=9.0, roll=3.0))
STREET = opendrive(road(1, 120.0, line(0, 0, 0, 0, 120), section(left=lane(1), right=lane(-1))))
PICTURE = {"image_size_x": WIDTH, "image_size_y": HEIGHT, "fov": 90}
DOWNWARDS = {
    "channels": 8,
    "upper_fov": -20,
    "lower_fov": -35,
    "points_per_second": 80_000,
    "rotation_frequency": 20,
    "range": 50,
    "dropoff_general_rate": 0.0,
    "atmosphere_attenuation_rate": 0.02,
}
"""All of its rays meet the ground or a wall within 10 m: in a step of 0.05 s, 500 of each channel."""
LOSSES = {"dropoff_general_rate": 0.45, "dropoff_intensity_limit": 0.0, "noise_stddev": 0.02}
SENSORS = {
    "depth": ("sensor.camera.depth", PICTURE),
    "tags": ("sensor.camera.semantic_segmentation", PICTURE),
    "lidar": (
        "sensor.lidar.ray_cast_semantic",
        {"channels": 48, "upper_fov": 12, "lower_fov": -35, "points_per_second": 480_000, "rotation_frequency": 20},
    ),
    "every point": ("sensor.lidar.ray_cast", DOWNWARDS),
    "some points": ("sensor.lidar.ray_cast", DOWNWARDS | LOSSES | {"noise_seed": 1}),
    "the same points": ("sensor.lidar.ray_cast", DOWNWARDS | LOSSES | {"noise_seed": 1}),
    "other points": ("sensor.lidar.ray_cast", DOWNWARDS | LOSSES | {"noise_seed": 2}),
}


@pytest.fixture(scope="module")
def seen(server: RunningServer) -> tuple[dict[str, Reading], dict[str, float]]:
    """What depth camera, tags and semantic lidar measured at one place, and where the walls' faces are: left, right."""
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(60.0)
    world = client.generate_opendrive_world(
        STREET, carla.OpendriveGenerationParameters(wall_height=3.0, additional_width=1.0)
    )
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
    world.apply_settings(settings)
    boxes = [item.bounding_box for item in world.get_environment_objects(carla.CityObjectLabel.Walls)]
    thick = {side: [box for box in boxes if box.location.y * sign > 0] for side, sign in (("left", -1), ("right", 1))}
    faces = {side: max(abs(box.location.y) - box.extent.y for box in found) for side, found in thick.items()}
    sensors = {name: made(world, kind, EYE, chosen=chosen) for name, (kind, chosen) in SENSORS.items()}
    with watching(world, sensors) as next_frame:
        return next_frame(), faces


def rays() -> NDArray[np.float64]:
    """(HEIGHT, WIDTH, 4): through the middle of each pixel, one metre ahead, in the camera's frame; no place."""
    across, down = np.meshgrid(np.arange(WIDTH) + 0.5 - WIDTH / 2, np.arange(HEIGHT) + 0.5 - HEIGHT / 2)
    return np.stack([np.ones_like(across), across / (WIDTH / 2), -down / (WIDTH / 2), np.zeros_like(across)], axis=-1)


def points(depth: Reading) -> NDArray[np.float64]:
    """(HEIGHT, WIDTH, 3): what each pixel shows, in the world."""
    ahead_m = depth.depth_m()[:, :, None] * rays() + np.array([0.0, 0.0, 0.0, 1.0])
    return (ahead_m @ depth.world_from_sensor.T)[:, :, :3]


Seen = tuple[dict[str, Reading], dict[str, float]]


def test_every_pixel_of_the_road_lies_on_its_plane_to_a_tenth_of_a_millimetre(seen: Seen) -> None:
    readings, _ = seen
    road_pixels = (readings["tags"].pixels()[:, :, 2] == ROADS) & (readings["depth"].depth_m() < NEAR_M)
    assert road_pixels.sum() > 10_000
    assert np.abs(points(readings["depth"])[road_pixels, 2]).max() < TENTH_MM


def test_every_pixel_of_a_wall_lies_on_its_face_to_a_tenth_of_a_millimetre(seen: Seen) -> None:
    readings, faces = seen
    place = points(readings["depth"])
    walls = (readings["tags"].pixels()[:, :, 2] == WALLS) & (readings["depth"].depth_m() < NEAR_M)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        of_face = walls & (place[:, :, 1] * sign > 1.0) & (place[:, :, 2] < 2.9)  # their upper edge has a top side
        assert of_face.sum() > 1_000
        assert np.abs(place[of_face, 1] * sign - faces[side]).max() < TENTH_MM


def test_lidar_points_lie_on_the_planes_of_what_they_are_said_to_be_of(seen: Seen) -> None:
    readings, faces = seen
    found = readings["lidar"].detections()
    place = (np.column_stack([found["xyz"], np.ones(len(found))]) @ readings["lidar"].world_from_sensor.T)[:, :3]
    street, walls = found["tag"] == ROADS, (found["tag"] == WALLS) & (place[:, 2] < 2.9)
    assert min(street.sum(), walls.sum()) > 2_000
    assert np.abs(place[street, 2]).max() < TENTH_MM
    face = np.where(place[walls, 1] < 0.0, faces["left"], faces["right"])
    assert np.abs(np.abs(place[walls, 1]) - face).max() < TENTH_MM


def test_a_lidar_of_the_same_place_measures_what_the_depth_picture_shows(seen: Seen) -> None:
    """Along a plane the inverse of depth grows evenly from pixel to pixel, so between four of them it is known."""
    readings, _ = seen
    inverse, found = 1.0 / readings["depth"].depth_m(), readings["lidar"].detections()
    tags = readings["tags"].pixels()[:, :, 2]
    ahead, aside, up = found["xyz"][found["xyz"][:, 0] > 0.5].astype(np.float64).T
    column, row = WIDTH / 2 * (1.0 + aside / ahead) - 0.5, HEIGHT / 2 - WIDTH / 2 * up / ahead - 0.5
    inside = (column > 0) & (column < WIDTH - 1) & (row > 0) & (row < HEIGHT - 1) & (ahead < 30.0)
    ahead, column, row = ahead[inside], column[inside], row[inside]
    left, top = column.astype(int), row.astype(int)
    one_thing = np.ptp([tags[top + j, left + i] for i in (0, 1) for j in (0, 1)], axis=0) == 0
    bend = inverse[top, left] + inverse[top + 1, left + 1] - inverse[top + 1, left] - inverse[top, left + 1]
    whole = one_thing & (np.abs(bend) < 1e-6)
    assert whole.sum() > 1_000
    right, down = column - left, row - top
    upper = inverse[top, left] * (1 - right) + inverse[top, left + 1] * right
    lower = inverse[top + 1, left] * (1 - right) + inverse[top + 1, left + 1] * right
    expected_m = 1.0 / (upper * (1 - down) + lower * down)
    assert np.abs(expected_m - ahead)[whole].max() < TENTH_MM


def test_a_lidar_has_as_many_points_as_its_attributes_say_the_same_for_each_channel(seen: Seen) -> None:
    assert seen[0]["every point"].shape == (500,) * 8


def test_intensity_fades_with_distance_as_the_attenuation_says(seen: Seen) -> None:
    found = seen[0]["every point"].columns().astype(np.float64)
    distance_m = np.linalg.norm(found[:, :3], axis=1)
    assert np.ptp(distance_m) > 1.0
    assert found[:, 3] == pytest.approx(np.exp(-0.02 * distance_m), abs=1e-6)


def test_a_share_of_the_points_drops_off_and_those_left_scatter_along_their_rays(seen: Seen) -> None:
    whole, some = seen[0]["every point"].columns(), seen[0]["some points"].columns()
    assert len(some) / len(whole) == pytest.approx(1.0 - 0.45, abs=0.03)
    scatter_m = np.linalg.norm(some[:, :3], axis=1) + np.log(some[:, 3]) / 0.02  # the intensity knows the true distance
    assert scatter_m.std() == pytest.approx(0.02, rel=0.1)
    assert abs(scatter_m.mean()) < 0.002


def test_one_seed_gives_the_same_bytes_and_another_others(seen: Seen) -> None:
    some, same, other = (seen[0][f"{which} points"].raw for which in ("some", "the same", "other"))
    assert some == same != other
