"""The weather that an episode begins with."""

from linden.values.episode import WeatherParameters

CLEAR_NOON = WeatherParameters(
    cloudiness=5.0,
    wind_intensity=10.0,
    sun_azimuth_angle=-1.0,
    sun_altitude_angle=45.0,
    fog_density=2.0,
    fog_distance=0.75,
    fog_falloff=0.1,
    scattering_intensity=1.0,
    mie_scattering_scale=0.03,
    rayleigh_scattering_scale=0.0331,
)
"""The client's preset of this name. CARLA's towns have a weather of their own, which no source states; all are by day.

With the sun on the horizon, which is where zeros would put it, the Traffic Manager turns its vehicles' lights on.
"""
