"""From light to bytes: exposure, bloom, rain before the lens, Unreal's film curve, gamma.

The film's curve and its parameters are those of Unreal Engine 4 (Epic, "Color grading and filmic tonemapper"), which
approximates the ACES output transform; CARLA's attributes slope, toe, shoulder, black and white clip are its own.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from linden.compiled import fingerprint, shading, shading_part
from linden.sensors.camera.picture.atmosphere import Air, brightness
from linden.sensors.camera.picture.texture_noise import hashed, narrow, narrow_whole, whole
from linden.sensors.camera.pixel_rays import TILE, TILE_PX, pixel_of_ray, tile_counts
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.casting.thread_pool import in_stretches

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

_STEPS = 4096
_MOST = 8.0
"""Light, once exposed, that the table of the film's curve ends at."""

_NOON = 1.75
"""Light on level ground on a clear noon, which is exposed with 1."""
_ADAPTION = 0.66
"""How much of a darker or brighter day an automatic exposure makes up for: night stays darker than day."""
_DARKEST = 0.02
_GREY = 0.84
"""What a white surface in half the noon's sun becomes before the film's curve."""
_DEFAULT = Film()

_BLOOM_FROM, _BLOOM_MOST, _BLOOM_SHARE = 2.2, 4.0, 0.10
"""Light, once exposed, that spreads around it: from, up to, and how much of it."""


def exposure(film: Film, light: Air) -> float:
    """Return the factor of light before the film's curve.

    With ``exposure_mode`` manual, the default shutter, ISO and f-stop expose a clear noon as the automatic one does.
    """
    stops = film.compensation_stops
    if film.manual:
        given, default = (
            math.log2(max(f.fstop, 0.1) ** 2 * max(f.shutter_hz, 0.1) * 100.0 / max(f.iso, 1.0))
            for f in (film, _DEFAULT)
        )
        return float(_GREY * 2.0 ** (stops - given + default))
    level = max(brightness(light), _DARKEST)
    return float(_GREY * (_NOON / level) ** _ADAPTION * 2.0**stops)


def curve(film: Film) -> U8:
    """Return the bytes (4096,) of light that is the square of evenly spaced numbers up to sqrt(8)."""
    light = np.linspace(0.0, math.sqrt(_MOST), _STEPS, dtype=np.float64) ** 2
    shown = filmic(light) if film.postprocess else np.clip(light, 0.0, 1.0)
    return (255.0 * np.clip(shown, 0.0, 1.0) ** (1.0 / max(film.gamma, 0.1)) + 0.5).astype(np.uint8)


def filmic(light: F64) -> F64:
    """Return what Unreal's film curve makes of light (N,), 0 to 1, with its default parameters."""
    slope, toe, shoulder, black, white, middle = 0.88, 0.55, 0.26, 0.0, 0.04, 0.18
    toe_scale, shoulder_scale = 1.0 + black - toe, 1.0 + white - shoulder
    ratio = (middle + black) / toe_scale - 1.0
    toe_at = math.log10(middle) - 0.5 * math.log((1.0 + ratio) / (1.0 - ratio)) * toe_scale / slope
    straight_at = (1.0 - toe) / slope - toe_at
    shoulder_at = shoulder / slope - straight_at
    stops = np.log10(np.maximum(light, 1e-10))
    straight = slope * (stops + straight_at)
    low = -black + 2.0 * toe_scale / (1.0 + np.exp(-2.0 * slope / toe_scale * (stops - toe_at)))
    high = 1.0 + white - 2.0 * shoulder_scale / (1.0 + np.exp(2.0 * slope / shoulder_scale * (stops - shoulder_at)))
    low, high = np.where(stops < toe_at, low, straight), np.where(stops > shoulder_at, high, straight)
    share = np.clip((stops - shoulder_at) / (toe_at - shoulder_at), 0.0, 1.0)  # the two overlap
    share = share * share * (3.0 - 2.0 * share)
    shown: F64 = np.clip(low + (high - low) * share, 0.0, 1.0)
    return shown


def developed(spec: CameraSpec, film: Film, light: F32, air: Air) -> U8:
    """Return the picture (height, width, 4) of light (N, 3), tile by tile, as bytes B, G, R, A."""
    pixel = pixel_of_ray(spec)
    image = np.empty((spec.height_px * spec.width_px, 4), np.uint8)
    table, factor = curve(film), balance(film, air)
    halo, across = bloom(spec, film, light, factor), tile_counts(spec)[0]

    def work(start: int, stop: int) -> None:
        develop_loop(light, factor, halo, across, pixel, spec.width_px, *rain(air), table, image, start, stop)

    in_stretches(len(pixel), work, multiple=TILE)
    return image.reshape(spec.height_px, spec.width_px, 4)


def balance(film: Film, air: Air) -> F32:
    """Return what red, green and blue (3,) are multiplied by before the film's curve."""
    factors: F32 = white_balance(film) * np.float32(exposure(film, air))
    return factors


def rain(air: Air) -> tuple[float, float, float]:
    """Return how hard it rains before the lens, 0 to 1, at what time (s), and how bright a drop is."""
    return air.rain, math.fmod(air.now_s, 1000.0), 0.16 * brightness(air)


