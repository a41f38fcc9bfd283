"""The light of the sky in a direction: gradient, sun, clouds that drift with the wind, stars."""

import math

from linden.compiled import shading_part
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.texture_noise import fading, fraction, hashed, narrow, ramp, smooth_noise, whole

_STAR_CELLS = narrow(220.0)  # to a radian


@shading_part
def clear_sky(dx: float, dy: float, dz: float, air: Air) -> tuple[float, float, float]:
    """Return what is seen in a direction of length 1 between the clouds; below the horizon, the horizon's haze."""
    up = max(dz, 0.0)
    rise = 1.0 - fading(-3.6 * up)
    red = air.horizon[0] + rise * (air.zenith[0] - air.horizon[0])
    green = air.horizon[1] + rise * (air.zenith[1] - air.horizon[1])
    blue = air.horizon[2] + rise * (air.zenith[2] - air.horizon[2])
    towards = dx * air.sun_x + dy * air.sun_y + dz * air.sun_z
    if towards > 0.0:
        wide = towards * towards
        wide = wide * wide
        haze = wide * fading(-5.0 * up)
        near = wide * wide * wide
        halo, disk = 0.10 * near * near, 9.0 * ramp(0.99985, 0.99993, towards)
        if towards > 0.97:
            disk += 0.5 * fading(-1100.0 * (1.0 - towards))
        red += haze * air.glow[0] + (halo + disk) * air.sun[0]
        green += haze * air.glow[1] + (halo + disk) * air.sun[1]
        blue += haze * air.glow[2] + (halo + disk) * air.sun[2]
    return red, green, blue


@shading_part
def sky(dx: float, dy: float, dz: float, star: float, air: Air) -> tuple[float, float, float]:
    """Return what is seen in a direction of length 1 where nothing stands; ``star`` is the light of one behind it."""
    red, green, blue = clear_sky(dx, dy, dz, air)
    if dz > 0.02:
        towards = dx * air.sun_x + dy * air.sun_y + dz * air.sun_z
        cover = _clouds(dx, dy, dz, air)
        behind = star * (1.0 - cover)
        red, green, blue = red + behind, green + behind, blue + behind
        shade = 0.82 + 0.18 * ramp(0.5, 1.0, 1.0 - cover)
        warm = max(towards, 0.0)
        warm *= warm
        warm *= warm
        red += (air.cloud[0] * shade + 0.5 * warm * air.glow[0] - red) * cover
        green += (air.cloud[1] * shade + 0.5 * warm * air.glow[1] - green) * cover
        blue += (air.cloud[2] * shade + 0.5 * warm * air.glow[2] - blue) * cover
    return red, green, blue


@shading_part
def _clouds(dx: float, dy: float, dz: float, air: Air) -> float:
    """Return how much of the sky clouds cover in a direction, 0 to 1: four octaves on a flat layer, seen from below."""
    if air.cloud_cover <= 0.0:
        return 0.0
    stretch = 1.5 / (dz + 0.08)
    x, y = dx * stretch + air.cloud_shift_m, dy * stretch + 0.3 * air.cloud_shift_m
    n = 0.52 * smooth_noise(x, y, 7) + 0.27 * smooth_noise(2.1 * x + 5.0, 2.1 * y, 8)
    edge = 0.80 - 0.62 * air.cloud_cover
    if n + 0.21 < edge:  # whatever the finer octaves add
        return 0.0
    n += 0.15 * smooth_noise(4.3 * x, 4.3 * y + 9.0, 9) + 0.06 * smooth_noise(9.1 * x + 3.0, 9.1 * y, 10)
    thick = ramp(edge, edge + 0.22, n)
    return thick * ramp(0.0, 0.18, dz) * (0.70 + 0.28 * air.cloud_cover)


@shading_part
def starlight(dx: float, dy: float, dz: float) -> float:
    """Return the light of the star in a direction, if there is one: one cell in 250 holds one."""
    u, v = math.atan2(dy, dx) * _STAR_CELLS, math.asin(min(dz, 1.0)) * _STAR_CELLS
    chance = hashed(whole(u), whole(v), 41)
    if chance > 0.004:
        return 0.0
    across, up = fraction(u) - 0.5, fraction(v) - 0.5
    away = across * across + up * up
    return 0.09 * ramp(0.0, 0.004, chance) * max(0.0, 1.0 - 5.0 * away)
