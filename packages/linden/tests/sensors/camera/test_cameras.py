"""What cameras see of a street whose every distance is known."""

import numpy as np
import pytest

from fakes.street import CAR_ID, WALL_ID, WALL_M, street
from linden.blueprints.library import BlueprintLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType, SemanticTag
from linden.protocol.values.episode import CLEAR_NOON
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.mesh import LampOf
from linden.sensors.camera.cameras import CAMERAS, Image
from linden.sensors.view import Seen, SensorLook

EYE = Transform(Vector3D(0.0, 0.0, 2.0), Rotation())
WIDTH, HEIGHT = 160, 122  # no multiple of a tile's 4
FOCAL = WIDTH / 2.0
LIBRARY = BlueprintLibrary.load()
NIGHT = CLEAR_NOON._replace(sun_altitude_angle=-60.0)


def camera(kind: str, **attributes: str):
    given = {"image_size_x": str(WIDTH), "image_size_y": str(HEIGHT), **attributes}
    values = tuple(AttributeValue(name, AttributeType.STRING, value) for name, value in given.items())
    name = f"sensor.camera.{kind}"
    return CAMERAS[name](LIBRARY.validate(ActorDescription(0, name, values)))


def look(seen: Seen, pose: Transform = EYE, before: Transform | None = None, number: int = 0) -> SensorLook:
    return SensorLook(seen, {}, pose, before or pose, np.zeros(3), 0, number, 0.05)


def pixels(kind: str, seen: Seen, pose: Transform = EYE, before: Transform | None = None, **attributes: str):
    image = camera(kind, **attributes).measure(look(seen, pose, before))
    assert isinstance(image, Image)
    assert image.pixels.shape[:2] == (HEIGHT, WIDTH)
    return image.pixels


def metres(image):
    return (image[:, :, 2] + 256.0 * image[:, :, 1] + 65536.0 * image[:, :, 0]) / 16777215.0 * 1000.0


