"""How far an actor can be seen by light and weather, as distances in m.

By day light sets no limit. From sunset on, lamps are needed: Ohio Revised Code 4513.03 (A) demands them from sunset,
and wherever persons are not discernible at 1,000 feet. For drivers twilight ends at a sun 6° below the horizon (civil
twilight: from some 500 lx to 3 lx, AMS Glossary of Meteorology). By then an unlit body is seen in the low beams only.
They have to reveal persons at 100 feet (Ohio Administrative Code 4501-15, (C)(2)): the least that a lawful lamp does.
Vehicles have lamps or reflectors, which have to be visible from 500 feet (Ohio Revised Code 4513.05, 4511.56).

In fog, rain and dust the range is the meteorological optical range: contrast falls to 5 % after 3 / extinction
(Koschmieder; WMO-No. 8, part I, chapter 9). CARLA gives its fog density no unit. The extinction here is that of
Linden's pictures (0.07/m in the densest fog, so 43 m), for want of a published one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import carla

FOOT_M = 0.3048
SUNSET_M = 1000.0 * FOOT_M  # of an unlit body, as the sun sets
LOW_BEAM_M = 100.0 * FOOT_M  # of an unlit body, in the dark
LAMPS_M = 500.0 * FOOT_M  # of a vehicle, in the dark
DARK_DEG = -6.0  # height of the sun
CONTRAST = 0.05  # at which a thing is no longer told from the fog before it
FOG_PER_M, FOG_EXPONENT = 0.07, 1.6  # extinction in the densest fog; how it grows with the density
RAIN_PER_M, DUST_PER_M = 0.003, 0.03  # in the hardest rain and the densest dust
CLEAR_PER_M = 1e-4  # 30 km


def light_range_m(sun_altitude_deg: float, *, lamps: bool) -> float:
    """Return how far a body is seen by the light there is; inf by day.

    Args:
        sun_altitude_deg: height of the sun above the horizon.
        lamps: whether the body has lamps or reflectors, as vehicles have.
    """
    if sun_altitude_deg >= 0.0:
        return math.inf
    dark_m = LAMPS_M if lamps else LOW_BEAM_M
    if sun_altitude_deg <= DARK_DEG:
        return dark_m
    share = sun_altitude_deg / DARK_DEG  # of the way from sunset into the dark
    return float(SUNSET_M * (dark_m / SUNSET_M) ** share)  # light falls by the same factor with each degree


def air_range_m(weather: carla.WeatherParameters) -> float:
    """Return the meteorological optical range, behind the distance at which CARLA's fog begins."""
    fog, rain, dust = (_share(v) for v in (weather.fog_density, weather.precipitation, weather.dust_storm))
    per_m = CLEAR_PER_M + FOG_PER_M * fog**FOG_EXPONENT + RAIN_PER_M * rain + DUST_PER_M * dust
    return float(max(0.0, float(weather.fog_distance)) - math.log(CONTRAST) / per_m)


def ranges_m(weather: carla.WeatherParameters) -> tuple[float, float]:
    """Return how far an unlit body is seen in this weather, and how far a vehicle."""
    if weather.cloudiness < 0.0:
        return math.inf, math.inf  # the map's own weather (CARLA's preset Default): a clear day
    air_m, sun_deg = air_range_m(weather), float(weather.sun_altitude_angle)
    return min(air_m, light_range_m(sun_deg, lamps=False)), min(air_m, light_range_m(sun_deg, lamps=True))


def _share(percent: float) -> float:
    return min(1.0, max(0.0, float(percent) / 100.0))