def white_balance(film: Film) -> F32:
    """Return factors (3,) of red, green and blue: a lamp of the film's temperature comes out white.

    A straight line through the ratios of a black body near 6500 K; ``tint`` above 0 goes to magenta, as in Unreal.
    """
    warmer = 6500.0 / min(max(film.temperature_k, 1500.0), 15000.0) - 1.0
    balance = np.array([1.0 - 0.45 * warmer, 1.0 - 0.25 * film.tint, 1.0 + 0.55 * warmer])
    factors: F32 = np.maximum(balance, 0.1).astype(np.float32)
    return factors


def bloom_weights(film: Film) -> tuple[F32, F32]:
    """Return how much light comes from each of 13 tiles (13,) down, and then across."""
    bell = np.exp(-0.5 * (np.arange(-6, 7) / 2.4) ** 2)
    bell /= bell.sum()
    strength = _BLOOM_SHARE * film.bloom / _DEFAULT.bloom if film.postprocess else 0.0
    return bell.astype(np.float32), (strength * bell).astype(np.float32)


def bloom(spec: CameraSpec, film: Film, light: F32, factor: F32) -> F32:
    """Return the light that the brightest spots spread around them, (tiles down, tiles across, 3), exposed."""
    across, down = tile_counts(spec)
    tiles = np.empty((down * across, 3), np.float32)

    def work(start: int, stop: int) -> None:
        excess_loop(light, factor, tiles, start, stop)

    in_stretches(len(tiles), work, multiple=1)
    over: F32 = tiles.reshape(down, across, 3)
    if not over.any():
        return over
    spread: F32 = over
    for axis, weights in enumerate(bloom_weights(film)):
        padded = np.pad(spread, [(6, 6) if side == axis else (0, 0) for side in range(3)])
        length = spread.shape[axis]
        spread = sum(weight * np.take(padded, np.arange(k, k + length), axis=axis) for k, weight in enumerate(weights))
    return spread


@shading
def excess_loop(light: F32, factor: F32, over: F32, start: int, stop: int) -> None:
    """Write how far the brightest spot of each tile is above what a picture can hold."""
    for tile in range(start, stop):
        for channel in range(3):
            most = narrow(0.0)
            for ray in range(tile * TILE, (tile + 1) * TILE):
                most = max(most, light[ray, channel])
            over[tile, channel] = min(max(most * factor[channel] - narrow(_BLOOM_FROM), 0.0), narrow(_BLOOM_MOST))


@shading_part
def _streak(x: float, y: float, rain: float, now_s: float) -> float:
    """Return how bright a falling drop is before a pixel of a picture 600 high: two sheets of slanting streaks."""
    bright = 0.0
    for sheet in range(2):
        wide, tall, fall = (1.6, 46.0, 1500.0) if sheet == 0 else (3.2, 95.0, 2300.0)
        number = whole((x + 0.07 * y) / wide)
        row = (y - fall * now_s) / tall + hashed(number, 3, 61 + sheet) * 977.0
        first = whole(row)
        if hashed(number, first, 71 + sheet) < 0.02 + 0.07 * rain:
            along = row - narrow(first)
            bright += (0.9 if sheet == 0 else 0.55) * along * (1.0 - along) * 4.0
    return bright


def _build(built_of: int) -> Callable[..., None]:
    """Compile the kernel; ``built_of`` is in its closure, so that it is renewed with the parts it is made of."""

    @shading
    def develop(
        light: F32, factor: F32, halo: F32, across: int, pixel: NDArray[np.int32], width: int, rain: float,
        now_s: float, rain_light: float, table: U8, image: U8, start: int, stop: int,
    ) -> None:  # fmt: skip
        if built_of < 0:
            return
        most = narrow(_MOST)
        scale = narrow(len(table) - 1) / math.sqrt(most)
        finer = narrow(600.0 * width / len(image))
        for tile in range(start // TILE, (stop + TILE - 1) // TILE):
            row, column = tile // across, tile % across
            red, green, blue = halo[row, column, 0], halo[row, column, 1], halo[row, column, 2]
            for ray in range(max(start, tile * TILE), min(stop, tile * TILE + TILE)):
                at = pixel[ray]
                if at < 0:
                    continue
                drop = narrow(0.0)
                if rain > 0.0:
                    x, y = narrow(column * TILE_PX + ray % TILE_PX), narrow(row * TILE_PX + ray % TILE // TILE_PX)
                    drop = narrow(rain * rain_light) * _streak(finer * x, finer * y, narrow(rain), narrow(now_s))
                exposed = (
                    (light[ray, 0] + drop) * factor[0] + red,
                    (light[ray, 1] + drop) * factor[1] + green,
                    (light[ray, 2] + drop) * factor[2] + blue,
                )
                image[at, 2] = table[narrow_whole(math.sqrt(min(max(exposed[0], 0.0), most)) * scale)]
                image[at, 1] = table[narrow_whole(math.sqrt(min(max(exposed[1], 0.0), most)) * scale)]
                image[at, 0] = table[narrow_whole(math.sqrt(min(max(exposed[2], 0.0), most)) * scale)]
                image[at, 3] = np.uint8(255)

    return develop


develop_loop = _build(fingerprint(Path(__file__), Path(__file__).with_name("texture_noise.py")))