def test_depth_of_road_and_wall_is_that_of_their_planes_to_a_millimetre() -> None:
    deep = metres(pixels("depth", street(car_m=(0.0, 500.0, 0.0))))
    below = (np.arange(HEIGHT) + 0.5 - HEIGHT / 2) / FOCAL
    with np.errstate(divide="ignore"):
        road = np.where(below > 0.0, 2.0 / below, np.inf)
    wall_seen = below > (2.0 - 8.0) / WALL_M
    expected = np.where(wall_seen, np.minimum(road, WALL_M), 1000.0)
    assert deep[:, WIDTH // 2] == pytest.approx(expected, abs=1e-3)


def test_depth_is_along_the_axis_not_along_the_ray() -> None:
    deep = metres(pixels("depth", street(car_m=(0.0, 500.0, 0.0))))
    row = HEIGHT // 2 - 2
    assert deep[row, 40:120] == pytest.approx(WALL_M, abs=1e-3)


def test_a_turned_camera_sees_what_lies_there() -> None:
    right = Transform(Vector3D(0.0, 0.0, 2.0), Rotation(yaw=90.0))
    tags = pixels("semantic_segmentation", street(car_m=(0.0, 10.0, 0.8)), right)[:, :, 2]
    assert tags[HEIGHT // 2 + 6, WIDTH // 2] == SemanticTag.CAR
    assert SemanticTag.BUILDINGS not in tags[:, WIDTH // 2 :]  # the wall is to the left now


def test_tags_are_in_red_alone_and_the_sky_has_its_own() -> None:
    image = pixels("semantic_segmentation", street())
    assert set(np.unique(image[:, :, 2])) == {
        SemanticTag.ROADS,
        SemanticTag.BUILDINGS,
        SemanticTag.SKY,
        SemanticTag.CAR,
    }
    assert not image[:, :, :2].any()
    assert (image[:, :, 3] == 255).all()


def test_instances_carry_the_ids_of_actors_and_objects_in_green_and_blue() -> None:
    seen = street()
    image = pixels("instance_segmentation", seen)
    tags = pixels("semantic_segmentation", seen)[:, :, 2]
    number = image[:, :, 1].astype(int) + 256 * image[:, :, 0].astype(int)
    assert (image[:, :, 2] == tags).all()
    assert set(number[tags == SemanticTag.CAR]) == {CAR_ID}
    assert set(number[tags == SemanticTag.BUILDINGS]) == {WALL_ID}
    assert set(number[tags == SemanticTag.ROADS]) == {0}


def test_a_boxs_pixels_fill_its_projection() -> None:
    tags = pixels("semantic_segmentation", street())[:, :, 2]
    rows, columns = np.nonzero(tags == SemanticTag.CAR)
    near_m, half_wide_m, top_m = 18.0, 0.9, 0.5
    assert columns.min() == int(np.ceil(WIDTH / 2 - FOCAL * half_wide_m / near_m - 0.5))
    assert columns.max() == int(np.floor(WIDTH / 2 + FOCAL * half_wide_m / near_m - 0.5))
    assert rows.max() == int(np.floor(HEIGHT / 2 + FOCAL * 1.9 / near_m - 0.5))
    assert rows.min() == int(np.ceil(HEIGHT / 2 + FOCAL * top_m / 22.04 - 0.5))


def test_normals_are_those_of_view_space() -> None:
    seen = street()
    image, tags = pixels("normals", seen), pixels("semantic_segmentation", seen)[:, :, 2]
    assert np.abs(image[tags == SemanticTag.ROADS][:, :3].astype(int) - (128, 255, 128)).max() <= 1  # B, G, R: up
    assert np.abs(image[tags == SemanticTag.BUILDINGS][:, :3].astype(int) - (255, 128, 128)).max() <= 1  # to the eye


def test_a_camera_in_a_car_sees_out_of_it() -> None:
    tags = pixels("semantic_segmentation", street(car_m=(0.0, 0.0, 2.0)))[:, :, 2]
    assert (tags[: HEIGHT // 2 - 20] == SemanticTag.SKY).any()
    assert (tags != SemanticTag.CAR).all()


def test_a_car_that_crosses_flows_as_far_as_it_went() -> None:
    seen = street(car_m=(20.0, 0.5, 0.8), before_m=(20.0, 0.0, 0.8))
    flow = pixels("optical_flow", seen)
    tags = pixels("semantic_segmentation", seen)[:, :, 2]
    rows, columns = np.nonzero(tags == SemanticTag.CAR)
    back = rows > HEIGHT / 2 + 3  # its rear side, 18 m away
    pixel = flow[rows[back], columns[back], 0] * WIDTH / 2
    assert pixel == pytest.approx(FOCAL * 0.5 / 18.0, abs=1e-3)
    assert np.abs(flow[tags != SemanticTag.CAR]).max() == 0.0


def test_the_world_flows_downwards_before_a_camera_that_drives() -> None:
    seen, before = street(car_m=(0.0, 500.0, 0.0)), Transform(Vector3D(-1.0, 0.0, 2.0), Rotation())
    flow = pixels("optical_flow", seen, EYE, before)
    row = HEIGHT - 10
    below = (row + 0.5 - HEIGHT / 2) / FOCAL
    ahead_m = 2.0 / below
    moved_px = FOCAL * (2.0 / ahead_m - 2.0 / (ahead_m + 1.0))
    assert flow[row, WIDTH // 2, 1] * HEIGHT / 2 == pytest.approx(-moved_px, rel=1e-3)


def test_the_sky_flows_as_the_camera_turns_and_stands_as_it_drives() -> None:
    seen = street(car_m=(0.0, 500.0, 0.0))
    driven = pixels("optical_flow", seen, EYE, Transform(Vector3D(-5.0, 0.0, 2.0), Rotation()))
    turned = pixels("optical_flow", seen, EYE, Transform(Vector3D(0.0, 0.0, 2.0), Rotation(yaw=-1.0)))
    assert np.abs(driven[0]).max() == 0.0
    assert turned[0, WIDTH // 2, 0] * WIDTH / 2 == pytest.approx(-FOCAL * np.tan(np.radians(1.0)), rel=0.5)


def test_the_same_moment_gives_the_same_bytes() -> None:
    first, second = (pixels("rgb", street()) for _ in range(2))
    assert (first == second).all()


def test_a_car_throws_a_shadow_away_from_the_sun() -> None:
    sun = CLEAR_NOON._replace(sun_azimuth_angle=90.0, sun_altitude_angle=30.0)  # in the south, to the right
    shaded, clear = pixels("rgb", street(weather=sun)), pixels("rgb", street(car_m=(0.0, 500.0, 0.0), weather=sun))
    row = HEIGHT // 2 + 7  # of the road beside the car
    darker = shaded[row, :, :3].sum(axis=1).astype(int) - clear[row, :, :3].sum(axis=1)
    left, right = darker[: WIDTH // 2 - 8], darker[WIDTH // 2 + 8 :]
    assert left.min() < -60
    assert right.min() > -20


def test_a_painted_car_has_its_actors_colour() -> None:
    seen = street()
    colour = pixels("rgb", seen)
    tags = pixels("semantic_segmentation", seen)[:, :, 2]
    blue, green, red = colour[tags == SemanticTag.CAR][:, :3].mean(axis=0)
    assert red > 2 * green
    assert red > 2 * blue


def test_night_is_dark_and_headlights_light_the_road_before_a_car() -> None:
    off, on = (pixels("rgb", street(weather=NIGHT, lights=bits << LampOf.HEAD)) for bits in (0, 1))
    noon = pixels("rgb", street())
    assert off[:, :, :3].mean() < 0.5 * noon[:, :, :3].mean()
    rows = slice(HEIGHT // 2 + 1, HEIGHT // 2 + 5)
    lit = on[rows, :, :3].astype(int) - off[rows, :, :3]
    assert lit.max() > 40


def test_fog_hides_the_wall() -> None:
    def contrast(density: float) -> float:
        seen = street(weather=CLEAR_NOON._replace(fog_density=density))
        tags = pixels("semantic_segmentation", seen)[:, :, 2]
        image = pixels("rgb", seen)[:, :, :3].astype(float)
        wall, sky = (image[tags == tag].mean(axis=0) for tag in (SemanticTag.BUILDINGS, SemanticTag.SKY))
        return float(np.abs(wall - sky).max())

    assert contrast(0.0) > contrast(50.0) > contrast(100.0)


def test_a_longer_exposure_is_brighter_where_exposure_is_manual() -> None:
    seen = street()
    short, long = (pixels("rgb", seen, exposure_mode="manual", shutter_speed=speed) for speed in ("800.0", "100.0"))
    assert long[:, :, :3].mean() > 1.5 * short[:, :, :3].mean()


def test_the_default_lens_is_ideal_and_a_circle_distorts() -> None:
    plain = metres(pixels("depth", street()))
    bent = metres(pixels("depth", street(), lens_circle_multiplier="10.0", lens_circle_falloff="1.0", lens_k="-3.0"))
    middle = (slice(HEIGHT // 2 - 1, HEIGHT // 2 + 1), slice(WIDTH // 2 - 1, WIDTH // 2 + 1))
    assert bent[middle] == pytest.approx(plain[middle], rel=0.05)
    assert np.abs(bent[-1] - plain[-1]).max() > 0.1


def test_an_event_camera_is_silent_until_something_moves() -> None:
    sensor = camera("dvs")
    assert sensor.measure(look(street())) is None
    assert sensor.measure(look(street()._replace(now_s=1.05), number=1)) is None
    moved = street(car_m=(20.0, 3.0, 0.8))._replace(now_s=1.1)
    found = sensor.measure(look(moved, number=2)).events
    assert (np.diff(found["t"]) >= 0).all()
    assert 1_050_000_000 <= found["t"].min() <= found["t"].max() <= 1_100_000_000
    assert {True, False} == set(found["polarity"].tolist())
    assert found["x"].max() < WIDTH
