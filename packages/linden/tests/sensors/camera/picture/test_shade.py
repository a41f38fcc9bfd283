"""The light along rays: the stages of the CPU against the same parts put together ray after ray, as plain Python.

For a CPU nothing else compiles ``shade_loop``, and that takes 17 s.
"""

import numpy as np
import pytest

from fleet import slow_uncompiled
from linden.protocol.values.episode import CLEAR_NOON, WeatherParameters
from linden.scenery.mesh import LampOf, Material
from linden.sensors.camera.picture.atmosphere import air
from linden.sensors.camera.picture.lamps import CELLS, LAMPLIGHT, LampGrid
from linden.sensors.camera.picture.shade import shade_loop, shaded, single
from linden.sensors.camera.picture.smooth_normals import FLAT, Relief
from linden.sensors.camera.picture.surface_points import SHINE, Places
from linden.sensors.camera.picture.texture_noise import fading, hashed, smooth_noise, whole
from linden.sensors.casting.caster import NOTHING, STATIC, Hits, Rays
from linden.sensors.view import Faces
from uncompiled import uncompiled

RAYS, FACES, BODIES, ROUND = 1500, 400, 5, 60
PIXEL_RAD = np.float32(0.002)
NIGHT = CLEAR_NOON._replace(sun_altitude_angle=-90.0)
RAIN = CLEAR_NOON._replace(cloudiness=90.0, precipitation=80.0, precipitation_deposits=60.0, wetness=80.0)


def units(dice: np.random.Generator, *shape: int) -> np.ndarray:
    vectors = dice.normal(size=(*shape, 3))
    return (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).astype(np.float32)


def world(dice: np.random.Generator) -> tuple[Rays, Hits, Faces, Relief, Places]:
    """Return rays that meet every material, on what stands and on bodies, and a fifth of which meet nothing."""
    instance = dice.integers(STATIC, BODIES, RAYS).astype(np.int32)
    instance[dice.random(RAYS) < 0.2] = NOTHING
    hits = Hits(
        dice.uniform(0.5, 300.0, RAYS).astype(np.float32),
        instance,
        dice.integers(0, FACES, RAYS).astype(np.int32),
        units(dice, RAYS),
    )
    row = np.full(FACES * (BODIES + 1), FLAT, np.int32)
    row[dice.permutation(len(row))[:ROUND]] = np.arange(ROUND)
    many = len(row)
    material = dice.integers(0, len(Material), many).astype(np.uint8)
    lamp = np.where(material == Material.LAMP, dice.integers(1, len(LampOf), many), 0).astype(np.uint8)
    faces = Faces(
        np.zeros(many, np.uint8),
        material,
        lamp,
        dice.random(many) < 0.1,
        dice.random((many, 3)).astype(np.float32),
        dice.integers(-1, 3, many).astype(np.int32),
        np.arange(BODIES + 1) * FACES,
    )
    relief = Relief(row, dice.normal(size=(ROUND, 3, 3)).astype(np.float32), units(dice, ROUND, 3))
    pose = np.zeros((BODIES + 1, 3, 4), np.float32)
    pose[:, :, :3] = np.eye(3)
    pose[1:, :, 3] = dice.normal(size=(BODIES, 3))
    back = pose.copy()
    back[:, :, 3] *= -1.0
    lights = dice.integers(0, 1 << len(LampOf), BODIES + 1).astype(np.uint32)
    paint = dice.random((BODIES + 1, 3)).astype(np.float32)
    places = Places(faces.first, pose, back, paint, lights, lights[:3])
    origin = (20.0 * dice.normal(size=(RAYS, 3))).astype(np.float32)
    return Rays(origin, units(dice, RAYS)), hits, faces, relief, places


def lamps(*, shining: bool) -> LampGrid:
    """Return a lamp that reaches into every cell, or none."""
    cells = CELLS * CELLS
    if not shining:
        return LampGrid(-160.0, -160.0, np.zeros(cells + 1, np.int32), np.zeros(0, np.int32), np.zeros(0, LAMPLIGHT))
    lamp = np.array([((0, 0, 6), (0, 0, -1), (6.5, 6, 5), 200.0, 0.05, 0.75, True)], LAMPLIGHT)
    return LampGrid(-160.0, -160.0, np.arange(cells + 1, dtype=np.int32), np.zeros(cells, np.int32), lamp)


@slow_uncompiled
@pytest.mark.parametrize("weather", [CLEAR_NOON, RAIN, NIGHT], ids=["noon", "rain", "night"])
def test_eight_rays_at_a_time_get_the_light_that_each_gets_alone(weather: WeatherParameters) -> None:
    dice = np.random.default_rng(11)
    rays, hits, faces, relief, places = world(dice)
    sunny = (dice.random(RAYS) < 0.5).astype(np.float32)
    sky, grid = air(weather, 3.0), lamps(shining=weather is NIGHT)
    together = shaded(rays, hits, sunny, PIXEL_RAD, faces, relief, places, sky, grid)
    alone = np.empty_like(together)
    rows = grid._replace(lamps=grid.lamps.view(np.recarray))  # whose fields Python finds by name, as numba does
    given = PIXEL_RAD, faces, relief, places, SHINE, single(sky), single(rows)
    with np.errstate(over="ignore"):  # of whole numbers, which noise is made of
        uncompiled(shade_loop)(rays, hits, sunny, *given, alone, 0, RAYS)
    assert np.isfinite(alone).all()
    wrong = np.abs(together - alone) > 1e-3 + 1e-3 * np.abs(alone)
    assert wrong.mean() < 0.002  # sums in another order may put a spot on the other side of a joint


def test_the_last_rays_of_an_uneven_number_have_their_light_too() -> None:
    rays, hits, faces, relief, places = world(np.random.default_rng(5))
    sunny, sky, grid = np.ones(RAYS, np.float32), air(CLEAR_NOON, 0.0), lamps(shining=False)
    all_of_them = shaded(rays, hits, sunny, PIXEL_RAD, faces, relief, places, sky, grid)
    few = slice(0, 1001)
    some = shaded(
        Rays(*(column[few] for column in rays)), Hits(*(column[few] for column in hits)), sunny[few], PIXEL_RAD,
        faces, relief, places, sky, grid,
    )  # fmt: skip
    np.testing.assert_allclose(some, all_of_them[few], rtol=1e-4, atol=1e-5)


def test_the_largest_whole_number_below_is_that_of_negative_numbers_too() -> None:
    values = [-2.5, -2.0, -0.25, 0.0, 0.75, 7.0, 1e6 + 0.5]
    assert [int(whole(np.float32(value))) for value in values] == [-3, -2, -1, 0, 0, 7, 1000000]


def test_a_power_of_e_is_right_to_four_digits() -> None:
    for x in np.linspace(-10.0, 10.0, 81):
        assert fading(np.float32(x)) == pytest.approx(np.exp(x), rel=2e-4)
    assert fading(np.float32(-500.0)) < 1e-12


def test_noise_is_even_and_without_a_seam_at_whole_numbers() -> None:
    drawn = np.array([hashed(x, y, 9) for x in range(-40, 40) for y in range(-40, 40)])
    assert drawn.mean() == pytest.approx(0.5, abs=0.02)
    assert drawn.var() == pytest.approx(1.0 / 12.0, abs=0.005)
    below, above = np.float32(2.9999), np.float32(3.0001)
    assert smooth_noise(below, np.float32(0.3), 4) == pytest.approx(smooth_noise(above, np.float32(0.3), 4), abs=1e-3)
