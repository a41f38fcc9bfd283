"""What surrounds the actors: weather, and the gravity that IMU sensors feel. Source of names: LibCarla 0.9.16."""

from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.values.episode import WeatherParameters


@method("get_weather_parameters")
def get_weather_parameters(context: Context) -> WeatherParameters:
    """Return the weather as it was set."""
    return context.simulation.episode.weather


@method("set_weather_parameters")
def set_weather_parameters(context: Context, weather: WeatherParameters) -> None:
    """Keep the weather; negative values mean the map's own default and are returned as they came."""
    episode = context.simulation.episode
    episode.weather = weather
    episode.surroundings.lamps.follow_sun(weather)


@method("get_imui_gravity")
def get_imui_gravity(context: Context) -> float:
    """Return the gravity that IMU sensors add, in m/s²."""
    return context.simulation.episode.imu_gravity_mps2


@method("set_imui_gravity")
def set_imui_gravity(context: Context, gravity_mps2: float) -> None:
    """Set the gravity that IMU sensors add."""
    context.simulation.episode.imu_gravity_mps2 = gravity_mps2
