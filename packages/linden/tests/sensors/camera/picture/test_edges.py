"""Which pixels get more rays, and what their samples take over from around them."""

import numpy as np

from linden.sensors.camera.picture.edges import SAMPLES, beside, edge_rays, smooth
from linden.sensors.camera.picture.sun_shadows import UNKNOWN, Sunshine, within
from linden.sensors.camera.pixel_rays import pixel_of_ray, tile_counts
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.casting.caster import NOTHING, STATIC, Hits

SPEC = CameraSpec(12, 8)
ACROSS, DOWN = tile_counts(SPEC)
RAYS = SPEC.width_px * SPEC.height_px
PIXEL = pixel_of_ray(SPEC)


def tiled(picture: np.ndarray) -> np.ndarray:
    """Return rows of a picture (height, width, ...) in the order of rays."""
    return np.ascontiguousarray(picture.reshape(RAYS, *picture.shape[2:])[PIXEL])


def hits(instance: np.ndarray) -> Hits:
    """Return hits of one plane, on these instances (height, width)."""
    normal = np.tile(np.float32([0.0, 0.0, 1.0]), (RAYS, 1))
    return Hits(np.full(RAYS, 9.0, np.float32), tiled(instance), np.zeros(RAYS, np.int32), normal)


def marked(instance: np.ndarray, light: np.ndarray) -> set[tuple[int, int]]:
    """Return (row, column) of the pixels that get more rays; ``light`` (height, width) is grey."""
    rows = edge_rays(SPEC, hits(instance), tiled(np.repeat(light[:, :, None], 3, axis=2)))
    return {divmod(int(pixel), SPEC.width_px) for pixel in PIXEL[rows]}


def test_beside_a_pixel_are_its_neighbours_across_tiles_too_and_itself_at_the_rim() -> None:
    ray_of = np.argsort(PIXEL)
    for side, (down, right) in enumerate(((0, 0), (0, -1), (0, 1), (-1, 0), (1, 0))):
        for y in range(SPEC.height_px):
            for x in range(SPEC.width_px):
                there = y + down, x + right
                inside = 0 <= there[0] < SPEC.height_px and 0 <= there[1] < SPEC.width_px
                row, column = there if inside else (y, x)
                found = beside(int(ray_of[y * SPEC.width_px + x]), side, ACROSS, DOWN)
                assert found == ray_of[row * SPEC.width_px + column]


def test_a_step_of_light_is_an_edge_on_both_its_sides_and_nowhere_else() -> None:
    light = np.full((8, 12), 0.2, np.float32)
    light[:, 7:] = 0.6
    there = {(row, column) for row in range(8) for column in (6, 7)}
    assert marked(np.full((8, 12), STATIC, np.int32), light) == there


def test_two_things_beside_each_other_are_an_edge_where_one_can_tell_them_apart() -> None:
    instance = np.full((8, 12), STATIC, np.int32)
    instance[:, 5:] = 3
    light = np.full((8, 12), 0.2, np.float32)
    assert not marked(instance, light)
    light[:, 5:] = 0.23
    assert marked(instance, light) == {(row, column) for row in range(8) for column in (4, 5)}
    assert not marked(np.full((8, 12), NOTHING, np.int32), light)  # a little more light in the sky is none


def test_samples_know_the_sun_where_all_around_agree_and_ask_where_a_shadow_ends() -> None:
    facing, lit = np.ones((8, 12), bool), np.ones((8, 12), np.float32)
    lit[:, 6:] = 0.0
    facing[:, 10:] = False  # they look the other way, and say nothing
    rows = np.argsort(PIXEL)[4 * SPEC.width_px : 5 * SPEC.width_px]  # a row of pixels
    known = within(SPEC, rows, Sunshine(tiled(facing), tiled(lit))).reshape(-1, SAMPLES)
    assert (known == known[:, :1]).all()
    assert known[:, 0].tolist() == [1.0] * 5 + [UNKNOWN] * 2 + [0.0] * 4 + [UNKNOWN]


def test_a_pixel_is_the_mean_of_its_samples_and_what_is_too_bright_counts_as_bright() -> None:
    light = np.zeros((RAYS, 3), np.float32)
    samples = np.zeros((2 * SAMPLES, 3), np.float32)
    samples[:SAMPLES, 0] = (0.0, 0.4, 0.8, 1.2)
    samples[SAMPLES:, 1] = (100.0, 0.0, 0.0, 0.0)
    smooth(np.array([5, 9]), samples, 2.0, light)
    np.testing.assert_allclose(light[[5, 9]], [[0.6, 0.0, 0.0], [0.0, 0.5, 0.0]], rtol=1e-6)
    assert np.count_nonzero(light) == 2
