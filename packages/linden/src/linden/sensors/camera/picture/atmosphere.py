"""Light and air by the weather: what the sun, the sky, clouds, fog and rain give to a picture, as numbers.

Light is reckoned so that a white surface square to a clear noon's sun shines with about 2. The colours of the sky by
the sun's height were chosen by eye; what the air takes from the sun's light follows Kasten and Young 1989 ("Revised
optical air mass tables and approximation formula", eq. 3).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.episode import WeatherParameters

F64 = NDArray[np.float64]

Colour = tuple[float, float, float]

_SKY = np.array(
    [  # sun's height in degrees; light of the zenith; light of the horizon: red, green, blue each
        (-90.0, 0.0011, 0.0016, 0.0036, 0.0028, 0.0032, 0.0052),
        (-14.0, 0.0013, 0.0020, 0.0048, 0.0040, 0.0042, 0.0065),
        (-6.0, 0.0120, 0.0210, 0.0520, 0.0900, 0.0680, 0.0720),
        (0.0, 0.0750, 0.1100, 0.2200, 0.6200, 0.3000, 0.1300),
        (6.0, 0.1400, 0.2100, 0.3600, 0.8800, 0.5000, 0.2400),
        (15.0, 0.1600, 0.2700, 0.4700, 0.9200, 0.6600, 0.4200),
        (25.0, 0.1500, 0.3200, 0.6300, 0.7200, 0.7800, 0.8400),
        (45.0, 0.1500, 0.3500, 0.7100, 0.7600, 0.8500, 0.9500),
        (90.0, 0.1600, 0.3800, 0.7700, 0.8000, 0.9000, 1.0000),
    ]
)
_SUN_ABOVE_AIR = np.array([2.30, 2.28, 2.33])
_OPTICAL_DEPTH = np.array([0.10, 0.175, 0.335])  # of clear air at the zenith: red, green, blue
_SUN_RADIUS_DEG = 0.27
_MOONLIGHT = np.array([0.010, 0.013, 0.020])
_CLEAR_FOG_PER_M = 0.0004


class Air(NamedTuple):
    """Everything that one moment's weather gives; colours are linear light, directions point to the light."""

    sun_x: float
    sun_y: float
    sun_z: float
    sun: Colour  # of a surface square to it; zeros by night and under thick clouds
    glow: Colour  # of the sky around the sun, at sunrise and sunset
    zenith: Colour
    horizon: Colour
    above: Colour  # light that a surface that looks up gets from the whole sky
    below: Colour  # and one that looks down, from the ground
    cloud: Colour
    cloud_cover: float  # 0 to 1
    cloud_shift_m: float  # how far the clouds have gone with the wind, at a height of one metre
    stars: float  # 0 to 1
    fog_per_m: float
    fog_from_m: float
    fog_falls_per_m: float
    fog: Colour
    rain: float  # 0 to 1
    wet: float  # 0 to 1: how dark and smooth the ground is
    puddles: float  # 0 to 1: share of the ground under water
    dust: float  # 0 to 1
    now_s: float


def air(weather: WeatherParameters, now_s: float) -> Air:
    """Return the light and air of a weather; one that is left to the map (negative) is a clear noon."""
    given = weather if weather.cloudiness >= 0.0 else WeatherParameters(cloudiness=5.0, sun_altitude_angle=45.0)
    height_deg = min(90.0, max(-90.0, given.sun_altitude_angle))
    cover, rain = _share(given.cloudiness), _share(given.precipitation)
    day = _mixed(height_deg)
    grey = cover**2
    gloom = 1.0 - 0.4 * rain
    zenith, horizon = gloom * _overcast(day[:3], grey), gloom * _overcast(day[3:], grey)
    mist = 1.0 - (1.0 - _share(given.fog_density)) ** 3  # of the sun's light, what it spreads over the whole sky
    clear = sunlight(height_deg) * (1.0 - 0.97 * cover**1.5) * (1.0 - 0.6 * rain)
    sun = (1.0 - mist) * clear
    light_of_day = float(day[3:].mean())
    towards = _direction(given.sun_azimuth_angle, height_deg)
    above = (0.50 * zenith + 0.26 * horizon) * (1.0 + 0.35 * grey) + 0.9 * _MOONLIGHT * (1.0 - 0.5 * grey)
    above += 0.45 * max(0.0, towards[2]) * mist * clear
    fog = 0.85 * horizon + 0.10 * zenith + 0.06 * sun
    return Air(
        *towards,
        sun=_colour(sun),
        glow=_colour(np.array([1.3, 0.42, 0.06]) * _bump(height_deg, 3.0, 11.0) * (1.0 - 0.8 * grey)),
        zenith=_colour(zenith),
        horizon=_colour(horizon),
        above=_colour(above),
        below=_colour(0.22 * above + 0.11 * max(0.0, towards[2]) * sun),
        cloud=_colour(gloom * _cloud(day, sun, cover)),
        cloud_cover=cover,
        cloud_shift_m=0.0004 * given.wind_intensity * now_s,
        stars=max(0.0, min(1.0, (-4.0 - height_deg) / 8.0)) * (1.0 - cover),
        fog_per_m=_CLEAR_FOG_PER_M + 0.07 * _share(given.fog_density) ** 1.6 + 0.003 * rain
        + 0.03 * _share(given.dust_storm),
        fog_from_m=max(0.0, given.fog_distance),
        fog_falls_per_m=0.004 + 0.06 * max(0.0, given.fog_falloff),
        fog=_colour(fog * (1.0 - _share(given.dust_storm)) + _share(given.dust_storm) * _dust(light_of_day)),
        rain=rain,
        wet=max(_share(given.wetness), 0.8 * _share(given.precipitation_deposits), 0.7 * rain),
        puddles=_share(given.precipitation_deposits),
        dust=_share(given.dust_storm),
        now_s=now_s,
    )  # fmt: skip


def sunlight(height_deg: float) -> F64:
    """Return the light (3,) of a surface square to the sun through clear air; none once it has set."""
    up = max(0.0, min(1.0, (height_deg + _SUN_RADIUS_DEG) / (2.0 * _SUN_RADIUS_DEG)))
    angle = max(height_deg, 0.0)
    mass = 1.0 / (math.sin(math.radians(angle)) + 0.50572 * (angle + 6.07995) ** -1.6364)
    light: F64 = up * _SUN_ABOVE_AIR * np.exp(-_OPTICAL_DEPTH * mass)
    return light


def brightness(light: Air) -> float:
    """Return the light on level ground, by which an eye or a camera adapts."""
    level = np.array(light.sun) * max(0.0, light.sun_z) + np.array(light.above)
    return float(level @ np.array([0.2126, 0.7152, 0.0722]))


def _mixed(height_deg: float) -> F64:
    return np.array([np.interp(height_deg, _SKY[:, 0], _SKY[:, column]) for column in range(1, 7)])


def _overcast(clear: F64, grey: float) -> F64:
    """Return a sky's colour behind ever more clouds: without its blue, and darker."""
    plain = np.full(3, 0.62 * clear.mean() + 0.28 * clear.max()) * np.array([0.97, 1.0, 1.04])
    mixed: F64 = clear + (plain - clear) * min(1.0, 1.1 * grey)
    return mixed


def _cloud(day: F64, sun: F64, cover: float) -> F64:
    lit: F64 = 0.95 * day[3:] + 0.10 * sun * (1.0 - cover)
    grey = np.full(3, 0.60 * day[3:].mean()) * np.array([0.97, 1.0, 1.05])
    mixed: F64 = lit + (grey - lit) * cover**1.5
    return mixed


def _dust(light_of_day: float) -> F64:
    dust: F64 = light_of_day * np.array([0.80, 0.58, 0.36])
    return dust


def _direction(azimuth_deg: float, height_deg: float) -> Colour:
    """Return the direction to the sun: azimuth clockwise from x, which is east; CARLA leaves its origin to Unreal."""
    azimuth, height = math.radians(azimuth_deg), math.radians(height_deg)
    return math.cos(azimuth) * math.cos(height), math.sin(azimuth) * math.cos(height), math.sin(height)


def _bump(value: float, middle: float, width: float) -> float:
    return math.exp(-(((value - middle) / width) ** 2))


def _share(percent: float) -> float:
    return max(0.0, min(1.0, percent / 100.0))


def _colour(light: F64) -> Colour:
    red, green, blue = (max(0.0, float(value)) for value in light)
    return red, green, blue
